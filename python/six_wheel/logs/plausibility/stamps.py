"""Clocks: stamps whose steps are those of another unit than seconds."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.proposals import AS_READ, ImplausibleReadingError, stamp_unit
from six_wheel.robot_description.doubts import Proposal

# A second later than this (the year 5138) is a count of something shorter.
LATEST_SECOND = 1e11
LATEST_YEAR = 4.1e9  # [s] since 1970, in 2099
UNITS = (("ms", 1e3), ("us", 1e6), ("ns", 1e9))
LONG_UNITS = (("d", 86_400.0), ("h", 3600.0), ("min", 60.0))
PERIODS = (0.9e-3, 1.1)  # [s] between rows of a recording of 1 to 1,000 Hz
LONG_GAP = 1.0  # [s] in which rates tell nothing
LONG_GAP_OF_TOTALS = 3.0  # [s] in which a turn may have gone any way
EVEN = 0.8  # share of steps that are alike, of a clock that ticks evenly
MISSED = 1.6  # times the usual step, from which on rows are missing
SHORTEST = 0.9  # [s] between rows, from which on it is asked whether these are seconds
FASTEST_RIM = 10.0  # [m/s] of a rover with more than 1,000 rows a second
CREEPING = 4e-3  # [m/s] rim speed of a drive that is read too slow
DRIVING = (1e-3, 60.0)  # [m/s] rim speeds of a rover that drives
FAR_APART = 5.0  # [s] between rows, from which on a drive is hardly in them
SMOOTH = 2e-3  # of the fastest speed, by which speeds that are 1 s apart change at most
MANY = 1000  # rows for which that counts
FEW_ROWS = 20  # the order of so few tells nothing
DISORDER = 0.1  # share of steps back, from which on rows are in another order
ANEW = 50  # rows behind the time that was reached, from which on a clock started anew
STANDING = 0.5  # share of rows at the time of the row before, from which on it is said


def since_1970(first: float) -> tuple[str | Proposal, ...]:
    """The parts of the question for a stamp that is no second of these days."""
    unit = "ms" if abs(first) < 1e14 else "us" if abs(first) < 1e17 else "ns"
    if abs(first) / dict(UNITS)[unit] < LATEST_YEAR:
        return f"{unit} since 1970? Give ", stamp_unit(unit)
    such = "as 2026-11-23 12:59:59.95"
    said = f"say the unit with {stamp_unit('us').option}"
    return (f"a date and a time in one number? Write them {such}, or {said}",)


def check_origin(first: float, header: str, row: int) -> None:
    """Refuses seconds that no clock shows. Raises `ImplausibleReadingError` if the first stamp is not in
    seconds."""
    if not abs(first) > LATEST_SECOND:
        return
    got = f'got {first:.17g} in column "{header}"'
    rule = f"row {row}: time must be in seconds unless it is said that it is not, {got}"
    raise ImplausibleReadingError(f"{rule}: ", *since_1970(first))


def check_clock(stamps: Floats, speeds: Floats, rates: bool, header: str, row: int) -> None:
    """Refuses stamps (n,) that are taken for seconds and are a thousand times as many or more.

    `speeds` (m,) are rim speeds of the fastest wheel over stretches of these rows [m/s]; `rates` is True if
    the log has rates of wheels, which are right whatever the clock. Of the times there are their `header` and
    the number of the first `row`.
    """
    steps = np.diff(stamps)
    steps = steps[steps > 0.0]
    if len(steps) < 4:
        return
    period = float(np.median(steps))
    moving = np.abs(speeds[np.abs(speeds) > 0.0])
    if not len(moving):
        return
    pace = float(np.quantile(moving, 0.95))
    # Rows that come faster than recorders write them, and would not as times in minutes or more.
    long_units = [each for each in LONG_UNITS if PERIODS[0] <= period * each[1] <= PERIODS[1]]
    for symbol, by in long_units[:1] if period < PERIODS[0] else ():
        if rates or (pace > FASTEST_RIM and pace / by <= DRIVING[1]):
            what = f'column "{header}" gives rows {period:.2g} s apart from row {row} on'
            raise _in_unit(f"{what}, as times in {symbol} would", symbol)
    units = [(symbol, by) for symbol, by in UNITS if PERIODS[0] <= period / by <= PERIODS[1]]
    if period < SHORTEST or not units:
        return
    # The shortest unit that the period allows: 1,000 us are 1 ms, and 1 kHz is rarer than 1 Hz.
    symbol, _ = units[0]
    apart = period >= FAR_APART
    calm = len(moving) >= MANY and float(np.median(np.abs(np.diff(speeds)))) < SMOOTH * pace
    if not (apart or calm):
        return
    if rates:
        why = f"rows {period:g} s apart with wheels at up to {pace:.3g} m/s"
    else:
        if pace >= CREEPING or not any(DRIVING[0] <= pace * by <= DRIVING[1] for _, by in units):
            return
        symbol = next(s for s, by in units if DRIVING[0] <= pace * by <= DRIVING[1])
        why = f"rows {period:g} s apart and wheels no faster than {pace:.2g} m/s"
    what = f'column "{header}" gives {why} from row {row} on, as times in {symbol} would'
    raise _in_unit(what, symbol)


def _in_unit(what: str, symbol: str) -> ImplausibleReadingError:
    rest = f"; they are seconds with {stamp_unit('s').option}"
    return ImplausibleReadingError(f"{what}: give ", stamp_unit(symbol), rest)


def check_order(stamps: Floats, warn: Callable[[str], None], header: str) -> None:
    """Refuses rows that are not in the order of time, and warns of time that stands still in most of them.
    Raises `ImplausibleReadingError` if they run backwards too often for a fault of the clock."""
    if bool((stamps[1:] > stamps[:-1]).all()):
        return
    steps = np.diff(stamps)
    if line := out_of_order(stamps, header):
        raise ImplausibleReadingError(line)
    still = int(np.count_nonzero(steps == 0.0))
    if still > STANDING * len(steps):
        many = f'column "{header}" stands still in {still} of {len(steps) + 1} rows, which are left out'
        warn(f"{many}: are the times whole seconds, or 32 bit numbers of a large size?")


def gap_line(
    stamps: Floats, readings: Floats, kind: str, max_gap: float | None
) -> tuple[str, str, int] | None:
    """The first long time without rows while wheels turn, in words, and its row; None if there is none.

    Readings (n, wheels) are rates [rad/s] of the kind ``"speeds"``, or totals in any unit; `max_gap` is a
    time that is all right [s].
    """
    steps = np.diff(stamps)
    if not len(steps):
        return None
    usual = float(np.median(steps))
    usual = usual if usual <= 1.5 * LONG_GAP else 0.0
    least = LONG_GAP if kind == "speeds" else LONG_GAP_OF_TOTALS
    if kind != "speeds" and usual == 0.0:
        return None
    long = np.flatnonzero(steps > max(least, 10.0 * usual, max_gap or 0.0))
    if not len(long):
        return None
    rates = readings if kind == "speeds" else np.diff(readings, axis=0) / np.maximum(steps, 1e-9)[:, None]
    rates = np.abs(rates)
    fastest = float(np.nanquantile(rates.max(axis=1), 0.95)) if np.isfinite(rates).any() else 0.0
    for place in long.tolist():
        beside = rates[place : place + 2] if kind == "speeds" else rates[place : place + 1]
        turning = float(np.nanmax(beside, initial=0.0))
        if turning > 0.05 * fastest:
            if kind == "speeds":
                return f"{steps[place]:.3g} s without rates", f"wheels at {turning:.3g} rad/s", place + 1
            return f"{steps[place]:.3g} s without readings", "wheels that turn", place + 1
    return None


class LostIncrements:
    """Number of rows that are missing between others, by the stamps of a clock that ticks evenly."""

    def __init__(self) -> None:
        self.rows, self.first, self._all = 0.0, 0, 0

    def add(self, stamps: Floats, readings: Floats) -> None:
        """Take in consecutive rows: stamps (n,) and what was turned in each (n, wheels)."""
        steps = np.diff(stamps)
        later = steps[steps > 0.0]
        usual = float(np.median(later)) if len(later) > FEW_ROWS else 0.0
        even = usual > 0.0 and float(np.mean(np.abs(later - usual) < 0.2 * usual)) > EVEN
        reached = np.maximum.accumulate(stamps)
        wide = steps > MISSED * usual
        wide[1:] &= stamps[2:] - reached[:-2] > (1.0 + MISSED) * usual  # no time is told twice before it
        for k in np.flatnonzero(wide).tolist() if even else ():
            turned = np.abs(readings[max(0, k - 1) : k + 3]).max(axis=1, initial=0.0)
            if len(turned) < 3 or k == 0:
                continue
            beside, ratio = float(max(turned[1], turned[-1])), float(steps[k]) / usual
            # A row that has what was turned since the row before is as much longer as its time.
            if beside > 0.0 and turned[2] < beside * (1.0 + ratio) / 2.0:
                self.rows += round(ratio) - 1
                self.first = self.first or self._all + k + 1
        self._all += len(stamps)


def rows_behind(stamps: NDArray[Any], late: NDArray[np.int64], rows: NDArray[np.int64]) -> str:
    """The line about consecutive rows that a clock puts behind the time it had shown; empty for none.

    Parameters are those of `out_of_order`.
    """
    reached = np.maximum.accumulate(stamps)
    behind = late[stamps[late] < reached[late]]
    together = behind[:-1][np.diff(behind) == 1]
    if not len(together):
        return ""
    what = f"{len(behind)} rows from row {rows[together[0]]} on are behind the time that was reached"
    return f"{what} and are left out: a clock that was set? The path misses what wheels turned meanwhile"


def out_of_order(
    stamps: NDArray[Any],
    header: str,
    late: NDArray[np.int64] | None = None,
    rows: NDArray[np.int64] | None = None,
) -> str:
    """The line about rows that are not in the order of time; empty if they are, as far as a clock is.

    `stamps` are times of the rows, or of more; `late` are rows of these that are behind the time that was
    reached, `rows` the numbers of all.
    """
    steps = np.diff(stamps.astype(np.float64))
    back = float(np.count_nonzero(steps < 0.0))
    if len(steps) >= FEW_ROWS and back > DISORDER * len(steps):
        how = "from the last to the first" if back > (1.0 - DISORDER) * len(steps) else "in no order"
        return f'the rows are not in the order of time: column "{header}" goes {how}; sort the rows by it'
    if late is None or rows is None or not len(steps):
        return ""
    late = late[(late > 0) & (steps[np.maximum(late, 1) - 1] != 0.0)]
    if len(late) < ANEW or np.min(late[ANEW - 1 :] - late[: len(late) - ANEW + 1]) >= 2 * ANEW:
        return ""
    what = f"time goes back in row {rows[late[0]]} and stays behind what it was"
    guess = "a clock that started anew, or several logs in one file?"
    rest = f"{AS_READ} (plausibility=False) leaves out what is behind"
    return f"{what}: {guess} Make a file of each; {rest}"
