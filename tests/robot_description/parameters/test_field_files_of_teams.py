"""Parameter files as teams of real robots write them, and files that are refused."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.robot_description.parameters import ParameterFileError, dump, read_parameters
from tests.robot_description.parameters.field_files import refusal
from tests.rovers import SIX_WHEELS


def test_the_open_source_rover_has_the_joints_of_its_own_nodes(read) -> None:
    dimensions = "{d1: 0.2, d2: 0.3, d3: 0.25, d4: 0.26, wheel_radius: 0.075}"
    text = f"rover:\n  ros__parameters:\n    rover_dimensions: {dimensions}\n"
    rover = read(text).rover
    assert (
        rover.wheels
        == sw.Rover.six_wheel(
            front_to_middle=0.25,
            middle_to_rear=0.3,
            track_width=0.4,
            middle_track_width=0.52,
            wheel_radius=0.075,
        ).wheels
    )
    assert rover.traction_joints["drive_left_back"] == "rear_left"
    assert "corner_right_front" in rover.reversed_joints
    with pytest.raises(ParameterFileError, match="rover_dimensions.d2 is missing"):
        read(text.replace("d2: 0.3, ", ""))


def test_controllers_of_ros_1_have_no_ros__parameters(read) -> None:
    text = "base:\n  type: diff_drive_controller/DiffDriveController\n  left_wheel: l\n  right_wheel: r\n"
    line = refusal(read, text + "  wheel_radius: 0.1\n")
    assert "wheel_separation is missing" in line
    assert "from the URDF" in line
    found = read(text + "  wheel_radius: 0.1\n  wheel_separation: 0.4\n  wheel_radius_multiplier: -1.0\n")
    assert found.warnings == ()
    assert found.rover.reversed_joints == ("l", "r")


def test_leos_firmware(read) -> None:
    text = """
wheels: {encoder_resolution: 878.4}
mecanum_wheels: false
controller:
  wheel_radius: 0.0625
  wheel_separation: 0.358
  wheel_base: 0.3
  angular_velocity_multiplier: 1.76
  input_timeout: 0
"""
    found = read(text)
    assert found.rover.wheels[0].y == pytest.approx(0.358 * 1.76 / 2)
    assert found.control == {"timeout": None}
    assert next(iter(found.rover.traction_joints)) == "wheel_FL_joint"
    mecanum = read(text.replace("false", "true"))
    assert mecanum.kind == "mecanum"
    assert mecanum.rover.wheels == sw.Rover.mecanum(0.3, 0.358, 0.0625).wheels


def test_clearpaths_mecanum_controller_goes_by_the_order_of_its_joints(read) -> None:
    text = """
controller_manager:
  ros__parameters:
    platform_velocity_controller.type: clearpath_mecanum_drive_controller/MecanumDriveController
platform_velocity_controller:
  ros__parameters:
    command_joint_names: [j0, j1, j2, j3]
    interface_name: velocity
    kinematics.wheels_radius: 0.0759
    kinematics.sum_of_robot_center_projection_on_X_Y_axis: 0.59
    kinematics.base_frame_offset: {x: 0.0, y: 0.0, theta: 0.0}
"""
    found = read(text)
    assert (found.kind, found.controller) == ("mecanum", "clearpath_mecanum_drive_controller")
    places = ("front_left", "rear_left", "rear_right", "front_right")
    assert found.rover.traction_joints == {f"j{k}": place for k, place in enumerate(places)}
    # The controller's own lines: 1 / r (vx -+ vy -+ (lx + ly) omega), in that order.
    (vx, vy, omega), radius, sum_ = (0.7, -0.3, 0.4), 0.0759, 0.59
    turning = sum_ * omega
    by_hand = [vx - vy - turning, vx + vy - turning, vx - vy + turning, vx + vy + turning]
    speeds = found.rover.commands((vx, vy, omega))
    assert [speeds[f"j{k}"] * radius for k in range(4)] == pytest.approx(by_hand, rel=1e-12)
    # With names of its own for every wheel, as Clearpath writes them, those count.
    names = "".join(f"    {place}_wheel_command_joint_name: {place}_wheel_joint\n" for place in places)
    assert dict(read(text + names).rover.traction_joints)["rear_left_wheel_joint"] == "rear_left"
    with pytest.raises(ParameterFileError, match="command_joint_names must name 4 joints, got 3"):
        read(text.replace("j0, ", ""))


def test_the_driver_of_rover_robotics(read) -> None:
    text = """
