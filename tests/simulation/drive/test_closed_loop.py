"""Driving a table through the controller: step by step, within limits, to rest, whatever the chunks."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import six_wheel as sw

pa = pytest.importorskip("pyarrow")
csv = pytest.importorskip("pyarrow.csv")
parquet = pytest.importorskip("pyarrow.parquet")

from six_wheel.logs.columns import TableError  # noqa: E402
from six_wheel.simulation.drive import (  # noqa: E402
    ControlledDrive,
    Loop,
    closed_loop,
    drive,
)
from six_wheel.simulation.drive.min_max_thinning import BINS, Course  # noqa: E402
from tests.rovers import CART as DIFFERENTIAL  # noqa: E402
from tests.rovers import SIX_SIZES  # noqa: E402

ROUNDING = 1e-9  # relative: a difference of values with 1e-16 over a step of 1/200 s, and room
RATE = 50.0

ROVER = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.0)
SWERVE = sw.Rover.swerve([(0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)], 0.08)
ROVERS = {"six_wheel": ROVER, "swerve": SWERVE, "differential": DIFFERENTIAL}
LIMITS = sw.Limits(
    speed=0.8,
    yaw_rate=0.6,
    acceleration=0.5,
    jerk=2.0,
    angular_acceleration=1.0,
    wheel_speed=6.0,
    wheel_acceleration=12.0,
    steering_rate=1.0,
    steering_acceleration=5.0,
)


def write(path: Path, time: Any, twists: Any, name: str = "time") -> Path:
    columns = dict(zip(("vx", "vy", "omega"), np.asarray(twists, dtype=float).T, strict=True))
    table = pa.table({name: time, **columns})
    csv.write_csv(table, path) if path.suffix == ".csv" else parquet.write_table(table, path)
    return path


def read(path: Path) -> dict[str, np.ndarray]:
    table = csv.read_csv(path) if path.suffix == ".csv" else parquet.read_table(path)
    return {name: table[name].to_numpy(zero_copy_only=False) for name in table.column_names}


def columns(result: dict[str, np.ndarray], prefix: str = "") -> np.ndarray:
    return np.column_stack([result[f"{prefix}{axis}"] for axis in ("vx", "vy", "omega")])


def joints(result: dict[str, np.ndarray], rover: sw.Rover) -> tuple[np.ndarray, np.ndarray]:
    """Steering angles and wheel speeds in the order of the rover's wheels."""
    turns = {wheel: joint for joint, wheel in rover.steering_joints.items()}
    drives = {wheel: joint for joint, wheel in rover.traction_joints.items()}
    steering = [result[turns[wheel]] for wheel in rover.steered_wheel_names]
    speeds = [result[drives[wheel]] for wheel in rover.wheel_names]
    rows = len(result["reasons"])
    return np.array(steering).reshape(-1, rows).T, np.array(speeds).T


