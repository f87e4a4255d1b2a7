"""Place of an image in the plane: transform, units of coordinates, axes, distances on the ground."""

import contextlib
import math
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from six_wheel.maps import doubts
from six_wheel.maps.files import Options, TerrainFileError
from six_wheel.maps.plausibility import is_in_degrees
from six_wheel.maps.readers import netcdf
from six_wheel.maps.readers.points import EAST
from six_wheel.maps.readers.reference import (
    UNKNOWN,
    Reference,
    in_degrees,
    projection_command,
    scale_factors,
    shell_names,
)

STRETCHED = 0.03  # of a distance
RIGHT_ANGLE = 1e-6  # cosine of the angle between axes: a centimetre over ten kilometres


class TerrainFileWarning(UserWarning):
    """A map that can be used, with distances that are not those on the ground."""


class Placement(NamedTuple):
    """Pixels in the frame of the map."""

    transform: Any  # affine, from column and row to coordinates
    metre: float  # unit of the coordinates [m]
    shape: tuple[int, int]

    @property
    def right(self) -> tuple[float, float]:
        """From a pixel to the next of its row [m]."""
        return self.transform.a * self.metre, self.transform.d * self.metre

    @property
    def down(self) -> tuple[float, float]:
        """From a pixel to the next of its column [m]."""
        return self.transform.b * self.metre, self.transform.e * self.metre

    @property
    def spacing(self) -> tuple[float, float]:
        """Between columns and between rows [m]."""
        return math.hypot(*self.right), math.hypot(*self.down)

    @property
    def flipped(self) -> bool:
        """True where rows go against the y axis of a grid whose x axis goes along them."""
        return self.right[0] * self.down[1] - self.right[1] * self.down[0] < 0

    @property
    def yaw(self) -> float:
        """Angle from the x axis of the frame to the rows [rad]."""
        return math.atan2(self.right[1], self.right[0])

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x, least y, largest x and largest y of the pixels [m]."""
        rows, columns = self.shape
        corners = [apply(self.transform, column, row) for column in (0, columns) for row in (0, rows)]
        xs, ys = ([corner[axis] * self.metre for corner in corners] for axis in range(2))
        return min(xs), min(ys), max(xs), max(ys)

    def middle(self, row: int, column: int) -> tuple[float, float]:
        """The middle of a pixel in the frame of the map [m]."""
        x, y = apply(self.transform, column + 0.5, row + 0.5)
        return x * self.metre, y * self.metre


def apply(transform: Any, x: float, y: float) -> tuple[float, float]:
    """Coordinates of a column and a row; versions of affine do not agree on the operator for them."""
    return transform.a * x + transform.b * y + transform.c, transform.d * x + transform.e * y + transform.f


def place(dataset: Any, path: Path, options: Options, reference: Reference) -> Placement:
    """Place of an open image, or where the options put it. Fails where neither says, and for degrees."""
    transform, shape, metre = dataset.transform, dataset.shape, reference.plane
    axes = netcdf.axes_of(dataset) if dataset.driver == "netCDF" else {}
    if reference.degrees:
        raise in_degrees(path, apply(transform, shape[1] / 2, shape[0] / 2), reference)
    numbers = tuple(transform)[:6]
    if numbers in ((1, 0, 0, 0, 1, 0), (1, 0, 0, 0, -1, 0)) or not all(
        value == 0 or 1e-300 < abs(value) < 1e300 for value in numbers
    ):
        if dataset.gcps[0] or dataset.rpcs:
            told = "is placed by control points alone: gdalwarp"
            raise TerrainFileError(f"{path} {told} {shell_names(path, '_placed.tif')}")
        if len(axes) == 2:
            told = f"has coordinates {axes['x']} and {axes['y']} with uneven steps"
            raise TerrainFileError(f"{path} {told}: interpolate first (xarray, .interp)")
        # GDAL turns over what NetCDF stores, taking its first row for the southern one.
        from_south = dataset.driver == "netCDF"
        transform, metre = _by_options(path, type(transform), shape, options, from_south), 1.0
    elif options.spacing is not None or options.origin is not None or options.north_up is not None:
        raise TerrainFileError(f"{path} ", *doubts.own_place(options))
    elif dataset.crs is None and axes:
        metre = netcdf.unit_of_axes(dataset, path, axes)
    ends = [apply(transform, column + 0.5, 0.5)[0] for column in (0, shape[1] - 1)]
    # Coordinates without any attribute are not in the metadata, but have their names.
    names = [axes["x"]] if "x" in axes else [each for word in EAST for each in (word, word.capitalize())]
    own = dataset.driver == "netCDF" and transform == dataset.transform
    if own and netcdf.is_transposed(path, (ends[0], ends[1]), shape, names):
        transform = type(transform)(*numbers[3:], *numbers[:3])
    placed = Placement(transform, metre, shape)
    right, down, spacing = np.array(placed.right), np.array(placed.down), placed.spacing
    if not min(spacing) > 0:
        raise TerrainFileError(f"{path} must have pixels with a size, got {numbers}")
    if abs(right @ down) > RIGHT_ANGLE * spacing[0] * spacing[1]:
        warp = f"gdalwarp {shell_names(path, '_square.tif')}"
        raise TerrainFileError(f"{path} must have axes at right angles, got {numbers}: {warp}")
    if reference == UNKNOWN and is_in_degrees(placed.bounds[:2], spacing, shape):
        raise in_degrees(path, placed.bounds[:2], reference)
    if reference.geographic is not None and dataset.crs.is_projected:
        _check_scale(dataset, path, placed, reference)
    return placed


def _by_options(path: Path, affine: Any, shape: tuple[int, int], options: Options, from_south: bool) -> Any:
    """Transform of an image without one; `from_south` where the first row in the file is the last here."""
    if options.steps is None:
        raise TerrainFileError(f"{path} ", *doubts.no_place(north_up=not from_south))
    (dx, dy), (x, y) = options.steps, options.first
    north_up = options.north_up is None or options.north_up is not from_south
    top = y + dy * (shape[0] - 0.5) if north_up else y - dy / 2
    return affine(dx, 0, x - dx / 2, 0, -dy if north_up else dy, top)


def _check_scale(dataset: Any, path: Path, placed: Placement, reference: Reference) -> None:
    """Warns where distances on the map are not those on the ground."""
    import rasterio
    from rasterio.errors import CRSError, RasterioError
    from rasterio.warp import transform

    (rows, columns), metre = placed.shape, placed.metre
    x, y = apply(placed.transform, columns / 2, rows / 2)
    step = 100.0 / metre
    places = [(x, y), (x + step, y), (x, y + step)]
    degrees = list[tuple[float, float]]()
    # Outside of what the projection is made for, and where PROJ cannot undo it, there is no scale to compare.
    with contextlib.suppress(CRSError, RasterioError, rasterio._err.CPLE_BaseError):
        there = rasterio.crs.CRS.from_wkt(reference.geographic)
        xs, ys = ([place[axis] for place in places] for axis in range(2))
        east, north = transform(dataset.crs, there, xs, ys)[:2]
        degrees = list(zip(east, north, strict=True))
    if not degrees or not np.isfinite(degrees).all():
        return
    factors = scale_factors(reference, [(a * metre, b * metre) for a, b in places], degrees)
    if max(abs(factor - 1.0) for factor in factors) > STRETCHED:
        command = projection_command(path, *degrees[0], reference.radius)
        warnings.warn(
            f"{path}: its projection makes distances {factors[0]:.3f} times as long along x and "
            f"{factors[1]:.3f} along y as on the ground: {command}",
            TerrainFileWarning,
            stacklevel=2,
        )
