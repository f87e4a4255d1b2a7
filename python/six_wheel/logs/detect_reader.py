"""Any log that the command line reads, by what the file is: a table, a ROS 2 bag, or what `READERS` read.

A format of one's own is a function that makes a `WheelLog` and its entry in `READERS`, as for OptiOdom runs.
"""

import os
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from six_wheel._core import Rover
from six_wheel.kinematics.errors import SuspiciousReadingsWarning, TableError, as_path
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.objects.closing import Closing
from six_wheel.logs import optiodom
from six_wheel.logs.bags.bag_files import BAGS, is_bag
from six_wheel.logs.datasets import katwijk, rose_lab
from six_wheel.logs.frames.tabular_input import is_table, table, whole
from six_wheel.logs.ground_truth import read_truth
from six_wheel.logs.headers.joint_columns import Reading
from six_wheel.logs.headers.time_columns import in_seconds, scale_of
from six_wheel.logs.joint_sources import JointSource, refuse_counts
from six_wheel.logs.joint_totals import Encoders, JointRows
from six_wheel.logs.joints import JointLog
from six_wheel.logs.log_options import LogOptions, corrections, encoders_of, encoders_or_keys
from six_wheel.logs.plausibility.arrays import check_log
from six_wheel.logs.plausibility.findings import Findings
from six_wheel.logs.plausibility.proposals import ImplausibleReadingError
from six_wheel.logs.recordings import GroundTruth, WheelLog
from six_wheel.logs.tables import FORMATS, READ
from six_wheel.logs.text.foreign import other_form
from six_wheel.robot_description.missing_files import no_file

ENDINGS = ", ".join(dict.fromkeys([*FORMATS, *BAGS, *READ]))
AnyLog: TypeAlias = "JointLog | WholeLog"


@dataclass(frozen=True)
class Reader:
    """A log format that is read whole."""

    # A path is such a log; asked before tables and bags are thought of.
    claims: Callable[[Path], bool]
    # From the path and the rover to a `WheelLog` in the rover's order, with its truth if it has one. Its
    # `ValueError` or `OSError` becomes the one line of the command, its warnings those of the log.
    read: Callable[[Path, Rover], WheelLog]
    # A path in a folder belongs to such a log, and is none by itself.
    belongs: Callable[[Path], bool] = lambda path: False


READERS: dict[str, Reader] = {
    "optiodom": Reader(optiodom.claims, optiodom.read_for, lambda path: "_metadata" in path.stem),
    "katwijk": Reader(katwijk.claims, katwijk.read, katwijk.belongs),
    "rose_lab": Reader(rose_lab.claims, rose_lab.read, rose_lab.belongs),
}


def log_formats() -> tuple[str, ...]:
    """Names of all formats."""
    return ("table", "bag", *READERS)


def log_format(path: Path) -> str:
    """Format of a log, by its ending and the files beside it. Raises `TableError` if nothing here reads such
    a file."""
    if not path.exists():
        raise TableError(no_file(path))
    for name, reader in READERS.items():
        if reader.claims(path):
            return name
    if is_bag(path):
        return "bag"
    if path.suffix.lower() in READ:
        return "table"
    rule = f'a log must be a bag\'s folder or end in {ENDINGS}, got "{path.suffix}"'
    raise TableError(f"{path}: {rule}; {other_form(path.suffix.lower())}")


def logs_in(paths: Sequence[Path]) -> list[Path]:
    """Logs as they are, and of folders that are no bag every log inside, in the order of their names. Raises
    `TableError` if a folder holds none."""
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
    named = path.suffix.lower() in {*READ, *BAGS} or any(one.claims(path) for one in READERS.values())
    part = inside_bag or path.name.startswith(".") or any(one.belongs(path) for one in READERS.values())
    return named and not part


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
        return WholeLog(path, rover, kind, plausibility=options.plausibility)
    if is_bag(path) != (kind == "bag"):
        tables = " or ".join(READ)
        form = "a folder or .mcap or .db3 file" if kind == "bag" else f"a file ending in {tables}"
        raise TableError(f"{path}: the format {kind} is {form}")
    return _joint_log(path, rover, options)


def _joint_log(path: Path, rover: Rover, options: LogOptions) -> JointLog:
    """A joint log whose readings the encoders of the options make angles, as far as they are meant for it.

    The headers tell counts from radians: encoders with ticks per turn are for counts, others for radians.
    Messages have no units: there `ticks_per_turn` says that they are counts.
    """
    source = JointSource(path, rover, options)
    counts = {"wheel": source.readings == "ticks", "steering": bool(source.counted)}
    found: dict[str, Encoders] = {}
    try:
        for part, given in (("wheel", options.wheel_encoders), ("steering", options.steering_encoders)):
            found[part], keys = encoders_or_keys(f"{part}_encoders", given)
            if found[part] is not None:
                continue
            counted = "ticks_per_turn" in keys
            if counts[part] and not counted:
                refuse_counts(source, part, options.wheel_keys if part == "wheel" else keys)
            # Speeds are those of the joints: of wheels there is nothing to count, nor are angles turned.
            meant = counts[part] or source.bagged if counted else source.readings != "speeds"
            if meant and not (part == "wheel" and source.readings == "speeds"):
                found[part] = encoders_of(rover, part, keys)
    except BaseException:
        source.close()
        raise
    meant = bool(found["wheel"]) or source.readings == "angles" or options.increments is not None
    increments = options.wheel_keys.get("increments") if meant else None
    return JointLog.of_source(source, found["wheel"] or None, found["steering"] or None, increments)


