"""A rover out of a robot description, with a record of what was derived from where."""

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from six_wheel._core import Limits, RockerBogie, Rover, Wheel, unit_questions, without_questions
from six_wheel.kinematics.errors import as_path
from six_wheel.kinematics.keywords import checked
from six_wheel.robot_description.diagnostics import Finding
from six_wheel.robot_description.missing_files import near_file
from six_wheel.robot_description.urdf.elements import Notes
from six_wheel.robot_description.urdf.macros import expanded, has_macros
from six_wheel.robot_description.urdf.suspension import Suspension, find_suspension
from six_wheel.robot_description.urdf.tree import MAX_BYTES, Tree, read_tree
from six_wheel.robot_description.urdf.wheel_geometry import FoundWheel
from six_wheel.robot_description.urdf.wheels import find_wheels, names_of


@dataclass(frozen=True)
class Robot:
    """Drive of a robot as its description gives it.

    Attributes
    ----------
    path : Path
    name : str
        The robot's.
    base_frame_id : str
        The root link: the rover's frame.
    rover : Rover
        With the joints' own names, and the suspension if there is one.
    wheels : dict of str to FoundWheel
        By the rover's names, in its order.
    suspension : Suspension or None
    limits : Limits
        Rates that the file gives to the wheels and the steering.
    up : float
        -1 if the file is z down.
    warnings : tuple of Finding
        Lines on what is ambiguous, or had to be decided.
    tree : Tree or None
        All links and joints.
    """

    path: Path
    name: str
    base_frame_id: str
    rover: Rover
    wheels: dict[str, FoundWheel]
    suspension: Suspension | None = None
    limits: Limits = field(default_factory=Limits)
    up: float = 1.0
    warnings: tuple[Finding, ...] = ()
    tree: Tree | None = field(default=None, repr=False)


@checked()
def read_urdf(
    path: str | os.PathLike[str],
    *,
    wheel_radius: float | None = None,
    arguments: Mapping[str, str] | None = None,
) -> Robot:
    """Read the vehicle out of a URDF, or a xacro file.

    Parameters
    ----------
    path : path-like
    wheel_radius : float, optional
        Hub to ground [m], in place of what the file says.
    arguments : mapping of str to str, optional
        For a xacro file.

    Returns
    -------
    Robot

    Raises
    ------
    ParameterFileError
        If it is no robot with wheels: one line with the reason and a remedy. A `ValueError`.
    ModuleNotFoundError
        If what expands xacro files is not installed.
    """
    path = as_path("path", path)
    notes = Notes(path)
    return parse_urdf(_text(path, arguments, notes), path, notes, wheel_radius)


def parse_urdf(
    text: str, path: Path = Path("robot.urdf"), notes: Notes | None = None, wheel_radius: float | None = None
) -> Robot:
    """The same from the text of a URDF, which messages call `path`."""
    notes = Notes(path) if notes is None else notes
    if wheel_radius is not None:
        Wheel("wheel", 0.0, 0.0, radius=wheel_radius)  # the core's own rule
    tree = read_tree(path, text, notes)
    found = find_wheels(tree, notes, wheel_radius)
    wheels = _in_rows(dict(zip(names_of(found, notes), found, strict=True)))
    suspension = find_suspension(tree, wheels, notes)
    try:
        rover, limits = without_questions(lambda: _rover(wheels, suspension)), _limits(wheels)
    except ValueError as error:  # the core's own rules, of lengths and rates that no robot has
        notes.fail(str(error), "correct the joints and wheels of the description")
    for _, says, likely in unit_questions(rover):
        notes.warn(says, likely)
    _say_of_slip(wheels, notes)
    warnings = tuple(sorted(notes.warnings, key=lambda finding: finding.line or 0))
    return Robot(path, tree.name, tree.root, rover, wheels, suspension, limits, tree.up, warnings, tree)


def _text(path: Path, arguments: Mapping[str, str] | None, notes: Notes) -> str:
    try:
        if path.stat().st_size > MAX_BYTES:
            notes.fail(f"the file is larger than {MAX_BYTES} bytes", "give the path of a robot description")
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        notes.fail(
            f"the file cannot be read: {error.strerror or error}",
            f"give the path of a robot description{near_file(path)}",
        )
    except ValueError as error:  # bytes that are no text, a path with a null character
        notes.fail(f"the file is no text: {error}", "save it as UTF-8 text")
    return expanded(path, arguments, notes) if has_macros(path, text) else text


def _in_rows(wheels: dict[str, FoundWheel]) -> dict[str, FoundWheel]:
    """Front to rear and left before right where the names are places, however the axles are staggered."""
    if all(wheel.noted_name is not None for wheel in wheels.values()):
        return wheels
    axles = ("front_", "middle_", "rear_", "")
    order = [f"{axle}{side}" for axle in axles for side in ("left", "right")]
    placed = [name for name in order if name in wheels]
    return {name: wheels[name] for name in [*placed, *(name for name in wheels if name not in placed)]}


def _rover(wheels: Mapping[str, FoundWheel], suspension: Suspension | None) -> Rover:
    made, traction, steering, backwards = [], {}, {}, []
    for name, found in wheels.items():
        steered = found.steering is not None and not found.castor
        x, y = (float(value) for value in found.pivot)
        made.append(
            Wheel(
                name, x, y, radius=found.radius, steered=steered, heading=found.heading,
                steering_limit=found.steering_limit if steered else None,
                scrub=found.scrub, trail=found.trail, roller_angle=found.roller_angle,
                driven=found.driven, castor=found.castor,
            )
        )  # fmt: skip
        if found.driven:
            traction[found.joint.name] = name
            backwards += [found.joint.name] if found.reversed else []
        if found.steering is not None and steered:
            steering[found.steering.name] = name
            backwards += [found.steering.name] if found.steering_reversed else []
    arm: RockerBogie | None = None if suspension is None else suspension.model
    return Rover(
        made, traction_joints=traction, steering_joints=steering, reversed_joints=backwards, suspension=arm
    )


def _limits(wheels: Mapping[str, FoundWheel]) -> Limits:
    """The least of the rates that the joints have."""
    speeds = [found.joint.velocity for found in wheels.values() if found.driven]
    rates = [found.steering.velocity for found in wheels.values() if found.steering and not found.castor]
    given = {"wheel_speed": speeds, "steering_rate": rates}
    known = {key: [value for value in values if value is not None] for key, values in given.items()}
    return Limits(**{key: min(values) for key, values in known.items() if values})


def _say_of_slip(wheels: Mapping[str, FoundWheel], notes: Notes) -> None:
    """Fixed wheels on several axles slip when they turn, which no description tells."""
    fixed = [found for found in wheels.values() if found.steering is None and found.roller_angle is None]
    along = [
        found.centre[0] * math.cos(found.heading) + found.centre[1] * math.sin(found.heading)
        for found in fixed
    ]
    steers = any(found.steering is not None for found in wheels.values())
    if not steers and len(fixed) > 2 and max(along) - min(along) > 0.1 * max(found.radius for found in fixed):
        message = f"{len(fixed)} wheels on several axles do not steer, and slip when they turn"
        remedy = "their effective track is not in a URDF; six-wheel calibrate finds it from a log"
        notes.warn(message, remedy)
