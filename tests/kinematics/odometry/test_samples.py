"""Samples of odometry: first, late, missing, out of order; counters, clocks and errors."""

import math
import pickle

import numpy as np
import pytest

import six_wheel as sw
from tests.odometry_logs import VEHICLES, drive, follow


def test_the_first_sample_is_a_reference():
    state = sw.Odometry(VEHICLES["six_wheel"]).update([0.3, 0.2, -0.3, -0.2], [1e5] * 6, 1.7e9)
    np.testing.assert_array_equal(state.pose, 0.0)
    np.testing.assert_array_equal(state.twist, 0.0)
    np.testing.assert_array_equal(state.covariance, 0.0)
    assert state.health == sw.OdometryHealth.FIRST
    assert state.stamp == 1.7e9


def test_a_gap_is_one_arc():
    rover = VEHICLES["differential"]
    twist = np.array([0.4, 0.0, 0.3])
    _, speeds = rover.inverse(twist)
    odometry = sw.Odometry(rover, max_gap=0.2)
    odometry.update(None, [0.0, 0.0], 0.0)
    assert odometry.update(None, speeds * 0.1, 0.1).health == sw.OdometryHealth.GOOD
    state = odometry.update(None, speeds * 5.1, 5.1)
    assert state.health == sw.OdometryHealth.GAP
    np.testing.assert_allclose(state.pose, sw.exp(twist, 5.1), atol=1e-14)


