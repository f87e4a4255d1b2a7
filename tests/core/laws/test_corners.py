"""Corners: pauses, joints beyond their limits, twists that nobody knows, axles that are nearly parallel."""

import math

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import reference
from six_wheel.kinematics.controller import Reason
from tests.limits import only
from tests.rovers import CART

ROVER = sw.Rover.preset("perseverance")
LIMITS = sw.Limits(
    speed=1.0, acceleration=0.5, jerk=1.0, steering_limit=0.5, steering_rate=0.4, steering_acceleration=1.0
)


# Controller


def test_after_a_pause_acceleration_begins_again():
    """The output was held meanwhile: what comes next changes from rest, within the jerk."""
    rover = CART
    limits = sw.Limits(speed=1.0, acceleration=0.5, jerk=1.0)
    controller = sw.Controller(rover, limits, timeout=None)
    controller.command((1.0, 0.0, 0.0), 0.0)
    speeds = [controller.step(k * 0.05).twist[0] for k in range(9)]
    assert speeds[-1] - speeds[-2] > 0.01  # it was accelerating
    out = controller.step(3600.0)
    assert out.reasons & Reason.PAUSED
    assert out.twist[0] - speeds[-1] <= 1.0 * 0.1**2 / 2 + 1e-12  # jerk over the longest step, from 0
    following = [out.twist[0], *(controller.step(3600.0 + k * 0.05).twist[0] for k in range(1, 40))]
    accelerations = np.diff(following) / 0.05
    assert np.abs(np.diff(accelerations)).max() <= 1.0 * 0.05 + 1e-9


@pytest.mark.parametrize("mode", ["free", "crab", "front_only", "spin"])
def test_joints_beyond_their_limit_come_back_inside_at_their_rate(mode):
    controller = sw.Controller(ROVER, LIMITS, mode=mode, timeout=None)
    measured, dt = np.array([0.6, -0.7, 0.54, 0.0]), 0.05
    before, inside = measured, False
    for k in range(200):
        out = controller.step(k * dt, before)
        change = np.abs(out.steering - before).max()
        assert change <= 0.4 * dt + 1e-9
        inside = bool((np.abs(out.steering) <= 0.5 + 1e-12).all())
        if not inside and k > 1:
            assert out.reasons & (Reason.STEERING_RATE | Reason.STEERING_ACCELERATION)
        before = out.steering
    assert inside
    if mode == "front_only":
        np.testing.assert_allclose(before[2:], 0.0, atol=1e-12)


def test_measured_angles_beyond_a_limit_are_no_error_later_either():
    controller = sw.Controller(ROVER, LIMITS)
    controller.command((0.5, 0.0, 0.1), 0.0)
    controller.step(0.0)
    out = controller.step(0.1, [0.0, 0.0, 1.2, 0.0])
    assert out.reasons & Reason.ALIGNING


@pytest.mark.parametrize("name", ["acceleration", "jerk", "wheel_acceleration", "steering_acceleration"])
@pytest.mark.parametrize("limit", [1e100, 1e200, 9.3e304, 1.7e308])
def test_limits_too_large_to_meet_are_none(name, limit):
    """Found by fuzzing: their squares are no numbers."""
    controller = sw.Controller(ROVER, only(**{name: limit}), timeout=None)
    controller.command((100.0, 0.0, 10.0), 0.0)
    for k in range(20):
        out = controller.step(0.02 * k)
        assert np.isfinite([*out.steering, *out.steering_rates, *out.wheel_speeds, *out.twist]).all()
    np.testing.assert_allclose(out.twist, (100.0, 0.0, 10.0))


# Odometry


def known(covariance: np.ndarray) -> bool:
    return bool(np.isfinite(covariance).all())


