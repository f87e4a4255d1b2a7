"""Picture of one twist from above: ranges, forbidden turns, turning circles, axles, velocity and words.

Everything is drawn on the page, forward up: the body's (x, y) stands at (-y, x).
"""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Patch, Wedge
from matplotlib.path import Path as Outline
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike

from six_wheel._core import Rover, exp
from six_wheel.kinematics.poses import Floats
from six_wheel.plotting.drawing import (
    AXLE,
    CENTRE,
    FORBIDDEN,
    FORWARD_UP,
    INK,
    MOTION,
    SOFT,
    body_box,
    bounds,
    contacts,
    draw_legend,
    draw_rover,
    figure_of,
    headings,
    in_world,
    number,
    one_axes,
    page,
    tidy,
    with_title,
)

NAMES, UNITS = ("vx", "vy", "omega"), ("m/s", "m/s", "rad/s")
ICR_REACH = 3.5  # rover sizes: a centre of rotation farther away than this is pointed at, not shown
AXES_WIDTH = 7.2  # [in] of the drawing, about
LETTER, LINE = 0.068, 0.165  # [in] of words in these pictures, about
CLEAR = 0.08  # [in] from words to the middle of a line that does not touch them
WAYS = np.array([(math.cos(way), math.sin(way)) for way in np.radians(np.arange(0.0, 360.0, 15.0))])
HALO = [withStroke(linewidth=3, foreground="white")]  # keeps words readable on lines
WORDS: dict[str, Any] = {"fontsize": 8, "linespacing": 1.4, "path_effects": HALO, "zorder": 8}


def view(
    low: Floats, high: Floats, size: float, icr: Floats, shown: bool
) -> tuple[float, float, float, float]:
    """Left, right, bottom and top of a page that holds the rover and, if it is near, the ICR."""
    low, high = low - 0.75 * size, high + 0.75 * size
    if shown:
        low, high = np.minimum(low, icr - 0.45 * size), np.maximum(high, icr + 0.45 * size)
    elif np.all(np.isfinite(icr)):  # room to see the axles lean towards it
        low, high = np.minimum(low, np.sign(icr) * 2.2 * size), np.maximum(high, np.sign(icr) * 2.2 * size)
    width, height = high - low
    spare = np.maximum((height / 0.95 - width, 0.55 * width - height), 0.0) / 2
    (left, bottom), (right, top) = low - spare, high + spare
    return float(left), float(right), float(bottom), float(top)


def draw_steering_ranges(axes: Axes, rover: Rover) -> None:
    for wheel in rover.wheels:
        if wheel.steering_range is not None:
            ends = np.clip(wheel.steering_range, -np.pi, np.pi)  # an endless joint has the whole circle
            lower, upper = np.degrees(ends + wheel.heading + FORWARD_UP)
            look: dict[str, Any] = {"color": AXLE, "alpha": 0.13, "linewidth": 0, "zorder": 1}
            axes.add_patch(Wedge((-wheel.y, wheel.x), 1.6 * wheel.radius, lower, upper, **look))


def icr_levels(rover: Rover) -> list[float]:
    """Position ahead [m] of the line on which the centre of rotation lies, if the fixed wheels define one."""
    fixed = [w for w in rover.wheels if not (w.steered or w.castor) and w.roller_angle is None]
    if not fixed or any(abs(math.sin(wheel.heading)) > 1e-9 for wheel in fixed):
        return []
    return [float(np.mean([wheel.x - wheel.trail * math.cos(wheel.heading) for wheel in fixed]))]


def draw_icr_line(axes: Axes, rover: Rover, height: float) -> None:
    """The line of the unsteered wheels, with the turns that the steering limits forbid."""
    axes.axhline(height, color=SOFT, linewidth=0.8, linestyle=(0, (6, 4)), zorder=1.1)
    island, smallest = rover.spin_radius, rover.min_radius
    if not island < smallest:
        return
    reach = smallest if math.isfinite(smallest) else max(map(abs, axes.get_xlim()))
    for side in (-1.0, 1.0):  # over the rover, or its body would hide the middle
        axes.plot(
            [side * island, side * reach], [height, height],
            color=FORBIDDEN, linewidth=6, alpha=0.25, solid_capstyle="butt", zorder=4,
        )  # fmt: skip
        if math.isfinite(smallest):
            axes.plot([side * smallest], [height], "|", color=FORBIDDEN, markersize=11, zorder=4)
        if island > 0.0:
            axes.plot([side * island], [height], "|", color=FORBIDDEN, markersize=11, zorder=4)
    inner = f"{island:.3g} m < " if island > 0.0 else ""
    outer = f" < {smallest:.3g} m" if math.isfinite(smallest) else ""
    words = f"purple: turns past the steering limits, {inner}radius{outer}"
    _corner(axes, words, right=True, color=FORBIDDEN)


