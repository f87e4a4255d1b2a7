"""Draw the pictures of the pages: ``python docs/draw.py`` writes all of docs/pictures, with names only those.

A picture of one's own is a function that returns it, and its line in `DRAWN`.
"""

import io
import math
import runpy
import sys
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path

import floors
import numpy as np
from lessons import LESSONS
from matplotlib.figure import Figure
from PIL import Image, ImageColor
from sheet import write_sheet
from viewers import foxglove_figure

from six_wheel import (
    FourAxle,
    FourAxleState,
    Limits,
    Noise,
    RockerBogie,
    Rover,
    Wheel,
    plot,
    profiles,
    reference,
)
from six_wheel.calibration.files import Calibrated, calibrate_files
from six_wheel.cli.demo import figures
from six_wheel.cli.demo.ground import drive_yard
from six_wheel.cli.demo.motion import ROVERS, drive_path, load_path
from six_wheel.cli.report.calibration import before_and_after
from six_wheel.log_odometry import ReckonSettings, reckon
from six_wheel.logs import Chunk, optiodom
from six_wheel.logs.headers.columns import TIME
from six_wheel.logs.optiodom import example_run
from six_wheel.plotting.drawing import new_figure
from six_wheel.plotting.log_odometry import draw_key, draw_path
from six_wheel.simulation.drive import ControlledDrive, DriveLoop

PICTURES = Path(__file__).parent / "pictures"
DPI = 100
SHEET = "cheat_sheet"  # no PNG: a page of words
DEMO_DPI = 57  # it is large
README_DPI = 140  # 1400 px wide, with letters of 14 pt
STRIP = 12  # [px]
MEANT = (
    plot.drawing.CENTRE,
    plot.drawing.FORBIDDEN,
    plot.drawing.RECORDED,
    plot.drawing.MOTION,
    plot.drawing.AXLE,
)
COLOURS = 160  # few, so that the files stay small

CORNERS = [(0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)]
RING = [math.radians(angle) for angle in (60.0, 180.0, 300.0)]
ON_A_ROCK = RockerBogie.preset("rocky7").planar((0.3, 0.2, -0.4))

VEHICLES = {
    "six_wheel": (
        Rover.six_wheel(
            front_to_middle=0.5,
            middle_to_rear=0.5,
            track_width=0.8,
            middle_track_width=0.9,
            wheel_radius=0.15,
            steering_limit=1.05,
        ),
        (0.5, 0.0, 0.5),
    ),
    "swerve": (Rover.swerve(CORNERS, 0.08), (0.3, 0.3, 0.6)),
    "differential": (
        Rover(
            [
                *Rover.differential(track_width=0.5, wheel_radius=0.1).wheels,
                Wheel("castor", -0.35, 0.0, radius=0.05, castor=True, trail=0.04),
            ]
        ),
        (0.3, 0.0, 0.5),
    ),
    "tracked": (Rover.tracked(0.5, 0.1, icr_left=0.42, icr_right=-0.38, icr_forward=0.05), (0.5, -0.03, 0.6)),
    "ackermann": (
        Rover.ackermann(wheelbase=1.1, track_width=0.6, wheel_radius=0.15, steering_limit=0.6),
        (0.6, 0.0, 0.3),
    ),
    "tricycle": (Rover.tricycle(wheelbase=0.9, track_width=0.6, wheel_radius=0.12), (0.4, 0.0, 0.4)),
    "bicycle": (Rover.bicycle(wheelbase=1.0, wheel_radius=0.16, steering_limit=0.8), (0.5, 0.0, 0.3)),
    "mecanum": (Rover.mecanum(wheelbase=0.6, track_width=0.5, wheel_radius=0.1), (0.3, 0.2, 0.4)),
    "rocker_bogie": (ON_A_ROCK, ON_A_ROCK.project((0.1, 0.0, 0.12))),
    "omni": (
        Rover.omni(
            [(0.3 * math.cos(a), 0.3 * math.sin(a)) for a in RING], [a + math.pi / 2 for a in RING], 0.06
        ),
        (0.2, 0.1, 0.5),
    ),
}


def four_axles() -> Figure:
    """Drive, stop halfway, re-aim, drive on."""
    car = FourAxle(pivots=(0.4, 0.3), axle_length=0.2, wheel_radius=0.1)
    steps = [car.drive(FourAxleState(), 0.5, 4.0)]
    steps += car.turn_sequence(steps[-1].end, 1.0, speed=0.5)
    steps.append(car.drive(steps[-1].end, 0.5, 4.0))
    return plot.four_axle_figure(car.simulate(steps, 0.02), title="four axles")


