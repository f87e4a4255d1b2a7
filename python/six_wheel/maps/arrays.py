"""Arrays as ground: those with coordinates or a mask, tables of points, and checks of plain ones."""

import math
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.errors import ArgumentTypeError, SuspiciousUnitsWarning
from six_wheel.maps import doubts
from six_wheel.maps.doubts import answer
from six_wheel.maps.files import Grid, Options, bracketed_unit, length
from six_wheel.maps.plausibility import find_fill, find_unit, is_fill
from six_wheel.maps.readers.axes import Axis, by_coordinates, check_shape
from six_wheel.maps.readers.points import EAST, NORTH, SCATTERED, find_columns, lattice
from six_wheel.maps.readers.reference import read_reference
from six_wheel.robot_description.doubts import DoubtError, Proposal


def check_plausibility(heights: Any, spacing: Any, nodata_open: bool, unit_open: bool) -> None:
    """Fails, or warns, where plain heights look like something else."""
    try:
        array = np.asarray(heights)
    except ValueError:
        return  # no array at all
    if array.dtype == object and isinstance(heights, np.ndarray):
        raise ValueError("heights must be real numbers, got dtype object: heights.astype(float)")
    check_shape(array)
    if array.ndim != 2 or array.dtype.kind not in "fiu" or min(array.shape) < 2:
        return
    steps = Options(spacing=spacing).checked().steps
    assert steps is not None
    if unit_open and array.dtype == np.uint8 and isinstance(heights, np.ndarray):
        raise _doubt("heights must be a map, got what ", *doubts.cells_of_bits())
    if nodata_open:
        _check_fill(array)
    if unit_open:
        whole = isinstance(heights, np.ndarray) and heights.dtype.kind in "iu"
        _check_unit(array, steps, whole)


def _doubt(*words: str | Proposal) -> ValueError:
    """The error of a doubt about an argument, which Python alone utters."""
    return ValueError(str(DoubtError(*words)))


def _check_fill(values: NDArray[Any], known: tuple[float, ...] = ()) -> None:
    values = values if values.dtype.kind == "f" else values.astype(np.float64)
    finding = find_fill(values, known)
    if finding is not None:
        raise _doubt("heights must be heights, got marks of unknown ones? ", *finding)


def _check_unit(values: NDArray[Any], steps: tuple[float, float], whole: bool) -> None:
    values = values if values.dtype.kind == "f" else values.astype(np.float64)
    finding = None if np.isinf(values).any() else find_unit(values, steps, whole=whole)
    if finding is None:
        return
    if 3 in values.shape:
        raise _doubt(
            "heights must have rows and columns, got three, scattered points? "
            "grid them first (scipy.interpolate.griddata), ",
            answer("unit", "m"),
            " if they are heights",
        )
    warnings.warn(f"Terrain: {DoubtError(*finding)}", SuspiciousUnitsWarning, stacklevel=3)


def read(
    heights: Any, *, spacing: Any, origin: Any, north_up: bool | None, nodata: Any, unit: Any
) -> tuple[NDArray[np.floating], tuple[float, float], tuple[float, float]]:
    """Heights in metres, spacing and place of node (0, 0) of what `Terrain` is given."""
    _refuse(heights)
    options = Options(nodata=nodata, unit=unit, north_up=north_up, spacing=spacing, origin=origin).checked()
    points = _points(heights)
    if points is not None:
        values, options = points.heights, options._replace(spacing=points.spacing, origin=points.origin)
        axes = None
    else:
        axes = _axes(heights)
        values = _values(heights)
        check_shape(values)
    whole = values.dtype.kind in "iu"
    factor, shift, marks = _attributes(heights)
    marks += options.marks
    if marks or factor != 1.0 or shift:
        values = np.array(values, np.float32 if values.dtype == np.float32 else np.float64)
    for mark in marks:
        values[is_fill(values, mark)] = np.nan
    if values.ndim == 2 and values.dtype.kind in "fiu" and not options.every_number_counts:
        _check_fill(values, options.marks)
    if axes is not None:
        values, options = by_coordinates(values, axes, options)
    if options.steps is None:
        raise _doubt(*doubts.no_spacing())
    if options.unit is not None:
        factor, shift = float(options.unit), 0.0
    if factor != 1.0 or shift:
        values = values * factor + shift
    if options.unit is None and values.ndim == 2 and values.dtype.kind in "fiu" and min(values.shape) > 1:
        _check_unit(values, options.steps, whole and factor == 1.0)
    grid = options.unplaced(values, False)
    return np.ascontiguousarray(grid.heights), grid.spacing, grid.origin


