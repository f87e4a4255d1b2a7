"""Parameter files: any naming and order gives the same rover, every mistake is found at once, on its line."""

import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.robot_description import parameters as config
from six_wheel.robot_description.parameters import ParameterFileError, read_parameters
from tests.robot_description.parameters.parameter_texts import DATA, STEERED, WHEELS, ros
from tests.rovers import SIX_SIZES
from tests.rovers import SIX_WHEELS as ROVER

TWIST = (0.5, 0.0, 1 / 3)  # R = 1.5 m

# Spellings of front left; the other wheels follow the same pattern.
STYLES = {
    "{axle}_{side}_wheel_joint": ("front middle rear", "left right"),
    "wheel_{side}_{axle}": ("front center back", "left right"),
    "{axle}{side}": ("f m r", "l r"),
    "{axle}{side}_joint": ("F M R", "L R"),
    "{side}{axle}_drive": ("f m r", "l r"),
    "motor_{axle}_{side}": ("f m b", "l r"),
    "{axle}_{side}": ("front mid rear", "l r"),
    "joint_{side}_{axle}": ("f m r", "left right"),
    "{axle}_wheel_{side}_joint": ("front centre back", "L R"),
    "{side}{axle}Wheel": ("Front Middle Rear", "left right"),
    "wheel{axle}{side}": ("F C R", "L R"),
    "{side}-{axle}": ("FRONT CENTRE REAR", "LEFT RIGHT"),
    "rover/{axle}{side}motor": ("front mid back", "left right"),
    "{side}{axle}_1": ("f c b", "l r"),
}


def names(style: str, wheels: tuple[str, ...] = WHEELS) -> dict[str, str]:
    """Joint to wheel in one of the styles."""
    axles = dict(zip(("front", "middle", "rear"), STYLES[style][0].split(), strict=True))
    sides = dict(zip(("left", "right"), STYLES[style][1].split(), strict=True))
    pairs = [(wheel, *wheel.split("_")) for wheel in wheels]
    return {style.format(axle=axles[axle], side=sides[side]): wheel for wheel, axle, side in pairs}


# Laws

unhurried = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
JOINT = st.text(st.characters(codec="utf-8", exclude_categories=("C", "Z")), min_size=1)


@pytest.mark.parametrize("style", STYLES)
@given(data=st.data())
@settings(unhurried, max_examples=20)
def test_any_order_of_any_naming_is_the_same_rover(read, style, data):
    traction = dict(data.draw(st.permutations(list(names(style).items()))))
    steering = {f"{joint}_steer": wheel for joint, wheel in names(style, STEERED).items()}
    steering = dict(data.draw(st.permutations(list(steering.items()))))
    rover = read(ros(list(traction), list(steering))).rover
    assert rover.wheels == ROVER.wheels
    assert (rover.traction_joints, rover.steering_joints) == (traction, steering)
    assert (*rover.traction_joints.values(),) == WHEELS  # as in the arrays, whatever the file's order
    assert (*rover.steering_joints.values(),) == STEERED
    commands, angles, speeds = rover.commands(TWIST), *ROVER.inverse(TWIST)
    assert tuple(commands) == rover.joint_names == (*steering, *traction)
    assert [commands[joint] for joint in steering] == [angles[STEERED.index(steering[j])] for j in steering]
    assert [commands[joint] for joint in traction] == [speeds[WHEELS.index(traction[j])] for j in traction]


@given(
    d=st.tuples(*[st.floats(1e-6, 1e6)] * 3, st.floats(0, 1e6), st.floats(1e-6, 1e3)),
    limit=st.none() | st.floats(0.01, 3.0) | st.tuples(st.floats(-3, -0.01), st.floats(0.01, 3)),
    joints=st.lists(JOINT, min_size=10, max_size=10, unique=True),
    node=st.none() | st.just("rover"),
)
@example((1.0,) * 5, None, ["y", "n", "1e3", "010", "null", "~", "0x1", ".nan", "a b", "a.b"], "rover")
@unhurried
def test_dump_then_load_is_the_identity(read, d, limit, joints, node):
    d1, d2, d3, d4, radius = d
    layout = sw.Rover.six_wheel(
        front_to_middle=d3,
        middle_to_rear=d2,
        track_width=2 * d1,
        middle_track_width=2 * d4,
        wheel_radius=radius,
        steering_limit=limit,
    )
    traction = dict(zip(joints[:6], WHEELS, strict=True))
    steering = dict(zip(joints[6:], reversed(STEERED), strict=True))
    rover = sw.Rover(layout.wheels, traction_joints=traction, steering_joints=steering)
    parameters = read(config.dump(rover, node=node, odom_frame_id="o", base_frame_id="b"))
    assert parameters.rover == rover
    assert list(parameters.rover.joint_names) == [*joints[6:], *joints[:6]]
    assert (parameters.node, parameters.odom_frame_id, parameters.base_frame_id) == (node, "o", "b")


