"""Driving a table through the controller: step by step, within limits, to rest, whatever the chunks."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.simulation.drive import (
    DriveLoop,
    drive,
)
from tests.simulation.drive.closed_loops import (
    LIMITS,
    RATE,
    ROVER,
    ROVERS,
    columns,
    read,
    wild,
    write,
)
from tests.strategies import at_most

ROUNDING = 1e-9  # relative: a difference of values with 1e-16 over a step of 1/200 s, and room


def joints(result: dict[str, np.ndarray], rover: sw.Rover) -> tuple[np.ndarray, np.ndarray]:
    """Steering angles and wheel speeds in the order of the rover's wheels."""
    turns = {wheel: joint for joint, wheel in rover.steering_joints.items()}
    drives = {wheel: joint for joint, wheel in rover.traction_joints.items()}
    steering = [result[turns[wheel]] for wheel in rover.steered_wheel_names]
    speeds = [result[drives[wheel]] for wheel in rover.wheel_names]
    rows = len(result["reasons"])
    return np.array(steering).reshape(-1, rows).T, np.array(speeds).T


# --- many steps in one call ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROVERS)
def test_a_run_is_the_steps_one_by_one(name: str) -> None:
    rover = ROVERS[name]
    stamps, twists = wild(1, 200, sideways=name == "swerve")
    times = np.arange(1, int(stamps[-1] * RATE) + 30) / RATE
    twists[50:53] = [[np.nan, 0, 0], [np.inf, 0, 0], [0, 0, 0]]
    stamps[[60, 61]] = stamps[[61, 60]]  # out of order
    run, steps = (sw.Controller(rover, LIMITS, period=1 / RATE) for _ in range(2))
    cut = 300
    given_before = int(np.argmax(stamps > times[cut - 1]))
    parts = [
        run.run(twists[:given_before], stamps[:given_before], times[:cut]),
        run.run(twists[given_before:], stamps[given_before:], times[cut:]),
    ]
    waiting = list(zip(stamps, twists, strict=True))
    for k, now in enumerate(times):
        while waiting and waiting[0][0] <= now:
            stamp, twist = waiting.pop(0)
            steps.command(twist, stamp)
        one, part, row = steps.step(now), parts[k >= cut], k - cut * (k >= cut)
        for field in ("steering", "steering_rates", "wheel_speeds", "twist"):
            np.testing.assert_array_equal(getattr(part, field)[row], getattr(one, field))
        assert part.reasons[row] == one.reasons
    assert [len(part) for part in parts] == [cut, len(times) - cut]
    seen = np.bitwise_or.reduce(np.concatenate([part.reasons for part in parts]))
    assert sw.Reason.NOT_FINITE & int(seen)
    assert sw.Reason.OUT_OF_ORDER & int(seen)


@pytest.mark.parametrize(
    ("stamps", "twists", "times", "words"),
    [
        ([0.0], [[1, 0, 0]], [0.0, 0.0], r"step_stamps\[1\] must be later than the step before, at 0"),
        ([0.0], [[1, 0, 0]], [0.0, np.nan], r"step_stamps\[1\] must be finite"),
        ([2.0], [[1, 0, 0]], [0.0, 1.0], r"stamps\[0\] must not be later than the last step, at 1"),
        ([np.inf], [[1, 0, 0]], [0.0, 1.0], r"stamps\[0\] must be finite"),
        ([0.0], [[1, 0, 0]], [], r"stamps\[0\] must be none without a step"),
        ([0.0, 0.1], [[1, 0, 0]], [1.0], r"twists must have shape \(2, 3\)"),
        ([0.0], [[1, 0, 0]], [-1.0, 1.0], r"step_stamps\[0\] must be later than the step before"),
    ],
)
def test_a_run_that_fails_changes_nothing(stamps: Any, twists: Any, times: Any, words: str) -> None:
    failed, other = (sw.Controller(ROVER, LIMITS, period=0.02) for _ in range(2))
    for each in (failed, other):
        each.command((0.5, 0.0, 0.2), -0.5)
        each.step(-0.5)
    with pytest.raises(ValueError, match=words):
        failed.run(twists, stamps, times)
    assert failed.stamp == other.stamp
    np.testing.assert_array_equal(failed.step(-0.45).wheel_speeds, other.step(-0.45).wheel_speeds)


# --- laws ------------------------------------------------------------------------------------------------


