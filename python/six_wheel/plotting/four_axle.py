"""Picture of a simulated `FourAxle`: path and tracks of the wheels, axles and brakes over time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from six_wheel.kinematics.four_axle import FourAxleSimulation
from six_wheel.log_odometry.evaluation.relative import path_distance
from six_wheel.plotting.drawing import (
    AXLE,
    FAINT,
    INK,
    MOTION,
    PAGE_WIDTH,
    SOFT,
    TRACK,
    bounds,
    contacts,
    draw_legend,
    draw_rover,
    in_world,
    new_figure,
    tidy,
    with_title,
)

WIDTH, TIMELINE, STRIPS = PAGE_WIDTH, 1.9, 0.5  # [in]
FREE = {"front": MOTION, "rear": AXLE}
NAMES = ("front left", "front right", "rear left", "rear right")
STYLES = ((MOTION, "-"), (MOTION, "--"), (AXLE, "-"), (AXLE, "--"))
SAME_PLACE = 0.02  # rover sizes: nearer than this, two poses are one


def four_axle_figure(result: FourAxleSimulation, *, title: str | None = None) -> Figure:
    """Picture of a simulated drive: where it went, and below it axle angles and free brakes over time.

    Parameters
    ----------
    result : FourAxleSimulation
        From `FourAxle.simulate`.
    title : str, optional
        Written above the picture.

    Returns
    -------
    matplotlib.figure.Figure
        The vehicle is drawn where it begins, where a brake changes, and where it ends; where it re-aimed its
        axles standing, with the old angles faded under the new ones.
    """
    rover, poses = result.rover, result.poses
    *_, size = bounds(rover)
    low = poses[:, :2].min(axis=0) - (1.25 * size, 1.6 * size)  # words stand below
    high = poses[:, :2].max(axis=0) + 1.25 * size
    across, along = (float(length) for length in high - low)
    height = float(np.clip((WIDTH - 0.9) * along / across, 2.2, 4.6))
    figure = new_figure(WIDTH, height + TIMELINE + STRIPS + 1.6)
    rows = figure.subplots(3, 1, height_ratios=(height, TIMELINE, STRIPS))
    path, angles, brakes = rows
    angles.sharex(brakes)

    _draw_path(path, result, size)
    path.set_xlim(low[0], high[0])
    path.set_ylim(low[1], high[1])
    path.set_aspect("equal")
    tidy(path, "x [m]", "y [m]")
    length = path_distance(poses)[-1]
    slip = float(result.residuals.max())
    with_title(path, title, f"{length:.2f} m in {result.stamps[-1]:.1f} s   slip at most {slip:.0e} m/s")

    _draw_angles(angles, result)
    _draw_brakes(brakes, result)
    return figure


def _draw_path(axes: Axes, result: FourAxleSimulation, size: float) -> None:
    rover, poses, angles = result.rover, result.poses, result.steering
    tracks = in_world(poses, contacts(rover, angles))
    axes.plot(tracks[..., 0], tracks[..., 1], color=TRACK, linewidth=1.0, zorder=1)
    axes.plot(poses[:, 0], poses[:, 1], color=INK, linewidth=1.2, zorder=5)
    shown: list[int] = []
    for number, row in enumerate(_stations(result)):
        gaps = [float(np.hypot(*(poses[row] - poses[other])[:2])) for other in shown]
        near = min(gaps, default=np.inf)
        if SAME_PLACE * size < near < 1.7 * size:
            continue  # they would stand on each other
        old = 0.72 if _stands_after(result, row) else 0.0
        draw_rover(axes, rover, poses[row], angles[row], fade=old, treads=False, zorder=3 + 0.01 * number)
        shown.append(row)
    for end in np.unique(result.ends)[:-1]:
        axes.plot(*poses[end, :2], "o", color="white", markeredgecolor=INK, markersize=5, zorder=6)
    axes.plot(*poses[0, :2], "o", color="white", markeredgecolor=INK, markersize=7, zorder=6)
    axes.plot(*poses[-1, :2], "o", color=INK, markeredgecolor="white", markersize=8, zorder=6)
    _write_actions(axes, result, size)


def _stations(result: FourAxleSimulation) -> list[int]:
    """Rows at which something begins or ends, the last and the first ones most deserving of room."""
    last = len(result.stamps) - 1
    return sorted({0, last, *(int(row) for row in result.ends)}, key=lambda row: (row not in (0, last), row))


def _stands_after(result: FourAxleSimulation, row: int) -> bool:
    """True if the axles turn after this row while the body stands."""
    later = result.ends[result.ends > row]
    if len(later) == 0:
        return False
    stands = bool(np.allclose(result.poses[later[0]], result.poses[row], rtol=0, atol=1e-9))
    return stands and not np.allclose(result.steering[later[0]], result.steering[row], rtol=0, atol=1e-9)


def _write_actions(axes: Axes, result: FourAxleSimulation, size: float) -> None:
    """Write the actions that take time beside the places where they happen; the strips show the rest."""
    places: list[tuple[np.ndarray, list[str]]] = []
    begin = 0
    for step, end in zip(result.steps, result.ends.tolist(), strict=True):
        middle = result.poses[(begin + end) // 2]
        begin = end
        if step.duration == 0.0:
            continue
        if places and np.hypot(*(places[-1][0] - middle)[:2]) < 0.5 * size:
            places[-1][1].append(step.action)
        else:
            places.append((middle, [step.action]))
    for middle, actions in places:
        x, y, yaw = middle
        side = np.array((np.sin(yaw), -np.cos(yaw))) * 1.05 * size  # to the right of the body
        words = "\n".join(actions)
        axes.text(x + side[0], y + side[1], words, ha="center", va="top", fontsize=8, color=SOFT, zorder=8)


def _draw_angles(axes: Axes, result: FourAxleSimulation) -> None:
    for axle, (name, (color, style)) in enumerate(zip(NAMES, STYLES, strict=True)):
        degrees = np.degrees(result.steering[:, axle])
        axes.plot(result.stamps, degrees, style, color=color, linewidth=1.5, label=name)
    tidy(axes, "", "axle angle [°]")
    axes.tick_params(labelbottom=False)
    place = {"loc": "lower left", "bbox_to_anchor": (0, 1), "borderaxespad": 0.1}
    draw_legend(axes, ncols=4, fontsize=8, handlelength=2.2, **place)


def _draw_brakes(axes: Axes, result: FourAxleSimulation) -> None:
    ends = result.stamps[result.ends] if len(result.ends) else np.zeros(0)
    begin = 0.0
    for step, end in zip(result.steps, ends.tolist(), strict=True):
        for level, pair in enumerate(("rear", "front")):
            free = getattr(step, f"{pair}_brake") == "free"
            color = FREE[pair] if free else FAINT
            axes.barh(level, end - begin, left=begin, height=0.62, color=color, linewidth=0)
        begin = end
    tidy(axes, "t [s]", "")
    axes.grid(False)
    axes.set_yticks((0, 1), ("rear free", "front free"))
    axes.set_xlim(0.0, max(begin, 1e-9))
    for time in ends[:-1]:
        axes.axvline(time, color="white", linewidth=1.0, zorder=4)
    axes.tick_params(axis="y", colors=SOFT)
