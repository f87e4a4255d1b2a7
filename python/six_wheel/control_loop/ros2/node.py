"""`six-wheel node`: commands and joint states in; joint commands, odometry, diagnostics out."""

import contextlib
import math
from typing import Any

from geometry_msgs.msg import PoseWithCovarianceStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from six_wheel.control_loop import Settings, Step
from six_wheel.control_loop.clock import SECOND
from six_wheel.control_loop.faults import ERROR
from six_wheel.control_loop.ros2.base import DEPTH, BaseNode
from six_wheel.control_loop.ros2.imu import ImuInput
from six_wheel.control_loop.ros2.interfaces import CommandInterface
from six_wheel.control_loop.ros2.parameters import NODE
from six_wheel.control_loop.ros2.transforms import message_type
from six_wheel.kinematics.errors import one_line
from six_wheel.logs.mcap import frames
from six_wheel.logs.mcap.frames import planar_pose, planar_twist

PLANAR = (0, 1, 5)  # x, y and yaw among the six of a covariance


class RoverNode(BaseNode):
    """The node that drives a rover."""

    def __init__(self, name: str, settings: Settings) -> None:
        super().__init__(name, settings, NODE)

    def _make(self) -> None:
        said, kind = self.settings.parameters, self.options["command_interface"]
        period = round(SECOND / self.settings.options.update_rate)
        self._interface = CommandInterface(self, kind, self.settings.rover, period)
        self._odom = self.publisher(Odometry, "odom", DEPTH)
        self._odometry = frames.odometry(said.odom_frame_id, said.base_frame_id)
        self._odom_due = 0
        self._limited = None
        if self.options["publish_limited_velocity"]:
            self._limited = self.publisher(TwistStamped, "cmd_vel_out", DEPTH)
            self._twist = frames.twist_stamped(said.base_frame_id)
        self._tf = self._make_tf() if self.options["enable_odom_tf"] else None
        self._states = frames.JointStates()
        self.take_commands()
        # Takes what reliable and what best-effort publishers send; an old reading is of no use.
        sensor = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
        if not self.settings.options.open_loop:
            self.subscribe(JointState, "joint_states", self._on_joints, sensor, raw=True)
        if self.settings.listens:
            self._imu = ImuInput(self, self._on_imu, self._on_mount)
        elif said.known_gyroscope is not None:
            self.get_logger().warning(
                "the gyroscope is not used: without joint states odometry is the commands"
            )
        pose = QoSProfile(depth=DEPTH)
        self.subscribe(PoseWithCovarianceStamped, "set_pose", self._on_pose, pose, area="odometry")
        self.serve(Trigger, "~/reset_odometry", self._on_reset)
        with contextlib.suppress(ImportError):  # of ros2_control, which not every robot has
            from control_msgs.srv import SetOdometry

            self.serve(SetOdometry, "~/set_odometry", self._on_set_odometry)

    def _make_tf(self) -> Any:
        kind = message_type()
        if kind is None:
            self.get_logger().warning("no transforms are published: tf2_msgs is not installed")
            return None
        said = self.settings.parameters
        self._transform = frames.transforms((said.odom_frame_id, said.base_frame_id))
        return self.publisher(kind, "/tf", DEPTH)

    def _commanding(self) -> Any:
        return self._interface.publishers

    # Calls

    def _on_joints(self, message: bytes) -> None:
        now = self.now()
        try:
            stamp, names, positions, velocities = self._states.parse(message)
        except ValueError as error:
            self.loop.faults.add("joints", ERROR, "joint states must be readable", str(error))
            return
        # The commands are published first, the other outputs of the step after them.
        step = self.loop.joints(names, positions, velocities, stamp, now, self._interface.publish)
        if step is not None:
            self._publish_outputs(step)
            self.halting.publish()
        if self.recorder is not None:
            self.recorder.joint_message(now, stamp, message)
            if step is not None:
                self.recorder.step(step)

    def _on_imu(self, message: bytes, rates: tuple[float, ...], stamp: int) -> None:
        now = self.now()
        step = self.loop.imu(rates, stamp, now)
        if self.recorder is not None:
            self.recorder.imu_message(now, stamp, message)
        self.after(step)

    def _on_mount(self, up: list[float]) -> None:
        now = self.now()
        self.loop.mount(up, now)
        self._record_change({"up": up}, now)

    def _publish(self, step: Step) -> None:
        if step.steering is not None and step.wheel_speeds is not None:
            self._interface.publish(step.now, step.steering, step.wheel_speeds)
        self._publish_outputs(step)

    def _publish_outputs(self, step: Step) -> None:
        """Publish the other outputs of a step: the motion, odometry, transforms."""
        if step.steering is not None and self._limited is not None:
            self._limited.publish(self._twist.pack(step.now, planar_twist(step.twist)))
        rate = self.settings.options.publish_rate
        if step.state is None or step.stamp is None or (rate and 0 <= self._odom_due - step.now < SECOND):
            return
        self._odom_due = step.now + (round(0.9 * SECOND / rate) if rate else 0)
        state = step.state
        place, motion = planar_pose(state.pose.tolist()), planar_twist(state.twist.tolist())
        covariance = state.covariance_6x6().ravel().tolist()
        of_twist = state.twist_covariance_6x6().ravel().tolist()
        self._odom.publish(self._odometry.pack(step.stamp, place, covariance, motion, of_twist))
        if self._tf is not None:
            self._tf.publish(self._transform.pack(step.stamp, place))

    def _on_pose(self, message: Any) -> None:
        """The rover is here, as robot_localization has it."""
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        yaw = math.atan2(
            2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y * turn.y + turn.z * turn.z)
        )
        pose = [place.x, place.y, yaw]
        whole = [float(value) for value in message.pose.covariance]
        covariance = [[whole[6 * i + k] for k in PLANAR] for i in PLANAR]
        if error := self._set_pose(pose, covariance):
            self.loop.faults.add("odometry", ERROR, "set_pose must be a pose", error)

    def _on_set_odometry(self, request: Any, response: Any) -> Any:
        """As ros2_controllers have it: the pose is that, for certain."""
        error = self._set_pose([request.x, request.y, request.yaw], [[0.0] * 3] * 3)
        flat = not any((request.z, request.roll, request.pitch))
        said = "odometry goes on from there" + ("" if flat else "; z, roll and pitch are not part of it")
        response.success, response.message = not error, error or said
        return response

    def _set_pose(self, pose: list[float], covariance: list[list[float]]) -> str:
        """Odometry goes on from a pose; returns what is wrong with it, if it cannot."""
        now = self.now()
        try:
            self.loop.set_pose(pose, covariance, now)
        except ValueError as error:
            return one_line(error)
        self._record_change({"pose": pose, "covariance": covariance}, now)
        return ""

    def _on_reset(self, request: Any, response: Any) -> Any:
        now = self.now()
        self.loop.reset(now)
        self._record_change({"reset": [0.0, 0.0, 0.0]}, now)
        response.success, response.message = True, "odometry starts over at the origin"
        return response
