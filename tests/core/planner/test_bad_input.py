"""Input that a planner refuses: one line, and the planner stays as it was."""

import re

import numpy as np
import pytest

import six_wheel as sw
from tests.core.planner.layouts import LIMITS, ROVERS
from tests.rovers import SIX_SIZES

ROVER = ROVERS["six wheels"]
FLAT = np.zeros((30, 40))
NAN = FLAT.copy()
NAN[3, 7] = np.nan


def planner(**options):
    return sw.Mppi(ROVER, sw.Limits(**LIMITS), **({"samples": 50, "horizon": 10} | options))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sw.Costmap(NAN, 0.1), "values[3, 7] must be finite, got nan"),
        (lambda: sw.Costmap(FLAT - np.inf, 0.1), "values[0, 0] must be finite, got -inf"),
        (
            lambda: sw.Costmap(FLAT[:1], 0.1),
            "values must have 2 to 4194304 rows and columns, got shape (1, 40)",
        ),
        (lambda: sw.Costmap(FLAT[0], 0.1), "values must have shape (rows, columns), got shape (40,)"),
        (lambda: sw.Costmap(FLAT, 0.0), "spacing must be finite and positive, got (0.0, 0.0)"),
        (lambda: sw.Costmap(FLAT, 0.1, (0, np.nan)), "origin must be finite, got (0.0, nan)"),
        (lambda: planner(samples=0), "samples must be 1 to 16777216, got 0"),
        (lambda: planner(horizon=0), "horizon must be 1 to 16777216, got 0"),
        (lambda: planner(horizon=-3), "horizon must be a whole number from 0 on, got -3"),
        (
            lambda: planner(samples=10**7, horizon=10**3),
            "horizon * samples must make 268435456 rollout steps at most",
        ),
        (lambda: planner(seed=-1), "seed must be 0 to 2^64 - 1, got -1"),
        (lambda: planner(seed=2**64), "seed must be 0 to 2^64 - 1, got 18446744073709551616"),
        (lambda: planner(samples=1.5), "samples must be a whole number, got 1.5"),
        (lambda: planner(dt=0.0), "dt must be finite and positive, got 0.0"),
        (lambda: planner(temperature=-1.0), "temperature must be finite and positive, got -1.0"),
        (lambda: planner(sampling_std=(1, 1, np.nan)), "sampling_std must be finite, got (1.0, 1.0, nan)"),
        (lambda: planner(sampling_std=(1, -1, 1)), "sampling_std must be finite and not negative, got -1.0"),
        (lambda: planner(delay=-0.1), "delay must be finite and not negative, got -0.1"),
        (lambda: planner(dtype="int32"), "dtype must be float32 or float64, got 'int32'"),
        (lambda: planner(cost_weights={"maps": 1}), "cost_weights must be of map, collision, goal"),
        (lambda: planner(cost_weights={"map": -1}), "map must be finite and not negative, got -1.0"),
        (lambda: planner(footprint=np.zeros((0, 2))), "footprint must hold 1 to 64 points, got 0"),
        (
            lambda: sw.Mppi(sw.Rover([sw.Wheel("w", 0, 0, radius=0.1, steered=True, trail=0.1)])),
            "rover must have no steered wheel with trail",
        ),
    ],
)
def test_it_is_refused_when_it_is_made(make, message):
    with pytest.raises(ValueError, match=re.escape(message)) as caught:
        make()
    assert "\n" not in str(caught.value)


