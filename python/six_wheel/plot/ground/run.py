"""A drive over ground: in three dimensions, as a strip of side views, and what its wheels did."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from six_wheel._core import RockerBogie, Stand, Terrain
from six_wheel.plot.drawing import CENTRE, FAINT, INK, SOFT, WHEEL
from six_wheel.plot.ground.side import draw_side_view
from six_wheel.simulation.ground import GroundSimulation

__all__ = ["film_figure", "ground_figure", "speeds_figure"]

Floats = NDArray[np.float64]

MARGIN = 2.0  # [m] of ground around the path
FACETS = 90  # of the drawn ground along its longer side
RIM = 24  # corners of a drawn wheel
ROVERS = 5  # drawn along the path
FRAMES = 6  # of a film strip


def _times(run: GroundSimulation, count: int) -> list[int]:
    """Rows evenly spaced in time at which the rover stands."""
    assert run.stand is not None
    standing = np.flatnonzero(np.isfinite(np.atleast_1d(run.stand.z)))
    return [int(row) for row in standing[np.linspace(0, len(standing) - 1, count).astype(int)]]


def ground_figure(run: GroundSimulation, arm: RockerBogie, ground: Terrain, *, title: str = "") -> Figure:
    """Draw a drive in three dimensions, with its film strip below.

    Parameters
    ----------
    run : GroundSimulation
        What `simulate` returned.
    arm : RockerBogie
        Who drove.
    ground : Terrain
        What it drove over.
    title : str
        A heading.

    Returns
    -------
    matplotlib.figure.Figure
        The ground around the path with the rover at five times; the rover from its left at six.
    """
    figure = Figure(figsize=(11, 9), layout="constrained")
    parts: Any = figure.subfigures(2, 1, height_ratios=(4, 1))
    upper, lower = parts
    _draw_space(upper.add_subplot(projection="3d"), run, arm, ground, title)
    _draw_film(list(lower.subplots(1, FRAMES)), run, arm)
    return figure


def film_figure(run: GroundSimulation, arm: RockerBogie, *, title: str = "") -> Figure:
    """Draw the rover from its left at six times of a drive."""
    figure = Figure(figsize=(14, 3.2), layout="constrained")
    figure.suptitle(title, x=0.01, ha="left", color=INK)
    _draw_film(list(figure.subplots(1, FRAMES)), run, arm)
    return figure


def speeds_figure(run: GroundSimulation, arm: RockerBogie, *, title: str = "") -> Figure:
    """Draw how fast the wheels turn, against what the same commands ask for on level ground."""
    assert run.speeds is not None
    assert run.flat_speeds is not None
    figure = Figure(figsize=(11, 6), layout="constrained")
    figure.suptitle(title, x=0.01, ha="left", color=INK)
    panels = figure.subplots(3, 2, sharex=True, sharey=True)
    for axes, name, speed, flat in zip(
        panels.flat, arm.wheel_names, run.speeds.T, run.flat_speeds.T, strict=True
    ):
        axes.plot(run.stamps, speed, color=CENTRE, lw=1.0, label="on this ground")
        axes.plot(run.stamps, flat, color=INK, lw=1.0, ls="--", label="on level ground")
        axes.set_title(name.replace("_", " "), loc="left", fontsize="small", color=SOFT)
        axes.grid(color=FAINT, lw=0.5)
    panels[0, 0].legend(fontsize="small", frameon=False, ncols=2)
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    for axes in panels[:, 0]:
        axes.set_ylabel("speed [rad/s]")
    return figure


def _draw_space(axes: Any, run: GroundSimulation, arm: RockerBogie, ground: Terrain, title: str) -> None:
    assert run.truth is not None
    assert run.stand is not None
    poses, stand = run.truth.poses, run.stand
    low, high = poses[:, :2].min(axis=0) - MARGIN, poses[:, :2].max(axis=0) + MARGIN
    counts = np.maximum(2, np.ceil(FACETS * (high - low) / (high - low).max()).astype(int))
    x, y = (np.linspace(low[k], high[k], counts[k]) for k in (0, 1))
    places = np.stack(np.meshgrid(x, y), axis=-1)
    heights = np.asarray(ground.height(places))
    axes.plot_surface(
        *np.moveaxis(places, -1, 0),
        heights,
        cmap="gist_earth",
        alpha=0.75,
        linewidth=0,
        rcount=200,
        ccount=200,
    )
    centres = np.asarray(stand.transform)[:, :3, 3]
    on_ground = np.asarray(ground.height(poses[:, :2])) + 0.05
    axes.plot(poses[:, 0], poses[:, 1], on_ground, color=CENTRE, lw=2.0, zorder=10)
    for row in _times(run, ROVERS):
        _draw_rover(axes, arm, stand, row)
    known = np.concatenate([heights.ravel(), centres[:, 2]])
    known = known[np.isfinite(known)]
    axes.set_box_aspect((high[0] - low[0], high[1] - low[1], max(np.ptp(known), 0.5) + 1.0), zoom=1.12)
    axes.locator_params(axis="z", nbins=3)
    axes.set_zlim(known.min(), known.min() + max(np.ptp(known), 0.5) + 1.0)
    axes.set_title(title, loc="left", color=INK)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_zlabel("z [m]")


def _draw_rover(axes: Any, arm: RockerBogie, stand: Stand, row: int) -> None:
    """Links and wheels at one pose."""
    transform, joints = stand.transform[row], stand.joints[row]
    frames = arm.frames(joints[0], joints[1:], stand.steering[row])
    world = {name: transform @ frame for name, frame in frames.items()}
    radius = arm.dimensions["wheel_radius"]
    t = np.linspace(0, 2 * np.pi, RIM)
    rim = radius * np.stack([np.sin(t), np.zeros(RIM), -np.cos(t)], axis=-1)
    for link in arm.links:
        if link.parent != "R" and link.frame != "D":
            ends = np.array([world[link.parent][:3, 3], world[link.frame][:3, 3]])
            axes.plot(*ends.T, color=INK, lw=1.2, zorder=11)
    for number in range(1, 7):
        wheel = world[f"A{number}"]
        axes.plot(*(rim @ wheel[:3, :3].T + wheel[:3, 3]).T, color=WHEEL, lw=1.6, zorder=12)


def _draw_film(panels: list[Axes], run: GroundSimulation, arm: RockerBogie) -> None:
    assert run.stand is not None
    for axes, row in zip(panels, _times(run, len(panels)), strict=True):
        one = arm.settle(run.stand.ground, run.stand.poses[row], run.stand.steering[row])
        draw_side_view(axes, arm, one)
        axes.set_title(f"{run.stamps[row]:.0f} s", fontsize="small", color=SOFT)
        axes.set_xticks([])
        axes.set_yticks([])
