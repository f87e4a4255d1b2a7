"""Files for controllers of ros2_controllers: the rover moves as the controller would move it."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.robot_description.parameters import ParameterFileError, read_parameters
from six_wheel.robot_description.parameters.foreign.read_tables import FOREIGN

DATA = Path(__file__).parent / "data"
NAMES = [form.name for form in FOREIGN[:8]]  # those of ros2_controllers


def text_of(name: str) -> str:
    return (DATA / f"{name}.yaml").read_text()


# The same rover as a constructor's

ROVERS = {
    "diff_drive_controller": sw.Rover.differential(0.5, (0.1, 0.05)),
    "tricycle_steering_controller": sw.Rover.tricycle(1.2, 0.7, 0.15, driven="rear"),
    "tricycle_controller": sw.Rover.tricycle(1.2, 0.7, 0.15, driven="front", steering_limit=1.4),
    "bicycle_steering_controller": sw.Rover.bicycle(1.0, 0.33),
    "mecanum_drive_controller": sw.Rover.mecanum(0.4, 0.5, 0.076),
    "clearpath_mecanum_drive_controller": sw.Rover.mecanum(0.4, 0.5, 0.076),
}


@pytest.mark.parametrize("name", NAMES)
def test_the_file_says_all_there_is_to_say(name):
    parameters = read_parameters(DATA / f"{name}.yaml")
    assert (parameters.controller, parameters.warnings) == (name, ())
    assert parameters.kind in name or parameters.kind == "differential"
    if name in ROVERS:
        assert parameters.rover.wheels == ROVERS[name].wheels


def test_an_ackermann_car_has_two_tracks_in_the_names_of_every_distribution():
    newer, older = (
        sw.load(DATA / "ackermann_steering_controller.yaml"),
        sw.load(DATA / "ackermann_older.yaml"),
    )
    assert newer == older
    assert [(wheel.name, wheel.x, wheel.y, wheel.driven) for wheel in newer.wheels] == [
        ("front_left", 3.0, 1.0, False),
        ("front_right", 3.0, -1.0, False),
        ("rear_left", 0.0, 0.75, True),
        ("rear_right", 0.0, -0.75, True),
    ]
    assert newer.joint_names[:2] == ("front_right_steering_joint", "front_left_steering_joint")


def test_one_track_and_one_radius_are_the_constructors_car(read):
    text = text_of("ackermann_steering_controller").replace("    steering_track_width: 2.0\n", "")
    assert read(text).rover.wheels == sw.Rover.ackermann(3.0, 1.5, 0.5, steering_limit=0.6).wheels
    assert read(text + "    front_wheels_radius: 0.4\n").rover.wheels[0].radius == 0.4


def test_an_omni_wheel_stands_at_its_angle_and_drives_clockwise():
    rover = sw.load(DATA / "omni_wheel_drive_controller.yaml")
    for index, wheel in enumerate(rover.wheels):
        angle = 0.5 + index * math.pi / 2
        assert (wheel.x, wheel.y) == pytest.approx((0.2 * math.cos(angle), 0.2 * math.sin(angle)))
        assert math.remainder(wheel.heading - angle + math.pi / 2, math.tau) == pytest.approx(0.0, abs=1e-15)
    assert list(rover.traction_joints.values()) == ["wheel_0", "wheel_1", "wheel_2", "wheel_3"]


def test_limits_of_a_controller():
    differential = read_parameters(DATA / "diff_drive_controller.yaml").limits
    assert differential == sw.Limits(speed=1.5, acceleration=2.0)
    tricycle = read_parameters(DATA / "tricycle_controller.yaml").limits
    assert tricycle == sw.Limits(wheel_speed=8.0, steering_rate=1.0)


def without_limits(name: str) -> str:
    lines = text_of(name).splitlines()
    return "\n".join(line for line in lines if not re.search(r"linear|angular|cmd_vel_timeout", line))


@pytest.mark.parametrize(
    "slowing", ["max_deceleration: -3.0", "max_deceleration: 3.0", "min_acceleration: -3.0"]
)
def test_a_deceleration_of_a_controller(read, slowing):
    extra = f"\n    linear.x.max_acceleration: 2.0\n    linear.x.{slowing}\n    angular.z.max_velocity: 0.5\n"
    parameters = read(without_limits("diff_drive_controller") + extra)
    assert parameters.limits == sw.Limits(acceleration=2.0, deceleration=3.0, yaw_rate=0.5)
    assert parameters.warnings == ()


def test_the_ways_of_a_controller(read):
    extra = "\n    cmd_vel_timeout: 0.25\n    reduce_wheel_speed_until_steering_reached: true\n"
    assert read(without_limits("diff_drive_controller") + extra).control == {
        "timeout": 0.25,
        "align": "cosine",
    }
    never = read(without_limits("diff_drive_controller") + "\n    cmd_vel_timeout: 0.0\n")
    assert never.control == {"timeout": None}
    assert "timeout=None" in repr(never.build_controller())
    assert read(text_of("tricycle_controller")).control == {"timeout": 0.5}  # 500 ms


# The formulas of the controllers, as their documentation has them

speeds = st.floats(0.05, 2.0)
rates = st.floats(-0.4, 0.4)
unhurried = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)


def commands(name: str, twist: tuple[float, float, float]) -> list[float]:
    return list(sw.load(DATA / f"{name}.yaml").commands(twist).values())


@given(v=speeds, omega=rates)
@unhurried
def test_differential_drive(v, omega):
    expected = [(v - omega * 0.5 / 2) / 0.1, (v + omega * 0.5 / 2) / 0.05]
    assert commands("diff_drive_controller", (v, 0.0, omega)) == pytest.approx(expected)


@given(v=speeds, curvature=st.floats(-0.15, 0.15))
@unhurried
def test_ackermann_steering(v, curvature):
    steering, traction = math.atan(curvature * 3.0), v / 0.5
    right, left = (
        math.atan2(6.0 * math.sin(steering), 6.0 * math.cos(steering) + sign * 2.0 * math.sin(steering))
        for sign in (1, -1)
    )
    wheels = [traction * (1 + sign * curvature * 0.75) for sign in (1, -1)]
    expected = [right, left, *wheels]
    assert commands("ackermann_steering_controller", (v, 0.0, v * curvature)) == pytest.approx(expected)


@given(v=speeds, curvature=st.floats(-1.0, 1.0))
@unhurried
def test_tricycles_and_bicycle(v, curvature):
    twist = (v, 0.0, v * curvature)
    steering, rear = math.atan(curvature * 1.2), v / 0.15
    assert commands("tricycle_controller", twist) == pytest.approx([steering, rear / math.cos(steering)])
    sides = [rear * (1 + sign * curvature * 0.35) for sign in (1, -1)]
    assert commands("tricycle_steering_controller", twist) == pytest.approx([steering, *sides])
    bicycle = [math.atan(curvature * 1.0), v / 0.33]
    assert commands("bicycle_steering_controller", twist) == pytest.approx(bicycle)


@given(vx=rates, vy=rates, omega=rates, x=rates, y=rates, theta=rates, ahead=st.none() | st.floats(0.1, 0.4))
@unhurried
def test_mecanum_drive_about_an_offset_base_frame(read, vx, vy, omega, x, y, theta, ahead):
    text = text_of("mecanum_drive_controller").replace(
        "{x: 0.0, y: 0.0, theta: 0.0}", f"{{x: {x!r}, y: {y!r}, theta: {theta!r}}}"
    )
    text = text.replace("half_wheelbase: 0.2", "" if ahead is None else f"half_wheelbase: {ahead!r}")
    cos, sin = math.cos(theta), math.sin(theta)
    forward, left, turn = cos * vx - sin * vy + y * omega, sin * vx + cos * vy - x * omega, 0.45 * omega
    expected = {
        "wheel_fl": forward - left - turn,
        "wheel_fr": forward + left + turn,
        "wheel_rr": forward - left + turn,
        "wheel_rl": forward + left - turn,
    }
    found = read(text).rover.commands((vx, vy, omega))
    assert list(found) == list(expected)
    assert found == pytest.approx({joint: speed / 0.076 for joint, speed in expected.items()}, abs=1e-9)


@given(vx=rates, vy=rates, omega=rates)
@unhurried
def test_omni_wheel_drive(vx, vy, omega):
    angles = 0.5 + np.arange(4) * np.pi / 2
    expected = (np.sin(angles) * vx - np.cos(angles) * vy - omega * 0.2) / 0.02
    np.testing.assert_allclose(commands("omni_wheel_drive_controller", (vx, vy, omega)), expected, atol=1e-9)


# Names of controllers


def test_the_controller_manager_decides_what_keys_leave_open(read):
    joints = "traction_joints_names: [a], steering_joints_names: [b]"
    node = f"base:\n  ros__parameters: {{wheelbase: 1.0, {joints}, %s: 0.1}}\n"
    manager = "controller_manager:\n  ros__parameters:\n    base%stype: %s\n"
    bicycle, tricycle = (
        f"{name.lower()}_steering_controller/{name}SteeringController" for name in ("Bicycle", "Tricycle")
    )
    both = "wheel_track: 0.5, rear_wheels_radius"
    assert read(node % both).rover.wheel_names == ("front", "rear_left", "rear_right")
    assert read(node % "rear_wheels_radius" + manager % (":\n      ", tricycle)).rover.wheel_names == (
        "front",
        "rear",
    )
    for beside in ("", manager % (":\n      ", bicycle), manager % (".", bicycle)):
        assert read(beside + node % "rear_wheel_radius").controller == "bicycle_steering_controller"
    with pytest.raises(ParameterFileError, match="traction_wheel_radius is missing"):
        read(f"base:\n  ros__parameters: {{type: {bicycle}}}")


def test_a_kind_beside_a_controllers_names_is_that_controller(read):
    text = text_of("diff_drive_controller").replace(
        "    wheel_radius", "    kind: differential\n    wheel_radius"
    )
    assert read(text).controller == "diff_drive_controller"


def test_groups_of_parameters_in_every_way_of_ros(read):
    text = text_of("mecanum_drive_controller")
    lines = text.replace("    kinematics:\n", "").replace(
        "      wheels_radius", "    kinematics.wheels_radius"
    )
    lines = lines.replace("      sum_of", "    kinematics.sum_of")
    dotted = re.sub(r"      base_frame_offset.*", "    kinematics.base_frame_offset.x: 0.0", lines)
    assert read(dotted).rover == read(text).rover
    over = "/**:\n  ros__parameters:\n    kinematics: {wheels_radius: 0.1, base_frame_offset: {x: 1.0}}\n"
    assert read(over + text).rover == read(text).rover
    assert read(text + over).rover.wheels[0].radius == 0.1


def test_what_a_dump_of_all_parameters_says_is_not_given(read):
    text = text_of("ackermann_steering_controller")
    unset = ["front_wheels_radius", "rear_wheels_radius", "front_wheel_track", "rear_wheel_track"]
    text += (
        "".join(f"    {key}: 0.0\n" for key in unset)
        + "    rear_wheels_names: []\n    front_steering: true\n"
    )
    assert read(text).rover == sw.load(DATA / "ackermann_steering_controller.yaml")


@pytest.mark.parametrize("pairs", [1, 2, 3])
def test_wheels_of_a_side_by_name_or_from_front_to_rear(read, pairs):
    axles = ["front", "middle", "rear"] if pairs == 3 else ["front", "rear"]
    named = {side: [f"{axle}_{side}" for axle in axles[:pairs]] for side in ("right", "left")}
    numbered = {side: [f"{side[0]}{number}" for number in range(pairs)] for side in named}
    for lists in (named, numbered):
        backwards = {side: joints[::-1] if lists is named else joints for side, joints in lists.items()}
        text = "base:\n  ros__parameters:\n    wheel_separation: 0.5\n    wheel_radius: 0.1\n"
        text += "".join(f"    {side}_wheel_names: {joints}\n" for side, joints in backwards.items())
        parameters = read(text + "    wheelbase: 0.8\n")
        if pairs > 1:
            assert parameters.rover.joint_names == (*backwards["right"], *backwards["left"])
            wheels = {
                joint: wheel for side in lists for joint, wheel in zip(lists[side], named[side], strict=True)
            }
            assert parameters.rover.traction_joints == wheels
        assert parameters.warnings == ()


# Keys that the model does not have


DIFF, OMNI, MECANUM, TRICYCLE = (
    f"{name}_controller" for name in ("diff_drive", "omni_wheel_drive", "mecanum_drive", "tricycle")
)
CAR, BICYCLE, REAR_DRIVEN = (f"{name}_steering_controller" for name in ("ackermann", "bicycle", "tricycle"))
PAIRS = "[left_wheel_joint]\n    right_wheel_names: [right_wheel_joint]"
RIGHT_LEFT = "[rear_right_wheel_joint, rear_left_wheel_joint]"
AROUND = "[front_wheel_joint, left_wheel_joint, back_wheel_joint, right_wheel_joint]"

WARNINGS = [
    # controller, what is written there and what instead, the line, words of the warning
    (DIFF, "max_velocity: .nan", "min_velocity: -1.0", 31, "angular.z.min_velocity is not read"),
    (DIFF, "min_velocity: -1.5", "min_velocity: -0.5", 28, "linear.x.min_velocity is not read"),
    (DIFF, PAIRS, "[a, b]\n    right_wheel_names: [c, d]", 11, "where the 2 wheels square (add wheelbase"),
    (DIFF, "publish_rate: 50.0", "wheels_per_side: 2", 18, "wheels_per_side is 2 (the names count"),
    (DIFF, "wheel_separation: 0.4", "wheel_separation: 1", 13, "is an integer (write 1.0)"),
    (MECANUM, "half_wheelbase: 0.2", "", 11, "only a sum square (add half_wheelbase"),
    (TRICYCLE, "track_width: 0.7", "", 6, "does not say how far apart (add track_width"),
    (TRICYCLE, "traction:", "traction.max_jerk: 1.0\n    traction:", 11, "traction.max_jerk is not read"),
    (CAR, RIGHT_LEFT, "[rl, rr]", 7, "begins with rl, takes for rear_right here the names count"),
    (BICYCLE, "wheelbase", "gearing: 2.0\n    wheelbase", 5, "unknown key gearing is ignored"),
]


@pytest.mark.parametrize(("name", "before", "after", "line", "words"), WARNINGS)
def test_what_is_not_in_our_model_is_a_warning(read, name, before, after, line, words):
    (warning,) = read(text_of(name).replace(before, after)).warnings
    assert re.search(".*".join(map(re.escape, words.split())), str(warning)), warning
    assert warning.line == line


MISTAKES = {
    # mistakes: controller, what is written there and what instead, the line, words; one finding each
    "no factor": (DIFF, "plier: 0.5", "plier: 0.0", 17, "right_wheel_radius_multiplier must be 0.0"),
    "missing": (DIFF, "    wheel_separation: 0.4\n", "", 10, "wheel_separation is missing (add wheel_sep"),
    "no joints": (DIFF, "[left_wheel_joint]", "[]", 11, "left_wheel_names 1 to 32 joints, got 0"),
    "many": (DIFF, "[right_wheel_joint]", "[r0, r1]", 12, "right_wheel_names must name 1 joint, got 2"),
    "swapped": (DIFF, "[left_", "[right_", 11, "of right, on the other side wheel_of_joint"),
    "both sides": (DIFF, "[right_", "[left_", 12, "of left, which is on the other side"),
    "misspelt": (DIFF, "wheel_separation:", "wheel_seperation:", 13, "did you mean wheel_separation?"),
    "limit misspelt": (DIFF, "max_jerk", "max_jurk", 30, "did you mean linear.x.max_jerk?"),
    "limit a word": (DIFF, "max_jerk: 5.0", "max_jerk: low", 30, "must be a number, got 'low'"),
    "steers at the rear": (BICYCLE, "steering_axis", "rear", 4, "of rear, which does not steer"),
    "drives in front": (BICYCLE, "[rear_", "[front_", 3, "of front, which has no motor"),
    "one drives": (CAR, RIGHT_LEFT, "[motor]", 7, "2 joints got 1 rear_right, rear_left"),
    "no track": (CAR, "    traction_track_width: 1.5\n", "", 2, "traction_track_width is missing (add"),
    "zero radius": (CAR, "wheels_radius: 0.5", "wheels_radius: 0.0", 12, "must be set, got 0.0"),
    "negative track": ("ackermann_older", "track: 1.5", "track: -1.5", 10, "rear_wheel_track must be"),
    "two names": (CAR, "wheelbase", "rear_wheels_radius: 0.4\n    wheelbase", 9, "differ (remove rear_"),
    "no steering": (REAR_DRIVEN, "steering_joints_names: [steering_axis_joint]", "", 2, "is missing"),
    "range": (TRICYCLE, "x_position: 1.4", "x_position: -2.0", 15, "min_position the lower angle below"),
    "no range": (TRICYCLE, "x_position: 1.4", "x_position: 0.0\n      min_position: 0.0", 15, "0.0 to 0.0"),
    "same joint": (TRICYCLE, ": steering_joint", ": traction_joint", 4, "named both in traction_joint_name"),
    "joint is a list": (TRICYCLE, ": traction_joint", ": [traction_joint]", 3, "must be text, got a list"),
    "kinematics": (MECANUM, "radius: 0.076", "radius: -1.0", 10, "kinematics.wheels_radius must be"),
    "deep misspelt": (MECANUM, "wheels_ra", "wheel_ra", 10, "mean kinematics.wheels_radius?"),
    "offset": (MECANUM, "theta: 0.0", "theta: .inf", 9, "base_frame_offset.theta must be finite"),
    "half of the sum": (MECANUM, "base: 0.2", "base: 0.5", 12, "half_wheelbase must be smaller than"),
    "corner": (MECANUM, "name: wheel_rl", "name: wheel_r_right", 7, "of rear_right, has a key of its own"),
    "two wheels": (OMNI, AROUND, "[a, b]", 4, "wheel_names 3 to 64 joints, got 2"),
    "same wheel": (OMNI, "left_wheel_joint", "front_wheel_joint", 4, "names front_wheel_joint twice"),
    "no offset": (OMNI, "    wheel_offset: 0.5\n", "", 2, "wheel_offset is missing"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_found_on_its_line_with_rule_and_remedy(findings, mistake):
    name, before, after, line, words = MISTAKES[mistake]
    text = text_of(name)
    assert before in text
    found = [finding for finding in findings(text.replace(before, after)) if finding.severity == "error"]
    assert re.search(".*".join(map(re.escape, words.split())), str(found[0])), found
    assert [finding.line for finding in found] == [line]
    assert found[0].remedy


def test_a_kinematics_group_must_be_a_group(findings):
    text = re.sub(r"    kinematics:\n( {6}.*\n)+", "    kinematics: 3\n", text_of("mecanum_drive_controller"))
    assert any(finding.message == "kinematics must be a mapping, got 3" for finding in findings(text))


def test_a_joint_of_a_misleading_name_can_be_stated(read):
    text = text_of("diff_drive_controller").replace("[left_wheel_joint]", "[right_hand_wheel]")
    stated = text + "    wheel_of_joint: {right_hand_wheel: left}\n"
    assert read(stated).rover.traction_joints == {"right_hand_wheel": "left", "right_wheel_joint": "right"}


@pytest.mark.parametrize("name", NAMES)
@given(data=st.data())
@settings(unhurried, max_examples=30)
def test_half_a_file_is_read_or_refused(tmp_path, name, data):
    lines = text_of(name).splitlines()
    kept = data.draw(st.lists(st.sampled_from(range(len(lines))), unique=True).map(sorted))
    (path := tmp_path / "rover.yaml").write_text("\n".join(lines[index] for index in kept))
    try:
        found = read_parameters(path).warnings
    except ParameterFileError as error:
        found = error.findings
        assert found
    assert all(finding.line is None or 1 <= finding.line <= len(kept) + 1 for finding in found)
