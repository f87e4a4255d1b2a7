"""The Open Source Rover, Curio, Leo, TurtleBot3 and those of Rover Robotics: what their files call things."""

from typing import Annotated, Literal

from pydantic import Field, Strict

from six_wheel._core import Rover, Wheel
from six_wheel.robot_description.parameters.foreign.limits import check_limits, with_limits
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report
from six_wheel.robot_description.parameters.schema import (
    Common,
    Finite,
    Flag,
    Form,
    Length,
    Name,
    Positive,
    Values,
    optional,
    required,
)

__all__ = ["ROVERS"]

CORNERS = ("front_left", "front_right", "rear_left", "rear_right")
SIX = ("front_left", "front_right", "middle_left", "middle_right", "rear_left", "rear_right")
_Count = Annotated[float, Strict(), Field(ge=0, allow_inf_nan=False)]


def stated_joints(values: Values, rover: Rover) -> list[JointList]:
    """Lists of joints that the file or its robot states as wheel to joint."""
    lists = []
    for key, steers in (("traction_joints", False), ("steering_joints", True)):
        wheels = rover.steered_names if steers else tuple(w.name for w in rover.wheels if w.driven)
        if key in values:
            others = tuple(name for name in rover.wheel_names if name not in wheels)
            lists.append(JointList(key, wheels, others, steers=steers))
    return lists


# The Open Source Rover: rover_dimensions of the node `rover`, osr_bringup/config/osr_params.yaml.


class OpenSourceRover(Common):
    d1: Finite = required("half the distance between left and right corner wheels", "rover_dimensions.d1")
    d2: Finite = required("the distance from middle to rear axle, in metres", "rover_dimensions.d2")
    d3: Finite = required("the distance from middle to front axle, in metres", "rover_dimensions.d3")
    d4: Finite = required("half the distance between middle wheels, in metres", "rover_dimensions.d4")
    wheel_radius: Length = required("the wheels' radius, in metres", "rover_dimensions.wheel_radius")
    drive_no_load_rpm: Length = optional("the speed of the drive motors without load, in turns per minute")


_OSR_PLACES = {"front": "front", "middle": "middle", "rear": "back"}


def _open_source_rover(values: Values) -> Rover:
    return Rover.six_wheel(**{key: values[f"rover_dimensions.{key}"] for key in _DIMENSIONS})


_DIMENSIONS = ("d1", "d2", "d3", "d4", "wheel_radius")


def _with_osr_joints(section: Section, values: Values) -> Values:
    """The joints have no key: these are the names that the rover's own nodes publish."""
    names = {wheel: f"{wheel.split('_')[1]}_{_OSR_PLACES[wheel.split('_')[0]]}" for wheel in SIX}
    steering = {wheel: f"corner_{names[wheel]}" for wheel in CORNERS}
    said = {"traction_joints": {wheel: f"drive_{name}" for wheel, name in names.items()}}
    # The corners count about an axis that points down.
    return {**said, "steering_joints": steering, "reversed_joints": list(steering.values())} | values


def _say_osr(section: Section, values: Values, error: Report, warning: Report) -> None:
    at = ("rover_dimensions.d1",)
    message = (
        "the joints get the names that the rover's nodes give them (drive_left_front, corner_left_front)"
    )
    warning(
        section.line_of(at),
        at,
        message,
        "corner joints count clockwise there, and its /cmd_drive takes the right wheels' speeds negated; "
        "state other names or signs with traction_joints, steering_joints and reversed_joints",
    )


# Curio: the ackermann_drive_controller of srmainwaring/curio, six wheels of which four steer.


class Curio(Common):
    wheel_radius: Length = required("the wheels' radius, in metres")
    mid: Length = required("the distance between the middle wheels, in metres", "mid_wheel_lat_separation")
    front: Length = required("the distance between the front wheels, in metres", "front_wheel_lat_separation")
    ahead: Length = required(
        "the distance from middle to front axle, in metres", "front_wheel_lon_separation"
    )
    back: Length = required("the distance between the rear wheels, in metres", "back_wheel_lat_separation")
    behind: Length = required("the distance from middle to rear axle, in metres", "back_wheel_lon_separation")
    wheel_radius_multiplier: Length = optional("a factor, positive")
    mid_wheel_lat_separation_multiplier: Length = optional("a factor, positive")
    front_left_wheel: Name = optional("the joint that drives the front left wheel")
    front_right_wheel: Name = optional("the joint that drives the front right wheel")
    mid_left_wheel: Name = optional("the joint that drives the middle left wheel")
    mid_right_wheel: Name = optional("the joint that drives the middle right wheel")
    back_left_wheel: Name = optional("the joint that drives the rear left wheel")
    back_right_wheel: Name = optional("the joint that drives the rear right wheel")
    front_left_steer: Name = optional("the joint that steers the front left wheel")
    front_right_steer: Name = optional("the joint that steers the front right wheel")
    back_left_steer: Name = optional("the joint that steers the rear left wheel")
    back_right_steer: Name = optional("the joint that steers the rear right wheel")