def wild(seed: int, count: int, every: float = 0.1, sideways: bool = False) -> tuple[Any, np.ndarray]:
    """Commands beyond all limits, each held for a while, at uneven times."""
    random = np.random.default_rng(seed)
    twists = np.repeat(random.uniform(-1.2, 1.2, (count // 8 + 1, 3)), 8, axis=0)[:count]
    twists[:, 1] *= sideways
    twists[random.random(count) < 0.05] = 0.0
    return np.cumsum(random.uniform(0.2, 1.8, count) * every), twists


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
        ([0.0], [[1, 0, 0]], [0.0, 0.0], r"times\[1\] must be later than the step before, at 0"),
        ([0.0], [[1, 0, 0]], [0.0, np.nan], r"times\[1\] must be finite"),
        ([2.0], [[1, 0, 0]], [0.0, 1.0], r"stamps\[0\] must not be later than the last step, at 1"),
        ([np.inf], [[1, 0, 0]], [0.0, 1.0], r"stamps\[0\] must be finite"),
        ([0.0], [[1, 0, 0]], [], r"stamps\[0\] must be none without a step"),
        ([0.0, 0.1], [[1, 0, 0]], [1.0], r"twists must have shape \(2, 3\)"),
        ([0.0], [[1, 0, 0]], [-1.0, 1.0], r"times\[0\] must be later than the step before"),
    ],
)
def test_a_run_that_fails_changes_nothing(stamps: Any, twists: Any, times: Any, words: str) -> None:
    failed, other = (sw.Controller(ROVER, LIMITS, period=0.02) for _ in range(2))
    for each in (failed, other):
        each.command((0.5, 0.0, 0.2), -0.5)
        each.step(-0.5)
    with pytest.raises(ValueError, match=words):
        failed.run(twists, stamps, times)
    assert failed.now == other.now
    np.testing.assert_array_equal(failed.step(-0.45).wheel_speeds, other.step(-0.45).wheel_speeds)


# --- laws ------------------------------------------------------------------------------------------------


@settings(max_examples=12)
@given(
    name=st.sampled_from(list(ROVERS)), seed=st.integers(0, 10**6), rate=st.sampled_from([20.0, 60.0, 200.0])
)
def test_no_limit_is_exceeded_and_the_rover_ends_at_rest(
    tmp_path_factory: pytest.TempPathFactory, name: str, seed: int, rate: float
) -> None:
    rover, folder = ROVERS[name], tmp_path_factory.mktemp("laws")
    time, twists = wild(seed, 120, sideways=name == "swerve")
    output = folder / "run.parquet"
    summary = drive(rover, write(folder / "c.parquet", time, twists), output, loop=Loop(LIMITS, rate))
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
    np.testing.assert_allclose(driven, limited, atol=1e-12)  # what the wheels say is what was decided
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
    summary = drive(ROVER, write(tmp_path / "c.csv", time, twists), output, loop=Loop(wide, RATE))
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
        ROVER, write(tmp_path / "c.parquet", time, twists), output, loop=Loop(LIMITS, RATE, {"timeout": 0.25})
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
    whole = drive(ROVER, commands, one, loop=Loop(LIMITS, RATE))
    cut = drive(ROVER, commands, parts, loop=Loop(LIMITS, RATE), chunk_rows=chunk_rows)
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


def test_nanoseconds_stay_whole(tmp_path: Path) -> None:
    begin = 1_700_000_000_000_000_001
    stamps = begin + 100_000_000 * np.arange(10)
    output = tmp_path / "run.csv"
    drive(
        ROVER,
        write(tmp_path / "c.csv", stamps, [[0.3, 0, 0]] * 10, "stamp_ns"),
        output,
        loop=Loop(LIMITS, 60),
    )
    time = read(output)["time_ns"]
    np.testing.assert_array_equal(time, begin + np.rint(np.arange(len(time)) * 1e9 / 60).astype(np.int64))


@pytest.mark.parametrize("begin", [0.0, 1_700_000_000.25])
def test_a_command_at_loop_rate_is_that_of_its_step(tmp_path: Path, begin: float) -> None:
    # Seconds since 1970 as doubles are good to 2e-7 s: they must not make a command a step late.
    count = 500
    twists = np.column_stack([np.linspace(0, 0.5, count), np.zeros(count), np.zeros(count)])
    commands = write(tmp_path / "c.parquet", begin + np.arange(count) / 60, twists)
    drive(ROVER, commands, tmp_path / "run.parquet", loop=Loop(LIMITS, 60))
    given = columns(read(tmp_path / "run.parquet"), "commanded_")
    np.testing.assert_array_equal(given[:count], twists)


def test_commands_faster_than_the_loop(tmp_path: Path) -> None:
    time, twists = np.arange(2000) / 1000, np.zeros((2000, 3))
    twists[:, 0] = np.arange(2000) / 4000
    drive(ROVER, write(tmp_path / "c.parquet", time, twists), tmp_path / "run.parquet", loop=Loop(LIMITS, 20))
    given = columns(read(tmp_path / "run.parquet"), "commanded_")
    np.testing.assert_array_equal(given[:40, 0], twists[::50, 0])
    assert (given[40:, 0] == twists[-1, 0]).all()


def test_one_row_is_driven_until_the_timeout_and_to_rest(tmp_path: Path) -> None:
    commands, output = write(tmp_path / "c.csv", [5.0], [[1, 0, 0]]), tmp_path / "run.csv"
    summary = drive(ROVER, commands, output, loop=Loop(LIMITS, RATE, {"timeout": 1.0}))
    result = read(output)
    assert result["time"][0] == 5.0
    assert result["time"][-1] > 6.0
    assert 0.1 < summary.path_length < 1.0
    stale = (result["reasons"] & sw.Reason.STALE.value) > 0
    np.testing.assert_array_equal(stale[:-1], result["time"][:-1] > 6.0)
    assert result["vx"][-1] == 0.0
    assert result["vx"][-2] > 0.0


def test_one_row_of_rest_is_one_row(tmp_path: Path) -> None:
    commands = write(tmp_path / "c.csv", [5.0], [[0, 0, 0]])
    assert drive(ROVER, commands, tmp_path / "run.csv", loop=Loop(LIMITS, RATE)).rows == 1


def test_without_a_timeout_the_stop_begins_with_the_next_step(tmp_path: Path) -> None:
    commands, output = write(tmp_path / "c.csv", [0.0, 2.0], [[0.4, 0, 0]] * 2), tmp_path / "run.csv"
    drive(ROVER, commands, output, loop=Loop(LIMITS, RATE, {"timeout": None}))
    result = read(output)
    np.testing.assert_array_equal(result["commanded_vx"], np.where(result["time"] > 2.0, 0.0, 0.4))
    assert not (result["reasons"] & sw.Reason.STALE.value).any()
    assert result["limited_vx"][-1] == 0.0


def test_over_a_long_gap_the_rover_stands(tmp_path: Path) -> None:
    commands, output = write(tmp_path / "c.csv", [0.0, 3600.0], [[0.4, 0, 0]] * 2), tmp_path / "run.parquet"
    summary = drive(ROVER, commands, output, loop=Loop(LIMITS, RATE), chunk_rows=1000)
    result = read(output)
    waiting = (result["time"] > 5.0) & (result["time"] < 3600.0)
    assert not result["limited_vx"][waiting].any()
    assert (result["reasons"][waiting] == sw.Reason.STALE.value).all()
    assert summary.rows > 180_000


@pytest.mark.parametrize("time", [[0.0, 1e6], [0.0, 1e300]])
def test_a_gap_that_no_drive_has_names_its_row(tmp_path: Path, time: list[float]) -> None:
    commands = write(tmp_path / "c.csv", time, [[0.4, 0, 0]] * 2)
    with pytest.raises(TableError, match=r"row 2 \(line 3\): time must be less than 200000 s"):
        drive(ROVER, commands, tmp_path / "run.csv", loop=Loop(LIMITS, RATE))
    assert list(tmp_path.iterdir()) == [commands]


def test_a_gap_longer_than_integers_count_names_its_row(tmp_path: Path) -> None:
    time = np.array([-(2**62), 2**63 - 1])
    commands = write(tmp_path / "c.parquet", time, [[0.4, 0, 0]] * 2, "time_ns")
    with pytest.raises(TableError, match="row 2: time must be less than 200000 s"):
        drive(ROVER, commands, loop=Loop(LIMITS, RATE))


def test_a_stop_that_takes_for_ever_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(closed_loop, "MOST_STEPS", 1000)
    slow = sw.Limits(acceleration=1.0, deceleration=1e-6)
    commands = write(tmp_path / "c.csv", [0.0, 1.0], [[0.4, 0, 0]] * 2)
    with pytest.raises(TableError, match=r"row 2 \(line 3\): the rover must stop within 1,000 steps"):
        drive(ROVER, commands, tmp_path / "run.csv", loop=Loop(slow, RATE))


# --- abuse -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rate", "words"),
    [
        (0.0, "rate must be finite and positive, got 0"),
        (-50.0, "rate must be finite and positive, got -50"),
        (np.nan, "rate must be finite and positive, got nan"),
        (np.inf, "rate must be finite and positive, got inf"),
        (5.0, r"rate must be at least 10 Hz: a step counts for at most max_step=0.1 s, got 5"),
        (1e9, "rate must be at most 100000 Hz"),
    ],
)
def test_bad_rates(tmp_path: Path, rate: float, words: str) -> None:
    commands = write(tmp_path / "c.csv", [0.0], [[1, 0, 0]])
    with pytest.raises(ValueError, match=words):
        drive(ROVER, commands, tmp_path / "run.csv", loop=Loop(LIMITS, rate))
    assert list(tmp_path.iterdir()) == [commands]


