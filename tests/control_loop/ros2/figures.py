"""Figures of a node, measured: ``python -m tests.control_loop.ros2.figures`` prints them. They judge nothing.

The time from joint states to joint commands is measured by ``python benches/ros_node.py``.
"""

import os
import statistics
import tempfile
from pathlib import Path

os.environ.setdefault("ROS_DOMAIN_ID", "92")
os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")

import six_wheel as sw
from tests.control_loop.ros2.conftest import ROVER
from tests.control_loop.ros2.measuring import FAULTS, longest_gap, rest, started
from tests.control_loop.ros2.peers import Peer, Process

STARTS = 5


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder, processes = Path(name), []
        rover = folder / "rover.yaml"
        rover.write_text(ROVER)

        def start(*arguments: str) -> Process:
            processes.append(Process(*arguments, folder=folder))
            return processes[-1]

        try:
            with Peer(sw.load(rover)) as peer:
                starts = []
                for number in range(STARTS):
                    starts.append(started(start, peer, rover, folder / f"{number}.mcap"))
                    processes[-1].end()
                    peer.until_silent()
                for k, what in enumerate(("configured", "first command", "of it in line")):
                    times = [each[k] for each in starts]
                    print(f"start, {what:<27} {statistics.median(times):.2f} s, longest {max(times):.2f} s")
                start("node", str(rover))
                for name, fault in FAULTS.items():
                    took = rest(peer, processes[-1], fault)
                    print(f"rest, {name:<28} {took.at_rest:.2f} s, in /diagnostics {took.named:.2f} s")
                peer.alter = lambda state: state
                gap, rate = longest_gap(peer, folder)
                print(
                    f"longest gap between commands       {1e3 * gap:.0f} ms at {rate:.0f} of cmd_vel a second"
                )
        finally:
            for process in processes:
                process.end()


if __name__ == "__main__":
    main()
