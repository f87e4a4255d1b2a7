"""Closed-loop drives from and to files."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.kinematics.errors import TableError
from six_wheel.simulation.drive import (
    ControlledDrive,
    DriveLoop,
    closed_loop,
    drive,
)
from six_wheel.simulation.drive.min_max_thinning import BINS, Course
from tests.simulation.drive.closed_loops import (
    LIMITS,
    RATE,
    ROVER,
    ROVERS,
    columns,
    pa,
    parquet,
    read,
    wild,
    write,
)


def test_nanoseconds_stay_whole(tmp_path: Path) -> None:
    begin = 1_700_000_000_000_000_001
    stamps = begin + 100_000_000 * np.arange(10)
    output = tmp_path / "run.csv"
    drive(
        ROVER,
        write(tmp_path / "c.csv", stamps, [[0.3, 0, 0]] * 10, "stamp_ns"),
        output,
        loop=DriveLoop(LIMITS, 60),
    )
    time = read(output)["time_ns"]
    np.testing.assert_array_equal(time, begin + np.rint(np.arange(len(time)) * 1e9 / 60).astype(np.int64))


@pytest.mark.parametrize("begin", [0.0, 1_700_000_000.25])
def test_a_command_at_loop_rate_is_that_of_its_step(tmp_path: Path, begin: float) -> None:
    # Seconds since 1970 as doubles are good to 2e-7 s: they must not make a command a step late.
    count = 500
    twists = np.column_stack([np.linspace(0, 0.5, count), np.zeros(count), np.zeros(count)])
    commands = write(tmp_path / "c.parquet", begin + np.arange(count) / 60, twists)
    drive(ROVER, commands, tmp_path / "run.parquet", loop=DriveLoop(LIMITS, 60))
    given = columns(read(tmp_path / "run.parquet"), "commanded_")
    np.testing.assert_array_equal(given[:count], twists)


def test_commands_faster_than_the_loop(tmp_path: Path) -> None:
    time, twists = np.arange(2000) / 1000, np.zeros((2000, 3))
    twists[:, 0] = np.arange(2000) / 4000
    drive(
        ROVER,
        write(tmp_path / "c.parquet", time, twists),
        tmp_path / "run.parquet",
        loop=DriveLoop(LIMITS, 20),
    )
    given = columns(read(tmp_path / "run.parquet"), "commanded_")
    np.testing.assert_array_equal(given[:40, 0], twists[::50, 0])
    assert (given[40:, 0] == twists[-1, 0]).all()


def test_one_row_is_driven_until_the_timeout_and_to_rest(tmp_path: Path) -> None:
    commands, output = write(tmp_path / "c.csv", [5.0], [[1, 0, 0]]), tmp_path / "run.csv"
    summary = drive(ROVER, commands, output, loop=DriveLoop(LIMITS, RATE, {"timeout": 1.0}))
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
    assert drive(ROVER, commands, tmp_path / "run.csv", loop=DriveLoop(LIMITS, RATE)).rows == 1


def test_without_a_timeout_the_stop_begins_with_the_next_step(tmp_path: Path) -> None:
    commands, output = write(tmp_path / "c.csv", [0.0, 2.0], [[0.4, 0, 0]] * 2), tmp_path / "run.csv"
    drive(ROVER, commands, output, loop=DriveLoop(LIMITS, RATE, {"timeout": None}))
    result = read(output)
    np.testing.assert_array_equal(result["commanded_vx"], np.where(result["time"] > 2.0, 0.0, 0.4))
    assert not (result["reasons"] & sw.Reason.STALE.value).any()
    assert result["limited_vx"][-1] == 0.0


def test_over_a_long_gap_the_rover_stands(tmp_path: Path) -> None:
    commands, output = write(tmp_path / "c.csv", [0.0, 3600.0], [[0.4, 0, 0]] * 2), tmp_path / "run.parquet"
    summary = drive(ROVER, commands, output, loop=DriveLoop(LIMITS, RATE), chunk_rows=1000)
    result = read(output)
    waiting = (result["time"] > 5.0) & (result["time"] < 3600.0)
    assert not result["limited_vx"][waiting].any()
    assert (result["reasons"][waiting] == sw.Reason.STALE.value).all()
    assert summary.rows > 180_000


@pytest.mark.parametrize("time", [[0.0, 1e6], [0.0, 1e300]])
def test_a_gap_that_no_drive_has_names_its_row(tmp_path: Path, time: list[float]) -> None:
    commands = write(tmp_path / "c.csv", time, [[0.4, 0, 0]] * 2)
    with pytest.raises(TableError, match=r"row 2 \(line 3\): time must be less than 200000 s"):
        drive(ROVER, commands, tmp_path / "run.csv", loop=DriveLoop(LIMITS, RATE))
    assert list(tmp_path.iterdir()) == [commands]


def test_a_gap_longer_than_integers_count_names_its_row(tmp_path: Path) -> None:
    time = np.array([-(2**62), 2**63 - 1])
    commands = write(tmp_path / "c.parquet", time, [[0.4, 0, 0]] * 2, "time_ns")
    with pytest.raises(TableError, match="row 2: time must be less than 200000 s"):
        drive(ROVER, commands, loop=DriveLoop(LIMITS, RATE))


def test_a_stop_that_takes_for_ever_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(closed_loop, "MOST_STEPS", 1000)
    slow = sw.Limits(acceleration=1.0, deceleration=1e-6)
    commands = write(tmp_path / "c.csv", [0.0, 1.0], [[0.4, 0, 0]] * 2)
    with pytest.raises(TableError, match=r"row 2 \(line 3\): the rover must stop within 1,000 steps"):
        drive(ROVER, commands, tmp_path / "run.csv", loop=DriveLoop(slow, RATE))


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
        drive(ROVER, commands, tmp_path / "run.csv", loop=DriveLoop(LIMITS, rate))
    assert list(tmp_path.iterdir()) == [commands]


def test_slow_loops_need_longer_steps(tmp_path: Path) -> None:
    commands = write(tmp_path / "c.csv", [0.0, 1.0], [[0.5, 0, 0]] * 2)
    summary = drive(ROVER, commands, loop=DriveLoop(LIMITS, 2.0, {"max_step": 0.5}))
    assert summary.rate == 2.0
    assert drive(ROVER, commands, loop=DriveLoop(LIMITS, None, {"period": 0.05})).rate == pytest.approx(20)
    assert drive(ROVER, commands, loop=DriveLoop(LIMITS)).rate == 50


def test_keep_projects_before_the_controller(tmp_path: Path) -> None:
    time, twists = np.arange(0, 2, 0.1), np.tile([0.3, 0.2, 0.1], (20, 1))
    output = tmp_path / "run.csv"
    commands = write(tmp_path / "c.csv", time, twists)
    summary = drive(ROVER, commands, output, loop=DriveLoop(LIMITS, RATE), keep="nearest")
    assert summary.projected_rows == 20
    assert "PROJECTED" not in summary.reasons
    wanted = ROVER.project(twists[0], keep="nearest")
    np.testing.assert_allclose(
        columns(read(output), "commanded_"), np.broadcast_to(wanted, (summary.rows, 3))
    )
    assert "PROJECTED" in drive(ROVER, commands, loop=DriveLoop(LIMITS, RATE)).reasons


# --- outputs ---------------------------------------------------------------------------------------------


def test_parquet_knows_the_bits_of_the_reasons(tmp_path: Path) -> None:
    output = tmp_path / "run.parquet"
    drive(ROVER, write(tmp_path / "c.csv", *wild(2, 30)), output, loop=DriveLoop(LIMITS, RATE))
    schema = parquet.read_schema(output)
    bits = dict(pair.split("=") for pair in schema.field("reasons").metadata[b"bits"].decode().split())
    assert {name: int(bit) for name, bit in bits.items()} == {each.name: each.value for each in sw.Reason}
    assert schema.field("reasons").type == pa.uint32()
    assert schema.field("limited_omega").metadata[b"unit"] == b"rad/s"


def test_what_is_written_can_be_driven_again(tmp_path: Path) -> None:
    first, second = tmp_path / "run.csv", tmp_path / "again.csv"
    drive(ROVER, write(tmp_path / "c.csv", *wild(3, 40)), first, loop=DriveLoop(LIMITS, RATE))
    drive(ROVER, first, second)  # directly
    np.testing.assert_allclose(columns(read(second)), columns(read(first), "limited_"), atol=1e-9)


def picture(path: Path) -> Callable[[ControlledDrive], None]:
    plot = pytest.importorskip("six_wheel.plotting")
    return lambda engine: plot.save(plot.engine_figure(engine, title=path.stem), path)


@pytest.mark.parametrize("name", ROVERS)
def test_the_picture_is_drawn(tmp_path: Path, name: str) -> None:
    commands = write(tmp_path / "c.csv", *wild(4, 60, sideways=name == "swerve"))
    drive(ROVERS[name], commands, loop=DriveLoop(LIMITS, RATE), finish=picture(tmp_path / "run.svg"))
    text = (tmp_path / "run.svg").read_text()
    assert text.count("<path") > 50


def test_the_picture_of_one_row_and_of_no_limits(tmp_path: Path) -> None:
    commands = write(tmp_path / "c.csv", [0.0], [[0, 0, 0]])
    drive(ROVER, commands, loop=DriveLoop(), finish=picture(tmp_path / "run.png"))
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
