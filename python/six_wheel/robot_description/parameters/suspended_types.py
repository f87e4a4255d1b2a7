"""Kinds of vehicle with a suspension: rocker-bogie, four axles; and keys that all kinds share."""

from typing import Annotated, Any, TypeAlias

from pydantic import Field

from six_wheel._core import FourAxle, RockerBogie, Rover
from six_wheel.robot_description.parameters.key_types import (
    Common,
    Finite,
    Joints,
    Length,
    Name,
    NumberOrPair,
    SteeringLimit,
    Values,
    asks_core,
    optional,
    required,
)
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report

ROCKER: Values = {
    "rocker_pivot": (0.1, 0.2, 0.1),
    "rocker_to_front": (0.3, 0.0, -0.1),
    "rocker_to_bogie": (-0.1, 0.0, -0.1),
    "bogie_to_middle": (0.1, 0.0, 0.0),
    "bogie_to_rear": (-0.1, 0.0, 0.0),
    "wheel_radius": 0.1,
}

IN_FRONT: Values = {
    "rocker_pivot": (0.1, 0.2, 0.1),
    "rocker_to_rear": (-0.3, 0.0, -0.1),
    "rocker_to_bogie": (0.1, 0.0, -0.1),
    "bogie_to_front": (0.1, 0.0, 0.0),
    "bogie_to_middle": (-0.1, 0.0, 0.0),
    "wheel_radius": 0.1,
}

AXLES: Values = {"pivots": (1.0, 1.0), "axle_length": 1.0, "wheel_radius": 1.0}
WHEEL_RADIUS = "the wheels' radius, in metres"
STEERING_LIMIT = "an angle or [lower, upper], in radians"


class OwnKeys(Common):
    traction_joints: Joints = optional(
        "a list with the joint of every driven wheel, or a mapping of wheel to joint"
    )


class SteeringKeys(OwnKeys):
    steering_joints: Joints = optional(
        "a list with the joint of every steered wheel, or a mapping of wheel to joint"
    )


class SteeredKeys(SteeringKeys):
    steering_limit: SteeringLimit = optional(STEERING_LIMIT)


_Vector: TypeAlias = Annotated[list[Finite], Field(min_length=3, max_length=3)]
_Pivot: TypeAlias = Annotated[_Vector, asks_core(RockerBogie, "rocker_pivot", **ROCKER)]
_ToFront: TypeAlias = Annotated[_Vector, asks_core(RockerBogie, "rocker_to_front", **ROCKER)]
_ToRear: TypeAlias = Annotated[_Vector, asks_core(RockerBogie, "rocker_to_rear", **IN_FRONT)]
_ToBogie: TypeAlias = Annotated[_Vector, asks_core(RockerBogie, "rocker_to_bogie", **ROCKER)]
_BogieToFront: TypeAlias = Annotated[_Vector, asks_core(RockerBogie, "bogie_to_front", **IN_FRONT)]
_BogieToMiddle: TypeAlias = Annotated[_Vector, asks_core(RockerBogie, "bogie_to_middle", **ROCKER)]
_BogieToRear: TypeAlias = Annotated[_Vector, asks_core(RockerBogie, "bogie_to_rear", **ROCKER)]
_Limit: TypeAlias = Annotated[NumberOrPair, asks_core(RockerBogie, "rocker_limit", **ROCKER)]


class RockerBogieKeys(SteeredKeys):
    rocker_pivot: _Pivot = required("[x, y, z] of the left rocker's pivot, in metres")
    rocker_to_front: _ToFront = optional("[x, y, z] from there to the front wheel's centre, in metres")
    rocker_to_rear: _ToRear = optional("the same to the rear wheel's centre, where the bogie is in front")
    rocker_to_bogie: _ToBogie = required("[x, y, z] from there to the bogie's pivot, in metres")
    bogie_to_front: _BogieToFront = optional(
        "[x, y, z] from the bogie's pivot to the front wheel's centre, where the bogie is in front"
    )
    bogie_to_middle: _BogieToMiddle = required(
        "[x, y, z] from the bogie's pivot to the middle wheel's centre, in metres"
    )
    bogie_to_rear: _BogieToRear = optional(
        "[x, y, z] from the bogie's pivot to the rear wheel's centre, in metres"
    )
    wheel_radius: Length = required(WHEEL_RADIUS)
    steered: Annotated[Name, asks_core(RockerBogie, "steered", **ROCKER)] = optional(
        "the wheels that steer: corners or front"
    )
    rocker_limit: _Limit = optional("the rocker's stops, an angle or [lower, upper], in radians")
    bogie_limit: _Limit = optional("the bogies' stops, an angle or [lower, upper], in radians")
    differential_bar: Annotated[_Vector, asks_core(RockerBogie, "differential_bar", **ROCKER)] = optional(
        "[half length, lever, rod] of a differential bar, in metres"
    )


class FourAxleKeys(SteeredKeys):
    pivots: Annotated[
        list[Finite], Field(min_length=2, max_length=2), asks_core(FourAxle, "pivots", **AXLES)
    ] = required("[x, y], half the distance of the pivots along and across the body, in metres")
    axle_length: Length = required("the distance from pivot to wheel, in metres")
    wheel_radius: Length = required(WHEEL_RADIUS)


def check_bogies(section: Section, values: Values, error: Report, warning: Report) -> None:
    """The bogie carries two wheels and the rocker the third: the rear ones and the front one, or the other
    way round."""
    data = section.data
    in_front = bool({"rocker_to_rear", "bogie_to_front"} & data.keys())
    wanted = ("rocker_to_rear", "bogie_to_front") if in_front else ("rocker_to_front", "bogie_to_rear")
    unwanted = ("rocker_to_front", "bogie_to_rear") if in_front else ()
    for key in wanted:
        if key not in data:
            description = RockerBogieKeys.model_fields[key].description
            error(section.line, (key,), f"{key} is missing", f"add {key}, {description}")
    for key in unwanted:
        if key in data:
            message = f"{key} is given beside keys for a bogie in front"
            section.report(error, (key,), message, f"remove {key}, or rocker_to_rear and bogie_to_front")


def on_flat_ground(**arguments: Any) -> Rover:
    """A rocker-bogie rover: its wheels where its suspension puts them with all joints at zero."""
    arm = RockerBogie(**arguments)
    return Rover(arm.planar().wheels, suspension=arm)


def with_axles_locked(**arguments: Any) -> Rover:
    return FourAxle(**arguments).rover
