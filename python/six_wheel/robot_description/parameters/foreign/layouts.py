"""Layouts of vehicles that are more than a constructor's arguments, and checks of their keys together.

What is required and missing has been reported, and a number stands in for it.
"""

import math

from six_wheel._core import Rover, Wheel
from six_wheel.robot_description.parameters.key_types import Values
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report

INCH = 0.0254  # [m]
_SUM = "kinematics.sum_of_robot_center_projection_on_X_Y_axis"
_OFFSET = tuple(f"kinematics.base_frame_offset.{part}" for part in ("x", "y", "theta"))


def mecanum(values: Values) -> Rover:
    total = values[_SUM] * values.get("wheel_separation_multiplier", 1.0)
    ahead = values.get("half_wheelbase", total / 2)
    radius = values["kinematics.wheels_radius"] * abs(values.get("wheel_radius_multiplier", 1.0))
    at_middle = Rover.mecanum(2 * ahead, 2 * (total - ahead), radius)
    x, y, theta = (values.get(key, 0.0) for key in _OFFSET)
    if x == y == theta == 0.0:
        return at_middle
    # The offset is the base frame as seen from the middle of the wheels; twists are those of the base frame.
    cos, sin = math.cos(theta), math.sin(theta)
    return Rover(
        [
            wheel.replace(
                x=cos * (wheel.x - x) + sin * (wheel.y - y),
                y=cos * (wheel.y - y) - sin * (wheel.x - x),
                heading=-theta,
            )
            for wheel in at_middle.wheels
        ]
    )


def check_half_wheelbase(section: Section, values: Values, error: Report, warning: Report) -> None:
    if _SUM not in values:
        return
    if "half_wheelbase" not in section.data:
        message = (
            "the file does not say where the wheels are, only a sum of lengths; they are put on a square"
        )
        remedy = (
            "add half_wheelbase, the distance from the middle to each axle; wheel speeds do not depend on it"
        )
        section.report(warning, (_SUM,), message, remedy)
    elif values.get("half_wheelbase", 0.0) >= values[_SUM]:
        at = ("half_wheelbase",)
        message = f"half_wheelbase must be smaller than {_SUM}, got {values['half_wheelbase']}"
        section.report(error, at, message, "the rest of that sum is the distance to each side")


def check_wheels_per_side(section: Section, values: Values, error: Report, warning: Report) -> None:
    count, per_side = len(values.get("left_wheel_names", ())), values.get("wheels_per_side", 0)
    if count and per_side not in (0, count):
        at = ("wheels_per_side",)
        message = f"wheels_per_side is {per_side}, and left_wheel_names names {count} joints"
        section.report(warning, at, message, "the names count; leave out wheels_per_side")


def omni(values: Values) -> Rover:
    count, radius = len(values["wheel_names"]), values["robot_radius"]
    angles = [values["wheel_offset"] + 2 * math.pi / count * index for index in range(count)]
    positions = [(radius * math.cos(angle), radius * math.sin(angle)) for angle in angles]
    # A positive speed drives a wheel clockwise around the middle.
    return Rover.omni(positions, [angle - math.pi / 2 for angle in angles], values["wheel_radius"])


def curio(values: Values) -> Rover:
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


def check_places_of_modules(section: Section, values: Values, error: Report, warning: Report) -> None:
    places = tuple(f"{module}Module{axis}" for module in ("fl", "fr", "bl", "br") for axis in "XY")
    wanted = ("robotTrackwidth",) if values.get("holonomicMode") is False else places
    missing = [key for key in wanted if key not in section.data]
    if missing:
        message = f"{missing[0]} is missing, and with it where the wheels are"
        error(section.line, (missing[0],), message, "PathPlanner 2025 and later writes it")


def yagsl(values: Values) -> Rover:
    modules: dict[str, tuple[float, float]] = values["modules"]
    places = [(front * INCH, left * INCH) for front, left in modules.values()]
    return Rover.swerve(places, values["conversionFactors.drive.diameter"] * INCH / 2, names=list(modules))
