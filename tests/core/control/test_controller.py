"""The controller: limits, one centre of rotation, reasons, faults, and the slow way to the same results.

The laws over a million random steps are in `rust/control/tests/controller.rs`.
"""

import math
import os
import pickle
import random
import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel import _core, reference
from six_wheel.kinematics.controller import Reason
from six_wheel.reference.control import controller as slow
from tests.limits import only
from tests.rovers import SIX_SIZES
from tests.strategies import any_twists, six_wheel_rovers

ROVER = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(60))
LIMITS = sw.Limits(
    speed=1.0,
    acceleration=0.5,
    deceleration=0.8,
    jerk=2.0,
    angular_acceleration=1.0,
    wheel_speed=8.0,
    wheel_acceleration=10.0,
    steering_rate=1.0,
    steering_acceleration=4.0,
    lateral_acceleration=0.4,
)
# Rounding of divided differences of numbers near 1, over steps of 1 ms: 1e-16 / 1e-6 beside limits near 1.
ALL = 1.0 + 1e-6


def shot(now: float, out: sw.ControllerOutput) -> slow.Shot:
    return slow.Shot(now, out.twist, out.steering, out.wheel_speeds)


def drive(controller, seconds, *, start=0.0, dt=0.01, commands=()):
    """A log of steps; `commands` are pairs of step and twist."""
    commands, log = dict(commands), []
    for k in range(round(seconds / dt) + 1):
        now = start + k * dt
        if k in commands:
            controller.command(commands[k], now)
        log.append((now, controller.step(now)))
    return log


def scrub(rover: sw.Rover, out: sw.ControllerOutput) -> float:
    """The fastest sideways slip of a wheel [m/s]."""
    twin = reference.Rover.like(rover)
    angles = iter(out.steering)
    return max(
        abs(float(wheel.rows(next(angles) if wheel.steered else 0.0)[1] @ out.twist)) for wheel in twin.wheels
    )


def test_reasons_are_those_of_the_core():
    assert {reason.name: int(reason) for reason in Reason} == dict(_core.reason_bits())
    assert sw.Reason is Reason


def test_the_picture_of_the_readme():
    controller = sw.Controller(
        ROVER,
        sw.Limits(speed=1.0, acceleration=0.5, jerk=2.0, wheel_speed=8.0, steering_rate=1.0),
        timeout=0.5,
    )
    assert controller.command((0.5, 0.0, 0.3), 0.0) is True
    out = controller.step(0.0)
    assert out.steering.shape == (4,)
    assert out.wheel_speeds.shape == (6,)
    assert out.twist.shape == (3,)
    assert out.steering_rates.shape == (4,)
    assert isinstance(out.reasons, Reason)
    assert out.reasons & Reason.ALIGNING


@given(six_wheel_rovers(st.floats(0.3, 2.0)), st.lists(any_twists(), min_size=1, max_size=4))
def test_no_limit_is_exceeded(rover, twists):
    controller = sw.Controller(rover, LIMITS, timeout=None)
    log = drive(controller, 3.0, commands=[(75 * k, twist) for k, twist in enumerate(twists)])
    used = slow.excess(LIMITS, [shot(now, out) for now, out in log])
    assert max(used.values()) <= ALL, used
    assert max(scrub(rover, out) for _, out in log) < 1e-9


@given(six_wheel_rovers(st.floats(0.3, 2.0)), any_twists())
def test_every_output_is_what_the_inverse_says(rover, twist):
    controller = sw.Controller(rover, LIMITS, timeout=None)
    for _, out in drive(controller, 2.0, dt=0.05, commands=[(0, twist)]):
        if out.twist.any():
            steering, speeds = rover.inverse(out.twist, previous=out.steering)
            np.testing.assert_allclose(out.steering, steering, rtol=0, atol=1e-9)
            np.testing.assert_allclose(out.wheel_speeds, speeds, rtol=0, atol=1e-9)


