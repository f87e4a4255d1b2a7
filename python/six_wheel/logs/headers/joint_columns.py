"""Columns of a joint log: the joint and the quantity that each of them holds.

A wheel may be read as the angle it has turned, as its rate, or in ticks of an encoder: three quantities
that no default can tell apart, so a header says which, by a word (``front_left_wheel_joint/velocity``) or by
a unit (``front_left [rpm]``). Of a log that has several, the angle serves best, and ticks before rates.
"""

import difflib
import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias, get_args

from six_wheel._core import Rover
from six_wheel.kinematics.errors import TableError
from six_wheel.logs.headers.columns import BRACKETS, SPEEDS, TIME, Column, Unit, listed, unit, words
from six_wheel.logs.headers.rate_columns import rate_columns
from six_wheel.logs.headers.renamed import all_names
from six_wheel.logs.headers.time_columns import time_columns
from six_wheel.logs.headers.truth_columns import ANGLES, truth_columns
from six_wheel.logs.plausibility.proposals import columns
from six_wheel.robot_description.doubts import Proposal

Reading: TypeAlias = Literal["angles", "speeds", "ticks"]
READINGS: tuple[Reading, ...] = get_args(Reading)
_BEST_FIRST: tuple[Reading, ...] = ("angles", "ticks", "speeds")

_TURN, _DEGREE = 2 * math.pi, math.pi / 180
# Ways and speeds of the rim, which its radius makes angles and rates.
_AT_RIM = (
    (
        unit("m", 1.0, "m metre metres meter meters"),
        unit("cm", 1e-2, "cm"),
        unit("mm", 1e-3, "mm"),
        unit("km", 1e3, "km"),
        unit("in", 0.0254, "in inch inches"),
        unit("ft", 0.3048, "ft foot feet"),
    ),
    (
        unit("m/s", 1.0, "m_s mps ms m_per_s m_s_1 m_sec meters_per_second metres_per_second"),
        *SPEEDS[1:],  # cm/s, mm/s, km/h
        unit("m/min", 1 / 60, "m_min m_per_min"),
        unit("mph", 0.44704, "mph mi_h"),
        unit("ft/s", 0.3048, "ft_s fps ft_per_s"),
    ),
)
_UNITS: Mapping[Reading, tuple[Unit, ...]] = {
    "angles": (*ANGLES, *_AT_RIM[0]),
    "speeds": (
        unit("rad/s", 1.0, "rad_s radps rad_per_s rad_s_1 rad_sec rad_per_sec radians_per_second"),
        unit("deg/s", _DEGREE, "deg_s degps dps deg_per_s deg_s_1 deg_sec deg_per_sec degrees_per_second"),
        unit("rev/s", _TURN, "rev_s revps rps rev_per_s rev_sec rot_s turns_s revolutions_per_second"),
        unit("mrad/s", 1e-3, "mrad_s mrad_per_s"),
        unit("rpm", _TURN / 60, "rpm rev_min r_min u_min tr_min 1_min min_1 revolutions_per_minute"),
        *_AT_RIM[1],
    ),
    "ticks": (unit("ticks", 1.0, "ticks tick counts count pulses pulse cnt cts steps qc quad_counts"),),
}
# Words for ways, which are nothing without their unit.
_LENGTHWISE = ("distance", "dist", "travel", "way")
_WORDS: Mapping[Reading, tuple[str, ...]] = {
    "angles": ("position", "pos", "angle", "theta", "phi", *_LENGTHWISE),
    "speeds": ("velocity", "vel", "speed", "rate", "omega"),
    "ticks": ("encoder", "enc", "ticks", "tick", "counts", "count", "cnt", "cts", "pulses", "pulse"),
}
# Words that messages do not recommend.
_SHORT = frozenset(("enc", "cnt", "cts", "pulse", "theta", "phi", "omega", *_LENGTHWISE))
_DIRECTIONS = frozenset(("dir", "direction", "sign", "forward", "fwd", "reverse", "rev_flag", "backwards"))
# Words by which joint states go, whose units are those of ROS.
_OF_ROS = frozenset(("position", "velocity"))
_BEHIND = frozenset(word for words_of in _WORDS.values() for word in words_of)
# Prefixes that recorders put before the name of a joint.
_BEFORE = ("", "joint_states_", "joint_state_")

