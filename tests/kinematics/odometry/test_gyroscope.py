"""A gyroscope whose bias is a state: learnt at rest, counted while driving; a parked rover stays put."""

import numpy as np
import pytest

import six_wheel as sw
from tests.rovers import PAIR

KNOWN = sw.Gyroscope(0.002, bias_walk=1e-5)
NOISE = sw.Noise(speed=0.01, slip=0.02)


def park(odometry, seconds, bias, seed=0, begin=0.0, angles=(0.0, 0.0)):
    random = np.random.default_rng(seed)
    for k in range(round(seconds / 0.05)):
        rate = bias + 0.002 * random.standard_normal()
        state = odometry.update(None, angles, begin + 0.05 * k, yaw_rate=rate)
    return state


def test_a_parked_rover_stays_where_it_is():
    odometry = sw.Odometry(PAIR, NOISE, gyroscope=KNOWN)
    state = park(odometry, 60.0, 0.023)
    assert abs(np.degrees(state.pose[2])) < 0.01
    np.testing.assert_array_equal(state.pose[:2], 0.0)
    assert not state.twist.any()
    value, deviation = odometry.gyroscope_bias
    # 1200 readings of 0.002 rad/s: 6e-5 rad/s, and the walk.
    assert abs(value - 0.023) < 4.0 * deviation < 1e-3
    assert state.covariance[2, 2] < 1e-12


def test_a_bias_learnt_at_rest_is_taken_off_on_the_way():
    learnt, never = (sw.Odometry(PAIR, NOISE, gyroscope=KNOWN) for _ in range(2))
    park(learnt, 20.0, 0.023)
    for odometry, begin in ((learnt, 20.0), (never, 0.0)):
        for k in range(400):  # straight ahead for 20 s
            angle = 0.25 * k
            state = odometry.update(None, (angle, angle), begin + 0.05 * k, yaw_rate=0.023)
    assert abs(learnt.state.pose[2]) < 0.01
    assert abs(state.pose[2]) > 0.05
    # A user who does not know the bias says so.
    assert abs(state.pose[2]) < 3.0 * np.sqrt(state.covariance[2, 2])
    assert learnt.state.covariance[2, 2] < 0.1 * state.covariance[2, 2]


def test_a_bias_learnt_late_also_moves_what_was_driven_without_readings():
    """Ten seconds with a bias that nobody knows, ten seconds in which the gyroscope is silent, then rest: the
    yaw was off by 0.05 rad from the first ten on, which the next ten metres went the wrong way by."""
    known = sw.Gyroscope(1e-4, bias_noise=0.05, bias_walk=0.0)
    odometry = sw.Odometry(PAIR, sw.Noise(speed=10.0), gyroscope=known)
    for k in range(401):
        state = odometry.update(None, (0.5 * k, 0.5 * k), 0.05 * k, yaw_rate=0.005 if k <= 200 else None)
    assert abs(state.pose[1]) > 0.5
    for k in range(401, 421):
        state = odometry.update(None, (200.0, 200.0), 0.05 * k, yaw_rate=0.005)
    # The rest is of second order: 20 m times half the square of 0.05.
    np.testing.assert_allclose(state.pose, (20.0, 0.0, 0.0), atol=0.025)


def test_a_rover_that_is_turned_by_hand_does_not_stand():
    odometry = sw.Odometry(PAIR, NOISE, gyroscope=KNOWN)
    park(odometry, 10.0, 0.0)
    for k in range(20):
        odometry.update(None, (0.0, 0.0), 10.0 + 0.05 * k, yaw_rate=0.5)
    assert abs(odometry.gyroscope_bias[0]) < 1e-3
    assert odometry.state.pose[2] > 0.05


@pytest.mark.parametrize("scale_noise", [0.0, 0.05])
def test_it_is_as_far_off_as_it_says(scale_noise):
    """Parked, then driven, biases and scales at random: mean NEES of the yaw is 1 within 4 deviations of
    sqrt(2 / n)."""
    known = sw.Gyroscope(0.01, bias_noise=0.02, bias_walk=1e-3, scale_noise=scale_noise)
    runs, times = 150, np.linspace(0, 10, 21)
    noise = sw.Noise(0.0, 0.0, slip=0.003)
    twists = np.zeros((21, 3))
    twists[5:, 0], twists[5:, 2] = 0.4, 0.3
    values = []
    for seed in range(runs):
        log = sw.simulate(PAIR, (times, twists), noise=noise, gyroscope=known, rate=10.0, seed=seed)
        track = sw.dead_reckon(PAIR, log, noise=noise, gyroscope=known)
        values.append((track.poses[-1, 2] - log.truth.poses[-1, 2]) ** 2 / track.covariances[-1, 2, 2])
    assert abs(np.mean(values) - 1.0) < 4.0 * np.sqrt(2.0 / runs)


@pytest.mark.parametrize("more", [{}, {"dimensions": 1e-9 * np.ones((2, 2, 9))}])
def test_what_its_scale_may_be_off_by_grows_with_the_turn_and_goes_back_with_it(more):
    """A gyroscope that alone says how the rover turns: the share of the turn, by definition."""
    known = sw.Gyroscope(0.0, bias_noise=0.0, bias_walk=0.0, scale_noise=0.02)
    odometry = sw.Odometry(PAIR, NOISE, gyroscope=known, **more)
    rates = np.concatenate((np.full(100, 0.5), np.full(50, -0.5), np.full(50, -0.5)))
    turned, angles = 0.0, np.zeros(2)
    for k, rate in enumerate(rates.tolist()):
        if k:
            turned += 0.1 * (rate + rates[k - 1]) / 2.0
            angles += 0.1 * (rate + rates[k - 1]) / 2.0 * np.array((-2.0, 2.0))
        state = odometry.update(None, angles, 0.1 * k, yaw_rate=rate)
        # One without noise has its word for it: wheels and dimensions add what their squares are rounded by.
        assert np.sqrt(state.covariance[2, 2]) == pytest.approx(0.02 * abs(turned), rel=1e-6, abs=1e-7)
    assert abs(turned) < 0.1  # and back again


def test_a_motion_for_a_graph_keeps_no_such_error():
    with pytest.raises(
        ValueError, match="scale_noise must be 0: a motion keeps no error that lasts beyond it"
    ):
        sw.Preintegrated(PAIR, NOISE, gyroscope=sw.Gyroscope(scale_noise=0.01))
    with pytest.raises(ValueError, match="scale_noise must be finite and not negative, got -1"):
        sw.Gyroscope(scale_noise=-1.0)


def test_without_a_gyroscope_there_is_no_bias():
    assert sw.Odometry(PAIR).gyroscope_bias is None
    with pytest.raises(ValueError, match="bias_noise must be finite and not negative, got -1"):
        sw.Gyroscope(bias_noise=-1.0)
