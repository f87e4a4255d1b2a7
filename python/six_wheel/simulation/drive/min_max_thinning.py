"""Values over time in bounded memory, no peak lost: the lowest and the highest of every stretch of time."""

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats

BINS = 2000  # twice as many at most; a picture is not wider


class Course:
    """Lowest and highest of the values of a row, so many `columns`, and all reasons, of stretches of at most
    `stride` rows."""

    def __init__(self, columns: int) -> None:
        self.stride = 1
        self._low = self._high = np.empty((0, columns))
        self._times = np.empty(0)
        self._reasons = np.empty(0, np.uint32)
        self._rest: tuple[Floats, Floats, NDArray[np.uint32]] = (
            np.empty(0),
            np.empty((0, columns)),
            np.empty(0, np.uint32),
        )

    def add(self, times: Floats, values: Floats, reasons: NDArray[np.uint32]) -> None:
        """Take in rows: times (n,) [s], values (n, columns), reasons (n,)."""
        rest = self._rest
        times, values = np.concatenate([rest[0], times]), np.concatenate([rest[1], values])
        reasons = np.concatenate([rest[2], reasons])
        whole = len(times) - len(times) % self.stride
        starts = np.arange(0, whole, self.stride)
        if whole:
            self._times = np.concatenate([self._times, times[starts]])
            self._low = np.concatenate([self._low, np.minimum.reduceat(values[:whole], starts)])
            self._high = np.concatenate([self._high, np.maximum.reduceat(values[:whole], starts)])
            found = np.bitwise_or.reduceat(reasons[:whole], starts)
            self._reasons = np.concatenate([self._reasons, found])
        # Copies: a view would keep all of the rows.
        self._rest = times[whole:].copy(), values[whole:].copy(), reasons[whole:].copy()
        while len(self._times) >= 2 * BINS:
            self._halve()

    def _halve(self) -> None:
        """Join neighbours; an odd last one stays alone."""
        starts = np.arange(0, len(self._times), 2)
        self._times = self._times[starts]
        self._low = np.minimum.reduceat(self._low, starts)
        self._high = np.maximum.reduceat(self._high, starts)
        self._reasons = np.bitwise_or.reduceat(self._reasons, starts)
        self.stride *= 2

    def stretches(self) -> tuple[Floats, Floats, Floats, NDArray[np.uint32]]:
        """Begin (m,) [s], lowest and highest values (m, columns) and reasons (m,) of the stretches so far."""
        times, values, reasons = self._rest
        if not len(times):
            return self._times, self._low, self._high, self._reasons
        return (
            np.append(self._times, times[0]),
            np.vstack([self._low, values.min(axis=0)]),
            np.vstack([self._high, values.max(axis=0)]),
            np.append(self._reasons, np.bitwise_or.reduce(reasons)),
        )
