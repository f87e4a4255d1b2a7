"""Controllers of ROS 1 and of vendors that drive what those of ros2_controllers do, under other keys."""

from typing import Annotated, Any, TypeAlias

from pydantic import BeforeValidator, Field

from six_wheel._core import Rover
from six_wheel.robot_description.parameters.foreign.limits import check_limits, with_limits
from six_wheel.robot_description.parameters.foreign.names import reversed_by_sign
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report
from six_wheel.robot_description.parameters.schema import (
    Common,
    Factor,
    Form,
    Length,
    Name,
    Values,
    optional,
    required,
)

__all__ = ["DRIVES"]

CORNERS = ("front_left", "front_right", "rear_left", "rear_right")


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


Joints: TypeAlias = Annotated[list[Name], Field(min_length=1, max_length=32), BeforeValidator(_as_list)]
_FROM_URDF = "the controller of ROS 1 takes it from the URDF: give that file, or the number in metres"


# Mecanum wheels by the distances between them: Husarion's, and that of ROS 1.


class MecanumBySeparation(Common):
    front_left_wheel_name: Name = optional("the joint of the front left wheel")
    front_right_wheel_name: Name = optional("the joint of the front right wheel")
    rear_left_wheel_name: Name = optional("the joint of the rear left wheel")
    rear_right_wheel_name: Name = optional("the joint of the rear right wheel")
    front_left_wheel_joint: Name = optional("the joint of the front left wheel, as ROS 1 calls it")
    front_right_wheel_joint: Name = optional("the joint of the front right wheel, as ROS 1 calls it")
    back_left_wheel_joint: Name = optional("the joint of the rear left wheel, as ROS 1 calls it")
    back_right_wheel_joint: Name = optional("the joint of the rear right wheel, as ROS 1 calls it")
    wheel_separation_x: Length = required("the distance from rear to front axle, in metres")
    wheel_separation_y: Length = required("the distance from left to right wheels, in metres")
    wheel_radius: Length = required("the wheels' radius, in metres")
    wheel_separation_x_multiplier: Length = optional("a factor, positive")
    wheel_separation_y_multiplier: Length = optional("a factor, positive")
    wheel_radius_multiplier: Factor = optional("a factor; a negative one reverses the joints")


def _mecanum_by_separation(values: Values) -> Rover:
    ahead, aside = (
        values[f"wheel_separation_{axis}"] * values.get(f"wheel_separation_{axis}_multiplier", 1.0) / 2
        for axis in "xy"
    )
    radius = values["wheel_radius"] * abs(values.get("wheel_radius_multiplier", 1.0))
    return Rover.mecanum(ahead, aside, radius)


def _mecanum_key(values: Values, wheel: str) -> str:
    older = f"{wheel.replace('rear', 'back')}_wheel_joint"
    return older if older in values else f"{wheel}_wheel_name"


def _corner_by_corner(values: Values, rover: Rover) -> list[JointList]:
    keys = {wheel: _mecanum_key(values, wheel) for wheel in CORNERS}
    return [JointList(key, (wheel,), order="fixed") for wheel, key in keys.items() if key in values]


def _check_mecanum(section: Section, values: Values, error: Report, warning: Report) -> None:
    check_limits(section, values, error, warning)
    missing = [wheel for wheel in CORNERS if _mecanum_key(values, wheel) not in section.data]
    for wheel in missing if len(missing) < len(CORNERS) else ():
        key = _mecanum_key(values, wheel)
        error(section.line, (key,), f"{key} is missing", f"add {key}, the joint of the {wheel} wheel")


# ROS 1.


class DiffDrive1(Common):
    left_wheel: Joints = required("the joint on the left, or a list of them, front to rear")
    right_wheel: Joints = required("the joint on the right, or a list of them, front to rear")
    wheel_separation: Length = required(f"the distance from left to right wheels; {_FROM_URDF}")
    wheel_radius: Length = required(f"the wheels' radius; {_FROM_URDF}")
    wheel_separation_multiplier: Length = optional("a factor, positive")
    wheel_radius_multiplier: Factor = optional("a factor; a negative one reverses the joints")
    left_wheel_radius_multiplier: Factor = optional("a factor; a negative one reverses the joints")
    right_wheel_radius_multiplier: Factor = optional("a factor; a negative one reverses the joints")
    wheelbase: Length = optional("the distance from the last to the first axle, in metres")


