"""Rovers of every kind of motion, and their twins in plain NumPy."""

import math

import numpy as np

import six_wheel as sw
from six_wheel import reference
from six_wheel.reference.control import planner as plain
from tests.rovers import CORNERS, LOW_SWERVE, SIX_SIZES, THREE_AXLES

RING = [math.radians(angle) for angle in (60.0, 180.0, 300.0)]
ROVERS = {
    "six wheels": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.2),
    "an island": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.3),
    "a quarter turn": sw.Rover.six_wheel(**SIX_SIZES),
    "one-sided": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=(-1.2, 0.6)),
    "wide": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=(-2.0, 2.5)),
    "perseverance": sw.Rover.preset("perseverance"),
    "ackermann": sw.Rover.ackermann(wheelbase=1.1, track_width=0.6, wheel_radius=0.15, steering_limit=0.6),
    "tricycle": sw.Rover.tricycle(wheelbase=0.9, track_width=0.6, wheel_radius=0.12),
    "swerve": LOW_SWERVE,
    "narrow swerve": sw.Rover.swerve(CORNERS, 0.08, steering_limit=0.9),
    "differential": THREE_AXLES,
    "mecanum": sw.Rover.mecanum(wheelbase=0.6, track_width=0.5, wheel_radius=0.1),
    "omni": sw.Rover.omni(
        [(0.3 * math.cos(a), 0.3 * math.sin(a)) for a in RING], [a + math.pi / 2 for a in RING], 0.06
    ),
    "sideways": sw.Rover([
        sw.Wheel("left", 0.1, 0.4, radius=0.1, heading=1.2),
        sw.Wheel("right", -0.2, -0.3, radius=0.1, heading=1.2),
        sw.Wheel("front", 0.5, 0.0, radius=0.1, heading=1.2, steered=True, scrub=0.05),
        sw.Wheel("castor", -0.5, 0.1, radius=0.05, castor=True, trail=0.04),
    ]),
}  # fmt: skip

LIMITS = {
    "speed": 1.0, "yaw_rate": 1.2, "acceleration": 2.0, "deceleration": 3.0, "angular_acceleration": 3.0,
    "lateral_acceleration": 0.6, "wheel_speed": 8.0, "wheel_acceleration": 40.0, "steering_rate": 1.5,
    "steering_acceleration": 8.0,
}  # fmt: skip


def twin(rover: sw.Rover, limits: dict[str, float], dt: float) -> plain.Drive:
    """The same rover in plain NumPy."""
    wheels = [
        reference.Wheel(
            wheel.name, wheel.x, wheel.y, radius=wheel.radius, steered=wheel.steered, heading=wheel.heading,
            steering_limit=wheel.steering_limit, scrub=wheel.scrub, trail=wheel.trail,
            roller_angle=wheel.roller_angle, driven=wheel.driven, castor=wheel.castor,
        )
        for wheel in rover.wheels
    ]  # fmt: skip
    return plain.Drive(reference.Rover(wheels), limits, dt)


def components(drive: plain.Drive, twists: np.ndarray) -> np.ndarray:
    """Twists as motions of a drive."""
    if len(drive.body) == 3:
        return twists
    return np.stack([twists @ drive.body[0], twists[..., 2]], axis=-1)
