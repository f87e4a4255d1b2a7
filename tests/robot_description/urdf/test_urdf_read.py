"""Robot descriptions: what is found in a tree, against independent compositions and trees made for a rule."""

import csv
import importlib.util
import math
import re
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.robot_description.diagnostics import ParameterFileError
from six_wheel.robot_description.urdf import read_urdf
from six_wheel.robot_description.urdf.read import parse_urdf

SHARED = Path(__file__).parents[4] / "shared" / "data" / "urdf"
ROBOTS = {"curio": "curio", "osr": "osr", "nova_banksia": "banksia"}
ROUNDED = 1e-6  # [m or rad] the table has six decimals

needs_shared = pytest.mark.skipif(not SHARED.is_dir(), reason="the descriptions of real robots are not here")


def robot(*parts: str, root: str = "base_link") -> str:
    return f'<robot name="test"><link name="{root}"/>{"".join(parts)}</robot>'


def joint(
    name: str,
    kind: str,
    parent: str,
    xyz: str,
    axis: str = "0 1 0",
    *,
    rpy: str = "0 0 0",
    limit: str = "",
    radius: float | None = None,
) -> str:
    """A joint and the link `<name>_link` below it."""
    cylinder = (
        f'<collision><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="{radius}" length="0.05"/>'
        "</geometry></collision>"
        if radius
        else ""
    )
    return (
        f'<link name="{name}_link">{cylinder}</link><joint name="{name}" type="{kind}">'
        f'<parent link="{parent}"/><child link="{name}_link"/><origin xyz="{xyz}" rpy="{rpy}"/>'
        f'<axis xyz="{axis}"/>{limit}</joint>'
    )


def wheel(name: str, xyz: str, axis: str = "0 1 0", *, parent: str = "base_link", radius: float = 0.1) -> str:
    return joint(name, "continuous", parent, xyz, axis, radius=radius)


PAIR = wheel("left_wheel", "0 0.2 0.1") + wheel("right_wheel", "0 -0.2 0.1")


@needs_shared
@pytest.mark.parametrize("name", ROBOTS)
def test_wheels_of_real_robots_are_where_an_independent_composition_puts_them(name: str) -> None:
    with (SHARED / "wheels.csv").open() as file:
        rows = {row["joint"]: row for row in csv.DictReader(file) if row["robot"] == name}
    found = read_urdf(SHARED / f"{ROBOTS[name]}.urdf")
    assert {each.joint.name for each in found.wheels.values()} == rows.keys()
    by_name = {each.name: each for each in found.rover.wheels}
    for at, each in found.wheels.items():
        row = rows[each.joint.name]
        np.testing.assert_allclose(each.centre, [float(row[key]) for key in "xyz"], atol=ROUNDED)
        assert each.heading == pytest.approx(math.atan2(-float(row["ax"]), float(row["ay"])), abs=ROUNDED)
        if row["radius"]:
            assert each.radius == float(row["radius"])
        assert row["steer_joint"] == ("" if each.steering is None else each.steering.name)
        if each.steering is not None:
            np.testing.assert_allclose(each.pivot, [float(row["sx"]), float(row["sy"])], atol=ROUNDED)
        # Pivot, scrub and trail of the rover lead to the wheel's centre.
        made = by_name[at]
        forward = np.array([math.cos(made.heading), math.sin(made.heading)])
        left = np.array([-forward[1], forward[0]])
        contact = np.array([made.x, made.y]) - made.trail * forward + made.scrub * left
        np.testing.assert_allclose(contact, each.centre[:2], atol=ROUNDED)


@needs_shared
def test_the_open_source_rover_has_its_bogies_in_front() -> None:
    found = read_urdf(SHARED / "osr.urdf", wheel_radius=0.075)
    suspension = found.rover.suspension
    assert suspension is not None
    said = suspension.dimensions
    assert {"rocker_to_rear", "bogie_to_front", "bogie_to_middle"} <= said.keys()
    assert said["bogie_limit"] == (-0.5, 0.5)
    assert said["steering_limit"] == (-0.523599, 0.523599)
    texts = "\n".join(map(str, found.warnings))
    assert "<gazebo> is passed over" in texts  # the file's end of it is not XML
    assert "rocker_bogie_joint_L_1 is fixed, but its axis and limits are those of a rocker" in texts


