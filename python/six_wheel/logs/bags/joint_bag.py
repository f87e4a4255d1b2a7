"""Bags of ROS 2, MCAP or sqlite3, and of ROS 1: joint states and poses. Needs rosbags.

Joints come in any order, in messages of their own, with positions or velocities. A row is made for every
message of the first wheel that has any; what comes in other messages is interpolated between the two around.
"""

import itertools
import math
import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.descriptions.joint_names import said_by
from six_wheel.logs.bag_files import files_of, one_line, rosbags_names, whole_part
from six_wheel.logs.columns import TIME_UNITS, TableError
from six_wheel.logs.joint_columns import Reading, did_you_mean
from six_wheel.logs.tolerant import Batch, Findings

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader

JOINT_STATE = "sensor_msgs/msg/JointState"
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")  # the other one of ROS 1, from before tf2
OWN_FRAMES = ("base_footprint", "base_link")  # of a rover, where nothing else is asked for
POSES = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "geometry_msgs/msg/TransformStamped",
)
LONGEST_GAP = 500_000_000  # [ns] between two messages of a joint, across which it is not interpolated
LOOK_AHEAD = 1000  # messages in which to look for the joints
LINE = 0  # messages have no line
MAX_FRAMES = 16  # between a rover and the top of its chain, which might be a circle


class Bag:
    """A bag on disk, open for reading the messages of some topics.

    Raises
    ------
    TableError
        If it cannot be read.
    ModuleNotFoundError
        If rosbags is not installed.
    """

    time_unit = TIME_UNITS[-1]

    def __init__(self, path: Path) -> None:
        self.path = path
        self.findings = Findings(path)
        self.position = 0
        self._topics: list[Any] = []
        self._whole: tempfile.TemporaryDirectory[str] | None = None
        rosbags = rosbags_names()
        try:
            self._reader = self._open(rosbags)
        except BaseException:
            self._forget()
            raise

    def _open(self, rosbags: Any) -> "AnyReader":
        """A reader of the bag, or of what is whole of it."""
        store = rosbags.get_typestore(rosbags.Stores.LATEST)

        def reader(paths: Sequence[Path]) -> "AnyReader":
            opened: AnyReader = rosbags.AnyReader(paths, default_typestore=store)
            opened.open()
            return opened

        if not self.path.exists():
            raise TableError(f"{self.path}: no such file")
        files = files_of(self.path)
        # The index of a folder is written when the recorder stops; the files serve without.
        bags = files if self.path.is_dir() and not (self.path / "metadata.yaml").exists() else [self.path]
        if not bags:
            raise TableError(
                f"{self.path}: the folder must hold metadata.yaml or .mcap or .db3 files, got none"
            )
        try:
            return reader(bags)
        except Exception as error:  # sqlite, YAML and zstd have their own, and a cut file meets all of them
            refused = TableError(f"{self.path}: not a readable bag: {one_line(error)}")
        self._whole = tempfile.TemporaryDirectory()
        try:
            return reader([whole_part(file, Path(self._whole.name)) for file in files])
        except Exception:
            raise refused from None

    def close(self) -> None:
        """Close the files."""
        self._reader.close()
        self._forget()

    def _forget(self) -> None:
        if self._whole is not None:
            self._whole.cleanup()

    @property
    def size(self) -> int:
        """Messages to read; `position` of them have been."""
        return sum(connection.msgcount for connection in self._topics)

    def _choose(self, types: Sequence[str], topics: Sequence[str] | None, usual: str = "") -> None:
        """The topics to read: those asked for, or the only one, or all that end as usual."""
        every = self._reader.connections
        there = [c for c in every if c.msgtype in types]
        if topics and types == POSES:
            there += [c for c in every if c.msgtype in TRANSFORMS]
        if not there:
            kinds = ", ".join(each.rpartition("/")[2] for each in types)
            listed = ", ".join(f"{c.topic} ({c.msgtype.rpartition('/')[2]})" for c in every[:12]) or "none"
            self.close()
            raise TableError(f"{self.path}: no topic has messages of the type {kinds}; the bag has {listed}")
        # A recorder of everything lists topics on which nothing came.
        spoken = {c.topic for c in there if c.msgcount} or {c.topic for c in there}
        names = sorted({c.topic for c in there} if topics else spoken)
        wanted = set(topics or [])
        if topics is None:
            wanted = set(names) if len(names) == 1 else {n for n in names if usual and n.endswith(usual)}
        unknown = sorted(wanted - set(names))
        if unknown or not wanted:
            kinds = ", ".join(each.rpartition("/")[2] for each in types)
            listed = ", ".join(names) or "none"
            option = "--truth-topic" if types == POSES else "--topic"
            got = unknown[0] if unknown else f"no choice (say which with {option})"
            self.close()
            raise TableError(f"{self.path}: the topic must be one of {listed} ({kinds}), got {got}")
        self._topics = [c for c in there if c.topic in wanted]

    @property
    def connections(self) -> Sequence[Any]:
        """Topics with their types."""
        return self._reader.connections

    def read_topics(self, topics: Collection[str]) -> None:
        """From here on `messages` are those of these topics."""
        self._topics = [c for c in self.connections if c.topic in topics]

    def transforms(self) -> Iterator[Any]:
        """Those of every chain, the lasting ones first, then of as many messages as tell all that move."""
        kept = self._topics
        there = sorted({c.topic for c in self.connections if c.msgtype in TRANSFORMS and c.msgcount})
        for topic in sorted(there, key=lambda name: (not name.endswith("static"), name)):
            self.read_topics({topic})
            for _, _, message in itertools.islice(self.messages(), LOOK_AHEAD):
                yield from message.transforms
        self._topics = kept

    def messages(self) -> Iterator[tuple[int, int, Any]]:
        """Number from 1, stamp [ns] and content of every message; its own stamp, or when it was received."""
        number = 0
        try:
            for connection, received, data in self._reader.messages(self._topics):
                number += 1
                try:
                    message: Any = self._reader.deserialize(data, connection.msgtype)
                except Exception as error:  # struct.error and IndexError among them
                    self.findings.add(number, f"the message must be readable, got: {one_line(error)}")
                    continue
                if connection.msgtype in TRANSFORMS:  # which has stamps inside
                    yield number, received, message
                    continue
                stamp = message.header.stamp
                yield number, (stamp.sec * 1_000_000_000 + stamp.nanosec) or received, message
        except Exception as error:
            self.findings.add(number + 1, f"the rest of the bag cannot be read: {one_line(error)}")
        else:
            if self._whole is not None:
                self.findings.add(number + 1, "the recording was cut off here")