def test_a_twist_that_nobody_knows_has_an_infinite_variance():
    odometry = sw.Odometry(ROVER)
    assert np.isinf(np.diag(odometry.state.twist_covariance)).all()
    state = odometry.update([0.0] * 4, [0.0] * 6, 0.0)
    assert np.isinf(np.diag(state.twist_covariance)).all()  # the first sample
    assert (np.diag(state.twist_covariance_6x6()) == 1e6).all()
    state = odometry.update([0.0] * 4, [0.1] * 6, 0.1)
    assert known(state.twist_covariance)
    assert (np.diag(state.twist_covariance) > 0.0).all()
    odometry.set_pose((1.0, 2.0, 0.0))
    assert np.isinf(np.diag(odometry.state.twist_covariance)).all()
    odometry.reset()
    odometry.command((0.1, 0.0, 0.0), 0.0)
    state = odometry.command((0.1, 0.0, 0.0), 1.0)
    assert np.isinf(np.diag(state.twist_covariance)).all()


@pytest.mark.parametrize("gap", [1e-9, 1.0, 1e4, 1e8, 1e12])
def test_no_stamps_give_a_negative_variance(gap):
    odometry = sw.Odometry(ROVER, sw.Noise(0.01, 0.009, slip=0.01))
    generator, stamp, turned = np.random.default_rng(1), 0.0, np.zeros(6)
    for k in range(60):
        steering = generator.uniform(-0.3, 0.3, 4)
        stamp += gap if k == 20 else 0.1
        turned = turned + generator.normal(size=6) * (1e3 if k == 20 else 1.0)
        covariance = odometry.update(steering, turned, stamp).covariance
        assert (np.diag(covariance) >= 0.0).all()
        pairs = [(0, 1), (0, 2), (1, 2)]
        for i, j in pairs:
            assert abs(covariance[i, j]) <= math.sqrt(covariance[i, i] * covariance[j, j]) * (1 + 1e-6)


def test_no_rover_gives_a_negative_variance_of_its_twist():
    """Found by fuzzing: wheels close together and far from the origin."""
    rover = sw.Rover(
        [
            sw.Wheel("a", 638.6, 634.4, radius=344.0, steered=True),
            sw.Wheel("b", 634.4, 634.4, radius=634.4, trail=634.4, driven=False),
        ]
    )
    odometry = sw.Odometry(rover, sw.Noise(0.01, 0.009, slip=0.02), readings="speeds")
    generator = np.random.default_rng(2)
    odometry.update([0.0], [0.0, 0.0], 0.0)
    for k in range(1, 500):
        steering, speeds = generator.normal(size=1) * 0.01, generator.normal(size=2) * 300.0
        assert (np.diag(odometry.update(steering, speeds, 0.1 * k).twist_covariance) >= 0.0).all()


def test_time_that_a_command_was_held_counts_once():
    odometry = sw.Odometry(ROVER)
    odometry.command((0.1, 0.0, 0.0), 0.0)
    state = odometry.command((0.1, 0.0, 0.0), 10.0)
    assert state.stamp == 10.0
    with pytest.raises(
        ValueError, match="^stamp must not be before the end of the last command, 10.0, got 5.0"
    ):
        odometry.update([0.0] * 4, [0.0] * 6, 5.0)
    odometry.update([0.0] * 4, [0.0] * 6, 10.0)
    state = odometry.command((0.1, 0.0, 0.0), 12.0)
    assert state.pose[0] == pytest.approx(1.2, rel=1e-12)
    assert state.stamp == 12.0
    odometry.set_pose((0.0, 0.0, 0.0))
    assert odometry.command((0.1, 0.0, 0.0), 13.0).pose[0] == pytest.approx(0.1, rel=1e-12)


def test_a_log_that_raises_leaves_everything_as_it_was():
    odometry = sw.Odometry(ROVER)
    odometry.update([0.0] * 4, [0.0] * 6, 0.0)
    wheels = np.tile(np.arange(1.0, 6.0)[:, None], (1, 6))
    wheels[3, 2] = math.nan
    with pytest.raises(ValueError, match=r"^wheel_angles\[3\] must be finite"):
        odometry.run(np.zeros((5, 4)), wheels, np.arange(1.0, 6.0), errors="raise")
    assert odometry.state.stamp == 0.0
    np.testing.assert_array_equal(odometry.state.pose, 0.0)


# Estimates


