"""Transitions as values: copies, shapes, and what makes no sense."""

import math
import pickle

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import profiles
from tests.core.control.test_transitions import LEFT, OSR, RATE, ROVERS, STRAIGHT, random_limits
from tests.rovers import CART

PLANS = [
    profiles.icr_transition(OSR, STRAIGHT, LEFT, steering_rate=RATE),
    profiles.icr_transition(
        OSR, STRAIGHT, (0, 0, 1), steering_rate=RATE, steering_jerk=9, previous=[0, 0, 0, 0]
    ),
    profiles.body_transition(OSR, STRAIGHT, LEFT, 1.0, shape="linear"),
    profiles.body_transition(OSR, STRAIGHT, LEFT, angular_acceleration=1.0, synchronise="phase"),
    profiles.module_transition(OSR, OSR.inverse(STRAIGHT), OSR.inverse(LEFT), 1.0),
    profiles.module_transition(CART, ([], [0, 1]), ([], [1, 0]), wheel_acceleration=1),
]


@pytest.mark.parametrize("plan", PLANS, ids=lambda plan: type(plan).__name__)
def test_transitions_are_values(plan):
    copy = pickle.loads(pickle.dumps(plan))
    assert copy == plan
    assert hash(copy) == hash(plan)
    assert plan != 1
    assert sum(plan == other for other in PLANS) == 1
    for part, other in zip(copy.at([0.0, 0.3]), plan.at([0.0, 0.3]), strict=True):
        np.testing.assert_array_equal(part, other)
    if not isinstance(plan, profiles.IcrTransition):
        assert eval(repr(plan), {"profiles": profiles, "Rover": sw.Rover, "Wheel": sw.Wheel}) == plan


@pytest.mark.parametrize("plan", PLANS, ids=lambda plan: type(plan).__name__)
def test_shapes_of_what_comes_out(plan):
    joints, wheels = len(plan.rover.steered_wheel_names), len(plan.rover.wheels)
    for times in [0.5, [0.1, 0.2], np.zeros((2, 3)), np.zeros(0), np.linspace(0, 1, 100)]:
        state = plan.at(times)
        widths = [(3,), (joints,), (wheels,), (joints,), (joints,), ()]
        for part, width in zip(state, widths, strict=True):
            assert np.shape(part) == np.shape(times) + width


@pytest.mark.parametrize(("spread", "least"), [(2.0, 50), (20.0, 10), (300.0, 0)])
def test_any_numbers_give_a_plan_or_a_plain_refusal(spread, least):
    rng = np.random.default_rng(11)
    plans = 0
    for _ in range(200):
        rover = list(ROVERS.values())[rng.integers(len(ROVERS))]
        start, end = (rng.normal(size=3) * 10.0 ** rng.uniform(-spread, spread, 3) for _ in range(2))
        limits = {name: 10.0 ** rng.uniform(-spread, spread) for name in random_limits(rng)}
        try:
            start, end = rover.project(start, "nearest"), rover.project(end, "nearest")
            plan = profiles.icr_transition(rover, start, end, **limits)
            state = plan.at(np.linspace(0.0, plan.duration, 9))
        except ValueError:
            continue
        plans += 1
        assert all(np.all(np.isfinite(part)) for part in state)
    assert plans >= least


TRAILING = sw.Rover(
    [sw.Wheel("a", 0.5, 0, radius=0.1, steered=True, trail=0.1), sw.Wheel("b", 0, 0, radius=0.1)]
)
BAD = [
    (
        lambda: profiles.icr_transition(OSR, STRAIGHT, LEFT, steering_rate=0),
        r"^steering_rate must be positive",
    ),
    (
        lambda: profiles.icr_transition(OSR, STRAIGHT, LEFT, steering_rate=math.inf),
        r"^steering_rate must be finite",
    ),
    (
        lambda: profiles.icr_transition(OSR, STRAIGHT, LEFT, steering_rate=math.nan),
        r"^steering_rate must be positive",
    ),
    (
        lambda: profiles.icr_transition(OSR, STRAIGHT, LEFT, steering_rate=1, wheel_acceleration=-1),
        r"^wheel_acceleration must be positive",
    ),
    (
        lambda: profiles.icr_transition(OSR, (math.nan, 0, 0), LEFT, steering_rate=1),
        r"^start_twist must be finite",
    ),
    (lambda: profiles.icr_transition(OSR, STRAIGHT, (0, 1, 0), steering_rate=1), r"^end_twist must let"),
    (
        lambda: profiles.icr_transition(OSR, STRAIGHT, LEFT, steering_rate=1, wheel_speed=1),
        r"^start_twist must keep every wheel within wheel_speed",
    ),
    (
        lambda: profiles.icr_transition(OSR, STRAIGHT, LEFT, steering_rate=1, previous=[0, 0]),
        r"^previous must have shape \(\.\.\., 4\)",
    ),
    (
        lambda: profiles.icr_transition(TRAILING, STRAIGHT, STRAIGHT, steering_rate=1),
        r"^rover must have no steered",
    ),
    (lambda: profiles.body_transition(OSR, STRAIGHT, LEFT), r"^duration must be given, or"),
    (
        lambda: profiles.body_transition(OSR, STRAIGHT, LEFT, 1, acceleration=1),
        r"^duration must not come with",
    ),
    (lambda: profiles.body_transition(OSR, STRAIGHT, LEFT, 0), r"^duration must be finite and positive"),
    (lambda: profiles.body_transition(OSR, STRAIGHT, LEFT, 1, shape="round"), r"^shape must be 'linear'"),
    (lambda: profiles.body_transition(OSR, STRAIGHT, (0, 1, 0), 1), r"^end_twist must let"),
    (lambda: profiles.module_transition(OSR, 1, 2, 1), r"^start must be a pair"),
    (
        lambda: profiles.module_transition(OSR, ([0] * 4, [0] * 6), ([2] * 4, [0] * 6), 1),
        r"^end must steer wheel \"front_left\" within",
    ),
    (
        lambda: profiles.module_transition(OSR, ([0] * 4, [0] * 6), ([1] * 4, [0] * 5), 1),
        r"^end\[1\] must have shape \(\.\.\., 6\)",
    ),
    (lambda: PLANS[0].at(math.nan), r"^times must be finite"),
]


@pytest.mark.parametrize(("call", "message"), BAD)
def test_what_makes_no_sense_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
