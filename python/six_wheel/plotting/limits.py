"""The picture of a rover's limits: the forward speeds and yaw rates that it can have, and what binds them."""

import math
from itertools import groupby

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Polygon, Rectangle

from six_wheel._core import Limits, Rover
from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.poses import Floats
from six_wheel.kinematics.rover_edit import limits_given
from six_wheel.plotting.drawing import (
    AXLE,
    FORBIDDEN,
    SERIES,
    SOFT,
    TICK,
    draw_legend,
    one_axes,
    page_figure,
    tidy,
    with_title,
    write,
)
from six_wheel.simulation.drive.performance import Rim, rim

COLORS = {
    Reason.SPEED: "#4a7fa7",
    Reason.YAW_RATE: "#8d6a9f",
    Reason.WHEEL_SPEED: "#2a7f62",
    Reason.LATERAL_ACCELERATION: "#d9a441",
}
SHADES = {Reason.STEERING_LIMIT: "#f3e4dd", Reason.PROJECTED: "#eceff1"}
WORDS = {Reason.STEERING_LIMIT: "past the steering range", Reason.PROJECTED: "not without side slip"}
MARGIN = 1.15


def limits_figure(rover: Rover, limits: Limits, *, title: str | None = None) -> Figure:
    """Picture of the forward speeds and yaw rates a rover can have, in the colour of the limit that binds.

    Parameters
    ----------
    rover : Rover
        Any layout of wheels.
    limits : Limits
        Of these the lasting ones count: speed, yaw rate, lateral acceleration, wheel speed, steering angle.
    title : str, optional
        Written above the picture.

    Returns
    -------
    matplotlib.figure.Figure
        A straight line through the middle is one turning radius; along it a twist grows until the limit whose
        colour the line runs through.

    Raises
    ------
    ValueError
        If the limits leave some motion without an end.
    """
    found = rim(rover, limits)
    if found is None:
        raise ValueError(f"limits must bound every motion for a picture of them, got {limits}")
    axes = one_axes(4.8)
    reach = MARGIN * np.abs(found.twists[:, (2, 0)]).max(axis=0)
    reach[reach == 0.0] = 1.0
    axes.set_xlim(reach[0], -reach[0])  # turning left is to the left
    axes.set_ylim(-reach[1], reach[1])
    shown = _fill(axes, found)
    axes.axhline(0.0, color=SOFT, linewidth=0.6, zorder=3)
    axes.axvline(0.0, color=SOFT, linewidth=0.6, zorder=3)
    _write_radii(axes, rover, reach)
    tidy(axes, "yaw rate [rad/s], positive: left", "forward speed [m/s]")
    draw_legend(axes, handles=shown, loc="upper left", bbox_to_anchor=(1.0, 0.4))
    return with_title(axes, title, "what the rover can do, and the limit that binds")


def given_limits_figure(limits: Limits, *, title: str | None, rover: Rover | None = None) -> Figure:
    """`Limits`: those of a `rover`, or the speeds and yaw rates within them, the ramps to the largest, and
    the other limits in words.
    """
    if rover is not None:
        return limits_figure(rover, limits, title=title)
    given = {name: value for name, value in limits_given(limits).items() if math.isfinite(value)}
    figure = page_figure(3.8)
    box, ramps = figure.subplots(1, 2)
    speed, yaw_rate = given.get("speed"), given.get("yaw_rate")
    right, top = 1.25 * (yaw_rate or 1.0), 1.25 * (speed or 1.0)
    wide, high = right if yaw_rate is None else yaw_rate, top if speed is None else speed
    box.add_patch(Rectangle((-wide, -high), 2 * wide, 2 * high, facecolor=AXLE, alpha=0.25, edgecolor=AXLE))
    box.set(xlim=(right, -right), ylim=(-top, top))
    tidy(box, "yaw rate [rad/s], positive: left", "speed [m/s]")
    for name, rise, color, unit in (
        ("speed", "acceleration", SERIES[0], "m/s"),
        ("yaw_rate", "angular_acceleration", SERIES[1], "rad/s"),
    ):
        if name in given and given.get(rise):
            time = given[name] / given[rise]
            label = f"{name.replace('_', ' ')} [{unit}]"
            ramps.plot([0.0, time, 1.3 * time], [0.0, given[name], given[name]], color=color, label=label)
    if ramps.lines:
        draw_legend(ramps)
    else:
        words = "no acceleration and no speed is given"
        ramps.text(0.5, 0.5, words, transform=ramps.transAxes, ha="center", color=SOFT, fontsize=TICK)
    tidy(ramps, "time from rest [s]", "speed [m/s], yaw rate [rad/s]")
    words = ", ".join(f"{name.replace('_', ' ')} {value:.3g}" for name, value in given.items())
    return with_title(box, title, f"given [m, s, rad]: {words or 'none'}")


def _fill(axes: Axes, found: Rim) -> list[Patch]:
    """Draws a wedge for each direction; returns what the legend has to say."""
    patches: dict[Reason, Patch] = {}
    ways, ends = found.directions[:, (2, 0)], found.twists[:, (2, 0)]
    order = (Reason.STEERING_LIMIT, Reason.PROJECTED, *COLORS)
    kinds = [next((kind for kind in order if kind in reasons), Reason.PROJECTED) for reasons in found.reasons]
    for kind, run in groupby(range(len(kinds)), kinds.__getitem__):
        rows = list(run)
        after = (rows[-1] + 1) % len(kinds)
        color = SHADES.get(kind) or COLORS[kind]
        if kind in SHADES:
            corners = 4.0 * ways[[*rows, after]]  # off the page
        else:
            corners = ends[[*rows, after]]
            if kinds[after] in SHADES:  # its fastest motion belongs to another sector
                corners[-1] = ways[after] * np.linalg.norm(corners[-2]) / np.linalg.norm(ways[rows[-1]])
        axes.add_patch(
            Polygon([(0.0, 0.0), *corners], facecolor=color, edgecolor=color, linewidth=0.4, zorder=1)
        )
        label = WORDS.get(kind, str(kind.name).lower().replace("_", " "))
        patches.setdefault(kind, Patch(facecolor=color, label=label))
    beyond = Patch(facecolor="white", edgecolor=SOFT, linewidth=0.6, label="faster than a limit allows")
    return [*(patches[kind] for kind in (*COLORS, *SHADES) if kind in patches), beyond]


def _write_radii(axes: Axes, rover: Rover, reach: Floats) -> None:
    """Lines at the radii between which no turn is possible."""
    for radius, words in ((rover.min_radius, "R min"), (rover.spin_radius, "spin to R")):
        if not 0.0 < radius < math.inf:
            continue
        for side in (1.0, -1.0):
            ends = np.array([-1.0, 1.0]) * 2.0 * reach[0]
            axes.plot(ends, ends * radius * side, color=FORBIDDEN, linewidth=0.8, zorder=4)
        right = min(reach[0], reach[1] / radius)
        look = {"annotation_clip": False, "ha": "left", "va": "center", "zorder": 5}
        write(axes, f"{words} {radius:.3g} m", (-right, right * radius), (3, 0), 8, **look)
