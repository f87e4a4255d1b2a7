"""Common parts of the readers of maps: checks of arguments and files, and their errors."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.errors import FileError

__all__ = ["Grid", "TerrainFileError", "Window", "cut"]

Window = tuple[float, float, float, float]


class TerrainFileError(FileError):
    """A file that is no map, or one that cannot be used."""


class Grid(NamedTuple):
    """Heights with their place: what a `Terrain` is made of."""

    heights: NDArray[np.floating]  # rows along +y, columns along +x [m]
    spacing: tuple[float, float]  # [m]
    origin: tuple[float, float]  # [m]
    yaw: float = 0.0  # [rad]


def check(window: Window | None) -> None:
    """Fails unless a window is one."""
    if window is None:
        return
    if len(window) != 4 or not all(math.isfinite(value) for value in window):
        raise ValueError(f"window must be x_min, y_min, x_max, y_max, all finite, got {window}")
    if not (window[0] < window[2] and window[1] < window[3]):
        raise ValueError(f"window must be x_min, y_min, x_max, y_max in order, got {window}")


def nodes(origin: float, spacing: float, count: int, low: float, high: float) -> tuple[int, int]:
    """First and last of the nodes of an axis that cover what lies between two of its coordinates."""
    first = math.floor((low - origin) / spacing)
    last = math.ceil((high - origin) / spacing)
    return max(first, 0), min(last, count - 1)


def cut(grid: Grid, window: Window | None, name: str) -> Grid:
    """The part of a grid along the axes that covers a window."""
    if window is None:
        return grid
    rows, columns = grid.heights.shape
    x0, x1 = nodes(grid.origin[0], grid.spacing[0], columns, window[0], window[2])
    y0, y1 = nodes(grid.origin[1], grid.spacing[1], rows, window[1], window[3])
    if x1 <= x0 or y1 <= y0:
        raise TerrainFileError(f"{name}: window must overlap the map, got {window}; {extent(grid)}")
    origin = (grid.origin[0] + x0 * grid.spacing[0], grid.origin[1] + y0 * grid.spacing[1])
    return grid._replace(heights=grid.heights[y0 : y1 + 1, x0 : x1 + 1], origin=origin)


def extent(grid: Grid) -> str:
    """Sentence on the range of x and y [m] that a grid covers."""
    (x, y), (dx, dy) = grid.origin, grid.spacing
    rows, columns = grid.heights.shape
    return f"the map has x {x:g} to {x + dx * (columns - 1):g}, y {y:g} to {y + dy * (rows - 1):g}"
