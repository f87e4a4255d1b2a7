"""The loop: with good messages it is Controller and Odometry, and what was wrong with others is said."""

import math

import numpy as np
import pytest

pytest.importorskip("pydantic", reason='needs pip install "six-wheel[cli]"')

import six_wheel as sw
from six_wheel.control_loop import Loop, Options, Settings
from six_wheel.control_loop.diagnostics import statuses
from tests.rovers import SIX_WHEELS as ROVER

LIMITS = sw.Limits(speed=1.0, acceleration=0.5, wheel_speed=8.0, steering_rate=1.0)
SETTINGS = Settings.of_rover(ROVER, limits=LIMITS)
NAMES = [*ROVER.steering_joints, *ROVER.traction_joints]
START = 1_700_000_000_000_000_000  # [ns]
PERIOD = 5_000_000
TWIST = (0.5, 0.0, 0.2)


class Robot:
    """Follows at once; its joint states come every `PERIOD`, a command every tenth time."""

    def __init__(self, settings: Settings = SETTINGS, now: int = START) -> None:
        self.loop = Loop(settings)
        self.now = now
        self.steering, self.angles, self.wheel_speeds = [0.0] * 4, [0.0] * 6, [0.0] * 6
        self.names = NAMES
        self.steps = []

    @property
    def positions(self) -> list[float]:
        return [*self.steering, *self.angles]

    def run(self, count: int, twist=TWIST, *, states: bool = True, alter=lambda *message: message) -> list:
        """Outputs of the loop over so many periods."""
        made = []
        for k in range(count):
            self.now += PERIOD
            self.angles = [a + PERIOD * 1e-9 * w for a, w in zip(self.angles, self.wheel_speeds, strict=True)]
            if twist is not None and k % 10 == 0:
                self.loop.command(twist, self.now, self.now)
            steps = [self.loop.tick(self.now)] if k % 4 == 0 else []
            if states:
                names, positions, velocities, stamp = alter(self.names, self.positions, [], self.now)
                steps.append(self.loop.joints(names, positions, velocities, stamp, self.now + 1))
            for step in filter(None, steps):
                made.append(step)
                if step.steering is not None:
                    self.steering, self.wheel_speeds = step.steering, step.wheel_speeds
        self.steps += made
        return made

    def said(self, area: str) -> str:
        (text,) = [
            message for _, name, message, _ in statuses(self.loop, "rover") if name == f"rover: {area}"
        ]
        return text


def test_it_is_controller_and_odometry():
    robot = Robot()
    robot.run(400)
    made = [step for step in robot.steps if step.steering is not None]
    controller, odometry = SETTINGS.controller(steering=[0.0] * 4), SETTINGS.odometry()
    angles, steering, speeds = np.zeros(6), [0.0] * 4, np.zeros(6)
    now, k_made = 0, 0
    for k in range(400):
        now += PERIOD
        angles = angles + PERIOD * 1e-9 * speeds
        seconds = (now + 1 - PERIOD) / 1e9  # from the first call
        if k % 10 == 0:
            controller.command(TWIST, (now - PERIOD) / 1e9)
        state = odometry.update(steering, angles, (now - PERIOD) / 1e9)
        if k * PERIOD < 30_000_000:
            continue  # until it is known how the rover moves
        out = controller.step(seconds, steering)
        assert made[k_made].steering == out.steering.tolist()
        assert made[k_made].wheel_speeds == out.wheel_speeds.tolist()
        assert made[k_made].state.pose.tolist() == state.pose.tolist()
        assert made[k_made].reasons == out.reasons
        steering, speeds, k_made = out.steering.tolist(), out.wheel_speeds, k_made + 1
    assert k_made == len(made)
    assert made[-1].twist == TWIST
    assert [message for level, _, message, _ in statuses(robot.loop, "rover") if level] == []


def test_nothing_is_commanded_before_the_joints_are_known():
    robot = Robot()
    assert robot.run(50, states=False) == []
    made = robot.run(8)
    assert [step.steering is None for step in made] == [True] * 6 + [False] * 2


