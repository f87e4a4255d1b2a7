"""Any log that the command line reads, by what the file is: a table, a ROS 2 bag, or what `READERS` read.

A format of one's own is a function that makes a `WheelLog` and its entry in `READERS`, as for OptiOdom runs.
"""

import difflib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import resources
from pathlib import Path
from typing import Any, Self, TypeAlias

import numpy as np

from six_wheel._core import Encoder, Rover
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.odometry.tabular_input import is_table, table
from six_wheel.kinematics.poses import Floats, inverse, joined
from six_wheel.logs import optiodom
from six_wheel.logs.bags.bag_files import BAGS, is_bag
from six_wheel.logs.columns import TableError
from six_wheel.logs.ground_truth import read_truth
from six_wheel.logs.joint_columns import Reading
from six_wheel.logs.joint_sources import JointSource
from six_wheel.logs.joints import JointLog, JointRows
from six_wheel.logs.recordings import GroundTruth, WheelLog
from six_wheel.logs.skip_bad_rows import Findings
from six_wheel.logs.tables import FORMATS

__all__ = [
    "READERS",
    "AnyLog",
    "LogOptions",
    "Reader",
    "as_logs",
    "corrections",
    "example_run",
    "log_format",
    "log_formats",
    "logs_in",
    "metadata_of",
    "open_log",
    "read_log",
]

# Of the keys of encoders those that hold for angles too, however they were read.
CORRECTIONS = frozenset({"scale", "steering_gain"})
ENDINGS = ", ".join([*FORMATS, *BAGS])
AnyLog: TypeAlias = "JointLog | WholeLog"


@dataclass(frozen=True)
class Reader:
    """A log format that is read whole.

    Attributes
    ----------
    claims : callable
        Whether a path is such a log. It is asked before tables and bags are thought of: an ending of
        theirs is not enough.
    read : callable
        From the path and the rover to a `WheelLog` in the rover's order, with its truth if it has one. Its
        `ValueError` or `OSError` becomes the one line of the command.
    """

    claims: Callable[[Path], bool]
    read: Callable[[Path, Rover], WheelLog]


def _optiodom(path: Path, rover: Rover) -> WheelLog:
    """An OptiOdom run, if it is one of this rover's."""
    nominal = optiodom.read_rover(path)
    if nominal.wheel_names != rover.wheel_names or nominal.steered_wheel_names != rover.steered_wheel_names:
        theirs, ours = (", ".join(each.wheel_names) for each in (nominal, rover))
        raise TableError(f"{path}: the wheels must be {theirs}, as the run has them, got {ours}")
    return optiodom.read(path)


READERS: dict[str, Reader] = {"optiodom": Reader(lambda path: metadata_of(path) is not None, _optiodom)}


def log_formats() -> tuple[str, ...]:
    """Names of all formats."""
    return ("table", "bag", *READERS)


@dataclass(frozen=True)
class LogOptions:
    """Options for what a log does not state; see `JointLog`. Encoders, truth and gyroscope have a parameter
    file's keys; `frame` is its base_frame_id."""

    format: str | None = None
    readings: Reading | None = None
    wheel_encoders: Mapping[str, Any] = field(default_factory=dict)
    steering_encoders: Mapping[str, Any] = field(default_factory=dict)
    columns: Mapping[str, str] = field(default_factory=dict)
    topics: Sequence[str] = ()
    truth_topic: str | None = None
    truth: Mapping[str, float] = field(default_factory=dict)
    gyroscope: Mapping[str, Any] = field(default_factory=dict)
    frame: str = ""

    @property
    def sensor(self) -> Floats:
        """Pose in the body of the point that the truth follows: x, y, yaw (3,) [m, m, rad]."""
        return np.array([self.truth.get(axis, 0.0) for axis in ("x", "y", "yaw")])

    def of_body(self, truth: GroundTruth) -> GroundTruth:
        """The truth of the body itself, in the clock of the log, by the key ``truth`` of a parameter file.

        Positions alone stay those of the sensor: without a heading none tells where the body is.
        """
        sensor = self.sensor
        offset = self.truth.get("time_offset", 0.0)
        if not (sensor.any() or offset):
            return truth
        poses = joined(truth.poses, inverse(sensor)) if truth.has_headings else truth.poses
        return replace(truth, stamps=truth.stamps - offset, poses=poses)


def metadata_of(path: Path) -> Path | None:
    """The metadata beside an OptiOdom run, or the path itself if it is one; None for other files."""
    if path.stem.endswith("_metadata"):
        return path
    session, run, _ = path.stem.rpartition("_run-")
    metadata = path.with_name(f"{session}_metadata.csv")
    return metadata if run and metadata.is_file() else None


def log_format(path: Path) -> str:
    """Format of a log, by its ending and the files beside it.

    Raises
    ------
    TableError
        If nothing here reads such a file.
    """
    if not path.exists():
        raise TableError(f"{path}: no such file{_instead_of(path)}")
    for name, reader in READERS.items():
        if reader.claims(path):
            return name
    if is_bag(path):
        return "bag"
    if path.suffix.lower() in FORMATS:
        return "table"
    raise TableError(f'{path}: a log must be a bag\'s folder or end in {ENDINGS}, got "{path.suffix}"')


