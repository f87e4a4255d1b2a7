"""Judgement on how a log is read: right, doubted, refused with help, or wrong in silence.

`read_and_compare` reads once; `judge` goes on as a user would, who pastes what a refusal proposes and fills
in what he alone knows of his log.
"""

import re
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np

import six_wheel as sw
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.log_odometry import ReckonSettings, reckon
from six_wheel.log_odometry.run_log import REMARKS
from six_wheel.logs import LogOptions

__all__ = ["CLASSES", "Case", "judge", "read_and_compare"]

CLASSES = ("right", "pasted", "helpful", "unhelpful", "silent", "traceback")
PASTED = re.compile(r"parameter file, or (.+?) in Python")
DOUBT = PASTED.pattern + r"|\?|the path misses|is a guess|after a gap"  # as a command prints it
NAMED = ("columns", "topics", "stamp_unit", "increments", "readings", "max_speed")
TRIES = 6


class Case(Protocol):
    """A log whose truth is known.

    `owner` is what whoever made the log knows and may be asked for, by the name of an option, None for one
    that has no answer; `knowable` is false where nothing in the log tells what it is; `says` are words of a
    refusal that is the right answer.
    """

    rover: sw.Rover
    pose: Any
    owner: dict[str, Any]
    knowable: bool
    says: Sequence[str]


def read_and_compare(read: Callable[[], tuple[Any, list[str]]], pose: Any, far: float) -> tuple[str, str]:
    """``right``, ``off``, ``refused`` or ``traceback``, and what was said.

    Parameters
    ----------
    read : callable
        Returns the last pose and warnings.
    pose : array_like, shape (3,)
        The true one [m, m, rad].
    far : float
        By which the path may be off [m], [rad].
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            found, lines = read()
        except (ValueError, ArgumentTypeError) as error:
            return "refused", str(error)
        except Exception as error:
            return "traceback", repr(error)
    said = "; ".join([*lines, *(str(each.message) for each in caught)])
    off = np.asarray(found) - pose
    off[2] = np.angle(np.exp(1j * off[2]))
    if np.hypot(*off[:2]) < far and abs(off[2]) < far:
        return "right", said
    return "off", f"{said} {off.round(2)}"


def of_path(rover: sw.Rover, path: Path, options: LogOptions) -> tuple[Any, list[str]]:
    """The last pose of a log on disk, and warnings."""
    bounds = {name: getattr(options, name) for name in ("max_speed", "max_gap")}
    settings = ReckonSettings(options={name: value for name, value in bounds.items() if value is not None})
    result = reckon(rover, path, log_options=options, settings=settings)
    rows = [f"{REMARKS.get(flag)}: {count}" for flag, count in result.flags.items()]
    return result.pose, [*result.warnings, *rows]


def of_memory(rover: sw.Rover, source: Any, options: dict[str, Any]) -> tuple[Any, list[str]]:
    """The last pose of a table, a log or arrays in memory."""
    given = source if isinstance(source, tuple) else (source,)
    return sw.dead_reckon(rover, *given, **options).poses[-1], []


def _read(case: Case, source: Any, options: dict[str, Any]) -> tuple[Any, list[str]]:
    if not isinstance(source, Path):
        return of_memory(case.rover, source, options)
    given = dict(options)
    if given.pop("increments", False):
        turn = given.get("wheel_encoders")
        turn = case.owner.get("COUNTS") if turn is None else turn.ticks_per_turn
        given["wheel_encoders"] = {"ticks_per_turn": turn, "increments": True}
    return of_path(case.rover, source, LogOptions(**given))


def _paste(case: Case, said: str, options: dict[str, Any]) -> dict[str, Any] | None:
    """Options a message proposes, or the one it names, filled in by its owner; None if nothing is new."""
    found: dict[str, Any] = {}
    for proposal in PASTED.findall(said)[:1]:
        if "COUNTS" in proposal and "COUNTS" not in case.owner:
            continue
        words = proposal.replace("COUNTS", str(case.owner.get("COUNTS")))
        try:
            found = eval(f"dict({words})", {"Encoder": sw.Encoder, "dict": dict})  # as a user would run it
        except SyntaxError:
            return None
    for name in NAMED:
        wanted = name not in found and name in case.owner
        if wanted and re.search(rf"\b{name}\b|--{name.replace('_', '-')}", said):
            found[name] = case.owner[name]
    known = case.owner.get("columns")
    if "columns" in found and isinstance(known, list):
        found["columns"] = known  # names for NAME
    elif isinstance(options.get("columns"), list):
        found.pop("columns", None)  # all columns have their names
    elif isinstance(found.get("columns"), dict) and isinstance(known, dict):
        columns = {**options.get("columns", {}), **found["columns"], **known}
        found["columns"] = {
            head: meaning for head, meaning in columns.items() if not re.fullmatch(r"HEADER\d*", head)
        }
    found |= {name: None for name in found if case.owner.get(name, found[name]) is None}
    merged = {**options, **found}
    return None if not found or repr(merged) == repr(options) else merged


def judge(case: Case, source: Any, far: float) -> tuple[str, str]:
    """The class of a form, and what was said."""
    options: dict[str, Any] = {}
    told = ""
    for step in range(TRIES):
        verdict, said = read_and_compare(partial(_read, case, source, options), case.pose, far)
        told = f"{told} THEN {said}" if told else said
        if verdict == "right":
            return ("pasted" if step else "right"), told
        doubted = verdict == "off" and re.search(DOUBT, said)
        if verdict == "traceback" or (verdict == "off" and not doubted):
            return "silent" if verdict == "off" else verdict, f"{told} ({options})"
        more = _paste(case, said, options)
        if more is None or any(value is None for value in more.values()):
            break  # the owner knows that it is something else
        options = more
    named = bool(case.says) and all(word in told for word in case.says)
    helpful = named or not case.knowable or verdict == "off"
    return ("helpful" if helpful else "unhelpful"), f"{told} ({options})"
