"""The node with a gyroscope: readings as messages, how it sits, silence; a record of it."""

import math
from types import SimpleNamespace

import pytest
from geometry_msgs.msg import TransformStamped
from rclpy.qos import qos_profile_sensor_data
from rclpy.serialization import serialize_message
from sensor_msgs.msg import Imu

from six_wheel.control_loop import Loop, Settings
from tests.control_loop.ros2.conftest import ROVER

KEYS = "noise: 0.001, period: 0.005, bias: 0.0, bias_noise: 0.0001, bias_walk: 0.0"
TURNING = 0.3  # [rad/s], of which the wheels say nothing
AHEAD = (0.5, 0.0, 0.0)


@pytest.fixture
def rover_file(tmp_path):
    path = tmp_path / "rover.yaml"
    path.write_text(f"{ROVER}    gyroscope: {{{KEYS}}}\n    noise: {{slip: 0.05}}\n")
    return path


def imu(stamp, rates=(0.0, 0.0, TURNING), frame="base_link"):
    message = Imu()
    message.header.stamp, message.header.frame_id = stamp, frame
    turning = message.angular_velocity
    turning.x, turning.y, turning.z = rates
    return message


def speak(peer, topic="imu/data", **fields):
    """A gyroscope beside the joint states, best effort as sensors are."""
    readings = peer.node.create_publisher(Imu, topic, qos_profile_sensor_data)

    def alter(state):
        readings.publish(imu(state.header.stamp, **fields))
        return state

    peer.alter = alter


def turns(peer):
    """True once odometry has had the gyroscope's yaw rate for a while."""
    last = [each.twist.twist.angular.z for each in peer.odometry[-5:]]
    return len(last) == 5 and all(each == pytest.approx(TURNING, rel=0.1) for each in last)


def test_odometry_turns_with_the_gyroscope_and_without_it_by_the_wheels(start, peer, rover_file, tmp_path):
    from six_wheel.control_loop.replay import replay

    process = start(
        "node", str(rover_file), "--ros-args", "-p", "record:=run.mcap", "-p", "publish_rate:=0.0"
    )
    speak(peer)
    peer.wanted = AHEAD
    peer.until(lambda: turns(peer))
    stamp = peer.odometry[-1].header.stamp
    assert stamp.sec > 0
    peer.alter = lambda state: state
    peer.diagnostics.clear()
    peer.until(lambda: peer.diagnosed("a gyroscope must speak in time: odometry goes by the wheels alone"))
    peer.odometry.clear()
    peer.until(lambda: len(peer.odometry) > 20 and abs(peer.odometry[-1].twist.twist.angular.z) < 1e-6)
    speak(peer)  # and again
    peer.until(lambda: turns(peer))
    assert process.end() == 0
    replayed = replay(tmp_path / "run.mcap")
    assert len(replayed.recorded.stamps) > 20  # as many as came while it was silent
    assert replayed.same_bits


def test_another_topic_and_a_sensor_that_hangs(start, peer, rover_file):
    """On its side: its y is down. The file tells how it sits, so no transform is asked for."""
    text = rover_file.read_text().replace(KEYS, f"{KEYS}, roll: {-math.pi / 2}, topic: /mast/imu")
    rover_file.write_text(text)
    start("node", str(rover_file))
    speak(peer, "/mast/imu", rates=(5.0, -TURNING, 5.0), frame="mast")
    peer.wanted = AHEAD
    peer.until(lambda: turns(peer))
    assert not peer.diagnosed("a transform must tell")


def test_what_is_not_known_of_how_it_sits_is_said(start, peer, rover_file):
    start("node", str(rover_file), "--ros-args", "-r", "imu/data:=mast/imu")
    speak(peer, "mast/imu", frame="mast")
    peer.wanted = AHEAD
    peer.until(
        lambda: peer.diagnosed("a transform must tell how a gyroscope sits: its z is taken for the rover's")
    )
    peer.until(lambda: turns(peer))


def test_transforms_that_stay_tell_how_it_sits():
    """Whenever they come; without a rover's frame at their end they tell nothing."""
    from six_wheel.control_loop.ros2.imu import ImuInput

    settings = Settings.of_text(
        f"kind: differential\ntrack_width: 0.5\nwheel_radius: 0.1\ngyroscope: {{{KEYS}}}\n"
    )
    loop, said, heard = Loop(settings), [], {}
    node = SimpleNamespace(
        settings=settings,
        loop=loop,
        subscribe=lambda kind, topic, call, qos, **how: heard.update({topic: call}),
    )
    source = ImuInput(
        node, lambda message, rates, stamp: said.append((rates, stamp)), lambda up: said.append(up)
    )
    message = serialize_message(imu(Imu().header.stamp, (1.0, 2.0, 3.0), "/sensor"))
    heard["imu/data"](message)
    assert said == [[0.0, 0.0, 1.0], ((1.0, 2.0, 3.0), 0)]
    links = []
    for child, parent, turn in (
        ("sensor", "mast", (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))),
        ("mast", "base_link", (0.0, 0.0, 1.0, 0.0)),
    ):
        link = TransformStamped()
        link.child_frame_id, link.header.frame_id, q = child, parent, link.transform.rotation
        q.x, q.y, q.z, q.w = turn
        links.append(link)
    source.link(links[:1])
    heard["imu/data"](message)
    source.link(links[1:])
    heard["imu/data"](message)
    heard["imu/data"](message)
    ups = [each for each in said if isinstance(each, list)]
    assert ups[-1] == pytest.approx([0.0, 1.0, 0.0])
    assert len(ups) == 3  # looked up again when a transform came, and no more when it is known
    none = imu(Imu().header.stamp)
    none.angular_velocity_covariance[0] = -1.0
    before = len(said)
    heard["imu/data"](serialize_message(none))
    heard["imu/data"](message[:40])
    assert len(said) == before
    told = " ".join(map(str, loop.faults.of("odometry")))
    assert "an Imu must have angular velocities" in told
    assert "a gyroscope must be readable" in told
