"""Axes of arrays: their coordinates, and shapes that are none of a map."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from six_wheel.maps.files import Options, length
from six_wheel.maps.readers.points import lattice

EVEN = 1e-3  # of a step: coordinates in single precision
BANDS = 16  # more than this along the first axis are rows


class Axis(NamedTuple):
    """Coordinates along one axis of an array."""

    name: str
    places: NDArray[np.float64]
    unit: str
    direction: str = ""  # `x`, `y`, or nothing where neither name nor attributes say it


def check_shape(array: NDArray[Any]) -> None:
    """Fails for what is no matrix of heights by its shape: several bands, one list, points."""
    if array.ndim == 3:
        if array.shape[0] <= BANDS:
            one = "src.read(1), not src.read()"
        else:
            one = "a picture? one band of it is heights[:, :, 0]"
        raise ValueError(
            f"heights must have at least two rows and two columns, got shape {array.shape}: {one}"
        )
    if array.ndim == 1 and array.size > 1 and array.dtype.kind in "fiu":
        made = "heights.reshape(rows, columns)"
        raise ValueError(
            f"heights must have at least two rows and two columns, got shape {array.shape}: {made}"
        )
    if array.ndim == 2 and array.dtype.kind in "fiu" and 3 in array.shape and max(array.shape) >= 9:
        turned = array.shape[1] != 3
        _refuse_points((array.T if turned else array).astype(np.float64), ".T" if turned else "")


def _refuse_points(array: NDArray[np.float64], turned: str) -> None:
    """Fails where rows are points x, y, z of a grid."""
    grid = lattice(*array.T)
    if grid is not None and grid.heights.size == len(array) and min(grid.heights.shape) > 2:
        order = np.lexsort((array[:, 0], array[:, 1]))
        sort = "" if (order == np.arange(len(array))).all() else "[np.lexsort((p[:, 0], p[:, 1]))]"
        rows, columns = grid.heights.shape
        points = "p" if not turned else "p = heights.T; p"
        made = f"sw.Terrain({points}{sort}[:, 2].reshape({rows}, {columns}), {grid.spacing}, {grid.origin})"
        raise ValueError(f"heights must have rows and columns, got points x, y, z: {made}")


def by_coordinates(
    values: NDArray[np.floating], axes: list[Axis], options: Options
) -> tuple[NDArray[np.floating], Options]:
    """Heights with rows along +y and columns along +x, and their place."""
    if axes[0].direction == "x" or (axes[1].direction == "y" and axes[0].direction != "y"):
        values, axes = values.T, axes[::-1]
    if not all(axis.places.size for axis in axes):
        return values, options
    steps, firsts = [], []
    for number, (name, places, unit, _) in enumerate(axes):
        if unit.startswith("degree") or (unit in ("m", "1.0") and name.lower().startswith(("lat", "lon"))):
            raise ValueError(
                f"coordinates {name} must be in metres, got degrees: "
                "project first (rioxarray, .rio.reproject)"
            )
        places = places * length(unit, f"units of {name}")
        differences = np.diff(places)
        step = (places[-1] - places[0]) / max(len(places) - 1, 1)
        if not (len(places) > 1 and step != 0 and np.abs(differences - step).max() <= EVEN * abs(step)):
            got = f"steps of {differences.min():g} to {differences.max():g}" if differences.size else "one"
            raise ValueError(
                f"coordinates {name} must be evenly spaced, got {got}: interpolate first (.interp)"
            )
        if step < 0:
            values = np.flip(values, number)
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
