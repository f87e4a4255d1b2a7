"""Files of other people's robots: each loads, or is refused by one line on which a stranger can act."""

import re
from pathlib import Path
from typing import get_args

import pytest
from typer.models import OptionInfo

from six_wheel.cli.shared import NodeOption
from six_wheel.robot_description.parameters import ParameterFileError, dump, read_parameters
from tests.robot_description.parameters.field_files import refusal

SHARED = Path(__file__).parents[4] / "shared" / "data" / "configs"

# The answer to each: the kind, or the beginning of the line that refuses it.
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
    # Under a name without "drive" it was taken for a six-wheeler without lengths.
    other = unknown.replace("CrabDriveController", "Crab").replace("wheels_apart: 0.4", "wheel_radius: 0.1")
    assert "base has the type my_controllers/Crab, which is not known (known are" in refusal(read, other)
    mine = manager.format(name="diff_drive_controller") + DIFF
    found = read(mine)
    assert "which is not known: read as diff_drive_controller, whose keys it has" in str(found.warnings[0])
    assert read(mine, kind="diff_drive_controller").warnings == ()
    line = refusal(read, mine, kind="diff_drive_controler")
    assert "--kind must name a kind or a controller, got diff_drive_controler (did you mean" in line


def test_several_vehicles_are_never_chosen_from(read) -> None:
    two = DIFF + DIFF.replace("diff_drive_controller", "other")
    line = refusal(read, two)
    answer = "several nodes describe a rover: diff_drive_controller, other (choose one with --parameters-node"
    assert answer in line
    assert read(two, node="other").node == "other"


def test_the_remedy_for_several_vehicles_is_an_option_that_the_commands_have(read) -> None:
    """It was ``--node``, the old name: who typed what the line said was told that there is no such option."""
    line = refusal(read, DIFF + DIFF.replace("diff_drive_controller", "other"))
    option = next(each for each in get_args(NodeOption) if isinstance(each, OptionInfo))
    declared = (option.default, *(option.param_decls or ()))  # typer has the first where a default would be
    assert re.findall(r"--[a-z-]+", line) == [each for each in declared if isinstance(each, str)]


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
