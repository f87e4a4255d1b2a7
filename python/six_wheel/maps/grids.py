"""Maps as text: ESRI ASCII grids, and one list of extents and heights."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from six_wheel.maps.files import Grid, TerrainFileError

__all__ = ["read"]

KEYS = (
    "ncols",
    "nrows",
    "xllcorner",
    "xllcenter",
    "yllcorner",
    "yllcenter",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
)


def read(path: Path) -> Grid:
    """The grid of a text file.

    An ESRI ASCII grid begins with ``ncols``; heights stand for the middle of their cells, the northern row
    first. Anything else is one list, separated by commas: least x, largest x, number of x, least y, largest
    y, number of y, then heights, x running fastest.
    """
    try:
        text = path.read_text(encoding="ascii")
    except UnicodeDecodeError:
        raise TerrainFileError(f"{path} must be text") from None
    if text[:200].lstrip().lower().startswith(("ncols", "nrows")):
        return _esri(path, text)
    return _list(path, text)


def _numbers(path: Path, text: str, separator: str | None) -> NDArray[np.float64]:
    parts = text.replace("\n", separator).split(separator) if separator else text.split()
    try:
        return np.array([part for part in map(str.strip, parts) if part], dtype=np.float64)
    except ValueError as error:
        raise TerrainFileError(f"{path}: {error}") from None


def _esri(path: Path, text: str) -> Grid:
    lines, header = text.splitlines(), dict[str, float]()
    for number, line in enumerate(lines):
        key, *value = line.split()[:2] or [""]
        if key.lower() not in KEYS:
            break
        try:
            header[key.lower()] = float(value[0])
        except (IndexError, ValueError):
            raise TerrainFileError(f"{path}:{number + 1}: {key} must be a number, got {line!r}") from None
    else:
        number = len(lines)
    sizes = (header.get("cellsize", header.get("dx")), header.get("cellsize", header.get("dy")))
    (dx, dy), shape = sizes, (header.get("nrows"), header.get("ncols"))
    if dx is None or dy is None or None in shape:
        raise TerrainFileError(f"{path} must give ncols, nrows and cellsize")
    rows, columns = (int(count or 0) for count in shape)
    heights = _numbers(path, "\n".join(lines[number:]), None)
    if heights.size != rows * columns:
        raise TerrainFileError(f"{path} must hold {rows} x {columns} heights, got {heights.size}")
    if (unknown := header.get("nodata_value")) is not None:
        heights[heights == unknown] = np.nan
    x = header.get("xllcenter", header.get("xllcorner", 0.0) + dx / 2)
    y = header.get("yllcenter", header.get("yllcorner", 0.0) + dy / 2)
    projection = path.with_suffix(".prj")
    if projection.exists() and projection.read_text(errors="replace").lstrip().upper().startswith("GEOG"):
        raise TerrainFileError(f"{path} must be in metres, its coordinates are degrees: project it first")
    return Grid(heights.reshape(rows, columns)[::-1], (dx, dy), (x, y))


def _list(path: Path, text: str) -> Grid:
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