# Names of wheels and their joints: their own names, and those that joints have where none are given.
_STEERING_FORMS = ("{0}_steering", "{0}_steer", "steering_{0}", "{0}_steering_joint", "{0}_steer_joint")
_WHEEL_FORMS = ("{0}", "{0}_wheel", "{0}_wheel_joint", "wheel_{0}", "wheel_{0}_joint")


@dataclass(frozen=True)
class JointColumns:
    """Columns by what they hold."""

    columns: dict[str, Column]  # "time", "steering NAME", "wheel NAME", those of the truth and a gyroscope
    readings: Reading  # kind of the wheels' columns
    silent: tuple[str, ...]  # wheels with a motor but without a column
    # Keys of `columns` that go by the name of a joint which counts the other way.
    reversed: frozenset[str] = frozenset()


def joint_columns(
    headers: Sequence[str],
    rover: Rover,
    readings: Reading | None = None,
    field_units: Mapping[int, str] | None = None,
    stamp_unit: str | None = None,
) -> JointColumns:
    """Find the columns of a joint log, whose headers name joints and wheels of the rover.

    `readings` is the kind of a wheel's column if its header does not state it, and the one to take if there
    are several; `field_units` are by column, for headers that state none; `stamp_unit` is that of the times,
    whatever their header says. Raises `TableError` if there is no time, no wheel, a steered wheel without its
    angle, two columns for one joint or wheels read in different ways.
    """
    if readings is not None and readings not in READINGS:
        raise ValueError(f'readings must be one of {", ".join(READINGS)}, got "{readings}"')
    found = time_columns(headers, field_units, stamp_unit)
    found |= truth_columns(headers) | rate_columns(headers, field_units)
    taken = {column.index for column in found.values()}
    steering = _stems(rover.steered_wheel_names, rover.steering_joints, _STEERING_FORMS)
    wheels = _stems(rover.wheel_names, rover.traction_joints, _WHEEL_FORMS)
    backwards = {words(joint) for joint in rover.reversed_joints}
    turned: set[str] = set()
    by_reading: dict[str, dict[Reading, Column]] = {}
    doubts: dict[str, tuple[str, tuple[str, str]]] = {}
    for index, header in enumerate(headers):
        if index in taken:
            continue
        bracketed = BRACKETS.match(header)
        text, given = (bracketed[1], bracketed[2]) if bracketed else (header, (field_units or {}).get(index))
        for part, stems in (("steering", steering), ("wheel", wheels)):
            named = _named(words(text), stems)
            if named is None:
                continue
            name, rest = f"{part} {named[0]}", named[1]
            turned |= {name} if named[2] in backwards else set()
            meaning = _reading(rest, given, "angles" if part == "steering" else readings)
            if meaning is None or (part == "steering" and meaning[0] == "speeds"):
                if meaning is None and (given or not rest):
                    meaning_of = f"{named[0]}{'_steering' if part == 'steering' else ''} [UNIT]"
                    said = (_doubt(header, text, rest, given, part), (header, meaning_of))
                    doubts.setdefault(name, said)
                break
            kinds = by_reading.setdefault(name, {})
            if meaning[0] in kinds:
                rule = f'{name} must be in one column, got "{kinds[meaning[0]].header}" and "{header}"'
                raise TableError(f"{rule}; rename or drop all but one")
            unit_of = _at_the_rim(meaning[1], rover, named[0]) if part == "wheel" else meaning[1]
            of_unit = rest != "" and rest not in _WORDS[meaning[0]]
            stated = given is not None or of_unit or (part == "wheel" and meaning[0] == readings)
            kinds[meaning[0]] = Column(index, header, unit_of, stated)
            break
    for name, (doubt, _) in doubts.items():
        if name not in by_reading:
            asked = dict(each for other, (_, each) in doubts.items() if other not in by_reading)
            raise TableError(f"{doubt}: give ", columns(asked))
    _refuse_missing(by_reading, headers, rover)
    wheel_columns = {name: kinds for name, kinds in by_reading.items() if name.startswith("wheel ")}
    choices = _BEST_FIRST if readings is None else (readings, *_BEST_FIRST)
    chosen = next((kind for kind in choices if all(kind in kinds for kinds in wheel_columns.values())), None)
    if chosen is None:
        shown = ", ".join(
            f'"{column.header}" ({kind})'
            for kinds in wheel_columns.values()
            for kind, column in kinds.items()
        )
        raise TableError(f"wheels must be read in one way, all as angles, speeds or ticks, got {shown}")
    found |= {
        name: kinds.get("angles") or kinds["ticks"]
        for name, kinds in by_reading.items()
        if name not in wheel_columns
    }
    found |= {name: kinds[chosen] for name, kinds in wheel_columns.items()}
    silent = tuple(wheel for wheel in rover.traction_joints.values() if f"wheel {wheel}" not in found)
    return JointColumns(found, chosen, silent, frozenset(turned))


