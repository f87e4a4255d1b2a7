"""A record in Foxglove's layout: its panels where it puts them, each with the values its paths name.

Foxglove itself draws in a browser; this reads the layout as it does: a path that leads nowhere is an error.
"""

import re
import tempfile
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from six_wheel import Limits, Rover
from six_wheel.logs.mcap import Record
from six_wheel.logs.mcap import rover_record as topics
from six_wheel.logs.mcap.layouts import foxglove
from six_wheel.simulation.drive import DriveLoop, drive

NOTHING = 1e-9  # [m/s] slip that is rounding
MARGIN = (0.035, 0.012, 0.03, 0.035)  # left, right, bottom, top of a panel, in figures


def foxglove_figure() -> Figure:
    """A drive of Perseverance that its limits bind, in the layout."""
    rover = Rover.preset("perseverance")
    with tempfile.TemporaryDirectory() as name:
        table, path = Path(name) / "commands.csv", Path(name) / "run.mcap"
        times = np.arange(0.0, 40.0, 0.1)
        turning = 0.35 * np.sin(0.35 * times) * (times < 34.0)
        rows = np.column_stack([times, 0.5 * (times < 34.0), turning])
        np.savetxt(table, rows, delimiter=",", header="time,vx,omega", comments="")
        limits = Limits(speed=0.4, acceleration=0.2, steering_rate=0.3, wheel_speed=1.6)
        drive(rover, table, path, loop=DriveLoop(limits))
        record = Record(path)
        seen: dict[str, list[tuple[float, Any]]] = {}
        for message in record.messages():
            seen.setdefault(message.topic, []).append((message.time / 1e9, record.parsed(message)))
    layout, figure = foxglove(rover), Figure(figsize=(14.0, 9.0))
    for panel, (x, y, width, height) in places(layout["layout"]).items():
        left, right, bottom, top = MARGIN
        axes = figure.add_axes((x + left, y + bottom, width - left - right, height - bottom - top))
        draw(axes, panel, layout["configById"][panel], seen)
    return figure


def places(split: Any, x: float = 0.0, y: float = 0.0, w: float = 1.0, h: float = 1.0) -> dict[str, Any]:
    """Panel to its left, bottom, width and height."""
    if isinstance(split, str):
        return {split: (x, y, w, h)}
    share = split["splitPercentage"] / 100.0
    if split["direction"] == "row":
        second = places(split["second"], x + share * w, y, (1.0 - share) * w, h)
        return places(split["first"], x, y, share * w, h) | second
    second = places(split["second"], x, y, w, (1.0 - share) * h)
    return places(split["first"], x, y + (1.0 - share) * h, w, share * h) | second


def draw(axes: Axes, panel: str, config: dict[str, Any], seen: dict[str, list[tuple[float, Any]]]) -> None:
    """One panel."""
    kind, _, name = panel.partition("!")
    axes.set_title(config.get("foxglovePanelTitle", f"{kind}: {name}"), loc="left", fontsize=9)
    axes.tick_params(labelsize=7)
    for path in config.get("paths", []):
        topic, fields = re.match(r"(/\w+)\.(.*)", path["value"]).groups()
        times = [time for time, _ in seen[topic]]
        values = [value_of(message, fields) for _, message in seen[topic]]
        if kind == "Plot":
            axes.plot(times, values, color=path["color"], lw=1.0, label=path["label"])
        else:
            ends = [*times[1:], max(time for time, _ in seen[topics.ODOMETRY])]
            colours = {value: f"C{k}" for k, value in enumerate(dict.fromkeys(values))}
            for begin, end, value in zip(times, ends, values, strict=True):
                axes.axvspan(begin, end, color=colours[value], alpha=0.6)
                if end - begin > 0.1 * ends[-1]:
                    text = value.replace("|", "\n") or "free"
                    axes.text((begin + end) / 2.0, 0.5, text, fontsize=6, ha="center", va="center")
            axes.set_yticks([])
    if kind == "Plot" and max(map(abs, axes.get_ylim())) < NOTHING:
        axes.set_ylim(-0.01, 0.01)
    handles, labels = axes.get_legend_handles_labels()
    named = dict(zip(labels, handles, strict=True))
    if named:
        axes.legend(
            named.values(), named.keys(), fontsize=5, loc="lower right", bbox_to_anchor=(1.0, 1.0),
            ncols=len(named), frameon=False, columnspacing=0.8, handlelength=1.0, borderaxespad=0.2,
        )  # fmt: skip
    if kind == "3D":
        poses = [message.pose.pose.position for _, message in seen[topics.ODOMETRY]]
        axes.plot([at.x for at in poses], [at.y for at in poses])
        axes.set_aspect("equal", adjustable="datalim")
    elif kind == "DiagnosticSummary":
        axes.set_axis_off()
        axes.text(0.0, 0.9, "none in a drive: a node reports every second", fontsize=8, va="top")


def value_of(message: Any, fields: str) -> Any:
    """Value at a path such as ``twist.linear.x`` or ``data[3]``."""
    parts = re.findall(r"\w+", fields)
    return reduce(lambda at, part: at[int(part)] if part.isdigit() else getattr(at, part), parts, message)
