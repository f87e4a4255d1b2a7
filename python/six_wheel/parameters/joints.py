"""Which wheel each joint turns.

Teams list joints by axle (front left, front right, ...) or by side (front left, middle left, ...), and
abbreviate as they like; the names are what can be trusted. What a name does not tell is not guessed. Only
where the wheels themselves have names that tell no place (module_0, arm), or a controller defines it, does
the order of a list count, and then only if no joint in it tells its wheel.
"""

import itertools
import re
from collections.abc import Iterable, Mapping
from typing import Literal, NamedTuple, TypeAlias

from six_wheel.parameters.nodes import Section, closest
from six_wheel.parameters.syntax import Path, Report, one_line

__all__ = ["JointList", "Said", "said_by", "wheel_said_by", "wheels_of_joints"]

Said: TypeAlias = tuple[str | None, str | None]  # axle and side; None for one that is left out

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


def wheel_said_by(name: str, wheels: Iterable[str], places: Iterable[str] = ()) -> str | None:
    """The one of `wheels` that `name` says; None if it does not say, or says two.

    The wheels of `places` are known besides: what says one of them exactly says none of `wheels` by halves.
    """
    wheels = tuple(wheels)
    known = (*wheels, *places)
    if name in known:
        return name
    said = said_by(name)
    if said is not None:
        same = [wheel for wheel in known if said_by(wheel) == said]
        if len(same) > 1:
            same = [wheel for wheel in same if _numbers(wheel) == _numbers(name)]
        if len(same) == 1:
            return same[0]
        agreeing = [wheel for wheel in wheels if said_by(wheel) and _agree(said_by(wheel), said)]
        if not same and len(agreeing) == 1:  # "left_wheel" of a car that drives two wheels, both at the rear
            return agreeing[0]
    placeless = [wheel for wheel in known if said_by(wheel) is None]
    for match in (_is_named_in, _has_numbers_of):
        matching = [wheel for wheel in placeless if match(wheel, name)]
        longest = [wheel for wheel in matching if len(wheel) == max(map(len, matching))]
        if len(longest) == 1:
            return longest[0]
    return None


def said_by(name: str) -> Said | None:
    """The place a name tells; None if it tells nothing or contradicts itself.

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


def _agree(one: Said | None, other: Said | None) -> bool:
    """Whether two names can mean the same place."""
    return (
        one is None
        or other is None
        or all(a in (b, None) or b is None for a, b in zip(one, other, strict=True))
    )


def _is_named_in(wheel: str, name: str) -> bool:
    return re.search(rf"(?<![A-Za-z0-9]){re.escape(wheel)}(?![A-Za-z0-9])", name) is not None


def _has_numbers_of(wheel: str, name: str) -> bool:
    return bool(_numbers(wheel)) and _numbers(wheel) == _numbers(name)


def _numbers(name: str) -> list[str]:
    return [number.lstrip("0") or "0" for number in re.findall(r"[0-9]+", name)]


def _words(name: str) -> Iterable[str]:
    for part in re.findall(r"[A-Za-z]+", name):
        if _ONLY_WORDS.fullmatch(part.lower()):
            yield from _WORD.findall(part.lower())
        else:
            yield from (word.lower() for word in _CAMEL_CASE.findall(part))


class JointList(NamedTuple):
    """A key of a parameter file whose value names joints, and the wheels that need one there."""

    key: str
    wheels: tuple[str, ...]
    elsewhere: tuple[str, ...] = ()
    """Wheels that must have no joint in this list."""
    lack: str = "does not steer"
    """Why those must not."""
    order: Literal["names", "silent", "expected", "fixed"] = "names"
    """Whether the order is that of `wheels`: never; if no joint tells its wheel; the same, and joints that
    tell another are worth a warning; always."""
    steers: bool = False
    """Whether the joints steer, and not drive."""


def wheels_of_joints(
    section: Section,
    here: JointList,
    given: list[str] | dict[str, str],
    stated: Mapping[str, str],
    report: Report,
) -> dict[str, str]:
    """Joint to wheel in the file's order, as far as the file is right.

    Parameters
    ----------
    section : Section
        Where the lines are.
    here : JointList
        The key, and which wheels it is about.
    given : list or dict
        Joints in any order, or wheel to joint.
    stated : mapping
        Joint to wheel, for joints whose names do not tell.
    report : callable
        Called for every mistake.
    """
    key, wheels, elsewhere = here.key, here.wheels, here.elsewhere
    entries = _entries(here, given, stated)
    said = {entry.wheel for entry in entries}
    free = [wheel for wheel in wheels if wheel not in said]
    unsaid, listed = ", ".join(free), ", ".join(wheels) or "none"
    examples = itertools.cycle(free or wheels or elsewhere)
    if not said - {None} and len(entries) != len(wheels) and (here.order != "names" or len(wheels) == 1):
        remedy = f"name them in the order of the wheels {listed}"
        report(section.line_of((key,)), (key,), f"{key} {_count_rule(wheels)}, got {len(entries)}", remedy)
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
        report(section.line_of((key,)), (key,), message, remedy)
    return {joint: wheel for wheel, joint in joint_of.items()}


def _count_rule(wheels: tuple[str, ...]) -> str:
    return f"must name {len(wheels)} joint{'' if len(wheels) == 1 else 's'}, one per wheel"


class _Entry(NamedTuple):
    path: Path
    joint: str
    statement: str | None  # the wheel as the file states it
    wheel: str | None


def _entries(here: JointList, given: list[str] | dict[str, str], stated: Mapping[str, str]) -> list[_Entry]:
    # What is stated must be a wheel's very name; a joint's own name is read for what it says.
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
    if len(entries) != len(here.wheels):
        return entries
    in_order = [
        entry._replace(wheel=wheel) if entry.statement is None else entry
        for entry, wheel in zip(entries, here.wheels, strict=True)
    ]
    silent = all(entry.wheel is None and entry.statement is None for entry in entries)
    fitting = all(_agree(said_by(entry.joint), said_by(str(entry.wheel))) for entry in in_order)
    counts = silent and fitting and (here.order != "names" or len(entries) == 1)
    return in_order if here.order == "fixed" or counts else entries
