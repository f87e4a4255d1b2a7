"""Pictures of a driven path with the rover drawn along it."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from six_wheel._core import Rover
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry.evaluation.relative import path_distance
from six_wheel.plotting.drawing import (
    INK,
    RECORDED,
    SOFT,
    TRACK,
    bounds,
    contacts,
    draw_rover,
    fit_page,
    in_world,
    one_axes,
    tidy,
    with_title,
    write,
)


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

    Raises
    ------
    ValueError
        If the shapes do not fit the rover and each other, or a pose is not finite.
    """
    axes = one_axes(7.0, 8.0)
    length = draw_path(axes, rover, poses, steering)
    fit_page(axes)
    return with_title(axes, title, f"{length:.2f} m")


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

    along = path_distance(track)
    *_, size = bounds(rover)
    ruts = in_world(track, contacts(rover, angles))
    extent = float(np.max(np.ptp(ruts, axis=(0, 1))))
    scale = max(1.0, extent / (30 * size))  # smaller than that, nothing of the rover could be seen

    axes.plot(ruts[..., 0], ruts[..., 1], color=TRACK, linewidth=0.9, zorder=1)
    if recorded is not None:
        asked = np.asarray(recorded, dtype=np.float64)
        axes.plot(
            asked[:, 0], asked[:, 1], color=RECORDED, linewidth=5.5, alpha=0.8, zorder=4.5, label="recorded"
        )
    axes.plot(track[:, 0], track[:, 1], color=INK, linewidth=1.2, zorder=5, label="driven")

    rows = _stations(track[:, :2], along, 1.4 * size * scale, count)
    for number, row in enumerate(rows):
        fade = 0.55 * (1 - (number + 1) / len(rows))
        pose, height = track[row], 3 + 0.01 * number
        draw_rover(axes, rover, pose, angles[row], fade=fade, scale=scale, treads=False, zorder=height)
    axes.plot(*track[0, :2], "o", color="white", markeredgecolor=INK, markersize=6, zorder=6)
    axes.plot(*track[-1, :2], "o", color=INK, markeredgecolor="white", markersize=8, zorder=6)

    reach = 1.1 * size * scale
    axes.set_xlim(track[:, 0].min() - reach, track[:, 0].max() + reach)
    axes.set_ylim(track[:, 1].min() - reach, track[:, 1].max() + reach)
    axes.set_aspect("equal")
    tidy(axes, "x [m]", "y [m]")
    if scale > 1.0:
        corner = {"xycoords": "axes fraction", "ha": "right", "va": "bottom"}
        write(axes, f"rover drawn {scale:.1f} times its size", (1, 0), (-6, 6), 8, color=SOFT, **corner)
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
