import math
import subprocess
import sys
from unittest.mock import Mock

import numpy as np
import pytest

from six_wheel import InfeasibleMotionError, Rover, Wheel, integrate

pytest.importorskip("matplotlib")

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle, FancyBboxPatch

from six_wheel import plotting as plot
from six_wheel.kinematics.errors import TableError
from six_wheel.plotting.drawing import AXLE, FORBIDDEN, new_figure
from tests.rovers import MECANUM, SIX_SIZES
from tests.rovers import SIX_WHEELS as ROVER

# The six-wheel rover of design/models.md, section 2.
LIMITED = Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(60))
CORNERS = [(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25), (-0.3, -0.25)]
SWERVE = Rover([Wheel(f"m{i}", x, y, radius=0.05, steered=True) for i, (x, y) in enumerate(CORNERS)])
PAIR = Rover([Wheel("left", 0.0, 0.1, radius=0.04), Wheel("right", 0.0, -0.1, radius=0.04)])
BICYCLE = Rover(
    [
        Wheel("front", 0.6, 0.0, radius=0.3, steered=True, steering_limit=0.6),
        Wheel("rear", -0.4, 0.0, radius=0.3),
    ]
)

TWISTS = {
    "left": (0.5, 0.0, 0.5),
    "backwards": (-0.5, 0.0, 0.5),
    "inside the wheels": (0.05, 0.0, 0.5),
    "far centre": (0.5, 0.0, 1e-3),
    "straight": (0.5, 0.0, 0.0),
    "spin": (0.0, 0.0, 0.5),
    "rest": (0.0, 0.0, 0.0),
    "tiny": (1e-9, 0.0, 1e-9),
}


def lines(figure, color):
    """End points of all lines of a colour, on the page."""
    wanted = to_rgb(color)
    return [line.get_xydata() for line in figure.axes[0].lines if to_rgb(line.get_color()) == wanted]


def draw(figure):
    FigureCanvasAgg(figure).draw()


@pytest.mark.parametrize("rover", [ROVER, SWERVE, PAIR], ids=["six wheels", "swerve", "pair"])
@pytest.mark.parametrize("name", TWISTS)
def test_every_layout_and_twist_gives_a_picture(rover, name):
    draw(plot.show_figure(rover, TWISTS[name], title=name))


@pytest.mark.parametrize("preset", Rover.presets())
def test_every_preset_gives_a_picture(preset):
    rover = Rover.preset(preset)
    draw(plot.show_figure(rover, rover.project((0.1, 0.0, 0.05))))


@pytest.mark.parametrize("name", ["left", "backwards", "inside the wheels", "far centre", "spin"])
def test_axles_meet_in_the_centre_of_rotation(name):
    vx, vy, omega = TWISTS[name]
    centre = np.array((-vx, -vy)) / omega  # forward up: (x, y) stands at (-y, x)
    axles = lines(plot.show_figure(ROVER, TWISTS[name]), AXLE)
    assert len(axles) == len(ROVER.wheels)
    for start, end in axles:
        along, to_centre = end - start, centre - start
        off = abs(along[0] * to_centre[1] - along[1] * to_centre[0]) / np.hypot(*along)
        assert off < 1e-12 * (1 + np.hypot(*to_centre))  # rounding of a coordinate that large


def test_axles_of_a_crab_are_parallel_to_each_other_and_square_to_the_way():
    for start, end in lines(plot.show_figure(SWERVE, (0.3, 0.3, 0.0)), AXLE):
        assert (end - start) @ (-0.3, 0.3) == pytest.approx(0.0, abs=1e-12)


def test_picture_holds_rover_and_near_centre():
    figure = plot.show_figure(ROVER, (0.5, 0.0, 0.5))
    (left, right), (bottom, top) = figure.axes[0].get_xlim(), figure.axes[0].get_ylim()
    assert left < -1.0
    assert right > 0.6
    assert bottom < -0.65
    assert top > 0.65


