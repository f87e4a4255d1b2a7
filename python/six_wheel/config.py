"""Rovers from ROS 2 parameter files, with every mistake reported at once.

Two forms are read. That of ROS 2, as its controllers take it::

    rover_controller:                # or /**:
      ros__parameters:
        traction_joints: [front_left_wheel_joint, ...]     # six, in any order
        steering_joints: [front_left_steering_joint, ...]  # four, in any order
        d1: 0.4                                            # d1 .. d4, wheel_radius: see `Rover.six_wheel`
        ...
        steering_limit: 1.2                                # optional, as are limits and the frames

and the same keys at the top level, where the joints may be left out (they are then called
``<wheel>_wheel_joint`` and ``<wheel>_steering_joint``). In both, ``preset: perseverance`` may replace the
dimensions. A joint whose name does not tell its wheel is stated, either beside the list, which stays as the
controller needs it::

    wheel_of_joint: {motor_3: middle_left}

or in its place: ``traction_joints: {front_left: motor_1, ...}``.
"""

import math
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NoReturn, TypeAlias

from six_wheel import _yaml
from six_wheel._core import Rover
from six_wheel._joints import joints_of, wheel_said_by
from six_wheel._nodes import PARAMETERS, Section, closest, section
from six_wheel._schema import DIMENSIONS, KEYS, TELLING, check_keys, check_values

__all__ = ["Finding", "ParameterFileError", "Parameters", "dump", "load", "read_parameters"]

# A parameter file has a few kilobytes. What is larger is a log or a mesh, and would take PyYAML long.
MAX_BYTES = 1 << 18

Severity: TypeAlias = Literal["error", "warning"]
_SIX = Rover.six_wheel(d1=1.0, d2=1.0, d3=1.0, d4=1.0, wheel_radius=1.0)


@dataclass(frozen=True)
class Finding:
    """One thing to put right in a parameter file; ``str()`` is one line such as a compiler prints."""

    line: int | None
    key: str
    message: str
    remedy: str | None = None
    severity: Severity = "error"
    path: str = ""

    def __str__(self) -> str:
        place = self.path if self.line is None else f"{self.path}:{self.line}"
        warning = "warning: " if self.severity == "warning" else ""
        remedy = f" ({self.remedy})" if self.remedy else ""
        return " ".join(f"{place}: {warning}{self.message}{remedy}".splitlines())


class ParameterFileError(ValueError):
    """A parameter file that does not describe a rover; ``str()`` has one line for each finding."""

    def __init__(self, findings: Iterable[Finding]) -> None:
        self.findings: tuple[Finding, ...] = tuple(findings)
        super().__init__(self.findings)

    def __str__(self) -> str:
        return "\n".join(map(str, self.findings))


@dataclass(frozen=True)
class Parameters:
    """What a parameter file says.

    Attributes
    ----------
    path : Path
        The file.
    node : str or None
        The node whose parameters were read, as the file writes it; None in a file without nodes.
    rover : Rover
        The rover, its joints in the file's order.
    odom_frame_id, base_frame_id : str
        Names of the odometry frame and of the rover's frame.
    limits : dict of str to float
        Of ``speed`` [m/s], ``acceleration`` [m/s^2], ``jerk`` [m/s^3], ``wheel_speed`` [rad/s] and
        ``steering_rate`` [rad/s] those the file gives.
    warnings : tuple of Finding
        What may be a mistake, but does not keep the file from being read.
    """

    path: Path
    node: str | None
    rover: Rover
    odom_frame_id: str = "odom"
    base_frame_id: str = "base_link"
    limits: dict[str, float] = field(default_factory=dict)
    warnings: tuple[Finding, ...] = ()


def load(path: str | os.PathLike[str], *, node: str | None = None) -> Rover:
    """The rover that a parameter file describes.

    Parameters
    ----------
    path : path-like
        A ROS 2 parameter file, or this package's own keys without node and ``ros__parameters``.
    node : str, optional
        Which node's parameters to read, for a file that describes several rovers.

    Returns
    -------
    Rover
        Its ``traction_joints`` and ``steering_joints`` are in the file's order.

    Raises
    ------
    ParameterFileError
        With every mistake of the file, its line, the rule and a remedy. A `ValueError`.
    """
    return read_parameters(path, node=node).rover


def read_parameters(path: str | os.PathLike[str], *, node: str | None = None) -> Parameters:
    """Everything a parameter file says: the rover, frames, limits, and warnings.

    Parameters, errors: see `load`.
    """
    path = Path(path)
    log = _Log(str(path))
    return _read(path, _text(path, log), node, log)


