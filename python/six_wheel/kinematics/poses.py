"""Poses seen from poses: the few lines of SE(2) that evaluation and calibration share."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import numpy as np
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import compose, wrap_angle

Floats = NDArray[np.float64]


def inverse(poses: Floats) -> Floats:
    """Inverse poses: ``compose(inverse(p), p)`` is the identity. Shape (..., 3)."""
    x, y, yaw = np.moveaxis(poses, -1, 0)
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.stack((-cos * x - sin * y, sin * x - cos * y, -yaw), axis=-1)


def joined(first: Floats, second: Floats) -> Floats:
    """`compose` of poses whose shapes broadcast: one pose before or after many."""
    shape = np.broadcast_shapes(first.shape, second.shape)
    return compose(np.broadcast_to(first, shape), np.broadcast_to(second, shape))


def between(first: Floats, second: Floats) -> Floats:
    """`second` as seen from `first`, its yaw between -pi and pi. Shapes (..., 3)."""
    seen = joined(inverse(first), second)
    seen[..., 2] = wrap_angle(seen[..., 2])
    return seen


def rotations(attitudes: Floats) -> Floats:
    """Rotations (n, 3, 3) ``Rz(yaw) Ry(pitch) Rx(roll)`` of rows ``[roll, pitch, yaw]`` [rad]."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(attitudes).T, np.cos(attitudes).T
    rows = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    return np.ascontiguousarray(np.moveaxis(np.array(rows), (0, 1), (-2, -1)))


def quaternions(attitudes: Floats) -> Floats:
    """Quaternions x, y, z, w (n, 4) of ``Rz(yaw) Ry(pitch) Rx(roll)``: rows ``[roll, pitch, yaw]`` [rad]."""
    (r, p, y), (cr, cp, cy) = np.sin(attitudes / 2.0).T, np.cos(attitudes / 2.0).T
    parts = (
        r * cp * cy - cr * p * y,
        cr * p * cy + r * cp * y,
        cr * cp * y - r * p * cy,
        cr * cp * cy + r * p * y,
    )
    return np.stack(parts, axis=-1)


def as_poses(name: str, poses: ArrayLike, count: int | None = None, columns: int = 3) -> Floats:
    """`poses` as an array of shape (n, 3), or of as many `columns`, finite, with n >= 1 or `count` rows.
    Raises `ValueError` if it is not."""
    rows = np.ascontiguousarray(poses, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != columns or len(rows) == 0:
        raise ValueError(f"{name} must have shape (n, {columns}), n >= 1, got {rows.shape}")
    if count is not None and len(rows) != count:
        raise ValueError(f"{name} must have shape ({count}, {columns}), got {rows.shape}")
    if not (good := np.isfinite(rows).all(axis=1)).all():
        row = int(np.argmin(good))
        raise ValueError(f"{name} must be finite, got {rows[row].tolist()} in row {row}")
    return rows
