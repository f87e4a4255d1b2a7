"""The controller: clocks, measured angles, alignment, options, threads, a drill of faults."""

import math
import os
import pickle
import random
import threading

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.kinematics.controller import Reason
from six_wheel.reference.control import controller as slow
from tests.core.control.controlled import ALL, LIMITS, ROVER, drive, shot
from tests.limits import only


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
