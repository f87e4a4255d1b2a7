"""Points x, y and z as a grid: tables of text, tables of columns, rows of an array."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from six_wheel.maps.files import Grid, TerrainFileError, bracketed_unit, length

EAST = ("x", "easting", "east", "e", "column", "columns", "col", "longitude", "lon")
NORTH = ("y", "northing", "north", "n", "row", "rows", "latitude", "lat")
UP = (
    "z",
    "elevation",
    "elev",
    "height",
    "heights",
    "altitude",
    "alt",
    "h",
    "dem",
    "dtm",
    "dsm",
    "topography",
)
OTHERS = (
    "slope", "aspect", "hillshade", "shade", "roughness", "tri", "tpi", "error", "uncertainty", "variance",
    "intensity", "depth", "confidence", "mask", "quality", "count", "red", "green", "blue", "traversability",
)  # fmt: skip
COMMENTS = ("#", ";", "//", "%")
SCATTERED = (
    "scattered points, or several heights at one place: "
    "grid them first (gdal_grid, or scipy.interpolate.griddata)"
)
ON_LATTICE = 1e-3  # of a step
MOST_COLUMNS = 9  # of a table of points
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[eE][-+]?\d+)?")
FORTRAN = re.compile(r"(\d\.?)[Dd]([-+]?\d+)$")
SEPARATORS = ("sep=;", "sep=,", "sep=\t")  # first line of tables that Excel writes
FILLERS = ("coord", "coordinate", "coordinates", "pos", "position")  # beside the word that counts
UNITS = ("m", "cm", "mm", "km", "ft", "feet")  # as last word of a name
NAME = re.compile(r'["\']?\s*([^\[\("\']*?)\s*(?:[\[\(]\s*([^\]\)]*)\s*[\]\)])?\s*["\']?')


class Table(NamedTuple):
    """Rows of numbers, with the names of their columns if they have some."""

    rows: NDArray[np.float64]
    names: list[str] | None


def read_table(lines: Sequence[str]) -> Table | None:
    """Rows of at least three numbers below a line of names or a comment of names; None for other text."""
    comments = [line for line in lines if line.lstrip().startswith(COMMENTS)]
    lines = [line for line in lines if not line.lstrip().startswith(COMMENTS)]
    if len(lines) > 1 and lines[0].strip() in (str(len(lines) - 1), *SEPARATORS):
        lines = lines[1:]  # their number, or what separates them
    if len(lines) < 4:
        return None
    separator, commas = _separator(lines[-1])
    rows = [[part.strip() for part in line.split(separator)] for line in lines]
    names = None
    if not any(_is_number(part, commas) for part in rows[0]):
        names, rows = rows[0], rows[1:]
        if all(bracketed_unit(f"[{part}]") or not part for part in rows[0]):  # a line of units
            names = [f"{name} [{unit}]" for name, unit in zip(names, rows[0], strict=False)]
            rows = rows[1:]
    elif comments:
        words = comments[-1].lstrip(" #;/%").split(separator)
        names = words if find_columns(words) is not None and len(words) == len(rows[0]) else None
    if len(rows[-1]) < 3 or any(len(row) != len(rows[-1]) for row in rows):
        return None
    found = None if names is None else find_columns(names)
    if names is not None and found is not None:  # others may hold texts
        rows = [[row[column] for column in found[0]] for row in rows]
        names = [names[column] for column in found[0]]
    try:
        values = [[_number(part, commas) for part in row] for row in rows]
    except ValueError:
        return None
    return Table(np.array(values, np.float64), names)


def read_crossed(lines: Sequence[str]) -> tuple[NDArray[np.float64], ...] | None:
    """Heights below a line of x, behind a column of y, as tables of pandas are written: x, y, heights.

    None for other text.
    """
    separator, commas = _separator(lines[-1])
    rows = [[part.strip(" \"'") for part in line.split(separator)] for line in lines]
    if len(rows) < 3 or len(rows[0]) < 3 or len({len(row) for row in rows}) > 1:
        return None
    if _is_number(rows[0][0], commas) or not all(_is_number(part, commas) for part in rows[0][1:]):
        return None
    try:
        head = np.array([_number(part, commas) for part in rows[0][1:]])
        values = np.array([[_number(part, commas) for part in row] for row in rows[1:]])
    except ValueError:
        return None
    return head, values[:, 0], values[:, 1:]


def _separator(line: str) -> tuple[str | None, bool]:
    """Separator of a line of numbers, None for blanks; true if their decimals stand behind commas."""
    parts = line.split()
    if ";" in line:
        return ";", "," in line
    if "," in line and len(parts) > 2 and any(map(DECIMAL_COMMA.fullmatch, parts)):
        return "\t" if "\t" in line.strip() else None, True
    return next((mark for mark in ("\t", "|", ",") if mark in line.strip()), None), False


def _number(text: str, commas: bool) -> float:
    """A number, also with the exponents of Fortran; NaN of no text."""
    if not text:
        return np.nan
    text = text.replace(",", ".") if commas else text
    return float(FORTRAN.sub(r"\1E\2", text) if "D" in text or "d" in text else text)


def _is_number(text: str, commas: bool) -> bool:
    try:
        _number(text, commas)
    except ValueError:
        return False
    return bool(text)


def split_name(name: str) -> tuple[str, str]:
    """The word of a name in small letters, and its unit: ``z [cm]``, ``Elev_ft``, ``X coord``."""
    match = NAME.fullmatch(name.strip())
    word, unit = (match[1], match[2] or "") if match else (name, "")
    parts = [part for part in re.split(r"[\s_.-]+", word.lower()) if part and part not in FILLERS]
    if len(parts) > 1 and parts[-1] in UNITS:
        unit = unit or parts.pop()
    return " ".join(parts), unit


def is_height(name: str) -> bool:
    """True for the name of a band, a variable or a column of heights."""
    return split_name(name)[0] in UP


def find_columns(names: Sequence[str]) -> tuple[tuple[int, int, int], tuple[str, str, str]] | None:
    """Columns of x, y and z by their names, and their units (empty if none is said); None unless each is one.

    Units stand in brackets, as in ``z [cm]``, or behind an underscore, as in ``z_m``.
    """
    found = dict[int, tuple[int, str]]()
    for column, name in enumerate(names):
        word, unit = split_name(name)
        for role, words in enumerate((EAST, NORTH, UP)):
            if word in words:
                if role in found:
                    return None
                found[role] = (column, unit)
    if len(found) != 3:
        return None
    if names[found[0][0]].strip("\"' ").lower().startswith("lon"):
        found[0] = (found[0][0], "degrees")
    (x, y, z), units = (tuple(found[role][k] for role in range(3)) for k in range(2))
    return (x, y, z), units  # type: ignore[return-value]


def points_grid(table: Table, path: Path) -> Grid | None:
    """The grid of a table; None if it has no names and is no list of points."""
    columns, factors, unit_stated = (0, 1, 2), [1.0, 1.0, 1.0], False
    if table.names is not None:
        found = find_columns(table.names)
        if found is None and len(table.names) > MOST_COLUMNS:
            return None  # a matrix below a line of names
        if found is None:
            listed = ", ".join(name.strip() for name in table.names[:6])
            raise TerrainFileError(f"{path} has columns {listed}: call those of the points x, y and z")
        columns, units = found
        unit_stated = bool(units[2])
        if any(unit.lower().startswith("deg") for unit in units):
            raise TerrainFileError(
                f"{path} must be in metres, its coordinates are degrees: project it first (cs2cs, gdalwarp)"
            )
        try:
            factors = [length(unit, f"units of {name}") for unit, name in zip(units, "xyz", strict=True)]
        except ValueError as error:
            raise TerrainFileError(f"{path}: {error}") from None
    x, y, z = (table.rows[:, column] * factor for column, factor in zip(columns, factors, strict=True))
    grid = lattice(x, y, z)
    if table.names is None and table.rows.shape[1] > 3:
        # Else columns of heights: those are on no lattice whose places repeat.
        return grid if grid is not None and max(grid.heights.shape) < len(table.rows) else None
    if grid is None:
        raise TerrainFileError(f"{path} has {SCATTERED}")
    return grid._replace(unit_stated=unit_stated)


def lattice(x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64]) -> Grid | None:
    """Points as a grid, NaN where none is.

    None unless they lie on one whose cells are mostly known, with one height at each place.
    """
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
    if (heights[rows, columns] != z)[~np.isnan(z)].any():
        return None
    return Grid(heights, (dx, dy), (x0, y0))
