"""Arrays as ground: those with coordinates or a mask, and doubts about those without."""

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.errors import SuspiciousUnitsWarning
from six_wheel.maps.doubts import find_doubt, is_fill
from six_wheel.maps.files import Options, length
from six_wheel.maps.grids import lattice

__all__ = ["doubt", "read"]

EVEN = 1e-3  # of a step: coordinates in single precision
EAST = ("x", "easting", "east", "e", "column", "columns", "longitude", "lon")
NORTH = ("y", "northing", "north", "n", "row", "rows", "latitude", "lat")


def doubt(heights: Any, spacing: Any, nodata_open: bool, unit_open: bool) -> None:
    """Fails, or warns, where plain heights look like something else."""
    try:
        array = np.asarray(heights)
    except ValueError:
        return  # no array at all
    if array.ndim == 3 and array.shape[0] == 1:
        raise ValueError(f"heights must have two axes, got shape {array.shape}: src.read(1), not src.read()")
    if array.ndim != 2 or array.dtype.kind not in "fiu" or min(array.shape) < 2:
        return
    steps = Options(spacing=spacing).checked().steps
    assert steps is not None
    if unit_open and array.dtype == np.uint8 and isinstance(heights, np.ndarray):
        raise ValueError(
            'heights must be heights, got cells of 8 bits, a picture: unit="m" if they are metres'
        )
    if array.shape[1] == 3 and array.shape[0] >= 9:
        _refuse_points(array.astype(np.float64))
    if array.dtype.kind != "f":
        array = array.astype(np.float64)
    if np.isinf(array).any():
        return
    whole = isinstance(heights, np.ndarray) and heights.dtype.kind in "iu"
    found = find_doubt(array, steps, nodata_known=not nodata_open, unit_known=not unit_open, whole=whole)
    if found is not None and found.is_fill:
        raise ValueError(f"heights must be heights, got marks of unknown ones? {found.message}")
    if found is not None:
        warnings.warn(f"Terrain: {found.message}", SuspiciousUnitsWarning, stacklevel=2)


def _refuse_points(array: NDArray[np.float64]) -> None:
    """Fails where rows are points x, y, z of a grid."""
    grid = lattice(*array.T)
    if grid is not None and grid.heights.size == len(array) and min(grid.heights.shape) > 2:
        order = np.lexsort((array[:, 0], array[:, 1]))
        sort = "" if (order == np.arange(len(array))).all() else "[np.lexsort((p[:, 0], p[:, 1]))]"
        rows, columns = grid.heights.shape
        made = f"sw.Terrain(p{sort}[:, 2].reshape({rows}, {columns}), {grid.spacing}, {grid.origin})"
        raise ValueError(f"heights must have rows and columns, got points x, y, z: {made}")


def read(
    heights: Any, *, spacing: Any, origin: Any, north_up: bool | None, nodata: Any, unit: Any
) -> tuple[NDArray[np.floating], tuple[float, float], tuple[float, float]]:
    """Heights in metres, spacing and place of node (0, 0) of what `Terrain` is given."""
    _refuse(heights)
    options = Options(nodata=nodata, unit=unit, north_up=north_up, spacing=spacing, origin=origin).checked()
    axes = _axes(heights)
    if isinstance(heights, np.ma.MaskedArray):
        single = heights.dtype == np.float32
        values = np.ma.filled(heights.astype(np.float32 if single else np.float64), np.nan)
    else:
        values = np.asarray(heights)
    unknown = np.isnan(options.nodata) if options.nodata is not None else True
    if not unknown:
        values = np.array(values, np.float32 if values.dtype == np.float32 else np.float64)
        values[is_fill(values, float(options.nodata or 0.0))] = np.nan
    if axes is not None:
        values, options = _by_coordinates(values, axes, options)
    if options.steps is None:
        raise ValueError(
            "spacing must be given where heights have no coordinates: spacing=0.1, between cells in metres"
        )
    factor = float(options.unit or _attribute_unit(heights))
    if factor != 1.0:
        values = values * factor
    doubt(values, options.steps, options.nodata is None, options.unit is None)
    grid = options.unplaced(values, False)
    return np.ascontiguousarray(grid.heights), grid.spacing, grid.origin


