"""`six_wheel.plot` draws every result without another argument, and refuses the rest in one line."""

import os
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

from matplotlib.patches import Ellipse

import six_wheel as sw
from six_wheel.maps import Traversed
from six_wheel.plotting.pictures.several import stacked
from tests.objects.samples import ROVER, TWIST, calibration, public_classes, samples

# Settings, parts and streams are read, not looked at.
WITHOUT = {
    "Controller",
    "Encoder",
    "FeasibilityLimits",
    "Gyroscope",
    "Link",
    "MarginJacobian",
    "Noise",
    "Odometry",
    "Odometry3",
    "Peaks",
    "Phase",
    "Pose",
    "State",
    "TransitionState",
    "WheelContradiction",
}
OUT = os.environ.get("SIX_WHEEL_PICTURES")


UNIT = re.compile(r"\[[^]]+\]|°")  # of an axis: a unit, [1] of a plain number


def shows(picture, name):
    """The picture fits a page of 720 pixels, can be read there, and its axes have units."""
    content = picture._repr_png_()
    assert content.startswith(b"\x89PNG")
    if OUT:
        Path(OUT, f"{name}.png").write_bytes(content)
    assert any(axes.has_data() for axes in picture.axes)
    assert 650 <= picture.get_figwidth() * 100 <= 860  # pixels of a page
    for axes in picture.axes:
        words = [*axes.texts, axes.xaxis.label, axes.yaxis.label, *axes.get_xticklabels()]
        assert all(text.get_fontsize() >= 7.5 for text in words if text.get_text())
        if axes.axison and axes.get_visible() and (len(axes.get_xticks()) or len(axes.get_yticks())):
            labels = f"{axes.get_xlabel()} {axes.get_ylabel()}"
            assert UNIT.search(labels) or axes.get_shared_x_axes().get_siblings(axes) != [axes], labels
    # The label of an axis and the last entry of a legend lay partly outside of the page.
    renderer, (width, height) = picture.canvas.get_renderer(), picture.bbox.size
    written = [axis.label for axes in picture.axes if axes.axison for axis in (axes.xaxis, axes.yaxis)]
    for one in [*(label for label in written if label.get_text()), *picture.legends]:
        box = one.get_window_extent(renderer)
        assert min(box.x0, box.y0, width - box.x1, height - box.y1) > -2.0, one


@pytest.mark.parametrize("name", sorted({*samples(), *(kind.__name__ for kind in public_classes())}))
def test_every_result_has_a_picture(name):
    one = samples()[name]
    if name in WITHOUT:
        with pytest.raises(TypeError, match=rf"^result must be a Rover, .{{,100}}, got {name}$"):
            sw.plot(one)
        return
    shows(sw.plot(one), name)


def test_a_calibration_a_traversed_map_and_lists_have_pictures(tmp_path):
    shows(sw.plot(calibration()), "Calibration")
    safe = np.linspace(0.0, 1.0, 600).reshape(20, 30)
    layers = SimpleNamespace(safe=safe, tilt=0.5 * safe)
    fields = dict.fromkeys(Traversed.__dataclass_fields__)
    shows(sw.plot(Traversed(**fields | {"picture": layers, "extent": (0.0, 3.0, 0.0, 2.0)})), "Traversed")
    shows(sw.plot([samples()["Track"], samples()["GroundTruth"]], title="two paths"), "list")


def test_other_results_of_a_list_stand_below_each_other_at_one_scale():
    other = sw.Rover.preset("open_source_rover")
    picture = sw.plot([ROVER, other, samples()["TwistFit"]], title="two rovers and a fit")
    shows(picture, "list of rovers")
    assert len(picture.axes) == 3
    figures = [sw.plot(ROVER), sw.plot(other)]
    stacked(figures, [sw.Rover, sw.Rover], title=None)
    assert figures[0].axes[0].get_xlim() == figures[1].axes[0].get_xlim()
    assert figures[0].axes[0].get_ylim() == figures[1].axes[0].get_ylim()


