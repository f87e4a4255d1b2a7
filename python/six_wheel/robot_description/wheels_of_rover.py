"""Wheels of a rover: their joints, and a rover whose wheels have other values."""

from collections.abc import Iterable
from typing import Any

from six_wheel._core import Rover, without_questions


def joints_as_given(rover: Rover) -> tuple[dict[str, str], dict[str, str]]:
    """Steering and traction joints to their wheels, in the order in which they were given."""
    steering, traction = rover.steering_joints, rover.traction_joints
    order = rover.joint_names
    return (
        {joint: steering[joint] for joint in order if joint in steering},
        {joint: traction[joint] for joint in order if joint in traction},
    )


def joints_by_wheel(rover: Rover) -> tuple[dict[str, str], dict[str, str]]:
    """Wheels to their steering and to their traction joints."""
    return (
        {wheel: joint for joint, wheel in rover.steering_joints.items()},
        {wheel: joint for joint, wheel in rover.traction_joints.items()},
    )


def reading_joints(rover: Rover) -> tuple[list[str], list[float]]:
    """Joints of a row of readings, and their signs: those that steer, then that of every wheel.

    A wheel without a motor may report under its own name.
    """
    steering, traction = joints_by_wheel(rover)
    joints = [steering[wheel] for wheel in rover.steered_wheel_names]
    joints += [traction.get(wheel, wheel) for wheel in rover.wheel_names]
    return joints, [-1.0 if joint in rover.reversed_joints else 1.0 for joint in joints]


def with_wheels(rover: Rover, changes: Iterable[dict[str, Any]]) -> Rover:
    """The rover whose wheel i has the values of the i-th dictionary, under the names `Wheel` gives them.

    Raises `ValueError` if a wheel may not have such a value.
    """

    def made() -> Rover:
        pairs = zip(rover.wheels, changes, strict=True)
        return rover.replace(wheels=[wheel.replace(**change) for wheel, change in pairs])

    return without_questions(made)  # those of the rover itself were asked for