def transitions() -> Figure:
    """Scrub that the angles force, while the Open Source Rover goes over to a left turn of 0.6 m."""
    rover = Rover.preset("open_source_rover")
    plain = reference.Rover.six_wheel(
        front_to_middle=0.274,
        middle_to_rear=0.310,
        track_width=0.354,
        middle_track_width=0.506,
        wheel_radius=0.075,
    )
    rate, end = math.radians(60.0), (0.3, 0.0, 0.5)
    figure = plot.drawing.new_figure(7.0, 3.2)
    starts = {"from straight": (0.3, 0.0, 0.0), "from a right turn of 0.6 m": (0.3, 0.0, -0.5)}
    axes = figure.subplots(1, 2, sharey=True, width_ratios=(1.0, 2.0))
    for axis, (title, start) in zip(axes, starts.items(), strict=True):
        ends = rover.inverse(start), rover.inverse(end)
        plans = {
            name: profiles.module_transition(rover, *ends, steering_rate=rate, synchronise=how)
            for name, how in {"independent joints": "none", "synchronised joints": "time"}.items()
        }
        plans["one centre of rotation"] = profiles.icr_transition(rover, start, end, steering_rate=rate)
        colours = (plot.drawing.FORBIDDEN, plot.drawing.AXLE, plot.drawing.MOTION)
        for colour, (name, plan) in zip(colours, plans.items(), strict=True):
            times = np.linspace(0.0, plan.duration, 400)
            scrubs = [reference.profiles.angle_scrub(plain, row, 0.3) for row in plan.at(times).steering]
            axis.plot(times, 1e3 * np.array(scrubs), label=name, lw=1.8, color=colour)
        axis.set_xlim(0.0, None)
        plot.drawing.tidy(axis, "time [s]", "worst side slip [mm/s]" if axis is axes[0] else "")
        axis.set_title(title, loc="left", fontsize=9, color=plot.drawing.SOFT)
    axes[1].legend(frameon=False, fontsize=8, labelcolor=plot.drawing.INK, loc="upper right")
    return figure


@cache
def calibrated() -> tuple[Path, Rover, Calibrated]:
    """The example's run, its rover as it is told, and what calibration makes of both."""
    run = example_run()
    nominal = optiodom.read_rover(run)
    return run, nominal, calibrate_files(nominal, [run])


def calibration() -> Figure:
    """Picture of `six-wheel calibrate --example --plot`."""
    return before_and_after(calibrated()[2], "tricycle")


def honesty() -> Figure:
    """One run as a tape and a data sheet have it, with the typical noise, and with what calibration found."""
    run, nominal, found = calibrated()
    result = found.result
    figure = new_figure(11.0, 4.6)
    for number, (title, rover, noise) in enumerate(
        (
            ("dishonest: nominal, noise of readings alone", nominal, Noise(speed=0.01, steering=0.009)),
            ("honest: nominal, the typical noise", nominal, Noise()),
            ("honest and useful: calibrated, measured", result.rover, result.noise),
        ),
        1,
    ):
        axes = figure.add_subplot(1, 3, number)
        draw_path(axes, reckon(rover, run, settings=ReckonSettings(noise)))
        axes.set_title(title, loc="left", fontsize=9, color=plot.drawing.SOFT)
    draw_key(figure, axes)
    return figure


def driven() -> Figure:
    """Picture of `six-wheel drive --plot`: a straight, a left turn, a tighter right turn, a stop."""
    rover, _ = VEHICLES["six_wheel"]
    bounds = Limits(
        speed=0.8, yaw_rate=0.6, acceleration=0.5, jerk=2.0, angular_acceleration=1.0,
        wheel_speed=6.0, wheel_acceleration=10.0, steering_rate=1.0, steering_acceleration=4.0,
    )  # fmt: skip
    times = np.arange(0.0, 10.0, 0.1)
    twists = np.zeros((len(times), 3))
    twists[:, 0] = np.select([times < 7.0, times < 9.4], [1.0, 0.3])
    twists[:, 2] = np.select([times < 2.0, times < 5.0, times < 7.0, times < 9.4], [0.0, 0.5, 0.0, -0.4])
    engine = ControlledDrive(rover, TIME.units[0], DriveLoop(bounds))
    rows = [*engine.blocks(Chunk(1, times, twists)), *engine.end()]
    assert rows
    shares = engine.summary.shares
    return plot.drive_figure(rover, engine.course, *engine.trace.path(), limits=bounds, shares=shares)


