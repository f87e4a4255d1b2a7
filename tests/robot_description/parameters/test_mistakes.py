"""Mistakes in a parameter file: each a finding on its line, with rule and remedy."""

import pickle
import re

import pytest

import six_wheel as sw
from six_wheel.robot_description import parameters as config
from six_wheel.robot_description.parameters import ParameterFileError
from tests.robot_description.parameters.parameter_texts import DATA, WHEELS, ros


def test_five_mistakes_are_five_findings_on_their_lines():
    with pytest.raises(ParameterFileError) as caught:
        sw.load(DATA / "five_mistakes.yaml")
    assert [(finding.line, finding.key) for finding in caught.value.findings] == [
        (9, "traction_joints[5]"),
        (10, "steering_joints"),
        (12, "d2"),
        (13, "d3"),
        (15, "wheel_radus"),
    ]
    lines = str(caught.value).splitlines()
    assert lines[2].startswith(
        f"{DATA / 'five_mistakes.yaml'}:12: d2 must be finite and positive, got -0.5 ("
    )
    assert lines[4].endswith("unknown key wheel_radus (did you mean wheel_radius?)")
    copy = pickle.loads(pickle.dumps(caught.value))
    assert copy.findings == caught.value.findings
    assert str(copy) == str(caught.value)


TRACTION = [f"{wheel}_wheel" for wheel in WHEELS]

EXPLICIT = dict(zip(WHEELS, TRACTION, strict=True))
TURNED = {"front_left_wheel": "front_left"} | dict(list(EXPLICIT.items())[1:])

