"""Pictures of paths against the truth, of how their errors grow, and of what a calibration leaves."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.kinematics.poses import Floats, as_poses
from six_wheel.log_odometry.evaluation.paths import Alignment, absolute_error, at_same_times
from six_wheel.log_odometry.evaluation.paths import align as aligned
from six_wheel.log_odometry.evaluation.relative import error_growth, path_distance
from six_wheel.logs.recordings import GroundTruth
from six_wheel.plotting.drawing import (
    AXLE,
    FORBIDDEN,
    INK,
    MOTION,
    SOFT,
    draw_legend,
    page_figure,
    tidy,
    with_title,
)

# The last one drawn is the one that matters: it is green, what came before is purple, then quieter.
COLOURS = (MOTION, FORBIDDEN, AXLE, SOFT)


def track_figure(
    tracks: ArrayLike | Track | Mapping[str, ArrayLike | Track],
    truth: ArrayLike | GroundTruth,
    *,
    align: Alignment = "first",
    title: str | None = None,
) -> Figure:
    """Picture of estimated paths against the true one, their errors along it, and how these grow.

    Parameters
    ----------
    tracks : array_like of shape (n, 3), or Track, or mapping of names to such
        Poses at the times of the truth [m, m, rad]; from the worst to the best.
    truth : array_like of shape (n, 3), or GroundTruth
        The true poses [m, m, rad]; a `GroundTruth` is brought to the stamps of tracks that share them.
    align : {'first', 'se2', 'none'}
        Alignment of each path, as in `six_wheel.log_odometry.evaluation.paths.align`.
    title : str, optional
        Written above the picture, over the errors.

    Raises
    ------
    ValueError
        If the shapes differ or a pose is not finite.
    """
    named = dict(tracks) if isinstance(tracks, Mapping) else {"estimate": tracks}
    pairs = {name: at_same_times(track, truth) for name, track in named.items()}
    wanted = as_poses("truth", next(iter(pairs.values()))[1])
    figure = page_figure(7.0)
    grid = figure.add_gridspec(2, 2, height_ratios=(2.0, 1.0))
    path = figure.add_subplot(grid[0, :])
    along, growth = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])

    path.plot(wanted[:, 0], wanted[:, 1], color=INK, linewidth=3.0, alpha=0.25, label="truth")
    distance, said = path_distance(wanted), []
    for number, (name, (track, _)) in enumerate(pairs.items()):
        colour = COLOURS[(len(pairs) - 1 - number) % len(COLOURS)]
        moved = aligned(track, wanted, align)
        error = absolute_error(moved, wanted, "none")
        said.append(f"{name} {error.rmse:.3f} m")
        path.plot(moved[:, 0], moved[:, 1], color=colour, linewidth=1.3, label=name)
        along.plot(distance, error.position, color=colour, linewidth=1.2)
        grown = error_growth(moved, wanted)
        growth.plot(grown.length, grown.position, "o-", color=colour, linewidth=1.2, markersize=3)
    path.plot(*wanted[0, :2], "o", color="white", markeredgecolor=INK, markersize=6, zorder=6)
    path.set_aspect("equal", adjustable="datalim")
    draw_legend(path)
    tidy(path, "x [m]", "y [m]")
    tidy(along, "distance driven [m]", "error [m]")
    tidy(growth, "length of a stretch [m]", "error over it, rms [m]")
    for axes in (along, growth):
        axes.set_ylim(bottom=0.0)
        axes.set_xlim(left=0.0)
    return with_title(path, title, "rms error " + ", ".join(said))


def residual_figure(before: Floats, after: Floats, *, title: str | None = None) -> Figure:
    """Picture of the errors of the motion over windows, before a calibration and after it.

    Parameters
    ----------
    before, after : ndarray, shape (n, 3)
        Errors forward [m], to the left [m] and of the heading [rad], one row per window.
    title : str, optional
        Written above the picture.
    """
    figure = page_figure(2.8)
    panels = [figure.add_subplot(1, 3, number + 1) for number in range(3)]
    draw_residuals(panels, before, after)
    return with_title(panels[0], title, "errors of the motion over windows")


def draw_residuals(panels: list[Axes], before: Floats, after: Floats) -> None:
    """Draw the errors of `residual_figure` into three axes."""
    for number, (name, scale, unit) in enumerate(
        (("forward", 1000.0, "mm"), ("left", 1000.0, "mm"), ("heading", float(np.degrees(1.0)), "deg"))
    ):
        _histogram(panels[number], scale * before[:, number], scale * after[:, number])
        tidy(panels[number], f"{name} [{unit}]", "windows" if number == 0 else "")
    draw_legend(panels[0])


def _histogram(axes: Axes, before: Floats, after: Floats) -> None:
    """Both on the same bins; the farthest hundredth on either side lies in the outer bins."""
    both = np.concatenate((before, after))
    low, high = np.quantile(both, (0.01, 0.99)) if len(both) else (0.0, 0.0)
    bins = np.linspace(low, high, 31) if low < high else np.linspace(low - 1.0, low + 1.0, 31)
    after, before = (np.clip(values, bins[0], bins[-1]) for values in (after, before))
    axes.hist(after, bins=bins.tolist(), color=MOTION, histtype="stepfilled", alpha=0.7, label="after")
    axes.hist(before, bins=bins.tolist(), color=FORBIDDEN, histtype="step", linewidth=1.4, label="before")
    axes.axvline(0.0, color=SOFT, linewidth=0.8)