_CURIO_PLACES = {"front": "front", "middle": "mid", "rear": "back"}


def _curio(values: Values) -> Rover:
    radius = values["wheel_radius"] * values.get("wheel_radius_multiplier", 1.0)
    middle = values["mid_wheel_lat_separation"] * values.get("mid_wheel_lat_separation_multiplier", 1.0)
    rows = {
        "front": (values["front_wheel_lon_separation"], values["front_wheel_lat_separation"]),
        "middle": (0.0, middle),
        "rear": (-values["back_wheel_lon_separation"], values["back_wheel_lat_separation"]),
    }
    return Rover(
        [
            Wheel(f"{axle}_{side}", x, way * track / 2, radius=radius, steered=axle != "middle")
            for axle, (x, track) in rows.items()
            for side, way in (("left", 1.0), ("right", -1.0))
        ]
    )


def _curio_key(wheel: str, what: str) -> str:
    axle, side = wheel.split("_")
    return f"{_CURIO_PLACES[axle]}_{side}_{what}"


def _curio_joints(values: Values, rover: Rover) -> list[JointList]:
    kinds = (("wheel", SIX, False), ("steer", CORNERS, True))
    return [
        JointList(_curio_key(wheel, what), (wheel,), order="fixed", steers=steers)
        for what, wheels, steers in kinds
        if all(_curio_key(wheel, what) in values for wheel in wheels)
        for wheel in wheels
    ]


# Leo: the firmware's parameters, and TurtleBot3's node.


class Leo(Common):
    wheel_radius: Length = required("the wheels' radius, in metres", "controller.wheel_radius")
    separation: Length = required(
        "the distance from left to right wheels, in metres", "controller.wheel_separation"
    )
    base: Length = optional("the distance from rear to front axle, in metres", "controller.wheel_base")
    multiplier: Length = optional("a factor, positive", "controller.angular_velocity_multiplier")
    timeout: _Count = optional("a time in milliseconds, 0 for never", "controller.input_timeout")
    mecanum: Flag = optional("whether the wheels are mecanum wheels", "mecanum_wheels")


_LEO_JOINTS = {
    "front_left": "wheel_FL_joint",
    "front_right": "wheel_FR_joint",
    "rear_left": "wheel_RL_joint",
    "rear_right": "wheel_RR_joint",
}


def _leo(values: Values) -> Rover:
    radius, track = values["controller.wheel_radius"], values["controller.wheel_separation"]
    key = "controller.wheel_base"
    base: float = values.get(key) or track
    if values.get("mecanum_wheels", False):
        return Rover.mecanum(base / 2, track / 2, radius)
    factor = values.get("controller.angular_velocity_multiplier", 1.0)
    return Rover.differential(track * factor, radius, wheels_per_side=2, wheelbase=base)


def _with_leo_joints(section: Section, values: Values) -> Values:
    said: Values = {"traction_joints": dict(_LEO_JOINTS)} | values
    if "controller.input_timeout" in values:
        milliseconds: float = values["controller.input_timeout"]
        timeout = milliseconds / 1000 if milliseconds else "never"
        said["control"] = {"timeout": timeout} | values.get("control", {})
    return said


def _check_leo(section: Section, values: Values, error: Report, warning: Report) -> None:
    key = "controller.angular_velocity_multiplier"
    if values.get("mecanum_wheels") and values.get(key, 1.0) != 1.0:
        warning(
            section.line_of((key,)), (key,), f"{key} is not read for mecanum wheels", "calibrate finds it"
        )
    elif not values.get("mecanum_wheels") and "controller.wheel_base" not in section.data:
        at = ("controller.wheel_separation",)
        message = "the file does not say where the 2 wheels of a side are; they are put on a square"
        warning(
            section.line_of(at), at, message, "add controller.wheel_base; wheel speeds do not depend on it"
        )


class TurtleBot3(Common):
    separation: Length = required("the distance from left to right wheel, in metres", "wheels.separation")
    radius: Length = required("the wheels' radius, in metres", "wheels.radius")


def _turtlebot3(values: Values) -> Rover:
    return Rover.differential(values["wheels.separation"], values["wheels.radius"])


def _with_turtlebot3_joints(section: Section, values: Values) -> Values:
    joints = {"left": "wheel_left_joint", "right": "wheel_right_joint"}
    return {"traction_joints": joints} | values


# Rover Robotics: the node roverrobotics_driver.


class RoverRobotics(Common):
    wheel_radius: Length = required("the wheels' radius, in metres")
    wheel_base: Length = required("the distance from left to right wheels, in metres")
    robot_length: Length = required("the distance from rear to front axle, in metres")
    drivetrain: Literal["differential", "mecanum"] = optional("what the wheels are")
    robot_type: Name = optional("the model; of one with 2wd in it only two wheels drive")
    linear_top_speed: Positive = optional("a speed in m/s")
    angular_top_speed: Positive = optional("a rate of turn in rad/s")


