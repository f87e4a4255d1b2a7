"""Columns of frames and dictionaries: by their plain names, or by quantity and unit in their headers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from six_wheel._core import Rover
from six_wheel.logs.headers.joint_columns import JointColumns, Reading, joint_columns
from six_wheel.logs.headers.renamed import Columns, renamed
from six_wheel.logs.headers.time_columns import scale_of
from six_wheel.robot_description.wheels_of_rover import joints_by_wheel

STAMPS = ("stamp", "stamps", "time", "timestamp", "t")
ENDINGS = {"angles": ("", ".position"), "ticks": ("", ".position"), "speeds": ("", ".velocity")}

Sensors: TypeAlias = Mapping[str, Any]


@dataclass(frozen=True)
class Meaning:
    """Column of each quantity of a table, empty for a passive wheel without one; factors of columns in other
    units than radians and seconds; and what headers say of the readings."""

    found: Mapping[str, str]
    scales: Mapping[str, float]
    readings: str | None = None
    reversed: frozenset[str] = frozenset()
    clock_stated: bool = False
    units_stated: bool = False


def steering_keys(rover: Rover) -> dict[str, str]:
    """Steered wheels to the keys of `names` for their angles."""
    steering, _ = joints_by_wheel(rover)
    return {wheel: steering.get(wheel, f"{wheel}_steering_joint") for wheel in rover.steered_wheel_names}


def names(rover: Rover, readings: str = "angles") -> dict[str, tuple[str, ...]]:
    """Accepted names of the columns: by joint for steering, by wheel, and the stamp."""
    _, traction = joints_by_wheel(rover)
    known: dict[str, tuple[str, ...]] = {"stamp": STAMPS}
    for joint in steering_keys(rover).values():
        known[joint] = tuple(joint + ending for ending in ENDINGS["angles"])
    for wheel in rover.wheel_names:
        stems = (traction.get(wheel, wheel), wheel)
        known[wheel] = tuple(stem + ending for stem in stems for ending in ENDINGS[readings])
    return known


def meaning_of(
    rover: Rover,
    headers: Sequence[str],
    columns: Columns | None,
    sensors: Sensors,
    options: Mapping[str, Any],
    units: Mapping[int, str],
    stamp_unit: str | None,
) -> Meaning:
    """By the plain names of the columns, or else by what their headers say of quantity and unit."""
    scales: dict[str, float] = {}
    try:
        given = columns if columns is None or isinstance(columns, Mapping) else None
        found = _find(rover, headers, given, sensors, options)
        if not units and given is columns:
            stated = stamp_unit is not None
            if stamp_unit is not None:
                scales[found["stamp"]] = scale_of(stamp_unit)
            return Meaning(found, scales, clock_stated=stated)
        plain = ""
    except ValueError as error:
        plain = str(error)
    readings = str(options.get("readings", "angles"))
    default: Reading = "speeds" if readings == "speeds" else "angles"
    names = renamed(headers, columns or {})
    try:
        by_name = joint_columns(names, rover, default, units, stamp_unit)
    except ValueError as error:
        raise ValueError(f"{plain}; {error}" if plain else str(error)) from None
    return _of_columns(rover, headers, by_name, sensors)


def _of_columns(rover: Rover, headers: Sequence[str], by_name: JointColumns, sensors: Sensors) -> Meaning:
    """The meaning of a table whose headers say what is in them."""
    known = by_name.columns
    found, scales = {"stamp": headers[known["time"].index]}, {}
    if "nanoseconds" in known:
        found["nanoseconds"] = headers[known["nanoseconds"].index]
        scales[found["stamp"]] = 1e-9
        scales[found["nanoseconds"]] = 1e9 * known["nanoseconds"].unit.scale
    elif known["time"].stated:
        scales[found["stamp"]] = known["time"].unit.scale
    keys = {f"steering {wheel}": key for wheel, key in steering_keys(rover).items()}
    keys |= {f"wheel {wheel}": wheel for wheel in rover.wheel_names}
    for name, key in keys.items():
        column = known.get(name)
        found[key] = "" if column is None else headers[column.index]
        if column is not None:
            scales[found[key]] = column.unit.scale
    wheels_of = [column for name, column in known.items() if name.startswith("wheel ")]
    stated = all(column.stated for column in wheels_of) and any("[" in column.header for column in wheels_of)
    backwards = frozenset(found[key] for name, key in keys.items() if name in by_name.reversed)
    found |= _of_sensors(sensors, headers)
    return Meaning(found, scales, by_name.readings, backwards, known["time"].stated, stated)


def _of_sensors(sensors: Sensors, headers: Sequence[str]) -> dict[str, str]:
    """Columns of sensors that the call names. Raises `ValueError` if one is not there."""
    named = {name: header for name, header in sensors.items() if header is not None}
    for name, header in named.items():
        if header not in headers:
            raise ValueError(f"{name} must name a column, got {header!r} of {', '.join(headers)}")
    return named


def _find(
    rover: Rover,
    headers: Sequence[str],
    columns: Mapping[str, str] | None,
    sensors: Sensors,
    options: Mapping[str, Any],
) -> dict[str, str]:
    """Column of each quantity; empty for a passive wheel without a column."""
    known = names(rover, options.get("readings", "angles"))
    given = dict(columns or {})
    joints = {**rover.traction_joints, **{joint: joint for joint in rover.steering_joints}}
    stated = {joints.get(name, name): header for name, header in given.items()}
    for name in stated:
        if name not in known:
            raise ValueError(f"columns must name some of {', '.join(known)}, got {name!r}")
    passive = {wheel.name for wheel in rover.wheels if not wheel.driven}
    found = {}
    for name, candidates in known.items():
        wanted = (stated[name],) if name in stated else candidates
        present = [header for header in wanted if header in headers]
        if present:
            found[name] = present[0]
        elif name in passive and name not in stated:
            found[name] = ""
        else:
            raise ValueError(f"table must have a column {' or '.join(wanted)}, got {', '.join(headers)}")
    return found | _of_sensors(sensors, headers)
