"""Odometry of the node told where it is, by topic and services; counters of joints that start over."""

import math
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from geometry_msgs.msg import PoseWithCovarianceStamped
from std_srvs.srv import Trigger

from tests.control_loop.ros2.peers import call, driving, seconds

ROOT = Path(__file__).parents[3]


def place(message):
    """x, y and yaw of an Odometry."""
    at, turn = message.pose.pose.position, message.pose.pose.orientation
    return np.array((at.x, at.y, 2.0 * math.atan2(turn.z, turn.w)))


def test_poses_that_are_none_are_said_and_left_out(start, peer, rover_file):
    start("node", str(rover_file))
    poses = peer.node.create_publisher(PoseWithCovarianceStamped, "set_pose", 1)
    peer.until(lambda: peer.odometry and poses.get_subscription_count())
    place, covariance = PoseWithCovarianceStamped(), PoseWithCovarianceStamped()
    for message in (place, covariance):
        message.pose.pose.position.x, message.pose.pose.orientation.w = 5.0, 1.0
    place.pose.pose.position.y = math.inf
    covariance.pose.covariance[0] = math.nan
    for message in (place, covariance):
        peer.diagnostics.clear()
        poses.publish(message)
        peer.until(lambda: peer.diagnosed("odometry: set_pose must be a pose"))
        assert abs(peer.odometry[-1].pose.pose.position.x) < 1.0


def test_poses_are_set_and_reset(start, peer, rover_file):
    start("node", str(rover_file))
    peer.until(lambda: peer.odometry)
    poses = peer.node.create_publisher(PoseWithCovarianceStamped, "set_pose", 1)
    message = PoseWithCovarianceStamped()
    message.pose.pose.position.x, message.pose.pose.orientation.w = 5.0, 1.0
    peer.until(lambda: poses.get_subscription_count())
    poses.publish(message)

    def at() -> float:
        return peer.odometry[-1].pose.pose.position.x

    peer.until(lambda: at() == pytest.approx(5.0, abs=0.01))
    assert call(peer, Trigger, "/rover_controller/reset_odometry", Trigger.Request()).success
    peer.until(lambda: at() == pytest.approx(0.0, abs=0.01))


@pytest.fixture
def set_odometry(tmp_path, monkeypatch):
    """The type of control_msgs; without a wheel of it, one made for the test, which the node imports too."""
    if find_spec("control_msgs") is not None:
        from control_msgs.srv import SetOdometry
    else:
        from tests.control_loop.ros2.set_odometry import SetOdometry

        package = tmp_path / "control_msgs"
        package.mkdir()
        (package / "__init__.py").touch()
        (package / "srv.py").write_text("from tests.control_loop.ros2.set_odometry import SetOdometry\n")
        monkeypatch.setenv("PYTHONPATH", str(ROOT), prepend=":")
    return SetOdometry


def test_odometry_goes_on_from_a_pose_by_the_service_of_ros2_controllers(
    start, peer, rover_file, tmp_path, set_odometry
):
    from six_wheel.control_loop.replay import replay

    process = start("node", str(rover_file), "--ros-args", "-p", "record:=run.mcap")
    driving(peer, (0.4, 0.0, 0.0))

    def ask(**request):
        return call(peer, set_odometry, "/rover_controller/set_odometry", set_odometry.Request(**request))

    answer = ask(x=5.0, y=-2.0, yaw=math.pi / 2)
    assert (answer.success, answer.message) == (True, "odometry goes on from there")
    peer.odometry.clear()
    peer.until(lambda: peer.odometry and place(peer.odometry[-1])[1] > -1.5)
    np.testing.assert_allclose(place(peer.odometry[-1])[[0, 2]], (5.0, math.pi / 2), atol=1e-3)
    # For certain: what is not certain of the pose is that of the way since.
    assert peer.odometry[0].pose.covariance[0] < peer.odometry[-1].pose.covariance[0] < 0.1
    answer = ask(x=5.0, z=0.3)
    assert (answer.success, answer.message) == (
        True,
        "odometry goes on from there; z, roll and pitch are not part of it",
    )
    refused = ask(x=math.nan)
    assert not refused.success
    assert "nan" in refused.message
    peer.odometry.clear()
    peer.until(lambda: peer.odometry)
    assert np.isfinite(place(peer.odometry[0])).all()
    assert call(peer, Trigger, "/rover_controller/reset_odometry", Trigger.Request()).success
    driving(peer, (0.2, 0.0, 0.1))
    assert process.end() == 0
    assert replay(tmp_path / "run.mcap").same_bits


def test_counters_that_start_over_are_named_and_followed(start, peer, rover_file):
    """As those of a microcontroller that resets: odometry was off by all that had been counted, 1.3 m after
    3 s, and nothing said so."""
    truth, before = {}, [0.0]  # way [m] at each stamp, and what was counted before the start over

    def driven(state):
        truth[seconds(state)] = before[0] + 0.15 * state.position[4]
        return state

    def error():
        return place(peer.odometry[-1])[0] - truth[seconds(peer.odometry[-1])]

    peer.alter = driven
    start("node", str(rover_file), "--ros-args", "-p", "publish_rate:=0.0")
    driving(peer, (0.4, 0.0, 0.0))
    peer.until(lambda: min(peer.angles) * 0.15 > 1.0)  # [m]
    peer.odometry.clear()
    peer.until(lambda: peer.odometry)
    was = error()
    before[0] = min(peer.angles) * 0.15
    peer.angles = [0.0] * len(peer.angles)
    peer.until(lambda: peer.diagnosed("RESTARTED: clock or counters restarted, followed"))
    peer.until(lambda: any("RESTARTED: clock or counters restarted" in line for line in peer.log))
    # Nobody counted between the last readings before and the first ones from which it goes on.
    uncounted = 0.4 * max(np.diff([seconds(message) for message in peer.odometry]))
    assert abs(error() - was) < uncounted + 0.05
    assert not peer.diagnosed("motion: halted")
    driving(peer, (0.4, 0.0, 0.0))
