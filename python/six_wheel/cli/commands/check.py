"""`six-wheel check`: every mistake in a file at once, then what the rover is and can do."""

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from six_wheel.cli.shared import (
    Reading,
    RoverArgument,
    choose,
    grid,
    new_console,
    text_table,
)
from six_wheel.robot_description.named_rover import NamedRover

if TYPE_CHECKING:
    from six_wheel._core import Limits, Rover, Wheel
    from six_wheel.robot_description.urdf import Robot
    from six_wheel.simulation.drive.performance import Bound

GROUPS = ("wheel_encoders", "steering_encoders", "odometry", "gyroscope", "truth")
GUESSED = (
    "that of a typical rover, slip of {slip:g} m per root m both ways; `six-wheel calibrate` measures it"
)


def check(
    rover: RoverArgument,
    *,
    reading: Reading,
    plot: Annotated[
        Path | None,
        typer.Option(help="Picture of what the limits leave, and which one binds where: .png, .svg or .pdf."),
    ] = None,
) -> None:
    try:
        chosen = choose(rover, reading)
    except ValueError as error:
        findings = getattr(error, "findings", None)
        if not findings:
            raise
        print(*findings, sep="\n", file=sys.stderr)
        raise typer.Exit(2) from None
    console = new_console()
    if chosen.warnings:
        print(*chosen.warnings, sep="\n", file=sys.stderr)
    if plot is not None:
        from six_wheel.plotting.limits import limits_figure
        from six_wheel.plotting.saving import picture_path, save

        target = picture_path(plot)
        save(limits_figure(chosen.rover, chosen.limits, title=chosen.name), target)
    console.print(plan(chosen.rover))
    console.print(wheels_table(chosen))
    if chosen.robot is not None:
        console.print(derived_table(chosen.robot))
    console.print(grid([*abilities(chosen), ("picture", plot)]))


def wheels_table(chosen: NamedRover) -> Any:
    """The wheels of a rover, a row each."""
    wheels, lengths = chosen.rover.wheels, ("x [m]", "y [m]", "radius [m]")
    rows = [
        (wheel.name, *(f"{value:.4g}" for value in (wheel.x, wheel.y, wheel.radius)), _turning(wheel))
        for wheel in wheels
    ]
    title = f"{chosen.name}: {len(wheels)} wheels"
    heads = ("wheel", *lengths, "steering range")
    return text_table(heads, rows, right=lengths, title=title, title_justify="left")


def derived_table(robot: "Robot") -> Any:
    """Table of the values derived from a robot description and their sources, a row for each wheel."""
    rows = []
    for name, found in robot.wheels.items():
        steered = ("", "", "")
        if found.steering is not None:
            steered = (
                found.steering.name + (", reversed" if found.steering_reversed else ""),
                ", ".join(f"{value:.4g}" for value in found.pivot),
                f"{1e3 * found.scrub:.4g}, {1e3 * found.trail:.4g}",
            )
        rows.append(
            (name, found.joint.name + (", reversed" if found.reversed else ""), found.radius_from, *steered)
        )
    heads = ("wheel", "joint", "radius from", "steering joint", "pivot [m]", "scrub, trail [mm]")
    title = f"derived from the {len(robot.wheels)} wheels of {robot.name}"
    return text_table(heads, rows, title=title, title_justify="left")


PLAN = 17  # lines of the picture in the terminal
SIDEWAYS = 2.1  # characters are about so much higher than wide


