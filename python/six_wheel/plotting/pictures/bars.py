"""Bars: derivatives of a twist, margins and intervals of a pose."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from collections.abc import Collection, Mapping
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
    SERIES,
    SOFT,
    TICK,
    draw_legend,
    number,
    one_axes,
    page_figure,
    tidy,
    with_title,
    write,
)
from six_wheel.plotting.four_axle import NAMES

TWIST, COMPONENTS = ("vx", "vy", "omega"), ("vx", "vy", "vz", "wx", "wy", "wz")
# Units of the quantities by which a twist is differentiated.
QUANTITIES = {
    "wheel_speeds": "rad/s", "steering": "rad", "steering_rates": "rad/s", "slip": "m/s", "side_slip": "m/s",
    "x": "m", "y": "m", "heading": "rad", "radius": "m", "scrub": "m", "trail": "m", "roller_angle": "rad",
}  # fmt: skip


def jacobian_bars(found: Any, *, title: str | None) -> Figure:
    """A `TwistJacobian`: derivatives of the twist by quantity and wheel; of a batch their mean size."""
    known = [
        name for name in QUANTITIES if getattr(found, name) is not None and np.size(getattr(found, name))
    ]
    columns = 2
    rows = -(-len(known) // columns)
    figure = page_figure(0.8 + 1.5 * rows)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, name in zip(panels, known, strict=False):
        table = np.asarray(getattr(found, name), dtype=float)
        table = table if table.ndim == 2 else np.abs(table.reshape(-1, *table.shape[-2:])).mean(axis=0)
        places = np.arange(table.shape[1])
        for k, (part, row) in enumerate(zip(TWIST, table, strict=True)):
            axes.bar(places + 0.27 * (k - 1), row, 0.25, color=SERIES[k], label=part)
        axes.set_xticks(places, [str(place + 1) for place in places])
        tidy(axes, f"{name.replace('_', ' ')} of wheel", f"twist [per {QUANTITIES[name]}]")
    for axes in panels[len(known) :]:
        axes.set_visible(False)
    drawn = panels[0].get_legend_handles_labels()
    draw_legend(figure, *drawn, loc="outside lower left", ncols=3, fontsize=9, labelcolor=None)
    words = "derivatives of the twist [m/s, m/s, rad/s] by the quantities of each wheel"
    figure.suptitle(title or words, x=0.01, ha="left", fontsize=10, color=INK)
    return figure


def number_bars(
    axes: Axes, values: Mapping[str, float], size: float, *, bad: Collection[str] = (), **look: Any
) -> None:
    """A row for each name with its number at the bar; those that are bad in another colour."""
    for place, (name, value) in enumerate(values.items()):
        shown = value if np.isfinite(value) else 0.0
        style: dict[str, Any] = {"color": AXLE, "height": 0.55} | look
        axes.barh(place, shown, **style | ({"color": FORBIDDEN} if name in bad else {"hatch": ""}))
        words = number(value, ".3g") if np.isfinite(value) else str(value)
        axes.annotate(f" {words}", (max(shown, 0.0), place), va="center", fontsize=size, color=INK)
    axes.set_yticks(range(len(values)), list(values))
    axes.invert_yaxis()


def named_bars(
    values: Mapping[str, float],
    *,
    title: str | None,
    below: str,
    unit: str,
    bad: frozenset[str] = frozenset(),
) -> Figure:
    """A row for each name with its number at the bar; those that are bad in another colour, hatched."""
    axes = one_axes(1.2 + 0.36 * len(values))
    number_bars(axes, values, LABEL, bad=bad, hatch="///", color=MOTION, edgecolor="white")
    axes.axvline(0.0, color=SOFT, linewidth=0.8)
    axes.margins(x=0.15)
    if not any(values.values()):
        axes.set_xlim(-1.0, 1.0)
    tidy(axes, unit, "")
    axes.tick_params(axis="y", labelsize=LABEL, labelcolor=INK)
    return with_title(axes, title, below)


def axle_bars(state: Any, *, title: str | None) -> Figure:
    """A `FourAxleState`: the angles of its axles, the brakes in words."""
    angles = dict(zip(NAMES, state.steering, strict=True))
    words = f"front {state.front_brake}, rear {state.rear_brake}"
    return named_bars(angles, title=title, below=words, unit="axle angle [rad]")


def sequence_bars(sequence: Any, *, title: str | None) -> Figure:
    """A `TurnSequence` or `FourAxleStep`: the durations of its steps."""
    steps = getattr(sequence, "steps", (sequence,))
    bars = {f"{k + 1}. {step.action}": step.duration for k, step in enumerate(steps)}
    words = getattr(sequence, "reason", "") or "steps and their durations"
    return named_bars(bars, title=title, below=words, unit="duration [s]")


def bounds_bars(found: Any, *, title: str | None) -> Figure:
    """`PoseBounds`: the interval of every quantity; of several poses their hull."""
    lengths = ("z", "clearance", "wheel_drop")
    names = ("z", "roll", "pitch", "tilt", "clearance", "rocker", "wheel_drop")
    axes = one_axes(3.6)
    for place, name in enumerate(names):
        ends = np.asarray(getattr(found, name), dtype=float).reshape(-1, 2)
        low, high = np.nanmin(ends[:, 0], initial=np.inf), np.nanmax(ends[:, 1], initial=-np.inf)
        if not low <= high:
            continue
        axes.plot([low, high], [place, place], color=AXLE, linewidth=7, solid_capstyle="butt")
        words = f"{number(low, '.3g')} to {number(high, '.3g')} {'m' if name in lengths else 'rad'}"
        write(axes, words, (high, place), (6, 0), 9, va="center")
    axes.set_yticks(range(len(names)), [name.replace("_", " ") for name in names])
    axes.invert_yaxis()
    axes.axvline(0.0, color=SOFT, linewidth=0.8)
    axes.margins(x=0.3)
    tidy(axes, "interval [m or rad]", "")
    status = np.unique(np.asarray(found.status).astype(str))
    return with_title(axes, title, f"bounds of a pose: {', '.join(status)}")


def feasible_bars(found: Any, *, title: str | None) -> Figure:
    """A `Feasibility`: margins of a pose and the reason; of several poses how many have each reason."""
    if np.ndim(found.ok):
        reasons, counts = np.unique(np.asarray(found.reason).astype(str), return_counts=True)
        values = {str(reason): float(count) for reason, count in zip(reasons, counts, strict=True)}
        return named_bars(
            values, title=title, below="poses by reason", unit="poses [1]", bad=frozenset(values) - {"ok"}
        )
    values = {
        "least margin [rad or m]": float(found.margin),
        "tilt [rad]": float(found.tilt),
        "clearance [m]": float(found.clearance),
    }
    words = "the rover may stand here" if found.ok else f"the rover may not stand here: {found.reason}"
    bad = frozenset() if found.ok else frozenset(list(values)[:1])
    return named_bars(values, title=title, below=words, unit="[rad or m]", bad=bad)


def slip_bars(found: Any, *, title: str | None) -> Figure:
    """A `BodySlip`: the slip by component, and its statistic beside the threshold."""
    slip = np.atleast_1d(found.slip)
    names = TWIST if len(slip) == 3 else COMPONENTS[: len(slip)]
    figure = page_figure(1.5 + 0.3 * max(len(slip), 2))
    parts, test = figure.subplots(1, 2)
    tests = {"statistic": found.statistic, "threshold": found.threshold}
    for axes, values, words in (
        (parts, dict(zip(names, slip.tolist(), strict=True)), "slip [m/s, rad/s]"),
        (test, tests, "chi squared [1]"),
    ):
        number_bars(axes, values, TICK, bad={"statistic"} if found.slipping else (), height=0.5)
        axes.axvline(0.0, color=SOFT, linewidth=0.8)
        axes.margins(x=0.25)
        tidy(axes, words, "")
    words = "the rover slips" if found.slipping else "no more than noise"
    return with_title(parts, title, f"{words}, probability {found.probability:.2g}")