@pytest.mark.parametrize("twist", [TWIST, (-0.4, 0.0, 0.3), (0.0, 0.0, 0.5)])
def test_started_again_in_motion_the_first_command_does_not_jump(twist):
    robot = Robot()
    robot.run(600, twist)
    before = robot.steps[-1]
    assert before.twist == twist
    again = Robot(now=robot.now)
    again.steering, again.angles, again.wheel_speeds = robot.steering, robot.angles, robot.wheel_speeds
    first = next(step for step in again.run(50, twist) if step.steering is not None)
    # The twist is measured from two readings: rounding, over a period of 5 ms.
    np.testing.assert_allclose(first.twist, twist, atol=1e-9)
    np.testing.assert_allclose(first.steering, before.steering, atol=1e-9)
    # Without a command it stops as it would have.
    alone = Robot(now=robot.now)
    alone.steering, alone.angles, alone.wheel_speeds = robot.steering, robot.angles, robot.wheel_speeds
    speeds = [math.hypot(*step.twist[:2]) for step in alone.run(400, None) if step.steering is not None]
    assert max(np.abs(np.diff(speeds)), default=0.0) <= 0.5 * PERIOD * 1e-9 * (1 + 1e-6)
    assert speeds[-1] == 0.0


def test_wheels_that_contradict_their_steering_are_not_taken_for_a_motion():
    robot = Robot()
    robot.steering, robot.wheel_speeds = [0.5, -0.5, 0.5, -0.5], [1.0, -1.0, 0.2, 1.0, 0.0, 0.3]
    first = next(step for step in robot.run(12, None) if step.steering is not None)
    assert first.twist == (0.0, 0.0, 0.0)
    assert first.steering == [0.5, -0.5, 0.5, -0.5]


def test_joint_states_that_stop_coming_stop_the_rover_within_limits():
    robot = Robot()
    robot.run(600)
    made = robot.run(500, states=False)
    speeds = [step.twist[0] for step in made]
    times = [step.now for step in made]
    assert speeds[0] == TWIST[0]  # for as long as the timeout
    assert speeds[-1] == 0.0
    # All that time commands kept coming, at the rate of the timer.
    assert max(np.diff(times)) <= 20_000_000
    assert max(np.abs(np.diff(speeds) / np.diff(times) * 1e9)) <= 0.5 * (1 + 1e-6)
    assert robot.loop.stopping == "joint states are missing"
    assert "front_left_steering_joint must be in the joint states" in robot.said("joints")
    assert robot.said("motion") == "stopped: joint states are missing"
    robot.run(600)
    assert robot.steps[-1].twist == TWIST
    assert robot.said("motion") == "limited by ACCELERATION"


def renamed(names, *others):
    return [name.replace("front_left_wheel_joint", "front_left_wheel") for name in names], *others


def without_one(names, positions, velocities, stamp):
    return names[:-1], positions[:-1], velocities, stamp


def not_a_number(names, positions, velocities, stamp):
    return names, [*positions[:-1], math.nan], velocities, stamp


def infinite_steering(names, positions, velocities, stamp):
    return names, [math.inf, *positions[1:]], velocities, stamp


def repeated(names, positions, velocities, stamp):
    return [*names, names[0]], [*positions, 0.0], velocities, stamp


def too_few(names, positions, velocities, stamp):
    return names, positions[:3], velocities, stamp


def old(names, positions, velocities, stamp):
    return names, positions, velocities, stamp - 3_000_000_000


@pytest.mark.parametrize(
    ("alter", "word"),
    [
        (
            renamed,
            "front_left_wheel_joint must be in the joint states, got none; is it front_left_wheel now?",
        ),
        (without_one, "joint rear_right_wheel_joint must be in the joint states"),
        (not_a_number, "joint rear_right_wheel_joint must have a finite value, got nan"),
        (infinite_steering, "joint front_left_steering_joint must have a finite value, got inf"),
        (repeated, "a joint must be in a message once, got front_left_steering_joint twice"),
        (too_few, "must have a position, got 3 of them"),
        (old, "stamps must be within 0.5 s of the clock, got 3 s"),
    ],
)
def test_bad_joint_states_stop_the_rover_and_are_named(alter, word):
    robot = Robot()
    robot.run(600)
    robot.run(500, alter=alter)
    assert word in robot.said("joints")
    assert robot.steps[-1].twist == (0.0, 0.0, 0.0)
    robot.run(700)
    assert robot.steps[-1].twist == TWIST  # and when they are good again it goes on
    robot.said("joints")
    robot.run(10)
    assert robot.said("joints") == "good"


