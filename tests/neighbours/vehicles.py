"""Vehicles that the tests share, and a controller that gets the same command at 50 Hz."""

import math

import six_wheel as sw

CART = sw.Rover.differential(0.5, 0.1)
CAR = sw.Rover.ackermann(2.0, 1.2, 0.3, steering_limit=0.6)
BICYCLE = sw.Rover.bicycle(1.0, 0.2)
TRICYCLE = sw.Rover.tricycle(1.0, 0.8, 0.2)
SQUARE = [(0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)]
SWERVE = sw.Rover.swerve(SQUARE, 0.1, steering_limit=math.pi / 2)
MECANUM = sw.Rover.mecanum(0.3, 0.2, 0.1)
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
