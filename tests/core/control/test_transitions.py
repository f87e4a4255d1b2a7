"""Transitions of a rover: limits at every instant, one centre of rotation, and the figures of the page.

`SOAK` in the environment multiplies the number of random transitions (`make soak`).
"""

import math
import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel import profiles, reference
from tests.core.control.transition_rovers import LEFT, OSR, RATE, RIGHT, ROVERS, STRAIGHT, largest
from tests.rovers import CORNERS
from tests.strategies import at_most, forward_twists, six_wheel_rovers

SOAK = int(os.environ.get("SOAK", "1"))
CASES = 200 * SOAK
STEPS = 400


def random_twist(rng: np.random.Generator, rover: sw.Rover) -> np.ndarray:
    """Any motion: also rest, straight, spin, and about a wheel's own pivot."""
    twist = rng.normal(size=3) * (0.5, 0.3, 0.5)
    wheel = rover.wheels[rng.integers(len(rover.wheels))]
    special = {
        0: (0, 0, 0),
        1: (0.4, 0, 0),
        2: (0, 0, twist[2]),
        3: twist[2] * np.array((wheel.y, -wheel.x, 1)),
    }
    return rover.project(special.get(int(rng.integers(8)), twist), "nearest")


def random_limits(rng: np.random.Generator) -> dict[str, float]:
    limits = {"steering_rate": 10 ** rng.uniform(-1, 0.7)}
    smooth = int(rng.integers(4))
    if smooth in (1, 2):
        limits["steering_acceleration"] = 10 ** rng.uniform(-1, 1.5)
    if smooth in (2, 3):
        limits["steering_jerk"] = 10 ** rng.uniform(-1, 2)
    for name in ("wheel_acceleration", "acceleration", "angular_acceleration"):
        if rng.random() < 0.4:
            limits[name] = 10 ** rng.uniform(-1, 1)
    return limits


def motors(rover: sw.Rover) -> list[bool]:
    return [wheel.driven and not wheel.castor for wheel in rover.wheels]