BAD = {
    "the same stamp": ((0.0, 0.0), (1.0, 1.0), 0.1, "stamp must be later than the last one, 0.1, got 0.1"),
    "time backwards": ((0.0, 0.0), (1.0, 1.0), 0.05, "stamp must be later than the last one, 0.1, got 0.05"),
    "no time": ((0.0, 0.0), (1.0, 1.0), math.nan, "stamp must be finite, got nan"),
    "NaN": ((0.0, 0.0), (1.0, math.nan), 0.2, "wheel_angles must be finite"),
    "infinity": ((0.0, 0.0), (1.0, math.inf), 0.2, "wheel_angles must be finite"),
    "NaN steering": ((math.nan, 0.0), (1.0, 1.0), 0.2, "steering must be finite"),
    "too fast": (
        (0.0, 0.0),
        (900.0, 900.0),
        0.2,
        "wheel_angles must keep a at a rim speed of 2 m/s at most, got",
    ),
    "too quick": ((1.5, 0.0), (1.0, 1.0), 0.2, "steering must keep a at a steering rate of 3 rad/s at most"),
    "not enough": ((0.0, 0.0), (1.0,), 0.2, r"wheel_angles must have shape \(\.\.\., 2\), got shape \(1,\)"),
    "too much": ((0.0, 0.0), ((1.0, 1.0),) * 3, 0.2, r"wheel_angles must have shape \(2,\)"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_refused_changes_nothing(case):
    steering, wheels, stamp, message = BAD[case]
    rover = sw.Rover([sw.Wheel(n, x, 0.0, radius=0.1, steered=True) for n, x in (("a", 0.3), ("b", -0.3))])
    odometry = sw.Odometry(rover, max_speed=2.0, max_steering_rate=3.0, lag=1.0)
    odometry.update((0.1, 0.1), (0.0, 0.0), 0.0)
    odometry.update((0.1, 0.05), (0.5, 0.5), 0.1)
    before = repr(odometry), odometry.state.pose, odometry.state.covariance
    with pytest.raises(ValueError, match=message):
        odometry.update(steering, wheels, stamp)
    assert repr(odometry) == before[0]
    after = odometry.update((0.1, 0.1), (1.0, 1.0), 0.2)
    twin = sw.Odometry(rover, max_speed=2.0, max_steering_rate=3.0, lag=1.0)
    twin.update((0.1, 0.1), (0.0, 0.0), 0.0)
    twin.update((0.1, 0.05), (0.5, 0.5), 0.1)
    np.testing.assert_array_equal(after.pose, twin.update((0.1, 0.1), (1.0, 1.0), 0.2).pose)


def test_a_passive_wheel_without_an_encoder_may_be_silent():
    rover = VEHICLES["tricycle"]
    log = drive(rover, n=30)
    angles = log.angles.copy()
    silent = [i for i, wheel in enumerate(rover.wheels) if not wheel.driven]
    angles[:, silent] = np.nan
    state = follow(sw.Odometry(rover), log.steering, angles, log.stamps)
    np.testing.assert_allclose(state.pose, log.poses[-1], rtol=0, atol=1e-11)


def test_wheels_that_do_not_determine_the_motion():
    rover = sw.Rover([sw.Wheel("w", 0.0, 0.0, radius=0.1)])
    odometry = sw.Odometry(rover)
    odometry.update(None, [0.0], 0.0)
    with pytest.raises(sw.UnderdeterminedError):
        odometry.update(None, [1.0], 0.1)


def test_a_dead_wheel_is_named_and_outvoted():
    log = drive(VEHICLES["six_wheel"], n=60)
    angles = log.angles.copy()
    angles[:, 4] = 0.0  # rear left
    errors = {}
    for method in ("least_squares", "robust"):
        odometry = sw.Odometry(log.rover, method=method)
        named = []
        for k in range(len(log.stamps)):
            state = odometry.update(log.steering[k], angles[k], log.stamps[k])
            if state.health & sw.OdometryHealth.SLIP:
                named.append(state.worst_wheel)
        errors[method] = np.hypot(*(state.pose - log.poses[-1])[:2])
        assert len(named) > 50
        assert named.count("rear_left") > 0.9 * len(named)
    print(errors)
    assert errors["robust"] < 0.05 * errors["least_squares"]


def test_disagreement_inflates_the_covariance():
    log = drive(VEHICLES["six_wheel"], n=60)
    angles = log.angles.copy()
    angles[:, 4] *= 0.5
    states = [
        follow(
            sw.Odometry(log.rover, sw.Noise(speed=0.01), inflate=inflate), log.steering, angles, log.stamps
        )
        for inflate in (False, True)
    ]
    np.testing.assert_array_equal(states[0].pose, states[1].pose)
    assert np.all(np.diag(states[1].covariance) > 4 * np.diag(states[0].covariance))


WAYS = {
    "arrays": lambda a: a,
    "tuples": lambda a: tuple(a.tolist()),
    "lists": lambda a: a.tolist(),
    "other order": lambda a: np.repeat(a, 2)[::2],
    "other bytes": lambda a: a.astype(a.dtype.newbyteorder()),
    "a subclass": lambda a: a.view(np.recarray),
}


@pytest.mark.parametrize("way", WAYS)
def test_however_readings_come_they_are_the_same(way):
    log = drive(VEHICLES["six_wheel"], n=5)
    expected, odometry = sw.Odometry(log.rover), sw.Odometry(log.rover)
    for k in range(len(log.stamps)):
        plainly = expected.update(log.steering[k], log.angles[k], log.stamps[k], yaw=0.1 * k)
        readings = {"wheel_angles": WAYS[way](log.angles[k]), "yaw": np.float64(0.1 * k), "yaw_rate": None}
        state = odometry.update(WAYS[way](log.steering[k]), stamp=float(log.stamps[k]), **readings)
        for name in ("pose", "twist", "covariance", "residuals", "velocity", "twist_covariance"):
            np.testing.assert_array_equal(getattr(state, name), getattr(plainly, name))
        assert state.stamp == plainly.stamp
    integers = sw.Odometry(VEHICLES["differential"])
    integers.update(None, (0, 0), 0)
    assert integers.update(None, (1, 1), 1).pose[0] == pytest.approx(0.1)


def test_states_are_apart():
    odometry = sw.Odometry(VEHICLES["differential"])
    first = odometry.update(None, (0.0, 0.0), 0.0)
    second = odometry.update(None, (1.0, 1.0), 0.1)
    assert first.pose[0] == 0.0
    second.pose[0] = 77.0  # an array of the caller's own
    assert odometry.state.pose[0] == second.pose[0] == pytest.approx(0.1)


def test_states_that_are_kept_stay_as_they_are():
    """Objects nobody holds are handed out again, and only those."""
    log = drive(VEHICLES["six_wheel"], 60)
    track = sw.dead_reckon(log.rover, log.steering, log.angles, log.stamps)
    odometry = sw.Odometry(log.rover)
    kept = {}
    for k, (steering, angles, stamp) in enumerate(zip(log.steering, log.angles, log.stamps, strict=True)):
        state = odometry.update(steering, angles, stamp)
        if k % 3:
            kept[k] = state
    for k, state in kept.items():
        np.testing.assert_array_equal(state.pose, track.poses[k])
        np.testing.assert_array_equal(state.covariance, track.covariances[k])
        np.testing.assert_array_equal(state.residuals, track.residuals[k])
        assert state.stamp == log.stamps[k]


def test_values_are_values():
    noise = sw.Noise(0.02, 0.01, slip=0.03, period=0.1)
    assert noise == pickle.loads(pickle.dumps(noise)) == eval(repr(noise), {"Noise": sw.Noise})
    assert hash(noise) == hash(pickle.loads(pickle.dumps(noise)))
    assert noise != sw.Noise()
    encoder = sw.Encoder(512, gear_ratio=-30.0, wraps_at=65536, offset=0.1)
    assert encoder == pickle.loads(pickle.dumps(encoder)) == eval(repr(encoder), {"Encoder": sw.Encoder})
    assert sw.Encoder().angle_per_tick == 1.0
    for wrong in ({"speed": -0.1}, {"steering": math.nan}, {"period": 0.0}, {"slip": math.inf}):
        with pytest.raises(ValueError, match=f"{next(iter(wrong))} must be finite"):
            sw.Noise(**wrong)
    for wrong in ({"ticks_per_turn": 0}, {"gear_ratio": 0}, {"wraps_at": -1}, {"offset": math.inf}):
        with pytest.raises(ValueError, match=f"{next(iter(wrong))} must be finite"):
            sw.Encoder(**wrong)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"readings": "counts"}, "readings must be 'angles', 'speeds' or 'ticks', got 'counts'"),
        ({"method": "best"}, "method must be 'least_squares'"),
        ({"wheel_encoders": [sw.Encoder()] * 3}, "wheel_encoders must be one encoder or 6, got 3"),
        (
            {"wheel_encoders": {"spare": sw.Encoder()}},
            "wheel_encoders must name some of front_left, .* got 'spare'",
        ),
        ({"wheel_encoders": 4096}, "wheel_encoders must be an Encoder"),
        ({"smoothing": -1.0}, "smoothing must be finite and not negative, got -1.0"),
        ({"max_speed": 0.0}, "max_speed must be positive, got 0.0"),
        ({"lag": math.nan}, "lag must be finite and not negative, got nan"),
    ],
)
def test_options_that_make_no_sense(options, message):
    with pytest.raises(ValueError, match=message):
        sw.Odometry(VEHICLES["six_wheel"], **options)