@given(six_wheel_rovers(st.floats(0.3, 2.0)), any_twists())
def test_the_goal_is_that_of_the_slow_way(rover, twist):
    limits = only(speed=0.6, yaw_rate=0.5, lateral_acceleration=0.2, wheel_speed=4.0)
    controller = sw.Controller(rover, limits)
    controller.command(twist, 0.0)
    out = controller.step(0.0)
    expected, name = slow.saturated(reference.Rover.like(rover), limits, twist)
    np.testing.assert_allclose(out.twist, expected, rtol=0, atol=1e-9)
    if name is not None and not np.allclose(expected, rover.project(twist), rtol=1e-12, atol=0):
        assert out.reasons & Reason[name]
    if np.array_equal(out.twist, twist):
        assert not out.reasons
    # Slowed down, not bent.
    assert abs(out.twist[0] * rover.project(twist)[2] - out.twist[2] * rover.project(twist)[0]) < 1e-9


@given(
    st.floats(0, 1),
    st.floats(-0.3, 0.3),
    st.floats(0, 1),
    st.floats(0.3, 2),
    st.floats(0.3, 2),
    st.floats(0.5, 5),
    st.floats(0.001, 0.1),
)
def test_the_speed_is_that_of_the_slow_way(first, rate, second, slower, faster, jerk, dt):
    limits = sw.Limits(acceleration=faster, deceleration=slower, jerk=jerk)
    controller = sw.Controller(ROVER, limits, timeout=None)
    value = change = 0.0
    goals = [first] * 10 + [second] * 10
    for k, goal in enumerate(goals):
        controller.command((goal, 0, 0), k * dt)
        speed = controller.step(k * dt).twist[0]
        if k:
            value, change = slow.ramp(value, change, goal, (slower, faster), jerk, dt)
        assert speed == pytest.approx(value, abs=1e-7)


def test_a_turn_takes_at_most_twice_as_long_as_trying_each_step():
    limits = sw.Limits(acceleration=0.5, steering_rate=1.0)
    start, goal, dt = (0.3, 0.0, 0.0), (0.3, 0.0, 0.3), 0.01
    twin = reference.Rover.like(ROVER)
    stepper = slow.Stepper(twin, limits, np.array(start), *twin.inverse(start))
    count = 0
    while not np.allclose(stepper.twist, goal, atol=1e-9):
        stepper.step(goal, dt)
        count += 1
    controller = sw.Controller(ROVER, limits, timeout=None)
    drive(controller, 2.0, commands=[(0, start)])
    log = drive(controller, 4.0, start=2.0 + dt, commands=[(0, goal)])
    ours = next(k for k, (_, out) in enumerate(log) if np.allclose(out.twist, goal, atol=1e-9))
    assert ours <= 2 * count + 2


def test_straight_to_a_tight_turn_without_scrub():
    """Where joints on their own slip by 28.8 mm/s."""
    rover = sw.Rover.preset("open_source_rover")
    radius = max(0.6, rover.min_radius * 1.001)
    controller = sw.Controller(rover, sw.Limits(steering_rate=math.radians(60)), timeout=None)
    drive(controller, 0.2, dt=0.001, commands=[(0, (0.3, 0, 0))])
    log = drive(controller, 2.0, start=0.201, dt=0.001, commands=[(0, (0.3, 0, 0.3 / radius))])
    assert max(scrub(rover, out) for _, out in log) < 1e-12
    np.testing.assert_allclose(log[-1][1].twist, (0.3, 0, 0.3 / radius), rtol=1e-12)


def test_braking_keeps_the_curvature_and_the_angles():
    controller = sw.Controller(ROVER, LIMITS, timeout=0.5)
    log = drive(controller, 8.0, commands=[(0, (0.3, 0.0, 0.2)), (400, (0.0, 0.0, 0.0))])
    braking = [out for now, out in log if now >= 4.0]
    angles = braking[0].steering
    for out in braking:
        np.testing.assert_array_equal(out.steering, angles)
        assert abs(out.twist[0] * 0.2 - out.twist[2] * 0.3) < 1e-9
    assert controller.stopped


