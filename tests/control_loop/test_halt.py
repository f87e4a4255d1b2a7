"""Halt, release and a joint that does not follow: what the loop makes of them, and what it says."""

import math

import numpy as np
import pytest

pytest.importorskip("pydantic", reason='needs pip install "six-wheel[cli]"')

import six_wheel as sw
from six_wheel.control_loop import Options, Settings
from six_wheel.control_loop.diagnostics import statuses
from six_wheel.kinematics.rover_edit import replace
from tests.control_loop.test_loop import LIMITS, PERIOD, ROVER, TWIST, Robot

HALTS = 2.0  # [m/s^2]
SETTINGS = Settings.of_rover(ROVER, limits=replace(LIMITS, halt_deceleration=HALTS))


def driving(settings: Settings = SETTINGS) -> Robot:
    robot = Robot(settings)
    robot.run(600)
    assert robot.steps[-1].twist == TWIST
    return robot


def fastest(made: list) -> np.ndarray:
    """Of the wheels in every step [rad/s]."""
    return np.array([max(map(abs, step.wheel_speeds)) for step in made])


def motion(robot: Robot) -> tuple[int, str, dict[str, str]]:
    level, _, text, values = statuses(robot.loop, "rover")[0]
    return level, text, values


def test_a_halt_stops_at_its_own_deceleration_and_takes_no_command():
    robot = driving()
    robot.loop.halt(robot.now)
    made = robot.run(200)
    speeds = fastest(made)
    _, wheels = ROVER.inverse(TWIST)
    ground = speeds * 0.15  # [m/s] of the contact of the fastest wheel
    steps = np.diff([step.now for step in made]) * 1e-9
    assert np.all(-np.diff(ground) <= HALTS * steps * (1 + 1e-6))
    rest = np.argmax(speeds == 0.0)
    taken = (made[rest].now - robot.steps[-len(made) - 1].now) * 1e-9
    assert taken <= 0.15 * max(np.abs(wheels)) / HALTS + 3 * PERIOD * 1e-9
    assert not speeds[rest:].any()
    assert all(step.reasons & sw.Reason.HALTED for step in made)
    level, text, _ = motion(robot)
    assert (level, text) == (2, "halted; ~/release ends it")


def test_release_waits_for_rest_and_then_for_a_new_command():
    robot = driving()
    robot.loop.halt(robot.now)
    robot.run(4)
    assert not robot.loop.release(robot.now)
    robot.run(200)
    assert robot.loop.halted
    assert robot.loop.release(robot.now)
    assert not robot.loop.halted
    before = robot.now
    assert not fastest(robot.run(100, None)).any()
    robot.loop.command(TWIST, before - 1, robot.now)  # given before the release
    assert not fastest(robot.run(20, None)).any()
    robot.run(600)
    assert robot.steps[-1].twist == TWIST


@pytest.mark.parametrize("when", ["before the first step", "twice", "time jumps"])
def test_a_halt_holds(when):
    robot = Robot(SETTINGS)
    if when != "before the first step":
        robot.run(600)
    robot.loop.halt(robot.now or 1)
    if when == "twice":
        robot.run(10)
        robot.loop.halt(robot.now)
    if when == "time jumps":
        robot.run(200)
        robot.now -= 50_000_000_000
    made = robot.run(400)
    assert robot.loop.halted
    assert not fastest([step for step in made if step.steering is not None][-100:]).any()


def test_a_joint_that_sticks_is_named_and_halts_until_it_is_released():
    robot = driving()
    names = list(ROVER.steering_joints)
    held = robot.steering[names.index("front_left_steering_joint")]

    def stuck(names, positions, velocities, stamp):
        positions = list(positions)
        positions[names.index("front_left_steering_joint")] = held
        return names, positions, velocities, stamp

    made = robot.run(1000, (0.5, 0.0, -0.3), alter=stuck)
    found = next(k for k, step in enumerate(made) if step.reasons & sw.Reason.JOINT_STUCK)
    assert not fastest(made[-100:]).any()
    level, text, values = motion(robot)
    assert level == 2
    assert "joint front_left_steering_joint does not follow" in text
    assert values["stuck joint"] == "front_left_steering_joint"
    error = float(values["error of the stuck joint [rad]"])
    assert abs(error) >= 0.2
    # As it was in the step in which it was told, or the one before: at most one step of the joint apart.
    commanded = made[found - 1].steering[names.index("front_left_steering_joint")]
    assert math.isclose(error, held - commanded, abs_tol=2e-3 + 1.0 * 4 * PERIOD * 1e-9)
    # Nothing presses against it.
    assert math.isclose(robot.steering[names.index("front_left_steering_joint")], held, abs_tol=1e-6)
    assert robot.loop.release(robot.now)
    assert robot.loop.stuck is None
    robot.run(1000)
    assert robot.steps[-1].twist == TWIST


def test_lost_joint_states_are_a_stop_and_no_halt():

    settings = Settings.of_rover(ROVER, Options(joint_state_timeout=2.0), limits=LIMITS)
    robot = driving(settings)
    made = robot.run(1200, (0.5, 0.0, -0.4), states=False)
    assert not any(step.reasons & (sw.Reason.JOINT_STUCK | sw.Reason.HALTED) for step in made)
    assert robot.loop.stopping == "joint states are missing"
    assert made[-1].twist == (0.0, 0.0, 0.0)


def test_limits_change_on_the_same_controller():
    robot = driving()
    controller = robot.loop._controller
    robot.loop.change(robot.loop.settings.changed({"limits.speed": 0.2}), robot.now)
    assert robot.loop._controller is controller
    made = robot.run(600)
    assert math.hypot(*made[-1].twist[:2]) <= 0.2 * (1 + 1e-9)
    before = robot.loop.settings
    with pytest.raises(ValueError, match="steering_limit"):
        robot.loop.change(before.changed({"limits.steering_limit": 9.0}), robot.now)
    assert robot.loop.settings is before


def test_the_end_is_rest_in_one_step_and_only_where_commands_are_in_force():
    robot = driving()
    step = robot.loop.end(robot.now)
    assert step is not None
    assert step.steering == robot.steering
    assert not any(step.wheel_speeds)
    assert robot.loop.end(robot.now) is None
    assert Robot(SETTINGS).loop.end(1) is None
    asleep = driving()
    asleep.loop.activate(asleep.now, active=False)
    asleep.run(600, None)
    assert asleep.loop.stopped
    assert asleep.loop.end(asleep.now) is None