roverrobotics_driver:
  ros__parameters:
    drivetrain: "differential"
    robot_type: "max"
    wheel_radius: 0.127
    wheel_base: 0.4953  # from side to side
    robot_length: 0.4445
    gear_ratio: 3.33
    linear_top_speed: 2.0
    odom_child_frame_id: "base"
"""
    found = read(text)
    assert found.warnings == ()
    assert (
        found.rover.wheels == sw.Rover.differential(0.4953, 0.127, wheels_per_side=2, wheelbase=0.4445).wheels
    )
    assert (found.limits.speed, found.base_frame_id) == (2.0, "base")
    assert len(read(text.replace('"max"', '"mini_2wd"')).rover.wheels) == 2
    assert read(text.replace('"differential"', '"mecanum"')).kind == "mecanum"
    assert "drivetrain must be" in refusal(read, text.replace('"differential"', '"tracks"'))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("realsense:\n  ros__parameters: {odom_frame_id: odom, base_frame_id: link}\n", "nothing here says"),
        ("streamer:\n  ros__parameters: {presets: {a: {x: 1}}, limits: 3}\n", "nothing here says"),
        ("ros__parameters: {timeout: 1.0}\n", "nothing here says"),
        (
            "diff_drive:\n  wheel_radius: {type: double, default_value: 0.0}\n",
            "the file declares parameters (wheel_radius) for generate_parameter_library",
        ),
    ],
)
def test_files_of_neighbours_are_refused_by_one_line(read, text: str, says: str) -> None:
    assert says in refusal(read, text)


def test_a_stand_in_for_what_is_missing_is_not_questioned(read) -> None:
    text = "type: diff_drive_controller/DiffDriveController\nleft_wheel: l\nright_wheel: r\n"
    assert "wheel_radius is missing" in refusal(read, text + "wheel_separation: 0.4\n")


def test_a_yagsl_drive_is_gathered_from_its_files(tmp_path: Path) -> None:
    (tmp_path / "modules").mkdir()
    for name, (front, left) in {"frontleft": (12, 11), "backright": (-12, -11)}.items():
        (tmp_path / "modules" / f"{name}.json").write_text(
            json.dumps({"location": {"front": front, "left": left}})
        )
    drive = tmp_path / "swervedrive.json"
    drive.write_text(json.dumps({"imu": {}, "modules": ["frontleft.json", "backright.json"]}))
    assert "conversionFactors.drive.diameter is missing" in refusal(read_parameters, drive)
    properties = {"conversionFactors": {"drive": {"diameter": 4, "gearRatio": 6.75}}}
    (tmp_path / "modules" / "physicalproperties.json").write_text(json.dumps(properties))
    rover = read_parameters(drive).rover
    assert rover.wheel_names == ("front_left", "rear_right")
    assert rover.wheels[1].x == pytest.approx(-12 * 0.0254)
    assert rover.wheels[0].radius == pytest.approx(2 * 0.0254)
    # The older files: x forward, y to the left, and the diameter by another name.
    (tmp_path / "modules" / "backright.json").write_text(json.dumps({"location": {"x": -12, "y": -11}}))
    (tmp_path / "modules" / "physicalproperties.json").write_text(json.dumps({"wheelDiameter": 4}))
    drive.write_text(json.dumps({"maxSpeed": 14.5, "modules": ["frontleft.json", "backright.json"]}))
    older = read_parameters(drive)
    assert older.rover.wheels == rover.wheels
    assert older.warnings == ()


def test_pathplanner_says_what_its_older_files_lack(read) -> None:
    line = refusal(
        read, '{"robotWidth": 0.9, "holonomicMode": true, "driveWheelRadius": 0.05}', "settings.json"
    )
    assert "flModuleX is missing, and with it where the wheels are" in line
    tank = '{"holonomicMode": false, "driveWheelRadius": 0.05, "robotTrackwidth": 0.6}'
    assert read(tank, "settings.json").rover.wheels == sw.Rover.differential(0.6, 0.05).wheels


def test_a_rocker_bogie_with_its_bogie_in_front(read) -> None:
    text = """
