"""Column headers of tables: the quantity that a column holds, and its unit."""

import difflib
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from six_wheel.kinematics.errors import TableError


@dataclass(frozen=True)
class Unit:
    """A unit: its symbol, what one of it is in SI, and how headers spell it."""

    symbol: str
    scale: float
    spellings: tuple[str, ...]


@dataclass(frozen=True)
class Quantity:
    """A quantity in a table: its name, the headers that mean it, and the units they may state (SI first)."""

    name: str
    spellings: tuple[str, ...]
    units: tuple[Unit, ...]
    required: bool = True


@dataclass(frozen=True)
class Column:
    """A column that holds a quantity in `unit`; `stated` if the file says so, or else it is the default."""

    index: int
    header: str
    unit: Unit
    stated: bool


def unit(symbol: str, scale: float, spellings: str) -> Unit:
    """A unit whose spellings are words of one text."""
    return Unit(symbol, scale, tuple(spellings.split()))


TIME_UNITS = (
    unit("s", 1.0, "s sec secs second seconds"),
    unit("ms", 1e-3, "ms msec msecs millis millisecond milliseconds"),
    unit("us", 1e-6, "us usec usecs micros microsecond microseconds"),
    unit("ns", 1e-9, "ns nsec nanos nanosec nanosecs nanosecond nanoseconds"),
)
# Of a header they are units behind a name, and no names of times by themselves.
LONG_TIME_UNITS = (
    unit("min", 60.0, "min mins minute minutes"),
    unit("h", 3600.0, "h hour hours"),
    unit("d", 86_400.0, "d day days"),
)
SPEEDS = (
    unit("m/s", 1.0, "m_s mps ms m_per_s m_s_1 meters_per_second metres_per_second"),
    unit("cm/s", 1e-2, "cm_s cmps cm_per_s"),
    unit("mm/s", 1e-3, "mm_s mmps mm_per_s"),
    unit("km/h", 1 / 3.6, "km_h kmh kph kmph"),
)
YAW_RATES = (
    unit("rad/s", 1.0, "rad_s radps rads rad_per_s rad_s_1 radians_per_second"),
    unit("deg/s", math.pi / 180, "deg_s degps degs dps deg_per_s deg_s_1 degrees_per_second"),
    unit("rpm", math.pi / 30, "rpm"),
)
_LINEAR = "v_{0} linear_{0} lin_{0} velocity_{0} vel_{0} linear_velocity_{0}"
_ANGULAR = "wz w_z omega_z yaw_rate yawrate angular_z ang_z angular_velocity_z angular_velocity turn_rate"

_TIMES = "time", "t", "stamp", "timestamp", "time_stamp"
_CLOCKS = "datetime", "date_time", "utc", "utc_time", "clock", "elapsed", "elapsed_time", "unix_time", "epoch"

TIME = Quantity("time", (*_TIMES, *_CLOCKS), (*TIME_UNITS, *LONG_TIME_UNITS))
QUANTITIES = (
    TIME,
    Quantity("vx", ("vx", "v", *_LINEAR.format("x").split(), "linear_velocity", "speed"), SPEEDS),
    Quantity("vy", ("vy", *_LINEAR.format("y").split()), SPEEDS, required=False),
    Quantity("omega", ("omega", "w", *_ANGULAR.split()), YAW_RATES),
)

# Prefixes that ROS tools put before a field: "/cmd_vel/twist/linear/x", "field.header.stamp".
_PREFIX = re.compile(r"^(?:(?:cmd_vel|command|cmd|field|msg|data|twist|header)_)+")
LISTED = 100  # headers in a message
# A name and the text in brackets behind it, both without spaces around them. Nothing is tried twice: the time
# is in proportion to the length of any header.
BRACKETS = re.compile(r"^((?:[^\[(\n]*[^\[(\s])?+)\s*+[\[(]\s*+((?:.*\S)?)\s*[\])]\s*$")
_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_SIGNS = str.maketrans({"°": "deg", "µ": "u", "μ": "u"})


