"""What went wrong for users elsewhere and does not here: every test has the name of such a failure.

It cites where it was told, as ``owner/repository#number``. Nothing of theirs is used.
"""

import math

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.controller import Reason
from six_wheel.odometry import Health

CART = sw.Rover.differential(0.5, 0.1)
CAR = sw.Rover.ackermann(2.0, 1.2, 0.3, steering_limit=0.6)
BICYCLE = sw.Rover.bicycle(1.0, 0.2)
TRICYCLE = sw.Rover.tricycle(1.0, 0.8, 0.2)
SQUARE = [(0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)]
SWERVE = sw.Rover.swerve(SQUARE, 0.1)
MECANUM = sw.Rover.mecanum(0.3, 0.2, 0.1)
MARS = sw.Rover.preset("perseverance")


def drive(controller: sw.Controller, command: tuple[float, float, float], seconds: float, start: float = 0.0):
    """Outputs of a controller that gets the same command at 50 Hz."""
    outs = []
    for k in range(round(seconds * 50)):
        now = start + k / 50.0
        controller.command(command, now)
        outs.append(controller.step(now))
    return outs


# Commands


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
    np.testing.assert_array_equal(out.speeds, last.speeds)
    assert out.reasons


def test_a_command_of_nan_turned_the_steering_uncontrollably():
    """4am-robotics/cob_driver#171"""
    controller = sw.Controller(SWERVE)
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
    np.testing.assert_array_equal(outs[-1].speeds, 0.0)
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


# Limits


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
        assert np.abs(out.speeds).max() <= 3.3 * (1 + 1e-12)


@pytest.mark.parametrize("command", [(-1.0, 0.0, 1.0), (1.0, 0.0, -1.0), (-1.0, 0.0, -2.0), (0.0, -1.0, 0.5)])
def test_wheels_that_turn_backwards_were_not_limited(command):
    """wpilibsuite/allwpilib#5268"""
    rover = SWERVE if command[1] else CART
    controller = sw.Controller(rover, sw.Limits(wheel_speed=1.0), timeout=None)
    for out in drive(controller, command, 1.0):
        assert np.abs(out.speeds).max() <= 1.0 + 1e-12


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
        np.testing.assert_allclose(out.speeds * radius, 0.3)


# Swerve


def test_modules_turned_opposite_ways_about_a_quarter_turn():
    """wpilibsuite/allwpilib#5313: those that could go either way go the same way."""
    previous = np.radians([88.0, 88.0, 88.0, 92.0]) - np.pi / 2
    _, speeds = SWERVE.inverse((0.0, 1.0, 0.0), previous=previous)
    assert len(set(np.sign(speeds))) == 1


def test_slowing_the_wheels_down_bent_a_path_while_turning():
    """wpilibsuite/allwpilib#7332: limits come after the discretisation, and leave one centre of rotation."""
    limits = sw.Limits(wheel_speed=4.0)
    controller = sw.Controller(SWERVE, limits, period=0.02, discretise=True, timeout=None)
    pose = np.zeros(3)
    for k in range(100):
        heading = pose[2]
        command = (math.cos(heading), -math.sin(heading), 2.0)  # straight along x of the world
        controller.command(command, 0.02 * k)
        out = controller.step(0.02 * k)
        assert np.abs(out.speeds).max() <= 4.0 + 1e-9
        pose = sw.compose(pose, sw.exp(out.twist, 0.02))
    # Discretised exactly, a step ends on the line; the limits take up to two per cent of the chord.
    assert abs(pose[1]) < 0.02 * pose[0]


def test_the_drive_pushed_sideways_while_modules_were_still_turning():
    """wpilibsuite/allwpilib#8274: the drive waits by the cosine of the error."""
    controller = sw.Controller(SWERVE, timeout=None)
    controller.command((1.0, 0.0, 0.0), 0.0)
    controller.step(0.0)
    out = controller.step(0.02, measured=[math.pi / 2, 0.0, 0.0, 0.0])
    assert np.abs(out.speeds).max() < 1e-9
    assert out.reasons & Reason.ALIGNING


def test_rest_turned_every_module_to_zero():
    """wpilibsuite/allwpilib#5134: at rest there is no direction, so angles are held."""
    previous = np.array([0.3, -0.2, 0.1, 0.7])
    steering, speeds = SWERVE.inverse((0.0, 0.0, 0.0), previous=previous)
    np.testing.assert_array_equal(steering, previous)
    np.testing.assert_array_equal(speeds, 0.0)


# Steering and its odometry


def test_steering_at_ninety_degrees_gave_zero():
    """ros-controls/ros2_controllers#1288: about the rear axle the front wheel stands across."""
    steering, speeds = BICYCLE.inverse((0.0, 0.0, 1.0))
    assert abs(steering[0]) == pytest.approx(math.pi / 2)
    assert np.isfinite(speeds).all()
    np.testing.assert_allclose(BICYCLE.forward(steering, speeds), (0.0, 0.0, 1.0), atol=1e-15)


