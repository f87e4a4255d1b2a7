"""`six-wheel node` as a process: what it says to robots and planners, and what it makes of what is wrong."""

import math
import signal

import numpy as np
import pytest
from geometry_msgs.msg import Twist
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParameters
from rclpy.parameter import Parameter as Value
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from trajectory_msgs.msg import JointTrajectory

from tests.control_loop.ros2.peers import PATIENCE, TWIST, call, driving


def set_parameter(peer, name, value):
    parameter = Value(name, value=value).to_parameter_msg()
    (result,) = call(
        peer, SetParameters, "/rover_controller/set_parameters", SetParameters.Request(parameters=[parameter])
    ).results
    return result


def hardest(peer, twist=TWIST):
    """Largest deceleration of the fastest wheel at 0.5 m/s² [rad/s²], and 1 % for the rounding of stamps."""
    _, speeds = peer.rover.inverse(twist)
    return 1.01 * 0.5 * max(abs(speeds)) / math.hypot(twist[0], twist[1])


def test_it_drives_and_says_where_it_is(start, peer, rover_file):
    start("node", str(rover_file))
    driving(peer)
    peer.odometry.clear()
    peer.until(lambda: len(peer.odometry) > 5)
    message = peer.odometry[-1]
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_link")
    twist, turn = message.twist.twist, message.pose.pose.orientation
    np.testing.assert_allclose((twist.linear.x, twist.linear.y, twist.angular.z), TWIST, atol=0.02)
    assert math.hypot(turn.z, turn.w) == pytest.approx(1.0)
    pose, motion = (np.reshape(each.covariance, (6, 6)) for each in (message.pose, message.twist))
    for covariance in (pose, motion):
        np.testing.assert_array_equal(covariance, covariance.T)
        assert (np.linalg.eigvalsh(covariance) >= 0.0).all()
        assert covariance[2, 2] == 1e6  # of what wheels say nothing
    assert 0.0 < pose[0, 0] < 1.0
    assert 0.0 < motion[5, 5] < 1.0
    command = peer.commands[-1]
    assert list(command.name) == peer.names
    assert [math.isnan(each) for each in command.position] == [False] * 4 + [True] * 6
    peer.until(lambda: peer.diagnosed("rover_controller: motion: as wanted"))
    peer.wanted = None
    peer.until(lambda: peer.diagnosed("commands must keep coming"))
    peer.until(lambda: not any(peer.wheel_speeds))


def stops_at(peer, alter, word):
    """A rover that drives stops when its joint states are altered, and says this of it."""
    peer.alter = lambda state: state
    driving(peer, (0.2, 0.0, 0.0))
    peer.diagnostics.clear()
    peer.alter = alter
    peer.until(lambda: peer.diagnosed(word), lambda: word)
    peer.until(lambda: not any(peer.wheel_speeds))


def test_faults_of_joint_states_are_said_and_stop_it(start, peer, rover_file):
    start("node", str(rover_file))

    def without(state: JointState) -> JointState:
        state.name, state.position, state.velocity = state.name[:-1], state.position[:-1], state.velocity[:-1]
        return state

    def not_finite(state: JointState) -> JointState:
        state.position[0] = math.nan
        return state

    def repeated(state: JointState) -> JointState:
        state.name = [*state.name, "fl_steer"]
        state.position = [*state.position, 0.0]
        state.velocity = []
        return state

    def renamed(state: JointState) -> JointState:
        state.name = ["front_left_steer" if name == "fl_steer" else name for name in state.name]
        return state

    def nothing(state: JointState) -> None:
        return None

    for alter, word in (
        (without, "joint rr_wheel must be in the joint states"),
        (not_finite, "joint fl_steer must have a finite value, got nan"),
        (repeated, "a joint must be in a message once, got fl_steer twice"),
        (renamed, "is it front_left_steer now?"),
        (nothing, "motion: stopped: joint states are missing"),
    ):
        stops_at(peer, alter, word)

    def shuffled(state: JointState) -> JointState:
        order = np.random.default_rng(state.header.stamp.nanosec).permutation(len(state.name)).tolist()
        position, velocity = list(state.position), list(state.velocity)
        state.name = [state.name[k] for k in order]
        state.position = [position[k] for k in order]
        state.velocity = [velocity[k] for k in order]
        return state

    peer.alter = shuffled
    driving(peer)


def test_faults_of_commands_are_said(start, peer, rover_file):
    start("node", str(rover_file))
    driving(peer)
    peer.wanted = None
    for twist, age, word in (
        ((math.nan, 0.0, 0.0), 0.0, "a command must be finite, got (nan, 0.0, 0.0)"),
        ((0.0, 0.0, math.inf), 0.0, "a command must be finite, got (0.0, 0.0, inf)"),
        (TWIST, 2.0, "a command must not be older than 0.5 s"),
        (TWIST, -5.0, "the stamp of a command must not be ahead of the clock"),
    ):
        peer.diagnostics.clear()
        peer.want(twist, age)
        peer.until(lambda word=word: peer.diagnosed(word), lambda word=word: word)
    other = peer.node.create_publisher(Twist, "cmd_vel_other", 1)
    second = type(peer)(peer.rover)
    try:
        peer.until(lambda: peer.diagnosed("/cmd_vel must have one publisher"))
    finally:
        second.close()
        peer.node.destroy_publisher(other)


