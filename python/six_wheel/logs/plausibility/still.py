"""Wheels that stand still while others turn, and logs in which nothing turns."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.logs.plausibility.proposals import Column, columns

__all__ = ["WheelTurns"]

Floats = NDArray[np.float64]

ROWS = 50  # of a log in which a wheel does not move
TURN = 4.0 * math.pi  # [rad] that another one turns meanwhile
END = 16.0 * math.pi  # [rad] that another one turns after a wheel has moved for the last time
LITTLE = (1e-3, 2.0 * math.pi)  # [rad] that no wheel of a drive is within
TO_AND_FRO = 2.5  # times what it spans, that a rate goes up and down
LONG = 400, 20.0  # rows and [s] of a log for which that counts


@dataclass
class WheelTurns:
    """Rotation of the wheels in a log, by some of its rows as they come.

    Attributes
    ----------
    low, high : array, shape (wheels,)
        Least and largest totals [rad].
    stopped : array, shape (wheels, wheels)
        Totals of all wheels when each one moved last [rad].
    way : array, shape (wheels,)
        Sums of all turns, to and fro [rad].
    """

    low: Floats = field(default_factory=lambda: np.zeros(0))
    high: Floats = field(default_factory=lambda: np.zeros(0))
    stopped: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    way: Floats = field(default_factory=lambda: np.zeros(0))
    _last: Floats = field(default_factory=lambda: np.zeros(0))

    def add(self, turned: Floats) -> None:
        """Take in totals (n, wheels) [rad], NaN without a reading."""
        low, high = np.fmin.reduce(turned, axis=0), np.fmax.reduce(turned, axis=0)
        if not len(self._last):
            self.low, self.high = low, high
            self.stopped = np.tile(turned[0], (turned.shape[1], 1))
            self.way = np.zeros(turned.shape[1])
        self.low, self.high = np.fmin(self.low, low), np.fmax(self.high, high)
        steps = np.abs(np.diff(turned, axis=0))
        self.way += np.nan_to_num(steps).sum(axis=0)
        moves = steps > 0.0
        for wheel in np.flatnonzero(moves.any(axis=0)).tolist():
            self.stopped[wheel] = turned[len(moves) - int(np.argmax(moves[::-1, wheel]))]
        self._last = turned[-1]

    def doubts(
        self, rover: Rover, wheels: Sequence[Column], rows: int, duration: float, named: bool, totals: bool
    ) -> list[str]:
        """Lines about wheels that do not turn, or hardly; `totals` where angles are read."""
        moved = self.high - self.low
        heard = np.isfinite(moved)
        if rows < ROWS or not heard.any():
            return []
        fastest = int(np.argmax(np.where(heard, moved, -1.0)))
        if moved[fastest] == 0.0:
            return [f"no wheel turns in all {rows} rows"]
        little = LITTLE[0] < moved[fastest] < min(LITTLE[1], self.way[fastest] / TO_AND_FRO)
        if totals and little and rows >= LONG[0] and duration >= LONG[1]:
            most = f"no wheel turns by more than {moved[fastest]:.3g} rad in {duration:.3g} s"
            return [f"{most}: are these angles, and not rates or what was turned in each row?"]
        said = []
        for place, wheel in enumerate(rover.wheels):
            if not heard[place] or wheel.roller_angle:
                continue
            header, other = wheels[place].header, wheels[fastest].header
            since = np.nan_to_num(np.abs(self._last - self.stopped[place]))
            if moved[place] == 0.0 and moved[fastest] > TURN:
                what = f'"{header}" stands still in all {rows} rows while "{other}" turns'
                remedy = "is its encoder connected?"
                if named and heard.sum() > 2:
                    remedy += f" Without it: {columns({header: ''})}"
                said.append(f"{what} {moved[fastest]:.4g} rad: {remedy}")
            elif moved[place] > 0.0 and since.max() > END:
                other = wheels[int(np.argmax(since))].header
                what = f'"{header}" stands still from some row on while "{other}" turns {since.max():.4g} rad'
                said.append(f"{what}: does its encoder still count?")
        return said
