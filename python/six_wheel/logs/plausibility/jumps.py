"""Columns that jump: counters and angles that start over at a number, and counters that were set to zero.

A column that wraps at M stays within M, and a step of it that is longer than half of what the column ever
spans is longer than any other by far. A reset goes to zero from anywhere.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats

POWERS = tuple(float(1 << bits) for bits in (8, 10, 11, 12, 13, 14, 15, 16, 17, 18, 20, 21, 22, 24, 31, 32))
DECIMALS = tuple(float(10**digits) for digits in range(2, 10))
WHOLE_TURNS = (360.0, 1.0, 400.0, 3600.0, 36000.0)
TURNS = (2.0 * math.pi, *WHOLE_TURNS)
SHARE = 0.45  # of its range, that a step of a column that wraps takes at least
CALM = 0.5  # of a jump, below which all other steps must stay
APART = 8.0  # times the other steps around it, that a jump is at least
AROUND = 25  # rows on either side that tell what steps are usual
LEAST = 3  # steps that have to be there beside a jump
PLAIN = 25.0  # times what steps change from row to row, that a counter's range is at least
RARE = 1000.0  # the same where the readings are not within 0 and that range, and where no range is usual
PIECE = 8192  # rows that fit a cache
MOST = 0.02  # share of steps that are jumps; more are motion in another unit
BACK = 0.9  # share of long steps against the one before, of readings that belong to two columns
ROWS = 20  # that a column has at least, of which anything is said


@dataclass(frozen=True)
class Jumps:
    """Rows of a column (0 for the first step) at which it jumps, and the number at which it starts over;
    None if it was set to another value."""

    rows: NDArray[np.int64]
    wraps_at: float | None
    before: float
    after: float


def may_jump(samples: Floats, steps: Floats) -> bool:
    """Quick test of a column by some of its values and the steps between them."""
    with np.errstate(invalid="ignore"):
        longest = float(np.nanmax(np.abs(steps), initial=0.0))
    if longest == 0.0:
        return False
    if longest > SHARE * float(np.nanmax(samples) - np.nanmin(samples)):
        return True
    few = steps[:: max(1, len(steps) // PIECE)]
    moving = np.abs(few[np.abs(few) > 0.0])
    return len(moving) > LEAST and longest > APART * float(np.quantile(moving, 0.9))


def longest_step(values: Floats) -> float:
    """The longest step between two rows of any column (n, columns), or of one (n,); NaN counts as none."""
    longest = 0.0
    for first in range(0, len(values) - 1, PIECE):
        rows = values[first : first + PIECE + 1]
        steps = rows[1:] - rows[:-1]
        most = float(np.abs(steps, out=steps).max())
        longest = max(longest, float(np.nanmax(steps, initial=0.0)) if math.isnan(most) else most)
    return longest


def lost_readings(column: Floats, longest: Floats) -> Jumps | None:
    """Steps of a column (n,) longer than any motion, `longest` (n - 1,), and far from the others."""
    steps = np.diff(column)
    sizes = np.nan_to_num(np.abs(steps))
    found = np.flatnonzero(sizes > longest)
    if not len(found) or len(found) > MOST * len(steps):
        return None
    others = np.delete(sizes, found)
    usual = float(np.quantile(others[others > 0.0], 0.95)) if others.any() else 0.0
    if APART * usual > float(sizes[found].min()):
        return None
    return Jumps(found + 1, None, float(column[found[0]]), float(column[found[0] + 1]))


def goes_to_and_fro(column: Floats, longest: Floats) -> bool:
    """True if many steps of a column (n,) are above `longest` (n - 1,), and the next takes them back."""
    steps = np.diff(column)
    found = np.flatnonzero(np.isfinite(steps) & (np.abs(steps) > longest))
    if len(found) <= max(ROWS, MOST * len(steps)):
        return False
    back = np.sign(steps[found[1:]]) != np.sign(steps[found[:-1]])
    return float(np.mean(back)) > BACK


def find_jumps(
    column: Floats, turns: Sequence[float] = (), whole: bool = False, steering: bool = False
) -> Jumps | None:
    """The jumps of a column (n,) of totals, of which NaN is left out.

    `turns` are counts of a turn, at which such a column may well start over; `whole` is True if the readings
    are whole numbers, `steering` if they are those of a joint, which may turn quickly to the other solution,
    half a turn away.
    """
    there = np.flatnonzero(np.isfinite(column))
    values = column[there]
    if len(values) < ROWS:
        return None
    steps = np.diff(values)
    sizes = np.abs(steps)
    span = float(values.max() - values.min())
    found = np.flatnonzero(sizes > max(SHARE * span, 0.0))
    found = _lasting(steps, found)
    others = np.delete(sizes, found)
    calm = len(found) and float(others.max(initial=0.0)) < CALM * float(sizes[found].min())
    if calm and len(others) >= LEAST:
        wraps_at, known = _wrap(steps, found, span, turns, whole)
        seen = wraps_at is not None and _is_certain(values, steps, found, wraps_at, known, whole)
        if seen and (known or whole or not steering):
            return Jumps(there[found + 1], wraps_at, float(values[found[0]]), float(values[found[0] + 1]))
    found = np.flatnonzero(sizes > APART * _around(sizes))
    found = _lasting(steps, found)
    found = found[_is_reset(values, found, whole)]
    if not len(found):
        return None
    return Jumps(there[found + 1], None, float(values[found[0]]), float(values[found[0] + 1]))


def _lasting(steps: Floats, found: NDArray[np.int64]) -> NDArray[np.int64]:
    """Jumps without those that the next row takes back."""
    back = np.zeros(len(found), dtype=bool)
    if len(found) > 1:
        pair = (np.diff(found) == 1) & (steps[found[1:]] * steps[found[:-1]] < 0.0)
        pair &= np.abs(steps[found[1:]] + steps[found[:-1]]) < CALM * np.abs(steps[found[1:]])
        back[1:] |= pair
        back[:-1] |= pair
    return found[~back]


def _wrap(
    steps: Floats, found: NDArray[np.int64], span: float, turns: Sequence[float], whole: bool
) -> tuple[float | None, bool]:
    """The number at which a column starts over, from its jumps, None if they have none in common; and whether
    it is the range of a usual counter or a turn."""
    usual = np.delete(np.abs(steps), found)
    most = float(usual.max(initial=0.0))
    # The motion of the wheel meanwhile is taken from the steps on both sides.
    before = steps[np.maximum(found - 1, 0)]
    after = steps[np.minimum(found + 1, len(steps) - 1)]
    ordinary = np.where(np.isin(found - 1, found) | (found == 0), after, before)
    ordinary = np.where(np.abs(ordinary) > most, 0.0, ordinary)
    sizes = np.abs(steps[found]) + np.sign(-steps[found]) * ordinary
    # A counter that starts over jumps against the direction it has.
    onward = float(np.mean(np.sign(steps[found]) * np.sign(ordinary) > 0)) > 0.5
    guess, spread = float(np.median(sizes)), float(sizes.max() - sizes.min())
    room = most + (1.0 if whole else 1e-9 * guess)
    if spread > 2.0 * room or guess <= 2.0 * most:
        return None, False
    if onward:  # a bit that was read wrong, in a column that goes on beyond it
        return next((each for each in POWERS if abs(each - guess) <= room), None), True
    known = [*turns, *POWERS, *DECIMALS, *TURNS]
    lowest = span + (1.0 if whole else 0.0)
    fits = [each for each in known if abs(each - guess) <= room and each >= lowest * (1.0 - 1e-9)]
    # A counter that runs beyond its range elsewhere in the log, by a bit that was read wrong.
    fits += [each for each in POWERS if whole and each >= 65_536.0 and abs(each - guess) <= room]
    fits += [each for each in (math.tau, 360.0, 1.0) if abs(each - guess) <= room and each >= span * 0.999]
    if fits:
        return min(fits, key=lambda each: abs(each - guess)), True
    if len(found) < 2:
        return None, False
    return (float(round(max(guess, lowest))) if whole else guess), False


def _is_certain(
    values: Floats, steps: Floats, found: NDArray[np.int64], wraps_at: float, known: bool, whole: bool
) -> bool:
    """True if jumps by about `wraps_at` are those of a counter, and not a wheel that starts or halts.

    Between them a counter goes on as around them, up to what its steps change from row to row. That two
    jumps agree by chance is as rare as the square of one; the first of an unusual range says nothing.
    """
    others = np.delete(steps, found)
    moving = (others[1:] != 0.0) | (others[:-1] != 0.0)
    changes = np.abs(np.diff(others))[moving]
    few = len(changes) <= LEAST
    usual = float(changes.max(initial=0.0) if few else np.quantile(changes, 0.9))
    usual += 1.0 if whole else 1e-6 * wraps_at
    calm = np.setdiff1d(np.arange(len(steps)), found)
    place = np.searchsorted(calm, found)
    around = np.stack([steps[calm[np.maximum(place - 1, 0)]], steps[calm[np.minimum(place, len(calm) - 1)]]])
    turned = steps[found] - np.sign(steps[found]) * wraps_at
    off = np.maximum(around.min(axis=0) - turned, turned - around.max(axis=0))
    if float(np.median(off)) > 2.0 * usual:
        return False
    low, high = float(values.min()), float(values.max())
    last = wraps_at - 1.0 if whole else 1.000_001 * wraps_at  # the highest reading
    within = (-1e-6 * wraps_at <= low and high <= last) or 2.0 * max(-low, high) <= 1.000_001 * wraps_at
    jumps = len(found) if known else len(found) - 1
    usually = known and wraps_at not in DECIMALS
    rare = jumps * math.log(wraps_at / usual)
    return rare > math.log(PLAIN if within and usually and not few else RARE)


def _around(sizes: Floats) -> Floats:
    """The longest of the steps around each, itself left out, in blocks of `AROUND`."""
    width = AROUND
    count = -(-len(sizes) // width)
    padded = np.zeros(count * width)
    padded[: len(sizes)] = sizes
    blocks = padded.reshape(count, width)
    order = np.partition(blocks, width - 2, axis=1)
    second, first = order[:, -2], order[:, -1]
    longest = np.where(blocks == first[:, None], second[:, None], first[:, None])
    beside = np.concatenate([[0.0], np.minimum(first, np.inf)[:-1]]), np.concatenate([first[1:], [0.0]])
    neighbours = np.maximum(*beside)
    # A block of the ends has one neighbour; a neighbour that jumps itself tells nothing.
    calm = np.where(neighbours > APART * np.maximum(second, np.median(first)), second, neighbours)
    return np.maximum(longest, calm[:, None]).ravel()[: len(sizes)]


def _is_reset(values: Floats, found: NDArray[np.int64], whole: bool) -> NDArray[np.bool_]:
    """True for jumps from anywhere to about zero, or to where the column began."""
    if not len(found):
        return np.zeros(0, dtype=bool)
    steps = np.diff(values)
    usual = np.delete(np.abs(steps), found)
    least = 1.0 if whole else 0.0
    most = max(float(usual.max(initial=0.0)), least)
    places = np.maximum(found - 1, 0), np.minimum(found + 1, len(steps) - 1)
    beside = np.maximum(*(np.abs(steps[each]) for each in places))
    turned = np.minimum(beside, most) + least
    near = np.minimum(np.abs(values[found + 1]), np.abs(values[found + 1] - values[0])) <= 1.5 * turned
    seen = RARE if np.count_nonzero(usual) <= LEAST else APART
    reset: NDArray[np.bool_] = near & (np.abs(steps[found]) > seen * most)
    return reset
