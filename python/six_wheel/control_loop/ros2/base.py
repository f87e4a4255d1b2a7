"""Base of both nodes: parameters, lifecycle, time, a timer, commands in, diagnostics, a record."""

import gc
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, ClockType
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.time import Time

from six_wheel.control_loop import Loop, Option, Settings, Step
from six_wheel.control_loop.diagnostics import FaultLines, Status, statuses
from six_wheel.control_loop.faults import ERROR, OK, WARN
from six_wheel.control_loop.recorder import Recorder
from six_wheel.control_loop.ros2.halting import HaltInterface
from six_wheel.control_loop.ros2.parameters import Declared
from six_wheel.kinematics.errors import one_line

REPORTS = 1.0  # [s] between diagnostics
DEPTH = 10  # that of the usual system defaults


def nanoseconds(stamp: Any) -> int:
    """A time of a message."""
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


class BaseNode(LifecycleNode):
    """A node around a `Loop`.

    The settings are those of the parameter file, and ROS parameters come over them; `own` are options of the
    node.
    """

    def __init__(self, name: str, settings: Settings, own: Sequence[Option]) -> None:
        super().__init__(name)
        self._declared = Declared(self, settings, own)
        self.options = self._declared.own
        self.settings = self._declared.settings
        self.loop = Loop(self.settings)
        self.recorder: Recorder | None = None
        self._things: list[Any] = []
        self._topics: list[tuple[str, bool, str, str]] = []
        self._fault_lines = FaultLines()
        self.add_on_set_parameters_callback(self._set_parameters)

    # Lifecycle

    def on_configure(self, state: Any) -> Any:
        """Topics are there and odometry counts; nothing is commanded yet."""
        try:
            self._configure()
        except Exception as error:  # rclpy tells nobody of it
            self.get_logger().error(one_line(error))
            self.on_cleanup(state)
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    def _configure(self) -> None:
        halted = self.loop.halted
        self.loop = Loop(self.settings)
        if self.options["record"] and self.recorder is None:
            path = Path(self.options["record"])
            if path.exists():
                raise ValueError(f"record must be a new file, got {path}")
            try:
                self.recorder = Recorder(path, self.settings)
            except OSError as error:
                rule = f"record must be a file that can be written, got {path}"
                raise ValueError(f"{rule}: {error.strerror or error}") from None
        self._activate(False)
        if halted:
            self.halt()
        self._make()
        self.halting = HaltInterface(self)
        from diagnostic_msgs.msg import DiagnosticArray

        self._diagnostics = self.publisher(DiagnosticArray, "/diagnostics", DEPTH)
        # By a clock that cannot be stopped: a simulation that stands still is to be reported as well.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        for period, call in (
            (1.0 / self.settings.options.update_rate, self._on_timer),
            (REPORTS, self._on_report),
        ):
            timer = self.create_timer(period, call, clock=steady)
            self._things.append((self.destroy_timer, timer))

    def on_activate(self, state: Any) -> Any:
        """Commands are taken."""
        self._activate(True)
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: Any) -> Any:
        """The rover stops within its limits, then nothing is commanded."""
        self._activate(False)
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state: Any) -> Any:
        """As before `on_configure`, the wheels commanded to rest."""
        self.send_rest()
        for destroy, thing in self._things:
            destroy(thing)
        self._things.clear()
        self._topics.clear()
        self.end_record()
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: Any) -> Any:
        """The end."""
        return self.on_cleanup(state)

    def _LifecycleNodeMixin__on_change_state(self, request: Any, response: Any) -> Any:  # noqa: N802
        """rclpy's own, which ends the process at a transition that the present state does not have."""
        try:
            return super()._LifecycleNodeMixin__on_change_state(request, response)
        except Exception as error:  # rclpy has no class for it that all versions share
            self.failed(error)
            response.success = False
            return response

    def failed(self, error: Exception) -> None:
        """A request could not be served; the node goes on."""
        said = one_line(error)
        self.loop.faults.add("commands", WARN, "a request must be one that the node can serve", said)
        self.get_logger().error(f"a request could not be served: {said}", throttle_duration_sec=1.0)

    def _activate(self, active: bool) -> None:
        now = self.now()
        self.loop.activate(now, active)
        self._record_change({"active": active}, now)

    def stop(self) -> None:
        """Stop within the limits, and take no more commands."""
        if self.loop.active:
            self._activate(False)

    def halt(self) -> None:
        """Stop at `halt_deceleration`, and take no commands until `release`."""
        now = self.now()
        self.loop.halt(now)
        self._record_change({"halt": True}, now)

    def release(self) -> bool:
        """End a halt; False while the rover still moves."""
        now = self.now()
        released = self.loop.release(now)
        self._record_change({"release": True}, now)
        return released

    def send_rest(self) -> None:
        """Command the wheels to rest in one step, as the last command of this loop, if it commands them."""
        now = self.now()
        step = self.loop.end(now)
        if step is None:
            return
        try:
            self._publish(step)
            self._record_change({"end": True}, now)
            if self.recorder is not None:
                self.recorder.step(step)
        except Exception as error:  # a topic that is gone, a record that is full: what follows goes on
            self.failed(error)

    def end_record(self) -> None:
        """Close the record, if there is one."""
        if self.recorder is not None:
            recorder, self.recorder = self.recorder, None
            try:
                recorder.close()
            except OSError as error:
                self.failed(error)

    def _record_change(self, what: Mapping[str, Any], now: int) -> None:
        if self.recorder is not None:
            self.recorder.change(now, what)

    # For the nodes

    def _make(self) -> None:
        """Make what is the node's own."""
        raise NotImplementedError

    def _publish(self, step: Step) -> None:
        """Send what came of a step."""
        raise NotImplementedError

    def now(self) -> int:
        """By the node's clock, which may be that of a simulation [ns]."""
        clock = self.get_clock()
        # Without a simulation it is the system's, which Python reads ten times as fast.
        return int(clock.now().nanoseconds) if clock.ros_time_is_active else time.time_ns()

    def publisher(self, kind: type, topic: str, depth: int) -> Any:
        """A publisher as ros2_controllers have them, reliable and volatile; parameters can override it."""
        options = QoSOverridingOptions.with_default_policies()
        return self.fixed_publisher(kind, topic, QoSProfile(depth=depth), qos_overriding_options=options)

    def fixed_publisher(self, kind: type, topic: str, qos: Any, **options: Any) -> Any:
        """A publisher whose qualities no parameter overrides."""
        made = self.create_publisher(kind, topic, qos, **options)
        self._things.append((self.destroy_publisher, made))
        return made

    def serve(self, kind: type, name: str, call: Any) -> None:
        """Answer calls of a service."""
        self._things.append((self.destroy_service, self.create_service(kind, name, call)))

    def subscribe(
        self,
        kind: type,
        topic: str,
        call: Any,
        qos: Any,
        *,
        area: str = "joints",
        alone: bool = False,
        raw: bool = False,
    ) -> None:
        """A subscription: faults of its publishers are of an `area`; `alone` if two of them are a mistake;
        `raw` for bytes."""
        options = QoSOverridingOptions.with_default_policies()
        made = self.create_subscription(kind, topic, call, qos, qos_overriding_options=options, raw=raw)
        self._things.append((self.destroy_subscription, made))
        self._topics.append((made.topic_name, alone, area, _type_name(kind)))

    def take_commands(self) -> None:
        """Subscribe to cmd_vel."""
        from geometry_msgs.msg import Twist, TwistStamped

        kind = TwistStamped if self.options["use_stamped_vel"] else Twist
        qos = QoSProfile(depth=DEPTH)
        self.subscribe(kind, "cmd_vel", self._on_command, qos, area="commands", alone=True)

    def after(self, step: Step | None) -> None:
        """A step goes out, then into the record."""
        if step is None:
            return
        self._publish(step)
        self.halting.publish()
        if self.recorder is not None:
            self.recorder.step(step)

    # Calls

    def _on_command(self, message: Any) -> None:
        is_stamped = self.options["use_stamped_vel"]
        twist = message.twist if is_stamped else message
        stamp = nanoseconds(message.header.stamp) if is_stamped else 0
        now, wanted = self.now(), (twist.linear.x, twist.linear.y, twist.angular.z)
        self.loop.command(wanted, stamp, now)
        if self.recorder is not None:
            self.recorder.wanted(now, stamp, wanted)

    def _on_timer(self) -> None:
        now = self.now()
        if now <= 0:  # a simulation that has not begun
            return
        step = self.loop.tick(now)
        if self.recorder is not None:
            self.recorder.tick(now)
        self.after(step)

    def _on_report(self) -> None:
        self._check_graph()
        from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

        now = self.now()
        for level, text in self._fault_lines.lines(self.loop):
            if level == OK:
                self.get_logger().info(text)
            else:
                self.get_logger().warning(text)
        name = self.get_fully_qualified_name().strip("/")
        told: list[Status] = statuses(self.loop, name)
        message = DiagnosticArray()
        message.header.stamp = Time(nanoseconds=now).to_msg()
        message.status = [
            DiagnosticStatus(
                level=bytes([level]),
                name=title,
                message=text,
                hardware_id=name,
                values=[KeyValue(key=key, value=value) for key, value in said.items()],
            )
            for level, title, text, said in told
        ]
        self._diagnostics.publish(message)
        if self.recorder is not None:
            self.recorder.diagnostics(now, told)
        gc.collect()  # otherwise nobody does: see `running`

    def _check_graph(self) -> None:
        """Report other publishers of the node's topics and publishers of wrong types."""
        faults = self.loop.faults
        for topic, alone, area, kind in self._topics:
            for info in self.get_publishers_info_by_topic(topic):
                if info.topic_type != kind:
                    hint = " (the parameter use_stamped_vel)" if alone else ""
                    got = f"{info.topic_type} from {_who(info)}{hint}"
                    faults.add(area, ERROR, f"{topic} must be {kind}", got)
            if alone:
                rule = f"{topic} must have one publisher, or the latest stamp counts"
                self._check_alone(topic, WARN, rule)
        for publisher in self._commanding():
            topic = publisher.topic_name
            self._check_alone(topic, ERROR, f"{topic} must have this publisher alone")

    def _check_alone(self, topic: str, level: int, rule: str) -> None:
        infos = self.get_publishers_info_by_topic(topic)
        if len(infos) > 1:
            listed = ", ".join(sorted(map(_who, infos)))
            self.loop.faults.add("commands", level, rule, f"{len(infos)}: {listed}")

    def _commanding(self) -> Sequence[Any]:
        """The publishers that nobody else may compete with."""
        return ()

    def _set_parameters(self, parameters: Sequence[Any]) -> Any:
        try:
            changes = self._declared.changes(parameters)
            if changes:
                settings = self.settings.changed(changes)
                now = self.now()
                self.loop.change(settings, now)
                self.settings = settings
                self._record_change({"set": changes}, now)
        except ValueError as error:
            return SetParametersResult(successful=False, reason=one_line(error))
        return SetParametersResult(successful=True)


def _type_name(kind: type) -> str:
    package, folder, *_ = kind.__module__.split(".")
    return f"{package}/{folder}/{kind.__name__}"


def _who(info: Any) -> str:
    return f"{info.node_namespace.rstrip('/')}/{info.node_name}"
