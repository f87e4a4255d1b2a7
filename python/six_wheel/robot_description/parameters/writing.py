"""Parameter files that are read as the same rover again."""

from collections.abc import Mapping
from typing import Any

from six_wheel._core import Limits, Rover, Wheel
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.rover_edit import limits_given
from six_wheel.robot_description.diagnostics import ParameterFileError
from six_wheel.robot_description.joint_names import wheel_said_by
from six_wheel.robot_description.parameters import ros_yaml
from six_wheel.robot_description.parameters.file import parse_parameters
from six_wheel.robot_description.parameters.key_types import NONE_WORDS, Values
from six_wheel.robot_description.parameters.ros_node_parameters import PARAMETERS
from six_wheel.robot_description.wheels_of_rover import joints_as_given

_SIX = Rover.six_wheel(front_to_middle=1.0, middle_to_rear=1.0, track_width=2.0, wheel_radius=1.0)


@checked()
def dump(
    rover: Rover,
    *,
    node: str | None = None,
    odom_frame_id: str = "odom",
    base_frame_id: str = "base_link",
    limits: Limits | None = None,
    control: Mapping[str, Any] | None = None,
) -> str:
    """The text of a parameter file from which `load` returns an equal rover.

    Parameters
    ----------
    rover : Rover
        Any; one of the layout of `Rover.six_wheel` gets the keys of that, another ``kind: custom``.
    node : str, optional
        Node name, for the form of ROS 2; None for this package's plain form.
    odom_frame_id, base_frame_id : str
        Names of the frames.
    limits : Limits, optional
        Of the motion.
    control : mapping of str to object, optional
        Keywords of `Controller`.

    Raises
    ------
    ValueError
        If the keys of a parameter file cannot say what this rover is, such as a name with a line break.
    """
    others: Values = {"odom_frame_id": odom_frame_id, "base_frame_id": base_frame_id}
    given = {} if limits is None else limits_given(limits)
    ways = {key: NONE_WORDS[key] if value is None else value for key, value in (control or {}).items()}
    others |= {key: value for key, value in (("limits", given), ("control", ways)) if value}
    for values in (_six_wheel_values(rover), _suspended_values(rover), _custom_values(rover)):
        text = ros_yaml.write(values | others if node is None else {node: {PARAMETERS: values | others}})
        # Keys say less than a rover can be (a wheel out of line, an invisible name): what comes back decides.
        try:
            if values and _same_on_flat_ground(parse_parameters(text, node=node).rover, rover, values):
                return text
        except ParameterFileError:
            continue
    raise ValueError(f"rover must have names with visible characters, got {rover}")


def _six_wheel_values(rover: Rover) -> Values:
    """The keys of `Rover.six_wheel`, nothing for another layout."""
    wheels = {wheel.name: wheel for wheel in rover.wheels}
    if rover.wheel_names != _SIX.wheel_names:
        return {}
    front, middle, rear = (wheels[name] for name in ("front_left", "middle_left", "rear_left"))
    steering, traction = joints_as_given(rover)
    stated = {
        joint: wheel
        for joint, wheel in (traction | steering).items()
        if wheel_said_by(joint, wheels) != wheel
    }
    values: Values = {
        "traction_joints": list(traction),
        "steering_joints": list(steering),
        "wheel_of_joint": stated,
        "reversed_joints": list(rover.reversed_joints),
        "d1": front.y,
        "d2": -rear.x,
        "d3": front.x,
        "d4": middle.y,
        "wheel_radius": front.radius,
        "steering_limit": list(front.steering_range or ()),
    }
    if front.steering_range == _SIX.wheels[0].steering_range:
        del values["steering_limit"]
    return {key: value for key, value in values.items() if value not in ({}, [])}


def _suspended_values(rover: Rover) -> Values:
    """The keys of a rocker-bogie, nothing for a rover without one."""
    arm = rover.suspension
    if arm is None:
        return {}
    said = {key: list(value) if isinstance(value, tuple) else value for key, value in arm.dimensions.items()}
    return (
        {"kind": "rocker_bogie"}
        | {key: value for key, value in said.items() if value is not None}
        | _joints_of(rover)
    )


def _same_on_flat_ground(found: Rover, rover: Rover, values: Values) -> bool:
    """True if the rover read back equals the one written, with its suspension where the keys can hold one."""
    return found == (rover.replace(suspension=None) if values.get("kind") == "custom" else rover)


def _joints_of(rover: Rover) -> Values:
    """Joints by wheel, as every kind takes them."""
    steering, traction = joints_as_given(rover)
    joints = {"traction_joints": traction, "steering_joints": steering}
    named: Values = {
        key: {wheel: joint for joint, wheel in value.items()} for key, value in joints.items() if value
    }
    if rover.reversed_joints:
        named["reversed_joints"] = list(rover.reversed_joints)
    return named


def _custom_values(rover: Rover) -> Values:
    """The keys of every wheel, as far as they are not as usual."""
    usual = Wheel("usual", 0.0, 0.0, radius=1.0)
    wheels: Values = {}
    for wheel in rover.wheels:
        keys: Values = {"x": wheel.x, "y": wheel.y, "radius": wheel.radius}
        for key in ("steered", "heading", "scrub", "trail", "roller_angle", "castor"):
            if getattr(wheel, key) != getattr(usual, key):
                keys[key] = getattr(wheel, key)
        if wheel.steering_range is not None:
            keys["steering_limit"] = list(wheel.steering_range)
        if not wheel.driven and not wheel.castor:
            keys["driven"] = False
        wheels[wheel.name] = keys
    return {"kind": "custom", "wheels": wheels} | _joints_of(rover)


def text_of(rover: Rover, **others: Any) -> str:
    """A parameter file of a rover, for its records, `others` as for `dump`; empty if no file can say it."""
    try:
        return dump(rover, **others)
    except ValueError:
        return ""
