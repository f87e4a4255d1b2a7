"""/tf where no tf2_msgs is installed, heard by another implementation of DDS and by rclpy."""

import json
import os
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import rclpy
from ament_index_python import get_package_share_directory
from rclpy.qos import DurabilityPolicy, QoSProfile

from six_wheel.control_loop.ros2 import transforms
from six_wheel.logs.mcap import frames
from tests.control_loop.ros2.peers import PATIENCE

pytestmark = pytest.mark.skipif(find_spec("tf2_msgs") is not None, reason="tf2_msgs is installed here")


def test_hash_of_the_type_is_that_of_its_description(monkeypatch):
    monkeypatch.setenv("AMENT_PREFIX_PATH", sys.prefix, prepend=os.pathsep)
    generator = pytest.importorskip("rosidl_generator_type_description")
    share = Path(get_package_share_directory("geometry_msgs"))
    copied = json.loads((share / "msg" / "TransformStamped.json").read_text())["type_description_msg"]
    transforms_field = {"type_id": 145, "capacity": 0, "string_capacity": 0}  # an unbounded sequence
    field = {
        "name": "transforms",
        "type": transforms_field | {"nested_type_name": copied["type_description"]["type_name"]},
        "default_value": "",
    }
    referenced = [copied["type_description"], *copied["referenced_type_descriptions"]]
    description = {
        "type_description": {"type_name": "tf2_msgs/msg/TFMessage", "fields": [field]},
        "referenced_type_descriptions": sorted(referenced, key=lambda each: each["type_name"]),
    }
    assert generator.calculate_type_hash(description) == f"RIHS01_{transforms.HASH}"


def test_transforms_are_those_of_odom(start, peer, cyclone, rover_file):
    reader = cyclone.Participant().reader("tf", cyclone.TFMessage, depth=500)
    start(
        "node", str(rover_file), "--ros-args", "-p", "base_frame_id:=chassis", "-p", "tf_frame_prefix:=mars"
    )
    peer.wanted = (0.5, 0.0, 0.3)
    heard = []

    def enough():
        heard.extend(each for each in reader.take(N=100) if isinstance(each, cyclone.TFMessage))
        return len(heard) > 50 and peer.odometry and peer.odometry[-1].pose.pose.position.x > 0.3

    peer.until(enough)
    stamped = {(each.header.stamp.sec, each.header.stamp.nanosec): each for each in peer.odometry}
    pairs = [
        (
            one.transforms[0],
            stamped.get((one.transforms[0].header.stamp.sec, one.transforms[0].header.stamp.nanosec)),
        )
        for one in heard
    ]
    both = [(transform, odometry) for transform, odometry in pairs if odometry is not None]
    assert len(both) > 30
    for transform, odometry in both:
        assert (transform.header.frame_id, transform.child_frame_id) == ("mars/odom", "mars/chassis")
        assert (odometry.header.frame_id, odometry.child_frame_id) == ("mars/odom", "mars/chassis")
        place, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        there, rotation = transform.transform.translation, transform.transform.rotation
        np.testing.assert_array_equal((there.x, there.y, there.z), (place.x, place.y, place.z))
        np.testing.assert_array_equal((rotation.z, rotation.w), (turn.z, turn.w))
    (info,) = peer.node.get_publishers_info_by_topic("/tf")
    assert (info.node_name, info.topic_type) == ("rover_controller", "tf2_msgs/msg/TFMessage")


def test_rclpy_sends_and_takes_them_as_bytes(monkeypatch):
    """From a publisher that stays to a subscription that comes later."""
    sent = frames.transforms(("base_link", "imu")).pack(1_500_000_000, (1.0, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8))
    heard: list[bytes] = []
    context = rclpy.Context()
    rclpy.init(context=context)
    try:
        node = rclpy.create_node("both", context=context)
        lasting = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        kind = transforms.message_type()
        publisher = node.create_publisher(kind, "/tf_static", lasting)
        publisher.publish(sent)
        kept = node.create_subscription(kind, "/tf_static", heard.append, lasting, raw=True)
        executor = rclpy.executors.SingleThreadedExecutor(context=context)
        executor.add_node(node)
        latest = time.monotonic() + PATIENCE
        while not heard and time.monotonic() < latest:
            executor.spin_once(timeout_sec=0.1)
        executor.shutdown()
        del kept
    finally:
        context.try_shutdown()
    (transform,) = transforms.decode(heard[0])
    assert (transform.header.frame_id, transform.child_frame_id) == ("base_link", "imu")
    assert (transform.header.stamp.sec, transform.header.stamp.nanosec) == (1, 500_000_000)
    assert transform.transform.translation.z == 3.0
    assert (transform.transform.rotation.y, transform.transform.rotation.w) == (0.6, 0.8)
