"""Wheel of each joint, from its name or its place in a list.

Teams list joints by axle (front left, front right, ...) or by side (front left, middle left, ...), and
abbreviate as they like; the names are what can be trusted. What a name does not tell is not guessed. Only
where the wheels themselves have names that tell no place (module_0, arm), or a controller defines it, does
the order of a list count, and then only if no joint in it tells its wheel.
"""

import itertools
from collections.abc import Mapping
from typing import Any, Literal, NamedTuple, Self

from six_wheel._core import Rover
from six_wheel.robot_description.joint_names import agree, said_by, wheel_said_by
from six_wheel.robot_description.parameters.ros_node_parameters import Section, closest
from six_wheel.robot_description.parameters.ros_yaml import Path, Report, one_line


class JointList(NamedTuple):
    """A key of a parameter file whose value names joints, and the wheels that need one there."""

    key: str
    wheels: tuple[str, ...]
    elsewhere: tuple[str, ...] = ()  # wheels that must have no joint in this list
    lack: str = "does not steer"  # reason against the others
    order: Literal["names", "silent", "expected", "fixed"] = "names"
    """Joints are in the order of `wheels`: "names" never; "silent" where no joint's name tells its wheel;
    "expected" the same, and a name that tells another wheel is a warning; "fixed" always."""
    steers: bool = False  # and not drive

    @classmethod
    def of(cls, rover: Rover, key: str, wheels: tuple[str, ...], **others: Any) -> Self:
        """The list of a key for some wheels of a rover; the others have no joint in it."""
        elsewhere = tuple(name for name in rover.wheel_names if name not in wheels)
        return cls(key, wheels, elsewhere, **others)


def wheels_of_joints(
    section: Section,
    here: JointList,
    given: list[str] | dict[str, str],
    stated: Mapping[str, str],
    report: Report,
) -> dict[str, str]:
    """Joint to wheel in the file's order, as far as the file is right; `report` is called for every mistake.

    The joints given are in any order, or by wheel; `stated` has the wheels of joints whose names do not tell.
    """
    key, wheels, elsewhere = here.key, here.wheels, here.elsewhere
    entries = _entries(here, given, stated)
    said = {entry.wheel for entry in entries}
    free = [wheel for wheel in wheels if wheel not in said]
    unsaid, listed = ", ".join(free), ", ".join(wheels) or "none"
    examples = itertools.cycle(free or wheels or elsewhere)
    if not said - {None} and len(entries) != len(wheels) and (here.order != "names" or len(wheels) == 1):
        remedy = f"name them in the order of the wheels {listed}"
        section.report(report, (key,), f"{key} {_count_rule(wheels)}, got {len(entries)}", remedy)
        return {}
    first_line: dict[str, int | None] = {}
    joint_of: dict[str, str] = {}
    misplaced = 0
    for path, joint, statement, wheel in entries:
        line, shown = section.line_of(path), one_line(joint)
        if joint in first_line:
            misplaced += 1
            message = f"names {shown} twice, first on line {first_line[joint]}"
            remedy = f"put the joint of {unsaid} here" if unsaid else "remove one"
        elif wheel is None and statement is not None:
            misplaced += 1
            message = f"has no wheel {one_line(statement)} for {shown}"
            guess = wheel_said_by(statement, wheels) or closest(statement, wheels)
            remedy = f"did you mean {guess}?" if guess else f"the wheels are {listed}"
        elif wheel is None:
            message = f"has {shown}, which does not tell which wheel it turns"
            remedy = (
                f"add wheel_of_joint: {{{shown}: {next(examples, 'the wheel')}}}, with the wheel it turns"
            )
        elif wheel in elsewhere:
            misplaced += 1
            message = f"has {shown}, of {wheel}, which {here.lack}"
            remedy = f"the wheels here are {listed}; wheel_of_joint states what a name does not tell"
        elif wheel in joint_of:
            misplaced += 1
            other = joint_of[wheel]
            message = f"has {shown} for {wheel}, as {one_line(other)} on line {first_line[other]}"
            remedy = (
                f"put a joint of {unsaid or 'another wheel'} here, or state its wheel with wheel_of_joint"
            )
        else:
            joint_of[wheel] = joint
            message = remedy = ""
        first_line.setdefault(joint, line)
        if message:
            report(line, path, f"{key} {message}", remedy)
    # One slip, one finding: a list that is too long by what was just refused is not reported again.
    if len(entries) < len(wheels) or len(entries) - misplaced > len(wheels):
        message = f"{key} {_count_rule(wheels)}, got {len(entries)}"
        remedy = f"add the joint of {unsaid}" if unsaid else f"the wheels are {listed}"
        section.report(report, (key,), message, remedy)
    return {joint: wheel for wheel, joint in joint_of.items()}


