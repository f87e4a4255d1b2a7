"""The parameters of the controllers of ros2_controllers that describe a vehicle, in the spelling of every
distribution since Humble. What is made of them is in `_controllers`.
"""

from typing import Annotated, Any, TypeAlias

from pydantic import AfterValidator, Strict

from six_wheel._core import Wheel
from six_wheel.robot_description.parameters.schema import (
    Common,
    Factor,
    Finite,
    Flag,
    Length,
    Name,
    Number,
    SteeringLimit,
    Values,
    optional,
    required,
)

__all__ = [
    "ALIGNING",
    "COMMAND_TIMEOUTS",
    "DRIVES",
    "FRONT_RADIUS",
    "FRONT_TRACK",
    "LIMITS",
    "RADIUS",
    "SLOWING",
    "STEERING_RANGE",
    "STEERS",
    "TIMEOUTS",
    "TRACK",
    "WELL_KNOWN",
    "AckermannSteering",
    "BicycleSteering",
    "DiffDrive",
    "Mecanum",
    "MecanumInOrder",
    "Omni",
    "SteeringDrive",
    "TricycleDrive",
    "TricycleSteering",
    "given",
    "is_set",
]

# Parameters of these controllers, their manager and ROS 2 nodes that do not concern kinematics.
_WELL_KNOWN = """
    allow_multiple_cmd_vel_publishers angular async_parameters cmd_timeout cmd_vel_timeout cmd_vel_topic
    command_interface command_interfaces command_joint_names diagnostic_updater diagonal_covariance
    enable_odom_tf fallback_controllers front_left_wheel_state_joint_name
    front_right_wheel_state_joint_name front_wheels_state_names in_chained_mode interface_name is_async
    linear node_options_args odom_only_twist odom_topic odometry_topic open_loop params_file
    pose_covariance_diagonal position_feedback preserve_turning_radius publish_ackermann_command
    publish_cmd publish_limited_velocity publish_odom publish_odom_tf publish_rate publish_tf
    publish_wheel_data qos_overrides rear_left_wheel_state_joint_name rear_right_wheel_state_joint_name
    rear_wheels_state_names reduce_wheel_speed_until_steering_reached reference_limit_max
    reference_limit_min reference_names reference_timeout start_type_description_service state_interface
    state_interfaces state_joint_names state_publish_rate steering_interface_name
    steering_joints_state_names steering_min_speed_scale steering_track_error_exponent tf_frame_prefix
    tf_frame_prefix_enable thread_priority traction_interface_name traction_joints_state_names
    twist_covariance_diagonal twist_input type update_rate use_sim_time use_stamped_vel use_twist_input
    velocity_rolling_window_size
"""
WELL_KNOWN = frozenset(_WELL_KNOWN.split())

# Their limits that are limits here; any other limit is reported as not read.
LIMITS = {
    "linear.x.max_velocity": "speed",
    "linear.x.max_acceleration": "acceleration",
    "linear.x.max_deceleration": "deceleration",
    "linear.x.max_jerk": "jerk",
    "angular.z.max_velocity": "yaw_rate",
    "angular.z.max_acceleration": "angular_acceleration",
    "angular.z.max_deceleration": "angular_deceleration",
    "angular.z.max_jerk": "angular_jerk",
    "traction.max_velocity": "wheel_speed",
    "traction.max_acceleration": "wheel_acceleration",
    "steering.max_velocity": "steering_rate",
    "steering.max_acceleration": "steering_acceleration",
}
# Until Jazzy the deceleration was the smallest acceleration.
SLOWING = {"linear.x.min_acceleration": "deceleration", "angular.z.min_acceleration": "angular_deceleration"}
TIMEOUTS = ("cmd_vel_timeout", "cmd_timeout", "reference_timeout")
COMMAND_TIMEOUTS = frozenset({"cmd_vel_timeout", "cmd_timeout"})
"""Those of which 0 means never; a reference with 0 counts for one cycle."""
ALIGNING = "reduce_wheel_speed_until_steering_reached"
STEERING_RANGE = ("steering.min_position", "steering.max_position")


