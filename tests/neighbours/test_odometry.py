"""Odometry that went wrong for users elsewhere and does not here: every test has the name of such a failure.

It cites where it was told, as ``owner/repository#number``. Nothing of theirs is used.
"""

import math

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.kinematics.odometry import OdometryHealth
from tests.neighbours.vehicles import MARS
from tests.rovers import CART


@pytest.mark.parametrize("first", [0.07874015748, -3.0, 12_345.6])
def test_the_first_reading_after_a_restart_was_a_jump(first):
    """clearpathrobotics/clearpath_robot#357, ROBOTIS-GIT/turtlebot3#880, ros-controls/ros_controllers#564"""
    odometry = sw.Odometry(CART)
    state = odometry.update(None, [first, first], 5.0)
    np.testing.assert_array_equal(state.pose, 0.0)
    np.testing.assert_array_equal(state.twist, 0.0)
    assert state.health & OdometryHealth.FIRST
    state = odometry.update(None, [first + 1.0, first + 1.0], 6.0)
    np.testing.assert_allclose(state.pose, (0.1, 0.0, 0.0), atol=1e-11)


def test_a_reset_left_the_heading_and_an_offset():
    """yujinrobot/kobuki#274, jackal/jackal_robot#39, introlab/rtabmap#298"""
    odometry = sw.Odometry(CART)
    for k in range(5):
        odometry.update(None, [1.0 * k, 1.5 * k], 0.1 * k, yaw=0.02 * k)
    odometry.reset((1.0, 2.0, 0.5))
    np.testing.assert_array_equal(odometry.state.pose, (1.0, 2.0, 0.5))
    state = odometry.update(None, [9.0, 9.0], 1.0, yaw=3.0)
    np.testing.assert_allclose(state.pose, (1.0, 2.0, 0.5), atol=1e-15)


def test_a_counter_that_started_over_threw_the_pose_away():
    """AIRclub-UdeSA/physical_rosmaster#1"""
    encoder = sw.Encoder(1000.0, wraps_at=2**32)
    odometry = sw.Odometry(CART, wheel_encoders=encoder)
    odometry.update(None, [2**31 - 500.0] * 2, 0.0)
    state = odometry.update(None, [-(2**31) + 500.0] * 2, 0.1)
    np.testing.assert_allclose(state.pose, (0.1 * 2 * math.pi, 0.0, 0.0), atol=1e-12)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_one_bad_reading_made_every_later_pose_nan(bad):
    """mrpt-ros-pkg/mrpt_navigation#120, rbonghi/roboteq_control#20"""
    odometry = sw.Odometry(CART)
    odometry.update(None, [0.0, 0.0], 0.0)
    with pytest.raises(ValueError, match="^wheel_angles must be finite"):
        odometry.update(None, [bad, 1.0], 0.1)
    np.testing.assert_allclose(odometry.update(None, [1.0, 1.0], 0.2).pose, (0.1, 0.0, 0.0), atol=1e-15)


def test_two_samples_with_one_stamp_divided_by_zero():
    """at-wat/neonavigation#10"""
    odometry = sw.Odometry(CART)
    odometry.update(None, [0.0, 0.0], 1.0)
    with pytest.raises(ValueError, match="^stamp must be later than the last one"):
        odometry.update(None, [1.0, 1.0], 1.0)
    track = sw.dead_reckon(CART, None, [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]], [0.0, 0.0, 1.0])
    assert np.isfinite(track.poses).all()


def test_the_covariance_was_zero():
    """ROBOTIS-GIT/turtlebot3#1069, AutonomyLab/create_robot#67: zero is certainty to a filter."""
    odometry = sw.Odometry(CART, sw.Noise(0.01, slip=0.02, side_slip=0.01))
    for k in range(3):
        state = odometry.update(None, [1.0 * k] * 2, 0.1 * k)
        assert (np.diag(state.twist_covariance) > 0.0).all()
    assert (np.diag(state.covariance) > 0.0).all()
    assert (np.diag(state.covariance_6x6()) > 0.0).all()
    assert (np.diag(state.twist_covariance_6x6()) > 0.0).all()


