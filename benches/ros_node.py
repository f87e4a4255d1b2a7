"""Cost of the node: from joint states to joint commands, and its memory over time. Needs rclpy.

    python benches/ros_node.py [--seconds 60] [--rate 200] [--record run.mcap]

A peer in this process publishes joint states at a steady rate and takes the commands; the node is a process
of its own. Of every joint state the time of its stamp, taken just before it is published, is known; of every
command the time in its header, when the node's callback began, and that at which the middleware of the node
sent it.
"""

import argparse
import contextlib
import gc
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

os.environ.setdefault("ROS_DOMAIN_ID", "91")
os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")

import numpy as np
import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import JointState

import six_wheel as sw
from six_wheel.logs.mcap import frames

ROVER = (
    "preset: perseverance\nlimits: {speed: 0.5, acceleration: 0.3, steering_rate: 1.0, wheel_speed: 4.0}\n"
)
PAGE = os.sysconf("SC_PAGE_SIZE")


def nanoseconds(stamp: Any) -> int:
    return stamp.sec * 10**9 + stamp.nanosec


def resident(process: int) -> float:
    """Memory of a process [MB]."""
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * PAGE / 1e6


def processor_time(process: int) -> float:
    """Of a process so far [s]."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Peer:
    """A robot that follows at once."""

    def __init__(self, rate: float) -> None:
        rclpy.init()
        self.node = rclpy.create_node("bench")
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        rover = sw.Rover.preset("perseverance")
        self._steered = len(rover.steering_joints)
        self._state = frames.joint_state([*rover.steering_joints, *rover.traction_joints], 10, 10)
        self._positions = np.zeros(10)
        self._speeds = np.zeros(len(rover.traction_joints))
        self._states = self.node.create_publisher(JointState, "joint_states", 10)
        self._wanted = self.node.create_publisher(TwistStamped, "cmd_vel", 10)
        self._kept = self.node.create_subscription(JointState, "joint_commands", self._on_command, 50)
        self._period = 1.0 / rate
        self.sent: list[int] = []
        self.times: list[tuple[int, int, int]] = []

    def _on_command(self, message: JointState, info: dict[str, int]) -> None:
        self.times.append((self.sent[-1], nanoseconds(message.header.stamp), info["source_timestamp"]))
        self._positions[: self._steered] = message.position[: self._steered]
        self._speeds[:] = message.velocity[self._steered :]

    def run(self, seconds: float) -> None:
        start = due = time.monotonic()
        count = 0
        while (now := time.monotonic()) < start + seconds:
            if now < due:
                self._executor.spin_once(timeout_sec=due - now)
                continue
            due = max(due + self._period, now - self._period)
            self._positions[self._steered :] += self._period * self._speeds
            numbers = self._positions.tolist()
            if count % 10 == 0:
                wanted = TwistStamped()
                wanted.header.stamp = self.node.get_clock().now().to_msg()
                wanted.twist.linear.x, wanted.twist.angular.z = 0.3, 0.2 * np.sin(0.3 * (now - start))
                self._wanted.publish(wanted)
            count += 1
            stamp = time.time_ns()
            self.sent = [stamp]
            self._states.publish(self._state.pack(stamp, numbers, numbers))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rate", type=float, default=200.0)
    parser.add_argument("--record", default="")
    parser.add_argument("--every", type=float, default=600.0, help="seconds between looks at the memory")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rover = Path(folder) / "rover.yaml"
        rover.write_text(ROVER)
        command = [sys.executable, "-m", "six_wheel", "node", str(rover)]
        if arguments.record:
            command += ["--ros-args", "-p", f"record:={Path(arguments.record).resolve()}"]
        process = subprocess.Popen(command, cwd=folder, stderr=subprocess.DEVNULL)
        try:
            measure(process.pid, arguments)
        finally:
            process.send_signal(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(10.0)
            process.kill()


def measure(process: int, arguments: argparse.Namespace) -> None:
    peer = Peer(arguments.rate)
    peer.run(5.0)
    gc.freeze()
    peer.times.clear()
    print(
        "| after | memory [MB] | processor | commands | p50 [us] | p99 [us] | p99.9 [us] | inside p50 | p99 |"
    )
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    before, begin, left = processor_time(process), time.monotonic(), arguments.seconds
    while left > 0.0:
        peer.run(min(left, arguments.every))
        left = arguments.seconds - (time.monotonic() - begin)
        spent = (processor_time(process) - before) / (time.monotonic() - begin)
        sent, begun, out = np.array(peer.times).T
        whole, inside = (np.percentile((out - since) / 1e3, [50, 99, 99.9]) for since in (sent, begun))
        figures = " | ".join(f"{value:.0f}" for value in (*whole, *inside[:2]))
        elapsed = time.monotonic() - begin
        print(
            f"| {elapsed:.0f} s | {resident(process):.2f} | {spent:.1%} | {len(out)} | {figures} |",
            flush=True,
        )
        peer.times.clear()


if __name__ == "__main__":
    main()
