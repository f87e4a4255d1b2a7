"""Rovers from ROS 2 parameter files, with every mistake reported at once.

Three forms are read. That of a node with this package's own keys::

    rover_controller:                # or /**:
      ros__parameters:
        traction_joints: [front_left_wheel_joint, ...]     # six, in any order
        steering_joints: [front_left_steering_joint, ...]  # four, in any order
        d1: 0.4                                            # d1 .. d4, wheel_radius: see `Rover.six_wheel`
        ...
        steering_limit: 1.2                                # optional, as are limits and the frames

the same keys at the top level; and the parameters of the controllers of ros2_controllers that drive a
vehicle (diff_drive_controller, ackermann_steering_controller, ...), as they stand. ``kind: swerve`` and so on
takes the arguments of `Rover.swerve`; without it the keys are those of `Rover.six_wheel`, or ``preset:
perseverance`` for a known rover. Joints that are left out are called ``<wheel>_wheel_joint`` and
``<wheel>_steering_joint``. A joint whose name does not tell its wheel is stated, either beside the list,
which stays as the controller needs it::

    wheel_of_joint: {motor_3: middle_left}

or in its place: ``traction_joints: {front_left: motor_1, ...}``. Every key is in
``docs/reference/parameter_keys.md``.
"""

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from six_wheel._core import Controller, Gyroscope, Limits, Rover, without_questions
from six_wheel.kinematics.errors import as_path, printable
from six_wheel.kinematics.keywords import checked, did_you_mean
from six_wheel.robot_description.diagnostics import Finding
from six_wheel.robot_description.diagnostics import ParameterFileError as ParameterFileError  # of the room
from six_wheel.robot_description.gyroscope_errors import ARGUMENTS
from six_wheel.robot_description.missing_files import near_file
from six_wheel.robot_description.parameters import ros_yaml
from six_wheel.robot_description.parameters.detect_format import check_keys, form_of, section_of
from six_wheel.robot_description.parameters.foreign.limits import own_timeout
from six_wheel.robot_description.parameters.foreign.read_tables import FOREIGN
from six_wheel.robot_description.parameters.foreign.yagsl import gather_modules
from six_wheel.robot_description.parameters.joints import JointList, check_wheels, wheels_of_joints
from six_wheel.robot_description.parameters.key_types import GROUPS, NONE_WORDS, Values
from six_wheel.robot_description.parameters.ros_node_parameters import (
    FileFindings,
    Section,
    closest,
    declares,
)
from six_wheel.robot_description.parameters.schema import PLAIN, Form, check_values
from six_wheel.robot_description.parameters.units import question_settings, question_units

# A parameter file has a few kilobytes. What is larger is a log or a mesh, and would take PyYAML long.
MAX_BYTES = 1 << 18


