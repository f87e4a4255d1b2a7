"""Wheels that went wrong for users elsewhere and do not here: every test has the name of such a failure.

It cites where it was told, as ``owner/repository#number``. Nothing of theirs is used.
"""

import math

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.kinematics.controller import Reason
from tests.neighbours.vehicles import BICYCLE, MARS, SWERVE
from tests.rovers import CAR, MECANUM, TRICYCLE

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
        assert np.abs(out.wheel_speeds).max() <= 4.0 + 1e-9
        pose = sw.compose(pose, sw.exp(out.twist, 0.02))
    # Discretised exactly, a step ends on the line; the limits take up to two per cent of the chord.
    assert abs(pose[1]) < 0.02 * pose[0]


def test_the_drive_pushed_sideways_while_modules_were_still_turning():
    """wpilibsuite/allwpilib#8274: the drive waits by the cosine of the error."""
    controller = sw.Controller(SWERVE, timeout=None)
    controller.command((1.0, 0.0, 0.0), 0.0)
    controller.step(0.0)
    out = controller.step(0.02, measured=[math.pi / 2, 0.0, 0.0, 0.0])
    assert np.abs(out.wheel_speeds).max() < 1e-9
    assert out.reasons & Reason.ALIGNING


def test_rest_turned_every_module_to_zero():
    """wpilibsuite/allwpilib#4204, CrossTheRoadElec/Phoenix-Releases#87: at rest there is no direction."""
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
    joints, wheels = len(rover.steered_wheel_names), len(rover.wheels)
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
        dict(zip(CAR.steered_wheel_names, steering, strict=True)),
        dict(zip(CAR.wheel_names, speeds, strict=True)),
    )
    left, right = sorted(CAR.steered_wheel_names, key=lambda name: -CAR.wheels[CAR.wheel_names.index(name)].y)
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
            sw.Rover.mecanum(0.6, 0.4, bad)


def test_the_wheel_radius_was_disregarded():
    """robotpy/pyfrc#32"""
    _, small = sw.Rover.mecanum(0.6, 0.4, 0.05).inverse((0.4, 0.1, 0.2))
    _, large = MECANUM.inverse((0.4, 0.1, 0.2))
    np.testing.assert_allclose(small, 2.0 * large)


# Whatever steers


def test_kinematics_remembered_angles_that_were_no_longer_true():
    """wpilibsuite/allwpilib#5167: two loops with one rover know nothing of each other."""
    twists = [(0.3, 0.1, 0.2), (0.0, 0.0, 0.0), (-0.2, 0.3, 0.0), (0.0, 0.0, 0.0)]
    alone, other = np.full(4, 0.4), np.full(4, -0.7)
    for twist in twists:
        expected, _ = SWERVE.inverse(twist, previous=alone)
        other, _ = SWERVE.inverse(np.negative(twist) * 3.0, previous=other)
        steering, _ = SWERVE.inverse(twist, previous=alone)
        np.testing.assert_array_equal(steering, expected)
        alone = steering


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_inner_wheels_were_faster_than_outer_ones(sign):
    """nasa-jpl/open-source-rover#176"""
    _, speeds = MARS.inverse((0.1, 0.0, sign * 0.04))
    icr = MARS.icr((0.1, 0.0, sign * 0.04))
    reach = [math.hypot(wheel.x - icr[0], wheel.y - icr[1]) for wheel in MARS.wheels]
    np.testing.assert_array_equal(np.argsort(reach), np.argsort(speeds))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_angles_of_both_sides_were_swapped(sign):
    """nasa-jpl/open-source-rover#175: the inner wheels turn further, the rear ones the other way."""
    steering, _ = MARS.inverse((0.1, 0.0, sign * 0.04))
    by_place = {}
    for name, angle in zip(MARS.steered_wheel_names, steering, strict=True):
        wheel = MARS.wheels[MARS.wheel_names.index(name)]
        by_place[wheel.x > 0.0, wheel.y * sign > 0.0] = sign * angle
    assert by_place[True, True] > by_place[True, False] > 0.0
    assert by_place[False, True] < by_place[False, False] < 0.0


