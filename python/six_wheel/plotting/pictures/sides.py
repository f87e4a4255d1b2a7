"""Rovers from the side and from the front, on their ground."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from six_wheel._core import RockerBogie, Suspension, Terrain
from six_wheel.plotting.drawing import (
    AXLE,
    BODY,
    CENTRE,
    INK,
    SOFT,
    TRACK,
    WHEEL,
    Floats,
    new_figure,
    tidy,
    write_title,
)
from six_wheel.plotting.ground.side import draw_side_view
from six_wheel.plotting.pictures.strips import strips

__all__ = ["motion_figure", "stand_figure", "suspension_figure"]


def stand_figure(stand: Any, *, title: str | None) -> Figure:
    """A `SettledPose`: from the left on its ground; of several poses their attitudes."""
    if np.ndim(stand.z):
        rows = np.arange(np.size(stand.z))
        panels = {
            "z [m]": {"z": np.ravel(stand.z)},
            "angles [rad]": {"roll": np.ravel(stand.roll), "pitch": np.ravel(stand.pitch)},
            "gap of the highest wheel [m]": {
                "gap": np.nan_to_num(stand.gap).reshape(len(rows), -1).max(axis=1)
            },
        }
        figure = strips(rows, panels, title=title, below=repr(stand))
        figure.axes[-1].set_xlabel("pose", fontsize=8, color=SOFT)
        return figure
    figure = new_figure(7.2, 4.6)
    axes = figure.add_subplot()
    if stand.stands:
        _draw(axes, stand)
    tidy(axes, "along the heading [m]", "height [m]")
    words = f"{stand.status}: roll {stand.roll:.3f} rad, pitch {stand.pitch:.3f} rad, z {stand.z:.3f} m"
    write_title(axes, title, words if stand.stands else f"{stand.status}: {stand.reason}")
    return figure


def _draw(axes: Axes, stand: Any) -> None:
    """A rocker-bogie with its links, any other suspension by its wheels."""
    if isinstance(stand.suspension, RockerBogie):
        draw_side_view(axes, stand.suspension, stand)
        return
    x, y, yaw = stand.poses
    heading = np.array((np.cos(yaw), np.sin(yaw)))
    centres = np.asarray(stand.wheel_centres)
    ahead = (centres[:, :2] - (x, y)) @ heading
    radii = np.linalg.norm(stand.contacts - centres, axis=1)
    body = np.asarray(stand.transform)[:3, 3]
    for k, (place, up, radius) in enumerate(zip(ahead, centres[:, 2], radii, strict=True)):
        axes.plot([0.0, place], [body[2], up], color=AXLE, linewidth=2, alpha=1.0 if k % 2 == 0 else 0.4)
        axes.add_patch(Circle((place, up), radius, fc=BODY, ec=WHEEL, lw=2, alpha=1.0 if k % 2 == 0 else 0.4))
    reach = float(np.ptp(ahead)) / 2 + 2 * float(radii.max())
    along = np.linspace(ahead.mean() - reach, ahead.mean() + reach, 400)
    height: Floats = np.asarray(stand.ground.height_at(np.array((x, y)) + along[:, None] * heading))
    axes.fill_between(along, height, np.nanmin(height) - radii.max(), color=TRACK, zorder=0)
    axes.plot(along, height, color=INK, linewidth=1)
    axes.set_aspect("equal")


def suspension_figure(arm: Suspension, *, title: str | None) -> Figure:
    """A `Suspension`: on level ground, from the left and from the front, with its dimensions."""
    level = Terrain(np.zeros((2, 2)), 1000.0, (-500.0, -500.0))
    stand = arm.settle(level, (0.0, 0.0, 0.0))
    figure = new_figure(7.2, 6.4)
    side, front = figure.subplots(2, 1)
    _draw(side, stand)
    centres, contacts = np.asarray(stand.wheel_centres), np.asarray(stand.contacts)
    radii = np.linalg.norm(contacts - centres, axis=1)
    for centre, radius in zip(centres, radii, strict=True):
        half = 0.45 * radius
        low, high = centre[2] - radius, centre[2] + radius
        box = np.array([(-half, low), (half, low), (half, high), (-half, high), (-half, low)])
        front.fill(*(box - (centre[1], 0.0)).T, facecolor=BODY, edgecolor=WHEEL, linewidth=1.5, alpha=0.8)
    front.axhline(0.0, color=INK, linewidth=1)
    front.plot(0.0, stand.z, "+", color=CENTRE, markersize=12)
    front.set_aspect("equal", adjustable="datalim")
    tidy(side, "forward [m]", "height [m]")
    tidy(front, "to the right [m], seen from behind", "height [m]")
    dimensions = getattr(arm, "dimensions", {})
    words = "; ".join(
        f"{name} {np.round(value, 3).tolist()}"
        for name, value in dimensions.items()
        if not isinstance(value, str | type(None))
    )
    write_title(
        side,
        title,
        "\n".join(words[k : k + 88] for k in range(0, min(len(words), 352), 88)) or repr(arm)[:100],
    )
    return figure


def motion_figure(found: Any, *, title: str | None) -> Figure:
    """A `GroundCommand`, `GroundMotion`, `Traction`, `SteeringCommand` or `WheelSlip`: its numbers."""
    names = (
        "steering",
        "wheel_speeds",
        "twist",
        "joint_rates",
        "contact_angles",
        "scrub",
        "ratio",
        "angle",
    )
    known = {
        name: np.asarray(getattr(found, name), dtype=float)
        for name in names
        if getattr(found, name, None) is not None
    }
    known = {
        name: values.reshape(-1, values.shape[-1]).mean(axis=0)
        for name, values in known.items()
        if values.ndim and values.size
    }
    figure = new_figure(7.2, 0.9 + 1.5 * len(known))
    rows = figure.subplots(len(known), 1, squeeze=False)[:, 0]
    for axes, (name, values) in zip(rows, known.items(), strict=True):
        axes.bar(np.arange(1, len(values) + 1), values, color=AXLE, width=0.6)
        axes.axhline(0.0, color=SOFT, linewidth=0.8)
        axes.set_xticks(np.arange(1, len(values) + 1))
        tidy(axes, "", name.replace("_", " "))
    write_title(
        rows[0], title, f"{type(found).__name__}: numbers by wheel, joint or component, in their order [SI]"
    )
    return figure
