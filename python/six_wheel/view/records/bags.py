"""Records of `drive`, `odometry`, `simulate` and the node: MCAP files of this package."""

from __future__ import annotations  # rosbags is loaded for a file

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.control_loop.replay.rerun import settings_of
from six_wheel.control_loop.replay.run_summary import OUT, Collected
from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.mcap import Record as Bag
from six_wheel.logs.mcap import RecordError, rover_record
from six_wheel.logs.recordings import GroundTruth
from six_wheel.robot_description.wheels_of_rover import joints_as_given
from six_wheel.view.records.record import Record


def read_bag(path: Path, owner: Rover | None) -> Record:
    """The record in an MCAP file, with the rover of its own parameter file unless another is given. Raises
    `RecordError` if the file is none of this package, or has no poses."""
    bag = Bag(path)
    settings = settings_of(bag)
    rover = settings.rover if owner is None else owner
    collected = Collected(rover)
    truth: list[tuple[float, float, float, float]] = []
    readings: list[tuple[int, dict[str, float]]] = []
    for message in bag.messages((*OUT, rover_record.TRUTH, rover_record.JOINTS)):
        if message.topic == rover_record.TRUTH:
            pose = bag.parsed(message).pose
            yaw = 2.0 * np.arctan2(pose.orientation.z, pose.orientation.w)
            truth.append((message.time, pose.position.x, pose.position.y, float(yaw)))
        elif message.topic == rover_record.JOINTS:
            states = bag.parsed(message)
            if len(states.position) == len(states.name):
                readings.append((message.time, dict(zip(states.name, states.position, strict=True))))
        elif message.topic != rover_record.REASONS or collected.reasons:
            collected.read(bag, message)
    run = collected.run()
    if not len(run.stamps):
        raise RecordError(f"{path}: the record must have odometry, got none")
    order = np.argsort(run.stamps, kind="stable")
    stamps, poses = run.stamps[order], run.poses[order]
    times = (stamps - stamps[0]) / 1e9
    covariances = run.covariances[order][:, :36].reshape(-1, 6, 6)[:, :2, :2]
    steering, speeds = _joints(rover, run.times, np.hstack([run.steering, run.wheel_speeds]), stamps)
    if steering is None and readings:
        steering, speeds = _read(rover, readings, stamps)
    reasons = None
    if any(run.reasons):
        names = [[Reason[name] for name in text.split("|") if name] for text in run.reasons]
        bits = np.array([sum(map(int, each)) for each in names], np.uint32)
        reasons = bits[_latest(run.times, stamps)]
    known = None
    if len(truth) > 1:
        rows = np.array(truth)
        later = np.concatenate([[True], np.diff(rows[:, 0]) > 0])
        known = GroundTruth((rows[later, 0] - stamps[0]) / 1e9, rows[later, 1:])
    return Record(
        rover,
        path.name,
        times,
        poses,
        steering,
        speeds,
        twists=run.motions[order],
        covariances=covariances,
        reasons=reasons,
        truth=known,
        suspension=rover.suspension,
        limits=settings.parameters.limits,
    )


def _latest(times: NDArray[np.int64], stamps: NDArray[np.int64]) -> NDArray[np.intp]:
    return np.clip(np.searchsorted(times, stamps, side="right") - 1, 0, max(len(times) - 1, 0))


def _joints(
    rover: Rover, times: NDArray[np.int64], rows: Floats, stamps: NDArray[np.int64]
) -> tuple[Floats | None, Floats | None]:
    """Angles and speeds in the rover's order at some times, of commands in the order of its joints."""
    if not len(times):
        return None, None
    names = [joint for joints in joints_as_given(rover) for joint in joints]
    values = dict(zip(names, rows[_latest(times, stamps)].T, strict=True))
    steering, speeds = rover.readings(values)
    return (steering if rover.steered_wheel_names else None), speeds


def _read(
    rover: Rover, readings: list[tuple[int, dict[str, float]]], stamps: NDArray[np.int64]
) -> tuple[Floats | None, Floats | None]:
    """The same of angles that were measured: speeds are their differences."""
    joints = list(rover.joint_names)
    rows = [
        (time, [found[joint] for joint in joints]) for time, found in readings if found.keys() >= {*joints}
    ]
    if len(rows) < 2:
        return None, None
    times = np.array([time for time, _ in rows])
    steering, angles = rover.readings(dict(zip(joints, np.array([row for _, row in rows]).T, strict=True)))
    speeds = np.gradient(angles, np.maximum.accumulate(times) / 1e9, axis=0)
    at = _latest(times, stamps)
    return (steering[at] if rover.steered_wheel_names else None), np.nan_to_num(speeds[at])
