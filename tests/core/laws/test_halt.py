"""Halts, joints that do not follow, resets, pauses and limits that change, through Python.

Random rovers and streams are in the Rust tests of the controller.
"""

import math

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.kinematics.controller import Reason

OSR = sw.Rover.preset("open_source_rover")
LIMITS = sw.Limits(speed=1.0, acceleration=0.5, steering_rate=1.0, halt_deceleration=2.0)
DT = 0.01


class Robot:
    """Joints that follow their commands, late and with noise; one may be stuck."""

    def __init__(self, *, lag: float = 0.0, noise: float = 0.0, **options):
        self.controller = sw.Controller(OSR, LIMITS, timeout=None, **options)
        self.lag, self.noise, self.stuck = lag, noise, None
        self.history = [np.zeros(4)]
        self.random = np.random.default_rng(0)
        self.now = 0.0

    def measured(self) -> np.ndarray:
        angles = self.history[max(0, len(self.history) - 1 - round(self.lag / DT))].copy()
        if self.stuck is not None:
            angles[self.stuck[0]] = self.stuck[1]
        return angles + self.noise * self.random.standard_normal(4)

    def step(self, twist=(0.5, 0.0, 0.5)) -> sw.ControllerOutput:
        if not self.controller.halted:
            self.controller.command(twist, self.now)
        out = self.controller.step(self.now, self.measured())
        self.history.append(out.steering)
        self.now += DT
        return out


@pytest.mark.parametrize("align", ["cosine", "hold", None])
def test_a_stuck_joint_is_named_in_time_and_not_pressed_against(align):
    """A joint stuck at 0 was driven against for ever, and nothing named it."""
    robot = Robot(align=align)
    robot.stuck = (1, 0.0)
    beyond = told = None
    for _ in range(400):
        out = robot.step()
        if beyond is None and abs(out.joint_errors[1]) > 0.2:
            beyond = robot.now
        if out.reasons & Reason.JOINT_STUCK and told is None:
            told = robot.now
            assert out.worst_joint == list(OSR.steering_joints)[1]
            assert out.worst_joint in out.commands
    assert told - beyond == pytest.approx(0.5, abs=3 * DT)
    assert out.reasons == Reason.HALTED | Reason.JOINT_STUCK
    assert robot.controller.halted
    assert robot.controller.stopped
    assert out.steering[1] == 0.0
    assert not np.any(out.wheel_speeds)


def test_a_joint_that_frees_itself_in_time_is_not_stuck():
    robot = Robot()
    for k in range(600):
        robot.stuck = (1, 0.0) if k % 60 < 40 else None  # free again for 0.2 s each time
        assert not robot.step().reasons & Reason.JOINT_STUCK


def test_a_release_tries_again():
    robot = Robot()
    robot.stuck = (1, 0.0)
    for _ in range(300):
        out = robot.step()
    assert out.reasons & Reason.JOINT_STUCK
    robot.stuck = None
    assert robot.controller.release() is True
    assert not robot.controller.halted
    for _ in range(600):
        out = robot.step()
        assert not out.reasons & Reason.JOINT_STUCK
    np.testing.assert_allclose(out.twist, (0.5, 0.0, 0.5), rtol=0, atol=1e-9)


def test_joints_that_lag_and_are_read_with_noise_are_not_stuck():
    robot = Robot(lag=0.05, noise=0.002)
    for k in range(3000):
        out = robot.step((0.5, 0.0, 0.5 * math.sin(0.01 * k)))
        assert not out.reasons & (Reason.JOINT_STUCK | Reason.HALTED)


@pytest.mark.parametrize("option", ["following_error", "following_time"])
def test_none_is_never(option):
    robot = Robot(**{option: None})
    robot.stuck = (1, 0.0)
    for _ in range(400):
        assert not robot.step().reasons & Reason.JOINT_STUCK


def test_an_endless_joint_that_jumps_by_a_whole_turn_follows():
    modules = [[0.3, 0.25], [0.3, -0.25], [-0.3, 0.25], [-0.3, -0.25]]
    swerve = sw.Rover.swerve(modules, wheel_radius=0.05, steering_limit=math.inf)
    controller = sw.Controller(swerve, sw.Limits(acceleration=0.5, steering_rate=2.0), timeout=None)
    measured = np.zeros(4)
    for k in range(300):
        controller.command((0.3, 0.2, 0.0), k * DT)
        out = controller.step(k * DT, measured)
        measured = out.steering + (2 * math.pi if k % 2 else 0.0)
        assert not out.reasons & Reason.JOINT_STUCK
    assert np.max(np.abs(out.joint_errors)) < 1e-9


def test_without_measured_joints_there_are_no_errors():
    controller = sw.Controller(OSR, LIMITS)
    out = controller.step(0.0)
    assert out.joint_errors is None
    assert out.worst_joint is None


@pytest.mark.parametrize("steps", [0, 5, 60, 120, 300])
def test_a_halt_in_every_phase(steps):
    """Before the first step, while the joints align, while it speeds up, and in a turn."""
    robot = Robot()
    twist = (0.5, 0.0, 0.5)
    for k in range(steps):
        twist = (0.5, 0.0, 0.5) if k < 200 else (0.5, 0.0, 0.1)
        robot.step(twist)
    robot.controller.halt()
    robot.controller.halt()
    assert robot.controller.command((0.5, 0.0, 0.0), robot.now) is False
    radius = OSR.wheels[0].radius
    before = np.abs(robot.step().wheel_speeds).max() * radius
    count = math.ceil(before / (2.0 * DT)) + 2
    for _ in range(count):
        out = robot.step()
        assert out.reasons & Reason.HALTED
    assert not np.any(out.twist)
    while not robot.controller.release():
        robot.step()
    rest = robot.controller.steering
    for _ in range(20):
        out = robot.controller.step(robot.now)
        robot.now += DT
        assert not out.reasons
        np.testing.assert_array_equal(out.steering, rest)
    assert not np.any(out.wheel_speeds)