def test_slow_loops_need_longer_steps(tmp_path: Path) -> None:
    commands = write(tmp_path / "c.csv", [0.0, 1.0], [[0.5, 0, 0]] * 2)
    summary = drive(ROVER, commands, loop=Loop(LIMITS, 2.0, {"max_step": 0.5}))
    assert summary.rate == 2.0
    assert drive(ROVER, commands, loop=Loop(LIMITS, None, {"period": 0.05})).rate == pytest.approx(20)
    assert drive(ROVER, commands, loop=Loop(LIMITS)).rate == 50


def test_keep_projects_before_the_controller(tmp_path: Path) -> None:
    time, twists = np.arange(0, 2, 0.1), np.tile([0.3, 0.2, 0.1], (20, 1))
    output = tmp_path / "run.csv"
    commands = write(tmp_path / "c.csv", time, twists)
    summary = drive(ROVER, commands, output, loop=Loop(LIMITS, RATE), keep="nearest")
    assert summary.projected_rows == 20
    assert "PROJECTED" not in summary.reasons
    wanted = ROVER.project(twists[0], keep="nearest")
    np.testing.assert_allclose(
        columns(read(output), "commanded_"), np.broadcast_to(wanted, (summary.rows, 3))
    )
    assert "PROJECTED" in drive(ROVER, commands, loop=Loop(LIMITS, RATE)).reasons


