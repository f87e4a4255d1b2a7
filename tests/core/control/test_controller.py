"""The controller: limits, one centre of rotation, reasons, faults, and the slow way to the same results.

The laws over a million random steps are in `rust/control/tests/controller`.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel import _core, reference
from six_wheel.kinematics.controller import Reason
from six_wheel.reference.control import controller as slow
from tests.core.control.controlled import ALL, LIMITS, ROVER, drive, shot
from tests.limits import only
from tests.strategies import any_twists, six_wheel_rovers


def scrub(rover: sw.Rover, out: sw.ControllerOutput) -> float:
    """The fastest sideways slip of a wheel [m/s]."""
    twin = reference.Rover.like(rover)
    angles = iter(out.steering)
    return max(
        abs(float(wheel.rows(next(angles) if wheel.steered else 0.0)[1] @ out.twist)) for wheel in twin.wheels
    )


def test_reasons_are_those_of_the_core():
    assert {reason.name: int(reason) for reason in Reason} == dict(_core.reason_bits())
    assert sw.Reason is Reason


def test_the_picture_of_the_readme():
    controller = sw.Controller(
        ROVER,
        sw.Limits(speed=1.0, acceleration=0.5, jerk=2.0, wheel_speed=8.0, steering_rate=1.0),
        timeout=0.5,
    )
    assert controller.command((0.5, 0.0, 0.3), 0.0) is True
    out = controller.step(0.0)
    assert out.steering.shape == (4,)
    assert out.wheel_speeds.shape == (6,)
    assert out.twist.shape == (3,)
    assert out.steering_rates.shape == (4,)
    assert isinstance(out.reasons, Reason)
    assert out.reasons & Reason.ALIGNING


@given(six_wheel_rovers(st.floats(0.3, 2.0)), st.lists(any_twists(), min_size=1, max_size=4))
def test_no_limit_is_exceeded(rover, twists):
    controller = sw.Controller(rover, LIMITS, timeout=None)
    log = drive(controller, 3.0, commands=[(75 * k, twist) for k, twist in enumerate(twists)])
    used = slow.excess(LIMITS, [shot(now, out) for now, out in log])
    assert max(used.values()) <= ALL, used
    assert max(scrub(rover, out) for _, out in log) < 1e-9


@given(six_wheel_rovers(st.floats(0.3, 2.0)), any_twists())
def test_every_output_is_what_the_inverse_says(rover, twist):
    controller = sw.Controller(rover, LIMITS, timeout=None)
    for _, out in drive(controller, 2.0, dt=0.05, commands=[(0, twist)]):
        if out.twist.any():
            steering, speeds = rover.inverse(out.twist, previous=out.steering)
            np.testing.assert_allclose(out.steering, steering, rtol=0, atol=1e-9)
            np.testing.assert_allclose(out.wheel_speeds, speeds, rtol=0, atol=1e-9)


@given(six_wheel_rovers(st.floats(0.3, 2.0)), any_twists())
def test_the_goal_is_that_of_the_slow_way(rover, twist):
    limits = only(speed=0.6, yaw_rate=0.5, lateral_acceleration=0.2, wheel_speed=4.0)
    controller = sw.Controller(rover, limits)
    controller.command(twist, 0.0)
    out = controller.step(0.0)
    expected, name = slow.saturated(reference.Rover.like(rover), limits, twist)
    np.testing.assert_allclose(out.twist, expected, rtol=0, atol=1e-9)
    if name is not None and not np.allclose(expected, rover.project(twist), rtol=1e-12, atol=0):
        assert out.reasons & Reason[name]
    if np.array_equal(out.twist, twist):
        assert not out.reasons
    # Slowed down, not bent.
    assert abs(out.twist[0] * rover.project(twist)[2] - out.twist[2] * rover.project(twist)[0]) < 1e-9


@given(
    st.floats(0, 1),
    st.floats(-0.3, 0.3),
    st.floats(0, 1),
    st.floats(0.3, 2),
    st.floats(0.3, 2),
    st.floats(0.5, 5),
    st.floats(0.001, 0.1),
)
def test_the_speed_is_that_of_the_slow_way(first, rate, second, slower, faster, jerk, dt):
    limits = sw.Limits(acceleration=faster, deceleration=slower, jerk=jerk)
    controller = sw.Controller(ROVER, limits, timeout=None)
    value = change = 0.0
    goals = [first] * 10 + [second] * 10
    for k, goal in enumerate(goals):
        controller.command((goal, 0, 0), k * dt)
        speed = controller.step(k * dt).twist[0]
        if k:
            value, change = slow.ramp(value, change, goal, (slower, faster), jerk, dt)
        assert speed == pytest.approx(value, abs=1e-7)


def test_a_turn_takes_at_most_twice_as_long_as_trying_each_step():
    limits = sw.Limits(acceleration=0.5, steering_rate=1.0)
    start, goal, dt = (0.3, 0.0, 0.0), (0.3, 0.0, 0.3), 0.01
    twin = reference.Rover.like(ROVER)
    stepper = slow.Stepper(twin, limits, np.array(start), *twin.inverse(start))
    count = 0
    while not np.allclose(stepper.twist, goal, atol=1e-9):
        stepper.step(goal, dt)
        count += 1
    controller = sw.Controller(ROVER, limits, timeout=None)
    drive(controller, 2.0, commands=[(0, start)])
    log = drive(controller, 4.0, start=2.0 + dt, commands=[(0, goal)])
    ours = next(k for k, (_, out) in enumerate(log) if np.allclose(out.twist, goal, atol=1e-9))
    assert ours <= 2 * count + 2


def test_straight_to_a_tight_turn_without_scrub():
    """A case in which joints on their own slip by 28.8 mm/s."""
    rover = sw.Rover.preset("open_source_rover")
    radius = max(0.6, rover.min_radius * 1.001)
    controller = sw.Controller(rover, sw.Limits(steering_rate=math.radians(60)), timeout=None)
    drive(controller, 0.2, dt=0.001, commands=[(0, (0.3, 0, 0))])
    log = drive(controller, 2.0, start=0.201, dt=0.001, commands=[(0, (0.3, 0, 0.3 / radius))])
    assert max(scrub(rover, out) for _, out in log) < 1e-12
    np.testing.assert_allclose(log[-1][1].twist, (0.3, 0, 0.3 / radius), rtol=1e-12)


def test_braking_keeps_the_curvature_and_the_angles():
    controller = sw.Controller(ROVER, LIMITS, timeout=0.5)
    log = drive(controller, 8.0, commands=[(0, (0.3, 0.0, 0.2)), (400, (0.0, 0.0, 0.0))])
    braking = [out for now, out in log if now >= 4.0]
    angles = braking[0].steering
    for out in braking:
        np.testing.assert_array_equal(out.steering, angles)
        assert abs(out.twist[0] * 0.2 - out.twist[2] * 0.3) < 1e-9
    assert controller.stopped


def test_a_spin_island_is_left_by_stopping():
    assert ROVER.spin_radius < ROVER.min_radius < math.inf
    controller = sw.Controller(ROVER, LIMITS, timeout=None)
    log = drive(controller, 8.0, commands=[(0, (0.3, 0, 0)), (200, (0, 0, 0.3))])
    reasons = [out.reasons for now, out in log if now >= 2.0]
    assert reasons[0] & Reason.SPIN_ISLAND
    assert any(reason & Reason.ALIGNING for reason in reasons)
    assert not reasons[-1]
    np.testing.assert_array_equal(log[-1][1].twist, (0, 0, 0.3))
    assert max(slow.excess(LIMITS, [shot(*pair) for pair in log]).values()) <= ALL


def test_a_stale_command_stops_the_rover_and_a_new_one_goes_on_without_a_jump():
    controller = sw.Controller(ROVER, LIMITS, timeout=0.3)
    log = []
    for k in range(6000):
        now = k * 0.001
        if now < 2.0 or now > 2.8:
            controller.command((0.4, 0.0, 0.1), now)
        log.append(shot(now, out := controller.step(now)))
        assert bool(out.reasons & Reason.STALE) == (2.3 < now <= 2.8), now
    assert np.linalg.norm(log[2799].twist) < 0.4
    np.testing.assert_allclose(log[-1].twist, (0.4, 0, 0.1))
    assert max(slow.excess(LIMITS, log).values()) <= ALL


@pytest.mark.parametrize(
    "bad", [(math.nan, 0, 0), (0.1, math.inf, 0), (0, 0, -math.inf), (1e308, 1e308, 1e308)]
)
def test_a_command_that_is_not_finite_is_ignored_and_the_last_one_ages(bad):
    controller = sw.Controller(ROVER, only(), timeout=0.5)
    controller.command((0.2, 0, 0), 0.0)
    assert not controller.step(0.0).reasons
    assert controller.command(bad, 0.1) is False
    out = controller.step(0.1)
    assert out.reasons == Reason.NOT_FINITE
    np.testing.assert_array_equal(out.twist, (0.2, 0, 0))
    for k in range(2, 6):
        controller.step(k * 0.1)
    assert controller.step(0.6).reasons & Reason.STALE
    controller.command((0.2, 0, 0), 0.6)
    assert not controller.step(0.7).reasons


def test_old_and_early_stamps():
    controller = sw.Controller(ROVER, only(), timeout=0.5)
    controller.command((0.2, 0, 0), 1.0)
    assert controller.command((0.4, 0, 0), 0.9) is False
    out = controller.step(1.0)
    assert out.reasons == Reason.OUT_OF_ORDER
    assert out.twist[0] == 0.2
    assert not controller.step(1.05).reasons
    # From the future: taken, but it ages from the step that sees it.
    controller.command((0.3, 0, 0), 1e9)
    assert controller.step(1.1).twist[0] == 0.3
    assert controller.command((0.1, 0, 0), 1.15) is True
    assert controller.step(1.15).twist[0] == 0.1
    # The same stamp again replaces.
    controller.command((0.2, 0, 0), 1.15)
    assert controller.step(1.16).twist[0] == 0.2


@pytest.mark.parametrize("stamp", [1.0, 0.5, math.nan, math.inf])
def test_a_clock_that_does_not_advance_is_an_error_without_effect(stamp):
    controller = sw.Controller(ROVER, LIMITS)
    controller.command((0.2, 0, 0), 1.0)
    controller.step(1.0)
    with pytest.raises(ValueError, match="^stamp must be"):
        controller.step(stamp)
    twin = sw.Controller(ROVER, LIMITS)
    twin.command((0.2, 0, 0), 1.0)
    twin.step(1.0)
    np.testing.assert_array_equal(controller.step(1.1).twist, twin.step(1.1).twist)
