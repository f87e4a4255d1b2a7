"""Profiles by plain integration, and transitions by following them step by step."""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from six_wheel.reference.planar.geometry import Floats
from six_wheel.reference.planar.rover import Rover


@dataclass(frozen=True)
class Shape:
    """A value that starts somewhere and moves with a velocity, which is smooth between `breaks` [s]."""

    start: float
    velocity: Callable[[float], float]
    breaks: Sequence[float]

    def value(self, time: float) -> float:
        """The velocity integrated by Simpson's rule, which is exact for the parabolas it is made of."""
        cuts = [0.0, *(b for b in self.breaks if 0.0 < b < time), time]
        parts = []
        for a, b in itertools.pairwise(cuts):
            ends = self.velocity(a) + self.velocity(b)
            parts.append((b - a) / 6 * (ends + 4 * self.velocity((a + b) / 2)))
        return self.start + math.fsum(parts)


def shape(kind: str, start: float, end: float, duration: float, ramp: float | None = None) -> Shape:
    """'linear', 'trapezoid' or 's_curve' from `start` to `end` in `duration` [s], ramps of `ramp` [s]."""
    if ramp is None:
        ramp = {"linear": 0.0, "trapezoid": duration / 3, "s_curve": duration / 2}[kind]

    def rise(share: float) -> float:
        if kind == "trapezoid":
            return share
        # Two parabolas that meet halfway: constant jerk up, then down.
        return 2 * share**2 if share < 0.5 else 1 - 2 * (1 - share) ** 2

    fastest = (end - start) / (duration - ramp)

    def velocity(time: float) -> float:
        to_end = min(time, duration - time)
        return fastest * (rise(to_end / ramp) if to_end < ramp else 1.0)

    return Shape(start, velocity, [ramp / 2, ramp, duration - ramp, duration - ramp / 2])


@dataclass(frozen=True)
class Strain:
    """The worst that a transition asks for, by differences of what it does at many instants."""

    steering_rate: float
    """[rad/s]"""
    steering_acceleration: float
    """[rad/s^2]"""
    wheel_speed: float
    """[rad/s]"""
    wheel_acceleration: float
    """[rad/s^2]"""
    acceleration: float
    """Of (vx, vy) [m/s^2]."""
    angular_acceleration: float
    """[rad/s^2]"""
    scrub: float
    """Largest sliding speed of a wheel under the twist that fits all wheels best [m/s]."""


def strain(
    rover: Rover, at: Callable[[float], Any], start: float, duration: float, steps: int = 200
) -> Strain:
    """Follow a transition through a time without stops and measure what it does.

    `at` gives `twist`, `steering`, `steering_rates` and `wheel_speeds` at a time [s], as transitions do.
    """
    step = duration / steps
    states = [at(start + k * step * (1 - 1e-12)) for k in range(steps + 1)]

    def change(values: list[Floats]) -> float:
        return max(float(np.max(np.abs(b - a), initial=0.0)) / step for a, b in itertools.pairwise(values))

    lengths = [math.hypot(*(b.twist - a.twist)[:2]) / step for a, b in itertools.pairwise(states)]
    residuals = [
        rover.fit(s.steering, s.wheel_speeds, steering_rates=s.steering_rates).residuals for s in states
    ]
    return Strain(
        steering_rate=change([state.steering for state in states]),
        steering_acceleration=change([state.steering_rates for state in states]),
        wheel_speed=max(float(np.max(np.abs(state.wheel_speeds))) for state in states),
        wheel_acceleration=change([state.wheel_speeds for state in states]),
        acceleration=max(lengths),
        angular_acceleration=change([state.twist[2:] for state in states]),
        scrub=max(float(np.max(residual)) for residual in residuals),
    )


def angle_scrub(rover: Rover, steering: Sequence[float], speed: float) -> float:
    """Side slip of the worst wheel [m/s] that angles [rad] force on a rover at a forward speed [m/s].

    Sideways speed and yaw rate are those with the least squares of all side slips: what is left is the fault
    of the angles alone, however well the wheels' speeds are chosen.
    """
    angles = {wheel.name: angle for wheel, angle in zip(rover.steered, steering, strict=True)}
    rows = np.array([wheel.rows(angles.get(wheel.name, 0.0))[1] for wheel in rover.wheels])
    rest = np.linalg.lstsq(rows[:, 1:], -rows[:, 0] * speed, rcond=None)[0]
    return float(np.max(np.abs(rows @ np.array([speed, *rest]))))
