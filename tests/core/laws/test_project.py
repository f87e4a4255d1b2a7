"""The admissible set and the way back into it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from tests.rovers import SIX_SIZES, SIX_WHEELS
from tests.strategies import any_twists, forward_twists, six_wheel_rovers

KEEPS = ["curvature", "speed", "yaw_rate", "nearest"]
LIMITS = st.floats(0.1, 1.7)


def distance(rover: sw.Rover, a, b) -> float:
    """Root mean square difference of the pivots' velocities [m/s]."""
    vx, vy, omega = np.subtract(a, b)
    return math.sqrt(np.mean([(vx - omega * w.y) ** 2 + (vy + omega * w.x) ** 2 for w in rover.wheels]))


@given(six_wheel_rovers(LIMITS), any_twists(), st.sampled_from(KEEPS))
def test_what_comes_out_can_be_driven(rover, twist, keep):
    projected = rover.project(twist, keep)
    assert rover.admissible(projected)
    np.testing.assert_allclose(rover.forward(*rover.inverse(projected)), projected, rtol=0, atol=2e-9)


@given(six_wheel_rovers(LIMITS), any_twists(), st.sampled_from(KEEPS))
def test_projecting_twice_changes_nothing(rover, twist, keep):
    once = rover.project(twist, keep)
    np.testing.assert_array_equal(rover.project(once, keep), once)


@given(six_wheel_rovers(LIMITS), forward_twists(), st.sampled_from(KEEPS))
def test_an_admissible_twist_is_its_own_projection(rover, twist, keep):
    if rover.admissible(twist):
        np.testing.assert_array_equal(rover.project(twist, keep), twist)


@given(six_wheel_rovers(LIMITS), any_twists())
def test_each_keep_keeps_its_own(rover, twist):
    vx, _, omega = twist
    assert rover.project(twist, "speed")[0] == vx
    assert rover.project(twist, "yaw_rate")[2] == omega
    curved = rover.project(twist)
    assert abs(curved[0]) <= abs(vx) * (1 + 1e-15)
    assert abs(curved[2]) <= abs(omega) * (1 + 1e-15)
    if rover.admissible((vx, 0.0, omega)):
        np.testing.assert_array_equal(curved, (vx, 0.0, omega))


@given(six_wheel_rovers(LIMITS), any_twists(), st.floats(0, math.pi), st.floats(-5, 5))
def test_nothing_admissible_is_nearer_than_the_nearest(rover, twist, direction, size):
    nearest = rover.project(twist, "nearest")
    rival = (size * math.cos(direction), 0.0, size * math.sin(direction))
    if rover.admissible(rival):
        assert distance(rover, nearest, twist) <= distance(rover, rival, twist) + 1e-9
    for keep in KEEPS:
        assert distance(rover, nearest, twist) <= distance(rover, rover.project(twist, keep), twist) + 1e-12


def test_a_turn_that_is_too_tight_becomes_the_tightest():
    rover = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(60))
    # R = 0.5 lies nearer to the limit of 0.689 than to the island of 0.111.
    np.testing.assert_allclose(rover.project((0.5, 0, 1.0)), (0.5, 0, 0.5 / rover.min_radius), rtol=1e-14)
    np.testing.assert_allclose(rover.project((0.5, 0, 1.0), "speed"), (0.5, 0, 0.5 / rover.min_radius))
    np.testing.assert_allclose(rover.project((0.5, 0, 1.0), "yaw_rate"), (rover.min_radius, 0, 1.0))


def test_a_spin_that_is_impossible_becomes_rest():
    rover = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=0.5)
    np.testing.assert_array_equal(rover.project((0, 0, 1.0)), (0, 0, 0))
    np.testing.assert_array_equal(rover.project((0, 0, 1.0), "speed"), (0, 0, 0))


def test_sideways_motion_is_dropped():
    rover = SIX_WHEELS
    np.testing.assert_array_equal(rover.project((0.3, 0.2, 0.1)), (0.3, 0.0, 0.1))
    np.testing.assert_array_equal(rover.project((0.0, 0.2, 0.0), "nearest"), (0, 0, 0))


def test_rovers_without_fixed_wheels_are_limited_too():
    # Six steered wheels, 45 degrees: two opposed wedges of directions are open to every wheel.
    spots = [(0.2, 0.12), (0.2, -0.12), (0.0, 0.12), (0.0, -0.12), (-0.2, 0.12), (-0.2, -0.12)]
    wheels = [
        sw.Wheel(f"w{i}", x, y, radius=0.05, steered=True, steering_limit=math.pi / 4)
        for i, (x, y) in enumerate(spots)
    ]
    rover = sw.Rover(wheels)
    np.testing.assert_allclose(rover.project((0.1, 0.3, 0.0), "nearest"), (0.2, 0.2, 0.0), atol=1e-15)
    np.testing.assert_allclose(rover.project((0.1, 0.3, 0.0), "speed"), (0.1, 0.1, 0.0), atol=1e-15)
    assert rover.min_radius == pytest.approx(0.12 + 0.2)
    assert rover.spin_radius == 0.0


def test_what_cannot_be_kept_is_said():
    axles = [sw.Wheel("a", 0, 0.2, radius=0.1), sw.Wheel("b", 0, -0.2, radius=0.1, heading=math.pi / 2)]
    rover = sw.Rover(axles)  # it can only turn about one point
    assert rover.min_radius == math.inf
    with pytest.raises(sw.InfeasibleMotionError, match="same yaw rate"):
        sw.Rover([*axles, sw.Wheel("c", 0.3, 0.3, radius=0.1, heading=1.0)]).project((0, 0, 1.0), "yaw_rate")


def test_the_slip_tolerance_from_both_sides():
    rover = SIX_WHEELS
    assert rover.admissible((1.0, 0.9e-9, 0.0))
    assert not rover.admissible((1.0, 1.1e-9, 0.0))
    limited = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.0)
    radius = limited.min_radius
    assert limited.admissible((radius * (1 - 1e-10), 0, 1))
    assert not limited.admissible((radius * (1 - 1e-8), 0, 1))
    steering, _ = limited.inverse((radius * (1 - 1e-10), 0, 1))
    assert np.abs(steering).max() == 1.0
