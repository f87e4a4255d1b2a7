"""Profiles by plain integration: shapes of the velocity, summed up to a time."""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

__all__ = ["Shape", "shape"]


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
