"""A record of a loop, run again event by event.

What comes in is taken from the record: commands, joint states, ticks, changes. The joint states are those
that were measured: what a rover would have measured under other commands nobody knows.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.onboard import Loop, Options, Settings, Step
from six_wheel.onboard.recorder import Recorder
from six_wheel.records import Record, RecordError, rover_record
from six_wheel.records.frames import JointStates, planar_pose
from six_wheel.records.reader import Message

__all__ = ["Replayed", "Run", "replay", "settings_of"]

Floats = NDArray[np.float64]
LOOPS = ("node", "simulate")
SECOND = 1_000_000_000
IN = (rover_record.WANTED, rover_record.JOINTS, rover_record.TICK, rover_record.CHANGES)
OUT = (rover_record.COMMANDS, rover_record.LIMITED, rover_record.REASONS, rover_record.ODOMETRY)


@dataclass
class Run:
    """What a loop commanded and counted; times in ns.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Of the commands.
    steering, speeds : ndarray, shape (n, joints)
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
    speeds: Floats
    twists: Floats
    reasons: list[str]
    stamps: NDArray[np.int64]
    poses: Floats
    motions: Floats
    covariances: Floats


@dataclass
class Replayed:
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
        """That of the record."""
        return self.before.rover

    @property
    def same_bits(self) -> bool:
        """Whether commands and odometry are the same numbers to the last bit."""
        one, other = self.recorded, self.again
        return one.reasons == other.reasons and all(
            getattr(one, name).tobytes() == getattr(other, name).tobytes()
            for name in ("times", "steering", "speeds", "twists", "stamps", "poses", "motions", "covariances")
        )


class _Collected:
    """Outputs as they come."""

    def __init__(self, steered: int, driven: int) -> None:
        self._widths = steered, driven
        self.times: list[int] = []
        self.joints: list[Sequence[float]] = []
        self.twists: list[Sequence[float]] = []
        self.reasons: list[str] = []
        self.stamps: list[int] = []
        self.motion: list[Sequence[float]] = []

    def add(self, step: Step) -> None:
        """What a step says."""
        if step.steering is not None and step.speeds is not None:
            self.times.append(step.now)
            self.joints.append([*step.steering, *step.speeds])
            self.twists.append(step.twist)
            self.reasons.append(rover_record.reason_names(step.reasons))
        if step.state is not None and step.stamp is not None:
            state = step.state
            both = (state.covariance_6x6().ravel(), state.twist_covariance_6x6().ravel())
            self.stamps.append(step.stamp)
            # The record has the yaw as a quaternion: it is compared as that.
            pose = planar_pose(state.pose.tolist())
            self.motion.append([*pose, *state.twist.tolist(), *both[0], *both[1]])

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