@needs_shared
def test_curio_stands_on_a_rocker_bogie_with_its_bogies_behind() -> None:
    found = read_urdf(SHARED / "curio.urdf")
    assert found.suspension is not None
    assert found.suspension.joints["bogie_left"] == "left_bogie_joint"
    said = found.suspension.model.dimensions
    assert said["rocker_pivot"] == (0.071, 0.155, 0.0118)
    assert said["bogie_to_middle"] == (0.1063, 0.0929, -0.0959)
    assert found.rover.steering_joints["back_left_corner_joint"] == "rear_left"


def test_a_reversed_axis_is_a_sign_of_the_joint() -> None:
    found = parse_urdf(robot(wheel("a", "0 0.2 0.1"), wheel("b", "0 -0.2 0.1", "0 -1 0"))).rover
    assert found.reversed_joints == ("b",)
    assert [each.heading for each in found.wheels] == [0.0, 0.0]
    assert found.commands((0.1, 0.0, 0.0)) == {"a": pytest.approx(1.0), "b": pytest.approx(-1.0)}


def test_a_wheel_mounted_by_rotations_is_the_same_wheel() -> None:
    turned = joint(
        "w", "continuous", "base_link", "0 0.2 0.1", "0 0 1", rpy="-1.5707963267948966 0 0", radius=0.1
    )
    plain = parse_urdf(robot(PAIR)).wheels["left"]
    other = parse_urdf(robot(turned, wheel("right_wheel", "0 -0.2 0.1"))).wheels["left"]
    assert not other.reversed
    assert other.heading == pytest.approx(plain.heading, abs=1e-15)  # rounding of a quarter turn


def test_steering_gives_pivot_scrub_and_trail() -> None:
    limit = '<limit lower="-0.4" upper="0.6" effort="1" velocity="2"/>'
    steer = joint("s", "revolute", "base_link", "0.5 0.3 0.4", "0 0 -1", limit=limit)
    text = robot(PAIR, steer, wheel("front", "-0.02 0.05 -0.3", parent="s_link"))
    found = parse_urdf(text)
    (made,) = [each for each in found.rover.wheels if each.steered]
    assert (made.x, made.y) == (0.5, 0.3)
    assert (made.trail, made.scrub) == (0.02, 0.05)
    assert made.steering_range == (-0.6, 0.4)  # its axis points down
    assert found.rover.reversed_joints == ("s",)
    assert found.limits.steering_rate == 2.0


def test_a_tilted_steering_axis_is_met_at_the_height_of_the_wheels_centre() -> None:
    tilt = 0.1
    axis = f"{math.sin(tilt)} 0 {math.cos(tilt)}"
    limit = '<limit lower="-1" upper="1" effort="1" velocity="0"/>'
    steer = joint("s", "revolute", "base_link", "0.5 0.0 0.5", axis, limit=limit)
    found = parse_urdf(robot(PAIR, steer, wheel("front", "0 0 -0.4", parent="s_link"))).wheels["front"]
    np.testing.assert_allclose(found.pivot, [0.5 - 0.4 * math.tan(tilt), 0.0], atol=1e-15)
    assert found.trail == pytest.approx(-0.4 * math.tan(tilt), abs=1e-15)


def test_a_limit_that_no_joint_reaches_is_none() -> None:
    limit = '<limit lower="-1.8e308" upper="1.8e308" effort="1" velocity="1.8e308"/>'
    steer = joint("s", "revolute", "base_link", "0.5 0 0.4", "0 0 1", limit=limit)
    text = robot(PAIR, steer, wheel("front", "0 0 -0.3", parent="s_link"))
    found = parse_urdf(text)
    assert found.rover.wheels[0].steering_limit == math.inf
    assert found.limits == sw.Limits()
    rolling = joint("w", "revolute", "base_link", "0 0.2 0.1", limit=limit, radius=0.1)
    assert parse_urdf(robot(rolling, wheel("b", "0 -0.2 0.1"))).rover.wheel_names == ("left", "right")