def test_a_steering_angle_that_cannot_be_stops_the_drive():
    robot = Robot()
    robot.run(600)
    robot.said("joints")
    robot.run(
        500,
        alter=lambda names, positions, velocities, stamp: (names, [2.5, *positions[1:]], velocities, stamp),
    )
    assert robot.steps[-1].twist == (0.0, 0.0, 0.0)
    assert '"front_left" (to 0.05 rad), got (2.5,' in robot.said("joints")


def test_order_and_strangers_and_several_messages_make_no_difference():
    plain, other = Robot(), Robot()

    def shuffled(names, positions, velocities, stamp):
        order = np.random.default_rng(stamp // PERIOD).permutation(len(names))
        return ["arm", *(names[k] for k in order)], [7.0, *(positions[k] for k in order)], velocities, stamp

    one, two = plain.run(300), other.run(300, alter=shuffled)
    assert [step.wheel_speeds for step in one] == [step.wheel_speeds for step in two]
    parts = Robot()

    def half(part):
        return lambda names, positions, velocities, stamp: (
            names[part],
            positions[part],
            velocities,
            stamp,
        )

    for _ in range(300):
        parts.run(1, alter=half(slice(0, 4)))
        parts.run(1, alter=half(slice(4, 10)))
    assert parts.steps[-1].twist == TWIST


def test_velocities_alone():
    settings = Settings.of_rover(ROVER, Options(position_feedback=False), limits=LIMITS)
    robot = Robot(settings)

    def speeds(names, positions, velocities, stamp):
        return names, positions, [*[0.0] * 4, *robot.wheel_speeds], stamp

    robot.run(400, alter=speeds)
    assert robot.steps[-1].twist == TWIST
    np.testing.assert_allclose(robot.steps[-1].state.twist, TWIST, atol=1e-12)
    robot.run(200)
    assert "must have a velocity, got 0 of them" in robot.said("joints")


def test_commands():
    robot = Robot()
    robot.run(600)
    robot.loop.command((math.nan, 0.0, 0.0), robot.now, robot.now)
    assert robot.said("commands") == "a command must be finite, got (nan, 0.0, 0.0)"
    robot.loop.command(TWIST, robot.now - 2_000_000_000, robot.now)
    assert "a command must not be older than 0.5 s, got 2 s old" in robot.said("commands")
    robot.loop.command(TWIST, robot.now + 9_000_000_000, robot.now)
    assert "must not be ahead of the clock, got 9 s ahead" in robot.said("commands")
    robot.run(400, None)
    assert robot.steps[-1].twist == (0.0, 0.0, 0.0)  # a stamp ahead keeps nothing alive
    assert "commands must keep coming" in robot.said("commands")


def test_time_that_jumps_back_starts_over_without_a_jump():
    for reset in (False, True):
        robot = Robot(Settings.of_rover(ROVER, Options(reset_on_time_jump=reset), limits=LIMITS))
        robot.run(600)
        pose = robot.steps[-1].state.pose
        robot.now -= 100_000_000_000
        made = robot.run(20)
        first = next(step for step in made if step.steering is not None)
        np.testing.assert_allclose(first.twist, TWIST, atol=1e-9)
        assert "time must not run backwards" in robot.said("time")
        moved = np.hypot(*(first.state.pose - (0.0 if reset else pose))[:2])
        assert moved < 0.02


def test_time_that_jumps_ahead_pauses():
    robot = Robot()
    robot.run(600)
    robot.now += 30_000_000_000
    made = robot.run(1, None)
    assert made[0].reasons & sw.Reason.PAUSED
    assert made[0].twist[0] >= TWIST[0] - 0.5 * 0.1 - 1e-9
    assert "time must not jump, got 30.005 s ahead" in robot.said("time")


def test_stamps_that_stand_still():
    robot = Robot()
    robot.run(600)
    stamp = robot.now
    robot.run(500, alter=lambda names, positions, velocities, _: (names, positions, velocities, stamp))
    assert "DUPLICATE" in robot.said("odometry")
    assert robot.steps[-1].twist == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("more", "reset"), [("odometry: {max_speed: 3.0}\n", False), ("", True)])
def test_a_counter_that_starts_over_is_followed(more, reset):
    robot = Robot(Settings.of_text(SETTINGS.text + more))
    robot.run(600)
    before = robot.steps[-1].state.pose
    robot.angles = [0.0 if reset else angle - 300.0 for angle in robot.angles]
    made = robot.run(3)
    assert "RESTARTED" in robot.said("odometry")
    assert np.hypot(*(made[-1].state.pose - before)[:2]) < 0.02


