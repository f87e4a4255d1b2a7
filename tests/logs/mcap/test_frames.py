"""Messages in bytes: rosbags, with a serialiser of its own, reads what was laid out, and the reverse."""

import contextlib
import math
import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("rosbags", reason='needs pip install "six-wheel[bags]"')

from rosbags.typesys import Stores, get_typestore

from six_wheel.logs.mcap import frames

STORE = get_typestore(Stores.LATEST)
STAMP = 1_700_000_000_123_456_789
NAMES = st.lists(st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=9), max_size=6)
NUMBERS = st.lists(st.floats(), max_size=9)


def read(message: bytes, kind: str):
    return STORE.deserialize_cdr(message, kind)


def stamp_of(time) -> int:
    return time.sec * 10**9 + time.nanosec


def bits(values) -> list[int]:
    return np.asarray(values, dtype=float).view(np.int64).tolist()


@pytest.mark.slow
@given(
    names=NAMES, positions=NUMBERS, velocities=NUMBERS, efforts=NUMBERS, frame_id=st.text("abc/", max_size=9)
)
def test_joint_states_both_ways(names, positions, velocities, efforts, frame_id):
    groups = positions, velocities, efforts
    frame = frames.joint_state(names, *map(len, groups))
    message = frame.pack(STAMP, *(group for group in groups if group))
    content = read(message, "sensor_msgs/msg/JointState")
    assert (content.name, stamp_of(content.header.stamp)) == (names, STAMP)
    for group, name in zip(groups, ("position", "velocity", "effort"), strict=True):
        assert bits(getattr(content, name)) == bits(group)
    # The same from the other serialiser, with a frame in front, which shifts everything.
    content.header.frame_id = frame_id
    states = frames.JointStates()
    for _ in range(2):  # the second time by what is remembered of the names
        stamp, found, first, second = states.parse(
            bytes(STORE.serialize_cdr(content, "sensor_msgs/msg/JointState"))
        )
        assert (stamp, found) == (STAMP, names)
        assert (bits(first), bits(second)) == (bits(positions), bits(velocities))


def test_names_that_change_are_read_again():
    states = frames.JointStates()
    for names in (["a", "bc"], ["bc", "a"], ["bcd"], [], ["a", "bc"]):
        message = frames.joint_state(names, len(names), 0).pack(0, *([range(len(names))] if names else []))
        assert states.parse(message)[1:] == (names, tuple(range(len(names))), ())


@given(cut=st.integers(0, 200), at=st.integers(12, 150), count=st.integers(0, 2**32 - 1))
def test_damaged_joint_states_are_refused_or_read(cut, at, count):
    message = bytearray(frames.joint_state(["left", "right"], 2, 2).pack(STAMP, (1.0, 2.0), (3.0, 4.0)))
    if at + 4 <= len(message):
        struct.pack_into("<I", message, at, count)
    with contextlib.suppress(ValueError):  # and nothing else
        frames.JointStates().parse(bytes(message[:cut]))


def imu(frame_id: str, rates, variance: float):
    """The bytes of a sensor_msgs/Imu, by the other serialiser."""
    types = STORE.types
    covariance = np.zeros(9)
    covariance[0] = variance
    message = types["sensor_msgs/msg/Imu"](
        types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](*divmod(STAMP, 10**9)), frame_id),
        types["geometry_msgs/msg/Quaternion"](0.1, 0.2, 0.3, 0.9),
        np.full(9, 7.0),
        types["geometry_msgs/msg/Vector3"](*rates),
        covariance,
        types["geometry_msgs/msg/Vector3"](1.0, 2.0, 9.8),
        np.full(9, 8.0),
    )
    return bytes(STORE.serialize_cdr(message, "sensor_msgs/msg/Imu"))


@given(frame_id=st.text("abc/", max_size=9), rates=st.tuples(*[st.floats()] * 3), variance=st.floats())
def test_angular_velocities(frame_id, rates, variance):
    stamp, frame, found, measured = frames.angular_velocity(imu(frame_id, rates, variance))
    assert (stamp, frame, measured) == (STAMP, frame_id, variance != -1.0)
    assert bits(found) == bits(rates)


