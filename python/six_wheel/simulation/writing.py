"""A log in memory, into a table or a bag that `six-wheel odometry` and `calibrate` read."""

import math
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Odometry, Rover
from six_wheel.logs.mcap.rover_record import PARAMETERS, TRUTH
from six_wheel.logs.mcap.writer import RecordWriter, libraries
from six_wheel.logs.recordings import WheelLog
from six_wheel.logs.writing import TableWriter, replacing
from six_wheel.robot_description.parameters.writing import text_of

Floats = NDArray[np.float64]

BAG = ".mcap"
WORLD, BODY = "map", "base_link"


def write_log(log: WheelLog, rover: Rover, path: str | Path) -> None:
    """Write a log: .csv or .parquet, its truth in columns x, y and yaw; or .mcap, for viewers.

    Parameters
    ----------
    log : WheelLog
        Joints in the rover's order. The truth is written at the stamps of the log. Counts stay counts, in
        a bag too, whose messages have no units: what reads it has to know the encoders.
    rover : Rover
        Its joints' names are those of the columns.
    path : str or Path
        A file that is there is replaced once the new one is complete.

    Raises
    ------
    TableError
        If the ending is none of these.
    ModuleNotFoundError
        If what writes the format is not installed.
    """
    target = Path(path)
    if log.options.get("readings", "angles") != "angles":
        log = log.in_radians(rover)  # a file has what was turned until then
    if target.suffix.lower() == BAG:
        _write_bag(log, rover, target)
        return
    columns = reading_columns(log, rover)
    if log.truth is not None:
        places = log.truth.at(log.stamps).T
        columns |= {name: (unit, place) for (name, unit), place in zip(POSE, places, strict=True)}
    write_columns(target, columns, {"time", "yaw_rate", *dict(POSE)})


POSE = (("x", "m"), ("y", "m"), ("yaw", "rad"))


def write_columns(path: Path, columns: Mapping[str, tuple[str, Any]], plain: Collection[str]) -> None:
    """Write a table that states its units: Parquet in its metadata, CSV in all but its `plain` headers."""
    stated = path.suffix.lower() == ".csv"
    units = {
        f"{name} [{unit}]" if stated and name not in plain else name: unit
        for name, (unit, _) in columns.items()
    }
    with replacing(path) as place, TableWriter(place, units) as writer:
        writer.write([np.ascontiguousarray(values) for _, values in columns.values()])


def reading_columns(log: WheelLog, rover: Rover) -> dict[str, tuple[str, Any]]:
    """Name to unit and values of what was read, in the order of a table."""
    columns: dict[str, tuple[str, Any]] = {"time": ("s", log.stamps)}
    for joint, values in joint_columns(log, rover).items():
        kind = "steering_encoders" if joint in rover.steering_joints else "wheel_encoders"
        columns[joint] = ("ticks" if kind in log.options else "rad", values)
    if log.yaw_rate is not None:
        columns["yaw_rate"] = ("rad/s", log.yaw_rate)
    return columns


def joint_columns(log: WheelLog, rover: Rover) -> dict[str, Floats]:
    """Readings by the names of the joints; without wheels that have none."""
    columns = {}
    for joint, wheel in rover.steering_joints.items():
        if log.steering is not None:
            columns[joint] = log.steering[:, rover.steered_wheel_names.index(wheel)]
    for joint, wheel in rover.traction_joints.items():
        column = log.wheel_angles[:, rover.wheel_names.index(wheel)]
        if np.isfinite(column).any():
            columns[joint] = column
    return columns


def _write_bag(log: WheelLog, rover: Rover, path: Path) -> None:
    columns = joint_columns(log, rover)
    rows = np.stack(list(columns.values()), axis=-1)
    with replacing(path) as place, record_of(place, rover) as writer:
        messages = Messages(writer)
        poses = None if log.truth is None else log.truth.at(log.stamps)
        odometry = reckoned(log, rover)
        for row, stamp in enumerate(np.rint(log.stamps * 1e9).astype(np.int64).tolist()):
            messages.joints(stamp, list(columns), rows[row])
            if poses is not None and np.isfinite(poses[row]).all():
                x, y, yaw = poses[row].tolist()
                at, turn = np.array((x, y, 0.0)), upright(yaw)
                messages.posed(stamp, at, turn)
                messages.transforms(stamp, {BODY: (WORLD, at, turn)})
            messages.odometry(stamp, *odometry[row])
            if log.yaw_rate is not None:
                messages.imu(stamp, (0.0, 0.0, log.yaw_rate[row]))


def record_of(path: Path, rover: Rover) -> RecordWriter:
    """A record of a simulation, with the rover's parameter file."""
    return RecordWriter(path, {"made_by": "simulate"}, {PARAMETERS: text_of(rover)})


def upright(yaw: float) -> Floats:
    """The quaternion x, y, z, w of a turn about z."""
    return np.array((0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)))


