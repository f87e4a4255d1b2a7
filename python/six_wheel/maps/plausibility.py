"""Plausibility of heights, checked before anything is computed: marks of unknown ones, units."""

import math

import numpy as np
from numpy.typing import NDArray

from six_wheel.maps import doubts
from six_wheel.maps.doubts import Words

LARGEST = 1e15  # from this on a number is no height, as in the core [m]
SAME = 1e-5  # of the value: text files round their marks
APART = 100.0  # of a mark from all other heights [m]
LOWEST = -9999.0  # below all ground of the Earth, the Moon and Mars that is no bed of a sea [m]
RANGES = 3.0  # the same of a number that is no common mark, in ranges of the other heights
STEEP = math.tan(math.radians(80.0))  # a median slope as no ground has it
ENOUGH = 64  # slopes of which the median says something
SAMPLES = 64  # rows and columns that are sampled, up to twice as many
FINE = 0.5  # cells for which whole metres are too coarse [m]
DEGREES = 1e-3  # cells up to this are degrees where their places are in the range of degrees


def is_fill(heights: NDArray[np.floating], mark: float) -> NDArray[np.bool_]:
    """True for heights that are this mark, as far as single precision and text keep it."""
    if math.isnan(mark) or abs(mark) > np.finfo(heights.dtype).max:
        return np.zeros(heights.shape, bool)
    with np.errstate(over="ignore"):  # between opposite ends of single precision
        same: NDArray[np.bool_] = np.abs(heights - mark) <= SAME * abs(mark)
    return same


def is_mark(number: float) -> bool:
    """True for what programs write where they know no height.

    Those are numbers of nines, as -9999; ends of 16 and 32 bits; powers of ten from 1e5 on; and whatever is
    too large for a height: ends of single precision, what NetCDF and PDS write by default.
    """
    size = abs(number)
    if size >= LARGEST:
        return True
    whole = round(size)
    if abs(size - whole) > SAME * size:
        return False
    nines = len(str(whole).rstrip("0")) > 1 and set(str(whole).rstrip("0")) == {"9"}
    tens = whole >= 10**5 and str(whole).strip("0") == "1"
    return (
        nines or tens or any(bits in (15, 16, 31) for bits in (math.log2(max(whole + k, 1)) for k in (0, 1)))
    )


def find_fill(heights: NDArray[np.floating], known: tuple[float, ...] = ()) -> Words | None:
    """The first mark of unknown heights among numbers as they are stored, and the option that settles it.

    It is the least or the largest number, no other within 100 m of it: a common mark, or any number that
    several nodes share, farther from all other heights than these are from each other. Where all numbers are
    one there is nothing to compare it with: it is a mark if no ground can be as low or as high. `known` are
    the marks that were given.
    """
    for extreme in _range(heights):
        if not math.isfinite(extreme):
            continue
        common = is_mark(extreme)
        marked = is_fill(heights, extreme) if common else heights == extreme
        count = int(np.count_nonzero(marked))
        if not common and not 2 <= count < marked.size / 2:
            continue
        least, most = _range(heights[~marked])
        if math.isnan(least):  # no others
            if extreme <= LOWEST or extreme >= LARGEST:
                return doubts.all_marked(count, extreme)
            continue
        apart = min(abs(least - extreme), abs(most - extreme))
        if apart < APART:
            continue
        # Ground of two heights is made by hand.
        if not common and (least == most or apart < RANGES * (most - least)):
            continue
        row, column = (int(index) for index in np.argwhere(marked)[0])
        found = count, float(heights[row, column]), (row, column)
        return doubts.another_mark(*found, known) if known else doubts.flagged_heights(*found)
    return None


def _range(heights: NDArray[np.floating]) -> tuple[float, float]:
    """Least and largest of the known heights; NaN without any."""
    if not heights.size:
        return math.nan, math.nan
    return float(np.fmin.reduce(heights, axis=None)), float(np.fmax.reduce(heights, axis=None))


def find_unit(
    heights: NDArray[np.floating], spacing: tuple[float, float], *, whole: bool = False
) -> Words | None:
    """Reason why heights [m], NaN where unknown, are hardly in metres, if there is one.

    `spacing` is between columns and between rows [m]; heights that are `whole` came as whole numbers.
    """
    rows, columns = (slice(None, None, max(1, size // SAMPLES)) for size in heights.shape)
    parts = heights[rows][:, columns]
    with np.errstate(over="ignore"):  # of heights that the core refuses
        ahead = (heights[rows, 1:][:, columns] - heights[rows, :-1][:, columns]) / spacing[0]
        across = (heights[1:][rows][:, columns] - heights[:-1][rows][:, columns]) / spacing[1]
        count, width = min(ahead.shape[0], across.shape[0]), min(ahead.shape[1], across.shape[1])
        slopes = np.hypot(ahead[:count, :width], across[:count, :width])
    slopes = slopes[~np.isnan(slopes)]
    if slopes.size < ENOUGH:
        return None
    median = float(np.median(slopes))
    if median > STEEP:
        return doubts.steep_heights(math.degrees(math.atan(median)), ("cm", "mm", "ft"))
    known = parts[~np.isnan(parts)]
    if whole and min(spacing) < FINE and np.ptp(known) > 0:
        return doubts.whole_heights(min(spacing))
    return None


def is_in_degrees(
    origin: tuple[float, float],
    spacing: tuple[float, float],
    shape: tuple[int, ...],
    largest: float = DEGREES,
) -> bool:
    """True for a place that is one of longitudes and latitudes, with cells of at most `largest` degrees."""
    (x, y), (dx, dy), (rows, columns) = origin, spacing, shape
    inside = -180.0 <= x <= x + dx * columns <= 360.0 and -90.0 <= y <= y + dy * rows <= 90.0
    return inside and max(dx, dy) <= largest
