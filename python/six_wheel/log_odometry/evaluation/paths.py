"""Errors of an estimated path against the true one: absolute, relative, and their growth with distance.

Both paths hold one pose per row, taken at the same times: x, y, yaw [m, m, rad] or, in space, x, y, z, roll,
pitch, yaw. `GroundTruth.at` of `six_wheel.logs.recordings` gives a reference with its own clock at the stamps
of a log.

The measures are those of Sturm et al., A Benchmark for the Evaluation of RGB-D SLAM Systems, IROS 2012,
without scale; relative errors go by distance as in Geiger, Lenz & Urtasun, Are we ready for
autonomous driving?, CVPR 2012. The package evo computes the same numbers.
"""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from dataclasses import dataclass, field
from os import PathLike
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.kinematics.keywords import checked, checked_class
from six_wheel.kinematics.objects.tables import Columns, Tabular
from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.kinematics.odometry.tracks3 import Track3
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry.evaluation.relative import (
    STRIDE,
    ErrorGrowth,
    RelativeError,
    error_growth,
    path_distance,
    relative_error,
    rms,
)
from six_wheel.log_odometry.evaluation.spaces import (
    as_path,
    best_fit,
    differences,
    inverse_of,
    moved_by,
    poses_of,
)
from six_wheel.logs.recordings import Reference, as_truth

Alignment = Literal["first", "se2", "se3", "none"]


@checked()
def align(estimate: ArrayLike, truth: ArrayLike, align: Alignment = "se2") -> Floats:
    """The estimate, moved as one rigid body onto the truth.

    Parameters
    ----------
    estimate, truth : array_like, shape (n, 3) or (n, 6)
        Poses at the same times, as in `evaluate`.
    align : {'first', 'se2', 'se3', 'none'}
        So that the first poses agree; so that the positions agree best in the sense of least squares,
        without scale, which is called 'se2' in the plane and 'se3' in space; or not at all.

    Returns
    -------
    ndarray, of the shape of `estimate`

    Raises
    ------
    ValueError
        If the shapes differ, a pose is not finite, or `align` is none of these.

    Source: Umeyama, Least-Squares Estimation of Transformation Parameters Between Two Point Patterns,
    IEEE PAMI 13(4), 1991.
    """
    wanted = as_path("truth", truth)
    return poses_of(_onto(as_path("estimate", estimate, wanted), wanted, align))


def _onto(moved: Floats, wanted: Floats, align: Alignment) -> Floats:
    """A path, moved as one rigid body onto another."""
    best = _best(wanted)
    if align not in ("first", best, "none"):
        raise ValueError(f"align must be 'first', '{best}' or 'none', got {align!r}")
    if align == "none":
        return moved.copy()
    if align == "first":
        return moved_by(moved_by(wanted[0], inverse_of(moved[0])), moved)
    return moved_by(best_fit(moved, wanted), moved)


def _best(path: Floats) -> Alignment:
    """The best rigid alignment of paths of this kind."""
    return "se2" if path.ndim == 2 else "se3"


@checked_class
@dataclass(frozen=True, eq=False)
class AbsoluteError:
    """Distance of every pose from its true one, after an alignment.

    `position` [m] and `heading` [rad, signed; in space the angle of the rotation] have shape (n,).
    """

    align: Alignment
    position: Floats = field(repr=False)
    heading: Floats = field(repr=False)

    @property
    def rmse(self) -> float:
        """Root mean square of the position error [m]: what is called ATE."""
        return rms(self.position)

    @property
    def median(self) -> float:
        """Median of the position error [m]."""
        return float(np.median(self.position))

    @property
    def maximum(self) -> float:
        """Largest position error [m]."""
        return float(np.max(self.position))

    @property
    def final(self) -> float:
        """Position error of the last pose [m]."""
        return float(self.position[-1])

    @property
    def yaw_rmse(self) -> float:
        """Root mean square of the heading error [rad]."""
        return rms(self.heading)

    @property
    def final_heading(self) -> float:
        """Heading error of the last pose [rad], signed."""
        return float(self.heading[-1])

    def __repr__(self) -> str:
        return (
            f"AbsoluteError({self.align}: rmse {self.rmse:.4f} m, max {self.maximum:.4f} m, "
            f"final {self.final:.4f} m {math.degrees(self.final_heading):+.2f} deg)"
        )


@checked()
def absolute_error(estimate: ArrayLike, truth: ArrayLike, align: Alignment = "first") -> AbsoluteError:
    """Absolute trajectory error: how far each pose is from the true one once the paths are aligned.

    Parameters, errors
        As in `align`.
    """
    wanted = as_path("truth", truth)
    moved = _onto(as_path("estimate", estimate, wanted), wanted, align)
    return AbsoluteError(align, *differences(moved, wanted))


