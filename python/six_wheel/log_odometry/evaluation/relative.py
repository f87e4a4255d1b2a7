"""Errors of the motion over stretches of a path."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry.evaluation.spaces import as_path, differences, lengths, positions, seen_from

Rows = NDArray[np.int64]


# Every fifth pose starts a segment: neighbours see nearly the same stretch of path.
STRIDE = 5


def rms(values: Floats) -> float:
    return math.sqrt(float(np.mean(np.square(values)))) if values.size else math.nan


@checked()
def path_distance(poses: ArrayLike) -> Floats:
    """Distance driven up to each pose, as the sum of the chords [m], shape (n,)."""
    return _distance(as_path("poses", poses))


def _distance(path: Floats) -> Floats:
    return np.concatenate(([0.0], np.cumsum(lengths(np.diff(positions(path), axis=0)))))


@checked()
def segments(poses: ArrayLike, length: float, *, stride: int | None = STRIDE) -> Rows:
    """First and last row of the stretches of a path that are `length` long.

    Parameters
    ----------
    poses : array_like, shape (n, 3) or (n, 6)
        The true path, as in `evaluate`.
    length : float
        Of a stretch [m]; it ends with the first pose at which that distance is reached.
    stride : int or None, default 5
        Every how many rows a stretch begins; None: where the one before it ended.

    Returns
    -------
    ndarray of int, shape (m, 2)
        No rows where the path is shorter than `length`.

    Raises
    ------
    ValueError
        If `length` is not finite and positive or `stride` not a positive integer.
    """
    if not (math.isfinite(length) and length > 0.0):
        raise ValueError(f"length must be finite and positive, got {length}")
    if stride is not None and stride < 1:
        raise ValueError(f"stride must be 1 or more, or None, got {stride}")
    along = path_distance(poses)
    if stride is not None:
        first = np.arange(0, len(along), stride)
        last = np.searchsorted(along, along[first] + length)
        pairs = np.stack((first, last), axis=1)[last < len(along)]
        return pairs.astype(np.int64, copy=False)
    rows = [0]
    # Where distances are no numbers, or so long that `length` is lost in their rounding, no row is farther.
    while rows[-1] < (end := int(np.searchsorted(along, along[rows[-1]] + length))) < len(along):
        rows.append(end)
    return np.stack((rows[:-1], rows[1:]), axis=1).astype(np.int64, copy=False)


@dataclass(frozen=True, eq=False)
class RelativeError:
    """Error of the motion over stretches of the true path that are `length` [m] long.

    `rows` (m, 2) are their ends, `position` [m] and `heading` [rad, signed; in space the angle of the
    rotation], both (m,), the error at the end of the estimated motion over a stretch. Without a stretch that
    long the figures are NaN.
    """

    length: float
    rows: Rows = field(repr=False)
    position: Floats = field(repr=False)
    heading: Floats = field(repr=False)

    @property
    def rmse(self) -> float:
        """Root mean square of the position error [m]."""
        return rms(self.position)

    @property
    def percent(self) -> float:
        """The same as a share of `length` [%]."""
        return 100.0 * self.rmse / self.length

    @property
    def yaw_rmse(self) -> float:
        """Root mean square of the heading error [rad]."""
        return rms(self.heading)

    def __repr__(self) -> str:
        return (
            f"RelativeError({len(self.rows)} x {self.length:g} m: rmse {self.percent:.2f} %, "
            f"{math.degrees(self.yaw_rmse):.2f} deg)"
        )


@checked()
def relative_error(
    estimate: ArrayLike,
    truth: ArrayLike,
    length: float = 0.5,
    *,
    stride: int | None = STRIDE,
    rows: ArrayLike | None = None,
) -> RelativeError:
    """Relative pose error over stretches of the true path.

    Parameters
    ----------
    estimate, truth : array_like, shape (n, 3) or (n, 6)
        Poses at the same times, as in `evaluate`; how the paths lie to each other does not matter.
    length, stride
        As in `segments`.
    rows : array_like of int, shape (m, 2), optional
        Ends of the stretches, instead of those that `segments` finds.

    Raises
    ------
    ValueError
        If the shapes differ, a pose is not finite or a row is not there.
    """
    wanted = as_path("truth", truth)
    moved = as_path("estimate", estimate, wanted)
    pairs = segments(truth, length, stride=stride) if rows is None else np.asarray(rows, dtype=np.int64)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise ValueError(f"rows must have shape (m, 2), got {pairs.shape}")
    if pairs.size and not (pairs.min() >= 0 and pairs.max() < len(wanted)):
        raise ValueError(f"rows must be in 0 to {len(wanted) - 1}, got {pairs.min()} to {pairs.max()}")
    first, last = pairs.T
    real, estimated = (seen_from(path[first], path[last]) for path in (wanted, moved))
    return RelativeError(length, pairs, *differences(estimated, real))


@dataclass(frozen=True, eq=False)
class ErrorGrowth:
    """Root mean square errors over stretches of growing length; arrays of shape (k,).

    `length` [m], `position` [m], `heading` [rad], and how many stretches there were (`count`).
    """

    length: Floats
    position: Floats
    heading: Floats
    count: Rows

    def __repr__(self) -> str:
        rows = zip(self.length, self.position, self.heading, strict=True)
        said = ", ".join(f"{d:g} m: {p:.4f} m {math.degrees(h):.2f} deg" for d, p, h in rows)
        return f"ErrorGrowth({said})"


@checked()
def error_growth(
    estimate: ArrayLike,
    truth: ArrayLike,
    lengths: Sequence[float] | None = None,
    *,
    stride: int | None = STRIDE,
) -> ErrorGrowth:
    """Growth of relative errors with the distance driven.

    Parameters
    ----------
    estimate, truth, stride
        As in `relative_error`.
    lengths : sequence of float, optional
        Lengths of the stretches [m]; twelve from a fiftieth of the path to half of it without them. Lengths
        for which the path is too short are left out.
    """
    if lengths is None:
        whole = float(_distance(as_path("truth", truth))[-1])
        lengths = np.geomspace(whole / 50, whole / 2, 12).tolist() if whole > 0.0 else []
    errors = [relative_error(estimate, truth, length, stride=stride) for length in lengths]
    errors = [error for error in errors if len(error.rows)]
    return ErrorGrowth(
        np.array([error.length for error in errors]),
        np.array([error.rmse for error in errors]),
        np.array([error.yaw_rmse for error in errors]),
        np.array([len(error.rows) for error in errors], dtype=np.int64),
    )
