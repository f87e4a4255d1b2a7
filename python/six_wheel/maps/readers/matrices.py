"""Arrays in files: ``.npy`` and ``.npz`` of NumPy, with a place where coordinates stand beside heights."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.errors import one_line
from six_wheel.maps import doubts
from six_wheel.maps.files import Grid, Options, TerrainFileError
from six_wheel.maps.readers.axes import Axis, by_coordinates, check_shape
from six_wheel.maps.readers.points import EAST, NORTH, SCATTERED, find_columns, is_height, lattice
from six_wheel.maps.readers.sources import Source

NUMPY = b"\x93NUMPY"


def read(source: Source, options: Options) -> Grid:
    """The grid of an array, or of a table of points x, y and z; the first row is the southern one."""
    arrays = _load(source)
    points = _points(arrays)
    if points is not None:
        grid = lattice(*(part.ravel().astype(np.float64) for part in points))
        if grid is None:
            raise TerrainFileError(f"{source.path} has {SCATTERED}")
        return grid
    values = arrays[_heights(source, arrays, options)]
    if values.dtype.kind not in "fiu":
        raise TerrainFileError(f"{source.path} must hold real numbers, got {values.dtype}")
    if values.dtype == np.uint8 and options.unit is None:
        raise TerrainFileError(f"{source.path} ", *doubts.cells_of_bits())
    values = values.astype(np.float32 if values.dtype == np.float32 else np.float64)
    try:
        check_shape(values)
        axes = _axes(arrays, values.shape)
        if axes is None:
            return unplaced(source, values, options)
        values, placed = by_coordinates(values, axes, options)
    except ValueError as error:
        if isinstance(error, TerrainFileError):
            raise
        raise TerrainFileError(f"{source.path}: {error}") from None
    return placed._replace(north_up=None).unplaced(values, False)


def _points(arrays: dict[str, NDArray[Any]]) -> list[NDArray[Any]] | None:
    """Coordinates x, y and z of points: three arrays of one shape, or three columns; None for others."""
    values = next(iter(arrays.values()), np.zeros(0))
    if len(arrays) == 1 and values.ndim == 2 and values.shape[1] == 3 and len(values) > 3:
        return list(values.T) if values.dtype.kind in "fiu" and lattice(*values.T * 1.0) else None
    columns = find_columns(list(arrays))
    if columns is None:
        return None
    listed = list(arrays.values())
    found = [listed[column] for column in columns[0]]
    return found if len({array.shape for array in found}) == 1 and found[0].size > 3 else None


def unplaced(source: Source, values: NDArray[Any], options: Options) -> Grid:
    """Rows and columns without a place where the options put them."""
    if options.steps is None:
        words = doubts.no_place("is an array without a place", north_up=False)
        raise TerrainFileError(f"{source.path} ", *words)
    return options.unplaced(values, False)


def _load(source: Source) -> dict[str, NDArray[Any]]:
    """Arrays of a file by name."""
    try:
        with source.open() as file:
            loaded = np.load(file, allow_pickle=False)
            if isinstance(loaded, np.ndarray):
                return {"": loaded}
            return {name: loaded[name] for name in loaded.files}
    except Exception as error:  # NumPy, zipfile and Python's tokenizer, which reads headers, list none
        told = one_line(error)
        raise TerrainFileError(f"{source.path} is no array of numbers, or damaged: {told}") from None


def _heights(source: Source, arrays: dict[str, NDArray[Any]], options: Options) -> str:
    """Name of the array of heights."""
    if options.band is not None and "" not in arrays:
        name = str(options.band)
        if name not in arrays:
            words = doubts.no_name_of_that("array", name, list(arrays), "band", next(iter(arrays)))
            raise TerrainFileError(f"{source.path} ", *words)
        return name
    tables = [name for name, array in arrays.items() if array.ndim == 2]
    named = [name for name in tables if is_height(name)]
    if len(named or tables) == 1 or "" in arrays:
        return (named or tables or [""])[0]
    if not tables:
        listed = doubts.listed([f"{name} {array.shape}" for name, array in arrays.items()]) or "none"
        raise TerrainFileError(f"{source.path} must hold an array of rows and columns, it has {listed}")
    raise TerrainFileError(f"{source.path} ", *doubts.several("arrays", tables, "band", tables[0]))


def _axes(arrays: dict[str, NDArray[Any]], shape: tuple[int, ...]) -> list[Axis] | None:
    """Coordinates of rows and columns that stand beside heights, or None."""
    axes = []
    for words, direction in ((NORTH, "y"), (EAST, "x")):
        found = [name for name, array in arrays.items() if name.lower() in words and array.ndim == 1]
        if len(found) != 1:
            return None
        axes.append(Axis(found[0], arrays[found[0]].astype(np.float64), "m", direction))
    sizes = tuple(axis.places.size for axis in axes)
    return axes if sizes == shape else axes[::-1] if sizes == shape[::-1] else None
