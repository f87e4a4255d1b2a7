"""Poses and twists in the plane, and how arrays of them are read."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.float64]
MaybeArray: TypeAlias = ArrayLike | None


def wrap_angle(angle: ArrayLike) -> Any:
    """Bring angles [rad] into [-pi, pi]; what lies there already is returned as it is. Any shape."""
    angles = finite("angle", angle)
    wrapped = [a if abs(a) <= math.pi else math.remainder(a, math.tau) for a in angles.flat]
    return np.array(wrapped, dtype=float).reshape(angles.shape) if angles.ndim else float(wrapped[0])


def _rotate(angle: float, x: float, y: float) -> tuple[float, float]:
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * x - sin * y, sin * x + cos * y


def _compose(first: Floats, second: Floats) -> tuple[float, float, float]:
    dx, dy = _rotate(first[2], second[0], second[1])
    return first[0] + dx, first[1] + dy, first[2] + second[2]


def compose(first: ArrayLike, second: ArrayLike) -> Floats:
    """``a_from_c = a_from_b * b_from_c``: poses (..., 3) and (..., 3) -> (..., 3), yaw not wrapped."""
    return rowwise(_compose, finite("first", first), finite("second", second))


def exp(twist: ArrayLike, dt: ArrayLike = 1.0) -> Floats:
    """Pose of the body frame after holding a twist for `dt` [s]: (..., 3) -> (..., 3), yaw not wrapped."""

    def pose(row: Floats, step: Floats) -> tuple[float, float, float]:
        turn = row[2] * step[0]
        # The chord leaves at half the turn, and np.sinc(x) is sin(pi x) / (pi x): nothing cancels near zero.
        length = np.sinc(turn / math.tau) * step[0]
        return *_rotate(turn / 2.0, length * row[0], length * row[1]), turn

    return rowwise(pose, finite("twist", twist), _steps(dt, zero=True))


def log(pose: ArrayLike, dt: ArrayLike = 1.0) -> Floats:
    """The constant twist that reaches a pose in `dt` [s] by the shortest turn: (..., 3) -> (..., 3)."""

    def twist(row: Floats, step: Floats) -> tuple[float, float, float]:
        turn = wrap_angle(row[2])
        length = np.sinc(turn / math.tau) * step[0]
        return *_rotate(-turn / 2.0, row[0] / length, row[1] / length), turn / step[0]

    return rowwise(twist, finite("pose", pose), _steps(dt))


def integrate(twists: ArrayLike, dt: ArrayLike, start: ArrayLike = (0.0, 0.0, 0.0)) -> Floats:
    """Hold twists (..., n, 3) for `dt` [s], scalar or (n,): poses (..., n + 1, 3), yaw not wrapped."""
    steps = exp(twists, dt)
    poses = np.empty((*steps.shape[:-2], steps.shape[-2] + 1, 3))
    for index in np.ndindex(steps.shape[:-2]):
        poses[(*index, 0)] = finite("start", start)
        for k, step in enumerate(steps[index]):
            poses[(*index, k + 1)] = _compose(poses[(*index, k)], step)
    return poses


def differentiate(poses: ArrayLike, dt: ArrayLike) -> Floats:
    """The inverse of `integrate`: poses (..., n + 1, 3) -> twists (..., n, 3), each by the shortest turn."""

    def step(before: Floats, after: Floats) -> tuple[float, float, float]:
        x, y, turn = after - before
        return *_rotate(-before[2], x, y), turn

    rows = finite("poses", poses)
    return log(rowwise(step, rows[..., :-1, :], rows[..., 1:, :]), dt)


def finite(name: str, values: ArrayLike) -> Floats:
    """`values` as an array; `ValueError` unless all are finite."""
    array = np.asarray(values, dtype=float)
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name} must be finite, got {array[~np.isfinite(array)][0]}")
    return array


def _steps(dt: ArrayLike, *, zero: bool = False) -> Floats:
    steps = finite("dt", dt)
    if np.any(steps < 0.0 if zero else steps <= 0.0):
        raise ValueError(f"dt must be {'not negative' if zero else 'positive'}, got {np.min(steps)}")
    return steps[..., None]  # an axis of length 1, to stand beside rows


def or_zeros(name: str, values: MaybeArray, shape: tuple[int, ...]) -> Floats:
    """`values` spread to a shape, zeros for None."""
    return np.zeros(shape) if values is None else np.broadcast_to(finite(name, values), shape)


def rowwise(function: Callable[..., Sequence[float] | Floats], *arrays: Floats, width: int = 3) -> Floats:
    """`function` of the last axes of `arrays`, over their leading axes broadcast together."""
    lead = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
    spread = [np.broadcast_to(array, (*lead, array.shape[-1])) for array in arrays]
    rows = [function(*(array[i] for array in spread)) for i in np.ndindex(lead)]
    return np.array(rows, dtype=float).reshape(*lead, width)
