"""Odometry with more than wheels: gyroscope, compass, late poses, commands."""

import math
import os

import numpy as np
import pytest

import six_wheel as sw
from tests.odometry_logs import VEHICLES, drive, follow

SOAK = "SOAK" in os.environ


def test_velocity_is_filtered_by_its_time_constant():
    rover = VEHICLES["differential"]
    odometry = sw.Odometry(rover, smoothing=0.5)
    odometry.update(None, [0.0, 0.0], 0.0)
    assert odometry.update(None, [1.0, 1.0], 0.1).velocity[0] == pytest.approx(1.0)
    totals, expected = 1.0, 1.0
    for k in range(2, 20):
        state = odometry.update(None, [totals, totals], 0.1 * k)  # stands still
        expected *= math.exp(-0.1 / 0.5)
        assert state.velocity[0] == pytest.approx(expected, rel=1e-12)
        assert abs(state.twist[0]) < 1e-15


def test_a_gyroscope_at_its_word_gives_the_turn():
    rover = VEHICLES["differential"]
    log = drive(rover, n=100)
    slow = log.angles * [1.0, 1.02]  # one wheel slips: the heading drifts
    rates = np.interp(log.stamps, log.stamps[1:], log.twists[:, 2])
    turns = np.concatenate([[0.0], np.cumsum((rates[1:] + rates[:-1]) / 2 * np.diff(log.stamps))])
    state = follow(sw.Odometry(rover), log.steering, slow, log.stamps, yaw_rate=rates)
    assert state.yaw == pytest.approx(turns[-1], abs=1e-12)
    absolute = follow(sw.Odometry(rover), log.steering, slow, log.stamps, yaw=log.poses[:, 2] + 100.0)
    assert absolute.yaw == pytest.approx(log.poses[-1, 2], abs=1e-12)
    without = follow(sw.Odometry(rover), log.steering, slow, log.stamps)
    apart = [np.hypot(*(s.pose - log.poses[-1])[:2]) for s in (absolute, without)]
    assert apart[0] < 0.3 * apart[1]


@pytest.mark.parametrize("sensor", ["yaw", "yaw_rate"])
def test_monte_carlo_with_a_yaw_sensor(sensor):
    runs = 5_000 if SOAK else 400
    rover = VEHICLES["differential"]
    stamps = np.arange(0.0, 6.01, 0.1)
    twist = np.array([0.5, 0.0, 0.4])
    _, speeds = rover.inverse(twist)
    truth = sw.integrate(np.tile(twist, (60, 1)), 0.1)
    noise = sw.Noise(0.05, 0.0, yaw=0.02, yaw_rate=0.05)
    generator = np.random.default_rng(23)
    squared, spreads = [], []
    for _ in range(runs):
        ways = speeds * 0.1 + generator.normal(0, 0.05 * 0.1 / 0.1, (60, 2))
        angles = np.vstack([np.zeros(2), np.cumsum(ways, axis=0)])
        true = {"yaw": truth[:, 2], "yaw_rate": np.full(61, 0.4)}[sensor]
        read = true + generator.normal(0, {"yaw": 0.02, "yaw_rate": 0.05}[sensor], 61)
        track = sw.dead_reckon(rover, None, angles, stamps, noise=noise, **{sensor: read})
        error = track.poses[-1] - truth[-1]
        squared.append(error @ np.linalg.solve(track.covariances[-1], error))
        spreads.append(track.covariances[-1][2, 2])
    band = 1.96 * math.sqrt(6.0 / runs)
    print(f"{sensor}: {np.mean(squared):.3f}, band 3 +- {band:.3f}")
    assert abs(np.mean(squared) - 3.0) < band
    alone = sw.dead_reckon(rover, None, angles, stamps, noise=noise)
    assert np.mean(spreads) < 0.5 * alone.covariances[-1][2, 2]


def test_late_poses_are_as_good_as_timely_ones():
    log = drive(VEHICLES["six_wheel"], n=60)
    noise = sw.Noise(0.02, 0.01)
    covariance = (np.diag([0.01, 0.02, 0.005]) + 0.002) * 1e-3
    fixes = [(30, (0.1, 0.05, 0.02)), (60, (-0.05, 0.02, 0.01)), (80, (0.02, 0.1, -0.03))]
    timely = sw.Odometry(log.rover, noise)
    late = sw.Odometry(log.rover, noise, lag=10.0)
    for k in range(len(log.stamps)):
        timely.update(log.steering[k], log.angles[k], log.stamps[k])
        late.update(log.steering[k], log.angles[k], log.stamps[k])
        for row, shift in fixes:
            if row == k:
                timely.correct(log.poses[row] + shift, log.stamps[row], covariance)
    for row, shift in (fixes[1], fixes[0], fixes[2]):  # and in another order
        late.correct(log.poses[row] + shift, log.stamps[row], covariance)
    np.testing.assert_allclose(late.state.pose, timely.state.pose, rtol=0, atol=1e-13)
    np.testing.assert_allclose(late.state.covariance, timely.state.covariance, rtol=1e-9, atol=1e-15)
    alone = sw.dead_reckon(log.rover, log.steering, log.angles, log.stamps, noise=noise)
    assert np.all(np.diag(late.state.covariance) < 0.99 * np.diag(alone.covariances[-1]))


