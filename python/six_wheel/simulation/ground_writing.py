"""A drive over ground as a table, or as a bag with transforms that viewers draw."""

from pathlib import Path
from typing import Any

import numpy as np

from six_wheel._core import RockerBogie
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.objects.whole_files import replacing
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.mcap import frames
from six_wheel.logs.mcap.rover_record import IMU, JOINTS, ODOMETRY, TRANSFORMS, TRUTH
from six_wheel.logs.mcap.writer import record_stamps
from six_wheel.logs.recordings import WheelLog
from six_wheel.logs.tables import FORMATS, table_format
from six_wheel.simulation.on_terrain import GroundSimulation
from six_wheel.simulation.writing import (
    BAG,
    BODY,
    POSE,
    WORLD,
    Messages,
    joint_columns,
    reading_columns,
    reckoned,
    record_of,
    write_columns,
)

ENDINGS = (*FORMATS, BAG)


@checked()
def write_ground(run: GroundSimulation, suspension: RockerBogie, path: str | Path) -> None:
    """Write a drive over ground.

    Raises `TableError` if the ending is none of these. Raises `ModuleNotFoundError` if what writes the format
    is not installed.

    Parameters
    ----------
    run : GroundSimulation
        Result of `simulate`.
    suspension : RockerBogie
        Suspension that drove.
    path : str or Path
        .csv or .parquet: readings and truth as `write_log` has them, and ``z``, ``roll``, ``pitch``, the
        joints, the IMU and, wheel by wheel, speed, contact angle, slip ratio and slip angle. .mcap: joint
        states, transforms from ``map`` to ``base_link`` and to every wheel, the true pose and the IMU. A
        file that is there is replaced once the new one is complete.
    """
    target = Path(path)
    if target.suffix.lower() == BAG:
        _write_bag(run, suspension, target)
        return
    table_format(target, ENDINGS)
    columns = _columns(run, suspension)
    write_columns(
        target, columns, {*dict(POSE), *(name for name, (unit, _) in columns.items() if unit in ("s", "1"))}
    )


def _columns(run: GroundSimulation, suspension: RockerBogie) -> dict[str, tuple[str, Any]]:
    """Name to unit and values, in the order of the table."""
    planar, stand = suspension.planar(), run.stand
    columns = reading_columns(run, planar)
    for (name, unit), values in zip(POSE, run.truth.poses.T, strict=True):
        columns[name] = (unit, values)
    columns["status"] = ("1", np.asarray(stand.status).astype(str))
    columns |= {"z": ("m", stand.z), "roll": ("rad", stand.roll), "pitch": ("rad", stand.pitch)}
    for name, values in zip(suspension.free_joints, stand.joints.T, strict=True):
        columns[name] = ("rad", values)
    for name, values in zip("xyzw", run.orientations.T, strict=True):
        columns[f"orientation_{name}"] = ("1", values)
    for name, values in zip("xyz", run.angular_velocity.T, strict=True):
        columns[f"angular_velocity_{name}"] = ("rad/s", values)
    for unit, quantity, table in (
        ("rad/s", "speed", run.wheel_speeds),
        ("rad", "contact_angle", stand.contact_angles),
        ("1", "slip_ratio", run.slip.ratio),
        ("rad", "slip_angle", run.slip.angle),
    ):
        for wheel, values in zip(suspension.wheel_names, table.T, strict=True):
            columns[f"{wheel}_{quantity}"] = (unit, values)
    return columns


def _write_bag(run: GroundSimulation, suspension: RockerBogie, path: Path) -> None:
    planar, stand = suspension.planar(), run.stand
    columns = joint_columns(run, planar) | dict(zip(suspension.free_joints, stand.joints.T, strict=True))
    rows = np.stack(list(columns.values()), axis=-1)
    places = np.column_stack((run.truth.poses[:, :2], stand.z))
    wheels = _wheel_transforms(run.in_radians(planar), run, suspension)
    with replacing(path) as place, record_of(place, planar) as writer:
        messages = Messages(writer, list(columns), (WORLD, BODY), *((BODY, name) for name in wheels))
        odometry = reckoned(run, planar)
        for row, stamp in enumerate(record_stamps(run.stamps, np.arange(1, 1 + len(run.stamps))).tolist()):
            if not np.isfinite(places[row]).all():
                continue  # no way to stand was found here
            there = (*places[row], *run.orientations[row])
            messages.write(JOINTS, stamp, rows[row])
            messages.write(TRANSFORMS, stamp, there, *(transform[row] for transform in wheels.values()))
            messages.write(TRUTH, stamp, there)
            messages.write(ODOMETRY, stamp, *odometry[row])
            messages.write(IMU, stamp, frames.inertial(run.angular_velocity[row], run.orientations[row]))


def _wheel_transforms(turned: WheelLog, run: GroundSimulation, suspension: RockerBogie) -> dict[str, Floats]:
    """Place and quaternion in the body of every wheel, turned as far as it has rolled, row by row."""
    joints = np.nan_to_num(run.stand.joints)
    found = suspension.frames(joints, np.nan_to_num(run.stand.steering))
    transforms = {}
    for number, name in enumerate(suspension.wheel_names):
        frame = found[f"A{number + 1}"]
        half = np.nan_to_num(turned.wheel_angles[:, number]) / 2.0
        spin = np.stack([np.zeros_like(half), np.sin(half), np.zeros_like(half), np.cos(half)], axis=-1)
        axes = _product(_quaternion(frame[:, :3, :3]), spin)
        transforms[name] = np.concatenate([frame[:, :3, 3], axes], axis=1)
    return transforms


def _quaternion(rotation: Floats) -> Floats:
    """Quaternions x, y, z, w (n, 4) of rotations by less than half a turn."""
    w = np.sqrt(np.maximum(0.0, 1.0 + np.trace(rotation, axis1=1, axis2=2))) / 2.0
    pairs = ((2, 1), (0, 2), (1, 0))
    vector = [(rotation[:, i, k] - rotation[:, k, i]) / (4.0 * w) for i, k in pairs]
    return np.stack([*vector, w], axis=-1)


def _product(first: Floats, second: Floats) -> Floats:
    """Product of quaternions x, y, z, w (n, 4)."""
    a, b = first[:, :3], second[:, :3]
    s, t = first[:, 3:], second[:, 3:]
    return np.concatenate(
        [s * b + t * a + np.cross(a, b), s * t - np.sum(a * b, axis=1, keepdims=True)], axis=1
    )
