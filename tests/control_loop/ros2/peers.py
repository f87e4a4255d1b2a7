"""The other side of the nodes under test: a robot, a planner and an operator in this process."""

import itertools
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Log
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import JointState

import six_wheel as sw

# [s] for what has to come: milliseconds, and on a machine that is very busy as long as it likes
PATIENCE = 60.0
PERIOD = 0.005  # [s] of the robot's joint states
BUSY = 0.6  # [s] that a machine whose processors are all taken may add
TWIST = (0.5, 0.0, 0.2)


def seconds(message: Any) -> float:
    """The stamp of a message [s]."""
    return float(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)


class Process:
    """`six-wheel`, or another program, in a process of its own, ended by its id."""

    def __init__(
        self, *arguments: str, folder: Path, program: Sequence[str] = (sys.executable, "-m", "six_wheel")
    ) -> None:
        command = [*program, *arguments]
        self._log = folder / f"process_{time.monotonic_ns()}.txt"
        with self._log.open("w") as log:
            self.process = subprocess.Popen(command, cwd=folder, stdout=log, stderr=subprocess.STDOUT)

    def end(self, how: signal.Signals = signal.SIGINT) -> int:
        """Tell it to end, and wait."""
        if self.process.poll() is None:
            self.process.send_signal(how)
            try:
                self.process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait(PATIENCE)
        return self.process.returncode

    @property
    def said(self) -> str:
        """Lines it printed."""
        return self._log.read_text()


