"""`Limits`: a value, checked when it is made."""

import math
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from tests.limits import only

NAMES = (
    "speed",
    "yaw_rate",
    "acceleration",
    "deceleration",
    "jerk",
    "angular_acceleration",
    "angular_deceleration",
    "angular_jerk",
    "lateral_acceleration",
    "wheel_speed",
    "wheel_acceleration",
    "steering_limit",
    "steering_rate",
    "steering_acceleration",
)
VALUES = st.one_of(st.none(), st.just(math.inf), st.floats(1e-3, 1e3))
GIVEN = st.fixed_dictionaries({}, optional=dict.fromkeys(NAMES, VALUES))


@given(GIVEN)
def test_limits_are_values(given):
    limits = sw.Limits(**given)
    for copy in (
        pickle.loads(pickle.dumps(limits)),
        eval(repr(limits), {"Limits": sw.Limits}),
        limits.replace(),
    ):
        assert copy == limits
        assert hash(copy) == hash(limits)


@given(GIVEN)
def test_what_is_left_out_reads_as_unlimited(given):
    limits = sw.Limits(**given)
    for name in NAMES:
        value = given.get(name)
        if value is None:
            value = given.get(name.replace("deceleration", "acceleration"))
        assert getattr(limits, name) == (math.inf if value is None else value)


ROVER = sw.Rover.six_wheel(front_to_middle=0.4, middle_to_rear=0.4, track_width=0.6, wheel_radius=0.1)
USUAL = {
    "acceleration": 9.81,
    "deceleration": 9.81,
    "angular_acceleration": 9.81 / 0.5,
    "angular_deceleration": 9.81 / 0.5,
    "steering_rate": 12.0,
    "halt_deceleration": 9.81,
}


def test_defaults_where_nothing_was_given():
    filled = sw.Limits().on(ROVER)
    for name in NAMES:
        assert getattr(filled, name) == pytest.approx(USUAL.get(name, math.inf)), name
    assert filled.on(ROVER) == filled


@given(GIVEN)
def test_defaults_replace_nothing_that_was_given(given):
    limits = sw.Limits(**given)
    filled = limits.on(ROVER)
    for name in NAMES:
        if given.get(name) is not None:
            assert getattr(filled, name) == given[name], name
    # The farthest wheel is 0.5 m away: its speed over the ground changes in a spin as straight on.
    for name in ("acceleration", "jerk"):
        if given.get(f"angular_{name}") is None:
            assert getattr(filled, f"angular_{name}") == pytest.approx(getattr(filled, name) / 0.5)


def test_none_and_infinite_are_not_the_same():
    assert sw.Limits(acceleration=None) == sw.Limits()
    assert sw.Limits(acceleration=math.inf) != sw.Limits()
    assert sw.Limits(acceleration=math.inf).on(ROVER).angular_acceleration == math.inf
    with pytest.raises(ValueError, match="halt_deceleration must be at least deceleration=1.0, got 0.5"):
        sw.Limits(acceleration=1.0, halt_deceleration=0.5)
    assert sw.Limits(halt_deceleration=0.5).on(ROVER).deceleration == 0.5


def test_limits_differ_where_they_differ():
    assert sw.Limits(speed=1.0) != sw.Limits(yaw_rate=1.0)
    assert sw.Limits() != 1.0
    assert sw.Limits(acceleration=1.0, deceleration=math.inf) != sw.Limits(acceleration=1.0)
    with pytest.raises(AttributeError):
        sw.Limits().speed = 1.0  # type: ignore[misc]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", [0.0, -0.0, -1.0, math.nan, -math.inf])
def test_a_limit_is_positive(name, value):
    with pytest.raises(ValueError, match=rf"^{name} must be positive .*, got {value}$"):
        sw.Limits(**{name: value})


@pytest.mark.parametrize("value", ["1", True, [1.0]])
def test_a_limit_is_a_number(value):
    with pytest.raises(TypeError, match="^speed must be a number"):
        sw.Limits(speed=value)


@pytest.mark.parametrize("slower", ["deceleration", "angular_deceleration"])
@pytest.mark.parametrize("top", ["speed", "yaw_rate"])
def test_a_rover_that_may_never_stop_is_a_contradiction(slower, top):
    with pytest.raises(ValueError, match=f"^{slower} must be positive: with {top}=1.5 the rover .*, got 0.0"):
        sw.Limits(**{slower: 0.0, top: 1.5})


def test_the_way_of_a_stop():
    assert sw.Limits(deceleration=0.5).stopping_distance(1.0) == 1.0
    assert sw.Limits(acceleration=0.5).stopping_distance(-1.0) == 1.0
    assert only().stopping_distance(1.0) == 0.0
    assert sw.Limits().stopping_distance(1.0) == pytest.approx(1.0 / (2 * 9.81))
    assert sw.Limits(deceleration=0.5, halt_deceleration=2.0).halting_distance(1.0) == 0.25
    # 0.25 s until 0.5 m/s² is reached, v / a + a / j in all, at half the speed on average.
    assert sw.Limits(acceleration=0.5, jerk=2.0).stopping_distance(1.0) == pytest.approx(1.125)
    assert only(jerk=4.0).stopping_distance(1.0) == pytest.approx(0.5)
    with pytest.raises(ValueError, match="speed must be finite"):
        sw.Limits().stopping_distance(math.nan)
