"""A map of heights from above: relief, slope, unknown cells."""

import numpy as np
from matplotlib.colors import LightSource
from matplotlib.figure import Figure

from six_wheel._core import Terrain

__all__ = ["map_figure"]

LARGEST = 1000  # drawn rows and columns
STEEPEST = 45.0  # end of the scale of slopes [deg]
SUN = LightSource(azdeg=315, altdeg=45)


def map_figure(ground: Terrain, *, title: str = "") -> Figure:
    """Draw the relief of a map beside its slope; unknown cells are grey.

    Parameters
    ----------
    ground : Terrain
        The map; axes are those of its rows, from node (0, 0), if it is turned.
    title : str
        A heading.
    """
    step = max(1, max(ground.shape) // LARGEST)
    heights = np.asarray(ground.heights[::step, ::step], np.float64)
    (dx, dy), (x, y) = (step * size for size in ground.spacing), ground.origin
    if ground.yaw:
        x = y = 0.0
    rows, columns = heights.shape
    extent = (x - dx / 2, x + dx * (columns - 0.5), y - dy / 2, y + dy * (rows - 0.5))
    across, along = np.gradient(heights, dy, dx)
    slopes = np.degrees(np.arctan(np.hypot(along, across)))
    figure = Figure(figsize=(11, 5), layout="constrained")
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    known = np.nan_to_num(heights, nan=float(np.nanmean(heights)) if np.isfinite(heights).any() else 0.0)
    shade = np.where(np.isnan(heights), np.nan, SUN.hillshade(known, dx=dx, dy=dy))
    told = {"extent": extent, "origin": "lower", "interpolation": "nearest"}
    image = left.imshow(heights, cmap="terrain", **told)
    left.imshow(shade, cmap="gray", alpha=0.45, vmin=0.0, vmax=1.0, **told)
    figure.colorbar(image, ax=left, shrink=0.8, label="height [m]")
    image = right.imshow(slopes, cmap="magma_r", vmin=0.0, vmax=STEEPEST, **told)
    figure.colorbar(image, ax=right, shrink=0.8, label="slope [°]", extend="max")
    for axes, name in ((left, "relief, light from the north-west"), (right, "slope")):
        axes.set(xlabel="x [m]", title=name, facecolor="0.8")
        axes.ticklabel_format(useOffset=False, scilimits=(-9, 9))
    left.set_ylabel("y [m]")
    figure.suptitle(title)
    return figure
