"""The topics of a rover: what it was told, what it measured, what it was made to do and where that led."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from six_wheel._core import Rover
from six_wheel.kinematics.controller import reason_names
from six_wheel.kinematics.objects.closing import Closing
from six_wheel.logs.mcap import frames
from six_wheel.logs.mcap.writer import RecordWriter
from six_wheel.robot_description.wheels_of_rover import joints_as_given

# In: what decides what a loop does, written as it comes.
WANTED = "/cmd_vel"
JOINTS = "/joint_states"
IMU = "/imu"
TICK = "/six_wheel/tick"  # a step of the timer, without new readings
CHANGES = "/six_wheel/changes"  # parameters, poses, resets: JSON
GIVEN = "/six_wheel/given"  # rows of a table of commands, in its own numbers: JSON
# Out: what it makes of that.
COMMANDS = "/joint_commands"
LIMITED = "/cmd_vel_out"
ODOMETRY = "/odom"
TRANSFORMS = "/tf"
REASONS = "/reasons"  # when they change
SLIP = "/wheel_slip"
DIAGNOSTICS = "/diagnostics"
DESCRIPTION = "/robot_description"
TRUTH = "/truth"  # of a simulation

Numbers = Sequence[float]
PARAMETERS = "rover.yaml"


@dataclass(frozen=True)
class Frames:
    """Names of the frames between which odometry is."""

    odom: str = "odom"
    base: str = "base_link"


class RoverRecord(Closing):
    """A record of one rover, written topic by topic.

    Parameters
    ----------
    path : Path
        A .mcap file; what is there is replaced.
    rover : Rover
        The rover with these joints.
    made_by : {"drive", "odometry", "simulate", "node"}
        Program that writes it.
    parameters : str
        The parameter file of the rover, as text.
    settings : mapping of str to object, optional
        Other settings; written as JSON.
    frames : Frames, optional
    """

    def __init__(
        self,
        path: Path,
        rover: Rover,
        made_by: str,
        parameters: str,
        settings: Mapping[str, Any] | None = None,
        frame_names: Frames | None = None,
    ) -> None:
        written = {"made_by": made_by} | {key: json.dumps(value) for key, value in (settings or {}).items()}
        self.rover = rover
        self._file = RecordWriter(path, written, {PARAMETERS: parameters})
        self._names = frame_names or Frames()
        self._steering, self._traction = map(list, joints_as_given(rover))
        self._commands = frames.joint_state(
            [*self._steering, *self._traction], *[len(self._steering) + len(self._traction)] * 2
        )
        self._unsaid = [math.nan] * len(self._traction), [math.nan] * len(self._steering)
        self._odometry = frames.odometry(self._names.odom, self._names.base)
        self._transform = frames.transforms((self._names.odom, self._names.base))
        self._slip = frames.values(len(rover.wheel_names), ",".join(rover.wheel_names))
        # A sender that makes up names must not fill the memory.
        self._twist_stamped = lru_cache(64)(frames.twist_stamped)
        self._joint_state = lru_cache(64)(frames.joint_state)
        self._clock = frames.clock()
        self._reasons: int | None = None

    # In

    def wanted(self, now: int, stamp: int, twist: Numbers, frame_id: str = "") -> None:
        """A command that came at `now`, given at `stamp` [ns]: ``[vx, vy, omega]``."""
        self._twist(WANTED, now, stamp, twist, frame_id)

    def joints(
        self,
        now: int,
        stamp: int,
        names: Sequence[str],
        positions: Numbers,
        velocities: Numbers = (),
        efforts: Numbers = (),
    ) -> None:
        """Joint states that came at `now`, as they were [rad, rad/s]."""
        frame = self._joint_state(tuple(names), len(positions), len(velocities), len(efforts))
        given = [group for group in (positions, velocities, efforts) if len(group)]
        self.joint_message(now, stamp, frame.pack(stamp, *given))

    def joint_message(self, now: int, stamp: int, message: bytes) -> None:
        """The same, as the bytes that came."""
        self._write(JOINTS, "sensor_msgs/msg/JointState", now, message, stamp)

    def imu_message(self, now: int, stamp: int, message: bytes) -> None:
        """Record a message of a gyroscope as the bytes that arrived."""
        self._write(IMU, "sensor_msgs/msg/Imu", now, message, stamp)

    def tick(self, now: int) -> None:
        """A step without new readings."""
        self._write(TICK, "rosgraph_msgs/msg/Clock", now, self._clock.pack(now))

    def change(self, now: int, what: Mapping[str, Any]) -> None:
        """Something that was set while it ran: ``{"set": {...}}``, ``{"pose": ..., "covariance": ...}``,
        ``{"active": ...}``, ``{"halt": True}``, ``{"release": True}``, ``{"end": True}``, ..."""
        self._text(CHANGES, now, json.dumps(what))

    def given(self, now: int, row: Sequence[float]) -> None:
        """A row of a table: its time as the table has it, and the twist; an empty one ends a chunk."""
        self._text(GIVEN, now, json.dumps(row))

    # Out

    def commands(self, now: int, steering: Numbers, speeds: Numbers) -> None:
        """Joint commands in the order of the rover's joints [rad, rad/s]."""
        groups = ([*steering, *self._unsaid[0]], [*self._unsaid[1], *speeds])
        message = self._commands.pack(now, *(group for group in groups if group))
        self._write(COMMANDS, "sensor_msgs/msg/JointState", now, message)

    def limited(self, now: int, twist: Numbers) -> None:
        """The motion that the commands make."""
        self._twist(LIMITED, now, now, twist, self._names.base)

    def reasons(self, now: int, reasons: int) -> None:
        """Record the reasons for limiting the motion; written only when they change."""
        if reasons != self._reasons:
            self._reasons = reasons
            self._text(REASONS, now, reason_names(reasons))

    def odometry(
        self,
        now: int,
        stamp: int,
        pose: Numbers,
        twist: Numbers,
        covariance: Numbers,
        twist_covariance: Numbers,
    ) -> None:
        """Record the odometry, also as a transform; covariances are 6 x 6, row by row."""
        place, motion = frames.planar_pose(pose), frames.planar_twist(twist)
        message = self._odometry.pack(stamp, place, covariance, motion, twist_covariance)
        self._write(ODOMETRY, "nav_msgs/msg/Odometry", now, message, stamp)
        self._write(TRANSFORMS, "tf2_msgs/msg/TFMessage", now, self._transform.pack(stamp, place), stamp)

    def slip(self, now: int, residual: Numbers) -> None:
        """Record the sliding speed of each wheel's contact [m/s]."""
        self._write(SLIP, "std_msgs/msg/Float64MultiArray", now, self._slip.pack(now, residual))

    def diagnostics(self, now: int, statuses: Sequence[tuple[int, str, str, Mapping[str, str]]]) -> None:
        """Level, name, message and values of everything there is to say."""

        def build(types: Any) -> Any:
            listed = [
                types["diagnostic_msgs/msg/DiagnosticStatus"](
                    level=level,
                    name=name,
                    message=message,
                    hardware_id="",
                    values=[types["diagnostic_msgs/msg/KeyValue"](*item) for item in said.items()],
                )
                for level, name, message, said in statuses
            ]
            stamp = types["builtin_interfaces/msg/Time"](*divmod(now, frames.NANOSECONDS))
            header = types["std_msgs/msg/Header"](stamp, "")
            return types["diagnostic_msgs/msg/DiagnosticArray"](header, listed)

        self._file.write_object(DIAGNOSTICS, "diagnostic_msgs/msg/DiagnosticArray", now, build)

    def description(self, now: int, urdf: str) -> None:
        """Record the robot description (URDF), for viewers that draw the rover."""
        self._text(DESCRIPTION, now, urdf)

    def close(self) -> None:
        """End the file."""
        self._file.close()

    def _twist(self, topic: str, now: int, stamp: int, twist: Numbers, frame_id: str) -> None:
        message = self._twist_stamped(frame_id).pack(stamp, frames.planar_twist(twist))
        self._write(topic, "geometry_msgs/msg/TwistStamped", now, message, stamp)

    def _text(self, topic: str, now: int, value: str) -> None:
        self._write(topic, "std_msgs/msg/String", now, frames.text(value))

    def _write(self, topic: str, kind: str, now: int, message: bytes, stamp: int | None = None) -> None:
        self._file.write(self._file.topic(topic, kind), now, message, stamp)