def draw_turning_circles(
    axes: Axes, wheels: Floats, twist: Floats, icr: Floats, size: float, shown: bool
) -> list[Floats]:
    """Draw the next motion of every wheel, now at `wheels` in the body, fading out, and its circle.

    Returns points of the lines, for words to keep off.
    """
    lines = []
    vx, vy, omega = twist
    fastest = float(np.max(np.hypot(vx - omega * wheels[:, 1], vy + omega * wheels[:, 0])))
    ahead = min(1.5 * size / fastest, math.pi / abs(omega) if omega else math.inf)
    ways = page(in_world(exp(twist * ahead * np.linspace(0.0, 1.0, 61)[:, None]), wheels))
    shades = [(*to_rgb(MOTION), 0.75 * (1 - step / 60)) for step in range(60)]
    for way in np.moveaxis(ways, 1, 0):
        pieces = list(np.stack((way[:-1], way[1:]), axis=1))
        axes.add_collection(LineCollection(pieces, colors=shades, linewidths=2.0, zorder=2), autolim=False)
        lines.append(way)
        if shown:
            middle, radius = (float(icr[0]), float(icr[1])), float(np.hypot(*(way[0] - icr)))
            axes.add_patch(
                Circle(middle, radius, fill=False, color=MOTION, linewidth=0.7, alpha=0.3, zorder=1.5)
            )
            round_ = np.linspace(0.0, 2.0 * math.pi, 361)
            lines.append(icr + radius * np.stack((np.cos(round_), np.sin(round_)), axis=-1))
    return lines


def draw_axles(axes: Axes, rover: Rover, steering: Floats, icr: Floats, size: float) -> list[Floats]:
    """A line along every axle as its wheel is really steered: that they meet is for the eye to check.

    Wheels with rollers and castors have no say in where that is. Returns points of the lines.
    """
    lines = []
    points, angles = page(contacts(rover, steering)), headings(rover, steering)
    for wheel, point, angle in zip(rover.wheels, points, angles, strict=True):
        if wheel.castor or wheel.roller_angle is not None:
            continue
        axle = np.array((-math.cos(angle), -math.sin(angle)))  # left of the wheel, on the page
        stub = 1.3 * wheel.radius
        if np.all(np.isfinite(icr)):
            towards = float((icr - point) @ axle)
            ends = (min(towards, -stub), max(towards, stub))
        else:
            ends = (-2 * size, 2 * size)
        (x0, y0), (x1, y1) = point + ends[0] * axle, point + ends[1] * axle
        axes.plot([x0, x1], [y0, y1], color=AXLE, linewidth=1.0, zorder=3.25, scalex=False, scaley=False)
        lines.append(np.linspace((x0, y0), (x1, y1), 200))
    return lines


def draw_velocity(axes: Axes, twist: Floats, size: float) -> list[Floats]:
    """A straight arrow for the velocity, a bent one for the yaw rate of the body; returns points of both."""
    vx, vy, omega = (float(value) for value in twist)
    speed = math.hypot(vx, vy)
    ways = []
    if speed > 0.0:
        ways.append(np.linspace((0.0, 0.0), (-vy, vx), 100) * (0.62 * size / speed))
    if omega != 0.0:
        sweep = math.copysign(1.0, omega) * np.linspace(-0.3, 1.1, 100) + FORWARD_UP + math.pi * (speed > 0.0)
        ways.append(0.22 * size * np.stack((np.cos(sweep), np.sin(sweep)), axis=-1))
    for way in ways:
        arrow = FancyArrowPatch(
            path=Outline(way), arrowstyle="-|>", mutation_scale=14, color=MOTION, linewidth=2.2, zorder=5
        )
        axes.add_patch(arrow)
    axes.plot(0, 0, "o", color="white", markeredgecolor=MOTION, markeredgewidth=1.5, markersize=5, zorder=6)
    return ways


