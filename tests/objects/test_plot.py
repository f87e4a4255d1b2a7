"""`six_wheel.plot` draws every result without another argument, and refuses the rest in one line."""

import os
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

import six_wheel as sw
from tests.objects.samples import ROVER, TWIST, calibration, public_classes, samples

# Settings and parts that are read, not looked at.
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
}
OUT = os.environ.get("SIX_WHEEL_PICTURES")


@pytest.mark.parametrize("name", sorted({*samples(), *(kind.__name__ for kind in public_classes())}))
def test_every_result_has_a_picture(name):
    one = samples()[name]
    if name in WITHOUT:
        with pytest.raises(TypeError, match=f"result must be one of BodySlip, .*got {name}"):
            sw.plot(one)
        return
    picture = sw.plot(one)
    content = picture._repr_png_()
    assert content.startswith(b"\x89PNG")
    assert any(axes.has_data() for axes in picture.axes)
    assert 650 <= picture.get_figwidth() * 100 <= 1150  # pixels of a page
    assert all(text.get_fontsize() >= 7 for axes in picture.axes for text in axes.texts)
    if OUT:
        Path(OUT, f"{name}.png").write_bytes(content)


def test_a_calibration_and_lists_have_pictures():
    for name, one in (
        ("Calibration", calibration()),
        ("list", [samples()["Track"], samples()["GroundTruth"]]),
    ):
        content = sw.plot(one)._repr_png_()
        if OUT:
            Path(OUT, f"{name}.png").write_bytes(content)


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
        (lambda: sw.plot([1, 2]), "a list must hold tracks, truths or logs with one, got a int"),
        (lambda: sw.plot(1.5), "result must be one of"),
    ):
        with pytest.raises(TypeError, match=message):
            call()
