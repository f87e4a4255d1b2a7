"""Laws of a drive whose command changes at every step: it starts, makes its way, and gives its reasons.

Before, a rover at rest stayed there for ever if each command differed from the one before, be it by 1e-8.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.kinematics.controller import Reason

SWERVE = [[0.3, 0.25], [0.3, -0.25], [-0.3, 0.25], [-0.3, -0.25]]
CAR = {"wheelbase": 0.6, "track_width": 0.4, "wheel_radius": 0.1}
VEHICLES = {
    "open_source_rover": sw.Rover.preset("open_source_rover"),
    "perseverance": sw.Rover.preset("perseverance"),
    "curiosity": sw.Rover.preset("curiosity"),
    "ackermann": sw.Rover.ackermann(**CAR, steering_limit=0.6),
    "tricycle": sw.Rover.tricycle(**CAR, steering_limit=1.2),
    "swerve": sw.Rover.swerve(SWERVE, wheel_radius=0.05),
}
LIMITS = {
    "rate": {"speed": 1.0, "acceleration": 0.5, "steering_rate": 1.0},
    "acceleration": {"speed": 1.0, "acceleration": 0.5, "steering_rate": 1.0, "steering_acceleration": 5.0},
    "jerk": {
        "speed": 1.0,
        "acceleration": 0.5,
        "jerk": 2.0,
        "steering_rate": 1.0,
        "steering_acceleration": 5.0,
    },
}
SECONDS = 10.0


def stream(kind: str, times: np.ndarray, seed: int) -> np.ndarray:
    """Commands of a new twist at every time, rows [vx, vy, omega]."""
    noise = np.random.default_rng(seed).uniform(-1.0, 1.0, times.size)
    zero = np.zeros(times.size)
    if kind.startswith("noise"):
        return np.stack([zero + 0.5, zero, 0.3 * (1.0 + float(kind[5:]) * noise)], axis=1)
    if kind == "ramp":
        return np.stack([zero + 0.5, zero, 0.3 * np.minimum(1.0, times / 3.0)], axis=1)
    if kind == "sweep":
        return np.stack([zero + 0.5, zero, 0.2 * np.sin(0.8 * times)], axis=1)
    if kind == "stick":
        speed = 0.5 * np.minimum(1.0, 0.1 + times / 2.0)
        return np.stack([speed, zero, 0.3 * speed * np.sin(2.0 * times)], axis=1)
    turned = 0.5 * times
    return np.stack([0.5 * np.cos(turned), -0.5 * np.sin(turned), zero + 0.5], axis=1)  # "field"


KINDS = ["noise1e-10", "noise1e-8", "noise1e-4", "noise0.01", "noise0.1", "ramp", "sweep", "stick"]


def earliest(rover: sw.Rover, limits: dict[str, float], twists: np.ndarray, times: np.ndarray) -> float:
    """First time [s] at which joints driven from 0 at their limits could be where the command of then is."""
    angles, _ = rover.inverse(twists, previous=np.zeros(len(rover.steered_wheel_names)))
    far = np.max(np.abs(angles), axis=1)
    rate, change = limits["steering_rate"], limits.get("steering_acceleration", math.inf)
    time = far / rate
    if change < math.inf:
        time = np.where(far > rate * rate / change, far / rate + rate / change, 2.0 * np.sqrt(far / change))
    return float(times[np.nonzero(time <= times)[0][0]])


def ideal(speeds: np.ndarray, times: np.ndarray, start: float, acceleration: float) -> float:
    """Way [m] of a body that stands until the start and then follows speeds at its acceleration."""
    way = speed = 0.0
    dt = times[1] - times[0]
    for wanted in speeds[times >= start]:
        speed += min(max(wanted - speed, -acceleration * dt), acceleration * dt)
        way += speed * dt
    return way


def check(vehicle: str, name: str, rate: float, kind: str, every: int, seed: int = 0) -> sw.ControllerRun:
    rover, limits = VEHICLES[vehicle], LIMITS[name]
    times = np.arange(round(SECONDS * rate)) / rate
    twists = stream(kind, times, seed)
    held = rover.project(twists[np.arange(times.size) // every * every])
    controller = sw.Controller(rover, sw.Limits(**limits), timeout=None)
    run = controller.run(twists[::every], times[::every], times)
    first = earliest(rover, limits, held, times)
    moving = np.max(np.abs(run.wheel_speeds), axis=1) > 0
    assert moving.any(), "it never starts"
    assert times[np.argmax(moving)] <= 1.1 * first + 0.25 + 3.0 / rate
    way = np.sum(np.hypot(run.twist[:, 0], run.twist[:, 1])) / rate
    wanted = ideal(np.hypot(held[:, 0], held[:, 1]), times, first, limits["acceleration"])
    assert way >= (0.8 if kind in ("noise0.1", "field") else 0.9) * wanted
    return run


@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.parametrize("vehicle", VEHICLES)
def test_a_rover_starts_and_makes_its_way(vehicle, name):
    kinds = [*KINDS, "field"] if vehicle == "swerve" else KINDS
    for kind in kinds:
        for rate, every in ((50.0, 1), (200.0, 1), (200.0, 4), (100.0, 10)):
            check(vehicle, name, rate, kind, every)


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_at_a_kilohertz(vehicle):
    for kind in ("noise1e-8", "noise0.01"):
        check(vehicle, "jerk", 1000.0, kind, 1)


@given(
    st.sampled_from(sorted(VEHICLES)),
    st.sampled_from(["cosine", "hold", None]),
    st.sampled_from([20.0, 50.0, 333.0]),
    st.floats(-1.0, 1.0),
    st.floats(1e-9, 0.1),
    st.integers(0, 2**32 - 1),
    st.floats(0.5, 6.0),
    st.one_of(st.just(math.inf), st.floats(2.0, 20.0)),
)
def test_no_rover_rests_longer_than_its_joints_take(
    vehicle, align, rate, yaw_rate, noise, seed, steering_rate, change
):
    rover = VEHICLES[vehicle]
    limits = {"acceleration": 0.5, "steering_rate": steering_rate, "steering_acceleration": change}
    controller = sw.Controller(rover, sw.Limits(**limits), timeout=None, align=align)
    times = np.arange(round(6.0 * rate)) / rate
    draws = np.random.default_rng(seed).uniform(-1.0, 1.0, times.size)
    twists = np.stack([0.5 + 0 * times, 0 * times, yaw_rate * (1.0 + noise * draws)], axis=1)
    projected = rover.project(twists)
    latest = 1.1 * earliest(rover, limits, projected, times) + 0.25 + 3.0 / rate
    measured = np.zeros(len(rover.steered_wheel_names))
    for now, twist in zip(times, twists, strict=True):
        controller.command(twist, now)
        out = controller.step(now, measured)
        measured = out.steering
        if np.any(out.twist):
            assert now <= latest
            return
    pytest.fail("it never starts")


@pytest.mark.parametrize("noise", [0.0, 1e-8, 0.01])
def test_wheels_with_trail_go_on_in_a_direction_that_is_nearly_right(noise):
    """They change direction at rest only, and stopped for every digit of a command."""
    rover = sw.Rover.tricycle(**CAR, steering_limit=1.2).replace("front", trail=0.03)
    controller = sw.Controller(rover, sw.Limits(acceleration=0.5, steering_rate=1.0), timeout=None)
    times = np.arange(0.0, 10.0, 0.01)
    draws = np.random.default_rng(0).uniform(-1.0, 1.0, times.size)
    twists = np.stack([0.5 + 0 * times, 0 * times, 0.3 * (1.0 + noise * draws)], axis=1)
    run = controller.run(twists, times, times)
    first = float(np.max(np.abs(rover.inverse((0.5, 0.0, 0.3))[0])))
    assert times[np.argmax(np.any(run.twist, axis=1))] <= 1.1 * first + 0.25 + 0.03
    assert np.sum(run.twist[:, 0]) * 0.01 > 0.9 * 0.5 * (10.0 - first - 0.5)
    if noise:
        assert run.reasons[-1] & Reason.ALIGNING


def test_a_goal_that_moves_slower_than_the_joints_is_met():
    """Steering asked for at 0.5 and 0.9 of the joints' rate, 0.3 rad ahead; faster ones have no promise."""
    rover = sw.Rover.ackermann(**CAR, steering_limit=1.5)
    for share in (0.5, 0.9):
        controller = sw.Controller(rover, sw.Limits(acceleration=0.5, steering_rate=0.2), timeout=None)
        times = np.arange(0.0, 10.0, 0.01)
        angle = np.minimum(0.3 + 0.2 * share * times, 1.2)  # of the middle of the front axle
        twists = np.stack([0.3 * np.cos(angle), 0 * times, 0.3 * np.sin(angle) / 0.6], axis=1)
        run = controller.run(twists, times, times)
        moving = np.nonzero(np.any(run.twist, axis=1))[0]
        assert moving.size
        assert times[moving[0]] <= 1.1 * 0.3 / (0.2 * (1 - share)) + 0.25 + 0.03


