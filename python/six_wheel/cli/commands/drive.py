"""`six-wheel drive`: a table of commands, directly or through the controller."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from six_wheel.cli.shared import (
    Reading,
    ResultsOption,
    RoverArgument,
    angle_text,
    choose,
    grid,
    new_console,
    progress_bar,
    warn,
)
from six_wheel.robot_description.named_rover import NamedRover

if TYPE_CHECKING:
    from six_wheel._core import Limits
    from six_wheel.simulation.drive.closed_loop import ControlledDrive, DriveLoop
    from six_wheel.simulation.drive.feedforward import Drive
    from six_wheel.simulation.drive.run_commands import Peak, Summary

ROUNDING = 1e-9  # of a value that is a difference over a step: within it a limit is kept

RateOption = Annotated[
    float | None,
    typer.Option(
        metavar="HZ",
        help="Through the controller, which keeps the limits of the parameter file: commands come when "
        "their times say, rows of the results at this rate, until the rover stands. Without it so too if "
        "the file has limits or control, at 1/period or 50 Hz.",
    ),
]
DirectOption = Annotated[
    bool,
    typer.Option("--direct", help="Without the controller: what a row says is done at once, until the next."),
]
PictureOption = Annotated[
    Path | None,
    typer.Option(
        help="Picture of the path; through the controller also of commands, joints, limits and reasons "
        "over time: .png, .svg or .pdf."
    ),
]
HaltOption = Annotated[
    float | None,
    typer.Option(
        metavar="T",
        help="Halt the rover so many seconds after the first command, at halt_deceleration, for good.",
    ),
]
KeepOption = Annotated[
    str | None,
    typer.Option(
        metavar="curvature|speed|yaw_rate|nearest",
        help="Drive the nearest possible where the rover cannot do as told, keeping this. "
        "Without it such a row is an error; the controller keeps the curvature.",
    ),
]


def drive(
    rover: RoverArgument,
    commands: Annotated[
        Path, typer.Argument(metavar="COMMANDS", help="Table with time, vx, vy, omega: .csv or .parquet.")
    ],
    output: ResultsOption = None,
    rate: RateOption = None,
    direct: DirectOption = False,
    plot: PictureOption = None,
    halt: HaltOption = None,
    keep: KeepOption = None,
    *,
    reading: Reading,
    chunk_rows: Annotated[int, typer.Option(help="Most rows in memory at a time.")] = 200_000,
) -> None:
    if direct and rate is not None:
        raise ValueError(f"--rate must be left out with --direct, which has no loop, got {rate:g}")
    if direct and halt is not None:
        raise ValueError(f"--halt must be left out with --direct, which has no controller, got {halt:g}")
    chosen = choose(rover, reading)
    loop = None if direct else _loop(chosen, rate, halt)
    # After the file of the rover is known to be good: Arrow takes its time.
    from six_wheel.cli.report.markdown import reporting
    from six_wheel.simulation.drive.run_file import drive as drive_table

    sources = [chosen.path] if chosen.path else []
    with (
        progress_bar(f"driving {commands.name}") as progress,
        reporting(plot, None, [commands, *sources]) as pages,
    ):

        def draw(engine: "Drive | ControlledDrive") -> None:
            if pages is not None:
                from six_wheel.plotting.drive import engine_figure

                pages.write([("", engine_figure(engine, title=commands.name))])

        summary = drive_table(
            chosen.rover,
            commands,
            output,
            loop=loop,
            finish=draw,
            keep=keep,
            chunk_rows=chunk_rows,
            sources=sources,
            progress=progress,
        )
    warn(summary.warnings)
    rows = [*_summary(summary, chosen.limits, halt), ("results", output), ("picture", plot)]
    new_console().print(grid(rows))


def _loop(chosen: NamedRover, rate: float | None, halt: float | None) -> "DriveLoop | None":
    """The controller to drive through, if there is anything for it to keep or it is asked for."""
    from six_wheel._core import Limits

    limits = chosen.limits
    control = chosen.parameters.control if chosen.parameters else {}
    if rate is None and halt is None and limits == Limits() and not control:
        return None
    from six_wheel.simulation.drive.closed_loop import DriveLoop

    return DriveLoop(limits, rate, control, halt)


def _summary(summary: "Summary", limits: "Limits", halt: float | None = None) -> list[tuple[str, object]]:
    """Summary of a drive, as rows for `grid`."""

    def at(peak: "Peak", value: str, limit: float = math.inf) -> str | None:
        if not peak.row:
            return None
        against = f" of {limit:g} allowed" if math.isfinite(limit) else ""
        over = ", over the limit" if abs(peak.value) > limit * (1.0 + ROUNDING) else ""
        place = "" if peak.name == "body" else f"{peak.name} "
        return f"{value}{against}, {place}in row {peak.row}{over}"

    def largest(peak: "Peak", unit: str, limit: float) -> str | None:
        return at(peak, f"{peak.value:.4g} {unit}", limit)

    def limited(peak: "Peak", unit: str, limit: float) -> str | None:
        """Text of a peak if it has a finite limit, otherwise None."""
        return largest(peak, unit, limit) if math.isfinite(limit) else None

    angle, residual = summary.steering_angle, summary.residuals
    x, y, yaw = summary.end_pose
    vx, vy, omega = summary.changed
    changes: object = summary.projected_rows
    if summary.projected_rows:
        changes = f"{summary.projected_rows}, by at most {vx:.3g} m/s, {vy:.3g} m/s, {omega:.3g} rad/s"
    elif summary.reasons.get("PROJECTED"):
        changes = f"{summary.reasons['PROJECTED']:,} steps, by the controller"
    hardest = max(limits.acceleration, limits.deceleration)
    through = None if summary.rate is None else f"the controller, at {summary.rate:g} Hz"
    reasons = sorted(summary.shares.items(), key=lambda item: -item[1])
    shares = [f"{name} {share:.1%}" for name, share in reasons]
    return [
        ("driven", through or "directly, without limits"),
        ("halted", None if halt is None else f"at {halt:g} s, at {limits.halt_deceleration:g} m/s^2"),
        ("rows", f"{summary.rows:,}"),
        ("duration", f"{summary.duration:.6g} s"),
        ("path length", f"{summary.path_length:.6g} m"),
        ("end pose", f"x {x:.6g} m, y {y:.6g} m, yaw {angle_text(yaw)}"),
        ("largest speed", limited(summary.speed, "m/s", limits.speed)),
        ("largest yaw rate", limited(summary.yaw_rate, "rad/s", limits.yaw_rate)),
        ("largest acceleration", limited(summary.acceleration, "m/s^2", hardest)),
        ("largest steering angle", at(angle, angle_text(angle.value), limits.steering_limit)),
        ("largest steering rate", largest(summary.steering_rate, "rad/s", limits.steering_rate)),
        ("largest wheel speed", largest(summary.wheel_speed, "rad/s", limits.wheel_speed)),
        (
            "largest wheel acceleration",
            limited(summary.wheel_acceleration, "rad/s^2", limits.wheel_acceleration),
        ),
        ("largest residual", at(residual, f"{residual.value:.2g} m/s")),
        ("projected rows", changes),
        ("limited by", ", ".join(shares) or ("nothing" if through else None)),
        ("took", f"{summary.elapsed:.3g} s, {summary.rows / summary.elapsed:,.0f} rows/s"),
    ]
