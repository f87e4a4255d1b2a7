"""What `six-wheel check` says about a rover."""

import math
from typing import TYPE_CHECKING, Any

from six_wheel.cli.shared import Chosen

if TYPE_CHECKING:
    from pathlib import Path

    from six_wheel._core import Limits, Rover, Wheel
    from six_wheel.abilities import Bound

GROUPS = ("noise", "encoders", "steering_encoders", "odometry")


def wheels_table(chosen: Chosen) -> Any:
    """The wheels of a rover, a row each."""
    from rich.table import Table

    rover = chosen.rover
    table = Table(title=f"{chosen.name}: {len(rover.wheels)} wheels", title_justify="left")
    for heading in ("wheel", "x [m]", "y [m]", "radius [m]", "steering range"):
        table.add_column(heading, justify="right" if heading.endswith("[m]") else "left", overflow="fold")
    for wheel in rover.wheels:
        numbers = (f"{value:.4g}" for value in (wheel.x, wheel.y, wheel.radius))
        table.add_row(wheel.name, *numbers, _turning(wheel))
    return table


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


def _given(values: dict[str, Any]) -> str | None:
    """What a group of keys holds, in one line; None if nothing."""
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


def abilities(chosen: Chosen) -> list[tuple[str, object]]:
    """What a rover can do, as rows for `grid`."""
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
        rows[2:2] = within(chosen.rover, parameters.limits)
        limits = str(parameters.limits).removeprefix("Limits(").removesuffix(")").replace("=", " ")
        kind, controller = parameters.kind, parameters.controller
        rows += [
            ("kind", f"{kind}, as {controller} has it" if controller else kind),
            ("node", parameters.node),
            ("frames", f"{parameters.odom_frame_id} to {parameters.base_frame_id}"),
            ("limits", limits or None),
            *((group, _given(getattr(parameters, group))) for group in GROUPS),
        ]
    return rows


def within(rover: "Rover", limits: "Limits") -> list[tuple[str, object]]:
    """What a rover can do within limits, as rows for `grid`; nothing without any."""
    from six_wheel.abilities import bound, stop_from, time_to_full_lock

    rows: list[tuple[str, object]] = []
    ahead, about = bound(rover, limits, (1.0, 0.0, 0.0)), bound(rover, limits, (0.0, 0.0, 1.0))
    if ahead is not None:
        rows.append(("top speed", f"{ahead.twist[0]:.4g} m/s, bound by {_words(ahead)}"))
    if about is not None and about.twist[2] != 0.0:
        rows.append(("top yaw rate", f"{about.twist[2]:.4g} rad/s on the spot, bound by {_words(about)}"))
    lock = time_to_full_lock(rover, limits)
    if lock is not None:
        rows.append(("time to full lock", f"{lock:.4g} s"))
    stop = None if ahead is None else stop_from(rover, limits, ahead.twist)
    if stop is not None:
        rows.append(("stopping distance", f"{stop.distance:.4g} m in {stop.time:.3g} s from top speed"))
    return rows


def _words(bound: "Bound") -> str:
    """What keeps a motion from being faster."""
    return " and ".join(str(reason.name).lower().replace("_", " ") for reason in bound.reasons) or "steering"


def draw_limits(chosen: Chosen, plot: "Path") -> None:
    """Write the picture of the limits."""
    from six_wheel._core import Limits
    from six_wheel.logs.writing import replacing
    from six_wheel.plot.limits import limits_figure
    from six_wheel.plot.saving import picture_path, save

    limits = chosen.parameters.limits if chosen.parameters else Limits()
    with replacing(picture_path(plot), [chosen.path] if chosen.path else []) as picture:
        save(limits_figure(chosen.rover, limits, title=chosen.name), picture)
