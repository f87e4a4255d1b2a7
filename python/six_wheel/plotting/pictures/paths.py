"""Paths: truths, drives over ground, tracks in space, evaluations."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from six_wheel._core import integrate
from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.logs.recordings import GroundTruth, Reference
from six_wheel.plotting.drawing import (
    AXLE,
    CENTRE,
    INK,
    MINUS,
    MOTION,
    draw_legend,
    equal_scales,
    one_axes,
    page_figure,
    tidy,
    with_title,
)
from six_wheel.plotting.pictures.fields import LEAST, draw_ground
from six_wheel.plotting.pictures.strips import log_strips


def truth_figure(truth: Any, *, title: str | None) -> Figure:
    """A `GroundTruth`: its path; of headings alone their values over time."""
    axes = one_axes(5.4)
    if not truth.has_positions:
        axes.plot(truth.stamps - truth.stamps[0], truth.poses[:, 2], color=MOTION)
        tidy(axes, "time [s]", "yaw [rad]")
    else:
        breaks = np.flatnonzero(np.diff(truth.stamps) > truth.max_gap) + 1
        for piece in np.split(truth.poses, breaks):
            axes.plot(*piece[:, :2].T, color=MOTION, linewidth=1.6)
        axes.plot(*truth.poses[0, :2], "o", color="white", markeredgecolor=INK, markersize=7)
        axes.plot(*truth.poses[-1, :2], "o", color=INK, markersize=7)
        equal_scales(axes, LEAST)
        tidy(axes, "x [m]", "y [m]")
    return with_title(
        axes, title, f"{len(truth)} poses in {truth.stamps[-1] - truth.stamps[0]:.1f} s; dark: the end"
    )


def track_figure(track: Track, *, title: str | None, truth: Reference | None = None) -> Figure:
    """A `Track`: against its `truth` and with its uncertainty, as far as it has them."""
    from six_wheel.log_odometry.tracks import of_track
    from six_wheel.plotting.log_odometry import reckoning_figure

    if track.covariances is None or track.residuals is None or len(track) < 2:
        return truth_figure(GroundTruth(track.stamps, track.poses), title=title)
    return reckoning_figure(of_track(track, truth), title=title)


def log_figure(log: Any, *, title: str | None) -> Figure:
    """A `WheelLog`: the path of its truth, or its angles over time."""
    if log.truth is not None:
        return truth_figure(log.truth, title=title or log.name or None)
    return log_strips(log, title=title or log.name or None)


def track3_figure(track: Any, *, title: str | None) -> Figure:
    """A `Track3`: its path from above, with its height along the way."""
    figure = page_figure(7.0)
    grid = figure.add_gridspec(2, 1)
    above, profile = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    above.plot(*track.positions[:, :2].T, color=MOTION, linewidth=1.6)
    above.plot(*track.positions[0, :2], "o", color="white", markeredgecolor=INK, markersize=7)
    above.plot(*track.positions[-1, :2], "o", color=INK, markersize=7)
    equal_scales(above, LEAST)
    figure.set_figheight(figure.get_figheight() + 1.8)
    grid.set_height_ratios((figure.get_figheight() - 2.2, 1.6))
    steps = np.hypot(*np.diff(track.positions[:, :2], axis=0).T)
    distance = np.concatenate(([0.0], np.cumsum(steps)))
    if track.covariances is not None:
        spread = 1.96 * np.sqrt(np.maximum(track.covariances[:, 2, 2], 0.0))
        low, high = track.positions[:, 2] - spread, track.positions[:, 2] + spread
        profile.fill_between(distance, low, high, color=AXLE, alpha=0.25, linewidth=0)
    profile.plot(distance, track.positions[:, 2], color=MOTION, linewidth=1.4)
    tidy(above, "x [m]", "y [m]")
    tidy(profile, "distance in plan [m]", "height, 95 % [m]")
    rows, (x, y, z) = len(track), track.positions[-1]
    words = f"{rows} rows, {distance[-1]:.2f} m in plan, ends at ({x:.3f}, {y:.3f}, {z:.3f}) m; dark: the end"
    return with_title(above, title, words.replace("-", MINUS))


def drive_figure(drive: Any, *, title: str | None) -> Figure:
    """A `GroundSimulation`: the path over the relief, and six side views along it."""
    from six_wheel._core import RockerBogie
    from six_wheel.plotting.ground.run import FRAMES, _draw_film

    figure = page_figure(6.0)
    grid = figure.add_gridspec(2, FRAMES)
    axes = figure.add_subplot(grid[0, :])
    draw_ground(axes, drive.stand.ground)
    poses = drive.truth.poses
    axes.plot(*poses[:, :2].T, color=CENTRE, linewidth=2.2, zorder=5)
    axes.plot(*poses[0, :2], "o", color="white", markeredgecolor=INK, markersize=7, zorder=6)
    axes.plot(*poses[-1, :2], "o", color=INK, markersize=7, zorder=6)
    (left, low), (right, high) = poses[:, :2].min(axis=0) - 1.0, poses[:, :2].max(axis=0) + 1.0
    axes.set(xlim=(left, right), ylim=(low, high))
    equal_scales(axes)
    tidy(axes, "x [m]", "y [m]")
    with_title(axes, title, f"{drive.duration:.1f} s over ground; below from the left at six times")
    if isinstance(drive.stand.suspension, RockerBogie):
        grid.set_height_ratios((figure.get_figheight(), 1.0))
        figure.set_figheight(figure.get_figheight() + 1.0)
        _draw_film([figure.add_subplot(grid[1, k]) for k in range(FRAMES)], drive, drive.stand.suspension)
        figure.draw_without_rendering()  # ticks of the laid out axes are wider than those that were laid out
    return figure


def evaluation_figure(found: Any, *, title: str | None) -> Figure:
    """An `Evaluation`: the error over the true distance, its histogram, its growth over stretches."""
    figure = page_figure(5.6)
    grid = figure.add_gridspec(2, 2)
    errors, counts, growth = (figure.add_subplot(place) for place in (grid[0, :], grid[1, 0], grid[1, 1]))
    first, aligned = found.first.position, found.aligned.position
    errors.plot(found.along, first, color=MOTION, label="first pose given")
    errors.plot(found.along, aligned, color=AXLE, linestyle="--", label="aligned as a whole")
    draw_legend(errors)
    counts.hist(first, bins=30, color=MOTION, alpha=0.8)
    counts.locator_params(axis="x", nbins=5)
    growth.plot(found.growth.length, found.growth.position, "o-", color=MOTION, markersize=4)
    tidy(errors, "distance driven [m]", "error [m]")
    tidy(counts, "error [m]", "poses")
    tidy(growth, "length of a stretch [m]", "error over it, rms [m]")
    return with_title(errors, title, repr(found).removeprefix("Evaluation(").removesuffix(")"))


def twist_path_figure(twist: Any, *, title: str | None) -> Figure:
    """A `Twist`: the arc it makes in a second."""
    axes = one_axes(5.0)
    poses = np.asarray(integrate(np.tile(np.asarray(twist, dtype=float), (60, 1)), 1.0 / 60.0))
    axes.plot(*poses[:, :2].T, color=MOTION, linewidth=2.2)
    axes.plot(0, 0, "o", color="white", markeredgecolor=INK, markersize=7)
    equal_scales(axes, LEAST)
    tidy(axes, "forward [m]", "to the left [m]")
    return with_title(axes, title, "the path of one second")
