"""A path in bounded memory, for pictures."""

import numpy as np

from six_wheel.kinematics.poses import Floats

TRACE_ROWS = 20_000


class Trace:
    """Poses and steering angles of at most `TRACE_ROWS` rows, evenly spread, and of the last one."""

    def __init__(self) -> None:
        self._rows = np.empty((0, 0))
        self._last = np.empty((0, 0))
        self._stride, self._seen = 1, 0

    def add(self, poses: Floats, steering: Floats) -> None:
        """Take in the rows of one chunk."""
        rows = np.hstack([poses, steering])
        kept = rows[-self._seen % self._stride :: self._stride]
        self._rows = np.vstack([self._rows, kept]) if self._seen else kept
        self._seen += len(rows)
        self._last = rows[-1:]
        while len(self._rows) >= TRACE_ROWS:
            self._rows, self._stride = self._rows[::2], 2 * self._stride

    def path(self) -> tuple[Floats, Floats]:
        """Poses (n, 3) and steering angles (n, steered wheels) so far."""
        last = self._last[: (self._seen - 1) % self._stride > 0]
        rows = np.vstack([self._rows, last])
        return rows[:, :3], rows[:, 3:]