def test_without_velocities_a_rover_that_needs_them_stops(start, peer, rover_file):
    start("node", str(rover_file), "--ros-args", "-p", "position_feedback:=false")
    driving(peer)

    def without(state: JointState) -> JointState:
        state.velocity = []
        return state

    def not_finite(state: JointState) -> JointState:
        state.velocity[-1] = math.nan
        return state

    for alter, word in (
        (without, "must have a velocity, got 0 of them"),
        (not_finite, "joint rr_wheel must have a finite value, got nan"),
    ):
        stops_at(peer, alter, word)


def test_killed_in_motion_and_started_again_it_goes_on(start, peer, rover_file):
    first = start("node", str(rover_file))
    driving(peer)
    first.end(signal.SIGKILL)
    peer.spin(0.3)
    before = list(peer.wheel_speeds)
    peer.commands.clear()
    start("node", str(rover_file))
    peer.until(lambda: peer.commands)
    command = peer.commands[0]
    # Measured over a few readings, during which the robot kept its speed; then braking until a command comes.
    np.testing.assert_allclose(command.velocity[4:], before, atol=0.05)
    np.testing.assert_allclose(command.position[:4], peer.steering, atol=0.02)
    peer.until(lambda: len(peer.commands) > 10)
    assert max(map(abs, peer.decelerations())) < hardest(peer)


def test_told_to_end_it_stops_the_rover_first(start, peer, rover_file):
    process = start("node", str(rover_file))
    driving(peer)
    peer.wanted = None
    process.process.send_signal(signal.SIGINT)
    peer.until(lambda: process.process.poll() is not None)
    assert process.process.returncode == 0
    peer.until(lambda: not any(peer.wheel_speeds))  # the last commands may come after its end
    assert 0.0 < max(peer.decelerations()) < hardest(peer)  # no step to zero


@pytest.mark.parametrize("interface", ["group", "trajectory"])
def test_command_interfaces(start, peer, rover_file, interface):
    wheels, steering = [], []
    kept = [
        peer.node.create_subscription(
            Float64MultiArray, "forward_velocity_controller/commands", wheels.append, 10
        ),
        peer.node.create_subscription(
            Float64MultiArray, "forward_position_controller/commands", steering.append, 10
        ),
        peer.node.create_subscription(
            JointTrajectory, "joint_trajectory_controller/joint_trajectory", steering.append, 10
        ),
    ]
    start("node", str(rover_file), "--ros-args", "-p", f"command_interface:={interface}")
    peer.until(lambda: len(wheels) > 2 and len(steering) > 2)
    assert len(wheels[-1].data) == 6
    if interface == "group":
        assert len(steering[-1].data) == 4
    else:
        assert list(steering[-1].joint_names) == peer.names[:4]
        assert len(steering[-1].points[0].positions) == 4
    del kept


def test_parameters(start, peer, rover_file):
    start("node", str(rover_file), "--ros-args", "-p", "limits.speed:=0.3", "-p", "wheel_radius:=0.2")
    request = GetParameters.Request(
        names=["limits.speed", "wheel_radius", "d1", "traction_joints", "limits.jerk"]
    )
    answers = call(peer, GetParameters, "/rover_controller/get_parameters", request).values
    assert [answers[k].double_value for k in (0, 1, 2, 4)] == [0.3, 0.2, 0.4, 0.0]
    assert list(answers[3].string_array_value) == peer.names[4:]
    request = DescribeParameters.Request(names=["limits.speed", "wheel_radius"])
    speed, radius = call(
        peer, DescribeParameters, "/rover_controller/describe_parameters", request
    ).descriptors
    assert (speed.read_only, radius.read_only) == (False, True)
    assert speed.floating_point_range[0].to_value == 1e6
    peer.wanted = (1.0, 0.0, 0.0)
    peer.until(lambda: peer.wheel_speeds and max(peer.wheel_speeds) == pytest.approx(0.3 / 0.2))
    assert set_parameter(peer, "limits.speed", 0.1).successful
    peer.until(lambda: max(peer.wheel_speeds) == pytest.approx(0.1 / 0.2))
    for name, value, word in (
        ("limits.speed", -1.0, "range"),
        ("wheel_radius", 0.3, "read-only"),
        ("open_loop", True, "read-only"),
        ("limits.steering_limit", 9.0, "steering"),
    ):
        result = set_parameter(peer, name, value)
        assert not result.successful
        assert word in result.reason.lower().replace("not fully inside the range", "range"), result.reason


