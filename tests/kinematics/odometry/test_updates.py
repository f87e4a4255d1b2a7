"""Odometry sample by sample: exact steps, honest covariance, encoders as they are, bad input."""

import math
import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.reference.planar import odometry as oracle
from tests.odometry_logs import VEHICLES, drive, follow, plain

SOAK = "SOAK" in os.environ


@pytest.mark.parametrize("name", VEHICLES)
def test_a_motion_held_over_every_step_is_found_exactly(name):
    log = drive(VEHICLES[name])
    odometry = sw.Odometry(log.rover)
    for k in range(len(log.stamps)):
        state = odometry.update(log.steering[k], log.angles[k], log.stamps[k])
        # Rounding of angles of some hundred radians, summed over 400 steps.
        np.testing.assert_allclose(state.pose, log.poses[k], rtol=0, atol=1e-11)
        if k:
            np.testing.assert_allclose(state.twist, log.twists[k - 1], rtol=0, atol=1e-11)
            assert state.residuals.max() < 1e-11


def crab(rate: float, span: float, dt: float = 0.05) -> tuple[np.ndarray, ...]:
    """2 m, all wheels steering at `rate` [rad/s] back and forth by `span` [rad] meanwhile."""
    speed = 1.0
    stamps = np.arange(0.0, 2.0 + dt / 2, dt)
    phase = rate * stamps
    # A triangle wave whose corners are samples: what a joint does at its rate limit.
    period = 2.0 * span
    angles = np.abs((phase + span / 2) % period - span) - span / 2
    way = speed * stamps
    fine = np.linspace(0.0, 2.0, 2_000_001)
    direction = np.interp(fine, stamps, angles)
    rates = np.stack((np.cos(direction), np.sin(direction)), axis=-1) * speed
    truth = np.trapezoid(rates, fine, axis=0)
    return np.repeat(angles[:, None], 4, axis=1), np.repeat(way[:, None] / 0.1, 4, axis=1), stamps, truth


@pytest.mark.parametrize("span", [0.6, 1.5, 3.0])
def test_steering_moves_during_the_step(span):
    steering, angles, stamps, truth = crab(1.5, span)
    rover = VEHICLES["swerve"]
    reached = follow(sw.Odometry(rover), steering, angles, stamps).pose[:2]
    error = np.hypot(*(reached - truth))
    ended = np.zeros(3)
    for k in range(1, len(stamps)):
        step = rover.forward(steering[k], angles[k] - angles[k - 1])
        ended = sw.compose(ended, sw.exp(step))
    by_end_angles = np.hypot(*(ended[:2] - truth))
    print(f"span {span} rad: {1e3 * error:.2g} mm, with end angles {1e3 * by_end_angles:.1f} mm")
    assert error < 1e-7  # the truth's own integral, 1 us steps
    assert error < 1e-4 * by_end_angles


def test_a_crab_of_two_metres():
    # Straight to the left, the wheels steering there from straight ahead at 1.5 rad/s on the way.
    dt, rate = 0.05, 1.5
    stamps = np.arange(0.0, 3.0, dt)
    angle = np.minimum(rate * stamps, math.pi / 2)
    fine = np.linspace(0.0, stamps[-1], 3_000_001)
    way = 2.0 * stamps / stamps[-1]
    held = np.interp(fine, stamps, angle)
    speed = 2.0 / stamps[-1]
    truth = np.trapezoid(np.stack((np.cos(held), np.sin(held)), axis=-1) * speed, fine, axis=0)
    steering, angles = (np.repeat(column[:, None], 4, axis=1) for column in (angle, way / 0.1))
    reached = follow(sw.Odometry(VEHICLES["swerve"]), steering, angles, stamps).pose
    assert np.hypot(*(reached[:2] - truth)) < 1e-4
    chord = sw.compose((0, 0, 0), (0, 0, 0))
    for k in range(1, len(stamps)):
        chord = sw.compose(chord, sw.exp(VEHICLES["swerve"].forward(steering[k], angles[k] - angles[k - 1])))
    assert np.hypot(*(chord[:2] - truth)) > 0.02


@pytest.mark.parametrize("name", VEHICLES)
def test_poses_and_covariance_are_those_of_the_reference(name):
    log = drive(VEHICLES[name], n=6)
    generator = np.random.default_rng(11)
    # Readings that contradict each other, steering on the way.
    steering = log.steering + generator.normal(0, 0.02, log.steering.shape)
    angles = log.angles + np.cumsum(generator.normal(0, 0.02, log.angles.shape), axis=0)
    noise = {"speed": 0.02, "steering": 0.01, "slip": 0.03, "side_slip": 0.02}
    state = follow(sw.Odometry(log.rover, sw.Noise(**noise)), steering, angles, log.stamps)
    rover = plain(log.rover)
    poses = oracle.dead_reckon(rover, steering, angles)
    np.testing.assert_allclose(state.pose, poses[-1], rtol=0, atol=1e-13)
    expected = oracle.covariance(rover, steering, angles, log.stamps, oracle.Noise(**noise))
    # The core leaves out how the chord of a steering wheel's arc answers to its angles, which is of the order
    # of the change of the angle in one step (here 0.03) beside the angle's own effect.
    np.testing.assert_allclose(state.covariance, expected, rtol=0.02, atol=2e-3 * np.abs(expected).max())