def given(values: Values, *keys: str) -> Any:
    """The value of the first of these keys that is set: 0, NaN and [] are what ROS 2 declares for none."""
    return next((values[key] for key in keys if key in values and is_set(values[key])), None)


def is_set(value: Any) -> bool:
    """True if a value is neither 0, empty, false nor NaN, the defaults in a dump of the parameters."""
    return bool(value) and value == value


def _length_or_unset(value: float) -> float:
    if is_set(value):
        Wheel("wheel", 0.0, 0.0, radius=value)
    return value


def _count(least: int, most: int) -> AfterValidator:
    def check(joints: list[str]) -> list[str]:
        if not least <= len(joints) <= most:
            many = f"{least}" if least == most else f"{least} to {most}"
            raise ValueError(f"joints must name {many} joints, got {len(joints)}")
        return joints

    return AfterValidator(check)


LengthOrUnset: TypeAlias = Annotated[Number, AfterValidator(_length_or_unset)]
JointNames: TypeAlias = Annotated[list[Name], _count(1, 32)]
_WHEELBASE = "the distance from rear to front axle, in metres"
_FACTOR = "a factor, positive"
_SIGNED = "a factor; a negative one reverses the joints of that side"


class DiffDrive(Common):
    max_velocity: Number = optional("a speed in m/s", "linear.x.max_velocity")
    max_acceleration: Number = optional("an acceleration in m/s^2", "linear.x.max_acceleration")
    min_acceleration: Number = optional("an acceleration in m/s^2", "linear.x.min_acceleration")
    max_deceleration: Number = optional("an acceleration in m/s^2", "linear.x.max_deceleration")
    max_jerk: Number = optional("a jerk in m/s^3", "linear.x.max_jerk")
    yaw_rate: Number = optional("a rate of turn in rad/s", "angular.z.max_velocity")
    yaw_acceleration: Number = optional("an angular acceleration in rad/s^2", "angular.z.max_acceleration")
    least_yaw_acceleration: Number = optional(
        "an angular acceleration in rad/s^2", "angular.z.min_acceleration"
    )
    yaw_deceleration: Number = optional("an angular acceleration in rad/s^2", "angular.z.max_deceleration")
    yaw_jerk: Number = optional("an angular jerk in rad/s^3", "angular.z.max_jerk")
    left_wheel_names: JointNames = required("a list of the joints on the left, front to rear")
    right_wheel_names: JointNames = required("a list of the joints on the right, front to rear")
    wheel_separation: Length = required("the distance from left to right wheels, in metres")
    wheel_radius: Length = required("the wheels' radius, in metres")
    wheel_separation_multiplier: Length = optional(_FACTOR)
    left_wheel_radius_multiplier: Factor = optional(_SIGNED)
    right_wheel_radius_multiplier: Factor = optional(_SIGNED)
    wheels_per_side: Annotated[int, Strict()] = optional("the number of wheels on each side")
    wheelbase: Length = optional("the distance from the last to the first axle, in metres")


class MecanumGeometry(Common):
    wheels_radius: Length = required("the wheels' radius, in metres", "kinematics.wheels_radius")
    projection: Length = required(
        "the sum of the distances from the middle to an axle and to a side, in metres",
        "kinematics.sum_of_robot_center_projection_on_X_Y_axis",
    )
    offset_x: Finite = optional(
        "how far forward of the middle of the wheels the base frame is, in metres",
        "kinematics.base_frame_offset.x",
    )
    offset_y: Finite = optional(
        "how far to the left of the middle of the wheels the base frame is, in metres",
        "kinematics.base_frame_offset.y",
    )
    offset_theta: Finite = optional(
        "the base frame's direction, in radians", "kinematics.base_frame_offset.theta"
    )
    half_wheelbase: Length = optional("the distance from the middle to each axle, in metres")
    wheel_separation_multiplier: Length = optional(_FACTOR)
    wheel_radius_multiplier: Factor = optional("a factor; a negative one reverses the joints")


class Mecanum(MecanumGeometry):
    front_left: Name = required("the joint of the front left wheel", "front_left_wheel_command_joint_name")
    front_right: Name = required("the joint of the front right wheel", "front_right_wheel_command_joint_name")
    rear_right: Name = required("the joint of the rear right wheel", "rear_right_wheel_command_joint_name")
    rear_left: Name = required("the joint of the rear left wheel", "rear_left_wheel_command_joint_name")