def draw_labels(axes: Axes, rover: Rover, steering: Floats, speeds: Floats, lines: list[Floats]) -> None:
    """Name, angle and rate of every wheel, beside it where they cover least of `lines` and of each other."""
    points, angles = page(contacts(rover, steering)), iter(np.degrees(steering).tolist())
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    inch = (right - left) / AXES_WIDTH
    corners = np.array(((left, bottom), (right, top)))
    centre, radius = (points.min(axis=0) + points.max(axis=0)) / 2, max(one.radius for one in rover.wheels)
    middle, (along, across) = body_box(rover)
    body, body_half = page(middle), np.array((across, along))
    crossed, taken = np.concatenate(lines) if lines else np.empty((0, 2)), list[Floats]()
    for wheel, point, speed in zip(rover.wheels, points, speeds.tolist(), strict=True):
        reading = f"{number(speed, '.2f')} rad/s"
        if wheel.steered:
            reading = f"{number(next(angles), '.1f')}°  {reading}"
        half = inch * np.array((0.5 * LETTER * max(len(wheel.name), len(reading)), 0.5 * 2 * LINE))

        def cost(place: Floats, half: Floats = half, point: Floats = point) -> float:
            crossings = int((np.abs(crossed - place) < half + CLEAR * inch).all(axis=1).sum())
            others = sum(bool((np.abs(other[0] - place) < half + other[1]).all()) for other in taken)
            others += bool((np.abs(body - place) < half + body_half).all())
            wheels = np.abs(points - place) - half < 0.9 * radius
            beyond = bool((place - half < corners[0]).any() or (place + half > corners[1]).any())
            away = place - point
            outward = float(away @ (point - centre)) / float(np.hypot(*(point - centre)) or 1.0)
            covered = 300 * (others + beyond) + 150 * wheels.all(axis=1).sum()
            covered += crossings + 30 * (crossings > 0)
            return float(covered) + 4.0 * (2.0 * float(np.hypot(*away)) - outward) / inch

        # The nearest edge of the words stands beside the wheel, or a little farther out.
        edge = np.minimum(*(half / np.maximum(np.abs(WAYS), 1e-9)).T)
        places = [
            point + (far * wheel.radius + gap) * way
            for far in (1.2, 1.45, 1.7, 2.0, 2.3, 2.7)
            for way, gap in zip(WAYS, edge, strict=True)
        ]
        best = min(places, key=cost)
        taken.append(np.stack((best, half)))
        axes.text(best[0], best[1], f"{wheel.name}\n{reading}", color=INK, ha="center", va="center", **WORDS)


def draw_icr(axes: Axes, icr: Floats, low: Floats, high: Floats) -> None:
    """The ICR as a dot; its name stands where the rover does not."""
    x, y = float(icr[0]), float(icr[1])
    axes.plot(x, y, "o", color=CENTRE, markersize=7, markeredgecolor="white", zorder=7)
    if low[0] < x < high[0]:
        y, words, place = y - 0.05 * float(high[1] - low[1]), "ICR", ("center", "top")
    else:
        words, place = "   ICR   ", ("right" if x < low[0] else "left", "center")
    axes.text(x, y, words, color=CENTRE, weight="bold", ha=place[0], va=place[1], **WORDS)


def point_at(axes: Axes, icr: Floats) -> None:
    """Say where the ICR is when it is too far away to be shown."""
    words = "ICR at infinity"
    if np.all(np.isfinite(icr)):
        sideways = abs(icr[0]) >= abs(icr[1])
        arrow = ("←" if icr[0] < 0 else "→") if sideways else ("↓" if icr[1] < 0 else "↑")
        words = f"{arrow} ICR {float(np.hypot(*icr)):.3g} m away"
    _corner(axes, words)


def _corner(axes: Axes, words: str, *, right: bool = False, color: str = CENTRE) -> None:
    place, shift, side = ((1.0, 0.0), (-6, 6), "right") if right else ((0.0, 0.0), (6, 6), "left")
    axes.annotate(words, place, shift, "axes fraction", "offset points", ha=side, color=color, **WORDS)


