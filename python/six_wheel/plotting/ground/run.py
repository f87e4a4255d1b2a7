"""A drive over ground: in three dimensions, as a strip of side views, and what its wheels did."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LightSource, to_rgb
from matplotlib.figure import Figure

from six_wheel._core import RockerBogie, SettledPose, Terrain
from six_wheel.plotting.drawing import CENTRE, FAINT, INK, SOFT, TRACK, WHEEL, tidy
from six_wheel.plotting.ground.side import draw_side_view
from six_wheel.simulation.on_terrain import GroundSimulation

MARGIN = 2.0  # [m] of ground around the path
FACETS = 180  # of the drawn ground along its longer side
RIM = 24  # corners of a drawn wheel
ROVERS = 5  # drawn along the path
FRAMES = 6  # of a film strip


def _times(run: GroundSimulation, count: int) -> list[int]:
    """Rows evenly spaced in time at which the rover stands."""
    standing = np.flatnonzero(np.isfinite(np.atleast_1d(run.stand.z)))
    return [int(row) for row in standing[np.linspace(0, len(standing) - 1, count).astype(int)]]


def ground_figure(
    run: GroundSimulation, suspension: RockerBogie, ground: Terrain, *, title: str = ""
) -> Figure:
    """Draw a drive in three dimensions, with its film strip below.

    Parameters
    ----------
    run : GroundSimulation
        Result of `simulate`.
    suspension : RockerBogie
        Suspension that drove.
    ground : Terrain
        Ground under it.
    title : str
        A heading.

    Returns
    -------
    matplotlib.figure.Figure
        The ground around the path with the rover at five times; the rover from its left at six.
    """
    figure = Figure(figsize=(11, 7.4))
    # A square as wide as the picture, its middle in that of the upper part: a space is clipped to its square.
    square = 11 / 7.4
    space = figure.add_axes((0.0, 0.61 - square / 2, 1.0, square), projection="3d", facecolor="none")
    _draw_space(space, run, suspension, ground)
    strip = figure.add_gridspec(1, FRAMES, left=0.01, right=0.99, bottom=0.02, top=0.2, wspace=0.04)
    _draw_film([figure.add_subplot(strip[k]) for k in range(FRAMES)], run, suspension)
    figure.text(0.012, 0.985, title, ha="left", va="top", color=INK, weight="bold")
    return figure


def film_figure(run: GroundSimulation, suspension: RockerBogie, *, title: str = "") -> Figure:
    """Draw the rover from its left at six times of a drive."""
    figure = Figure(figsize=(14, 3.2), layout="constrained")
    figure.suptitle(title, x=0.01, ha="left", color=INK)
    _draw_film(list(figure.subplots(1, FRAMES)), run, suspension)
    return figure


def speeds_figure(run: GroundSimulation, suspension: RockerBogie, *, title: str = "") -> Figure:
    """Draw how fast the wheels turn, against what the same commands ask for on level ground."""
    figure = Figure(figsize=(11, 6), layout="constrained")
    figure.suptitle(title, x=0.01, ha="left", color=INK)
    panels = figure.subplots(3, 2, sharex=True, sharey=True)
    for axes, name, speed, flat in zip(
        panels.flat, suspension.wheel_names, run.wheel_speeds.T, run.flat_wheel_speeds.T, strict=True
    ):
        axes.plot(run.stamps, speed, color=CENTRE, lw=1.0, label="on this ground")
        axes.plot(run.stamps, flat, color=INK, lw=1.0, ls="--", label="on level ground")
        axes.set_title(name.replace("_", " "), loc="left", fontsize="small", color=SOFT)
        tidy(axes, "time [s]" if axes in panels[-1] else "", "speed [rad/s]" if axes in panels[:, 0] else "")
    panels[0, 0].legend(fontsize="small", frameon=False, ncols=2)
    return figure


def _draw_space(axes: Any, run: GroundSimulation, suspension: RockerBogie, ground: Terrain) -> None:
    poses, stand = run.truth.poses, run.stand
    low, high = poses[:, :2].min(axis=0) - MARGIN, poses[:, :2].max(axis=0) + MARGIN
    counts = np.maximum(2, np.ceil(FACETS * (high - low) / (high - low).max()).astype(int))
    x, y = (np.linspace(low[k], high[k], counts[k]) for k in (0, 1))
    places = np.stack(np.meshgrid(x, y), axis=-1)
    heights = np.asarray(ground.height_at(places))
    sun = LightSource(azdeg=300, altdeg=40)
    bright = sun.hillshade(
        np.nan_to_num(heights, nan=float(np.nanmin(heights))), vert_exag=1.5, dx=x[1] - x[0]
    )
    colours = np.ones((*heights.shape, 4))
    colours[..., :3] = np.array(to_rgb(TRACK)) * (0.55 + 0.5 * bright[..., None]).clip(0.0, 1.05)
    axes.plot_surface(
        *np.moveaxis(places, -1, 0),
        heights,
        facecolors=colours.clip(0.0, 1.0),
        linewidth=0,
        antialiased=False,
        rcount=max(counts),
        ccount=max(counts),
        shade=False,
    )
    centres = np.asarray(stand.transform)[:, :3, 3]
    on_ground = np.asarray(ground.height_at(poses[:, :2])) + 0.05
    axes.plot(poses[:, 0], poses[:, 1], on_ground, color=CENTRE, lw=2.0, zorder=10)
    for row in _times(run, ROVERS):
        _draw_rover(axes, suspension, stand, row)
    known = np.concatenate([heights.ravel(), centres[:, 2]])
    known = known[np.isfinite(known)]
    tall = max(np.ptp(known), 0.5) + 1.0
    axes.set_box_aspect((high[0] - low[0], high[1] - low[1], tall), zoom=0.86)
    axes.view_init(elev=38, azim=-65)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(known.min(), known.min() + tall))
    axes.set_zticks([])
    for axis, name in ((axes.xaxis, "x [m]"), (axes.yaxis, "y [m]"), (axes.zaxis, "")):
        axis.pane.set_visible(False)
        axis.line.set_color("none" if not name else FAINT)
        axis.set_label_text(name, color=SOFT, fontsize=8)
        axis.labelpad = 12  # off the ticks, whose words lie along the axis here
        axis.set_tick_params(colors=SOFT, labelsize=8)
    axes.grid(False)


def _draw_rover(axes: Any, suspension: RockerBogie, stand: SettledPose, row: int) -> None:
    """Links and wheels at one pose."""
    transform, joints = stand.transform[row], stand.joints[row]
    frames = suspension.frames(joints, stand.steering[row])
    world = {name: transform @ frame for name, frame in frames.items()}
    radius = suspension.dimensions["wheel_radius"]
    t = np.linspace(0, 2 * np.pi, RIM)
    rim = radius * np.stack([np.sin(t), np.zeros(RIM), -np.cos(t)], axis=-1)
    for link in suspension.links:
        if link.parent != "R" and link.frame != "D":
            ends = np.array([world[link.parent][:3, 3], world[link.frame][:3, 3]])
            axes.plot(*ends.T, color=INK, lw=1.2, zorder=11)
    for number in range(1, 7):
        wheel = world[f"A{number}"]
        axes.plot(*(rim @ wheel[:3, :3].T + wheel[:3, 3]).T, color=WHEEL, lw=1.6, zorder=12)


def _draw_film(panels: list[Axes], run: GroundSimulation, suspension: RockerBogie) -> None:
    for axes, row in zip(panels, _times(run, len(panels)), strict=True):
        one = suspension.settle(run.stand.ground, run.stand.poses[row], run.stand.steering[row])
        draw_side_view(axes, suspension, one)
        axes.set_title(f"{run.stamps[row]:.0f} s", fontsize="small", color=SOFT)
        axes.set_xticks([])
        axes.set_yticks([])
        axes.spines[:].set_visible(False)
