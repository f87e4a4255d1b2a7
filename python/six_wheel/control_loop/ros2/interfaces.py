"""Joint commands as the usual controllers of ROS 2 take them, sent as bytes: rclpy has less to do."""

import math
from collections.abc import Sequence
from typing import Any

from six_wheel._core import Rover
from six_wheel.logs.mcap import frames
from six_wheel.robot_description.wheels_of_rover import joints_as_given

STATES = "joint_commands"
STEERING_GROUP = "forward_position_controller/commands"
WHEEL_GROUP = "forward_velocity_controller/commands"
TRAJECTORY = "joint_trajectory_controller/joint_trajectory"


class CommandInterface:
    """Publishers of joint commands; a trajectory is to be there in `period` [ns]."""

    def __init__(self, node: Any, kind: str, rover: Rover, period: int) -> None:
        from rclpy.qos import QoSProfile

        self.publishers: list[Any] = []
        steering, traction = map(list, joints_as_given(rover))
        self._whole = kind == "joint_state"
        self._nothing = [math.nan] * len(traction), [math.nan] * len(steering)

        def publisher(message: type, topic: str) -> Any:
            # As the controllers subscribe: reliable, volatile. Only the last command counts.
            self.publishers.append(node.fixed_publisher(message, topic, QoSProfile(depth=1)))
            return self.publishers[-1].publish

        if kind == "joint_state":
            from sensor_msgs.msg import JointState

            count = len(steering) + len(traction)
            self._frame = frames.joint_state([*steering, *traction], count, count)
            self._send = publisher(JointState, STATES)
            return
        from std_msgs.msg import Float64MultiArray

        self._frame = frames.values(len(traction))
        self._send = publisher(Float64MultiArray, WHEEL_GROUP)
        self._steer: Any = None
        if steering and kind == "group":
            self._steering_frame = frames.values(len(steering))
            self._steer = publisher(Float64MultiArray, STEERING_GROUP)
        elif steering:
            from trajectory_msgs.msg import JointTrajectory

            self._steering_frame = frames.trajectory(steering, period)
            self._steer = publisher(JointTrajectory, TRAJECTORY)

    def publish(self, stamp: int, steering: Sequence[float], speeds: Sequence[float]) -> None:
        """Send commands [ns, rad, rad/s]."""
        if self._whole:
            before, after = self._nothing
            self._send(self._frame.pack(stamp, [*steering, *before], [*after, *speeds]))
            return
        if self._steer is not None:
            self._steer(self._steering_frame.pack(stamp, steering))
        self._send(self._frame.pack(stamp, speeds))