@dataclass(frozen=True)
class Parameters:
    """Contents of a parameter file.

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
    limits : Limits
        Those the file gives; there are no others.
    control : dict of str to object
        Of the keywords of `Controller` those the file gives.
    noise, wheel_encoders, steering_encoders, odometry : dict
        Keys about dead reckoning: arguments of `Noise`; those of `Encoder` and more, for
        the readings of wheels and steering joints; options of `Odometry`.
    columns, topics, stamp_unit, plausibility
        Meaning of headers and topics of logs, the unit of times, and if odd readings are refused.
    gyroscope : dict
        Arguments of `Gyroscope`, and how its readings are to be taken: `period`, `scale`, `roll`, `pitch`,
        `time_offset`, `topic`.
    truth, calibration : dict
        Place in the body of the point that a truth follows (`x`, `y`, `yaw`) and its `time_offset`; names of
        the `parameters` that were calibrated and their `covariance`.
    warnings : tuple of Finding
        Possible mistakes, and keys that are not part of the model; the file is read all the same.
    kind : str
        The kind of vehicle, ``preset`` for a known rover.
    controller : str or None
        The controller or robot whose parameter names the file has, such as ``diff_drive_controller``.
    kind_given : str or None
        Kind that the reader was told.
    """

    path: Path
    node: str | None
    rover: Rover
    odom_frame_id: str = "odom"
    base_frame_id: str = "base_link"
    limits: Limits = field(default_factory=Limits)
    control: dict[str, Any] = field(default_factory=dict)
    noise: dict[str, float] = field(default_factory=dict)
    wheel_encoders: Values = field(default_factory=dict)
    steering_encoders: Values = field(default_factory=dict)
    columns: dict[str, str] | list[str] = field(default_factory=dict)
    topics: dict[str, str] | list[str] = field(default_factory=dict)
    stamp_unit: str | None = None
    plausibility: bool = True
    odometry: Values = field(default_factory=dict)
    gyroscope: Values = field(default_factory=dict)
    truth: Values = field(default_factory=dict)
    calibration: Values = field(default_factory=dict)
    warnings: tuple[Finding, ...] = ()
    kind: str = "six_wheel"
    controller: str | None = None
    kind_given: str | None = None

    @property
    def dimensions(self) -> Any:
        """Covariance of the dimensions, as `Odometry` takes it; None if the file has none."""
        known = self.calibration
        if not known.get("covariance"):
            return None
        from six_wheel.robot_description.dimensions import deviations

        return deviations(self.rover, known["parameters"], known["covariance"])

    @property
    def known_gyroscope(self) -> Gyroscope | None:
        """Error model of the gyroscope, as `Odometry` takes it; None if the file has none."""
        given = {name: self.gyroscope[name] for name in ARGUMENTS if name in self.gyroscope}
        return Gyroscope(**given) if given else None

    def build_controller(self, **changes: Any) -> Controller:
        """A `Controller` of the rover within the limits, in the ways the file says; `changes` go first."""
        return Controller(self.rover, self.limits, **self.control | changes)


def load(path: str | os.PathLike[str], *, node: str | None = None, kind: str | None = None) -> Rover:
    """The rover that a parameter file describes.

    Parameters
    ----------
    path : path-like
        A ROS 2 parameter file, or this package's own keys without node and ``ros__parameters``.
    node : str, optional
        Node whose parameters to read, for a file that describes several rovers.
    kind : str, optional
        The kind or the controller whose keys the file has, where it does not say by itself.

    Returns
    -------
    Rover
        Its `commands` come in the file's order.

    Raises
    ------
    ParameterFileError
        With every mistake of the file, its line, the rule and a remedy. A `ValueError`.
    """
    return read_parameters(path, node=node, kind=kind).rover


@checked()
def read_parameters(
    path: str | os.PathLike[str], *, node: str | None = None, kind: str | None = None
) -> Parameters:
    """Everything a parameter file says: the rover, frames, limits, and warnings.

    Parameters, errors: see `load`.
    """
    log = FileFindings(printable(str(path)))
    try:
        path = as_path("path", path)
    except ValueError as error:
        if not isinstance(path, str) or not path:
            raise
        log.fail(None, str(error), "give the path of a parameter file, .yaml or .json")
    return _read(path, _text(path, log), node, kind, log)


@checked()
def parse_parameters(
    text: str, *, node: str | None = None, kind: str | None = None, path: Path = Path("rover")
) -> Parameters:
    """The same from the text of a parameter file, which messages call `path`."""
    return _read(path, text, node, kind, FileFindings(str(path)))