def _diff_drive(values: Values) -> Rover:
    track = values["wheel_separation"] * values.get("wheel_separation_multiplier", 1.0)
    both = abs(values.get("wheel_radius_multiplier", 1.0))
    left, right = (
        values["wheel_radius"] * both * abs(values.get(f"{side}_wheel_radius_multiplier", 1.0))
        for side in ("left", "right")
    )
    count = len(values["left_wheel"])
    base = values.get("wheelbase", track)
    return Rover.differential(track, (left, right), wheels_per_side=count, wheelbase=base)


def _by_side(values: Values, rover: Rover) -> list[JointList]:
    sides = {side: tuple(n for n in rover.wheel_names if n.endswith(side)) for side in ("left", "right")}
    lack = "is on the other side"
    return [
        JointList("left_wheel", sides["left"], sides["right"], lack, "silent"),
        JointList("right_wheel", sides["right"], sides["left"], lack, "silent"),
    ]


class AckermannSteering1(Common):
    rear_wheel: Name = required("the joint that drives, between the rear wheels")
    front_steer: Name = required("the joint that steers, between the front wheels")
    wheel_separation_h: Length = required(f"the distance from rear to front axle; {_FROM_URDF}")
    wheel_radius: Length = required(f"the wheels' radius; {_FROM_URDF}")
    wheel_separation_h_multiplier: Length = optional("a factor, positive")
    wheel_radius_multiplier: Factor = optional("a factor; a negative one reverses the joint")


def _one_track(values: Values) -> Rover:
    base = values["wheel_separation_h"] * values.get("wheel_separation_h_multiplier", 1.0)
    radius = values["wheel_radius"] * abs(values.get("wheel_radius_multiplier", 1.0))
    return Rover.bicycle(base, radius)


def _front_and_rear(values: Values, rover: Rover) -> list[JointList]:
    return [
        JointList("rear_wheel", ("rear",), ("front",), "has no motor", "fixed"),
        JointList("front_steer", ("front",), ("rear",), order="fixed", steers=True),
    ]


def _form(
    name: str, kind: str, schema: type[Common], layout: Any, joints: Any, telling: set[str], **others: Any
) -> Form:
    usual: dict[str, Any] = {"check": check_limits, "complete": with_limits, "ros1": True}
    return Form(name, kind, schema, layout, joints, telling=frozenset(telling), **usual | others)


DRIVES = (
    _form(
        "husarion_mecanum_drive_controller",
        "mecanum",
        MecanumBySeparation,
        _mecanum_by_separation,
        _corner_by_corner,
        {"wheel_separation_x", "wheel_separation_y"},
        stand_in=dict.fromkeys(("wheel_separation_x", "wheel_separation_y", "wheel_radius"), 1.0),
        check=_check_mecanum,
        complete=reversed_by_sign(
            {"wheel_radius_multiplier": tuple(f"{wheel}_wheel_name" for wheel in CORNERS)}
        ),
        controller="husarion_mecanum_drive_controller/MecanumDriveController",
    ),
    _form(
        "diff_drive_controller of ROS 1",
        "differential",
        DiffDrive1,
        _diff_drive,
        _by_side,
        {"left_wheel", "right_wheel"},
        stand_in={"wheel_separation": 1.0, "wheel_radius": 1.0},
        complete=reversed_by_sign(
            {
                "wheel_radius_multiplier": ("left_wheel", "right_wheel"),
                "left_wheel_radius_multiplier": ("left_wheel",),
                "right_wheel_radius_multiplier": ("right_wheel",),
            }
        ),
    ),
    _form(
        "ackermann_steering_controller of ROS 1",
        "bicycle",
        AckermannSteering1,
        _one_track,
        _front_and_rear,
        {"rear_wheel", "front_steer"},
        stand_in={"wheel_separation_h": 1.0, "wheel_radius": 1.0},
        complete=reversed_by_sign({"wheel_radius_multiplier": ("rear_wheel",)}),
    ),
)
