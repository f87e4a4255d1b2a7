"""What `six-wheel check` says about a rover."""

import math
from typing import TYPE_CHECKING, Any

from six_wheel._cli_shared import Chosen

if TYPE_CHECKING:
    from six_wheel._core import Wheel

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