def _values(heights: Any) -> NDArray[Any]:
    """The numbers of an array; NaN where a mask hides them or a table has none."""
    if isinstance(heights, np.ma.MaskedArray) and heights.dtype.kind in "fiu":
        single = heights.dtype == np.float32
        filled: NDArray[Any] = np.ma.filled(heights.astype(np.float32 if single else np.float64), np.nan)
        return filled if np.ma.getmaskarray(heights).any() else np.ma.getdata(heights)
    try:
        values = np.asarray(heights)
    except ValueError as error:
        if error.__traceback__ is not None and error.__traceback__.tb_next is not None:
            raise  # by the object's own code, not by NumPy
        kind = type(heights).__name__
        raise ValueError(f"heights must be numbers of one rectangular shape, got a ragged {kind}") from None
    if values.dtype == object:
        try:
            is_table = hasattr(heights, "iloc")
            values = heights.to_numpy(np.float64, na_value=np.nan) if is_table else values.astype(np.float64)
        except (TypeError, ValueError) as error:
            raise ValueError(f"heights must be real numbers: {error}") from None
    if values.dtype.kind not in "fiu":
        raise ArgumentTypeError(f"heights must be real numbers, got dtype {values.dtype}")
    return values


def _refuse(heights: Any) -> None:
    if isinstance(heights, str) or hasattr(heights, "__fspath__"):
        raise ValueError(f"heights must be an array, got a path: sw.Terrain.read({str(heights)!r})")
    if isinstance(heights, (bytes, bytearray)):
        raise ValueError("heights must be an array, got bytes: np.frombuffer(...).reshape(rows, columns)")
    if hasattr(heights, "transform") and hasattr(heights, "read"):
        raise ValueError("heights must be an array, got a dataset: sw.Terrain.read(path) keeps its place")
    if hasattr(heights, "height_at"):
        raise ValueError(
            "heights must be an array, got a Terrain, which is ground already: ground.replace(...)"
        )
    if isinstance(heights, dict):
        raise ValueError(
            f"heights must be an array, got a dict of {', '.join(map(str, heights))}: one of its values"
        )
    if hasattr(heights, "data_vars"):
        names = list(map(str, heights.data_vars))
        raise ValueError(f'heights must be one variable, got {", ".join(names)}: dataset["{names[0]}"]')
    if hasattr(heights, "collect") and not hasattr(heights, "__array__"):
        raise ValueError("heights must be an array, got a lazy table: heights.collect()")
    if hasattr(heights, "unstack") and getattr(heights, "ndim", 2) == 1:
        raise ValueError("heights must have two axes, got a column: .unstack() of an index of y and x")
    if hasattr(heights, "dims") and len(heights.dims) > 2:
        listed, one = ", ".join(map(str, heights.dims)), heights.dims[0]
        raise ValueError(f"heights must have two dimensions, got {listed}: .isel({one}=0)")


