"""Picture of a drive through a controller: the path, and commands, joints and reasons over time."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import Limits, Rover
from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.poses import Floats
from six_wheel.plotting.drawing import (
    AXLE,
    FAINT,
    INK,
    LABEL,
    MOTION,
    RECORDED,
    SOFT,
    draw_legend,
    page_figure,
    tidy,
    write,
    write_heading,
)
from six_wheel.plotting.path import draw_path, path_figure
from six_wheel.simulation.drive.closed_loop import ControlledDrive
from six_wheel.simulation.drive.feedforward import Drive
from six_wheel.simulation.drive.min_max_thinning import Course

WHEELS = (AXLE, "#b5651d", MOTION, "#8a6d2f", "#6a62a8", "#b0507a", "#3d8f9e", "#9aa53a")
ASKED, DONE = RECORDED, INK
NEAR = 2.5  # a limit this many times as far away as the values is not in the picture, but said beside it
SIDE = 0.2  # share of the largest value that makes the limit of a side worth its room
STEERING = Reason.STEERING_LIMIT | Reason.STEERING_RATE | Reason.STEERING_ACCELERATION
ROLLING = Reason.WHEEL_SPEED | Reason.WHEEL_ACCELERATION
STATES = ~(2 * Reason.ANGULAR_JERK.value - 1)  # reasons of the command and the loop, not of a motion's size
BODILY = "#b5651d"  # colour of reasons that limit the body
DASHES: tuple[Any, Any] = (
    "-",
    (0, (4, 3)),
)  # of the rear half: where a front wheel does the same, both are seen
TIME_UNITS = ((600.0, 1.0, "s"), (10_800.0, 60.0, "min"), (math.inf, 3600.0, "h"))


def draw_course(
    figure: Figure,
    grid: Any,
    rover: Rover,
    course: Course,
    limits: Limits,
    shares: Mapping[str, float],
) -> list[Axes]:
    """Draw panels over time below each other: twists, joints against their limits, reasons.

    They go into a place in a grid of the figure. `shares` are those of the time, 0 to 1, of every reason
    there was.
    """
    begin, low, high, bits = course.stretches()
    last = begin[-1] if len(begin) else 0.0
    _, scale, unit = next(each for each in TIME_UNITS if last <= each[0])
    begin = begin / scale
    sideways = bool(np.abs(low[:, [1, 4]]).max() > 1e-9 or np.abs(high[:, [1, 4]]).max() > 1e-9)
    panels = _panels(rover, limits, sideways)

    reasons = [each for each in Reason if each.name in shares]
    heights = [1.0] * len(panels) + [max(0.17 * len(reasons), 0.17)]
    rows = [*grid.subgridspec(len(heights), 1, height_ratios=heights)]
    found: list[Axes] = []
    for panel, row in zip(panels, rows, strict=False):
        axes = figure.add_subplot(row, sharex=found[0] if found else None)
        found.append(axes)
        _draw_panel(axes, panel, begin, low, high, course.stride)
    strip = figure.add_subplot(rows[-1], sharex=found[0])
    _draw_reasons(strip, begin, bits, reasons, shares)
    tidy(strip, f"time [{unit}]", "")
    strip.grid(False, axis="y")
    end = max(float(begin[-1]), float(begin[0]) + 1e-9) if len(begin) else 1.0
    strip.set_xlim(0.0, end)
    figure.align_ylabels(found)
    return [*found, strip]


class Panel(NamedTuple):
    """Values over time in one frame: their name, columns, colours, and where their limits are."""

    name: str
    columns: list[int]
    hues: Sequence[str]
    limits: list[float]
    dashed: frozenset[str] = frozenset()
    """Colours of the rear half of the wheels."""


def _panels(rover: Rover, limits: Limits, sideways: bool) -> list[Panel]:
    """Twists, asked for and done, then joints and wheels."""

    def both(limit: float) -> list[float]:
        return [-limit, limit]

    twist = ((0, "vx [m/s]", limits.speed), (1, "vy [m/s]", limits.speed), (2, "ω [rad/s]", limits.yaw_rate))
    panels = [
        Panel(name, [axis, axis + 3], (ASKED, DONE), both(limit))
        for axis, name, limit in twist
        if axis != 1 or sideways
    ]
    wheels, joints = len(rover.wheels), len(rover.steered_wheel_names)
    colours = [WHEELS[k % len(WHEELS)] for k in range(wheels)]
    steering = [colours[k] for k, wheel in enumerate(rover.wheels) if wheel.steered]
    dashed = frozenset(colours[(wheels + 1) // 2 :])
    if joints:
        widest = limits.steering_limit
        ranges = [wheel.steering_range for wheel in rover.wheels if wheel.steering_range is not None]
        ends = [end for end in np.unique(np.clip(ranges, -widest, widest)) if math.isfinite(end)]
        rates = list(range(6 + joints, 6 + 2 * joints))
        rate = both(limits.steering_rate)
        panels.append(Panel("steering [rad]", list(range(6, 6 + joints)), steering, ends, dashed))
        panels.append(Panel("steering rate\n[rad/s]", rates, steering, rate, dashed))
    speeds = [6 + 2 * joints + k for k in range(wheels)]
    panels.append(Panel("wheel speed\n[rad/s]", speeds, colours, both(limits.wheel_speed), dashed))
    return panels


def _draw_panel(axes: Axes, panel: Panel, begin: Floats, low: Floats, high: Floats, stride: int) -> None:
    for place, (column, hue) in enumerate(zip(panel.columns, panel.hues, strict=True)):
        x, y = begin, low[:, column]
        if stride > 1:  # up and down between the extremes of every stretch
            x, y = np.repeat(begin, 2), np.stack([y, high[:, column]], axis=1).ravel()
        # The commanded motion is a broad pale line below the limited one.
        asked = hue == ASKED and column < 3
        width = (3.0 if asked else 1.1) / (1.0 if stride == 1 else 2.0)
        axes.plot(
            x, y, color=hue, linewidth=width, alpha=0.4 if asked else 0.95,
            zorder=2 if asked else 3 + 0.01 * place, solid_joinstyle="round",
            linestyle=DASHES[hue in panel.dashed],
        )  # fmt: skip
    _draw_limits(axes, panel.limits, low[:, panel.columns], high[:, panel.columns])
    tidy(axes, "", panel.name)
    axes.yaxis.set_major_locator(MaxNLocator(5, min_n_ticks=3))
    axes.tick_params(labelbottom=False)


def draw_key(axes: Axes, rover: Rover) -> None:
    """Draw the legend of `draw_course`."""
    lines = [
        Line2D([], [], color=ASKED, linewidth=3.0, alpha=0.4, label="commanded"),
        Line2D([], [], color=DONE, linewidth=1.1, label="limited"),
        Line2D([], [], color=SOFT, linewidth=0.9, linestyle=(0, (5, 3)), label="limit"),
    ]
    count = len(rover.wheels)
    for k, name in enumerate(rover.wheel_names):
        color, dashes = WHEELS[k % len(WHEELS)], DASHES[k >= (count + 1) // 2]
        label = name.replace("_", " ")
        lines.append(Line2D([], [], color=color, linewidth=2.0, linestyle=dashes, label=label))
    axes.axis("off")
    draw_legend(axes, handles=lines, fontsize=8, loc="center", ncols=3)


def drive_figure(
    rover: Rover,
    course: Course,
    poses: ArrayLike,
    steering: ArrayLike,
    *,
    limits: Limits,
    shares: Mapping[str, float],
    title: str | None = None,
) -> Figure:
    """Picture of a drive through a controller: the path, and commands, joints and reasons over time.

    Parameters
    ----------
    rover, poses, steering
        As in `path_figure`.
    course : Course
        Commanded and limited twists, steering angles, their rates and wheel speeds over time.
    limits : Limits
        Dashed lines where the values come near them.
    shares : mapping of str to float
        Share of the time, 0 to 1, of every reason there was.
    title : str, optional
        Written above the picture.
    """
    heights = (0.5, 3.6, 7.0 + 0.17 * len(shares))  # [in]
    figure = page_figure(sum(heights) + 0.6)
    grid = figure.add_gridspec(3, 1, height_ratios=heights)
    draw_key(figure.add_subplot(grid[0]), rover)
    path = figure.add_subplot(grid[1])
    length = draw_path(path, rover, poses, steering)
    path.set_title(f"{length:.2f} m", loc="left", fontsize=LABEL, color=SOFT)
    draw_course(figure, grid[2], rover, course, limits, shares)
    write_heading(figure, title)
    return figure


def engine_figure(engine: Drive | ControlledDrive, *, title: str | None) -> Figure:
    """Picture of a drive at its end: its path, and what the controller did where one was driven through."""
    title = title or "drive"
    path = engine.trace.path()
    if not isinstance(engine, ControlledDrive):
        return path_figure(engine.rover, *path, title=title)
    shares = engine.summary.shares
    return drive_figure(engine.rover, engine.course, *path, limits=engine.limits, shares=shares, title=title)


def _draw_limits(axes: Axes, lines: Sequence[float], low: Floats, high: Floats) -> None:
    """Dashed lines; what is far from all values is only said."""
    bottom, top = min(float(low.min()), 0.0), max(float(high.max()), 0.0)
    reach = max(-bottom, top)
    finite = [line for line in lines if math.isfinite(line)]
    near = [line for line in finite if reach and abs(line) <= NEAR * reach]
    # Of the two sides only the one there is something on, unless both are close.
    near = [line for line in near if (top if line > 0 else -bottom) > SIDE * reach]
    for line in near:
        axes.axhline(line, color=SOFT, linewidth=0.9, linestyle=(0, (5, 3)), zorder=1.5)
    bottom, top = min([bottom, *near]), max([top, *near])
    room = 0.08 * (top - bottom or 1.0)
    axes.set_ylim(bottom - room, top + room)
    if finite and not near:
        words = f"limits {', '.join(f'{line:.3g}' for line in finite)}, outside the picture"
        corner = {"xycoords": "axes fraction", "ha": "right", "va": "bottom"}
        write(axes, words, (1, 1), (0, 1), 7.5, color=SOFT, **corner)


def _draw_reasons(
    axes: Axes,
    begin: Floats,
    bits: NDArray[np.uint32],
    reasons: Sequence[Reason],
    shares: Mapping[str, float],
) -> None:
    """One row per reason, coloured while it holds."""
    step = float(np.median(np.diff(begin))) if len(begin) > 1 else 1.0
    edges = np.append(begin, begin[-1] + step if len(begin) else 0.0)
    for place, each in enumerate(reasons):
        on = (bits & each.value) > 0
        turns = np.flatnonzero(np.diff(np.concatenate([[False], on, [False]]).astype(np.int8)))
        spans = [(edges[a], edges[b] - edges[a]) for a, b in turns.reshape(-1, 2)]
        axes.axhspan(place - 0.36, place + 0.36, color=FAINT, alpha=0.3, linewidth=0, zorder=0)
        axes.broken_barh(spans, (place - 0.36, 0.72), facecolors=_colour(each), linewidth=0, zorder=2)
        share = shares[str(each.name)]
        words = f"{100 * share:.1f} %" if share >= 0.001 else "< 0.1 %"
        beside = {"xycoords": axes.get_yaxis_transform(), "va": "center", "annotation_clip": False}
        write(axes, words, (1, place), (4, 0), 7.5, color=SOFT, **beside)
    axes.set_ylim(len(reasons) - 0.4 if reasons else 1.0, -0.6)
    axes.set_yticks(range(len(reasons)), [str(each.name) for each in reasons])
    for label in axes.get_yticklabels():
        label.set_fontsize(7)
    if not reasons:
        axes.annotate("no limit was met", (0.5, 0.5), xycoords="axes fraction", ha="center", va="center",
                      fontsize=8, color=SOFT)  # fmt: skip


def _colour(reason: Reason) -> str:
    if reason & STEERING:
        return AXLE
    if reason & ROLLING:
        return MOTION
    return SOFT if reason.value & STATES else BODILY