def as_logs(source: Any, rover: Rover, options: LogOptions | None = None) -> list[WheelLog]:
    """Drives from what tells one, or from some of those: a `WheelLog`, the path of any that `read_log` reads,
    a table of columns. Raises `TypeError` if it is nothing of these. Raises `ValueError` if a file or a table
    cannot be used."""
    many = isinstance(source, Iterable) and not (isinstance(source, str) or is_table(source))
    logs = list(source if many else [source])
    return [_as_log(one, rover, options or LogOptions(), number) for number, one in enumerate(logs)]


def _as_log(source: Any, rover: Rover, options: LogOptions, number: int) -> WheelLog:
    if isinstance(source, WheelLog):
        return _with_options(source, rover, options, number)
    if isinstance(source, str | os.PathLike):
        return read_log(source, rover, options)[0]
    if not is_table(source):
        raise TypeError(f"logs must be Logs, paths or tables of columns, got {type(source).__name__}")
    given = _odometry_options(rover, options)
    columns, clock = options.columns or None, options.stamp_unit
    read = table(rover, source, columns, {}, given, stamp_unit=clock, plausibility=options.plausibility)
    log = whole(read)
    if read.options.get("readings") == "speeds":
        given["readings"] = "speeds"
    return WheelLog(log.stamps, log.steering, log.wheels, options=given, plausibility=False)


def _odometry_options(rover: Rover, options: LogOptions) -> dict[str, Any]:
    """Options of `Odometry` for readings in memory."""
    found = {"wheel_encoders": options.wheel_encoders, "steering_encoders": options.steering_encoders}
    given: dict[str, Any] = {}
    for (name, values), part in zip(found.items(), ("wheel", "steering"), strict=True):
        direct, keys = encoders_or_keys(name, values)
        if encoders := direct or encoders_of(rover, part, keys):
            given[name] = encoders
    if options.wheel_keys.get("increments"):
        given["increments"] = True
    if options.readings == "speeds":
        given["readings"] = options.readings
    return given


def _with_options(log: WheelLog, rover: Rover, options: LogOptions, number: int) -> WheelLog:
    """A log in memory with what is said of it; readings that no rover has are refused."""
    given, stamps = _odometry_options(rover, options), log.stamps
    if options.stamp_unit is not None:
        stamps = in_seconds(stamps, scale_of(options.stamp_unit))
    if given or stamps is not log.stamps:
        log = replace(log, stamps=stamps, options={**log.options, **given})
    if options.plausibility and log.plausibility:
        try:
            stated = options.stamp_unit is not None
            check_log(log, rover, clock_stated=stated, judged_later=log.truth is not None)
        except ImplausibleReadingError as error:
            raise ValueError(f"logs[{number}]: {error}") from None
    return log


@checked(LogOptions)
def read_log(
    path: str | os.PathLike[str],
    rover: Rover,
    options: LogOptions | None = None,
    *,
    truth: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
    **how: Any,
) -> tuple[WheelLog, AnyLog]:
    """A whole log with its truth, and the (closed) reader with its findings.

    Parameters
    ----------
    path : path-like
    rover : Rover
    options : LogOptions, optional
    truth : Path, optional
        File of the truth, if the log does not have it.
    progress : callable, optional
        Called after every chunk with how far it is and how far it will go.
    **how
        Options by their names: `columns`, `wheel_encoders`, `steering_encoders`, `increments`, `topics`,
        `stamp_unit`, `plausibility`, `max_speed` and others of `LogOptions`.

    Raises
    ------
    TableError
        If log or truth cannot be used.
    """
    path, options = as_path("path", path), replace(options or LogOptions(), **how)
    session = str(path.parent)
    with open_log(path, rover, options) as log:
        whole = log.read(truth=truth, truth_topic=options.truth_topic, session=session, progress=progress)
    gains, scale = corrections(rover, options.wheel_keys)
    steering = None if whole.steering is None else whole.steering * gains
    known = None if whole.truth is None else options.of_body(whole.truth)
    angles = whole.wheel_angles * scale
    return replace(whole, steering=steering, wheel_angles=angles, truth=known, rover=rover), log


class WholeLog(Closing):
    """A log that is read whole by the one of `READERS` called `kind`, with the face of a `JointLog`.

    Raises `TableError` if the file is no such log, or its wheels are not those of the rover.
    """

    readings: Reading = "ticks"
    origin = position = 0
    truth_findings: Findings | None = None

    def __init__(self, path: Path, rover: Rover, kind: str, *, plausibility: bool = True) -> None:
        self.path, self.rover, self.findings = path, rover, Findings(path)
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", SuspiciousReadingsWarning)
                self._log = log = READERS[kind].read(path, rover)
                check_log(log, rover, clock_stated=True, units_stated=True) if plausibility else None
            self.warnings = [str(each.message) for each in caught]
        except TableError:
            raise
        except OSError as error:
            name = Path(error.filename or path).name
            raise TableError(f"{path}: a log of format {kind} needs its {name}: {error.strerror}") from None
        except ValueError as error:
            raise TableError(f"{path}: not a readable log of format {kind}: ", error) from None
        if self._log.wheel_angles.shape[1] != len(rover.wheels):
            wheels, found = len(rover.wheels), self._log.wheel_angles.shape[1]
            raise TableError(f"{path}: the log must have {wheels} wheels, as the rover has, got {found}")
        self.size = len(self._log)

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
