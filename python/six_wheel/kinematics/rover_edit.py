"""A rover with other numbers in its wheels: everything else stays as it was."""

from collections.abc import Iterable
from typing import Any

from six_wheel._core import Rover, Wheel, without_questions


def with_wheels(rover: Rover, changes: Iterable[dict[str, Any]]) -> Rover:
    """The rover whose wheel i has the values of the i-th dictionary, under the names `Wheel` gives them.

    Raises
    ------
    ValueError
        If a wheel may not have such a value.
    """
    steering, traction = joints_as_given(rover)

    def made() -> Rover:
        wheels = [_with(wheel, **change) for wheel, change in zip(rover.wheels, changes, strict=True)]
        return Rover(
            wheels,
            traction_joints=traction,
            steering_joints=steering,
            reversed_joints=rover.reversed_joints,
            # Wheels that are elsewhere do not stand on what the file said.
            suspension=rover.suspension if tuple(wheels) == rover.wheels else None,
        )

    return without_questions(made)  # which were asked of the rover itself


def _with(wheel: Wheel, **changes: Any) -> Wheel:
    values: dict[str, Any] = {
        "x": wheel.x,
        "y": wheel.y,
        "radius": wheel.radius,
        "steered": wheel.steered,
        "heading": wheel.heading,
        "steering_limit": wheel.steering_limit,
        "scrub": wheel.scrub,
        "trail": wheel.trail,
        "roller_angle": wheel.roller_angle,
        "driven": wheel.driven,
        "castor": wheel.castor,
    }
    values |= changes
    return Wheel(wheel.name, values.pop("x"), values.pop("y"), **values)


def joints_as_given(rover: Rover) -> tuple[dict[str, str], dict[str, str]]:
    """Steering and traction joints to their wheels, in the order in which they were given."""
    steering, traction = rover.steering_joints, rover.traction_joints
    order = rover.command_joints
    return (
        {joint: steering[joint] for joint in order if joint in steering},
        {joint: traction[joint] for joint in order if joint in traction},
    )