def reckoned(log: WheelLog, rover: Rover) -> list[tuple[Floats, Floats, Floats, Floats]]:
    """Odometry of the readings from the first true pose on: pose, twist and their covariances (6, 6), row by
    row."""
    odometry = Odometry(rover, **log.options)
    if log.truth is not None:
        odometry.reset(log.truth.at(log.stamps[:1])[0])
    rows = []
    for row, stamp in enumerate(log.stamps.tolist()):
        part = slice(row, row + 1)
        steering = None if log.steering is None else log.steering[part]
        odometry.run(steering, log.wheel_angles[part], [stamp], covariances=False, residuals=False)
        state = odometry.state
        rows.append((state.pose, state.twist, state.covariance_6x6(), state.twist_covariance_6x6()))
    return rows


class Messages:
    """Joint states, the true pose, also as a transform, odometry and the gyroscope, each on its topic."""

    TOPICS: ClassVar = {
        "sensor_msgs/msg/JointState": "/joint_states",
        "geometry_msgs/msg/PoseStamped": TRUTH,
        "sensor_msgs/msg/Imu": "/imu",
        "nav_msgs/msg/Odometry": "/odom",
        "tf2_msgs/msg/TFMessage": "/tf",
    }

    def __init__(self, writer: RecordWriter) -> None:
        self._writer, self._store = writer, libraries().store

    def _make(self, kind: str, /, **fields: Any) -> Any:
        return self._store.types[kind](**fields)

    def _header(self, stamp: int, frame: str) -> Any:
        second, nanosecond = divmod(stamp, 1_000_000_000)
        time = self._make("builtin_interfaces/msg/Time", sec=second, nanosec=nanosecond)
        return self._make("std_msgs/msg/Header", stamp=time, frame_id=frame)

    def _write(self, kind: str, stamp: int, frame: str = "", **fields: Any) -> None:
        self._send(kind, stamp, header=self._header(stamp, frame), **fields)

    def _send(self, kind: str, stamp: int, **fields: Any) -> None:
        self._writer.write_object(self.TOPICS[kind], kind, stamp, lambda types: types[kind](**fields))

    def joints(self, stamp: int, names: list[str], positions: Floats) -> None:
        nothing = np.empty(0)
        readings: dict[str, Any] = {
            "position": np.ascontiguousarray(positions),
            "velocity": nothing,
            "effort": nothing,
        }
        self._write("sensor_msgs/msg/JointState", stamp, name=names, **readings)

    def _quaternion(self, numbers: Floats) -> Any:
        x, y, z, w = map(float, numbers)
        return self._make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def _vector(self, numbers: Iterable[float], kind: str = "Vector3") -> Any:
        x, y, z = map(float, numbers)
        return self._make(f"geometry_msgs/msg/{kind}", x=x, y=y, z=z)

    def transforms(self, stamp: int, frames: dict[str, tuple[str, Floats, Floats]]) -> None:
        """Child frame to parent frame, place and quaternion."""
        stamped = []
        for child, (parent, place, turn) in frames.items():
            transform = self._make(
                "geometry_msgs/msg/Transform",
                translation=self._vector(place),
                rotation=self._quaternion(turn),
            )
            header = self._header(stamp, parent)
            fields = {"header": header, "child_frame_id": child, "transform": transform}
            stamped.append(self._make("geometry_msgs/msg/TransformStamped", **fields))
        self._send("tf2_msgs/msg/TFMessage", stamp, transforms=stamped)

    def posed(self, stamp: int, place: Floats, turn: Floats) -> None:
        """The true pose."""
        point = self._vector(place, "Point")
        pose = self._make("geometry_msgs/msg/Pose", position=point, orientation=self._quaternion(turn))
        self._write("geometry_msgs/msg/PoseStamped", stamp, WORLD, pose=pose)

    def odometry(self, stamp: int, pose: Floats, twist: Floats, of_pose: Floats, of_twist: Floats) -> None:
        """Write a message of odometry with both covariances (6, 6)."""
        make = self._make
        place = self._vector((pose[0], pose[1], 0.0), "Point")
        posed = make("geometry_msgs/msg/Pose", position=place, orientation=self._quaternion(upright(pose[2])))
        moved = make(
            "geometry_msgs/msg/Twist",
            linear=self._vector((twist[0], twist[1], 0.0)),
            angular=self._vector((0.0, 0.0, twist[2])),
        )
        fields = {
            "child_frame_id": BODY,
            "pose": make("geometry_msgs/msg/PoseWithCovariance", pose=posed, covariance=of_pose.ravel()),
            "twist": make("geometry_msgs/msg/TwistWithCovariance", twist=moved, covariance=of_twist.ravel()),
        }
        self._write("nav_msgs/msg/Odometry", stamp, WORLD, **fields)

    def imu(self, stamp: int, rates: Iterable[float], turn: Floats | None = None) -> None:
        """Rates of the body, and its attitude if the sensor has it."""
        unknown = np.zeros(9)
        unknown[0] = -1.0  # by REP 145: this sensor has none of it
        self._write(
            "sensor_msgs/msg/Imu",
            stamp,
            BODY,
            orientation=self._quaternion(upright(0.0) if turn is None else turn),
            orientation_covariance=unknown if turn is None else np.zeros(9),
            angular_velocity=self._vector(rates),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=self._vector(np.zeros(3)),
            linear_acceleration_covariance=unknown,
        )
