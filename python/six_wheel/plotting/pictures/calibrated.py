"""A calibration: its parameters with their intervals, its runs and windows, and what was left out."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from six_wheel.plotting.drawing import (
    AXLE,
    FORBIDDEN,
    INK,
    LABEL,
    MOTION,
    SOFT,
    draw_legend,
    number,
    page_figure,
    tidy,
    with_title,
    write,
)
from six_wheel.plotting.tracks import draw_residuals

RUNS = 12  # that are drawn


def calibration_figure(found: Any, *, title: str | None) -> Figure:
    """A `Calibration`: values beside the nominal ones, errors before and after, what was left out as slip."""
    rows = max(len(found.parameters), min(len(found.runs), RUNS), 2)
    figure = page_figure(1.4 + 0.32 * rows + 2.4)
    grid = figure.add_gridspec(2, 6, height_ratios=(0.32 * rows + 0.6, 2.0))
    values, errors = figure.add_subplot(grid[0, :3]), figure.add_subplot(grid[0, 3:])
    _draw_values(values, found)
    _draw_runs(errors, found.runs[:RUNS])
    draw_residuals(
        [figure.add_subplot(grid[1, 2 * k : 2 * k + 2]) for k in range(3)],
        found.windows.before,
        found.windows.after,
    )
    left_out = [f"left out as slip: {line}" for line in found.slips] or ["nothing was left out as slip"]
    words = f"intervals of {100 * found.confidence:g} %; errors of windows below"
    return with_title(values, title, "\n".join([words, *left_out[:3]]))


def _draw_values(axes: Axes, found: Any) -> None:
    """Difference of every parameter from its nominal value, with its interval; hatched if none is known."""
    for place, one in enumerate(found.parameters):
        scale, unit = (100.0 / abs(one.nominal), "%") if one.nominal else (1.0, one.unit)
        change = scale * (one.value - one.nominal)
        shown = f"{one.name}\n{number(one.value, '.4g')} {one.unit}"
        if one.identified:
            low, high = scale * (np.array(one.interval) - one.nominal)
            axes.plot([low, high], [place, place], color=AXLE, linewidth=6, alpha=0.5, solid_capstyle="butt")
            axes.plot(change, place, "o", color=MOTION, markersize=6)
            words = f"{number(change, '+.3g')} {unit}"
        else:
            axes.plot(change, place, "x", color=FORBIDDEN, markersize=7, markeredgewidth=2)
            words = "not identified"
        write(axes, words, (change, place), (0, 8), 8, ha="center")
        beside: dict[str, Any] = {"xycoords": ("axes fraction", "data"), "ha": "right", "va": "center"}
        write(axes, shown, (0.0, place), (-6, 0), LABEL, **beside)
    axes.axvline(0.0, color=SOFT, linewidth=0.8)
    axes.set_ylim(len(found.parameters) - 0.4, -0.7)
    axes.set_yticks([])
    axes.margins(x=0.2)
    tidy(axes, "change from the nominal value [%]", "")


def _draw_runs(axes: Axes, runs: Any) -> None:
    """Position error of every run with the nominal and with the calibrated rover."""
    places = np.arange(len(runs))
    for offset, name, colour in ((-0.17, "before", FORBIDDEN), (0.17, "after", MOTION)):
        values = [getattr(run, name) for run in runs]
        axes.barh(places + offset, values, 0.3, color=colour, label=name)
        for place, value in zip(places + offset, values, strict=True):
            axes.annotate(f" {value:.2g}", (value, place), va="center", fontsize=8, color=INK)
    axes.set_yticks(places, [run.name for run in runs])
    axes.invert_yaxis()
    axes.margins(x=0.2)
    draw_legend(axes, loc="lower right", ncols=2, bbox_to_anchor=(1.0, 1.0))
    units = {run.unit for run in runs} or {"m"}
    tidy(axes, f"error of a run, rms [{', '.join(sorted(units))}]", "")
