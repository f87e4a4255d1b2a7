"""Stability of a settled pose: loads of the wheels, the support polygon and the line of tipping over."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from six_wheel._core import SettledPose
from six_wheel.kinematics.poses import Floats
from six_wheel.plotting.drawing import (
    AXLE,
    CENTRE,
    FORBIDDEN,
    INK,
    MOTION,
    TICK,
    TRACK,
    number,
    page,
    page_figure,
    tidy,
    with_title,
    write,
)
from six_wheel.plotting.pictures.bars import number_bars

TOUCHES = 1e-6  # [m] between a wheel and the ground it touches
HIGHEST = 1e3  # of a centre of mass above the contacts, in sizes of the support polygon


def stability_figure(found: Any, *, title: str | None, stand: SettledPose | None = None) -> Figure:
    """A `Stability`: loads and margins, of several poses the least; of one with its `stand` the polygon."""
    loads = np.asarray(found.loads, dtype=float)
    loads = loads.reshape(-1, loads.shape[-1]).min(axis=0)
    margins = {
        f"{name.replace('_', ' ')} [{unit}]": float(np.min(getattr(found, name)))
        for name, unit in (("tip_over_angle", "rad"), ("clearance", "m"), ("tilt", "rad"))
    }
    joints = np.asarray(found.joint_margins, dtype=float)
    joints = joints.reshape(-1, joints.shape[-1]).min(axis=0)
    margins |= {f"joint {k + 1} to its stop [rad]": float(margin) for k, margin in enumerate(joints)}
    if stand is None:
        figure = page_figure(1.6 + 0.36 * max(len(loads), len(margins)))
        left, right = figure.subplots(1, 2)
        _bars(left, {f"wheel {k + 1}": float(load) for k, load in enumerate(loads)}, "vertical load [N]")
        words = "negative ones in red\nstand= draws the support polygon"
        words = f"least over the poses; {words}" if np.ndim(found.tilt) else words
    else:
        if np.ndim(stand.z) or np.ndim(found.tilt) or len(stand.contacts) != len(loads):
            raise ValueError(f"stand must be the one pose that the stability is of, got {stand!r}")
        figure = page_figure(4.6)
        left, right = figure.subplots(1, 2, width_ratios=(1.5, 1.0))
        words = _draw_support(left, found, loads, stand)
    _bars(right, margins, "margin [rad, m]")
    return with_title(left, title, words)


def _bars(axes: Axes, values: dict[str, float], words: str) -> None:
    number_bars(axes, values, TICK, bad={name for name, value in values.items() if value < 0.0})
    axes.margins(x=0.3)
    tidy(axes, words, "")


def _draw_support(axes: Axes, found: Any, loads: Floats, stand: Any) -> str:
    """The polygon of the contacts from above, forward up, with their loads; what to say of it."""
    x, y, yaw = stand.poses
    turn = np.array(((np.cos(yaw), np.sin(yaw)), (-np.sin(yaw), np.cos(yaw))))
    contacts = np.asarray(stand.contacts, dtype=float)
    seen = page((contacts[:, :2] - (x, y)) @ turn.T)
    touching = np.flatnonzero(np.abs(stand.gap) < TOUCHES)
    hull = touching[_hull(seen[touching])]
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.3)
    largest = max(float(np.nanmax(np.abs(loads), initial=0.0)), 1e-9)
    for k, (place, load) in enumerate(zip(seen, loads, strict=True)):
        size = 6.0 + 16.0 * np.sqrt(abs(load) / largest) if np.isfinite(load) else 6.0
        colour = FORBIDDEN if load < 0.0 else AXLE if k in touching else "white"
        axes.plot(*place, "o", markersize=size, color=colour, markeredgecolor=INK, alpha=0.85, zorder=4)
        name = stand.suspension.wheel_names[k].replace("_", " ")
        told = f"{name}\n{number(load, '.3g')} N" if k in touching else f"{name}\nin the air"
        write(axes, told, tuple(place), (0, -14), 8, ha="center", va="top", zorder=9)
    tidy(axes, "to the right [m]", "forward [m]")
    total = float(np.nansum(loads[touching]))
    if len(hull) < 3 or not total > 0.0 or not np.isfinite(found.tip_over_angle):
        return "the contacts make no polygon of support"
    axes.add_patch(Polygon(seen[hull], facecolor=TRACK, edgecolor=INK, alpha=0.5, linewidth=1, zorder=1))
    weight = loads[touching] @ seen[touching] / total  # forces straight up balance it there
    axes.plot(*weight, "P", color=MOTION, markeredgecolor="white", markersize=11, zorder=8)
    first = _tipping_edge(seen[hull], contacts[hull, 2], weight, float(found.tip_over_angle))
    ends = np.stack((seen[hull[first]], seen[hull[(first + 1) % len(hull)]]))
    axes.plot(*ends.T, color=CENTRE, linewidth=3, zorder=3)
    return (
        "from above: polygon of support, loads (discs), weight (green cross)\n"
        f"red: the line it tips over first, at {number(found.tip_over_angle, '.3g')} rad"
    )


def _hull(points: Floats) -> list[int]:
    """Corners of the convex hull of points (n, 2), counter-clockwise: Andrew's monotone chain."""
    order = np.lexsort((points[:, 1], points[:, 0])).tolist()
    hull: list[int] = []
    for way in (order, order[::-1]):
        side: list[int] = []
        for k in way:
            while len(side) > 1 and _turn(points[side[-2]], points[side[-1]], points[k]) <= 0.0:
                side.pop()
            side.append(k)
        hull += side[:-1]
    return hull


def _turn(a: Floats, b: Floats, c: Floats) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _tipping_edge(corners: Floats, heights: Floats, weight: Floats, least: float) -> int:
    """The edge of the polygon about which the angle until the weight stands above it is the least.

    The loads tell where the weight is but for its height, which is found from that least angle: every angle
    falls as it grows.
    """
    first = np.column_stack((corners, heights))
    edges = np.roll(first, -1, axis=0) - first
    edges /= np.linalg.norm(edges, axis=1)[:, None]
    down = np.array((0.0, 0.0, -1.0)) + edges[:, 2:] * edges

    def angles(height: float) -> Floats:
        line = first - (*weight, height)
        line = line - (line * edges).sum(axis=1)[:, None] * edges
        across = (edges * np.cross(line, down)).sum(axis=1)
        found: Floats = np.arctan2(across, (line * down).sum(axis=1))
        return found

    low = float(heights.min())
    high = low + HIGHEST * float(np.ptp(corners, axis=0).max())
    for _ in range(80):
        middle = (low + high) / 2.0
        low, high = (middle, high) if angles(middle).min() > least else (low, middle)
    return int(np.argmin(angles(high)))
