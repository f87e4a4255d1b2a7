"""The controllers of ros2_controllers that drive a vehicle: a table, one entry each.

What a file for them says beyond our model is reported; what would change the kinematics is applied or
refused.
"""

import math
from collections.abc import Callable, Iterator
from typing import Any

from six_wheel._core import Rover, Wheel
from six_wheel.descriptions.joint_names import said_by
from six_wheel.parameters.controllers.keys import (
    DRIVES,
    FRONT_RADIUS,
    FRONT_TRACK,
    LIMITS,
    RADIUS,
    STEERING_RANGE,
    STEERS,
    TRACK,
    AckermannSteering,
    BicycleSteering,
    DiffDrive,
    Mecanum,
    Omni,
    TricycleDrive,
    TricycleSteering,
    given,
    is_set,
)
from six_wheel.parameters.controllers.limits import check_limits, with_limits
from six_wheel.parameters.controllers.names import reversed_by_sign, with_states
from six_wheel.parameters.joints import JointList
from six_wheel.parameters.nodes import Section
from six_wheel.parameters.schema import Common, Form, Values, as_argument, keys_of, shown
from six_wheel.parameters.syntax import Report

__all__ = ["CONTROLLERS"]

_SUM = "kinematics.sum_of_robot_center_projection_on_X_Y_axis"
_OFFSET = tuple(f"kinematics.base_frame_offset.{part}" for part in ("x", "y", "theta"))
_CORNERS = ("front_left", "front_right", "rear_left", "rear_right")

# Layouts. What is required and missing has been reported, and 1 stands in for it.


def _diff_drive(values: Values) -> Rover:
    track = values["wheel_separation"] * values.get("wheel_separation_multiplier", 1.0)
    left, right = (
        values["wheel_radius"] * abs(values.get(f"{side}_wheel_radius_multiplier", 1.0))
        for side in ("left", "right")
    )
    count = len(values["left_wheel_names"])
    wheelbase = values.get("wheelbase", track)
    return Rover.differential(track, (left, right), wheels_per_side=count, wheelbase=wheelbase)


def _mecanum(values: Values) -> Rover:
    total = values[_SUM] * values.get("wheel_separation_multiplier", 1.0)
    ahead = values.get("half_wheelbase", total / 2)
    radius = values["kinematics.wheels_radius"] * abs(values.get("wheel_radius_multiplier", 1.0))
    at_middle = Rover.mecanum(ahead, total - ahead, radius)
    x, y, theta = (values.get(key, 0.0) for key in _OFFSET)
    if x == y == theta == 0.0:
        return at_middle
    # The offset is the base frame as seen from the middle of the wheels; twists are those of the base frame.
    cos, sin = math.cos(theta), math.sin(theta)
    return Rover(
        [
            Wheel(
                wheel.name,
                cos * (wheel.x - x) + sin * (wheel.y - y),
                cos * (wheel.y - y) - sin * (wheel.x - x),
                radius=wheel.radius,
                heading=-theta,
                roller_angle=wheel.roller_angle,
            )
            for wheel in at_middle.wheels
        ]
    )


def _omni(values: Values) -> Rover:
    count, radius = len(values["wheel_names"]), values["robot_radius"]
    angles = [values["wheel_offset"] + 2 * math.pi / count * index for index in range(count)]
    positions = [(radius * math.cos(angle), radius * math.sin(angle)) for angle in angles]
    # A positive speed drives a wheel clockwise around the middle.
    return Rover.omni(positions, [angle - math.pi / 2 for angle in angles], values["wheel_radius"])


def _ackermann_steering(values: Values) -> Rover:
    track = given(values, *TRACK) or 1.0
    steered = given(values, *FRONT_TRACK) or track
    return _behind(_car(values, steered, track)) if _steers_behind(values) else _car(values, steered, track)


def _steers_behind(values: Values) -> bool:
    """Whether the names of all joints say that the front wheels drive and the rear ones steer."""

    def said(keys: tuple[str, ...]) -> set[str | None]:
        return {(said_by(name) or (None, None))[0] for name in given(values, *keys) or ()}

    return said(DRIVES) == {"front"} and said(STEERS) == {"rear"}


def _behind(car: Rover) -> Rover:
    """A car with its steered axle as far behind the origin as it was ahead of it, and named so."""
    other = {"front": "rear", "rear": "front"}
    wheels = []
    for wheel in sorted(car.wheels, key=lambda wheel: wheel.steered):
        axle, _, side = wheel.name.partition("_")
        wheels.append(
            Wheel(
                "_".join(filter(None, (other[axle], side))),
                0.0 - wheel.x,
                wheel.y,
                radius=wheel.radius,
                steered=wheel.steered,
                steering_limit=wheel.steering_limit,
                driven=wheel.driven,
            )
        )
    return Rover(wheels)


