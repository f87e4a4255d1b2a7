"""Columns of stamps: one, or whole seconds and nanoseconds in two."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.errors import TableError
from six_wheel.logs.headers.columns import (
    BRACKETS,
    TIME,
    TIME_UNITS,
    Column,
    Unit,
    find_columns,
    is_number,
    listed,
    means,
    words,
)
from six_wheel.logs.plausibility.proposals import columns

# Beyond this a double of seconds resolves less than 0.1 ns, and stamps are counted from a later second.
LONGEST_RUN = 1e6  # [s]

_SECONDS = re.compile(r"^(.*?)_?(?:sec|secs|seconds)$")
_FRACTIONS = (
    (re.compile(r"^(.*?)_?(?:nanosec|nanosecs|nsec|nsecs|nanoseconds)$"), TIME_UNITS[3]),
    (re.compile(r"^(.*?)_?(?:microsec|microsecs|usec|usecs|microseconds)$"), TIME_UNITS[2]),
    (re.compile(r"^(.*?)_?(?:millisec|millisecs|msec|msecs|milliseconds)$"), TIME_UNITS[1]),
)
# Names of clocks that are read where no column is called by a plain name.
_OF_RECORDERS = re.compile(
    r"(?:ts|timestamps|times|seconds_since_start|(?:log|sim|ros|rec|record|recorded|recording|receive|rx|system|sys|host"
    r"|local|header|sensor|gps|unix|epoch|relative|rel|elapsed|run|bag|mission|utc)_(?:time|timestamp|stamp|ts)"
    r"|(?:time|timestamp)_(?:unix|epoch|utc|local|rel|relative|elapsed|stamp)|(?:recorded|created|received)_at)"
)


def time_columns(
    headers: Sequence[str], field_units: Mapping[int, str] | None = None, stamp_unit: str | None = None
) -> dict[str, Column]:
    """The column ``"time"``, and ``"nanoseconds"`` where stamps are in two.

    Raises `TableError` if there is no such column or more than one, or a unit is not known.

    `field_units` are units that are stated apart from the headers, by column; `stamp_unit` is that of the
    times, whatever the table says.
    """
    if stamp_unit is not None:
        scale_of(stamp_unit)
    if pair := _in_two(headers):
        return pair
    given, headers = headers, _plain(headers)
    found = [index for index, header in enumerate(headers) if means(header, TIME)]
    if len(found) > 1:
        both = " and ".join(f'"{headers[index]}"' for index in found)
        leave = " ".join(f'--column "{headers[index]}="' for index in found[1:])
        python = ", ".join(f'"{headers[index]}": ""' for index in found[1:])
        rule = f"time must be in one column, got {both}; rename or drop all but one"
        raise TableError(f"{rule}, as {leave} does, or columns={{{python}}} in Python")
    if not found:
        _refuse_missing(headers)
    column = find_columns(headers, (TIME,))["time"]
    stated = (field_units or {}).get(column.index)
    if stated is not None and not column.stated:
        unit = next((unit for unit in TIME.units if words(stated) in unit.spellings), None)
        if unit is None:
            raise _unknown_unit(column.header, stated)
        column = replace(column, unit=unit, stated=True)
    if stamp_unit is not None:
        unit = next(unit for unit in TIME.units if unit.symbol == stamp_unit)
        column = replace(column, unit=unit, stated=True)
    return {"time": replace(column, header=given[column.index])}


def scale_of(stamp_unit: str) -> float:
    """Seconds of a unit of stamps. Raises `ValueError` if it is not known."""
    scales = {unit.symbol: unit.scale for unit in TIME.units}
    if stamp_unit not in scales:
        raise ValueError(f'stamp_unit must be one of {", ".join(scales)}, got "{stamp_unit}"')
    return scales[stamp_unit]


def _plain(headers: Sequence[str]) -> list[str]:
    """Headers with a recorder's name of its clock written as ``time``, if no other column is a time."""
    found = list(headers)
    if any(means(header, TIME) for header in headers):
        return found
    for index, header in enumerate(headers):
        bracketed = BRACKETS.match(header)
        text = words(bracketed[1] if bracketed else header)
        stem, _, ending = text.rpartition("_")
        unit = next((each.symbol for each in TIME_UNITS if ending in each.spellings), None)
        if _OF_RECORDERS.fullmatch(text):
            found[index] = f"time [{bracketed[2]}]" if bracketed else "time"
        elif unit and not bracketed and _OF_RECORDERS.fullmatch(stem):
            found[index] = f"time [{unit}]"
    return found


def _refuse_missing(headers: Sequence[str]) -> None:
    """Refuses a table without a time, with what would name one."""
    for header in headers:
        bracketed = BRACKETS.match(header)
        if bracketed and means(bracketed[1], TIME):
            raise _unknown_unit(header, bracketed[2])
    if all(is_number(header) for header in headers):
        return
    likely, meaning = next(filter(None, map(_like_a_time, headers)), ("HEADER", "time [s]"))
    what = "with the header of the times" if likely == "HEADER" else "if that is it"
    none = f"no column for time among {listed(headers)}; known: {', '.join(TIME.spellings)}; give "
    raise TableError(none, columns({likely: meaning}), f", {what}, or with another unit")


def _unknown_unit(header: str, unit: str) -> TableError:
    known = ", ".join(each.symbol for each in TIME.units)
    rule = f'the unit of column "{header}" must be one of {known}, got "{unit}"'
    return TableError(f"{rule}: give ", columns({header: "time [s]"}), ", with its unit")


def _like_a_time(header: str) -> tuple[str, str] | None:
    """A header that looks like that of times, and what it may mean."""
    bracketed = BRACKETS.match(header)
    parts = words(bracketed[2] if bracketed else header).split("_")
    unit = next((each.symbol for each in TIME_UNITS if set(parts) & {*each.spellings}), None)
    named = re.search("time|stamp|clock|sec|date|tow|zeit|temps|tiempo|tempo", words(header))
    return (header, f"time [{unit or 's'}]") if unit or named else None


def _in_two(headers: Sequence[str]) -> dict[str, Column] | None:
    """Stamps in two columns: whole seconds, and nanoseconds or microseconds beside them."""
    names = [words(header) for header in headers]
    for index, name in enumerate(names):
        for pattern, unit in _FRACTIONS:
            if not (fine := pattern.match(name)):
                continue
            for other, coarse in enumerate(names):
                whole = _SECONDS.match(coarse)
                apart = other != index and not any(each.match(coarse) for each, _ in _FRACTIONS)
                if apart and whole and whole[1] == fine[1]:
                    return {
                        "time": Column(other, headers[other], TIME_UNITS[-1], stated=True),
                        "nanoseconds": Column(index, headers[index], unit, stated=True),
                    }
    return None


def whole_second(time: Any, unit: Unit) -> int:
    """The second from which to count stamps that begin at `time`: whole, so that it is exact in any unit."""
    seconds = float(time) * unit.scale
    return 0 if abs(seconds) < LONGEST_RUN else math.floor(seconds)


def in_seconds(times: NDArray[Any], scale: float, origin: int = 0) -> NDArray[np.float64]:
    """Times in a unit of so many seconds, as seconds since the second `origin`: by division where a second
    has a whole number of them, and differences first, or 1.7e18 ns would lose 256 ns as a double."""
    if scale > 1.0:
        return np.asarray(times * scale - origin, dtype=float)
    per_second = round(1.0 / scale)
    return np.asarray((times - origin * per_second) / per_second, dtype=float)
