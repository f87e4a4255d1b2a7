"""Pictures of rovers: one twist seen from above, a whole path with the rover drawn along it, or a simulated
drive on lockable pivots.

Only matplotlib's object interface is used: no global state and no display, so the figures can be made in any
thread and on any machine. `save` writes them as PNG, SVG or PDF.
"""

import math
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import Rover

try:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
except ImportError as missing:
    raise ImportError('pictures need matplotlib: pip install "six-wheel[plot]"') from missing

from six_wheel.plot import twist
from six_wheel.plot.drawing import (
    CENTRE,
    FORWARD_UP,
    INK,
    SOFT,
    TRACK,
    Floats,
    bounds,
    contacts,
    draw_rover,
    in_world,
    new_figure,
    page,
    tidy,
    write_title,
)
from six_wheel.plot.drive import drive_figure
from six_wheel.plot.four_axle import four_axle_figure
from six_wheel.plot.limits import limits_figure
from six_wheel.plot.tracks import residual_figure, track_figure

__all__ = [
    "draw_path",
    "draw_rover",
    "drive_figure",
    "four_axle_figure",
    "limits_figure",
    "path_figure",
    "residual_figure",
    "save",
    "show_figure",
    "track_figure",
]

ICR_REACH = 3.5  # rover sizes: a centre of rotation farther away than this is pointed at, not shown


def show_figure(rover: Rover, twist: ArrayLike, *, title: str | None = None) -> Figure:
    """Picture of one twist from above, forward up: wheels at their angles, their axles meeting in the ICR.

    Parameters
    ----------
    rover : Rover
        Any layout of wheels.
    twist : array_like, shape (3,)
        vx, vy, omega in body axes [m/s, m/s, rad/s].
    title : str, optional
        Written above the picture, over the twist.

    Returns
    -------
    matplotlib.figure.Figure
        Steering ranges are light wedges. On the line of the unsteered wheels, where the ICR must lie, the
        turns that the steering limits forbid are red.

    Raises
    ------
    InfeasibleMotionError
        If the rover cannot make this twist.
    ValueError
        If the twist is not three finite numbers.
    """
    asked = np.asarray(twist, dtype=np.float64)
    if asked.shape != (3,):
        raise ValueError(f"twist must have shape (3,), got {asked.shape}")
    steering, speeds = rover.inverse(asked)
    moving = bool(np.any(asked != 0.0))
    icr = page(np.asarray(rover.icr(asked)))
    low, high, size = bounds(rover)
    shown = bool(np.max(np.abs(icr - (low + high) / 2)) <= ICR_REACH * size)  # False also for inf and NaN

    left, right, bottom, top = twist.view(low, high, size, icr, shown)
    width = 8.0
    figure = new_figure(width, width * (top - bottom) / (right - left) + 0.9)
    axes = figure.add_subplot()
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal")
    axes.xaxis.set_major_formatter(lambda value, _: f"{-value + 0.0:g}")  # left of the page is +y
    tidy(axes, "y, left [m]", "x, forward [m]")

    twist.draw_steering_ranges(axes, rover)
    twist.draw_icr_line(axes, rover)
    if moving:
        twist.draw_turning_circles(axes, contacts(rover, steering), asked, icr, size, shown)
        twist.draw_axles(axes, rover, steering, icr, size)
    draw_rover(axes, rover, (0.0, 0.0, FORWARD_UP), steering)
    twist.draw_velocity(axes, asked, size)
    if shown:
        twist.draw_icr(axes, icr, low, high)
    elif moving:
        twist.point_at(axes, icr)
    beside = bool(np.isfinite(icr[0])) and not low[0] < icr[0] < high[0]
    twist.draw_labels(axes, rover, steering, speeds, -math.copysign(1.0, icr[0]) if beside else 0.0)
    write_title(axes, title, twist.describe(asked))
    return figure


def path_figure(rover: Rover, poses: ArrayLike, steering: ArrayLike, *, title: str | None = None) -> Figure:
    """Picture of a driven path with the tracks of the wheels and the rover drawn along it.

    Parameters
    ----------
    rover : Rover
        Any layout of wheels.
    poses : array_like, shape (n, 3)
        x, y, yaw of the body in the world [m, m, rad], n >= 1.
    steering : array_like, shape (n, steered wheels)
        Steering angles at those poses [rad].
    title : str, optional
        Written above the picture.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If the shapes do not fit the rover and each other, or a pose is not finite.
    """
    figure = new_figure(8.0, 7.0)
    axes = figure.add_subplot()
    length = draw_path(axes, rover, poses, steering)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    longest = 8.0 / max(right - left, top - bottom)  # [in/m], and words need some room
    figure.set_size_inches(max(4.0, longest * (right - left)), max(3.0, longest * (top - bottom)) + 0.9)
    write_title(axes, title, f"{length:.2f} m")
    return figure