def test_a_yaw_rate_was_taken_for_a_steering_angle():
    """nasa-jpl/osr-rover-code#80: the same yaw rate backwards needs the wheels the other way round."""
    ahead, _ = CAR.inverse((0.5, 0.0, 0.1))
    back, _ = CAR.inverse((-0.5, 0.0, 0.1))
    fast, _ = CAR.inverse((1.0, 0.0, 0.2))
    np.testing.assert_allclose(back, -ahead[::-1], atol=1e-15)
    np.testing.assert_allclose(fast, ahead, atol=1e-15)


@pytest.mark.parametrize("angle", [0.1, 0.7, 1.4, -1.2])
def test_a_driven_front_wheel_was_given_the_speed_of_the_rear(angle):
    """ros-controls/ros2_controllers#1150: along its own heading it is faster by the cosine."""
    _, speeds = BICYCLE.inverse((0.5, 0.0, 0.5 * math.tan(angle)))
    by_name = dict(zip(BICYCLE.wheel_names, speeds, strict=True))
    (front,) = BICYCLE.steered_wheel_names
    (rear,) = by_name.keys() - {front}
    assert by_name[front] == pytest.approx(by_name[rear] / math.cos(angle), rel=1e-12)


@pytest.mark.parametrize("curvature", [1e-9, 0.3, 2.0, 50.0])
def test_steering_angles_were_taken_as_small(curvature):
    """rst-tu-dortmund/teb_local_planner#67"""
    steering, _ = BICYCLE.inverse((1.0, 0.0, curvature))
    assert steering[0] == pytest.approx(math.atan(1.0 * curvature), rel=1e-14)


def test_the_speed_was_that_of_another_point_than_the_rear_axle():
    """rst-tu-dortmund/teb_local_planner#32: the origin is where the wheels' places are counted from."""
    wheelbase, speed, yaw_rate = 1.0, 1.0, 0.5
    middle = sw.Rover(
        [
            sw.Wheel("front", wheelbase / 2, 0.0, radius=0.2, steered=True),
            sw.Wheel("rear", -wheelbase / 2, 0.0, radius=0.2),
        ]
    )
    with pytest.raises(sw.InfeasibleMotionError):
        middle.inverse((speed, 0.0, yaw_rate))
    steering, speeds = middle.inverse((speed, wheelbase / 2 * yaw_rate, yaw_rate))
    expected, rear = BICYCLE.inverse((speed, 0.0, yaw_rate))
    np.testing.assert_allclose(steering, expected, rtol=1e-14)
    np.testing.assert_allclose(sorted(speeds), sorted(rear), rtol=1e-14)


@pytest.mark.parametrize("twist", [(0.2, 0, 0), (0.2, 0.2, 0), (0, -0.1, 0), (0, 0, 0.4), (0.3, 0.1, -0.6)])
def test_odometry_had_to_know_the_manoeuvre(twist):
    """robotika/osgar#603: straight, crab, on the spot and arcs are one equation."""
    np.testing.assert_allclose(SWERVE.forward(*SWERVE.inverse(twist)), twist, atol=1e-15)


def test_two_wheels_turned_at_half_the_rate_and_at_twice_of_it():
    """linorobot/linorobot#57, o3de/o3de-extras#216"""
    for per_side in (1, 2, 3):
        rover = sw.Rover.differential(0.5, 0.1, wheels_per_side=per_side, wheelbase=0.6)
        _, speeds = rover.inverse((0.0, 0.0, 1.0))
        np.testing.assert_allclose(np.abs(speeds), 0.25 / 0.1)
        np.testing.assert_allclose(rover.forward(None, speeds), (0.0, 0.0, 1.0), atol=1e-15)