def dump(
    rover: Rover, *, node: str | None = None, odom_frame_id: str = "odom", base_frame_id: str = "base_link"
) -> str:
    """The text of a parameter file from which `load` returns an equal rover.

    Parameters
    ----------
    rover : Rover
        Of the layout of `Rover.six_wheel`.
    node : str, optional
        Node name, for the form of ROS 2; None for this package's plain form.
    odom_frame_id, base_frame_id : str
        Names of the frames.

    Raises
    ------
    ValueError
        If the keys of a parameter file cannot say what this rover is.
    """
    wheels = {wheel.name: wheel for wheel in rover.wheels}
    if rover.wheel_names != _SIX.wheel_names:
        raise ValueError(f"rover must have the wheels {', '.join(_SIX.wheel_names)}, got {', '.join(wheels)}")
    front, middle, rear = (wheels[name] for name in ("front_left", "middle_left", "rear_left"))
    stated = {
        joint: wheel
        for joints in (rover.traction_joints, rover.steering_joints)
        for joint, wheel in joints.items()
        if wheel_said_by(joint, wheels) != wheel
    }
    values: dict[str, Any] = {
        "traction_joints": list(rover.traction_joints),
        "steering_joints": list(rover.steering_joints),
        "wheel_of_joint": stated,
        "d1": front.y,
        "d2": -rear.x,
        "d3": front.x,
        "d4": middle.y,
        "wheel_radius": front.radius,
        "steering_limit": list(front.steering_range or ()),
        "odom_frame_id": odom_frame_id,
        "base_frame_id": base_frame_id,
    }
    values = {key: value for key, value in values.items() if value not in ({}, [])}
    if front.steering_range == _SIX.wheels[0].steering_range:
        del values["steering_limit"]
    text = _yaml.write(values if node is None else {node: {PARAMETERS: values}})
    # The keys say less than a rover can be (casters, a wheel out of line): what comes back decides.
    try:
        same = _read(Path("rover"), text, node, _Log("rover")).rover == rover
    except ParameterFileError:
        same = False
    if not same:
        raise ValueError(f"rover must have the layout of Rover.six_wheel, got {rover}")
    return text