def test_a_spin_island_is_left_by_stopping():
    assert ROVER.spin_radius < ROVER.min_radius < math.inf
    controller = sw.Controller(ROVER, LIMITS, timeout=None)
    log = drive(controller, 8.0, commands=[(0, (0.3, 0, 0)), (200, (0, 0, 0.3))])
    reasons = [out.reasons for now, out in log if now >= 2.0]
    assert reasons[0] & Reason.SPIN_ISLAND
    assert any(reason & Reason.ALIGNING for reason in reasons)
    assert not reasons[-1]
    np.testing.assert_array_equal(log[-1][1].twist, (0, 0, 0.3))
    assert max(slow.excess(LIMITS, [shot(*pair) for pair in log]).values()) <= ALL


def test_a_stale_command_stops_the_rover_and_a_new_one_goes_on_without_a_jump():
    controller = sw.Controller(ROVER, LIMITS, timeout=0.3)
    log = []
    for k in range(6000):
        now = k * 0.001
        if now < 2.0 or now > 2.8:
            controller.command((0.4, 0.0, 0.1), now)
        log.append(shot(now, out := controller.step(now)))
        assert bool(out.reasons & Reason.STALE) == (2.3 < now <= 2.8), now
    assert np.linalg.norm(log[2799].twist) < 0.4
    np.testing.assert_allclose(log[-1].twist, (0.4, 0, 0.1))
    assert max(slow.excess(LIMITS, log).values()) <= ALL


@pytest.mark.parametrize(
    "bad", [(math.nan, 0, 0), (0.1, math.inf, 0), (0, 0, -math.inf), (1e308, 1e308, 1e308)]
)
def test_a_command_that_is_not_finite_is_ignored_and_the_last_one_ages(bad):
    controller = sw.Controller(ROVER, only(), timeout=0.5)
    controller.command((0.2, 0, 0), 0.0)
    assert not controller.step(0.0).reasons
    assert controller.command(bad, 0.1) is False
    out = controller.step(0.1)
    assert out.reasons == Reason.NOT_FINITE
    np.testing.assert_array_equal(out.twist, (0.2, 0, 0))
    for k in range(2, 6):
        controller.step(k * 0.1)
    assert controller.step(0.6).reasons & Reason.STALE
    controller.command((0.2, 0, 0), 0.6)
    assert not controller.step(0.7).reasons


def test_old_and_early_stamps():
    controller = sw.Controller(ROVER, only(), timeout=0.5)
    controller.command((0.2, 0, 0), 1.0)
    assert controller.command((0.4, 0, 0), 0.9) is False
    out = controller.step(1.0)
    assert out.reasons == Reason.OUT_OF_ORDER
    assert out.twist[0] == 0.2
    assert not controller.step(1.05).reasons
    # From the future: taken, but it ages from the step that sees it.
    controller.command((0.3, 0, 0), 1e9)
    assert controller.step(1.1).twist[0] == 0.3
    assert controller.command((0.1, 0, 0), 1.15) is True
    assert controller.step(1.15).twist[0] == 0.1
    # The same stamp again replaces.
    controller.command((0.2, 0, 0), 1.15)
    assert controller.step(1.16).twist[0] == 0.2


@pytest.mark.parametrize("stamp", [1.0, 0.5, math.nan, math.inf])
def test_a_clock_that_does_not_advance_is_an_error_without_effect(stamp):
    controller = sw.Controller(ROVER, LIMITS)
    controller.command((0.2, 0, 0), 1.0)
    controller.step(1.0)
    with pytest.raises(ValueError, match="^stamp must be"):
        controller.step(stamp)
    twin = sw.Controller(ROVER, LIMITS)
    twin.command((0.2, 0, 0), 1.0)
    twin.step(1.0)
    np.testing.assert_array_equal(controller.step(1.1).twist, twin.step(1.1).twist)