def plan(rover: "Rover") -> str:
    """The rover from above, forward up, in characters: steered wheels, fixed ones, castors, the origin."""
    places = [(wheel.x, wheel.y) for wheel in rover.wheels]
    xs, ys = [x for x, _ in places] + [0.0], [y for _, y in places] + [0.0]
    middle = ((max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2)
    reach = max(max(xs) - min(xs), max(ys) - min(ys), 2 * max(wheel.radius for wheel in rover.wheels)) / 2
    half = PLAN // 2
    wide = round(half * SIDEWAYS)
    cells = [[" "] * (2 * wide + 1) for _ in range(PLAN)]

    def put(x: float, y: float, sign: str) -> None:
        row, column = round(half * (1 - (x - middle[0]) / reach)), round(wide * (1 - (y - middle[1]) / reach))
        if 0 <= row < PLAN and 0 <= column <= 2 * wide:
            cells[row][column] = sign

    put(0.0, 0.0, "+")
    for wheel, (x, y) in zip(rover.wheels, places, strict=True):
        put(x, y, "o" if wheel.castor else "X" if wheel.roller_angle else "S" if wheel.steered else "#")
    rows = ["".join(row).rstrip() for row in cells]
    while rows and not rows[0]:
        rows.pop(0)
    while rows and not rows[-1]:
        rows.pop()
    marks = {"S": "steered", "#": "fixed", "X": "with rollers", "o": "castor", "+": "origin"}
    drawn = [f"{mark} {what}" for mark, what in marks.items() if any(mark in row for row in rows)]
    return "\n".join([*rows, f"forward is up, {2 * reach:.3g} m across: {', '.join(drawn)}"])


def _turning(wheel: "Wheel") -> str:
    """Steering range of a wheel, and everything else about it that is not the default."""
    ends = wheel.steering_range
    turns = "fixed" if ends is None else f"{math.degrees(ends[0]):.1f}° to {math.degrees(ends[1]):.1f}°"
    if ends is not None and math.isinf(ends[1]):
        turns = "endless"
    notes = {
        "swivels freely": wheel.castor,
        turns: not wheel.castor,
        f"heading {math.degrees(wheel.heading):.4g}°": wheel.heading != 0.0,
        f"trail {wheel.trail:.4g} m": wheel.trail != 0.0,
        f"scrub radius {wheel.scrub:.4g} m": wheel.scrub != 0.0,
        f"rollers at {math.degrees(wheel.roller_angle or 0.0):.4g}°": wheel.roller_angle is not None,
        "no motor": not wheel.driven and not wheel.castor,
    }
    return ", ".join(note for note, holds in notes.items() if holds)


def _joints(joints: dict[str, str]) -> str:
    """Joints in their order, each with its wheel unless its name says that."""
    return ", ".join(joint if wheel in joint else f"{joint} ({wheel})" for joint, wheel in joints.items())


def _given(values: dict[str, Any]) -> str | None:
    """Values of a group of keys, in one line; None if there are none."""
    return ", ".join(f"{name} {_written(value)}" for name, value in values.items()) or None


def _written(value: Any) -> str:
    """A value as a parameter file has it."""
    match value:
        case bool():
            return str(value).lower()
        case list():
            return f"[{', '.join(value)}]"
        case dict():
            return f"{{{_given(value)}}}"
    return f"{value:g}" if isinstance(value, float) else str(value)


def abilities(chosen: NamedRover) -> list[tuple[str, object]]:
    """Abilities of a rover, as rows for `grid`."""
    from six_wheel._core import Noise
    from six_wheel.robot_description.wheels_of_rover import joints_as_given
    from six_wheel.simulation.drive.performance import defaults

    rover, parameters = chosen.rover, chosen.parameters
    steering, traction = joints_as_given(rover)
    least, most = rover.min_radius, rover.spin_radius
    turns = "none: every radius is possible" if least == 0.0 else f"{least:.4g} m"
    spin = "not possible" if most == 0.0 else f"possible, with the centre up to {most:.4g} m from the middle"
    rows: list[tuple[str, object]] = [
        ("minimum radius", "cannot turn" if math.isinf(least) else turns),
        ("spin in place", "possible" if math.isinf(most) else spin),
        ("steering joints", _joints(steering) or "none"),
        ("traction joints", _joints(traction) or "none"),
    ]
    if rover.reversed_joints:
        rows.append(("reversed joints", ", ".join(rover.reversed_joints)))
    if chosen.robot is not None:
        rows += _described(chosen.robot)
    rows[2:2] = within(chosen.rover, chosen.limits)
    if parameters:
        filled = [
            f"{name} {value:.4g} ({SOURCES[name]})"
            for name, value in defaults(rover, parameters.limits).items()
        ]
        kind, controller = parameters.kind, parameters.controller
        rows += [
            ("kind", f"{kind}, as {controller} has it" if controller else kind),
            ("node", parameters.node),
            ("frames", f"{parameters.odom_frame_id} to {parameters.base_frame_id}"),
            ("limits", _in_words(parameters.limits)),
            ("limits by default", ", ".join(filled) or None),
            ("noise", _given(parameters.noise) or GUESSED.format(slip=Noise().slip)),
            *((group, _given(getattr(parameters, group))) for group in GROUPS),
        ]
    return rows


def _in_words(limits: "Limits") -> str | None:
    """The limits that were given; None if there are none."""
    return str(limits).removeprefix("Limits(").removesuffix(")").replace("=", " ") or None


def _described(robot: "Robot") -> list[tuple[str, object]]:
    """Properties in a robot description beside the wheels, as rows for `grid`."""
    found = robot.suspension
    joints = "" if found is None else ", ".join(f"{what} {joint}" for what, joint in found.joints.items())
    model = "none" if found is None else f"rocker-bogie: {joints}"
    rates = ("rates of joints", _in_words(robot.limits))
    return [("base frame", robot.base_frame_id), ("suspension", model), rates]


def within(rover: "Rover", limits: "Limits") -> list[tuple[str, object]]:
    """Performance of a rover within limits, as rows for `grid`; no rows without limits."""
    from six_wheel.simulation.drive.performance import bound, halt_from, stop_from, time_to_full_lock

    rows: list[tuple[str, object]] = []
    if limits == type(limits)():
        return rows
    ahead, about = bound(rover, limits, (1.0, 0.0, 0.0)), bound(rover, limits, (0.0, 0.0, 1.0))
    if ahead is not None:
        rows.append(("top speed", f"{ahead.twist[0]:.4g} m/s, bound by {_words(ahead)}"))
    if about is not None and about.twist[2] != 0.0:
        rows.append(("top yaw rate", f"{about.twist[2]:.4g} rad/s on the spot, bound by {_words(about)}"))
    lock = time_to_full_lock(rover, limits)
    if lock is not None:
        rows.append(("time to full lock", f"{lock:.4g} s"))
    for name, come_to_rest in (("stopping distance", stop_from), ("halt distance", halt_from)):
        stop = None if ahead is None else come_to_rest(rover, limits, ahead.twist)
        if stop is not None:
            rows.append((name, f"{stop.distance:.4g} m in {stop.time:.3g} s from top speed"))
    return rows


SOURCES = {
    "acceleration": "friction of 1",
    "deceleration": "as acceleration",
    "angular_acceleration": "acceleration at the farthest wheel",
    "angular_deceleration": "as the acceleration",
    "angular_jerk": "jerk at the farthest wheel",
    "steering_rate": "1.2 rad in a step of 0.1 s",
    "halt_deceleration": "as deceleration",
}
"""Sources of the defaults of the limits, by name."""


def _words(bound: "Bound") -> str:
    """Names of the limits that keep a motion from being faster."""
    return " and ".join(str(reason.name).lower().replace("_", " ") for reason in bound.reasons) or "steering"