def test_no_wheel_is_the_worst_where_all_agree():
    cart = CART
    fit = cart.fit(None, [0.0, 0.0])
    assert (fit.residuals == 0.0).all()
    assert fit.worst_wheel is None
    many = ROVER.fit([0.0] * 4, [[0.0] * 6, [1.0, 0, 0, 0, 0, 0]])
    assert many.worst_wheel[0] is None
    assert isinstance(many.worst_wheel[1], str)


def cart_with(heading: float) -> sw.Rover:
    """Four fixed wheels on two axles, one of them out of true."""
    places = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)]
    return sw.Rover(
        [
            sw.Wheel(f"w{k}", x, y, radius=0.1, heading=heading if k == 0 else 0.0)
            for k, (x, y) in enumerate(places)
        ]
    )


HEADINGS = [
    0.0,
    1e-12,
    1e-9,
    1.1e-9,
    1e-8,
    1e-6,
    1e-4,
    1e-3,
    0.01,
    0.1,
    0.17,
    0.1745,
    0.175,
    0.3,
    math.pi / 2,
]


def test_forward_is_continuous_in_the_headings():
    speeds = [-4.0, 4.0, -4.0, 4.0]
    straight = cart_with(0.0).forward(None, speeds)
    for heading in HEADINGS:
        found = cart_with(heading).forward(None, speeds)
        assert np.abs(found - straight).max() <= 20.0 * heading  # [1/s]: no jump anywhere near parallel
    # No step of a fine walk from parallel to well apart is more than its length allows.
    walk = np.linspace(0.0, 0.3, 3001)
    twists = np.array([cart_with(float(heading)).forward(None, speeds) for heading in walk])
    assert np.abs(np.diff(twists, axis=0)).max() <= 20.0 * (walk[1] - walk[0])


def test_the_reference_shares_rows_alike():
    speeds = np.array([1.0, 2.0, -1.0, 3.0])
    for heading in [*HEADINGS, math.pi, math.pi - 0.05, -0.1]:
        rover = cart_with(heading)
        plain = reference.Rover(
            [reference.Wheel(w.name, w.x, w.y, radius=w.radius, heading=w.heading) for w in rover.wheels]
        )
        # Headings that count as the same are those of the first wheel.
        atol = 1e-12 + (2 * heading if 0.0 < heading < 2e-9 else 0.0)
        np.testing.assert_allclose(rover.forward(None, speeds), plain.forward(None, speeds), atol=atol)
        for kernel in sw.simd_levels():
            many = rover.forward(None, np.tile(speeds, (9, 1)), level=kernel)
            np.testing.assert_allclose(many[4], rover.forward(None, speeds), atol=1e-12)


@pytest.mark.parametrize("heading", [0.0, 0.05, 0.1])
@pytest.mark.parametrize("quantity", ["x", "y", "trail"])
def test_derivatives_of_shared_rows(heading, quantity):
    """Central differences, whose error is about 1e-6 squared and rounding over 1e-6."""
    speeds, rover = [1.0, 2.0, -1.0, 3.0], cart_with(heading)
    found = getattr(rover.sensitivity(None, speeds), quantity)
    for k, wheel in enumerate(rover.wheels):
        ends = []
        for step in (1e-6, -1e-6):
            wheels = list(rover.wheels)
            size = {name: getattr(wheel, name) for name in ("x", "y", "radius", "heading", "trail")}
            size[quantity] += step
            wheels[k] = sw.Wheel(wheel.name, **size)
            ends.append(sw.Rover(wheels).forward(None, speeds))
        np.testing.assert_allclose(found[:, k], (ends[0] - ends[1]) / 2e-6, atol=1e-7)