def test_a_step_after_an_hour_is_a_step():
    controller = sw.Controller(ROVER, LIMITS, timeout=None, max_step=0.05)
    controller.command((0.5, 0, 0), 0.0)
    controller.step(0.0)
    before = controller.step(0.05)
    after = controller.step(3600.0)
    assert after.reasons & Reason.PAUSED
    assert after.twist[0] - before.twist[0] <= 0.5 * 0.05


@pytest.mark.parametrize(
    ("measured", "rule"),
    [
        ([0, 0, math.nan, 0], "be finite"),
        ([0, 0, 0], r"have shape \(\.\.\., 4\)"),
        ([[0, 0, 0, 0]], r"have shape \(4,\)"),
        ("abcd", "be"),
    ],
)
def test_measured_angles_that_cannot_be_are_errors_without_effect(measured, rule):
    controller, twin = (sw.Controller(ROVER, LIMITS) for _ in range(2))
    for each in (controller, twin):
        each.command((0.5, 0, 0.1), 0.0)
        each.step(0.0)
    with pytest.raises(ValueError, match=f"^measured must {rule}"):
        controller.step(0.1, measured)
    np.testing.assert_array_equal(controller.step(0.1).steering, twin.step(0.1).steering)
    assert controller.stamp == 0.1


@pytest.mark.parametrize(("align", "share"), [("cosine", math.cos(0.5)), ("hold", 0.0), (None, 1.0)])
def test_the_drive_waits_for_the_wheels(align, share):
    controller = sw.Controller(ROVER, align=align)
    controller.command((0.5, 0, 0), 0.0)
    controller.step(0.0)
    out = controller.step(0.1, [0.0, -0.5, 0.1, 0.0])
    np.testing.assert_allclose(out.twist, (0.5 * share, 0, 0), atol=1e-15)
    assert bool(out.reasons & Reason.ALIGNING) == (share < 1)
    assert not controller.step(0.2, np.zeros(4)).reasons


def test_it_starts_from_the_measured_angles():
    controller = sw.Controller(ROVER, LIMITS)
    controller.command((0.5, 0, 0), 0.0)
    np.testing.assert_array_equal(controller.step(0.0, [0.1, 0.2, 0.3, 0.4]).steering, [0.1, 0.2, 0.3, 0.4])
    controller = sw.Controller(ROVER, LIMITS, steering=[0.1, 0, 0, 0])
    assert controller.step(0.0).steering[0] == 0.1
    controller.reset()
    assert controller.stamp is None
    assert controller.steering[0] == 0.1


@pytest.mark.parametrize("twist", [(0.5, 0.3, 0.8), (0.2, -0.6, -1.0)])
@pytest.mark.parametrize("limits", [only(), only(speed=0.4), only(wheel_speed=3.0)])
def test_discretised_commands_do_not_skew(twist, limits):
    swerve = sw.Rover.swerve([(0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)], 0.1)
    period = 0.05
    controller = sw.Controller(swerve, limits, period=period, discretise=True)
    controller.command(twist, 0.0)
    out = controller.step(0.0)
    x, y, yaw = sw.exp(out.twist, period)
    # Along the command, by as much as the limits leave.
    share = yaw / (twist[2] * period)
    np.testing.assert_allclose((x, y), np.multiply(twist[:2], share * period), atol=1e-12)
    assert share <= 1 + 1e-12
    assert np.hypot(*out.twist[:2]) <= limits.speed * ALL
    assert np.max(np.abs(out.wheel_speeds)) <= limits.wheel_speed * ALL
    # A rover that cannot follow is left alone.
    controller = sw.Controller(ROVER, only(), period=period, discretise=True)
    controller.command((0.5, 0, 0.2), 0.0)
    np.testing.assert_array_equal(controller.step(0.0).twist, (0.5, 0, 0.2))


