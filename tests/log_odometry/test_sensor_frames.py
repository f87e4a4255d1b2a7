"""A lever arm: the track of what sits somewhere in the body, poses, twists and covariances."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import six_wheel as sw
from tests.rovers import PAIR

SENSOR = (0.25, -0.1, 0.3)
STAMPS = 0.05 * np.arange(120)
TOTALS = np.cumsum(np.column_stack((0.2 + 0.1 * np.sin(STAMPS), 0.25 + 0 * STAMPS)), axis=0)
NOISE = sw.Noise(speed=0.02, slip=0.01)


def reckon(**options):
    return sw.dead_reckon(PAIR, None, TOTALS, STAMPS, noise=NOISE, **options)


def test_the_sensor_is_carried_by_the_body():
    body, seen = reckon(), reckon(sensor=SENSOR, start=SENSOR)
    arm = np.broadcast_to(SENSOR, body.poses.shape)
    assert_allclose(seen.poses, sw.compose(body.poses, arm), rtol=0, atol=1e-12)
    # It moves as its twists say: exactly, for these are constant over a step.
    steps = np.diff(STAMPS)
    assert_allclose(sw.integrate(seen.twists[1:], steps, start=SENSOR), seen.poses, rtol=0, atol=1e-12)


def test_its_covariance_is_that_of_drawn_bodies():
    """Of poses drawn about the last one: 4 deviations of 200000 draws, and what is left of second order."""
    body, seen = reckon(), reckon(sensor=SENSOR, start=SENSOR)
    random = np.random.default_rng(0)
    spread = 1e-4 * body.covariances[-1] / np.trace(body.covariances[-1])
    scale = spread[0, 0] / body.covariances[-1][0, 0]
    drawn = random.multivariate_normal(body.poses[-1], spread, 200_000)
    sampled = np.cov(sw.compose(drawn, np.broadcast_to(SENSOR, drawn.shape)), rowvar=False)
    wanted = scale * seen.covariances[-1]
    room = 4.0 * np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)) * 2.0 / len(drawn))
    assert (np.abs(sampled - wanted) < room + 1e-2 * np.abs(wanted)).all()


def test_what_is_known_of_its_start_goes_back_and_forth():
    known = np.diag([1e-4, 4e-4, 1e-3])
    track = reckon(sensor=SENSOR, start=(1.0, 2.0, -0.7), start_covariance=known)
    assert_allclose(track.poses[0], (1.0, 2.0, -0.7), rtol=0, atol=1e-14)
    assert_allclose(track.covariances[0], known, rtol=0, atol=1e-16)
    assert_allclose(
        reckon(sensor=SENSOR, start_covariance=(1e-4, 4e-4, 1e-3)).covariances[0], known, rtol=0, atol=1e-16
    )


def test_at_the_origin_nothing_changes():
    assert_allclose(reckon(sensor=(0, 0, 0)).poses, reckon().poses, rtol=0, atol=0)


@pytest.mark.parametrize("sensor", [(0.1, 0.2), (0.1, 0.2, np.nan), 0.3])
def test_a_mount_is_three_finite_numbers(sensor):
    with pytest.raises(ValueError, match="sensor must be three finite numbers, x, y and yaw"):
        reckon(sensor=sensor)
