"""A map of heights from above: relief, slope, unknown cells."""

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import LightSource
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from six_wheel._core import Terrain

LARGEST = 1000  # drawn rows and columns
STEEPEST = 45.0  # end of the scale of slopes [deg]
SUN = LightSource(azdeg=315, altdeg=45)
UNKNOWN = "0.75"
SIDE = 4.6  # longer side of a panel [in]
LINE = 0.17  # of a fact [in]


def map_figure(ground: Terrain, *, title: str = "", facts: Sequence[tuple[str, str]] = ()) -> Figure:
    """Draw the relief of a map beside its slope; unknown cells are grey.

    Parameters
    ----------
    ground : Terrain
        The map; axes are those of its rows, from node (0, 0), if it is turned.
    title : str
        A heading.
    facts : sequence of (str, str)
        Names and values that are written below.
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
    unknown = np.isnan(heights)
    known = np.nan_to_num(heights, nan=0.0 if unknown.all() else float(np.nanmean(heights)))
    # Beside unknown cells there is no slope, and so no light or shadow.
    shade = np.where(np.isnan(slopes), np.nan, SUN.hillshade(known, dx=dx, dy=dy))
    wide, high = (
        max(SIDE * length / max(dx * columns, dy * rows), 2.2) for length in (dx * columns, dy * rows)
    )
    lines = max(len(facts), 1) * LINE
    figure = Figure(figsize=(2.0 * wide + 3.2, high + 1.2 + lines), layout="constrained")
    parts = figure.subfigures(2, 1, height_ratios=(high + 1.2, lines), squeeze=False)
    above, below = parts[:, 0]
    above.suptitle(title)
    left, right = above.subplots(1, 2, sharex=True, sharey=True)
    drawn = {"extent": extent, "origin": "lower", "interpolation": "nearest"}
    image = left.imshow(heights, cmap="terrain", **drawn)
    left.imshow(shade, cmap="gray", alpha=0.45, vmin=0.0, vmax=1.0, **drawn)
    above.colorbar(image, ax=left, label="height [m]")
    image = right.imshow(slopes, cmap="magma_r", vmin=0.0, vmax=STEEPEST, **drawn)
    above.colorbar(image, ax=right, label="slope [°]", extend="max")
    for axes, name in (
        (left, "relief" if ground.yaw else "relief, light from the north-west"),
        (right, "slope"),
    ):
        axes.set(xlabel="x [m]", facecolor=UNKNOWN)
        axes.set_title(name, fontsize="medium")
        axes.ticklabel_format(useOffset=False, scilimits=(-9, 9))  # places as the map has them
        axes.xaxis.set_major_locator(MaxNLocator(3))
        axes.yaxis.set_major_locator(MaxNLocator(5))
    left.set_ylabel("y along the rows' normal [m]" if ground.yaw else "y [m]")
    if unknown.any():
        right.legend(handles=[Patch(facecolor=UNKNOWN, edgecolor="0.4", label="unknown")], loc="lower right")
    for number, (name, value) in enumerate(facts):
        height = 1.0 - (number + 0.5) / len(facts)
        below.text(0.03, height, name, va="center", fontsize="small", color="0.35")
        below.text(0.16, height, value, va="center", fontsize="small")
    return figure
