"""Noise of a gyroscope: simulated values lie within the estimated intervals as often as these claim."""

import math
import os
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("scipy")

import six_wheel as sw
from six_wheel.calibration import calibrate
from six_wheel.calibration.gyroscope.noise import measure
from six_wheel.calibration.gyroscope.scale import mistaken, scale
from six_wheel.logs import WheelLog
from tests.rovers import SMALL_PAIR as PAIR

KNOWN = sw.Gyroscope(0.002, bias_noise=0.02, bias_walk=5e-4)
SOAK = int(os.environ.get("SOAK", "1"))


def rest(seed: int, rows: int = 400, dt: float = 0.02) -> WheelLog:
    """A rover that rests, drives for 20 s and rests: only what it reads at rest is looked at."""
    random = np.random.default_rng(seed)
    stamps = dt * np.arange(2 * rows)
    stamps[rows:] += 20.0
    steps = KNOWN.bias_walk * np.sqrt(np.diff(stamps)) * random.standard_normal(2 * rows - 1)
    bias = KNOWN.bias_noise * random.standard_normal() + np.append(0.0, np.cumsum(steps))
    angles = np.where(stamps < stamps[rows], 0.0, 50.0)[:, None] * np.ones(2)
    return WheelLog(stamps, None, angles, yaw_rate=bias + KNOWN.noise * random.standard_normal(2 * rows))


@pytest.mark.slow
def test_noise_that_was_put_in_is_in_its_intervals():
    """Of 40 times two intervals of 95 %, 76 are meant to hold, give or take three deviations of 2."""
    held, count = 0, 40 * SOAK
    for seed in range(count):
        found = measure([rest(seed)], 0.95)
        for one, true in ((found.noise, KNOWN.noise), (found.bias_walk, KNOWN.bias_walk)):
            held += one.interval[0] <= true <= one.interval[1]
    spread = math.sqrt(2 * count * 0.95 * 0.05)
    assert abs(held - 0.95 * 2 * count) <= 3.0 * spread


@pytest.mark.slow
def test_more_rest_tells_more_and_logs_go_together():
    few, many = measure([rest(1)], 0.95), measure([rest(seed) for seed in range(16)], 0.95)
    width = [one.noise.interval[1] - one.noise.interval[0] for one in (few, many)]
    assert width[1] == pytest.approx(width[0] / 4.0, rel=0.1)  # the root of the number of readings
    assert many.period == pytest.approx(0.02)
    assert many.bias == pytest.approx(
        np.sqrt(np.mean([rest(k).yaw_rate.mean() ** 2 for k in range(16)])), rel=0.05
    )


def test_a_wandering_that_does_not_show_is_the_usual_one():
    log = rest(3)
    still = replace(log, yaw_rate=0.002 * np.random.default_rng(1).standard_normal(len(log)))
    found = measure([still], 0.95)
    assert found.bias_walk.interval[0] == 0.0
    guess = sw.Gyroscope().bias_walk
    assert found.known.bias_walk == pytest.approx(min(guess, found.bias_walk.interval[1]), rel=0.01)


def test_what_tells_nothing_is_no_measurement():
    log = rest(1)
    restless = replace(log, wheel_angles=log.wheel_angles + 0.1 * log.stamps[:, None])
    lost, none = replace(log, yaw_rate=np.full(len(log), np.nan)), replace(log, yaw_rate=None)
    for one in (restless, lost, none, replace(log, yaw_rate=np.full(len(log), 0.01))):
        assert measure([one], 0.95) is None


def driven(seed: int, factor: float = 1.0, bias: float = 0.02, rest_first: bool = True) -> WheelLog:
    times = np.linspace(0.0, 40.0, 81)
    twists = np.stack((0.2 + 0 * times, 0 * times, 0.8 * np.sin(0.5 * times + seed)), axis=-1)
    twists[: 8 if rest_first else 0] = 0.0
    known = sw.Gyroscope(0.002, bias=bias, bias_noise=0.0, bias_walk=0.0)
    log = sw.simulate(
        PAIR, (times, twists), gyroscope=known, noise=sw.Noise(0, 0, slip=0.003), rate=20.0, seed=seed
    )
    return replace(log, yaw_rate=log.yaw_rate / factor)


@pytest.mark.parametrize("rest_first", [True, False])
def test_a_truth_tells_the_scale(rest_first):
    logs = [driven(seed, 1.05, rest_first=rest_first) for seed in range(4)]
    found = scale(logs, 0.0, 0.99)
    assert found.interval[0] < 1.05 < found.interval[1] < 1.06
    assert scale([replace(log, truth=None) for log in logs], 0.0, 0.99) is None
    assert scale(logs[:1], 0.0, 0.99).interval[0] < 1.05  # thirds of one log


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (1.0, ""),
        (-1.0, "counts the other way than the wheels: if it hangs upside down, give gyroscope.roll: 3.14159"),
        (math.pi / 180.0, "if its rates are in degrees, write deg/s into the header"),
    ],
)
def test_a_gyroscope_that_is_read_wrongly_is_named(factor, words):
    said = mistaken(PAIR, [driven(1, factor)])
    assert words in " ".join(said)
    assert bool(said) == bool(words)
    other = replace(driven(1), yaw_rate=0.02 + np.cos(3.0 * driven(1).stamps))
    assert "does not turn as the wheels say" in mistaken(PAIR, [other])[0]


def test_a_calibration_has_all_of_it():
    log = driven(1, -1.0)
    result = calibrate(PAIR, log, parameters=["track_width"], cross_validation=False)
    assert any("counts the other way" in message for message in result.observability.messages)
    factor = result.gyroscope.scale
    assert factor.value == pytest.approx(-1.0, abs=0.02)
    assert result.gyroscope.known.scale_noise == pytest.approx(factor.std / -factor.value, rel=0.01)
    report = result.to_markdown()
    assert "A reading of the gyroscope errs by" in report
    assert "Its readings are to be multiplied by" in report
    assert "from" in repr(result.gyroscope)
    odometry = sw.Odometry(result.rover, **result.known)
    assert odometry.gyroscope_bias == (0.0, result.gyroscope.known.bias_noise)


def test_a_gyroscope_that_never_rests_is_said_not_to_be_known():
    """Its key was missing in the file, and nobody said why."""
    restless = replace(driven(1), wheel_angles=driven(1).wheel_angles + 0.1 * driven(1).stamps[:, None])
    result = calibrate(PAIR, restless, parameters=["wheel_radius"], cross_validation=False)
    assert result.gyroscope is None
    assert "what the gyroscope errs by is not known" in " ".join(result.observability.messages)


def test_a_gyroscope_of_a_log_counts_as_a_guess_unless_something_is_said():
    log = driven(2, bias=0.1, rest_first=True)
    guessed = sw.dead_reckon(PAIR, log)
    said = sw.dead_reckon(PAIR, log, gyroscope=sw.Gyroscope())
    np.testing.assert_array_equal(guessed.poses, said.poses)
    word = sw.dead_reckon(PAIR, log, yaw_rate=log.yaw_rate)  # at its word, as given
    end = log.truth.poses[-1, 2]
    assert abs(guessed.poses[-1, 2] - end) < 0.2 * abs(word.poses[-1, 2] - end)
