"""Columns of a gyroscope in a table."""

import math
from collections.abc import Mapping, Sequence

from six_wheel.logs.headers.columns import BRACKETS, YAW_RATES, Column, Quantity, find_columns, unit

AXES = ("x", "y", "z")
ABOUT_Z = "rate"  # of the rover itself, however the sensor sits
RATES = (ABOUT_Z, *(f"rate {axis}" for axis in AXES))

_UNITS = (
    *YAW_RATES[:2],  # rad/s, deg/s
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
