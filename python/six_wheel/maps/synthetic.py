"""Ground made by seed: fractal, with rocks as on Mars.

Everything is made of additions, products and square roots of 64-bit numbers drawn by PCG64, and rounded to
0.1 mm at the end: a seed means the same ground on every platform.
"""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Terrain
from six_wheel.kinematics.errors import ArgumentTypeError, shown
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.poses import Floats

SMALLEST, LARGEST = 0.05, 3.0  # diameters of rocks [m]
FRACTAL_SIZE = 40.0  # the roughness is that of a yard of this size [m]
MOST_HEIGHTS, MOST_ROCKS = 10**9, 10**8
BLOCK = 1 << 18  # heights, or rocks, between two looks at signals
FADE = 0.615_572_206_672_458_2  # 2^-0.7: amplitude of an octave against the one before, Hurst 0.7


@checked()
def yard(
    size: float | tuple[float, float] = (40.0, 40.0),
    spacing: float = 0.05,
    cover: float = 0.1,
    seed: int = 0,
    *,
    roughness: float = 0.1,
) -> Terrain:
    """See `Terrain.yard`.

    Raises
    ------
    ValueError
        If a number is not finite or out of its range, or they make too many heights or rocks.
    """
    try:
        extent = (float(size), float(size)) if isinstance(size, int | float) else tuple(map(float, size))
    except (TypeError, ValueError):
        raise ArgumentTypeError(f"size must be one or two lengths, got {shown(size)}") from None
    if len(extent) != 2 or not all(math.isfinite(length) and length > 0 for length in extent):
        raise ValueError(f"size must be one or two lengths, finite and positive, got {size}")
    if not (math.isfinite(spacing) and 0 < spacing <= min(extent)):
        raise ValueError(f"spacing must be positive and at most the size, got {spacing}")
    if not 0 <= cover <= 0.5:
        raise ValueError(f"cover must be from 0 to 0.5, got {cover}")
    if not (math.isfinite(roughness) and roughness >= 0):
        raise ValueError(f"roughness must be finite and not negative, got {roughness}")
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ValueError(f"seed must be a whole number from 0, got {seed}")
    cells = [length / spacing for length in extent]
    if not (cells[0] + 1) * (cells[1] + 1) <= MOST_HEIGHTS:
        rule = f"must make at most {MOST_HEIGHTS:,} heights"
        raise ValueError(f"spacing {rule}, got {cells[0]:g} x {cells[1]:g} of {spacing}")
    counts = [math.floor(cell + 1e-9) + 1 for cell in cells]
    sizes = _sizes((counts[0] - 1) * (counts[1] - 1) * spacing * spacing, cover)
    if not (rocks := sum(number for _, _, number in sizes)) <= MOST_ROCKS:
        raise ValueError(
            f"size must make at most {MOST_ROCKS:,} rocks, got {rocks:.3g} by a cover of {cover}"
        )
    random = np.random.Generator(np.random.PCG64(int(seed)))
    heights = _fractal(random, counts, spacing, roughness)
    above = _rocks(random, counts, spacing, sizes)
    for block in _blocks(heights.shape):
        np.round(heights[block] + above[block], 4, out=heights[block])
    return Terrain(heights, spacing)


