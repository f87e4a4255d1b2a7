"""The node among others: another DDS, a simulation's clock, a subscriber that never reads; the filter."""

import os
import signal
import time
from dataclasses import dataclass

import numpy as np
import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

import six_wheel as sw
from tests.control_loop.ros2.peers import PATIENCE, Peer
from tests.limits import only

ONLY_HERE = """<CycloneDDS><Domain Id="any">
<General><AllowMulticast>false</AllowMulticast>
<Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""
TWIST = (0.5, 0.0, 0.2)


def test_another_implementation_of_dds(start, rover_file, monkeypatch):
    pytest.importorskip("cyclonedds", reason="needs pip install cyclonedds")
    monkeypatch.setenv("CYCLONEDDS_URI", ONLY_HERE)
    from cyclonedds.core import Policy, Qos
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.idl import IdlStruct
    from cyclonedds.idl.types import float64, int32, sequence, uint32
    from cyclonedds.pub import DataWriter
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic

    @dataclass
    class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
        sec: int32
        nanosec: uint32

    @dataclass
    class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
        stamp: Time
        frame_id: str

    @dataclass
    class State(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
        header: Header
        name: sequence[str]
        position: sequence[float64]
        velocity: sequence[float64]
        effort: sequence[float64]

    @dataclass
    class Vector(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
        x: float64
        y: float64
        z: float64

    @dataclass
    class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
        linear: Vector
        angular: Vector

    @dataclass
    class Stamped(IdlStruct, typename="geometry_msgs::msg::dds_::TwistStamped_"):
        header: Header
        twist: Twist

    rover = sw.load(rover_file)
    names = [*rover.steering_joints, *rover.traction_joints]
    participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
    reliable = Qos(Policy.Reliability.Reliable(1_000_000_000), Policy.History.KeepLast(10))
    states = DataWriter(participant, Topic(participant, "rt/joint_states", State, qos=reliable))
    wanted = DataWriter(participant, Topic(participant, "rt/cmd_vel", Stamped, qos=reliable))
    commands = DataReader(participant, Topic(participant, "rt/joint_commands", State, qos=reliable))
    start("node", str(rover_file))
    steering, angles, speeds = [0.0] * 4, np.zeros(6), np.zeros(6)
    end, last, count = time.monotonic() + PATIENCE, time.time_ns(), 0
    _, there = rover.inverse(TWIST)
    while time.monotonic() < end and not np.allclose(speeds, there, atol=1e-9):
        time.sleep(0.005)
        now = time.time_ns()
        angles, last, count = angles + (now - last) * 1e-9 * speeds, now, count + 1
        header = Header(Time(*divmod(now, 1_000_000_000)), "")
        states.write(State(header, names, [*steering, *angles.tolist()], [], []))
        if count % 10 == 0:
            linear, angular = Vector(TWIST[0], 0.0, 0.0), Vector(0.0, 0.0, TWIST[2])
            wanted.write(Stamped(header, Twist(linear, angular)))
        for command in commands.take(N=10):
            if isinstance(command, State):
                steering, speeds = list(command.position[:4]), np.array(command.velocity[4:])
    np.testing.assert_allclose(speeds, there, atol=1e-9)


def test_the_clock_of_a_simulation(start, peer, rover_file):
    """Time is the simulation's: it stands, runs, is set back and jumps ahead."""
    clock = peer.node.create_publisher(Clock, "/clock", 10)
    time_now = [100_000_000_000]
    running = [True]

    def simulated(state: JointState) -> JointState:
        time_now[0] += 5_000_000 if running[0] else 0
        tick = Clock()
        tick.clock.sec, tick.clock.nanosec = divmod(time_now[0], 1_000_000_000)
        clock.publish(tick)
        state.header.stamp = tick.clock
        return state

    peer.alter = simulated
    peer.clock = lambda: time_now[0]
    start("node", str(rover_file), "--ros-args", "-p", "use_sim_time:=true")
    peer.wanted = TWIST
    peer.until(lambda: peer.odometry and peer.odometry[-1].twist.twist.linear.x > 0.4)
    assert peer.odometry[-1].header.stamp.sec < 10_000
    time_now[0] -= 50_000_000_000
    peer.diagnostics.clear()
    peer.until(lambda: peer.diagnosed("time must not run backwards"))
    peer.odometry.clear()
    peer.until(lambda: peer.odometry)
    assert abs(peer.odometry[0].pose.pose.position.x) < 2.0  # it started over, where the simulation did
    time_now[0] += 50_000_000_000
    peer.diagnostics.clear()
    peer.until(lambda: peer.diagnosed("time must not jump"))
    running[0] = False
    peer.until_silent()  # time stands still, and so do the steps
    running[0] = True
    peer.until(lambda: peer.commands)


