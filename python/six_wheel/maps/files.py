"""Common parts of the readers of maps: checks of arguments and files, and their errors."""

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.errors import FileError, shown
from six_wheel.maps.doubts import answer
from six_wheel.robot_description.doubts import DoubtError

Window = tuple[float, float, float, float]
Unit = str | float

FOOT = 0.3048
SURVEY_FOOT = 1200 / 3937
LENGTHS = {
    1.0: ("", "m", "metre", "meter"),
    0.1: ("dm", "decimetre", "decimeter"),
    0.01: ("cm", "centimetre", "centimeter"),
    0.001: ("mm", "millimetre", "millimeter"),
    1000.0: ("km", "kilometre", "kilometer"),
    FOOT / 12: ("in", "inch", "inche"),
    FOOT: ("ft", "foot", "feet", "international foot", "foot international"),
    SURVEY_FOOT: ("us-ft", "ftus", "foot us", "us survey foot", "us survey feet"),
    3 * FOOT: ("yd", "yard"),
}
UNITS = {name: size for size, names in LENGTHS.items() for name in names}
"""Lengths by their names [m], those of files among them; a plural s goes where the name is not known."""


NAMED_UNITS = ("ft", "feet", "cm", "mm", "km")  # of files and bands that are called by them


class TerrainFileError(DoubtError, FileError):
    """A file that is no map, or one that cannot be used."""


class Grid(NamedTuple):
    """Heights with their place: what a `Terrain` is made of."""

    heights: NDArray[np.floating]  # rows along +y, columns along +x [m]
    spacing: tuple[float, float]  # [m]
    origin: tuple[float, float]  # [m]
    yaw: float = 0.0  # [rad]
    unit_stated: bool = False  # the form says the unit of its heights


class Options(NamedTuple):
    """Answers to what a file may leave open: see `Terrain.read`."""

    window: Window | None = None
    topic: str | None = None
    layer: str | None = None
    band: int | str | None = None
    nodata: float | Sequence[float] | None = None
    unit: Unit | None = None
    north_up: bool | None = None
    spacing: float | tuple[float, float] | None = None
    origin: tuple[float, float] | None = None

    def checked(self) -> "Options":
        """The same as numbers. Fails where one is none."""
        check(self.window)
        if not isinstance(self.north_up, int | np.bool_ | None):
            raise ValueError(f"north_up must be True or False, got {shown(self.north_up)}")
        north_up = None if self.north_up is None else bool(self.north_up)
        unit = None if self.unit is None else length(self.unit, "unit")
        nodata = self.nodata
        if nodata is not None:
            several = nodata if isinstance(nodata, (tuple, list, np.ndarray)) else [nodata]
            nodata = tuple(number("nodata", each) for each in several)
        origin = None if self.origin is None else pair("origin", self.origin)
        spacing = None if self.spacing is None else pair("spacing", self.spacing)
        if spacing is not None and not (min(spacing) > 0 and math.isfinite(sum(spacing))):
            south = spacing[0] > 0 > spacing[1]
            turned = answer("spacing", (spacing[0], -spacing[1])).beside(answer("north_up", True))
            hint = ("; for rows that run south ", turned) if south else ()
            raise DoubtError(f"spacing must be finite and positive, got {spacing}", *hint)
        return self._replace(unit=unit, nodata=nodata, north_up=north_up, origin=origin, spacing=spacing)

    @property
    def marks(self) -> tuple[float, ...]:
        """Numbers that stand for unknown heights; none where every number is a height, or none is given."""
        given = self.nodata
        several = () if given is None else given if isinstance(given, Sequence) else (given,)
        return () if any(map(math.isnan, several)) else tuple(several)

    @property
    def every_number_counts(self) -> bool:
        """True if every number is a height."""
        return self.nodata is not None and not self.marks

    @property
    def steps(self) -> tuple[float, float] | None:
        """Spacing between columns and between rows [m], if it was given."""
        return None if self.spacing is None else pair("spacing", self.spacing)

    @property
    def first(self) -> tuple[float, float]:
        """Middle of the south-western cell of a map without a place [m]."""
        return self.origin or (0.0, 0.0)

    def unplaced(self, heights: NDArray[np.floating], north_up: bool) -> Grid:
        """A grid without a place of its own where these options put it; `north_up` as its form has it."""
        spacing = self.steps
        if spacing is None:
            raise ValueError("spacing must be given")
        turned = heights[::-1] if (north_up if self.north_up is None else self.north_up) else heights
        return Grid(turned, spacing, self.first)


