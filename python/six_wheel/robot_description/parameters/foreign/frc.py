"""Swerve drives of the FIRST Robotics Competition: PathPlanner's settings.json, and YAGSL's JSON files.

YAGSL has a file for the drive, one for each module beside it, and lengths in inches.
"""

import json
from pathlib import Path
from typing import Any

from six_wheel._core import Rover
from six_wheel.robot_description.joint_names import said_by
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Place, Report, Tree
from six_wheel.robot_description.parameters.schema import (
    Common,
    Finite,
    Flag,
    Form,
    Length,
    Values,
    optional,
    required,
)

__all__ = ["FRC", "gather_modules"]

INCH = 0.0254  # [m]
MODULES = {"fl": "front_left", "fr": "front_right", "bl": "rear_left", "br": "rear_right"}
MAX_BYTES = 1 << 18


class PathPlanner(Common):
    holonomicMode: Flag = optional("whether it is a swerve drive")  # noqa: N815 - the file's own names
    robotTrackwidth: Length = optional("the distance from left to right wheels, in metres")  # noqa: N815
    driveWheelRadius: Length = required("the wheels' radius, in metres")  # noqa: N815
    maxDriveSpeed: Length = optional("the largest speed of a wheel's rim, in m/s")  # noqa: N815
    flModuleX: Finite = optional("x of the front left module, in metres")  # noqa: N815
    flModuleY: Finite = optional("y of the front left module, in metres")  # noqa: N815
    frModuleX: Finite = optional("x of the front right module, in metres")  # noqa: N815
    frModuleY: Finite = optional("y of the front right module, in metres")  # noqa: N815
    blModuleX: Finite = optional("x of the rear left module, in metres")  # noqa: N815
    blModuleY: Finite = optional("y of the rear left module, in metres")  # noqa: N815
    brModuleX: Finite = optional("x of the rear right module, in metres")  # noqa: N815
    brModuleY: Finite = optional("y of the rear right module, in metres")  # noqa: N815


_PLACES = tuple(f"{module}Module{axis}" for module in MODULES for axis in "XY")
_SETTINGS = """
    robotWidth robotLength pathFolders autoFolders defaultMaxVel defaultMaxAccel defaultMaxAngVel
    defaultMaxAngAccel defaultNominalVoltage robotMass robotMOI driveGearing driveMotorType driveCurrentLimit
    wheelCOF bumperOffsetX bumperOffsetY robotFeatures maxModuleSpeed swerveModules choreoAutos
"""


def _pathplanner(values: Values) -> Rover:
    radius = values["driveWheelRadius"]
    if values.get("holonomicMode") is False:
        return Rover.differential(values["robotTrackwidth"], radius)
    places = [(values[f"{module}ModuleX"], values[f"{module}ModuleY"]) for module in MODULES]
    return Rover.swerve(places, radius, names=list(MODULES.values()))


def _check_pathplanner(section: Section, values: Values, error: Report, warning: Report) -> None:
    wanted = ("robotTrackwidth",) if values.get("holonomicMode") is False else _PLACES
    missing = [key for key in wanted if key not in section.data]
    if missing:
        message = f"{missing[0]} is missing, and with it where the wheels are"
        error(section.line, (missing[0],), message, "PathPlanner 2025 and later writes it")


def _with_wheel_speed(section: Section, values: Values) -> Values:
    if "maxDriveSpeed" not in values or "driveWheelRadius" not in values:
        return values
    limits = {"wheel_speed": values["maxDriveSpeed"] / values["driveWheelRadius"]}
    return values | {"limits": limits | values.get("limits", {})}


def _no_joints(values: Values, rover: Rover) -> list[JointList]:
    return []


class Yagsl(Common):
    places: dict[str, tuple[float, float]] = required("the module files, a list", "modules")
    diameter: Length = required(
        "the wheels' diameter in inches, in modules/physicalproperties.json",
        "conversionFactors.drive.diameter",
    )