def _refuse(heights: Any) -> None:
    if isinstance(heights, (str, bytes)) or hasattr(heights, "__fspath__"):
        raise ValueError(f"heights must be an array, got a path: sw.Terrain.read({str(heights)!r})")
    if hasattr(heights, "transform") and hasattr(heights, "read"):
        raise ValueError("heights must be an array, got a dataset: sw.Terrain.read(path) keeps its place")
    if isinstance(heights, dict):
        raise ValueError(
            f"heights must be an array, got a dict of {', '.join(map(str, heights))}: one of its values"
        )
    if hasattr(heights, "data_vars"):
        names = list(map(str, heights.data_vars))
        raise ValueError(f'heights must be one variable, got {", ".join(names)}: dataset["{names[0]}"]')


def _attribute_unit(heights: Any) -> float:
    """Unit that the attributes of a DataArray state [m]; negative where heights count downwards."""
    attributes = getattr(heights, "attrs", None) or {}
    unit = str(attributes.get("units", "m"))
    down = str(attributes.get("positive", "up")).lower() == "down"
    return length(unit, "units of heights") * (-1.0 if down else 1.0)


def _axes(heights: Any) -> list[tuple[str, NDArray[np.float64], str]] | None:
    """Name, values and unit of the coordinates along both axes; None where there are none."""
    if hasattr(heights, "dims") and hasattr(heights, "coords"):
        dims = [str(name) for name in heights.dims]
        if len(dims) != 2 or not all(name in heights.coords for name in heights.dims):
            return None
        coords = [heights.coords[name] for name in heights.dims]
        units = [str(getattr(coord, "attrs", {}).get("units", "m")) for coord in coords]
        return [
            (name, np.asarray(coord.values, np.float64), unit)
            for name, coord, unit in zip(dims, coords, units, strict=True)
        ]
    if hasattr(heights, "iloc") and hasattr(heights, "columns"):
        kinds = {type(index).__name__ for index in (heights.index, heights.columns)}
        if "RangeIndex" in kinds:
            return None
        try:
            values = [np.asarray(index, np.float64) for index in (heights.index, heights.columns)]
        except (TypeError, ValueError):
            listed = ", ".join(map(str, heights.columns[:4]))
            pivot = "table.pivot(index='y', columns='x', values='z')"
            raise ValueError(f"heights must have numbers for columns, got {listed}: {pivot}") from None
        names = (str(heights.index.name or "y"), str(heights.columns.name or "x"))
        return [(name, value, "m") for name, value in zip(names, values, strict=True)]
    return None


def _by_coordinates(
    values: NDArray[np.floating], axes: list[tuple[str, NDArray[np.float64], str]], options: Options
) -> tuple[NDArray[np.floating], Options]:
    """Heights with rows along +y and columns along +x, and their place."""
    if (axes[0][0].lower() in EAST and axes[1][0].lower() not in EAST) or (
        axes[1][0].lower() in NORTH and axes[0][0].lower() not in NORTH
    ):
        values, axes = values.T, axes[::-1]
    steps, firsts = [], []
    for axis, (name, places, unit) in enumerate(axes):
        if unit.startswith("degree"):
            raise ValueError(
                f"coordinates {name} must be in metres, got {unit}: project first (rioxarray, .rio.reproject)"
            )
        places = places * length(unit, f"units of {name}")
        differences = np.diff(places)
        step = (places[-1] - places[0]) / max(len(places) - 1, 1)
        if not (len(places) > 1 and step != 0 and np.abs(differences - step).max() <= EVEN * abs(step)):
            got = f"steps of {differences.min():g} to {differences.max():g}"
            raise ValueError(
                f"coordinates {name} must be evenly spaced, got {got}: interpolate first (.interp)"
            )
        if step < 0:
            values = np.flip(values, axis)
        steps.append(abs(float(step)))
        firsts.append(float(min(places[0], places[-1])))
    spacing, origin = (steps[1], steps[0]), (firsts[1], firsts[0])
    given = options.steps
    if given is not None and not np.allclose(given, spacing, rtol=EVEN, atol=0):
        raise ValueError(f"spacing must be that of the coordinates, {spacing}, got {given}: leave it out")
    if options.origin is not None and not np.allclose(
        options.origin, origin, rtol=0, atol=EVEN * min(spacing)
    ):
        raise ValueError(
            f"origin must be that of the coordinates, {origin}, got {options.origin}: leave it out"
        )
    if options.north_up is not None:
        raise ValueError("north_up must be left out: the coordinates say which row is the northern one")
    return values, options._replace(spacing=spacing, origin=origin)