@checked_class
@dataclass(frozen=True, eq=False)
class Evaluation(Tabular):
    """All measures of one estimated path.

    Attributes
    ----------
    distance : float
        Length of the true path [m].
    first, aligned : AbsoluteError
        With the first pose given, and after the best rigid alignment.
    relative : RelativeError
    growth : ErrorGrowth
    along : ndarray, shape (n,)
        Distance along the true path up to each pose [m].
    """

    distance: float
    first: AbsoluteError
    aligned: AbsoluteError
    relative: RelativeError
    growth: ErrorGrowth = field(repr=False)
    along: Floats = field(repr=False)

    def _columns(self) -> Columns:
        """Distance along the true path, and the errors of every pose after each of the alignments."""
        columns: Columns = {"distance": ("m", self.along)}
        angle = "yaw" if self.aligned.align == "se2" else "rotation"
        for error in (self.first, self.aligned):
            columns[f"position_error_{error.align}"] = ("m", error.position)
            columns[f"{angle}_error_{error.align}"] = ("rad", error.heading)
        return columns

    def __repr__(self) -> str:
        turned = math.degrees(self.first.final_heading)
        per = math.degrees(self.relative.yaw_rmse)
        return (
            f"Evaluation({self.distance:.2f} m: ATE {self.first.rmse:.4f} m, "
            f"aligned {self.aligned.rmse:.4f} m, end {self.first.final:.4f} m {turned:+.2f} deg, "
            f"{self.relative.percent:.2f} % and {per:.2f} deg per {self.relative.length:g} m)"
        )

    def to_dict(self) -> dict[str, float]:
        """The figures under names that say what they are and in which unit."""
        return {
            "distance_m": self.distance,
            "ate_first_m": self.first.rmse,
            f"ate_{self.aligned.align}_m": self.aligned.rmse,
            "final_m": self.first.final,
            "final_deg": math.degrees(self.first.final_heading),
            "relative_length_m": self.relative.length,
            "relative_percent": self.relative.percent,
            "relative_deg": math.degrees(self.relative.yaw_rmse),
        }


def at_same_times(
    estimate: ArrayLike | Track | Track3, truth: ArrayLike | Reference
) -> tuple[ArrayLike, ArrayLike]:
    """Poses of both at the same times: a `Track` and a `GroundTruth` (or what `as_truth` takes) by stamps.

    Raises
    ------
    ValueError
        If they do not overlap in time for two rows of the track, or a truth comes without a track.
    """
    if isinstance(truth, str | PathLike):
        truth = as_truth(truth)
    if hasattr(truth, "stamps"):
        truth = as_truth(truth)
        if not isinstance(estimate, Track | Track3):
            raise ValueError(
                f"estimate must be a Track where truth is a GroundTruth, got {type(estimate).__name__}"
            )
        space = truth.has_space and isinstance(estimate, Track3)
        real = truth.at_in_space(estimate.stamps) if space else truth.at(estimate.stamps)
        known = np.isfinite(real).all(axis=1)
        if np.count_nonzero(known) < 2:
            theirs = f"{truth.stamps[0]:g} to {truth.stamps[-1]:g} s"
            ours = f"{estimate.stamps[0]:g} to {estimate.stamps[-1]:g} s" if len(estimate) else "no rows"
            raise ValueError(f"truth must overlap the track in time, got {theirs} and {ours}")
        return (estimate.poses if space else _planar(estimate))[known], real[known]
    if isinstance(estimate, Track3) and np.shape(truth)[1:] == (6,):
        return estimate.poses, truth
    return _planar(estimate) if isinstance(estimate, Track | Track3) else estimate, truth


def _planar(track: Track | Track3) -> Floats:
    """Poses x, y, yaw of a track; those of one in space as seen from above."""
    return track.poses if isinstance(track, Track) else track.poses[:, [0, 1, 5]]


@checked()
def evaluate(
    estimate: ArrayLike | Track | Track3,
    truth: ArrayLike | Reference,
    *,
    length: float = 0.5,
    stride: int | None = STRIDE,
) -> Evaluation:
    """Every measure of an estimated path against the true one.

    Parameters
    ----------
    estimate, truth : array_like, shape (n, 3) or (n, 6), or Track or Track3 and GroundTruth
        Poses at the same times: x, y, yaw [m, m, rad], or in space x, y, z, roll, pitch, yaw. A `GroundTruth`
        is interpolated at the stamps of a track, whose rows outside it are left out; the `WheelLog` that has
        it, another `Track` or `Track3`, or the path of a file of poses serves as well. A `Track3` is compared
        in space where the truth is known there, else as seen from above.
    length, stride
        Of the relative error; see `segments`.

    Returns
    -------
    Evaluation

    Raises
    ------
    ValueError
        If the shapes differ, a pose is not finite, or track and truth do not overlap in time.
    """
    estimate, truth = at_same_times(estimate, truth)
    wanted = as_path("truth", truth)
    along = path_distance(truth)
    return Evaluation(
        float(along[-1]),
        absolute_error(estimate, truth, "first"),
        absolute_error(estimate, truth, _best(wanted)),
        relative_error(estimate, truth, length, stride=stride),
        error_growth(estimate, truth, stride=stride),
        along,
    )
