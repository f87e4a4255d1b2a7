"""Joint commands as the usual controllers of ROS 2 take them."""

from array import array
from collections.abc import Sequence
from typing import Any

from six_wheel._core import Rover

__all__ = ["CommandInterface"]

STEERING_GROUP = "forward_position_controller/commands"
WHEEL_GROUP = "forward_velocity_controller/commands"
TRAJECTORY = "joint_trajectory_controller/joint_trajectory"
STATES = "joint_commands"


class CommandInterface:
    """Publishers of joint commands; messages are made once and filled again.

    Parameters
    ----------
    node : Node
    kind : {"joint_state", "group", "trajectory"}
    rover : Rover
    period : float
        In which a trajectory is to be there [s].
    """

    def __init__(self, node: Any, kind: str, rover: Rover, period: float) -> None:
        self._steering, self._traction = list(rover.steering_joints), list(rover.traction_joints)
        self._kind = kind
        self.publishers: list[Any] = []
        from rclpy.qos import QoSProfile

        def publisher(message: type, topic: str) -> Any:
            # As the controllers subscribe: reliable, volatile. Only the last command counts.
            made = node.create_publisher(message, topic, QoSProfile(depth=1))
            self.publishers.append(made)
            return made

        if kind == "joint_state":
            from sensor_msgs.msg import JointState

            self._state = JointState(name=[*self._steering, *self._traction])
            self._states = publisher(JointState, STATES)
            nothing = float("nan")
            self._before, self._after = [nothing] * len(self._traction), [nothing] * len(self._steering)
            return
        from std_msgs.msg import Float64MultiArray

        self._wheels = publisher(Float64MultiArray, WHEEL_GROUP)
        self._speeds = Float64MultiArray()
        if kind == "group":
            self._angles = Float64MultiArray()
            self._group = publisher(Float64MultiArray, STEERING_GROUP) if self._steering else None
        else:
            from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

            self._point = JointTrajectoryPoint()
            seconds, nanoseconds = divmod(round(period * 1e9), 1_000_000_000)
            self._point.time_from_start.sec, self._point.time_from_start.nanosec = seconds, nanoseconds
            self._trajectory = JointTrajectory(joint_names=self._steering, points=[self._point])
            self._group = publisher(JointTrajectory, TRAJECTORY) if self._steering else None

    def publish(self, stamp: Any, steering: Sequence[float], speeds: Sequence[float]) -> None:
        """Send commands [rad, rad/s]."""
        if self._kind == "joint_state":
            state = self._state
            state.header.stamp = stamp
            state.position = array("d", [*steering, *self._before])
            state.velocity = array("d", [*self._after, *speeds])
            self._states.publish(state)
            return
        self._speeds.data = array("d", speeds)
        self._wheels.publish(self._speeds)
        if self._group is None:
            return
        if self._kind == "group":
            self._angles.data = array("d", steering)
            self._group.publish(self._angles)
        else:
            self._point.positions = array("d", steering)
            self._trajectory.points = [self._point]
            self._group.publish(self._trajectory)
