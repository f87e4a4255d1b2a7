"""Vehicles that the tests share, and a controller that gets the same command at 50 Hz."""

import math

import six_wheel as sw
from tests.rovers import CORNERS

BICYCLE = sw.Rover.bicycle(1.0, 0.2)
SWERVE = sw.Rover.swerve(CORNERS, 0.1, steering_limit=math.pi / 2)
MARS = sw.Rover.preset("perseverance")

Twist = tuple[float, float, float]


def drive(
    controller: sw.Controller, command: Twist, seconds: float, start: float = 0.0
) -> list[sw.ControllerOutput]:
    """Outputs of a controller that gets the same command at 50 Hz."""
    outs = []
    for k in range(round(seconds * 50)):
        now = start + k / 50.0
        controller.command(command, now)
        outs.append(controller.step(now))
    return outs
