"""Four axles on lockable pivots: brakes, turns under way, simulation."""

import copy
import dataclasses
import math
import re

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel import FourAxle, FourAxleState, FourAxleStep
from six_wheel.kinematics.four_axle import FourAxleSimulation, TurnSequence
from six_wheel.reference.control import four_axle as reference
from tests.core.control.four_axles import H_X, H_Y, LENGTH, RADIUS, cars, pivots_of
from tests.strategies import at_most

STRAIGHT = FourAxleState()
SLIP = 1e-9  # [m/s] what a plan may slip; rounding is 1e-15


def drive_through(car: FourAxle, plan: TurnSequence, start: FourAxleState) -> FourAxleSimulation:
    """Simulates a plan and checks what every plan promises."""
    result = car.simulate(plan, 0.02, state=start)
    if not plan.steps:
        return result
    assert result.residuals.max() < SLIP
    expected = plan.steps[-1].end
    np.testing.assert_allclose(result.final.steering, expected.steering, rtol=0, atol=1e-10)
    np.testing.assert_allclose(result.final.pose, expected.pose, rtol=0, atol=1e-10)
    for step in plan:
        both_free = step.front_brake == step.rear_brake == "free"
        assert not both_free or (step.duration == 0.0 and not any(step.wheel_speeds))
    assert (result.final.front_brake, result.final.rear_brake) == ("locked", "locked")
    assert car.mobility(result.final.steering).degree_of_mobility >= 1
    return result


def test_a_lock_that_would_freeze_the_robot_says_why_and_what_would_do(car):
    front = car.concurrent_angles((0.0, 1.0))[:2]
    state = FourAxleState((*front, -0.3, -0.3), rear_brake="free")
    before = copy.deepcopy(state)
    with pytest.raises(sw.InfeasibleMotionError, match="smallest singular value") as caught:
        car.lock(state, "rear")
    assert state == before
    left, right = map(float, re.findall(r"rear must be at \(([^,]+), ([^)]+)\)", str(caught.value))[0])
    # Six digits: the rear axles that meet where the front ones do.
    np.testing.assert_allclose((left, right), car.concurrent_angles((0.0, 1.0))[2:], atol=1e-6)
    locked = car.lock(dataclasses.replace(state, steering=(*front, left, right)), "rear")
    assert locked.rear_brake == "locked"


def test_beside_axles_in_line_the_remedy_is_the_nearest_turn(car):
    state = FourAxleState((0.0, 0.0, -0.3, -0.2), rear_brake="free")
    with pytest.raises(sw.InfeasibleMotionError) as caught:
        car.lock(state, "rear")
    remedy = tuple(map(float, re.findall(r"rear must be at \(([^,]+), ([^)]+)\)", str(caught.value))[0]))
    np.testing.assert_allclose(remedy, (-0.3, -0.2), atol=0.05)
    assert car.mobility((0, 0, *remedy)).slip < 1e-6


@pytest.mark.parametrize(("factor", "locks"), [(0.99, True), (1.01, False)])
def test_the_tolerance_has_two_sides(factor, locks):
    car = FourAxle((H_X, H_Y), LENGTH, RADIUS, tolerance=1e-4)
    # Largest askew angle of one axle, by bisection of the reference.
    angles = np.array(car.concurrent_angles((0.0, 1.0)))
    scale = np.array((1.0, 1.0, 1.0 / math.hypot(H_X, H_Y)))

    def slip(askew):
        rows = reference.side_slip_rows(pivots_of(car), np.add(angles, (0, 0, 0, askew)))
        return np.linalg.svd(rows * scale)[1][2] / 2

    low, high = 0.0, 0.01
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if slip(middle) < 1e-4 else (low, middle)
    state = FourAxleState(np.add(angles, (0, 0, 0, factor * low)), rear_brake="free")
    if locks:
        assert car.lock(state, "rear").rear_brake == "locked"
    else:
        with pytest.raises(sw.InfeasibleMotionError):
            car.lock(state, "rear")


def test_releasing_both_pairs_is_refused_where_the_body_would_be_adrift(car):
    state = car.release(STRAIGHT, "rear")
    assert (state.front_brake, state.rear_brake) == ("locked", "free")
    with pytest.raises(sw.InfeasibleMotionError, match="lock rear first"):
        car.release(state, "front")
    assert car.lock(state, "rear") == STRAIGHT
    assert car.lock(STRAIGHT, "rear") == STRAIGHT  # it is already


# Turning under way


@pytest.mark.slow
@at_most(40)
@given(
    cars(rigid=True), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.floats(0.05, 1.0), st.floats(0.1, 1.0)
)
def test_a_dual_differential_drive_turns_in_six_steps_without_a_stop(car, first, second, speed, rate):
    state = FourAxleState(car.concurrent_angles((0, 1 / first if first else np.inf)))
    plan = car.turn_sequence(state, second, speed=speed, pivot_rate=rate)
    assume(abs(first - second) > 1e-6)
    assert not plan.stops, plan.reason
    assert [step.action for step in plan] == [
        f"{action} {pair}" for pair in ("rear", "front") for action in ("free", "turn", "lock")
    ]
    result = drive_through(car, plan, state)
    np.testing.assert_allclose(result.final.steering, car.inverse((1, 0, second))[0], rtol=0, atol=1e-10)
    motion = car.mobility(result.final.steering).motion[0]
    np.testing.assert_allclose(motion[2] / motion[0], second, rtol=0, atol=1e-9)
    # It never stands, and after every lock all four wheels roll.
    pivot_speeds = np.hypot(*result.twists[:, :2].T) + np.abs(result.twists[:, 2]) * car.pivots[0]
    assert pivot_speeds.min() > 0.05 * speed


