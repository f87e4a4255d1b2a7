"""The end of `six-wheel node`: by signals in any number and order, and the last joint command is zero."""

import signal
import time

import numpy as np
import pytest
from lifecycle_msgs.srv import ChangeState

from tests.control_loop.ros2.peers import BUSY, driving, seconds

SLOW = "limits: {speed: 1.0, acceleration: 0.5, deceleration: 0.02, steering_rate: 1.0"
STOPS = {"halts": f"{SLOW}, halt_deceleration: 1.0}}", "halts slowly": f"{SLOW}}}"}
TWIST = (0.4, 0.0, 0.0)
RADIUS = 0.15  # [m]
LAST = 4.5  # [s] after the first signal at which the last command goes out at the latest


@pytest.fixture
def slow_file(rover_file, request):
    """A rover that takes 20 s to stop from 0.4 m/s within its limits."""
    text = rover_file.read_text()
    first = text.index("limits:")
    rover_file.write_text(text[:first] + STOPS[request.param] + "\n")
    return rover_file


def end(peer, process, *signals):
    """Send signals, each so many seconds after the first; how long after it the last command went out, by its
    stamp [s]."""
    begin, first = time.monotonic(), time.time()
    for number, after in signals:
        peer.spin(begin + after - time.monotonic())
        if process.process.poll() is None:
            process.process.send_signal(number)
    peer.until(lambda: process.process.poll() is not None)
    assert process.process.returncode == 0, process.said
    peer.until(lambda: not any(peer.wheel_speeds))  # the last commands may come after its end
    assert "Traceback" not in process.said
    return seconds(peer.commands[-1]) - first


@pytest.mark.parametrize("slow_file", ["halts"], indirect=True)
@pytest.mark.parametrize(
    "signals",
    [
        [(signal.SIGINT, 0.0), (signal.SIGINT, 0.1)],
        [(signal.SIGTERM, 0.0), (signal.SIGINT, 0.3), (signal.SIGTERM, 0.4)],
        [(signal.SIGINT, 0.02 * k) for k in range(20)],
        [(signal.SIGHUP, 0.0), (signal.SIGTERM, 0.0)],
    ],
    ids=["twice", "mixed", "hammered", "terminal closed"],
)
def test_a_second_signal_halts(start, peer, slow_file, signals):
    process = start("node", str(slow_file))
    driving(peer, TWIST)
    assert end(peer, process, *signals) < signals[1][1] + TWIST[0] / 1.0 + BUSY
    # Down to the last command it is a halt, not a jump: 1 m/s^2 and 1 % for the rounding of stamps.
    assert max(peer.decelerations()) < 1.01 * 1.0 / RADIUS


@pytest.mark.parametrize("slow_file", ["halts"], indirect=True)
def test_a_long_stop_becomes_a_halt(start, peer, slow_file):
    process = start("node", str(slow_file))
    driving(peer, TWIST)
    assert 4.0 < end(peer, process, (signal.SIGINT, 0.0)) < LAST + BUSY
    assert max(peer.decelerations()) < 1.01 * 1.0 / RADIUS


@pytest.mark.parametrize("slow_file", ["halts slowly"], indirect=True)
@pytest.mark.parametrize("silent", [False, True], ids=["measured", "silent joints"])
def test_even_a_halt_that_takes_too_long_ends_in_a_zero(start, peer, slow_file, silent):
    process = start("node", str(slow_file))
    driving(peer, TWIST)
    if silent:
        peer.alter = lambda state: None
    assert LAST <= end(peer, process, (signal.SIGINT, 0.0), (signal.SIGTERM, 0.5)) < LAST + BUSY
    command = peer.commands[-1]
    assert not any(command.velocity[4:])
    np.testing.assert_allclose(command.position[:4], peer.commands[-2].position[:4])


def test_a_transition_to_unconfigured_in_motion_leaves_the_wheels_at_rest(start, peer, rover_file):
    start("node", str(rover_file))
    driving(peer, TWIST)
    change = peer.node.create_client(ChangeState, "/rover_controller/change_state")
    peer.until(change.service_is_ready)
    for number in (4, 2):  # deactivate, and clean up before the rover has stopped
        request = ChangeState.Request()
        request.transition.id = number
        change.call_async(request)
        peer.spin(0.1)
    peer.until_silent()
    assert not any(peer.wheel_speeds)
