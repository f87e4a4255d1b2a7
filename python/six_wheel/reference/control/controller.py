"""Limits along the motion, the slow way: ratios from the wheels, searches by halving, a log audited.

`saturated` slows a twist down along its curvature. `ramp` moves a speed towards its goal under limits of
its rate and of the change of that, found by halving the peak of the rate. `Stepper` goes from motion to
motion under first-order limits by trying how far it can. `excess` holds a log against every limit.
"""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.planar.geometry import Floats
from six_wheel.reference.planar.rover import Rover

HALVINGS = 200


def _ratios(rover: Rover, limits: Any, twist: Floats) -> Iterator[tuple[str, float]]:
    """Ratio of the twist to each limit of speed; above 1 it is too fast."""
    vx, vy, omega = twist
    speed = math.hypot(vx, vy)
    yield "SPEED", speed / limits.speed
    yield "YAW_RATE", abs(omega) / limits.yaw_rate
    # It falls with the square of the scale.
    yield "LATERAL_ACCELERATION", math.sqrt(speed * abs(omega) / limits.lateral_acceleration)
    _, wheel_speeds = rover.inverse(twist)
    yield "WHEEL_SPEED", float(np.max(np.abs(wheel_speeds))) / limits.wheel_speed


def saturated(rover: Rover, limits: Any, twist: ArrayLike) -> tuple[Floats, str | None]:
    """The nearest possible twist (3,), slowed down by the largest ratio; and the limit behind that."""
    possible = rover.project(twist)
    name, ratio = max(_ratios(rover, limits, possible), key=lambda pair: pair[1])
    return (possible / ratio, name) if ratio > 1.0 else (possible, None)


def ramp(
    value: float, rate: float, goal: float, rates: tuple[float, float], change: float, dt: float
) -> tuple[float, float]:
    """A value and its rate `dt` later, on the quickest way to rest at a goal.

    The rate stays within ``(-rates[0], rates[1])``, where it starts, and changes by `change` per second.
    """
    rest = value + rate * abs(rate) / (2 * change)  # by braking at once
    if rest == goal and rate == 0.0:
        return goal, 0.0
    upwards = goal > rest or (goal == rest and rate > 0.0)
    sign = 1.0 if upwards else -1.0
    start, limit = sign * rate, rates[1] if upwards else rates[0]

    def phases(peak: float, cruise: float) -> list[tuple[float, float]]:
        """Durations and changes of the rate."""
        return [((peak - start) / change, change), (cruise, 0.0), (peak / change, -change)]

    def end(peak: float, cruise: float, time: float = math.inf) -> tuple[float, float]:
        x, v = sign * value, start
        for duration, slope in phases(peak, cruise):
            t = min(duration, time)
            x, v, time = x + v * t + slope * t * t / 2, v + slope * t, time - t
        return x, v

    low, high = max(start, 0.0), limit
    cruise = 0.0
    if end(limit, 0.0)[0] <= sign * goal:
        cruise = (sign * goal - end(limit, 0.0)[0]) / limit
        peak = limit
    else:
        for _ in range(HALVINGS):
            peak = (low + high) / 2
            low, high = (peak, high) if end(peak, 0.0)[0] < sign * goal else (low, peak)
        peak = low
    if dt >= sum(duration for duration, _ in phases(peak, cruise)):
        return goal, 0.0
    x, v = end(peak, cruise, dt)
    return sign * x, sign * v


@dataclass
class Stepper:
    """From motion to motion under first-order limits, as far as they allow each step.

    A step goes along the straight line from twist to goal as far as body, wheels and joints can follow.
    """

    rover: Rover
    limits: Any
    twist: Floats
    steering: Floats
    wheel_speeds: Floats

    def step(self, goal: ArrayLike, dt: float) -> None:
        """Move on by `dt` towards a goal that the rover can reach by turning its wheels."""
        wanted = np.asarray(goal, dtype=float)
        share = _largest(lambda share: self._allowed(self.twist + share * (wanted - self.twist), dt))
        self.twist = self.twist + share * (wanted - self.twist)
        self.steering, self.wheel_speeds = self.rover.inverse(self.twist, previous=self.steering)

    def _allowed(self, twist: Floats, dt: float) -> bool:
        steering, wheel_speeds = self.rover.inverse(twist, previous=self.steering)
        step = [
            Shot(0.0, self.twist, self.steering, self.wheel_speeds),
            Shot(dt, twist, steering, wheel_speeds),
        ]
        return max(excess(self.limits, step).values(), default=0.0) <= 1.0


def _largest(allowed: Any) -> float:
    """The largest share in [0, 1] up to which something is allowed."""
    if allowed(1.0):
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if allowed(middle) else (low, middle)
    return low


@dataclass(frozen=True)
class Shot:
    """One step of a log: when [s], and what was commanded."""

    time: float
    twist: Floats
    steering: Floats
    wheel_speeds: Floats


def excess(limits: Any, log: Sequence[Shot]) -> dict[str, float]:
    """Largest share of each limit that a log uses: 1 is all of it.

    Rates and their changes are divided differences, so that steps may be of any length.
    """
    time = np.array([shot.time for shot in log])
    twist = np.array([shot.twist for shot in log])
    steering = np.array([shot.steering for shot in log]).reshape(len(log), -1)
    wheel_speeds = np.array([shot.wheel_speeds for shot in log])
    linear = np.hypot(twist[:, 0], twist[:, 1])

    def slope(values: Floats, times: Floats) -> tuple[Floats, Floats]:
        rates = np.diff(values, axis=0) / np.diff(times)[:, None]
        return rates, (times[1:] + times[:-1]) / 2

    def largest(values: Floats) -> float:
        return float(np.max(np.linalg.norm(values, axis=1), initial=0.0))

    acceleration, middle = slope(twist, time)
    jerk, _ = slope(acceleration, middle)
    rate, middle = slope(steering, time)
    curve, _ = slope(rate, middle)
    used = {
        "speed": float(np.max(linear)),
        "yaw_rate": float(np.max(np.abs(twist[:, 2]))),
        "lateral_acceleration": float(np.max(linear * np.abs(twist[:, 2]))),
        "wheel_speed": float(np.max(np.abs(wheel_speeds))),
        "wheel_acceleration": float(np.max(np.abs(slope(wheel_speeds, time)[0]), initial=0.0)),
        "jerk": largest(jerk[:, :2]),
        "angular_jerk": largest(jerk[:, 2:]),
        "steering_rate": float(np.max(np.abs(rate), initial=0.0)),
        "steering_acceleration": float(np.max(np.abs(curve), initial=0.0)),
    }
    shares = {name: value / getattr(limits, name) for name, value in used.items()}
    # Speeding up and slowing down apart, unless the direction changes at the same time.
    turned = np.any(np.diff(steering, axis=0) != 0, axis=1)
    for name, speed, part in (
        ("", linear, acceleration[:, :2]),
        ("angular_", np.abs(twist[:, 2]), acceleration[:, 2:]),
    ):
        size = np.linalg.norm(part, axis=1)
        up, down = getattr(limits, f"{name}acceleration"), getattr(limits, f"{name}deceleration")
        bound = np.where(turned, max(up, down), np.where(np.diff(speed) > 0, up, down))
        shares[f"{name}acceleration"] = float(np.max(size / bound, initial=0.0))
    return shares
