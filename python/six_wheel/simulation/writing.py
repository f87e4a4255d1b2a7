"""A log in memory, into a table or a bag that `six-wheel odometry` and `calibrate` read."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from six_wheel._core import Odometry, Rover
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.objects.whole_files import replacing
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.mcap import frames
from six_wheel.logs.mcap.rover_record import IMU, JOINTS, ODOMETRY, PARAMETERS, TRANSFORMS, TRUTH
from six_wheel.logs.mcap.writer import RecordWriter, record_stamps
from six_wheel.logs.recordings import WheelLog
from six_wheel.logs.writing import TableWriter
from six_wheel.robot_description.parameters.writing import text_of

BAG = ".mcap"
WORLD, BODY = "map", "base_link"


@checked()
def write_log(log: WheelLog, rover: Rover, path: str | Path) -> None:
    """Write a log: .csv or .parquet, its truth in columns x, y and yaw; or .mcap, for viewers.

    Raises `TableError` if the ending is none of these. Raises `ModuleNotFoundError` if what writes the format
    is not installed.

    Parameters
    ----------
    log : WheelLog
        Joints in the rover's order. The truth is written at the stamps of the log. Counts stay counts, in
        a bag too, whose messages have no units: what reads it has to know the encoders.
    rover : Rover
        Its joints' names are those of the columns.
    path : str or Path
        A file that is there is replaced once the new one is complete.
    """
    target = Path(path)
    if log.options.get("readings") == "speeds" or log.options.get("increments"):
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
        messages = Messages(writer, list(columns), (WORLD, BODY))
        poses = None if log.truth is None else log.truth.at(log.stamps)
        odometry = reckoned(log, rover)
        for row, stamp in enumerate(record_stamps(log.stamps, np.arange(1, 1 + len(log.stamps))).tolist()):
            messages.write(JOINTS, stamp, rows[row])
            if poses is not None and np.isfinite(poses[row]).all():
                there = frames.planar_pose(poses[row])
                messages.write(TRUTH, stamp, there)
                messages.write(TRANSFORMS, stamp, there)
            messages.write(ODOMETRY, stamp, *odometry[row])
            if log.yaw_rate is not None:
                messages.write(IMU, stamp, frames.inertial((0.0, 0.0, log.yaw_rate[row])))


def record_of(path: Path, rover: Rover) -> RecordWriter:
    """A record of a simulation, with the rover's parameter file."""
    return RecordWriter(path, {"made_by": "simulate"}, {PARAMETERS: text_of(rover)})


def reckoned(log: WheelLog, rover: Rover) -> list[tuple[Any, ...]]:
    """Odometry of the readings from the first true pose on, row by row as a message of it has them."""
    odometry = Odometry(rover, **log.options)
    if log.truth is not None:
        odometry.reset(log.truth.at(log.stamps[:1])[0])
    rows: list[tuple[Any, ...]] = []
    for row, stamp in enumerate(log.stamps.tolist()):
        part = slice(row, row + 1)
        steering = None if log.steering is None else log.steering[part]
        odometry.run(steering, log.wheel_angles[part], [stamp], covariances=False, residuals=False)
        state = odometry.state
        covariances = state.covariance_6x6().ravel(), state.twist_covariance_6x6().ravel()
        place, motion = frames.planar_pose(state.pose.tolist()), frames.planar_twist(state.twist.tolist())
        rows.append((place, covariances[0], motion, covariances[1]))
    return rows


class Messages:
    """Messages of a simulation on their topics; `transforms` are the frames, a parent and a child each."""

    def __init__(self, writer: RecordWriter, joints: Sequence[str], *transforms: tuple[str, str]) -> None:
        self._writer = writer
        self._frames = {
            JOINTS: ("sensor_msgs/msg/JointState", frames.joint_state(joints, len(joints), 0)),
            TRUTH: ("geometry_msgs/msg/PoseStamped", frames.pose_stamped(WORLD)),
            TRANSFORMS: ("tf2_msgs/msg/TFMessage", frames.transforms(*transforms)),
            ODOMETRY: ("nav_msgs/msg/Odometry", frames.odometry(WORLD, BODY)),
            IMU: ("sensor_msgs/msg/Imu", frames.imu(BODY)),
        }

    def write(self, topic: str, stamp: int, *groups: Any) -> None:
        """Append a message: groups of numbers as its frame takes them."""
        kind, frame = self._frames[topic]
        self._writer.write(self._writer.topic(topic, kind), stamp, frame.pack(stamp, *groups))
