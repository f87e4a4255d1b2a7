"""`six-wheel filter`: commands in, commands out that the rover can follow, their curvature kept."""

from typing import Any

from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time

from six_wheel.control_loop import Settings, Step
from six_wheel.control_loop.faults import ERROR
from six_wheel.control_loop.ros2.base import DEPTH, BaseNode
from six_wheel.control_loop.ros2.parameters import FILTER
from six_wheel.kinematics.errors import one_line


class FilterNode(BaseNode):
    """The node between a planner and a robot that has a controller of its own."""

    def __init__(self, name: str, settings: Settings) -> None:
        super().__init__(name, settings.changed({"open_loop": True}), FILTER)

    def _make(self) -> None:
        self._stamped = self.options["use_stamped_vel"]
        self._out = self.publisher(TwistStamped if self._stamped else Twist, "cmd_vel_out", DEPTH)
        self._rests = 0
        self._waits = self.options["feedback"] == "CLOSED_LOOP"
        if self._waits:
            sensor = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
            self.subscribe(Odometry, "odom", self._on_odom, sensor)
        self.take_commands()

    def _commanding(self) -> Any:
        return (self._out,)

    def _on_odom(self, message: Any) -> None:
        """The first one says how the rover moves."""
        if not self._waits:
            return
        moving = message.twist.twist
        twist, now = [moving.linear.x, moving.linear.y, moving.angular.z], self.now()
        try:
            self.loop.begin(now, twist)
        except ValueError as error:
            self.loop.faults.add("odometry", ERROR, "odom must be a motion", one_line(error))
            return
        self._waits = False
        self._record_change({"begin": twist}, now)

    def _on_timer(self) -> None:
        if not self._waits:
            super()._on_timer()

    def _publish(self, step: Step) -> None:
        if step.wheel_speeds is None:
            return
        # At rest it is said once; whoever else wants to drive then may.
        self._rests = self._rests + 1 if step.twist == (0.0, 0.0, 0.0) and self.loop.stopped else 0
        if self._rests > 1:
            return
        message = TwistStamped() if self._stamped else Twist()
        twist = message.twist if self._stamped else message
        twist.linear.x, twist.linear.y, twist.angular.z = step.twist
        if self._stamped:
            message.header.stamp = Time(nanoseconds=step.now).to_msg()
            message.header.frame_id = self.settings.parameters.base_frame_id
        self._out.publish(message)