@pytest.mark.parametrize(("step", "stops"), [(0.29, False), (0.31, True)])
def test_goals_on_both_sides_of_what_counts_as_near(step, stops):
    """From rest a turn of a joint up to 0.3 rad is made in motion, a farther one before."""
    rover = sw.Rover.tricycle(**CAR, steering_limit=1.2)

    def twist(angle: float) -> tuple[float, float, float]:
        return 0.3 * math.cos(angle), 0.0, 0.3 * math.sin(angle) / 0.6

    controller = sw.Controller(rover, sw.Limits(steering_rate=1.0, acceleration=0.5), timeout=None)
    times = np.arange(0.0, 4.0, 0.01)
    controller.run([twist(0.2), (0.0, 0.0, 0.0)], [0.0, 2.0], times)
    assert controller.stopped
    assert controller.steering[0] == pytest.approx(0.2)
    controller.command(twist(0.2 + step), 4.0)
    first, second = controller.step(4.01), controller.step(4.02)
    assert bool(second.twist[0] == 0.0) == stops
    assert bool((first.reasons | second.reasons) & Reason.ALIGNING) is stops


def test_reasons_say_how_much_of_the_speed_is_left():
    rover = VEHICLES["open_source_rover"]
    controller = sw.Controller(rover, sw.Limits(speed=0.25, acceleration=1.0), timeout=None)
    controller.command((1.0, 0.0, 0.0), 0.0)
    out = [controller.step(0.01 * k) for k in range(100)][-1]
    assert out.reasons == Reason.SPEED
    assert out.speed_share == pytest.approx(0.25)
    controller.command((0.2, 0.0, 0.0), 1.0)
    assert controller.step(1.0).speed_share == 1.0


def test_a_spin_is_limited_where_only_linear_limits_are_given():
    """The example file gave `acceleration` alone, and a spin went from 0 to 0.6 rad/s in one step."""
    rover = VEHICLES["open_source_rover"]
    reach = max(math.hypot(wheel.x, wheel.y) for wheel in rover.wheels)
    controller = sw.Controller(rover, sw.Limits(acceleration=0.5), timeout=None)
    times = np.arange(0.0, 5.0, 0.02)
    run = controller.run([(0.0, 0.0, 0.6)], [0.0], times)
    change = np.max(np.abs(np.diff(run.twist[:, 2]))) / 0.02
    assert change == pytest.approx(0.5 / reach)
    assert np.max(np.abs(np.diff(run.wheel_speeds, axis=0))) / 0.02 * rover.wheels[0].radius <= 0.5 * (
        1 + 1e-9
    )
    assert run.twist[-1, 2] == 0.6
