"""Doubts about heights, said before anything is computed: marks of unknown ones, units, pictures."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Doubt", "find_doubt", "is_fill"]

# Marks of unknown heights of GIS programs, NetCDF (its default), Surfer, integer types and PDS.
FILLS = (
    -9999.0, -99999.0, -999.0, -32768.0, -32767.0, 9999.0, 99999.0, 32767.0, 65535.0, -3.4028234663852886e38,
    3.4028234663852886e38, -3.4028226550889045e38, 1e20, -1e20, 1e30, -1e30, 1.70141e38,
    -1.797693134862315e308, 1.797693134862315e308, 9.969209968386869e36, -1e10,
)  # fmt: skip
SAME = 1e-5  # of the value: text files round their marks
APART = 100.0  # from all other heights [m]
STEEP = math.tan(math.radians(80.0))  # a median slope as no ground has it
ENOUGH = 64  # slopes of which the median says something
SAMPLES = 256  # rows and columns that are looked at
FINE = 0.5  # cells for which whole metres are too coarse [m]


class Doubt(NamedTuple):
    """What about heights is in doubt, and the option that settles it."""

    message: str
    is_fill: bool


def is_fill(heights: NDArray[np.floating], mark: float) -> NDArray[np.bool_]:
    """True for heights that are this mark, as far as single precision and text keep it."""
    if math.isnan(mark) or abs(mark) > np.finfo(heights.dtype).max:
        return np.zeros(heights.shape, bool)
    same: NDArray[np.bool_] = np.abs(heights - mark) <= SAME * abs(mark)
    return same


def find_doubt(
    heights: NDArray[np.floating],
    spacing: tuple[float, float],
    *,
    nodata_known: bool,
    unit_known: bool,
    whole: bool = False,
) -> Doubt | None:
    """The first doubt about heights in metres, if there is one.

    Parameters
    ----------
    heights : ndarray, shape (rows, columns)
        NaN where unknown.
    spacing : (float, float)
        Between columns and between rows [m].
    nodata_known, unit_known : bool
        True where somebody has said which heights are unknown, and in which unit they are.
    whole : bool
        True if they came as whole numbers.
    """
    if not nodata_known and (found := _mark(heights)):
        return found
    return None if unit_known else _unit(heights, spacing, whole)


def _mark(heights: NDArray[np.floating]) -> Doubt | None:
    if not heights.size:
        return None
    low, high = float(np.fmin.reduce(heights, axis=None)), float(np.fmax.reduce(heights, axis=None))
    for extreme in (low, high):
        for mark in FILLS:
            if not abs(extreme - mark) <= SAME * abs(mark):
                continue
            marked = is_fill(heights, mark)
            others = heights[~marked & ~np.isnan(heights)]
            if others.size and np.abs(others - mark).min() < APART:
                continue
            row, column = (int(index) for index in np.argwhere(marked)[0])
            value = float(heights[row, column])
            told = f"{int(marked.sum())} heights are {value:g}, the first at row {row}, column {column}"
            return Doubt(f"{told}: nodata={value:g} if they are unknown, nodata=nan if not", True)
    return None


def _unit(heights: NDArray[np.floating], spacing: tuple[float, float], whole: bool) -> Doubt | None:
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
    settles = 'unit="cm", unit="mm" or unit="ft" if they are, unit="m" if not'
    if median > STEEP:
        tilt = math.degrees(math.atan(median))
        return Doubt(f"half the slopes are above {tilt:.0f} degrees, heights not in metres? {settles}", False)
    known = parts[~np.isnan(parts)]
    if whole and min(spacing) < FINE and np.ptp(known) > 0:
        cells = f"cells of {min(spacing):g} m"
        return Doubt(f"heights are whole numbers on {cells}, not metres? {settles}", False)
    return None
