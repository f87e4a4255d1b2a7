"""OptiOdom recordings: an example of a reader for a format of one's own.

A reader turns files into `Rover` and `WheelLog`; everything else works on those. This one reads the data set
of Sousa, Petry, Moreira & Costa (doi 10.1007/s10846-022-01630-3): four laboratory robots, their encoders
against an OptiTrack motion capture system. A run is a CSV file without header, one row per sample,

    time, x, y, heading, reading 1, reading 2, ...

whose readings count from the row before; ``<session>_metadata.csv`` beside it has the nominal robot. Which
wheel a reading belongs to and which way it counts is in `ROBOTS`, the only part that knows one robot from
another.
"""

import contextlib
import csv
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np

from six_wheel._core import Rover
from six_wheel.kinematics.errors import TableError
from six_wheel.logs.recordings import WheelLog
from six_wheel.robot_description.wheels_of_rover import with_wheels

Metadata = Mapping[str, list[float]]


@dataclass(frozen=True)
class Robot:
    """Interpretation of the files of one robot of the data set."""

    rover: Callable[[Metadata], Rover]  # from the numbers of the metadata to the nominal rover
    wheels: tuple[str, ...]  # the wheel of every reading; a steered robot's steering angle [rad] follows them
    signs: tuple[float, ...]  # +1 where a reading counts forward, or else -1
    steered: bool = False  # there is a steering angle


def _differential(metadata: Metadata) -> Rover:
    right, left = metadata["Di"]
    return Rover.differential(metadata["Li"][0], (left / 2, right / 2))


def _tricycle(metadata: Metadata) -> Rover:
    # The distance of its rear wheels is not stated and, without encoders, not needed: one stands for both.
    return Rover.bicycle(metadata["Li"][0], metadata["Di"][0] / 2, driven="front")


def _omni(metadata: Metadata) -> Rover:
    reach, (headings, names) = metadata["Li"][0], _OMNI
    directions = np.radians(headings)
    places = reach * np.stack((-np.sin(directions), np.cos(directions)), axis=1)
    rover = Rover.omni(places, directions, metadata["Di"][0] / 2, names=names)
    return with_wheels(rover, ({"radius": diameter / 2} for diameter in metadata["Di"]))


def _mecanum(metadata: Metadata) -> Rover:
    base, track_width = metadata["Li"]
    rover = Rover.mecanum(base, track_width, metadata["Di"][0] / 2)
    return with_wheels(rover, ({"radius": diameter / 2} for diameter in metadata["Di"]))


# Each wheel drives across its arm, so that all together turn the robot clockwise.
_OMNI = ((-150.0, -30.0, 90.0), ("front_right", "front_left", "rear"))

ROBOTS: Mapping[str, Robot] = {
    "diff": Robot(_differential, ("right", "left"), (1, 1)),
    "tricyc": Robot(_tricycle, ("front",), (1,), steered=True),
    "omni3": Robot(_omni, _OMNI[1], (1, 1, 1)),
    "omni4": Robot(_mecanum, ("front_left", "front_right", "rear_left", "rear_right"), (1, -1, 1, -1)),
}


def read_rover(path: str | Path) -> Rover:
    """The nominal robot of a session, by a ``_metadata.csv`` or a run beside it.

    Raises `ValueError` if the robot is not one of `ROBOTS` or a dimension is missing. Raises `OSError` if
    there is no such file.
    """
    return _read_metadata(Path(path))[2]