def test_lifecycle(start, peer, rover_file):
    start("node", str(rover_file), "--ros-args", "-p", "autostart:=false")

    def state():
        answer = call(peer, GetState, "/rover_controller/get_state", GetState.Request())
        return answer.current_state.label

    def change(number):
        request = ChangeState.Request()
        request.transition.id = number
        return call(peer, ChangeState, "/rover_controller/change_state", request).success

    assert state() == "unconfigured"
    peer.spin(0.3)
    assert not peer.odometry
    assert change(1)
    peer.until(lambda: peer.odometry)
    assert not peer.commands
    assert change(3)
    driving(peer)
    assert not change(3)  # it is active: refused, and the rover drives on
    peer.diagnostics.clear()
    peer.until(lambda: peer.diagnosed("a request must be one that the node can serve"))
    driving(peer)
    assert change(4)
    peer.until(lambda: not any(peer.wheel_speeds))
    peer.until_silent()
    assert change(2)
    assert state() == "unconfigured"
    assert change(1)
    assert change(3)
    driving(peer)


def test_namespaces_and_remapping(start, peer, rover_file):
    limited = []
    kept = peer.node.create_subscription(JointState, "/mars/joint_commands", limited.append, 10)
    start(
        "node",
        str(rover_file),
        "--ros-args",
        *("-r", "__ns:=/mars", "-r", "__node:=driver", "-r", "joint_states:=/joint_states"),
    )
    peer.until(lambda: limited)
    peer.until(lambda: ("driver", "/mars") in peer.node.get_node_names_and_namespaces())
    del kept


def test_a_record_is_replayed_to_the_bit(start, peer, rover_file, tmp_path):
    from six_wheel.control_loop.replay import compare, replay

    process = start("node", str(rover_file), "--ros-args", "-p", "record:=run.mcap")
    driving(peer)
    peer.until(lambda: len(peer.commands) > 200)
    set_parameter(peer, "limits.speed", 0.2)
    peer.alter = lambda state: None
    peer.spin(0.8)
    peer.alter = lambda state: state
    peer.spin(0.5)
    assert process.end() == 0
    replayed = replay(tmp_path / "run.mcap")
    assert len(replayed.recorded.times) > 100
    assert replayed.same_bits
    changed = compare(replay(tmp_path / "run.mcap", {"limits.acceleration": 0.25}))
    assert not changed.same_bits
    # Speeding up was recorded with twice the acceleration: at no row of it were the wheels as fast as now.
    fastest = np.abs(replayed.recorded.wheel_speeds).max(axis=1)
    speeding_up = np.count_nonzero(np.diff(fastest) > 0.0)
    assert changed.differing >= speeding_up > 0
    # The next one does not write over it.
    refused = start("node", str(rover_file), "--ros-args", "-p", "record:=run.mcap")
    peer.until(lambda: refused.process.poll() is not None)
    assert refused.process.returncode == 2
    assert "record must be a new file" in refused.said
    # Nor into a folder that is not there; the reason was in no log.
    refused = start("node", str(rover_file), "--ros-args", "-p", "record:=nowhere/run.mcap")
    peer.until(lambda: refused.process.poll() is not None)
    assert refused.process.returncode == 2
    rule = "record must be a file that can be written, got nowhere/run.mcap: No such file or directory"
    assert rule in refused.said


def test_a_killed_node_leaves_a_record(start, peer, rover_file, tmp_path):
    from six_wheel.control_loop.replay import replay

    process = start("node", str(rover_file), "--ros-args", "-p", "record:=run.mcap")
    driving(peer)
    peer.until(lambda: (tmp_path / "run.mcap").stat().st_size > 50_000)
    process.end(signal.SIGKILL)
    replayed = replay(tmp_path / "run.mcap")
    assert replayed.same_bits
    assert "cut off" in replayed.warnings[0]


def test_wrong_arguments_are_one_line(start, rover_file, tmp_path):
    for arguments, word in (
        (
            ["node", str(rover_file), "-p", "a:=1"],
            "No such option: -p; arguments of ROS must follow --ros-args",
        ),
        (["node", str(rover_file), "--ros-args", "-p", "nonsense"], "ROS arguments cannot be used"),
        (["node", str(rover_file), "--ros-args", "-p", "limits.speed:=fast"], "limits.speed"),
        (["node", str(rover_file), "--ros-args", "-p", "d1:=-1.0"], "d1 must be finite and positive, got -1"),
        (
            ["node", str(rover_file), "--ros-args", "-p", "command_interface:=can"],
            "command_interface must be one",
        ),
    ):
        process = start(*arguments)
        process.process.wait(PATIENCE)
        assert process.process.returncode == 2, process.said
        lines = [line for line in process.said.splitlines() if line.startswith("six-wheel: ")]
        assert len(lines) == 1, process.said
        assert word in lines[0]
        assert "Traceback" not in process.said
