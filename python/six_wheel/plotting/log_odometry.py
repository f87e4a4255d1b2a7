"""Picture of a dead-reckoned log: the path with what is not known of it, errors, and how the wheels slid."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from six_wheel._core import Noise
from six_wheel.kinematics.odometry.tracks import ROUNDING, SILENT
from six_wheel.log_odometry.evaluation.paths import absolute_error, align
from six_wheel.log_odometry.evaluation.relative import path_distance
from six_wheel.log_odometry.results import Reckoned
from six_wheel.plotting.drawing import (
    AXLE,
    FAINT,
    INK,
    LIKELY,
    MINUS,
    MOTION,
    SOFT,
    covariance_ellipse,
    draw_legend,
    few_rows,
    page_figure,
    tidy,
    with_title,
)

ELLIPSES = 14
WHEELS = (AXLE, "#b5651d", MOTION, "#8a6d2f", "#4c4a7d", "#7d3c5d")
LINE = 110  # letters of a legend in one row, 8 of them for each sign


def reckoning_figure(result: Reckoned, *, title: str | None = None) -> Figure:
    """Picture of a track: its path with ellipses of 95 %, and truth, errors and residuals if there are any.

    Parameters
    ----------
    result : Reckoned
        Result to show.
    title : str, optional
        Written above the picture, over the figures of the end.
    """
    known = result.evaluation is not None
    figure = page_figure(8.4)
    grid = figure.add_gridspec(3, 2, height_ratios=(2.4, 1.0, 1.0))
    path = figure.add_subplot(grid[0, :])
    draw_path(path, result)
    draw_key(figure, path)
    x, y, _ = result.pose
    words = f"{result.distance:.2f} m in {result.duration:.1f} s, ends at ({x:.3f}, {y:.3f}) m"
    with_title(path, title, words.replace("-", MINUS))
    _draw_error(figure.add_subplot(grid[1, 0] if known else grid[1, :]), result)
    if known:
        _draw_growth(figure.add_subplot(grid[1, 1]), result)
    _draw_residuals(figure.add_subplot(grid[2, :]), result)
    return figure


def draw_path(axes: Axes, result: Reckoned) -> None:
    """The path with its ellipses of 95 %, and the truth if it is known."""
    _, poses, covariances, _ = result.trace()
    if result.evaluation is not None:
        # The truth is moved, so that the ellipses stay as they are.
        (truth,) = few_rows(align(result.truth, result.estimate, "first"))
        axes.plot(truth[:, 0], truth[:, 1], color=INK, linewidth=3.0, alpha=0.25, zorder=3, label="truth")
    (drawn,) = few_rows(poses)
    axes.plot(drawn[:, 0], drawn[:, 1], color=MOTION, linewidth=1.6, zorder=3, label="odometry")
    typical = ", by the noise of a typical rover" if result.noise == Noise.typical() else ""
    along = path_distance(poses)
    stations = np.searchsorted(along, np.linspace(0.0, along[-1], ELLIPSES + 1)[1:])
    for number, row in enumerate(np.unique(np.minimum(stations, len(poses) - 1))):
        label = {} if number else {"label": f"95 % of where it may be{typical}"}
        look = {"facecolor": (AXLE, 0.1), "edgecolor": (AXLE, 0.7), "linewidth": 0.8, "zorder": 2.5}
        axes.add_patch(covariance_ellipse(poses[row], covariances[row, :2, :2], **look, **label))
    axes.plot(*poses[0, :2], "o", color="white", markeredgecolor=INK, markersize=6, zorder=6)
    axes.plot(*poses[-1, :2], "o", color=INK, markeredgecolor="white", markersize=8, zorder=6, label="end")
    if result.evaluation is not None:
        axes.plot(
            *truth[-1, :2], "X", color=INK, markeredgecolor="white", markersize=9, zorder=7, label="true end"
        )
    axes.set_aspect("equal", adjustable="datalim")
    tidy(axes, "x [m]", "y [m]")


def draw_key(figure: Figure, axes: Axes) -> None:
    """Draw the legend of a path below the picture, which ellipses may fill."""
    handles, labels = axes.get_legend_handles_labels()
    columns = 5 if sum(map(len, labels)) + 8 * len(labels) < LINE else 3
    draw_legend(figure, handles, labels, loc="outside lower left", ncols=columns)


def _draw_error(axes: Axes, result: Reckoned) -> None:
    """The position error along the way over the bound that the covariance gives."""
    _, poses, covariances, _ = result.trace()
    largest = np.linalg.eigvalsh(covariances[:, :2, :2])[:, -1]
    bound = np.sqrt(LIKELY * np.maximum(largest, 0.0))
    distance, bound = few_rows(path_distance(poses), bound)
    axes.fill_between(distance, 0.0, bound, color=AXLE, alpha=0.22, linewidth=0, label="95 % bound")
    if result.evaluation is not None:
        error = absolute_error(result.estimate, result.truth, "first").position
        along, error = few_rows(path_distance(result.estimate), error)
        axes.plot(along, error, color=MOTION, linewidth=1.2, label="error")
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    draw_legend(axes, loc="upper left")
    tidy(axes, "distance driven [m]", "position [m]")


def _draw_growth(axes: Axes, result: Reckoned) -> None:
    if result.evaluation is None:
        return
    growth = result.evaluation.growth
    axes.plot(growth.length, growth.position, "o-", color=MOTION, linewidth=1.2, markersize=3)
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    tidy(axes, "length of a stretch [m]", "error over it, rms [m]")


def _draw_residuals(axes: Axes, result: Reckoned) -> None:
    """Draw the sliding speed of each wheel [mm/s], with stretches of slip shaded."""
    stamps, _, _, residuals = result.trace()
    names = result.rover.wheel_names
    stamps, residuals = few_rows(stamps, residuals)
    if not np.nan_to_num(residuals).max() > ROUNDING:
        said = "no wheel contradicts another" if result.slip.observable else SILENT.replace(": ", ":\n")
        box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.9}
        axes.text(0.5, 0.5, said, transform=axes.transAxes, ha="center", color=SOFT, bbox=box, zorder=4)
    order = np.argsort(-np.nan_to_num(residuals).max(axis=0), kind="stable")
    for number, wheel in enumerate(order):
        colour = WHEELS[number] if number < len(WHEELS) else SOFT
        label = {"label": names[wheel].replace("_", " ")} if number < len(WHEELS) else {}
        axes.plot(stamps, 1000.0 * residuals[:, wheel], color=colour, linewidth=0.8, **label)
    told = [(window.start, window.end) for window in result.slip.windows]
    for start, end in [*told, *((stretch.start, stretch.end) for stretch in result.lost)]:
        axes.axvspan(start, end, color=FAINT, alpha=0.6, zorder=0)
    axes.set_ylim(0.0, max(1.05e3 * float(np.nan_to_num(residuals).max()), 1.0))
    axes.set_xlim(stamps[0], stamps[-1])
    draw_legend(axes, loc="upper right", ncols=3)
    tidy(axes, "time [s]", "wheels slide [mm/s]")
