"""Drives with known truth, and what is drawn of the forms of their logs: readings, stamps, rows."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

import six_wheel as sw

COUNTS = 2048
ROVERS: dict[str, sw.Rover] = {
    "pair": sw.Rover.differential(0.36, 0.08),
    "skid": sw.Rover.differential(0.5, 0.12, wheels_per_side=2, wheelbase=0.4),
    "bicycle": sw.Rover.bicycle(0.9, 0.2, driven="all"),
    "six": sw.Rover.six_wheel(
        front_to_middle=0.3, middle_to_rear=0.3, track_width=0.5, middle_track_width=0.55, wheel_radius=0.1
    ),
}


@dataclass
class Form:
    """A log under way: names, true readings and the texts or numbers that are written of them.

    `owner` is what whoever made the log knows and may be asked for, by the name of an option; `knowable` is
    false where nothing in the log tells what it is.
    """

    random: np.random.Generator
    rover: sw.Rover
    stamps: np.ndarray
    wheels: np.ndarray
    steering: np.ndarray | None
    pose: np.ndarray
    drawn: list[str] = field(default_factory=list)
    columns: dict[str, Any] = field(default_factory=dict)
    owner: dict[str, Any] = field(default_factory=dict)
    knowable: bool = True
    says: tuple[str, ...] = ()

    def choose(self, *names: str) -> str:
        """One of these, noted down."""
        name = str(self.random.choice(names))
        self.drawn.append(name)
        return name


def drive(random: np.random.Generator, rover: sw.Rover) -> tuple[np.ndarray, ...]:
    """Stamps, wheel angles, steering and the last pose of a drive with turns and a stop."""
    period = float(random.choice([0.02, 0.05, 0.1]))
    times = np.arange(0.0, 40.0, period)
    parts = random.uniform(0.15, 0.6, 6)
    speed = np.interp(times, [0, 4, 12, 14, 17, 30, 40], [0, parts[0], parts[1], 0, 0, parts[2], 0])
    turn = random.uniform(0.2, 0.7) * np.sin(times * random.uniform(0.1, 0.4) + parts[3])
    angles, rates = rover.inverse(np.stack([speed, 0 * speed, turn * speed], axis=1))
    steps = (rates[1:] + rates[:-1]) / 2.0 * period
    turned = np.vstack([np.zeros(len(rover.wheels)), np.cumsum(steps, axis=0)])
    steering = np.asarray(angles) if rover.steered_wheel_names else None
    track = sw.dead_reckon(rover, steering, turned, times, plausibility=False)
    return times, turned, steering, track.poses[-1]


# --- readings and stamps ---------------------------------------------------------------------------------

READINGS = {
    "rad": ("rad", 1.0),
    "deg": ("deg", 180.0 / np.pi),
    "rev": ("rev", 0.5 / np.pi),
    "rad/s": ("rad/s", 1.0),
    "rpm": ("rpm", 30.0 / np.pi),
    "deg/s": ("deg/s", 180.0 / np.pi),
}
COUNTERS = {
    "ticks": None,
    "u16": (1 << 16, 0),
    "i16": (1 << 16, 1 << 15),
    "u12": (1 << 12, 0),
    "u32": (1 << 32, 0),
}
STYLES: dict[str, Callable[[str, str], str]] = {
    "brackets": lambda name, unit: f"{name} [{unit}]",
    "round": lambda name, unit: f"{name}_wheel ({unit})",
    "ending": lambda name, unit: f"{name}_{unit.replace('/', '_')}",
    "capital": lambda name, unit: f"{name.title()} [{unit}]",
    "joint": lambda name, unit: f"{name}_wheel_joint [{unit}]",
    "bare": lambda name, unit: name,
    "foreign": lambda name, unit: "ch_" + name[:3] + name[-3:] + str(len(name)),
}


def readings(form: Form) -> None:
    """Columns of wheels and steering, in one unit and style."""
    kind = form.choose(*READINGS, "ticks", *COUNTERS, "per row")
    style = form.choose(*STYLES, "brackets", "ending")
    unit = READINGS.get(kind, ("ticks", 0.0))[0]
    name_of = STYLES[style]
    if kind in READINGS:
        values = (
            form.wheels
            if "/" not in unit and unit != "rpm"
            else np.gradient(form.wheels, form.stamps, axis=0)
        )
        values = np.round(values * READINGS[kind][1], 6)
    else:
        total = np.rint(form.wheels * COUNTS / (2.0 * np.pi))
        form.owner["COUNTS"] = COUNTS
        if kind == "per row":
            values = np.diff(total, axis=0, prepend=total[:1])
        elif COUNTERS[kind] is None:
            values = total + form.random.integers(0, 5000, total.shape[1])
        else:
            size, half = COUNTERS[kind]
            first = size - form.random.integers(200, 2000, total.shape[1]) - half
            values = (total + first + half) % size - half
        values = values.astype(np.int64)
    bare = style in ("bare", "foreign")
    heads = [name_of(name, unit) for name in form.rover.wheel_names]
    meaning = {head: f"{name} [{unit}]" for head, name in zip(heads, form.rover.wheel_names, strict=True)}
    form.columns.update(zip(heads, values.T, strict=True))
    if form.steering is not None:
        degrees = form.choose("steer rad", "steer deg") == "steer deg"
        unit = "deg" if degrees else "rad"
        for name, angles in zip(form.rover.steered_wheel_names, form.steering.T, strict=True):
            head = f"{name}_steering" if bare else name_of(f"{name}_steering", unit)
            if style == "round":
                head = f"{name}_steering ({unit})"
            elif style == "joint":
                head = f"{name}_steering_joint [{unit}]"
            form.columns[head] = np.round(np.degrees(angles) if degrees else angles, 6)
            meaning[head] = f"{name}_steering [{unit}]"
    if bare:
        form.owner["columns"] = meaning
        form.knowable = kind in ("rad", "ticks", *COUNTERS)
    if kind == "per row":
        form.owner["increments"] = True


def stamps(form: Form) -> None:
    """The column of times, first or last."""
    times = form.stamps
    kind = form.choose(
        "time [s]", "t", "time_ms", "bare ms", "bare us", "ns 1970", "s 1970", "iso", "clock", "sec nanosec"
    )
    start = 1_764_000_000
    whole = np.rint(times * 1e9).astype(np.int64)
    made: dict[str, Any] = {}
    if kind in ("time [s]", "t"):
        made = {kind: np.round(times, 6)}
    elif kind == "time_ms":
        made = {kind: whole // 10**6}
    elif kind in ("bare ms", "bare us"):
        unit = kind.split()[1]
        made = {"time": whole // (10**6 if unit == "ms" else 10**3)}
        form.owner["stamp_unit"] = unit
    elif kind == "ns 1970":
        made = {"stamp_ns": whole + start * 10**9}
    elif kind == "s 1970":
        made = {"timestamp": np.round(start + times, 6)}
    elif kind == "iso":
        dates = pd.to_datetime(whole + start * 10**9)
        made = {"time": [date.isoformat() + "Z" for date in dates]}
    elif kind == "clock":
        dates = pd.to_datetime(whole + (23 * 3600 + 59 * 60 + 45) * 10**9)
        made = {"clock": [f"{date:%H:%M:%S.%f}"[:-2] for date in dates]}
    else:
        made = {"stamp.sec": start + whole // 10**9, "stamp.nanosec": whole % 10**9}
    form.columns = {**made, **form.columns}


def rows(form: Form) -> None:
    """Other columns beside, rows twice, cells without a reading, a first column of numbers."""
    kind = form.choose("usual", "usual", "others", "twice", "holes", "index")
    count = len(form.stamps)
    if kind == "others":
        noise = form.random.normal(size=(2, count))
        form.columns |= {"battery [V]": np.round(24.0 + noise[0], 2), "left_current": np.round(noise[1], 3)}
    elif kind == "twice":
        again = np.sort(np.concatenate([np.arange(count), form.random.integers(1, count, 20)]))
        form.columns = {head: np.asarray(values)[again] for head, values in form.columns.items()}
    elif kind == "index":
        form.columns = {"": np.arange(count), **form.columns}
    elif kind == "holes":
        head = list(form.columns)[-1]
        values = np.asarray(form.columns[head], dtype=float).copy()
        values[form.random.integers(2, count - 2, 15)] = np.nan
        form.columns[head] = values
