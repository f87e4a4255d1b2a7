"""A form in which a log may come, and the judgement on how it is read."""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from six_wheel.log_odometry import ReckonSettings, reckon
from six_wheel.logs import LogOptions

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
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            pose, lines = _path(form, source)
        except ValueError as error:
            said = str(error)
            one_line = "\n" not in said
            return (
                "helpful" if one_line and form.says and all(w in said for w in form.says) else "unhelpful"
            ), said
        except Exception as error:
            return "traceback", repr(error)
    said = "; ".join([*lines, *(str(each.message) for each in caught)])
    off = np.asarray(pose) - form.pose
    off[2] = np.angle(np.exp(1j * off[2]))
    if np.hypot(*off[:2]) < FAR and abs(off[2]) < FAR:
        return "right", said
    doubted = form.says and all(word in said for word in form.says)
    return ("helpful" if doubted else "silent"), f"{said} {off}"


def _path(form: Form, source: Any) -> tuple[Any, list[str]]:
    if not isinstance(source, Path):
        track = sw.dead_reckon(form.rover, *source, **form.options)
        return track.poses[-1], []
    options = LogOptions(**form.options)
    bounds = {name: getattr(options, name) for name in ("max_speed", "max_gap")}
    settings = ReckonSettings(options={name: value for name, value in bounds.items() if value is not None})
    result = reckon(form.rover, source, log_options=options, settings=settings)
    return result.pose, list(result.warnings)