def read(path: str | Path) -> WheelLog:
    """One run: stamps, wheel angles as running totals, steering angles, and the truth.

    Parameters
    ----------
    path : str or Path
        A ``_run-NN.csv`` with its metadata beside it. Its name and the session's become those of the log.

    Raises
    ------
    ValueError
        If a line does not hold the numbers it must; the line is named. A last line without its end is what
        a recorder leaves that was switched off: it is left out.
    OSError
        If there is no such file.
    """
    path = Path(path)
    robot, metadata, rover = _read_metadata(path)
    with _named(path):
        columns = 4 + len(robot.wheels) + robot.steered
        with open(path, encoding="utf-8", errors="replace") as file:
            rows = [row for number, line in enumerate(file, 1) for row in _numbers(number, line, columns)]
        table = np.array(rows).reshape(-1, columns)
        per_turn = metadata["ngear"][0] * metadata["encRes"][0]
        turned = table[:, 4 : 4 + len(robot.wheels)] * np.array(robot.signs) * (2.0 * math.pi / per_turn)
        increments = np.full((len(table), len(rover.wheels)), math.nan)  # NaN: a wheel without encoder
        increments[:, [rover.wheel_names.index(name) for name in robot.wheels]] = turned
        return WheelLog.from_increments(
            table[:, 0],
            table[:, -1:] if robot.steered else None,
            increments,
            table[:, 1:4],
            name=path.stem,
            session=path.stem.rpartition("_run-")[0],
        )


@contextlib.contextmanager
def _named(path: Path) -> Iterator[None]:
    """Errors of the block name the file and are a `ValueError`."""
    try:
        yield
    except (csv.Error, IndexError, ValueError) as error:
        told = "a number of the robot is missing" if isinstance(error, IndexError) else str(error)
        raise ValueError(f"{path.name}: {told}") from None


def read_for(path: Path, rover: Rover) -> WheelLog:
    """A run, if it is one of this rover's. Raises `TableError` if it has other wheels."""
    nominal = read_rover(path)
    if nominal.wheel_names != rover.wheel_names or nominal.steered_wheel_names != rover.steered_wheel_names:
        theirs, ours = (", ".join(each.wheel_names) for each in (nominal, rover))
        raise TableError(f"{path}: the wheels must be {theirs}, as the run has them, got {ours}")
    return read(path)


def runs(folder: str | Path) -> list[Path]:
    """All runs under a folder, by name: those that have their metadata beside them."""
    return sorted(path for path in Path(folder).rglob("*_run-*.csv") if metadata_of(path).exists())


def example_run() -> Path:
    """The run that comes with this package; see logs/data/README.md."""
    return runs(Path(str(resources.files("six_wheel.logs") / "data" / "optiodom")))[0]


def example() -> tuple[Rover, WheelLog]:
    """The nominal robot and the run that come with this package: a tricycle driven freely."""
    return read_rover(example_run()), read(example_run())


def claims(path: Path) -> bool:
    """True for a run with its metadata beside it, and for metadata."""
    return path.stem.endswith("_metadata") or ("_run-" in path.stem and metadata_of(path).is_file())


def metadata_of(path: Path) -> Path:
    """The metadata beside a run, or the path itself if it is that."""
    if path.stem.endswith("_metadata"):
        return path
    return path.with_name(path.stem.rpartition("_run-")[0] + "_metadata.csv")


def _read_metadata(path: Path) -> tuple[Robot, Metadata, Rover]:
    with _named(path := metadata_of(path)):
        with open(path, newline="", encoding="utf-8", errors="replace") as file:
            rows = [row for row in csv.reader(file) if row and row[0]]
        fields = {name: [value for value in values if value] for name, *values in rows}
        kind = "".join(fields.pop("type", []))
        if kind not in ROBOTS:
            raise ValueError(f"type must be one of {', '.join(ROBOTS)}, got {kind!r}")
        metadata = {name: [float(value) for value in values] for name, values in fields.items()}
        for name in ("ngear", "encRes", "Li", "Di"):
            if not metadata.get(name):
                raise ValueError(f"{name} must be given")
        return ROBOTS[kind], metadata, ROBOTS[kind].rover(metadata)


def _numbers(number: int, line: str, columns: int) -> Iterator[list[float]]:
    """The row of a line; nothing for an empty or a cut one."""
    if not line.strip():
        return
    try:
        row = [float(text) for text in line.split(",")]
    except ValueError:
        row = []
    if len(row) == columns and all(map(math.isfinite, row)):
        yield row
    elif line.endswith("\n"):
        message = f"line {number} must be {columns} finite numbers, got {line.strip()[:60]!r}"
        raise ValueError(message)