@at_most(40)
@given(cars(), st.floats(-1.2, 1.2), st.floats(0.05, 1.0), st.sampled_from(("front", "rear")))
def test_hinged_axles_turn_one_pair_under_way(car, curvature, speed, steer):
    assume(abs(curvature) * (car.pivots[1] + car.axle_length) < 0.7)
    plan = car.turn_sequence(STRAIGHT, curvature, speed=speed, steer=steer, pivot_rate=0.5)
    assert not plan.stops, plan.reason
    result = drive_through(car, plan, STRAIGHT)
    abreast = car.pivots[0] if steer == "rear" else -car.pivots[0]
    if abs(curvature) > 1e-6:
        motion = car.mobility(result.final.steering).motion[0]
        np.testing.assert_allclose(motion[2] * abreast + motion[1], 0, atol=1e-9)
        np.testing.assert_allclose(motion[2] / motion[0], curvature, rtol=0, atol=1e-9)


def test_from_rear_to_front_steering_and_back(car):
    rear = car.turn_sequence(STRAIGHT, 0.8, speed=0.5, steer="rear").steps[-1].end
    plan = car.turn_sequence(rear, 0.8, speed=0.5, steer="front")
    assert (plan.stops, plan.reason) == (False, "")
    assert [step.action for step in plan][1::3] == ["turn rear", "turn front"]
    np.testing.assert_allclose(plan.steps[2].end.steering, 0, atol=1e-12)  # in between, straight ahead
    drive_through(car, plan, rear)
    front = plan.steps[-1].end
    back = car.turn_sequence(front, -0.8, speed=0.5, steer="rear")
    assert [step.action for step in back][1::3] == ["turn front", "turn rear"]
    drive_through(car, back, front)


def test_a_swing_too_wide_for_its_speed_goes_by_way_of_straight_ahead():
    car = FourAxle((0.73, 0.0), 0.3, RADIUS)
    state = FourAxleState((-1.32, -1.32, 1.37, 1.37))
    x = 0.73 * (1 + 2 * math.tan(-1.07) / (math.tan(-1.33) - math.tan(-1.07)))
    y = 2 * 0.73 / (math.tan(-1.07) - math.tan(-1.33))
    plan = car.aim_sequence(state, (x, y), speed=0.5)
    assert not plan.stops
    assert "no constant speeds" in plan.reason
    assert len(plan) == 12
    drive_through(car, plan, state)


def test_hinged_axles_cannot_turn_about_a_point_abreast_of_the_middle_without_a_stop(car):
    # Front locked straight ahead: its line is x = h_x, the target is not on it: re-aimed rear axles freeze.
    target = car.concurrent_angles((0.0, 1.0))
    frozen = car.mobility((0, 0, *target[2:]))
    assert frozen.degree_of_mobility == 0
    assert frozen.slip > 0.03  # 38 mm per metre driven
    plan = car.turn_sequence(STRAIGHT, 1.0, speed=0.5)
    assert plan.stops
    assert "no point in common" in plan.reason
    assert [step.action for step in plan] == [
        "stop", "free rear", "turn rear", "free front", "lock rear", "turn front", "lock front",
    ]  # fmt: skip
    result = drive_through(car, plan, STRAIGHT)
    np.testing.assert_allclose(result.poses, 0, atol=1e-14)  # it stood
    np.testing.assert_allclose(result.final.steering, target, rtol=0, atol=1e-12)


@at_most(40)
@given(cars(), st.floats(-2, 2), st.floats(-2, 2), st.floats(-2, 2), st.floats(-2, 2))
def test_standing_every_point_can_be_aimed_at_from_every_other(car, x, y, next_x, next_y):
    for point in ((x, y), (next_x, next_y)):
        assume(np.hypot(*(pivots_of(car) - point).T).min() > 1e-2)
    state = FourAxleState(car.concurrent_angles((x, y)))
    plan = car.aim_sequence(state, (next_x, next_y), pivot_rate=0.7)
    result = drive_through(car, plan, state)
    np.testing.assert_allclose(result.poses, 0, atol=1e-12)
    assert np.abs(np.diff(result.steering, axis=0)).max(initial=0.0) <= 0.7 * 0.02 * (1 + 1e-9)


def test_spinning_in_place(car):
    plan = car.aim_sequence(STRAIGHT, (0.0, 0.0))
    aimed = plan.steps[-1].end
    result = car.simulate((*plan, car.drive(aimed, 0.5, math.pi)), 0.05)
    assert result.residuals.max() < SLIP
    np.testing.assert_allclose(result.final.pose, (0, 0, math.pi), atol=1e-13)  # pivots 0.5 m away at 0.5 m/s