def _yagsl(values: Values) -> Rover:
    modules: dict[str, tuple[float, float]] = values["modules"]
    places = [(front * INCH, left * INCH) for front, left in modules.values()]
    return Rover.swerve(places, values["conversionFactors.drive.diameter"] * INCH / 2, names=list(modules))


FRC = (
    Form(
        "PathPlanner's settings",
        "swerve",
        PathPlanner,
        _pathplanner,
        _no_joints,
        telling=frozenset({*_PLACES, "holonomicMode", "driveWheelRadius"}),
        stand_in={"driveWheelRadius": 1.0, "robotTrackwidth": 1.0}
        | {key: float(index) for index, key in enumerate(_PLACES)},
        check=_check_pathplanner,
        complete=_with_wheel_speed,
        ignored=frozenset(_SETTINGS.split()),
    ),
    Form(
        "YAGSL's swervedrive",
        "swerve",
        Yagsl,
        _yagsl,
        _no_joints,
        telling=frozenset({"modules"}),
        stand_in={"conversionFactors.drive.diameter": 4.0},
        ignored=frozenset({"$schema", "imu", "invertedIMU", "maxSpeed", "optimalVoltage"}),
    ),
)


def gather_modules(tree: Tree, path: Path, report: Report) -> Tree:
    """The drive of a YAGSL file with what stands in the files beside it; any other tree as it is.

    A file of one module is reported: where the others are it does not say.
    """
    data = tree.data
    if _is_module(data):
        place = tree.places.get(("location",), Place(1, ""))
        message = "this is one module of a YAGSL swerve drive, and where the others are it does not say"
        report(place.line, ("location",), message, "give its swervedrive.json")
        return tree
    named = data.get("modules") if isinstance(data, dict) else None
    if not (isinstance(named, list) and named and all(str(name).endswith(".json") for name in named)):
        return tree
    line = tree.places[("modules",)].line
    modules: dict[str, tuple[float, float]] = {}
    for index, name in enumerate(map(str, named)):
        file = path.parent / "modules" / name
        module = _json(file)
        if not _is_module(module):
            lacks = "has no location with front and left, or x and y"
            what = "is not beside this file" if module is None else lacks
            message = f"modules/{name} {what}"
            at = ("modules", index)
            place = tree.places.get(at, Place(line, ""))
            report(place.line, at, message, "give swervedrive.json in the folder it belongs to")
            return tree
        axle, side = said_by(Path(name).stem) or (None, None)
        called = f"{axle}_{side}" if axle and side else Path(name).stem
        modules[called] = _place_of(module)
    properties = _json(path.parent / "modules" / "physicalproperties.json")
    known = _number_in(properties, "conversionFactors", "drive", "diameter")
    known = _number_in(properties, "wheelDiameter") if known is None else known
    gathered = {key: value for key, value in data.items() if key != "modules"} | {"modules": modules}
    if known is not None:
        gathered["conversionFactors.drive.diameter"] = known
    return Tree(gathered, tree.places)


def _is_module(data: Any) -> bool:
    location = data.get("location") if isinstance(data, dict) else None
    return isinstance(location, dict) and any(
        all(isinstance(location.get(key), int | float) for key in keys) for keys in _LOCATIONS
    )


# The older files say x and y for it, x forward and y to the left as everywhere at FIRST.
_LOCATIONS = (("front", "left"), ("x", "y"))


def _place_of(module: dict[str, Any]) -> tuple[float, float]:
    """Place of a module, forward and to the left [inches]."""
    location = module["location"]
    ahead, aside = next(keys for keys in _LOCATIONS if keys[0] in location)
    return float(location[ahead]), float(location[aside])


def _number_in(data: Any, *keys: str) -> float | None:
    for key in keys:
        data = data.get(key) if isinstance(data, dict) else None
    return float(data) if isinstance(data, int | float) else None


def _json(path: Path) -> Any:
    """The content of a file beside another; None if there is none that can be read."""
    try:
        if path.stat().st_size > MAX_BYTES:
            return None
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