def direction_columns(headers: Sequence[str], rover: Rover) -> dict[str, str]:
    """Headers that name a direction of a wheel apart from its readings, by wheel."""
    stems = _stems(rover.wheel_names, rover.traction_joints, _WHEEL_FORMS)
    named = {header: _named(words(header), stems) for header in headers}
    return {found[0]: header for header, found in named.items() if found and found[1] in _DIRECTIONS}


def unit_words() -> frozenset[str]:
    """All spellings of units."""
    return frozenset(s for units in (*_UNITS.values(), TIME.units) for each in units for s in each.spellings)


def unsaid_units(joints: JointColumns, rover: Rover) -> str:
    """Line about wheels of which nobody said the unit; empty where names are those of joint states."""
    of_ros = tuple(f"{words(joint)}_{word}" for joint in rover.traction_joints for word in _OF_ROS)
    unit = "rad" if joints.readings == "angles" else "rad/s"
    found = {
        column.header: f"{name.removeprefix('wheel ')} [{unit}]"
        for name, column in joints.columns.items()
        if name.startswith("wheel ") and not column.stated and joints.readings != "ticks"
        if not words(column.header).endswith(of_ros)
    }
    if not found:
        return ""
    return f'"{next(iter(found))}" says no unit, and is read in {unit}: {columns(found)} says so'


def _at_the_rim(unit: Unit, rover: Rover, wheel: str) -> Unit:
    """A unit of a wheel's angle or rate; of ways and speeds, by its radius."""
    if not any(unit.symbol == each.symbol for units in _AT_RIM for each in units):
        return unit
    radius = next(each.radius for each in rover.wheels if each.name == wheel)
    return replace(unit, scale=unit.scale / radius)


def _stems(wheels: Sequence[str], joints: Mapping[str, str], forms: Sequence[str]) -> dict[str, str]:
    """Beginnings that a header may have, each with the wheel that it means."""
    named = {words(form.format(wheel)): wheel for wheel in wheels for form in forms}
    return named | {words(joint): wheel for joint, wheel in joints.items()}


def _named(text: str, stems: Mapping[str, str]) -> tuple[str, str, str] | None:
    """The wheel a header names, what comes behind, by which name; of "rear" and "rear_left" the longer."""
    rests = {
        text[len(before + stem) :].lstrip("_"): (wheel, stem)
        for stem, wheel in stems.items()
        for before in _BEFORE
        if text == before + stem or text.startswith(before + stem + "_")
    }
    if not rests:  # "encoder_left", "vel_front_left"
        rests = {
            text[: -len(stem) - 1].removesuffix("_wheel"): (wheel, stem)
            for stem, wheel in stems.items()
            if text.endswith(f"_{stem}") and text[: -len(stem) - 1].removesuffix("_wheel") in _BEHIND
        }
    rest = min(rests, key=len, default=None)
    return None if rest is None else (rests[rest][0], rest, rests[rest][1])


def _doubt(header: str, text: str, rest: str, given: str | None, part: str) -> str:
    kinds: Sequence[Reading] = ("angles", "ticks") if part == "steering" else READINGS
    units = {spelling for kind in kinds for each in _UNITS[kind] for spelling in each.spellings}
    if rest and given is not None and words(given) in units:
        said = ", ".join(sorted({word for kind in kinds for word in _WORDS[kind]} - _SHORT))
        return f'column "{header}" must say what it is by one of {said}, or nothing, got "{rest}"'
    known = ", ".join(each.symbol for kind in kinds for each in _UNITS[kind])
    such = f'"{text.strip()} [{"rad" if part == "steering" else "rad/s"}]"'
    got = "none" if given is None else f'"{given}"'
    return f'column "{header}" must state its unit, one of {known}, such as {such}, got {got}'