def test_the_covariance_depended_on_how_often_messages_came():
    """PR2/pr2_controllers#306: many short commands looked surer than one long one."""
    ends = []
    for count in (11, 101, 1001):
        stamps = np.linspace(0.0, 10.0, count)
        noise = sw.Noise(speed=0.0, steering=0.0, slip=0.02, side_slip=0.01)
        track = sw.dead_reckon(CART, None, stamps[:, None] * [1.0, 1.0], stamps, noise=noise)
        ends.append(track.covariances[-1])
    # Along the way it is exact; across it, steps of a tenth of the way leave out a hundredth of the variance.
    np.testing.assert_allclose(ends[0], ends[2], rtol=0.02, atol=1e-9)
    np.testing.assert_allclose(ends[1], ends[2], rtol=0.002, atol=1e-9)


def test_what_is_not_measured_was_said_to_be_certain():
    """ros-simulation/gazebo_ros_pkgs#1466: z, roll and pitch are not known to wheels on a plane."""
    state = sw.Odometry(CART).update(None, [0.0, 0.0], 0.0)
    np.testing.assert_array_equal(np.diag(state.covariance_6x6(unmeasured=1e9))[2:5], 1e9)


def test_velocities_were_differences_over_the_wrong_time():
    """at-wat/neonavigation#10"""
    odometry = sw.Odometry(CART)
    for stamp in (0.0, 0.1, 0.15, 1.0, 1.001):
        state = odometry.update(None, [5.0 * stamp] * 2, stamp)
    np.testing.assert_allclose(state.twist, (0.5, 0.0, 0.0), atol=1e-9)


def test_a_robot_that_stood_still_crept_away():
    """RobotnikAutomation/rbcar_sim#4"""
    odometry = sw.Odometry(MARS)
    for k in range(10_000):
        state = odometry.update((0.1, 0.1, 0.0, 0.0), (3.0,) * 6, 0.01 * k)
    np.testing.assert_array_equal(state.pose, 0.0)


def test_a_wheel_that_turned_backwards_was_taken_forwards():
    """yaqwsx/PathPlanner#1: about a point between the wheels the inner one goes back."""
    twist = np.array([0.05, 0.0, 1.0])
    _, speeds = CART.inverse(twist)
    assert speeds.min() < 0.0 < speeds.max()
    stamps = np.linspace(0.0, 3.0, 31)
    track = sw.dead_reckon(CART, None, stamps[:, None] * speeds, stamps)
    np.testing.assert_allclose(track.poses[-1], sw.exp(twist, 3.0), atol=1e-12)


def test_odometry_turned_the_wrong_way():
    """ros-controls/ros2_controllers#280: the right wheel is faster in a turn to the left."""
    right = [float(wheel.y < 0.0) for wheel in CART.wheels]
    track = sw.dead_reckon(CART, None, [[0.0, 0.0], right], [0.0, 1.0])
    assert track.poses[-1, 2] == pytest.approx(0.1 / 0.5)
    assert track.poses[-1, 1] > 0.0


def test_velocities_never_returned_to_zero():
    """ros-controls/ros2_controllers#1972"""
    odometry = sw.Odometry(CART)
    turned, generator = np.zeros(2), np.random.default_rng(1)
    for k in range(300):
        odometry.update(None, turned, 0.05 * k)
        turned = turned + generator.uniform(0.0, 1.0, 2)
    odometry.update(None, turned, 15.0)
    np.testing.assert_array_equal(odometry.update(None, turned, 15.05).twist, 0.0)


def test_one_encoder_counted_the_other_way_and_straight_was_a_circle():
    """jfstepha/differential-drive#5"""
    left, right = CART.wheel_names
    encoders = {left: sw.Encoder(1000.0), right: sw.Encoder(1000.0, gear_ratio=-1.0)}
    odometry = sw.Odometry(CART, wheel_encoders=encoders)
    odometry.update(None, [0.0, 0.0], 0.0)
    state = odometry.update(None, [500.0, -500.0], 1.0)
    np.testing.assert_allclose(state.pose, (0.1 * math.pi, 0.0, 0.0), atol=1e-15)


@pytest.mark.parametrize("samples", [2, 5, 500])
def test_a_step_was_a_straight_line(samples):
    """zauberzeug/rosys#201, CentroEPiaggio/irobotcreate2ros#10: off by more, the fewer samples there were."""
    twist = np.array([0.4, 0.0, 0.9])
    _, speeds = CART.inverse(twist)
    stamps = np.linspace(0.0, 3.0, samples)
    track = sw.dead_reckon(CART, None, stamps[:, None] * speeds, stamps)
    np.testing.assert_allclose(track.poses[-1], sw.exp(twist, 3.0), atol=1e-12)


