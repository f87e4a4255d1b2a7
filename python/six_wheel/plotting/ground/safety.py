"""Picture of the poses in which a rover can stand, from above."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from six_wheel.plotting.drawing import color_bar, page_figure, tidy, with_title


def traverse_figure(
    safe: NDArray[np.float32],
    tilt: NDArray[np.float32],
    extent: tuple[float, float, float, float],
    title: str | None,
) -> Figure:
    """A map of the share of safe headings beside one of the worst tilt.

    Parameters
    ----------
    safe, tilt : ndarray, shape (rows, columns)
        Rows of an image [1], [rad].
    extent : (float, float, float, float)
        x_min, x_max, y_min, y_max [m].
    title : str or None
        Written above the picture.
    """
    wide, high = extent[1] - extent[0], extent[3] - extent[2]
    rows = 2 if wide > 1.3 * high else 1  # wide maps lie one above the other
    share = high / wide * (1.0 if rows == 2 else 0.5)
    figure = page_figure(rows * min(max(5.4 * share, 1.2), 6.0) + 1.2)
    panels = figure.subplots(rows, 3 - rows, sharex=True, sharey=True)
    for axes, layer, name, colours, most in (
        (panels[0], safe, "share of safe headings [1]", "cividis", 1.0),
        (panels[1], np.degrees(tilt), "worst tilt [°]", "magma_r", 30.0),
    ):
        image = axes.imshow(layer, extent=extent, cmap=colours, vmin=0.0, vmax=most, interpolation="nearest")
        axes.set_facecolor("0.8")
        tidy(axes, "x [m]", "y [m]")
        axes.grid(False)
        color_bar(image, axes, name)
    known = safe[np.isfinite(safe)]
    found = 100 * float(known.mean()) if known.size else math.nan
    return with_title(panels[0], title, f"{found:.1f} % of poses safe; grey: not known")


def traversed_figure(done: Any, *, title: str | None) -> Figure:
    """A `Traversed` map."""
    return traverse_figure(done.picture.safe, done.picture.tilt, done.extent, title)
