"""The parameters of the nodes: what the parameter file says, limits and options, declared with ranges.

Names are those of the file and of ros2_controllers. A number that is not given is 0, as in their dumps,
and has its default.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from six_wheel._core import Noise
from six_wheel.control_loop import OPTIONS, Option, Settings
from six_wheel.control_loop.settings import NAMES, rover_keys
from six_wheel.kinematics.rover_edit import limits_given
from six_wheel.robot_description.parameters.detect_format import NO_LIMIT
from six_wheel.robot_description.parameters.file import Parameters
from six_wheel.robot_description.parameters.foreign.limits import is_number
from six_wheel.robot_description.parameters.key_types import GROUPS
from six_wheel.robot_description.parameters.ros_node_parameters import closest

LARGEST = NO_LIMIT
NONE = 0.0  # value of a parameter that is not given
TIMEOUT, REFERENCE = "cmd_vel_timeout", "reference_timeout"
UNUSED = ("pose_covariance_diagonal", "twist_covariance_diagonal")
# Types of parameters in words: ROS takes no whole number for one with a decimal point.
_KINDS = {
    bool: "true or false",
    float: "a number with a decimal point",
    int: "a whole number",
    list: "a list of the type in the file or by default",
    str: "text",
}
COMPUTED = "covariances are computed from the noise and the readings"
OTHERS = (
    "qos_overrides.",
    "use_sim_time",
    "start_type_description_service",
)  # parameters that rclpy declares

SHARED = ("tf_frame_prefix", "rover", "robot_description", "autostart", "record")
NODE = (
    Option("use_stamped_vel", True, "cmd_vel is geometry_msgs/TwistStamped; false: geometry_msgs/Twist"),
    Option(
        "command_interface",
        "joint_state",
        "joint commands: joint_state (sensor_msgs/JointState), group (std_msgs/Float64MultiArray for "
        "steering and for wheels) or trajectory (trajectory_msgs/JointTrajectory for steering, a group "
        "for wheels)",
        choices=("joint_state", "group", "trajectory"),
    ),
    Option("enable_odom_tf", True, "publish the transform from odom_frame_id to base_frame_id"),
    Option("tf_frame_prefix", "", "before both frames, with a slash between; ~: the namespace of the node"),
    Option("publish_limited_velocity", False, "publish the motion that the limits leave on cmd_vel_out"),
    Option("rover", "", "parameter file, URDF or preset, where no ROVER is given as an argument"),
    Option("robot_description", "", "URDF as text, where no rover is given; else the topic of that name"),
    Option("autostart", True, "configure and activate at once, without a lifecycle manager"),
    Option("record", "", "an .mcap file for a record from which the run can be replayed; must not exist"),
)
FILTER = (
    NODE[0],
    Option(
        "feedback",
        "OPEN_LOOP",
        "where the motion starts from: OPEN_LOOP, at rest; CLOSED_LOOP, the first odom",
        choices=("OPEN_LOOP", "CLOSED_LOOP"),
    ),
    *(option for option in NODE if option.name in SHARED),
)


class Declared:
    """The parameters of a node, and what a change of them means.

    The settings are as the file has them, `own` are options of the node itself.
    """

    def __init__(self, node: Any, settings: Settings, own: Sequence[Option]) -> None:
        from rclpy.parameter import Parameter

        self._node, self._parameter = node, Parameter
        self.live: set[str] = set()
        self.own: dict[str, Any] = {}
        changes: dict[str, Any] = {}
        options = settings.options.values()
        for option in OPTIONS:
            value = self._option(option, options[option.name])
            if value != options[option.name]:
                changes[option.name] = value
        for option in own:
            given = option.check(settings.node_options.get(option.name, option.default))
            self.own[option.name] = option.check(self._option(option, given))
        changes |= self._groups(settings)
        self._unused(settings)
        changes |= self._keys(settings)
        changes |= self._frames(settings.parameters)
        self.settings = settings.changed(changes) if changes else settings
        self._name_unknown()

    def changes(self, parameters: Sequence[Any]) -> dict[str, Any]:
        """Convert a request to set parameters into the changes that `Settings.changed` takes. Raises
        `ValueError` if one of them cannot be changed while the node runs."""
        changes: dict[str, Any] = {}
        for parameter in parameters:
            name = parameter.name
            if name in self.own or (name in NAMES and name not in self.live):
                raise ValueError(f"{name} can only be set when the node starts")
            if name in self.live:
                changes |= _meant(name, parameter.value)
        return changes

    def _option(self, option: Option, value: Any) -> Any:
        descriptor = self._descriptor(option.description, not option.live)
        if option.choices:
            descriptor.additional_constraints = "one of " + ", ".join(option.choices)
        if option.min_value is not None and option.max_value is not None:
            _range(descriptor, option.min_value, option.max_value)
        if option.live:
            self.live.add(option.name)
        return self._declare(option.name, value, descriptor)

    def _groups(self, settings: Settings) -> dict[str, Any]:
        """Limits, timeout and noise: numbers that can be changed while it runs."""
        changes: dict[str, Any] = {}
        said = settings.parameters
        timeout = said.control.get("timeout", 0.5)
        given = {TIMEOUT: NONE if timeout is None else timeout}
        limits = dict.fromkeys(GROUPS["limits"].model_fields, NONE) | limits_given(said.limits)
        given |= {f"limits.{name}": min(value, LARGEST) for name, value in limits.items()}
        noise = Noise(**said.noise)
        given |= {f"noise.{name}": getattr(noise, name) for name in GROUPS["noise"].model_fields}
        for name, value in given.items():
            group, _, key = name.partition(".")
            what = "age at which a command is too old, in s"
            if key:
                what = str(GROUPS[group].model_fields[key].description)
            none = {"noise": "", "limits": f"; 0: its default, {LARGEST:g}: none"}.get(group, "; 0: none")
            descriptor = self._descriptor(f"{what}{none}", read_only=False)
            _range(descriptor, 0.0, LARGEST)
            self.live.add(name)
            other = self._reference_timeout(settings) if name == TIMEOUT else NONE
            now = self._declare(name, float(other or value), descriptor)
            if now != value:
                changes |= _meant(name, now)
        return changes | self._following(settings)

    def _reference_timeout(self, settings: Settings) -> float:
        """The timeout by the name that steering controllers have for it; 0 where nobody gives it by that."""
        descriptor = self._descriptor(
            f"another name of {TIMEOUT}, which comes first; 0: that one alone", True
        )
        _range(descriptor, 0.0, LARGEST)
        given = settings.node_options.get(REFERENCE)
        value: float = self._declare(REFERENCE, float(given) if is_number(given) else NONE, descriptor)
        overrides = self._node._parameter_overrides
        return value if REFERENCE in overrides and TIMEOUT not in overrides else NONE

    def _following(self, settings: Settings) -> dict[str, Any]:
        """The rule for a joint that does not follow: to be set when the node starts."""
        changes: dict[str, Any] = {}
        error, time = (settings.controller_option(f"following_{what}") for what in ("error", "time"))
        for name, value, none in (("error", error or NONE, "; 0: never halt for it"), ("time", time, "")):
            key = f"following_{name}"
            descriptor = self._descriptor(f"{GROUPS['control'].model_fields[key].description}{none}", True)
            _range(descriptor, 0.0, LARGEST)
            now = self._declare(f"control.{key}", float(value), descriptor)
            if now != value:
                changes[f"control.{key}"] = now or "never"
        return changes

    def _keys(self, settings: Settings) -> dict[str, Any]:
        """The other keys of the file: to be set when the node starts, by the names that the team has."""
        changes: dict[str, Any] = {}
        for name, value in rover_keys(settings).items():
            if self._node.has_parameter(name):
                continue  # as one of the node's own, which counts
            descriptor = self._descriptor("of the parameter file", read_only=True)
            now = self._declare(name, value, descriptor)
            if now != value and list(now if isinstance(now, Sequence) else [now]) != value:
                changes[name] = now
        return changes

    def _unused(self, settings: Settings) -> None:
        """Parameters of ros2_controllers that are accepted; a value for one is warned of."""
        for name in UNUSED:
            given = settings.node_options.get(name, [NONE] * 6)
            if not (isinstance(given, list) and all(map(is_number, given))):
                raise ValueError(f"{name} must be a list of numbers, got {given}")
            descriptor = self._descriptor(f"not used: {COMPUTED}", True)
            if any(self._declare(name, [float(each) for each in given], descriptor)):
                self._node.get_logger().warning(f"{name} is not used: {COMPUTED}")

    def _frames(self, said: Parameters) -> dict[str, Any]:
        """The frames, with the prefix before both."""
        prefix = self.own["tf_frame_prefix"]
        prefix = (self._node.get_namespace() if prefix.startswith("~") else prefix).strip("/")
        changes: dict[str, Any] = {}
        for name, what in (("odom_frame_id", "odometry"), ("base_frame_id", "the rover")):
            given = getattr(said, name)
            frame = self._declare(name, given, self._descriptor(f"frame of {what}", True))
            frame = f"{prefix}/{frame}" if prefix else frame
            if frame != given:
                changes[name] = frame
        return changes

    def _name_unknown(self) -> None:
        """Warn of values for parameters that there are none of, as a slip in a name makes them."""
        known = [name for name in self._node._parameters if not name.startswith(OTHERS)]
        for name in self._node._parameter_overrides:
            if not (self._node.has_parameter(name) or name.startswith(OTHERS)):
                guess = closest(name, known, likeness=0.6)
                hint = f"; did you mean {guess}?" if guess else ""
                self._node.get_logger().warning(f"unknown parameter {name} is ignored{hint}")

    def _declare(self, name: str, value: Any, descriptor: Any) -> Any:
        """The value of a parameter: the one given for it, or else this."""
        from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException

        if self._node.has_parameter(name):
            return self._node.get_parameter(name).value
        try:
            return self._node.declare_parameter(name, value, descriptor).value
        except InvalidParameterTypeException:
            got, kind = self._node._parameter_overrides[name].value, _KINDS[type(value)]
            raise ValueError(f"{name} must be {kind}, got {got}") from None
        except InvalidParameterValueException:
            (allowed,) = descriptor.floating_point_range
            least, most = allowed.from_value, allowed.to_value
            got = self._node._parameter_overrides[name].value
            raise ValueError(f"{name} must lie between {least:g} and {most:g}, got {got:g}") from None

    def _descriptor(self, description: str, read_only: bool) -> Any:
        from rcl_interfaces.msg import ParameterDescriptor

        return ParameterDescriptor(description=description, read_only=read_only)


def _range(descriptor: Any, least: float, most: float) -> None:
    from rcl_interfaces.msg import FloatingPointRange

    descriptor.floating_point_range = [FloatingPointRange(from_value=least, to_value=most, step=0.0)]


def _meant(name: str, value: Any) -> Mapping[str, Any]:
    """A parameter of ROS as a key of the file; 0 takes a limit away, so that it has its default."""
    if name == TIMEOUT:
        return {"control.timeout": value or LARGEST}
    if name.startswith("limits."):
        return {name: math.inf if value >= LARGEST else value or None}
    return {name: value}
