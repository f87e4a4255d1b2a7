"""A form in which a log may come, and the judgement on how it is read."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import six_wheel as sw
from six_wheel.logs import LogOptions
from tests.logs.judging import of_memory, of_path, read_and_compare

FAR = 0.08  # [m] and [rad] by which a path may be off at its end: ticks, and rows that were left out


@dataclass(frozen=True)
class Form:
    """A log and what it should come to.

    Attributes
    ----------
    name, group : str
    write : callable
        From a folder to the path of a log, or to arguments of `dead_reckon` behind the rover.
    rover : Rover
    pose : array, shape (3,)
        True pose at the end.
    options : mapping
        Said from the start: of `LogOptions` for a path, else of `dead_reckon`.
    fix : mapping
        Of the same kind: what follows the proposal.
    says : tuple of str
        Words that the message must have: the proposal, literally.
    """

    name: str
    group: str
    write: Callable[[Path], Any]
    rover: sw.Rover
    pose: Any
    options: Mapping[str, Any] = field(default_factory=dict)
    fix: Mapping[str, Any] | None = None
    says: tuple[str, ...] = ()


def judge(form: Form, folder: Path) -> tuple[str, str]:
    """The class of a form, and what was said: right, proposed, helpful, unhelpful, silent or traceback."""
    source = form.write(folder)
    verdict, said = _attempt(form, source)
    if verdict == "right" or form.fix is None:
        return verdict, said
    if verdict in ("helpful", "unhelpful") and all(word in said for word in form.says):
        again, more = _attempt(replace(form, options={**form.options, **form.fix}), source)
        return ("proposed", said) if again == "right" else (again, f"{said} THEN {more}")
    return verdict, said


def _attempt(form: Form, source: Any) -> tuple[str, str]:
    verdict, said = read_and_compare(lambda: _path(form, source), form.pose, FAR)
    named = bool(form.says) and all(word in said for word in form.says)
    if verdict == "refused":
        return ("helpful" if named and "\n" not in said else "unhelpful"), said
    return ("helpful" if named else "silent") if verdict == "off" else verdict, said


def _path(form: Form, source: Any) -> tuple[Any, list[str]]:
    if isinstance(source, Path):
        return of_path(form.rover, source, LogOptions(**form.options))
    return of_memory(form.rover, source, dict(form.options))
