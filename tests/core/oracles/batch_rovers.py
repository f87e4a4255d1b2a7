"""Rovers of the tests of batches."""

import math

import six_wheel as sw
from tests.rovers import CAR, CASTOR, CORNERS, MECANUM, SIX_SIZES, THREE_AXLES, TRICYCLE

ROVERS = {
    "perseverance": sw.Rover.preset("perseverance"),
    "limited": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.0),
    "wide": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=(-2.0, 2.5)),
    "swerve": sw.Rover.swerve(CORNERS, 0.1),
    "turning swerve": sw.Rover.swerve(CORNERS[:3], 0.1, steering_limit=math.pi),
    "ackermann": CAR,
    "tricycle": TRICYCLE,
    "differential": THREE_AXLES,
    "mecanum": MECANUM,
    "omni": sw.Rover.omni([(0.2, 0), (-0.1, 0.17), (-0.1, -0.17)], [1.57, 3.67, -0.52], 0.05),
    "castor": CASTOR,
    "turned": sw.Rover(
        [
            sw.Wheel("a", 0.5, 0.3, radius=0.1, steered=True, heading=0.7),
            sw.Wheel("b", -0.5, 0.0, radius=0.2, steered=True, heading=-2.0, steering_limit=(-0.4, 1.3)),
            sw.Wheel("c", 0.0, -0.3, radius=0.1),
        ]
    ),
    "scrub and trail": sw.Rover(
        [
            sw.Wheel("a", 0.5, 0.4, radius=0.1, steered=True, steering_limit=1.2, scrub=0.05, trail=0.02),
            sw.Wheel("b", 0.5, -0.4, radius=0.1, steered=True, heading=0.3, scrub=-0.05, trail=0.02),
            sw.Wheel("c", 0.0, 0.4, radius=0.1),
            sw.Wheel("d", 0.0, -0.4, radius=0.1),
        ]
    ),
}