def logs_in(paths: Sequence[Path]) -> list[Path]:
    """Logs as they are, and of folders that are no bag every log inside, in the order of their names.

    Raises
    ------
    TableError
        If a folder holds none.
    """
    found: list[Path] = []
    for path in paths:
        if not path.is_dir() or (path / "metadata.yaml").exists():
            found.append(path)
            continue
        inside = sorted(each for each in path.rglob("*") if _is_log(each))
        if not inside:
            raise TableError(f"{path}: the folder must hold a log, a bag or a file ending in {ENDINGS}")
        found += inside
    return found


def _is_log(path: Path) -> bool:
    """True if a path in a folder is a log by itself: no part of a bag, not hidden, no metadata of runs."""
    if path.is_dir():
        return (path / "metadata.yaml").exists()
    inside_bag = (path.parent / "metadata.yaml").exists()
    named = path.suffix.lower() in {*FORMATS, *BAGS} or any(one.claims(path) for one in READERS.values())
    return named and not inside_bag and not path.name.startswith(".") and not path.stem.endswith("_metadata")


def open_log(path: Path, rover: Rover, options: LogOptions) -> AnyLog:
    """Open a log for reading in chunks.

    Raises
    ------
    TableError
        If the file is no such log of this rover.
    """
    kind = options.format or log_format(path)
    if kind not in log_formats():
        raise ValueError(f'format must be one of {", ".join(log_formats())}, got "{kind}"')
    if kind in READERS:
        return WholeLog(path, rover, kind)
    if is_bag(path) != (kind == "bag"):
        tables = " or ".join(FORMATS)
        form = "a folder or .mcap or .db3 file" if kind == "bag" else f"a file ending in {tables}"
        raise TableError(f"{path}: the format {kind} is {form}")
    return _joint_log(path, rover, options)


def _joint_log(path: Path, rover: Rover, options: LogOptions) -> JointLog:
    """A joint log whose readings the encoders of the options make angles, as far as they are meant for it.

    The headers tell counts from radians: encoders with ticks per turn are for counts, others for radians.
    Messages have no units: there `ticks_per_turn` says that they are counts.
    """
    columns, topics = options.columns or None, options.topics or None
    source = JointSource(path, rover, options.readings, columns, topics, options.gyroscope, options.frame)
    counts = {"wheel": source.readings == "ticks", "steering": bool(source.counted)}
    found: dict[str, dict[str, Encoder]] = {"wheel": {}, "steering": {}}
    try:
        for part, keys in (("wheel", options.wheel_encoders), ("steering", options.steering_encoders)):
            counted = "ticks_per_turn" in keys
            if counts[part] and not counted:
                what, keys_of_it = TICKS[part]
                rule = f"{what} in ticks, and how many a turn has must be said"
                raise TableError(f"{path}: {rule}; give {keys_of_it} in the parameter file")
            # Speeds are those of the joints: of wheels there is nothing to count, nor are angles turned.
            meant = counts[part] or source.bagged if counted else source.readings != "speeds"
            if meant and not (part == "wheel" and source.readings == "speeds"):
                found[part] = encoders_of(rover, part, keys)
    except BaseException:
        source.close()
        raise
    increments = options.wheel_encoders.get("increments", False) and bool(found["wheel"])
    return JointLog.of_source(source, found["wheel"] or None, found["steering"] or None, increments)


# What is in ticks, and where their number is said.
TICKS = {
    "wheel": ("the wheels are", "--ticks-per-turn, or wheel_encoders.ticks_per_turn"),
    "steering": ("the steering is", "steering_encoders.ticks_per_turn"),
}


def encoders_of(rover: Rover, part: str, values: Mapping[str, Any]) -> dict[str, Encoder]:
    """Encoders by wheel, from the keys of a parameter file; none if these say nothing about them."""
    if not values.keys() - CORRECTIONS:
        return {}
    joints = rover.traction_joints if part == "wheel" else rover.steering_joints
    wheels = rover.wheel_names if part == "wheel" else rover.steered_wheel_names
    turned = {joints.get(name, name) for name in values.get("reversed", ())}
    offsets = {joints.get(name, name): offset for name, offset in values.get("offsets", {}).items()}
    ticks, gear, wraps_at = (values.get(key) for key in ("ticks_per_turn", "gear_ratio", "wraps_at"))
    return {
        wheel: Encoder(
            ticks,
            gear_ratio=(1.0 if gear is None else gear) * (-1.0 if wheel in turned else 1.0),
            wraps_at=wraps_at,
            offset=offsets.get(wheel, 0.0),
        )
        for wheel in wheels
    }


def corrections(rover: Rover, values: Mapping[str, Any]) -> tuple[Floats, float]:
    """Factors for the steering angles (steered wheels,) and for the wheels' angles."""
    gains = values.get("steering_gain", {})
    named = {rover.steering_joints.get(name, name): gain for name, gain in gains.items()}
    return np.array([named.get(wheel, 1.0) for wheel in rover.steered_wheel_names]), values.get("scale", 1.0)