def test_kernels_agree_as_the_condition_allows():
    """5 ulp or 1e-14, times the condition number of the wheels' rows."""
    generator = np.random.default_rng(5)
    for lever in [1.0, 1e-2, 1e-3]:
        rover = sw.Rover(
            [
                sw.Wheel("a", 0.5, lever, radius=0.1, heading=0.3),
                sw.Wheel("b", -0.5, 0.0, radius=0.1, steered=True),
                sw.Wheel("c", 0.5 + lever, 0.0, radius=0.1, heading=0.3),
            ]
        )
        steering, speeds = generator.normal(size=(200, 1)), generator.normal(size=(200, 3)) * 10
        plain = rover.forward(steering, speeds, level="scalar")
        fit = rover.fit(steering, speeds)
        largest = math.sqrt(2 * 3 * (1.0 + 2.0))  # of six rows no longer than that
        condition = largest / fit.sigma_min
        scale = np.abs(speeds).max(axis=1) * 0.1 * 3
        allowed = np.maximum(5 * np.spacing(scale), 1e-14) * condition
        for kernel in sw.simd_levels():
            found = rover.forward(steering, speeds, level=kernel)
            assert (np.abs(found - plain).max(axis=1) <= allowed).all()


def test_what_no_rover_has_is_not_taken_in():
    """Found by fuzzing: squares of such numbers are infinite, and a pose that was NaN once would stay so."""
    with pytest.raises(ValueError, match="heading must be an angle, at most 1000 rad, got -5.4e274"):
        sw.Wheel("w", 0.0, 0.0, radius=0.1, heading=-5.4e274)
    with pytest.raises(ValueError, match="radius must be at least 1e-60, got 1.9e-309"):
        sw.Wheel("w", 0.0, 0.0, radius=1.9e-309)
    with pytest.raises(ValueError, match=r"scrub must be smaller than 1e60, got -1\.7375"):
        sw.Wheel("w", 3.0, 0.01, radius=0.01, steered=True, steering_limit=0.01, scrub=-1.737594360102449e308)
    odometry = sw.Odometry(ROVER)
    odometry.update([0.0] * 4, [0.0] * 6, 0.0)
    spatial = sw.Odometry3(sw.RockerBogie.preset("perseverance"))
    spatial.update([0.0] * 4, [0.0] * 6, 0.0, joints=[0.0] * 3, attitude=[0.0, 0.0])
    for estimate, far in ((odometry, (0.0, -1e160, 0.0)), (spatial, (0.0, -1e160, 0.0, 0.0, 0.0, 0.0))):
        before = estimate.state.pose
        for tell in (
            lambda: estimate.set_pose(far),  # noqa: B023
            lambda: estimate.correct(far, 0.0, [1.0, 1.0, 1.0]),  # noqa: B023
        ):
            with pytest.raises(ValueError, match="pose must be smaller than 1e60 in every part"):
                tell()
        # A variance as large as numbers go says nothing, as an infinite one.
        estimate.correct(before, 0.0, [1.7e308, 1.7e308, 1.7e308])
        np.testing.assert_array_equal(estimate.state.pose, before)
    # Whole turns were taken out of a yaw without digits by a product that has none either.
    odometry.set_pose((0.0, 0.0, 2e56))
    for stamp in (0.1, 0.2):
        odometry.update([0.0] * 4, [stamp] * 6, stamp)
    assert np.hypot(*odometry.state.pose[:2]) == pytest.approx(0.2 * ROVER.wheels[0].radius, rel=1e-12)
    # A step that was refused left the noise that it was refused for.
    before = odometry.state.twist_covariance
    with pytest.raises(ValueError, match="wheel_angles must be small enough"):
        odometry.update([0.0] * 4, [1e59] * 6, 0.3)
    np.testing.assert_array_equal(odometry.state.twist_covariance, before)
    with pytest.raises(ValueError, match="jerk must be at least 1e-60, got 5e-324"):
        sw.Limits(jerk=5e-324)
    # A rate of 5e303 rad/s turned a wheel with scrub at no number.
    assert sw.Limits(steering_rate=5e303) == sw.Limits(steering_rate=math.inf)
    controller = sw.Controller(ROVER, only())
    assert not controller.command((1e300, 0.0, 0.0), 0.0)
    with pytest.raises(ValueError, match="twist must be small enough for a possible twist beside it"):
        sw.Rover(
            [sw.Wheel("w", 0.0, 0.0, radius=1e45, steered=True, steering_limit=(-16.0, 511.0), trail=5e2)]
        ).project((-563.0, 0.2, -5.8e303))
