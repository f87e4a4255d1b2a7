"""The gyroscope of a bag: angular velocities of ``sensor_msgs/Imu``, and the way it is mounted."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from six_wheel.kinematics.errors import TableError
from six_wheel.logs.bags.messages import Bag
from six_wheel.logs.gyroscope.links import Links
from six_wheel.logs.headers.rate_columns import RATES
from six_wheel.logs.skip_bad_rows import Batch


class RateBag(Bag):
    """The gyroscope of a bag: angular velocities of one topic of sensor_msgs/Imu.

    `topic` is the one to read, where there are several, `frames` are possible names of the rover's own frame.
    """

    IMU = "sensor_msgs/msg/Imu"

    def __init__(self, path: Path, topic: str | None, frames: Sequence[str]) -> None:
        super().__init__(path)
        self.frame, self.up = "", None  # of the sensor; the rover's z in its axes, by transforms of the bag
        self.others: Sequence[str] = ()  # topics that might be meant
        try:
            self.rate_topic = self._chosen(topic)
            if self.rate_topic is None:
                return
            self.read_topics({self.rate_topic})
            self.frame = next((str(m.header.frame_id) for _, _, m in self.messages()), "").lstrip("/")
            links = Links(frames)
            if not links.owns(self.frame):
                links.add(self.transforms())
            self.up = links.up(self.frame)
            self.read_topics({self.rate_topic})
        except BaseException:
            self.close()
            raise

    def _chosen(self, topic: str | None) -> str | None:
        """The topic that is asked for, or the only one with angular velocities."""
        there = sorted({c.topic for c in self.connections if c.msgtype == self.IMU and c.msgcount})
        if topic is not None:
            if topic not in there:
                listed = ", ".join(there) or "none"
                raise TableError(f"{self.path}: gyroscope.topic must be one of {listed} (Imu), got {topic}")
            return topic
        telling = []
        for name in there:
            self.read_topics({name})
            first = next((message for _, _, message in self.messages()), None)
            # By REP 145 a first covariance of -1 says that there is no such measurement.
            if first is not None and first.angular_velocity_covariance[0] != -1.0:
                telling.append(name)
        if len(telling) > 1:
            self.others = telling
        return telling[0] if len(telling) == 1 else None

    def batches(self, chunk_rows: int) -> Iterator[Batch]:
        """Readings in the order of their messages."""
        rates = ((number, stamp, m.angular_velocity) for number, stamp, m in self.messages())
        rows = ((number, stamp, (rate.x, rate.y, rate.z)) for number, stamp, rate in rates)
        return self.batched(rows, RATES[1:], chunk_rows)