@pytest.mark.parametrize("steps", range(1, 60, 4))
@pytest.mark.parametrize("hard", [0.5, 2.0])
def test_a_halt_in_a_turn_keeps_the_centre(steps, hard):
    """Joints without a limit of acceleration turned on, as jerk let the body: rest came up to 73 ms late."""
    lengths = {"front_to_middle": 0.5, "middle_to_rear": 0.5, "track_width": 0.8, "middle_track_width": 0.9}
    rover = sw.Rover.six_wheel(**lengths, wheel_radius=0.15)
    limits = sw.Limits(speed=1.0, acceleration=0.5, jerk=2.0, wheel_speed=20.0, steering_rate=1.0)
    controller = sw.Controller(rover, limits.replace(halt_deceleration=hard), timeout=None)
    controller.run([(0.5, 0.0, 0.1)], [0.0], np.arange(0.0, 4.0, DT))
    controller.command((0.5, 0.0, 0.3), 4.0)
    for k in range(steps):
        before = controller.step(4.0 + k * DT)
    controller.halt()
    radius = rover.wheels[0].radius
    count = math.ceil(np.abs(before.wheel_speeds).max() * radius / (hard * DT)) + 2
    for k in range(steps, steps + count):
        out = controller.step(4.0 + k * DT)
        np.testing.assert_array_equal(out.steering, before.steering)
    assert not np.any(out.twist)


def test_a_release_in_motion_is_refused():
    robot = Robot()
    for _ in range(300):
        robot.step()
    robot.controller.halt()
    robot.step()
    assert robot.controller.release() is False
    assert robot.controller.halted


def test_an_infinite_halt_rests_in_the_next_step():
    controller = sw.Controller(OSR, LIMITS.replace(halt_deceleration=math.inf), timeout=None)
    controller.run([(0.5, 0.0, 0.0)], [0.0], np.arange(0.0, 3.0, DT))
    controller.halt()
    assert not np.any(controller.step(3.0).wheel_speeds)


def test_a_reset_moves_no_joint():
    """It commanded every joint to 0 in one step."""
    controller = sw.Controller(OSR, LIMITS, timeout=None)
    controller.run([(0.5, 0.0, 0.5)], [0.0], np.arange(0.0, 3.0, DT))
    steering = controller.steering
    assert np.max(np.abs(steering)) > 0.3
    controller.halt()
    controller.reset()
    assert not controller.halted
    out = controller.step(0.0)  # an earlier time is fine
    np.testing.assert_array_equal(out.steering, steering)
    assert not np.any(out.twist)
    controller.reset()
    np.testing.assert_array_equal(controller.step(0.0, [0.1, 0.0, 0.0, 0.0]).steering, [0.1, 0.0, 0.0, 0.0])
    controller.reset(steering=[0.2, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(controller.step(0.0, [0.1, 0.0, 0.0, 0.0]).steering, [0.2, 0.0, 0.0, 0.0])
    for wrong in ([0.2], [math.nan, 0, 0, 0], [9.0, 0, 0, 0]):
        with pytest.raises(ValueError, match="steering must"):
            controller.reset(steering=wrong)


def test_limits_of_a_living_controller():
    controller = sw.Controller(OSR, LIMITS, timeout=None)
    times = np.arange(0.0, 4.0, DT)
    controller.run([(0.8, 0.0, 0.0)], [0.0], times)
    assert controller.twist[0] == pytest.approx(0.8)
    controller.limits = controller.limits.replace(speed=0.3, acceleration=0.25)
    assert controller.limits == sw.Limits(
        speed=0.3, acceleration=0.25, steering_rate=1.0, halt_deceleration=2.0
    )
    speeds = [controller.twist[0]] + [controller.step(4.0 + k * DT).twist[0] for k in range(300)]
    drops = -np.diff(speeds) / DT
    assert np.max(drops) <= 0.25 * (1 + 1e-6)
    assert speeds[round((0.8 - 0.3) / 0.25 / DT) + 2] <= 0.3
    assert speeds[-1] == pytest.approx(0.3)
    with pytest.raises(ValueError, match="steering_limit must lie inside the steering range"):
        controller.limits = controller.limits.replace(steering_limit=3.0)
    with pytest.raises((TypeError, ValueError), match="limits must be Limits"):
        controller.limits = 0.3
    assert controller.limits.speed == 0.3


def test_a_pause_counts_as_the_longest_step():
    controller = sw.Controller(OSR, LIMITS, timeout=None)
    controller.run([(0.5, 0.0, 0.0)], [0.0], np.arange(0.0, 0.5, DT))
    before = controller.twist[0]
    out = controller.step(10.5)
    assert out.reasons & Reason.PAUSED
    assert out.twist[0] == pytest.approx(before + 0.5 * 0.1)
    with pytest.raises(ValueError, match="stamp must be later than the last step"):
        controller.step(10.5)
