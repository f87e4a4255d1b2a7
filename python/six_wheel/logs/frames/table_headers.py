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


def names(rover: Rover, readings: str = "angles") -> dict[str, tuple[str, ...]]:
    """Accepted names of the columns: by joint for steering, by wheel, and the stamp."""
    steering, traction = joints_by_wheel(rover)
    known: dict[str, tuple[str, ...]] = {"stamp": STAMPS}
    for wheel in rover.steered_wheel_names:
        joint = steering.get(wheel, f"{wheel}_steering_joint")
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
    steering, _ = joints_by_wheel(rover)
    known = by_name.columns
    found, scales = {"stamp": headers[known["time"].index]}, {}
    if "nanoseconds" in known:
        found["nanoseconds"] = headers[known["nanoseconds"].index]
        scales[found["stamp"]] = 1e-9
        scales[found["nanoseconds"]] = 1e9 * known["nanoseconds"].unit.scale
    elif known["time"].stated:
        scales[found["stamp"]] = known["time"].unit.scale
    backwards = set()
    for part, wheels in (("steering", rover.steered_wheel_names), ("wheel", rover.wheel_names)):
        for wheel in wheels:
            name = wheel if part == "wheel" else steering.get(wheel, f"{wheel}_steering_joint")
            column = known.get(f"{part} {wheel}")
            found[name] = "" if column is None else headers[column.index]
            if column is not None:
                scales[found[name]] = column.unit.scale
                backwards |= {found[name]} if f"{part} {wheel}" in by_name.reversed else set()
    for name, header in sensors.items():
        if header is not None:
            if header not in headers:
                raise ValueError(f"{name} must name a column, got {header!r} of {', '.join(headers)}")
            found[name] = str(header)
    wheels_of = [column for name, column in known.items() if name.startswith("wheel ")]
    kind = by_name.readings
    return Meaning(
        found,
        scales,
        kind,
        frozenset(backwards),
        known["time"].stated,
        all(column.stated for column in wheels_of) and any("[" in column.header for column in wheels_of),
    )


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
    for name, header in sensors.items():
        if header is not None:
            if header not in headers:
                raise ValueError(f"{name} must name a column, got {header!r} of {', '.join(headers)}")
            found[name] = header
    return found