def _with_axle_behind(section: Section, values: Values) -> Values:
    """The controller steers as if the axle were ahead: behind, its joints count the other way."""
    values = with_limits(section, values)
    if _steers_behind(values) and "reversed_joints" not in values:
        return values | {"reversed_joints": list(given(values, *STEERS))}
    return values


def _tricycle_steering(values: Values) -> Rover:
    if _drives_front(values):
        return _car(values, None, given(values, *TRACK), driven="front")
    return _car(values, None, given(values, *TRACK) or 1.0)


def _drives_front(values: Values) -> bool:
    """Whether a tricycle has one joint that drives: then it is that of the steered wheel."""
    return len(given(values, *DRIVES) or ()) == 1


def _tricycle(values: Values) -> Rover:
    return _car(values, None, values.get("track_width"), driven="front")


def _bicycle_steering(values: Values) -> Rover:
    return _car(values, None, None)


def _car(
    values: Values, front_track: float | None, rear_track: float | None, *, driven: str = "rear"
) -> Rover:
    """Steered front and fixed rear wheels, one where there is no track; origin between the rear ones."""
    radius = given(values, *RADIUS, "wheel_radius") or 1.0
    front_radius = given(values, *FRONT_RADIUS) if driven == "rear" else None
    limit = as_argument(values.get("steering_limit"))
    steering = {"steered": True, "steering_limit": limit, "driven": driven == "front"}
    front = _axle("front", values["wheelbase"], front_track, front_radius or radius, **steering)
    return Rover([*front, *_axle("rear", 0.0, rear_track, radius, driven=driven == "rear")])


def _axle(name: str, x: float, track: float | None, radius: float, **keywords: Any) -> Iterator[Wheel]:
    if track is None:
        yield Wheel(name, x, 0.0, radius=radius, **keywords)
    else:
        yield Wheel(f"{name}_left", x, track / 2, radius=radius, **keywords)
        yield Wheel(f"{name}_right", x, -track / 2, radius=radius, **keywords)


# Joints.


def _right_before_left(values: Values, rover: Rover) -> list[JointList]:
    """Lists that the controller reads by position."""
    names = rover.wheel_names
    if values.get("front_steering") is False:  # which has been refused: the lists are about other wheels
        return []
    driven = tuple(wheel.name for wheel in rover.wheels if wheel.driven)[::-1]
    steered = rover.steered_names[::-1]
    lists = []
    for keys, wheels, lack in ((DRIVES, driven, "has no motor"), (STEERS, steered, "does not steer")):
        elsewhere = tuple(name for name in names if name not in wheels)
        key = next((key for key in keys if is_set(values.get(key))), keys[0])
        lists.append(JointList(key, wheels, elsewhere, lack, "expected", steers=keys is STEERS))
    return lists


def _by_side(values: Values, rover: Rover) -> list[JointList]:
    """Lists from front to rear, if names do not say otherwise: wheels of one side have one speed."""
    sides = {
        side: tuple(name for name in rover.wheel_names if name.endswith(side)) for side in ("left", "right")
    }
    lack = "is on the other side"
    return [
        JointList("left_wheel_names", sides["left"], sides["right"], lack, "silent"),
        JointList("right_wheel_names", sides["right"], sides["left"], lack, "silent"),
    ]


def _corner_by_corner(values: Values, rover: Rover) -> list[JointList]:
    return [
        JointList(
            f"{wheel}_wheel_command_joint_name",
            (wheel,),
            tuple(name for name in _CORNERS if name != wheel),
            "has a key of its own",
        )
        for wheel in _CORNERS
    ]


def _front_wheel(values: Values, rover: Rover) -> list[JointList]:
    rear = rover.wheel_names[1:]
    return [
        JointList("traction_joint_name", ("front",), rear, "has no motor"),
        JointList("steering_joint_name", ("front",), rear, steers=True),
    ]


def _around(values: Values, rover: Rover) -> list[JointList]:
    return [JointList("wheel_names", rover.wheel_names, order="fixed")]


# What keys say together, and what they say beyond our model.


def _check_diff_drive(section: Section, values: Values, error: Report, warning: Report) -> None:
    check_limits(section, values, error, warning)
    at, count = ("left_wheel_names",), len(values.get("left_wheel_names", ()))
    if count > 1 and "wheelbase" not in section.data:
        message = f"the file does not say where the {count} wheels of a side are; they are put on a square"
        remedy = (
            "add wheelbase, the distance from the last to the first axle; wheel speeds do not depend on it"
        )
        warning(section.line_of(at), at, message, remedy)
    per_side = values.get("wheels_per_side", 0)
    if count and per_side not in (0, count):
        at = ("wheels_per_side",)
        message = f"wheels_per_side is {per_side}, and left_wheel_names names {count} joints"
        warning(section.line_of(at), at, message, "the names count; leave out wheels_per_side")