@pytest.mark.parametrize(("axis", "kept"), [("0 0 1", (0.2, 1.0)), ("0 0 -1", (-1.0, -0.2))])
def test_a_range_without_straight_ahead_is_kept(axis: str, kept: tuple[float, float]) -> None:
    """0.2 to 1.0 rad was once read as a quarter turn to either side."""
    limit = '<limit lower="0.2" upper="1.0" effort="1" velocity="1"/>'
    steer = joint("s", "revolute", "base_link", "0.5 0 0.4", axis, limit=limit)
    found = parse_urdf(robot(PAIR, steer, wheel("front", "0 0 -0.3", parent="s_link")))
    assert found.rover.wheels[0].steering_range == kept


@pytest.mark.parametrize(
    ("limit", "says"),
    [
        ('lower="-inf" upper="0.5"', ":3: the range of s must have two ends or none, got -inf to 0.5 rad"),
        # Once read as a wheel that goes straight on.
        ('lower="0.2" upper="0.2"', ":3: s, above a wheel, must have a range or none, got 0.2 rad alone"),
        ('lower="0" upper="0.5" velocity="-1"', ":3: velocity of s must be positive, got -1 rad/s"),
    ],
)  # fmt: skip
def test_numbers_that_cannot_be_held_are_refused_with_their_line(limit: str, says: str) -> None:
    steer = joint("s", "revolute", "base_link", "0.5 0 0.4", "0 0 1", limit=f"<limit {limit}/>")
    with pytest.raises(ParameterFileError, match=re.escape(says)):
        parse_urdf(robot(PAIR, "\n\n", steer, wheel("front", "0 0 -0.3", parent="s_link")))


@pytest.mark.parametrize("kind", ["fixed", "continuous"])
def test_a_chain_of_any_length_is_read(kind: str) -> None:
    """It once was as long as the interpreter's limit of recursion."""
    names = ["base_link", *(f"{k}_link" for k in range(3000))]
    parts = [joint(f"{k}", kind, parent, "0 0 0") for k, parent in enumerate(names[:-1])]
    found = parse_urdf(robot(PAIR, *parts, wheel("last", "0.5 0 0.1", parent=names[-1])))
    assert len(found.wheels) == 3


def test_more_wheels_than_a_rover_has_are_refused_at_once() -> None:
    wheels = [wheel(f"w{k}", f"{k} 0 0.1") for k in range(3000)]
    with pytest.raises(ParameterFileError, match="a rover has 1 to 64 wheels, got 3000"):
        parse_urdf(robot(*wheels))
    most = [sw.Wheel(f"w{k}", k, 0.0, radius=0.1) for k in range(64)]
    assert parse_urdf(sw.Rover(most).urdf()).rover.wheels == tuple(most)


def test_names_lie_and_geometry_decides() -> None:
    found = parse_urdf(robot(wheel("left_wheel", "0 -0.2 0.1"), wheel("right_wheel", "0 0.2 0.1")))
    assert found.rover.traction_joints == {"right_wheel": "left", "left_wheel": "right"}
    texts = [str(each) for each in found.warnings]
    assert any("left_wheel says left, but its wheel is at y = -0.2 m, on the right" in text for text in texts)


def test_a_file_with_z_down_is_turned_over() -> None:
    """A rover's side with its wheels at larger z than what holds them."""
    parts = [
        joint(f"{side}_steer", "continuous", "base_link", f"0.5 {y} 0", "0 0 1")
        + wheel(f"{side}_wheel", "0 0 0.4", "0 -1 0", parent=f"{side}_steer_link")
        for side, y in (("left", -0.3), ("right", 0.3))
    ]
    found = parse_urdf(robot(*parts))
    assert found.up == -1.0
    left = found.wheels["left"]
    np.testing.assert_allclose(left.centre, [0.5, 0.3, -0.4])
    assert left.joint.name == "left_wheel"
    assert not left.reversed
    assert found.rover.reversed_joints == ("left_steer", "right_steer")
    assert "z down" in str(found.warnings[0])


