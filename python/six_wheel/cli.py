"""The commands of `six-wheel`: arguments in, files and tables out, one line for whatever is wrong.

Only typer is imported here: ``six-wheel drive --help`` need not wait for NumPy, Arrow or matplotlib.
"""

import contextlib
import difflib
import math
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from six_wheel.__main__ import COMMANDS, INSTALL, PROGRAM, PURPOSE

if TYPE_CHECKING:
    from rich.console import Console

    from six_wheel._core import Limits, Rover, Wheel
    from six_wheel.config import Parameters
    from six_wheel.drive import Peak, Summary

EXTRA_MODULES = ("matplotlib", "pyarrow", "pydantic", "rich", "yaml")
HELP_OPTIONS = ["-h", "--help"]
PROGRESS_AFTER = 1.0  # [s] what is over sooner needs no bar

app = typer.Typer(
    help=PURPOSE,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": HELP_OPTIONS},
)

RoverArgument = Annotated[
    str, typer.Argument(metavar="ROVER", help="Parameter file, or the name of a preset.")
]
NodeOption = Annotated[
    str | None, typer.Option(help="Node whose parameters to read, if the file has several.")
]


@app.command(help=COMMANDS["demo"])
def demo(
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder for the pictures and tables.")
    ] = Path("six_wheel_demo"),
) -> None:
    from six_wheel import demo

    demo.run(output, console=_console())


@app.command(help=COMMANDS["check"])
def check(rover: RoverArgument, node: NodeOption = None) -> None:
    try:
        chosen = _choose(rover, node)
    except ValueError as error:
        findings = getattr(error, "findings", None)
        if not findings:
            raise
        print(*findings, sep="\n", file=sys.stderr)
        raise typer.Exit(2) from None
    console = _console()
    if chosen.parameters and chosen.parameters.warnings:
        print(*chosen.parameters.warnings, sep="\n", file=sys.stderr)
    _print_wheels(console, chosen)
    console.print(_grid(_abilities(chosen)))


@app.command(help=COMMANDS["drive"])
def drive(
    rover: RoverArgument,
    commands: Annotated[
        Path, typer.Argument(metavar="COMMANDS", help="Table with time, vx, vy, omega: .csv or .parquet.")
    ],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Where the results go: .csv, .parquet or .mcap.")
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Picture of the path: .png, .svg or .pdf.")] = None,
    keep: Annotated[
        str | None,
        typer.Option(
            metavar="curvature|speed|yaw_rate|nearest",
            help="Drive the nearest possible where the rover cannot do as told, keeping this. "
            "Without it such a row is an error.",
        ),
    ] = None,
    node: NodeOption = None,
    chunk_rows: Annotated[int, typer.Option(help="Most rows in memory at a time.")] = 200_000,
) -> None:
    chosen = _choose(rover, node)
    # After the file of the rover is known to be good: Arrow takes its time.
    from six_wheel.drive import drive as drive_table

    with _progress(f"driving {commands.name}") as progress:
        summary = drive_table(
            chosen.rover,
            commands,
            output,
            plot=plot,
            keep=keep,
            chunk_rows=chunk_rows,
            sources=[chosen.path] if chosen.path else [],
            progress=progress,
        )
    console = _console()
    for warning in summary.warnings:
        print(f"{PROGRAM}: warning: {warning}", file=sys.stderr)
    from six_wheel._core import Limits

    limits = chosen.parameters.limits if chosen.parameters else Limits()
    console.print(_grid([*_summary(summary, limits), ("results", output), ("picture", plot)]))


@app.command(help=COMMANDS["show"])
def show(
    rover: RoverArgument,
    twist: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="VX VY OMEGA", help="Motion to draw [m/s, m/s, rad/s]. Default: a left turn."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Picture: .png, .svg or .pdf. Default: ROVER_from_above.png"),
    ] = None,
    node: NodeOption = None,
) -> None:
    chosen = _choose(rover, node)
    from six_wheel.drive import picture_path, replacing
    from six_wheel.plot import save, show_figure

    target = picture_path(output or Path(f"{chosen.name}_from_above.png"))
    figure = show_figure(chosen.rover, twist or _left_turn(chosen.rover), title=chosen.name)
    with replacing(target, [chosen.path] if chosen.path else []) as temporary:
        save(figure, temporary)
    print(target.resolve())


@app.command(help=COMMANDS["bench"])
def bench() -> None:
    from six_wheel import benchmark

    with _progress("timing") as progress:
        results = benchmark.measure(progress=progress)
    _console().print(benchmark.table(results))


# --- what the commands share -----------------------------------------------------------------------------


