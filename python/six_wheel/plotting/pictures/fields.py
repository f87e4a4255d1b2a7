"""Maps from above: ground, costs, plans and rollouts."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LightSource, LinearSegmentedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from six_wheel._core import Costmap, MppiPlan, Terrain
from six_wheel.plotting.drawing import (
    CENTRE,
    INK,
    MOTION,
    SOFT,
    TRACK,
    color_bar,
    equal_scales,
    number,
    one_axes,
    tidy,
    with_title,
)
from six_wheel.plotting.planning import draw_costmap

NODES = 400  # of a drawn map along its longer side
ROLLOUTS = 300  # that are drawn
LEAST = 0.2  # [m] of the plane that a picture shows
BESIDE = 1.0  # [m] of a costmap around paths
SUN = LightSource(azdeg=315, altdeg=40)


def _nodes(grid: Terrain | Costmap, shape: tuple[int, ...], step: int = 1) -> NDArray[np.float64]:
    """x and y of every `step`-th node of a grid in the world, shape (2, rows, columns) [m]."""
    rows, columns = np.indices(shape) * step
    (dx, dy), (x, y) = grid.spacing, grid.origin
    along, up, cos, sin = columns * dx, rows * dy, np.cos(grid.yaw), np.sin(grid.yaw)
    return np.stack((x + cos * along - sin * up, y + sin * along + cos * up))


def draw_ground(axes: Axes, ground: Terrain) -> None:
    """Relief with contour lines; what is not known stays white."""
    heights = np.asarray(ground.heights, dtype=float)
    if not np.isfinite(heights).any():
        raise ValueError("ground must have a known height to be drawn, all of them are NaN")
    step = max(1, -(-max(heights.shape) // NODES))
    heights = heights[::step, ::step]
    dx, dy = np.multiply(ground.spacing, step)
    filled = np.nan_to_num(heights, nan=float(np.nanmin(heights)))
    bright = SUN.hillshade(filled, vert_exag=2.0, dx=dx, dy=dy)
    colours = LinearSegmentedColormap.from_list("ground", [INK, TRACK, "#ffffff"])
    x, y = _nodes(ground, heights.shape, step)
    shown = np.where(np.isfinite(heights), bright, np.nan)
    smooth: Literal["gouraud", "nearest"]
    smooth = "gouraud" if np.isfinite(shown).all() else "nearest"  # the smooth one knows no holes
    axes.pcolormesh(x, y, shown, cmap=colours, vmin=-0.4, vmax=1.2, shading=smooth, rasterized=True, zorder=0)
    if np.nanmax(heights) > np.nanmin(heights):
        lines = axes.contour(x, y, heights, levels=8, colors=INK, linewidths=0.6, alpha=0.6, zorder=0.5)
        for words in axes.clabel(lines, fontsize=7.5, fmt=lambda height: number(height, ".2g")):
            words.set(clip_on=True, in_layout=False)  # those beyond the limits of the axes take no room
    axes.autoscale_view(tight=True)


def terrain_figure(ground: Terrain, *, title: str | None) -> Figure:
    """A `Terrain`: relief with contour lines [m]."""
    axes = one_axes(6.0)
    draw_ground(axes, ground)
    equal_scales(axes)
    tidy(axes, "x [m]", "y [m]")
    heights = np.asarray(ground.heights)
    rows, columns = heights.shape
    low, high = (number(float(end(heights)), ".3g") for end in (np.nanmin, np.nanmax))
    words = f"{rows} x {columns} nodes, contour lines: heights {low} to {high} m"
    return with_title(axes, title, words)


def costmap_figure(costmap: Costmap, *, title: str | None) -> Figure:
    """A `Costmap`: costs in grey, what is lethal dark and hatched."""
    axes = one_axes(6.0)
    _draw_costs(axes, costmap)
    color_bar(axes.images[0], axes, "cost [1]")
    values = costmap.values
    frame = "" if costmap.frame is None else f" in frame {costmap.frame}"
    return with_title(axes, title, f"{values.shape[0]} x {values.shape[1]} cells{frame}; lethal ones hatched")


def _draw_costs(axes: Axes, costmap: Costmap) -> None:
    draw_costmap(axes, costmap)
    values, lethal = np.asarray(costmap.values, dtype=float), costmap.lethal
    if lethal is not None and (values >= lethal).any():
        look: dict[str, Any] = {"levels": [0.5, 1.5], "colors": "none", "hatches": ["xxx"], "zorder": 0.6}
        axes.contourf(*_nodes(costmap, values.shape), values >= lethal, **look)
    tidy(axes, "x [m]", "y [m]")


def plan_path_figure(plan: Any, *, title: str | None, costmap: Costmap | None = None) -> Figure:
    """An `MppiPlan`: the poses it leads to, over a costmap where one is given, and their motion."""
    axes = one_axes(5.0)
    _draw_poses(axes, np.asarray(plan.poses))
    _over_costs(axes, costmap)
    tidy(axes, "x [m]", "y [m]")
    vx, vy, omega = plan.twist
    words = f"now vx {vx:.3g} m/s, vy {vy:.3g} m/s, omega {omega:.3g} rad/s; cost {plan.cost:.3g}"
    return with_title(axes, title, f"{words}\n{plan.reason}" if plan.reason else words)


def _over_costs(axes: Axes, costmap: Costmap | None) -> None:
    """Both axes at one scale around what is drawn, with a margin of `BESIDE`, and the costs beneath it."""
    if costmap is not None:
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        _draw_costs(axes, costmap)
        axes.set(xlim=(left - BESIDE, right + BESIDE), ylim=(low - BESIDE, high + BESIDE))
    equal_scales(axes, LEAST)


def _draw_poses(axes: Axes, poses: Any) -> None:
    """A path of poses, with a stroke along the heading at some."""
    axes.plot(*poses[:, :2].T, color=MOTION, linewidth=2.2, zorder=5)
    some = poses[np.linspace(0, len(poses) - 1, 8).astype(int)]
    axes.quiver(
        *some[:, :2].T, np.cos(some[:, 2]), np.sin(some[:, 2]), color=INK, width=0.004, scale=25, zorder=6
    )
    axes.plot(*poses[0, :2], "o", color="white", markeredgecolor=INK, markersize=7, zorder=7)


def _draw_rollouts(axes: Axes, paths: Any, costs: Any, words: str) -> None:
    """Paths (k, t, 2 or 3) coloured by a number, the smallest on top."""
    order = np.argsort(-np.asarray(costs))
    order = order[np.linspace(0, len(order) - 1, min(len(order), ROLLOUTS)).astype(int)]
    lines = LineCollection(list(paths[order][..., :2]), cmap="cividis", linewidths=0.9, alpha=0.8, zorder=3)
    lines.set_array(np.asarray(costs)[order])
    axes.add_collection(lines)
    axes.autoscale_view()
    color_bar(lines, axes, words)


def planner_figure(
    planner: Any, *, title: str | None, plan: MppiPlan | None = None, costmap: Costmap | None = None
) -> Figure:
    """An `Mppi`: the rollouts of its last cycle by their cost, and its plan.

    They begin at the rover; with the `plan` of that cycle where it was then, over its `costmap`.
    """
    from six_wheel._core import rollout

    if costmap is not None and plan is None:
        raise TypeError("costmap must come with plan, the result of the step: it says where the rover was")
    start = (0.0, 0.0, 0.0) if plan is None else plan.poses[0]
    axes = one_axes(5.4)
    if len(planner.costs):
        paths = np.asarray(rollout(planner.wishes, planner.dt, start))
        _draw_rollouts(axes, paths, planner.costs, "cost of a rollout [1]")
    if plan is None:
        _draw_poses(axes, np.asarray(rollout(planner.state["controls"][None], planner.dt))[0])
        words = ("ahead of the rover [m]", "to its left [m]")
    else:
        _draw_poses(axes, np.asarray(plan.poses))
        words = ("x [m]", "y [m]")
    _over_costs(axes, costmap)
    tidy(axes, *words)
    below = f"{planner.samples} rollouts of {planner.horizon} steps as they were sampled; green: the plan"
    return with_title(axes, title, f"{below}\n{plan.reason}" if plan is not None and plan.reason else below)


def rollouts_figure(found: Any, *, title: str | None, costmap: Costmap | None = None) -> Figure:
    """A `RolloutCost`: its paths, by the largest speed of a wheel, over a costmap where one is given."""
    poses = np.asarray(found.poses).reshape(-1, *np.shape(found.poses)[-2:])
    speeds = np.asarray(found.max_wheel_speed).ravel()
    axes = one_axes(5.0)
    _draw_rollouts(axes, poses, speeds, "largest wheel speed [rad/s]")
    _over_costs(axes, costmap)
    tidy(axes, "x [m]", "y [m]")
    axes.plot(*poses[0, 0, :2], "o", color=CENTRE, markeredgecolor=SOFT, zorder=6)
    return with_title(axes, title, f"{len(poses)} rollouts")
