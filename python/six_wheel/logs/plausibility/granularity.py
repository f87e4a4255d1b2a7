"""Steps of encoders in angles: readings that are whole parts of a turn tell their unit."""

import math
from collections.abc import Sequence

import numpy as np

from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.proposals import (
    TAKEN,
    Column,
    ImplausibleReadingError,
    columns,
    encoders,
)

UNITS = {1.0: "rev", 360.0: "deg"}
ROWS = 200  # steps with a moving wheel
FINEST = 100_000.0  # counts of a turn
OFF = 2e-3  # counts, by which a turn is no whole number of them
ROUNDED = 0.1  # steps, by which readings are off from whole ones at most
LEVELS = 6  # steps of different length in a recording
PARTS = (1, 2, 3, 4)  # of the shortest step in a log, that a step of the encoder is
WIDER = 8.0  # times as many steps in every round of the fit


def turn_by_steps(column: Floats, turns: Sequence[float]) -> tuple[float, int] | None:
    """The one of some turns that is a whole number of the steps of a column (n,), while 2 pi is none; with
    the number of steps. None if readings have no steps, or those of a decimal number."""
    quantum = _quantum(column[np.isfinite(column)])
    if quantum is None or _is_whole(2.0 * math.pi / quantum):
        return None
    for turn in turns:
        if _is_whole(turn / quantum):
            return turn, round(turn / quantum)
    return None


def check_steps_of_turns(wheels: Floats, named: Sequence[Column], row: int, mapped: bool) -> None:
    """Refuses columns (n, wheels) whose steps are a whole part of a revolution or of 360 degrees, and no part
    of 2 pi; `mapped` where they have headers."""
    for column, readings in zip(named, wheels.T, strict=True):
        found = turn_by_steps(readings, tuple(UNITS))
        if found is None:
            continue
        turn, counts = found
        meanings = {each.header: f"{each.wheel} [{UNITS[turn]}]" for each in named if each.header}
        proposal = columns(meanings) if mapped else encoders(turn=turn)
        what = f'"{column.header}" goes from row {row} on in steps of {turn / counts:.6g}'
        guess = (
            f"{counts} of them are {turn:g}, and 2 pi is no whole number of them: {UNITS[turn]}, and not rad?"
        )
        raise ImplausibleReadingError(f"{what}: {guess} Give ", proposal, TAKEN)


def _is_whole(counts: float) -> bool:
    return 8.0 <= counts <= FINEST and abs(counts - round(counts)) < OFF


def _quantum(values: Floats) -> float | None:
    """The step of which all readings are whole multiples up to an offset; None if there is none, or one of a
    single digit, to which numbers are rounded."""
    steps = np.abs(np.diff(values))
    away = np.abs(values - values[:1])
    moves = steps[steps > 1e-9 * away.max(initial=0.0)]
    if len(moves) < ROWS:
        return None
    shortest = float(moves.min())
    found = (_fitted(away, float(np.median(moves[moves < 1.1 * shortest])) / parts) for parts in PARTS)
    quantum = next(filter(None, found), None)
    if quantum is None or len(np.unique(np.round(moves / quantum))) < LEVELS:
        return None
    mantissa = quantum / 10.0 ** math.floor(math.log10(quantum))
    decimal = abs(mantissa - round(mantissa)) < 1e-5
    return None if decimal else quantum


def _fitted(away: Floats, quantum: float) -> float | None:
    """A step to more digits, if ways (n,) are whole multiples of it: the longer the way, the more exact."""
    reach = 4.0
    while True:
        near = away[away < reach * quantum]
        whole = np.round(near / quantum)
        if not whole.any():
            return None
        quantum = float(near @ whole / (whole @ whole))
        if np.abs(near / quantum - np.round(near / quantum)).max() > ROUNDED:
            return None
        if reach * quantum > away.max():
            return quantum
        reach *= WIDER
