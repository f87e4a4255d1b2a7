"""Driving a command table directly: the command of a row holds from its time to that of the next row."""

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.headers.columns import Unit
from six_wheel.logs.tables import Chunk
from six_wheel.simulation.drive.run_commands import Engine, by_row


class Drive(Engine):
    """A rover on its way through a table, doing at once what each row says.

    Arguments and attributes are those of `Engine`; without `keep` a twist that the rover cannot make is an
    error.
    """

    def __init__(self, rover: Rover, time_unit: Unit, keep: str | None = None) -> None:
        super().__init__(rover, time_unit, keep)
        ranges = [wheel.steering_range for wheel in rover.wheels if wheel.steered]
        ends = np.array([ends for ends in ranges if ends is not None]).reshape(-1, 2).T
        self._ends = np.clip(ends, -math.tau, math.tau)  # from either a joint without ends goes another way
        self._time: Any = None

    def blocks(self, chunk: Chunk) -> Iterator[list[Any]]:
        """The columns of the next rows."""
        yield self.advance(chunk)

    def end(self) -> Iterator[list[Any]]:
        """The columns of what comes after the last row: nothing."""
        return iter(())

    def advance(self, chunk: Chunk) -> list[NDArray[Any]]:
        """Drive through the next rows.

        Returns
        -------
        list of array
            One array (n,) for each of `units`.

        Raises
        ------
        RowError
            If the rover cannot make the twist of a row, or its pose would not be finite.
        """
        steering, speeds = self._invert(self._project(chunk), chunk.first_row)
        before = chunk.stamps[:0] if self._time is None else np.array([self._time])
        # Differences first, in the file's own numbers: 1.7e18 ns would lose 256 ns as a double.
        steps = np.diff(np.concatenate([before, chunk.stamps])) * self.time_unit.scale
        self._time = chunk.stamps[-1]
        return self.account(chunk.stamps, steps, steering, speeds)

    def _invert(self, twists: Floats, row: int) -> tuple[Floats, Floats]:
        """Steering angles and wheel speeds; the angles of a row are the `previous` ones of the next."""
        hint = "; --keep curvature drives the nearest twist that it can make"
        low, high = (np.broadcast_to(end, (len(twists), len(end))) for end in self._ends)
        steering, speeds = by_row(partial(self.rover.inverse, twists, previous=low), row, hint)
        # If the angle nearest to either end of the range is the same, there is only one, whatever was before.
        # The other rows (at rest, or with two angles to choose from) are asked one by one.
        open_rows = (steering != self.rover.inverse(twists, previous=high)[0]).any(axis=1)
        for k in np.flatnonzero(open_rows):
            previous = steering[k - 1] if k else self._steering
            steering[k], speeds[k] = self.rover.inverse(twists[k], previous=previous)
        return steering, speeds