def test_a_tuple_is_drawn_as_a_list_and_only_pictures_are_saved(tmp_path):
    track = samples()["Track"]
    assert sw.plot((track, track))._repr_png_() == sw.plot([track, track])._repr_png_()
    with pytest.raises(TypeError, match="figure must be what sw.plot gives, got NoneType"):
        sw.plot.save(None, tmp_path / "picture.png")


def test_ellipses_lie_under_the_path():
    (path, *_) = sw.plot(samples()["Track"]).axes
    ellipses = [patch for patch in path.patches if isinstance(patch, Ellipse)]
    (line,) = [line for line in path.lines if line.get_label() == "odometry"]
    assert ellipses
    assert all(one.zorder < line.zorder and one.get_facecolor()[3] <= 0.15 for one in ellipses)


def test_motions_on_ground_stand_on_it():
    stand = samples()["SettledPose"]
    command, motion = samples()["GroundCommand"], samples()["GroundMotion"]
    picture = sw.plot(command, stand=stand)
    shows(picture, "GroundCommand on its ground")
    words = [text.get_text() for text in picture.axes[0].texts]
    assert [word.splitlines()[0] for word in words] == [
        n.replace("_", " ") for n in stand.suspension.wheel_names
    ]
    assert all(word.endswith("rad/s") for word in words)
    shows(sw.plot(motion, stand=stand), "GroundMotion on its ground")
    zoe = sw.Suspension.preset("zoe")
    other = zoe.settle(stand.ground, (0.0, 0.0, 0.3))
    shows(sw.plot(zoe.inverse(other, (0.1, 0.05)), stand=other), "GroundCommand of Zoe")
    with pytest.raises(ValueError, match="stand must be that of 6 wheels, got 4 wheels"):
        sw.plot(command, stand=other)
    with pytest.raises(ValueError, match="stand must be one pose at which the rover stands, got"):
        sw.plot(command, stand=stand.suspension.settle(stand.ground, [(0.0, 0.0, 0.0)]))


@pytest.mark.parametrize("centre", [(0.3, 0.0, 0.1), (-0.03, 0.0, 0.1), (0.2, 0.15, 0.1), (0.2, -0.15, 0.1)])
def test_the_line_of_tipping_over_is_the_nearest_one(centre):
    """A weight near one side of the support tips over that side, whose line is the red one."""
    stand = samples()["SettledPose"]
    arm = stand.suspension
    level = arm.settle(sw.Terrain(np.zeros((2, 2)), 20.0, (-10.0, -10.0)), (0.5, 0.0, 2.0))
    picture = sw.plot(arm.stability(level, mass=10.0, centre_of_mass=centre), stand=level)
    shows(picture, "Stability with its polygon")
    (line,) = [line for line in picture.axes[0].lines if len(line.get_xdata()) == 2]
    (cross,) = [line for line in picture.axes[0].lines if line.get_marker() == "P"]
    x, y, _, _ = level.transform @ (*centre, 1.0)  # the body leans by 1e-4 rad
    ahead = np.cos(2.0) * (x - 0.5) + np.sin(2.0) * y, np.cos(2.0) * y - np.sin(2.0) * (x - 0.5)
    np.testing.assert_allclose((cross.get_ydata()[0], -cross.get_xdata()[0]), ahead, atol=1e-9)
    corners = picture.axes[0].patches[0].get_xy()
    middle = corners.mean(axis=0)
    (ends,) = [np.transpose(line.get_data())]
    towards = np.subtract((-centre[1], centre[0]), middle) @ np.subtract(ends.mean(axis=0), middle)
    assert towards > 0.0


def test_the_angle_of_the_red_line_is_that_of_the_stability():
    from six_wheel.plotting.pictures import support

    corners = np.array(((1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)))
    least = float(np.arctan2(0.5, 2.0))  # half a metre from the line x = 1, two metres above it
    assert support._tipping_edge(corners, np.zeros(4), np.array((0.5, 0.0)), least) == 0
    assert support._tipping_edge(corners, np.zeros(4), np.array((0.0, -0.7)), 0.1) == 3
    square = np.concatenate((corners, [(0.0, 0.0), (1.0, 0.0)]))
    assert sorted(support._hull(square)) == [0, 1, 2, 3]


