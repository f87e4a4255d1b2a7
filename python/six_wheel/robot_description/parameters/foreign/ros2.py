"""The controllers of ros2_controllers that drive a vehicle: a table, one entry each.

What a file for them says beyond our model is reported; what would change the kinematics is applied or
refused.
"""

import math
from collections.abc import Callable
from typing import Any

from six_wheel._core import Rover, Wheel
from six_wheel.robot_description.parameters.foreign.keys import (
    FRONT_TRACK,
    LIMITS,
    RADIUS,
    STEERING_RANGE,
    TRACK,
    AckermannSteering,
    BicycleSteering,
    DiffDrive,
    Mecanum,
    MecanumInOrder,
    Omni,
    TricycleDrive,
    TricycleSteering,
)
from six_wheel.robot_description.parameters.foreign.limits import check_limits, with_limits
from six_wheel.robot_description.parameters.foreign.names import reversed_by_sign, with_states
from six_wheel.robot_description.parameters.foreign.steering import (
    STEERED_STATES,
    TRICYCLE_TRACK,
    ackermann_steering,
    bicycle_steering,
    check_steering,
    check_tricycle,
    right_before_left,
    steered_wheel,
    tricycle,
    tricycle_steering,
    with_axle_behind,
    with_steering_range,
)
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report
from six_wheel.robot_description.parameters.schema import Common, Form, Values, keys_of

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


# Joints.


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


def _around_the_body(values: Values, rover: Rover) -> list[JointList]:
    order = ("front_left", "rear_left", "rear_right", "front_right")
    return [JointList("command_joint_names", order, order="fixed")]


def _around(values: Values, rover: Rover) -> list[JointList]:
    return [JointList("wheel_names", rover.wheel_names, order="fixed")]


# Checks of several keys together, and of keys beyond the model.


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
    usual: dict[str, Any] = {"complete": with_limits, "controller": f"{name}/{class_}"}
    return Form(
        name,
        kind,
        schema,
        layout,
        telling=frozenset(keys - keys_of(Common).keys() - LIMITS.keys() - {*STEERING_RANGE} - _OF_OTHERS),
        stand_in={key: value for key, value in _STAND_IN.items() if key in keys},
        **usual | others,
    )


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
        ackermann_steering,
        joint_lists=right_before_left,
        complete=with_states(STEERED_STATES, with_axle_behind),
        check=check_steering(RADIUS[:2], TRACK[:2], FRONT_TRACK),
    ),
    _controller(
        "tricycle_steering_controller",
        "tricycle",
        TricycleSteering,
        tricycle_steering,
        joint_lists=right_before_left,
        complete=with_states(STEERED_STATES, with_axle_behind),
        check=check_steering(RADIUS[:2], TRICYCLE_TRACK),
    ),
    _controller(
        "tricycle_controller",
        "tricycle",
        TricycleDrive,
        tricycle,
        joint_lists=steered_wheel,
        check=check_tricycle,
        complete=with_steering_range,
    ),
    _controller(
        "bicycle_steering_controller",
        "bicycle",
        BicycleSteering,
        bicycle_steering,
        joint_lists=right_before_left,
        complete=with_states(STEERED_STATES, with_axle_behind),
        check=check_steering(RADIUS[2:]),
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
    ),
    _controller(
        "clearpath_mecanum_drive_controller",
        "mecanum",
        MecanumInOrder,
        _mecanum,
        joint_lists=_around_the_body,
        check=_check_mecanum,
        complete=with_states(
            {"command_joint_names": "state_joint_names"},
            reversed_by_sign({"wheel_radius_multiplier": ["command_joint_names"]}),
        ),
        controller="clearpath_mecanum_drive_controller/MecanumDriveController",
    ),
    _controller("omni_wheel_drive_controller", "omni", Omni, _omni, joint_lists=_around, check=check_limits),
)