def test_covariance_grows_with_the_distance_and_not_with_the_rate():
    rover = VEHICLES["differential"]
    spreads = {}
    for dt in (0.01, 0.1):
        stamps = np.arange(0.0, 20.0 + dt / 2, dt)
        angles = np.repeat(0.5 / 0.1 * stamps[:, None], 2, axis=1)
        for period in (None, 0.1):
            for slip in (0.0, 0.02):
                noise = sw.Noise(0.0 if slip else 0.01, 0.0, slip=slip, period=period)
                state = sw.dead_reckon(rover, None, angles, stamps, noise=noise)
                spreads[dt, period, slip] = np.sqrt(state.covariances[-1][0, 0])
    # 10 m: slip of 2 cm per root metre and wheel, two wheels, whatever the rate.
    for dt in (0.01, 0.1):
        assert spreads[dt, None, 0.02] == pytest.approx(0.02 * math.sqrt(10 / 2), rel=1e-9)
        assert spreads[dt, 0.1, 0.0] == pytest.approx(0.01 * math.sqrt(20 * 0.1 / 2), rel=1e-9)
        assert spreads[dt, None, 0.0] == pytest.approx(0.01 * math.sqrt(20 * dt / 2), rel=1e-9)


def simulate(log, noise, runs, generator):
    """Last poses (runs, 3) of odometry on noisy readings, and its covariances (runs, 3, 3)."""
    radii = np.array([wheel.radius for wheel in log.rover.wheels])
    durations = np.diff(log.stamps)[:, None]
    ways = np.diff(log.angles, axis=0) * radii
    pivots = np.array([(wheel.x, wheel.y) for wheel in log.rover.wheels])
    velocity = log.twists[:, None, :2] + log.twists[:, None, 2:] * np.stack(
        (-pivots[:, 1], pivots[:, 0]), axis=-1
    )
    distances = np.linalg.norm(velocity, axis=-1) * durations
    deviations = np.sqrt((noise.speed * durations) ** 2 + noise.slip**2 * distances)
    poses, covariances = np.empty((runs, 3)), np.empty((runs, 3, 3))
    for i in range(runs):
        read = (ways + deviations * generator.normal(size=ways.shape)) / radii
        angles = np.vstack([np.zeros(len(radii)), np.cumsum(read, axis=0)])
        steering = log.steering + noise.steering * generator.normal(size=log.steering.shape)
        track = sw.dead_reckon(log.rover, steering, angles, log.stamps, noise=noise, residuals=False)
        poses[i], covariances[i] = track.poses[-1], track.covariances[-1]
    return poses, covariances


@pytest.mark.parametrize("name", ["six_wheel", "differential", "tricycle", "mecanum", "swerve"])
def test_monte_carlo_the_error_is_what_it_is_said_to_be(name):
    runs = 10_000 if SOAK else 600
    log = drive(VEHICLES[name], n=40, turning=0.2)
    noise = sw.Noise(0.02, 0.01, slip=0.01)
    poses, covariances = simulate(log, noise, runs, np.random.default_rng(17))
    errors = poses - log.poses[-1]
    squared = np.einsum("ni,nij,nj->n", errors, np.linalg.inv(covariances), errors)
    # Normalised error squared: chi-square, 3 degrees of freedom, so its mean has deviation sqrt(6 / runs).
    band = 1.96 * math.sqrt(6.0 / runs)
    print(f"{name}: mean normalised error squared {squared.mean():.3f}, 95 % band 3 +- {band:.3f}")
    assert abs(squared.mean() - 3.0) < band
    assert 0.92 < np.mean(squared < 7.815) < 0.98


@given(st.data())
def test_covariance_is_always_positive_semidefinite(data):
    rover = data.draw(st.sampled_from(list(VEHICLES.values())))
    noises = st.floats(0.0, 0.1) | st.just(0.0)
    noise = sw.Noise(
        data.draw(noises), data.draw(noises), slip=data.draw(noises), side_slip=data.draw(noises)
    )
    odometry = sw.Odometry(rover, noise, inflate=data.draw(st.booleans()))
    joints, wheels = len(rover.steered_wheel_names), len(rover.wheels)
    readings = st.floats(-2.0, 2.0)
    for k in range(data.draw(st.integers(2, 8))):
        steering = data.draw(st.lists(readings, min_size=joints, max_size=joints))
        angles = data.draw(st.lists(readings, min_size=wheels, max_size=wheels))
        state = odometry.update(steering, angles, 0.1 * k)
        np.testing.assert_array_equal(state.covariance, state.covariance.T)
        assert np.linalg.eigvalsh(state.covariance).min() >= 0.0
        if np.isfinite(state.twist_covariance).all():  # otherwise nothing is known of the twist
            least = np.linalg.eigvalsh(state.twist_covariance).min()
            assert least >= -1e-14 * np.trace(state.twist_covariance)