def words(text: str) -> str:
    """`text` in lower case, whatever is between its words written as one underscore; ``leftTicks`` is two."""
    apart = _CAPITAL.sub("_", text).lower().translate(_SIGNS)
    return re.sub(r"[^a-z0-9]+", "_", apart).strip("_")


def _interpret(header: str, quantity: Quantity) -> tuple[Unit, bool] | None:
    """The unit of a column and whether the header states it; None if the header does not mean `quantity`."""
    if bracketed := BRACKETS.match(header):
        unit = next((unit for unit in quantity.units if words(bracketed[2]) in unit.spellings), None)
        return (unit, True) if unit and _interpret(bracketed[1], quantity) else None
    name, spelled = words(header), _spellings(quantity)
    return spelled.get(name) or spelled.get(_PREFIX.sub("", name))


@cache
def _spellings(quantity: Quantity) -> dict[str, tuple[Unit, bool]]:
    """The unit of a quantity and whether a header states it, by the words of the header."""
    spelled = dict.fromkeys(quantity.spellings, (quantity.units[0], False))
    for unit in quantity.units:
        alone = unit.spellings if unit in TIME_UNITS else ()  # "sec" says by itself what it measures
        behind = (f"{stem}_{ending}" for ending in unit.spellings for stem in quantity.spellings)
        for form in (*alone, *behind):
            spelled.setdefault(form, (unit, True))
    return spelled


def means(header: str, quantity: Quantity) -> bool:
    """True if a header means a quantity."""
    return _interpret(header, quantity) is not None


def find_columns(headers: Sequence[str], quantities: Sequence[Quantity] = QUANTITIES) -> dict[str, Column]:
    """The column of each quantity, by name; those that are not required may be absent.

    Raises `TableError` if a quantity has no column or more than one, or a unit is not known.
    """
    found: dict[str, Column] = {}
    for quantity in quantities:
        meanings = [(index, header, _interpret(header, quantity)) for index, header in enumerate(headers)]
        matches = [Column(index, header, *meaning) for index, header, meaning in meanings if meaning]
        if len(matches) > 1:
            both = " and ".join(f'"{column.header}"' for column in matches)
            raise TableError(f"{quantity.name} must be in one column, got {both}; rename or drop all but one")
        if matches:
            found[quantity.name] = matches[0]
        elif quantity.required:
            raise TableError(_missing(quantity, headers, found, quantities))
    return found


def _missing(
    quantity: Quantity,
    headers: Sequence[str],
    found: Mapping[str, Column],
    quantities: Sequence[Quantity],
) -> str:
    if headers and all(is_number(header) for header in headers):
        such = ",".join(each.name for each in quantities)
        return f'the first line must name the columns, such as "{such}", got "{",".join(headers)}"'
    for header in headers:
        bracketed = BRACKETS.match(header)
        if bracketed and _interpret(bracketed[1], quantity):
            known = ", ".join(unit.symbol for unit in quantity.units)
            return f'the unit of column "{header}" must be one of {known}, got "{bracketed[2]}"'
    free = [header for header in headers if header not in (column.header for column in found.values())]
    alike = {difflib.SequenceMatcher(None, words(h), s).ratio(): h for h in free for s in quantity.spellings}
    best = max(alike, default=0.0)
    hint = f'did you mean "{alike[best]}"? ' if best > 0.6 else ""
    known = ", ".join(quantity.spellings)
    return f"no column for {quantity.name} among {listed(headers) or 'none'}; {hint}known: {known}"


def listed(headers: Sequence[str]) -> str:
    """Headers as a message names them: the first hundred, of each the first sixty characters."""
    more = f" and {len(headers) - LISTED} more" if len(headers) > LISTED else ""
    return ", ".join(f'"{header:.60}"' for header in headers[:LISTED]) + more


def is_number(cell: str) -> bool:
    """True if a cell of a table is a number that `float` reads, without Python's underscores."""
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell  # Python's own spelling, which no table has
