"""Stretches of time in which an estimate departs from its truth: slip that the wheels alone need not show."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import Rover
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.kinematics.poses import Floats, between
from six_wheel.logs.recordings import Reference, as_truth

SPAN = 0.5  # [s] over which motions are compared: longer than an encoder's step, shorter than what slip lasts
SLIP = 0.25  # of a usual motion over a span: wrong dimensions err by less
UNUSUAL = 8.0  # times the median error: what errs as much all the time is a dimension, no slip
GAP = 0.5  # [s], below which two stretches are one


@dataclass(frozen=True, slots=True)
class Stretch:
    """From when to when an estimate moved otherwise than the truth, and by how much."""

    start: float  # stamp [s]
    end: float
    distance: float  # it slid in that time, a turn counted as what the outermost wheel drives [m]

    def __str__(self) -> str:
        return f"{self.start:.2f} s to {self.end:.2f} s"


@checked()
def slip_against(
    track: Track, truth: Reference | None = None, yaw_rate: ArrayLike | None = None
) -> tuple[Stretch, ...]:
    """Stretches in which the wheels did not show the motion of the rover, as a truth or a gyroscope knows.

    Two wheels alone cannot tell it: nothing contradicts them.

    Parameters
    ----------
    track : Track
        Of the wheels alone, at stamps that grow.
    truth : GroundTruth, WheelLog or Track, optional
        True path: a truth, a log that has it, or a better track.
    yaw_rate : array_like, shape (n,), optional
        Of a gyroscope at the stamps of the track [rad/s]; its bias is the median of the differences.

    Returns
    -------
    tuple of Stretch
        In which the motion errs by more than a quarter of a usual one, and eight times as much as usual.

    Raises
    ------
    ValueError
        If there is neither a truth nor a gyroscope, or both.
    """
    if (truth is None) == (yaw_rate is None):
        raise ValueError("truth or yaw_rate must be given, got neither or both")
    if truth is not None:
        real = as_truth(truth).at(track.stamps)
        known = np.isfinite(real).all(axis=1)
        return lost_stretches(track.stamps[known], track.poses[known], real[known], reach(track.rover))
    rates = np.asarray(yaw_rate, dtype=np.float64)
    if rates.shape != track.stamps.shape:
        raise ValueError(f"yaw_rate must have shape {track.stamps.shape}, got {rates.shape}")
    known = np.isfinite(rates)
    stamps, poses = track.stamps[known], track.poses[known]
    if len(stamps) < 2:
        return ()
    steps = np.diff(stamps)
    turned = np.diff(poses[:, 2])
    measured = (rates[known][1:] + rates[known][:-1]) / 2.0 * steps
    usual = np.median((measured - turned)[steps > 0.0] / steps[steps > 0.0]) if (steps > 0.0).any() else 0.0
    heading = poses[0, 2] + np.concatenate(([0.0], np.cumsum(measured - usual * steps)))
    # The same steps, each in the direction that the gyroscope knows.
    cos, sin = np.cos(heading - poses[:, 2])[:-1], np.sin(heading - poses[:, 2])[:-1]
    x, y = np.diff(poses[:, :2], axis=0).T
    way = np.cumsum(np.column_stack((cos * x - sin * y, sin * x + cos * y)), axis=0)
    real = np.column_stack((poses[0, :2] + np.vstack((np.zeros(2), way)), heading))
    return lost_stretches(stamps, poses, real, reach(track.rover))


def reach(rover: Rover) -> float:
    """Origin to the farthest wheel [m]."""
    return max(float(np.hypot(wheel.x, wheel.y)) for wheel in rover.wheels)


def lost_stretches(
    stamps: Floats, estimate: Floats, truth: Floats, reach: float, least: float = SLIP
) -> tuple[Stretch, ...]:
    """Stretches in which the motion errs by far more than it usually does.

    `estimate` and `truth` are poses (n, 3) [m, m, rad] at the `stamps` (n,) [s], none before the one above
    it. `reach` is from the origin to the farthest wheel [m]: a turn counts as what that wheel drives. A
    motion errs by the share `least` of a usual one at least.
    """
    first = np.arange(len(stamps))
    last = np.searchsorted(stamps, stamps + SPAN)
    first, last = first[last < len(stamps)], last[last < len(stamps)]
    if len(first) < 2:
        return ()
    seen, real = between(estimate[first], estimate[last]), between(truth[first], truth[last])
    weigh = np.array((1.0, 1.0, reach))
    seconds = stamps[last] - stamps[first]
    moved = np.linalg.norm(real * weigh, axis=1) / seconds
    error = np.linalg.norm((seen - real) * weigh, axis=1) / seconds
    usual = float(np.median(moved[moved > 0.0])) if (moved > 0.0).any() else 0.0
    if usual == 0.0:
        return ()
    share = error / np.maximum(moved, usual)
    odd = share > max(least, UNUSUAL * float(np.median(share)))
    return _stretches(stamps, first[odd], last[odd], error[odd])


def _stretches(
    stamps: Floats, first: NDArray[np.int64], last: NDArray[np.int64], error: Floats
) -> tuple[Stretch, ...]:
    """Windows that overlap or nearly do, as one stretch each; what lasts no longer than a window is noise."""
    if not len(first):
        return ()
    cuts = np.flatnonzero(stamps[first[1:]] - stamps[last[:-1]] > GAP) + 1
    found = []
    for windows in np.split(np.arange(len(first)), cuts):
        # A window that only touches the slip begins before it or ends behind it: half of one at either end.
        start, end = stamps[first[windows[0]]] + SPAN / 2.0, stamps[last[windows[-1]]] - SPAN / 2.0
        if end - start < SPAN / 2.0:
            continue
        found.append(Stretch(float(start), float(end), float(np.median(error[windows]) * (end - start))))
    return tuple(found)


def merged(stretches: Sequence[Stretch], margin: float) -> list[tuple[float, float]]:
    """From when to when there is slip, with a margin to either side [s]."""
    spans: list[tuple[float, float]] = []
    for one in sorted(stretches, key=lambda one: one.start):
        start, end = one.start - margin, one.end + margin
        if spans and start <= spans[-1][1]:
            spans[-1] = (spans[-1][0], max(end, spans[-1][1]))
        else:
            spans.append((start, end))
    return spans
