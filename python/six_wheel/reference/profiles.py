"""Profiles by plain integration: shapes of the velocity, summed up to a time."""

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
        for a, b in zip(cuts, cuts[1:], strict=False):
            ends = self.velocity(a) + self.velocity(b)
            parts.append((b - a) / 6 * (ends + 4 * self.velocity((a + b) / 2)))
        return self.start + math.fsum(parts)


def shape(kind: str, start: float, end: float, duration: float, ramp: float | None = None) -> Shape:
    """'linear', 'trapezoid' or 's_curve' from `start` to `end` in `duration` [s], ramps of `ramp` [s]."""
    if kind == "linear":
        ramp, rise = 0.0, lambda share: 1.0
    elif kind == "trapezoid":
        ramp, rise = duration / 3 if ramp is None else ramp, lambda share: share
    else:
        # Two parabolas that meet halfway: constant jerk up, then down.
        ramp = duration / 2 if ramp is None else ramp

        def rise(share: float) -> float:
            return 2 * share**2 if share < 0.5 else 1 - 2 * (1 - share) ** 2

    fastest = (end - start) / (duration - ramp)

    def velocity(time: float) -> float:
        to_end = min(time, duration - time)
        return fastest * (rise(to_end / ramp) if to_end < ramp else 1.0)

    return Shape(start, velocity, [ramp / 2, ramp, duration - ramp, duration - ramp / 2])