class MecanumInOrder(MecanumGeometry):
    command_joint_names: Annotated[list[Name], _count(4, 4)] = required(
        "a list of the joints: front left, rear left, rear right, front right"
    )


class Omni(Common):
    wheel_names: Annotated[list[Name], _count(3, 64)] = required(
        "a list of the wheels' joints, counter-clockwise from the first"
    )
    wheel_offset: Finite = required("the direction from the middle to the first wheel, in radians")
    robot_radius: Length = required("the distance from the middle to each wheel, in metres")
    wheel_radius: Length = required("the wheels' radius, in metres")


class TricycleDrive(Common):
    traction_joint_name: Name = required("the joint that drives the front wheel")
    steering_joint_name: Name = required("the joint that steers the front wheel")
    wheelbase: Length = required(_WHEELBASE)
    wheel_radius: Length = required("the front wheel's radius, in metres")
    track_width: Length = optional("the distance from left to right rear wheel, in metres")
    steering_limit: SteeringLimit = optional("an angle or [lower, upper], in radians")
    min_position: Number = optional("an angle in radians", STEERING_RANGE[0])
    max_position: Number = optional("an angle in radians", STEERING_RANGE[1])
    wheel_speed: Number = optional("a rate of turn in rad/s", "traction.max_velocity")
    wheel_acceleration: Number = optional("an angular acceleration in rad/s^2", "traction.max_acceleration")
    steering_rate: Number = optional("a rate of turn in rad/s", "steering.max_velocity")
    steering_acceleration: Number = optional(
        "an angular acceleration in rad/s^2", "steering.max_acceleration"
    )


class SteeringDrive(Common):
    traction_joints_names: list[Name] = optional("a list of the joints that drive, right before left")
    steering_joints_names: list[Name] = optional("a list of the joints that steer, right before left")
    rear_wheels_names: list[Name] = optional("the older name of traction_joints_names")
    front_wheels_names: list[Name] = optional("the older name of steering_joints_names")
    front_steering: Flag = optional("whether the front axle steers")
    wheelbase: Length = required(_WHEELBASE)
    steering_limit: SteeringLimit = optional("an angle or [lower, upper], in radians")


class BicycleSteering(SteeringDrive):
    traction_wheel_radius: LengthOrUnset = optional("the rear wheel's radius, in metres")
    rear_wheel_radius: LengthOrUnset = optional("the older name of traction_wheel_radius")
    front_wheel_radius: LengthOrUnset = optional("the front wheel's radius, in metres")


class _TwoTrack(SteeringDrive):
    traction_track_width: LengthOrUnset = optional("the distance from left to right rear wheel, in metres")
    traction_wheels_radius: LengthOrUnset = optional("the rear wheels' radius, in metres")
    rear_wheels_radius: LengthOrUnset = optional("the older name of traction_wheels_radius")
    front_wheels_radius: LengthOrUnset = optional("the front wheels' radius, in metres")
    steering_wheels_radius: LengthOrUnset = optional("another name of front_wheels_radius")


class TricycleSteering(_TwoTrack):
    wheel_track: LengthOrUnset = optional("the older name of traction_track_width")


class AckermannSteering(_TwoTrack):
    rear_wheel_track: LengthOrUnset = optional("the older name of traction_track_width")
    steering_track_width: LengthOrUnset = optional("the distance from left to right front wheel, in metres")
    front_wheel_track: LengthOrUnset = optional("the older name of steering_track_width")


# Names that changed between distributions, the newer one first.
DRIVES = ("traction_joints_names", "rear_wheels_names")
STEERS = ("steering_joints_names", "front_wheels_names")
TRACK = ("traction_track_width", "rear_wheel_track", "wheel_track")
FRONT_TRACK = ("steering_track_width", "front_wheel_track")
RADIUS = ("traction_wheels_radius", "rear_wheels_radius", "traction_wheel_radius", "rear_wheel_radius")
FRONT_RADIUS = ("steering_wheels_radius", "front_wheels_radius", "front_wheel_radius")
