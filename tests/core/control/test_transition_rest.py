"""Transitions from and to rest, and those in which the body or the modules lead."""

import numpy as np
import pytest

from six_wheel import profiles
from tests.core.control.transition_rovers import LEFT, OSR, RATE, ROVERS, STRAIGHT, largest


def test_from_rest_and_to_rest():
    limits = {"steering_rate": RATE, "acceleration": 0.5}
    away = profiles.icr_transition(OSR, (0, 0, 0), LEFT, **limits)
    assert [phase.action for phase in away.phases] == ["align", "drive"]
    assert away.stops == 0
    assert away.duration == pytest.approx(0.604 + 0.6, abs=1e-3)
    back = profiles.icr_transition(OSR, LEFT, (0, 0, 0), **limits)
    assert back.duration == pytest.approx(0.6)
    np.testing.assert_allclose(back.at(1.0).steering, OSR.inverse(LEFT)[0], rtol=0, atol=4e-16)
    still = profiles.icr_transition(OSR, LEFT, LEFT, **limits)
    assert still.duration == 0.0
    np.testing.assert_array_equal(still.at(0.0).twist, LEFT)


def test_without_a_limit_of_acceleration_a_change_of_speed_takes_no_time():
    plan = profiles.icr_transition(OSR, STRAIGHT, (0.5, 0, 0), steering_rate=RATE)
    assert plan.duration == 0.0
    np.testing.assert_array_equal(plan.at(-1e-9).twist, STRAIGHT)
    np.testing.assert_array_equal(plan.at(0.0).twist, (0.5, 0, 0))


def test_the_body_leads():
    plan = profiles.body_transition(OSR, STRAIGHT, LEFT, 1.0)
    times = np.linspace(0.0, 1.0, 201)
    state = plan.at(times)
    np.testing.assert_array_equal(state.twist[:, 2], profiles.s_curve(0.0, 0.5, 1.0).at(times).value)
    np.testing.assert_allclose(state.steering, OSR.inverse(state.twist)[0], rtol=1e-14, atol=1e-15)
    assert state.scrub.max() < 1e-14
    rates = np.gradient(state.steering, times, axis=0, edge_order=2)
    np.testing.assert_allclose(state.steering_rates, rates, atol=2e-2)
    accelerations = np.gradient(state.steering_rates, times, axis=0, edge_order=2)
    inside = np.abs(times[:, None] % 0.25 - 0.125) < 0.11  # off the jumps of the jerk
    np.testing.assert_allclose(
        np.where(inside, state.steering_accelerations, 0), np.where(inside, accelerations, 0), atol=0.1
    )
    limited = profiles.body_transition(OSR, STRAIGHT, LEFT, angular_acceleration=0.5)
    assert limited.duration == pytest.approx(1.0)
    jerky = profiles.body_transition(OSR, STRAIGHT, LEFT, angular_acceleration=0.5, angular_jerk=1.0)
    assert jerky.duration == pytest.approx(1.5)


def test_a_body_that_leads_past_a_steering_limit_scrubs():
    rover = ROVERS["limited"]
    state = profiles.body_transition(
        rover, (0.4, 0, 0.1), (0, 0, 0.5) if rover.spin_radius else (-0.4, 0, 0.1), 1.0
    )
    assert state.at(np.linspace(0, 1, 101)).scrub.max() > 1e-3


def test_modules_lead():
    start, end = OSR.inverse((0, 0, 0)), OSR.inverse((0, 0, 0.5))
    align = profiles.module_transition(
        OSR, start, (end[0], start[1]), steering_rate=RATE, steering_acceleration=4.0
    )
    assert align.duration == pytest.approx(largest(end[0]) / RATE + RATE / 4.0)
    state = align.at(np.linspace(0, align.duration, 51))
    assert state.scrub.max() == 0.0
    np.testing.assert_array_equal(state.twist, np.zeros((51, 3)))
    np.testing.assert_array_equal(state.steering[-1], end[0])
    timed = profiles.module_transition(OSR, start, end, 2.0, shape="trapezoid")
    np.testing.assert_allclose(timed.at(1.0).steering, end[0] / 2, atol=1e-15)
    np.testing.assert_allclose(timed.at(1.0).wheel_speeds, end[1] / 2, atol=1e-15)
    alone = profiles.module_transition(
        OSR, start, end, steering_rate=RATE, wheel_acceleration=1.0, synchronise="none"
    )
    assert alone.duration == pytest.approx(max(largest(end[1]), largest(end[0]) / RATE))
