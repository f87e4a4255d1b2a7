"""Maps as images: GeoTIFF, PDS and whatever else GDAL reads, by windows, in their own frame."""

import contextlib
import math
import warnings
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from six_wheel.maps.doubts import find_doubt, is_fill
from six_wheel.maps.files import Grid, Options, TerrainFileError, Window, length
from six_wheel.maps.reference import UNKNOWN, projection_command, read_reference, scale_factors

__all__ = ["Raster", "TerrainFileWarning", "rasterio"]

HEIGHTS = ("elevation", "height", "heights", "dem", "dtm", "z", "altitude", "topography")
EAST = ("x", "easting", "east", "X")  # names of coordinates
SAMPLE = 256  # rows and columns of a part that stands for the image
STRETCHED = 0.03  # of a distance


def rasterio() -> Any:
    """The library, or what to install."""
    try:
        import rasterio
    except ImportError as missing:
        raise ImportError('maps as images need rasterio: pip install "six-wheel[terrain]"') from missing
    return rasterio


class TerrainFileWarning(UserWarning):
    """A map that can be used, with distances that are not those on the ground."""


class Raster:
    """An open image of heights: one band, in metres, pixel (0, 0) first.

    Parameters
    ----------
    path : path
        The image.
    options : Options
        What is known about it beside the file, checked.
    source : str, optional
        Name under which GDAL opens it, default the path.

    Raises
    ------
    ImportError
        If rasterio is not installed.
    TerrainFileError
        If it is no image, its coordinates are degrees, its axes are not at right angles, or something is in
        doubt.
    """

    def __init__(self, path: Path, options: Options = Options(), source: str | None = None) -> None:  # noqa: B008 - it is immutable
        library = rasterio()
        self.path, self.options = path, options.checked()
        # Whatever the image lacks is said here in one line, not as a warning. NetCDF: axes are known by their
        # names too (GDAL, netCDF driver).
        self._environment = library.Env(CPL_DEBUG=False, GDAL_NETCDF_IGNORE_XY_AXIS_NAME_CHECKS="YES")
        self._environment.__enter__()
        try:
            self.dataset = self._open(source or str(path))
        except library.errors.RasterioIOError as error:
            self._environment.__exit__(None, None, None)
            raise TerrainFileError(f"{path} must be a map: {' '.join(str(error).split())}") from None
        except BaseException:
            self._environment.__exit__(None, None, None)
            raise
        try:
            self.band = self._band()
            self._place()
            self._measure()
        except BaseException:
            self.close()
            raise

    def _open(self, source: str) -> Any:
        """The dataset, or that of its only variable, or of the one that is asked for."""
        library = rasterio()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", library.errors.NotGeoreferencedWarning)
            dataset = library.open(source)
            parts = {name.rpartition(":")[2].strip('/"'): name for name in dataset.subdatasets}
            if dataset.count or not parts:
                return dataset
            dataset.close()
            named = [part for part in parts if part.lower() in HEIGHTS]
            wanted = self.options.band
            name = named[0] if wanted is None and len(named) == 1 else str(wanted)
            if name not in parts:
                listed = ", ".join(parts)
                raise TerrainFileError(
                    f'{self.path} has several variables: {listed}; band="{next(iter(parts))}"'
                )
            return library.open(parts[name])

    def _band(self) -> int:
        """The band of heights."""
        names, wanted, count = self.dataset.descriptions, self.options.band, self.dataset.count
        told = ", ".join(f"{k} {name}" if name else str(k) for k, name in enumerate(names, 1))
        if isinstance(wanted, str) and wanted.isdecimal():
            wanted = int(wanted)
        if isinstance(wanted, int) and not isinstance(wanted, bool):
            if not 1 <= wanted <= count:
                raise TerrainFileError(f"{self.path} has no band {wanted}, it has {told}")
            return wanted
        if isinstance(wanted, str) and count > 1:
            if wanted not in names:
                raise TerrainFileError(f"{self.path} has no band {wanted}, it has {told}")
            return int(names.index(wanted)) + 1
        if count == 1:
            return 1
        named = [k for k, name in enumerate(names, 1) if name and name.lower() in HEIGHTS]
        if len(named) == 1:
            return named[0]
        kinds = set(self.dataset.dtypes)
        if count in (3, 4) and kinds == {"uint8"}:
            raise TerrainFileError(
                f"{self.path} is a picture, not heights: {count} bands of 8 bits (band=1 takes one)"
            )
        raise TerrainFileError(
            f"{self.path} has {count} bands: {told}; give that of the heights, as band={count}"
        )

    def _place(self) -> None:
        library = rasterio()
        self.crs, transform = self.dataset.crs, self.dataset.transform
        wkt = "" if self.crs is None else self.crs.to_wkt()
        self.reference = read_reference(wkt) if wkt else UNKNOWN
        self.metre = self.reference.plane
        self.shape: tuple[int, int] = self.dataset.shape
        numbers = tuple(transform)[:6]
        if self.reference.degrees:
            self._refuse_degrees(transform)
        if numbers in ((1, 0, 0, 0, 1, 0), (1, 0, 0, 0, -1, 0)) or not all(
            value == 0 or 1e-300 < abs(value) < 1e300 for value in numbers
        ):
            if self.dataset.gcps[0] or self.dataset.rpcs:
                told = "is placed by control points alone: gdalwarp"
                raise TerrainFileError(f"{self.path} {told} {self.path.name} {self.path.stem}_placed.tif")
            steps = self.options.steps
            if steps is None:
                told = "spacing=0.1, the size of its cells in metres, and origin=(x, y) if it matters"
                raise TerrainFileError(f"{self.path} has no place (no transform): {told}")
            x, y = self.options.first
            rows, (dx, dy) = self.shape[0], steps
            north_up = self.options.north_up is not False
            top = y + dy * (rows - 0.5) if north_up else y - dy / 2
            transform = type(transform)(dx, 0, x - dx / 2, 0, -dy if north_up else dy, top)
            self.metre = 1.0
        elif self.options.spacing is not None or self.options.origin is not None:
            raise TerrainFileError(f"{self.path} has a place of its own: leave spacing and origin out")
        elif self.options.north_up is not None:
            raise TerrainFileError(
                f"{self.path} says itself which row is the northern one: leave north_up out"
            )
        self.transform = transform
        right = np.array([transform.a, transform.d]) * self.metre
        down = np.array([transform.b, transform.e]) * self.metre
        self.spacing = (math.hypot(*right), math.hypot(*down))
        if not (self.spacing[0] > 0 and self.spacing[1] > 0):
            raise TerrainFileError(f"{self.path} must have pixels with a size, got {tuple(transform)[:6]}")
        if abs(right @ down) > 1e-9 * self.spacing[0] * self.spacing[1]:
            warp = f"gdalwarp {self.path.name} {self.path.stem}_square.tif"
            raise TerrainFileError(
                f"{self.path} must have axes at right angles, got {tuple(transform)[:6]}: {warp}"
            )
        # Columns go along the x axis of the grid; rows along its y axis where they go north, else against it.
        self.flipped = bool(right[0] * down[1] - right[1] * down[0] < 0)
        self.yaw = math.atan2(right[1], right[0])
        if self.dataset.driver == "netCDF":
            self._check_axes()
        if self.reference.geographic is not None and self.crs.is_projected:
            # A system that PROJ cannot undo has no scale to compare.
            with contextlib.suppress(library.errors.RasterioError):
                self._check_scale()

    def _check_axes(self) -> None:
        """Fails where rows of a NetCDF variable run along x: GDAL takes any last dimension for x."""
        for name in EAST:
            try:
                with rasterio().open(f"NETCDF:{self.path}:{name}") as axis:
                    places = axis.read(1).ravel()
            except rasterio().errors.RasterioIOError:
                continue
            told = self.dataset.tags().get(f"{name}#units", "m")
            rows, columns = self.shape
            first = [
                _apply(self.transform, column + 0.5, row + 0.5)[0]
                for row, column in ((0, 0), (0, columns - 1))
            ]
            ends = {round(float(value), 6) for value in (places[0], places[-1])}
            if told.startswith("degree") or (len(places) == columns and ends == {round(x, 6) for x in first}):
                return
            if len(places) == rows:
                flipped = f"ncpdq -a y,{name} {self.path.name} {self.path.stem}_rows.nc"
                raise TerrainFileError(f"{self.path} has rows along {name}: {flipped} makes them run along y")

    def _refuse_degrees(self, transform: Any) -> None:
        rows, columns = self.shape
        longitude, latitude = _apply(transform, columns / 2, rows / 2)
        command = projection_command(self.path.name, longitude, latitude, self.reference.radius)
        raise TerrainFileError(
            f"{self.path} must be in metres, its coordinates are degrees: project it first: {command}"
        )

    def _check_scale(self) -> None:
        """Warns where distances on the map are not those on the ground."""
        from rasterio.errors import RasterioError
        from rasterio.warp import transform

        (rows, columns), step = self.shape, 100.0 / self.metre
        x, y = _apply(self.transform, columns / 2, rows / 2)
        places = [(x, y), (x + step, y), (x, y + step)]
        there = rasterio().crs.CRS.from_wkt(self.reference.geographic)
        xs, ys = ([place[axis] for place in places] for axis in range(2))
        try:
            degrees = list(zip(*transform(self.crs, there, xs, ys)[:2], strict=True))
        except (RasterioError, rasterio()._err.CPLE_BaseError):
            return  # outside of what the projection is made for
        if not np.isfinite(degrees).all():
            return
        metres = [(a * self.metre, b * self.metre) for a, b in places]
        factors = scale_factors(self.reference, metres, degrees)
        if max(abs(factor - 1.0) for factor in factors) > STRETCHED:
            (east, north), radius = degrees[0], self.reference.radius
            command = projection_command(self.path.name, east, north, radius)
            warnings.warn(
                f"{self.path}: its projection makes distances {factors[0]:.3f} times as long along x and "
                f"{factors[1]:.3f} along y as on the ground: {command}",
                TerrainFileWarning,
                stacklevel=2,
            )

    def _measure(self) -> None:
        """Unit and sense of the heights. Fails where the file leaves them open and they are in doubt."""
        index, options = self.band - 1, self.options
        dtype = self.dataset.dtypes[index]
        if dtype.startswith("complex"):
            raise TerrainFileError(f"{self.path} must hold real numbers, got {dtype}")
        self.scale, self.offset = self.dataset.scales[index], self.dataset.offsets[index]
        tags = {key.lower(): value for key, value in self.dataset.tags(self.band).items()}
        unit = (self.dataset.units[index] or tags.get("units") or "").strip()
        picture = dtype == "uint8" and (self.scale, self.offset) == (1.0, 0.0)
        if options.unit is None and not unit and picture:
            told = 'cells of 8 bits without a unit (unit="m" takes them as metres)'
            raise TerrainFileError(f"{self.path} is a picture, not heights: {told}")
        if options.unit is None and not unit and self.dataset.driver in ("PNG", "JPEG", "BMP"):
            raise TerrainFileError(
                f'{self.path} has no unit: unit="mm", or the height of one count in metres, unit=0.01'
            )
        self.unit = 1.0
        if options.unit is not None:
            self.unit = length(options.unit, "unit")
        elif unit:
            try:
                self.unit = length(unit, "unit")
            except ValueError:
                raise TerrainFileError(
                    f'{self.path} has heights in {unit!r}: unit="m", or its length in metres'
                ) from None
        if self.reference.height is not None and options.unit is None:
            if unit and abs(abs(self.reference.height) - self.unit) > 1e-3 * self.unit:
                other = f"{abs(self.reference.height):g}"
                told = f"has heights in {unit} by its band, in units of {other} m by its vertical system"
                raise TerrainFileError(f'{self.path} {told}: unit="{unit}" or unit={other}')
            self.unit = abs(self.reference.height)
        if tags.get("positive", "").lower() == "down" or (self.reference.height or 0.0) < 0.0:
            self.unit = -self.unit
        self.unit_known = bool(options.unit is not None or unit or self.reference.height is not None)
        self.nodata_known = options.nodata is not None
        self.whole = np.issubdtype(np.dtype(dtype), np.integer) and self.scale == 1.0
        # A sample of the whole image, before anything is computed from a part of it.
        rows, columns = self.shape
        side = SAMPLE
        for row, column in ((0.5, 0.5), (0.1, 0.1), (0.9, 0.9)):
            first = [int(max(size - side, 0) * share) for size, share in ((rows, row), (columns, column))]
            parts = [slice(k, min(k + side, size)) for k, size in zip(first, (rows, columns), strict=True)]
            self.doubt(self.heights(*parts))
            if rows <= side and columns <= side:
                break

    def doubt(self, heights: NDArray[np.floating]) -> None:
        """Fails if heights of this image look like something else."""
        found = find_doubt(
            heights, self.spacing, nodata_known=True, unit_known=self.unit_known, whole=self.whole
        )
        if found is not None:
            raise TerrainFileError(f"{self.path}: {found.message}")

    def place(self, row: int, column: int) -> tuple[float, float]:
        """The middle of a pixel in the frame of the map [m]."""
        x, y = _apply(self.transform, column + 0.5, row + 0.5)
        return x * self.metre, y * self.metre

    def heights(self, rows: slice, columns: slice) -> NDArray[np.floating]:
        """Pixels of a window as they lie in the image; NaN where there are none [m]."""
        window = ((rows.start, rows.stop), (columns.start, columns.stop))
        try:
            band = self.dataset.read(self.band, window=window, masked=True)
        except Exception as error:
            raise TerrainFileError(f"{self.path}: {' '.join(str(error).split())}") from None
        plain = (self.scale, self.offset, self.unit) == (1.0, 0.0, 1.0)
        single = band.dtype == np.float32 and plain
        if self.options.nodata is not None and math.isnan(self.options.nodata):
            band = np.ma.getdata(band)
        heights: NDArray[np.floating] = np.ma.filled(
            band.astype(np.float32 if single else np.float64), np.nan
        )
        if self.options.nodata is not None:
            heights[is_fill(heights, self.options.nodata)] = np.nan
        # Some images mark what is not known by infinities beside their own mark.
        heights[np.isinf(heights)] = np.nan
        found = find_doubt(heights, self.spacing, nodata_known=self.nodata_known, unit_known=True)
        if found is not None:
            raise TerrainFileError(f"{self.path}: {found.message}")
        if not plain:
            heights = (heights * self.scale + self.offset) * self.unit
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
            left, bottom, right, top = self.bounds
            where = f"the map has x {left:g} to {right:g}, y {bottom:g} to {top:g}"
            raise TerrainFileError(f"{self.path}: window must overlap the map, got {window}; {where}")
        return self.grid(slice(first[1], last[1] + 1), slice(first[0], last[0] + 1))

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x, least y, largest x and largest y of the pixels [m]."""
        rows, columns = self.shape
        corners = [_apply(self.transform, column, row) for column in (0, columns) for row in (0, rows)]
        xs, ys = ([corner[axis] * self.metre for corner in corners] for axis in range(2))
        return min(xs), min(ys), max(xs), max(ys)

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
