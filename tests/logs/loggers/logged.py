"""Drives of three rovers with known truth, and the parts that forms of logs are made of."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from six_wheel.kinematics.poses import Floats

COUNTS = 1440
START = 1_794_571_200  # [s] since 1970, a midnight in November 2026


@dataclass(frozen=True)
class Drive:
    """Stamps [s], running totals and steering angles [rad] of a rover, and its pose at the end."""

    rover: sw.Rover
    stamps: Floats
    angles: Floats
    steering: Floats | None
    pose: Floats

    @property
    def rates(self) -> Floats:
        """[rad/s], whose trapezium comes to the totals."""
        return np.gradient(self.angles, self.stamps, axis=0)

    @property
    def counts(self) -> np.ndarray:
        """Whole running totals of an encoder."""
        return np.rint(self.angles * COUNTS / (2.0 * np.pi)).astype(np.int64)

    @property
    def steps(self) -> np.ndarray:
        """Counts since the row before."""
        return np.diff(self.counts, axis=0, prepend=self.counts[:1])

    @property
    def ms(self) -> np.ndarray:
        """Whole milliseconds."""
        return np.rint(1e3 * self.stamps).astype(np.int64)


def driven(
    rover: sw.Rover, period: float = 0.05, backwards: bool = True, seconds: float = 70.0, sign: float = 1.0
) -> Drive:
    """Away in a curve, a stop, back a little, on in the other curve, a stop."""
    stamps = np.round(np.arange(0.0, seconds, period), 9)
    back = -0.2 if backwards else 0.1
    share = stamps / seconds
    knots = [0, 0.05, 0.35, 0.4, 0.45, 0.5, 0.58, 0.62, 0.7, 0.95, 0.98, 1.0]
    speed = np.interp(share, knots, [0, 0.4, 0.45, 0, 0, back, back, 0, 0.5, 0.35, 0, 0])
    speed = sign * speed * (1.0 + 0.04 * np.sin(5.3 * stamps) + 0.03 * np.sin(13.1 * stamps))
    omega = speed * (0.5 * np.sin(stamps / 6.0) + 0.05 * np.sin(3.7 * stamps))
    found, rates = map(np.asarray, rover.inverse(np.stack([speed, 0.0 * speed, omega], axis=1)))
    steps = (rates[1:] + rates[:-1]) / 2.0 * period
    angles = np.vstack([np.zeros(len(rover.wheels)), np.cumsum(steps, axis=0)])
    steering = found if rover.steered_wheel_names else None
    track = sw.dead_reckon(rover, steering, angles, stamps, plausibility=False)
    return Drive(rover, stamps, angles, steering, track.poses[-1])


def dead_reckoned(drive: Drive, angles: Floats, stamps: Floats) -> Drive:
    """The drive that other totals [rad] and stamps [s] of a rover without steering tell."""
    pose = sw.dead_reckon(drive.rover, None, angles, stamps, plausibility=False).poses[-1]
    return Drive(drive.rover, stamps, angles, None, pose)


PAIR = driven(sw.Rover.differential(0.42, 0.09))
ONWARD = driven(PAIR.rover, backwards=False)
QUICK = driven(PAIR.rover, period=0.01)
BACK = driven(PAIR.rover, sign=-1.0)
SKID = driven(sw.Rover.differential(0.5, 0.11, wheels_per_side=2, wheelbase=0.4), period=0.1)
SIX = driven(
    sw.Rover.six_wheel(
        front_to_middle=0.28, middle_to_rear=0.3, track_width=0.48, middle_track_width=0.52, wheel_radius=0.07
    )
)


@dataclass
class Logged:
    """A form of a log: `write` makes a path in a folder, or arguments of `dead_reckon` behind the rover."""

    name: str
    write: Callable[[Path], Any]
    drive: Drive = PAIR
    owner: dict[str, Any] = field(default_factory=dict)
    knowable: bool = True
    says: Sequence[str] = ()

    @property
    def rover(self) -> sw.Rover:
        """Of the drive."""
        return self.drive.rover

    @property
    def pose(self) -> Floats:
        """At the end of the drive."""
        return self.drive.pose


def cell(value: Any) -> str:
    """A number as loggers print it, empty without one."""
    if isinstance(value, float | np.floating):
        return "" if np.isnan(value) else f"{value:.7g}" if abs(value) < 1e5 else f"{value:.6f}"
    return str(value)


def lines_of(columns: Mapping[str, Sequence[Any]], separator: str = ",", header: bool = True) -> list[str]:
    """The lines of a table."""
    rows = [separator.join(map(cell, row)) for row in zip(*columns.values(), strict=True)]
    return [separator.join(columns), *rows] if header else rows


def text(name: str, lines: Sequence[str], encoding: str = "utf-8", end: str = "\n") -> Callable[[Path], Path]:
    """A writer of lines to a file."""

    def write(folder: Path) -> Path:
        (folder / name).write_bytes((end.join(lines) + end).encode(encoding))
        return folder / name

    return write


def table(
    columns: Mapping[str, Sequence[Any]], separator: str = ",", name: str = "log.csv", **how: Any
) -> Callable[[Path], Path]:
    """A writer of a table to a file."""
    return text(name, lines_of(columns, separator), **how)


def wheels(drive: Drive, values: Any, style: str = "{0}") -> dict[str, Any]:
    """Columns of the wheels by their names in some style."""
    return {
        style.format(name): column for name, column in zip(drive.rover.wheel_names, values.T, strict=True)
    }


def as_ticks(heads: Sequence[str], drive: Drive = PAIR) -> dict[str, Any]:
    """Answers of an owner who knows the counts under these headers."""
    names = drive.rover.wheel_names
    return {
        "columns": {h: f"{name} [ticks]" for h, name in zip(heads, names, strict=True)},
        "COUNTS": COUNTS,
    }


def as_unit(heads: Sequence[str], unit: str, drive: Drive = PAIR, **more: str) -> dict[str, Any]:
    """Answers of an owner who knows the unit of columns, and other headers."""
    names = drive.rover.wheel_names
    return {"columns": {**more, **{h: f"{name} [{unit}]" for h, name in zip(heads, names, strict=True)}}}


def clock(seconds: float, form: str = "%H:%M:%S.%f", start: float = START) -> str:
    """A time as `strftime` writes it, with milliseconds for microseconds."""
    from datetime import UTC, datetime

    shown = datetime.fromtimestamp(round(start + seconds, 6), UTC).strftime(form)
    return shown[:-3] if form.endswith("%f") else shown
