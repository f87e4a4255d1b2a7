"""Parameter files of every kind: file and constructor give one rover, mistakes are found on their lines."""

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.robot_description import parameters as config
from six_wheel.robot_description.parameters import read_parameters
from six_wheel.robot_description.parameters.vehicle_types import KINDS
from tests.robot_description.parameters.vehicle_texts import CORNERS, unhurried

EXAMPLES = Path(__file__).parents[3] / "examples"
SQUARE = [(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25), (-0.3, -0.25)]

# The wheels of the examples, from the constructors.
ROVERS = {
    "swerve": sw.Rover.swerve(SQUARE, 0.05, names=CORNERS, steering_limit=3.1416),
    "differential": sw.Rover.differential(
        0.5708, 0.1651, wheels_per_side=2, wheelbase=0.512, icr_left=0.43, icr_right=-0.43
    ),
    "tracked": sw.Rover.tracked(0.4, 0.07, icr_left=0.31, icr_right=-0.29, icr_forward=-0.02),
    "ackermann": sw.Rover.ackermann(0.33, 0.28, 0.06, steering_limit=0.6),
    "tricycle": sw.Rover.tricycle(1.2, 0.7, 0.15, driven="front"),
    "bicycle": sw.Rover.bicycle(1.0, 0.33, steering_limit=0.7),
    "mecanum": sw.Rover.mecanum(0.4, 0.5, 0.076, roller_angle=0.7854),
    "omni": sw.Rover.omni(
        [(0.2, 0.0), (-0.1, 0.1732), (-0.1, -0.1732)], [1.5708, 3.6652, 5.7596], wheel_radius=0.04
    ),
    "rocker_bogie": sw.RockerBogie(
        rocker_pivot=(0.12075, 0.2, 0.105),
        rocker_to_front=(0.288, 0.0, -0.125),
        rocker_to_bogie=(-0.120753532836, 0.0, -0.104969444638),
        bogie_to_middle=(0.069, 0.0, -0.02),
        bogie_to_rear=(-0.069, 0.0, -0.02),
        wheel_radius=0.065,
        steered="front",
        steering_limit=1.0472,
    ).planar(),
    "four_axle": sw.FourAxle((0.4, 0.3), 0.2, 0.1, steering_limit=1.0).rover,
    "custom": sw.Rover(
        [
            sw.Wheel("left", 0.0, 0.2, radius=0.1),
            sw.Wheel("right", 0.0, -0.2, radius=0.1),
            sw.Wheel("rear", -0.35, 0.0, radius=0.08, steered=True, steering_limit=(-1.2, 1.2), driven=False),
            sw.Wheel("castor", 0.3, 0.0, radius=0.04, castor=True, trail=0.03),
        ]
    ),
}


def in_node(text: str) -> str:
    """The same keys as parameters of a node, two lines further down."""
    return "rover:\n  ros__parameters:\n" + re.sub("^", "    ", text, flags=re.M)


def integers_as_floats(text: str) -> str:
    return re.sub(r"(?<=[ \[])(-?\d+)(?=[,\] \n]|$)", r"\1.0", text)


# The same rover


@pytest.mark.parametrize("kind", sorted(KINDS.keys() - {"six_wheel"}))
def test_the_example_is_the_constructors_rover_in_both_forms(read, kind):
    path = EXAMPLES / f"{kind}.yaml"
    parameters = read_parameters(path)
    assert parameters.rover.wheels == ROVERS[kind].wheels
    assert (parameters.warnings, parameters.kind, parameters.controller) == ((), kind, None)
    node = read(in_node(path.read_text()))
    assert node.rover == parameters.rover
    assert node.node == "rover"


def test_the_examples_joints():
    swerve, omni = sw.load(EXAMPLES / "swerve.yaml"), sw.load(EXAMPLES / "omni.yaml")
    assert list(swerve.commands((1.0, 0.0, 0.0)))[:2] == ["fl_steer", "fr_steer"]
    assert list(swerve.traction_joints.values()) == CORNERS
    assert omni.traction_joints == {f"motor_{i}": f"wheel_{i}" for i in range(3)}
    car, bicycle = sw.load(EXAMPLES / "ackermann.yaml"), sw.load(EXAMPLES / "bicycle.yaml")
    assert car.traction_joints == {"left_wheel_joint": "rear_left", "right_wheel_joint": "rear_right"}
    assert car.steering_joints == {
        "left_steering_joint": "front_left",
        "right_steering_joint": "front_right",
    }
    assert (bicycle.traction_joints, bicycle.steering_joints) == ({"motor": "rear"}, {"handlebar": "front"})
    custom = sw.load(EXAMPLES / "custom.yaml")
    assert custom.traction_joints == {"drive_a": "left", "drive_b": "right"}


def test_what_a_list_of_lists_is_for_ros(read):
    rows, flat = "positions: [[1, 0.5], [-1, 0]]", "positions: [1.0, 0.5, -1.0, 0.0]"
    text = "kind: swerve\nwheel_radius: 0.1\n"
    rover = sw.Rover.swerve([(1.0, 0.5), (-1.0, 0.0)], 0.1)
    assert read(text + rows).rover == read(text + flat).rover == read(in_node(text + flat)).rover == rover
    assert read(in_node(text + flat)).warnings == ()
    (warning,) = read(in_node(text + rows)).warnings
    assert (warning.line, warning.key) == (5, "positions")
    assert "ROS 2 does not read" in str(warning)


