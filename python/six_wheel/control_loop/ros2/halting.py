"""Halt and release by an operator: services and a topic in, a topic that says whether the rover is halted."""

from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

DEPTH = 10  # that of the usual system defaults


class HaltInterface:
    """``~/halt`` and ``~/release`` (services), ``~/halt`` (topic in), ``~/halted`` (topic out, latched)."""

    def __init__(self, node: Any) -> None:
        self._node = node
        self._said: bool | None = None
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._halted = node.fixed_publisher(Bool, "~/halted", latched)
        node.serve(Trigger, "~/halt", self._on_halt)
        node.serve(Trigger, "~/release", self._on_release)
        # Not alone: everybody may halt the rover.
        node.subscribe(Bool, "~/halt", self._on_message, QoSProfile(depth=DEPTH), area="commands")
        self.publish()

    def publish(self) -> None:
        """Say whether the rover is halted, where that has changed."""
        if self._said is not self._node.loop.halted:
            self._said = self._node.loop.halted
            self._halted.publish(Bool(data=self._said))

    def _on_halt(self, request: Any, response: Any) -> Any:
        self._node.halt()
        self.publish()
        response.success = True
        response.message = "halted: at rest" if self._node.loop.stopped else "halted: coming to rest"
        return response

    def _on_release(self, request: Any, response: Any) -> Any:
        response.success = self._node.release()
        self.publish()
        released, refused = "the next command drives the rover", "the rover still moves: release it at rest"
        response.message = released if response.success else refused
        return response

    def _on_message(self, message: Any) -> None:
        """True halts. False does nothing: a publisher that repeats it must not end the halt of another."""
        if message.data:
            self._node.halt()
            self.publish()