class Peer:
    """A node in this process with everything that a node under test talks to.

    Its robot follows joint commands at once and reports positions every `PERIOD` while it spins. `parts` are
    those that are in the graph from the beginning, of "robot" and "planner"; see `join`.
    """

    def __init__(self, rover: sw.Rover, parts: Sequence[str] = ("robot", "planner")) -> None:
        self.rover = rover
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.node = rclpy.create_node("peer", context=self.context)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self.names = [*rover.steering_joints, *rover.traction_joints]
        self.steering = [0.0] * len(rover.steering_joints)
        self.angles = [0.0] * len(rover.traction_joints)
        self.wheel_speeds = [0.0] * len(rover.traction_joints)
        self.clients: dict[str, Any] = {}  # of services, by name
        self.commands: list[Any] = []
        self.odometry: list[Odometry] = []
        self.diagnostics: list[DiagnosticArray] = []
        self.limited: list[Any] = []
        self.log: list[str] = []  # lines that nodes logged
        self.wanted: tuple[float, float, float] | None = None
        self.clock: Callable[[], int] = time.time_ns
        self.alter: Callable[[JointState], JointState | None] = lambda state: state
        self._states = self._wanted = None
        self.join(*parts)
        subscribe = self.node.create_subscription
        self._kept = [
            subscribe(JointState, "joint_commands", self._on_commands, 10),
            subscribe(Odometry, "odom", self.odometry.append, 10),
            subscribe(DiagnosticArray, "/diagnostics", self.diagnostics.append, 10),
            subscribe(TwistStamped, "cmd_vel_out", self.limited.append, 10),
            subscribe(Log, "/rosout", lambda line: self.log.append(line.msg), 100),
        ]
        self._next = time.monotonic()
        self._stamp = time.time_ns()
        self._count = 0

    def join(self, *parts: str) -> None:
        """Enter the graph as the robot, with its joint states, or as the planner, with its commands."""
        if "robot" in parts:
            self._states = self.node.create_publisher(JointState, "joint_states", 10)
        if "planner" in parts:
            self._wanted = self.node.create_publisher(TwistStamped, "cmd_vel", 10)

    def close(self) -> None:
        """Leave the graph."""
        self._executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()

    def __enter__(self) -> "Peer":
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _on_commands(self, message: JointState) -> None:
        self.commands.append(message)
        steered = len(self.steering)
        self.steering = list(message.position[:steered])
        self.wheel_speeds = list(message.velocity[steered:])

    def state(self) -> JointState:
        """Joint states of the robot at this moment."""
        state = JointState(name=self.names)
        state.header.stamp.sec, state.header.stamp.nanosec = divmod(self._stamp, 1_000_000_000)
        state.position = [*self.steering, *self.angles]
        state.velocity = [*[0.0] * len(self.steering), *self.wheel_speeds]
        return state

    def spin(self, duration: float, until: Callable[[], object] | None = None) -> bool:
        """Live for a while, or until something is so; whether it is."""
        end = time.monotonic() + duration
        while time.monotonic() < end:
            if until is not None and until():
                return True
            now = time.monotonic()
            if now >= self._next:
                # After a pause of this process the robot goes on from where it was.
                self._next = max(self._next, now - 5 * PERIOD) + PERIOD
                stamp = time.time_ns()
                step, self._stamp = (stamp - self._stamp) * 1e-9, stamp
                self.angles = [a + step * w for a, w in zip(self.angles, self.wheel_speeds, strict=True)]
                if self._states is not None and (state := self.alter(self.state())) is not None:
                    self._states.publish(state)
                self._count += 1
                if self.wanted is not None and self._count % 10 == 0:
                    self.want(self.wanted)
            self._executor.spin_once(timeout_sec=max(0.0, min(self._next - time.monotonic(), PERIOD)))
        return until is not None and bool(until())

    def want(self, twist: Sequence[float], age: float = 0.0) -> None:
        """Send a command, given some time ago [s], as far as there is a planner."""
        if self._wanted is None:
            return
        message = TwistStamped()
        given = self.clock() - round(age * 1e9)
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(given, 1_000_000_000)
        message.twist.linear.x, message.twist.linear.y, message.twist.angular.z = map(float, twist)
        self._wanted.publish(message)

    def until(self, what: Callable[[], object], hint: Callable[[], str] = lambda: "") -> None:
        """Live until something is so, or fail."""
        assert self.spin(PATIENCE, what), hint()

    def until_silent(self) -> None:
        """Live until no joint commands come any more: what is under way, or late, may still arrive."""

        def silent() -> bool:
            self.commands.clear()
            self.spin(0.5)
            return not self.commands

        self.until(silent)

    def decelerations(self) -> list[float]:
        """Deceleration of the fastest wheel of the commands, by their own stamps [rad/s^2]."""
        times = [seconds(each) for each in self.commands]
        fastest = [max(map(abs, each.velocity[len(self.steering) :])) for each in self.commands]
        rows = list(zip(times, fastest, strict=True))
        return [
            (before - after) / (then - now)
            for (now, before), (then, after) in itertools.pairwise(rows)
            if then > now
        ]

    def last_report(self) -> str:
        """The last lines of the node, one each."""
        statuses = self.diagnostics[-1].status if self.diagnostics else ()
        return "\n".join(f"{status.name}: {status.message}" for status in statuses)

    def diagnosed(self, text: str) -> bool:
        """True where a report has said this since the list was cleared."""
        return any(
            text in f"{status.name}: {status.message}"
            for report in self.diagnostics
            for status in report.status
        )


def call(peer: "Peer", kind: Any, name: str, request: Any) -> Any:
    """The answer of a service."""
    if name not in peer.clients:
        client = peer.clients[name] = peer.node.create_client(kind, name)
        peer.until(client.service_is_ready)
        # Ready is who can be asked. That answers find their way back is settled later, and one that came too
        # early is lost: what asks for nothing is asked until it is answered.
        peer.until(lambda: peer.spin(1.0, client.call_async(kind.Request()).done))
    future = peer.clients[name].call_async(request)
    peer.until(future.done)
    return future.result()


def driving(peer: "Peer", twist: Sequence[float] = TWIST) -> None:
    """Drive until that is what the robot does."""
    peer.wanted = (twist[0], twist[1], twist[2])
    _, speeds = peer.rover.inverse(twist)
    wheels = list(peer.rover.wheel_names)
    wanted = speeds[[wheels.index(wheel) for wheel in peer.rover.traction_joints.values()]]
    peer.until(lambda: peer.commands and np.allclose(peer.wheel_speeds, wanted, atol=1e-9), peer.last_report)
