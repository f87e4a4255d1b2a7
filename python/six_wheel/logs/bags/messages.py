"""A bag of ROS 2 (MCAP or sqlite3) or ROS 1: the messages of its topics. Needs rosbags."""

import contextlib
import itertools
import re
import tempfile
from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel.kinematics.errors import TableError, needed, one_line
from six_wheel.logs.bags.bag_files import files_of, whole_part
from six_wheel.logs.headers.columns import TIME_UNITS
from six_wheel.logs.plausibility.findings import Findings
from six_wheel.logs.skip_bad_rows import Batch
from six_wheel.robot_description.doubts import Option
from six_wheel.robot_description.missing_files import no_file

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader

TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")  # the other one of ROS 1, from before tf2
OWN_FRAMES = ("base_footprint", "base_link")  # of a rover, where nothing else is asked for
POSES = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "geometry_msgs/msg/TransformStamped",
)
LOOK_AHEAD = 1000  # messages in which to look for the joints
LINE = 0  # messages have no line
JOINT_STATE = "sensor_msgs/msg/JointState"
# Types of messages that hold readings of wheels, with the field of the number.
NUMBERS = re.compile(
    r"std_msgs/msg/(?:Float32|Float64|Int8|Int16|Int32|Int64|UInt8|UInt16|UInt32|UInt64)(MultiArray)?"
)
FIELDS = {
    "SensorState": (".left_encoder", ".right_encoder"),
    "WheelEncoderStamped": (".data",),
    "AckermannDrive": (".speed", ".steering_angle"),
    "AckermannDriveStamped": (".drive.speed", ".drive.steering_angle"),
}


def numbers_in(connections: Sequence[Any]) -> tuple[str, ...]:
    """Parts of a proposal to read topics with numbers as wheels; nothing if there are none."""
    keys = []
    for one in connections:
        if found := NUMBERS.fullmatch(one.msgtype):
            keys += [one.topic + place for place in (("[0]", "[1]") if found[1] else ("",))]
        else:
            keys += [one.topic + field for field in FIELDS.get(one.msgtype.rpartition("/")[2], ())]
    if not keys:
        return ()
    options = " ".join(f'--topic "{key}=WHEEL [UNIT]"' for key in keys[:4])
    python = ", ".join(f'"{key}": "WHEEL [UNIT]"' for key in keys[:4])
    unit = "UNIT one of rad, ticks, rad/s, m/s; of a steering angle WHEEL_steering [rad]"
    rest = f", or topics: {{{python}}} in the parameter file, {unit}"
    return "; numbers can be read: give ", Option(options), rest


