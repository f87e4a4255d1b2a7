"""Commands and odometry of a loop, from a record and from its rerun."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.control_loop import Settings, Step
from six_wheel.kinematics.controller import reason_names
from six_wheel.kinematics.objects.notebooks import Shown
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.mcap import Record, rover_record
from six_wheel.logs.mcap.frames import planar_pose
from six_wheel.logs.mcap.reader import Message

OUT = (rover_record.COMMANDS, rover_record.LIMITED, rover_record.REASONS, rover_record.ODOMETRY)


@dataclass
class Run:
    """Commands and odometry of a loop; times in ns.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Of the commands.
    steering, wheel_speeds : ndarray, shape (n, joints)
        In the order of the rover's joints [rad, rad/s].
    twists : ndarray, shape (n, 3)
    reasons : list of str, n
        Names, joined by ``|``.
    stamps : ndarray, shape (m,)
        Of the odometry.
    poses : ndarray, shape (m, 3)
    motions : ndarray, shape (m, 3)
        Twists that were measured.
    covariances : ndarray, shape (m, 72)
        Of both, 6 x 6 each.
    """

    times: NDArray[np.int64]
    steering: Floats
    wheel_speeds: Floats
    twists: Floats
    reasons: list[str]
    stamps: NDArray[np.int64]
    poses: Floats
    motions: Floats
    covariances: Floats


@dataclass
class Replayed(Shown):
    """A record and what came of running it again.

    Attributes
    ----------
    name : str
    before, after : Settings
        Of the record, and with the changes.
    recorded, again : Run
    wanted : ndarray, shape (k, 4)
        Commands that came: time [ns], vx, vy, omega.
    warnings : list of str
    """

    name: str
    before: Settings
    after: Settings
    recorded: Run
    again: Run
    wanted: Floats
    warnings: list[str] = field(default_factory=list)

    @property
    def rover(self) -> Rover:
        """Rover of the record."""
        return self.before.rover

    @property
    def same_bits(self) -> bool:
        """True if commands and odometry are the same numbers to the last bit."""
        one, other = self.recorded, self.again
        arrays = [each.name for each in fields(Run) if each.name != "reasons"]
        return one.reasons == other.reasons and all(
            getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in arrays
        )


class Collected:
    """Outputs as they come."""

    def __init__(self, rover: Rover) -> None:
        self._widths = len(rover.steering_joints), len(rover.traction_joints)
        self.times: list[int] = []
        self.joints: list[Sequence[float]] = []
        self.twists: list[Sequence[float]] = []
        self.reasons: list[str] = []
        self.stamps: list[int] = []
        self.motion: list[Sequence[float]] = []
        self._reason = ""

    def add(self, step: Step) -> None:
        """Add the outputs of a step."""
        if step.steering is not None and step.wheel_speeds is not None:
            self.times.append(step.now)
            self.joints.append([*step.steering, *step.wheel_speeds])
            self.twists.append(step.twist)
            self.reasons.append(reason_names(step.reasons))
        if step.state is not None and step.stamp is not None:
            state = step.state
            both = (state.covariance_6x6().ravel(), state.twist_covariance_6x6().ravel())
            self.stamps.append(step.stamp)
            # The record has the yaw as a quaternion: it is compared as that.
            pose = planar_pose(state.pose.tolist())
            self.motion.append([*pose, *state.twist.tolist(), *both[0], *both[1]])

    def read(self, record: Record, message: Message) -> None:
        """Add a message of a record, of a topic in `OUT`."""
        with record.reading(f"a message of {message.topic}"):
            self._add(record.parsed(message), message)

    def _add(self, content: Any, message: Message) -> None:
        if message.topic == rover_record.COMMANDS:
            steered = self._widths[0]
            self.times.append(message.time)
            if not len(content.position) == len(content.velocity) == sum(self._widths):
                raise ValueError("it must have a position and a velocity for every joint")
            self.joints.append([*content.position[:steered], *content.velocity[steered:]])
        elif message.topic == rover_record.LIMITED:
            self.twists.append(planar(content.twist))
            self.reasons.append(self._reason)
        elif message.topic == rover_record.REASONS:
            self._reason = content.data
            self.reasons[-1] = content.data  # written behind the motion that it is about
        else:
            place, turn, twist = content.pose.pose.position, content.pose.pose.orientation, content.twist
            pose = (place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w)
            covariances = (*content.pose.covariance, *twist.covariance)
            self.stamps.append(message.stamp)
            self.motion.append([*pose, *planar(twist.twist), *covariances])

    def end(self, steps: int, counted: int) -> None:
        """Leave out what comes after so many commands, and so many messages of odometry."""
        for each in (self.times, self.joints, self.twists, self.reasons):
            del each[steps:]
        del self.stamps[counted:], self.motion[counted:]

    def run(self) -> Run:
        """All of it."""
        steered, driven = self._widths
        joints = np.array(self.joints, dtype=float).reshape(-1, steered + driven)
        motion = np.array(self.motion, dtype=float).reshape(-1, 82)
        yaw = 2.0 * np.arctan2(motion[:, 5], motion[:, 6])
        return Run(
            np.array(self.times, dtype=np.int64),
            joints[:, :steered].copy(),
            joints[:, steered:].copy(),
            np.array(self.twists, dtype=float).reshape(-1, 3),
            self.reasons,
            np.array(self.stamps, dtype=np.int64),
            np.column_stack([motion[:, 0], motion[:, 1], yaw]),
            motion[:, 7:10].copy(),
            motion[:, 10:].copy(),
        )


def planar(twist: Any) -> tuple[float, float, float]:
    """The part of a Twist that a rover on a plane has."""
    return twist.linear.x, twist.linear.y, twist.angular.z
