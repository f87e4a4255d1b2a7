"""Whole numbers: counts that are read as radians, and what was turned since the row before as a total."""

from collections.abc import Sequence

import numpy as np

from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.proposals import (
    Column,
    ImplausibleReadingError,
    columns,
    encoders,
)

LONG_STEP = 100.0  # of whole numbers in a row, which no radians are
ROWS = 20  # from which on whole numbers alone are enough
VALUES = 8  # different ones among them
ALIKE = 0.95  # share of steps of one size, from which on they are no recording
FLIPS = 0.3  # share of steps against the step before, from which on they are no motion
ONWARD = 0.2  # of the way at its longest step, that a total goes; rates rise and fall in few of the rows
LEVELS = 5  # ticks that what was turned in a row takes at least


def all_whole(values: Floats) -> bool:
    """True if every finite value is a whole number."""
    there = values[np.isfinite(values)]
    return len(there) > 0 and not np.any(there % 1.0)


def check_counts(
    wheels: Floats, named: Sequence[Column], row: int, steering: bool = False, mapped: bool = False
) -> None:
    """Refuses whole numbers as angles in radians: columns (n, wheels) of readings of which nobody said what
    they are; `mapped` where their headers have to say that they are counts."""
    for column, readings in zip(named, wheels.T, strict=True):
        there = readings[np.isfinite(readings)]
        if len(there) < 2 or not all_whole(there):
            continue
        steps = np.abs(np.diff(there))
        longest = float(steps.max())
        moves = steps[steps > 0.0]
        # Steps that are nearly all the same are no recording.
        several = len(moves) >= ROWS and np.unique(steps, return_counts=True)[1].max() < ALIKE * len(steps)
        if longest > LONG_STEP or (several and len(np.unique(there)) >= VALUES):
            at = row + int(np.argmax(steps)) + 1
            what = f'"{column.header}" holds whole numbers, with a step of {longest:.0f} in row {at}'
            proposal = encoders(counts=True, steering=steering)
            if mapped:
                ending = "_steering [ticks]" if steering else " [ticks]"
                meanings = {each.header: f"{each.wheel}{ending}" for each in named if each.header}
                proposal = columns(meanings).beside(proposal)
            what = f"{what}: counts are no radians; give "
            raise ImplausibleReadingError(what, proposal, ", COUNTS those of a turn")


def check_thousands(readings: Floats, column: Column, row: int) -> None:
    """Refuses counts with a point between thousands: 1.000 behind 999."""
    there = readings[np.isfinite(readings)]
    parts = there[there % 1.0 != 0.0]
    if (
        not len(parts)
        or np.abs(there).max() >= 1e3
        or np.any(np.abs(parts * 1e3 - np.round(parts * 1e3)) > 1e-6)
    ):
        return
    sizes = np.abs(there)
    falls = np.flatnonzero((sizes[:-1] > 800.0) & (sizes[1:] >= 1.0) & (sizes[1:] < 2.0))
    if len(falls):
        at = row + int(falls[0]) + 1
        what = f'"{column.header}" goes from {there[falls[0]]:g} to {there[falls[0] + 1]:.3f} in row {at}'
        rest = "write the numbers without them"
        raise ImplausibleReadingError(f"{what}: points between thousands? Counts are whole numbers; {rest}")


def check_increments_as_totals(readings: Floats, column: Column, row: int) -> None:
    """Refuses what was turned since the row before where totals are read: a total that goes to and fro by
    single counts at many levels is none."""
    there = readings[np.isfinite(readings)]
    if len(there) < 2 * ROWS or not all_whole(there):
        return
    steps = np.diff(there)
    moves = steps[steps != 0.0]
    if len(moves) < ROWS:
        return
    flips = float(np.mean(np.sign(moves[1:]) != np.sign(moves[:-1])))
    span = float(there.max() - there.min())
    way = float(np.abs(moves).sum())
    if flips > FLIPS and span >= LEVELS and way > 3.0 * span and float(np.median(np.abs(moves))) < span:
        what = f'"{column.header}" goes to and fro between {there.min():.0f} and {there.max():.0f}'
        raise _in_increments(f"{what} from row {row} on")


def check_increments(readings: Floats, column: Column, row: int) -> None:
    """Refuses totals where what was turned since the row before is read. Raises `ImplausibleReadingError` if
    the readings go on and on."""
    there = readings[np.isfinite(readings)]
    if len(there) < 2 * ROWS:
        return
    longest = float(np.abs(np.diff(there)).max())
    onward = float(there.max() - there.min()) > ONWARD * longest * np.count_nonzero(there)
    if longest > 0.0 and onward and float(np.median(np.abs(there))) > ROWS * longest:
        way = f"from {there.min():.6g} to {there.max():.6g}"
        what = f'"{column.header}" goes {way} by {longest:.6g} a row at most'
        raise ImplausibleReadingError(
            f"{what} from row {row} on: a total, and not what was turned since the row before"
        )


def returned_counts(column: Column) -> ImplausibleReadingError:
    """The error for counts of all wheels that rested at 0 after a motion and went on, as totals do not."""
    return _in_increments(
        f'"{column.header}" and all other counts rest at 0 again after a motion and then go on'
    )


def _in_increments(what: str) -> ImplausibleReadingError:
    rest = "; they are totals with increments: false"
    what = f"{what}, as counts of each row would: give "
    return ImplausibleReadingError(what, encoders(increments=True), rest)
