"""A record of a loop, run again event by event.

What comes in is taken from the record: commands, joint states, ticks, changes. The joint states are those
that were measured: what a rover would have measured under other commands nobody knows.
"""

import contextlib
import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from six_wheel.control_loop import Loop, Options, Settings, Step
from six_wheel.control_loop.recorder import Recorder
from six_wheel.control_loop.replay.command_replay import DRIVE, replay_drive
from six_wheel.control_loop.replay.run_summary import OUT, Collected, Replayed, planar
from six_wheel.kinematics.errors import as_path
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.objects.whole_files import replacing
from six_wheel.logs.mcap import Record, RecordError, rover_record
from six_wheel.logs.mcap.frames import JointStates, angular_velocity
from six_wheel.logs.mcap.reader import Message

LOOPS = ("node",)
READ = ("odometry", "simulate")  # records of what was measured
IN = (rover_record.WANTED, rover_record.JOINTS, rover_record.IMU, rover_record.TICK, rover_record.CHANGES)


@checked()
def replay(
    path: str | os.PathLike[str],
    changes: Mapping[str, Any] | None = None,
    output: str | os.PathLike[str] | None = None,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> Replayed:
    """Run a record again.

    Parameters
    ----------
    path : path
        A record of a node, or of a drive.
    changes : mapping of str to object, optional
        Keys of the parameter file or options, with other values: ``{"limits.speed": 0.3}``.
    output : path, optional
        A record of the new run, .mcap.
    progress : callable, optional
        Called now and then with how far it is and how far it will go.

    Returns
    -------
    Replayed
        The recorded run and the new one, which `compare` takes.

    Raises
    ------
    RecordError
        If the file is no such record.
    ValueError
        If a change cannot be used.
    """
    path = as_path("path", path)
    output = None if output is None else as_path("output", output)
    record = Record(path)
    made_by = record.settings.get("made_by")
    if made_by not in (*LOOPS, DRIVE):
        had = "readings" if made_by in READ else "none"
        remedy = f"; six-wheel odometry ROVER {path} reckons it again" if made_by in READ else ""
        message = f"only a record of {' or '.join((*LOOPS, DRIVE))} has commands to run again"
        raise RecordError(f"{path}: {message}, got one of {made_by}, which has {had}{remedy}")
    before = settings_of(record)
    after = before.changed(changes) if changes else before
    rover = before.rover
    if after.rover.joint_names != rover.joint_names:
        raise ValueError("changes must leave the joints of the rover as they are: the record is of those")
    with contextlib.ExitStack() as stack:
        target = None if output is None else stack.enter_context(replacing(output, [path]))
        if made_by == DRIVE:
            result = replay_drive(record, before, after, target, progress)
        else:
            result = _replay_loop(record, before, after, changes or {}, target, progress)
    if record.cut_off:
        result.warnings.append(f"{path}: the record was cut off; it is replayed up to there")
    return result


def _replay_loop(
    record: Record,
    before: Settings,
    after: Settings,
    changes: Mapping[str, Any],
    output: Path | None,
    progress: Callable[[int, int], None] | None,
) -> Replayed:
    """A node's events through a loop."""
    recorder = Recorder(output, after, "node") if output else None
    again = _Again(after, changes, recorder)
    recorded = Collected(before.rover)
    wanted: list[tuple[float, ...]] = []
    try:
        for number, message in enumerate(record.messages((*IN, *OUT))):
            if progress is not None and not number % 4096:
                progress(number, record.count)
            if message.topic in IN:
                given = again.take(record, message)
                if given is not None:
                    wanted.append((message.time, *given))
                continue
            recorded.read(record, message)
    finally:
        again.close()
    if record.cut_off:  # in the middle of a step, perhaps
        steps, counted = max(min(len(recorded.times), len(recorded.twists)) - 1, 0), len(recorded.stamps)
        for each in (recorded, again.collected):
            each.end(steps, counted)
    commands = np.array(wanted).reshape(-1, 4)
    return Replayed(record.path.name, before, after, recorded.run(), again.collected.run(), commands)


class _Again:
    """A loop that is given what a record has."""

    def __init__(self, settings: Settings, changes: Mapping[str, Any], recorder: Recorder | None) -> None:
        self.loop = Loop(settings)
        self.collected = Collected(settings.rover)
        self._changes, self._recorder = changes, recorder
        self._states = JointStates()

    def take(self, record: Record, message: Message) -> tuple[float, float, float] | None:
        """One event; the command, if it is one."""
        loop, recorder, now, step, given = self.loop, self._recorder, message.time, None, None
        if message.topic == rover_record.JOINTS:
            with record.reading(f"a message of {message.topic}"):
                stamp, names, positions, velocities = self._states.parse(message.data)
            step = loop.joints(names, positions, velocities, stamp, now)
            if recorder is not None:
                recorder.joint_message(now, stamp, message.data)
        elif message.topic == rover_record.IMU:
            with record.reading(f"a message of {message.topic}"):
                stamp, _, rates, _ = angular_velocity(message.data)
            step = loop.imu(rates, stamp, now)
            if recorder is not None:
                recorder.imu_message(now, stamp, message.data)
        elif message.topic == rover_record.TICK:
            step = loop.tick(now)
            if recorder is not None:
                recorder.tick(now)
        elif message.topic == rover_record.WANTED:
            given = planar(record.parsed(message).twist)
            loop.command(given, message.stamp, now)
            if recorder is not None:
                recorder.wanted(now, message.stamp, given)
        else:
            with record.reading("a change"):
                what = json.loads(record.parsed(message).data)
                step = self._change(what, now)
            if recorder is not None:
                recorder.change(now, what)
        if step is not None:
            self.collected.add(step)
            if recorder is not None:
                recorder.step(step)
        return given

    def _change(self, what: Mapping[str, Any], now: int) -> Step | None:
        """Apply a recorded change to the loop; returns a step if the change is the last one."""
        loop = self.loop
        if "set" in what:
            # Changes asked for in the rerun take precedence over recorded ones.
            kept = {key: value for key, value in what["set"].items() if key not in self._changes}
            if kept:
                loop.change(loop.settings.changed(kept), now)
        elif "pose" in what:
            loop.set_pose(what["pose"], what["covariance"], now)
        elif "reset" in what:
            loop.reset(now, what["reset"])
        elif "up" in what:
            loop.mount(what["up"], now)
        elif "active" in what:
            loop.activate(now, what["active"])
        elif "begin" in what:
            loop.begin(now, what["begin"])
        elif "halt" in what:
            loop.halt(now)
        elif "release" in what:
            loop.release(now)
        elif "end" in what:
            return loop.end(now)
        return None

    def close(self) -> None:
        if self._recorder is not None:
            self._recorder.close()


def settings_of(record: Record) -> Settings:
    """Settings of the loop of a record at its beginning."""
    text = record.files.get(rover_record.PARAMETERS)
    if text is None:
        raise RecordError(f"{record.path}: the record must hold the parameter file, got none")
    with record.reading("a setting"):
        options = Options.of(json.loads(record.settings.get("options", "{}")))
        node = json.loads(record.settings.get("node", "null"))
    return Settings.of_text(text, node=node, path=record.path, options=options)
