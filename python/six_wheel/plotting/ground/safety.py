"""Picture of the poses in which a rover can stand, from above."""

import math

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

__all__ = ["traverse_figure"]


def traverse_figure(
    safe: NDArray[np.float32],
    tilt: NDArray[np.float32],
    extent: tuple[float, float, float, float],
    title: str,
) -> Figure:
    """A map of the share of safe headings beside one of the worst tilt.

    Parameters
    ----------
    safe, tilt : ndarray, shape (rows, columns)
        Rows of an image [1], [rad].
    extent : (float, float, float, float)
        x_min, x_max, y_min, y_max [m].
    title : str
        What it shows.
    """
    figure = Figure(figsize=(11, 5), layout="constrained")
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, layer, name, colours, low, high in (
        (left, safe, "share of safe headings", "RdYlGn", 0.0, 1.0),
        (right, np.degrees(tilt), "worst tilt [°]", "magma_r", 0.0, 30.0),
    ):
        image = axes.imshow(layer, extent=extent, cmap=colours, vmin=low, vmax=high, interpolation="nearest")
        axes.set(xlabel="x [m]", title=name, facecolor="0.8")
        figure.colorbar(image, ax=axes, shrink=0.8)
    left.set_ylabel("y [m]")
    known = safe[np.isfinite(safe)]
    share = 100 * float(known.mean()) if known.size else math.nan
    figure.suptitle(f"{title}: {share:.1f} % of poses safe")
    return figure
