"""Output of the demo: one picture, one table of commands per rover, and the numbers on the console."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from six_wheel.cli.demo.motion import REST_SPEED, SMOOTHING, SUSTAINED, DemoMotion, DemoResult
from six_wheel.kinematics.objects.whole_files import replacing
from six_wheel.plotting.drawing import INK, SOFT, draw_legend, new_figure, tidy
from six_wheel.plotting.path import draw_path
from six_wheel.robot_description.wheels_of_rover import joints_by_wheel

# One colour per axle, from front to rear; the left wheel is drawn full, the right one lighter.
REST = "#e3e6e9"  # opaque: a palette of few colours keeps it
AXLE_COLORS = ("#1f6f9c", "#8a6d2f", "#a3321c", "#4c4a7d")


def draw(results: Sequence[DemoResult]) -> Figure:
    """The rovers along their paths, over their steering angles and wheel speeds."""
    figure = new_figure(6.4 * len(results), 10.0)
    rows = figure.subplots(3, len(results), squeeze=False, height_ratios=(3.4, 1, 1))
    for result, (path, steering, speeds) in zip(results, rows.T, strict=True):
        draw_path(path, result.rover, result.driven[:-1], result.steering, recorded=result.recorded)
        enlarged = f"path enlarged {result.scale:.2f} times, " if result.scale > 1 else ""
        path.set_title(result.name, loc="left", fontsize=14, color=INK, weight="bold")
        path.set_title(f"{enlarged}{result.length:.1f} m", loc="right", fontsize=10, color=SOFT)
        draw_legend(path, loc="upper left", fontsize=8, labelcolor=SOFT)

        wheels, times = result.rover.wheels, result.times[:-1]
        steered = [wheel for wheel in wheels if wheel.steered]
        colors = _colors(result)
        for wheel, angles in zip(steered, result.steering.T, strict=True):
            steering.plot(times, np.degrees(angles), **colors[wheel.name])
        for wheel, rates in zip(wheels, result.wheel_speeds.T, strict=True):
            speeds.plot(times, rates, **colors[wheel.name], label=wheel.name.replace("_", " "))
        tidy(steering, "", "steering [°]")
        tidy(speeds, "time [s]", "wheel speed [rad/s]")
        steering.tick_params(labelbottom=False)
        words = "shaded: it stands and turns its wheels to the next angles"
        steering.set_title(words, loc="right", fontsize=8, color=SOFT)
        for axes in (steering, speeds):
            axes.set_xlim(times[0], times[-1])
            _shade_rests(axes, result)
    handles, labels = rows[2, 0].get_legend_handles_labels()
    draw_legend(figure, handles, labels, loc="outside lower center", ncols=6, fontsize=8, labelcolor=SOFT)
    return figure


def write_commands(result: DemoResult, path: Path) -> None:
    """Joint commands as CSV: each row holds from its time to the next, the last one stops.

    Steering joints [rad], wheel joints [rad/s], and the odometry pose at the row's time [m, m, rad].
    """
    rover = result.rover
    joint_of, wheel_joint_of = joints_by_wheel(rover)
    joints = [joint_of[name] for name in rover.steered_wheel_names] + [
        wheel_joint_of[name] for name in rover.wheel_names
    ]
    stop = np.zeros((1, 3)), result.steering[-1:], np.zeros((1, len(rover.wheels)))
    commands = zip((result.twists, result.steering, result.wheel_speeds), stop, strict=True)
    columns = [result.times[:, None], *map(np.concatenate, commands), result.odometry]
    header = ",".join(["time", "vx", "vy", "omega", *joints, "x", "y", "yaw"])
    rows = np.concatenate(columns, axis=1) + 0.0  # -0 is 0
    with replacing(path) as temporary:
        np.savetxt(temporary, rows, fmt="%.9g", delimiter=",", header=header, comments="")


def introduce(motion: DemoMotion) -> str:
    """Text on the recording and its preparation."""
    yaw, ahead = motion.frame
    way = float(np.sum(np.abs(motion.twists[:, 0]) * np.diff(motion.times)))
    return "\n".join(
        (
            f"Recorded: a tricycle robot under motion capture, {motion.times[-1] - motion.times[0]:.1f} s, "
            f"{len(motion.times)} poses, {way:.2f} m",
            "(OptiOdom data set by Sousa, Petry, Moreira and Costa, MIT licence).",
            f"Its poses are smoothed by local quadratics over {SMOOTHING:g} s. The recorded frame is",
            f"turned by {math.degrees(yaw):.2f} degrees and {abs(1e3 * ahead):.1f} mm "
            f"{'ahead of' if ahead > 0 else 'behind'} the robot's axle: fitted, and taken out.",
            f"Below {1e3 * REST_SPEED:g} mm/s the robot turns on the spot or stands.",
        )
    )


def summary(result: DemoResult) -> dict[str, str]:
    """Cells of the main table by the names of their rows."""
    rover, deviation = result.rover, result.deviation
    joints = (result.steering, result.steering_rates, result.wheel_speeds)
    angles, rates, speeds = map(np.abs, joints)
    distance, turn = result.closing_error
    moving = np.any(result.asked != 0.0, axis=1)
    possible = np.asarray(rover.admissible(result.asked[moving]))
    slip = (result.asked - result.twists)[moving, 1]
    steered, fastest = rover.steered_wheel_names, math.degrees(rates.max())
    when = result.times[int(np.argmax(rates.max(axis=1)))]
    return {
        f"tightest turn held for {SUSTAINED:g} s": f"{result.tightest_radius:.3f} m",
        "  its half width asks for": f"{result.needed_radius:.3f} m",
        "  so the path is scaled by": f"{result.scale:.2f}",
        "driven, same time stamps": f"{result.length:.2f} m",
        "odometry off the drive by": f"{distance:.1e} m, {turn:.1e} rad",
        "drive off the recording by": f"{_share(float(np.sqrt(np.mean(deviation**2))), result.length)}, RMS",
        "  at most": _share(float(np.max(deviation)), result.length),
        "twists possible as they are": f"{int(np.sum(possible)):,} of {len(possible):,}",
        "sideways, taken out": f"{1e3 * float(np.sqrt(np.mean(slip**2))):.2f} mm/s RMS",
        "largest steering angle": f"{math.degrees(angles.max()):.1f}°, {_which(steered, angles)}",
        "fastest steering joint": f"{fastest:.0f}°/s, {_which(steered, rates)}, {when:.0f} s",
        "fastest wheel": f"{speeds.max():.2f} rad/s, {_which(rover.wheel_names, speeds)}",
    }


def _share(distance: float, length: float) -> str:
    return f"{1e3 * distance:.1f} mm, {100 * distance / length:.2f} %"


def _which(names: Sequence[str], values: Any) -> str:
    return names[int(np.argmax(np.max(values, axis=0)))]


def table(title: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> Any:
    """A rich table where rich is installed, else the same as text."""
    try:
        from rich import box
        from rich.table import Table
    except ImportError:
        return "\n".join(
            [title, *("  ".join(cell.replace("\n", " ") for cell in row) for row in (header, *rows))]
        )
    made = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE)
    for number, name in enumerate(header):
        made.add_column(name, style="" if number else "dim")
    for row in rows:
        made.add_row(*row)
    return made


def compare(title: str, names: Sequence[str], columns: Sequence[Mapping[str, str]]) -> Any:
    """A table with a column for each name, whose cells have the same names of rows."""
    rows = [[row, *(column[row] for column in columns)] for row in columns[0]]
    return table(title, ["", *names], rows)


def _colors(result: DemoResult) -> dict[str, dict[str, Any]]:
    axles = sorted({wheel.x for wheel in result.rover.wheels}, reverse=True)
    return {
        wheel.name: {
            "color": AXLE_COLORS[axles.index(wheel.x) % len(AXLE_COLORS)],
            "alpha": 1.0 if wheel.y > 0 else 0.6,
            "linewidth": 1.2,
            # Axles that do the same lie on each other: what is under a dashed line can be seen.
            "linestyle": "-" if axles.index(wheel.x) < len(axles) / 2 else (0, (4, 3)),
        }
        for wheel in result.rover.wheels
    }


def _shade_rests(axes: Axes, result: DemoResult) -> None:
    resting = ~np.any(result.twists != 0.0, axis=1)
    axes.fill_between(
        result.times[:-1],
        0,
        1,
        where=list(resting),
        transform=axes.get_xaxis_transform(),
        color=REST,
        lw=0,
        zorder=0,
    )