def test_what_turns_far_above_the_ground_is_no_wheel() -> None:
    camera = joint("camera_tilt", "continuous", "base_link", "0.1 0 1.5", radius=0.02)
    found = parse_urdf(robot(PAIR, camera))
    assert found.rover.wheel_names == ("left", "right")
    assert "camera_tilt" in str(found.warnings[0])


def test_a_swivel_that_nothing_commands_is_a_castor() -> None:
    swivel = joint("swivel", "continuous", "base_link", "-0.4 0 0.2", "0 0 1")
    rolling = wheel("castor_wheel", "-0.05 0 -0.15", parent="swivel_link", radius=0.05)
    (castor,) = [each for each in parse_urdf(robot(PAIR, swivel, rolling)).rover.wheels if each.castor]
    assert castor.trail == 0.05
    assert not castor.driven
    command = '<ros2_control><joint name="swivel"><command_interface name="position"/></joint></ros2_control>'
    (steered,) = [
        each for each in parse_urdf(robot(PAIR, swivel, rolling, command)).rover.wheels if each.steered
    ]
    assert steered.trail == 0.05


def test_ros2_control_says_which_wheels_have_motors() -> None:
    text = (
        '<ros2_control><joint name="left_wheel"><command_interface name="velocity"/></joint></ros2_control>'
    )
    found = parse_urdf(robot(PAIR, text)).rover
    assert [each.driven for each in found.wheels] == [True, False]
    assert list(found.traction_joints) == ["left_wheel"]


def test_three_wheels_in_three_directions_are_omni_wheels() -> None:
    parts = []
    for k in range(3):
        angle = math.tau * k / 3
        x, y = 0.2 * math.cos(angle), 0.2 * math.sin(angle)
        yaw = f"0 0 {angle - math.pi / 2}"
        parts.append(joint(f"w{k}", "continuous", "base_link", f"{x} {y} 0.1", rpy=yaw, radius=0.1))
    found = parse_urdf(robot(*parts))
    assert [each.roller_angle for each in found.rover.wheels] == [math.pi / 2] * 3
    assert found.rover.mobility().degree_of_mobility == 3
    assert "taken as omni wheels" in str(found.warnings[0])


def test_axles_that_differ_by_a_rounded_right_angle_are_parallel() -> None:
    turned = joint("a", "continuous", "base_link", "0 0.2 0.1", "0 0 1", rpy="-1.57 0 0.0008", radius=0.1)
    found = parse_urdf(robot(turned, wheel("b", "0 -0.2 0.1")))
    assert len({each.heading for each in found.rover.wheels}) == 1
    assert found.rover.admissible((0.1, 0.1 * math.tan(0.0004), 0.2)) in (True, np.True_)


def test_wheels_that_slip_are_said_to() -> None:
    parts = [wheel(f"w{x}{y}", f"{x} {y} 0.1") for x in (0.2, -0.2) for y in (0.2, -0.2)]
    assert "effective track is not in a URDF" in str(parse_urdf(robot(*parts)).warnings[0])


def test_the_radius_is_of_a_shape_a_mesh_or_an_option(tmp_path: Path) -> None:
    bare = robot(
        joint("l", "continuous", "base_link", "0 0.2 0"), joint("r", "continuous", "base_link", "0 -0.2 0")
    )
    with pytest.raises(
        ParameterFileError, match=r"nothing tells the radius of l, r: no round shape \(give wheel_"
    ):
        parse_urdf(bare)
    assert parse_urdf(bare, wheel_radius=0.07).rover.wheels[0].radius == 0.07
    with pytest.raises(ValueError, match="radius must be finite and positive, got -1"):
        parse_urdf(bare, wheel_radius=-1.0)
    plugin = '<gazebo><plugin filename="drive"><wheel_diameter>0.3</wheel_diameter></plugin></gazebo>'
    assert (
        parse_urdf(robot(bare[len('<robot name="test"><link name="base_link"/>') : -len("</robot>")], plugin))
        .rover.wheels[0]
        .radius
        == 0.15
    )
    box = wheel("l", "0 0.2 0.1").replace("0.1", "0.1")
    assert (
        parse_urdf(robot(box, joint("r", "continuous", "base_link", "0 -0.2 0.1"))).rover.wheels[1].radius
        == 0.1
    )
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.cylinder(radius=0.11, height=0.04, sections=64).export(tmp_path / "tyre.stl")
    shape = (
        '<visual><origin rpy="1.5707963267948966 0 0"/><geometry><mesh filename="package://bot/tyre.stl"/>'
        "</geometry></visual>"
    )
    path = tmp_path / "bot.urdf"
    path.write_text(bare.replace('<link name="l_link">', f'<link name="l_link">{shape}'))
    found = read_urdf(path).wheels["left"]
    assert found.radius == pytest.approx(0.11, rel=1e-6)  # single precision
    assert "mesh tyre.stl in the visual" in found.radius_from


