"""`six-wheel node`: commands and joint states in; joint commands, odometry, transforms and diagnostics out."""

import math
from typing import Any

from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from six_wheel.onboard import Settings, Step
from six_wheel.onboard.loop import SECOND
from six_wheel.ros.base import DEPTH, BaseNode, nanoseconds
from six_wheel.ros.interfaces import CommandInterface
from six_wheel.ros.parameters import NODE

__all__ = ["RoverNode"]

PLANAR = (0, 1, 5)  # x, y and yaw among the six of a covariance


class RoverNode(BaseNode):
    """The node that drives a rover."""

    def __init__(self, name: str, settings: Settings) -> None:
        super().__init__(name, settings, NODE)

    def _make(self) -> None:
        said, rate = self.settings.parameters, self.settings.options.update_rate
        self._interface = CommandInterface(
            self, self.options["command_interface"], self.settings.rover, 1 / rate
        )
        self._things += [(self.destroy_publisher, each) for each in self._interface.publishers]
        self._odom = self.publisher(Odometry, "odom", DEPTH)
        self._message = Odometry(child_frame_id=said.base_frame_id)
        self._message.header.frame_id = said.odom_frame_id
        self._odom_due = 0
        self._limited = None
        if self.options["publish_limited_velocity"]:
            self._limited = self.publisher(TwistStamped, "cmd_vel_out", DEPTH)
            self._twist = TwistStamped()
            self._twist.header.frame_id = said.base_frame_id
        self._tf = self._make_tf() if self.options["enable_odom_tf"] else None
        self.take_commands()
        # Takes what reliable and what best-effort publishers send; an old reading is of no use.
        sensor = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
        if not self.settings.options.open_loop:
            self.subscribe(JointState, "joint_states", self._on_joints, sensor)
        self.subscribe(PoseWithCovarianceStamped, "set_pose", self._on_pose, QoSProfile(depth=DEPTH))
        service = self.create_service(Trigger, "~/reset_odometry", self._on_reset)
        self._things.append((self.destroy_service, service))

    def _make_tf(self) -> Any:
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:
            self.get_logger().warning("no transforms are published: tf2_msgs is not installed")
            return None
        said = self.settings.parameters
        self._transform = TransformStamped(child_frame_id=said.base_frame_id)
        self._transform.header.frame_id = said.odom_frame_id
        self._transforms = TFMessage(transforms=[self._transform])
        return self.publisher(TFMessage, "/tf", DEPTH)

    def _commanding(self) -> Any:
        return self._interface.publishers

    # Calls

    def _on_joints(self, message: Any) -> None:
        now, stamp = self.now(), nanoseconds(message.header.stamp)
        names, positions, velocities = message.name, message.position, message.velocity
        step = self.loop.joints(names, positions, velocities, stamp, now)
        if step is not None:
            self._publish(step)
        if self.recorder is not None:
            self.recorder.joints(names, positions, velocities, stamp, now)
            if step is not None:
                self.recorder.step(step)

    def _publish(self, step: Step) -> None:
        stamp = Time(nanoseconds=step.now).to_msg()
        if step.steering is not None and step.speeds is not None:
            self._interface.publish(stamp, step.steering, step.speeds)
            if self._limited is not None:
                self._twist.header.stamp = stamp
                vx, vy, omega = step.twist
                self._twist.twist.linear.x, self._twist.twist.linear.y = vx, vy
                self._twist.twist.angular.z = omega
                self._limited.publish(self._twist)
        rate = self.settings.options.publish_rate
        if step.state is None or step.stamp is None or (rate and 0 <= self._odom_due - step.now < SECOND):
            return
        self._odom_due = step.now + (round(0.9 * SECOND / rate) if rate else 0)
        self._publish_odometry(step.stamp, step.state)

    def _publish_odometry(self, stamp: int, state: Any) -> None:
        message = self._message
        message.header.stamp = Time(nanoseconds=stamp).to_msg()
        x, y, yaw = state.pose.tolist()
        vx, vy, omega = state.twist.tolist()
        pose, twist = message.pose.pose, message.twist.twist
        pose.position.x, pose.position.y = x, y
        pose.orientation.z, pose.orientation.w = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
        twist.linear.x, twist.linear.y, twist.angular.z = vx, vy, omega
        message.pose.covariance = state.covariance_6x6().ravel()
        message.twist.covariance = state.twist_covariance_6x6().ravel()
        self._odom.publish(message)
        if self._tf is not None:
            self._transform.header.stamp = message.header.stamp
            self._transform.transform.translation.x, self._transform.transform.translation.y = x, y
            self._transform.transform.rotation = pose.orientation
            self._tf.publish(self._transforms)

    def _on_pose(self, message: Any) -> None:
        """The rover is here, as robot_localization has it."""
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        yaw = math.atan2(
            2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y * turn.y + turn.z * turn.z)
        )
        pose = [place.x, place.y, yaw]
        whole = [float(value) for value in message.pose.covariance]
        covariance = [[whole[6 * i + k] for k in PLANAR] for i in PLANAR]
        now = self.now()
        try:
            self.loop.set_pose(pose, covariance, now)
        except ValueError as error:
            self.loop.faults.add("odometry", 2, "set_pose must be a pose", " ".join(str(error).split()))
            return
        if self.recorder is not None:
            self.recorder.change({"pose": pose, "covariance": covariance}, now)

    def _on_reset(self, request: Any, response: Any) -> Any:
        now = self.now()
        self.loop.reset(now)
        if self.recorder is not None:
            self.recorder.change({"reset": [0.0, 0.0, 0.0]}, now)
        response.success, response.message = True, "odometry starts over at the origin"
        return response