class _Log:
    """Collects findings about one file."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.findings: list[Finding] = []

    def error(self, line: int | None, at: _yaml.Path, message: str, remedy: str | None) -> None:
        self._add(line, at, message, remedy, "error")

    def warning(self, line: int | None, at: _yaml.Path, message: str, remedy: str | None) -> None:
        self._add(line, at, message, remedy, "warning")

    def fail(self, line: int | None, message: str, remedy: str) -> NoReturn:
        """Report what leaves nothing more to read."""
        self.error(line, (), message, remedy)
        raise self.failure()

    def failure(self) -> ParameterFileError:
        return ParameterFileError(self.in_order())

    def in_order(self) -> tuple[Finding, ...]:
        return tuple(sorted(self.findings, key=lambda finding: finding.line or 0))

    @property
    def has_errors(self) -> bool:
        return any(finding.severity == "error" for finding in self.findings)

    def _add(
        self, line: int | None, at: _yaml.Path, message: str, remedy: str | None, severity: Severity
    ) -> None:
        if PARAMETERS in at[:-1]:
            at = at[at.index(PARAMETERS) + 1 :]
        self.findings.append(Finding(line, _yaml.spell(at), message, remedy, severity, self.path))


def _read(path: Path, text: str, node: str | None, log: _Log) -> Parameters:
    found = section(_tree(text, log), node, KEYS, TELLING, log.error)
    if found is None:
        raise log.failure()
    check_keys(found, log.error, log.warning)
    values = check_values(found, log.error)
    rover = _rover(found, values, log)
    if rover is None or log.has_errors:
        raise log.failure()
    named = {key: values[key] for key in ("odom_frame_id", "base_frame_id", "limits") if key in values}
    return Parameters(path, found.node, rover, **named, warnings=log.in_order())


def _text(path: Path, log: _Log) -> str:
    remedy = "give the path of a parameter file"
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        log.fail(None, f"the file cannot be read: {error.strerror or error}", remedy)
    except ValueError as error:  # a path with a null character
        log.fail(None, f"the path cannot be used: {error}", remedy)
    if len(content) > MAX_BYTES:
        log.fail(None, f"the file is larger than {MAX_BYTES} bytes", remedy)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        log.fail(
            line, f"not UTF-8 text: the byte 0x{content[error.start]:02x}", "save the file as UTF-8 text"
        )


def _tree(text: str, log: _Log) -> _yaml.Tree:
    try:
        tree = _yaml.parse(text, log.error)
    except _yaml.YamlSyntaxError as error:
        log.fail(error.line, error.message, error.remedy)
    if tree.data is None:
        log.fail(None, "the file is empty", f"give it the keys {', '.join(DIMENSIONS)}, or a preset")
    if not isinstance(tree.data, dict):
        what = "a list" if isinstance(tree.data, list) else "a single value"
        log.fail(1, f"the file must be a mapping, got {what}", "write lines such as `d1: 0.4`")
    return tree


def _rover(section: Section, values: dict[str, Any], log: _Log) -> Rover | None:
    """The rover, if nothing is wrong; joints are checked even if the rest is."""
    layout = _layout(section, values, log)
    if layout is None and "preset" in section.data:
        return None  # whose wheels are not known
    joints = _joints(section, values, layout or _SIX, log)
    if layout is None or log.has_errors:
        return None
    try:
        return Rover(layout.wheels, **joints)
    except ValueError as error:
        log.fail(section.line, str(error), "see the keys it names")


def _layout(section: Section, values: dict[str, Any], log: _Log) -> Rover | None:
    """Wheels without the file's joints; None, with the reason reported, if the file does not say enough."""
    at = ("steering_limit",)
    limit = values.get("steering_limit")
    limit = tuple(limit) if isinstance(limit, list) else limit
    largest = max(map(abs, limit)) if isinstance(limit, tuple) else limit or 0.0
    if largest > math.pi:
        degrees = f"{largest:g} degrees are {math.radians(largest):.4g} radians"
        log.warning(section.line_of(at), at, f"steering_limit is beyond half a turn, got {limit}", degrees)
    preset = values.get("preset")
    needed = {"preset"} if "preset" in section.data else set(DIMENSIONS)
    if not needed <= values.keys():
        return None
    try:
        if preset is None:
            return Rover.six_wheel(**{key: values[key] for key in DIMENSIONS}, steering_limit=limit)
        rover = Rover.preset(preset)
        if limit is not None and not rover.steered_names:
            message = f"steering_limit is given, but no wheel of the preset {preset} steers"
            log.error(section.line_of(at), at, message, "remove steering_limit")
        if "kind" in values and rover.steered_names != _SIX.steered_names:
            message = f"kind six_wheel does not fit the preset {preset}"
            log.error(section.line_of(("kind",)), ("kind",), message, "leave out kind")
        return rover if limit is None else Rover.preset(preset, steering_limit=limit)
    except ValueError as error:
        log.error(section.line_of(at), at, str(error), "see the keys it names")
        return None


def _joints(section: Section, values: dict[str, Any], layout: Rover, log: _Log) -> dict[str, dict[str, str]]:
    """Joint to wheel for each of the two lists."""
    lists = {"traction_joints": layout.wheel_names, "steering_joints": layout.steered_names}
    stated: dict[str, str] = values.get("wheel_of_joint", {})
    joints: dict[str, dict[str, str]] = {}
    line_of: dict[str, int | None] = {}
    for key, wheels in lists.items():
        if key not in values:
            if key not in section.data:
                joints[key] = getattr(layout, key)
            continue
        given = values[key]
        elsewhere = tuple(wheel for wheel in layout.wheel_names if wheel not in wheels)
        joints[key] = joints_of(section, key, given, stated, wheels, elsewhere, log.error)
        places = given.items() if isinstance(given, dict) else enumerate(given)
        lines = {joint: section.line_of((key, place)) for place, joint in places}
        for joint in [joint for joint in lines if joint in line_of]:
            first = f"in traction_joints on line {line_of[joint]} and in {key}"
            message = f"{_yaml.one_line(joint)} is named both {first}"
            log.error(lines[joint], (key,), message, "a joint drives or steers; name the other one")
        line_of |= lines
    for joint in stated if lists.keys() <= values.keys() else ():
        if joint not in line_of:
            at, guess = ("wheel_of_joint", joint), closest(joint, line_of)
            message = f"wheel_of_joint names {_yaml.one_line(joint)}, which is in neither list of joints"
            log.error(section.line_of(at), at, message, f"did you mean {guess}?" if guess else "remove it")
    return joints
