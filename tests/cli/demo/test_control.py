"""The recording through the controller: the way that was commanded is driven, whatever the joints measure."""

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.cli.demo import control
from six_wheel.cli.demo.motion import ROVERS, drive_path, load_path

pytest.importorskip("matplotlib")


@pytest.fixture(scope="module", params=list(ROVERS))
def recording(request):
    return drive_path(sw.Rover.preset(request.param), request.param, *load_path())


@pytest.mark.parametrize("noise", [0.0, control.NOISE])
def test_what_is_commanded_is_driven(recording, noise):
    result = control.drive_controlled(recording, noise)
    moving = np.hypot(*result.commanded[:, :2].T) > 0.0
    changes = np.any(np.diff(result.commanded, axis=0) != 0.0, axis=1)[moving[1:]]
    assert changes.mean() > 0.9  # a new command in nearly every step
    assert result.length(result.twists) >= 0.9 * result.length(result.commanded)
    assert "JOINT_STUCK" not in result.shares
    assert "HALTED" not in result.shares
    # As long as a quarter turn of the joints takes, and the start law's quarter of a second.
    assert result.standing <= 1.1 * (np.pi / 2) / control.LIMITS.steering_rate + 0.25 + 3 / control.RATE


def test_the_picture_has_speeds_and_reasons(recording):
    figure = control.draw_control(control.drive_controlled(recording, control.NOISE))
    words = [label.get_text() for axes in figure.axes for label in axes.get_yticklabels()]
    assert "ALIGNING" in words
    assert "vx [m/s]" in [axes.get_ylabel() for axes in figure.axes]