def _count_rule(wheels: tuple[str, ...]) -> str:
    return f"must name {len(wheels)} joint{'' if len(wheels) == 1 else 's'}, one per wheel"


class _Entry(NamedTuple):
    path: Path
    joint: str
    statement: str | None  # the wheel as the file states it
    wheel: str | None


def _entries(here: JointList, given: list[str] | dict[str, str], stated: Mapping[str, str]) -> list[_Entry]:
    # A stated name must be a wheel's very name; a joint's own name is searched for a wheel's place.
    key = here.key
    known = {wheel: wheel for wheel in (*here.wheels, *here.elsewhere)}
    if isinstance(given, dict):
        return [_Entry((key, wheel), joint, wheel, known.get(wheel)) for wheel, joint in given.items()]
    entries = []
    for index, joint in enumerate(given):
        statement = stated.get(joint)
        said = wheel_said_by(joint, here.wheels, here.elsewhere)
        wheel = said if statement is None else known.get(statement)
        entries.append(_Entry((key, index), joint, statement, wheel))
    entries = _by_elimination(entries, here.wheels)
    if len(entries) != len(here.wheels):
        return entries
    in_order = [
        entry._replace(wheel=wheel) if entry.statement is None else entry
        for entry, wheel in zip(entries, here.wheels, strict=True)
    ]
    silent = all(entry.wheel is None and entry.statement is None for entry in entries)
    fitting = all(agree(said_by(entry.joint), said_by(str(entry.wheel))) for entry in in_order)
    counts = silent and fitting and (here.order != "names" or len(entries) == 1)
    return in_order if here.order == "fixed" or counts else entries


def _by_elimination(entries: list[_Entry], wheels: tuple[str, ...]) -> list[_Entry]:
    """Names that say a side or an axle, and that the others leave one wheel: ``left_wheel`` beside
    ``rear_left_wheel``."""
    for _ in wheels:
        free = [wheel for wheel in wheels if wheel not in {entry.wheel for entry in entries}]
        for index, entry in enumerate(entries):
            said = said_by(entry.joint)
            told = [wheel for wheel in free if said_by(wheel) is not None]
            fitting = [wheel for wheel in told if said is not None and agree(said_by(wheel), said)]
            if entry.wheel is None and entry.statement is None and len(fitting) == 1:
                entries[index] = entry._replace(wheel=fitting[0])
                break
        else:
            break
    return entries


def check_wheels(section: Section, values: Mapping[str, Any], rover: Rover, report: Report) -> None:
    """The wheels that the keys of wheel_encoders and odometry name are there."""
    steered = (rover.steered_wheel_names, rover.steering_joints)
    for group, key, (wheels, joints) in (
        ("wheel_encoders", "reversed", (rover.wheel_names, rover.traction_joints)),
        ("wheel_encoders", "steering_gain", steered),
        ("steering_encoders", "reversed", steered),
        ("steering_encoders", "offsets", steered),
        ("odometry", "wheel_noise", (rover.wheel_names, ())),
    ):
        given = values.get(group, {}).get(key, ())
        places = [(name, name) for name in given] if isinstance(given, dict) else enumerate(given)
        known = [*wheels, *joints]
        for place, wheel in places:
            if wheel not in known:
                at, guess = (group, key, place), closest(wheel, known)
                message = f"{group}.{key} names {one_line(wheel)}, which is no such wheel or joint"
                remedy = f"did you mean {guess}?" if guess else f"there are {', '.join(wheels) or 'none'}"
                section.report(report, at, message, remedy)