def test_a_rover_that_steers_says_how():
    rover, message = VEHICLES["six_wheel"], "steering must hold the angles of the steered wheels, got None"
    with pytest.raises(ValueError, match=message):
        sw.Odometry(rover).update(None, np.zeros(6), 0.0)
    with pytest.raises(ValueError, match=message):
        sw.dead_reckon(rover, None, np.zeros((1, 6)), [0.0])


def test_huge_readings_are_refused_not_infinite():
    odometry = sw.Odometry(VEHICLES["differential"])
    odometry.update(None, (0.0, 0.0), 0.0)
    for wheels in ((1e308, 1e308), (1e200, -1e200), (1e100, 1e100)):
        with pytest.raises(ValueError, match="must be small enough"):
            odometry.update(None, wheels, 1.0)
    assert np.all(np.isfinite(odometry.update(None, (1.0, 2.0), 1e-300 + 1.0).covariance))


def test_noise_that_nobody_measured_is_that_of_a_typical_rover():
    guess = sw.Noise()
    assert (guess.slip, guess.side_slip) == (0.03, 0.03)
    assert sw.Noise(yaw_rate=0.002).slip == 0.03  # says nothing of the wheels
    assert (sw.Noise(speed=0.02).slip, sw.Noise(steering=0.02).side_slip, sw.Noise(slip=0.02).side_slip) == (
        0,
    ) * 3
    assert eval(repr(guess), {"Noise": sw.Noise}) == guess
