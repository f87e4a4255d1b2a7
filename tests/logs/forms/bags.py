"""Forms of bags: joint states of angles and counts, topics of numbers, encoder messages of known robots."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.logs.forms.drives import PAIR, TICKS, Course, course
from tests.logs.forms.form import Form

BICYCLE = course(sw.Rover.bicycle(1.0, 0.15))
TURTLEBOT = "std_msgs/Header header\nint32 left_encoder\nint32 right_encoder\n"
DUCKIETOWN = "std_msgs/Header header\nint32 data\nuint16 resolution\nuint8 type\n"
ACKERMANN = "float32 steering_angle\nfloat32 steering_angle_velocity\nfloat32 speed\n"


def bag(
    kinds: dict[str, str], made: Callable[[Any, int], Sequence[Any]], own: dict[str, str] | None = None
) -> Any:
    """Writes a bag: topics with their types, the messages of every row, and definitions of other types."""

    def write(folder: Path) -> Path:
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        store = get_typestore(Stores.LATEST)
        for name, text in (own or {}).items():
            store.register(get_types_from_msg(text, name))
        with Writer(folder / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            topics = {
                topic: writer.add_connection(topic, kind, typestore=store) for topic, kind in kinds.items()
            }
            for row in range(len(PAIR.stamps)):
                stamp = 10**18 + round(1e9 * PAIR.stamps[row])
                for (topic, kind), message in zip(kinds.items(), made(store.types, row), strict=True):
                    writer.write(topics[topic], stamp, store.serialize_cdr(message, kind))
        return folder / "bag"

    return write


def header(types: Any, row: int) -> Any:
    stamp = types["builtin_interfaces/msg/Time"](
        1_000_000_000 + int(PAIR.stamps[row]), round((PAIR.stamps[row] % 1.0) * 1e9)
    )
    return types["std_msgs/msg/Header"](stamp, "")


def states(values: Any, speeds: bool = False) -> Any:
    """A bag of joint states."""

    def made(types: Any, row: int) -> list[Any]:
        readings, nothing = np.asarray(values[row], dtype=float), np.zeros(0)
        position, velocity = (nothing, readings) if speeds else (readings, nothing)
        names = [*PAIR.rover.traction_joints]
        return [types["sensor_msgs/msg/JointState"](header(types, row), names, position, velocity, nothing)]

    return bag({"/joint_states": "sensor_msgs/msg/JointState"}, made)


def numbers(kind: str, values: Any) -> Any:
    """A bag with a topic of numbers for each wheel."""
    name = f"std_msgs/msg/{kind}"
    cast = float if kind.startswith("Float") else int
    return bag(
        {"/left": name, "/right": name}, lambda types, row: [types[name](cast(v)) for v in values[row]]
    )


def bags() -> Iterator[Form]:
    """All of them."""

    def form(name: str, write: Any, drive: Course = PAIR, **more: Any) -> Form:
        return Form(name, "bags", write, drive.rover, drive.pose, **more)

    known = {"wheel_encoders": {"ticks_per_turn": TICKS}}
    yield form("states: angles", states(PAIR.angles))
    yield form("states: rates", states(PAIR.rates, speeds=True))
    yield form("states: counts", states(PAIR.counts), fix=known, says=("ticks_per_turn: COUNTS",))
    yield form("states: counts said", states(PAIR.counts), options=known)
    wrapped = (PAIR.counts + 65_000) % 65_536
    wraps = {"wheel_encoders": {"ticks_per_turn": TICKS, "wraps_at": 65_536}}
    yield form("states: 16 bit", states(wrapped), options=known, fix=wraps, says=("wraps_at: 65536",))
    for kind, unit, values in (
        ("Float64", "rad", PAIR.angles),
        ("Float32", "rad/s", PAIR.rates),
        ("Int32", "ticks", PAIR.counts),
        ("Int64", "ticks", PAIR.counts),
    ):
        topics = {"/left": f"left [{unit}]", "/right": f"right [{unit}]"}
        fix = {"topics": topics, **(known if unit == "ticks" else {})}
        says = ('--topic "/left=WHEEL [UNIT]"', "topics:")
        yield form(f"{kind} in {unit}", numbers(kind, values), fix=fix, says=says)
    array = "std_msgs/msg/Float64MultiArray"

    def arrays(types: Any, row: int) -> list[Any]:
        layout = types["std_msgs/msg/MultiArrayLayout"]([], 0)
        return [types[array](layout, np.asarray(PAIR.angles[row]))]

    topics = {"/wheels[0]": "left [rad]", "/wheels[1]": "right [rad]"}
    yield form("array", bag({"/wheels": array}, arrays), fix={"topics": topics}, says=('"/wheels[0]=',))
    state = "turtlebot3_msgs/msg/SensorState"
    topics = {"/sensor_state.left_encoder": "left [ticks]", "/sensor_state.right_encoder": "right [ticks]"}
    write = bag(
        {"/sensor_state": state},
        lambda types, row: [types[state](header(types, row), *map(int, PAIR.counts[row]))],
        {state: TURTLEBOT},
    )
    yield form("turtlebot3", write, fix={"topics": topics, **known}, says=("/sensor_state.left_encoder",))
    tick = "duckietown_msgs/msg/WheelEncoderStamped"
    write = bag(
        {"/left/tick": tick, "/right/tick": tick},
        lambda types, row: [types[tick](header(types, row), int(v), 4096, 0) for v in PAIR.counts[row]],
        {tick: DUCKIETOWN},
    )
    topics = {"/left/tick": "left [ticks]", "/right/tick": "right [ticks]"}
    yield form("duckietown", write, fix={"topics": topics, **known}, says=("/left/tick",))
    command, radius = "ackermann_msgs/msg/AckermannDrive", BICYCLE.rover.wheels[0].radius
    rear = BICYCLE.rover.wheel_names.index("rear")
    write = bag(
        {"/ackermann": command},
        lambda types, row: [
            types[command](float(BICYCLE.steering[row, 0]), 0.0, float(radius * BICYCLE.rates[row, rear]))
        ],
        {command: ACKERMANN},
    )
    topics = {"/ackermann.speed": "rear [m/s]", "/ackermann.steering_angle": "front_steering [rad]"}
    yield form("ackermann", write, BICYCLE, fix={"topics": topics}, says=("/ackermann.speed",))
