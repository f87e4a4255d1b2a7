"""Bags as they come from the field: counts, reversed joints, transforms, ROS 1, types nobody knows."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import six_wheel as sw

pytest.importorskip("rosbags", reason='needs pip install "six-wheel[bags]"')
pytest.importorskip("pyarrow")

from rosbags.rosbag1 import Writer as Writer1
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from six_wheel.kinematics.errors import TableError
from six_wheel.kinematics.poses import quaternions
from six_wheel.logs import JointLog, read_truth
from six_wheel.logs.detect_reader import read_log
from six_wheel.logs.log_options import LogOptions
from tests.logs.test_bags import CART, START, STORE, TYPES, header, joints, states, write

COUNTS = {"ticks_per_turn": 42.0, "gear_ratio": 5.0}


def drive(sign: float = 1.0, scale: float = 1.0) -> list[Any]:
    """A cart that rolls straight on, a tenth of a radian a message."""
    names = list(CART.traction_joints)
    return [
        joints(START + 100_000_000 * k, names, [0.1 * k * scale, 0.1 * k * scale * sign], [1.0, sign])
        for k in range(20)
    ]


def angles(path: Path, rover: sw.Rover, **options: Any) -> np.ndarray:
    log, _ = read_log(path, rover, LogOptions(**options))
    return log.wheel_angles - log.wheel_angles[0]


def test_encoder_settings_hold_in_bags_as_in_tables(tmp_path: Path) -> None:
    per_turn = 42.0 * 5.0
    bag = write(tmp_path / "bag", states(drive(scale=per_turn / math.tau)))
    found = angles(bag, CART, wheel_encoders=COUNTS)
    np.testing.assert_allclose(found[-1], [1.9, 1.9], atol=1e-12)  # rounding of counts to radians
    turned = angles(bag, CART, wheel_encoders=COUNTS | {"reversed": ["right"]})
    np.testing.assert_allclose(turned[-1], [1.9, -1.9], atol=1e-12)


def test_speeds_need_no_encoder_settings(tmp_path: Path) -> None:
    names = list(CART.traction_joints)
    messages = [joints(START + 100_000_000 * k, names, (), [1.0, 1.0]) for k in range(20)]
    bag = write(tmp_path / "bag", states(messages))
    np.testing.assert_allclose(angles(bag, CART, wheel_encoders=COUNTS)[-1], [1.9, 1.9], atol=1e-9)


@pytest.mark.parametrize("readings", ["angles", "speeds"])
def test_reversed_joints_are_turned_round(tmp_path: Path, readings: Any) -> None:
    rover = sw.Rover(CART.wheels, reversed_joints=["right_wheel_joint"])
    bag = write(tmp_path / "bag", states(drive(sign=-1.0)))
    np.testing.assert_allclose(angles(bag, rover, readings=readings)[-1], [1.9, 1.9], atol=1e-9)
    table = tmp_path / "log.csv"
    rows = [f"{0.1 * k},{0.1 * k},{-0.1 * k}" for k in range(5)]
    table.write_text("time,left_wheel_joint [rad],right_wheel_joint [rad]\n" + "\n".join(rows) + "\n")
    np.testing.assert_allclose(angles(table, rover)[-1], [0.4, 0.4])
    table.write_text("time,left [rad],right [rad]\n" + "\n".join(rows) + "\n")  # wheels, and not joints
    np.testing.assert_allclose(angles(table, rover)[-1], [0.4, -0.4])


@pytest.mark.parametrize("slash", ["", "/"])  # with which frames of ROS 1 began
def test_a_truth_out_of_transforms(tmp_path: Path, slash: str) -> None:
    types = STORE.types

    def transform(stamp: int, parent: str, child: str, x: float, yaw: float, pitch: float = 0.0) -> Any:
        turned = types["geometry_msgs/msg/Quaternion"](*quaternions(np.array([[0.0, pitch, yaw]]))[0])
        moved = types["geometry_msgs/msg/Transform"](types["geometry_msgs/msg/Vector3"](x, 0.0, 0.0), turned)
        top = types["std_msgs/msg/Header"](header(stamp).stamp, f"{slash}{parent}")
        return types["geometry_msgs/msg/TransformStamped"](top, f"{slash}{child}", moved)

    kind = types["tf2_msgs/msg/TFMessage"]
    first = kind([transform(START, "map", "odom", 1.0, math.pi / 2, 0.3)])
    moving = [kind([transform(START + 10**8 * k, "odom", "base_link", 0.1 * k, 0.0)]) for k in range(5)]
    messages = [("/tf", START + 10**8 * k, message) for k, message in enumerate([first, *moving])]
    bag = write(tmp_path / "bag", messages)
    _, poses, _ = read_truth(bag, topic="/tf")
    # 0.4 m along the x axis of odom that leads downwards, in the direction of the map's y.
    wanted = [1.0, 0.4 * math.cos(0.3), -0.4 * math.sin(0.3), 0.0, 0.3, math.pi / 2]
    np.testing.assert_allclose(poses[-1], wanted, atol=1e-15)
    with pytest.raises(TableError, match=r"no topic has messages .* the bag has /tf \(TFMessage\)"):
        read_truth(bag)
    with pytest.raises(TableError, match="at least one row"):
        read_truth(bag, topic="/tf:camera")


def test_a_bag_of_ros_1_is_read(tmp_path: Path) -> None:
    store = get_typestore(Stores.ROS1_NOETIC)
    types = store.types
    kind = "sensor_msgs/msg/JointState"
    path = tmp_path / "drive.bag"
    with Writer1(path) as writer:
        connection = writer.add_connection("/joint_states", kind, typestore=store)
        for k in range(10):
            stamp = START + 10**8 * k
            time = types["builtin_interfaces/msg/Time"](*divmod(stamp, 10**9))
            top = types["std_msgs/msg/Header"](k, time, "")
            values = np.array([0.1 * k, 0.1 * k])
            message = types[kind](top, list(CART.traction_joints), values, np.empty(0), np.empty(0))
            writer.write(connection, stamp, store.serialize_ros1(message, kind))
    np.testing.assert_allclose(angles(path, CART)[-1], [0.9, 0.9])


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_messages_of_unknown_types_are_read_around(tmp_path: Path, storage: str) -> None:
    own = "robot_msgs/msg/Battery"
    STORE.register(get_types_from_msg("float64 volts", own))
    message = STORE.types[own](12.0)
    bag = write(tmp_path / "bag", [("/battery", START, message), *states(drive())], storage)
    np.testing.assert_allclose(angles(bag, CART)[-1], [1.9, 1.9])


def test_a_bag_without_joint_states_names_its_topics(tmp_path: Path) -> None:
    odometry = TYPES["std_msgs/msg/Float64"](1.0)
    bag = write(tmp_path / "bag", [("/battery", START, odometry)])
    with pytest.raises(TableError, match=r"type JointState; the bag has /battery \(Float64\)"):
        JointLog(bag, CART)


def test_the_hint_at_a_missing_joint_is_a_wheels(tmp_path: Path) -> None:
    names = ["gripper_left_link_joint", "wheel_left", "wheel_right"]
    bag = write(tmp_path / "bag", states([joints(START + k, names, [0.0, 0.0, 0.0]) for k in range(3)]))
    with pytest.raises(TableError, match="no joint of any wheel"):
        JointLog(bag, CART)