@at_most(12)
@given(
    name=st.sampled_from(list(ROVERS)), seed=st.integers(0, 10**6), rate=st.sampled_from([20.0, 60.0, 200.0])
)
def test_no_limit_is_exceeded_and_the_rover_ends_at_rest(
    tmp_path_factory: pytest.TempPathFactory, name: str, seed: int, rate: float
) -> None:
    rover, folder = ROVERS[name], tmp_path_factory.mktemp("laws")
    time, twists = wild(seed, 120, sideways=name == "swerve")
    output = folder / "run.parquet"
    summary = drive(rover, write(folder / "c.parquet", time, twists), output, loop=DriveLoop(LIMITS, rate))
    result = read(output)
    steering, speeds = joints(result, rover)
    driven, limited = columns(result), columns(result, "limited_")
    steps = np.diff(result["time"])
    np.testing.assert_allclose(steps, 1 / rate, rtol=1e-9)

    def within(values: np.ndarray, limit: float) -> None:
        assert np.abs(values).max(initial=0.0) <= limit * (1 + ROUNDING)

    within(np.hypot(limited[:, 0], limited[:, 1]), LIMITS.speed)
    within(limited[:, 2], LIMITS.yaw_rate)
    within(np.hypot(*np.diff(limited[:, :2], axis=0).T) * rate, LIMITS.acceleration)
    within(np.diff(limited[:, 2]) * rate, LIMITS.angular_acceleration)
    within(speeds, LIMITS.wheel_speed)
    within(np.diff(speeds, axis=0) * rate, LIMITS.wheel_acceleration)
    within(np.diff(steering, axis=0) * rate, LIMITS.steering_rate)
    within(np.diff(steering, 2, axis=0) * rate**2, LIMITS.steering_acceleration)
    np.testing.assert_allclose(driven, limited, atol=1e-12)  # the wheels show what was decided
    assert not speeds[-1].any()
    # Reasons are complete: where there is none, the latest command is done.
    free = result["reasons"] == 0
    np.testing.assert_array_equal(limited[free], columns(result, "commanded_")[free])
    assert summary.rows == len(free)
    for reason in sw.Reason:
        count = int(np.count_nonzero(result["reasons"] & reason.value))
        assert summary.reasons.get(str(reason.name), 0) == count


def test_what_is_within_the_limits_passes_through(tmp_path: Path) -> None:
    time = np.arange(0, 6, 0.02)
    twists = np.zeros((len(time), 3))
    twists[:, 0] = 0.1 * np.minimum(time, 4.0)  # 0.1 m/s^2, where 0.5 are allowed
    wide = sw.Limits(speed=1.0, acceleration=0.5, wheel_speed=10.0, steering_rate=1.0)
    output = tmp_path / "run.csv"
    summary = drive(ROVER, write(tmp_path / "c.csv", time, twists), output, loop=DriveLoop(wide, RATE))
    result = read(output)
    rows = slice(0, len(time))
    np.testing.assert_array_equal(columns(result, "limited_")[rows], twists)
    np.testing.assert_array_equal(columns(result, "commanded_")[rows], twists)
    assert not result["reasons"][rows].any()
    assert set(summary.reasons) == {"STALE", "DECELERATION"}  # the stop at the end
    assert set(result["reason_names"]) == {"", "STALE", "DECELERATION|STALE"}


def test_it_is_the_controllers_loop(tmp_path: Path) -> None:
    time, twists = wild(5, 100)
    output = tmp_path / "run.parquet"
    drive(
        ROVER,
        write(tmp_path / "c.parquet", time, twists),
        output,
        loop=DriveLoop(LIMITS, RATE, {"timeout": 0.25}),
    )
    result = read(output)
    steering, speeds = joints(result, ROVER)
    controller = sw.Controller(ROVER, LIMITS, period=1 / RATE, timeout=0.25)
    waiting = list(zip(time - time[0], twists, strict=True))
    for k in range(len(speeds)):
        while waiting and waiting[0][0] <= k / RATE:
            stamp, twist = waiting.pop(0)
            controller.command(twist, stamp)
        out = controller.step(k / RATE)
        np.testing.assert_array_equal(steering[k], out.steering)
        np.testing.assert_array_equal(speeds[k], out.wheel_speeds)
        np.testing.assert_array_equal(columns(result, "limited_")[k], out.twist)
        np.testing.assert_array_equal(columns(result, "commanded_")[k], twist)
        assert result["reasons"][k] == out.reasons
        assert result["reason_names"][k] == "|".join(str(each.name) for each in out.reasons)
    assert not waiting
    assert controller.stopped


@pytest.mark.parametrize("chunk_rows", [1, 7, 100])
def test_chunks_change_nothing(tmp_path: Path, chunk_rows: int) -> None:
    time, twists = wild(8, 90)
    commands = write(tmp_path / "c.parquet", time, twists)
    one, parts = tmp_path / "one.parquet", tmp_path / "parts.parquet"
    whole = drive(ROVER, commands, one, loop=DriveLoop(LIMITS, RATE))
    cut = drive(ROVER, commands, parts, loop=DriveLoop(LIMITS, RATE), chunk_rows=chunk_rows)
    first, second = read(one), read(parts)
    assert list(first) == list(second)
    for name in first:
        if first[name].dtype == float:
            np.testing.assert_allclose(second[name], first[name], atol=1e-12)
        else:
            np.testing.assert_array_equal(second[name], first[name])
    np.testing.assert_array_equal(joints(second, ROVER)[1], joints(first, ROVER)[1])
    assert (cut.reasons, cut.rows) == (whole.reasons, whole.rows)


# --- time ------------------------------------------------------------------------------------------------