def _reading(rest: str, given: str | None, default: Reading | None) -> tuple[Reading, Unit] | None:
    """Reading and unit by the words behind a name and the unit in brackets; None if they do not agree."""
    given = words(given) if given else None
    for kind in READINGS:
        for each in _UNITS[kind]:
            if given is not None:
                if given in each.spellings and rest in ("", *_WORDS[kind]):
                    return kind, each
            elif any(rest in (ending, *(f"{w}_{ending}" for w in _WORDS[kind])) for ending in each.spellings):
                return kind, each
        if given is None and rest in _WORDS[kind] and rest not in _LENGTHWISE:
            return kind, _UNITS[kind][0]
    return (default, _UNITS[default][0]) if default and not rest and given is None else None


def _refuse_missing(found: Collection[str], headers: Sequence[str], rover: Rover) -> None:
    for joint, wheel in rover.steering_joints.items():
        if f"steering {wheel}" not in found:
            hint = did_you_mean([joint, f"{wheel}_steering"], headers)
            missing = f'no column for the steering angle of {wheel} ("{joint}")'
            raise TableError(f"{missing} among {listed(headers)}{hint}")
    if not any(name.startswith("wheel ") for name in found):
        named = ", ".join(f'"{joint}"' for joint in rover.traction_joints)
        hint = did_you_mean([*rover.traction_joints, *rover.wheel_names], headers)
        twice = len(set(headers)) < len(headers)
        given = ("; some have one name: ", *all_names(headers)) if twice else _proposed(headers, rover)
        raise TableError(f"no column for any wheel ({named}) among {listed(headers)}{hint}", *given)


def _proposed(headers: Sequence[str], rover: Rover) -> tuple[str | Proposal, ...]:
    """Parts of a proposal to read headers as wheels, by names, initials or their order; or nothing."""
    bare = {header: BRACKETS.match(header) for header in headers}
    names = {header: (found[1] if found else header) for header, found in bare.items()}
    found = _like(names, rover) or _in_order(headers, rover)
    meanings = {}
    for header, wheel in found.items():
        bracketed = bare[header]
        meanings[header] = f"{wheel} [{bracketed[2]}]" if bracketed else wheel + _by_name(words(header))
    if not meanings:
        meanings = {f"HEADER{k}": f"{wheel} [UNIT]" for k, wheel in enumerate(rover.wheel_names, start=1)}
        return "; give ", columns(meanings), ", with headers of this log and their unit, or [ticks]"
    guessed = any("[" not in meaning for meaning in meanings.values())
    return "; give ", columns(meanings), ", or with their unit, as [deg]" if guessed else ""


def _like(names: Mapping[str, str], rover: Rover) -> dict[str, str]:
    """Headers to wheels, by what these are called; none if a wheel has no header or several."""
    found: dict[str, str] = {}
    for wheel in rover.wheel_names:
        initials = "".join(part[0] for part in wheel.split("_"))
        ending = re.compile(rf"(?:^|[^a-zA-Z]|[a-z])(?:{initials}|{initials.upper()})$")
        named = re.compile(rf"(?:^|_){words(wheel)}(?:_|$)")
        like = [each for each, name in names.items() if named.search(words(name))]
        like = like or [each for each, name in names.items() if ending.search(name)]
        if len(like) != 1 or like[0] in found:
            return {}
        found[like[0]] = wheel
    return found


def _in_order(headers: Sequence[str], rover: Rover) -> dict[str, str]:
    """Headers to wheels in their order, if that is all a table has beside what is known."""
    known = time_columns(headers) | truth_columns(headers) | rate_columns(headers)
    taken = {column.index for column in known.values()}
    free = [header for index, header in enumerate(headers) if index not in taken and header.strip()]
    fits = len(free) == len(rover.wheel_names) == len(set(free)) and not rover.steered_wheel_names
    return dict(zip(free, rover.wheel_names, strict=True)) if fits else {}


def _by_name(name: str) -> str:
    """The quantity that the words of a header make likely; without a unit, so that readings stay in doubt."""
    if re.search("enc|tick|count|cnt|cts|pulse", name):
        return " [ticks]"
    return "_speed" if re.search("vel|speed|rate|omega|rpm|^w[lr]$", name) else "_angle"


def did_you_mean(names: Sequence[str], given: Sequence[str]) -> str:
    """The pair of a name that is missing and one that is there which are most alike, as a question."""
    likeness = {
        (difflib.SequenceMatcher(None, words(BRACKETS.sub(r"\1", there)), words(name)).ratio(), name, there)
        for name in names
        for there in given
    }
    best, name, there = max(likeness, default=(0.0, "", ""))
    return f'; did you mean "{there}" for "{name}"?' if best > 0.6 else ""
