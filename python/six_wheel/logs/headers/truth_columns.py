"""Columns of a true pose: position and heading, or a quaternion."""

import math
from collections.abc import Sequence

from six_wheel.logs.headers.columns import Column, Quantity, Unit, find_columns, unit

_TURN, _DEGREE = 2 * math.pi, math.pi / 180
ANGLES = (
    unit("rad", 1.0, "rad rads radian radians"),
    unit("deg", _DEGREE, "deg degs degree degrees"),
    unit("rev", _TURN, "rev revs revolution revolutions turn turns rot rots rotation rotations"),
    unit("mrad", 1e-3, "mrad"),
    unit("gon", _TURN / 400, "gon"),  # "grad" is a degree in other languages
)
_LENGTHS = (unit("m", 1.0, "m metres meters"), unit("cm", 1e-2, "cm"), unit("mm", 1e-3, "mm"))
_NONE = (unit("1", 1.0, ""),)
_TRUTH = ("", "truth_", "true_", "gt_", "ground_truth_", "reference_", "mocap_")
_POSITIONS = (
    "{0}",
    "position_{0}",
    "pose_position_{0}",
    "pose_pose_position_{0}",
    "translation_{0}",
    "t{0}",
)
_HEADINGS = ("yaw", "theta", "heading")
_QUATERNIONS = (
    "q{0}",
    "orientation_{0}",
    "pose_orientation_{0}",
    "pose_pose_orientation_{0}",
    "rotation_{0}",
)


def _truth(name: str, forms: Sequence[str], units: tuple[Unit, ...], axis: str = "") -> Quantity:
    spellings = tuple(before + form.format(axis) for form in forms for before in _TRUTH)
    return Quantity(name, spellings, units, required=False)


POSITION = (_truth("x", _POSITIONS, _LENGTHS, "x"), _truth("y", _POSITIONS, _LENGTHS, "y"))
YAW = _truth("yaw", _HEADINGS, ANGLES)
QUATERNION = tuple(_truth(f"q{axis}", _QUATERNIONS, _NONE, axis) for axis in "xyzw")
HEIGHT = _truth("z", _POSITIONS, _LENGTHS, "z")
TILT = tuple(_truth(name, (name,), ANGLES) for name in ("roll", "pitch"))


def truth_columns(headers: Sequence[str]) -> dict[str, Column]:
    """The columns of a pose: all of ``x``, ``y`` and ``yaw``, or ``qx`` to ``qw``; none if one is missing."""
    found = find_columns(headers, (*POSITION, YAW, *QUATERNION))
    names = {"yaw"} if "yaw" in found else {quantity.name for quantity in QUATERNION}
    names |= {"x", "y"}
    return {name: found[name] for name in found if name in names} if names <= found.keys() else {}


def columns_in_space(headers: Sequence[str]) -> dict[str, Column]:
    """Columns of a pose in space beside `truth_columns`: ``z`` with ``qx`` to ``qw`` or ``roll`` and
    ``pitch``; none if one is missing."""
    found = find_columns(headers, (HEIGHT, *TILT, *QUATERNION))
    for angles in (QUATERNION, TILT):
        names = {"z", *(quantity.name for quantity in angles)}
        if names <= found.keys():
            return {name: found[name] for name in names}
    return {}


def position_columns(headers: Sequence[str]) -> dict[str, Column]:
    """The columns ``x`` and ``y``; none if one is missing."""
    found = find_columns(headers, POSITION)
    return found if {"x", "y"} <= found.keys() else {}
