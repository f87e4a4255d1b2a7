"""Maps as images: GeoTIFF, PDS and whatever else GDAL reads, by windows, in their own frame."""

import math
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from six_wheel.maps.files import Grid, TerrainFileError, Window

__all__ = ["Raster", "rasterio"]


def rasterio() -> Any:
    """The library, or what to install."""
    try:
        import rasterio
    except ImportError as missing:
        raise ImportError('maps as images need rasterio: pip install "six-wheel[terrain]"') from missing
    return rasterio


class Raster:
    """An open image of heights: its first band, in metres, pixel (0, 0) first.

    Parameters
    ----------
    path : path
        The image.

    Raises
    ------
    ImportError
        If rasterio is not installed.
    TerrainFileError
        If it is no image, its coordinates are degrees, or its axes are not at right angles.
    """

    def __init__(self, path: Path) -> None:
        library = rasterio()
        self.path = path
        # Whatever the image lacks is said here in one line, not as a warning.
        self._environment = library.Env(CPL_DEBUG=False)
        self._environment.__enter__()
        try:
            import warnings

            with warnings.catch_warnings():
                warnings.simplefilter("ignore", library.errors.NotGeoreferencedWarning)
                self.dataset = library.open(path)
        except library.errors.RasterioIOError as error:
            self._environment.__exit__(None, None, None)
            raise TerrainFileError(f"{path} must be a map: {' '.join(str(error).split())}") from None
        try:
            self._place()
        except BaseException:
            self.close()
            raise

    def _place(self) -> None:
        crs, transform = self.dataset.crs, self.dataset.transform
        metre = 1.0
        if crs is not None:
            if crs.is_geographic:
                raise TerrainFileError(
                    f"{self.path} must be in metres, its coordinates are degrees: project it first"
                )
            if crs.is_projected:
                metre = float(crs.linear_units_factor[1])
        self.crs, self.transform = crs, transform
        self.shape: tuple[int, int] = self.dataset.shape
        right = np.array([transform.a, transform.d]) * metre
        down = np.array([transform.b, transform.e]) * metre
        self.spacing = (math.hypot(*right), math.hypot(*down))
        if not (self.spacing[0] > 0 and self.spacing[1] > 0):
            raise TerrainFileError(f"{self.path} must have pixels with a size, got {tuple(transform)[:6]}")
        if abs(right @ down) > 1e-9 * self.spacing[0] * self.spacing[1]:
            raise TerrainFileError(f"{self.path} must have axes at right angles, got {tuple(transform)[:6]}")
        # Columns go along the x axis of the grid; rows along its y axis where they go north, else against it.
        self.flipped = right[0] * down[1] - right[1] * down[0] < 0
        self.yaw = math.atan2(right[1], right[0])
        self.metre = metre

    def place(self, row: int, column: int) -> tuple[float, float]:
        """The middle of a pixel in the frame of the map [m]."""
        x, y = _apply(self.transform, column + 0.5, row + 0.5)
        return x * self.metre, y * self.metre

    def heights(self, rows: slice, columns: slice) -> NDArray[np.floating]:
        """Pixels of a window as they lie in the image; NaN where there are none [m]."""
        window = ((rows.start, rows.stop), (columns.start, columns.stop))
        try:
            band = self.dataset.read(1, window=window, masked=True)
        except Exception as error:
            raise TerrainFileError(f"{self.path}: {' '.join(str(error).split())}") from None
        scale, offset = self.dataset.scales[0], self.dataset.offsets[0]
        single = band.dtype == np.float32 and (scale, offset) == (1.0, 0.0)
        heights: NDArray[np.floating] = band.astype(np.float32 if single else np.float64).filled(np.nan)
        if (scale, offset) != (1.0, 0.0):
            heights = heights * scale + offset
        # Some images mark what is not known by infinities beside their own mark.
        heights[np.isinf(heights)] = np.nan
        return heights

    def grid(self, rows: slice, columns: slice) -> Grid:
        """A window as a grid of the frame of the map."""
        heights = self.heights(rows, columns)
        if self.flipped:
            return Grid(heights[::-1], self.spacing, self.place(rows.stop - 1, columns.start), self.yaw)
        return Grid(heights, self.spacing, self.place(rows.start, columns.start), self.yaw)

    def read(self, window: Window | None) -> Grid:
        """The pixels that cover a window of the frame of the map, or all."""
        rows, columns = self.shape
        if window is None:
            return self.grid(slice(0, rows), slice(0, columns))
        x0, y0, x1, y1 = (value / self.metre for value in window)
        inverse = ~self.transform
        corners = np.array([_apply(inverse, x, y) for x in (x0, x1) for y in (y0, y1)]) - 0.5
        low, high = np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0))
        first = np.maximum(low, 0).astype(int)
        last = np.minimum(high, [columns - 1, rows - 1]).astype(int)
        if not (last > first).all():
            left, bottom, right, top = self.dataset.bounds
            where = f"the map has x {left:g} to {right:g}, y {bottom:g} to {top:g}"
            raise TerrainFileError(f"{self.path}: window must overlap the map, got {window}; {where}")
        return self.grid(slice(first[1], last[1] + 1), slice(first[0], last[0] + 1))

    def close(self) -> None:
        """Let go of the file."""
        self.dataset.close()
        self._environment.__exit__(None, None, None)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _apply(transform: Any, x: float, y: float) -> tuple[float, float]:
    """Versions of the library behind it do not agree on the sign for this."""
    return transform.a * x + transform.b * y + transform.c, transform.d * x + transform.e * y + transform.f
