"""UMBmark: squares driven by rovers of known dimensions, simulated with the core's own kinematics."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from tests.rovers import SMALL_PAIR as NOMINAL

SIDE = 2.0


def returned(true: sw.Rover, *, left: bool) -> np.ndarray:
    """End pose of a rover that believes to have driven the square as `NOMINAL`."""
    turn = math.pi / 2 if left else -math.pi / 2
    pose = np.zeros((1, 3))
    for twist in ((SIDE, 0.0, 0.0), (0.0, 0.0, turn)) * 4:
        _, speeds = NOMINAL.inverse(twist)
        pose = sw.integrate([true.forward([], speeds)], 1.0, start=pose[-1])[-1:]
    return pose[-1, :2]


@given(ratio=st.floats(-5e-3, 5e-3), wider=st.floats(-0.01, 0.01))
def test_the_dimensions_come_back(ratio, wider):
    radii = 0.042 * (1.0 - ratio / 2), 0.042 * (1.0 + ratio / 2)
    true = sw.Rover.differential(0.2 * (1.0 + wider), radii)
    result = sw.umbmark(NOMINAL, [returned(true, left=False)], [returned(true, left=True)], SIDE)
    # The method is of first order in errors of up to 5 % of the side: what is left is of second.
    assert result.diameter_ratio == pytest.approx(radii[1] / radii[0], abs=4e-4)
    assert result.track_ratio == pytest.approx(1.0 + wider, abs=4e-3)
    better = [np.hypot(*returned(rover, left=left)) for rover in (NOMINAL, true) for left in (True, False)]
    assert result.error <= max(better[2:]) + 1e-12


def test_a_rover_as_drawn_is_left_as_it_is():
    result = sw.umbmark(NOMINAL, np.zeros((5, 2)), np.zeros((5, 2)), SIDE)
    assert result.rover == NOMINAL
    assert (result.diameter_ratio, result.track_ratio, result.error, result.spread) == (1.0, 1.0, 0.0, 0.0)
    assert repr(result) == "SquareTest(E_d 1.000000, E_b 1.000000, systematic 0.0000 m, spread 0.0000 m)"


def test_spread_is_what_is_left_around_the_centres():
    result = sw.umbmark(NOMINAL, [(0.01, 0.0), (-0.01, 0.0)], [(0.0, 0.03), (0.0, -0.03)], SIDE)
    assert result.rover == NOMINAL
    assert result.spread == pytest.approx(math.sqrt((2 * 0.01**2 + 2 * 0.03**2) / 4))


@pytest.mark.parametrize(
    ("rover", "clockwise", "side", "rule"),
    [
        (sw.Rover.mecanum(0.2, 0.2, 0.03), [(0, 0)], 1.0, "rover must have two driven, unsteered wheels"),
        (NOMINAL, [(0, 0, 0)], 1.0, r"clockwise must have shape \(n, 2\)"),
        (NOMINAL, np.empty((0, 2)), 1.0, "clockwise must have shape"),
        (NOMINAL, [(0, math.nan)], 1.0, "clockwise must be finite"),
        (NOMINAL, [(0, 0)], 0.0, "side must be finite and positive"),
    ],
)
def test_what_is_no_square_test_is_refused(rover, clockwise, side, rule):
    with pytest.raises(ValueError, match=rule):
        sw.umbmark(rover, clockwise, [(0, 0)], side)
