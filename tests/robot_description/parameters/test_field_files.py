"""Files of other people's robots: each loads, or is refused by one line on which a stranger can act."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.robot_description.parameters import ParameterFileError, dump, read_parameters
from tests.rovers import SIX_WHEELS

SHARED = Path(__file__).parents[4] / "shared" / "data" / "configs"

# What six-wheel answers to each: the kind, or the beginning of the line that refuses it.
ANSWERS = {
    "01_osr-rover-code_osr_params.yaml": "six_wheel",
    "02_osr-rover-code_roboclaw_params.yaml": "nothing here says where the wheels are",
    "03_curio_control_ackermann_drive.yaml": "six_wheel",
    "05_curio_control_ackermann_drive.yaml": "six_wheel",
    "07_leo_robot-ros2_firmware_diff_drive_params.yaml": "differential",
    "09_leo_robot-ros2_default_firmware_params.yaml": "differential",
    "10_nova_nova.yaml": "several nodes describe a rover: pivot_drive_controller (pivot_drive_controller/",
    "13_kalman_robot_twist_controller.yaml": "nothing here says where the wheels are",
    "17_clearpath_common_control.yaml": "mecanum",
    "18_clearpath_common_control.yaml": "differential",
    "24_husarion_ugv_ros_WH02_controller.yaml": "mecanum",
    "25_husarion_ugv_ros_WH05_controller.yaml": "differential",
    "33_linorobot2_navigation.yaml": "no node has the parameters of a rover; the file has amcl",
    "36_pmb2_robot_mobile_base_controller.yaml": "differential",
    "38_gz_ros2_control_ackermann_drive_controller.yaml": "ackermann",
    "42_ros2_control_demos_diffbot_chained_controllers.yaml": "differential",
    "45_ros2_controllers_ackermann_steering_controller_preceding_params.yaml": "ackermann",
    "49_ros2_controllers_mecanum_drive_controller_params.yaml": "several nodes describe a rover: /**/test",
    "50_ros2_controllers_test_omni_wheel_drive_controller.yaml": "omni",
    "55_forklift_one_forklift_controllers.yaml": "ackermann",
    "67_pathplanner_settings.json": "swerve",
    "68_YAGSL-Example_frontleft.json": "this is one module of a YAGSL swerve drive",
    "69_YAGSL-Example_swervedrive.json": "modules/frontleft.json is not beside this file",
    "76_abitobot_abitobot_controllers.yaml": "differential",
    "81_turtlebot3_burger.yaml": "differential",
}


@pytest.mark.skipif(not SHARED.is_dir(), reason="the files of real robots are not here")
@pytest.mark.parametrize("name", ANSWERS)
def test_the_answer_to_every_file_of_a_real_robot(name: str) -> None:
    answer = ANSWERS[name]
    if " " not in answer:
        assert read_parameters(SHARED / name).kind == answer
        return
    with pytest.raises(ParameterFileError) as caught:
        read_parameters(SHARED / name)
    (finding,) = caught.value.findings
    assert finding.message.startswith(answer)
    assert finding.remedy


@pytest.fixture
def read(tmp_path: Path):
    def read(text: str, name: str = "rover.yaml", **options: str):
        path = tmp_path / name
        path.write_text(text)
        return read_parameters(path, **options)

    return read


def refusal(call, *arguments: object, **options: str) -> str:
    with pytest.raises(ParameterFileError) as caught:
        call(*arguments, **options)
    (line,) = str(caught.value).splitlines()
    return line


SIDES = (
    "left_wheel_names: [l]\n    right_wheel_names: [r]\n    wheel_separation: 0.4\n    wheel_radius: 0.1\n"
)
DIFF = f"diff_drive_controller:\n  ros__parameters:\n    {SIDES}"


def test_a_negative_radius_multiplier_reverses_the_joints_of_its_side(read) -> None:
    rover = read(DIFF + "    right_wheel_radius_multiplier: -0.5\n").rover
    assert rover.reversed_joints == ("r",)
    assert [wheel.radius for wheel in rover.wheels] == [0.1, 0.05]
    assert rover.commands((0.1, 0.0, 0.0)) == {"l": pytest.approx(1.0), "r": pytest.approx(-2.0)}
    steering, wheels = rover.readings({"r": -2.0, "l": 1.0, "camera": 0.3})
    assert steering.shape == (0,)
    assert rover.forward(steering, wheels) == pytest.approx([0.1, 0.0, 0.0])
    path_free = dump(rover)
    assert "reversed_joints" in path_free


def test_reversed_joints_of_the_plain_form_come_back(read) -> None:
    text = "kind: differential\ntrack_width: 0.4\nwheel_radius: 0.1\nreversed_joints: [left_wheel_joint]\n"
    rover = read(text).rover
    assert rover.reversed_joints == ("left_wheel_joint",)
    assert read(dump(rover)).rover == rover
    line = refusal(read, text.replace("[left_wheel_joint]", "[middle]"))
    assert "reversed_joints must be some of the joints left_wheel_joint, right_wheel_joint" in line


def test_joints_behind_other_controllers_go_by_their_own_names(read) -> None:
    chained = DIFF.replace("[l]", "[pid_left/l]").replace("[r]", "[pid_right/r]")
    assert list(read(chained).rover.traction_joints) == ["l", "r"]
    car = """
