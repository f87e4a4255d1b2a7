"""Commands that went wrong for users elsewhere and do not here: every test has the name of such a failure.

It cites where it was told, as ``owner/repository#number``. Nothing of theirs is used.
"""

import math

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.kinematics.controller import Reason
from tests.limits import only
from tests.neighbours.vehicles import MARS, SWERVE, drive
from tests.rovers import CAR, CART, MECANUM


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", [0, 2])
def test_a_command_of_nan_drove_backwards_at_full_speed(bad, place):
    """ros-controls/ros_controllers#283, #469"""
    controller = sw.Controller(CART, sw.Limits(speed=1.0, acceleration=1.0))
    last = drive(controller, (0.5, 0.0, 0.0), 1.0)[-1]
    command = [0.5, 0.0, 0.0]
    command[place] = bad
    assert not controller.command(command, 1.0)
    out = controller.step(1.0)
    np.testing.assert_array_equal(out.wheel_speeds, last.wheel_speeds)
    assert out.reasons


def test_a_command_of_nan_turned_the_steering_uncontrollably():
    """4am-robotics/cob_driver#171"""
    controller = sw.Controller(SWERVE, only())
    last = drive(controller, (0.3, 0.1, 0.0), 0.5)[-1]
    controller.command((math.nan, math.nan, math.nan), 0.5)
    np.testing.assert_array_equal(controller.step(0.5).steering, last.steering)


def test_the_output_stayed_nan_after_one_bad_command():
    """autowarefoundation/autoware_universe#13239"""
    controller = sw.Controller(CART, sw.Limits(acceleration=1.0))
    controller.command((math.nan, 0.0, 0.0), 0.0)
    controller.step(0.0)
    out = drive(controller, (0.3, 0.0, 0.0), 1.0, start=0.02)[-1]
    np.testing.assert_allclose(out.twist, (0.3, 0.0, 0.0))
    assert not out.reasons


@pytest.mark.parametrize("rover", [CAR, SWERVE, MARS], ids=["car", "swerve", "mars"])
def test_the_wheels_straightened_at_a_timeout(rover):
    """ros-controls/ros2_controllers#1289"""
    controller = sw.Controller(rover, sw.Limits(steering_rate=2.0, acceleration=1.0), timeout=0.2)
    held = drive(controller, (0.3, 0.0, 0.1), 3.0)[-1].steering
    assert np.abs(held).max() > 0.01
    outs = [controller.step(3.0 + k / 50.0) for k in range(100)]
    assert outs[-1].reasons & Reason.STALE
    np.testing.assert_array_equal(outs[-1].wheel_speeds, 0.0)
    np.testing.assert_allclose(outs[-1].steering, held, atol=1e-12)


def test_the_wheels_straightened_at_a_stop():
    """ros-controls/ros2_controllers#1283: a command of zero says nothing of an angle."""
    steering, _ = CAR.inverse((0.5, 0.0, 0.1))
    held, speeds = CAR.inverse((0.0, 0.0, 0.0), previous=steering)
    np.testing.assert_array_equal(held, steering)
    np.testing.assert_array_equal(speeds, 0.0)


@pytest.mark.parametrize("speed", [1e-9, 1e-3, 1.0, 50.0])
def test_the_steering_angle_depended_on_the_speed(speed):
    """ros-controls/ros2_controllers#1283"""
    turn, _ = CAR.inverse((speed, 0.0, 0.1 * speed))
    np.testing.assert_allclose(turn, CAR.inverse((1.0, 0.0, 0.1))[0], rtol=0, atol=1e-14)


def test_after_a_timeout_no_command_was_taken_any_more():
    """ros-controls/ros2_controllers#1683"""
    controller = sw.Controller(MECANUM, only(), timeout=0.2)
    drive(controller, (0.3, 0.1, 0.0), 0.5)
    for k in range(50):
        stopped = controller.step(0.5 + k / 50.0)
    assert stopped.reasons & Reason.STALE
    out = drive(controller, (0.3, 0.1, 0.0), 0.5, start=2.0)[-1]
    np.testing.assert_allclose(out.twist, (0.3, 0.1, 0.0))
    assert not out.reasons


def test_the_planner_died_and_the_robot_drove_on():
    """PR2/pr2_mechanism#25, AutonomyLab/bebop_autonomy#12: a time-out holds without being asked for."""
    controller = sw.Controller(CART, only())
    controller.command((0.5, 0.0, 0.0), 0.0)
    outs = [controller.step(k / 50.0) for k in range(100)]
    np.testing.assert_array_equal(outs[-1].wheel_speeds, 0.0)
    assert outs[-1].reasons & Reason.STALE


def test_a_time_out_that_was_switched_off_stopped_every_command():
    """ros-controls/ros2_controllers#2503"""
    controller = sw.Controller(CART, only(), timeout=None)
    controller.command((0.5, 0.0, 0.0), 0.0)
    outs = [controller.step(k / 50.0) for k in range(5000)]
    np.testing.assert_allclose([outs[0].twist, outs[-1].twist], [(0.5, 0.0, 0.0)] * 2)
    assert not outs[-1].reasons


@pytest.mark.parametrize("now", [0.5, 0.99, -1e9])
def test_a_step_back_in_time_drove_backwards(now):
    """ros-controls/ros_controllers#162, #561, fetchrobotics/robot_controllers#82"""
    controller = sw.Controller(CART, sw.Limits(acceleration=0.3))
    last = drive(controller, (0.5, 0.0, 0.0), 1.02)[-1]
    with pytest.raises(ValueError, match="^stamp must be later than the last step"):
        controller.step(now)
    controller.command((0.0, 0.0, 0.0), 1.02)
    out = controller.step(1.02)
    assert 0.0 < out.twist[0] <= last.twist[0]


def test_a_command_that_came_late_was_taken_for_a_new_one():
    """PR2/pr2_controllers#320: what is old when it comes is old."""
    controller = sw.Controller(CART, only(), timeout=0.5)
    assert controller.command((0.5, 0.0, 0.0), 10.0)
    controller.step(10.0)
    assert not controller.command((0.9, 0.0, 0.0), 9.8)
    out = controller.step(10.02)
    assert out.reasons & Reason.OUT_OF_ORDER
    np.testing.assert_allclose(out.twist, (0.5, 0.0, 0.0))
    late = sw.Controller(CART, only(), timeout=0.5)
    late.command((0.5, 0.0, 0.0), 9.0)
    out = late.step(10.0)
    assert out.reasons & Reason.STALE
    np.testing.assert_array_equal(out.wheel_speeds, 0.0)


@pytest.mark.parametrize("size", [0.0, 5e-324, 1e-300, 2.5e-7])
def test_angles_were_infinite_at_rest(size):
    """pvandervelde/zinger_swerve_controller#1"""
    controller = sw.Controller(SWERVE, only())
    drive(controller, (0.3, 0.1, 0.2), 0.5)
    for out in drive(controller, (size, 0.0, -size), 1.0, start=0.5):
        assert np.isfinite([*out.steering, *out.wheel_speeds]).all()


def test_it_never_started_from_rest():
    """wpilibsuite/allwpilib#5134: slowing down went by the measured speed, and at rest that is zero."""
    controller = sw.Controller(SWERVE, sw.Limits(wheel_speed=5.0, acceleration=1.0, steering_rate=3.0))
    steering = np.zeros(4)
    for k in range(200):
        controller.command((2.0, 1.0, 0.5), k / 50.0)
        out = controller.step(k / 50.0, measured=steering)
        steering = out.steering
    assert np.abs(out.wheel_speeds).max() == pytest.approx(5.0)