def test_a_planner_is_drawn_over_its_costmap():
    planner, plan, costmap = (samples()[name] for name in ("Mppi", "MppiPlan", "Costmap"))
    for one, options in (
        (planner, {"plan": plan}),
        (planner, {"plan": plan, "costmap": costmap}),
        (plan, {"costmap": costmap}),
        (samples()["RolloutCost"], {"costmap": costmap}),
    ):
        picture = sw.plot(one, **options)
        shows(picture, f"{type(one).__name__} over costs")
        assert len(picture.axes[0].images) == 2 * ("costmap" in options)  # costs, and what is lethal
    with pytest.raises(TypeError, match="costmap must come with plan, the result of the step"):
        sw.plot(planner, costmap=costmap)
    with pytest.raises(TypeError, match="^plan must be a MppiPlan, got 'abc'$"):
        sw.plot(planner, plan="abc")


def test_arguments_of_a_planned_drive_are_named():
    """They were in words of Python and NumPy."""
    from six_wheel.plotting import plan_figure

    costmap, poses = samples()["Costmap"], np.zeros((1, 3))
    with pytest.raises(ValueError, match="^steering must be real numbers, got 'ahead'$"):
        plan_figure(ROVER, costmap, poses, "ahead")
    with pytest.raises(ValueError, match=r"^path must have shape \(m, 2 or more\), got shape \(3,\)$"):
        plan_figure(ROVER, costmap, poses, np.zeros((1, 4)), path=[0.0, 1.0, 2.0])


def test_times_and_distances_are_those_of_the_result():
    run, found = samples()["ControllerRun"], samples()["Evaluation"]
    (line, *_) = sw.plot(run).axes[0].lines
    np.testing.assert_allclose(line.get_xdata(), run.stamps - run.stamps[0])
    (line, *_) = sw.plot(found).axes[0].lines
    np.testing.assert_array_equal(line.get_xdata(), found.along)


def test_batches_have_pictures():
    stand = samples()["SettledPose"]
    arm, ground = stand.suspension, stand.ground
    poses = [(0.1 * k, 0.0, 0.0) for k in range(5)]
    steering, speeds = ROVER.inverse([TWIST] * 4)
    batches = [
        arm.settle(ground, poses),
        arm.bounds(ground, poses),
        arm.feasible(ground, poses),
        ROVER.fit(steering, speeds),
        ROVER.sensitivity(steering, speeds),
        arm.stability(arm.settle(ground, poses), mass=1.0),
    ]
    for one in batches:
        assert sw.plot(one)._repr_png_()


def test_options_and_titles():
    assert sw.plot(ROVER, twist=TWIST, title="a title")._repr_png_()
    assert sw.plot(samples()["Limits"], rover=ROVER)._repr_png_()
    for call, message in (
        (
            lambda: sw.plot(ROVER, twst=1),
            r"sw\.plot\(\) has no twst; did you mean twist\? It takes title, twist, limits",
        ),
        (lambda: sw.plot(ROVER, twist=TWIST, limits=sw.Limits()), "twist= or limits=, got both"),
        (lambda: sw.plot([1, 2]), "^result must be a Rover, .{,100}, got int$"),
        (lambda: sw.plot([]), "a list must hold results that have pictures, got an empty one"),
        (lambda: sw.plot([ROVER] * 7), "a list must hold at most 6 results, or paths, got 7"),
        (lambda: sw.plot(1.5), "^result must be a Rover, .{,100}, got float$"),
        (
            lambda: sw.plot(np.zeros((3, 3))),
            "got ndarray; poses are drawn by six_wheel.plotting",
        ),
        (lambda: sw.plot(sw.Rover), "got type; give an object of the class$"),
        (lambda: sw.plot("track.csv"), r"got str; read the file first: six_wheel\.load"),
        (lambda: sw.plot(Path("map.tif")), r"got PosixPath; read the file first"),
    ):
        with pytest.raises(TypeError, match=message):
            call()


def test_ground_that_nobody_knows_is_refused_in_one_line():
    with pytest.raises(ValueError, match="ground must have a known height to be drawn, all of them are NaN"):
        sw.plot(sw.Terrain(np.full((3, 3), np.nan), 1.0))
