"""Clocks: stamps whose steps are those of another unit than seconds."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.logs.plausibility.proposals import (
    ImplausibleReadingError,
    at_its_word,
    stamp_unit,
)

__all__ = ["check_clock", "check_order", "check_origin", "out_of_order", "unit_since_1970"]

Floats = NDArray[np.float64]

# A second later than this (the year 5138) is a count of something shorter.
LATEST_SECOND = 1e11
UNITS = (("ms", 1e3), ("us", 1e6), ("ns", 1e9))
PERIODS = (0.9e-3, 1.1)  # [s] between rows of a recording of 1 to 1,000 Hz
SHORTEST = 0.9  # [s] between rows, from which on it is asked whether these are seconds
CREEPING = 4e-3  # [m/s] rim speed of a drive that is read too slow
DRIVING = (1e-3, 60.0)  # [m/s] rim speeds of a rover that drives
FAR_APART = 5.0  # [s] between rows, from which on a drive is hardly in them
SMOOTH = 2e-3  # of the fastest speed, by which speeds that are 1 s apart change at most
MANY = 1000  # rows for which that counts
FEW_ROWS = 20  # whose order tells nothing
DISORDER = 0.1  # share of steps back, from which on rows are in another order
ANEW = 50  # rows behind the time that was reached, from which on a clock started anew
STANDING = 0.5  # share of rows at the time of the row before, from which on it is said


def unit_since_1970(first: float) -> str:
    """The unit in which a stamp is a time of these days."""
    return "ms" if abs(first) < 1e14 else "us" if abs(first) < 1e17 else "ns"


def check_origin(first: float, header: str, row: int) -> None:
    """Refuses seconds that no clock shows.

    Raises
    ------
    ImplausibleReadingError
        If the first stamp is not in seconds.
    """
    if not abs(first) > LATEST_SECOND:
        return
    unit = unit_since_1970(first)
    rule = f'time must be in seconds unless it is said that it is not, got {first:.17g} in column "{header}"'
    raise ImplausibleReadingError(f"row {row}: {rule}: {unit} since 1970? Give {stamp_unit(unit)}")


def check_clock(stamps: Floats, speeds: Floats, rates: bool, header: str, row: int) -> None:
    """Refuses stamps that are taken for seconds and are a thousand times as many or more.

    Parameters
    ----------
    stamps : array, shape (n,)
        In seconds, as they are read.
    speeds : array, shape (m,)
        Rim speeds of the fastest wheel over stretches of these rows [m/s].
    rates : bool
        Whether the log has rates of wheels, which are right whatever the clock.
    header : str
        What the log calls its times.
    row : int
        The first of these rows.
    """
    steps = np.diff(stamps)
    steps = steps[steps > 0.0]
    if len(steps) < 4:
        return
    period = float(np.median(steps))
    if period < SHORTEST:
        return
    units = [(symbol, by) for symbol, by in UNITS if PERIODS[0] <= period / by <= PERIODS[1]]
    moving = np.abs(speeds[np.abs(speeds) > 0.0])
    if not units or not len(moving):
        return
    pace = float(np.quantile(moving, 0.95))
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
    raise ImplausibleReadingError(
        f"{what}: give {stamp_unit(symbol)}; they are seconds with {stamp_unit('s').option}"
    )


def check_order(stamps: Floats, warn: Callable[[str], None], header: str) -> None:
    """Refuses rows that are not in the order of time, and warns of time that stands still in most of them.

    Raises
    ------
    ImplausibleReadingError
        If they run backwards too often for a fault of the clock.
    """
    if bool((stamps[1:] > stamps[:-1]).all()):
        return
    steps = np.diff(stamps)
    if line := out_of_order(stamps, header):
        raise ImplausibleReadingError(line)
    still = int(np.count_nonzero(steps == 0.0))
    if still > STANDING * len(steps):
        many = f'column "{header}" stands still in {still} of {len(steps) + 1} rows, which are left out'
        warn(f"{many}: are the times whole seconds, or 32 bit numbers of a large size?")


def out_of_order(
    stamps: NDArray[Any],
    header: str,
    late: NDArray[np.int64] | None = None,
    rows: NDArray[np.int64] | None = None,
) -> str:
    """The line about rows that are not in the order of time; empty if they are, as far as a clock is.

    Parameters
    ----------
    stamps : array, shape (n,) or longer
        Times of the rows.
    header : str
        What the log calls them.
    late, rows : array of int, optional
        Rows of these that are behind the time that was reached, and numbers of all rows.
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
    rest = f"{at_its_word().option} ({at_its_word().argument}) leaves out what is behind"
    return f"{what}: {guess} Make a file of each; {rest}"
