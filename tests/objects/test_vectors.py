"""Twists are vectors, poses the group SE(2): what means nothing is refused."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import six_wheel as sw

NUMBERS = st.floats(-5.0, 5.0)
TWISTS = st.builds(sw.Twist, NUMBERS, NUMBERS, NUMBERS)
POSES = st.builds(sw.Pose, NUMBERS, NUMBERS, NUMBERS)
ROUNDING = 1e-12  # of sums and products of numbers up to 5, several hundred units in the last place


@given(TWISTS, TWISTS, NUMBERS)
def test_twists_are_a_vector_space(a, b, factor):
    assert a + b == b + a == tuple(np.add(a, b))
    assert a - b == -(b - a)
    assert_allclose(factor * (a + b), factor * a + factor * b, atol=ROUNDING)
    assert 2 * a == a * 2 == a + a
    assert (2.0 * a) / 2.0 == a
    assert type(np.float64(2.0) * a) in (sw.Twist, np.ndarray)
    assert all(
        type(each) is sw.Twist for each in (sum((a, b), sw.Twist()), (1, 2, 3) - a, -a, +a, a / 2, 2 * a)
    )


@given(TWISTS, NUMBERS)
def test_a_field_relative_twist_is_the_same_motion(twist, yaw):
    body = twist.to_body(yaw)
    assert_allclose(body.to_world(yaw), twist, atol=ROUNDING)
    assert math.hypot(body.vx, body.vy) == pytest.approx(math.hypot(twist.vx, twist.vy), abs=ROUNDING)
    assert sw.Pose(1.0, 2.0, yaw).to_body(twist) == body
    ahead = sw.Pose(0.0, 0.0, yaw) @ (body.vx, body.vy, 0.0)  # the body goes where the world's axes say
    assert_allclose(ahead[:2], twist[:2], atol=ROUNDING)


@given(TWISTS, st.floats(0.01, 0.5))
def test_a_discretized_twist_ends_where_the_velocity_points(twist, dt):
    assert_allclose(sw.exp(twist.discretized(dt), dt), np.multiply(twist, dt), atol=ROUNDING)


@given(POSES, POSES, POSES)
def test_poses_are_a_group(a, b, c):
    assert_allclose(a @ a.inverse(), (0.0, 0.0, 0.0), atol=ROUNDING)
    assert_allclose((a @ b) @ c, a @ (b @ c), atol=1e-11)  # numbers grow by each of the poses
    assert_allclose((a @ b).inverse(), b.inverse() @ a.inverse(), atol=1e-11)
    assert a @ b == tuple(sw.compose(a, b))
    assert type((1.0, 2.0, 0.1) @ a) is sw.Pose


@given(POSES, POSES, st.floats(0.0, 1.0))
def test_a_pose_between_two_is_on_the_way(a, b, share):
    step = a.between(b)
    assert abs(step.yaw) <= math.pi + ROUNDING
    assert_allclose((a @ step)[:2], b[:2], atol=1e-11)
    assert_allclose(sw.wrap_angle((a @ step).yaw - b.yaw), 0.0, atol=1e-11)
    assert a.interpolate(b, 0.0) == pytest.approx(a, abs=ROUNDING)
    assert a.interpolate(b, 1.0)[:2] == pytest.approx(b[:2], abs=1e-10)
    # Two shares of one arc make their sum.
    first, whole = a.interpolate(b, share / 2.0), a.interpolate(b, share)
    assert first @ a.between(first) == pytest.approx(whole, abs=1e-10)


def test_the_group_takes_arrays():
    poses = np.random.default_rng(0).normal(size=(4, 5, 3))
    first, second = poses[:, :1], poses
    assert_allclose(sw.se2.compose(sw.se2.inverse(poses), poses), 0.0, atol=ROUNDING)
    seen = sw.se2.between(first, second)
    assert seen.shape == (4, 5, 3)
    assert_allclose(seen[2, 3], sw.Pose(*first[2, 0]).between(second[2, 3]), atol=ROUNDING)
    shares = np.linspace(0.0, 1.0, 5)
    found = sw.se2.interpolate(first, second, shares)
    assert_allclose(found[1, 2], sw.Pose(*first[1, 0]).interpolate(second[1, 2], 0.5), atol=ROUNDING)
    with pytest.raises(ValueError, match=r"pose must have shape \(..., 3\), got \(2,\)"):
        sw.se2.inverse((0.0, 1.0))


def test_what_has_no_meaning_is_refused():
    twist, pose = sw.Twist(1.0), sw.Pose(1.0, 2.0, 0.3)
    assert twist == (1.0, 0.0, 0.0) == sw.Twist(vx=1)
    for wrong in (lambda: pose + pose, lambda: 2 * pose, lambda: pose * 2, lambda: -pose, lambda: pose / 2,
                  lambda: pose - (0, 0, 0), lambda: abs(pose)):  # fmt: skip
        with pytest.raises(TypeError, match="poses do not add or scale: pose @ other composes"):
            wrong()
    with pytest.raises(TypeError, match="a twist has no length: metres and radians do not add"):
        abs(twist)
    with pytest.raises(TypeError, match=r"\+ needs three numbers beside it, got \(1, 2\)"):
        twist.__add__((1, 2))
    with pytest.raises(TypeError):
        twist * twist
    with pytest.raises(TypeError):
        twist * "2"
    with pytest.raises(ValueError, match="dt must be finite and positive, got 0.0"):
        twist.discretized(0.0)
    with pytest.raises(TypeError, match="@ needs three numbers beside it"):
        pose @ (1.0, 2.0)


def test_a_pose_is_not_added_to_a_twist():
    """``pose + twist`` was refused, ``twist + pose`` was a twist."""
    for call in (lambda: sw.Twist(1.0) + sw.Pose(1, 2, 3), lambda: sw.Twist(1.0) - sw.Pose(1, 2, 3)):
        with pytest.raises(TypeError, match="^poses do not add or scale: pose @ other composes"):
            call()


def test_numbers_that_are_none_are_refused_by_their_names():
    for wrong in (math.nan, math.inf):
        with pytest.raises(ValueError, match=f"^yaw must be finite, got {wrong}$"):
            sw.Twist(1.0).to_body(wrong)
        with pytest.raises(ValueError, match=f"^share must be finite, got {wrong}$"):
            sw.Pose(1, 2, 3).interpolate((0, 0, 0), wrong)
        with pytest.raises(ValueError, match=f"^share must be finite, got {wrong}$"):
            sw.se2.interpolate((1, 2, 3), (0, 0, 0), [0.0, wrong])


def test_wheel_speeds_are_slowed_down_together():
    rover = sw.Rover.preset("perseverance")
    steering, speeds = rover.inverse([(0.5, 0.0, 0.1), (0.01, 0.0, 0.0)])
    slow = rover.desaturate(speeds, 0.5)
    assert np.abs(slow[0]).max() == pytest.approx(0.5, rel=1e-15)
    np.testing.assert_array_equal(slow[1], speeds[1])
    before, after = rover.forward(steering, speeds), rover.forward(steering, slow)
    assert_allclose(
        after[0] / before[0, 0] * before[0, 0] / after[0, 0], before[0] / before[0, 0], atol=1e-12
    )
    each = rover.desaturate(speeds[0], [9, 9, 0.1, 9, 9, 9])
    assert abs(each[2]) == pytest.approx(0.1)
    for wrong, rule in (
        ((speeds[:, :5], 1.0), r"speeds must have shape \(..., 6\)"),
        ((speeds, 0.0), "positive"),
        ((speeds, [1.0]), "max_wheel_speed must have shape"),
        (([np.nan] * 6, 1.0), "finite"),
    ):
        with pytest.raises(ValueError, match=rule):
            rover.desaturate(*wrong)


def test_the_pose_at_an_instant_is_on_the_arc_of_its_step():
    rover = sw.Rover.preset("perseverance")
    odometry = sw.Odometry(rover, lag=1.0)
    twist = (0.1, 0.0, 0.05)
    steering, speeds = rover.inverse(twist)
    with pytest.raises(ValueError, match="stamp must be finite and follow a first sample"):
        odometry.at(0.0)
    for stamp in np.arange(11) * 0.1:
        odometry.update(steering, speeds * stamp, stamp)
    for stamp in (0.33, 0.7, 1.0, 1.25):
        assert_allclose(odometry.at(stamp), sw.exp(twist, stamp), atol=1e-9)  # least squares of six wheels
    assert type(odometry.at(1.0)) is sw.Pose
    np.testing.assert_array_equal(odometry.at(1.0), odometry.state.pose)
    for stamp in (-0.5, 2.5, math.nan):
        with pytest.raises(ValueError, match="stamp must be"):
            odometry.at(stamp)