def test_ros_order():
    log = drive(VEHICLES["six_wheel"], n=20)
    state = follow(sw.Odometry(log.rover), log.steering, log.angles, log.stamps)
    spatial = state.covariance_6x6(unmeasured=99.0)
    places = [0, 1, 5]
    np.testing.assert_array_equal(spatial[np.ix_(places, places)], state.covariance)
    np.testing.assert_array_equal(np.diag(spatial)[2:5], 99.0)
    assert np.count_nonzero(spatial) == 12
    np.testing.assert_array_equal(
        state.twist_covariance_6x6()[np.ix_(places, places)], state.twist_covariance
    )


@pytest.mark.parametrize("bits", [16, 32])
@pytest.mark.parametrize("signed", [False, True])
def test_counters_that_start_over(bits, signed):
    rover = VEHICLES["differential"]
    resolution, gear, modulus = 512.0, 30.0, 2**bits
    log = drive(rover, n=300)
    per_radian = resolution * gear / math.tau
    counts = np.round(log.angles * per_radian * (1.0 if bits == 16 else 2000.0))
    encoder = sw.Encoder(resolution * (1.0 if bits == 16 else 2000.0), gear_ratio=gear, wraps_at=modulus)
    read = (counts + (modulus // 2 if signed else modulus) - 1000) % modulus
    read = np.where(read >= modulus / 2, read - modulus, read) if signed else read
    odometry = sw.Odometry(rover, wheel_encoders=encoder)
    wrapped = 0
    for k in range(len(log.stamps)):
        state = odometry.update(None, read[k], log.stamps[k])
        wrapped += bool(state.health & sw.OdometryHealth.WRAPPED)
    plainly = sw.Odometry(rover)
    expected = follow(plainly, log.steering, counts * encoder.angle_per_tick, log.stamps)
    np.testing.assert_allclose(state.pose, expected.pose, rtol=0, atol=1e-9)
    assert wrapped >= 1


def test_steering_encoders_are_absolute():
    rover = VEHICLES["tricycle"]
    log = drive(rover, n=40)
    encoder = sw.Encoder(4096, wraps_at=4096, offset=-3.0)
    counts = (log.steering + 3.0) / encoder.angle_per_tick % 4096
    odometry = sw.Odometry(rover, steering_encoders={rover.steered_wheel_names[0]: encoder})
    state = follow(odometry, counts, log.angles, log.stamps)
    np.testing.assert_allclose(state.pose, log.poses[-1], rtol=0, atol=1e-10)


def test_a_motor_that_runs_the_other_way_round():
    rover = VEHICLES["differential"]
    log = drive(rover, n=30)
    encoders = [sw.Encoder(100, gear_ratio=10.0), sw.Encoder(50, gear_ratio=-4.0)]
    counts = log.angles / [encoder.angle_per_tick for encoder in encoders]
    state = follow(sw.Odometry(rover, wheel_encoders=encoders), log.steering, counts, log.stamps)
    np.testing.assert_allclose(state.pose, log.poses[-1], rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", VEHICLES)
def test_increments_are_totals_apart(name):
    log = drive(VEHICLES[name], n=30)
    increments = np.diff(log.angles, axis=0, prepend=log.angles[:1] - 5.0)
    state = follow(sw.Odometry(log.rover, increments=True), log.steering, increments, log.stamps)
    np.testing.assert_allclose(state.pose, log.poses[-1], rtol=0, atol=1e-11)


def test_speeds_count_for_half_a_step_at_each_end():
    rover = VEHICLES["differential"]
    stamps = np.linspace(0.0, 4.0, 81)
    speeds = np.stack((2.0 + 0.5 * stamps, 3.0 - 0.25 * stamps), axis=-1)
    state = follow(sw.Odometry(rover, readings="speeds"), [None] * 81, speeds, stamps)
    totals = np.stack((2.0 * stamps + 0.25 * stamps**2, 3.0 * stamps - 0.125 * stamps**2), axis=-1)
    expected = follow(sw.Odometry(rover), [None] * 81, totals, stamps)
    np.testing.assert_allclose(state.pose, expected.pose, rtol=0, atol=1e-12)
    # Every reading errs once, although two steps use it: the deviation over N steps is that of N readings.
    ahead = sw.dead_reckon(
        rover, None, np.full((81, 2), 5.0), stamps, readings="speeds", noise=sw.Noise(0.02, 0.0)
    )
    assert ahead.covariances[-1][0, 0] == pytest.approx(0.02**2 * 0.05**2 / 2 * (80 - 0.5), rel=1e-9)
