"""Which wheel each joint turns.

Teams list joints by axle (front left, front right, ...) or by side (front left, middle left, ...), and
abbreviate as they like; the names are what can be trusted. What a name does not tell is not guessed.
"""

import itertools
import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from six_wheel._nodes import Section, closest
from six_wheel._yaml import Path, Report, one_line

__all__ = ["joints_of", "wheel_said_by"]

_AXLES = {
    "front": "front forward fore fwd",
    "middle": "middle mid center centre central ctr",
    "rear": "rear back hind aft",
}
_SIDES = {"left": "left lft", "right": "right rgt rght"}
# Words that say nothing about the wheel, so that "wheelfl" and "frontleftmotor" come apart.
_OTHER = """
    wheel wheels joint jnt motor drive driver driving traction steer steering steered steerer turn rotation
    corner link hub axle servo actuator rocker bogie suspension pivot knuckle rover
"""

_AXLE_OF = {word: axle for axle, words in _AXLES.items() for word in words.split()}
_SIDE_OF = {word: side for side, words in _SIDES.items() for word in words.split()}
_AXLE_LETTERS = {"f": "front", "m": "middle", "c": "middle", "b": "rear", "r": "rear"}
_SIDE_LETTERS = {"l": "left", "r": "right"}
# An r beside an l, or beside another r, is the rear axle; beside an axle's letter it is the right side.
_PAIR_OF = {
    pair: (axle, side)
    for letter, axle in _AXLE_LETTERS.items()
    for initial, side in _SIDE_LETTERS.items()
    for pair in (letter + initial, initial + letter)
}

_WORDS = sorted([*_AXLE_OF, *_SIDE_OF, *_OTHER.split(), *_PAIR_OF], key=len, reverse=True)
_WORD = re.compile("|".join(_WORDS))
_ONLY_WORDS = re.compile(f"(?:{_WORD.pattern})+")
_CAMEL_CASE = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")


def wheel_said_by(name: str, wheels: Iterable[str]) -> str | None:
    """The one of `wheels` that `name` says, by axle and side; None if it does not say, or says two."""
    wheels = tuple(wheels)
    if name in wheels:
        return name
    said = _axle_and_side(name)
    if said is None:
        return None
    matching = [wheel for wheel in wheels if _axle_and_side(wheel) == said]
    return matching[0] if len(matching) == 1 else None


def _axle_and_side(name: str) -> tuple[str | None, str | None] | None:
    """Axle and side, None for one the name leaves out; None alone if it says nothing or contradicts itself.

    Words and pairs ("fl") count first and must agree; letters only fill what they leave open ("front_l").
    """
    words = list(_words(name))
    pairs = [_PAIR_OF[word] for word in words if word in _PAIR_OF]
    axles = {_AXLE_OF[word] for word in words if word in _AXLE_OF} | {axle for axle, _ in pairs}
    sides = {_SIDE_OF[word] for word in words if word in _SIDE_OF} | {side for _, side in pairs}
    letters = [word for word in words if word in _AXLE_LETTERS or word in _SIDE_LETTERS]
    if not axles and not sides:
        return _PAIR_OF.get("".join(letters))
    if not sides:
        sides = {_SIDE_LETTERS[letter] for letter in letters if letter in _SIDE_LETTERS}
    elif not axles:
        axles = {_AXLE_LETTERS[letter] for letter in letters if letter in _AXLE_LETTERS}
    if len(axles) > 1 or len(sides) > 1:
        return None
    return next(iter(axles), None), next(iter(sides), None)


def _words(name: str) -> Iterable[str]:
    for part in re.findall(r"[A-Za-z]+", name):
        if _ONLY_WORDS.fullmatch(part.lower()):
            yield from _WORD.findall(part.lower())
        else:
            yield from (word.lower() for word in _CAMEL_CASE.findall(part))


def joints_of(
    section: Section,
    key: str,
    given: list[str] | dict[str, str],
    stated: Mapping[str, str],
    wheels: tuple[str, ...],
    elsewhere: tuple[str, ...],
    report: Report,
) -> dict[str, str]:
    """Joint to wheel in the file's order, as far as the file is right.

    Parameters
    ----------
    section : Section
        Where the lines are.
    key : str
        ``traction_joints`` or ``steering_joints``.
    given : list or dict
        Joints in any order, or wheel to joint.
    stated : mapping
        Joint to wheel, for joints whose names do not tell.
    wheels : tuple of str
        The wheels that must have a joint each.
    elsewhere : tuple of str
        The rover's other wheels, which must have none.
    report : callable
        Called for every mistake.
    """
    entries = _entries(key, given, stated, (*wheels, *elsewhere))
    said = {entry.wheel for entry in entries}
    free = [wheel for wheel in wheels if wheel not in said]
    unsaid, listed = ", ".join(free), ", ".join(wheels) or "none"
    examples = itertools.cycle(free or wheels or elsewhere)
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
            remedy = f"add wheel_of_joint: {{{shown}: {next(examples)}}}, with the wheel it turns"
        elif wheel in elsewhere:
            misplaced += 1
            message = f"has {shown}, of {wheel}, which does not steer"
            remedy = f"the wheels that steer are {listed}"
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
        message = f"{key} must name {len(wheels)} joints, one per wheel, got {len(entries)}"
        remedy = f"add the joint of {unsaid}" if unsaid else f"the wheels are {listed}"
        report(section.line_of((key,)), (key,), message, remedy)
    return {joint: wheel for wheel, joint in joint_of.items()}


class _Entry(NamedTuple):
    path: Path
    joint: str
    statement: str | None  # the wheel as the file states it
    wheel: str | None


def _entries(
    key: str, given: list[str] | dict[str, str], stated: Mapping[str, str], wheels: tuple[str, ...]
) -> list[_Entry]:
    # What is stated must be a wheel's very name; a joint's own name is read for what it says.
    known = {wheel: wheel for wheel in wheels}
    if isinstance(given, dict):
        return [_Entry((key, wheel), joint, wheel, known.get(wheel)) for wheel, joint in given.items()]
    entries = []
    for index, joint in enumerate(given):
        statement = stated.get(joint)
        wheel = wheel_said_by(joint, wheels) if statement is None else known.get(statement)
        entries.append(_Entry((key, index), joint, statement, wheel))
    return entries
