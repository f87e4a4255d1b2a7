"""Vehicles and logs of the odometry tests: what wheels would read along a motion."""

import math
from typing import NamedTuple

import numpy as np

import six_wheel as sw
from six_wheel import reference
from tests.rovers import PAIR, SIX_WHEELS, SMALL_SWERVE, SMALL_TRICYCLE


class WheelLog(NamedTuple):
    """A true motion and what is read along it."""

    rover: sw.Rover
    steering: np.ndarray  # (n, steered) [rad]
    angles: np.ndarray  # (n, wheels) [rad]
    stamps: np.ndarray  # (n,) [s]
    twists: np.ndarray  # (n - 1, 3), held over each step
    poses: np.ndarray  # (n, 3)


VEHICLES = {
    "six_wheel": SIX_WHEELS,
    "differential": PAIR,
    "tricycle": SMALL_TRICYCLE,
    "ackermann": sw.Rover.ackermann(0.8, 0.5, 0.12),
    "mecanum": sw.Rover.mecanum(0.6, 0.4, 0.05),
    "omni": sw.Rover.omni([(0.2, 0.0), (-0.1, 0.17), (-0.1, -0.17)], [math.pi / 2, -2.6, -0.5], 0.05),
    "swerve": SMALL_SWERVE,
    "offset": sw.Rover(
        [
            sw.Wheel("front", 0.5, 0.0, radius=0.1, steered=True, scrub=0.05),
            sw.Wheel("left", 0.0, 0.3, radius=0.12),
            sw.Wheel("right", 0.0, -0.3, radius=0.12),
        ]
    ),
}


def drive(rover: sw.Rover, n: int = 200, dt: float = 0.05, turning: float = 0.5) -> WheelLog:
    """Twists the rover can make, each held with its wheels already steered: exact for any odometry.

    Between two twists the wheels steer at rest, as a sample of their own.
    """
    stamps = np.arange(2 * n + 1) * dt
    t = stamps[1::2]
    wanted = np.stack((0.5 + 0.2 * np.sin(t), 0.2 * np.cos(0.7 * t), turning * np.cos(0.3 * t)), axis=-1)
    moving = rover.project(wanted)
    steering, speeds = np.empty((n, len(rover.steered_wheel_names))), np.empty((n, len(rover.wheels)))
    held = np.zeros(steering.shape[1])
    for k in range(n):
        steering[k], speeds[k] = rover.inverse(moving[k], previous=held)
        held = steering[k]
    twists = np.zeros((2 * n, 3))
    twists[1::2] = moving
    log_steering = np.empty((2 * n + 1, steering.shape[1]))
    log_steering[1::2], log_steering[2::2] = steering, steering
    log_steering[0] = steering[0]
    angles = np.zeros((2 * n + 1, speeds.shape[1]))
    # Steering at rest turns a wheel with scrub: rolling reads radius * speed + scrub * rate = 0.
    scrub = np.array([wheel.scrub / wheel.radius for wheel in rover.wheels if wheel.steered])
    joints = [i for i, wheel in enumerate(rover.wheels) if wheel.steered]
    for k in range(n):
        angles[2 * k + 1] = angles[2 * k]
        angles[2 * k + 1, joints] -= scrub * (log_steering[2 * k + 1] - log_steering[2 * k])
        angles[2 * k + 2] = angles[2 * k + 1] + speeds[k] * dt
    poses = np.asarray(reference.integrate(twists, dt))
    return WheelLog(rover, log_steering, angles, stamps, twists, poses)


def plain(rover: sw.Rover) -> reference.Rover:
    """The same rover in the reference."""
    names = ("x", "y", "radius", "steered", "heading", "scrub", "trail", "roller_angle", "castor", "driven")
    wheels = [{name: getattr(wheel, name) for name in names} for wheel in rover.wheels]
    return reference.Rover(
        [reference.Wheel(wheel.name, **numbers) for wheel, numbers in zip(rover.wheels, wheels, strict=True)]
    )


def follow(odometry: sw.Odometry, steering, angles, stamps, **others) -> sw.OdometryState:
    """The state after a log taken in sample by sample."""
    for k, stamp in enumerate(stamps):
        odometry.update(steering[k], angles[k], stamp, **{name: column[k] for name, column in others.items()})
    return odometry.state