car:
  ros__parameters:
    traction_joints_names: [pid/a, pid/b]
    steering_joints_names: [pid/c, pid/d]
    traction_joints_state_names: [rear_right, rear_left]
    steering_joints_state_names: [front_right_steer, front_left_steer]
    wheelbase: 1.0
    traction_track_width: 0.5
    traction_wheels_radius: 0.2
    steering_limit: 0.5
"""
    rover = read(car).rover
    assert rover.traction_joints == {"rear_right": "rear_right", "rear_left": "rear_left"}
    assert rover.joint_names[:2] == ("front_right_steer", "front_left_steer")


def test_one_name_that_tells_less_is_decided_by_the_other(read) -> None:
    pair = SIDES.replace("[l]", "[left_wheel_joint, rear_left_wheel_joint]").replace("[r]", "[fr, rr]")
    rover = read(f"c:\n  ros__parameters:\n    {pair}    wheelbase: 0.5\n").rover
    assert rover.traction_joints["left_wheel_joint"] == "front_left"


def test_a_forklift_steers_behind_with_joints_that_count_as_its_controller_commands(read) -> None:
    car = """
forklift:
  ros__parameters:
    traction_joints_names: [right_front_wheel, left_front_wheel]
    steering_joints_names: [right_rear_steer, left_rear_steer]
    wheelbase: 0.2
    traction_track_width: 0.1
    traction_wheels_radius: 0.05
    steering_limit: 1.0