def replay(
    path: Path,
    changes: Mapping[str, Any] | None = None,
    output: Path | None = None,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> Replayed:
    """Run a record again.

    Parameters
    ----------
    path : Path
        A record of a node, or of a simulation.
    changes : mapping of str to object, optional
        Keys of the parameter file or options, with other values: ``{"limits.speed": 0.3}``.
    output : Path, optional
        A record of the new run, .mcap.
    progress : callable, optional
        Called now and then with how far it is and how far it will go.

    Raises
    ------
    RecordError
        If the file is no such record.
    ValueError
        If a change cannot be used.
    """
    record = Record(path)
    made_by = record.settings.get("made_by")
    if made_by not in LOOPS:
        raise RecordError(
            f"{path}: only a record of {' or '.join(LOOPS)} can be replayed, got one of {made_by}"
        )
    before = settings_of(record)
    after = before.changed(changes) if changes else before
    rover = before.rover
    if after.rover.command_joints != rover.command_joints:
        raise ValueError("changes must leave the joints of the rover as they are: the record is of those")
    again = _Again(after, changes or {}, Recorder(output, after, made_by) if output else None)
    recorded = _Collected(len(rover.steering_joints), len(rover.traction_joints))
    wanted: list[tuple[float, ...]] = []
    reasons = ""
    try:
        for number, message in enumerate(record.messages((*IN, *OUT))):
            if progress is not None and not number % 4096:
                progress(number, record.count)
            if message.topic in IN:
                given = again.take(record, message)
                if given is not None:
                    wanted.append((message.time, *given))
                continue
            content = record.parsed(message)
            if message.topic == rover_record.COMMANDS:
                steered = len(rover.steering_joints)
                recorded.times.append(message.time)
                recorded.joints.append([*content.position[:steered], *content.velocity[steered:]])
            elif message.topic == rover_record.LIMITED:
                recorded.twists.append(_planar(content.twist))
                recorded.reasons.append(reasons)
            elif message.topic == rover_record.REASONS:
                reasons = content.data
                recorded.reasons[-1] = reasons  # written behind the motion that it is about
            else:
                pose, twist = content.pose.pose, content.twist.twist
                recorded.stamps.append(message.stamp)
                recorded.motion.append(
                    [
                        *(pose.position.x, pose.position.y, pose.position.z),
                        *(pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w),
                        *_planar(twist),
                        *content.pose.covariance,
                        *content.twist.covariance,
                    ]
                )
    finally:
        again.close()
    if record.cut_off:  # in the middle of a step, perhaps
        steps, counted = max(min(len(recorded.times), len(recorded.twists)) - 1, 0), len(recorded.stamps)
        for each in (recorded, again.collected):
            each.end(steps, counted)
    result = Replayed(
        path.name, before, after, recorded.run(), again.collected.run(), np.array(wanted).reshape(-1, 4)
    )
    if record.cut_off:
        result.warnings.append(f"{path}: the record was cut off; it is replayed up to there")
    return result


class _Again:
    """A loop that is given what a record has."""

    def __init__(self, settings: Settings, changes: Mapping[str, Any], recorder: Recorder | None) -> None:
        self.loop = Loop(settings)
        rover = settings.rover
        self.collected = _Collected(len(rover.steering_joints), len(rover.traction_joints))
        self._changes, self._recorder = changes, recorder
        self._states = JointStates()

    def take(self, record: Record, message: Message) -> tuple[float, float, float] | None:
        """One event; the command, if it is one."""
        loop, recorder, now, step, given = self.loop, self._recorder, message.time, None, None
        if message.topic == rover_record.JOINTS:
            stamp, names, positions, velocities = self._states.parse(message.data)
            step = loop.joints(names, positions, velocities, stamp, now)
            if recorder is not None:
                recorder.joints(message.data, stamp, now)
        elif message.topic == rover_record.TICK:
            step = loop.tick(now)
            if recorder is not None:
                recorder.tick(now)
        elif message.topic == rover_record.WANTED:
            given = _planar(record.parsed(message).twist)
            loop.command(given, message.stamp, now)
            if recorder is not None:
                recorder.command(given, message.stamp, now)
        else:
            what = json.loads(record.parsed(message).data)
            self._change(what, now)
            if recorder is not None:
                recorder.change(what, now)
        if step is not None:
            self.collected.add(step)
            if recorder is not None:
                recorder.step(step)
        return given

    def _change(self, what: Mapping[str, Any], now: int) -> None:
        loop = self.loop
        if "set" in what:
            # What is asked for now goes before what was set then.
            kept = {key: value for key, value in what["set"].items() if key not in self._changes}
            if kept:
                loop.change(loop.settings.changed(kept), now)
        elif "pose" in what:
            loop.set_pose(what["pose"], what["covariance"], now)
        elif "reset" in what:
            loop.reset(now, what["reset"])
        elif "active" in what:
            loop.activate(now, what["active"])
        elif "begin" in what:
            loop.begin(now, what["begin"])

    def close(self) -> None:
        if self._recorder is not None:
            self._recorder.close()


def settings_of(record: Record) -> Settings:
    """What the loop of a record was told at its beginning."""
    text = record.files.get(rover_record.PARAMETERS)
    if text is None:
        raise RecordError(f"{record.path}: the record must hold the parameter file, got none")
    options = Options.of(json.loads(record.settings.get("options", "{}")))
    node = json.loads(record.settings.get("node", "null"))
    return Settings.of_text(text, node=node, path=record.path, options=options)


def _planar(twist: Any) -> tuple[float, float, float]:
    return twist.linear.x, twist.linear.y, twist.angular.z