class JointBag(Bag):
    """The joint states of a rover in a bag.

    Parameters
    ----------
    path : Path
        A folder with metadata.yaml, a .mcap or .db3 file.
    rover : Rover
    reading : {"angle", "speed"}, optional
        What to take of the wheels where both are there; angles without it.
    topics : sequence of str, optional

    Attributes
    ----------
    names : list of str
        ``"steering NAME"`` and ``"wheel NAME"`` of what is in the bag.
    reading : {"angle", "speed"}
    """

    def __init__(
        self, path: Path, rover: Rover, reading: Reading | None = None, topics: Sequence[str] | None = None
    ) -> None:
        super().__init__(path)
        self._choose([JOINT_STATE], topics, usual="joint_states")
        self._joints = {wheel: f"wheel {wheel}" for wheel in rover.wheel_names}
        self._joints |= {joint: f"wheel {wheel}" for joint, wheel in rover.traction_joints.items()}
        self._joints |= {joint: f"steering {wheel}" for joint, wheel in rover.steering_joints.items()}
        self._turned = frozenset(rover.reversed_joints)
        try:
            self.reading = self._look(rover, reading)
        except BaseException:
            self.close()
            raise

    def _look(self, rover: Rover, reading: Reading | None) -> Reading:
        """Which joints there are, and what is known of every wheel."""
        kinds: dict[str, set[Reading]] = {}
        strangers: dict[str, None] = {}
        for number, _, message in self.messages():
            for joint, position, velocity in self._states(message):
                if (name := self._joints.get(joint)) is None:
                    strangers[joint] = None
                    continue
                known = kinds.setdefault(name, set())
                known |= {"angle"} if math.isfinite(position) else set()
                known |= {"speed"} if math.isfinite(velocity) else set()
            lacking = [j for j, wheel in rover.steering_joints.items() if not kinds.get(f"steering {wheel}")]
            if number >= LOOK_AHEAD and not lacking:
                break
        self.findings = Findings(self.path)  # all of it is read again
        listed = ", ".join([*(j for j, name in self._joints.items() if name in kinds), *strangers]) or "none"
        for joint, wheel in rover.steering_joints.items():
            if "angle" not in kinds.get(f"steering {wheel}", ()):
                hint = did_you_mean([joint], _like_wheels(strangers))
                raise TableError(f"{self.path}: no position of joint {joint} among {listed}{hint}")
        wheels = {name: known for name, known in kinds.items() if name.startswith("wheel ") and known}
        if not wheels:
            joints = ", ".join(rover.traction_joints)
            hint = did_you_mean([*rover.traction_joints], _like_wheels(strangers))
            raise TableError(f"{self.path}: no joint of any wheel ({joints}) among {listed}{hint}")
        self.names = [name for name in dict.fromkeys(self._joints.values()) if kinds.get(name)]
        choices: tuple[Reading, ...] = ("angle", "speed") if reading is None else (reading,)
        for choice in choices:
            if all(choice in known for known in wheels.values()):
                return choice
        raise TableError(
            f"{self.path}: wheels must be read in one way, all as {' or '.join(choices)}, got "
            + ", ".join(f"{name} ({' and '.join(sorted(known))})" for name, known in wheels.items())
        )

    def _states(self, message: Any) -> Iterator[tuple[str, float, float]]:
        """Joint, position and velocity; NaN for what the message leaves out."""
        try:
            names = [str(name) for name in message.name]
            positions, velocities = message.position.tolist(), message.velocity.tolist()
        except (AttributeError, TypeError):  # bags bring the definitions of their messages along
            rule = "joint states must have names, positions and velocities, which this bag's have not"
            raise TableError(f"{self.path}: {rule}") from None
        nothing = [math.nan] * len(names)
        positions, velocities = (
            values if len(values) == len(names) else nothing for values in (positions, velocities)
        )
        return zip(names, positions, velocities, strict=True)

    def batches(self, chunk_rows: int) -> Iterator[Batch]:
        """Rows at the messages of the first wheel, numbered as those messages are."""
        series = {name: _Series() for name in self.names}
        first = next(name for name in self.names if name.startswith("wheel "))
        for number, stamp, message in self.messages():
            self.position = number
            for joint, position, velocity in self._states(message):
                if (name := self._joints.get(joint)) in series:
                    speed = name.startswith("wheel ") and self.reading == "speed"
                    value = velocity if speed else position
                    flaw = series[name].add(number, stamp, -value if joint in self._turned else value)
                    if flaw and name == first:
                        self.findings.add(*flaw)
            if len(series[first].stamps) > chunk_rows and number % chunk_rows == 0:
                yield from self._rows(series, first, last=False)
        yield from self._rows(series, first, last=True)

    def _rows(self, series: "Mapping[str, _Series]", first: str, last: bool) -> Iterator[Batch]:
        pivot = series[first]
        # The newest message of a joint may yet turn out to run ahead. A joint that has been silent for longer
        # than can be interpolated is not waited for.
        silent = pivot.stamps[-2] - 2 * LONGEST_GAP if len(pivot.stamps) > 1 else 0
        ends = [each.stamps[-2] if len(each.stamps) > 1 else 0 for each in series.values()]
        horizon = math.inf if last else max(min(ends), silent)
        count = int(np.searchsorted(np.array(pivot.stamps, dtype=np.int64), horizon, side="right"))
        if not count:
            return
        rows = np.array(pivot.numbers[:count], dtype=np.int64)
        stamps = np.array(pivot.stamps[:count], dtype=np.int64)
        values = {name: each.at(stamps) for name, each in series.items()}
        for each in series.values():
            each.forget(int(stamps[-1]), keep=each is not pivot)
        yield Batch(rows, np.full(count, LINE), stamps, values)