# Of the driver, and no matter of kinematics.
_DRIVER_KEYS = frozenset(
    {
        "angular_a_coef", "angular_b_coef", "angular_c_coef", "angular_max_scale", "angular_min_scale",
        "comm_type", "control_mode", "device_port", "diagnostics_frequency", "estop_reset_topic",
        "estop_state", "estop_trigger_topic", "gear_ratio", "motor_control_d_gain", "motor_control_i_gain",
        "motor_control_p_gain", "odom_child_frame_id", "odometry_frequency", "robot_info_request_topic",
        "robot_info_topic", "robot_status_frequency", "robot_status_topic", "speed_topic", "trim_topic",
    }
)  # fmt: skip


def _rover_robotics_kind(values: Values) -> str:
    kind: str = values.get("drivetrain", "differential")
    return kind


def _rover_robotics(values: Values) -> Rover:
    track, base, radius = values["wheel_base"], values["robot_length"], values["wheel_radius"]
    if _rover_robotics_kind(values) == "mecanum":
        return Rover.mecanum(base / 2, track / 2, radius)
    if "2wd" in values.get("robot_type", ""):
        return Rover.differential(track, radius)
    return Rover.differential(track, radius, wheels_per_side=2, wheelbase=base)


def _with_top_speeds(section: Section, values: Values) -> Values:
    keys = {"speed": "linear_top_speed", "yaw_rate": "angular_top_speed"}
    said = {limit: values[key] for limit, key in keys.items() if key in values}
    frame = (
        {"base_frame_id": section.data["odom_child_frame_id"]}
        if "odom_child_frame_id" in section.data
        else {}
    )
    return frame | values | {"limits": said | values.get("limits", {})}


ROVERS = (
    Form(
        "open_source_rover",
        "six_wheel",
        OpenSourceRover,
        _open_source_rover,
        stated_joints,
        telling=frozenset(f"rover_dimensions.{key}" for key in _DIMENSIONS[:4]),
        stand_in={f"rover_dimensions.{key}": 1.0 for key in _DIMENSIONS},
        check=_say_osr,
        complete=_with_osr_joints,
        ignored=frozenset({"drive_no_load_rpm", "enable_odometry"}),
    ),
    Form(
        "ackermann_drive_controller",
        "six_wheel",
        Curio,
        _curio,
        _curio_joints,
        telling=frozenset(
            {"mid_wheel_lat_separation", "front_wheel_lon_separation", "back_wheel_lon_separation"}
        ),
        stand_in=dict.fromkeys(
            (
                "wheel_radius",
                "mid_wheel_lat_separation",
                "front_wheel_lat_separation",
                "front_wheel_lon_separation",
                "back_wheel_lat_separation",
                "back_wheel_lon_separation",
            ),
            1.0,
        ),
        check=check_limits,
        complete=with_limits,
        controller="ackermann_drive_controller/AckermannDriveController",
        ros1=True,
        ignored=frozenset(
            {
                "estimate_velocity_from_position",
                "allow_multiple_cmd_vel_publishers",
                "publish_wheel_joint_controller_state",
                "publish_cmd",
            }
        ),
    ),
    Form(
        "leo_firmware",
        "differential",
        Leo,
        _leo,
        stated_joints,
        telling=frozenset({"controller.wheel_separation", "controller.wheel_base", "mecanum_wheels"}),
        stand_in={"controller.wheel_radius": 1.0, "controller.wheel_separation": 1.0},
        check=_check_leo,
        complete=_with_leo_joints,
        kind_of=lambda values: "mecanum" if values.get("mecanum_wheels") else "differential",
        ros1=True,
        ignored=frozenset({"battery_min_voltage", "wheels"}),
    ),
    Form(
        "turtlebot3_node",
        "differential",
        TurtleBot3,
        _turtlebot3,
        stated_joints,
        telling=frozenset({"wheels.separation"}),
        stand_in={"wheels.separation": 1.0, "wheels.radius": 1.0},
        complete=_with_turtlebot3_joints,
        ignored=frozenset({"opencr", "motors", "sensors", "enable_stamped_cmd_vel", "odometry", "namespace"}),
    ),
    Form(
        "roverrobotics_driver",
        "differential",
        RoverRobotics,
        _rover_robotics,
        stated_joints,
        telling=frozenset({"robot_length", "drivetrain"}),
        stand_in={"wheel_radius": 1.0, "wheel_base": 1.0, "robot_length": 1.0},
        check=check_limits,
        complete=_with_top_speeds,
        kind_of=_rover_robotics_kind,
        ignored=_DRIVER_KEYS,
    ),
)
