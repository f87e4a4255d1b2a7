"""First positions of the sliders by options, and the command line and Python lines that give them again."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from collections.abc import Iterable, Mapping
from shlex import quote
from typing import Any

import numpy as np

from six_wheel.kinematics.errors import ArgumentTypeError, shown
from six_wheel.simulation.on_terrain import middle
from six_wheel.view.motion import State
from six_wheel.view.subject import Subject, number, triple

DEGREES = ("steering_limit", "tilt", "joints")  # of the command line; radians in Python
TILT = math.radians(30.0)


def start_state(
    subject: Subject,
    *,
    twist: Any = None,
    steering_limit: float | None = None,
    wheel_speed: float | None = None,
    speed: float | None = None,
    tilt: float | None = None,
    joints: Any = None,
    scrub: Mapping[str, float] | None = None,
) -> State:
    """The first positions of the sliders: a left turn, or what is given; arguments as of `six_wheel.view`."""
    if twist is None:
        rim = subject.wheel_speed * subject.radius / 2.0
        size = max(max(abs(wheel.x), abs(wheel.y)) for wheel in subject.rover.wheels)
        turn = np.array((rim, 0.0, rim / max(2.5 * size, 1.2 * subject.rover.min_radius)))
        if subject.stand is not None:  # as its wheels are steered, where they agree
            free = subject.rover.mobility(subject.stand.steering).motion
            if len(free) == 1:
                turn = free[0] * np.copysign(rim / np.linalg.norm(free[0]), free[0, 0])
        twist = subject.rover.project(turn).tolist()
    if joints is not None and (subject.suspension is None or subject.ground is not None or subject.record):
        raise ValueError(f"joints must be left out unless a suspension is shown without ground, got {joints}")
    return State(
        triple("twist", twist),
        subject.steering_limit if steering_limit is None else _steering_limit(subject, steering_limit),
        subject.wheel_speed if wheel_speed is None else _positive("wheel_speed", wheel_speed),
        subject.limits.speed if speed is None else _positive("speed", speed),
        TILT if tilt is None else _positive("tilt", tilt),
        subject.start,
        (0.0, 0.0, 0.0) if joints is None else triple("joints", joints),
        scrub=None if scrub is None else _scrub(subject, scrub),
    )


def command_line(subject: Subject, state: State, time: float | None = None) -> str | None:
    """The command; None for a subject that was made in a program."""
    given = subject.given is not None and subject.rover_given != ""
    if not given or (subject.ground is not None and not subject.ground_given and subject.record is None):
        return None
    parts = ["six-wheel view", quote(str(subject.given))]
    if subject.rover_given is not None:
        parts.append(f"--rover {quote(str(subject.rover_given))}")
    if subject.other is not None:
        if subject.other.given is None:
            return None
        parts.append(f"--with {quote(subject.other.given)}")
    if subject.ground_given not in (None, "yard"):
        parts.append(f"--ground {quote(str(subject.ground_given))}")
    for name, value in _changes(subject, state, time).items():
        option = f"--{name.replace('_', '-')}"
        if isinstance(value, dict):
            parts += [f"{option} {quote(f'{wheel}={_number(each)}')}" for wheel, each in value.items()]
            continue
        shown = [math.degrees(each) for each in value] if name in DEGREES else value
        parts.append(f"{option} {' '.join(map(_number, shown))}")
    return " ".join(parts)


def python_lines(subject: Subject, state: State, time: float | None = None) -> str:
    """The lines of a program; objects are called x, rover, other and ground."""
    options = ["x" if subject.given is None else repr(subject.given)]
    if subject.rover_given is not None:
        options.append(f"rover={repr(subject.rover_given) if subject.rover_given else 'rover'}")
    if subject.other is not None:
        options.append(f"other={'other' if subject.other.given is None else repr(subject.other.given)}")
    given = subject.ground_given
    own = subject.record is not None or subject.stand is not None
    if given == "flat" or (subject.ground is not None and given != "yard" and not own):
        options.append(f"ground={'ground' if given is None else repr(given)}")
    for name, value in _changes(subject, state, time).items():
        if name == "time":
            continue
        if isinstance(value, dict):
            inside = ", ".join(f"{wheel!r}: {_number(each)}" for wheel, each in value.items())
            options.append(f"{name}={{{inside}}}")
            continue
        joined = ", ".join(map(_number, value))
        options.append(f"{name}={joined}" if len(value) == 1 else f"{name}=({joined})")
    lines = ["import six_wheel as sw", f"view = sw.view({', '.join(options)})"]
    if time:
        lines.append(f"view.time = {_number(time)}")
    return "\n".join(lines)


def _changes(
    subject: Subject, state: State, time: float | None
) -> dict[str, tuple[float, ...] | dict[str, float]]:
    """Options that differ from what a view begins with."""
    found: dict[str, tuple[float, ...] | dict[str, float]] = {}
    begin = start_state(subject)
    if time is None:
        found["twist"] = state.twist
        ground = subject.ground
        if state.pose != ((0.0, 0.0, 0.0) if ground is None else (*middle(ground), 0.0)):
            found["at"] = state.pose
    for name in ("steering_limit", "wheel_speed", "speed", "tilt"):
        value, first = getattr(state, name), getattr(begin, name)
        if value is not None and not math.isclose(value, first, rel_tol=1e-9):
            found[name] = (value,)
    if state.joints != begin.joints and subject.ground is None and time is None:
        found["joints"] = state.joints
    if state.scrub is not None:
        pairs = zip(subject.rover.wheels, state.scrub, strict=True)
        if changed := {wheel.name: each for wheel, each in pairs if each != wheel.scrub}:
            found["scrub"] = changed
    if time:
        found["time"] = (time,)
    return found


def scrub_of(texts: Iterable[str]) -> dict[str, float] | None:
    """Scrub of wheels by name [m] from texts WHEEL=M."""
    found = {}
    for text in texts:
        name, _, value = text.partition("=")
        try:
            found[name] = float(value)
        except ValueError:
            raise ValueError(f'scrub must be WHEEL=M, such as "front_left=0.05", got "{text}"') from None
    return found or None


def _number(value: float) -> str:
    return f"{value:.6g}" if abs(value) < 1000.0 else f"{value:.3f}"  # coordinates of maps are long


def _positive(name: str, value: float) -> float:
    if not (math.isfinite(number(name, value)) and value > 0.0):
        raise ValueError(f"{name} must be finite and positive, got {value:g}")
    return float(value)


def _steering_limit(subject: Subject, steering_limit: float) -> float:
    most = subject.steering_limit
    if most is None:
        raise ValueError(
            f"steering_limit must be left out for a rover that does not steer, got {steering_limit:g}"
        )
    if not 0.0 < number("steering_limit", steering_limit) <= most * (1.0 + 1e-9):
        raise ValueError(f"steering_limit must be positive and at most {most:g} rad, got {steering_limit:g}")
    return min(float(steering_limit), most)


def _scrub(subject: Subject, given: Mapping[str, float]) -> tuple[float, ...]:
    """Scrub of every wheel [m]: the given ones, the others as they are."""
    if not isinstance(given, Mapping):
        raise ArgumentTypeError(f"scrub must be a dict of lengths by names of wheels, got {shown(given)}")
    if subject.ground is not None or subject.record is not None:
        raise ValueError(f"scrub must be left out on ground and for a record, got {dict(given)}")
    names = subject.rover.wheel_names
    for name, value in given.items():
        if name not in names:
            raise ValueError(f'scrub must be by names of wheels ({", ".join(names)}), got "{name}"')
        if not np.isfinite(number("scrub", value)):
            raise ValueError(f"scrub must be finite, got {value} for {name}")
    return tuple(float(given.get(wheel.name, wheel.scrub)) for wheel in subject.rover.wheels)