def draw_path(
    axes: Axes,
    rover: Rover,
    poses: ArrayLike,
    steering: ArrayLike,
    *,
    recorded: ArrayLike | None = None,
    count: int = 14,
) -> float:
    """Draw a driven path, its wheel tracks and up to `count` rovers along it; returns its length [m].

    Parameters
    ----------
    axes, rover, poses, steering
        As in `path_figure`; the limits of the axes are set to what is drawn.
    recorded : array_like, shape (m, 2 or more), optional
        A path to draw underneath, for instance the one that was to be followed [m].
    count : int
        Most rovers drawn; fewer where they would stand on each other.

    Raises
    ------
    ValueError
        As in `path_figure`.
    """
    track = np.asarray(poses, dtype=np.float64)
    angles = np.asarray(steering, dtype=np.float64)
    steered = sum(wheel.steered for wheel in rover.wheels)
    if track.ndim != 2 or track.shape[1] != 3 or len(track) == 0 or not np.all(np.isfinite(track)):
        raise ValueError(f"poses must be finite with shape (n, 3), n >= 1, got shape {track.shape}")
    if angles.shape != (len(track), steered):
        raise ValueError(f"steering must have shape ({len(track)}, {steered}), got {angles.shape}")

    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(track[:, :2], axis=0).T))))
    *_, size = bounds(rover)
    ruts = in_world(track, contacts(rover, angles))
    extent = float(np.max(np.ptp(ruts, axis=(0, 1))))
    scale = max(1.0, extent / (30 * size))  # smaller than that, nothing of the rover could be seen

    axes.plot(ruts[..., 0], ruts[..., 1], color=TRACK, linewidth=0.9, zorder=1)
    if recorded is not None:
        asked = np.asarray(recorded, dtype=np.float64)
        axes.plot(
            asked[:, 0], asked[:, 1], color=CENTRE, linewidth=3.2, alpha=0.35, zorder=1.5, label="recorded"
        )
    axes.plot(track[:, 0], track[:, 1], color=INK, linewidth=1.2, zorder=5, label="driven")

    rows = _stations(track[:, :2], along, 1.4 * size * scale, count)
    for number, row in enumerate(rows):
        fade = 0.55 * (1 - (number + 1) / len(rows))
        pose, height = track[row], 3 + 0.01 * number
        draw_rover(axes, rover, pose, angles[row], fade=fade, scale=scale, treads=False, zorder=height)
    axes.plot(*track[0, :2], "o", color="white", markeredgecolor=INK, markersize=6, zorder=6)
    axes.plot(*track[-1, :2], "o", color=CENTRE, markeredgecolor="white", markersize=8, zorder=6)

    reach = 1.1 * size * scale
    axes.set_xlim(track[:, 0].min() - reach, track[:, 0].max() + reach)
    axes.set_ylim(track[:, 1].min() - reach, track[:, 1].max() + reach)
    axes.set_aspect("equal")
    tidy(axes, "x [m]", "y [m]")
    if scale > 1.0:
        axes.annotate(
            f"rover drawn {scale:.1f} times its size", (1, 0), (-6, 6), "axes fraction", "offset points",
            ha="right", va="bottom", fontsize=8, color=SOFT,
        )  # fmt: skip
    return float(along[-1])


def _stations(track: Floats, along: Floats, apart: float, count: int) -> list[int]:
    """Rows to draw the rover at: at most `count`, first and last among them, none nearer than `apart` [m]."""
    last = len(track) - 1
    far = np.hypot(*(track - track[last]).T) >= apart
    spacing = max(along[-1] / count, 1.3 * apart)
    rows = [0]
    for way in np.linspace(0.0, along[-1], 20 * count):
        row = int(np.searchsorted(along, way))
        gaps = np.hypot(*(track[rows] - track[row]).T)
        if far[row] and gaps.min() >= apart and way - along[rows[-1]] >= spacing:
            rows.append(row)
    return rows if last == 0 else [*rows, last]


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure; the ending of the name says as what (png, svg, pdf).

    Raises
    ------
    ValueError
        If matplotlib knows no such ending.
    OSError
        If the file cannot be written.
    """
    figure.savefig(path, dpi=160)
