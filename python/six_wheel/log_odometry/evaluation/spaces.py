"""Paths in the plane (n, 3) and in space (n, 6) under the same few operations.

A path is kept as rows x, y, yaw in the plane and as transforms ``world_from_body`` (n, 4, 4) in space, made
of rows x, y, z, roll, pitch, yaw with ``Rz(yaw) Ry(pitch) Rx(roll)``.
"""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
import reprlib

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import wrap_angle
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.kinematics.poses import Floats, as_poses, between, inverse, joined
from six_wheel.logs.ground_truth import rows_of, transforms

SPACE = 6  # columns of poses in space


def as_path(name: str, poses: ArrayLike, like: Floats | None = None) -> Floats:
    """Poses as a path, which has the rows and the kind of `like` where that is given; else a `ValueError`."""
    try:
        rows = np.asarray(poses, dtype=np.float64)
    except (TypeError, ValueError):
        rows = np.empty(())
    if rows.ndim == 0:
        got = reprlib.repr(poses)
        raise ArgumentTypeError(f"{name} must be poses, rows of three or six numbers, got {got}")
    columns = (
        (SPACE if rows.shape[1:] == (SPACE,) else 3) if like is None else (3 if like.ndim == 2 else SPACE)
    )
    rows = as_poses(name, poses, None if like is None else len(like), columns)
    return rows if columns == 3 else transforms(rows)


def positions(path: Floats) -> Floats:
    """Positions of the body, shape (n, 2) or (n, 3) [m]."""
    return path[:, :2] if path.ndim == 2 else path[:, :3, 3]


def lengths(vectors: Floats) -> Floats:
    """Lengths of the rows of vectors (n, 2) or (n, 3); of those in the plane without overflow."""
    found: Floats = np.hypot(*vectors.T) if vectors.shape[1] == 2 else np.linalg.norm(vectors, axis=1)
    return found


def moved_by(pose: Floats, path: Floats) -> Floats:
    """The path as a rigid body, moved by a pose on its left."""
    return pose @ path if _in_space(path) else joined(pose, path)


def inverse_of(pose: Floats) -> Floats:
    """The inverse of one pose or of several."""
    if not _in_space(pose):
        return inverse(pose)
    back = np.zeros_like(pose)
    turned = np.swapaxes(pose[..., :3, :3], -1, -2)
    back[..., :3, :3], back[..., 3, 3] = turned, 1.0
    back[..., :3, 3] = -(turned @ pose[..., :3, 3:])[..., 0]
    return back


def seen_from(first: Floats, second: Floats) -> Floats:
    """`second` as seen from `first`, row by row."""
    return inverse_of(first) @ second if _in_space(first) else between(first, second)


def differences(moved: Floats, wanted: Floats) -> tuple[Floats, Floats]:
    """Distances of poses [m] and angles [rad]: in the plane the signed yaw, in space that of the rotation."""
    distances = lengths(positions(moved) - positions(wanted))
    if not _in_space(moved):
        return distances, np.asarray(wrap_angle(moved[:, 2] - wanted[:, 2]))
    # ‖R − Q‖² = 8 sin²(θ / 2): as exact near zero as the matrices are.
    chord = np.linalg.norm(moved[:, :3, :3] - wanted[:, :3, :3], axis=(1, 2)) / math.sqrt(8.0)
    return distances, 2.0 * np.arcsin(np.minimum(chord, 1.0))


def best_fit(moved: Floats, wanted: Floats) -> Floats:
    """The pose that brings the positions of one path nearest to those of another, without scale.

    Source: Umeyama, Least-Squares Estimation of Transformation Parameters Between Two Point Patterns,
    IEEE PAMI 13(4), 1991; in the plane the rotation is one `atan2`.
    """
    centre, onto = positions(moved).mean(axis=0), positions(wanted).mean(axis=0)
    products = (positions(moved) - centre).T @ (positions(wanted) - onto)
    if moved.ndim == 2:
        yaw = math.atan2(products[0, 1] - products[1, 0], products[0, 0] + products[1, 1])
        return joined(np.array((*onto, yaw)), np.array((*-centre, 0.0)))
    left, _, right = np.linalg.svd(products)
    keep_handedness = np.diag((1.0, 1.0, np.sign(np.linalg.det(left) * np.linalg.det(right))))
    pose = np.eye(4)
    pose[:3, :3] = right.T @ keep_handedness @ left.T
    pose[:3, 3] = onto - pose[:3, :3] @ centre
    return pose


def poses_of(path: Floats) -> Floats:
    """The rows of a path: x, y, yaw, or x, y, z, roll, pitch, yaw."""
    return path if path.ndim == 2 else rows_of(path)


def _in_space(poses: Floats) -> bool:
    return poses.shape[-2:] == (4, 4)