def test_a_pose_between_two_samples_lies_on_the_arc():
    rover = VEHICLES["differential"]
    twist = np.array([0.5, 0.0, 0.8])
    _, speeds = rover.inverse(twist)
    odometry = sw.Odometry(rover, sw.Noise(0.02, 0.0), lag=2.0)
    for k in range(6):
        odometry.update(None, speeds * 0.2 * k, 0.2 * k)
    moved = sw.compose((1.0, -2.0, 0.5), sw.exp(twist, 0.5))
    state = odometry.correct(moved, 0.5, (0.0, 0.0, 0.0))
    # From then on as the wheels say.
    np.testing.assert_allclose(state.pose, sw.compose(moved, sw.exp(twist, 0.5)), atol=1e-12)
    beyond = odometry.correct(sw.compose(moved, sw.exp(twist, 0.6)), 1.1, (0.0, 0.0, 0.0))
    np.testing.assert_allclose(beyond.pose, state.pose, atol=1e-12)


def test_a_pose_may_know_some_directions_only():
    rover = VEHICLES["differential"]
    odometry = sw.Odometry(rover, sw.Noise(0.5, 0.0))
    for k in range(20):
        odometry.update(None, (5.0 * k, 5.0 * k), 0.1 * k)
    before = odometry.state
    state = odometry.correct((before.pose[0] + 0.5, 77.0, 3.0), before.stamp, (1e-9, math.inf, math.inf))
    assert state.pose[0] == pytest.approx(before.pose[0] + 0.5, abs=1e-6)
    np.testing.assert_allclose(state.pose[1:], before.pose[1:], atol=1e-9)
    assert state.covariance[0, 0] < 1.1e-9
    assert state.covariance[2, 2] == pytest.approx(before.covariance[2, 2], rel=1e-6)


def test_a_pose_too_old_or_without_samples_is_refused():
    odometry = sw.Odometry(VEHICLES["differential"], lag=0.5)
    with pytest.raises(ValueError, match="stamp must be finite and follow a first sample, got 1.0"):
        odometry.correct((0, 0, 0), 1.0, (1, 1, 1))
    for k in range(30):
        odometry.update(None, (k, k), 0.1 * k)
    before = odometry.state.pose
    with pytest.raises(
        ValueError, match=r"stamp must be between 2\.3\d* and 3\.4\d*, as lag and history allow, got 2"
    ):
        odometry.correct((0, 0, 0), 2.0, (1, 1, 1))
    with pytest.raises(ValueError, match="covariance must have no negative variance in any direction"):
        odometry.correct((0, 0, 0), 2.8, [[1, 2, 0], [2, 1, 0], [0, 0, 1]])
    with pytest.raises(ValueError, match="covariance must be symmetric"):
        odometry.correct((0, 0, 0), 2.8, [[1, 0.2, 0], [0, 1, 0], [0, 0, 1]])
    np.testing.assert_array_equal(odometry.state.pose, before)


def test_set_pose_and_reset():
    rover = VEHICLES["differential"]
    odometry = sw.Odometry(rover)
    odometry.update(None, (0, 0), 0.0)
    odometry.update(None, (1, 1), 0.1)
    odometry.set_pose((3.0, 2.0, math.pi / 2), (0.1, 0.2, 0.3))
    np.testing.assert_allclose(np.diag(odometry.state.covariance), (0.1, 0.2, 0.3), rtol=1e-12)
    np.testing.assert_allclose(odometry.update(None, (2, 2), 0.2).pose, (3.0, 2.1, math.pi / 2), atol=1e-12)
    odometry.reset()
    state = odometry.update(None, (50, -50), 0.0)
    np.testing.assert_array_equal(state.pose, 0.0)
    np.testing.assert_array_equal(state.covariance, 0.0)
    with pytest.raises(ValueError, match="pose must be finite"):
        odometry.set_pose((math.nan, 0, 0))


def test_open_loop():
    odometry = sw.Odometry(VEHICLES["six_wheel"])
    odometry.command((0.5, 0.0, 0.2), 10.0)
    state = odometry.command((0.5, 0.0, 0.2), 12.0)
    np.testing.assert_allclose(state.pose, sw.exp((0.5, 0.0, 0.2), 2.0), atol=1e-14)
    assert np.all(np.linalg.eigvalsh(state.covariance) > 0.0)
    with pytest.raises(sw.InfeasibleMotionError):
        odometry.command((0.0, 1.0, 0.0), 13.0)
    np.testing.assert_array_equal(odometry.state.pose, state.pose)
    # Readings that come now are a reference: what was commanded is not counted twice.
    measured = odometry.update(np.zeros(4), np.full(6, 7.0), 12.5)
    np.testing.assert_array_equal(measured.pose, state.pose)
