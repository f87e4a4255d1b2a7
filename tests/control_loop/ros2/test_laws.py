"""Times that teams can rely on: start, rest after a fault, commands under load.

Each bound is that of a machine with no other work, and `BUSY` on top of it: what a machine whose processors
are all taken may add. Time for which the node was ready and another process had the processor does not count.
"""

import itertools
import math
import time

import numpy as np
import pytest

import six_wheel as sw
from tests.control_loop.ros2.measuring import FAULTS, SPEED, longest_gap, rest, started
from tests.control_loop.ros2.peers import BUSY, Peer, driving

TIMEOUT = 0.5  # [s] of commands and of joint states, by default
DECELERATION = 0.5  # [m/s^2] of the file
REPORT = 1.0  # [s] between reports
START = 3.0  # [s]
REPEATED = 3.0  # [s] after which Fast DDS repeats what another participant did not hear of its discovery


def test_it_is_up_in_three_seconds(start, peer, rover_file, tmp_path):
    took = started(start, peer, rover_file, tmp_path / "run.mcap")
    assert took.configured - took.queued < START
    assert took.commanded - took.queued < START + REPEATED


@pytest.mark.parametrize("order", [*itertools.permutations(("node", "robot", "planner"))], ids="-".join)
def test_in_any_order_it_drives(start, rover_file, order):
    with Peer(sw.load(rover_file), parts=()) as peer:
        peer.wanted = (SPEED, 0.0, 0.0)
        for part in order:
            if part == "node":
                start("node", str(rover_file))
                peer.until(lambda: peer.diagnostics)
            else:
                peer.join(part)
                peer.spin(0.3)
        driving(peer, peer.wanted)


def test_it_tells_what_it_waits_for(start, rover_file):
    """A robot without joint states: each joint is named in diagnostics, and they are one line of the log."""
    with Peer(sw.load(rover_file), parts=("planner",)) as peer:
        process = start("node", str(rover_file))
        peer.until(lambda: peer.diagnosed("joints: joint fl_steer must be in the joint states, got none"))
        assert all(peer.diagnosed(f"joint {name} must be in the joint states") for name in peer.names)
        peer.diagnostics.clear()
        peer.until(lambda: len(peer.diagnostics) > 2)
        assert process.said.count("joint fl_steer must be in the joint states") == 1
        assert "joints: the rover stops, joint states are missing: joint fl_steer must" in process.said
        assert not peer.commands
        peer.join("robot")
        driving(peer, (SPEED, 0.0, 0.0))


@pytest.mark.parametrize("name", FAULTS)
def test_after_a_fault_it_is_at_rest_and_says_so_once(start, peer, rover_file, name):
    fault = FAULTS[name]
    took = rest(peer, start("node", str(rover_file)), fault)
    assert took.at_rest - took.queued < TIMEOUT + SPEED / DECELERATION + 0.1 + BUSY
    assert took.named - took.queued < TIMEOUT + REPORT + BUSY

    def said(over):
        return sum(fault.rule in line and ("over: " in line) is over for line in peer.log)

    peer.diagnostics.clear()
    peer.until(lambda: said(False) and len(peer.diagnostics) > 2)
    assert (said(False), said(True)) == (1, 0)
    peer.alter = lambda state: state
    driving(peer, (SPEED, 0.0, 0.0))
    peer.until(lambda: said(True))
    lines = [line for line in peer.log if fault.rule in line]
    assert ["over: " in line for line in lines[:2]] == [False, True]


def noise(t, random):
    """A yaw rate with 1 % of noise [rad/s]."""
    return 0.3 * (1.0 + 0.01 * random.standard_normal())


def weaving(t, random):
    return 0.3 * math.sin(2.0 * t)


@pytest.mark.parametrize("turning", [noise, weaving])
@pytest.mark.parametrize("rate", [10.0, 100.0, 500.0])
def test_a_planner_gets_the_speed_it_asks_for(start, peer, rover_file, rate, turning):
    """Whatever its rate, against the robot's 200 Hz, and however its commands differ from each other: with
    noise in every command the rover drove at 0.02 m/s of 0.4."""
    start("node", str(rover_file))
    peer.until(lambda: peer.odometry)
    random, begin, sent = np.random.default_rng(1), time.monotonic(), [0]

    def speak(state):
        t = time.monotonic() - begin
        while sent[0] < rate * t:
            peer.want((SPEED, 0.0, turning(t, random)))
            sent[0] += 1
        return state

    peer.alter = speak
    peer.spin(3.0)
    peer.odometry.clear()
    peer.spin(3.0)
    assert np.mean([message.twist.twist.linear.x for message in peer.odometry]) >= 0.9 * SPEED


def test_ten_thousand_commands_a_second_hold_up_none(start, peer, rover_file, tmp_path):
    start("node", str(rover_file))
    gap, _ = longest_gap(peer, tmp_path)
    assert gap < 0.05 + BUSY
    # And it drives by them.
    speeds = np.median([command.velocity[-1] for command in peer.commands])
    assert speeds == pytest.approx(SPEED / peer.rover.wheels[0].radius)
