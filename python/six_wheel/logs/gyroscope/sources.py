"""The readings of a gyroscope: its columns in a table, and rates about the rover's z from any source."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.logs.columns import BRACKETS, TIME, Column, Quantity, find_columns, unit
from six_wheel.logs.gyroscope.rates import ABOUT_Z, AXES, RATES, Floats, about_z
from six_wheel.logs.skip_bad_rows import Sieve, Source, TolerantTable

__all__ = ["rate_columns", "rate_table", "readings_of"]

CHUNK = 65_536  # readings at a time

_UNITS = (
    unit("rad/s", 1.0, "rad_s radps rads rad_per_s rad_s_1 radians_per_second"),
    unit("deg/s", math.pi / 180, "deg_s degps degs dps deg_per_s deg_s_1 degrees_per_second"),
    unit("rev/s", 2 * math.pi, "rev_s revps rps rev_per_s revolutions_per_second"),
    unit("rpm", math.pi / 30, "rpm rev_min revolutions_per_minute"),
)
_YAW_RATE = ("yaw_rate", "yawrate", "imu_yaw_rate", "gyro_yaw_rate", "gyro", "gyroscope")
_AXIS = (
    "gyro_{0}",
    "gyro{0}",
    "gyroscope_{0}",
    "imu_gyro_{0}",
    "angular_velocity_{0}",
    "imu_angular_velocity_{0}",
    "imu_data_angular_velocity_{0}",
)


def rate_columns(headers: Sequence[str], field_units: Mapping[int, str] | None = None) -> dict[str, Column]:
    """The columns of a gyroscope: one about the rover's z, or else those of its axes; none without z."""
    given = field_units or {}
    stated = [
        header if BRACKETS.match(header) or index not in given else f"{header} [{given[index]}]"
        for index, header in enumerate(headers)
    ]

    def first(name: str, spellings: Sequence[str]) -> dict[str, Column]:
        for spelling in spellings:
            if found := find_columns(stated, (Quantity(name, (spelling,), _UNITS, required=False),)):
                column = found[name]
                return {name: Column(column.index, headers[column.index], column.unit, column.stated)}
        return {}

    if found := first(ABOUT_Z, _YAW_RATE):
        return found
    for form in _AXIS:
        named = [first(f"rate {axis}", (form.format(axis),)) for axis in AXES]
        if named[2]:
            return {name: column for each in named for name, column in each.items()}
    return {}


def readings_of(
    source: Source,
    stated: bool,
    seconds: Callable[[NDArray[Any]], Floats],
    up: Floats,
    keys: Mapping[str, Any],
) -> Iterator[tuple[Floats, Floats]]:
    """Stamps in the clock of the log and rates about the rover's z, from a table or a bag."""
    offset, scale = keys.get("time_offset", 0.0), keys.get("scale", 1.0)
    for batch in Sieve(source.findings, RATES, stated).pass_on(source.batches(CHUNK)):
        rates = about_z(batch.values, up)
        there = np.isfinite(rates)
        yield seconds(batch.time[there]) - offset, scale * rates[there]


def rate_table(path: Path, columns: Mapping[str, str] | None) -> TolerantTable:
    """The same table again, of which only times and the gyroscope are read."""

    def find(headers: Sequence[str], field_units: Mapping[int, str]) -> dict[str, Column]:
        return find_columns(headers, (TIME,)) | rate_columns(headers, field_units)

    return TolerantTable(path, find, columns, RATES)
