"""Times of `six-wheel node` that its laws bound; `test_laws` asserts them, `figures` prints them."""

import itertools
import math
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from sensor_msgs.msg import JointState

from tests.control_loop.ros2 import flood
from tests.control_loop.ros2.peers import Peer, Process, driving, seconds

Start = Callable[..., Process]
SPEED = 0.4  # [m/s], from which the rover stops


def queued(process: int) -> float:
    """Time that threads of a process were ready to run and had no processor [s]: what others take."""
    threads = Path(f"/proc/{process}/task").glob("*/schedstat")
    return 1e-9 * sum(int(thread.read_text().split()[1]) for thread in threads)


class Started(NamedTuple):
    """Times from the start of a process on [s].

    Attributes
    ----------
    configured : float
        Its topics are there: the record that it was asked for has begun.
    commanded : float
        Its first joint command is there, so that it and the robot have discovered each other.
    queued : float
        What of it the node and this process stood in line for a processor.
    """

    configured: float
    commanded: float
    queued: float


def started(start: Start, peer: Peer, rover: Path, record: Path) -> Started:
    """Start a node beside a robot."""
    peer.commands.clear()
    begin, before = time.monotonic(), queued(os.getpid())
    process = start("node", str(rover), "--ros-args", "-p", f"record:={record}")
    peer.until(record.exists)
    configured = time.monotonic() - begin
    peer.until(lambda: peer.commands)
    commanded = time.monotonic() - begin
    return Started(configured, commanded, queued(process.process.pid) + queued(os.getpid()) - before)


class Fault(NamedTuple):
    """Something that stops the rover.

    Attributes
    ----------
    alter : callable
        The robot's joint states from then on, as `Peer.alter`.
    is_planner : bool
        True if the planner falls silent.
    rule : str
        The rule that is broken, as diagnostics and log have it.
    """

    alter: Callable[[JointState], JointState | None]
    is_planner: bool
    rule: str


def _same(state: JointState) -> JointState:
    return state


def _not_finite(state: JointState) -> JointState:
    state.position[0] = math.nan
    return state


def _without_one(state: JointState) -> JointState:
    state.name, state.position, state.velocity = state.name[:-1], state.position[:-1], state.velocity[:-1]
    return state


FAULTS = {
    "planner silent": Fault(_same, True, "commands must keep coming"),
    "joints silent": Fault(lambda state: None, False, "joint fl_steer must be in the joint states"),
    "a reading that is NaN": Fault(_not_finite, False, "joint fl_steer must have a finite value"),
    "a joint gone": Fault(_without_one, False, "joint rr_wheel must be in the joint states"),
}


class Rest(NamedTuple):
    """Times from the beginning of a fault on [s], by the clock of the node; and for how long of them it
    stood in line for a processor."""

    at_rest: float
    named: float
    queued: float


def rest(peer: Peer, process: Process, fault: Fault) -> Rest:
    """Drive at `SPEED`, have the fault, see the rover at rest and the fault in the diagnostics; it lasts."""
    peer.alter = _same
    driving(peer, (SPEED, 0.0, 0.0))

    def good() -> bool:
        """True after two reports without the fault, which this process has for itself where it is held up."""
        peer.diagnostics.clear()
        peer.until(lambda: len(peer.diagnostics) > 1)
        return not peer.diagnosed(fault.rule)

    peer.until(good)
    for listed in (peer.diagnostics, peer.commands, peer.log):
        listed.clear()
    begin, before = time.time(), queued(process.process.pid)  # the last good message is older
    peer.alter = fault.alter
    if fault.is_planner:
        peer.wanted = None
    peer.until(lambda: not any(peer.wheel_speeds))
    stopped = seconds(peer.commands[-1])
    peer.until(lambda: peer.diagnosed(fault.rule))
    report = next(each for each in peer.diagnostics if any(fault.rule in s.message for s in each.status))
    return Rest(stopped - begin, seconds(report) - begin, queued(process.process.pid) - before)


def longest_gap(peer: Peer, folder: Path, count: int = 60_000) -> tuple[float, float]:
    """Between two joint commands by their stamps [s], while another process sends `count` commands at 10 kHz;
    and the rate at which it did [Hz]. `Peer.commands` are then those of that time."""
    driving(peer, (SPEED, 0.0, 0.0))
    peer.wanted = None  # the other one's are the same
    peer.commands.clear()
    process = Process(str(count), str(SPEED), folder=folder, program=(sys.executable, flood.__file__))
    try:
        peer.until(lambda: process.process.poll() is not None)
    finally:
        process.end()
    stamps = [seconds(each) for each in peer.commands]
    return max(after - before for before, after in itertools.pairwise(stamps)), float(process.said)