def assert_kept(rover: sw.Rover, plan: profiles.IcrTransition, limits: dict[str, float]) -> None:
    """Every limit, by what `at` reports and by differences of it, and no scrub."""
    motor = motors(rover)
    for phase in plan.phases:
        if phase.duration == 0:
            continue
        # Short of the end, where the next phase begins.
        times = np.linspace(phase.start, phase.start + phase.duration * (1 - 1e-9), STEPS)
        state, step = plan.at(times), times[1] - times[0]
        # Rounding of what is differenced.
        noise = 1e-14 * (1 + np.abs(state.wheel_speeds).max()) / step

        def slope(values: np.ndarray, step: float = step) -> np.ndarray:
            return np.diff(values, axis=0) / step

        limit = {
            name: limits.get(name, math.inf) * (1 + 1e-9) + noise for name in (*limits, "wheel_acceleration")
        }
        unlimited = math.inf
        assert largest(state.steering_rates) <= limit["steering_rate"]
        assert largest(slope(state.steering)) <= limit["steering_rate"]
        assert largest(state.steering_accelerations) <= limit.get("steering_acceleration", unlimited)
        assert largest(slope(state.steering_rates)) <= limit.get("steering_acceleration", unlimited)
        assert largest(slope(state.steering_accelerations)) <= limit.get("steering_jerk", unlimited) * (
            1 + 1e-6
        )
        assert largest(slope(state.wheel_speeds[:, motor])) <= limit["wheel_acceleration"]
        change = slope(state.twist)
        assert np.hypot(change[:, 0], change[:, 1]).max() <= limit.get("acceleration", unlimited)
        assert largest(change[:, 2]) <= limit.get("angular_acceleration", unlimited)
        # Rounding of velocities of a few metres per second.
        assert state.scrub.max() < 1e-13


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())
def test_every_limit_holds_at_every_instant_and_nothing_scrubs(rover):
    rng = np.random.default_rng(42)
    for _ in range(max(1, CASES // len(ROVERS))):
        start, end, limits = random_twist(rng, rover), random_twist(rng, rover), random_limits(rng)
        plan = profiles.icr_transition(rover, start, end, **limits)
        assert_kept(rover, plan, limits)
        np.testing.assert_array_equal(plan.at(-1.0).twist, start)
        np.testing.assert_array_equal(plan.at(plan.duration).twist, end)
        np.testing.assert_array_equal(plan.at(plan.duration + 1.0).twist, end)
        # Angles and speeds are those of the inverse, next to where the wheels stand.
        middle = plan.at(plan.duration / 2)
        steering, speeds = rover.inverse(
            middle.twist, previous=middle.steering, steering_rates=middle.steering_rates
        )
        np.testing.assert_allclose(middle.steering, steering, atol=1e-9)
        np.testing.assert_allclose(middle.wheel_speeds, speeds, atol=1e-9)
        # No angle jumps where one phase ends and the next begins.
        for phase in plan.phases:
            around = plan.at(np.clip([phase.start - 1e-9, phase.start + 1e-9], 0.0, plan.duration))
            assert largest(np.diff(around.steering, axis=0)) <= 1e-8 * (1 + limits["steering_rate"])


@pytest.mark.parametrize("name", ["six wheels", "swerve", "scrub"])
def test_followed_step_by_step_by_the_reference(name):
    rover = ROVERS[name]
    plain = reference.Rover([reference.Wheel(**copied(wheel)) for wheel in rover.wheels])
    limits = {
        "steering_rate": 0.8,
        "steering_acceleration": 3.0,
        "wheel_acceleration": 4.0,
        "acceleration": 0.5,
    }
    plan = profiles.icr_transition(rover, (0.4, 0.0, -0.1), (0.2, 0.0, 0.4), **limits)
    (phase,) = plan.phases
    worst = reference.profiles.strain(plain, plan.at, phase.start, phase.duration)
    for limit, value in limits.items():
        assert getattr(worst, limit) <= value * (1 + 1e-9), limit
    assert worst.scrub < 1e-12
    assert max(getattr(worst, limit) / value for limit, value in limits.items()) > 0.99


def copied(wheel: sw.Wheel) -> dict:
    names = ["name", "x", "y", "radius", "steered", "heading", "steering_limit", "scrub", "trail"]
    return {name: getattr(wheel, name) for name in names}


def test_the_figures_of_the_page(capsys):
    """Open Source Rover at 0.3 m/s, servos of 60 deg/s: scrub that the angles force, and time."""
    plain = reference.Rover.six_wheel(
        front_to_middle=0.274,
        middle_to_rear=0.310,
        track_width=0.354,
        middle_track_width=0.506,
        wheel_radius=0.075,
    )
    lines = [f"{'':24}{'independent':>14}{'synchronised':>14}{'ours':>14}"]
    expected = {
        "straight to R = 0.6 m": (STRAIGHT, (28.8, 9.9), 0.604),
        "R = -0.6 m to R = 0.6 m": (RIGHT, (41.2, 38.3), 1.208),
    }
    for name, (start, scrubs, seconds) in expected.items():
        ends = OSR.inverse(start), OSR.inverse(LEFT)
        joints = [
            profiles.module_transition(OSR, *ends, steering_rate=RATE, synchronise=how)
            for how in ("none", "time")
        ]
        ours = profiles.icr_transition(OSR, start, LEFT, steering_rate=RATE)
        worst, times = [], []
        for plan in (*joints, ours):
            angles = plan.at(np.linspace(0.0, plan.duration, 1001)).steering
            worst.append(max(reference.profiles.angle_scrub(plain, row, 0.3) for row in angles))
            times.append(plan.duration)
        lines.append(f"{name:24}" + "".join(f"{1e3 * value:9.3g} mm/s" for value in worst))
        lines.append(f"{'':24}" + "".join(f"{value:12.3f} s" for value in times))
        np.testing.assert_allclose(1e3 * np.array(worst[:2]), scrubs, atol=0.05)
        assert worst[2] < 1e-12
        assert ours.at(np.linspace(0, ours.duration, 1001)).scrub.max() < 1e-12
        assert ours.duration == pytest.approx(seconds, abs=5e-4)
        assert ours.stops == 0
        np.testing.assert_allclose(times[:2], times[0], rtol=1e-12)
    # From straight, no slower than the joints on their own.
    straight = profiles.icr_transition(OSR, STRAIGHT, LEFT, steering_rate=RATE)
    turn = largest(OSR.inverse(LEFT)[0])
    assert straight.duration == pytest.approx(turn / RATE, rel=1e-14)
    with capsys.disabled():
        print("\n" + "\n".join(lines))


@given(six_wheel_rovers(), forward_twists(), forward_twists(), st.sampled_from([math.inf, 2.0]))
@at_most(60)
def test_mirrored_twists_make_mirrored_transitions(rover, start, end, acceleration):
    mirror = np.array([1.0, 1.0, -1.0])
    limits = {"steering_rate": 1.0, "steering_acceleration": acceleration, "acceleration": 1.0}
    plan = profiles.icr_transition(rover, start, end, **limits)
    other = profiles.icr_transition(rover, start * mirror, end * mirror, **limits)
    # Where a wheel has two ways of the same length it takes the one forwards, which has no mirror image.
    if plan.stops == other.stops == 0 and all(phase.action == "drive" for phase in plan.phases):
        assert other.duration == pytest.approx(plan.duration, rel=1e-9, abs=1e-12)
        times = np.linspace(0.0, plan.duration, 50)
        np.testing.assert_allclose(other.at(times).twist, plan.at(times).twist * mirror, atol=1e-6)


@given(six_wheel_rovers(), forward_twists(), forward_twists())
@at_most(60)
def test_there_takes_as_long_as_back(rover, start, end):
    plan = profiles.icr_transition(rover, start, end, steering_rate=1.0, acceleration=1.0)
    if plan.duration > 0 and plan.stops == 0 and len(plan.phases) == 1:
        back = profiles.icr_transition(
            rover, end, start, steering_rate=1.0, acceleration=1.0, previous=plan.at(plan.duration).steering
        )
        assert back.duration == pytest.approx(plan.duration, rel=1e-9, abs=1e-12)
        times = np.linspace(0.0, plan.duration, 50)
        np.testing.assert_allclose(back.at(plan.duration - times).twist, plan.at(times).twist, atol=1e-8)


@given(six_wheel_rovers(), forward_twists(), forward_twists())
@at_most(60)
def test_no_faster_than_the_joints_and_as_fast_where_one_of_them_leads(rover, start, end):
    plan = profiles.icr_transition(rover, start, end, steering_rate=1.0)
    first, last = plan.at(0.0).steering, plan.at(plan.duration).steering
    assert plan.duration >= largest(last - first) - 1e-9
    # Exact: at every instant of a drive one joint turns at the limit.
    for phase in plan.phases:
        if phase.duration > 0:
            rates = plan.at(phase.start + phase.duration * np.linspace(0.01, 0.99, 20)).steering_rates
            np.testing.assert_allclose(np.abs(rates).max(axis=-1), 1.0, rtol=1e-9)


@pytest.mark.parametrize("jerk", [math.inf, 20.0])
def test_a_single_joint_takes_its_own_least_time(jerk):
    # The path of a bicycle is that of its only steering angle, so the double integrator knows the optimum.
    bicycle = sw.Rover.bicycle(wheelbase=1.0, wheel_radius=0.2)
    limits = {"steering_rate": 1.0, "steering_acceleration": 2.0, "steering_jerk": jerk}
    plan = profiles.icr_transition(bicycle, (0.5, 0, -0.4), (0.5, 0, 0.9), **limits)
    ends = plan.at([0.0, plan.duration]).steering[:, 0]
    least = profiles.time_optimal(*ends, velocity=1.0, acceleration=2.0, jerk=jerk).duration
    assert plan.duration >= least * (1 - 1e-9)
    # A cell of 256 more without a limit of jerk; with one the course is feasible, not the fastest.
    assert plan.duration <= least * (1.005 if jerk == math.inf else 1.15)


def test_over_a_spin_island_the_rover_stops_and_turns_its_wheels():
    rover = sw.Rover.six_wheel(
        front_to_middle=0.3,
        middle_to_rear=0.3,
        track_width=0.8,
        middle_track_width=0.9,
        wheel_radius=0.15,
        steering_limit=math.radians(60),
    )
    assert 0 < rover.spin_radius < rover.min_radius
    limits = {"steering_rate": 1.0, "acceleration": 0.5, "angular_acceleration": 1.0}
    plan = profiles.icr_transition(rover, (0.4, 0, 0.1), (0, 0, 0.5), **limits)
    assert plan.stops == 1
    assert [phase.action for phase in plan.phases] == ["stop", "align", "drive"]
    assert "'front_left'" in plan.phases[0].reason.replace('"', "'")
    assert "1 stop" in repr(plan)
    stop, align, drive = plan.phases
    assert stop.duration == pytest.approx(0.4 / 0.5)
    assert drive.duration == pytest.approx(0.5 / 1.0)
    assert_kept(rover, plan, limits)
    np.testing.assert_array_equal(plan.at(align.start + align.duration / 2).twist, 0.0)
    np.testing.assert_array_equal(plan.at(stop.duration / 2).steering, plan.at(0.0).steering)
    assert profiles.icr_transition(rover, (0.4, 0, 0.1), (0.4, 0, -0.1), **limits).stops == 0


HALF_TURN = sw.Rover.swerve(CORNERS, 0.1, steering_limit=2.5)


def test_what_passes_close_to_a_pivot_passes_right_over_it():
    # A straight path of the centre a millimetre from a pivot would have its module turn by half a turn.
    start, end = (0.5, -0.4, 1.0), (0.1, -0.399, 1.0)
    limits = {"steering_rate": 1.0, "acceleration": 1.0}
    plan = profiles.icr_transition(HALF_TURN, start, end, **limits)
    assert_kept(HALF_TURN, plan, limits)
    assert plan.stops == 0
    assert [phase.action for phase in plan.phases] == ["drive", "align", "drive"]
    assert "module_0" in plan.phases[0].reason
    assert plan.phases[1].duration == pytest.approx(math.atan2(0.001, 0.2))
    np.testing.assert_allclose(plan.at(plan.phases[1].start).twist, (0.3, -0.4, 1.0), atol=2e-3)


@pytest.mark.parametrize("gap", [3e-3, 1e-5, 2e-6, 5e-7, 1e-9, 1e-15, 0.0])
def test_however_close_to_a_pivot(gap):
    # A module that may turn all the way round could follow; from a millionth of the way on it need not.
    rover, limits = ROVERS["turning swerve"], {"steering_rate": 1.0, "steering_acceleration": 3.0}
    for sign in (1, -1):
        plan = profiles.icr_transition(
            rover, (0.5, -0.4 + sign * gap, 1.0), (0.1, -0.4 + sign * gap, 1.0), **limits
        )
        assert plan.stops == 0
        assert_kept(rover, plan, limits)


def test_a_swerve_goes_round_what_is_in_the_way():
    # From one side to the other a module would have to turn by more than its range; over the top it need not.
    rng = np.random.default_rng(3)
    rover, detours = ROVERS["swerve"], 0
    for _ in range(150):
        start, end = rng.normal(size=(2, 3))
        plan = profiles.icr_transition(rover, start, end, steering_rate=1.0, acceleration=1.0)
        if any("around" in phase.reason for phase in plan.phases):
            detours += 1
            assert plan.stops == 0
            assert_kept(rover, plan, {"steering_rate": 1.0, "acceleration": 1.0})
    assert detours > 0


def test_right_through_a_pivot_the_wheel_only_rolls_back():
    plan = profiles.icr_transition(
        HALF_TURN, (0.5, -0.4, 1.0), (0.1, -0.4, 1.0), steering_rate=1.0, acceleration=1.0
    )
    state = plan.at(np.linspace(0, plan.duration, 101))
    assert plan.stops == 0
    np.testing.assert_allclose(state.steering[:, 0], 0.0, atol=1e-15)
    assert state.wheel_speeds[0, 0] > 0 > state.wheel_speeds[-1, 0]


def test_a_pivot_under_the_centre_turns_before_its_wheel_rolls():
    rover = ROVERS["swerve"]
    wheel = rover.wheels[0]
    about = np.array([wheel.y, -wheel.x, 1.0])
    limits = {"steering_rate": 1.0, "acceleration": 1.0}
    plan = profiles.icr_transition(rover, about, about + np.array((0.1, 0.1, 0.0)), **limits)
    assert [phase.action for phase in plan.phases] == ["align", "drive"]
    assert plan.phases[0].duration == pytest.approx(math.pi / 4)
    np.testing.assert_array_equal(plan.at(plan.phases[0].duration / 2).twist, about)
    assert_kept(rover, plan, limits)
