"""The cheat sheet: one A4 page with axes, shapes, code, commands and remedies, as SVG and PDF."""

import math
import re
from collections.abc import Sequence
from pathlib import Path
from textwrap import shorten

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from six_wheel import Rover, plot
from six_wheel.cli.names import COMMANDS

A4 = (8.27, 11.69)  # [in]
LEFT, MIDDLE = 0.04, 0.515  # of the width
INK, SOFT, CENTRE, MOTION = plot.drawing.INK, plot.drawing.SOFT, plot.drawing.CENTRE, plot.drawing.MOTION
STEP = 0.0142  # between lines, of the height of the page

SHAPES = (
    ("twist", "(..., 3)", "vx, vy [m/s], omega [rad/s]"),
    ("pose", "(..., 3)", "x, y [m], yaw [rad]"),
    ("steering", "(..., steered)", "angles [rad]"),
    ("speeds", "(..., wheels)", "wheel rates [rad/s]"),
    ("wheel_angles", "(n, wheels)", "running totals [rad]"),
    ("stamps", "(n,)", "[s], rising"),
    ("covariance", "(..., 3, 3)", "of x, y, yaw"),
    ("stand", "a SettledPose", "z, roll, pitch, joints"),
)

CODE = """import six_wheel as sw
rover = sw.Rover.six_wheel(front_to_middle=0.5,
    middle_to_rear=0.5, track_width=0.8,
    middle_track_width=0.9, wheel_radius=0.15)
rover = sw.Rover.preset("perseverance")
steering, speeds = rover.inverse((0.3, 0, 0.1))
twist = rover.forward(steering, speeds)
fit = rover.fit(steering, speeds, method="robust")
fit.worst_wheel, fit.residuals
rover.project((0.3, 0.1, 0.0))     # nearest possible
rover.commands((0.3, 0, 0.1))      # by joint name
poses = sw.integrate([twist] * 50, dt=0.1)
limits = sw.Limits(speed=0.5, acceleration=0.5)
controller = sw.Controller(rover, limits)
controller.command((0.3, 0, 0.1), 0.0)
out = controller.step(0.01)        # .reasons .commands
odometry = sw.Odometry(rover)
state = odometry.update(steering, 0.0 * speeds, 0.0)
log = sw.simulate(rover, [(0, 0.3, 0, 0.1), (9, 0, 0, 0)])
track = sw.dead_reckon(rover, log)
track.slip_report()
plan = sw.Mppi(rover, limits).step((0, 0, 0), goal=(2, 1))
ground = sw.Terrain.yard((9, 9), spacing=0.1, seed=1)
arm = sw.RockerBogie.preset("perseverance")
stand = arm.settle(ground, (4, 4, 0))
figure = sw.plot(rover, twist=(0.3, 0, 0.1))"""

REASONS = (
    ("STEERING_LIMIT", "ask for a wider turn"),
    ("PROJECTED", "ask for a motion the wheels allow"),
    ("SPEED .. JERK", "a limit binds: ask for less, or raise it"),
    ("WHEEL_SPEED", "the fastest wheel binds: drive slower"),
    ("STEERING_RATE", "a joint cannot turn faster"),
    ("SPIN_ISLAND", "it stops and re-aligns: wait"),
    ("ALIGNING", "joints are on their way: wait"),
    ("STALE", "send commands more often than timeout"),
    ("NOT_FINITE", "a command was NaN: look at its source"),
    ("OUT_OF_ORDER", "stamps go back: one clock for all"),
    ("PAUSED", "the loop was late: see max_step"),
    ("HALTED", "release() at rest"),
    ("JOINT_STUCK", "free worst_joint, then release()"),
)
HEALTH = (
    ("FIRST", "the reference: nothing to do"),
    ("GAP", "rows are missing: log faster"),
    ("WRAPPED", "a counter started over: followed"),
    ("SLIP", 'a wheel slides: method="robust"'),
    ("NOT_FINITE", "a reading is NaN: left out"),
    ("DUPLICATE, BACKWARDS", "repair the stamps"),
    ("JUMP", "faster than max_speed: left out"),
    ("UNDETERMINED", "read more wheels"),
    ("RESTARTED", "counts from there"),
    ("UNSETTLED, OFF_GROUND", "the map does not fit"),
    ("OVERTURNED", "attitude upside down: its axes"),
)


