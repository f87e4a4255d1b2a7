"""Records out of tracks, logs, simulations, drives and files."""

from __future__ import annotations  # pyarrow and rosbags are loaded for files

import os
from pathlib import Path
from typing import Any

import numpy as np

from six_wheel._core import Rover
from six_wheel.kinematics.odometry import Track
from six_wheel.kinematics.odometry.tracks3 import Track3
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry import dead_reckon
from six_wheel.logs.recordings import GroundTruth, WheelLog
from six_wheel.robot_description.missing_files import no_file
from six_wheel.view.records.record import Record
from six_wheel.view.records.tables import read_table

ENDINGS = (".mcap", ".csv", ".parquet", ".db3")
DRIVES = ("ControlledDrive", "Drive")


def is_record(what: Any) -> bool:
    """True for a record, by its type or the ending of its file."""
    if isinstance(what, str | os.PathLike):
        path = Path(what)
        return path.suffix.lower() in ENDINGS or (path / "metadata.yaml").exists()
    return isinstance(what, Track | Track3 | WheelLog) or type(what).__name__ in DRIVES


def find_record(what: Any, owner: Rover | None) -> Record:
    """The record in an object or a file; `owner` is whose it is where it does not say. Raises `ValueError` if
    it cannot be read, or nothing says whose it is."""
    if isinstance(what, str | os.PathLike):
        return _of_file(Path(what), owner)
    if isinstance(what, Track):
        return _of_track(what, "track")
    if isinstance(what, Track3):
        return _of_track3(what)
    if isinstance(what, WheelLog):
        return _of_log(what, owner)
    return _of_drive(what)


def _since(stamps: Any) -> Floats:
    times = np.asarray(stamps, dtype=np.float64)
    return times - times[0] if len(times) else times


def _needed(owner: Rover | None, name: str) -> Rover:
    if owner is None:
        raise ValueError(
            f"{name}: rover must say whose record it is; give --rover ROVER, or rover= in Python"
        )
    return owner


def _of_track(track: Track, name: str, log: WheelLog | None = None) -> Record:
    covariances = None if track.covariances is None else track.covariances[:, :2, :2]
    steering = speeds = truth = None
    if log is not None:
        steering = log.steering
        speeds = (
            np.gradient(log.wheel_angles, np.maximum.accumulate(log.stamps), axis=0) if len(log) > 1 else None
        )
        if log.truth is not None:
            truth = GroundTruth(log.truth.stamps - log.stamps[0], log.truth.poses, log.truth.max_gap)
    return Record(
        track.rover, name, _since(track.stamps), track.poses, steering, speeds, track.residuals, track.twists,
        covariances=covariances, truth=truth,
    )  # fmt: skip


def _of_track3(track: Track3) -> Record:
    suspension: Any = track.suspension
    slips = None if track.slips is None else np.linalg.norm(track.slips, axis=-1)
    covariances = None if track.covariances is None else track.covariances[:, :2, :2]
    return Record(
        suspension.planar(), "track", _since(track.stamps), track.poses[:, [0, 1, 5]],
        slips=slips, twists=track.twists[:, [0, 1, 5]], covariances=covariances, suspension=suspension,
    )  # fmt: skip


def _of_log(log: WheelLog, owner: Rover | None) -> Record:
    stand = getattr(log, "stand", None)
    if stand is not None:  # a simulation on ground knows all there is
        suspension = stand.suspension
        made: Any = log
        slips = (
            np.abs(made.slip.ratio) * np.abs(made.wheel_speeds) * float(suspension.dimensions["wheel_radius"])
        )
        return Record(
            suspension.planar(), log.name or "simulation", _since(log.stamps), stand.poses,
            stand.steering, made.wheel_speeds, np.nan_to_num(slips), made.twists[:, [0, 1, 5]],
            suspension=suspension, ground=stand.ground,
        )  # fmt: skip
    rover = _needed(owner, log.name or "the log")
    whole = log.in_radians(rover)
    start = (0.0, 0.0, 0.0)
    if whole.truth is not None:
        first = whole.truth.at(whole.stamps[:1])[0]
        start = tuple(first) if np.isfinite(first).all() else start
    return _of_track(dead_reckon(rover, whole, start=start), log.name or "log", whole)


def _of_drive(engine: Any) -> Record:
    """A drive that has ended: its path evenly in time, the middle of what its joints did there."""
    rover = engine.rover
    poses, steering = engine.trace.path()
    times = np.linspace(0.0, engine.summary.duration, len(poses))
    course = getattr(engine, "course", None)
    if course is None:
        return Record(rover, "drive", times, poses, steering)
    begins, low, high, reasons = course.stretches()
    middle = (low + high) / 2.0
    rows = np.clip(np.searchsorted(begins, times, side="right") - 1, 0, len(begins) - 1)
    wheels = len(rover.wheels)
    return Record(
        rover, "drive", times, poses, steering, middle[rows, -wheels:],
        twists=middle[rows, 3:6], commanded=middle[rows, :3],
        reasons=reasons[rows], limits=engine.limits,
    )  # fmt: skip


def _of_file(path: Path, owner: Rover | None) -> Record:
    if not path.exists():
        raise ValueError(no_file(path))
    if path.suffix.lower() == ".mcap":
        from six_wheel.logs.mcap import RecordError
        from six_wheel.view.records.bags import read_bag

        try:
            return read_bag(path, owner)
        except RecordError:
            if owner is None:
                raise
    elif path.suffix.lower() in (".csv", ".parquet"):
        table = read_table(path)
        if table.has_poses:
            return table.record(_needed(owner, str(path)))
    from six_wheel.logs.detect_reader import read_log

    log, _ = read_log(path, _needed(owner, str(path)))
    return _of_log(log, owner)