def _instead_of(path: Path) -> str:
    """A hint at a file whose name is like that of one that is missing."""
    folder = path.parent
    names = [each.name for each in folder.iterdir()] if folder.is_dir() else []
    close = difflib.get_close_matches(path.name, names, 1)
    return f'; did you mean "{path.with_name(close[0])}"?' if close else ""


def as_logs(source: Any, rover: Rover) -> list[WheelLog]:
    """Drives from what tells one, or from some of those: a `WheelLog`, the path of any that `read_log` reads,
    a table of columns.

    Raises
    ------
    TypeError
        If it is nothing of these.
    ValueError
        If a file or a table cannot be used.
    """
    many = isinstance(source, Iterable) and not (isinstance(source, str) or is_table(source))
    return [_as_log(one, rover) for one in (source if many else [source])]


def _as_log(source: Any, rover: Rover) -> WheelLog:
    if isinstance(source, WheelLog):
        return source
    if isinstance(source, str | os.PathLike):
        return read_log(source, rover)[0]
    if not is_table(source):
        raise TypeError(f"logs must be Logs, paths or tables of columns, got {type(source).__name__}")
    pieces = list(table(rover, source, None, {}, {}).pieces)
    steering = np.concatenate([piece.steering for piece in pieces]) if rover.steered_wheel_names else None
    stamps = np.concatenate([piece.stamps for piece in pieces])
    return WheelLog(stamps, steering, np.concatenate([piece.wheels for piece in pieces]))


@checked()
def read_log(
    path: str | os.PathLike[str],
    rover: Rover,
    options: LogOptions | None = None,
    *,
    truth: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[WheelLog, AnyLog]:
    """A whole log with its truth, and the (closed) reader with its findings.

    Raises
    ------
    TableError
        If log or truth cannot be used.
    """
    path, options = Path(path), options or LogOptions()
    session = str(path.parent)
    with open_log(path, rover, options) as log:
        whole = log.read(truth=truth, truth_topic=options.truth_topic, session=session, progress=progress)
    gains, scale = corrections(rover, options.wheel_encoders)
    steering = None if whole.steering is None else whole.steering * gains
    known = None if whole.truth is None else options.of_body(whole.truth)
    return replace(whole, steering=steering, wheel_angles=whole.wheel_angles * scale, truth=known), log


class WholeLog:
    """A log that is read whole, with the face of a `JointLog`.

    Parameters
    ----------
    path : Path
        What one of `READERS` reads.
    rover : Rover
        With the wheels of that log, in its order.
    kind : str
        Which of them.

    Raises
    ------
    TableError
        If the file is no such log, or of another rover.
    """

    readings: Reading = "ticks"
    origin = 0
    truth_findings: Findings | None = None

    def __init__(self, path: Path, rover: Rover, kind: str) -> None:
        self.path, self.rover = path, rover
        self.findings, self.warnings = Findings(path), list[str]()
        self.position = 0
        try:
            self._log = READERS[kind].read(path, rover)
        except TableError:
            raise
        except OSError as error:
            name = Path(error.filename or path).name
            raise TableError(f"{path}: a log of format {kind} needs its {name}: {error.strerror}") from None
        except ValueError as error:
            raise TableError(f"{path}: not a readable log of format {kind}: {error}") from None
        if self._log.wheel_angles.shape[1] != len(rover.wheels):
            wheels, found = len(rover.wheels), self._log.wheel_angles.shape[1]
            raise TableError(f"{path}: the log must have {wheels} wheels, as the rover has, got {found}")
        self.size = len(self._log)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """The file is closed already."""

    @property
    def has_gyroscope(self) -> bool:
        """True if rows have yaw rates."""
        return self._log.yaw_rate is not None

    def chunks(self, chunk_rows: int = 200_000) -> Iterator[JointRows]:
        """The rows in order, at most `chunk_rows` at a time."""
        log, truth = self._log, self._log.truth
        for start in range(0, len(log), chunk_rows):
            part = slice(start, start + chunk_rows)
            rows = np.arange(start, min(start + chunk_rows, len(log))) + 1
            poses = None if truth is None else truth.poses
            some = [None if each is None else each[part] for each in (log.steering, poses, log.yaw_rate)]
            self.position = int(rows[-1])
            yield JointRows(rows, log.stamps[part], some[0], log.wheel_angles[part], *some[1:])

    def read(self, *, truth: Path | None = None, truth_topic: str | None = None, **_: Any) -> WheelLog:
        """The whole run, with its own truth unless another is given."""
        self.position, log = self.size, self._log
        if truth is not None:
            stamps, poses, self.truth_findings = read_truth(truth, topic=truth_topic)
            log = replace(log, truth=GroundTruth(stamps, poses))
        return log


def example_run() -> Path:
    """The run that comes with this package; see logs/data/README.md."""
    return optiodom.runs(Path(str(resources.files("six_wheel.logs") / "data" / "optiodom")))[0]