@given(number=st.floats(1e-100, 1e59), style=st.sampled_from(["{!r}", "{:e}", "{:.17g}", "{:E}", "+{!r}"]))
@unhurried
def test_a_number_is_read_however_it_is_written(read, number, style):
    text = style.format(number)
    assert read(f"d1: {text}\nd2: 1\nd3: 1\nd4: 1\nwheel_radius: 1").rover.wheels[0].y == float(text)


def read_or_refuse(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "any.yaml"
    path.write_bytes(content)
    try:
        findings = read_parameters(path).warnings
    except ParameterFileError as error:
        findings = error.findings
        assert len(str(error).splitlines()) == len(findings) > 0  # noqa: PT017 - both outcomes are right
    assert all(str(finding).startswith(str(path)) for finding in findings)
    assert all(finding.line is None or 1 <= finding.line <= len(content) + 1 for finding in findings)


@given(content=st.binary())
@example(b"\xff\xfed\x001\x00")
@example(b"\x00" * 100)
@unhurried
def test_random_bytes_are_read_or_refused(tmp_path, content):
    read_or_refuse(tmp_path, content)


@given(text=st.text() | st.text(alphabet="d14:- \n\t[]{}'\"#&*!|>%@,?~.e0"))
@example("[" * 5000)
@example("a: " + "{a: " * 3000)
@example("a: &a [*a]")
@example('"\\UFFFFFFFF"')
@example("%YAML " + "9" * 5000 + ".1\n---\na: 1")
@example(".".join("a" * 5000) + ": 1")
@example("? [a, b]\n: c\n? {d1: 2}\n: 3")
@example("d1: !!python/object/apply:os.system [ls]")
@example("d1: !!float abc\nd2: !!int x\nd3: !!bool maybe\nd4: !x 1\nwheel_radius: !!binary ab")
@example("a: 1\na.b.c: 2\na.d: 3")
@example("ros__parameters: {d1: 1}")
@example("rover: {ros__parameters: [1, 2]}")
@example("limits: {}\nlimits.speed: 1\nlimits: 3")
@unhurried
def test_random_text_is_read_or_refused(tmp_path, text):
    read_or_refuse(tmp_path, text.encode("utf-8", "surrogatepass"))


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(WHEELS),
    lambda inner: (
        st.lists(inner, max_size=7)
        | st.dictionaries(st.sampled_from([*WHEELS, "speed", "x"]), inner, max_size=3)
    ),
    max_leaves=12,
)
KEYS = [
    *(
        "traction_joints",
        "steering_joints",
        "wheel_of_joint",
        "d1",
        "d2",
        "d3",
        "d4",
        "wheel_radius",
        "preset",
    ),
    *(
        "steering_limit",
        "limits",
        "kind",
        "odom_frame_id",
        "base_frame_id",
        "ros__parameters",
        "d5",
        "radius",
        "/**",
    ),
]


@given(tree=st.dictionaries(st.sampled_from(KEYS), VALUES), nested=st.booleans())
@unhurried
def test_random_values_are_read_or_refused(tmp_path, tree, nested):
    text = repr({"rover": {"ros__parameters": tree}} if nested else tree)
    text = re.sub(r"\b(None|True|False)\b", lambda match: match[0].lower().replace("none", "null"), text)
    read_or_refuse(tmp_path, text.encode("utf-8", "surrogatepass"))


# Exact cases


def test_both_published_orders_are_one_rover_with_commands_in_the_files_order():
    by_axle, by_side = sw.load(DATA / "by_axle.yaml"), sw.load(DATA / "by_side.yaml")
    assert by_axle == ROVER
    assert by_side.wheels == ROVER.wheels
    first, second = by_axle.commands(TWIST), by_side.commands(TWIST)
    assert first == second
    assert list(first) != list(second)
    assert list(second)[:2] == ["front_left_steering_joint", "rear_left_steering_joint"]
    assert second["front_left_steering_joint"] == pytest.approx(0.426627, abs=1e-6)  # models.md, section 2
    assert second["front_left_wheel_joint"] == pytest.approx(2.685121, abs=1e-6)


def test_what_a_ros_file_says():
    parameters = read_parameters(DATA / "by_axle.yaml")
    assert parameters.node == "rover_controller"
    assert (parameters.odom_frame_id, parameters.base_frame_id) == ("odom", "base_footprint")
    assert (parameters.limits, parameters.control) == (sw.Limits(), {"timeout": 0.5})
    assert parameters.warnings == ()
    assert parameters.path == DATA / "by_axle.yaml"


def test_the_plain_form():
    parameters = read_parameters(DATA / "plain.yaml")
    assert parameters.rover == sw.Rover.six_wheel(**SIX_SIZES, steering_limit=(-1.0, 1.2))
    assert parameters.node is None
    assert (parameters.odom_frame_id, parameters.base_frame_id) == ("odom", "base_link")
    assert parameters.limits == sw.Limits(speed=1.0, jerk=2.0)


def test_a_preset():
    assert sw.load(DATA / "preset.yaml") == sw.Rover.preset("perseverance", steering_limit=1.2)