def _check_mecanum(section: Section, values: Values, error: Report, warning: Report) -> None:
    check_limits(section, values, error, warning)
    if _SUM not in values:
        return
    if "half_wheelbase" not in section.data:
        message = (
            "the file does not say where the wheels are, only a sum of lengths; they are put on a square"
        )
        remedy = (
            "add half_wheelbase, the distance from the middle to each axle; wheel speeds do not depend on it"
        )
        warning(section.line_of((_SUM,)), (_SUM,), message, remedy)
    elif values.get("half_wheelbase", 0.0) >= values[_SUM]:
        at = ("half_wheelbase",)
        message = f"half_wheelbase must be smaller than {_SUM}, got {values['half_wheelbase']}"
        error(section.line_of(at), at, message, "the rest of that sum is the distance to each side")


def _check_tricycle(section: Section, values: Values, error: Report, warning: Report) -> None:
    check_limits(section, values, error, warning)
    if "track_width" not in section.data:
        message = (
            "the file does not say how far apart the rear wheels are; one wheel between them stands for both"
        )
        remedy = "add track_width, the distance from left to right rear wheel; commands do not depend on it"
        warning(section.line_of(("wheelbase",)), ("wheelbase",), message, remedy)
    limit = _steering_range(values)
    if limit is None and "steering_limit" not in section.data:
        message = "the file has no range of the steering: 90 degrees to both sides are assumed"
        warning(section.line_of(("wheelbase",)), ("wheelbase",), message, "add steering_limit, in radians")
    if limit is not None:
        at = (next(key for key in STEERING_RANGE[::-1] if is_set(values.get(key))),)
        try:
            Wheel("front", 0.0, 0.0, radius=1.0, steered=True, steering_limit=limit)
        except ValueError as refused:
            message = f"steering.min_position and max_position{str(refused).removeprefix('steering_limit')}"
            error(section.line_of(at), at, message, "they are the ends of the steering range, in radians")


def _steering_range(values: Values) -> tuple[float, float] | None:
    """The range between two positions; one of them alone holds to both sides."""
    lower, upper = (values.get(key, math.nan) for key in STEERING_RANGE)
    if math.isnan(lower) and math.isnan(upper):
        return None
    return (-upper if math.isnan(lower) else lower, -lower if math.isnan(upper) else upper)


def _with_steering_range(section: Section, values: Values) -> Values:
    limit = _steering_range(values)
    # The only one of them that counts its time-out in milliseconds.
    return with_limits(section, ({"steering_limit": list(limit)} if limit else {}) | values, second=1000.0)


def _check_steering(
    radii: tuple[str, ...], tracks: tuple[str, ...] = (), front: tuple[str, ...] = ()
) -> Callable[[Section, Values, Report, Report], None]:
    """The rules of the steering controllers, whose names changed between distributions."""

    def check(section: Section, values: Values, error: Report, warning: Report) -> None:
        check_limits(section, values, error, warning)
        if values.get("front_steering") is False:
            at = ("front_steering",)
            message = "front_steering is false, and which way a rear axle steers is not in the file"
            remedy = "describe the vehicle with kind: custom, its steering angles counter-clockwise"
            error(section.line_of(at), at, message, remedy)
        if front and _steers_behind(values):
            key = next(key for key in STEERS if is_set(values.get(key)))
            message = "the names say that the front wheels drive and the rear ones steer: so they are placed"
            remedy = "the steering joints then count clockwise, as the controller commands them"
            warning(section.line_of((key,)), (key,), message, remedy)
        if "steering_limit" not in section.data:
            message = "the file has no range of the steering: 90 degrees to both sides are assumed"
            warning(
                section.line_of(("wheelbase",)), ("wheelbase",), message, "add steering_limit, in radians"
            )
        alone = tracks == TRICYCLE_TRACK and _drives_front(values)
        for keys, needed in (
            (DRIVES, True),
            (STEERS, True),
            (radii, True),
            (tracks, not alone),
            (front, False),
        ):
            _check_names(section, values, error, keys, needed=needed)

    return check