def number(name: str, value: object) -> float:
    """A number that an argument is."""
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a number, got {shown(value)}") from None


def pair(name: str, value: object) -> tuple[float, float]:
    """Two numbers; one stands for both of a spacing."""
    several = isinstance(value, (tuple, list))
    if name == "spacing" and not several and np.ndim(value) == 0:  # type: ignore[arg-type]
        return (number(name, value),) * 2
    parts = list(value) if isinstance(value, (tuple, list, np.ndarray)) else []
    if len(parts) != 2:
        hint = ", as src.res of a dataset" if name == "spacing" else ""
        raise ValueError(f"{name} must be two numbers{hint}, got {shown(value)}")
    return number(name, parts[0]), number(name, parts[1])


def length(unit: Unit, name: str) -> float:
    """Length of a unit by its name or as a number [m]. Fails for one that is not known."""
    try:
        value: float | None = float(unit)
    except (TypeError, ValueError):
        value = named_length(str(unit))
    if value is not None and math.isfinite(value) and value > 0:
        return value
    rule = "be m, cm, mm, dm, km, ft, us-ft, in or its length in metres"
    raise ValueError(f"{name} must {rule}, got {shown(unit)}")


def named_length(unit: str) -> float | None:
    """Length of a unit by its name [m], as "[m]", "US_survey_foot", "metres above the areoid", or None."""
    text = re.sub(r"[\[\]().]|\babove\b.*", "", unit.lower().replace("_", " ")).strip()
    return UNITS.get(text, UNITS.get(text.removesuffix("s")))


def bracketed_unit(text: object) -> str:
    """The unit of length in brackets, as in ``elevation [ft]``; nothing without one."""
    for found in re.findall(r"[\[(]\s*([^\])]*?)\s*[\])]", str(text or "")):
        if found and named_length(found) is not None:
            return str(found)
    return ""


def unit_in_name(name: object) -> str:
    """The unit that a name has, as ``site_ft.tif``; nothing without one, or where a number is before it."""
    words = re.split(r"[^a-z0-9]+", str(name or "").lower())
    pairs = zip(["", *words], words, strict=False)
    return next((word for before, word in pairs if word in NAMED_UNITS and not before.isdecimal()), "")


def check(window: Window | None) -> None:
    """Fails unless a window is one."""
    if window is None:
        return
    try:
        is_window = len(window) == 4 and all(math.isfinite(value) for value in window)
    except TypeError:
        is_window = False
    if not is_window:
        raise ValueError(f"window must be x_min, y_min, x_max, y_max, all finite, got {shown(window)}")
    if not (window[0] < window[2] and window[1] < window[3]):
        raise ValueError(f"window must be x_min, y_min, x_max, y_max in order, got {window}")


def nodes(origin: float, spacing: float, count: int, low: float, high: float) -> tuple[int, int]:
    """First and last of the nodes of an axis that cover what lies between two of its coordinates."""
    first = math.floor((low - origin) / spacing)
    last = math.ceil((high - origin) / spacing)
    return max(first, 0), min(last, count - 1)


def cut(grid: Grid, window: Window | None, name: str) -> Grid:
    """The part of a grid along the axes that covers a window."""
    if window is None:
        return grid
    rows, columns = grid.heights.shape
    x0, x1 = nodes(grid.origin[0], grid.spacing[0], columns, window[0], window[2])
    y0, y1 = nodes(grid.origin[1], grid.spacing[1], rows, window[1], window[3])
    if x1 <= x0 or y1 <= y0:
        raise TerrainFileError(f"{name}: window must overlap the map, got {window}; {extent(grid)}")
    origin = (grid.origin[0] + x0 * grid.spacing[0], grid.origin[1] + y0 * grid.spacing[1])
    return grid._replace(heights=grid.heights[y0 : y1 + 1, x0 : x1 + 1], origin=origin)


def extent(grid: Grid) -> str:
    """Sentence on the range of x and y [m] that a grid covers."""
    (x, y), (dx, dy) = grid.origin, grid.spacing
    rows, columns = grid.heights.shape
    return f"the map has x {x:g} to {x + dx * (columns - 1):g}, y {y:g} to {y + dy * (rows - 1):g}"
