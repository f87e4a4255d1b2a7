"""The rover of a node that was started without one: by its parameters, or by a topic."""

import time
from collections.abc import Callable
from typing import Any

from six_wheel.control_loop import Settings

Load = Callable[[str, bool], Settings]
"""Reads a rover: the path of a file or the name of a preset, or the text of a robot description (True)."""

PATIENCE = 10.0  # [s] for a robot description to come
TURN = 0.1  # [s] between looks at whether the process is to end


def settings_by_parameters(ros: Any, name: str, load: Load, is_ending: Callable[[], bool]) -> Settings | None:
    """Settings by the parameters ``rover`` or ``robot_description``, else by the topic of that name; None if
    the process is to end before they are there. Raises `ValueError` if there is none of them, or it describes
    no rover."""
    node = ros.create_node(name)
    try:
        rover, text = (node.declare_parameter(key, "").value for key in ("rover", "robot_description"))
        if rover:
            return load(rover, False)
        if not text:
            text = _heard(ros, node, is_ending)
    finally:
        node.destroy_node()
    return None if text is None else load(text, True)


def _heard(ros: Any, node: Any, is_ending: Callable[[], bool]) -> str | None:
    """The text on the topic, which is latched, as robot_state_publisher has it."""
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import String

    heard: list[str] = []
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    kept = node.create_subscription(
        String, "robot_description", lambda message: heard.append(message.data), latched
    )
    node.get_logger().info(f"no ROVER is given: waiting for {kept.topic_name}")
    executor = ros.executors.SingleThreadedExecutor()
    executor.add_node(node)
    latest = time.monotonic() + PATIENCE
    while not heard and not is_ending():
        if time.monotonic() > latest:
            ways = (
                "as an argument, the parameter rover or robot_description, or on the topic robot_description"
            )
            raise ValueError(f"ROVER must be given {ways}; none came within {PATIENCE:g} s")
        executor.spin_once(timeout_sec=TURN)
    executor.remove_node(node)
    executor.shutdown()
    return heard[-1] if heard else None
