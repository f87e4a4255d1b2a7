"""Halt, release and a joint that does not follow: what the node does, says and records."""

import itertools
import signal

import numpy as np
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

from tests.control_loop.ros2.peers import driving

HALTS = 2.0  # [m/s^2]
RADIUS = 0.15  # [m]


@pytest.fixture
def rover_file(rover_file):
    text = rover_file.read_text()
    rover_file.write_text(
        text.replace("steering_rate: 1.0}", f"steering_rate: 1.0, halt_deceleration: {HALTS}}}")
    )
    return rover_file


def trigger(peer, name):
    """The answer of a service that was there all along."""
    client = peer.clients.setdefault(name, peer.node.create_client(Trigger, f"/rover_controller/{name}"))
    peer.until(client.service_is_ready)
    peer.spin(0.5)  # ready is who can be asked; that answers find their way back is settled a little later
    future = client.call_async(Trigger.Request())
    peer.until(future.done)
    return future.result()


def speeds(replayed):
    return np.abs(replayed.recorded.wheel_speeds).max(axis=1)


def test_halt_and_release_by_service(start, peer, rover_file, tmp_path):
    from six_wheel.control_loop.replay import replay

    halted = []
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    process = start("node", str(rover_file), "--ros-args", "-p", "record:=run.mcap")
    driving(peer)
    kept = peer.node.create_subscription(
        Bool, "/rover_controller/halted", lambda m: halted.append(m.data), latched
    )
    peer.until(lambda: halted == [False])
    peer.commands.clear()
    answer = trigger(peer, "halt")
    assert answer.success
    peer.until(lambda: not any(peer.wheel_speeds))
    assert 0.5 / RADIUS < max(peer.decelerations()) < 1.01 * HALTS / RADIUS
    assert halted[-1]
    peer.diagnostics.clear()
    peer.until(lambda: peer.diagnosed("motion: halted; ~/release ends it"))
    assert not any(peer.wheel_speeds)  # though commands kept coming
    assert trigger(peer, "release").success
    driving(peer)
    assert halted[-1] is False
    assert process.end(signal.SIGTERM) == 0
    replayed = replay(tmp_path / "run.mcap")
    assert replayed.same_bits
    reasons = [names.split("|") for names in replayed.recorded.reasons]
    stretches = [on for on, _ in itertools.groupby(reasons, lambda names: "HALTED" in names)]
    assert stretches == [False, True, False, True]  # the last one is the last command
    assert not speeds(replayed)[-1]
    del kept


def test_a_topic_halts_and_does_not_release(start, peer, rover_file):
    start("node", str(rover_file))
    driving(peer)
    key = peer.node.create_publisher(Bool, "/rover_controller/halt", 1)
    peer.until(key.get_subscription_count)
    key.publish(Bool(data=False))
    peer.spin(0.3)
    assert any(peer.wheel_speeds)
    key.publish(Bool(data=True))
    peer.until(lambda: not any(peer.wheel_speeds))
    key.publish(Bool(data=False))
    peer.spin(1.0)
    assert not any(peer.wheel_speeds)


def test_a_joint_that_sticks_halts_and_is_named(start, peer, rover_file, tmp_path):
    from six_wheel.control_loop.replay import replay

    process = start("node", str(rover_file), "--ros-args", "-p", "record:=run.mcap")
    driving(peer)
    held = peer.steering[0]

    def stuck(state):
        state.position[0] = held
        return state

    peer.alter = stuck
    peer.wanted = (0.5, 0.0, -0.4)
    peer.until(lambda: peer.diagnosed("motion: halted: joint fl_steer does not follow"))
    status = next(
        status
        for report in peer.diagnostics
        for status in report.status
        if "fl_steer does not follow" in status.message
    )
    values = {each.key: each.value for each in status.values}
    assert status.level == b"\x02"
    assert values["stuck joint"] == "fl_steer"
    assert abs(float(values["error of the stuck joint [rad]"])) >= 0.2
    peer.until(lambda: not any(peer.wheel_speeds))
    peer.alter = lambda state: state
    peer.until(lambda: trigger(peer, "release").success)
    driving(peer)
    assert process.end() == 0
    replayed = replay(tmp_path / "run.mcap")
    assert replayed.same_bits
    assert any("JOINT_STUCK" in names for names in replayed.recorded.reasons)
