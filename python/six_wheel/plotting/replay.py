"""Picture of a record that was run again: both ways, and what was wanted and commanded over time."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from six_wheel.control_loop.replay.compare_runs import compare
from six_wheel.control_loop.replay.run_summary import Replayed, Run
from six_wheel.kinematics.poses import Floats
from six_wheel.plotting.drawing import (
    AXLE,
    CENTRE,
    FAINT,
    SOFT,
    draw_legend,
    few_rows,
    page_figure,
    tidy,
    with_title,
)

SECOND = 1e9
LOOKS = {"recorded": (SOFT, 3.0), "again": (CENTRE, 1.4)}
ROWS = (("forward [m/s]", 0), ("turning [rad/s]", 2))


def replay_figure(replayed: Replayed, *, title: str | None = None) -> Figure:
    """Picture of a record and of what came of running it again.

    Parameters
    ----------
    replayed : Replayed
        Result to show.
    title : str, optional
        Written above the picture.
    """
    difference = compare(replayed)
    figure = page_figure(8.4)
    grid = figure.add_gridspec(len(ROWS) + 2, 1, height_ratios=(2.4, *[1.0] * (len(ROWS) + 1)))
    ways = figure.add_subplot(grid[0])
    both = (difference.recorded, difference.again)
    for (label, (colour, width)), run in zip(LOOKS.items(), both, strict=True):
        x, y = few_rows(*run.path[:, :2].T)
        ways.plot(x, y, color=colour, linewidth=width, label=label)
        ways.plot(x[-1], y[-1], "o", color=colour, markersize=5)
    ways.set_aspect("equal", adjustable="datalim")
    tidy(ways, "x [m]", "y [m]")
    draw_legend(ways, fontsize=None)
    same = f"differ in {difference.differing:,} of {difference.common:,} steps"
    below = f"the commanded way; commands {'are the same bits' if difference.same_bits else same}"
    with_title(ways, title, below)
    runs = (replayed.recorded, replayed.again)
    begin = float(min(run.times[0] for run in runs if len(run.times)))
    for row, (name, column) in enumerate(ROWS):
        axes = figure.add_subplot(grid[row + 1])
        if len(wanted := replayed.wanted):
            time, value = few_rows((wanted[:, 0] - begin) / SECOND, wanted[:, 1 + column])
            axes.step(time, value, where="post", color=FAINT, linewidth=1.0, label="wanted")
        _draw_runs(axes, runs, begin, [run.twists[:, column] for run in runs])
        if column == 0 and len(wanted):
            draw_legend(axes, fontsize=None)
        tidy(axes, "", name)
    axes = figure.add_subplot(grid[-1])
    fastest = [np.abs(run.wheel_speeds).max(axis=1, initial=0.0) for run in runs]
    _draw_runs(axes, runs, begin, fastest)
    limit = replayed.after.parameters.limits.wheel_speed
    if np.isfinite(limit):
        axes.axhline(limit, color=AXLE, linewidth=0.8, linestyle="--")
    tidy(axes, "time [s]", "fastest wheel [rad/s]")
    return figure


def _draw_runs(axes: Axes, runs: Sequence[Run], begin: float, values: Sequence[Floats]) -> None:
    """A quantity of both runs over time."""
    for (colour, width), run, drawn in zip(LOOKS.values(), runs, values, strict=True):
        axes.plot(*few_rows((run.times - begin) / SECOND, drawn), color=colour, linewidth=width)
