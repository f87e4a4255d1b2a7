"""A track as what sits somewhere in the body has it: poses, twists and covariances by a lever arm."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.kinematics.poses import Floats, as_poses, inverse, joined


def mount(sensor: ArrayLike) -> Floats:
    """The pose of a sensor in the body, shape (3,). Raises `ValueError` if it is not three finite numbers."""
    pose = np.asarray(sensor, dtype=np.float64)
    if pose.shape != (3,) or not np.isfinite(pose).all():
        raise ValueError(f"sensor must be three finite numbers, x, y and yaw, got {sensor!r}")
    return pose


def start_of_body(
    start: ArrayLike, covariance: ArrayLike | None, sensor: Floats
) -> tuple[Floats, Floats | None]:
    """Pose of the body whose sensor is at `start`, and the covariance of that pose."""
    seen = as_poses("start", np.atleast_2d(np.asarray(start, dtype=np.float64)), 1)
    body = joined(seen, inverse(sensor))
    if covariance is None:
        return body[0], None
    known = np.asarray(covariance, dtype=np.float64)
    back = np.linalg.inv(_carry(body, sensor)[0])
    return body[0], back @ (np.diag(known) if known.ndim == 1 else known) @ back.T


def seen_by(track: Track, sensor: Floats) -> Track:
    """The track of the sensor: world poses, twists in its own axes, covariances in world axes."""
    vx, vy, omega = track.twists.T
    moved = np.stack((vx - omega * sensor[1], vy + omega * sensor[0]), axis=-1)
    cos, sin = np.cos(sensor[2]), np.sin(sensor[2])
    turned = np.column_stack((moved @ np.array([[cos, -sin], [sin, cos]]), omega))
    covariances = track.covariances
    if covariances is not None:
        by = _carry(track.poses, sensor)
        covariances = by @ covariances @ by.transpose(0, 2, 1)
    return replace(track, poses=joined(track.poses, sensor), twists=turned, covariances=covariances)


def _carry(body: Floats, sensor: Floats) -> Floats:
    """Derivatives of the sensor's poses by those of the body (n, 3), shape (n, 3, 3)."""
    cos, sin = np.cos(body[:, 2]), np.sin(body[:, 2])
    by = np.tile(np.eye(3), (len(body), 1, 1))
    by[:, 0, 2] = -(sin * sensor[0] + cos * sensor[1])
    by[:, 1, 2] = cos * sensor[0] - sin * sensor[1]
    return by