class _Series:
    """What one joint said, as far as it is still needed."""

    def __init__(self) -> None:
        self.numbers: list[int] = []
        self.stamps: list[int] = []
        self._values: list[float] = []
        self._forgotten: float = -math.inf  # the stamp of the last value that was dropped

    def add(self, number: int, stamp: int, value: float) -> tuple[int, str, str] | None:
        """Take in a value; the message that is left out, if one is, and why."""
        if not math.isfinite(value):
            return number, "every joint must have a finite value", f", got {value}"
        flaw = None
        if self.stamps and stamp <= self.stamps[-1]:
            before = self.stamps[-2] if len(self.stamps) > 1 else self._forgotten
            if stamp <= before or stamp == self.stamps[-1]:
                return number, "stamps must increase", f", got {stamp} ns after {self.stamps[-1]} ns"
            ahead = self.stamps.pop()
            flaw = self.numbers.pop(), "stamps must not run ahead", f", got {ahead} ns before {stamp} ns"
            self._values.pop()
        self.numbers.append(number)
        self.stamps.append(stamp)
        self._values.append(value)
        return flaw

    def at(self, stamps: NDArray[np.int64]) -> NDArray[np.float64]:
        """Values at other stamps, straight from message to message; NaN across gaps and beyond the ends."""
        result = np.full(len(stamps), np.nan)
        if not self.stamps:
            return result
        own, values = np.array(self.stamps, dtype=np.int64), np.array(self._values)
        after = np.minimum(np.searchsorted(own, stamps), len(own) - 1)
        exact = own[after] == stamps
        result[exact] = values[after[exact]]
        before = after - 1
        step = own[after] - own[before]
        inside = ~exact & (after > 0) & (own[after] > stamps) & (step <= LONGEST_GAP)
        b, a = before[inside], after[inside]
        part = (stamps[inside] - own[b]) / step[inside]
        result[inside] = values[b] + part * (values[a] - values[b])
        return result

    def forget(self, stamp: int, keep: bool) -> None:
        """Drop what is up to `stamp`; `keep` the last of it, to interpolate from."""
        count = int(np.searchsorted(np.array(self.stamps, dtype=np.int64), stamp, side="right"))
        count = max(count - keep, 0)
        if count:
            self._forgotten = self.stamps[count - 1]
            del self.numbers[:count], self.stamps[:count], self._values[:count]