def _read(path: Path, text: str, node: str | None, kind: str | None, log: FileFindings) -> Parameters:
    tree = _tree(text, path, log)
    before = len(log.findings)
    found = section_of(tree, node, log.error)
    if found is not None:
        nesting = len(log.findings)
        form = form_of(found, log.error, log.warning, kind)
        if form is None:
            del log.findings[before:nesting]  # of what is no rover's
    if found is None or form is None:
        raise log.failure(warnings=False)  # there is nothing that they would be about
    check_keys(found, form, log.error, log.warning)
    values = check_values(found, form, log.error)
    form.check(found, values, log.error, log.warning)
    values = form.complete(found, values)
    if form not in FOREIGN and (timeout := own_timeout(found, log.error)):
        values["control"] = timeout | values.get("control", {})
    rover = without_questions(lambda: _rover(found, form, values, log))  # they become findings
    if rover is not None:
        check_wheels(found, values, rover, log.error)
        _check_covariance(found, values, rover, log)
    question_settings(found, values, log.warning)
    if rover is None or log.has_errors:
        raise log.failure()
    named: Values = {key: values[key] for key in (*PLAIN, *GROUPS) if key in values}
    for key, word in NONE_WORDS.items():
        if named.get("control", {}).get(key) == word:
            named["control"] = named["control"] | {key: None}
    controller = form.name if form in FOREIGN else None
    of_kind = form.kind if form.kind_of is None else form.kind_of(values)
    try:
        named["limits"] = without_questions(lambda: Limits(**values.get("limits", {})))
        parameters = Parameters(
            path, found.node, rover, **named, warnings=log.in_order(), kind=of_kind, controller=controller,
            kind_given=kind,
        )  # fmt: skip
        if {"limits", "control"} & found.data.keys():
            parameters.build_controller()
    except ValueError as error:
        _refuse(found, error, log)
    return parameters


def _refuse(section: Section, error: ValueError, log: FileFindings) -> NoReturn:
    """Limits or ways of a controller that fit neither each other nor the rover."""
    key = getattr(error, "argument", "")
    at = ("limits" if key in GROUPS["limits"].model_fields else "control", key)
    section.report(log.error, at, f"{at[0]}.{error}", "change one of the two")
    raise log.failure() from None


def _text(path: Path, log: FileFindings) -> str:
    near = [] if path.suffix else [*Rover.presets()]
    hint = did_you_mean(path.name, near) or near_file(path)
    remedy = f"give the path of a parameter file, .yaml or .json, or the name of a preset{hint}"
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        log.fail(None, f"the file cannot be read: {error.strerror or error}", remedy)
    if len(content) > MAX_BYTES:
        log.fail(None, f"the file is larger than {MAX_BYTES} bytes", remedy)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        log.fail(
            line, f"not UTF-8 text: the byte 0x{content[error.start]:02x}", "save the file as UTF-8 text"
        )


def _tree(text: str, path: Path, log: FileFindings) -> ros_yaml.Tree:
    try:
        tree = ros_yaml.parse(text, log.error, log.warning)
    except ros_yaml.YamlSyntaxError as error:
        log.fail(error.line, error.message, error.remedy)
    if tree.data is None:
        remedy = "give it the keys d1, d2, d3, d4 and wheel_radius, a kind and its keys, or a preset"
        log.fail(None, "the file is empty", remedy)
    if not isinstance(tree.data, dict):
        what = "a list" if isinstance(tree.data, list) else "a single value"
        log.fail(1, f"the file must be a mapping, got {what}", "write lines such as `d1: 0.4`")
    if declared := declares(tree.data):
        message = f"the file declares parameters ({declared}) for generate_parameter_library, without values"
        log.fail(1, message, "give the file that a robot's values are in")
    before = len(log.findings)
    gathered = gather_modules(tree, path, log.error)
    if len(log.findings) > before:
        raise log.failure()  # other findings would be nothing but consequences
    return gathered


def _rover(section: Section, form: Form, values: Values, log: FileFindings) -> Rover | None:
    """The rover, if nothing is wrong; joints are checked even if the rest is."""
    layout = _layout(section, form, values, log)
    if layout is None:
        return None  # its wheels are not known
    question_units(section, layout, form.needed - section.data.keys(), log.warning)
    joints = _joints(section, form, values, layout, log)
    if log.has_errors:
        return None
    backwards = values.get("reversed_joints", ())
    try:
        return Rover(
            layout.wheels,
            traction_joints=joints.get("traction_joints"),
            steering_joints=joints.get("steering_joints"),
            reversed_joints=list(backwards),
            suspension=layout.suspension,
        )
    except ValueError as error:
        log.fail(section.line_of((getattr(error, "argument", ""),)), str(error), "see the keys it names")


