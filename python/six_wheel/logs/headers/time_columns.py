"""Columns of stamps: one, or whole seconds and nanoseconds in two."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.logs.headers.columns import (
    TIME,
    TIME_UNITS,
    Column,
    TableError,
    Unit,
    find_columns,
    means,
    words,
)

__all__ = ["scale_of", "seconds_since", "time_columns", "whole_second"]

# Beyond this a double of seconds resolves less than 0.1 ns, and stamps are counted from a later second.
LONGEST_RUN = 1e6  # [s]

_SECONDS = re.compile(r"^(.*?)_?(?:sec|secs|seconds)$")
_NANOSECONDS = re.compile(r"^(.*?)_?(?:nanosec|nanosecs|nsec|nsecs|nanoseconds)$")


def time_columns(
    headers: Sequence[str], field_units: Mapping[int, str] | None = None, stamp_unit: str | None = None
) -> dict[str, Column]:
    """The column ``"time"``, and ``"nanoseconds"`` where stamps are in two.

    Parameters
    ----------
    headers : sequence of str
    field_units : mapping, optional
        Units that are stated apart from the headers, by column.
    stamp_unit : str, optional
        Unit of the times, whatever the table says.

    Raises
    ------
    TableError
        If there is no such column or more than one, or a unit is not known.
    """
    if stamp_unit is not None:
        scale_of(stamp_unit)
    if pair := _in_two(headers):
        return pair
    found = [index for index, header in enumerate(headers) if means(header, TIME)]
    if len(found) > 1:
        both = " and ".join(f'"{headers[index]}"' for index in found)
        leave = " ".join(f'--column "{headers[index]}="' for index in found[1:])
        python = ", ".join(f'"{headers[index]}": ""' for index in found[1:])
        rule = f"time must be in one column, got {both}; rename or drop all but one"
        raise TableError(f"{rule}, as {leave} does, or columns={{{python}}} in Python")
    column = find_columns(headers, (TIME,))["time"]
    stated = (field_units or {}).get(column.index)
    if stated is not None and not column.stated:
        unit = next((unit for unit in TIME_UNITS if words(stated) in unit.spellings), None)
        if unit is None:
            known = ", ".join(each.symbol for each in TIME_UNITS)
            raise TableError(f'the unit of column "{column.header}" must be one of {known}, got "{stated}"')
        column = replace(column, unit=unit, stated=True)
    if stamp_unit is not None:
        unit = next(unit for unit in TIME_UNITS if unit.symbol == stamp_unit)
        column = replace(column, unit=unit, stated=True)
    return {"time": column}


def scale_of(stamp_unit: str) -> float:
    """Seconds of a unit of stamps.

    Raises
    ------
    ValueError
        If it is not known.
    """
    scales = {unit.symbol: unit.scale for unit in TIME_UNITS}
    if stamp_unit not in scales:
        raise ValueError(f'stamp_unit must be one of {", ".join(scales)}, got "{stamp_unit}"')
    return scales[stamp_unit]


def _in_two(headers: Sequence[str]) -> dict[str, Column] | None:
    """Stamps of ROS: whole seconds, and nanoseconds beside them."""
    names = [words(header) for header in headers]
    for index, name in enumerate(names):
        if not (fine := _NANOSECONDS.match(name)):
            continue
        for other, coarse in enumerate(names):
            whole = _SECONDS.match(coarse)
            if other != index and whole and whole[1] == fine[1] and not _NANOSECONDS.match(coarse):
                unit = TIME_UNITS[-1]
                return {
                    "time": Column(other, headers[other], unit, stated=True),
                    "nanoseconds": Column(index, headers[index], unit, stated=True),
                }
    return None


def whole_second(time: Any, unit: Unit) -> int:
    """The second from which to count stamps that begin at `time`: whole, so that it is exact in any unit."""
    seconds = float(time) * unit.scale
    return 0 if abs(seconds) < LONGEST_RUN else math.floor(seconds)


def seconds_since(origin: int, time: NDArray[Any], unit: Unit) -> NDArray[np.float64]:
    """`time` in seconds since `origin`: differences first, or 1.7e18 ns would lose 256 ns as a double."""
    per_second = round(1 / unit.scale)
    return np.asarray((time - origin * per_second) / per_second, dtype=float)