# --- outputs ---------------------------------------------------------------------------------------------


def test_parquet_knows_the_bits_of_the_reasons(tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    drive(ROVER, write(tmp_path / "c.csv", *wild(2, 30)), output, loop=Loop(LIMITS, RATE))
    schema = parquet.read_schema(output)
    bits = dict(pair.split("=") for pair in schema.field("reasons").metadata[b"bits"].decode().split())
    assert {name: int(bit) for name, bit in bits.items()} == {each.name: each.value for each in sw.Reason}
    assert schema.field("reasons").type == pa.uint32()
    assert schema.field("limited_omega").metadata[b"unit"] == b"rad/s"


def test_what_is_written_can_be_driven_again(tmp_path: Path) -> None:
    first, second = tmp_path / "run.csv", tmp_path / "again.csv"
    drive(ROVER, write(tmp_path / "c.csv", *wild(3, 40)), first, loop=Loop(LIMITS, RATE))
    drive(ROVER, first, second)  # directly
    np.testing.assert_allclose(columns(read(second)), columns(read(first), "limited_"), atol=1e-9)


def picture(path: Path) -> Callable[[ControlledDrive], None]:
    plot = pytest.importorskip("six_wheel.plotting")
    return lambda engine: plot.save(plot.engine_figure(engine, title=path.stem), path)


@pytest.mark.parametrize("name", ROVERS)
def test_the_picture_is_drawn(tmp_path: Path, name: str) -> None:
    commands = write(tmp_path / "c.csv", *wild(4, 60, sideways=name == "swerve"))
    drive(ROVERS[name], commands, loop=Loop(LIMITS, RATE), finish=picture(tmp_path / "run.svg"))
    text = (tmp_path / "run.svg").read_text()
    assert text.count("<path") > 50


def test_the_picture_of_one_row_and_of_no_limits(tmp_path: Path) -> None:
    commands = write(tmp_path / "c.csv", [0.0], [[0, 0, 0]])
    drive(ROVER, commands, loop=Loop(), finish=picture(tmp_path / "run.png"))
    assert (tmp_path / "run.png").stat().st_size > 10_000


@given(sizes=st.lists(st.integers(1, 9000), min_size=1, max_size=6), seed=st.integers(0, 99))
def test_the_course_stays_small_and_loses_no_peak(sizes: list[int], seed: int) -> None:
    random = np.random.default_rng(seed)
    rows = sum(sizes)
    times, values = np.arange(rows) / 10, random.normal(size=(rows, 2))
    bits = (random.random(rows) < 0.001).astype(np.uint32) * 4
    course, begin = Course(2), 0
    for size in sizes:
        part = slice(begin, begin + size)
        course.add(times[part], values[part], bits[part])
        begin += size
    starts, low, high, found = course.stretches()
    assert len(starts) <= 2 * BINS + 1
    places = np.searchsorted(times, starts)
    np.testing.assert_array_equal(times[places], starts)
    np.testing.assert_array_equal(np.minimum.reduceat(values, places), low)
    np.testing.assert_array_equal(np.maximum.reduceat(values, places), high)
    np.testing.assert_array_equal(np.bitwise_or.reduceat(bits, places), found)