def test_far_centre_does_not_blow_up_the_picture():
    figure = plot.show_figure(ROVER, (0.5, 0.0, 1e-6))
    assert np.ptp(figure.axes[0].get_xlim()) < 8.0  # [m], of a rover of 1.3 m
    assert any("5e+05 m away" in text.get_text() for text in figure.axes[0].texts)


def test_forbidden_turns_are_marked_where_there_are_any():
    def marks(rover):
        found = [
            line for line in lines(plot.show_figure(rover, (0.5, 0.0, 0.1)), FORBIDDEN) if len(line) == 2
        ]
        return [sorted(np.abs(line[:, 0])) for line in found]

    assert marks(ROVER) == []
    expected = [LIMITED.spin_radius, LIMITED.min_radius]
    np.testing.assert_allclose(marks(LIMITED), [expected, expected], rtol=1e-12)


def test_labels_say_what_inverse_says():
    twist = (0.5, 0.0, 1 / 3)  # radius 1.5 m
    words = " ".join(text.get_text() for text in plot.show_figure(ROVER, twist).axes[0].texts)
    for expected in (
        "front_left\n24.4°  2.69 rad/s",
        "rear_right\n−14.7°  4.37 rad/s",
        "middle_left\n2.33 rad/s",
    ):
        assert expected in words


@pytest.mark.parametrize(
    ("rover", "twist"), [(ROVER, (0.0, 0.1, 0.0)), (LIMITED, (0.2, 0.0, 0.5)), (BICYCLE, (0.0, 0.0, 1.0))]
)
def test_impossible_twist_is_an_error(rover, twist):
    with pytest.raises(InfeasibleMotionError):
        plot.show_figure(rover, twist)


@pytest.mark.parametrize("twist", [(1.0, 0.0), [[1.0, 0.0, 0.0]], (math.nan, 0.0, 0.0)])
def test_bad_twist_is_an_error(twist):
    with pytest.raises(ValueError, match="twist"):
        plot.show_figure(ROVER, twist)


def test_wheels_are_drawn_where_they_are_at_their_size_and_angle():
    figure = new_figure(4.0, 4.0)
    axes = figure.add_subplot()
    steering = (0.3, 0.2, -0.3, -0.2)
    plot.draw_rover(axes, ROVER, (1.0, 2.0, 0.5), steering)
    to_world = axes.transData.inverted()
    tyres = [patch for patch in axes.patches if isinstance(patch, FancyBboxPatch)][1:]  # the body comes first
    angles = (0.3, 0.2, 0.0, 0.0, -0.3, -0.2)
    for tyre, wheel, angle in zip(tyres, ROVER.wheels, angles, strict=True):
        corners = (tyre.get_transform() + to_world).transform(tyre.get_path().vertices)
        x, y = math.cos(0.5), math.sin(0.5)
        pivot = (1.0 + x * wheel.x - y * wheel.y, 2.0 + y * wheel.x + x * wheel.y)
        np.testing.assert_allclose((corners.min(axis=0) + corners.max(axis=0)) / 2, pivot, atol=1e-9)
        along = corners @ (math.cos(0.5 + angle), math.sin(0.5 + angle))
        assert np.ptp(along) == pytest.approx(2 * wheel.radius, rel=1e-6)


def drawn(wheel):
    """The parts of a rover of this one wheel."""
    axes = new_figure(4.0, 4.0).add_subplot()
    plot.draw_rover(axes, Rover([wheel]))
    tyre = [patch for patch in axes.patches if isinstance(patch, FancyBboxPatch)][1]
    rings = [patch for patch in axes.patches if isinstance(patch, Circle)]
    stripes = [found for found in axes.collections if isinstance(found, LineCollection)]
    return axes, tyre, rings, stripes