"""
    found = read(car)
    wheels = {wheel.name: wheel for wheel in found.rover.wheels}
    assert (wheels["rear_left"].x, wheels["front_left"].x) == (-0.2, 0.0)
    assert wheels["rear_left"].steered
    assert not wheels["rear_left"].driven
    ahead = read(car.replace("front", "x").replace("rear", "front").replace("x", "rear")).rover
    twist = (0.1, 0.0, 0.2)
    assert [*found.rover.commands(twist).values()] == pytest.approx([*ahead.commands(twist).values()])
    assert "front wheels drive and the rear ones steer: so say the names" in str(found.warnings[0])


def test_keys_given_twice_octal_and_hexadecimal_numbers_are_read_as_ros_2_does(read) -> None:
    text = DIFF.replace("0.1\n", "0x1\n") + "    wheel_separation: 010\n"
    found = read(text)
    assert (found.rover.wheels[0].y, found.rover.wheels[0].radius) == (4.0, 1.0)
    texts = "\n".join(map(str, found.warnings))
    assert "wheel_separation is given twice, first on line 5 (the later counts, as in ROS 2" in texts
    assert "010 is octal and means 8" in texts
    nodes = "/**:\n  a:\n    ros__parameters:\n      rate: 1\n/**:\n  b:\n    ros__parameters:\n      "
    assert read(nodes + SIDES.replace("\n    ", "\n      ")).rover.wheel_names == ("left", "right")


def test_an_unknown_type_is_named(read) -> None:
    type_ = "my_controllers/CrabDriveController"
    manager = f"controller_manager:\n  ros__parameters:\n    {{name}}:\n      type: {type_}\n"
    unknown = manager.format(name="base") + "base:\n  ros__parameters:\n    wheels_apart: 0.4\n"
    line = refusal(read, unknown)
    assert "base has the type my_controllers/CrabDriveController, which is not known (known are ack" in line
    mine = manager.format(name="diff_drive_controller") + DIFF
    found = read(mine)
    assert "which is not known: read as diff_drive_controller, whose keys it has" in str(found.warnings[0])
    assert read(mine, kind="diff_drive_controller").warnings == ()
    line = refusal(read, mine, kind="diff_drive_controler")
    assert "--kind must name a kind or a controller, got diff_drive_controler (did you mean" in line


def test_several_vehicles_are_never_chosen_from(read) -> None:
    two = DIFF + DIFF.replace("diff_drive_controller", "other")
    line = refusal(read, two)
    assert "several nodes describe a rover: diff_drive_controller, other (choose one with --node" in line
    assert read(two, node="other").node == "other"


def test_a_command_that_never_becomes_too_old(read) -> None:
    plain = "kind: differential\ntrack_width: 0.4\nwheel_radius: 0.1\ncontrol: {timeout: never}\n"
    found = read(plain)
    assert found.control == {"timeout": None}
    assert read(dump(found.rover, control=found.control)).control == {"timeout": None}
    line = refusal(read, plain.replace("never", "nevr"))
    assert "control.timeout must be" in line


OLDER = {
    "ackermann": "    front_wheel_track: 0.15\n    rear_wheel_track: 0.14\n",
    "tricycle": "    wheel_track: 0.15\n",
    "bicycle": "",
}


@pytest.mark.parametrize("kind", OLDER)
def test_front_steering_false_is_the_same_vehicle_driving_the_other_way(read, kind: str) -> None:
    """Backwards, the older controllers' files with a rear axle that steers are those with a front one."""
    radius = "wheel_radius" if kind == "bicycle" else "wheels_radius"
    drives = "[r]" if kind == "bicycle" else "[right, left]"
    steers = "[right_steer, left_steer]" if kind == "ackermann" else "[steer]"
    text = f"""
c:
  ros__parameters:
    type: {kind}_steering_controller/{kind.capitalize()}SteeringController
    front_steering: false
    front_wheels_names: {drives}
    rear_wheels_names: {steers}
    wheelbase: 0.2
    front_{radius}: 0.05
    rear_{radius}: 0.04
    steering_limit: [-0.3, 1.0]
{OLDER[kind]}"""
    behind, ahead = (
        read(text),
        read(re.sub("(front|rear)(?=_wheel)", other_axle, text.replace("false", "true"))),
    )
    assert "front_steering is false" in str(behind.warnings[0])
    for wheel in behind.rover.wheels:
        there = next(
            each for each in ahead.rover.wheels if each.name == re.sub("front|rear", other_axle, wheel.name)
        )
        assert (wheel.x, wheel.y, wheel.radius, wheel.steered, wheel.driven) == (
            -there.x, there.y, there.radius, there.steered, there.driven,
        )  # fmt: skip
    # Each commands its joints alike: that is how the controller makes them.
    twist = (0.1, 0.0, 0.1)
    assert [*behind.rover.commands(twist).values()] == pytest.approx([*ahead.rover.commands(twist).values()])


@pytest.mark.parametrize("both", [False, True])
def test_a_rear_steered_tricycle_drives_the_other_way(read, both: bool) -> None:
    """One joint drives and steers the rear wheel, as forklifts have it."""
    text = """
c:
  ros__parameters:
    traction_joint_name: rear_traction_joint
    steering_joint_name: rear_steering_joint
    steering.min_position: -0.5
    steering.max_position: 1.0
    wheelbase: 1.2
    wheel_radius: 0.2
"""
    if both:
        text = """
c:
  ros__parameters:
    type: tricycle_steering_controller/TricycleSteeringController
    traction_joints_names: [rear_traction_joint]
    steering_joints_names: [rear_steering_joint]
    steering_limit: [-1.0, 0.5]
    traction_track_width: 0.8
    wheelbase: 1.2
    traction_wheels_radius: 0.2
"""
    behind, ahead = read(text).rover, read(text.replace("rear", "front")).rover
    (steered,) = [wheel for wheel in behind.wheels if wheel.steered]
    assert (steered.name, steered.x, steered.driven) == ("rear", -1.2, True)
    assert steered.steering_range == (-1.0, 0.5)
    assert behind.reversed_joints == ("rear_steering_joint",)
    twist = (0.1, 0.0, 0.02)
    assert [*behind.commands(twist).values()] == pytest.approx([*ahead.commands(twist).values()])
    assert "the rear wheel drives and steers: so say the names" in str(read(text).warnings)


def other_axle(found: re.Match[str]) -> str:
    return {"front": "rear", "rear": "front"}[found[0]]


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