@given(cut=st.integers(0, 400), length=st.integers(0, 2**32 - 1))
def test_damaged_angular_velocities_are_refused_or_read(cut, length):
    message = bytearray(imu("imu_link", (1.0, 2.0, 3.0), 0.0))
    whole = frames.angular_velocity(bytes(message))
    if cut < len(message):
        with pytest.raises(ValueError, match=r"must be (CDR|whole)"):
            frames.angular_velocity(bytes(message[:cut]))
    struct.pack_into("<I", message, 12, length)
    with contextlib.suppress(ValueError):  # and nothing else
        assert frames.angular_velocity(bytes(message))[0] == whole[0]


def test_odometry_and_its_transform():
    pose, twist = frames.planar_pose((1.0, 2.0, math.pi / 2)), frames.planar_twist((0.1, 0.2, 0.3))
    covariances = np.arange(36.0), np.arange(36.0) + 100.0
    message = frames.odometry("odom", "base_link").pack(STAMP, pose, covariances[0], twist, covariances[1])
    content = read(message, "nav_msgs/msg/Odometry")
    assert (content.header.frame_id, content.child_frame_id) == ("odom", "base_link")
    assert stamp_of(content.header.stamp) == STAMP
    place, turn = content.pose.pose.position, content.pose.pose.orientation
    assert (place.x, place.y, place.z, turn.x, turn.y) == (1.0, 2.0, 0.0, 0.0, 0.0)
    np.testing.assert_allclose((turn.z, turn.w), math.sqrt(0.5))
    moving = content.twist.twist
    assert (moving.linear.x, moving.linear.y, moving.angular.z) == (0.1, 0.2, 0.3)
    np.testing.assert_array_equal(content.pose.covariance, covariances[0])
    np.testing.assert_array_equal(content.twist.covariance, covariances[1])
    (transform,) = read(
        frames.transforms(("odom", "base_link")).pack(STAMP, pose), "tf2_msgs/msg/TFMessage"
    ).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_link")
    assert (transform.transform.translation.x, transform.transform.rotation.z) == (1.0, turn.z)


def test_the_other_messages():
    twist = read(
        frames.twist_stamped("base").pack(STAMP, (1, 2, 3, 4, 5, 6)), "geometry_msgs/msg/TwistStamped"
    )
    assert (twist.header.frame_id, twist.twist.linear.y, twist.twist.angular.z) == ("base", 2.0, 6.0)
    for label in (None, "left,right"):
        values = read(frames.values(2, label).pack(0, (1.5, 2.5)), "std_msgs/msg/Float64MultiArray")
        assert values.data.tolist() == [1.5, 2.5]
        assert [(each.label, each.size) for each in values.layout.dim] == ([(label, 2)] if label else [])
    trajectory = read(
        frames.trajectory(["a", "b"], 20_000_000).pack(STAMP, (0.1, 0.2)),
        "trajectory_msgs/msg/JointTrajectory",
    )
    (point,) = trajectory.points
    assert (trajectory.joint_names, point.positions.tolist()) == (["a", "b"], [0.1, 0.2])
    assert (point.time_from_start.sec, point.time_from_start.nanosec, len(point.velocities)) == (
        0,
        20_000_000,
        0,
    )
    assert stamp_of(read(frames.clock().pack(STAMP), "rosgraph_msgs/msg/Clock").clock) == STAMP
    assert read(frames.text("räder"), "std_msgs/msg/String").data == "räder"


def test_times_before_1970_and_wrong_counts():
    clock = read(frames.clock().pack(-1), "rosgraph_msgs/msg/Clock").clock
    assert (clock.sec, clock.nanosec) == (-1, 999_999_999)
    with pytest.raises(struct.error):
        frames.twist_stamped("").pack(0, (1.0, 2.0))