@pytest.mark.skipif(importlib.util.find_spec("xacrodoc") is None, reason="xacrodoc is not installed")
def test_a_xacro_is_expanded(tmp_path: Path) -> None:
    macro = '<xacro:arg name="r" default="0.1"/><xacro:property name="r" value="$(arg r)"/>'
    text = robot(macro, PAIR.replace('radius="0.1"', 'radius="${2*r}"'))
    path = tmp_path / "bot.urdf.xacro"
    path.write_text(text.replace("<robot ", '<robot xmlns:xacro="http://wiki.ros.org/xacro" '))
    assert read_urdf(path).rover.wheels[0].radius == 0.2
    assert read_urdf(path, arguments={"r": "0.2"}).rover.wheels[0].radius == 0.4
    path.write_text(
        text.replace("<robot ", '<robot xmlns:xacro="http://wiki.ros.org/xacro" ').replace("2*r", "no")
    )
    with pytest.raises(ParameterFileError, match="the xacro cannot be expanded: "):
        read_urdf(path)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "not valid XML: no element found"),
        ("<robot><link", "not valid XML: unclosed token"),
        ("<sdf/>", "the file must hold a <robot>, got an SDF"),
        ("<robot/>", "the file has no links"),
        (robot(), "no wheel found"),
        (robot(joint("j", "spinning", "base_link", "0 0 0")), "the joint j must be one of"),
        (robot(joint("j", "fixed", "nowhere", "0 0 0")), "the joint j has the link nowhere, which"),
        (robot(joint("j", "fixed", "base_link", "0 nan 0")), "xyz of j must be a number, got 'nan'"),
        (robot(joint("j", "fixed", "base_link", "0 1")), "xyz of j must be three finite numbers, got '0 1'"),
        (robot(joint("j", "fixed", "base_link", "0 inf 0")), "must be three finite numbers"),
        (robot(joint("j", "continuous", "base_link", "0 0 0", "0 0 0")), "the axis of the joint j must not"),
        (robot(PAIR, PAIR), "the link left_wheel_link is given twice"),
        (robot(joint("j", "fixed", "j_link", "0 0 0")), "some links form a circle, which the joint j closes"),
        (robot(joint("j", "continuous", "base_link", "0 0 0", "0 0 1")), "no continuous joint has"),
        (robot(joint("j", "fixed", "base_link", "${x} 0 0")), "expand the file with xacro first"),
        (
            robot(joint("j", "revolute", "base_link", "0 0 0", limit='<limit lower="1" upper="-1"/>')),
            "the limits of j must be in order",
        ),
    ],
)  # fmt: skip
def test_a_bad_description_is_one_line(text: str, says: str) -> None:
    with pytest.raises(ParameterFileError) as caught:
        parse_urdf(text)
    assert says in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_bytes_and_missing_files_are_one_line(tmp_path: Path) -> None:
    with pytest.raises(ParameterFileError, match="the file cannot be read: No such file"):
        read_urdf(tmp_path / "none.urdf")
    (tmp_path / "bytes.urdf").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ParameterFileError, match="the file is no text"):
        read_urdf(tmp_path / "bytes.urdf")