def _check_names(
    section: Section, values: Values, error: Report, keys: tuple[str, ...], *, needed: bool
) -> None:
    """Of several names for one thing one is given, or they say the same."""
    named = [key for key in keys if is_set(section.data.get(key))]
    present = [key for key in keys if key in section.data]
    if needed and keys and not present:
        at, description = (keys[0],), _DESCRIPTIONS[keys[0]]
        error(section.line, at, f"{keys[0]} is missing", f"add {keys[0]}, {description}")
    elif needed and present and not named and present[0] in values:
        at, description = (present[0],), _DESCRIPTIONS[present[0]]
        message = f"{present[0]} must be set, got {shown(values[present[0]])}"
        error(section.line_of(at), at, message, f"it is {description}")
    both = [key for key in named if key in values]
    for key in both[1:]:
        if values[key] != values[both[0]]:
            message = f"{key} and {both[0]} are given, and differ"
            error(section.line_of((key,)), (key,), message, f"remove {key}, the older name")


TRICYCLE_TRACK = ("traction_track_width", "wheel_track")
_DESCRIPTIONS = {
    key: str(info.description)
    for schema in (BicycleSteering, TricycleSteering, AckermannSteering)
    for key, info in keys_of(schema).items()
}
_OF_OTHERS = {
    "steering_limit",
    "track_width",
    "half_wheelbase",
    "wheelbase",
    "wheel_radius",
    "wheels_per_side",
    "robot_radius",
    "wheel_separation_multiplier",
    "wheel_radius_multiplier",
}
_STAND_IN = {
    "wheelbase": 1.0,
    "wheel_radius": 1.0,
    "wheel_separation": 1.0,
    "robot_radius": 1.0,
    "wheel_offset": 0.0,
    "kinematics.wheels_radius": 1.0,
    _SUM: 2.0,
}


def _controller(
    name: str, kind: str, schema: type[Common], layout: Callable[[Values], Rover], **others: Any
) -> Form:
    keys = keys_of(schema).keys()
    class_ = "".join(map(str.capitalize, name.split("_")))
    return Form(
        name,
        kind,
        schema,
        layout,
        telling=frozenset(keys - keys_of(Common).keys() - LIMITS.keys() - {*STEERING_RANGE} - _OF_OTHERS),
        stand_in={key: value for key, value in _STAND_IN.items() if key in keys},
        controller=f"{name}/{class_}",
        **{"complete": with_limits} | others,
    )


_STEERED_STATES = {
    "traction_joints_names": "traction_joints_state_names",
    "steering_joints_names": "steering_joints_state_names",
    "rear_wheels_names": "rear_wheels_state_names",
    "front_wheels_names": "front_wheels_state_names",
}


CONTROLLERS = (
    _controller(
        "diff_drive_controller",
        "differential",
        DiffDrive,
        _diff_drive,
        joint_lists=_by_side,
        check=_check_diff_drive,
        complete=with_states(
            dict.fromkeys(("left_wheel_names", "right_wheel_names"), ""),
            reversed_by_sign(
                {f"{side}_wheel_radius_multiplier": (f"{side}_wheel_names",) for side in ("left", "right")}
            ),
        ),
    ),
    _controller(
        "ackermann_steering_controller",
        "ackermann",
        AckermannSteering,
        _ackermann_steering,
        joint_lists=_right_before_left,
        complete=with_states(_STEERED_STATES, _with_axle_behind),
        check=_check_steering(RADIUS[:2], TRACK[:2], FRONT_TRACK),
    ),
    _controller(
        "tricycle_steering_controller",
        "tricycle",
        TricycleSteering,
        _tricycle_steering,
        joint_lists=_right_before_left,
        complete=with_states(_STEERED_STATES, with_limits),
        check=_check_steering(RADIUS[:2], TRICYCLE_TRACK),
    ),
    _controller(
        "tricycle_controller",
        "tricycle",
        TricycleDrive,
        _tricycle,
        joint_lists=_front_wheel,
        check=_check_tricycle,
        complete=_with_steering_range,
    ),
    _controller(
        "bicycle_steering_controller",
        "bicycle",
        BicycleSteering,
        _bicycle_steering,
        joint_lists=_right_before_left,
        complete=with_states(_STEERED_STATES, with_limits),
        check=_check_steering(RADIUS[2:]),
    ),
    _controller(
        "mecanum_drive_controller",
        "mecanum",
        Mecanum,
        _mecanum,
        joint_lists=_corner_by_corner,
        check=_check_mecanum,
        complete=with_states(
            {f"{wheel}_wheel_command_joint_name": f"{wheel}_wheel_state_joint_name" for wheel in _CORNERS},
            reversed_by_sign(
                {"wheel_radius_multiplier": [f"{wheel}_wheel_command_joint_name" for wheel in _CORNERS]}
            ),
        ),
        more=("clearpath_mecanum_drive_controller/MecanumDriveController",),
    ),
    _controller("omni_wheel_drive_controller", "omni", Omni, _omni, joint_lists=_around, check=check_limits),
)
