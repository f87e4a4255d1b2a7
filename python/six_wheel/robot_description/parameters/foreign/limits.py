"""Limits and timeouts of controllers, as far as they are limits and ways here too."""

import math
from typing import Any, TypeGuard

from six_wheel.robot_description.parameters.key_types import Values
from six_wheel.robot_description.parameters.ros_node_parameters import GROUPS, Section
from six_wheel.robot_description.parameters.ros_yaml import Report
from six_wheel.robot_description.parameters.schema import shown

# Limits of controllers that are limits here; any other limit is reported as not read.
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


def with_limits(section: Section, values: Values, second: float = 1.0) -> Values:
    """With the limits and the ways of a controller that are such here too."""
    data = section.data
    limits = {
        name: abs(values[key])
        for key, name in (SLOWING | LIMITS).items()
        if key in values and _in_force(data, key) and _has_its_sign(key, values[key])
    }
    control = with_timeout(data, second)
    if isinstance(data.get(ALIGNING), bool):
        control["align"] = "cosine" if data[ALIGNING] else "none"
    both = {"limits": limits, "control": control}
    return values | {key: read | values.get(key, {}) for key, read in both.items() if read}


def with_timeout(data: Values, second: float = 1.0) -> Values:
    """The age at which a command is too old, as the key `timeout` of `control`, if the data has it."""
    control: Values = {}
    for key in TIMEOUTS:
        if is_number(data.get(key)) and 0 < data[key] < math.inf:
            control["timeout"] = data[key] / second
        elif key in COMMAND_TIMEOUTS and is_number(data.get(key)) and data[key] == 0:
            control["timeout"] = "never"
    return control


def own_timeout(section: Section, error: Report) -> Values:
    """The same for a file with this package's keys beside those of ROS; an error if it can be none."""
    for key in TIMEOUTS:
        value = section.data.get(key, 0.0)
        if not is_number(value) or not 0 <= value < math.inf:
            section.report(error, (key,), f"{key} must be a time in seconds, got {shown(value)}", "0: never")
            return {}
    return with_timeout(section.data)


def _has_its_sign(key: str, value: float) -> bool:
    """Decelerations are negative for ROS 2, in older files positive ones are found as well."""
    return value < 0 if key in SLOWING else value > 0 or key.endswith("deceleration")


def is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _in_force(data: Values, key: str) -> bool:
    """True if a parameter is a limit in force: 0, NaN and infinity are no limits, and some have a switch."""
    value = data[key]
    stem, _, what = key.rpartition(".")
    quantity = what.partition("_")[2].removesuffix("_reverse").replace("deceleration", "acceleration")
    return (
        is_number(value)
        and math.isfinite(value)
        and value != 0
        and data.get(f"{stem}.has_{quantity}_limits") is not False
    )


def check_limits(section: Section, values: Values, error: Report, warning: Report) -> None:
    data = section.data

    def number(key: str) -> float:
        value = data.get(key)
        return value if is_number(value) else math.nan

    def is_read(key: str) -> bool:
        forwards = key.removesuffix("_reverse")
        same = forwards != key and abs(number(key)) == abs(number(forwards))
        mirrored = ".min_" in key and number(key) == -number(key.replace(".min_", ".max_"))
        limit = key in (LIMITS | SLOWING) and _has_its_sign(key, data[key])
        return key in STEERING_RANGE or same or mirrored or limit

    limits = [
        key for key in data if key.partition(".")[0] in GROUPS - {"kinematics"} and _in_force(data, key)
    ]
    for group in GROUPS:
        unread = [key for key in limits if key.startswith(f"{group}.") and not is_read(key)]
        if unread:
            message = f"{', '.join(unread)} {'is' if len(unread) == 1 else 'are'} not read"
            remedy = "limits here are positive and hold both ways: see the key limits"
            section.report(warning, (unread[0],), message, remedy)
