"""The core against the reference where numbers are small, wrapped or cancel."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from six_wheel.reference import (
    Rover,
    exp,
    log,
    wrap_angle,
)
from tests.core.oracles.reference_rovers import (
    admissible_twist,
    limits,
    rovers,
    swerve,
    twists,
)
from tests.rovers import SIX_SIZES


@pytest.mark.parametrize("omega", [0.0, 5e-324, 1e-300, 1e-17, 1e-9, 1e-4])
def test_nothing_cancels_as_the_turn_goes_to_zero(omega):
    # Series of the arc, good to a relative omega^4.
    x, y, _ = exp((1.0, 0.0, omega))
    assert x == pytest.approx(1.0 - omega**2 / 6.0, rel=1e-15)
    assert y == pytest.approx(omega / 2.0 - omega**3 / 24.0, rel=1e-15, abs=5e-324)
    np.testing.assert_allclose(log((x, y, omega)), (1.0, 0.0, omega), rtol=1e-15, atol=1e-19)


@given(st.floats(-1e4, 1e4))
def test_wrapped_angles_differ_by_whole_turns(angle):
    wrapped = wrap_angle(angle)
    assert abs(wrapped) <= math.pi
    turns = (angle - wrapped) / math.tau
    assert turns == pytest.approx(round(turns), abs=1e-10)
    assert abs(angle) > math.pi or wrapped == angle


# The nearest twist, against a search that knows nothing of planes


def pivot_change(rover, a, b):
    pivots = np.array([wheel.pivot_velocity(np.asarray(a) - b) for wheel in rover.wheels])
    return math.sqrt(np.mean(np.sum(pivots**2, axis=1)))


def admissible_edges(rover):
    """Directions (vx, 0, omega) at which turns become possible, by bisection between samples."""

    def direction(angle):
        return np.array([math.cos(angle), 0.0, math.sin(angle)])

    angles = np.linspace(-math.pi / 2, math.pi / 2, 181)
    possible = rover.admissible([direction(angle) for angle in angles])
    edges = []
    for k in np.flatnonzero(possible[1:] != possible[:-1]):
        inside, outside = (angles[k], angles[k + 1]) if possible[k] else (angles[k + 1], angles[k])
        for _ in range(45):
            middle = (inside + outside) / 2.0
            inside, outside = (middle, outside) if rover.admissible(direction(middle)) else (inside, middle)
        edges.append(direction(inside))
    return edges


@settings(deadline=None)
@given(rovers, limits, twists)
def test_projection_is_the_nearest(rover, limit, twist):
    rover = Rover.six_wheel(
        front_to_middle=rover.wheels[0].x,
        middle_to_rear=0.5,
        track_width=0.8,
        middle_track_width=0.9,
        wheel_radius=0.15,
        steering_limit=limit,
    )
    nearest = rover.project(twist, keep="nearest")
    assert rover.admissible(nearest)
    for edge in admissible_edges(rover):
        change = np.array([wheel.pivot_velocity(edge) for wheel in rover.wheels]).ravel()
        wanted = np.array([wheel.pivot_velocity(twist) for wheel in rover.wheels]).ravel()
        best = edge * (change @ wanted) / (change @ change)
        # slip tolerance
        assert pivot_change(rover, nearest, twist) <= pivot_change(rover, best, twist) + 1e-8
        for keep, k in (("speed", 0), ("yaw_rate", 2)):
            if abs(edge[k]) > 1e-3:
                kept = rover.project(twist, keep=keep)
                assert kept[k] == twist[k]
                edge_kept = edge * twist[k] / edge[k]
                assert pivot_change(rover, kept, twist) <= pivot_change(rover, edge_kept, twist) + 1e-5


@settings(deadline=None)
@given(limits, twists, st.integers(0, 2**32 - 1))
def test_projection_of_a_swerve_has_no_better_neighbour(limit, twist, seed):
    rover = swerve(limit)
    nearest = rover.project(twist, keep="nearest")
    assert rover.admissible(nearest)
    least = pivot_change(rover, nearest, twist)
    steps = np.random.default_rng(seed).normal(size=(60, 3)) * np.repeat([[1.0], [0.1], [1e-3]], 20, axis=0)
    better = [q for q in nearest + steps if pivot_change(rover, q, twist) < least - 1e-8]
    assert not any(rover.admissible(q) for q in better)


@settings(deadline=None)
@given(rovers, limits, twists)
def test_projection_keeps_what_it_says(rover, limit, twist):
    rover = Rover.six_wheel(**SIX_SIZES | {"middle_to_rear": rover.wheels[0].x}, steering_limit=limit)
    asked = admissible_twist(twist[0], twist[2])
    found = rover.project(twist)
    assert rover.admissible(found)
    if rover.admissible(asked):
        np.testing.assert_allclose(found, asked, rtol=0, atol=1e-8)  # the twist itself within slip tolerance
    assert np.all(np.abs(found) <= np.abs(asked) + 1e-8)  # neither speed nor yaw rate grows: slip tolerance
    np.testing.assert_array_equal(rover.project(found), found)


@given(rovers, limits)
def test_radii_are_the_edges_of_the_possible_turns(rover, limit):
    rover = Rover.six_wheel(**SIX_SIZES | {"middle_to_rear": rover.wheels[0].x}, steering_limit=limit)
    depth = max(rover.wheels[0].x, -rover.wheels[4].x)
    assert rover.min_radius == pytest.approx(0.4 + depth / math.tan(limit), rel=1e-9)
    assert rover.spin_radius == pytest.approx(max(0.0, 0.4 - depth / math.tan(limit)), abs=1e-9)
