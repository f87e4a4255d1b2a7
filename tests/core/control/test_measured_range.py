"""No commanded angle is outside the rover's own range, whatever was measured."""

import pickle
from collections.abc import Sequence

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


MODES = ["free", "crab", "front_only", "spin"]


def starts(start: str, mode: str, angles: Sequence[float]) -> sw.Controller:
    """A controller whose joints start at these angles: handed over in one of the two ways there are."""
    if start == "made":
        return sw.Controller(ROVER, sw.Limits(steering_rate=0.5), mode=mode, steering=angles)
    controller = sw.Controller(ROVER, sw.Limits(steering_rate=0.5), mode=mode)
    controller.reset(angles)
    return controller


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("start", ["made", "reset"])
@given(measured=st.lists(st.floats(-LIMIT - 0.049, LIMIT + 0.049), min_size=4, max_size=4))
def test_joints_start_inside_their_ranges(start: str, mode: str, measured: list[float]) -> None:
    """Rear joints of ``front_only`` were commanded where they were handed over, beyond their range."""
    controller = starts(start, mode, measured)
    controller.command((0.1, 0.0, 0.02), 0.0)
    for k in range(5):
        assert np.abs(controller.step(0.02 * k).steering).max() <= LIMIT


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("start", ["made", "reset"])
@pytest.mark.parametrize("joint", range(4))
def test_no_joint_starts_far_outside(start: str, mode: str, joint: int) -> None:
    angles = [0.0] * 4
    angles[joint] = LIMIT + 0.06
    with pytest.raises(ValueError, match=r"^steering must be inside the steering range, .* \(to 0.05 rad\)"):
        starts(start, mode, angles)


def test_the_end_of_the_play_belongs_to_it() -> None:
    """1.05 rad was refused at a range of 1 rad: the difference rounds to more than 0.05."""
    rover = sw.Rover.six_wheel(
        front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, wheel_radius=0.15, steering_limit=1.0
    )
    measured = [1.0 + 0.05, -(1.0 + 0.05), 0.0, 0.0]
    np.testing.assert_array_equal(sw.Controller(rover).step(0.0, measured).steering[:2], [1.0, -1.0])
    np.testing.assert_array_equal(sw.Controller(rover, steering=measured).step(0.0).steering[:2], [1.0, -1.0])
    assert np.abs(planned(rover, measured)).max() <= 1.0


def planned(rover: sw.Rover, measured: Sequence[float]) -> np.ndarray:
    """Angles that a planner commands from measured ones."""
    planner = sw.Mppi(rover, sw.Limits(speed=0.5, yaw_rate=0.5), samples=64, horizon=10)
    return planner.step((0.0, 0.0, 0.0), steering=measured, goal=(3.0, 1.0)).steering


@given(st.lists(st.floats(-LIMIT - 0.049, LIMIT + 0.049), min_size=4, max_size=4))
def test_a_plan_stays_inside_the_ranges(measured: list[float]) -> None:
    """A planner took any angle, 3 rad at a range of 1 rad, and its plan began there."""
    assert np.abs(planned(ROVER, measured)).max() <= LIMIT


@pytest.mark.parametrize("limit", [0.3, 0.7, None])
@pytest.mark.parametrize("own", [(0.5, 1.0), (-0.4, 1.0), (-1.0, -0.2)])
def test_a_planner_begins_inside_the_ranges(own: tuple[float, float], limit: float | None) -> None:
    """One that has no angle within the limit began at 0, outside the range: its copy was refused."""
    rover = sw.Rover.six_wheel(
        front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, wheel_radius=0.15, steering_limit=own
    )
    planner = sw.Mppi(rover, sw.Limits(steering_limit=limit), samples=20, horizon=5)
    for each in (planner, pickle.loads(pickle.dumps(planner))):
        angles = each.step((0.0, 0.0, 0.0), goal=(3.0, 1.0)).steering
        assert np.all((own[0] <= angles) & (angles <= own[1]))
        assert pickle.loads(pickle.dumps(each)).step((0.0, 0.0, 0.0), goal=(3.0, 1.0)).steering.shape == (4,)


def test_a_plan_from_far_outside_is_refused() -> None:
    with pytest.raises(
        ValueError, match=r"^state.steering must be inside the steering range, .* \(to 0.05 rad\)"
    ):
        planned(ROVER, [LIMIT + 0.06, 0.0, 0.0, 0.0])


def test_a_narrower_limit_by_choice_is_come_back_to_at_the_rate() -> None:
    controller = sw.Controller(ROVER, sw.Limits(steering_limit=0.5, steering_rate=0.5))
    angles = controller.step(0.0, [1.0, 1.0, -1.0, -1.0]).steering
    np.testing.assert_allclose(np.abs(angles), 1.0, atol=0.5 * 0.02)


def test_wheels_as_good_as_in_one_place_are_refused() -> None:
    """Two wheels 1e-149 m apart, one with scrub: their speeds were infinite, and NaN at rest."""
    rover = sw.Rover(
        [
            sw.Wheel("a", 0.0, 4e-149, radius=0.1, steered=True),
            sw.Wheel("b", 0.0, 0.0, radius=0.1, steered=True, scrub=0.5),
        ]
    )
    with pytest.raises(
        ValueError, match=r"^rover must have its wheels in one place, or 1e-60 m apart at least"
    ):
        sw.Controller(rover)
