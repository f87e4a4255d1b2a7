"""The command line and the Python lines that give the picture on the screen."""

import math
from shlex import quote

from six_wheel.view.motion import State
from six_wheel.view.subject import Subject

__all__ = ["command_line", "python_lines"]


def _number(value: float) -> str:
    return f"{value:.6g}"


def _changes(subject: Subject, state: State, time: float | None) -> dict[str, tuple[float, ...]]:
    """Options that differ from what the view begins with."""
    found: dict[str, tuple[float, ...]] = {}
    if any(state.twist):
        found["twist"] = state.twist
    if state.pose != subject.start and time is None:
        found["at"] = state.pose
    limit = subject.steering_limit
    if limit is not None and state.steering_limit is not None and abs(state.steering_limit - limit) > 1e-9:
        found["steering_limit"] = (state.steering_limit,)
    if time:
        found["time"] = (time,)
    return found


def command_line(subject: Subject, state: State, time: float | None = None) -> str | None:
    """The command; None for a subject that was made in a program."""
    if subject.given is None or (subject.ground is not None and subject.ground_given is None):
        return None
    parts = ["six-wheel view", quote(subject.given)]
    if subject.ground_given not in (None, "yard"):
        parts.append(f"--ground {quote(str(subject.ground_given))}")
    for name, values in _changes(subject, state, time).items():
        shown = [math.degrees(value) for value in values] if name == "steering_limit" else values
        parts.append(f"--{name.replace('_', '-')} {' '.join(map(_number, shown))}")
    return " ".join(parts)


def python_lines(subject: Subject, state: State, time: float | None = None) -> str:
    """The lines of a program; an object is called x."""
    what = "x" if subject.given is None else repr(subject.given)
    options = []
    if subject.ground is not None and subject.ground_given != "yard":
        options.append(f"ground={'ground' if subject.ground_given is None else repr(subject.ground_given)}")
    elif subject.ground is None and subject.ground_given == "flat":
        options.append("ground='flat'")
    for name, values in _changes(subject, state, time).items():
        if name == "time":
            continue
        joined = ", ".join(map(_number, values))
        options.append(f"{name}={joined}" if len(values) == 1 else f"{name}=({joined})")
    lines = ["import six_wheel as sw", f"view = sw.view({', '.join([what, *options])})"]
    if time:
        lines.append(f"view.time = {_number(time)}")
    return "\n".join(lines)
