"""Arguments of a suspension: any numbers, no rows, wrong ones."""

import math
import re

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import RockerBogie  # noqa: F401  (the name that a repr refers to)
from tests.core.laws.suspensions import ROCKY


def test_any_numbers_will_do():
    expected = ROCKY.frames((0.5, 0.25, -0.5), (0.125, 0.0))["A2"]
    for joints, steering in [
        ([np.float32(0.5), 0.25, -0.5], np.array([0.125, 0.0], dtype=">f4")),
        (np.array([-0.5, 0.25, 0.5])[::-1], (0.125, 0)),
    ]:
        np.testing.assert_array_equal(ROCKY.frames(joints, steering)["A2"], expected)
    column = np.asfortranarray([[0.5, 0.25, -0.5], [0.5, 0.25, -0.5]])
    batch = ROCKY.frames(column, [[0.125, 0.0]] * 2)["A2"]
    np.testing.assert_array_equal(batch, [expected] * 2)
    assert batch.flags.c_contiguous
    assert batch.flags.writeable


def test_no_rows_give_no_rows():
    none = np.zeros((0, 3))
    assert {a.shape for a in ROCKY.frames(none).values()} == {(0, 4, 4)}
    assert {a.shape for a in ROCKY.jacobians(none, none[:, :2]).values()} == {(0, 3, 5)}
    assert ROCKY.icr_offset(none).shape == (0,)
    assert ROCKY.steer(0.1, 0.0, none).wheel_speeds.shape == (0, 6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ROCKY.frames((0.0, 0.0)), r"joints must have shape \(\.\.\., 3\), got shape \(2,\)"),
        (lambda: ROCKY.frames(0.0), r"joints must have shape \(\.\.\., 3\), got a number"),
        (lambda: ROCKY.frames((0.0, 0, 0), (0, 0, 0, 0)), r"steering must have shape \(\.\.\., 2\), got"),
        (
            lambda: ROCKY.frames([(0, 0, 0)] * 3, [(0, 0)] * 2),
            r"steering must have shape \(3, 2\), got shape \(2, 2\)",
        ),
        (lambda: ROCKY.frames((math.nan, 0, 0)), r"joints must be finite, got \(nan, 0\.0, 0\.0\)"),
        (lambda: ROCKY.frames([(0, 0, 0), (math.nan, 0, 0)]), r"joints\[1\] must be finite, got \(nan, "),
        (lambda: ROCKY.jacobians([(0, 0, 0), (0, 0, math.inf)]), r"joints\[1\] must be finite"),
        (lambda: ROCKY.frames((0, 0, 0), (0, math.nan)), r"steering must be finite, got \(0\.0, nan\)"),
        (lambda: ROCKY.planar([(0, 0, 0)]), r"joints must be one row of shape \(3,\), got shape \(1, 3\)"),
        (lambda: ROCKY.planar((0.0, 0, math.nan)), r"joints must be finite"),
        (lambda: ROCKY.icr_offset([[(0, 0, 0), (0, 0, math.nan)]]), r"joints\[0, 1\] must be finite"),
        (lambda: ROCKY.steer(math.nan, 0, (0, 0, 0)), r"speed must be finite, got nan"),
        (lambda: ROCKY.steer(0, [0, math.inf], [(0, 0, 0)] * 2), r"yaw_rate\[1\] must be finite, got inf"),
        (
            lambda: ROCKY.steer([1, 2], 0, [(0, 0, 0)] * 3),
            r"speed must be one number or have shape \(3,\), got",
        ),
        (lambda: ROCKY.steer(1, 0, (0, 0, 0), previous=(0,)), r"previous must have shape"),
        (lambda: ROCKY.steer(1, 0, (0, 0, 0), previous=(0, math.nan)), r"previous must be finite"),
        (lambda: ROCKY.frames(("0.1", 0, 0)), r"joints must be real numbers"),
        (lambda: ROCKY.frames((True, True, False)), r"joints must be real numbers"),
    ],
)
def test_wrong_arguments_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_turns_past_the_steering_limit_are_refused():
    with pytest.raises(sw.InfeasibleMotionError, match='twist must let wheel "front_left" steer within'):
        ROCKY.steer(0.05, 0.3, (0.0, 0.0, 0.0))
    with pytest.raises(sw.InfeasibleMotionError, match=r"twist\[1\] must"):
        ROCKY.steer([0.3, 0.05], 0.3, [(0.0, 0.0, 0.0)] * 2)
    assert sw.RockerBogie(**ROCKY.dimensions | {"steering_limit": 1.5}).steer(0.05, 0.3, (0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    "argument", ["bogie_pivot", "bogie_to_front", "bogie_to_middle", "rear_pivot", "rear_to_wheel"]
)
@pytest.mark.parametrize("axis", range(3))
def test_a_dimension_of_three_bogies_is_named(argument, axis):
    """It was "origin" or "centre", of a part of the chain."""
    said = {
        "bogie_pivot": (0.3, 0.4, 0.1),
        "bogie_to_front": (0.3, 0.1, -0.1),
        "bogie_to_middle": (-0.3, 0.1, -0.1),
        "rear_pivot": (-0.5, 0.0, 0.1),
        "rear_to_wheel": (-0.1, 0.4, -0.1),
    }
    wrong = list(said[argument])
    wrong[axis] = math.nan
    with pytest.raises(
        ValueError, match=rf"^{argument} must be finite, got {re.escape(repr(tuple(wrong)))}$"
    ):
        sw.Suspension.triple_bogie(**said | {argument: wrong}, wheel_radius=0.1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wheel_radius": -0.1}, r"wheel_radius must be finite and positive, got -0\.1"),
        ({"wheel_radius": "big"}, r"wheel_radius must be a number, got 'big'"),
        ({"rocker_pivot": (0.1, 0.2)}, r"rocker_pivot must have shape \(\.\.\., 3\), got shape \(2,\)"),
        ({"rocker_pivot": [(0.1, 0.2, 0.3)]}, r"rocker_pivot must have shape \(3,\), got shape \(1, 3\)"),
        (
            {"rocker_to_front": (0.1, math.nan, 0.3)},
            r"rocker_to_front must be finite, got \(0\.1, nan, 0\.3\)",
        ),
        ({"rocker_pivot": (0.1, -0.2, 0.1)}, r"rocker_to_front must end at a wheel of the left-hand side"),
        ({"bogie_to_rear": (-0.1, -0.2, 0.0)}, r"bogie_to_rear must end at a wheel of the left-hand side"),
        ({"bogie_to_rear": (-1e200, 0, 0)}, r"rocker_pivot must reach a finite distance"),
        ({"steered": "rear"}, r"steered must be 'front', 'corners' or 'all', got \"rear\""),
        ({"steering_limit": 0.0}, r"steering_limit must be finite and positive, got 0\.0"),
    ],
)
def test_wrong_dimensions_are_named(change, message):
    with pytest.raises(ValueError, match=message):
        sw.RockerBogie(**ROCKY.dimensions | change)