def test_a_wheel_without_a_motor_is_pale_and_a_castor_has_its_ring():
    _, motor, rings, _ = drawn(Wheel("w", 0.1, 0.2, radius=0.1))
    assert not rings
    _, passive, rings, _ = drawn(Wheel("w", 0.1, 0.2, radius=0.1, driven=False))
    assert not rings
    assert sum(passive.get_facecolor()[:3]) > sum(motor.get_facecolor()[:3]) + 0.5
    axes, castor, (ring,), _ = drawn(Wheel("w", 0.1, 0.2, radius=0.1, castor=True, trail=0.05))
    assert castor.get_facecolor() == passive.get_facecolor()
    assert ring.center == (0.1, 0.2)
    to_page = castor.get_transform() - axes.transData
    corners = to_page.transform(castor.get_path().vertices)
    np.testing.assert_allclose((corners.min(axis=0) + corners.max(axis=0)) / 2, (0.05, 0.2), atol=1e-9)
    assert np.hypot(*(corners - ring.center).T).max() <= ring.radius + 1e-9  # it swivels inside its ring


@pytest.mark.parametrize("angle", [math.pi / 4, -math.pi / 4, math.pi / 2, 1.2])
def test_rollers_are_drawn_along_their_axes_as_seen_from_above(angle):
    *_, (stripes,) = drawn(Wheel("w", 0.1, 0.2, radius=0.1, roller_angle=angle))
    assert stripes.get_clip_path() is not None
    for start, end in stripes.get_segments():
        # Below, the axis is (sin, cos) of its angle in the axes of the wheel; on top it leans the other way.
        across = (end - start) @ (math.cos(angle), math.sin(angle))
        assert across == pytest.approx(0.0, abs=1e-12)
    assert len(stripes.get_segments()) >= 3


def test_only_wheels_that_cannot_slip_sideways_have_a_say_in_the_centre():
    mecanum = MECANUM
    assert lines(plot.show_figure(mecanum, (0.3, 0.1, 0.5)), AXLE) == []
    robot = Rover([*PAIR.wheels, Wheel("c", -0.2, 0.0, radius=0.03, castor=True, trail=0.02)])
    assert len(lines(plot.show_figure(robot, (0.3, 0.0, 0.5)), AXLE)) == 2


def driven():
    twists = np.array([(0.3, 0.0, 0.25)] * 40 + [(0.0, 0.0, 0.5)] * 20 + [(0.3, 0.0, 0.0)] * 30)
    return integrate(twists, 0.2)[:-1], ROVER.inverse(twists)[0]


def test_path_is_as_long_as_driven_and_all_inside():
    poses, steering = driven()
    figure = plot.path_figure(ROVER, poses, steering, title="commands.csv")
    draw(figure)
    axes = figure.axes[0]
    words = [axes.get_title(loc="left"), figure.get_suptitle()]
    chords = float(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum())
    assert {f"{chords:.2f} m", "commands.csv"} <= set(words)
    assert axes.get_xlim()[0] < poses[:, 0].min() - 0.65
    assert axes.get_ylim()[1] > poses[:, 1].max() + 0.65


def test_small_rover_on_a_long_path_is_enlarged_and_said_so():
    poses = integrate(np.full((1000, 3), (1.0, 0.0, 0.0)), 1.0)
    figure = plot.path_figure(ROVER, poses, np.zeros((1001, 4)))
    assert any("times its size" in text.get_text() for text in figure.axes[0].texts)


def test_one_rover_has_one_row_of_angles():
    axes = new_figure(4.0, 4.0).add_subplot()
    with pytest.raises(ValueError, match="steering must be one row of angles, got 2 rows"):
        plot.draw_rover(axes, ROVER, steering=np.zeros((2, 4)))
    with pytest.raises(ValueError, match=r"steering must have shape \(..., 4\), got \(6,\)"):
        plot.draw_rover(axes, ROVER, steering=np.zeros(6))


@pytest.mark.parametrize("rows", [1, 2])
def test_path_at_rest(rows):
    draw(plot.path_figure(ROVER, np.zeros((rows, 3)), np.zeros((rows, 4))))


