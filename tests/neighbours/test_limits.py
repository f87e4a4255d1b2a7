"""Limits that went wrong for users elsewhere and do not here: every test has the name of such a failure.

It cites where it was told, as ``owner/repository#number``. Nothing of theirs is used.
"""

import numpy as np
import pytest

import six_wheel as sw
from tests.neighbours.vehicles import SWERVE, drive
from tests.rovers import CAR, CART, MECANUM


@pytest.mark.parametrize("limits", [{"speed": 0.4}, {"wheel_speed": 3.0}, {"yaw_rate": 0.2}])
def test_the_curvature_was_lost_when_a_limit_cut_in(limits):
    """ros-controls/ros2_controllers#470"""
    controller = sw.Controller(CART, sw.Limits(**limits), timeout=None)
    out = drive(controller, (1.0, 0.0, 0.6), 1.0)[-1]
    assert out.twist[2] / out.twist[0] == pytest.approx(0.6, rel=1e-12)
    assert out.reasons


def test_the_curvature_was_lost_while_braking():
    """ros-controls/ros2_controllers#470, 4am-robotics/cob_control#92"""
    controller = sw.Controller(CART, sw.Limits(acceleration=1.0, deceleration=0.5, angular_acceleration=0.3))
    drive(controller, (1.0, 0.0, 0.5), 5.0)
    for out in drive(controller, (0.0, 0.0, 0.0), 5.0, start=5.0):
        if out.twist[0] > 0.0:
            assert out.twist[2] / out.twist[0] == pytest.approx(0.5, rel=1e-9)
    np.testing.assert_array_equal(out.twist, 0.0)


def test_one_motor_was_asked_for_more_than_it_can():
    """Ekumen-OS/andino#148"""
    controller = sw.Controller(CART, sw.Limits(speed=0.33, yaw_rate=2.0, wheel_speed=3.3), timeout=None)
    for out in drive(controller, (0.33, 0.0, 2.0), 1.0):
        assert np.abs(out.wheel_speeds).max() <= 3.3 * (1 + 1e-12)


@pytest.mark.parametrize("command", [(-1.0, 0.0, 1.0), (1.0, 0.0, -1.0), (-1.0, 0.0, -2.0), (0.0, -1.0, 0.5)])
def test_wheels_that_turn_backwards_were_not_limited(command):
    """wpilibsuite/allwpilib#5268"""
    rover = SWERVE if command[1] else CART
    controller = sw.Controller(rover, sw.Limits(wheel_speed=1.0), timeout=None)
    for out in drive(controller, command, 1.0):
        assert np.abs(out.wheel_speeds).max() <= 1.0 + 1e-12


def test_braking_was_as_weak_as_speeding_up_when_going_backwards():
    """ros-controls/ros_controllers#290, #354, ros-controls/ros2_controllers#1317"""
    profiles = []
    for sign in (1.0, -1.0):
        controller = sw.Controller(CART, sw.Limits(acceleration=0.2, deceleration=2.0))
        up = drive(controller, (sign * 0.4, 0.0, 0.0), 3.0)
        down = drive(controller, (0.0, 0.0, 0.0), 1.0, start=3.0)
        profiles.append([sign * out.twist[0] for out in up + down])
    np.testing.assert_allclose(*profiles, atol=1e-15)
    rates = np.diff(profiles[0]) * 50.0
    assert rates.max() == pytest.approx(0.2)
    assert rates.min() == pytest.approx(-2.0)


def test_one_direction_of_turning_was_quicker_than_the_other():
    """kobuki-base/kobuki_core#52"""
    left, right = (
        [
            out.twist[2]
            for out in drive(sw.Controller(CART, sw.Limits(angular_acceleration=0.5)), (0, 0, sign), 1)
        ]
        for sign in (1.0, -1.0)
    )
    np.testing.assert_array_equal(left, np.negative(right))


def test_a_jerk_limit_made_it_go_backwards_after_the_stop():
    """ros-controls/ros_controllers#359"""
    controller = sw.Controller(CART, sw.Limits(acceleration=1.0, jerk=1.0))
    outs = drive(controller, (1.0, 0.0, 0.0), 4.0) + drive(controller, (0.0, 0.0, 0.0), 4.0, start=4.0)
    speeds = [out.twist[0] for out in outs]
    assert min(speeds) >= 0.0
    assert speeds[-1] == 0.0