def _points(heights: Any) -> Grid | None:
    """The grid of a table whose columns are called x, y and z; None for any other."""
    columns = getattr(heights, "columns", None)
    if columns is None or not all(isinstance(name, str) for name in columns):
        return None
    found = find_columns(list(columns))
    if found is None:
        if len(columns) > 2 and str(columns[0]).lower() in (*EAST, *NORTH):
            raise ValueError(
                f"heights must be heights, got {columns[0]} as first column: "
                f'table.drop("{columns[0]}") with spacing= and origin=, or one row per point x, y, z'
            )
        return None
    indices, units = found
    if any(unit.lower().startswith("deg") for unit in units):
        raise ValueError("coordinates must be in metres, got degrees: project them first (pyproj)")
    table = [np.asarray(heights[columns[index]], np.float64) for index in indices]
    grid = lattice(*(column * length(unit, "unit") for column, unit in zip(table, units, strict=True)))
    if grid is None:
        raise ValueError(f"heights must have rows and columns, got {SCATTERED}")
    return grid


def _attributes(heights: Any) -> tuple[float, float, list[float]]:
    """Unit and offset of the heights by the attributes of a DataArray [m], and its marks of unknown ones.

    The unit is negative where heights count downwards.
    """
    attributes = getattr(heights, "attrs", None) or {}
    stated = attributes.get("units") or bracketed_unit(attributes.get("long_name"))
    size = length(str(stated or "m"), "units of heights")
    sense = attributes.get("positive", "down" if attributes.get("standard_name") == "depth" else "up")
    if str(sense).lower() == "down":  # CF: a depth counts downwards
        size = -size
    marks = [attributes[name] for name in ("_FillValue", "missing_value", "nodata") if name in attributes]
    scale, offset = (float(attributes.get(*pair)) for pair in (("scale_factor", 1.0), ("add_offset", 0.0)))
    known = [float(mark) for mark in marks if np.ndim(mark) == 0 and not math.isnan(float(mark))]
    return size * scale, size * offset, known


def _axes(heights: Any) -> list[Axis] | None:
    """Coordinates along both axes; None where there are none."""
    if hasattr(heights, "dims") and hasattr(heights, "coords"):
        return _labelled_axes(heights)
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
        return [
            Axis(name, value, "m", _direction(name, {})) for name, value in zip(names, values, strict=True)
        ]
    return None


def _labelled_axes(heights: Any) -> list[Axis] | None:
    """Axes of a DataArray, without places where it has no coordinates but says which is which."""
    reference = heights.coords["spatial_ref"].attrs if "spatial_ref" in heights.coords else {}
    system = read_reference(str(reference.get("crs_wkt", "")))
    turned = str(reference.get("GeoTransform", "")).split()
    if len(turned) == 6 and (float(turned[2]) or float(turned[4])):
        raise ValueError(
            "heights must have coordinates of x and y, got a turned image: sw.Terrain.read(path)"
        )
    axes = []
    for dim in heights.dims:
        known = dim in heights.coords
        attributes = heights.coords[dim].attrs if known else {}
        unit = "degrees" if system.degrees else str(attributes.get("units", system.plane))
        places = np.asarray(heights.coords[dim].values, np.float64) if known else np.zeros(0)
        axes.append(Axis(str(dim), places, unit, _direction(str(dim), attributes)))
    directions = [axis.direction for axis in axes]
    if len(axes) != 2 or not any(directions):
        if all(axis.places.size for axis in axes):
            first, second = (axis.name for axis in axes)
            raise ValueError(
                f"heights must have dimensions y and x, got {first} and {second}: "
                f'.rename({first}="y", {second}="x")'
            )
        return None
    return axes


def _direction(name: str, attributes: Any) -> str:
    """``x`` or ``y`` by the attributes of a coordinate or by its name; else nothing."""
    standard = str(attributes.get("standard_name", ""))
    for direction, words in (("x", EAST), ("y", NORTH)):
        if (
            standard == f"projection_{direction}_coordinate"
            or attributes.get("axis", "").lower() == direction
        ):
            return direction
        if not standard and name.lower() in words:
            return direction
    return ""
