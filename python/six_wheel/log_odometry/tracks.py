"""A `Track` in memory as what dead reckoning of a log on disk comes to, for pictures and reports."""

from __future__ import annotations

import numpy as np

from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.log_odometry.evaluation.paths import at_same_times, evaluate
from six_wheel.log_odometry.evaluation.relative import path_distance
from six_wheel.log_odometry.evaluation.slip import slip_against
from six_wheel.log_odometry.results import Reckoned
from six_wheel.logs.recordings import Reference


def of_track(
    track: Track, truth: Reference | None = None, *, name: str = "track", length: float = 0.5
) -> Reckoned:
    """Summary of a track, with its errors against the truth if that is known.

    Parameters
    ----------
    track : Track
        With covariances and residuals.
    truth : GroundTruth, WheelLog or Track, optional
        Brought to its stamps.
    name : str
        Its name.
    length : float
        Of the stretches for the relative error [m].

    Raises
    ------
    ValueError
        If the track is empty or without covariances or residuals, or does not overlap the truth in time.
    """
    if not len(track) or track.covariances is None or track.residuals is None:
        raise ValueError("track must hold rows with covariances and residuals, got one without")
    result = Reckoned(name, track.rover, len(track))
    result.duration = float(track.stamps[-1] - track.stamps[0])
    result.distance = float(path_distance(track.poses)[-1])
    result.pose, result.covariance = track.poses[-1], track.covariances[-1]
    result.slip, result.noise = track.slip_report(), track.noise
    flat = track.covariances.reshape(-1, 9)
    result._trace.add(track.poses, np.hstack([track.stamps[:, None], flat, track.residuals]))
    if truth is not None:
        result.estimate, result.truth = map(np.asarray, at_same_times(track, truth))
        result.lost = slip_against(track, truth)
        result.evaluation = evaluate(result.estimate, result.truth, length=length)
    return result
