"""A gyroscope in a table or a bag: which columns or messages it has, and how it sits."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.logs.columns import BRACKETS, TIME, Column, Quantity, TableError, find_columns, unit
from six_wheel.logs.gyroscope.links import Links
from six_wheel.logs.gyroscope.rates import ABOUT_Z, AXES, RATES, Floats, about_z
from six_wheel.logs.tolerant import Batch, Sieve, Source, TolerantTable

if TYPE_CHECKING:
    from six_wheel.logs.bags import Bag

__all__ = ["RateBag", "rate_columns", "rate_table", "readings_of"]

CHUNK = 65_536  # readings at a time

_UNITS = (
    unit("rad/s", 1.0, "rad_s radps rads rad_per_s rad_s_1 radians_per_second"),
    unit("deg/s", math.pi / 180, "deg_s degps degs dps deg_per_s deg_s_1 degrees_per_second"),
    unit("rev/s", 2 * math.pi, "rev_s revps rps rev_per_s revolutions_per_second"),
    unit("rpm", math.pi / 30, "rpm rev_min revolutions_per_minute"),
)
_YAW_RATE = ("yaw_rate", "yawrate", "imu_yaw_rate", "gyro_yaw_rate", "gyro", "gyroscope")
_AXIS = (
    "gyro_{0}",
    "gyro{0}",
    "gyroscope_{0}",
    "imu_gyro_{0}",
    "angular_velocity_{0}",
    "imu_angular_velocity_{0}",
    "imu_data_angular_velocity_{0}",
)


def rate_columns(headers: Sequence[str], field_units: Mapping[int, str] | None = None) -> dict[str, Column]:
    """The columns of a gyroscope: one about the rover's z, or else those of its axes; none without z."""
    given = field_units or {}
    stated = [
        header if BRACKETS.match(header) or index not in given else f"{header} [{given[index]}]"
        for index, header in enumerate(headers)
    ]

    def first(name: str, spellings: Sequence[str]) -> dict[str, Column]:
        for spelling in spellings:
            if found := find_columns(stated, (Quantity(name, (spelling,), _UNITS, required=False),)):
                column = found[name]
                return {name: Column(column.index, headers[column.index], column.unit, column.stated)}
        return {}

    if found := first(ABOUT_Z, _YAW_RATE):
        return found
    for form in _AXIS:
        named = [first(f"rate {axis}", (form.format(axis),)) for axis in AXES]
        if named[2]:
            return {name: column for each in named for name, column in each.items()}
    return {}


def readings_of(
    source: Source,
    stated: bool,
    seconds: Callable[[NDArray[Any]], Floats],
    up: Floats,
    keys: Mapping[str, Any],
) -> Iterator[tuple[Floats, Floats]]:
    """Stamps in the clock of the log and rates about the rover's z, from a table or a bag."""
    offset, scale = keys.get("time_offset", 0.0), keys.get("scale", 1.0)
    for batch in Sieve(source.findings, RATES, stated).pass_on(source.batches(CHUNK)):
        rates = about_z(batch.values, up)
        there = np.isfinite(rates)
        yield seconds(batch.time[there]) - offset, scale * rates[there]


def rate_table(path: Path, columns: Mapping[str, str] | None) -> TolerantTable:
    """The same table again, of which only times and the gyroscope are read."""

    def find(headers: Sequence[str], field_units: Mapping[int, str]) -> dict[str, Column]:
        return find_columns(headers, (TIME,)) | rate_columns(headers, field_units)

    return TolerantTable(path, find, columns, RATES)


class RateBag:
    """The gyroscope of a bag: angular velocities of one topic of sensor_msgs/Imu.

    Parameters
    ----------
    bag : Bag
        Open; it is closed with this.
    topic : str, optional
        Which, where there are several.
    frames : sequence of str
        What the rover's own frame may be called.

    Attributes
    ----------
    up : ndarray, shape (3,), or None
        The rover's z in the axes of the sensor, where transforms in the bag tell it.
    others : sequence of str
        Topics that might be meant, where there are several and none was asked for.
    """

    IMU = "sensor_msgs/msg/Imu"

    def __init__(self, bag: "Bag", topic: str | None, frames: Sequence[str]) -> None:
        self._bag, self.findings, self.time_unit = bag, bag.findings, bag.time_unit
        self.frame, self.up = "", None
        self.position = 0
        self.others: Sequence[str] = ()
        self.topic = self._chosen(topic)
        if self.topic is not None:
            bag.read_topics({self.topic})
            self.frame = next((str(m.header.frame_id) for _, _, m in bag.messages()), "").lstrip("/")
            links = Links(frames)
            if not links.owns(self.frame):
                links.add(bag.transforms())
            self.up = links.up(self.frame)
            bag.read_topics({self.topic})

    def _chosen(self, topic: str | None) -> str | None:
        """The topic that is asked for, or the only one with angular velocities."""
        bag = self._bag
        there = sorted({c.topic for c in bag.connections if c.msgtype == self.IMU and c.msgcount})
        if topic is not None:
            if topic not in there:
                listed = ", ".join(there) or "none"
                raise TableError(f"{bag.path}: gyroscope.topic must be one of {listed} (Imu), got {topic}")
            return topic
        telling = []
        for name in there:
            bag.read_topics({name})
            first = next((message for _, _, message in bag.messages()), None)
            # By REP 145 a first covariance of -1 says that there is no such measurement.
            if first is not None and first.angular_velocity_covariance[0] != -1.0:
                telling.append(name)
        if len(telling) > 1:
            self.others = telling
        return telling[0] if len(telling) == 1 else None

    @property
    def size(self) -> int:
        """Messages to read."""
        return self._bag.size

    def close(self) -> None:
        """Close the files."""
        self._bag.close()

    def batches(self, chunk_rows: int) -> Iterator[Batch]:
        """Readings in the order of their messages."""
        numbers: list[int] = []
        stamps: list[int] = []
        rates: list[tuple[float, float, float]] = []

        def batch() -> Batch:
            columns = dict(zip(RATES[1:], np.array(rates, dtype=float).T, strict=True))
            made = Batch(np.array(numbers), np.zeros(len(rates), np.int64), np.array(stamps), columns)
            for each in (numbers, stamps, rates):
                each.clear()
            return made

        for number, stamp, message in self._bag.messages():
            self.position = number
            rate = message.angular_velocity
            numbers.append(number)
            stamps.append(stamp)
            rates.append((rate.x, rate.y, rate.z))
            if len(rates) >= chunk_rows:
                yield batch()
        if rates:
            yield batch()
