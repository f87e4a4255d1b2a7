"""The core against `six_wheel.reference`, which shares no code with it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel import reference
from tests.strategies import any_twists, forward_twists, layouts, six_wheel_rovers


def twin(rover: sw.Rover) -> reference.Rover:
    return reference.Rover.like(rover)


def assert_same_commands(rover, ours, theirs):
    """Equal up to rounding, and up to the choice between two angles that are equally near."""
    for (steering, speeds), other in ((ours, theirs), (theirs, ours)):
        assert np.shape(steering) == np.shape(other[0])
        assert np.shape(speeds) == np.shape(other[1])
    tie = np.abs(np.abs(ours[0] - theirs[0]) - math.pi) < 1e-9
    np.testing.assert_allclose(np.where(tie, theirs[0], ours[0]), theirs[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(np.abs(ours[1]), np.abs(theirs[1]), rtol=1e-12, atol=1e-12)


@given(layouts(offset=True), any_twists(), st.floats(-2, 2))
def test_inverse(rover, twist, rate):
    twist = rover.project(twist)
    rates = np.full(len(rover.steered_wheel_names), rate)
    for keywords in ({}, {"steering_rates": rates}):
        ours = rover.inverse(twist, **keywords)
        assert_same_commands(rover, ours, twin(rover).inverse(twist, **keywords))


@given(six_wheel_rovers(), forward_twists(), st.lists(st.floats(-2, 2), min_size=4, max_size=4))
def test_inverse_with_previous_angles(rover, twist, previous):
    ours = rover.inverse(twist, previous=previous)
    assert_same_commands(rover, ours, twin(rover).inverse(twist, previous=previous))


READINGS = st.lists(st.floats(-5, 5), min_size=6, max_size=6)
ANGLES = st.lists(st.floats(-2, 2), min_size=4, max_size=4)


@given(six_wheel_rovers(), ANGLES, READINGS, st.sampled_from(["least_squares", "middle_wheels"]))
def test_fit(rover, steering, speeds, method):
    ours = rover.fit(steering, speeds, method=method)
    theirs = twin(rover).fit(steering, speeds, method=method)
    # The smallest singular value of these rovers is above 0.1: errors grow tenfold at most.
    np.testing.assert_allclose(ours.twist, theirs.twist, rtol=0, atol=1e-11)
    np.testing.assert_allclose(ours.residuals, theirs.residuals, rtol=0, atol=1e-11)
    np.testing.assert_allclose(ours.sigma_min, theirs.sigma_min, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(ours.weights, theirs.weights)
    assert ours.rank == theirs.rank
    if method == "least_squares":
        np.testing.assert_array_equal(rover.forward(steering, speeds, level="scalar"), ours.twist)


@given(six_wheel_rovers(), forward_twists(), st.integers(0, 5), st.floats(-1, 1))
def test_robust_fit(rover, twist, wheel, fault):
    steering, speeds = rover.inverse(twist)
    speeds[wheel] *= 1 + fault
    ours = rover.fit(steering, speeds, method="robust")
    theirs = twin(rover).fit(steering, speeds, method="robust")
    np.testing.assert_allclose(ours.twist, theirs.twist, rtol=0, atol=1e-9)
    np.testing.assert_allclose(ours.weights, theirs.weights, rtol=0, atol=1e-8)


@given(
    six_wheel_rovers(st.floats(0.1, 1.7)),
    any_twists(),
    st.sampled_from(["curvature", "speed", "yaw_rate", "nearest"]),
)
def test_project(rover, twist, keep):
    ours, theirs = rover.project(twist, keep), twin(rover).project(twist, keep)
    if keep != "curvature":  # two may be equally near
        arms = [(w.x, w.y) for w in rover.wheels]

        def change(found):
            vx, vy, omega = np.subtract(found, twist)
            return math.sqrt(np.mean([(vx - omega * y) ** 2 + (vy + omega * x) ** 2 for x, y in arms]))

        assert change(ours) == pytest.approx(change(theirs), abs=1e-9)
    else:
        assert twin(rover).admissible(ours)
    np.testing.assert_array_equal(rover.admissible(twist), twin(rover).admissible(twist))


@given(six_wheel_rovers(st.floats(0.1, 1.7)))
def test_turning_limits(rover):
    assert rover.min_radius == pytest.approx(twin(rover).min_radius, rel=1e-9, abs=1e-9)
    assert rover.spin_radius == pytest.approx(twin(rover).spin_radius, rel=1e-9, abs=1e-9)


@given(st.floats(-0.3, 0.3), st.floats(0.2, 1.7), st.floats(-0.2, 0.2))
def test_turning_limits_of_wheels_with_trail(trail, limit, scrub):
    steered = {"radius": 0.1, "steered": True, "steering_limit": limit, "trail": trail, "scrub": scrub}
    wheels = [sw.Wheel("a", 0.5, 0.3, **steered), sw.Wheel("b", 0.5, -0.3, **steered)]
    rover = sw.Rover([*wheels, sw.Wheel("c", 0, 0.3, radius=0.1), sw.Wheel("d", 0, -0.3, radius=0.1)])
    assert rover.min_radius == pytest.approx(twin(rover).min_radius, rel=1e-9, abs=1e-9)
    assert rover.spin_radius == pytest.approx(twin(rover).spin_radius, rel=1e-9, abs=1e-9)


@given(any_twists())
def test_icr(twist):
    rover = sw.Rover.preset("perseverance")
    np.testing.assert_array_equal(rover.icr(twist), twin(rover).icr(twist))


@given(st.lists(any_twists(), max_size=20), st.floats(1e-3, 5), any_twists())
def test_integrate(twists, dt, start):
    twists = np.reshape(twists, (-1, 3))
    ours = sw.integrate(twists, dt, start)
    np.testing.assert_allclose(ours, reference.integrate(twists, dt, start), rtol=0, atol=1e-11)
    each = np.full(len(twists), dt)
    np.testing.assert_array_equal(ours, sw.integrate(twists, each, start))


@given(st.lists(any_twists(), min_size=2, max_size=20), st.floats(1e-3, 5))
def test_differentiate(poses, dt):
    ours, theirs = sw.differentiate(poses, dt), reference.differentiate(poses, dt)
    np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12)


@given(any_twists(), st.floats(1e-3, 2))
def test_exp_and_log(twist, dt):
    np.testing.assert_allclose(sw.exp(twist, dt), reference.exp(twist, dt), rtol=0, atol=1e-13)
    np.testing.assert_allclose(sw.log(twist, dt), reference.log(twist, dt), rtol=1e-12, atol=1e-12)


@given(st.floats(-1e6, 1e6))
def test_wrap_angle(angle):
    assert sw.wrap_angle(angle) == pytest.approx(reference.wrap_angle(angle), abs=1e-15)


@pytest.mark.parametrize("limit", [0.6, 1.2, 1.6, 1.9, 2.2])
@pytest.mark.parametrize("trail", [0.02, -0.03, 0.1])
def test_turning_radii_with_a_trail_are_those_of_brute_force(trail: float, limit: float) -> None:
    # Once the reference knew no ends of ranges of half a turn and more: 0.19 where 0.16 is right.
    corners = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)]
    middle = [sw.Wheel("left", 0.0, 0.45, radius=0.15), sw.Wheel("right", 0.0, -0.45, radius=0.15)]
    steered = [
        sw.Wheel(f"corner {k}", x, y, radius=0.15, steered=True, trail=trail, steering_limit=limit)
        for k, (x, y) in enumerate(corners)
    ]
    rover = sw.Rover(steered + middle)
    assert twin(rover).spin_radius == pytest.approx(rover.spin_radius, rel=1e-9)
    assert twin(rover).min_radius == pytest.approx(rover.min_radius, rel=1e-9)
    radii = np.arange(0.0005, 3.0, 0.001)
    turns = np.stack([radii, np.zeros_like(radii), np.ones_like(radii)], axis=1)
    possible = rover.admissible(turns) & rover.admissible(turns * [-1.0, 1.0, 1.0])
    if possible.all():
        assert (rover.spin_radius, rover.min_radius) == (np.inf, 0.0)
    else:
        assert radii[np.argmin(possible)] == pytest.approx(rover.spin_radius, abs=0.001)
        assert radii[len(radii) - 1 - np.argmin(possible[::-1])] == pytest.approx(rover.min_radius, abs=0.001)