def limits() -> Figure:
    """Motions of the Open Source Rover within limits, its wheels turning 70 degrees to either side."""
    rover = Rover.preset("open_source_rover", steering_limit=math.radians(70.0))
    bounds = Limits(speed=0.5, wheel_speed=8.0, lateral_acceleration=0.25)
    return plot.limits_figure(rover, bounds, title="Open Source Rover, 70 degrees")


def over_ground() -> dict[str, Figure]:
    """Perseverance over a yard of rocks: in space, from its left, and what its wheels do."""
    arm, ground, run = drive_yard()
    climbing = int(np.argmax(np.abs(run.stand.joints).sum(axis=1)))
    one = arm.settle(ground, run.stand.poses[climbing], run.stand.steering[climbing])
    space = plot.ground_figure(run, arm, ground)
    space.set_size_inches(7.6, 5.11)
    return {
        "ground": space,
        "ground_speeds": plot.speeds_figure(run, arm),
        "ground_side": plot.side_figure(arm, one),
    }


def planned() -> dict[str, Figure]:
    """Path of the planner of the example in its narrow places."""
    example = runpy.run_path(str(Path(__file__).parents[1] / "examples" / "05_planner.py"), run_name="worlds")
    figures = {}
    for name, world in example["WORLDS"].items():
        run = example["drive"](world)
        figures[f"planner_{name.replace(' ', '_')}"] = plot.plan_figure(
            example["rover"], world.costmap(), run.poses, run.steering, path=world.path, title=name
        )
    return figures


def demo() -> Figure:
    """First picture of `make demo`."""
    times, poses = load_path()
    found = [drive_path(Rover.preset(key), name, times, poses) for key, name in ROVERS.items()]
    return figures.draw(found)


def write(name: str, figure: Figure, dpi: int) -> None:
    """As a PNG of few colours."""
    png = io.BytesIO()
    figure.savefig(png, dpi=dpi)
    picture = Image.open(png).convert("RGB")
    # A dot would lose its colour to larger things: a strip of each colour keeps those that mean something.
    swatch = Image.new("RGB", (picture.width, picture.height + STRIP * len(MEANT)), "white")
    swatch.paste(picture)
    for place, colour in enumerate(MEANT):
        top = picture.height + STRIP * place
        swatch.paste(ImageColor.getrgb(colour), (0, top, picture.width, top + STRIP))
    palette = swatch.quantize(COLOURS, dither=Image.Dither.NONE)
    picture = picture.quantize(palette=palette, dither=Image.Dither.NONE)
    picture.save(PICTURES / f"{name}.png", optimize=True)


def seen_from_above(name: str) -> Figure:
    """A vehicle as it makes one motion."""
    rover, twist = VEHICLES[name]
    return plot.show_figure(rover, twist, title=name.replace("_", " "))


# By the picture's name; of several pictures by what they begin with.
def map_rows() -> Figure:
    """One small grid as an image stores it, and as ground."""
    heights = np.arange(12.0).reshape(3, 4)
    figure = new_figure(7.0, 2.6)
    left, right = figure.subplots(1, 2)
    titles = ("an image: row 0 in the north", "ground: row 0 in the south")
    for axes, title, rows in ((left, titles[0], heights[::-1]), (right, titles[1], heights)):
        axes.imshow(rows, origin="lower" if axes is right else "upper", cmap="terrain", alpha=0.6)
        axes.set(title=title, xlabel="column, x east", ylabel="row", xticks=range(4), yticks=range(3))
        for row, column in np.ndindex(heights.shape):
            axes.text(column, row, f"{rows[row, column]:g}", ha="center", va="center")
    right.plot(0, 0, "s", markersize=34, fillstyle="none", color="k")
    right.annotate("origin", (0, 0), (0.55, 0.45))
    return figure


DRAWN: dict[str, Callable[[], Figure | dict[str, Figure]]] = {
    **{name: partial(seen_from_above, name) for name in VEHICLES},
    "four_axle": four_axles,
    "transitions": transitions,
    "calibration": calibration,
    "honesty": honesty,
    "drive": driven,
    "limits": limits,
    "ground": over_ground,
    "map_rows": map_rows,
    "foxglove": foxglove_figure,
    "planner": planned,
    "architecture": floors.figure,
    "demo": demo,
    **LESSONS,
}


def main(*names: str) -> None:
    for name in names or (*DRAWN, SHEET):
        if name == SHEET:
            write_sheet(PICTURES)
            continue
        found = DRAWN[name]()
        for each, figure in (found if isinstance(found, dict) else {name: found}).items():
            write(each, figure, {"demo": DEMO_DPI, "readme": README_DPI}.get(each, DPI))


if __name__ == "__main__":
    main(*sys.argv[1:])