def _fractal(random: np.random.Generator, counts: list[int], spacing: float, roughness: float) -> Floats:
    """Noise of octaves, each half as long and `FADE` times as high as the one before."""
    columns, rows = counts
    heights = np.zeros((rows, columns))
    length, amplitude = FRACTAL_SIZE / 2, 1.0
    # Uniform numbers between -1 and 1 have the mean square 1/3; smooth in between, about half of it is left.
    total, octaves = 0.0, []
    while length > spacing:
        octaves.append((length, amplitude))
        total += amplitude * amplitude / 6
        length, amplitude = length / 2, amplitude * FADE
    if not octaves:  # the noise is finer than the grid
        return heights
    for length, amplitude in octaves:
        shape = [math.floor((count - 1) * spacing / length) + 2 for count in (rows, columns)]
        offset = random.random(2)
        values = 2 * random.random((shape[0] + 1, shape[1] + 1)) - 1
        (i, a), (j, b) = (
            _steps(count, spacing / length, shift)
            for count, shift in zip((rows, columns), offset, strict=True)
        )
        for block in _blocks(heights.shape):
            lower, upper = values[i[block]], values[i[block] + 1]
            along = lower + a[block, None] * (upper - lower)
            left, right = along[:, j], along[:, j + 1]
            heights[block] += amplitude * (left + b * (right - left))
    for block in _blocks(heights.shape):
        heights[block] *= roughness / math.sqrt(total)
    return heights


def _blocks(shape: tuple[int, int]) -> Iterator[slice]:
    """Rows of a grid, a few at a time."""
    rows, columns = shape
    step = max(1, BLOCK // max(columns, 1))
    return (slice(first, min(first + step, rows)) for first in range(0, rows, step))


def _steps(count: int, step: float, shift: float) -> tuple[NDArray[np.intp], Floats]:
    """Cells of a lattice, and where in them, smoothed so that slopes are continuous."""
    place = step * np.arange(count) + shift
    cell = place.astype(np.intp)
    t = place - cell
    return cell, t * t * t * (t * (6 * t - 15) + 10)


def _sizes(area: float, cover: float) -> list[tuple[float, float, float]]:
    """Least and largest diameters of rocks [m], and how many there are of them on an area [m^2].

    Those larger than D cover ``cover exp(-q D)`` (M. Golombek, D. Rapp, Size-frequency distributions of rocks
    on Mars and Earth analog sites, Journal of Geophysical Research 102, 1997: q = 1.79 + 0.152 / cover.)
    """
    if cover == 0:
        return []
    q = 1.79 + 0.152 / cover
    edges = [SMALLEST * (LARGEST / SMALLEST) ** (k / 60) for k in range(61)]
    sizes = []
    for small, large in pairwise(edges):
        share = cover * (math.exp(-q * small) - math.exp(-q * large))
        middle = (small + large) / 2
        sizes.append((small, large, share * area / (math.pi * middle * middle / 4)))
    return sizes


def _rocks(
    random: np.random.Generator,
    counts: list[int],
    spacing: float,
    sizes: list[tuple[float, float, float]],
) -> Floats:
    """Half ellipsoids as high as half their diameter."""
    columns, rows = counts
    heights = np.zeros((rows, columns))
    for small, large, wanted in sizes:
        number = math.floor(wanted + random.random())
        for first in range(0, number, BLOCK):
            for share, column, row in random.random((min(BLOCK, number - first), 3)).tolist():
                place = (column * (columns - 1), row * (rows - 1))
                _place(heights, spacing, small + (large - small) * share, place)
    return heights


def _place(heights: Floats, spacing: float, diameter: float, place: tuple[float, float]) -> None:
    """A rock, its middle at a place in columns and rows; where rocks overlap, the higher one is seen."""
    (column, row), radius = place, diameter / 2
    reach = radius / spacing
    rows, columns = heights.shape
    j = np.arange(max(math.ceil(column - reach), 0), min(math.floor(column + reach), columns - 1) + 1)
    i = np.arange(max(math.ceil(row - reach), 0), min(math.floor(row + reach), rows - 1) + 1)
    if not (i.size and j.size):
        return
    patch = heights[i[0] : i[-1] + 1, j[0] : j[-1] + 1]
    for block in _blocks(patch.shape):
        square: Any = ((i[block] - row) * (i[block] - row))[:, None] + (j - column) * (j - column)
        rock = radius * np.sqrt(np.maximum(0.0, 1 - square / (reach * reach)))
        np.maximum(patch[block], rock, out=patch[block])