kind: rocker_bogie
rocker_pivot: [0.1, 0.2, 0.2]
rocker_to_rear: [-0.4, 0.0, -0.1]
rocker_to_bogie: [0.1, 0.0, -0.05]
bogie_to_front: [0.15, 0.0, -0.05]
bogie_to_middle: [-0.15, 0.0, -0.05]
wheel_radius: 0.1
rocker_limit: 0.4
bogie_limit: [-0.5, 0.6]
"""
    rover = read(text).rover
    assert rover.suspension is not None
    assert rover.suspension.dimensions["bogie_limit"] == (-0.5, 0.6)
    assert read(dump(rover)).rover == rover
    line = refusal(read, text.replace("bogie_to_front: [0.15, 0.0, -0.05]\n", ""))
    assert "bogie_to_front is missing" in line


def test_a_car_without_a_range_of_its_steering_says_what_is_assumed(read) -> None:
    text = """
c:
  ros__parameters:
    traction_joint_name: t
    steering_joint_name: s
    wheelbase: 1.0
    wheel_radius: 0.1
    track_width: 0.5
"""
    found = read(text)
    assert "90 degrees to both sides are assumed" in str(found.warnings[0])
    assert found.rover.wheels[0].steering_range == (-math.pi / 2, math.pi / 2)


@pytest.mark.parametrize(("factor", "unit"), [(100.0, "centimetres"), (1000.0, "millimetres")])
def test_lengths_that_cannot_be_metres_are_questioned(read, factor: float, unit: str) -> None:
    text = "kind: differential\ntrack_width: {}\nwheel_radius: {}\n"
    assert read(text.format(0.4, 0.1)).warnings == ()
    (warning,) = read(text.format(0.4 * factor, 0.1 * factor)).warnings
    assert f"in {unit} they would be 0.1 m and 0.2 m" in str(warning)
    assert warning.line == 3


def test_commands_and_readings_are_each_others_inverse() -> None:
    turned = ["front_left_steering_joint", "rear_right_wheel_joint"]
    rover = sw.Rover(SIX_WHEELS.wheels, reversed_joints=turned)
    twists = np.array([[0.3, 0.0, 0.2], [0.5, 0.0, -0.1]])
    steering, speeds = rover.inverse(twists)
    back = rover.readings(rover.commands(twists))
    np.testing.assert_array_equal(back[0], steering)
    np.testing.assert_array_equal(back[1], speeds)
    plain = sw.Rover(rover.wheels)
    assert plain != rover
    assert rover.commands(twists[0])[turned[1]] == -plain.commands(twists[0])[turned[1]]
    with pytest.raises(
        ValueError, match='joints must hold every joint of the rover, "front_left_steering_jo'
    ):
        rover.readings({"front_left_wheel_joint": 1.0})
    with pytest.raises(ValueError, match="reversed_joints must be some of the joints"):
        sw.Rover(rover.wheels, reversed_joints=["nose"])
    with pytest.raises(ValueError, match="reversed_joints must name every joint once"):
        sw.Rover(rover.wheels, reversed_joints=[turned[0], turned[0]])
