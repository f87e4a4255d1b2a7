"""Paths: truths, drives over ground, tracks in space, evaluations."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from six_wheel._core import integrate
from six_wheel.plotting.drawing import AXLE, CENTRE, INK, MOTION, new_figure, tidy, write_title
from six_wheel.plotting.pictures.fields import draw_ground
from six_wheel.plotting.pictures.strips import log_strips

__all__ = ["drive_figure", "evaluation_figure", "log_figure", "track3_figure", "truth_figure"]


def truth_figure(truth: Any, *, title: str | None) -> Figure:
    """A `GroundTruth`: its path; of headings alone their values over time."""
    figure = new_figure(7.2, 5.4)
    axes = figure.add_subplot()
    if not truth.has_positions:
        axes.plot(truth.stamps - truth.stamps[0], truth.poses[:, 2], color=MOTION)
        tidy(axes, "time [s]", "yaw [rad]")
    else:
        breaks = np.flatnonzero(np.diff(truth.stamps) > truth.max_gap) + 1
        for piece in np.split(truth.poses, breaks):
            axes.plot(*piece[:, :2].T, color=MOTION, linewidth=1.6)
        axes.plot(*truth.poses[0, :2], "o", color="white", markeredgecolor=INK, markersize=7)
        axes.plot(*truth.poses[-1, :2], "o", color=INK, markersize=7)
        axes.set_aspect("equal", adjustable="datalim")
        tidy(axes, "x [m]", "y [m]")
    write_title(
        axes, title, f"{len(truth)} poses in {truth.stamps[-1] - truth.stamps[0]:.1f} s; dark: the end"
    )
    return figure


def log_figure(log: Any, *, title: str | None) -> Figure:
    """A `WheelLog`: the path of its truth, or its angles over time."""
    if log.truth is not None:
        return truth_figure(log.truth, title=title or log.name or None)
    return log_strips(log, title=title or log.name or None)


def track3_figure(track: Any, *, title: str | None) -> Figure:
    """A `Track3`: its path from above, with its height along the way."""
    figure = new_figure(7.2, 7.0)
    above, profile = figure.subplots(2, 1, height_ratios=(2.5, 1.0))
    above.plot(*track.positions[:, :2].T, color=MOTION, linewidth=1.6)
    above.plot(*track.positions[0, :2], "o", color="white", markeredgecolor=INK, markersize=7)
    above.plot(*track.positions[-1, :2], "o", color=INK, markersize=7)
    above.set_aspect("equal", adjustable="datalim")
    steps = np.hypot(*np.diff(track.positions[:, :2], axis=0).T)
    distance = np.concatenate(([0.0], np.cumsum(steps)))
    if track.covariances is not None:
        spread = 1.96 * np.sqrt(np.maximum(track.covariances[:, 2, 2], 0.0))
        low, high = track.positions[:, 2] - spread, track.positions[:, 2] + spread
        profile.fill_between(distance, low, high, color=AXLE, alpha=0.25, linewidth=0)
    profile.plot(distance, track.positions[:, 2], color=MOTION, linewidth=1.4)
    tidy(above, "x [m]", "y [m]")
    tidy(profile, "distance [m]", "height [m], 95 %")
    write_title(above, title, repr(track))
    return figure


def drive_figure(drive: Any, *, title: str | None) -> Figure:
    """A `GroundSimulation`: the path over the relief, and six side views along it."""
    from six_wheel._core import RockerBogie
    from six_wheel.plotting.ground.run import _draw_film

    figure = new_figure(7.2, 7.2)
    grid = figure.add_gridspec(2, 6, height_ratios=(3.0, 1.0))
    axes = figure.add_subplot(grid[0, :])
    draw_ground(axes, drive.stand.ground)
    poses = drive.truth.poses
    axes.plot(*poses[:, :2].T, color=CENTRE, linewidth=2.2, zorder=5)
    (left, low), (right, high) = poses[:, :2].min(axis=0) - 1.0, poses[:, :2].max(axis=0) + 1.0
    axes.set(xlim=(left, right), ylim=(low, high))
    tidy(axes, "x [m]", "y [m]")
    write_title(axes, title, f"{drive.duration:.1f} s over ground; below from the left at six times")
    if isinstance(drive.stand.suspension, RockerBogie):
        _draw_film([figure.add_subplot(grid[1, k]) for k in range(6)], drive, drive.stand.suspension)
    return figure


def evaluation_figure(found: Any, *, title: str | None) -> Figure:
    """An `Evaluation`: the error over rows, its histogram, and its growth with distance."""
    figure = new_figure(7.2, 6.0)
    grid = figure.add_gridspec(2, 2)
    errors, counts, growth = (
        figure.add_subplot(grid[0, :]),
        figure.add_subplot(grid[1, 0]),
        figure.add_subplot(grid[1, 1]),
    )
    errors.plot(found.first.position, color=MOTION, label="first pose given")
    errors.plot(found.aligned.position, color=AXLE, linestyle="--", label="aligned as a whole")
    errors.legend(frameon=False, fontsize=8, labelcolor=INK)
    counts.hist(found.first.position, bins=30, color=MOTION, alpha=0.8)
    growth.plot(found.growth.length, found.growth.position, "o-", color=MOTION, markersize=4)
    tidy(errors, "row", "error [m]")
    tidy(counts, "error [m]", "rows")
    tidy(growth, "length of a stretch [m]", "error over it, rms [m]")
    write_title(errors, title, repr(found).removeprefix("Evaluation(").removesuffix(")"))
    return figure


def twist_path_figure(twist: Any, *, title: str | None) -> Figure:
    """A `Twist`: the arc it makes in a second."""
    figure = new_figure(7.2, 5.0)
    axes = figure.add_subplot()
    poses = np.asarray(integrate(np.tile(np.asarray(twist, dtype=float), (60, 1)), 1.0 / 60.0))
    axes.plot(*poses[:, :2].T, color=MOTION, linewidth=2.2)
    axes.plot(0, 0, "o", color="white", markeredgecolor=INK, markersize=7)
    axes.set_aspect("equal", adjustable="datalim")
    tidy(axes, "forward [m]", "to the left [m]")
    write_title(axes, title, "the way in one second")
    return figure
