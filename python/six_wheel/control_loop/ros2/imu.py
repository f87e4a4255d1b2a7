"""A gyroscope as messages: what it reads, and how it sits in the rover."""

from collections.abc import Callable, Iterable
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu

from six_wheel.control_loop.faults import WARN, Faults
from six_wheel.control_loop.ros2.transforms import decode, message_type
from six_wheel.logs.bags.messages import OWN_FRAMES
from six_wheel.logs.gyroscope.links import Links
from six_wheel.logs.mcap.frames import angular_velocity

TOPIC = "imu/data"  # by REP 145, and as robot_localization has it
DEPTH = 100  # readings that may come while the node is at something else: each is a turn


class ImuInput:
    """The subscriptions to a gyroscope and to the transforms that stay.

    `take` is called with every message, its rates about the axes of the sensor [rad/s], and its stamp [ns],
    `mount` with the rover's z in those axes when it is known.
    """

    def __init__(
        self,
        node: Any,
        take: Callable[[bytes, tuple[float, ...], int], None],
        mount: Callable[[list[float]], None],
    ) -> None:
        said = node.settings.parameters
        self._faults: Faults = node.loop.faults
        self._take, self._mount = take, mount
        self._seated = not said.gyroscope.keys().isdisjoint({"roll", "pitch"})
        self._links = Links((said.base_frame_id, *OWN_FRAMES))
        self._frame: str | None = None
        self._known = False
        sensor = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
        node.subscribe(Imu, said.gyroscope.get("topic", TOPIC), self._on_imu, sensor, raw=True)
        if self._seated:
            return
        kind = message_type()
        if kind is None:
            return  # then only a frame of the rover's own is known
        lasting = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.subscribe(kind, "/tf_static", lambda message: self.link([*decode(message)]), lasting, raw=True)

    def link(self, transforms: Iterable[Any]) -> None:
        """geometry_msgs/TransformStamped that stay."""
        self._links.add(transforms)
        if not self._known:
            self._frame = None  # to be looked up again

    def _on_imu(self, message: bytes) -> None:
        try:
            stamp, frame, rates, measured = angular_velocity(message)
        except ValueError as error:
            self._faults.add("odometry", WARN, "a gyroscope must be readable", str(error))
            return
        if not measured:
            self._faults.add("odometry", WARN, "an Imu must have angular velocities, got none")
            return
        if not self._seated and frame != self._frame:
            self._frame = frame
            up = self._links.up(frame.lstrip("/"))
            self._known = up is not None
            self._mount([0.0, 0.0, 1.0] if up is None else up.tolist())
        if not (self._seated or self._known):
            rule = "a transform must tell how a gyroscope sits: its z is taken for the rover's"
            self._faults.add("odometry", WARN, rule, f"none of {frame}")
        self._take(message, rates, stamp)
