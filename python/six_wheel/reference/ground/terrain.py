"""A regular grid of heights, seen through bilinear interpolation."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from six_wheel.reference.planar.geometry import Floats


@dataclass(frozen=True)
class Terrain:
    """Heights [m]: rows go along +y, columns along +x, `origin` is the place of ``heights[0, 0]``."""

    heights: ArrayLike
    spacing: float | tuple[float, float]  # [m], or (dx, dy)
    origin: tuple[float, float] = (0.0, 0.0)  # [m]
    grid: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Takes the heights as they are."""
        object.__setattr__(self, "grid", np.asarray(self.heights, float))

    def _cells(self, xy: ArrayLike) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats, Floats, Floats]:
        """Row and column of the cell under a point, where in it from 0 to 1, and its corners (4, ...)."""
        spacing, place = np.broadcast_to(self.spacing, 2), np.asarray(xy, float)
        u, v = ((place[..., k] - self.origin[k]) / spacing[k] for k in (0, 1))
        rows, columns = self.grid.shape
        inside = (u >= 0) & (u <= columns - 1) & (v >= 0) & (v <= rows - 1)  # NaN is outside
        i = np.clip(np.floor(np.where(inside, v, 0)).astype(int), 0, rows - 2)
        j = np.clip(np.floor(np.where(inside, u, 0)).astype(int), 0, columns - 2)
        corners = np.array([self.grid[i + a, j + b] for a in (0, 1) for b in (0, 1)])
        return i, j, u - j, v - i, np.where(inside, corners, np.nan)

    def height_at(self, xy: ArrayLike) -> Floats:
        """Heights (...) [m] at points (..., 2); NaN outside and beside unknown cells."""
        _, _, a, b, (low, right, up, far) = self._cells(xy)
        height: Floats = (low * (1 - a) + right * a) * (1 - b) + (up * (1 - a) + far * a) * b
        return height

    def gradient_at(self, xy: ArrayLike) -> Floats:
        """Slopes (..., 2) along x and y of the cell under a point; NaN as for heights."""
        _, _, a, b, (low, right, up, far) = self._cells(xy)
        dx, dy = np.broadcast_to(self.spacing, 2)
        along = ((right - low) * (1 - b) + (far - up) * b) / dx
        across = ((up - low) * (1 - a) + (far - right) * a) / dy
        return np.stack([along, across], axis=-1)

    def normal_at(self, xy: ArrayLike) -> Floats:
        """Unit normals (..., 3), upwards."""
        slope = self.gradient_at(xy)
        normal = np.concatenate([-slope, np.ones_like(slope[..., :1])], axis=-1)
        unit: Floats = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
        return unit