def test_modes_by_command():
    swerve = sw.Rover.swerve([(0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)], 0.1)
    controller = sw.Controller(swerve, only())
    for k, (mode, expected) in enumerate(
        [("crab", (0.5, 0.2, 0)), ("spin", (0, 0, 0.3)), ("free", (0.5, 0.2, 0.3)), (None, (0.5, 0.2, 0.3))]
    ):
        controller.command((0.5, 0.2, 0.3), k * 0.1, mode=mode)
        np.testing.assert_array_equal(controller.step(k * 0.1).twist, expected)
    with pytest.raises(ValueError, match="^mode must be 'free', 'crab'"):
        controller.command((0, 0, 0), 1.0, mode="sideways")
    with pytest.raises(ValueError, match="^mode must be that of the controller"):
        controller.command((0, 0, 0), 1.0, mode="front_only")
    front = sw.Controller(ROVER, only(), mode="front_only")
    front.command((0.5, 0, 0.1), 0.0)
    out = front.step(0.0)
    assert out.steering[0] > 0
    np.testing.assert_array_equal(out.steering[2:], 0)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"timeout": 0.0}, "timeout must be positive"),
        ({"timeout": math.nan}, "timeout must be positive"),
        ({"period": -1.0}, "period must be finite and positive"),
        ({"period": 0.2}, "period must not exceed max_step=0.1, got 0.2"),
        ({"max_step": 0.0}, "max_step must be finite and positive"),
        ({"discretise": True}, "period must be given with discretise=True"),
        ({"mode": "sideways"}, "mode must be 'free'"),
        ({"align": "soon"}, "align must be 'cosine', 'hold' or None"),
        ({"align_tolerance": 0.0}, "align_tolerance must be"),
        ({"steering": [0, 0, 0, math.inf]}, "steering must be finite"),
        ({"steering": [0, 0]}, "steering must have shape"),
        (
            {"limits": sw.Limits(steering_limit=1.2)},
            'steering_limit must lie inside .* wheel "front_left", got 1.2',
        ),
    ],
)
def test_options_that_make_no_sense(keywords, message):
    with pytest.raises(ValueError, match=message):
        sw.Controller(ROVER, **keywords)


def test_a_narrower_steering_limit_counts():
    controller = sw.Controller(ROVER, only(steering_limit=0.3))
    controller.command((0.5, 0, 0.6), 0.0)
    out = controller.step(0.0)
    assert out.reasons & Reason.STEERING_LIMIT
    assert np.max(np.abs(out.steering)) <= 0.3
    assert out.twist[0] > 0


def test_a_wheel_with_scrub_rolls_while_it_is_steered():
    wheels = [
        sw.Wheel("front", 0.5, 0.0, radius=0.1, steered=True, scrub=0.05),
        sw.Wheel("left", 0.0, 0.3, radius=0.1),
        sw.Wheel("right", 0.0, -0.3, radius=0.1),
    ]
    rover = sw.Rover(wheels)
    limits = sw.Limits(
        steering_rate=1.0, steering_acceleration=5.0, wheel_acceleration=20.0, acceleration=0.5
    )
    controller = sw.Controller(rover, limits, timeout=None)
    log = drive(controller, 4.0, commands=[(0, (0.3, 0, 0.3)), (200, (0.3, 0, -0.2))])
    turning = [out for _, out in log if out.steering_rates.any()]
    assert len(turning) > 50
    for out in turning:
        expected = rover.inverse(out.twist, previous=out.steering, steering_rates=out.steering_rates)[1]
        np.testing.assert_allclose(out.wheel_speeds, expected, atol=1e-9)
    assert max(slow.excess(limits, [shot(*pair) for pair in log]).values()) <= ALL