def draw_key(axes: Axes, rover: Rover, moving: bool) -> None:
    """Draw the legend of wedges, lines and arrows."""
    shown: list[Line2D | Patch] = []
    if any(wheel.steered for wheel in rover.wheels):
        shown.append(Patch(facecolor=AXLE, alpha=0.13, linewidth=0, label="steering range"))
    if moving:
        if any(not wheel.castor and wheel.roller_angle is None for wheel in rover.wheels):
            shown.append(Line2D([], [], color=AXLE, linewidth=1.0, label="axle"))
        shown.append(Line2D([], [], color=MOTION, linewidth=2.0, label="where a wheel goes"))
        arrow = {"marker": r"$\rightarrow$", "markersize": 12, "linestyle": "none"}
        shown.append(Line2D([], [], color=MOTION, label="motion of the body, not to scale", **arrow))  # type: ignore[arg-type]
    look = {"fontsize": 8, "labelcolor": SOFT, "handlelength": 1.6, "columnspacing": 1.4}
    draw_legend(figure_of(axes), handles=shown, loc="outside lower left", ncols=4, **look)


def describe(twist: Floats) -> str:
    vx, vy, omega = (float(value) for value in twist)
    speed = math.hypot(vx, vy)
    least = 1e-5 * max(abs(vx), abs(vy), abs(omega))  # less is the rounding of what led to this twist
    shown = (number(value if abs(value) >= least else 0.0, ".4g") for value in (vx, vy, omega))
    parts = [f"{name} {value} {unit}" for name, value, unit in zip(NAMES, shown, UNITS, strict=True)]
    if speed == 0.0:
        parts.append("turn on the spot" if omega else "at rest")
    else:
        parts.append(f"radius {speed / abs(omega):.3g} m" if omega else "no turn")
    return "   ".join(parts)


def show_figure(rover: Rover, twist: ArrayLike, *, title: str | None = None) -> Figure:
    """Picture of one twist from above, forward up: wheels at their angles, their axles meeting in the ICR.

    Parameters
    ----------
    rover : Rover
        Any layout of wheels.
    twist : array_like, shape (3,)
        vx, vy, omega in body axes [m/s, m/s, rad/s].
    title : str, optional
        Written above the picture, over the

    Returns
    -------
    matplotlib.figure.Figure
        Steering ranges are light wedges. On the line of the unsteered wheels, where the ICR must lie, the
        turns that the steering limits forbid are purple.

    Raises
    ------
    InfeasibleMotionError
        If the rover cannot make this
    ValueError
        If the twist is not three finite numbers.
    """
    asked = np.asarray(twist, dtype=np.float64)
    if asked.shape != (3,):
        raise ValueError(f"twist must have shape (3,), got {asked.shape}")
    steering, speeds = rover.inverse(asked)
    moving = bool(np.any(asked != 0.0))
    icr = page(np.asarray(rover.icr(asked)))
    low, high, size = bounds(rover)
    shown = bool(np.max(np.abs(icr - (low + high) / 2)) <= ICR_REACH * size)  # False also for inf and NaN

    left, right, bottom, top = view(low, high, size, icr, shown)
    width = 8.0  # [in], with labels of wheels
    axes = one_axes(width * (top - bottom) / (right - left) + 1.1, width)
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal")
    tidy(axes, "y, left [m]", "x, forward [m]")
    axes.xaxis.set_major_formatter(lambda value, _: number(-value))  # left of the page is +y

    draw_steering_ranges(axes, rover)
    lines: list[Floats] = []
    for level in icr_levels(rover):
        draw_icr_line(axes, rover, level)
        lines.append(np.stack(np.broadcast_arrays(np.linspace(left, right, 300), level), axis=-1))
    if moving:
        lines += draw_turning_circles(axes, contacts(rover, steering), asked, icr, size, shown)
        lines += draw_axles(axes, rover, steering, icr, size)
    draw_rover(axes, rover, (0.0, 0.0, FORWARD_UP), steering)
    lines += draw_velocity(axes, asked, size)
    if shown:
        draw_icr(axes, icr, low, high)
    elif moving:
        point_at(axes, icr)
    draw_labels(axes, rover, steering, speeds, lines)
    draw_key(axes, rover, moving)
    return with_title(axes, title, describe(asked))
