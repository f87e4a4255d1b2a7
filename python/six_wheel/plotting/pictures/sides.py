"""Rovers from the side and from the front, on their ground."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from six_wheel._core import RockerBogie, SettledPose, Suspension
from six_wheel.kinematics.poses import Floats
from six_wheel.plotting.drawing import (
    AXLE,
    BODY,
    CENTRE,
    INK,
    LABEL,
    PAGE_WIDTH,
    SOFT,
    WHEEL,
    equal_scales,
    number,
    one_axes,
    page_figure,
    tidy,
    with_title,
    write,
)
from six_wheel.plotting.ground.side import along_heading, draw_ground_line, draw_side_view, on_level_ground
from six_wheel.plotting.pictures.strips import strips


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
        figure.axes[-1].set_xlabel("pose", fontsize=LABEL, color=SOFT)
        return figure
    axes = one_axes(4.6)
    if stand.stands:
        _draw(axes, stand)
        equal_scales(axes)
    tidy(axes, "along the heading [m]", "height [m]")
    roll, pitch, z = (number(value, ".3f") for value in (stand.roll, stand.pitch, stand.z))
    words = f"{stand.status}: roll {roll} rad, pitch {pitch} rad, z {z} m"
    return with_title(axes, title, words if stand.stands else f"{stand.status}: {stand.reason}")


def _draw(axes: Axes, stand: Any) -> None:
    """A rocker-bogie with its links, any other suspension by its wheels."""
    if isinstance(stand.suspension, RockerBogie):
        draw_side_view(axes, stand.suspension, stand)
        return
    centres = along_heading(stand, stand.wheel_centres)
    ahead, radii = centres[:, 0], np.linalg.norm(stand.contacts - stand.wheel_centres, axis=1)
    for k, ((place, up), radius) in enumerate(zip(centres, radii, strict=True)):
        alpha = 1.0 if k % 2 == 0 else 0.4
        axes.plot([0.0, place], [stand.transform[2, 3], up], color=AXLE, linewidth=2, alpha=alpha)
        axes.add_patch(Circle((place, up), radius, fc=BODY, ec=WHEEL, lw=2, alpha=alpha))
    reach = float(np.ptp(ahead)) / 2 + 2 * float(radii.max())
    along = np.linspace(ahead.mean() - reach, ahead.mean() + reach, 400)
    draw_ground_line(axes, stand, along, 0.0, depth=radii.max())


def suspension_figure(arm: Suspension, *, title: str | None) -> Figure:
    """A `Suspension`: on level ground, from the left with its vectors by name, and from behind."""
    stand = on_level_ground(arm)
    figure = page_figure(6.4)
    side, behind = figure.subplots(2, 1)
    _draw(side, stand)
    dimensions = getattr(arm, "dimensions", {})
    if isinstance(arm, RockerBogie):
        _name_vectors(side, stand, dimensions)
    equal_scales(side)
    tall = figure.get_figheight()
    centres, contacts = np.asarray(stand.wheel_centres), np.asarray(stand.contacts)
    radii = np.linalg.norm(contacts - centres, axis=1)
    for centre, radius in zip(centres, radii, strict=True):
        half = 0.45 * radius
        low, high = centre[2] - radius, centre[2] + radius
        box = np.array([(-half, low), (half, low), (half, high), (-half, high), (-half, low)])
        behind.fill(*(box - (centre[1], 0.0)).T, facecolor=BODY, edgecolor=WHEEL, linewidth=1.5, alpha=0.8)
    behind.axhline(0.0, color=INK, linewidth=1)
    behind.plot(0.0, stand.z, "+", color=CENTRE, markersize=12)
    write(behind, "origin of the body", (0.0, stand.z), (8, 6), 8, zorder=20)
    equal_scales(behind)
    figure.set_size_inches(PAGE_WIDTH, tall + figure.get_figheight())
    tidy(side, "forward [m]", "height [m]")
    tidy(behind, "to the right, seen from behind [m]", "height [m]")
    single = {
        name: value
        for name, value in dimensions.items()
        if np.ndim(value) == 0 and not isinstance(value, str | None)
    }
    words = "; ".join(f"{name} {number(value, '.3g')} m" for name, value in single.items())
    return with_title(side, title, words or repr(arm)[:100])


def _name_vectors(axes: Axes, stand: Any, dimensions: Mapping[str, Any]) -> None:
    """Names and numbers of the vectors of a rocker-bogie at the ends of its links, which lie in the body."""
    origin = np.asarray(stand.transform)[:3, 3]
    starts = {"rocker": origin + np.asarray(dimensions["rocker_pivot"])}
    starts["bogie"] = starts["rocker"] + np.asarray(dimensions["rocker_to_bogie"])
    named = {"rocker_pivot": starts["rocker"]}
    for name, vector in dimensions.items():
        start, between, _ = name.partition("_to_")
        if between and np.shape(vector) == (3,):
            named[name] = starts[start] + np.asarray(vector)
    heights = sorted(named, key=lambda name: named[name][0])
    top = max(point[2] for point in named.values()) + 0.9 * float(dimensions["wheel_radius"])
    for place, name in enumerate(heights):
        x, _, z = named[name]
        vector = ", ".join(number(part, ".3g") for part in np.asarray(dimensions[name]))
        at = (x, top + 0.6 * float(dimensions["wheel_radius"]) * (place % 3))
        axes.annotate(
            f"{name}\n{vector}", (x, z), at, fontsize=7.5, color=INK, ha="center", va="bottom", zorder=20,
            arrowprops={"arrowstyle": "-", "color": SOFT, "linewidth": 0.7},
        )  # fmt: skip
    axes.set_ylim(top=top + 1.9 * float(dimensions["wheel_radius"]))


# Quantities of a result by wheel or component, and their units.
QUANTITIES = {
    "steering": "rad", "wheel_speeds": "rad/s", "twist": "m/s, rad/s", "joint_rates": "rad/s",
    "contact_angles": "rad", "scrub": "m/s", "ratio": "1", "angle": "rad",
}  # fmt: skip
PARTS = {3: ("vx", "vy", "omega"), 6: ("vx", "vy", "vz", "wx", "wy", "wz")}


def ground_motion_figure(found: Any, *, title: str | None, stand: SettledPose | None = None) -> Figure:
    """A `GroundCommand` or `GroundMotion`: bars by quantity; with its `stand` from the side on its ground.

    At the wheels stand their speeds or, of a motion, how fast their contacts slide.
    """
    if stand is None:
        return motion_figure(found, title=title, below="stand= draws it on its ground")
    if np.ndim(stand.z) or not stand.stands:
        raise ValueError(f"stand must be one pose at which the rover stands, got {stand!r}")
    known = _quantities(found)
    if (speeds := known.pop("wheel_speeds", None)) is not None:
        words = [f"{number(speed, '.3g')} rad/s" for speed in speeds]
    else:
        sliding = np.linalg.norm(np.asarray(found.residuals, dtype=float), axis=-1)
        words = [f"slides {number(1000.0 * speed, '.2g')} mm/s" for speed in sliding]
    if len(words) != len(stand.suspension.wheel_names):
        raise ValueError(
            f"stand must be that of {len(words)} wheels, got {len(stand.suspension.wheel_names)} wheels"
        )
    figure = page_figure(3.6)
    grid = figure.add_gridspec(2, len(known))
    side = figure.add_subplot(grid[0, :])
    _draw(side, stand)
    centres = along_heading(stand, stand.wheel_centres).tolist()
    radius = float(np.linalg.norm(stand.contacts[0] - stand.wheel_centres[0]))
    top = side.get_ylim()[1] + 0.2 * radius
    row_height = 1.2 * radius
    for k, (name, told) in enumerate(zip(stand.suspension.wheel_names, words, strict=True)):
        side.annotate(
            f"{name.replace('_', ' ')}\n{told}", centres[k], (centres[k][0], top + row_height * (k % 2)),
            fontsize=8, color=INK, ha="center", va="bottom", zorder=20,
            arrowprops={"arrowstyle": "-", "color": SOFT, "linewidth": 0.6, "alpha": 1.0 - 0.6 * (k % 2)},
        )  # fmt: skip
    side.set_ylim(top=top + 2.2 * row_height)
    equal_scales(side)
    tall = figure.get_figheight()
    figure.set_size_inches(PAGE_WIDTH, tall + 1.7)
    grid.set_height_ratios([tall, 1.7])
    tidy(side, "along the heading [m]", "height [m]")
    _bars([figure.add_subplot(grid[1, k]) for k in range(len(known))], known)
    return with_title(
        side, title, f"{type(found).__name__}, from the left; lines to the right wheels are pale"
    )


def motion_figure(found: Any, *, title: str | None, below: str = "") -> Figure:
    """A `Traction`, `SteeringCommand`, `WheelSlip` or another motion: bars by quantity."""
    known = _quantities(found)
    figure = page_figure(0.7 + 1.7 * -(-len(known) // 2))
    panels = figure.subplots(-(-len(known) // 2), min(len(known), 2), squeeze=False).ravel()
    _bars(panels, known)
    for axes in panels[len(known) :]:
        axes.set_visible(False)
    rows = next((len(getattr(found, name)) for name in known if np.ndim(getattr(found, name)) > 1), 1)
    words = type(found).__name__ if rows == 1 else f"{type(found).__name__}: means of {rows} rows"
    return with_title(panels[0], title, f"{words}\n{below}")


def _quantities(found: Any) -> dict[str, Floats]:
    """The quantities of a result by name; of several rows their means."""
    known = {
        name: np.asarray(getattr(found, name), dtype=float)
        for name in QUANTITIES
        if getattr(found, name, None) is not None
    }
    return {
        name: values.reshape(-1, values.shape[-1]).mean(axis=0)
        for name, values in known.items()
        if values.ndim and values.size
    }


def _bars(panels: Iterable[Axes], known: Mapping[str, Floats]) -> None:
    """A panel for each quantity, a bar for each of its parts."""
    for axes, (name, values) in zip(panels, known.items(), strict=False):
        places = np.arange(len(values))
        axes.bar(places, values, color=AXLE, width=0.5)
        axes.axhline(0.0, color=SOFT, linewidth=0.8)
        parts = PARTS[len(values)] if name == "twist" else [f"{place + 1}" for place in places]
        axes.set_xticks(places, parts)
        axes.set_xlim(-0.8, len(values) - 0.2)
        below = "" if name == "twist" else "joint" if name == "joint_rates" else "wheel"
        below = f"steered {below}" if name == "steering" else below
        tidy(axes, below, f"{name.replace('_', ' ')} [{QUANTITIES[name]}]")
