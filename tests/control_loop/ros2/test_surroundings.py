"""The node among others: another DDS, a simulation's clock, a subscriber that never reads; the filter."""

import signal
import time

import numpy as np
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

import six_wheel as sw
from tests.control_loop.ros2.peers import BUSY, PATIENCE, TWIST, Peer, driving, seconds
from tests.limits import only

SOON = 2.0  # [s] after which it drives again


def test_another_implementation_of_dds(start, cyclone, rover_file):
    rover = sw.load(rover_file)
    names = [*rover.steering_joints, *rover.traction_joints]
    participant = cyclone.Participant()
    states = participant.writer("joint_states", cyclone.JointState)
    wanted = participant.writer("cmd_vel", cyclone.TwistStamped)
    commands = participant.reader("joint_commands", cyclone.JointState)
    start("node", str(rover_file))
    steering, angles, speeds = [0.0] * 4, np.zeros(6), np.zeros(6)
    end, last, count = time.monotonic() + PATIENCE, time.time_ns(), 0
    _, there = rover.inverse(TWIST)
    twist = cyclone.Twist(cyclone.Vector3(TWIST[0], 0.0, 0.0), cyclone.Vector3(0.0, 0.0, TWIST[2]))
    while time.monotonic() < end and not np.allclose(speeds, there, atol=1e-9):
        time.sleep(0.005)
        now = time.time_ns()
        angles, last, count = angles + (now - last) * 1e-9 * speeds, now, count + 1
        header = cyclone.Header(cyclone.Time(*divmod(now, 1_000_000_000)), "")
        states.write(cyclone.JointState(header, names, [*steering, *angles.tolist()], [], []))
        if count % 10 == 0:
            wanted.write(cyclone.TwistStamped(header, twist))
        for command in commands.take(N=10):
            if isinstance(command, cyclone.JointState):
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

    def drives_soon():
        begin = time.monotonic()
        peer.commands.clear()
        peer.until(lambda: peer.commands and any(peer.wheel_speeds))
        assert time.monotonic() - begin < SOON + BUSY

    peer.wanted = TWIST
    start("node", str(rover_file), "--ros-args", "-p", "use_sim_time:=true")
    peer.until(lambda: peer.diagnostics)
    peer.spin(1.0)
    assert not peer.commands  # without a clock
    peer.alter = simulated
    peer.clock = lambda: time_now[0]
    peer.until(lambda: peer.odometry and peer.odometry[-1].twist.twist.linear.x > 0.4)
    assert peer.odometry[-1].header.stamp.sec < 10_000
    time_now[0] -= 50_000_000_000
    peer.diagnostics.clear()
    drives_soon()
    peer.until(lambda: peer.diagnosed("time must not run backwards"))
    peer.odometry.clear()
    peer.until(lambda: peer.odometry)
    assert abs(peer.odometry[0].pose.pose.position.x) < 2.0  # it started over, where the simulation did
    time_now[0] += 50_000_000_000
    peer.diagnostics.clear()
    drives_soon()
    peer.until(lambda: peer.diagnosed("time must not jump"))
    driving(peer)
    running[0] = False
    peer.spin(1.0)
    before, stamps = peer.commands[-1], [seconds(each) for each in peer.commands]
    assert stamps.count(stamps[-1]) == 1
    peer.until_silent()  # time stands still, and so do the steps
    running[0] = True
    peer.until(lambda: peer.commands)
    np.testing.assert_allclose(peer.commands[0].velocity, before.velocity, atol=1e-9)  # and no step after


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