def test_wheels_as_a_list_as_a_mapping_and_as_ros_parameters(read):
    keys = "x: 0.1, y: 0.2, radius: 0.3, steered: true"
    rover = sw.Rover([sw.Wheel("arm", 0.1, 0.2, radius=0.3, steered=True)])
    assert read(f"kind: custom\nwheels:\n- {{name: arm, {keys}}}").rover == rover
    assert read(f"kind: custom\nwheels: {{arm: {{{keys}}}}}").rover == rover
    dotted = "\n".join(f"wheels.arm.{key}" for key in keys.split(", "))
    assert read(in_node(f"kind: custom\n{dotted}")).rover == rover
    (warning,) = read(in_node(f"kind: custom\nwheels:\n- {{name: arm, {keys}}}")).warnings
    assert "list of mappings, which ROS 2 does not read" in str(warning)


@pytest.mark.parametrize("driven", ["front", "rear", "all"])
@pytest.mark.parametrize("kind", ["ackermann", "tricycle", "bicycle"])
def test_which_wheels_drive(read, kind, driven):
    lengths = {"wheelbase": 1.0, "track_width": 0.5, "wheel_radius": 0.1}
    if kind == "bicycle":
        del lengths["track_width"]
    text = "\n".join(f"{key}: {value}" for key, value in ({"kind": kind, "driven": driven} | lengths).items())
    assert read(text).rover == getattr(sw.Rover, kind)(**lengths, driven=driven)


def test_a_radius_for_each_side(read):
    text = "kind: tracked\ntrack_width: 0.4\nwheel_radius: [0.07, 0.08]"
    assert read(text).rover == sw.Rover.tracked(0.4, (0.07, 0.08))


# Joints


NAMINGS = {
    # kind: joint to wheel
    "ackermann": {"rear_left_wheel_joint": "rear_left", "wheel_rr": "rear_right"},
    "mecanum": {
        "fl": "front_left",
        "FrontRight": "front_right",
        "back_left": "rear_left",
        "m_rr": "rear_right",
    },
    "tricycle": {"front_wheel_joint": "front"},
    "swerve": {f"drive_{corner[0]}{corner.split('_')[1][0]}": corner for corner in CORNERS},
    "omni": {f"omni_{number}_joint": f"wheel_{number}" for number in range(3)},
    "custom": {"left_motor": "left", "right_motor": "right"},
}


@pytest.mark.parametrize("kind", NAMINGS)
@given(data=st.data())
@unhurried
def test_joints_in_any_order_are_one_rover(read, kind, data):
    joints = dict(data.draw(st.permutations(list(NAMINGS[kind].items()))))
    text = re.sub(
        r"^(traction|steering)_joints:.*\n?", "", (EXAMPLES / f"{kind}.yaml").read_text(), flags=re.M
    )
    rover = read(f"{text}\ntraction_joints: {list(joints)}").rover
    assert rover.wheels == ROVERS[kind].wheels
    assert rover.traction_joints == joints
    assert rover.joint_names[-len(joints) :] == tuple(joints)


def test_numbered_wheels_take_the_numbers_of_joints_or_their_order(read):
    text = "kind: swerve\nwheel_radius: 0.1\npositions: [1, 0, -1, 0, 0, 1]\ntraction_joints: "
    for names in ("m_0 m_1 m_2", "port aft bow"):
        joints = names.split()
        rover = read(f"{text}[{', '.join(joints)}]").rover
        assert rover.traction_joints == dict(zip(joints, rover.wheel_names, strict=True))
    rover = read(text + "[m_2, m_0, m_1]").rover
    assert rover.traction_joints == {f"m_{k}": f"module_{k}" for k in range(3)}
    assert rover.joint_names[-3:] == ("m_2", "m_0", "m_1")


def test_sides_and_numbers_together_tell_the_axle(read):
    text = "kind: differential\ntrack_width: 1\nwheel_radius: 0.1\nwheels_per_side: 4\nwheelbase: 2\n"
    joints = [f"{side}_{number}" for side in ("left", "right") for number in range(4)]
    rover = read(f"{text}traction_joints: {joints}").rover
    assert rover.traction_joints == {
        joint: "axle_{}_{}".format(*reversed(joint.split("_"))) for joint in joints
    }


# Files of any rover


names = st.text(st.characters(codec="utf-8", exclude_categories=("C", "Z")), min_size=1, max_size=8)
lengths = st.floats(-1e3, 1e3)


@st.composite
def wheels(draw):
    found = []
    for name in draw(st.lists(names, min_size=1, max_size=5, unique=True)):
        kind = draw(st.sampled_from(["fixed", "steered", "castor", "roller", "passive"]))
        keys = {
            "fixed": {"scrub": draw(lengths)},
            "steered": {"steered": True, "steering_limit": draw(st.none() | st.floats(0.01, 9.0))},
            "castor": {"castor": True, "trail": draw(st.floats(1e-3, 10.0))},
            "roller": {"roller_angle": draw(st.floats(0.1, 3.0))},
            "passive": {"driven": False},
        }[kind]
        heading, radius = draw(st.floats(-7, 7)), draw(st.floats(1e-3, 1e3))
        found.append(sw.Wheel(name, draw(lengths), draw(lengths), radius=radius, heading=heading, **keys))
    return found


@given(wheels=wheels(), node=st.none() | st.just("rover"))
@settings(unhurried, max_examples=100)
def test_dump_then_load_is_the_identity_for_any_rover(read, wheels, node):
    rover = sw.Rover(wheels)
    assert read(config.dump(rover, node=node)).rover == rover


@pytest.mark.parametrize("kind", ROVERS)
def test_dump_then_load_of_every_example(read, kind):
    rover = sw.load(EXAMPLES / f"{kind}.yaml")
    assert read(config.dump(rover, node="rover")).rover == rover


# Mistakes