def _layout(section: Section, form: Form, values: Values, log: FileFindings) -> Rover | None:
    """Wheels without the file's joints; None, with the reason reported, if the file does not say enough."""
    if not form.needed <= form.stand_in.keys() | values.keys():
        return None
    try:
        return form.layout(form.stand_in | values if log.has_errors else values)
    except ValueError as error:
        if form.needed <= values.keys():
            at = tuple(key for key in (getattr(error, "argument", ""),) if key in section.data)
            if not (log.has_error_at(*at) if at else log.has_errors):
                line = section.line_of(at) if at else section.line
                log.error(line, at, str(error), "see the keys it names")
        return None


def _joints(
    section: Section, form: Form, values: Values, layout: Rover, log: FileFindings
) -> dict[str, dict[str, str]]:
    """Joint to wheel for those that drive and those that steer, in the file's order."""
    stated: dict[str, str] = values.get("wheel_of_joint", {})
    joints: dict[str, dict[str, str]] = {}
    lists = form.joint_lists(values, layout)
    key_of: dict[str, tuple[str, int | None]] = {}
    named: set[str] = set()
    for here in sorted(
        lists, key=lambda here: list(section.data).index(here.key) if here.key in section.data else 0
    ):
        if here.key not in values:
            continue
        given = values[here.key]
        given = [given] if isinstance(given, str) else given
        found = wheels_of_joints(section, here, given, stated, log.error)
        joints.setdefault("steering_joints" if here.steers else "traction_joints", {}).update(found)
        _check_order(section, here, found, log)
        places = given.items() if isinstance(given, dict) else enumerate(given)
        lines = {joint: section.line_of((here.key, place)) for place, joint in places}
        for joint in [joint for joint in lines if joint in key_of and joint in found]:
            first = "in {} on line {}".format(*key_of[joint])
            message = f"{ros_yaml.one_line(joint)} is named both {first} and in {here.key}"
            log.error(lines[joint], (here.key,), message, "a joint turns one wheel, and drives or steers it")
        key_of |= {joint: (here.key, lines[joint]) for joint in found}
        named |= lines.keys()
    # With one list missing or wrong, the joints stated may be those of that list.
    whole = all(here.key in values for here in lists) or not any(here.key in section.data for here in lists)
    for joint in stated if lists and whole else ():
        if joint not in named:
            at, guess = ("wheel_of_joint", joint), closest(joint, named)
            message = f"wheel_of_joint names {ros_yaml.one_line(joint)}, which is in neither list of joints"
            section.report(log.error, at, message, f"did you mean {guess}?" if guess else "remove it")
    return joints


def _check_covariance(section: Section, values: Values, rover: Rover, log: FileFindings) -> None:
    """A covariance has a row and a column for every parameter, and these are the rover's."""
    given = values.get("calibration", {})
    names, rows = given.get("parameters", []), given.get("covariance", [])
    if rows and [len(row) for row in rows] != [len(names)] * len(names):
        at = ("calibration", "covariance")
        message = (
            f"calibration.covariance must have {len(names)} rows of as many numbers, got {len(rows)} rows"
        )
        section.report(log.error, at, message, "give one row and one column for each of the parameters")
    elif rows:
        from six_wheel.robot_description.dimensions import deviations

        try:
            deviations(rover, names, rows)
        except ValueError as error:
            section.report(log.error, at, f"calibration.{error}", "calibrate the rover again")


def _check_order(section: Section, here: JointList, found: dict[str, str], log: FileFindings) -> None:
    if here.order == "expected" and len(found) == len(here.wheels) and tuple(found.values()) != here.wheels:
        at, first = (here.key,), next(iter(found))
        taken = f"which a controller of ROS 2 takes for {here.wheels[0]}"
        message = f"{here.key} begins with {ros_yaml.one_line(first)}, {taken}"
        remedy = f"ROS 2 goes by the order {', '.join(here.wheels)}; here the names count"
        section.report(log.warning, at, message, remedy)
