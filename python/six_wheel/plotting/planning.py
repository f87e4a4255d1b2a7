"""Pictures of drives by a planner: over its costmap, beside the path it was to follow."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.transforms import Affine2D
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import Costmap, Rover
from six_wheel.plotting.drawing import INK, RECORDED, SOFT, fit_page, one_axes, with_title
from six_wheel.plotting.path import draw_path


def draw_costmap(axes: Axes, costmap: Costmap) -> None:
    """Draw costs, from white to grey, what is lethal black, and the border of the map.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Axes in the frame of the map [m]; their limits become the map's.
    costmap : Costmap
        Costs to draw.
    """
    values = np.asarray(costmap.values, dtype=np.float64)
    (dx, dy), (rows, columns) = costmap.spacing, values.shape
    left, right, low, high = extent = (-dx / 2, (columns - 0.5) * dx, -dy / 2, (rows - 0.5) * dy)
    placed = Affine2D().rotate(costmap.yaw).translate(*costmap.origin)

    def draw(layer: NDArray[np.float64], *colours: str, zorder: float) -> None:
        axes.imshow(
            layer,
            origin="lower",
            extent=extent,
            cmap=LinearSegmentedColormap.from_list("costs", colours),
            zorder=zorder,
            interpolation="nearest",
            transform=placed + axes.transData,
        )

    draw(values, "#ffffff", "#b9c2ca", zorder=0)
    if costmap.lethal is not None:
        draw(np.where(values >= costmap.lethal, 1.0, np.nan), INK, INK, zorder=0.5)
    corners = placed.transform([(left, low), (right, low), (right, high), (left, high)])
    axes.add_patch(Polygon(corners, fill=False, edgecolor=SOFT, linewidth=0.8, zorder=0.7))
    (left, low), (right, high) = corners.min(axis=0), corners.max(axis=0)
    axes.set(xlim=(left, right), ylim=(low, high))


def plan_figure(
    rover: Rover,
    costmap: Costmap,
    poses: ArrayLike,
    steering: ArrayLike,
    *,
    path: ArrayLike | None = None,
    title: str | None = None,
) -> Figure:
    """Picture of a drive over a costmap, the rover drawn along it.

    Parameters
    ----------
    rover, poses, steering
        As in `path_figure`; the poses are those in the frame of the map.
    costmap : Costmap
        Costs that the planner used.
    path : array_like, shape (m, 2 or more), optional
        The path that was to be followed [m].
    title : str, optional
        Written above the picture.

    Raises
    ------
    ValueError
        If the shapes do not fit the rover and each other, or a pose is not finite.
    """
    axes = one_axes(6.0, 8.0)
    length = draw_path(axes, rover, poses, steering, count=8)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    draw_costmap(axes, costmap)
    # Obstacles beside the motion stay in view: 0.6 m on every side.
    axes.set(xlim=(left - 0.6, right + 0.6), ylim=(low - 0.6, high + 0.6))
    if path is not None:
        asked = np.asarray(path, dtype=np.float64)
        if asked.ndim != 2 or asked.shape[1] < 2:
            raise ValueError(f"path must have shape (m, 2 or more), got shape {asked.shape}")
        axes.plot(asked[:, 0], asked[:, 1], color=RECORDED, linewidth=2.5, alpha=0.8, zorder=1.5)
    fit_page(axes)
    return with_title(axes, title, f"{length:.2f} m")