def test_nearly_straight_was_divided_by_nearly_nothing():
    """CNR-STIIMA-IRAS/rosdyn#21"""
    rates = np.concatenate([[0.0, 5e-324, 1e-310], 10.0 ** np.arange(-300.0, -7.0)])
    twists = np.stack([np.ones_like(rates), 0.0 * rates, rates], axis=-1)
    for signed in (twists, twists * [1.0, 1.0, -1.0]):
        ends = sw.exp(signed, 2.0)
        np.testing.assert_allclose(ends[:, 0], 2.0, atol=1e-14)
        np.testing.assert_allclose(ends[:, 1], 2.0 * signed[:, 2], rtol=1e-9, atol=1e-300)


def test_the_heading_jumped_at_half_a_turn():
    """macorobots/roomac_ros#44, acmerobotics/road-runner-quickstart#35: a compass goes from pi to -pi."""
    odometry = sw.Odometry(CART, sw.Noise(yaw=0.01))
    _, speeds = CART.inverse((0.0, 0.0, 1.0))
    yaws = []
    for k in range(100):
        state = odometry.update(None, 0.1 * k * speeds, 0.1 * k, yaw=float(sw.wrap_angle(0.1 * k)))
        yaws.append(state.pose[2])
    np.testing.assert_allclose(np.diff(np.unwrap(yaws)), 0.1, atol=1e-6)
    assert abs(sw.wrap_angle(np.array(math.pi + 0.1) - (-math.pi + 0.1))) < 1e-12


def test_counts_of_eight_bits_started_over_and_the_robot_was_elsewhere():
    """chrisl8/ArloBot#40"""
    odometry = sw.Odometry(CART, wheel_encoders=sw.Encoder(144.0, wraps_at=256))
    for k in range(100):
        state = odometry.update(None, [(100 * k) % 256, (100 * k) % 256], 0.1 * k)
    np.testing.assert_allclose(
        state.pose, (99 * 100 / 144 * 2 * math.pi * 0.1, 0.0, 0.0), rtol=1e-12, atol=1e-12
    )


def test_a_variance_so_large_that_filters_broke():
    """yujinrobot/kobuki#387: 1e308 for what is not known is infinite as soon as anything is added to it."""
    odometry = sw.Odometry(CART)
    for state in (odometry.state, odometry.update(None, [0.0, 0.0], 0.0)):
        for matrix in (state.covariance_6x6(), state.twist_covariance_6x6()):
            assert np.isfinite(matrix).all()
            assert np.isfinite(matrix @ matrix @ matrix).all()


def test_noise_that_nobody_gave_was_none():
    """cra-ros-pkg/robot_localization#809"""
    odometry = sw.Odometry(MARS)
    for k in range(5):
        state = odometry.update([0.1 * k] * 4, [1.0 * k] * 6, 0.1 * k)
    assert (np.diag(state.covariance) > 0.0).all()


def test_a_velocity_was_added_as_if_it_were_a_way():
    """RoverRobotics-archive/roverrobotics_ros2#21"""
    odometry = sw.Odometry(CART, readings="speeds")
    for k in range(101):
        state = odometry.update(None, [5.0, 5.0], 0.01 * k)
    np.testing.assert_allclose(state.pose, (0.5, 0.0, 0.0), atol=1e-12)


def test_a_sensor_that_failed_for_a_moment_made_the_pose_nan():
    """ros-controls/ros2_controllers#2083"""
    stamps = np.arange(20) / 10.0
    wheels = np.repeat(stamps[:, None], 2, axis=1)
    wheels[7, 1], wheels[12] = math.nan, math.inf
    track = sw.dead_reckon(CART, None, wheels, stamps)
    assert np.isfinite(track.poses).all()
    np.testing.assert_allclose(track.poses[-1], (0.19, 0.0, 0.0), atol=1e-15)


def test_the_period_was_the_nominal_one():
    """ros-controls/ros2_controllers#1394: steps are as long as their stamps say."""
    generator = np.random.default_rng(3)
    stamps = np.cumsum(generator.uniform(0.001, 0.3, 200))
    _, speeds = CART.inverse((0.4, 0.0, 0.5))
    odometry = sw.Odometry(CART)
    for stamp in stamps:
        state = odometry.update(None, stamp * speeds, stamp)
    np.testing.assert_allclose(state.twist, (0.4, 0.0, 0.5), atol=1e-9)