class TruthBag(Bag):
    """Poses in a bag: odometry, stamped poses or transforms of one topic.

    Parameters
    ----------
    path : Path
    topic : str, optional
        Which. Transforms of many frames (``/tf``) have to be asked for, and may name the frame of the rover
        behind a colon: ``/tf:base_link``. Its pose is that in the frame at the top of its chain.
    """

    def __init__(self, path: Path, topic: str | None = None) -> None:
        super().__init__(path)
        name, _, frame = (topic or "").partition(":")
        self._frames = (frame.lstrip("/"),) if frame else OWN_FRAMES
        self._tree: dict[str, tuple[str, Any]] = {}
        self._choose(POSES, None if topic is None else [name], usual="truth")

    def batches(self, chunk_rows: int) -> Iterator[Batch]:
        """A row for every message."""
        names = ("x", "y", "qx", "qy", "qz", "qw")
        numbers: list[int] = []
        stamps: list[int] = []
        rows: list[tuple[float, ...]] = []

        def batch() -> Batch:
            columns = np.array(rows, dtype=float).reshape(-1, len(names)).T
            values = dict(zip(names, columns, strict=True))
            made = Batch(
                np.array(numbers), np.full(len(rows), LINE), np.array(stamps, dtype=np.int64), values
            )
            for each in (numbers, stamps, rows):
                each.clear()
            return made

        for number, stamp, message in self.messages():
            self.position = number
            found = [(stamp, _pose(message))] if not hasattr(message, "transforms") else self._moved(message)
            for when, pose in found:
                numbers.append(number)
                stamps.append(when)
                rows.append(pose)
            if len(rows) >= chunk_rows:
                yield batch()
        if rows:
            yield batch()

    def _moved(self, message: Any) -> list[tuple[int, tuple[float, ...]]]:
        """Stamps and poses of the rover that transforms tell, through the frames known so far."""
        found = []
        for each in message.transforms:
            frame, parent = (str(name).lstrip("/") for name in (each.child_frame_id, each.header.frame_id))
            self._tree[frame] = (parent, each.transform)
            if frame not in self._frames:
                continue
            poses = list[tuple[float, float, float]]()
            while frame in self._tree and len(poses) < MAX_FRAMES:
                frame, transform = self._tree[frame]
                poses.append(_planar(transform.translation, transform.rotation))
            stamp = each.header.stamp
            found.append((stamp.sec * 1_000_000_000 + stamp.nanosec, _composed(poses)))
        return found


def _planar(p: Any, q: Any) -> tuple[float, float, float]:
    """x, y and yaw of a transform."""
    return p.x, p.y, math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def _composed(poses: Sequence[tuple[float, float, float]]) -> tuple[float, ...]:
    """A pose through frames that lie level, the innermost first, as x, y and a quaternion."""
    x = y = yaw = 0.0
    for ahead, aside, turned in poses:
        cos, sin = math.cos(turned), math.sin(turned)
        x, y, yaw = ahead + cos * x - sin * y, aside + sin * x + cos * y, turned + yaw
    return x, y, 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)


def _like_wheels(joints: Iterable[str]) -> list[str]:
    """Those of the joints whose names tell a place, as a wheel's do; all of them if none does."""
    return [joint for joint in joints if said_by(joint) is not None] or [*joints]


def _pose(message: Any) -> tuple[float, ...]:
    if hasattr(message, "transform"):
        p, q = message.transform.translation, message.transform.rotation
    else:
        pose = getattr(message.pose, "pose", message.pose)  # inside a covariance
        p, q = pose.position, pose.orientation
    return p.x, p.y, q.x, q.y, q.z, q.w
