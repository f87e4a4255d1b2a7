"""Readers and any bytes: an answer that holds together, or the error of their kind, in plain words.

For coverage-guided fuzzing (`fuzzed.py`) and for what that found (`test_finds.py`).
"""

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

import six_wheel as sw
from six_wheel.logs import CommandTable, LogOptions, TableError, open_log
from six_wheel.robot_description.parameters import ParameterFileError, dump, parse_parameters, read_parameters
from six_wheel.robot_description.urdf import read_urdf
from tests.rovers import CART

ROOT = Path(__file__).parents[2]
ROVER = sw.Rover.preset("perseverance")


def told(error: ValueError) -> None:
    """Words that a terminal can show."""
    text = str(error)
    assert text
    assert text.replace("\n", "").isprintable(), repr(text)


def yaml(path: Path) -> None:
    """A parameter file; what it says can be written and read again."""
    try:
        found = read_parameters(path)
    except ParameterFileError as error:
        told(error)
        return
    again = parse_parameters(dump(found.rover, limits=found.limits, control=found.control))
    assert again.rover == found.rover
    assert again.limits == found.limits


def commands(path: Path) -> None:
    """A table of commands: rows of finite numbers, later and later."""
    try:
        with CommandTable(path) as table:
            last = -np.inf
            for chunk in table.chunks(16):
                assert np.isfinite(chunk.twists).all()
                times = np.concatenate([[last], chunk.stamps])
                assert (np.diff(times) > 0.0).all()
                last = chunk.stamps[-1]
    except TableError as error:
        told(error)


def log(path: Path) -> None:
    """A log of wheels: what cannot be used is left out and counted."""
    try:
        with open_log(path, ROVER, LogOptions()) as opened:
            for rows in opened.chunks(16):
                assert len(rows.stamps) == len(rows.wheel_angles) == len(rows.rows)
                assert (np.diff(rows.rows) > 0).all()
    except TableError as error:
        told(error)


def urdf(path: Path) -> None:
    """A robot description; a rover of it can be written and read again."""
    try:
        found = read_urdf(path)
    except ParameterFileError as error:
        told(error)
        return
    assert np.isfinite([[wheel.x, wheel.y, wheel.radius] for wheel in found.rover.wheels]).all()


def texts_of(*patterns: str) -> Iterator[bytes]:
    for pattern in patterns:
        for path in sorted(ROOT.glob(pattern)):
            yield path.read_bytes()


def descriptions() -> Iterator[bytes]:
    for rover in (ROVER, CART, sw.Rover.ackermann(2.0, 1.2, 0.3)):
        yield rover.urdf().encode()


def command_tables() -> Iterator[bytes]:
    yield b"time,vx,omega\n0,0.5,0\n1,0.5,0.2\n2,0.5,0\n"
    yield b"stamp_ns;linear.x [m/s];angular.z [deg/s]\n1700000000000000000;1;2\n1700000000010000000;1;-2\n"
    yield b'"t (s)"\tv (km/h)\tvy\tyaw_rate\n-1e3\t1\t0\t.5\n0x1\tnan\tinf\t\n'


def joint_tables() -> Iterator[bytes]:
    wheels, steering = list(ROVER.traction_joints), list(ROVER.steering_joints)
    numbers = ",".join("0.1" for _ in (*wheels, *steering))
    rows = "".join(f"{k}00,{numbers}\n" for k in range(4))
    angles = [f"{name} [rad]" for name in wheels] + [f"{name} (deg)" for name in steering]
    speeds = [f"{name}_speed (rad/s)" for name in wheels] + [f"{name} [rad]" for name in steering]
    yield f"time_ms,{','.join(angles)}\n{rows}".encode()
    yield f"stamp,{','.join(speeds)}\n{rows}".encode()


def bags() -> Iterator[bytes]:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    names = [*ROVER.traction_joints, *ROVER.steering_joints]
    with tempfile.TemporaryDirectory() as folder:
        with Writer(Path(folder) / "run", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            connection = writer.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=store)
            for k in range(3):
                header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](k, 5), "")
                states = np.full(len(names), k / 10)
                message = types["sensor_msgs/msg/JointState"](header, names, states, states, states[:0])
                data = store.serialize_cdr(message, "sensor_msgs/msg/JointState")
                writer.write(connection, k * 10**9, data)
        (file,) = (Path(folder) / "run").glob("*.mcap")
        yield file.read_bytes()


Read = Callable[[Path], None]
# By the name of the target: what reads, the ending of its files, files to begin with.
READERS: dict[str, tuple[Read, str, Callable[[], Iterator[bytes]]]] = {
    "yaml": (
        yaml,
        ".yaml",
        lambda: texts_of("tests/robot_description/parameters/data/*.yaml", "examples/*.yaml"),
    ),
    "commands": (commands, ".csv", command_tables),
    "log": (log, ".csv", joint_tables),
    "bag": (log, ".mcap", bags),
    "urdf": (urdf, ".urdf", descriptions),
}


def read(target: str, content: bytes, folder: Path) -> None:
    """Have the reader of a target read these bytes."""
    reader, ending, _ = READERS[target]
    path = folder / f"file{ending}"
    path.write_bytes(content)
    reader(path)