MISTAKES = {
    # mistakes: (file, line, words of message and remedy); one finding each
    "tab indent": ("rover:\n\tros__parameters:\n", 2, "tab in the indentation (replace the tab by spaces"),
    "syntax": ("d1: [0.4\nd2: 1\n", 2, "not valid YAML starts on line 1 (check"),
    "quote": ("d1: 1\nd2: 'x\n\n", 4, "not valid YAML starts on line 2"),
    "alias": ("a: &a 1\nd1: *a\n", 2, "alias *a, which ROS 2 does not read (write the value out)"),
    "documents": ("d1: 1\n---\nd1: 2\n", 2, "second YAML document"),
    "deep": ("d1: " + "[" * 50 + "]" * 50, 1, "nested more than 32 levels"),
    "duplicate joint": (ros([*TRACTION[:5], TRACTION[0]]), 3, "twice, first on line 3 rear_right here"),
    "five joints": (ros(TRACTION[:5]), 3, "must name 6 joints, got 5 (add the joint of rear_right)"),
    "seven joints": (ros([*TRACTION, "spare_fl"]), 3, "spare_fl for front_left, as front_left_wheel"),
    "same wheel": (ros([*TRACTION[:5], "fl"]), 3, "fl for front_left, as front_left_wheel rear_right here"),
    "untold": (ros([*TRACTION[:5], "m_6"]), 3, "m_6, does not tell wheel_of_joint: {m_6: rear_right}"),
    "contradiction": (ros([*TRACTION[:5], "rear_left_right"]), 3, "does not tell which wheel"),
    "middle steers": (ros(None, ["fl", "fr", "rl", "mr_steer"]), 4, "of middle_right, which does not steer"),
    "both lists": (ros(None, ["fl", "fr", "rl", TRACTION[5]]), 4, "named both in traction_joints on line 3"),
    "no such wheel": (ros({**EXPLICIT, "rear": "a"}), 3, "no wheel rear for a (the wheels are front_left,"),
    "joint for wheel": (ros(TURNED), 3, "no wheel front_left_wheel did you mean front_left?"),
    "stated wheel": (ros(wheel_of_joint={TRACTION[5]: "rr"}), 3, "no wheel rr did you mean rear_right?"),
    "stated joint": (ros(wheel_of_joint={"fl_wheel": "fl"}), 10, "fl_wheel, which is in neither list"),
    "joints as text": (ros("front_left"), 3, "must be a list of joint names, got 'front_left'"),
    "joint is a bool": (ros("[on, fr, ml, mr, rl, rr]"), 3, "[0] must be text, got on (put it in quotes)"),
    "joint is a number": (ros("[1, fr, ml, mr, rl, rr]"), 3, "[0] must be text, got 1 (put it in quotes)"),
    "joint is blank": (ros(["", *TRACTION[1:]]), 3, "[0]: a name must have visible characters"),
    "text for a number": (ros(d1="wide"), 5, "d1 must be a number, got 'wide' (it is half the distance"),
    "quoted number": (ros(d1="'0.4'"), 5, "d1 must be a number, got '0.4' (write 0.4, without quotes"),
    "comma": (ros(d1="0,4"), 5, "d1 must be a number, got '0,4' (write 0.4, without quotes, comma"),
    "unit": (ros(d1="0.4 m"), 5, "d1 must be a number, got '0.4 m'"),
    "sexagesimal": (ros(d1="1:30"), 5, "d1 must be a number, got '1:30'"),
    "underscore": (ros(d1="1_0.0"), 5, "d1 must be a number, got '1_0.0'"),
    "bool for a number": (ros(d1="yes"), 5, "d1 must be a number, got yes"),
    "list for a number": (ros(d1="[0.4]"), 5, "d1 must be a number, got a list"),
    "no value": (ros(d1=""), 5, "d1 must be a number, got nothing (it is half the distance"),
    "nan": (ros(d2=".nan"), 6, "d2 must be finite and positive, got"),
    "inf": (ros(d3="-.inf"), 7, "d3 must be finite and positive, got -inf"),
    "overflow": (ros(d3="1e999"), 7, "d3 must be finite and positive, got inf"),
    "zero": (ros(wheel_radius="0.0"), 9, "wheel_radius must be finite and positive, got 0"),
    "negative": (ros(d1="-0.4"), 5, "d1 must be finite and positive, got -0.4"),
    "negative d4": (ros(d4="-0.4"), 8, "d4 must be finite and not negative, got -0.4"),
    "steering limit 0": (ros(steering_limit="0.0"), 10, "steering_limit must be got 0"),
    "steering limit swapped": (ros(steering_limit="[1.0, 0.5]"), 10, "steering_limit must below 1.0 0.5"),
    "steering limit of three": (ros(steering_limit="[1, 2, 3]"), 10, "must be a number or two numbers"),
    "steering limit text": (ros(steering_limit="[a, 1.0]"), 10, "[0] must be a number, got 'a'"),
    "limit 0": (ros(limits="{speed: 0.0}"), 10, "limits.speed must be finite and positive, got 0.0 (it is"),
    "limit nan": (ros(limits="{jerk: nan}"), 10, "limits.jerk must be finite and positive, got nan"),
    "limit misspelt": (ros(limits="{sped: 1.0}"), 10, "unknown key limits.sped (did you mean speed?)"),
    "limit past range": (ros(limits="{steering_limit: 2}"), 10, "limits.steering_limit must lie inside"),
    "period too long": (ros(control="{period: 1.0}"), 10, "control.period must not exceed max_step=0.1"),
    "way misspelt": (ros(control="{timeuot: 1.0}"), 10, "unknown key control.timeuot (did you mean"),
    "no such way": (ros(control="{mode: sideways}"), 10, "control.mode must be one of 'free', 'crab'"),
    "limits no mapping": (ros(limits="3.0"), 10, "limits must be a mapping, got 3.0"),
    "missing": (ros(d3=...), 2, "d3 is missing (add d3, the distance from middle to front axle"),
    "missing joints": (ros(steering_joints=...), 2, "steering_joints is missing (add steering_joints, a"),
    "d5 for d4": (ros(d4=..., d5=0.45), 9, "unknown key d5 (did you mean d4?)"),
    "indentation": ("d1: 0.4\n  d2: 0.5\n", 2, "not valid YAML: a colon where no key can be"),
    "misspelt": (ros(wheel_radius=..., wheelRadius=1.0), 9, "wheelRadius (did you mean wheel_radius?)"),
    "joints_names": (ros(traction_joints=..., traction_joints_names=TRACTION), 9, "traction_joints?"),
    "frame": (ros(odom_frame_id="on"), 10, "odom_frame_id must be text, got on (put it in quotes)"),
    "kind": (ros(kind="six_weel"), 10, "kind must be one of six_wheel, got 'six_weel' mean six_wheel?"),
    "preset": ("preset: persevrance", 1, "preset must be one of perseverance, got persevrance"),
    "preset, wheels unknown": ("preset: husk\ntraction_joints: [fl, fr, rl, rr]", 1, "preset must be one of"),
    "preset and d1": ("preset: perseverance\nd1: 1.0", 2, "d1 is given besides a preset (remove d1"),
    "steerless preset": ("steering_limit: 1.0\npreset: husky", 1, "no wheel of preset husky steers"),
    "kind and preset": ("preset: husky\nkind: six_wheel", 2, "kind six_wheel does not fit the preset husky"),
    "empty": ("", None, "the file is empty (give it the keys d1"),
    "only a comment": ("# nothing\n", None, "the file is empty"),
    "a list": ("- d1\n- d2\n", 1, "the file must be a mapping, got a list"),
    "a word": ("rover", 1, "the file must be a mapping, got a single value"),
    "latin-1": (b"d1: 1\n# Stra\xdfe\n", 2, "not UTF-8 text: the byte 0xdf"),
    "binary": (b"\x7fELF\x02\x01\x01\x00\x00", 1, "not a text file: it has the character U+007F"),
    "large": (b"#" * (1 << 18) + b"\n", None, "larger than 262144 bytes"),
    "a level less": (ros().replace("  ros__parameters:\n", ""), 1, "rover has its keys without ros__"),
    "ros_parameters": (ros().replace("ros__", "ros_"), 2, "unknown key ros_parameters mean ros__parameters?"),
    "no node": (ros().replace("rover:\n  ", "").replace("\n    ", "\n  "), 1, "no node above it (write /**"),
    "empty node": ("rover:\n  ros__parameters:\n", 2, "ros__parameters must hold parameters"),
    "outside": (ros(d1=...) + "\nd1: 0.4", 10, "d1 stands outside ros__parameters, (move it"),
    "no rover": ("a: {ros__parameters: {}}\nb: {ros__parameters: {}}", None, "no node has a rover has a, b"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_found_on_its_line_with_rule_and_remedy(findings, mistake):
    content, line, words = MISTAKES[mistake]
    (finding,) = (finding for finding in findings(content) if finding.severity == "error")
    assert finding.line == line
    assert finding.remedy
    text = f"{finding.message} ({finding.remedy})"
    assert re.search(".*".join(map(re.escape, words.split())), text), text


def test_a_misspelt_key_does_not_hide_the_mistake_in_its_value(findings):
    spelling, value = findings(ros(wheel_radius=..., wheel_radus=-1.0))
    assert spelling.remedy == "did you mean wheel_radius?"
    assert (value.line, value.message) == (9, "wheel_radius must be finite and positive, got -1.0")


@pytest.mark.parametrize("path", [".", "missing.yaml", "a\0b", "x" * 5000])
def test_a_path_that_cannot_be_read_is_a_finding(path):
    with pytest.raises(ParameterFileError) as caught:
        sw.load(path)
    assert len(caught.value.findings) == len(str(caught.value).splitlines()) == 1


def test_a_node_asked_of_a_file_without_nodes():
    with pytest.raises(ParameterFileError, match="no nodes"):
        sw.load(DATA / "plain.yaml", node="rover")


# Warnings


@pytest.mark.parametrize(
    ("extra", "words"),
    [
        ("    brightness: 3", "unknown key brightness is ignored"),
        ("    d2_offset: 3", "unknown key d2_offset is ignored"),
        ("    steering_limit: 60", "60 degrees are 1.047 radians"),
        ("    limits: {brightness: 3}", "limits.brightness"),
    ],
)
def test_what_may_be_a_mistake_is_a_warning(read, extra, words):
    (warning,) = read(ros(extra=extra)).warnings
    assert warning.severity == "warning"
    assert warning.line == 10
    assert all(word in str(warning) for word in ["warning: ", *words.split()])


def test_an_integer_where_ros_wants_a_float_is_a_warning(read):
    (warning,) = read(ros(d2=1)).warnings
    assert (warning.line, warning.remedy) == (6, "write 1.0")


def test_keys_of_other_controllers_are_passed_over(read):
    extra = (
        "    use_sim_time: true\n    update_rate: 50\n    publish_rate: 50.0\n    linear.x.max_velocity: 1.0"
    )
    assert read(ros(extra=extra)).warnings == ()


def test_dump_refuses_what_a_file_cannot_say():
    with pytest.raises(ValueError, match="visible"):
        config.dump(sw.Rover([sw.Wheel("a\nb", 0.0, 0.0, radius=1.0)]))
