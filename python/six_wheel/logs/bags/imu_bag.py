"""The gyroscope of a bag: angular velocities of ``sensor_msgs/Imu``, and the way it is mounted."""

from collections.abc import Iterator, Sequence

import numpy as np

from six_wheel.logs.bags.messages import Bag
from six_wheel.logs.gyroscope.links import Links
from six_wheel.logs.gyroscope.rates import RATES
from six_wheel.logs.headers.columns import TableError
from six_wheel.logs.skip_bad_rows import Batch


class RateBag:
    """The gyroscope of a bag: angular velocities of one topic of sensor_msgs/Imu.

    Parameters
    ----------
    bag : Bag
        Open; it is closed with this.
    topic : str, optional
        The topic to read, where there are several.
    frames : sequence of str
        Possible names of the rover's own frame.

    Attributes
    ----------
    up : ndarray, shape (3,), or None
        The rover's z in the axes of the sensor, where transforms in the bag tell it.
    others : sequence of str
        Topics that might be meant, where there are several and none was asked for.
    """

    IMU = "sensor_msgs/msg/Imu"

    def __init__(self, bag: Bag, topic: str | None, frames: Sequence[str]) -> None:
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