def test_the_jerk_was_twice_its_limit():
    """ros-controls/ros2_controllers#1390, ros-controls/ros_controllers#388"""
    controller = sw.Controller(CART, sw.Limits(acceleration=2.0, jerk=20.0))
    speeds = [out.twist[0] for out in drive(controller, (1.0, 0.0, 0.0), 2.0)]
    # Second differences of a motion of bounded jerk are no larger than the jerk times the step squared.
    assert np.abs(np.diff(speeds, 2)).max() <= 20.0 / 50.0**2 * (1 + 1e-9)


def test_a_limit_was_applied_before_the_radius():
    """ros-controls/ros_controllers#243: limits of the body are those of the body, whatever the wheels."""
    for radius in (0.05, 0.1, 0.4):
        rover = sw.Rover.differential(0.5, radius)
        out = drive(sw.Controller(rover, sw.Limits(speed=0.3), timeout=None), (1.0, 0.0, 0.0), 0.2)[-1]
        np.testing.assert_allclose(out.wheel_speeds * radius, 0.3)


def test_the_speed_was_limited_and_the_yaw_rate_was_not():
    """mjansen4857/pathplanner#133"""
    controller = sw.Controller(CART, sw.Limits(speed=2.0, yaw_rate=1.0), timeout=None)
    for out in drive(controller, (2.0, 0.0, 7.0), 1.0):
        assert abs(out.twist[2]) <= 1.0 + 1e-12


def test_smoothing_turned_the_direction_of_travel():
    """yujinrobot/yujin_ocs#3: components were limited one by one."""
    controller = sw.Controller(SWERVE, sw.Limits(acceleration=0.4, steering_rate=5.0))
    outs = drive(controller, (1.0, 0.5, 0.0), 4.0)
    for out in outs:
        assert out.twist[1] == pytest.approx(0.5 * out.twist[0], abs=1e-12)
    np.testing.assert_allclose(outs[-1].twist, (1.0, 0.5, 0.0))


def test_the_path_was_another_one_while_speeding_up():
    """ros-navigation/navigation2#5604: scaled were the changes, not the velocities."""
    controller = sw.Controller(CART, sw.Limits(acceleration=1.0, angular_acceleration=0.3))
    for out in drive(controller, (2.0, 0.0, 1.5), 6.0):
        assert out.twist[2] * 2.0 == pytest.approx(out.twist[0] * 1.5, abs=1e-12)


@pytest.mark.parametrize("command", [(-1.0, 0.4, 0.3), (0.2, -1.5, -0.7), (-0.1, 0.0, 2.0)])
def test_mecanum_wheels_that_turn_backwards_were_not_limited(command):
    """wpilibsuite/allwpilib#6040"""
    controller = sw.Controller(MECANUM, sw.Limits(wheel_speed=4.0), timeout=None)
    out = drive(controller, command, 0.2)[-1]
    assert np.abs(out.wheel_speeds).max() == pytest.approx(4.0)
    np.testing.assert_allclose(np.cross(out.twist, command), 0.0, atol=1e-12)  # slower, not elsewhere


def test_modules_were_asked_for_more_than_they_can():
    """CrossTheRoadElec/Phoenix-Releases#72"""
    controller = sw.Controller(SWERVE, sw.Limits(wheel_speed=30.0), timeout=None)
    for out in drive(controller, (4.0, 3.0, 9.0), 1.0):
        assert np.abs(out.wheel_speeds).max() <= 30.0 * (1 + 1e-12)


def test_a_sampled_motion_turned_tighter_than_the_vehicle_can():
    """ros-navigation/navigation2#6107: at low speeds above all."""
    generator = np.random.default_rng(1)
    wanted = generator.normal(size=(5000, 3)) * [1.0, 0.0, 1.0] * 10.0 ** generator.uniform(-6, 0, (5000, 1))
    made = CAR.project(wanted)
    assert CAR.admissible(made).all()
    turning = np.abs(made[:, 2]) > 0.0
    assert (np.abs(made[turning, 0] / made[turning, 2]) >= CAR.min_radius * (1 - 1e-9)).all()


def test_every_trajectory_became_a_circle():
    """ros-navigation/navigation2#3579: what the vehicle can do stays as it is."""
    generator = np.random.default_rng(2)
    speeds, curvatures = generator.normal(size=300), generator.uniform(-0.9, 0.9, 300) / CAR.min_radius
    wanted = np.stack([speeds, 0.0 * speeds, speeds * curvatures], axis=-1)
    np.testing.assert_array_equal(CAR.project(wanted), wanted)
