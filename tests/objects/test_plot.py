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


@pytest.mark.parametrize("name", sorted({*samples(), *(kind.__name__ for kind in public_classes())}))
def test_every_result_has_a_picture(name):
    one = samples()[name]
    if name in WITHOUT:
        with pytest.raises(TypeError, match=f"result must be one of BodySlip, .*got {name}"):
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


def test_ellipses_lie_under_the_path():
    (path, *_) = sw.plot(samples()["Track"]).axes
    ellipses = [patch for patch in path.patches if isinstance(patch, Ellipse)]
    (line,) = [line for line in path.lines if line.get_label() == "odometry"]
    assert ellipses
    assert all(one.zorder < line.zorder and one.get_facecolor()[3] <= 0.15 for one in ellipses)


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
        (lambda: sw.plot([1, 2]), "result must be one of .* got int"),
        (lambda: sw.plot([]), "a list must hold results that have pictures, got an empty one"),
        (lambda: sw.plot([ROVER] * 7), "a list must hold at most 6 results, or paths, got 7"),
        (lambda: sw.plot(1.5), "result must be one of"),
        (
            lambda: sw.plot(np.zeros((3, 3))),
            "got ndarray; poses are drawn by six_wheel.plotting",
        ),
        (lambda: sw.plot("track.csv"), r"got str; read the file first: six_wheel\.load"),
        (lambda: sw.plot(Path("map.tif")), r"got PosixPath; read the file first"),
    ):
        with pytest.raises(TypeError, match=message):
            call()


def test_ground_that_nobody_knows_is_refused_in_one_line():
    with pytest.raises(ValueError, match="ground must have a known height to be drawn, all of them are NaN"):
        sw.plot(sw.Terrain(np.full((3, 3), np.nan), 1.0))
