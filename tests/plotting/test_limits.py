"""`Limits`: a value, checked when it is made."""

import math
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw

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
        sw.Limits(**{name: getattr(limits, name) for name in NAMES}),
    ):
        assert copy == limits
        assert hash(copy) == hash(limits)


@given(GIVEN)
def test_what_is_left_out_is_unlimited(given):
    limits = sw.Limits(**given)
    for name in NAMES:
        value = given.get(name)
        if value is None:
            value = given.get(name.replace("deceleration", "acceleration"))
        assert getattr(limits, name) == (math.inf if value is None else value)


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
    assert sw.Limits().stopping_distance(1.0) == 0.0
    # 0.25 s until 0.5 m/s² is reached, v / a + a / j in all, at half the speed on average.
    assert sw.Limits(acceleration=0.5, jerk=2.0).stopping_distance(1.0) == pytest.approx(1.125)
    assert sw.Limits(jerk=4.0).stopping_distance(1.0) == pytest.approx(0.5)
    with pytest.raises(ValueError, match="speed must be finite"):
        sw.Limits().stopping_distance(math.nan)