class Page:
    """A4, its places in shares of width and height, from the top."""

    def __init__(self) -> None:
        self.figure = Figure(figsize=A4)
        self.figure.patch.set_facecolor("white")

    def text(self, x: float, y: float, text: str, **style: object) -> None:
        if style.get("family") == "monospace":
            text = text.replace(" ", "\u00a0")  # in SVG two spaces are one
        self.figure.text(x, 1.0 - y, text, **{"va": "top", "fontsize": 8.2, "color": INK, **style})  # type: ignore[arg-type]

    def heading(self, x: float, y: float, text: str) -> float:
        self.text(x, y, text, fontsize=11, weight="bold", color=MOTION)
        return y + 0.023

    def rows(self, x: float, y: float, rows: Sequence[Sequence[str]], columns: Sequence[float]) -> float:
        for row in rows:
            for column, cell in zip(columns, row, strict=True):
                first = column == columns[0]
                self.text(
                    x + column,
                    y,
                    cell,
                    family="monospace" if first else "sans-serif",
                    fontsize=7.8 if first else 8.2,
                )
            y += STEP
        return y + 0.012


def draw_layout(axes: Axes) -> None:
    rover = Rover.six_wheel(
        front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, middle_track_width=0.9, wheel_radius=0.15
    )
    plot.draw_rover(axes, rover, (0, 0, math.pi / 2), rover.inverse((0.5, 0, 0.3))[0], treads=False)
    arrow = {"arrowstyle": "-|>", "color": MOTION, "lw": 1.8}
    axes.annotate("", (0, 0.95), (0, 0), arrowprops=arrow)
    axes.annotate("", (-1.25, 0.07), (0, 0.07), arrowprops=arrow)
    axes.text(0.05, 0.88, "x, vx", color=MOTION, fontsize=8)
    axes.text(-1.25, 0.1, "y, vy", color=MOTION, fontsize=8)
    axes.text(0.05, 0.74, "omega: + to the left", color=MOTION, fontsize=7)
    for number, (name, wheel) in enumerate(zip(rover.wheel_names, rover.wheels, strict=True)):
        right = wheel.y < 0
        axes.text(
            -wheel.y + (0.22 if right else -0.22), wheel.x - 0.05, f"{number} {name}", fontsize=6.5,
            color=INK, ha="left" if right else "right", va="center",
        )  # fmt: skip
    axes.set_xlim(-1.55, 1.55)
    axes.set_ylim(-0.8, 1.05)
    axes.set_aspect("equal")
    axes.axis("off")


def cheat_sheet() -> Figure:
    page = Page()
    page.text(LEFT, 0.025, "six_wheel", fontsize=17, weight="bold")
    page.text(
        0.215,
        0.0325,
        "x forward, y left, z up; counter-clockwise positive; m, s, rad",
        color=SOFT,
        fontsize=8.5,
    )
    draw_layout(page.figure.add_axes((LEFT, 0.735, 0.45, 0.2)))
    y = page.heading(LEFT, 0.28, "Shapes and units")
    y = page.rows(LEFT, y, SHAPES, (0.0, 0.12, 0.24))
    y = page.heading(LEFT, y, "Code")
    for line in CODE.splitlines():
        page.text(LEFT, y, line, family="monospace", fontsize=7.3)
        y += STEP
    y = page.heading(LEFT, y + 0.012, "When wheels contradict or limits bind")
    page.text(LEFT, y, "out.reasons, state.health and stand.reason say why; print them.")
    page.text(LEFT, y + STEP, "A wrong argument is a ValueError that names it; a motion that the rover")
    page.text(LEFT, y + 2 * STEP, "cannot make is an InfeasibleMotionError that names wheel and row.")
    y = page.heading(MIDDLE, 0.075, "Commands: six-wheel ...")
    for name, summary in COMMANDS.items():
        page.text(MIDDLE, y, name, family="monospace", fontsize=7.8)
        page.text(
            MIDDLE + 0.1, y, shorten(re.split("[:;,]", summary)[0], 52, placeholder=" ..."), fontsize=7.6
        )
        y += STEP
    y = page.heading(MIDDLE, y + 0.012, "Reason, and what to do")
    y = page.rows(MIDDLE, y, REASONS, (0.0, 0.15))
    y = page.heading(MIDDLE, y, "OdometryHealth, and what to do")
    y = page.rows(MIDDLE, y, HEALTH, (0.0, 0.205))
    y = page.heading(MIDDLE, y, "Formulas")
    for line in (
        "velocity of a pivot      u = (vx - omega y, vy + omega x)",
        "steering angle           atan2(u_y, u_x)",
        "wheel speed              |u| / r",
        "centre of rotation       (-vy, vx) / omega",
        "curvature                omega / vx",
        "rover.min_radius         tightest turn [m]",
        "rover.spin_radius        widest spin [m]",
    ):
        page.text(MIDDLE, y, line, family="monospace", fontsize=7.4)
        y += STEP
    return page.figure


def write_sheet(folder: Path) -> None:
    """Two files, with their letters as text, so that they stay small."""
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "six_wheel", "pdf.fonttype": 42}):
        for ending in ("svg", "pdf"):
            dates = {"Date": None} if ending == "svg" else {"CreationDate": None}
            cheat_sheet().savefig(folder / f"cheat_sheet.{ending}", metadata=dates)