def test_a_subscriber_that_never_reads_holds_up_nobody(start, peer, rover_file):
    start("node", str(rover_file))
    peer.until(lambda: len(peer.commands) > 10)
    code = (
        "import time, rclpy; from sensor_msgs.msg import JointState; rclpy.init(); "
        "node = rclpy.create_node('sleeper'); "
        "kept = node.create_subscription(JointState, 'joint_commands', print, 10); time.sleep(60)"
    )
    import subprocess
    import sys

    sleeper = subprocess.Popen([sys.executable, "-c", code])
    try:
        peer.until(lambda: peer.node.count_subscribers("joint_commands") > 1)
        peer.spin(0.2)
        sleeper.send_signal(signal.SIGSTOP)  # not even its middleware reads
        before = len(peer.commands)
        peer.until(lambda: len(peer.commands) - before > 400)  # far more than what is kept for anybody
    finally:
        sleeper.kill()
        sleeper.wait(PATIENCE)


def test_two_that_command_the_joints_are_told(start, peer, rover_file):
    start("node", str(rover_file), "--ros-args", "-r", "__node:=one")
    start("node", str(rover_file), "--ros-args", "-r", "__node:=two")
    peer.until(lambda: peer.diagnosed("/joint_commands must have this publisher alone, got 2: /one, /two"))


def test_the_filter_keeps_the_curvature(start, peer, rover_file):
    # A planner that is held up for a while, as on a busy machine, is not to be taken for one that is gone.
    start("filter", str(rover_file), "--ros-args", "-p", "cmd_vel_timeout:=5.0")
    peer.wanted = (2.0, 0.0, 1.0)  # twice as fast as it may be
    ctl = sw.Controller(peer.rover, only(speed=1.0, wheel_speed=8.0))
    ctl.command(peer.wanted, 0.0)
    vx, _, omega = ctl.step(0.0).twist

    def there() -> bool:
        last = peer.limited[-1].twist if peer.limited else None
        return last is not None and np.allclose((last.linear.x, last.angular.z), (vx, omega), rtol=1e-9)

    peer.until(there)
    moving = np.array([(m.twist.linear.x, m.twist.angular.z) for m in peer.limited])
    moving = moving[moving[:, 0] > 1e-6]
    np.testing.assert_allclose(moving[:, 1] / moving[:, 0], 0.5, rtol=1e-9)
    speeds = np.diff(moving[:, 0])
    assert speeds.min() >= 0.0
    peer.wanted = None
    peer.until(lambda: peer.limited[-1].twist.linear.x == 0.0)

    def silent() -> bool:
        peer.limited.clear()
        return not peer.spin(0.5, lambda: peer.limited)

    peer.until(silent)  # at rest: whoever else wants to drive may
    peer.until(lambda: peer.diagnosed("commands must keep coming"))


def test_the_filter_starts_from_the_motion_there_is(start, peer, rover_file):
    from nav_msgs.msg import Odometry

    odom = peer.node.create_publisher(Odometry, "odom", 10)
    start("filter", str(rover_file), "--ros-args", "-p", "feedback:=CLOSED_LOOP")
    peer.until(lambda: odom.get_subscription_count() > 1)
    moving = Odometry()
    moving.twist.twist.linear.x = float("nan")

    def nothing() -> bool:
        odom.publish(moving)
        return peer.diagnosed("odometry: odom must be a motion")

    peer.until(nothing)
    assert not peer.limited
    moving.twist.twist.linear.x = 0.6
    peer.wanted = (0.6, 0.0, 0.0)

    def said() -> bool:
        odom.publish(moving)
        return bool(peer.limited)

    peer.until(said)
    assert 0.5 < peer.limited[0].twist.linear.x <= 0.6


def test_types_that_do_not_fit_are_named(start, peer, rover_file):
    start("node", str(rover_file), "--ros-args", "-p", "use_stamped_vel:=false")
    peer.until(lambda: peer.diagnosed("(the parameter use_stamped_vel)"))


def test_an_unused_peer_closes() -> None:
    with Peer(sw.Rover.preset("perseverance")) as peer:
        assert not peer.spin(0.05, lambda: peer.commands)
