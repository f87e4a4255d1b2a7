"""A drive through a controller that measures its joints, one of which sticks."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from six_wheel._core import Controller, Limits, Rover
from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.poses import Floats
from six_wheel.simulation.controlled import Controlled
from six_wheel.simulation.course import Course
from six_wheel.simulation.planar import Motion, SlippingRover

PERIOD = 0.02  # [s] of a controller whose period is not given


@dataclass(frozen=True, slots=True)
class Stick:
    """A steering joint that stays where it is from a time on.

    Parameters
    ----------
    joint : str
        Name of the joint, or of its wheel.
    start : float
        Time since the first command [s].
    """

    joint: str
    start: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.start) and self.start >= 0.0):
            raise ValueError(f"start must be finite and not negative, got {self.start}")

    def column(self, rover: Rover) -> int:
        """Its place among the steered wheels.

        Raises
        ------
        ValueError
            If the rover has no such joint.
        """
        wheel = rover.steering_joints.get(self.joint, self.joint)
        if wheel not in rover.steered_wheel_names:
            known = ", ".join(rover.steering_joints) or "none"
            raise ValueError(f"stick must name a steering joint, {known}, got {self.joint!r}")
        return list(rover.steered_wheel_names).index(wheel)


def drive_stuck(
    slipping: SlippingRover,
    course: Course,
    stick: Stick,
    limits: Limits,
    control: Mapping[str, Any],
    *,
    step: float,
    start: Floats,
) -> tuple[Motion, Controlled]:
    """Simulate a rover under a `Controller` with one joint that sticks.

    In every step, at most so long [s], the controller is given the twist of the course and the measured
    angles of the joints.
    """
    rover, noise, random = slipping.rover, slipping.noise, slipping.random
    stuck = stick.column(rover)
    begin, end = course.stamps[0], course.stamps[-1]
    period = min(step, float(control.get("period", PERIOD)))
    stamps = np.linspace(begin, end, max(math.ceil((end - begin) / period), 1) + 1)
    controller = Controller(rover, limits, **{**control, "period": stamps[1] - stamps[0]})
    wanted = course.at(stamps)
    angles, actual = (np.zeros((len(stamps), len(rover.steered_wheel_names))) for _ in range(2))
    rates, speeds = np.zeros_like(angles), np.zeros((len(stamps), len(rover.wheels)))
    twists, reasons = np.zeros((len(stamps), 3)), np.zeros(len(stamps), np.uint32)
    measured = angles[0]
    found: dict[str, Any] = {}
    for row, now in enumerate((stamps - begin).tolist()):
        controller.command(tuple(wanted[row].tolist()), now)
        output = controller.step(now, measured)
        angles[row], rates[row], speeds[row] = output.steering, output.steering_rates, output.wheel_speeds
        twists[row], reasons[row] = output.twist, int(output.reasons)
        actual[row] = angles[row]
        if now >= stick.start and row:
            actual[row, stuck] = actual[row - 1, stuck]
        measured = actual[row] + noise.steering * random.standard_normal(len(actual[row]))
        if not found and output.reasons & Reason.JOINT_STUCK:
            assert output.worst_joint is not None
            assert output.joint_errors is not None
            wheel = rover.steering_joints[output.worst_joint]
            error = float(output.joint_errors[list(rover.steered_wheel_names).index(wheel)])
            found = {"joint": output.worst_joint, "found": now, "error": error}
    turning = (speeds[1:] + speeds[:-1]) / 2.0
    motion = slipping.follow_joints(stamps, actual, turning, start)
    values = np.hstack([wanted, twists, angles, rates, speeds])
    return motion, Controlled(limits, stamps - begin, values, reasons, **found)
