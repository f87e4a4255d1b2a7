"""Dead reckoning, slow and obvious: one step at a time, derivatives by differences.

The pose after ``n`` samples is a function of all their readings. Its covariance to first order is
``J Q Jᵀ``, where ``J`` holds its derivatives by every reading of the log and ``Q`` their variances: no
recursion, nothing about which steps share a reading.
"""

import math
from dataclasses import dataclass

import numpy as np

from six_wheel.reference.planar.geometry import Floats, compose, exp
from six_wheel.reference.planar.rover import Rover

DIFFERENCE = 1e-5  # of a reading: derivatives err by its square, and by rounding over it


@dataclass(frozen=True)
class Noise:
    """Standard deviations of readings and slip; see `dead_reckon`."""

    speed: float = 0.01  # of a rim speed over one step [m/s]
    steering: float = 0.009  # of a steering angle [rad]
    slip: float = 0.0  # of a way along a wheel's heading, per root of the metres travelled [m per root m]
    side_slip: float = 0.0  # the same across it


def displacement(rover: Rover, before: Floats, after: Floats, rolled: Floats, slid: Floats) -> Floats:
    """Displacement in body axes whose exponential is the step, angles taken in its middle.

    `rolled` (wheels,) [m] is the way along the rim; `slid` (wheels,) [m] how far each contact slid left.
    A pivot whose wheel steers by ``d`` goes along an arc, whose chord is ``sin(d/2) / (d/2)`` of its length.
    """
    turned = after - before
    a, b = rover.equations((before + after) / 2.0, rolled, turned)
    b[[wheel.steered for wheel in rover.wheels]] *= np.sinc(turned / math.tau)[:, None]
    for i, wheel in enumerate(rover.wheels):
        # Rollers turn away a part of what slides across them, and pass the rest on along the wheel.
        if wheel.roller_angle is None:
            b[i, 1] += slid[i]
        else:
            b[i, 0] += slid[i] / math.tan(wheel.roller_angle)
    unread = np.isnan(b[:, 0])
    a[unread, 0] = b[unread, 0] = 0.0
    return np.asarray(np.linalg.lstsq(a.reshape(-1, 3), b.ravel(), rcond=1e-9)[0])


def dead_reckon(rover: Rover, steering: Floats, wheel_angles: Floats, start: Floats | None = None) -> Floats:
    """Poses (n, 3) from steering angles (n, steered) [rad] and running totals (n, wheels) [rad]."""
    ways = np.diff(wheel_angles, axis=0) * [wheel.radius for wheel in rover.wheels]
    return _poses(rover, steering, ways, np.zeros_like(ways), start)


def _poses(rover: Rover, steering: Floats, ways: Floats, slid: Floats, start: Floats | None = None) -> Floats:
    poses = [np.zeros(3) if start is None else np.asarray(start, dtype=float)]
    for k in range(len(ways)):
        step = exp(displacement(rover, steering[k], steering[k + 1], ways[k], slid[k]))
        poses.append(compose(poses[-1], step))
    return np.array(poses)


def covariance(rover: Rover, steering: Floats, wheel_angles: Floats, stamps: Floats, noise: Noise) -> Floats:
    """Covariance (3, 3) of the last pose, world axes, by differences over every reading of the log."""
    ways = np.diff(wheel_angles, axis=0) * [wheel.radius for wheel in rover.wheels]
    still = np.zeros_like(ways)

    pivots = np.array([(wheel.x, wheel.y) for wheel in rover.wheels])
    distances = np.empty_like(ways)
    for k in range(len(ways)):
        step = displacement(rover, steering[k], steering[k + 1], ways[k], still[k])
        velocity = step[:2] + step[2] * np.stack((-pivots[:, 1], pivots[:, 0]), axis=-1)
        distances[k] = np.hypot(*velocity.T)
    durations = np.diff(stamps)[:, None]
    variances = (
        (steering, np.full_like(steering, noise.steering**2)),
        (ways, (noise.speed * durations) ** 2 + noise.slip**2 * distances),
        (still, noise.side_slip**2 * distances),
    )
    total = np.zeros((3, 3))
    for which, (readings, variance) in enumerate(variances):
        for index in np.ndindex(readings.shape):
            ends = []
            for step_by in (DIFFERENCE, -DIFFERENCE):
                moved = [steering.copy(), ways.copy(), still.copy()]
                moved[which][index] += step_by
                ends.append(_poses(rover, *moved)[-1])
            derivative = (ends[0] - ends[1]) / (2.0 * DIFFERENCE)
            total += variance[index] * np.outer(derivative, derivative)
    return total