class _Chosen(NamedTuple):
    """A rover, what to call it, and the file it comes from unless it is a preset."""

    rover: "Rover"
    name: str
    path: Path | None = None
    parameters: "Parameters | None" = None


def _choose(argument: str, node: str | None) -> _Chosen:
    """The rover of a parameter file, or a preset if there is no such file."""
    path = Path(argument)
    if path.is_file() or path.suffix:
        from six_wheel.config import read_parameters

        parameters = read_parameters(path, node=node)
        return _Chosen(parameters.rover, path.stem, path, parameters)
    from six_wheel import Rover

    presets = list(Rover.presets())
    if argument in presets:
        return _Chosen(Rover.preset(argument), argument)
    close = difflib.get_close_matches(argument, presets, 1)
    hint = f'did you mean "{close[0]}"? ' if close else ""
    known = ", ".join(presets)
    raise ValueError(f'ROVER must be a parameter file or a preset, got "{argument}"; {hint}presets: {known}')


def _left_turn(rover: "Rover") -> tuple[float, float, float]:
    """Half a metre a second forward, around a centre to the left that this rover can turn about."""
    size = max(max(abs(wheel.x), abs(wheel.y)) for wheel in rover.wheels)
    speed = 0.5
    # Unsteered wheels may hold the centre on a line beside the origin: the projection puts it there.
    vx, vy, omega = rover.project((speed, 0.0, speed / max(2.0 * size, 1.2 * rover.min_radius))).tolist()
    return vx, vy, omega


def _console(stderr: bool = False) -> "Console":
    from rich.console import Console

    stream = sys.stderr if stderr else sys.stdout
    # Names of joints and files may hold square brackets; a file or pipe has no width to keep to.
    return Console(stderr=stderr, markup=False, highlight=False, width=None if stream.isatty() else 120)


@contextlib.contextmanager
def _progress(what: str) -> Iterator[Callable[[int, int], None]]:
    """A function to call with how much of how much is done; it draws a bar once that takes long."""
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    console = _console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    task = bar.add_task(what, total=None)
    begin = time.monotonic()

    def update(done: int, total: int) -> None:
        bar.update(task, completed=done, total=total)
        if time.monotonic() - begin > PROGRESS_AFTER:
            bar.start()  # which does nothing the second time

    try:
        yield update
    finally:
        if bar.live.is_started:  # some versions end even an unseen bar with an empty line
            bar.stop()


def _grid(rows: Sequence[tuple[str, object]]) -> Any:
    """A table of names and values; what is None is left out."""
    from rich.table import Table

    grid = Table.grid(padding=(0, 2))
    grid.add_column(style="bold", no_wrap=True)
    grid.add_column(overflow="fold")
    for name, value in rows:
        if value is not None:
            grid.add_row(name, str(value))
    return grid


def _angle(radians: float) -> str:
    return f"{radians:.4g} rad ({math.degrees(radians):.1f}°)"


def _print_wheels(console: "Console", chosen: _Chosen) -> None:
    from rich.table import Table

    rover = chosen.rover
    table = Table(title=f"{chosen.name}: {len(rover.wheels)} wheels", title_justify="left")
    for heading in ("wheel", "x [m]", "y [m]", "radius [m]", "steering range"):
        table.add_column(heading, justify="right" if heading.endswith("[m]") else "left", overflow="fold")
    for wheel in rover.wheels:
        numbers = (f"{value:.4g}" for value in (wheel.x, wheel.y, wheel.radius))
        table.add_row(wheel.name, *numbers, _turning(wheel))
    console.print(table)


def _turning(wheel: "Wheel") -> str:
    """How a wheel steers, and what else is not as usual about it."""
    ends = wheel.steering_range
    turns = "fixed" if ends is None else f"{math.degrees(ends[0]):.1f}° to {math.degrees(ends[1]):.1f}°"
    notes = {
        "swivels freely": wheel.castor,
        turns: not wheel.castor,
        f"heading {math.degrees(wheel.heading):.4g}°": wheel.heading != 0.0,
        f"rollers at {math.degrees(wheel.roller_angle or 0.0):.4g}°": wheel.roller_angle is not None,
        "no motor": not wheel.driven and not wheel.castor,
    }
    return ", ".join(note for note, holds in notes.items() if holds)


def _joints(joints: dict[str, str]) -> str:
    """Joints in their order, each with its wheel unless its name says that."""
    return ", ".join(joint if wheel in joint else f"{joint} ({wheel})" for joint, wheel in joints.items())