def raising(poses, twists):
    raise KeyError("mine")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"state": (np.nan, 0, 0)}, "state.pose must be finite, got (nan, 0.0, 0.0)"),
        ({"state": (0, 0)}, "state.pose must have shape (..., 3), got shape (2,)"),
        ({"twist": (0, 0, np.inf)}, "state.twist must be finite, got (0.0, 0.0, inf)"),
        ({"steering": (0, 0, 0)}, "state.steering must have shape (..., 4), got shape (3,)"),
        ({"state": (9, 1, 0)}, "state.pose must lie on the costmap (x 0.0 to 3.9000000000000004 m"),
        ({"state": (9, 1, 0), "goal": None}, "state.pose must lie on the costmap (x 0.0 to"),
        ({"frame": "odom"}, 'costmap must be in the frame of the state, "odom", got "map"'),
        ({"path": [(0, 0)]}, "path must have two points or more, got 1"),
        ({"path": [(0, 0), (np.nan, 1)]}, "path must be finite"),
        ({"path": np.zeros((4, 5))}, "path must have shape (..., 2), got shape (4, 5)"),
        ({"goal": (0, np.inf)}, "goal must be finite, got (0.0, inf)"),
        (
            {"out": (np.zeros(4), np.zeros(5))},
            "out.wheel_speeds must be a writeable float64 array of shape (6,), got shape",
        ),
        (
            {"goal": None},
            "goal must be given, or a path or an extra_cost: without one there is nowhere to go",
        ),
        ({"out": np.zeros(4)}, "out must be a tuple of two arrays, steering and wheel_speeds, got ndarray"),
        ({"level": "none"}, "level must be one this machine has"),
        ({"threads": 0}, "threads must be at least 1, got 0"),
        (
            {"extra_cost": lambda poses, twists: np.zeros(3)},
            "extra_cost must have shape (..., 50), got shape (3,)",
        ),
        (
            {"extra_cost": lambda poses, twists: np.full(50, np.nan)},
            "extra_cost[0] must return numbers, got nan",
        ),
        (
            {"extra_cost": lambda poses, twists: np.full(50, np.inf)},
            "extra_cost must leave one rollout possible",
        ),
    ],
)
def test_a_step_is_refused_and_nothing_is_written(arguments, message):
    plan, twin = planner(), planner()
    good = {"state": (1, 1, 0), "costmap": sw.Costmap(FLAT, 0.1, frame="map"), "goal": (3, 1)}
    plan.step(**good)
    twin.step(**good)
    out = (np.full(4, 7.0), np.full(6, 7.0))
    with pytest.raises(ValueError, match=re.escape(message)) as caught:
        plan.step(**(good | {"out": out} | arguments))
    assert "\n" not in str(caught.value)
    assert (np.concatenate(out) == 7).all()
    np.testing.assert_array_equal(plan.step(**good).controls, twin.step(**good).controls)


def test_what_a_callback_raises_comes_through():
    plan, twin = planner(), planner()
    with pytest.raises(KeyError, match="mine"):
        plan.step((0, 0, 0), extra_cost=raising)
    first, second = (one.step((0, 0, 0), goal=(3, 1)) for one in (plan, twin))
    np.testing.assert_array_equal(first.controls, second.controls)


def test_a_callback_must_not_step_its_planner():
    plan = planner()

    def stepping(poses, twists):
        plan.step((0, 0, 0), goal=(3, 1))
        return np.zeros(50)

    with pytest.raises(ValueError, match="extra_cost must not step the planner it judges for"):
        plan.step((0, 0, 0), extra_cost=stepping)


@pytest.mark.parametrize(
    ("rover", "limits", "reason"),
    [
        (
            sw.Rover.six_wheel(**SIX_SIZES, steering_limit=(0.5, 1.0)),
            {},
            "no motion lets all wheels of this rover roll",
        ),
        (
            sw.Rover([sw.Wheel(name, x, y, radius=0.1, heading=h) for name, x, y, h in
                      [("a", 0, 1, 0.0), ("b", 1, 0, 1.0), ("c", -1, 0.5, 2.0)]]),
            {},
            "no motion lets all wheels of this rover roll",
        ),
        (
            sw.Rover([sw.Wheel("a", 0, 0, radius=0.1),
                      sw.Wheel("b", 1, 0, radius=0.1, steered=True, steering_limit=(0.5, 1.0))]),
            {"steering_limit": 0.3},
            "a steered wheel has no angle within steering_limit",
        ),
    ],
)  # fmt: skip
@pytest.mark.parametrize("goal", [(5, 5), None])
def test_a_rover_that_cannot_move_stays_and_says_why(rover, limits, reason, goal):
    plan = sw.Mppi(rover, sw.Limits(**limits), samples=20, horizon=5)
    steering = np.full(len(rover.steered_wheel_names), 0.75)  # inside their ranges
    found = plan.step((1, 2, 3), steering=steering, goal=goal)
    assert found.reason == reason
    assert not found.twist.any()
    assert not found.wheel_speeds.any()
    np.testing.assert_array_equal(found.steering, steering)
    np.testing.assert_array_equal(found.poses, np.tile((1.0, 2.0, 3.0), (6, 1)))


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_one_step_and_one_sample_are_enough(dtype):
    for horizon, samples in [(1, 1), (1, 40), (30, 1)]:
        plan = planner(horizon=horizon, samples=samples, dtype=dtype)
        for _ in range(3):
            found = plan.step((0, 0, 0), path=[(0, 0), (0, 0), (1, 0)])
        assert np.isfinite(found.poses).all()
        assert found.controls.shape == (horizon, 3)


def test_a_path_may_be_one_place():
    found = planner().step((0, 0, 0), path=[(1, 1), (1, 1)])
    assert np.isfinite(found.controls).all()
