"""No commanded angle is outside the rover's own range, whatever was measured."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw

LIMIT = 1.2
ROVER = sw.Rover.six_wheel(
    front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, wheel_radius=0.15, steering_limit=LIMIT
)


@given(st.lists(st.floats(-LIMIT - 0.049, LIMIT + 0.049), min_size=4, max_size=4))
def test_play_is_the_end_of_the_range(measured: list[float]) -> None:
    controller = sw.Controller(ROVER, sw.Limits(steering_rate=0.5))
    controller.command((0.1, 0.0, 0.02), 0.0)
    before = np.clip(measured, -LIMIT, LIMIT)
    for k in range(5):
        angles = controller.step(0.02 * k, measured).steering
        assert np.abs(angles).max() <= LIMIT
        assert np.abs(angles - before).max() <= 0.5 * 0.02 + 1e-12
        before = angles


@pytest.mark.parametrize("started", [False, True])
def test_farther_outside_is_an_error_that_changes_nothing(started: bool) -> None:
    controller, other = sw.Controller(ROVER), sw.Controller(ROVER)
    for each in (controller, other):
        each.command((0.1, 0.0, 0.02), 0.0)
        if started:
            each.step(0.0, [0.0] * 4)
    with pytest.raises(ValueError, match=r"^measured must be inside the steering range, .* \(to 0.05 rad\)"):
        controller.step(0.02, [LIMIT + 0.06, 0.0, 0.0, 0.0])
    for k in range(1, 5):
        found, wanted = (each.step(0.02 * k).steering for each in (controller, other))
        np.testing.assert_array_equal(found, wanted)


def test_a_narrower_limit_by_choice_is_come_back_to_at_the_rate() -> None:
    controller = sw.Controller(ROVER, sw.Limits(steering_limit=0.5, steering_rate=0.5))
    angles = controller.step(0.0, [1.0, 1.0, -1.0, -1.0]).steering
    np.testing.assert_allclose(np.abs(angles), 1.0, atol=0.5 * 0.02)