class Bag:
    """A bag on disk, open for reading the messages of some topics. Raises `TableError` if it cannot be read.
    Raises `ModuleNotFoundError` if rosbags is not installed."""

    time_unit = TIME_UNITS[-1]

    def __init__(self, path: Path) -> None:
        self.path = path
        self.findings = Findings(path)
        self.position = 0
        self.topic = ""  # of the message that was read last
        self._topics: list[Any] = []
        self._cut_off = False
        with contextlib.ExitStack() as self._files:
            self._reader = self._open()
            self._files = self._files.pop_all()  # they stay open

    def _open(self) -> "AnyReader":
        """A reader of the bag, or of what is whole of it."""
        with needed("six-wheel[bags]", "bags need"):
            from rosbags.highlevel import AnyReader
            from rosbags.typesys import Stores, get_typestore

        def reader(paths: Sequence[Path]) -> AnyReader:
            opened = AnyReader(paths, default_typestore=get_typestore(Stores.LATEST))
            opened.open()
            self._files.callback(opened.close)
            return opened

        if not self.path.exists():
            raise TableError(no_file(self.path))
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
        self._cut_off, folder = True, Path(self._files.enter_context(tempfile.TemporaryDirectory()))
        try:
            return reader([whole_part(file, folder) for file in files])
        except Exception:
            raise refused from None

    def close(self) -> None:
        """Close the files."""
        self._files.close()

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
        kinds = ", ".join(each.rpartition("/")[2] for each in types)
        if not there:
            listed = ", ".join(f"{c.topic} ({c.msgtype.rpartition('/')[2]})" for c in every[:12]) or "none"
            hint = numbers_in(every) if types == [JOINT_STATE] else ()
            self.close()
            none = f"no topic has messages of the type {kinds}; the bag has {listed}"
            raise TableError(f"{self.path}: {none}", *hint)
        # A recorder of everything lists topics on which nothing came.
        spoken = {c.topic for c in there if c.msgcount} or {c.topic for c in there}
        names = sorted({c.topic for c in there} if topics else spoken)
        wanted = set(topics or [])
        if topics is None:
            wanted = set(names) if len(names) == 1 else {n for n in names if usual and n.endswith(usual)}
        unknown = sorted(wanted - set(names))
        if unknown or not wanted:
            listed = ", ".join(names) or "none"
            option = "--truth-topic" if types == POSES else "--topic"
            got = unknown[0] if unknown else f"no choice (say which with {option})"
            self.close()
            raise TableError(f"{self.path}: the topic must be one of {listed} ({kinds}), got {got}")
        self._topics = [c for c in there if c.topic in wanted]

    @property
    def duration(self) -> float:
        """From the first message to the last [s]."""
        return float(self._reader.duration or 0) * 1e-9

    @property
    def connections(self) -> Sequence[Any]:
        """Topics with their types."""
        return self._reader.connections

    def read_topics(self, topics: Collection[str]) -> None:
        """From here on `messages` are those of these topics."""
        self._topics = [c for c in self.connections if c.topic in topics]

    def transforms(self) -> Iterator[Any]:
        """Transforms of every chain: the static ones first, then messages until all moving ones are known."""
        kept = self._topics
        there = sorted({c.topic for c in self.connections if c.msgtype in TRANSFORMS and c.msgcount})
        for topic in sorted(there, key=lambda name: (not name.endswith("static"), name)):
            self.read_topics({topic})
            for _, _, message in itertools.islice(self.messages(), LOOK_AHEAD):
                yield from message.transforms
        self._topics = kept

    def batched(
        self, rows: Iterable[tuple[int, int, Sequence[float]]], names: Sequence[str], chunk_rows: int
    ) -> Iterator[Batch]:
        """Batches of rows: the number of the message, a stamp and the values of these names."""
        waiting = iter(rows)
        while piece := list(itertools.islice(waiting, chunk_rows)):
            numbers, stamps, values = (np.array(column) for column in zip(*piece, strict=True))
            columns = dict(zip(names, values.astype(float).T, strict=True))
            self.position = int(numbers[-1])
            yield Batch(numbers, np.full(len(piece), LINE), stamps, columns)

    def messages(self) -> Iterator[tuple[int, int, Any]]:
        """Number from 1, stamp [ns] and content of every message; its own stamp, or when it was received."""
        number = 0
        try:
            for connection, received, data in self._reader.messages(self._topics):
                number += 1
                self.topic = connection.topic
                try:
                    message: Any = self._reader.deserialize(data, connection.msgtype)
                except Exception as error:  # struct.error and IndexError among them
                    self.findings.add(number, f"the message must be readable, got: {one_line(error)}")
                    continue
                if connection.msgtype in TRANSFORMS:  # the stamps are inside the message
                    yield number, received, message
                    continue
                header = getattr(message, "header", None)
                stamp = 0 if header is None else header.stamp.sec * 1_000_000_000 + header.stamp.nanosec
                yield number, stamp or received, message
        except Exception as error:
            self.findings.add(number + 1, f"the rest of the bag cannot be read: {one_line(error)}")
        else:
            if self._cut_off:
                self.findings.add(number + 1, "the recording was cut off here")
