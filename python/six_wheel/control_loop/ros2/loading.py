"""rclpy, from wherever it comes; and one line that says how to get it."""

import sys
from typing import Any

from six_wheel.kinematics.errors import one_line

MISSING = (
    "the nodes need rclpy: source a ROS 2 installation of this Python (. /opt/ros/jazzy/setup.bash) "
    'or pip install "six-wheel[ros]"'
)


def rclpy() -> Any:
    """The module. Raises `ModuleNotFoundError` with both ways to get it."""
    try:
        import rclpy
        import rclpy.lifecycle
    except ImportError as error:
        # A ROS installation of another Python has the module, and not its compiled part.
        name = getattr(error, "name", None) or "rclpy"
        version = "{}.{}".format(*sys.version_info)
        why = "" if name == "rclpy" else f" (this is Python {version}; {one_line(error)[:200]})"
        raise ModuleNotFoundError(MISSING + why, name="rclpy") from None
    return rclpy
