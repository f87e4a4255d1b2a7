"""Rovers of the tests of transitions."""

import math

import numpy as np

import six_wheel as sw
from tests.rovers import CAR, CART, CASTOR, CORNERS, LIMITED, MECANUM, SIX_SIZES, SIX_WHEELS, TRICYCLE

OSR = sw.Rover.preset("open_source_rover")
RATE = math.radians(60.0)
STRAIGHT, LEFT, RIGHT = (0.3, 0.0, 0.0), (0.3, 0.0, 0.5), (0.3, 0.0, -0.5)

ROVERS = {
    "six wheels": SIX_WHEELS,
    "limited": LIMITED,
    "wide": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=(-2.0, 2.5)),
    "swerve": sw.Rover.swerve(CORNERS, 0.1, steering_limit=math.pi / 2),
    "turning swerve": sw.Rover.swerve(CORNERS[:3], 0.1, steering_limit=math.pi),
    "ackermann": CAR,
    "tricycle": TRICYCLE,
    "mecanum": MECANUM,
    "differential": CART,
    "scrub": sw.Rover(
        [
            sw.Wheel(f"w{i}", *place, radius=0.1, steered=True, scrub=0.03 * (-1) ** i)
            for i, place in enumerate(CORNERS)
        ]
    ),
    "castor": CASTOR,
}


def largest(values: np.ndarray) -> float:
    return float(np.max(np.abs(values), initial=0.0))
