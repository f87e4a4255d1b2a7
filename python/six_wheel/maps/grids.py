"""Maps as text: ESRI ASCII grids, tables of x, y and z, and one list of extents and heights."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from six_wheel.maps.doubts import is_fill
from six_wheel.maps.files import Grid, Options, TerrainFileError
from six_wheel.maps.reference import UNKNOWN, Reference, read_reference

__all__ = ["lattice", "read"]

CORNERS = ("xllcorner", "xllcenter", "yllcorner", "yllcenter")
KEYS = ("ncols", "nrows", *CORNERS, "cellsize", "dx", "dy", "nodata_value", "nodata")
COMMENTS = ("#", ";", "//", "%")
ON_LATTICE = 1e-3  # of a step


def read(path: Path, text: str, options: Options) -> tuple[Grid, Reference]:
    """The grid of a text, and what is known of its units.

    An ESRI ASCII grid begins with ``ncols``; heights stand for the middle of their cells, the northern row
    first. A table has rows of x, y and z, in any order, with or without a line of names. Anything else is one
    list, separated by commas: least x, largest x, number of x, least y, largest y, number of y, then heights,
    x running fastest.
    """
    lines = [line for line in text.lstrip("\ufeff").splitlines() if line.strip()]
    lines = [line for line in lines if not line.lstrip().startswith(COMMENTS)]
    reference = _projection(path)
    if lines and lines[0].split()[0].lower() in KEYS:
        return _scaled(_esri(path, lines), reference, options, path), reference
    table = _table(lines)
    if table is not None:
        return _scaled(_points(path, *table), reference, options, path), reference
    return _list(path, "\n".join(lines)), reference


def _projection(path: Path) -> Reference:
    projection = path.with_suffix(".prj")
    if not projection.exists():
        return UNKNOWN
    reference = read_reference(projection.read_text(errors="replace"))
    if reference.degrees:
        command = f"gdalwarp -t_srs EPSG:326NN {path.name} {path.stem}.tif, NN the UTM zone"
        raise TerrainFileError(
            f"{path} must be in metres, its coordinates are degrees: project it first: {command}"
        )
    return reference


def _scaled(grid: Grid, reference: Reference, options: Options, path: Path) -> Grid:
    if options.spacing is not None or options.origin is not None or options.north_up is not None:
        raise TerrainFileError(f"{path} has a place of its own: leave spacing, origin and north_up out")
    (dx, dy), (x, y), metre = grid.spacing, grid.origin, reference.plane
    return grid._replace(spacing=(dx * metre, dy * metre), origin=(x * metre, y * metre))


def _numbers(path: Path, text: str, separator: str | None) -> NDArray[np.float64]:
    parts = text.replace("\n", separator).split(separator) if separator else text.split()
    try:
        return np.array([part for part in map(str.strip, parts) if part], dtype=np.float64)
    except ValueError as error:
        raise TerrainFileError(f"{path}: {error}") from None


def _esri(path: Path, lines: list[str]) -> Grid:
    header = dict[str, float]()
    for number, line in enumerate(lines):
        key, *value = line.split()[:2] or [""]
        if key.lower() not in KEYS:
            break
        try:
            header[key.lower()] = float(value[0].replace(",", "."))
        except (IndexError, ValueError):
            raise TerrainFileError(f"{path}:{number + 1}: {key} must be a number, got {line!r}") from None
    else:
        number = len(lines)
    sizes = (header.get("cellsize", header.get("dx")), header.get("cellsize", header.get("dy")))
    (dx, dy), shape = sizes, (header.get("nrows"), header.get("ncols"))
    if dx is None or dy is None or None in shape:
        raise TerrainFileError(f"{path} must give ncols, nrows and cellsize")
    rows, columns = (int(count or 0) for count in shape)
    body = "\n".join(lines[number:])
    if "," in body and "." not in body:
        body = body.replace(",", ".")
    heights = _numbers(path, body, None)
    if heights.size != rows * columns:
        raise TerrainFileError(f"{path} must hold {rows} x {columns} heights, got {heights.size}")
    # Without the line it is -9999 (ESRI ASCII raster format).
    heights[is_fill(heights, header.get("nodata_value", header.get("nodata", -9999.0)))] = np.nan
    x = header.get("xllcenter", header.get("xllcorner", 0.0) + dx / 2)
    y = header.get("yllcenter", header.get("yllcorner", 0.0) + dy / 2)
    return Grid(heights.reshape(rows, columns)[::-1], (dx, dy), (x, y))


def _table(lines: list[str]) -> tuple[NDArray[np.float64], list[str] | None] | None:
    """Rows of three numbers and the names above them; None where the text is no table of them."""
    if len(lines) < 4:
        return None
    head = next((mark for mark in (";", "\t", ",") if mark in lines[-1]), None)
    rows = [[part.strip() for part in line.split(head)] for line in lines]
    names = None
    try:
        [float(part) for part in rows[0]]
    except ValueError:
        names, rows = [re.sub(r'["\s]', "", name).lower() for name in rows[0]], rows[1:]
    if head == ";":
        rows = [[part.replace(",", ".") for part in row] for row in rows]
    if any(len(row) != 3 for row in rows):
        return None
    try:
        return np.array(rows, dtype=np.float64), names
    except ValueError:
        return None


def _points(path: Path, table: NDArray[np.float64], names: list[str] | None) -> Grid:
    order = (0, 1, 2)
    if names is not None and {name[:1] for name in names} == {"x", "y", "z"}:
        starts = [name[:1] for name in names]
        order = (starts.index("x"), starts.index("y"), starts.index("z"))
    x, y, z = (table[:, column] for column in order)
    grid = lattice(x, y, z)
    if grid is None:
        raise TerrainFileError(
            f"{path} has scattered points: grid them first (gdal_grid, or scipy.interpolate.griddata)"
        )
    return grid


def lattice(x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64]) -> Grid | None:
    """Points as a grid, NaN where none is; None unless they lie on one whose cells are mostly known."""
    axes = []
    for values in (x, y):
        places = np.unique(values[np.isfinite(values)])
        if places.size < 2:
            return None
        step = float(np.diff(places)[np.diff(places) > 1e-6 * np.ptp(places)].min())
        index = np.rint((values - places[0]) / step)
        # The mean step has more digits than the least one.
        step = float((places[-1] - places[0]) / index.max())
        index = np.rint((values - places[0]) / step)
        if not np.abs(values - places[0] - index * step).max() <= ON_LATTICE * step:
            return None
        axes.append((float(places[0]), step, index.astype(int)))
    (x0, dx, columns), (y0, dy, rows) = axes
    shape = (int(rows.max()) + 1, int(columns.max()) + 1)
    if shape[0] * shape[1] > 4 * x.size:
        return None
    heights = np.full(shape, np.nan)
    heights[rows, columns] = z
    return Grid(heights, (dx, dy), (x0, y0))


def _list(path: Path, text: str) -> Grid:
    lines = text.splitlines()
    separator = "," if "," in text else None
    widths = {len(line.split(separator)) for line in lines}
    if len(lines) > 1 and len(widths) == 1 and (separator is None or len(lines) > 6) and widths.pop() > 1:
        mark = ', delimiter=","' if separator else ""
        made = f'sw.Terrain(np.loadtxt("{path.name}"{mark}), spacing=0.1)'
        raise TerrainFileError(f"{path} is a matrix without a place: {made}")
    numbers = _numbers(path, text, ",")
    if numbers.size < 6:
        raise TerrainFileError(f"{path} must begin with x min, x max, x count, y min, y max, y count")
    x0, x1, columns, y0, y1, rows = numbers[:6]
    if not (columns >= 2 and rows >= 2 and columns % 1 == 0 and rows % 1 == 0):
        raise TerrainFileError(f"{path} must have at least two x and y, got {columns:g} and {rows:g}")
    heights = numbers[6:]
    if heights.size != rows * columns:
        raise TerrainFileError(f"{path} must hold {rows:g} x {columns:g} heights, got {heights.size}")
    spacing = (float((x1 - x0) / (columns - 1)), float((y1 - y0) / (rows - 1)))
    return Grid(heights.reshape(int(rows), int(columns)), spacing, (float(x0), float(y0)))
