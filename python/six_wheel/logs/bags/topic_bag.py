"""Wheels and steering joints in messages of any type of a bag: topics of numbers, and fields of others.

``/left/velocity`` is the number of a std_msgs message, ``/encoders[1]`` one of an array, and a field stands
behind a point: ``/sensor_state.left_encoder`` (turtlebot3_msgs), ``/ackermann_cmd.drive.steering_angle``. The
stamp is that of the header, or else when the message was received.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from six_wheel._core import Rover
from six_wheel.kinematics.errors import TableError
from six_wheel.logs.bags.joint_bag import JointBag
from six_wheel.logs.bags.messages import Bag
from six_wheel.logs.headers.joint_columns import Reading, joint_columns

_KEY = re.compile(r"(?P<topic>[^.\[]+)(?:\.(?P<field>[\w.]+))?(?:\[(?P<index>\d+)\])?")


class TopicBag(JointBag):
    """Readings of a rover in topics of a bag.

    Raises `TableError` if there is no such topic or field.

    `topics` leads from a topic, with a field and an index where there are several numbers, to a header as
    tables have it; `readings` is the kind of the numbers where the headers do not state it.
    """

    def __init__(
        self, path: Path, rover: Rover, topics: Mapping[str, str], readings: Reading | None = None
    ) -> None:
        Bag.__init__(self, path)
        try:
            found = joint_columns(["time [ns]", *topics.values()], rover, readings)
        except BaseException:
            self.close()
            raise
        self.columns = {
            name: replace(column, header=list(topics)[column.index - 1])
            for name, column in found.columns.items()
            if name.startswith(("wheel ", "steering "))
        }
        self.readings, self.names = found.readings, list(self.columns)
        self.counted = {
            name.removeprefix("steering ")
            for name, column in self.columns.items()
            if name.startswith("steering ") and column.unit.symbol == "ticks"
        }
        self._joints = {name: name for name in self.names}
        self._turned = found.reversed
        self._fields: dict[str, list[tuple[str, str, int | None]]] = {}
        for name, column in self.columns.items():
            key = _KEY.fullmatch(column.header)
            topic = column.header if key is None else key["topic"]
            index = None if key is None or key["index"] is None else int(key["index"])
            field = "" if key is None else key["field"] or ""
            self._fields.setdefault(topic, []).append((name, field, index))
        there = {each.topic: each.msgtype for each in self.connections}
        for topic in self._fields:
            if topic not in there:
                self.close()
                listed = ", ".join(f"{name} ({kind.rpartition('/')[2]})" for name, kind in there.items())
                raise TableError(f"{path}: topics must name topics of the bag, got {topic} among {listed}")
        self.read_topics(set(self._fields))

    def _states(self, message: Any) -> Iterator[tuple[str, float, float]]:
        for name, field, index in self._fields[self.topic]:
            value = message
            for step in field.split(".") if field else ["data"]:
                if not hasattr(value, step):
                    fields = ", ".join(each for each in vars(message) if not each.startswith("_"))
                    such = f'"{self.topic}.FIELD", FIELD one of {fields}'
                    raise TableError(f'{self.path}: {self.topic} has no field "{step}": name it as {such}')
                value = getattr(value, step)
            try:
                number = float(value if index is None else value[index])
            except (TypeError, ValueError, IndexError):
                raise TableError(
                    f'{self.path}: {self.topic} must have one number there, or several and "[0]" behind it'
                ) from None
            number *= self.columns[name].unit.scale
            yield name, number, number
