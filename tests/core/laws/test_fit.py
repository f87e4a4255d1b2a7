"""Wheels to twist: which wheel is at fault, and what that does to each method."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from tests.rovers import SIX_WHEELS
from tests.strategies import forward_twists, six_wheel_rovers

OSR = sw.Rover.preset("open_source_rover")
RADII = [0.0, 0.05, 0.2, 0.45, 1.0, 1.5, 6.4, 100.0, math.inf]


def turning(radius: float) -> tuple[float, float, float]:
    """Half a metre a second about this radius, or a spin."""
    if radius == 0.0:
        return 0.0, 0.0, 1.0
    return 0.5, 0.0, 0.5 / radius


@given(six_wheel_rovers(), forward_twists(), st.sampled_from(["least_squares", "middle_wheels", "robust"]))
def test_consistent_readings_have_no_residual(rover, twist, method):
    fit = rover.fit(*rover.inverse(twist), method=method)
    np.testing.assert_allclose(fit.twist, twist, rtol=0, atol=1e-12)
    assert fit.residuals.max() < 1e-12
    assert fit.rank == 3
    if method != "middle_wheels":
        np.testing.assert_array_equal(np.round(fit.weights, 9), np.ones(6))


@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("wheel", range(6))
def test_one_faulty_wheel_is_named_and_outvoted(radius, side, wheel):
    vx, _, omega = turning(radius)
    twist = np.array([vx, 0.0, side * omega])
    steering, speeds = OSR.inverse(twist)
    # A wheel that stands still cannot turn 50 % too fast.
    if abs(speeds[wheel]) < 0.1 * np.abs(speeds).max():
        speeds[wheel] += 0.5 * np.abs(speeds).max()
    else:
        speeds[wheel] *= 1.5
    fit = OSR.fit(steering, speeds, method="robust")
    size = np.hypot(0.3 * omega, vx)  # a pivot's speed: omega on a straight line has no percent of its own
    assert abs(fit.twist[2] - twist[2]) * 0.3 < 0.01 * size
    assert abs(fit.twist[0] - vx) < 0.01 * size
    assert fit.worst_wheel == OSR.wheel_names[wheel]
    assert np.argmax(fit.residuals) == np.argmin(fit.weights) == wheel


def test_what_a_faulty_middle_wheel_does_to_each_method():
    # The published figures: -123 %, -26.5 % and -0.1 % of omega at R = 1.5 m, one middle wheel reading +50 %.
    twist = (0.5, 0.0, 0.5 / 1.5)
    steering, speeds = OSR.inverse(twist)
    speeds[2] *= 1.5  # middle left
    errors = {
        method: OSR.fit(steering, speeds, method=method).twist[2] / twist[2] - 1
        for method in ("middle_wheels", "least_squares", "robust")
    }
    assert errors["middle_wheels"] == pytest.approx(-1.23, abs=0.005)
    assert errors["least_squares"] == pytest.approx(-0.265, abs=0.0005)
    assert abs(errors["robust"]) < 0.001


def test_middle_wheels_is_the_published_form():
    rover = SIX_WHEELS
    fit = rover.fit([0.1, 0.2, 0.3, 0.4], [9.0, 9.0, 2.0, 5.0, 9.0, 9.0], method="middle_wheels")
    np.testing.assert_allclose(fit.twist, (0.15 * 7 / 2, 0.0, 0.15 * 3 / 0.9), rtol=1e-14, atol=1e-15)
    np.testing.assert_array_equal(fit.weights, (0, 0, 1, 1, 0, 0))


def test_middle_wheels_needs_unsteered_wheels():
    rover = sw.Rover.swerve([(0.3, 0.2), (-0.3, -0.2)], 0.1)
    with pytest.raises(ValueError, match="method must be another one for a rover without unsteered wheels"):
        rover.fit([0.0, 0.0], [1.0, 1.0], method="middle_wheels")


def test_noise_hurts_least_squares_less():
    # 1 cm/s and 0.5 degree of noise: the spread is 1.8 times smaller in v and 3.1 times in omega.
    generator = np.random.default_rng(7)
    steering, speeds = OSR.inverse(np.tile([0.3, 0.0, 0.2], (20_000, 1)))
    steering += generator.normal(0, math.radians(0.5), steering.shape)
    speeds += generator.normal(0, 0.01 / 0.075, speeds.shape)
    spread = {
        m: OSR.fit(steering, speeds, method=m).twist.std(axis=0) for m in ("middle_wheels", "least_squares")
    }
    ratio = spread["middle_wheels"] / spread["least_squares"]
    print(f"least squares spreads {ratio[0]:.2f} times less in vx, {ratio[2]:.2f} times less in omega")
    assert ratio[0] > 1.5
    assert ratio[2] > 2.0


def test_batches_and_single_fits_agree():
    twists = np.array([turning(radius) for radius in RADII]).reshape(3, 3, 3)
    steering, speeds = OSR.inverse(twists)
    speeds[1, 2, 4] *= 1.5
    fit = OSR.fit(steering, speeds, method="robust")
    one = OSR.fit(steering[1, 2], speeds[1, 2], method="robust")
    np.testing.assert_array_equal(fit.twist[1, 2], one.twist)
    np.testing.assert_array_equal(fit.residuals[1, 2], one.residuals)
    assert fit.worst_wheel[1][2] == one.worst_wheel == "rear_left"
    assert repr(one).startswith("TwistFit(twist=[")