def test_changing_the_rear_speeds_alone_would_slip(tandem):
    # The front wheels as they were hold the robot on its course, and the rear axle, turned, drags across it.
    naive = FourAxleStep("turn rear", 0.6, "locked", "free", (5.0, 5.0, 6.5, 3.5))
    assert tandem.simulate([naive], 0.05).residuals.max() > 0.05
    planned = tandem.turn_sequence(STRAIGHT, 1.0, speed=0.5).steps[1]
    assert planned.wheel_speeds[:2] == (None, None)
    np.testing.assert_allclose(planned.wheel_speeds[2:], naive.wheel_speeds[2:], rtol=1e-12)
    assert tandem.simulate([planned], 0.05).residuals.max() < SLIP


def test_speeds_that_follow_can_be_fed_to_the_drives(tandem):
    plan = tandem.turn_sequence(STRAIGHT, 1.0, speed=0.5)
    result = tandem.simulate(plan, 0.01)
    row = result.ends[1] - 3
    state, speeds = result.steering[row], result.wheel_speeds[row]
    fed = tandem.forward(state, speeds, rear_brake="free")
    np.testing.assert_allclose(fed.twist, result.twists[row], rtol=0, atol=1e-12)
    assert fed.residuals.max() < SLIP


# Simulation


@given(
    st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.1, 1.0), st.floats(-0.8, 0.8), st.floats(0.1, 0.5)
)
def test_a_free_rear_axle_follows_the_closed_form(front, rear, speed, turning, time):
    car = FourAxle((H_X, 0.0), 0.3, RADIUS)
    angle, pose = reference.tandem(H_X, front, rear, speed, turning, time)
    assume(abs(angle) < 1.5)
    difference = 0.3 * turning
    speeds = (None, None, (speed - difference) / RADIUS, (speed + difference) / RADIUS)
    start = FourAxleState((front, front, rear, rear), rear_brake="free")
    result = car.simulate([FourAxleStep("turn", time, "locked", "free", speeds)], time / 3, state=start)
    np.testing.assert_allclose(result.final.steering, (front, front, angle, angle), rtol=0, atol=1e-11)
    np.testing.assert_allclose(result.final.pose, pose, rtol=0, atol=1e-11)


@pytest.mark.slow
@at_most(15)
@given(st.floats(0.2, 0.8), st.floats(-0.1, 0.1), st.floats(0.2, 1.0))
def test_free_hinged_axles_follow_the_reference(speed, difference, time):
    car = FourAxle((H_X, H_Y), LENGTH, RADIUS)
    rims = (speed - difference, speed + difference)
    angles, pose = reference.rear_steering(H_X, H_Y, LENGTH, rims, time)
    assume(np.abs(angles).max() < 1.2)
    step = FourAxleStep("turn", time, "locked", "free", (None, None, rims[0] / RADIUS, rims[1] / RADIUS))
    result = car.simulate([step], 0.1)
    # the reference's own step
    np.testing.assert_allclose(result.final.steering[2:], angles, rtol=0, atol=1e-9)
    np.testing.assert_allclose(result.final.pose, pose, rtol=0, atol=1e-9)
    assert result.residuals.max() < SLIP


@at_most(20)
@given(cars(), st.floats(-0.6, 0.6), st.floats(0.1, 0.8))
def test_half_steps_make_whole_ones(car, curvature, speed):
    plan = car.turn_sequence(STRAIGHT, curvature, speed=speed, steer="rear", brake_time=0.3)
    halves = [
        dataclasses.replace(step, duration=step.duration / 2)
        for step in plan
        for _ in range(2 if step.duration else 1)
    ]
    whole, half = car.simulate(plan, 10.0), car.simulate(halves, 0.03)
    np.testing.assert_allclose(half.final.pose, whole.final.pose, rtol=0, atol=1e-10)
    np.testing.assert_allclose(half.final.steering, whole.final.steering, rtol=0, atol=1e-10)


def test_locked_driving_is_an_arc(car):
    state = FourAxleState(car.concurrent_angles((0.0, 1.0)))
    step = car.drive(state, -0.5, 2.0)
    result = car.simulate([step], 0.5, state=state)
    assert result.final == step.end
    omega = result.twists[0, 2]
    assert omega < 0
    arc = (math.sin(2 * omega), 1 - math.cos(2 * omega), 2 * omega)
    np.testing.assert_allclose(result.final.pose, arc, rtol=0, atol=1e-13)


def test_a_motion_is_the_same_far_from_the_origin(tandem):
    plan = tandem.turn_sequence(STRAIGHT, 1.0, speed=0.5)
    near = tandem.simulate(plan, 0.1).final.pose
    far = tandem.simulate(plan, 0.1, state=FourAxleState(pose=(1e6, -1e6, 0.0))).final.pose
    np.testing.assert_allclose(np.subtract(far, (1e6, -1e6, 0.0)), near, rtol=0, atol=1e-8)  # ulps of 1e6 m
