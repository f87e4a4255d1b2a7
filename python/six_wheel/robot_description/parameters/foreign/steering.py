"""Cars, tricycles and bicycles of ros2_controllers: a steered axle ahead of a fixed one, or behind it.

Their keys changed names between distributions, and some of the older names say where a wheel is.
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from six_wheel._core import Rover, Wheel
from six_wheel.robot_description.joint_names import said_by
from six_wheel.robot_description.parameters.foreign.limits import STEERING_RANGE, with_limits
from six_wheel.robot_description.parameters.foreign.names import listed
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.key_types import Values, as_argument, is_set
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report
from six_wheel.robot_description.parameters.schema import shown

# Names that changed between distributions, the newer one first.
DRIVES = ("traction_joints_names", "rear_wheels_names")
STEERS = ("steering_joints_names", "front_wheels_names")
TRACK = ("traction_track_width", "rear_wheel_track", "wheel_track")
FRONT_TRACK = ("steering_track_width", "front_wheel_track")
RADIUS = ("traction_wheels_radius", "rear_wheels_radius", "traction_wheel_radius", "rear_wheel_radius")
FRONT_RADIUS = ("steering_wheels_radius", "front_wheels_radius", "front_wheel_radius")


# Layouts.


def ackermann_steering(values: Values) -> Rover:
    track = _given(values, *TRACK) or 1.0
    return _car(values, _given(values, *FRONT_TRACK) or track, track)


def tricycle_steering(values: Values) -> Rover:
    if _drives_steered(values):
        return _car(values, None, _given(values, *TRACK), driven="front")
    return _car(values, None, _given(values, *TRACK) or 1.0)


def tricycle(values: Values) -> Rover:
    return _car(values, None, values.get("track_width"), driven="front")


def bicycle_steering(values: Values) -> Rover:
    return _car(values, None, None)


def _car(
    values: Values, front_track: float | None, rear_track: float | None, *, driven: str = "rear"
) -> Rover:
    """Steered front and fixed rear wheels, one where there is no track; origin between the fixed ones."""
    radius = _given(values, *RADIUS, "wheel_radius") or 1.0
    front_radius = _given(values, *FRONT_RADIUS) if driven == "rear" else None
    limit = as_argument(values.get("steering_limit"))
    steering = {"steered": True, "steering_limit": limit, "driven": driven == "front"}
    front = _axle("front", values["wheelbase"], front_track, front_radius or radius, **steering)
    car = Rover([*front, *_axle("rear", 0.0, rear_track, radius, driven=driven == "rear")])
    return _behind(car) if _steers_behind(values) else car


def _axle(name: str, x: float, track: float | None, radius: float, **keywords: Any) -> Iterator[Wheel]:
    if track is None:
        yield Wheel(name, x, 0.0, radius=radius, **keywords)
    else:
        yield Wheel(f"{name}_left", x, track / 2, radius=radius, **keywords)
        yield Wheel(f"{name}_right", x, -track / 2, radius=radius, **keywords)


def _behind(car: Rover) -> Rover:
    """A car with its steered axle as far behind the origin as it was ahead of it, and named so."""
    other = {"front": "rear", "rear": "front"}
    wheels = []
    for wheel in sorted(car.wheels, key=lambda wheel: wheel.steered):
        axle, _, side = wheel.name.partition("_")
        wheels.append(wheel.replace(name="_".join(filter(None, (other[axle], side))), x=0.0 - wheel.x))
    return Rover(wheels)


def _steers_behind(values: Values) -> bool:
    """True if the file or the names of all joints say that the rear wheels steer."""

    def said(*keys: str) -> set[str | None]:
        return {(said_by(name) or (None, None))[0] for name in listed(_given(values, *keys))}

    driven = "rear" if _drives_steered(values) else "front"
    names = said(*STEERS, "steering_joint_name") == {"rear"}
    return values.get("front_steering") is False or (
        names and said(*DRIVES, "traction_joint_name") == {driven}
    )


def _drives_steered(values: Values) -> bool:
    """True if the vehicle is a tricycle with one driven joint, which is then that of the steered wheel."""
    if "traction_joint_name" in values:
        return True
    several = _given(values, *RADIUS[:2], *FRONT_RADIUS[:2])  # bicycles do not have it
    return several is not None and len(listed(_given(values, *DRIVES))) == 1


def _given(values: Values, *keys: str) -> Any:
    """The value of the first of these keys that is set: 0, NaN and [] are what ROS 2 declares for none."""
    known = _older(keys, values)
    return next((values[key] for key in known if key in values and is_set(values[key])), None)


def _older(keys: tuple[str, ...], values: Values) -> tuple[str, ...]:
    """The names of a key: until Jazzy some said where a wheel is, and `front_steering` which axle steers."""
    if values.get("front_steering") is not False:
        return keys
    other = {"front": "rear", "rear": "front"}
    return tuple(re.sub("^(front|rear)(?=_wheel)", lambda found: other[found[0]], key) for key in keys)


# Values that follow from the keys.


def with_axle_behind(section: Section, values: Values, second: float = 1.0) -> Values:
    """The controller steers as if the axle were ahead: behind, its joints count the other way."""
    values = with_limits(section, values, second)
    if _steers_behind(values) and "reversed_joints" not in values:
        return values | {"reversed_joints": listed(_given(values, *STEERS, "steering_joint_name"))}
    return values


def with_steering_range(section: Section, values: Values) -> Values:
    limit = _steering_range(values)
    if limit and _steers_behind(values):
        limit = (-limit[1], -limit[0])  # positions are those of the joint
    # The only one of them that counts its time-out in milliseconds.
    return with_axle_behind(section, ({"steering_limit": list(limit)} if limit else {}) | values, 1000.0)


def _steering_range(values: Values) -> tuple[float, float] | None:
    """The range between two positions; one of them alone holds to both sides."""
    lower, upper = (values.get(key, math.nan) for key in STEERING_RANGE)
    if math.isnan(lower) and math.isnan(upper):
        return None
    return (-upper if math.isnan(lower) else lower, -lower if math.isnan(upper) else upper)


# Joints.


def right_before_left(values: Values, rover: Rover) -> list[JointList]:
    """Lists that the controller reads by position."""
    driven = tuple(wheel.name for wheel in rover.wheels if wheel.driven)[::-1]
    steered = rover.steered_wheel_names[::-1]
    lists = []
    kinds = ((DRIVES, driven, "has no motor", False), (STEERS, steered, "does not steer", True))
    for keys, wheels, lack, steers in kinds:
        known = _older(keys, values)
        key = next((key for key in known if is_set(values.get(key))), known[0])
        lists.append(JointList.of(rover, key, wheels, lack=lack, order="expected", steers=steers))
    return lists


def steered_wheel(values: Values, rover: Rover) -> list[JointList]:
    steered = rover.steered_wheel_names
    return [
        JointList.of(rover, "traction_joint_name", steered, lack="has no motor"),
        JointList.of(rover, "steering_joint_name", steered, steers=True),
    ]


# Checks of several keys together, and of keys beyond the model.


def check_steering(
    form: Mapping[str, Any], descriptions: Mapping[str, str]
) -> Callable[[Section, Values, Report, Report], None]:
    """The rules of the steering controllers, whose names changed between distributions.

    `form` has the names of `radii`, `tracks` and `front_tracks`.
    """
    radii, tracks, front = (tuple(form.get(name, ())) for name in ("radii", "tracks", "front_tracks"))

    def check(section: Section, values: Values, error: Report, warning: Report) -> None:
        _say_behind(section, values, warning)
        if "steering_limit" not in section.data:
            _say_range(section, warning)
        alone = "one_joint_without_track" in form and _drives_steered(values)
        for keys, needed in (
            (DRIVES, True),
            (STEERS, True),
            (radii, True),
            (tracks, not alone),
            (front, False),
        ):
            _check_names(section, values, error, _older(keys, values), descriptions, needed=needed)

    return check


def _say_range(section: Section, warning: Report) -> None:
    message = "the file has no range of the steering: 90 degrees to both sides are assumed"
    section.report(warning, ("wheelbase",), message, "add steering_limit, in radians")


def check_tricycle(section: Section, values: Values, error: Report, warning: Report) -> None:
    _say_behind(section, values, warning)
    if "track_width" not in section.data:
        message = (
            "the file does not say how far apart the rear wheels are; one wheel between them stands for both"
        )
        remedy = "add track_width, the distance from left to right rear wheel; commands do not depend on it"
        section.report(warning, ("wheelbase",), message, remedy)
    limit = _steering_range(values)
    if limit is None and "steering_limit" not in section.data:
        _say_range(section, warning)
    if limit is not None:
        given = [key for key in STEERING_RANGE[::-1] if key in values]
        at = (next((key for key in given if is_set(values[key])), given[0]),)
        try:
            Wheel("front", 0.0, 0.0, radius=1.0, steered=True, steering_limit=limit)
        except ValueError as refused:
            message = f"steering.min_position and max_position {getattr(refused, 'problem', refused)}"
            section.report(error, at, message, "they are the ends of the steering range, in radians")


def _say_behind(section: Section, values: Values, warning: Report) -> None:
    if not _steers_behind(values):
        return
    keys = (*_older(STEERS, values), "steering_joint_name")
    key = next((key for key in keys if is_set(values.get(key))), "wheelbase")
    why = "front_steering is false" if values.get("front_steering") is False else "so say the names"
    wheels = (
        "the rear wheel drives and steers"
        if _drives_steered(values)
        else ("the front wheels drive and the rear ones steer")
    )
    remedy = "the steering joints then count clockwise, as the controller commands them"
    section.report(warning, (key,), f"{wheels}: {why}", remedy)


def _check_names(
    section: Section,
    values: Values,
    error: Report,
    keys: tuple[str, ...],
    descriptions: Mapping[str, str],
    *,
    needed: bool,
) -> None:
    """Of several names for one thing one is given, or they say the same."""
    named = [key for key in keys if is_set(section.data.get(key))]
    present = [key for key in keys if key in section.data]
    if needed and keys and not present:
        at, description = (keys[0],), descriptions[keys[0]]
        error(section.line, at, f"{keys[0]} is missing", f"add {keys[0]}, {description}")
    elif needed and present and not named and present[0] in values:
        at, description = (present[0],), descriptions[present[0]]
        message = f"{present[0]} must be set, got {shown(values[present[0]])}"
        section.report(error, at, message, f"it is {description}")
    both = [key for key in named if key in values]
    for key in both[1:]:
        if values[key] != values[both[0]]:
            message = f"{key} and {both[0]} are given, and differ"
            section.report(error, (key,), message, f"remove {key}, the older name")
