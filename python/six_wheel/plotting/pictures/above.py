"""Results drawn on a rover from above, forward up, or on a metre of grid."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from six_wheel._core import Limits, Rover, exp
from six_wheel.kinematics.geometry import Twist
from six_wheel.kinematics.poses import Floats
from six_wheel.plotting.drawing import (
    AXLE,
    CENTRE,
    FORBIDDEN,
    FORWARD_UP,
    INK,
    MOTION,
    SOFT,
    bounds,
    contacts,
    covariance_ellipse,
    draw_legend,
    draw_rover,
    equal_scales,
    number,
    one_axes,
    page,
    tidy,
    with_title,
    write,
)  # fmt: skip
from six_wheel.plotting.limits import limits_figure
from six_wheel.plotting.twist import show_figure

ROUNDING = 1e-9  # [m/s], below which a residual is none


def typical_twist(rover: Rover) -> Twist:
    """A left turn of which the radius is three times the rover, as near as the rover can make it."""
    _, _, size = bounds(rover)
    wanted = (size, 0.0, 1.0 / 3.0)
    return Twist(*np.asarray(rover.project(wanted)).tolist())


def rover_figure(
    rover: Rover, *, title: str | None, twist: ArrayLike | None = None, limits: Limits | None = None
) -> Figure:
    """A `Rover`: at a twist, that of a left turn without one; or its limits."""
    if limits is None:
        return show_figure(rover, typical_twist(rover) if twist is None else twist, title=title)
    if twist is not None:
        raise TypeError("a rover's picture takes twist= or limits=, got both")
    return limits_figure(rover, limits, title=title)


def four_axle_figure(car: Any, *, title: str | None) -> Figure:
    """A `FourAxle`: its rover on a left turn."""
    return rover_figure(car.rover, title=title)


def _axes(rover: Rover, steering: Floats | None) -> tuple[Axes, float]:
    """A page with the rover in its middle, and half its diagonal."""
    axes = one_axes(6.0)
    draw_rover(axes, rover, (0.0, 0.0, FORWARD_UP), steering, fade=0.45)
    low, high, size = bounds(rover)
    axes.set_aspect("equal")
    axes.set(
        xlim=(low[0] - 0.9 * size, high[0] + 0.9 * size), ylim=(low[1] - 0.4 * size, high[1] + 0.4 * size)
    )
    tidy(axes, "to the right [m]", "forward [m]")
    return axes, size


def fit_figure(fit: Any, *, title: str | None) -> Figure:
    """A `TwistFit`: residual of every wheel as a disc and a number, the worst in colour."""
    if np.ndim(fit.residuals) > 1:
        from six_wheel.plotting.pictures.strips import strips

        rows = np.asarray(fit.residuals).reshape(-1, np.shape(fit.residuals)[-1])
        names = fit.rover.wheel_names
        panels = {"residual [m/s]": dict(zip(names, rows.T, strict=True))}
        figure = strips(np.arange(len(rows)), panels, title=title, below=f"residuals of {len(rows)} rows")
        figure.axes[-1].set_xlabel("row", fontsize=8, color=SOFT)
        return figure
    axes, size = _axes(fit.rover, None)
    residual, places = np.asarray(fit.residuals), page(contacts(fit.rover))
    residual = np.where(residual > ROUNDING, residual, 0.0)
    largest = max(float(np.nanmax(residual)), ROUNDING)
    for name, place, slid, weight in zip(fit.rover.wheel_names, places, residual, fit.weights, strict=True):
        colour = CENTRE if name == fit.worst_wheel and slid else AXLE
        axes.plot(*place, "o", markersize=4 + 22 * slid / largest, color=colour, alpha=0.8, zorder=8)
        _label(axes, place, f"{name}\n{slid:.2g} m/s\nweight {weight:.2g}")
    twist = np.asarray(fit.twist)
    _arrow(axes, twist, size)
    worst = f"the worst wheel is {fit.worst_wheel}" if residual.any() else "no wheel contradicts another"
    return with_title(axes, title, f"{_told(twist)}; {worst}")


def _label(axes: Axes, place: Floats, words: str) -> None:
    """Words beside a wheel, on the side away from the body."""
    shift, side = (22, "left") if place[0] >= 0.0 else (-22, "right")
    write(axes, words, tuple(place), (shift, 0), 8.5, ha=side, va="center", zorder=9)


def _arrow(axes: Axes, twist: Floats, size: float) -> None:
    """The velocity of the origin."""
    way = page(twist[:2])
    if (length := float(np.hypot(*way))) > 0.0:
        arrow = {"arrowstyle": "-|>", "color": MOTION, "lw": 2.5}
        axes.annotate("", tuple(size / length * way), (0.0, 0.0), arrowprops=arrow, zorder=9)


def _told(twist: Any) -> str:
    vx, vy, omega = (number(float(part), ".3g") for part in twist)
    return f"vx {vx} m/s, vy {vy} m/s, omega {omega} rad/s"


def output_figure(output: Any, *, title: str | None) -> Figure:
    """A `ControllerOutput`: the rover now, its motion, and why it is not the one asked for."""
    axes, size = _axes(output.rover, output.steering)
    _arrow(axes, np.asarray(output.twist), size)
    for name, place, speed in zip(
        output.rover.wheel_names, page(contacts(output.rover)), output.wheel_speeds, strict=True
    ):
        _label(axes, place, f"{name}\n{speed:.3g} rad/s")
    reasons = "|".join(str(reason.name) for reason in output.reasons) or "as commanded"
    return with_title(axes, title, f"{_told(output.twist)}\n{reasons}")


def mobility_figure(found: Any, *, title: str | None) -> Figure:
    """A `Mobility` or `FourAxleMobility`: each free motion as the path it makes, and the degrees in words."""
    axes = one_axes(5.0)
    for place, motion in enumerate(np.atleast_2d(found.motion)):
        if not motion.size:
            continue
        vx, vy, omega = motion
        turns = abs(omega) > 1e-9
        times = np.linspace(0.0, 0.5 / abs(omega) if turns else 1.0, 60)  # for half a radian, or a metre
        for side in (1.0, -1.0):
            path = page(np.array([exp(side * motion, t)[:2] for t in times]))
            colour, style = (MOTION, AXLE, CENTRE)[place % 3], "-" if side > 0 else "--"
            axes.plot(*path.T, style, color=colour, linewidth=2)
        if turns:
            axes.plot(-vx / omega, -vy / omega, "o", color=CENTRE, markersize=8)
    axes.plot(0, 0, "+", color=INK, markersize=14)
    axes.margins(0.2)
    equal_scales(axes)
    tidy(axes, "to the right [m]", "forward [m]")
    steer = getattr(found, "degree_of_steerability", None)
    words = f"degree of mobility {found.degree_of_mobility}" + (
        "" if steer is None else f", of steerability {steer}"
    )
    return with_title(axes, title, f"{words}; free motions, and their centres of rotation (dots)")


def pose_figure(state: Any, *, title: str | None) -> Figure:
    """An `OdometryState`, `Odometry3State` or `Preintegrated`: pose with its ellipse of 95 %, on a grid."""
    pose = np.asarray(state.delta if hasattr(state, "delta") else state.pose, dtype=float)
    covariance = np.asarray(
        state.covariance_in("coordinates") if hasattr(state, "delta") else state.covariance
    )
    if pose.shape == (4, 4):
        pose = np.array((pose[0, 3], pose[1, 3], math.atan2(pose[1, 0], pose[0, 0])))
    x, y, yaw = pose[0], pose[1], pose[-1]
    axes = one_axes(5.4)
    ellipse = covariance_ellipse(pose, covariance[:2, :2], facecolor=AXLE, alpha=0.25, edgecolor=AXLE)
    axes.add_patch(ellipse)
    reach = max(0.5, 0.7 * ellipse.width)
    spread = 1.96 * math.sqrt(max(float(covariance[-1, -1]), 0.0))
    for angle, style in ((yaw, "-"), (yaw - spread, ":"), (yaw + spread, ":")):
        end = (x + 0.6 * reach * math.cos(angle), y + 0.6 * reach * math.sin(angle))
        axes.plot([x, end[0]], [y, end[1]], color=MOTION, linewidth=1.6, linestyle=style)
    axes.plot(x, y, "o", color=INK, markersize=6)
    axes.set(xlim=(x - reach, x + reach), ylim=(y - 0.6 * reach, y + 0.6 * reach))
    equal_scales(axes)
    tidy(axes, "x [m]", "y [m]")
    deviations = np.sqrt(np.maximum(np.diag(covariance), 0.0))[[0, 1, -1]]
    words = ", ".join(
        f"{name} {number(value, '.3f')} ± {deviation:.2g} {unit}"
        for name, value, deviation, unit in zip(
            ("x", "y", "yaw"), (x, y, yaw), deviations, ("m", "m", "rad"), strict=True
        )
    )
    return with_title(axes, title, f"{words} (ellipse and dotted: 95 %)")


def wheel_figure(wheel: Any, *, title: str | None) -> Figure:
    """A `Wheel`: its pivot, its contact, scrub and trail with their numbers."""
    one = Rover([wheel, *_beside(wheel)])
    axes = one_axes(5.0)
    draw_rover(axes, one, (0.0, 0.0, FORWARD_UP), fade=0.0, body_color="#ffffff")
    pivot, contact = page(np.array((wheel.x, wheel.y))), page(contacts(one))[0]
    axes.plot(*pivot, "o", color=CENTRE, markersize=8, zorder=9, label="pivot")
    axes.plot(*contact, "x", color=FORBIDDEN, markersize=9, markeredgewidth=2, zorder=9, label="contact")
    reach = 2.2 * wheel.radius + abs(wheel.scrub) + abs(wheel.trail)
    axes.set_aspect("equal")
    axes.set(xlim=(pivot[0] - reach, pivot[0] + reach), ylim=(pivot[1] - reach, pivot[1] + reach))
    tidy(axes, "to the right [m]", "forward [m]")
    draw_legend(axes, fontsize=9)
    numbers = ", ".join(f"{name} {getattr(wheel, name):g}" for name in ("x", "y", "radius", "scrub", "trail"))
    words = f"{wheel.name}: {numbers} m"
    return with_title(axes, title, words)


def _beside(wheel: Any) -> list[Any]:
    """A second wheel far away, without which there is no rover."""
    return [type(wheel)("other", wheel.x, wheel.y - 50.0 * wheel.radius, radius=wheel.radius)]
