"""A rover from the side: its chain of links, and the ground its wheels stand on."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from six_wheel._core import RockerBogie, SettledPose, Suspension, Terrain
from six_wheel.kinematics.poses import Floats
from six_wheel.plotting.drawing import AXLE, BODY, CENTRE, INK, TRACK, WHEEL, tidy

PIVOT = 0.18  # radius of a drawn joint, of a wheel's


def side_figure(rover: RockerBogie, stand: SettledPose | None = None, *, title: str = "") -> Figure:
    """Draw a rocker-bogie from its left: links, joints, wheels and the ground under them.

    Parameters
    ----------
    rover : RockerBogie
        Suspension that stands.
    stand : SettledPose, optional
        One pose of `RockerBogie.settle`. Default: on flat ground.
    title : str
        A heading.

    Returns
    -------
    matplotlib.figure.Figure
        Left side in colour, the right one behind it pale, both along the heading of the rover.

    Raises
    ------
    ValueError
        If the stand holds several poses or the rover does not stand there.
    """
    stand = stand or on_level_ground(rover)
    if np.ndim(stand.z) or not stand.stands:
        raise ValueError(f"stand must be one pose at which the rover stands, got {stand!r}")
    figure = Figure(figsize=(9, 5), layout="constrained")
    axes = figure.add_subplot()
    axes.set_title(title, loc="left", color=INK)
    draw_side_view(axes, rover, stand)
    tidy(axes, "along the heading [m]", "height [m]")
    return figure


def on_level_ground(rover: Suspension) -> SettledPose:
    """A suspension at the origin of a level plane."""
    return rover.settle(Terrain(np.zeros((2, 2)), 1000.0, (-500.0, -500.0)), (0.0, 0.0, 0.0))


def draw_side_view(axes: Axes, rover: RockerBogie, stand: SettledPose) -> None:
    """Both sides of a rover at one pose, and the ground under them."""
    axes.set_aspect("equal")
    for side, fade in ((1, 0.55), (0, 0.0)):
        _draw_side(axes, rover, stand, side, fade)
    _draw_ground(axes, rover, stand)


def along_heading(stand: SettledPose, points: Floats) -> Any:
    """Points of the world as distances along the heading and heights."""
    x, y, yaw = stand.poses
    ahead = (points[..., 0] - x) * np.cos(yaw) + (points[..., 1] - y) * np.sin(yaw)
    return np.stack([ahead, points[..., 2]], axis=-1)


def _draw_side(axes: Axes, rover: RockerBogie, stand: SettledPose, side: int, fade: float) -> None:
    radius, alpha = rover.dimensions["wheel_radius"], 1.0 - fade
    frames = rover.frames(stand.joints)
    world = [stand.transform @ frames[name] for name in (f"S{side + 1}", f"B{side + 1}", f"S{side + 5}")]
    bogie = world[1][:3, 3]
    behind = "rocker_to_front" in rover.dimensions
    pivot = np.array(rover.dimensions["rocker_pivot"]) * [1, 1 - 2 * side, 1]
    pivot = stand.transform[:3, :3] @ pivot + stand.transform[:3, 3]
    centres = stand.wheel_centres[side::2]
    lone, pair = (centres[0], centres[1:]) if behind else (centres[2], centres[:2])
    height = 10 - 5 * side
    for line, colour in (((lone, pivot, bogie), AXLE), ((pair[0], bogie, pair[1]), CENTRE)):
        x, z = along_heading(stand, np.array(line)).T
        axes.plot(x, z, color=colour, lw=4, alpha=alpha, solid_capstyle="round", zorder=height + 1)
    for centre in centres:
        axes.add_patch(
            Circle(
                along_heading(stand, centre), radius, fc=BODY, ec=WHEEL, lw=2.5, alpha=alpha, zorder=height
            )
        )
    for joint in (pivot, bogie):
        axes.add_patch(
            Circle(
                along_heading(stand, joint),
                PIVOT * radius,
                fc="white",
                ec=INK,
                alpha=alpha,
                zorder=height + 2,
            )
        )
    touching = np.abs(stand.gap[side::2]) < 1e-6
    x, z = along_heading(stand, stand.contacts[side::2][touching]).T
    axes.plot(x, z, "o", color=INK, ms=4, alpha=alpha, zorder=height + 3)


def _draw_ground(axes: Axes, rover: RockerBogie, stand: SettledPose) -> None:
    """The ground under the left wheels, on the line of the middle one."""
    x, y, yaw = stand.poses
    centres = stand.wheel_centres[0::2]
    ahead = along_heading(stand, centres)[:, 0]
    reach = 2 * rover.dimensions["wheel_radius"]
    along = np.linspace(ahead.min() - reach, ahead.max() + reach, 800)
    offset = float((centres[1, :2] - [x, y]) @ [-np.sin(yaw), np.cos(yaw)])
    draw_ground_line(axes, stand, along, offset, depth=reach / 2)
    axes.set_xlim(along[0], along[-1])


def draw_ground_line(axes: Axes, stand: SettledPose, along: Floats, offset: float, *, depth: float) -> None:
    """The ground at distances along the heading [m], so far to the left of the rover, filled below."""
    x, y, yaw = stand.poses
    heading, left = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    height: Floats = np.asarray(stand.ground.height_at((x, y) + along[:, None] * heading + offset * left))
    axes.fill_between(along, height, np.nanmin(height) - depth, color=TRACK, zorder=0)
    axes.plot(along, height, color=INK, lw=1, zorder=1)