@pytest.mark.parametrize(
    ("poses", "steering", "message"),
    [
        (
            np.zeros((0, 3)),
            np.zeros((0, 4)),
            r"poses must be finite with shape \(n, 3\), n >= 1, got shape \(0, 3\)",
        ),
        (np.zeros((5, 2)), np.zeros((5, 4)), "poses must be finite"),
        (np.full((5, 3), np.nan), np.zeros((5, 4)), "poses must be finite"),
        (np.zeros((5, 3)), np.zeros((4, 4)), r"steering must have shape \(5, 4\), got \(4, 4\)"),
        (np.zeros((5, 3)), np.zeros((5, 6)), r"steering must have shape \(5, 4\), got \(5, 6\)"),
    ],
)
def test_bad_path_is_an_error(poses, steering, message):
    with pytest.raises(ValueError, match=message):
        plot.path_figure(ROVER, poses, steering)


@pytest.mark.parametrize(("ending", "magic"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_save_writes_what_the_name_says(tmp_path, ending, magic):
    target = tmp_path / f"picture.{ending}"
    plot.save(plot.show_figure(ROVER, (0.5, 0.0, 0.5)), target)
    assert target.read_bytes().startswith(magic)


@pytest.mark.parametrize("name", ["picture.nothing", "picture", ".png", "picture."])
def test_unknown_ending_is_an_error(tmp_path, name):
    """The sentence of matplotlib named no file."""
    target = tmp_path / name
    with pytest.raises(TableError) as error:
        plot.save(plot.show_figure(ROVER, (0.5, 0.0, 0.5)), target)
    rule = "the ending must be .png, .svg, .pdf or another of matplotlib's formats"
    assert str(error.value) == f'{target}: {rule}, got "{target.suffix}"'
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("raised", [RuntimeError, ValueError])
def test_what_matplotlib_cannot_draw_is_named_by_its_file(tmp_path, monkeypatch, raised):
    """A format that needs TeX ended with an error of matplotlib."""
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", Mock(side_effect=raised("no TeX\nhere")))
    target = tmp_path / "picture.pgf"
    with pytest.raises(TableError) as error:
        plot.save(plot.show_figure(ROVER, (0.5, 0.0, 0.5)), target)
    assert str(error.value) == f"{target}: the picture could not be drawn: no TeX here"
    assert list(tmp_path.iterdir()) == []


def test_neither_pyplot_nor_a_window_is_touched():
    code = "import six_wheel.plotting, sys; sys.exit('matplotlib.pyplot' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_missing_matplotlib_is_named_with_the_install_line():
    code = "import sys; sys.modules['matplotlib'] = None; import six_wheel.plotting"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert 'ImportError: pictures need matplotlib: pip install "six-wheel[plot]"' in done.stderr


def test_paths_against_the_truth_and_what_a_calibration_leaves():
    truth = integrate(np.tile((0.1, 0.0, 0.2), (80, 1)), 0.5)
    worse = integrate(np.tile((0.1, 0.0, 0.22), (80, 1)), 0.5)
    figure = plot.track_figure({"nominal": worse, "calibrated": truth}, truth, title="a circle")
    draw(figure)
    path, along, growth = figure.axes
    assert [line.get_label() for line in path.lines[:3]] == ["truth", "nominal", "calibrated"]
    assert along.lines[0].get_ydata()[-1] > 0.1
    assert np.max(along.lines[1].get_ydata()) < 1e-12
    assert len(growth.lines) == 2
    draw(plot.track_figure(truth, truth))
    draw(plot.track_figure(truth[:1], truth[:1]))
    with pytest.raises(ValueError, match="estimate must have shape"):
        plot.track_figure(truth[:-1], truth)
    errors = np.random.default_rng(1).normal(size=(50, 3))
    draw(plot.residual_figure(errors, 0.1 * errors, title="windows"))
    draw(plot.residual_figure(np.empty((0, 3)), np.empty((0, 3))))


def test_a_picture_of_nothing_is_named_as_it_was_called():
    with pytest.raises(TypeError, match=r"^sw\.plot\(\) needs the argument result$"):
        plot()