@pytest.mark.parametrize("rover", [CAR, BICYCLE, TRICYCLE], ids=["car", "bicycle", "tricycle"])
def test_an_infinite_turning_radius_gave_nan(rover):
    """ros-controls/ros2_controllers#1285"""
    joints, wheels = len(rover.steered_names), len(rover.wheels)
    radii = [wheel.radius for wheel in rover.wheels]
    twist = rover.forward([0.0] * joints, 1.0 / np.array(radii))
    np.testing.assert_allclose(twist, (1.0, 0.0, 0.0), atol=1e-15)
    assert np.isfinite(rover.forward([5e-324] * joints, [1.0] * wheels)).all()


@pytest.mark.parametrize("rover", [CAR, BICYCLE, TRICYCLE], ids=["car", "bicycle", "tricycle"])
def test_the_heading_turned_a_hundred_times_too_fast(rover):
    """ros-controls/ros2_controllers#789, #937: an angle was added where a rate was meant, at 100 Hz."""
    twist, dt = np.array([0.5, 0.0, 0.1]), 0.01
    steering, speeds = rover.inverse(twist)
    stamps = np.arange(101) * dt
    track = sw.dead_reckon(rover, np.tile(steering, (101, 1)), stamps[:, None] * speeds, stamps)
    np.testing.assert_allclose(track.poses[-1], sw.exp(twist, 1.0), atol=1e-12)


def test_left_and_right_steering_angles_were_swapped():
    """ros-controls/ros2_controllers#878, #933: turning left the left wheel is the inner one."""
    steering, speeds = CAR.inverse((1.0, 0.0, 0.2))
    angle, speed = (
        dict(zip(CAR.steered_names, steering, strict=True)),
        dict(zip(CAR.wheel_names, speeds, strict=True)),
    )
    left, right = sorted(CAR.steered_names, key=lambda name: -CAR.wheels[CAR.wheel_names.index(name)].y)
    assert angle[left] > angle[right] > 0.0
    assert speed[left] < speed[right]


def test_a_turning_radius_of_zero_divided_by_zero():
    """nasa-jpl/osr-rover-code#134"""
    steering, speeds = MARS.inverse((0.0, 0.0, 0.2))
    assert np.isfinite(steering).all()
    assert np.isfinite(speeds).all()
    np.testing.assert_allclose(MARS.forward(steering, speeds), (0.0, 0.0, 0.2), atol=1e-14)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_turning_right_needed_a_case_of_its_own(sign):
    """RobotnikAutomation/rbcar_common#3: right is the mirror image of left."""
    left, _ = CAR.inverse((1.0, 0.0, 0.2))
    steering, _ = CAR.inverse((1.0, 0.0, sign * 0.2))
    np.testing.assert_allclose(np.sort(steering), np.sort(sign * left), atol=1e-15)


# Mecanum


def test_strafing_left_went_right():
    """linorobot/linorobot#35, acmerobotics/road-runner-quickstart#131: y is left, in and out."""
    _, speeds = MECANUM.inverse((0.0, 0.5, 0.0))
    by_place = {
        (wheel.x > 0, wheel.y > 0): speed for wheel, speed in zip(MECANUM.wheels, speeds, strict=True)
    }
    assert by_place[True, True] < 0.0 < by_place[True, False]
    assert by_place[False, False] < 0.0 < by_place[False, True]
    np.testing.assert_allclose(MECANUM.forward(None, speeds), (0.0, 0.5, 0.0), atol=1e-15)


def test_diagonals_while_turning_went_astray():
    """acmerobotics/road-runner-quickstart#359"""
    twist = np.array([0.3, 0.4, 0.7])
    _, speeds = MECANUM.inverse(twist)
    stamps = np.linspace(0.0, 2.0, 201)
    track = sw.dead_reckon(MECANUM, None, stamps[:, None] * speeds, stamps)
    np.testing.assert_allclose(track.poses[-1], sw.exp(twist, 2.0), atol=1e-12)


def test_a_missing_dimension_made_odometry_nan():
    """ridgeback/ridgeback#22: a rover without a dimension is no rover."""
    for bad in (0.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="must be finite and positive"):
            sw.Rover.mecanum(0.3, 0.2, bad)


def test_the_wheel_radius_was_disregarded():
    """robotpy/pyfrc#32"""
    _, small = sw.Rover.mecanum(0.3, 0.2, 0.05).inverse((0.4, 0.1, 0.2))
    _, large = MECANUM.inverse((0.4, 0.1, 0.2))
    np.testing.assert_allclose(small, 2.0 * large)


# Odometry


@pytest.mark.parametrize("first", [0.07874015748, -3.0, 12_345.6])
def test_the_first_reading_after_a_restart_was_a_jump(first):
    """clearpathrobotics/clearpath_robot#357, ROBOTIS-GIT/turtlebot3#880, ros-controls/ros_controllers#564"""
    odometry = sw.Odometry(CART)
    state = odometry.update(None, [first, first], 5.0)
    np.testing.assert_array_equal(state.pose, 0.0)
    np.testing.assert_array_equal(state.twist, 0.0)
    assert state.health & Health.FIRST
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
    encoder = sw.Encoder(1000.0, modulus=2**32)
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