def test_the_example_is_clean():
    parameters = read_parameters(Path(__file__).parents[3] / "examples" / "rover.yaml")
    assert (parameters.rover, parameters.warnings) == (ROVER, ())


def test_d4_may_be_zero(read):
    assert read(ros(d4=0.0)).rover.wheels[2].y == 0.0


@pytest.mark.parametrize(
    "text", ["1e-3", "1E-3", "1.e-3", ".001", "+.1e-2", "0.001\t", "0.001 # metres", "00.001"]
)
def test_numbers_as_ros_reads_them(read, text):
    assert read(ros(d1=text)).rover.wheels[0].y == 1e-3


def test_a_tab_may_follow_a_key_or_a_value(read):
    assert read("d1:\t0.4\t# m\nd2: 0.5\nd3: 0.5\nd4: 0.45\nwheel_radius:\t 0.15\n").rover == ROVER


def test_joints_stated_beside_the_list(read):
    joints = [f"motor_{number}" for number in range(1, 7)]
    stated = (
        "    wheel_of_joint: {" + ", ".join(f"{j}: {w}" for j, w in zip(joints, WHEELS, strict=True)) + "}"
    )
    rover = read(ros(joints, extra=stated)).rover
    assert rover.traction_joints == dict(zip(joints, WHEELS, strict=True))


def test_joints_stated_in_place_of_the_list(read):
    rover = read(ros({wheel: f"j{number}" for number, wheel in enumerate(reversed(WHEELS))})).rover
    assert list(rover.joint_names[-6:]) == [f"j{number}" for number in range(6)]
    assert rover.traction_joints["j5"] == "front_left"


def test_a_statement_beats_the_name(read):
    extra = (
        "    wheel_of_joint.front_left_wheel: front_right\n    wheel_of_joint.front_right_wheel: front_left"
    )
    assert read(ros(extra=extra)).rover.traction_joints["front_left_wheel"] == "front_right"


def test_limits_in_both_ways_of_ros(read):
    text = ros(
        extra="    limits: {speed: 1, jerk: 2e0}\n    limits.wheel_speed: 8.0\n    steering_limit: 1.0"
    )
    assert read(text).limits == sw.Limits(speed=1.0, jerk=2.0, wheel_speed=8.0)


def test_the_ways_of_a_controller(read):
    text = ros(
        extra="    control: {timeout: 0.2, align: none}\n    control.mode: crab\n    control.period: 0.02"
    )
    assert read(text).control == {"timeout": 0.2, "align": None, "mode": "crab", "period": 0.02}


def test_limits_build_a_controller(read):
    text = ros(extra="    limits: {speed: 1.0, jerk: 2.0}\n    control: {timeout: 0.25, mode: crab}")
    controller = read(text).build_controller(mode="free")
    assert (controller.rover.wheels, controller.limits) == (ROVER.wheels, sw.Limits(speed=1.0, jerk=2.0))
    assert "timeout=0.25" in repr(controller)
    assert "crab" not in repr(controller)


def test_limits_and_ways_come_back_from_a_dump(tmp_path):
    limits, control = sw.Limits(speed=1.5, deceleration=2.0), {"timeout": 0.25, "align": None}
    path = tmp_path / "rover.yaml"
    for node in (None, "rover"):
        path.write_text(config.dump(ROVER, node=node, limits=limits, control=control))
        parameters = read_parameters(path)
        assert (parameters.rover, parameters.limits, parameters.control) == (ROVER, limits, control)


def test_what_stands_under_every_node_holds_for_the_rover_and_the_later_block_wins(read):
    text = "/**:\n  ros__parameters: {wheel_radius: 0.15, d1: 7.0}\n" + ros(wheel_radius=...)
    assert read(text).rover.wheels == ROVER.wheels
    later = ros() + "\n/**:\n  ros__parameters: {d1: 0.7}\n"
    assert read(later).rover.wheels[0].y == 0.7


def test_a_node_in_a_namespace(read):
    text = "mars:\n" + re.sub("^", "  ", ros(), flags=re.M)
    assert read(text).node == "mars/rover"
    assert read(text, node="rover").node == read(text, node="/mars/rover").node == "mars/rover"


def test_several_rovers_need_a_choice(read, findings):
    text = ros() + "\n" + ros(d1=0.3).replace("rover:", "twin:")
    (finding,) = findings(text)
    assert "several nodes describe a rover: rover, twin" in finding.message
    assert "node=" in (finding.remedy or "")
    assert read(text, node="twin").rover.wheels[0].y == 0.3
    (finding,) = findings(text, node="twins")
    assert finding.remedy == "did you mean twin?"


def test_a_wheeled_controller_beside_the_rover_is_not_one(read):
    other = (
        "\nbase:\n  ros__parameters: {wheel_radius: 0.1, odom_frame_id: odom, traction_joints_names: [a, b]}"
    )
    assert read(ros() + other).node == "rover"


# Mistakes