def test_limits_change_while_it_drives():
    robot = Robot()
    robot.run(600)
    robot.loop.change(robot.loop.settings.changed({"limits.speed": 0.2}), robot.now)
    speeds = [step.twist[0] for step in robot.run(400)]
    assert max(np.abs(np.diff([TWIST[0], *speeds]))) <= 0.5 * PERIOD * 1e-9 * (1 + 1e-6)
    assert speeds[-1] == pytest.approx(0.2)
    with pytest.raises(ValueError, match="the rover must stay what it is"):
        robot.loop.change(robot.loop.settings.changed({"wheel_radius": 0.2}), robot.now)


def test_inactive_it_stops_and_is_silent():
    robot = Robot()
    robot.run(600)
    robot.loop.activate(robot.now, active=False)
    made = robot.run(500)
    assert [step.steering is None for step in made][-1]
    assert robot.loop.stopped
    commanded = [step for step in made if step.steering is not None]
    assert commanded[-1].twist[0] < 0.01
    robot.loop.activate(robot.now)
    robot.run(400)
    assert robot.steps[-1].twist == TWIST


def test_open_loop():
    loop = Loop(Settings.of_rover(ROVER, Options(open_loop=True), limits=LIMITS))
    now = START
    for k in range(200):
        now += 20_000_000
        if k % 5 == 0:
            loop.command(TWIST, now, now)
        step = loop.tick(now)
    assert step.twist == TWIST
    travelled = np.hypot(*step.state.pose[:2])
    assert 1.0 < travelled < 2.0


def test_poses():
    robot = Robot()
    robot.run(300)
    robot.loop.set_pose([5.0, 6.0, 0.0], None, robot.now)
    (step,) = robot.run(1)
    assert np.hypot(*(step.state.pose - (5.0, 6.0, 0.0))[:2]) < 0.01
    robot.loop.reset(robot.now)
    assert robot.run(2)[-1].state.pose[0] < 0.01
    with pytest.raises(ValueError, match="pose must be finite"):
        robot.loop.set_pose([math.nan, 0.0, 0.0], None, robot.now)


def test_changes_of_settings():
    changed = SETTINGS.changed({"limits.speed": 0.3, "joint_state_timeout": 1.0})
    assert (changed.parameters.limits.speed, changed.options.joint_state_timeout) == (0.3, 1.0)
    assert changed.rover == ROVER
    assert changed.changed({"limits.speed": None}).parameters.limits.speed == math.inf
    assert SETTINGS.changed({"limits.speed": 1.0}).parameters.limits == LIMITS  # as it is
    for changes, message in (
        ({"limits.speed": -1.0}, "limits.speed must be finite and positive, got -1.0"),
        ({"limits.sped": 1.0}, "unknown key limits.sped"),
        ({"joint_state_timeout": 1e9}, "joint_state_timeout must lie between 0.01 and 60, got 1e"),
        ({"open_loop": "yes"}, "open_loop must be true or false, got 'yes'"),
    ):
        with pytest.raises(ValueError, match=message):
            SETTINGS.changed(changes)


def test_joints_that_count_the_other_way():
    backwards = [NAMES[0], NAMES[4], NAMES[9]]
    turned = sw.Rover(
        ROVER.wheels,
        traction_joints=ROVER.traction_joints,
        steering_joints=ROVER.steering_joints,
        reversed_joints=backwards,
    )
    plain, other = Robot(), Robot(Settings.of_rover(turned, limits=LIMITS))
    one, two = plain.run(300)[-1], other.run(300)[-1]
    signs = [-1.0 if joint in backwards else 1.0 for joint in NAMES]
    np.testing.assert_array_equal(
        [*two.steering, *two.wheel_speeds], np.multiply(signs, [*one.steering, *one.wheel_speeds])
    )
    np.testing.assert_allclose(two.state.pose, one.state.pose, atol=1e-12)


def test_settings_of_what_a_file_says(tmp_path):
    path = tmp_path / "rover.yaml"
    path.write_text(SETTINGS.text + "noise: {speed: 0.02}\n")
    said = sw.robot_description.parameters.read_parameters(path)
    assert Settings.of_parameters(said).parameters.noise == {"speed": 0.02}
    path.unlink()  # then the numbers alone tell
    again = Settings.of_parameters(said)
    assert (again.rover, again.parameters.limits) == (ROVER, LIMITS)
    assert again.parameters.noise == {"speed": 0.02}
