"""Joint readings that wait for the gyroscope.

Each gets what a row of a log gets (`six_wheel.logs.gyroscope.rates`): the mean from halfway since the
readings before to halfway to the next. So they wait for the next ones, and odometry is that far behind the
wheels; what the gyroscope does not say in time they do without.
"""

import math
import statistics
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from six_wheel.control_loop.clock import SECOND
from six_wheel.control_loop.joints import Readings
from six_wheel.logs.gyroscope.rates import Passing, upward

FIRST_LOOK = SECOND // 10  # [ns] over which the interval of joint readings is measured
MOST = 1 << 14  # readings of a gyroscope that are kept for wheels that are silent


class Row(NamedTuple):
    """Joint readings of time `stamp`, and the time of their arrival [ns]."""

    readings: Readings
    stamp: int
    came: int


class Rows:
    """The joint readings that odometry has not counted yet; `keys` are those of ``gyroscope`` in a parameter
    file.

    `apart` is the time between joint readings, as they came at the start [s], None until that is known;
    `came` is when the gyroscope spoke last [ns].
    """

    def __init__(self, keys: Mapping[str, Any]) -> None:
        self._scale = keys.get("scale", 1.0)
        self._offset = round(keys.get("time_offset", 0.0) * SECOND)
        self._seated = not keys.keys().isdisjoint({"roll", "pitch"})  # the file has the last word
        self._up: list[float] = upward(*(keys.get(turn, 0.0) for turn in ("roll", "pitch"))).tolist()
        self.apart: float | None = None
        self.forget()

    def forget(self) -> None:
        """Nothing has come yet."""
        self._rows: deque[Row] = deque()
        self._heard: deque[tuple[int, float]] = deque(maxlen=MOST)
        self._passing = Passing()
        self._origin: int | None = None  # doubles hold seconds, not nanoseconds since 1970
        self._last: int | None = None
        self._before: int | None = None
        self.came: int | None = None

    def mount(self, up: Sequence[float]) -> None:
        """The rover's z in the axes of the sensor, unless the file tells how that sits."""
        if not self._seated:
            self._up = list(up)

    def add_rates(self, rates: Sequence[float], stamp: int, now: int) -> bool:
        """Add a reading about the axes of the sensor [rad/s] that came at `now` [ns]; True if it is valid."""
        stamp -= self._offset
        rate = self._scale * sum(share * each for share, each in zip(self._up, rates, strict=True))
        if not math.isfinite(rate) or (self._last is not None and stamp <= self._last):
            return False
        self._last, self.came = stamp, now
        self._heard.append((stamp, rate))
        return True

    @property
    def newest(self) -> int | None:
        """The stamp of the last joint readings [ns]."""
        return self._rows[-1].stamp if self._rows else self._before

    def add(self, row: Row) -> None:
        """Joint readings, later than those before."""
        self._rows.append(row)

    def ready(self, now: int, patience: int) -> Iterator[tuple[Row, float | None]]:
        """Joint readings that wait no more, with what the gyroscope says [rad/s], None where it does not."""
        if self.apart is None and not self._look():
            return
        silent = self.came is None or now - self.came > patience
        while len(self._rows) > 1:
            row, behind = self._rows[0], self._rows[1]
            told = self._last is not None and 2 * self._last > row.stamp + behind.stamp
            if not told and not silent and now - behind.came <= patience:
                return
            self._rows.popleft()
            rate = self._rate(row.stamp, behind.stamp) if told else None
            self._before = row.stamp
            yield row, rate

    def rest(self) -> Iterator[tuple[Row, float | None]]:
        """All the others, which wait for nothing more."""
        while self._rows:
            row = self._rows.popleft()
            self._before = row.stamp
            yield row, None

    def _look(self) -> bool:
        """Measure the median interval `apart` of joint readings [s]; True if there are enough for that."""
        if not self._rows or self._rows[-1].came - self._rows[0].came < FIRST_LOOK:
            return False
        self.apart = statistics.median(b.stamp - a.stamp for a, b in pairwise(self._rows)) / SECOND
        return True

    def _rate(self, stamp: int, behind: int) -> float | None:
        """About the rover's z, from halfway since the readings before to halfway to those behind."""
        if self._origin is None:
            self._origin = stamp
        origin, passing = self._origin, self._passing
        for heard, rate in self._heard:
            passing.add((heard - origin) / SECOND, rate)
        self._heard.clear()
        row = (stamp - origin) / SECOND
        start = row if self._before is None else ((self._before - origin) / SECOND + row) / 2.0
        mean = passing.rate(start, (row + (behind - origin) / SECOND) / 2.0)
        return mean if math.isfinite(mean) else None
