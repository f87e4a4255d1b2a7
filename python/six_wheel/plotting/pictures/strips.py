"""Strips of values over time, a quantity each."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.poses import Floats
from six_wheel.plotting.drawing import (
    FORBIDDEN,
    LABEL,
    SERIES,
    SOFT,
    draw_legend,
    number,
    page_figure,
    tidy,
    with_title,
)

HEIGHT = 1.5  # [in] of a strip
INSTANTS = 400  # of a profile that is drawn
ROUNDING = 1e-9


def strips(
    times: ArrayLike, panels: Mapping[str, Mapping[str, Floats]], *, title: str | None, below: str
) -> Figure:
    """A figure with a strip for each quantity, under which name its lines stand with theirs."""
    figure = page_figure(0.9 + HEIGHT * len(panels))
    rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (quantity, lines) in zip(rows, panels.items(), strict=True):
        _strip(axes, times, lines)
        tidy(axes, "time [s]" if axes is rows[-1] else "", quantity)
    return with_title(rows[0], title, below)


def _strip(axes: Axes, times: ArrayLike, lines: Mapping[str, Floats]) -> None:
    for place, (name, values) in enumerate(lines.items()):
        style = ("-", "--", ":")[place // len(SERIES) % 3]
        axes.plot(
            times, values, color=SERIES[place % len(SERIES)], linestyle=style, linewidth=1.3, label=name
        )
    low, high = axes.get_ylim()
    if high - low < ROUNDING:  # nothing but rounding, which is no curve
        axes.set_ylim(low - 0.05, high + 0.05)
    if len(lines) > 1:
        draw_legend(axes, loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=1.5)


def _named(names: Sequence[str], values: Floats) -> dict[str, Floats]:
    return dict(zip(names, np.atleast_2d(values.T), strict=True))


def run_strips(run: Any, *, title: str | None) -> Figure:
    """A `ControllerRun`: its motion, its joints, and the reasons of its steps."""
    rover, times = run.rover, run.stamps - run.stamps[:1]
    panels = {
        "vx, vy [m/s]": _named(("vx", "vy"), run.twist[:, :2]),
        "omega [rad/s]": {"omega": run.twist[:, 2]},
    }
    if rover.steered_wheel_names:
        panels["steering [rad]"] = _named(rover.steered_wheel_names, run.steering)
    panels["wheels [rad/s]"] = _named(rover.wheel_names, run.wheel_speeds)
    start = f" from stamp {number(run.stamps[0])} s" if len(run) else ""
    figure = strips(times, panels, title=title, below=f"{len(run)} steps of a controller{start}")
    axes = figure.axes[0]
    found = [reason for reason in Reason if np.any(run.reasons & reason.value)]
    for place, reason in enumerate(found):
        held = (run.reasons & reason.value) != 0
        low = 1.02 + 0.06 * place
        axes.fill_between(
            times, low, low + 0.05, where=held, color=SERIES[place % len(SERIES)], linewidth=0,
            transform=axes.get_xaxis_transform(), clip_on=False, label=str(reason.name),
        )  # fmt: skip
    if found:
        axes.set_title(
            axes.get_title(loc="left"), loc="left", fontsize=LABEL, color=SOFT, y=1.04 + 0.06 * len(found)
        )
        draw_legend(figure, handles=axes.collections, loc="outside lower left", ncols=3)
    return figure


def log_strips(log: Any, *, title: str | None) -> Figure:
    """A `WheelLog` without a truth: its angles."""
    times = log.stamps - log.stamps[0]
    wheels = [f"wheel {k + 1}" for k in range(log.wheel_angles.shape[1])]
    panels = {"wheels turned [rad]": _named(wheels, log.wheel_angles)}
    if log.steering is not None and np.shape(log.steering)[1]:
        steered = [f"steered {k + 1}" for k in range(np.shape(log.steering)[1])]
        panels["steering [rad]"] = _named(steered, np.asarray(log.steering))
    if log.yaw_rate is not None:
        panels["yaw rate [rad/s]"] = {"gyroscope": log.yaw_rate}
    return strips(times, panels, title=title, below=repr(log))


def profile_strips(profile: Any, *, title: str | None) -> Figure:
    """A `Profile`: value and derivatives."""
    times = np.linspace(0.0, profile.duration, INSTANTS)
    state = profile.at(times)
    panels = {}
    units = {"value": " [1]", "velocity": " [1/s]", "acceleration": " [1/s²]", "jerk": " [1/s³]"}
    for name, unit in units.items():
        values = np.asarray(getattr(state, name)).reshape(len(times), -1)
        panels[name + unit] = _named([f"axis {k + 1}" for k in range(values.shape[1])], values)
    return strips(times, panels, title=title, below=f"profile of {profile.duration:.3g} s")


def transition_strips(transition: Any, *, title: str | None) -> Figure:
    """A transition of a rover: its motion, its joints, and how fast the worst wheel slides."""
    times, rover = np.linspace(0.0, transition.duration, INSTANTS), transition.rover
    state = transition.at(times)
    panels = {"twist [m/s, rad/s]": _named(("vx", "vy", "omega"), np.asarray(state.twist))}
    if rover.steered_wheel_names:
        panels["steering [rad]"] = _named(rover.steered_wheel_names, np.asarray(state.steering))
    panels["wheels [rad/s]"] = _named(rover.wheel_names, np.asarray(state.wheel_speeds))
    panels["scrub [m/s]"] = {"worst wheel": np.asarray(state.scrub)}
    words = f"{type(transition).__name__} of {transition.duration:.3g} s"
    return strips(times, panels, title=title, below=words)


def slip_strips(report: Any, *, title: str | None) -> Figure:
    """A `SlipReport`: a row for every wheel, with what it slid, and its windows over time."""
    names = [wheel.name for wheel in report.wheels]
    figure = page_figure(1.5 + 0.32 * len(names))
    bars, windows = figure.subplots(1, 2, sharey=True)
    places = np.arange(len(names))
    rms, worst = (1000.0 * np.array([getattr(w, part) for w in report.wheels]) for part in ("rms", "worst"))
    bars.barh(places, rms, color=SERIES[0], height=0.5, label="rms")
    bars.plot(worst, places, "|", color=FORBIDDEN, markersize=12, markeredgewidth=2, label="worst")
    bars.set_yticks(places, names)
    bars.invert_yaxis()
    bars.set_xlim(0.0, max(1.1 * worst.max(initial=0.0), 1.0))
    for window in report.windows:
        place = names.index(window.wheel)
        windows.barh(place, window.end - window.start, left=window.start, color=FORBIDDEN, height=0.5)
    if not report.windows:
        words = (
            "no wheel contradicts another" if report.observable else "the wheels cannot contradict each other"
        )
        windows.text(0.5, 0.5, words, transform=windows.transAxes, color=SOFT, ha="center", fontsize=LABEL)
        windows.set_xticks([])
    tidy(bars, "residual [mm/s]", "")
    tidy(windows, "windows of slip, stamps [s]", "")
    draw_legend(figure, *bars.get_legend_handles_labels(), loc="outside lower left", ncols=2)
    return with_title(bars, title, f"slip over {report.rows} rows")
