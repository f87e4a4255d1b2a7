"""Maps as text: ESRI ASCII grids, tables of x, y and z, and one list of extents and heights."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from six_wheel.maps import doubts
from six_wheel.maps.files import Grid, Options, TerrainFileError
from six_wheel.maps.plausibility import is_fill, is_in_degrees
from six_wheel.maps.readers.axes import Axis, by_coordinates
from six_wheel.maps.readers.points import COMMENTS, points_grid, read_crossed, read_table
from six_wheel.maps.readers.reference import UNKNOWN, Reference, in_degrees

CORNERS = ("xllcorner", "xllcenter", "yllcorner", "yllcenter")
PIECE = 1 << 16  # numbers that are read at a time
KEYS = ("ncols", "nrows", *CORNERS, "cellsize", "dx", "dy", "nodata_value", "nodata")
WORD = re.compile(r"[a-z_]{2,}")
NUMBERS = ("nan", "inf", "na", "null", "nodata")  # words among cells
UNKNOWN_CELLS = ("*", "na", "n/a", "null", "nodata", "-")  # beside what C libraries print, as 1.#QNAN


def read(path: Path, text: str, options: Options, reference: Reference = UNKNOWN) -> Grid:
    """The grid of a text in the coordinates of its reference [m].

    An ESRI ASCII grid begins with ``ncols``; heights stand for the middle of their cells, the northern row
    first. A table has rows of x, y and z, in any order, with or without a line of names. Anything else is one
    list, separated by commas: least x, largest x, number of x, least y, largest y, number of y, then heights,
    x running fastest.
    """
    lines = [line for line in text.lstrip("\ufeff").splitlines() if line.strip()]
    plain = [line for line in lines if not line.lstrip().startswith(COMMENTS)]
    if not plain:
        raise TerrainFileError(f"{path} is empty: fetch it again")
    placed = options
    if plain[0].split()[0].lower().rstrip(":") in KEYS:
        grid, placed = _esri(path, plain, options)
    else:
        grid, placed = _table(path, lines, plain, options)
    if placed.spacing is not None or placed.origin is not None or placed.north_up is not None:
        raise TerrainFileError(f"{path} ", *doubts.own_place(placed))
    if reference.degrees or (
        reference == UNKNOWN and is_in_degrees(grid.origin, grid.spacing, grid.heights.shape)
    ):
        raise in_degrees(path, grid.origin, reference)
    (dx, dy), (x, y), metre = grid.spacing, grid.origin, reference.plane
    return grid._replace(spacing=(dx * metre, dy * metre), origin=(x * metre, y * metre))


def _table(path: Path, lines: list[str], plain: list[str], options: Options) -> tuple[Grid, Options]:
    """The grid of points, of heights with coordinates or without, or of a list, and the options left."""
    crossed = read_crossed(plain)
    if crossed is not None:
        x, y, heights = crossed
        if all((places == np.arange(places.size)).all() for places in (x, y)):  # numbers of rows and columns
            return _unplaced(path, heights, options)
        axes = [Axis("y", y, "m", "y"), Axis("x", x, "m", "x")]
        try:
            values, placed = by_coordinates(heights, axes, options)
        except ValueError as error:
            raise TerrainFileError(f"{path}: {error}") from None
        return placed._replace(north_up=None).unplaced(values, False), Options()
    table = read_table(lines)
    points = None if table is None else points_grid(table, path)
    return (points, options) if points is not None else _list(path, "\n".join(plain), options)


def _unplaced(path: Path, heights: NDArray[np.float64], options: Options) -> tuple[Grid, Options]:
    """A matrix of heights where the options put it."""
    if options.steps is None:
        raise TerrainFileError(f"{path} ", *doubts.no_place("is a matrix without a place", north_up=False))
    return options.unplaced(heights, False), options._replace(spacing=None, origin=None, north_up=None)


def _floats(parts: list[str]) -> NDArray[np.float64]:
    """The numbers of texts, so many at a time, between which Ctrl-C is taken."""
    pieces = range(0, max(len(parts), 1), PIECE)
    return np.concatenate([np.array(parts[k : k + PIECE], dtype=np.float64) for k in pieces])


def _numbers(path: Path, parts: list[str]) -> NDArray[np.float64]:
    try:
        return _floats(parts)
    except ValueError:
        unknown = (part.lower() in UNKNOWN_CELLS or "#" in part for part in parts)
        parts = ["nan" if is_unknown else part for part, is_unknown in zip(parts, unknown, strict=True)]
    try:
        return _floats(parts)
    except ValueError:
        told = repr(next(part for part in parts if not _is_number(part)))[:60]
        raise TerrainFileError(f"{path} is no map as text: it has {told} where a height belongs") from None


def _is_number(text: str) -> bool:
    try:
        np.array([text], dtype=np.float64)
    except ValueError:
        return False
    return True


def _esri(path: Path, lines: list[str], options: Options) -> tuple[Grid, Options]:
    """The grid, and those options that it has not used."""
    header = dict[str, float]()
    for number, line in enumerate(lines):
        key, *value = line.split()[:2] or [""]
        key = key.lower().rstrip(":")
        if key not in KEYS:
            if value and WORD.fullmatch(key) and key not in NUMBERS:
                continue  # a key of others, as byteorder
            break
        try:
            header[key] = float(value[0].replace(",", "."))
        except (IndexError, ValueError):
            raise TerrainFileError(f"{path}:{number + 1}: {key} must be a number, got {line!r}") from None
    else:
        number = len(lines)
    sizes = (header.get("cellsize", header.get("dx")), header.get("cellsize", header.get("dy")))
    (dx, dy), counts = sizes, (header.get("nrows"), header.get("ncols"))
    if dx is None or dy is None or None in counts:
        raise TerrainFileError(f"{path} must give ncols, nrows and cellsize")
    if not all(count is not None and count >= 1 and count % 1 == 0 for count in counts):
        raise TerrainFileError(f"{path} must have whole ncols and nrows, got {counts[1]} and {counts[0]}")
    rows, columns = (int(count or 0) for count in counts)
    heights = _numbers(path, _cells(lines[number:], rows * columns))
    if heights.size != rows * columns:
        raise TerrainFileError(f"{path} must hold {rows} x {columns} heights, got {heights.size}")
    # Without the line it is -9999 (ESRI ASCII raster format).
    heights[is_fill(heights, header.get("nodata_value", header.get("nodata", -9999.0)))] = np.nan
    if not any(key.startswith("xll") for key in header) or not any(key.startswith("yll") for key in header):
        if options.origin is None:
            raise TerrainFileError(f"{path} ", *doubts.no_corners())
        x, y = options.origin
        options = options._replace(origin=None)
    else:
        x = header.get("xllcenter", header.get("xllcorner", 0.0) + dx / 2)
        y = header.get("yllcenter", header.get("yllcorner", 0.0) + dy / 2)
    return Grid(heights.reshape(rows, columns)[::-1], (dx, dy), (x, y)), options


def _cells(lines: list[str], count: int) -> list[str]:
    """Numbers between blanks, semicolons or commas; commas are decimal where that makes the count."""
    if any(";" in line for line in lines):
        lines = [line.replace(";", " ").replace(",", ".") for line in lines]
    if any("," in line for line in lines):
        is_whole = sum(len(line.split()) for line in lines) == count
        is_decimal = is_whole and not any("." in line for line in lines)
        lines = [line.replace(",", "." if is_decimal else " ") for line in lines]
    return [cell for line in lines for cell in line.split()]


def _list(path: Path, text: str, options: Options) -> tuple[Grid, Options]:
    """The grid of one list, or of a matrix of heights, and those options that it has not used."""
    if ";" in text:
        text = text.replace(",", ".").replace(";", ",")
    separator = "," if "," in text else None
    lines = [[part.strip() for part in line.split(separator)] for line in text.splitlines()]
    numbers = _numbers(path, [part for line in lines for part in line if part])
    counts = numbers[[2, 5]] if numbers.size > 6 else np.zeros(2)
    if not (counts % 1 == 0).all() or numbers.size - 6 != counts.prod():
        widths = {len(line) for line in lines}
        if len(lines) > 1 and len(widths) == 1 and widths.pop() > 1:
            matrix = np.array([_numbers(path, [part or "nan" for part in line]) for line in lines])
            is_counted = (matrix[0] == np.arange(matrix.shape[1])).all()  # columns, as pandas writes them
            return _unplaced(path, matrix[1:] if is_counted else matrix, options)
    if numbers.size < 6:
        raise TerrainFileError(f"{path} must begin with x min, x max, x count, y min, y max, y count")
    x0, x1, columns, y0, y1, rows = numbers[:6]
    if not (columns >= 2 and rows >= 2 and columns % 1 == 0 and rows % 1 == 0):
        raise TerrainFileError(f"{path} must have at least two x and y, got {columns:g} and {rows:g}")
    heights = numbers[6:]
    if heights.size != rows * columns:
        raise TerrainFileError(f"{path} must hold {rows:g} x {columns:g} heights, got {heights.size}")
    spacing = (float((x1 - x0) / (columns - 1)), float((y1 - y0) / (rows - 1)))
    return Grid(heights.reshape(int(rows), int(columns)), spacing, (float(x0), float(y0))), options