def fault_drill(seed: int, seconds: float) -> None:
    """A loop at 1 kHz with commands dropped, late, twice, not finite, reordered, and frozen feedback."""
    draw = random.Random(seed)
    timeout, dt = 0.1, 0.001
    controller = sw.Controller(ROVER, LIMITS, timeout=timeout)
    log: list[slow.Shot] = []
    due: list[tuple[float, tuple[float, float, float], float]] = []
    quiet, wanted, stop, frozen = 0.0, (0.0, 0.0, 0.0), None, None
    for k in range(round(seconds / dt)):
        now = k * dt
        if draw.random() < 0.001:
            quiet = now + draw.uniform(0.0, 3.0)  # the planner hangs
        if draw.random() < 0.002:
            wanted = (draw.uniform(-1, 1), 0.0, draw.choice((0.0, draw.uniform(-0.5, 0.5))))
        if k % 20 == 0 and now >= quiet and draw.random() < 0.9:
            late = draw.choice((0.0, 0.0, draw.uniform(0.0, 0.08)))
            bad = draw.random() < 0.1
            due.append((now + late, (math.nan, 0.0, 0.0) if bad else wanted, now))
            if draw.random() < 0.1:
                due.append((now + late, wanted, now))
        for item in [item for item in due if item[0] <= now]:
            due.remove(item)
            controller.command(item[1], item[2])
        if draw.random() < 0.001:
            frozen = None if frozen is not None else controller.steering
        measured = frozen if frozen is not None else controller.steering
        stated = controller.stopping_distance
        out = controller.step(now, measured)
        log.append(shot(now, out))
        if out.reasons & Reason.STALE:
            way, limit = stop or (0.0, stated)
            before = log[-2].twist if k else out.twist
            way += math.hypot(before[0], before[1]) * dt
            assert way <= limit + 1e-12, (seed, now)
            stop = (way, limit)
        else:
            stop = None
    used = slow.excess(LIMITS, log)
    assert max(used.values()) <= ALL, (seed, used)
    assert any(np.linalg.norm(shot.twist) > 0.1 for shot in log)


def test_fault_drill():
    fault_drill(1, 60.0)
    for seed in range(int(os.environ.get("SOAK", "0"))):
        fault_drill(2 + seed, 60.0)


def test_commands_come_from_any_thread():
    controller = sw.Controller(ROVER, LIMITS, timeout=None)
    done = threading.Event()

    def planner():
        k = 0
        while not done.is_set():
            controller.command((0.1 + 0.1 * (k % 3), 0.0, 0.05 * (k % 2)), 0.0)
            k += 1

    threads = [threading.Thread(target=planner) for _ in range(3)]
    for thread in threads:
        thread.start()
    log = [(k * 0.01, controller.step(k * 0.01)) for k in range(2000)]
    done.set()
    for thread in threads:
        thread.join()
    assert max(slow.excess(LIMITS, [shot(*pair) for pair in log]).values()) <= ALL


def test_the_quick_way_is_the_general_one():
    quick, general = (sw.Controller(ROVER, LIMITS) for _ in range(2))
    for k in range(300):
        now = k * 0.01
        twist = (0.3 * math.sin(k / 50), 0.0, 0.2)
        quick.command(twist, now)
        general.command(np.array(twist, dtype=">f8"), np.float64(now))
        a = quick.step(now, tuple(quick.steering))
        b = general.step(now, measured=np.array(general.steering, dtype=np.longdouble))
        np.testing.assert_array_equal(a.wheel_speeds, b.wheel_speeds)
        np.testing.assert_array_equal(a.steering, b.steering)
        assert a.reasons == b.reasons


def test_what_it_says_of_itself():
    controller = sw.Controller(
        ROVER, LIMITS, timeout=None, period=0.01, mode="crab", align=None, discretise=True
    )
    names = {"Rover": sw.Rover, "Limits": sw.Limits, "Controller": sw.Controller}
    copy = eval(repr(controller), names)
    assert repr(copy) == repr(controller)
    assert copy.limits == LIMITS
    assert copy.rover == ROVER
    assert "reasons=" in repr(controller.step(0.0))
    with pytest.raises(TypeError):
        pickle.dumps(controller)  # a state, not a value
