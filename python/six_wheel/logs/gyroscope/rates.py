"""Mean yaw rates of a gyroscope at the rows of a log.

Readings have stamps of their own. Each holds from halfway since the one before to halfway to the next, and a
row gets their mean over its own such stretch: so no turn is lost between two rates, readings at the rows'
own stamps stay what they are, and the noise of one row is not that of another.
"""

import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping

import numpy as np

from six_wheel.kinematics.poses import Floats
from six_wheel.logs.headers.rate_columns import ABOUT_Z, AXES

LONGEST_GAP = 0.5  # [s] between two readings, across which nothing is known


def upward(roll: float, pitch: float) -> Floats:
    """The rover's z in the axes of a sensor that is turned by Ry(pitch) Rx(roll) in the body, shape (3,)."""
    sin, cos = math.sin, math.cos
    return np.array((-sin(pitch), cos(pitch) * sin(roll), cos(pitch) * cos(roll)))


def about_z(values: Mapping[str, Floats], up: Floats) -> Floats:
    """Rates about the rover's z (n,), of what was read about it or about the axes of a sensor.

    Raises `ValueError` if the sensor is tilted and an axis is missing.
    """
    if ABOUT_Z in values:
        return values[ABOUT_Z]
    total = np.zeros(len(values["rate z"]))
    for axis, share in zip(AXES, up.tolist(), strict=True):
        if f"rate {axis}" in values:
            total += share * values[f"rate {axis}"]
        elif abs(share) > 1e-9:
            rule = "gyroscope.roll and gyroscope.pitch need the rates about all axes"
            raise ValueError(f"{rule}, got none about {axis}")
    return total


class Turning:
    """Rates about the rover's z at the rows of a log, from readings with other stamps, as far as rows ask.

    `readings` are pieces of any length: stamps that increase [s], and rates [rad/s].
    """

    def __init__(self, readings: Iterator[tuple[Floats, Floats]]) -> None:
        self._readings = readings
        self._stamps, self._rates = np.empty(0), np.empty(0)
        self._ended = False

    def rates(self, edges: Floats) -> Floats:
        """Means between these times, (n + 1,) to (n,); NaN where readings lack for too long. What is before
        the last of them is forgotten."""
        while not self._ended and not (len(self._stamps) and self._stamps[-1] >= edges[-1]):
            if (piece := next(self._readings, None)) is None:
                self._ended = True
            else:
                self.add(*piece)
        if len(self._stamps) < 2:
            return np.full(len(edges) - 1, np.nan)
        stamps, rates = self._stamps, self._rates
        steps = np.diff(stamps)
        middles = stamps[:-1] + steps / 2.0
        # Until the middle the reading before holds, then the one behind.
        knots = np.empty(2 * len(stamps) - 1)
        knots[::2], knots[1::2] = stamps, middles
        turned = np.concatenate(([0.0], np.cumsum(np.diff(knots) * np.repeat(rates, 2)[1:-1])))
        lost = np.concatenate(([0], np.cumsum(steps > LONGEST_GAP)))
        step = np.searchsorted(stamps, edges, side="right") - 1
        inside = (edges >= stamps[0]) & (edges <= stamps[-1])
        step = np.clip(step, 0, len(steps) - 1)
        within = inside & (
            (steps[step] <= LONGEST_GAP) | (edges == stamps[step]) | (edges == stamps[step + 1])
        )
        part = np.where(edges == stamps[step + 1], lost[step + 1], lost[step])
        total = np.interp(edges, knots, turned)
        width = np.diff(edges)
        good = within[1:] & within[:-1] & (part[1:] == part[:-1]) & (width > 0.0)
        means: Floats = np.where(good, np.diff(total) / np.where(width > 0.0, width, 1.0), np.nan)
        keep = max(int(np.searchsorted(stamps, edges[-1], side="right")) - 2, 0)
        self._stamps, self._rates = stamps[keep:], rates[keep:]
        return means

    def add(self, stamps: Floats, rates: Floats) -> None:
        """More readings, behind those that are there."""
        self._stamps = np.concatenate((self._stamps, stamps))
        self._rates = np.concatenate((self._rates, rates))


class Passing:
    """`Turning` for one stretch after the other, as readings come: the same sums in the same order, but no
    arrays, which cost more than sums of so few readings."""

    def __init__(self) -> None:
        self._stamps: list[float] = []
        self._rates: list[float] = []

    def add(self, stamp: float, rate: float) -> None:
        """Add a reading, later than those that are there."""
        self._stamps.append(stamp)
        self._rates.append(rate)

    def rate(self, start: float, end: float) -> float:
        """As `Turning.rates` of two edges."""
        stamps = self._stamps
        if len(stamps) < 2:
            return math.nan
        behind = bisect_right(stamps, end)
        mean = math.nan
        if start < end and stamps[0] <= start and end <= stamps[-1]:
            first, last = bisect_right(stamps, start) - 1, min(behind, len(stamps) - 1) - 1
            # Between readings; an end at a reading is in none of the steps that begin there.
            steps = range(first, last + (stamps[last] < end))
            if all(stamps[k + 1] - stamps[k] <= LONGEST_GAP for k in steps):
                before = self._turned(0, first, 0.0)
                begun, ended = self._within(first, start, before), self._turned(first, last, before)
                mean = (self._within(last, end, ended) - begun) / (end - start)
        keep = max(behind - 2, 0)
        del stamps[:keep], self._rates[:keep]
        return mean

    def _turned(self, first: int, last: int, total: float) -> float:
        """Angle [rad] at reading `last`, from `total` at reading `first`: each rate holds to halfway."""
        stamps, rates = self._stamps, self._rates
        for k in range(first, last):
            before, behind = stamps[k], stamps[k + 1]
            middle = before + (behind - before) / 2.0
            total += (middle - before) * rates[k]
            total += (behind - middle) * rates[k + 1]
        return total

    def _within(self, step: int, time: float, total: float) -> float:
        """Angle [rad] at a time within a step that begins at angle `total`, as `numpy.interp` has it."""
        begin, end = self._stamps[step], self._stamps[step + 1]
        middle = begin + (end - begin) / 2.0
        after = total + (middle - begin) * self._rates[step]
        if time >= middle:
            begin, middle, total = middle, end, after
            after = total + (end - begin) * self._rates[step + 1]
            if time == end:
                return after
        return (after - total) / (middle - begin) * (time - begin) + total


def edges_of(stamps: Floats, before: float | None, after: float | None) -> Floats:
    """Halfway between rows (n + 1,); the first and the last row of a log end at themselves."""
    first = stamps[0] if before is None else (before + stamps[0]) / 2.0
    last = stamps[-1] if after is None else (stamps[-1] + after) / 2.0
    return np.concatenate(([first], stamps[:-1] + np.diff(stamps) / 2.0, [last]))
