"""Four axles on lockable pivots: laws, the reference, section 6 of the models, what must be refused."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel import FourAxle, FourAxleState
from six_wheel.reference.control import four_axle as reference
from tests.core.control.four_axles import H_X, H_Y, LENGTH, RADIUS, cars, pivots_of

angles_in_range = st.tuples(*[st.floats(-1.5, 1.5)] * 4)
small_speeds = st.floats(-3.0, 3.0)


# Section 6


@given(
    st.tuples(small_speeds, small_speeds, small_speeds),
    angles_in_range,
    st.tuples(*[small_speeds] * 4),
    st.tuples(small_speeds, small_speeds, small_speeds),
)
def test_the_wheel_end_of_a_pivoting_axle_moves_as_the_wheel_equation_says(twist, angles, rates, pose):
    pivots = reference.pivot_points(H_X, H_Y)
    dt = 1e-5

    def ends(time):
        end = sw.compose(
            pose, sw.exp(twist, abs(time)) if time > 0 else sw.exp(np.negative(twist), abs(time))
        )
        return reference.wheel_ends(pivots, LENGTH, end, np.add(angles, np.multiply(rates, time)))

    yaw = pose[2]
    to_body = np.array(((np.cos(yaw), np.sin(yaw)), (-np.sin(yaw), np.cos(yaw))))
    moved = (ends(dt) - ends(-dt)) / (2 * dt) @ to_body.T
    said = reference.wheel_end_velocities(pivots, LENGTH, twist, angles, rates)
    # dt^2 times a jerk of 1e2 to 1e3, and 1e-16 / dt
    np.testing.assert_allclose(said, moved, rtol=0, atol=1e-7)

    # The core's own rows, through the wheel equation with steering rates.
    rover = FourAxle((H_X, H_Y), LENGTH, RADIUS).rover
    e, n = reference.headings(angles)
    speeds = np.sum(e * said, axis=1) / RADIUS
    fit = rover.fit(angles, speeds, steering_rates=rates)
    across = np.sum(n * said, axis=1)
    rows = reference.side_slip_rows(pivots, angles)
    np.testing.assert_allclose(rows @ twist, across, rtol=0, atol=1e-12)
    if np.abs(across).max() == 0.0:
        np.testing.assert_allclose(fit.twist, twist, rtol=0, atol=1e-9)


def test_the_turning_of_the_body_counts_in_the_rim_speed(car):
    # Spinning with locked axles: without omega the rims would be too slow, 0.5 m/s in place of 0.7.
    angles, speeds = car.inverse((0.0, 0.0, 1.0))
    e, _ = reference.headings(angles)
    without = np.sum(e * reference.pivot_velocities(pivots_of(car), (0, 0, 1)), axis=1)
    np.testing.assert_allclose(np.abs(without), 0.5, rtol=1e-14)
    np.testing.assert_allclose(np.abs(speeds * RADIUS), 0.7, rtol=1e-14)


def test_equal_angles_left_and_right_lock_the_robot(car):
    mobility = car.mobility((0.2, 0.2, -0.2, -0.2))
    assert (mobility.rank, mobility.degree_of_mobility) == (3, 0)
    assert mobility.motion.shape == (0, 3)
    np.testing.assert_allclose(mobility.singular_values, (1.960, 0.885, 0.053), atol=5e-4)
    assert mobility.margin < 0


def test_angles_that_differ_as_the_wheel_equation_says_do_not(car):
    np.testing.assert_allclose(car.concurrent_angles((0, 1)), (0.5191, 0.2985, -0.5191, -0.2985), atol=5e-5)
    mobility = car.mobility(car.concurrent_angles((0, 1)))
    assert (mobility.rank, mobility.degree_of_mobility) == (2, 1)
    np.testing.assert_allclose(mobility.singular_values, (1.826, 1.153, 0), atol=5e-4)
    np.testing.assert_allclose(car.rover.icr(mobility.motion[0]), (0, 1), atol=1e-12)
    np.testing.assert_allclose(mobility.margin, 1e-3, atol=1e-12)


def test_spinning_straight_and_crab(car):
    np.testing.assert_allclose(
        np.degrees(car.concurrent_angles((0, 0))), (-53.130102, 53.130102, 53.130102, -53.130102), atol=1e-6
    )
    np.testing.assert_array_equal(car.concurrent_angles((0, np.inf)), np.zeros(4))
    np.testing.assert_array_equal(car.concurrent_angles((7, -np.inf)), np.zeros(4))
    np.testing.assert_allclose(np.abs(car.concurrent_angles((np.inf, 0))), np.pi / 2, rtol=1e-15)
    assert car.concurrent_angles(np.zeros((2, 3, 2))).shape == (2, 3, 4)


def test_a_dual_differential_drive_has_one_angle_per_axle(tandem):
    angles = tandem.concurrent_angles((0, 1))
    np.testing.assert_allclose(angles, np.arctan((H_X, H_X, -H_X, -H_X)), rtol=1e-14)
    for front, rear in ((0.2, -0.7), (0.3, 0.3), (-1.0, 1.2)):
        assert tandem.mobility((front, front, rear, rear)).degree_of_mobility == 1
    # Both axle lines along the body: it moves sideways or turns about any point of that line.
    sideways = tandem.mobility((math.pi / 2, math.pi / 2, -math.pi / 2, -math.pi / 2))
    assert (sideways.rank, sideways.degree_of_mobility, sideways.motion.shape) == (1, 2, (2, 3))
    with pytest.raises(ValueError, match="one motion"):
        tandem.drive(FourAxleState(steering=(math.pi / 2,) * 4), 0.5, 1.0)


# Velocities


@given(cars(), st.tuples(small_speeds, small_speeds, small_speeds))
def test_inverse_then_forward_is_the_identity(car, twist):
    angles, speeds = car.inverse(twist)
    found = car.forward(angles, speeds)
    # An angle up to 1e-9 rad beyond its range is the end of the range: (0, 1, 1e-9) failed here once. The
    # wheel then slides by 1e-9 of its speed, and the yaw rate is off by that over the shortest lever, 0.05 m.
    at_end = np.abs(angles) == math.pi / 2
    slip = 1e-9 * car.wheel_radius * np.max(np.abs(speeds) * at_end)
    np.testing.assert_allclose(found.twist, twist, rtol=0, atol=1e-10 + slip / 0.05)
    assert found.residuals.max() < 1e-11 + slip


@given(cars(), angles_in_range, st.tuples(*[st.floats(-10.0, 10.0)] * 4))
def test_locked_axles_are_a_rover(car, angles, speeds):
    fit = car.rover.fit(angles, speeds)
    assume(fit.sigma_min > 1e-3)
    found = car.forward(angles, speeds)
    scale = 1e-11 / fit.sigma_min
    # Scrub and side slip weigh alike in both, whatever unit the yaw rate is counted in.
    np.testing.assert_allclose(found.twist, fit.twist, rtol=0, atol=100 * scale)
    np.testing.assert_allclose(found.residuals, fit.residuals, rtol=0, atol=100 * scale)


@given(angles_in_range, st.tuples(*[st.floats(-10.0, 10.0)] * 4), st.sampled_from(("front", "rear")))
def test_free_axles_agree_with_the_reference(angles, speeds, pair):
    car = FourAxle((H_X, H_Y), LENGTH, RADIUS)
    free = np.array((1, 1, 0, 0) if pair == "front" else (0, 0, 1, 1), dtype=bool)
    twist, rates, slip = reference.forward(pivots_of(car), LENGTH, angles, RADIUS * np.array(speeds), free)
    found = car.forward(angles, speeds, **{f"{pair}_brake": "free"})
    np.testing.assert_allclose(found.twist, twist, rtol=0, atol=1e-10)
    np.testing.assert_allclose(found.pivot_rates, rates, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.residuals, slip, rtol=0, atol=1e-10)


@given(cars(), st.floats(0.2, 5.0), st.floats(-5.0, 5.0))
def test_speed_differences_turn_a_free_axle(car, radius, difference):
    # At rest: the front wheels hold the body, each rear wheel walks around its own pivot.
    angles = car.concurrent_angles((0, radius))
    found = car.forward(angles, (0, 0, difference, -difference), rear_brake="free")
    rate = difference * car.wheel_radius / car.axle_length
    np.testing.assert_allclose(found.pivot_rates, (0, 0, -rate, -rate), rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.twist, 0, atol=1e-10)


@given(cars(), st.floats(-1.0, 1.0), st.floats(0.1, 2.0), st.floats(-2.0, 2.0))
def test_a_free_pivot_obeys_the_rolling_row(car, curvature, speed, difference):
    # The rear of a rear-steered curve, its wheels driven, those in front following.
    h_x, h_y = car.pivots
    assume(abs(curvature) * h_y < 0.8)
    twist = np.array((1.0, -h_x * curvature, curvature))
    angles, speeds = car.inverse(speed * twist)
    driven = np.add(speeds[2:], (difference, -difference))
    found = car.forward(angles, (None, None, *driven), rear_brake="free")
    assert found.residuals.max() < 1e-9
    e, _ = reference.headings(angles)
    along = np.sum(e * reference.pivot_velocities(pivots_of(car), found.twist), axis=1)
    scrub = car.axle_length * reference.SIDES
    rates = (along - car.wheel_radius * found.wheel_speeds) / scrub - found.twist[2]
    np.testing.assert_allclose(found.pivot_rates, rates, rtol=0, atol=1e-9)
    # The axle lines go on to share a point: second order in the time, where they would part in first order.
    later = car.mobility(angles + 1e-4 * found.pivot_rates).slip
    assert later < 1e-6 * (1 + np.abs(found.pivot_rates).max() ** 2)


def test_wheels_that_say_too_little_are_named(car):
    with pytest.raises(sw.UnderdeterminedError, match="speeds must determine"):
        car.forward(np.zeros(4), (None, None, None, None))
    with pytest.raises(sw.UnderdeterminedError, match=r"\(6 of 7 unknowns"):
        car.forward(np.zeros(4), (1, 1, 1, 1), front_brake="free", rear_brake="free")


# Mobility and brakes


@given(cars(), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_concurrent_axles_leave_the_turn_about_their_point(car, x, y):
    assume(np.hypot(*(pivots_of(car) - (x, y)).T).min() > 1e-3)
    angles = car.concurrent_angles((x, y))
    offset = np.array(angles) - reference.concurrent_angles(pivots_of(car), (x, y))
    np.testing.assert_allclose(np.sin(offset), 0, atol=1e-12)
    mobility = car.mobility(angles)
    rows = reference.side_slip_rows(pivots_of(car), angles)
    np.testing.assert_allclose(mobility.singular_values, np.linalg.svd(rows)[1], rtol=0, atol=1e-14)
    assert mobility.slip < 1e-14
    assert mobility.degree_of_mobility >= 1
    if mobility.degree_of_mobility == 1:
        assert mobility.motion[0] @ mobility.motion[0] > 0
        np.testing.assert_allclose(rows @ mobility.motion[0], 0, atol=1e-13)
        speeds = reference.pivot_velocities(pivots_of(car), mobility.motion[0])
        np.testing.assert_allclose(np.mean(np.sum(speeds**2, axis=1)), 1.0, rtol=1e-12)


@given(cars(), angles_in_range)
def test_at_any_angles_both_pairs_can_be_locked_or_both_free_but_not_either(car, angles):
    state = FourAxleState(angles, front_brake="locked", rear_brake="free")
    locks = frees = True
    try:
        car.lock(state, "rear")
    except sw.InfeasibleMotionError:
        locks = False
    try:
        car.release(state, "front")
    except sw.InfeasibleMotionError:
        frees = False
    assert locks != frees
    assert locks == (car.mobility(angles).margin >= 0)
