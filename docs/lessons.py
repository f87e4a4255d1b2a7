"""Pictures of the tutorial on wheels, of the glossary and of the README; forward is up."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Polygon

from six_wheel import Rover, Wheel, plot

INK, SOFT, FAINT = plot.drawing.INK, plot.drawing.SOFT, plot.drawing.FAINT
MOTION, CENTRE, AXLE = plot.drawing.MOTION, plot.drawing.CENTRE, plot.drawing.AXLE
TURN = (0.5, 0.0, 0.3)  # the twist of the tutorial

Point = Sequence[float]


def panels(titles: Sequence[str], width: float, height: float) -> tuple[Figure, list[Axes]]:
    """A row of axes of the same scale, without frames."""
    figure = plot.drawing.new_figure(width, height)
    axes = [figure.add_subplot(1, len(titles), k + 1) for k in range(len(titles))]
    for axis, title in zip(axes, titles, strict=True):
        axis.set_aspect("equal")
        axis.axis("off")
        axis.set_title(title, fontsize=11, color=INK)
    return figure, axes


def arrow(axes: Axes, start: Point, end: Point, color: str = MOTION, width: float = 2.2) -> None:
    axes.add_patch(
        FancyArrowPatch(
            tuple(start), tuple(end), arrowstyle="-|>", mutation_scale=14, color=color, linewidth=width,
            shrinkA=0, shrinkB=0, zorder=5,
        )
    )  # fmt: skip


def bend(
    axes: Axes,
    centre: Point,
    radius: float,
    first: float,
    last: float,
    color: str = MOTION,
    width: float = 2.2,
) -> None:
    """An arc with an arrow head, from one angle to another [rad]."""
    angles = np.linspace(first, last, 40)
    x, y = centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles)
    axes.plot(x, y, color=color, linewidth=width, zorder=5)
    arrow(axes, (x[-2], y[-2]), (x[-1], y[-1]), color, width)


def line(axes: Axes, *points: Point, color: str = AXLE, width: float = 1.2, dashed: bool = False) -> None:
    x, y = zip(*points, strict=True)
    axes.plot(x, y, color=color, linewidth=width, linestyle=(0, (5, 4)) if dashed else "-", zorder=2)


def words(
    axes: Axes, place: Point, text: str, color: str = INK, size: float = 10.5, side: str = "center"
) -> None:
    axes.text(place[0], place[1], text, color=color, fontsize=size, ha=side, va="center", zorder=7)


def dot(axes: Axes, place: Point, color: str = CENTRE) -> None:
    axes.plot(*place, "o", color=color, markersize=8, zorder=6)


def tyre(axes: Axes, place: Point, angle: float, radius: float = 0.15, pale: bool = False) -> None:
    """A wheel from above, rolling at an angle from the top of the page [rad], left positive."""
    half = np.array([(-0.4, 1), (0.4, 1), (0.4, -1), (-0.4, -1)]) * radius
    c, s = math.cos(angle), math.sin(angle)
    corners = half @ np.array([(c, s), (-s, c)]) + place
    axes.add_patch(Polygon(corners, color=SOFT if pale else plot.drawing.WHEEL, zorder=4))


def frame(axes: Axes, left: float, right: float, bottom: float, top: float) -> None:
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)


def one_wheel() -> Figure:
    """Rolling and not sliding; the axle points at the centre of rotation; scrub and trail."""
    titles = ("rolls along, not sideways", "its axle points at the ICR", "contact beside the steering axis")
    figure, (first, second, third) = panels(titles, 10.5, 2.9)
    tyre(first, (0, 0), 0.0, 0.3)
    arrow(first, (0, 0.36), (0, 0.8))
    words(first, (0.08, 0.62), "rolls: speed = r q", MOTION, side="left")
    arrow(first, (0.2, 0), (0.6, 0), plot.drawing.FORBIDDEN)
    words(first, (0.4, -0.12), "side slip: 0", plot.drawing.FORBIDDEN)
    frame(first, -0.7, 0.9, -0.6, 0.95)
    vx, _, omega = TURN
    x, y = 0.5, 0.4
    place, icr = np.array((-y, x)), np.array((-vx / omega, 0.0))
    u = np.array((vx - omega * y, omega * x))
    angle = math.atan2(u[1], u[0])
    line(second, place, icr)
    line(second, (0, 0), icr, color=SOFT, dashed=True)
    line(second, (0, 0), place, color=SOFT, dashed=True)
    tyre(second, place, angle)
    arrow(second, place, place + 1.4 * np.array((-u[1], u[0])))
    words(second, np.add(place, (0.12, 0.5)), "u", MOTION)
    arrow(second, (0, 0), (0, 0.7))
    words(second, (0.08, 0.6), "vx", MOTION, side="left")
    bend(second, (0, 0), 0.2, -1.9, 0.9)
    words(second, (0.3, -0.1), "omega", MOTION, side="left")
    dot(second, icr)
    words(second, icr - (0, 0.15), "ICR = (-vy, vx) / omega", CENTRE, side="left")
    words(second, (-1.05, 0.52), "axle", AXLE)
    frame(second, -1.8, 0.65, -0.75, 1.6)
    tyre(third, (0.0, 0.0), 0.35, 0.3)
    pivot = np.array((0.42, 0.32))
    along = np.array((-math.sin(0.35), math.cos(0.35)))
    across = np.array((-math.cos(0.35), -math.sin(0.35)))
    corner = pivot + across * float(-pivot @ across)
    line(third, pivot, corner, color=CENTRE, width=1.8)
    line(third, corner, (0, 0), color=CENTRE, width=1.8)
    dot(third, pivot, INK)
    words(third, np.add(pivot, (0.08, 0.05)), "pivot (x, y)", side="left")
    dot(third, (0, 0), CENTRE)
    words(third, (pivot + corner) / 2 + (0.1, 0.14), "scrub", CENTRE)
    words(third, corner / 2 + (0.2, 0.0), "trail", CENTRE, side="left")
    words(third, (0.26, -0.22), "contact", CENTRE, side="left")
    arrow(third, along * 0.36, along * 0.85)
    frame(third, -0.75, 1.1, -0.6, 0.95)
    return figure


def two_wheels() -> Figure:
    """Straight, a left turn, a spin: the tips of the arrows lie on a line through the centre."""
    figure, axes = panels(("straight: no ICR", "a left turn", "a spin: the ICR in the middle"), 10.5, 3.0)
    for axis, (left, right) in zip(axes, ((0.5, 0.5), (0.4, 0.6), (-0.5, 0.5)), strict=True):
        b = 0.5
        line(axis, (-b / 2, 0), (b / 2, 0), color=INK, width=3)
        for place, speed in ((-b / 2, left), (b / 2, right)):
            tyre(axis, (place, 0), 0.0, 0.1)
            arrow(axis, (place, 0), (place, speed))
        words(
            axis,
            (-b / 2 - 0.08, left + 0.12 if 0 < left < right else left / 2),
            f"{left} m/s",
            MOTION,
            side="right",
        )
        words(axis, (b / 2 + 0.08, right / 2), f"{right} m/s", MOTION, side="left")
        if left != right:
            centre = -(right + left) / 2 / ((right - left) / b)
            far = b / 2
            slope = (right - left) / b
            line(axis, (centre, 0), (far, (far - centre) * slope), color=MOTION, dashed=True)
            line(axis, (centre, 0), (-b / 2, 0), color=AXLE)
            dot(axis, (centre, 0))
            words(axis, (centre + 0.04, -0.14), "ICR", CENTRE, side="left" if left < 0 else "center")
            if left < 0:
                line(axis, (centre, 0), (-far, left), color=MOTION, dashed=True)
        else:
            line(axis, (-b / 2, left), (b / 2, right), color=MOTION, dashed=True)
        frame(axis, -1.5, 0.8, -0.75, 0.85)
    return figure


def turning(axes: Axes, rover: Rover, twist: Point, size: float) -> np.ndarray:
    """The rover, its axles to the centre of rotation, and an arrow at every wheel; returns the centre."""
    vx, vy, omega = twist
    icr = np.array((-vx / omega, -vy / omega))
    steering, _ = rover.inverse(twist)
    plot.draw_rover(axes, rover, (0.0, 0.0, math.pi / 2), steering)
    for wheel in rover.wheels:
        place = np.array((-wheel.y, wheel.x))
        u = np.array((-(vy + omega * wheel.x), vx - omega * wheel.y))
        line(axes, icr, place, width=1.4)
        axes.add_patch(
            Circle(
                tuple(icr), float(np.hypot(*(place - icr))), fill=False, color=MOTION, alpha=0.25, zorder=1
            )
        )
        arrow(axes, place, place + size * u)
    dot(axes, icr)
    return icr


def six_wheels() -> Figure:
    """The corners steer until their axles meet that of the middle wheels."""
    rover = Rover.six_wheel(
        front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, middle_track_width=0.9, wheel_radius=0.15
    )
    titles = ("a left turn: vx 0.5 m/s, omega 0.3 rad/s", "a spin")
    figure, (first, second) = panels(titles, 9.0, 3.9)
    icr = turning(first, rover, TURN, 0.7)
    steering = np.degrees(rover.inverse(TURN)[0])
    words(first, icr - (0, 0.16), "ICR", CENTRE)
    line(first, (-2.0, 0.0), (1.0, 0.0), color=SOFT, dashed=True)
    for wheel, angle in zip((w for w in rover.wheels if w.steered), steering, strict=True):
        words(first, (-wheel.y + math.copysign(0.36, -wheel.y), wheel.x + 0.02), f"{angle:.1f}°", size=10)
    frame(first, -1.95, 0.95, -0.95, 1.15)
    turning(second, rover, (0.0, 0.0, 0.8), 0.45)
    frame(second, -1.1, 1.1, -0.95, 1.15)
    return figure


def readme() -> Figure:
    """A rover turning about a centre of rotation to its left."""
    rover = Rover.six_wheel(
        front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, middle_track_width=0.9, wheel_radius=0.15
    )
    figure = plot.drawing.new_figure(10.0, 4.2)
    axes = figure.subplots()
    axes.set_aspect("equal")
    axes.axis("off")
    icr = turning(axes, rover, TURN, 0.9)
    line(axes, (-3.2, 0.0), (1.6, 0.0), color=SOFT, dashed=True)
    words(axes, icr - (0.3, 0.16), "centre of rotation (ICR)", CENTRE, 14)
    words(axes, (0.75, 1.0), "wheel velocities", MOTION, 14, "left")
    words(axes, (-1.35, 0.42), "axles", AXLE, 14)
    words(axes, (0.75, -0.26), "axle of the\nmiddle wheels", SOFT, 14, "left")
    words(axes, (-2.85, 0.85), "rover.inverse((0.5, 0.0, 0.3))", INK, 15, "left")
    frame(axes, -3.0, 2.2, -0.9, 1.18)
    return figure


def glossary_motion() -> Figure:
    figure, (first, second, third, fourth) = panels(
        ("body frame, twist", "ICR, turning radius", "crab", "spin"), 10.5, 2.9
    )
    rover = Rover.six_wheel(
        front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, middle_track_width=0.9, wheel_radius=0.15
    )
    swerve = Rover.swerve([(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)], 0.15)
    plot.draw_rover(first, rover, (0, 0, math.pi / 2))
    arrow(first, (0, 0), (0, 0.95))
    words(first, (0.1, 0.9), "x, vx", MOTION, side="left")
    arrow(first, (0, 0), (-0.85, 0))
    words(first, (-0.8, 0.13), "y, vy", MOTION)
    bend(first, (0, 0), 0.25, -1.2, 1.2)
    words(first, (0.3, -0.1), "omega", MOTION, side="left", size=9)
    icr = turning(second, rover, (0.5, 0.0, 0.45), 0.0001)
    line(second, icr, (0, 0), color=CENTRE, width=2)
    words(second, icr / 2 - (0.15, 0.15), "R", CENTRE)
    turned = swerve.inverse((0.4, 0.3, 0.0))[0]
    plot.draw_rover(third, swerve, (0, 0, math.pi / 2), turned)
    arrow(third, (0, 0), (-0.54, 0.72))
    turning(fourth, swerve, (0.0, 0.0, 0.8), 0.4)
    for axis in (first, third, fourth):
        frame(axis, -1.0, 1.0, -0.85, 1.05)
    frame(second, -1.35, 0.65, -0.85, 1.05)
    return figure


def glossary_wheels() -> Figure:
    """Six words about a wheel."""
    titles = ("steering angle", "scrub, trail", "side slip, slip angle", "castor", "roller angle")
    figure, (first, second, third, fourth, fifth) = panels(titles, 10.5, 2.6)
    tyre(first, (0, 0), 0.5, 0.35)
    line(first, (0, 0), (0, 0.7), color=SOFT, dashed=True)
    arrow(first, (0, 0), (-0.36, 0.66))
    bend(first, (0, 0), 0.55, math.pi / 2, math.pi / 2 + 0.45, AXLE, 1.5)
    words(first, (0.08, 0.62), "forward", SOFT, side="left", size=9)
    tyre(second, (-0.1, -0.15), 0.0, 0.35)
    dot(second, (0.3, 0.25), INK)
    line(second, (0.3, 0.25), (-0.1, 0.25), color=CENTRE)
    line(second, (-0.1, 0.25), (-0.1, -0.15), color=CENTRE)
    words(second, (0.12, 0.36), "scrub", CENTRE, 9)
    words(second, (0.0, 0.02), "trail", CENTRE, 9, "left")
    words(second, (0.3, 0.12), "pivot", INK, 9)
    tyre(third, (0, -0.1), 0.0, 0.35)
    arrow(third, (0, -0.1), (0, 0.7))
    arrow(third, (0, -0.1), (-0.35, 0.65), CENTRE)
    arrow(third, (0, 0.7), (-0.35, 0.7), plot.drawing.FORBIDDEN)
    words(third, (-0.2, 0.82), "side slip", plot.drawing.FORBIDDEN, 9)
    words(third, (-0.36, 0.4), "velocity", CENTRE, 9, "right")
    tyre(fourth, (0.15, -0.3), -0.4, 0.28)
    line(fourth, (0.0, 0.1), (0.15, -0.3), color=INK, width=3)
    dot(fourth, (0.0, 0.1), INK)
    fourth.add_patch(Circle((0, 0.1), 0.43, fill=False, color=SOFT, linestyle="--"))
    arrow(fourth, (0, 0.1), (-0.18, 0.65))
    plot.draw_rover(
        fifth, Rover([Wheel("m", 0, 0, radius=0.35, roller_angle=math.pi / 4), Wheel("n", 0, 5, radius=0.1)]),
        (0, 0, math.pi / 2),
    )  # fmt: skip
    line(fifth, (-0.5, -0.5), (0.5, 0.5), color=CENTRE)
    line(fifth, (-0.55, 0), (0.55, 0), color=AXLE)
    words(fifth, (0.45, 0.18), "45°", CENTRE, 9, "left")
    for axis in (first, second, third, fourth, fifth):
        frame(axis, -0.75, 0.75, -0.7, 0.95)
    return figure


def glossary_ground() -> Figure:
    """Suspension, contact, clearance, tip-over."""
    titles = ("rocker, bogie", "contact angle", "clearance", "tip-over angle")
    figure, (first, second, third, fourth) = panels(titles, 10.5, 2.8)
    ground = [(-1.0, -0.6), (1.0, -0.6)]
    for axis in (first, third):
        line(axis, *ground, color=SOFT, width=2)
        for x in (-0.75, 0.0, 0.75):
            axis.add_patch(Circle((x, -0.4), 0.2, color=plot.drawing.WHEEL))
        line(axis, (0.75, -0.4), (0.1, 0.25), (-0.38, 0.0), color=INK, width=3)
        line(axis, (-0.75, -0.4), (-0.38, 0.0), (0.0, -0.4), color=AXLE, width=3)
        axis.add_patch(Polygon([(-0.6, 0.3), (0.6, 0.3), (0.6, 0.6), (-0.6, 0.6)], color=plot.drawing.BODY))
    dot(first, (0.1, 0.25), CENTRE)
    dot(first, (-0.38, 0.0), CENTRE)
    words(first, (0.5, 0.12), "rocker", INK, 9.5, "left")
    words(first, (-0.62, -0.02), "bogie", AXLE, 9.5, "right")
    words(first, (0.0, 0.45), "body: differential", INK, 9)
    arrow(third, (0.35, 0.3), (0.35, -0.6), CENTRE)
    words(third, (0.4, -0.05), "clearance", CENTRE, 9.5, "left")
    second.add_patch(Circle((0, 0), 0.45, color=plot.drawing.WHEEL, alpha=0.35))
    touch = 0.45 * np.array((math.sin(0.7), -math.cos(0.7)))
    line(second, (0, 0), (0, -0.45), color=SOFT, dashed=True)
    line(second, (0, 0), touch, color=CENTRE)
    slope = np.array((math.cos(0.7), math.sin(0.7)))
    line(second, touch - 0.55 * slope, touch + 0.5 * slope, color=SOFT, width=2)
    second.add_patch(Arc((0, 0), 0.5, 0.5, theta1=-90, theta2=-90 + math.degrees(0.7), color=CENTRE))
    words(second, (0.12, -0.12), "t", CENTRE, side="left")
    arrow(second, (0, 0), (0.75, 0.0))
    words(second, (0.75, 0.13), "forward", MOTION, 9)
    tilt = np.array([(math.cos(0.3), -math.sin(0.3)), (math.sin(0.3), math.cos(0.3))])
    body = np.array([(-0.5, 0.0), (0.5, 0.0), (0.5, 0.55), (-0.5, 0.55)]) @ tilt.T + (0.0, -0.25)
    fourth.add_patch(Polygon(body, color=plot.drawing.BODY))
    line(
        fourth, body[0] + (body[0] - body[1]) * 0.4, body[1] + (body[1] - body[0]) * 0.4, color=SOFT, width=2
    )
    dot(fourth, body.mean(axis=0), INK)
    line(fourth, body[0], body.mean(axis=0), color=CENTRE)
    line(fourth, body[0], body[0] + (0, 0.9), color=SOFT, dashed=True)
    dot(fourth, body[0], CENTRE)
    words(fourth, body[0] + (0.12, 0.62), "angle", CENTRE, 9, "left")
    for axis in (first, second, third, fourth):
        frame(axis, -1.05, 1.05, -0.75, 0.75)
    return figure


LESSONS = {
    "one_wheel": one_wheel,
    "two_wheels": two_wheels,
    "six_wheels": six_wheels,
    "readme": readme,
    "glossary_motion": glossary_motion,
    "glossary_wheels": glossary_wheels,
    "glossary_ground": glossary_ground,
}
