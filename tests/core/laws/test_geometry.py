"""Twists and poses: laws, then cases a person can check."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from tests.strategies import any_twists

POSES = any_twists()
TIMES = st.floats(0.01, 1.0)


@given(any_twists(), TIMES)
def test_log_undoes_exp(twist, dt):
    # Up to 3 rad in one step: the short way round is the way it went.
    np.testing.assert_allclose(sw.log(sw.exp(twist, dt), dt), twist, rtol=1e-12, atol=1e-12)


@given(any_twists(), TIMES)
def test_two_half_steps_make_one(twist, dt):
    whole, halves = sw.integrate([twist], dt), sw.integrate([twist, twist], dt / 2)
    np.testing.assert_allclose(halves[-1], whole[-1], rtol=0, atol=1e-13)  # [m, m, rad], rounding only


@given(any_twists(), TIMES)
def test_the_icr_stands_still(twist, dt):
    rover = sw.Rover.preset("perseverance")
    icr = rover.icr(twist)
    if np.isfinite(icr).all():
        x, y, yaw = sw.exp(twist, dt)
        turned = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]) @ icr
        np.testing.assert_allclose(turned + np.array([x, y]), icr, rtol=1e-12, atol=1e-12)


@given(st.lists(any_twists(), min_size=1, max_size=30), st.floats(0.01, 0.9), POSES)
def test_differentiate_undoes_integrate(twists, dt, start):
    poses = sw.integrate(twists, dt, start)
    np.testing.assert_allclose(sw.differentiate(poses, dt), twists, rtol=0, atol=1e-10)


@given(POSES, POSES, POSES)
def test_composition_is_associative(a, b, c):
    left = sw.compose(sw.compose(a, b), c)
    np.testing.assert_allclose(left, sw.compose(a, sw.compose(b, c)), rtol=0, atol=1e-13)


@given(st.lists(any_twists(), min_size=1, max_size=10), TIMES, POSES)
def test_a_log_started_elsewhere_is_the_same_log_moved(twists, dt, start):
    here, there = sw.integrate(twists, dt), sw.integrate(twists, dt, start)
    moved = sw.compose(np.broadcast_to(start, here.shape), here)
    np.testing.assert_allclose(there, moved, rtol=0, atol=1e-12)


def test_quarter_circle():
    poses = sw.integrate([(1.0, 0.0, math.pi / 2)], 1.0)
    np.testing.assert_allclose(poses[1], (2 / math.pi, 2 / math.pi, math.pi / 2), rtol=1e-15)


def test_straight_spin_and_crab():
    np.testing.assert_array_equal(sw.exp((2.0, 0.0, 0.0), 0.5), (1.0, 0.0, 0.0))
    np.testing.assert_array_equal(sw.exp((0.0, 0.0, 2.0), 0.5), (0.0, 0.0, 1.0))
    np.testing.assert_array_equal(sw.exp((0.0, 2.0, 0.0), 0.5), (0.0, 1.0, 0.0))


@pytest.mark.parametrize("omega", [0.0, 5e-324, 1e-300, 1e-17, 1e-9, 1e-8, 1e-7, 1e-3])
def test_nothing_cancels_as_the_turn_vanishes(omega):
    x, y, yaw = sw.exp((1.0, 0.0, omega))
    assert x == pytest.approx(1 - omega**2 / 6, rel=1e-15)
    assert y == pytest.approx(omega / 2 - omega**3 / 24, rel=1e-12)
    assert yaw == omega
    np.testing.assert_allclose(sw.log((x, y, yaw)), (1.0, 0.0, omega), rtol=1e-15, atol=1e-16)


def test_yaw_keeps_its_turns_and_wrap_takes_them_out():
    poses = sw.integrate(np.tile([0.0, 0.0, 1.0], (10, 1)), 1.0)
    assert poses[-1, 2] == 10.0
    assert sw.wrap_angle(10.0) == pytest.approx(10.0 - 4 * math.pi)
    np.testing.assert_allclose(sw.wrap_angle(poses[:, 2]), np.angle(np.exp(1j * poses[:, 2])), atol=1e-14)
    assert sw.wrap_angle(math.pi) == math.pi
    assert sw.wrap_angle(-math.pi) == -math.pi


def test_many_logs_in_one_call():
    generator = np.random.default_rng(1)
    twists, starts = generator.normal(size=(2, 4, 7, 3)), generator.normal(size=(2, 4, 3))
    poses = sw.integrate(twists, np.full(7, 0.1), starts)
    assert poses.shape == (2, 4, 8, 3)
    # Side by side or alone, the last digits are those of another order of the same sums.
    alone = sw.integrate(twists[1, 2], 0.1, starts[1, 2])
    np.testing.assert_allclose(poses[1, 2], alone, rtol=0, atol=1e-15)
    alone = sw.integrate(twists[0, 3], 0.1)
    np.testing.assert_allclose(sw.integrate(twists, 0.1)[0, 3], alone, rtol=0, atol=1e-15)


def test_named_tuples_go_wherever_three_floats_do():
    twist = sw.Twist(0.5, 0.0, 0.25)
    rover = sw.Rover.preset("perseverance")
    np.testing.assert_array_equal(rover.icr(twist), (0.0, 2.0))
    pose = sw.Pose(*sw.exp(twist, 2.0))
    assert pose.yaw == 0.5
    assert repr(twist) == "Twist(vx=0.5, vy=0.0, omega=0.25)"


def test_the_same_stamp_twice_moves_nothing():
    """Recordings have steps of no duration: the pose stays, and what follows is as without them."""
    twists = np.array([(0.5, 0.1, 0.3), (9.0, 9.0, 9.0), (0.4, 0.0, -0.2)])
    poses = sw.integrate(twists, [0.1, 0.0, 0.2])
    np.testing.assert_array_equal(poses[2], poses[1])
    np.testing.assert_array_equal(poses[[0, 1, 3]], sw.integrate(twists[[0, 2]], [0.1, 0.2]))
    np.testing.assert_array_equal(sw.exp((1.0, 2.0, 3.0), 0.0), 0.0)
    np.testing.assert_array_equal(sw.integrate(twists, 0.0), np.zeros((4, 3)))
    many = np.tile(twists, (1000, 1))  # side by side, and over threads
    steps = np.tile([0.1, 0.0, 0.2], 1000)
    for kernel in sw.simd_levels():
        np.testing.assert_allclose(
            sw.integrate(many, steps, level=kernel), sw.reference.integrate(many, steps), rtol=0, atol=1e-9
        )


BAD = [
    (lambda: sw.integrate([(1, 0, 0)], -0.1), "dt must be finite and not negative, got -0.1"),
    (lambda: sw.integrate([(1, 0, 0)], math.nan), "dt must be finite and not negative, got nan"),
    (
        lambda: sw.integrate([(1, 0, 0)] * 3, [0.1, -0.1, 0.1]),
        r"dt\[1\] must be finite and not negative, got -0.1",
    ),
    (
        lambda: sw.integrate(np.ones((40_000, 3)), np.r_[0.0, np.ones(39_998), math.nan]),
        r"dt\[39999\] must be finite and not negative, got nan",
    ),
    (lambda: sw.differentiate([(0, 0, 0)] * 2, 0.0), "dt must be finite and positive, got 0.0"),
    (lambda: sw.log((1, 0, 0), 5e-324), "dt must be at least 1e-150, got 5e-324"),
    (lambda: sw.log((1, 0, 0), 0.0), "dt must be finite and positive, got 0.0"),
    (
        lambda: sw.integrate([(1, 0, 0)] * 3, [0.1, 0.1]),
        r"dt must be one number or have shape \(3,\), got shape \(2,\)",
    ),
    (lambda: sw.integrate((1, 0, 0), 0.1), r"twists must have shape \(..., n, 3\), got shape \(3,\)"),
    (lambda: sw.integrate([(1, 0, math.nan)], 0.1), r"twists\[0\] must be finite, got \(1.0, 0.0, nan\)"),
    (lambda: sw.integrate([(1e308, 0, 0)] * 3, 10.0), r"twists\[0\] must keep the pose finite over its step"),
    (lambda: sw.integrate([(1, 0, 0)], 0.1, (0, 0)), r"start must have shape \(..., 3\), got shape \(2,\)"),
    (lambda: sw.integrate([(1, 0, 0)], 0.1, (0, 0, math.inf)), "start must be finite"),
    (
        lambda: sw.integrate([[(1, 0, 0)]] * 3, 0.1, [(0, 0, 0)] * 2),
        "start must be one pose or have leading axes",
    ),
    (lambda: sw.integrate([(1, 0, 0)], "0.1"), "dt must be real numbers, got '0.1'"),
    (lambda: sw.differentiate(np.empty((0, 3)), 0.1), "poses must hold at least one pose"),
    (lambda: sw.differentiate((0, 0, 0), 0.1), r"poses must have shape \(n \+ 1, 3\)"),
    (lambda: sw.differentiate([(0, 0, 0), (math.nan, 0, 0)], 0.1), r"poses\[1\] must be finite"),
    (lambda: sw.exp((1, 0, 0), -1.0), "dt must be finite and not negative, got -1.0"),
    (
        lambda: sw.compose([(0, 0, 0)] * 3, [(0, 0, 0)] * 2),
        r"second must have shape \(3, 3\), got shape \(2, 3\)",
    ),
    (lambda: sw.wrap_angle(math.nan), "angle must be finite"),
]


@pytest.mark.parametrize(("call", "message"), BAD)
def test_bad_arguments(call, message):
    with pytest.raises(ValueError, match=message):
        call()