def _abilities(chosen: _Chosen) -> list[tuple[str, object]]:
    """What a rover can do, as rows for `_grid`."""
    rover, parameters = chosen.rover, chosen.parameters
    least, most = rover.min_radius, rover.spin_radius
    turns = "none: every radius is possible" if least == 0.0 else f"{least:.4g} m"
    spin = "not possible" if most == 0.0 else f"possible, with the centre up to {most:.4g} m from the middle"
    rows: list[tuple[str, object]] = [
        ("minimum radius", "cannot turn" if math.isinf(least) else turns),
        ("spin in place", "possible" if math.isinf(most) else spin),
        ("steering joints", _joints(rover.steering_joints) or "none"),
        ("traction joints", _joints(rover.traction_joints) or "none"),
    ]
    if parameters:
        limits = str(parameters.limits).removeprefix("Limits(").removesuffix(")").replace("=", " ")
        kind, controller = parameters.kind, parameters.controller
        rows += [
            ("kind", f"{kind}, as {controller} has it" if controller else kind),
            ("node", parameters.node),
            ("frames", f"{parameters.odom_frame_id} to {parameters.base_frame_id}"),
            ("limits", limits or None),
        ]
    return rows


def _summary(summary: "Summary", limits: "Limits") -> list[tuple[str, object]]:
    """What a drive came to, as rows for `_grid`."""

    def at(peak: "Peak", value: str, limit: float | None = None) -> str | None:
        over = f", over the limit of {limit:g}" if limit is not None and abs(peak.value) > limit else ""
        return f"{value}, {peak.name} in row {peak.row}{over}" if peak.row else None

    angle, rate = summary.steering_angle, summary.steering_rate
    speed, residual = summary.wheel_speed, summary.residual
    x, y, yaw = summary.end_pose
    vx, vy, omega = summary.changed
    changes = f"{summary.projected_rows}, by at most {vx:.3g} m/s, {vy:.3g} m/s, {omega:.3g} rad/s"
    return [
        ("rows", f"{summary.rows:,}"),
        ("duration", f"{summary.duration:.6g} s"),
        ("path length", f"{summary.path_length:.6g} m"),
        ("end pose", f"x {x:.6g} m, y {y:.6g} m, yaw {_angle(yaw)}"),
        ("largest steering angle", at(angle, _angle(angle.value))),
        ("largest steering rate", at(rate, f"{rate.value:.4g} rad/s", limits.steering_rate)),
        ("largest wheel speed", at(speed, f"{speed.value:.4g} rad/s", limits.wheel_speed)),
        ("largest residual", at(residual, f"{residual.value:.2g} m/s")),
        ("projected rows", changes if summary.projected_rows else summary.projected_rows),
        ("took", f"{summary.elapsed:.3g} s, {summary.rows / summary.elapsed:,.0f} rows/s"),
    ]


def run(arguments: Sequence[str]) -> int:
    """Run a command; whatever is wrong with its input becomes one line on stderr. Returns the exit code."""
    try:
        if len(arguments) == 2 and arguments[0] in COMMANDS and arguments[1] in HELP_OPTIONS:
            # To read arguments typer loads pydantic, which takes longer than all of this.
            group: Any = typer.main.get_command(app)
            command = group.commands[arguments[0]]
            parent = typer.Context(group, info_name=PROGRAM, **group.context_settings)
            print(command.get_help(typer.Context(command, parent=parent, info_name=arguments[0])))
            return 0
        code = app(list(arguments), prog_name=PROGRAM, standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        return 130
    except (
        BrokenPipeError
    ):  # `six-wheel check ... | head`: nobody reads on, and Python must not flush at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as error:
        message = _explain(error)
        if message is None:
            raise
        print(f"{PROGRAM}: {' '.join(message.split())}", file=sys.stderr)
        return 2
    return code if isinstance(code, int) else 0


def _explain(error: Exception) -> str | None:
    """What to tell the user about an error; None if it is not their input but this program that is wrong."""
    if findings := getattr(error, "findings", None):  # of a parameter file
        others = len(findings) - 1
        return f"{findings[0]}" + (f"; and {others} more: {PROGRAM} check shows all" if others else "")
    if hasattr(error, "format_message"):  # typer's own, whichever class it has in this version
        context = getattr(error, "ctx", None)
        usage = f"; see {context.command_path} --help" if context else ""
        return str(error.format_message()).rstrip(".") + usage
    if isinstance(error, ModuleNotFoundError) and (error.name or "").split(".")[0] in EXTRA_MODULES:
        return f"this needs {error.name}, which is not installed: {INSTALL}"
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if isinstance(error, MemoryError):
        return "not enough memory"
    return str(error) if isinstance(error, ValueError | OSError | ImportError) else None
