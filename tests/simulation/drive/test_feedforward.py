"""Driving a table: the same as the library call by call, whatever the chunks, and in bounded memory."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw

pa = pytest.importorskip("pyarrow")
csv = pytest.importorskip("pyarrow.csv")
parquet = pytest.importorskip("pyarrow.parquet")

from six_wheel.logs import replacing  # noqa: E402
from six_wheel.logs import tables as logs  # noqa: E402
from six_wheel.logs.frames.thinning import TRACE_ROWS, Trace  # noqa: E402
from six_wheel.simulation.drive import Drive, drive  # noqa: E402
from tests.rovers import SIX_SIZES  # noqa: E402
from tests.rovers import SIX_WHEELS as ROVER  # noqa: E402

ROUNDING = 1e-12  # [m, rad] of a few hundred steps of about a metre

LIMITED = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=np.pi / 3)
SWERVE = sw.Rover(
    [
        sw.Wheel(name, x, y, radius=0.1, steered=True, steering_limit=3.5)
        for name, x, y in (("a", 0.5, 0.3), ("b", 0.5, -0.3), ("c", -0.5, 0.0))
    ]
)
DIFFERENTIAL = sw.Rover([sw.Wheel("left", 0, 0.2, radius=0.1), sw.Wheel("right", 0, -0.2, radius=0.1)])


def write(path: Path, time: Any, twists: Any, name: str = "time") -> Path:
    columns = dict(zip(("vx", "vy", "omega"), np.asarray(twists, dtype=float).T, strict=True))
    table = pa.table({name: time, **columns})
    if path.suffix == ".csv":
        csv.write_csv(table, path)
    else:
        parquet.write_table(table, path)
    return path


def read(path: Path) -> dict[str, np.ndarray]:
    table = csv.read_csv(path) if path.suffix == ".csv" else parquet.read_table(path)
    return {name: table[name].to_numpy() for name in table.column_names}


def winding(n: int, step: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    """A path with straights, turns, spins and rests."""
    time = step * np.arange(n)
    twists = np.zeros((n, 3))
    twists[:, 0] = 0.5 * (np.sin(time) > -0.5)
    twists[:, 2] = 0.4 * np.sin(1.7 * time) * (np.cos(0.6 * time) > -0.7)
    return time, twists


def by_hand(rover: sw.Rover, time: np.ndarray, twists: np.ndarray) -> tuple[np.ndarray, ...]:
    """Steering angles, wheel speeds and poses, row by row."""
    previous = np.zeros(len(rover.steered_wheel_names))
    pose = np.zeros(3)
    rows = []
    for k, twist in enumerate(twists):
        steering, speeds = rover.inverse(twist, previous=previous)
        rows.append((steering, speeds, pose))
        if k + 1 < len(time):
            pose = sw.integrate([rover.forward(steering, speeds)], time[k + 1] - time[k], pose)[1]
        previous = steering
    return tuple(np.array(column) for column in zip(*rows, strict=True))


@pytest.mark.parametrize("rover", [ROVER, SWERVE, DIFFERENTIAL], ids=["six_wheel", "swerve", "differential"])
@pytest.mark.parametrize("chunk_rows", [1, 7, 1000])
@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_a_table_is_driven_as_the_library_drives_its_rows(
    tmp_path: Path, rover: sw.Rover, chunk_rows: int, ending: str
) -> None:
    time, twists = winding(100)
    commands, output = write(tmp_path / f"c{ending}", time, twists), tmp_path / f"run{ending}"
    drive(rover, commands, output, chunk_rows=chunk_rows)
    result = read(output)
    steering, speeds, poses = by_hand(rover, time, twists)
    np.testing.assert_array_equal(result["time"], time)
    for joint, wheel in rover.steering_joints.items():
        np.testing.assert_array_equal(result[joint], steering[:, rover.steered_wheel_names.index(wheel)])
    for joint, wheel in rover.traction_joints.items():
        np.testing.assert_allclose(result[joint], speeds[:, rover.wheel_names.index(wheel)], rtol=1e-14)
    np.testing.assert_allclose(np.column_stack([result[n] for n in ("x", "y", "yaw")]), poses, atol=ROUNDING)
    driven = np.column_stack([result[n] for n in ("vx", "vy", "omega")])
    np.testing.assert_allclose(driven, twists, atol=ROUNDING)
    for wheel in rover.wheel_names:
        assert result[f"residual_{wheel}"].max() < ROUNDING


def test_a_wheel_at_rest_keeps_its_angle(tmp_path: Path) -> None:
    twists = [[0.5, 0, 0.3], [0, 0, 0], [0, 0, 0], [0.5, 0, 0], [0, 0, 0]]
    output = tmp_path / "run.csv"
    for chunk_rows in (1, 2, 5):
        drive(ROVER, write(tmp_path / "c.csv", np.arange(5), twists), output, chunk_rows=chunk_rows)
        angle = read(output)["front_left_steering_joint"]
        turning = np.arctan2(0.3 * 0.5, 0.5 - 0.3 * 0.4)
        np.testing.assert_allclose(angle, [turning, turning, turning, 0, 0], rtol=1e-15)


def test_a_quarter_circle_and_a_straight(tmp_path: Path) -> None:
    # Radius 2 m at 1 m/s: pi seconds to (2, 2) facing +y; then 3 m along y. The last command never ends.
    time, twists = [10.0, 10.0 + np.pi, 13.0 + np.pi], [[1, 0, 0.5], [1, 0, 0], [1, 0, 0.5]]
    summary = drive(ROVER, write(tmp_path / "c.csv", time, twists))
    np.testing.assert_allclose(summary.end_pose, [2, 5, np.pi / 2], atol=ROUNDING)
    assert summary.path_length == pytest.approx(np.pi + 3, abs=ROUNDING)
    assert summary.duration == pytest.approx(np.pi + 3, abs=ROUNDING)
    assert summary.rows == 3
    assert (summary.steering_angle.name, summary.steering_angle.row) == ("front_left", 1)
    assert summary.steering_angle.value == pytest.approx(np.arctan2(0.5, 2 - 0.4))
    assert summary.steering_rate.value == pytest.approx(np.arctan2(0.5, 1.6) / 3)  # from row 2 to row 3
    assert (summary.steering_rate.name, summary.steering_rate.row) == ("front_left", 3)
    assert summary.wheel_speed.name == "front_right"
    assert summary.wheel_speed.value == pytest.approx(np.hypot(2.4, 0.5) * 0.5 / 0.15)


def test_one_row_is_a_drive_of_no_length(tmp_path: Path) -> None:
    summary = drive(ROVER, write(tmp_path / "c.csv", [5.0], [[1, 0, 0]]), tmp_path / "run.csv")
    assert (summary.rows, summary.duration, summary.path_length) == (1, 0, 0)
    assert summary.steering_rate.row == 0
    assert read(tmp_path / "run.csv")["x"] == [0]


def test_joints_come_in_the_users_order(tmp_path: Path) -> None:
    wheels = ROVER.wheels
    names = {f"drive_{k}": wheel.name for k, wheel in enumerate(reversed(wheels))}
    turns = {f"turn_{k}": wheel.name for k, wheel in enumerate(reversed([w for w in wheels if w.steered]))}
    rover = sw.Rover(list(wheels), traction_joints=names, steering_joints=turns)
    drive(rover, write(tmp_path / "c.csv", *winding(5)), tmp_path / "run.csv")
    assert list(read(tmp_path / "run.csv")) == [
        *("time", *turns, *names, "x", "y", "yaw", "vx", "vy", "omega"),
        *(f"residual_{wheel.name}" for wheel in wheels),
    ]


def test_joints_named_like_another_column_also_say_what_is_commanded(tmp_path: Path) -> None:
    joints = dict(zip(["x", "y", "yaw", "vx", "vy", "omega"], ROVER.wheel_names, strict=True))
    rover = sw.Rover(list(ROVER.wheels), traction_joints=joints)
    drive(rover, write(tmp_path / "c.csv", *winding(5)), tmp_path / "run.csv")
    columns = list(read(tmp_path / "run.csv"))
    assert columns[1] == "front_left_steering_joint/position"
    assert columns[5] == "x/velocity"
    assert len(set(columns)) == len(columns)


def test_parquet_knows_the_units(tmp_path: Path) -> None:
    drive(ROVER, write(tmp_path / "c.csv", *winding(5)), tmp_path / "run.parquet")
    units = {f.name: f.metadata[b"unit"].decode() for f in parquet.read_schema(tmp_path / "run.parquet")}
    assert units["front_left_steering_joint"] == units["yaw"] == "rad"
    assert units["front_left_wheel_joint"] == units["omega"] == "rad/s"
    assert (units["time"], units["x"], units["residual_rear_left"]) == ("s", "m", "m/s")


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_nanoseconds_are_driven_exactly_and_come_out_as_they_were(tmp_path: Path, ending: str) -> None:
    stamps = 1_700_000_000_000_000_001 + np.arange(0, 1000, 10)  # steps of 10 ns: less than a double can tell
    commands = write(tmp_path / f"c{ending}", stamps, [[1, 0, 0]] * 100, "stamp_ns")
    summary = drive(ROVER, commands, tmp_path / f"run{ending}", chunk_rows=30)
    assert summary.end_pose[0] == pytest.approx(990e-9, rel=1e-9)
    np.testing.assert_array_equal(read(tmp_path / f"run{ending}")["time_ns"], stamps)


def test_what_is_written_can_be_driven_again(tmp_path: Path) -> None:
    first, second = tmp_path / "run.csv", tmp_path / "again.parquet"
    drive(ROVER, write(tmp_path / "c.csv", *winding(50)), first)
    drive(ROVER, first, second)
    one, two = read(first), read(second)
    for name in one:
        np.testing.assert_allclose(two[name], one[name], atol=ROUNDING)


@given(cuts=st.integers(1, 60))
def test_chunks_change_nothing(tmp_path_factory: pytest.TempPathFactory, cuts: int) -> None:
    folder = tmp_path_factory.mktemp("cuts")
    commands = write(folder / "c.parquet", *winding(60))
    whole, parts = drive(ROVER, commands), drive(ROVER, commands, chunk_rows=cuts)
    np.testing.assert_allclose(parts.end_pose, whole.end_pose, atol=ROUNDING)
    assert parts.path_length == pytest.approx(whole.path_length, abs=ROUNDING)
    for name in ("steering_angle", "steering_rate", "wheel_speed"):
        assert getattr(parts, name).row == getattr(whole, name).row
        assert getattr(parts, name).value == pytest.approx(getattr(whole, name).value)


# --- what a rover cannot do ------------------------------------------------------------------------------


@pytest.mark.parametrize("chunk_rows", [1, 10, 1000])
def test_a_twist_that_cannot_be_driven_names_its_row(tmp_path: Path, chunk_rows: int) -> None:
    time, twists = winding(40)
    twists[[16, 30]] = [0.5, 0.2, 0.0]
    commands = write(tmp_path / "c.csv", time, twists)
    with pytest.raises(logs.TableError, match=r"row 17 \(line 18\): .*--keep curvature") as caught:
        drive(ROVER, commands, tmp_path / "run.csv", chunk_rows=chunk_rows)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == [commands]


@pytest.mark.parametrize("keep", ["curvature", "speed", "yaw_rate", "nearest"])
def test_keep_projects_and_counts(tmp_path: Path, keep: Any) -> None:
    time, twists = winding(40)
    twists[[3, 20]] = [[0.5, 0.2, 0.0], [0.5, -0.05, 0.1]]
    summary = drive(
        ROVER, write(tmp_path / "c.csv", time, twists), tmp_path / "run.csv", keep=keep, chunk_rows=9
    )
    projected = ROVER.project(twists, keep=keep)
    assert summary.projected_rows == 2
    np.testing.assert_allclose(summary.changed, np.abs(projected - twists).max(axis=0), atol=1e-15)
    result = read(tmp_path / "run.csv")
    driven = np.column_stack([result[n] for n in ("vx", "vy", "omega")])
    np.testing.assert_allclose(driven, projected, atol=ROUNDING)


def test_what_cannot_be_kept_names_its_row(tmp_path: Path) -> None:
    twists = [
        [0.5, 0, 0],
        [0, 0, 0],
        [0, 0, 0.3],
    ]  # this rover cannot spin about a centre 0.2 m away, nor at 0
    limited = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=0.3)
    with pytest.raises(logs.TableError, match=r"row 3 \(line 4\): ") as caught:
        drive(limited, write(tmp_path / "c.csv", [0, 1, 2], twists))
    assert "--keep" in str(caught.value)
    assert drive(limited, tmp_path / "c.csv", keep="nearest").projected_rows == 1


def test_a_pose_beyond_all_numbers_names_its_row(tmp_path: Path) -> None:
    with pytest.raises(logs.TableError, match=r"row 3 \(line 4\): twists must keep the pose finite"):
        drive(ROVER, write(tmp_path / "c.csv", [0, 1, 1e300], [[1e100, 0, 0]] * 3))


def test_arguments_are_checked(tmp_path: Path) -> None:
    commands = write(tmp_path / "c.csv", *winding(5))
    with pytest.raises(ValueError, match=r'keep must be one of curvature, .*, got "pace"'):
        drive(ROVER, commands, keep="pace")
    with pytest.raises(ValueError, match="chunk_rows must be positive, got 0"):
        drive(ROVER, commands, chunk_rows=0)
    with pytest.raises(ValueError, match=r'must be \.csv, \.parquet or \.mcap, got "\.txt"'):
        drive(ROVER, commands, tmp_path / "run.txt")


# --- files -----------------------------------------------------------------------------------------------


def test_an_output_is_replaced_only_by_success(tmp_path: Path) -> None:
    output = tmp_path / "run.csv"
    output.write_text("precious")
    good, bad = tmp_path / "good.csv", tmp_path / "bad.csv"
    write(good, *winding(50))
    bad.write_text(good.read_text().replace("\n", "\n", 1) + "5.0,1,0\n")
    with pytest.raises(logs.TableError):
        drive(ROVER, bad, output, chunk_rows=5)
    assert output.read_text() == "precious"

    def interrupt(done: int, size: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        drive(ROVER, good, output, progress=interrupt)
    assert output.read_text() == "precious"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.csv", "good.csv", "run.csv"]
    drive(ROVER, good, output)
    assert output.read_text().startswith("time,front_left_steering_joint,")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.csv", "good.csv", "run.csv"]


def test_outputs_never_are_inputs(tmp_path: Path) -> None:
    commands = write(tmp_path / "c.csv", *winding(5))
    before = commands.read_bytes()
    (tmp_path / "same.csv").hardlink_to(commands)
    (tmp_path / "link.csv").symlink_to(commands)
    for name in ("c.csv", "same.csv", "link.csv"):
        with pytest.raises(logs.TableError, match="the output must be another file than"):
            drive(ROVER, commands, tmp_path / name)
    with pytest.raises(logs.TableError, match=r'one of .png, .svg, .pdf, got ".csv"'):
        pytest.importorskip("six_wheel.plotting").picture_path(tmp_path / "c.csv")
    with pytest.raises(logs.TableError, match="another file"):
        drive(ROVER, commands, tmp_path / "rover.csv", sources=[tmp_path / "rover.csv"])
    assert commands.read_bytes() == before


def test_replacing_says_why_it_cannot(tmp_path: Path) -> None:
    with pytest.raises(logs.TableError, match="the folder of the output must exist"):
        replacing(tmp_path / "none" / "run.csv").__enter__()
    (tmp_path / "folder").mkdir()
    with pytest.raises(logs.TableError, match="the output must be a file"):
        replacing(tmp_path / "folder").__enter__()


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "run.csv").symlink_to(tmp_path / "data" / "real.csv")
    with replacing(tmp_path / "run.csv") as temporary:
        temporary.write_text("new")
    assert (tmp_path / "run.csv").is_symlink()
    assert (tmp_path / "data" / "real.csv").read_text() == "new"


def test_the_picture_is_drawn(tmp_path: Path) -> None:
    plot, path = pytest.importorskip("six_wheel.plotting"), tmp_path / "run.png"
    commands = write(tmp_path / "c.csv", *winding(50))
    drive(ROVER, commands, finish=lambda engine: plot.save(plot.engine_figure(engine, title="c"), path))
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


# --- size ------------------------------------------------------------------------------------------------


@given(sizes=st.lists(st.integers(1, 30_000), min_size=1, max_size=6))
def test_the_trace_stays_small_and_keeps_the_ends(sizes: list[int]) -> None:
    trace, seen = Trace(), 0
    for size in sizes:
        rows = np.arange(seen, seen + size, dtype=float)[:, None]
        trace.add(np.repeat(rows, 3, axis=1), rows)
        seen += size
    poses, steering = trace.path()
    assert len(poses) <= TRACE_ROWS + 1
    assert len(poses) > min(seen - 1, TRACE_ROWS // 4)
    assert poses[0, 0] == 0
    assert poses[-1, 0] == seen - 1
    np.testing.assert_array_equal(poses[:, :1], steering)
    assert len(np.unique(np.diff(poses[:-1, 0]))) <= 1  # evenly spread


PEAK_MEMORY = """
import re, sys
import six_wheel as sw
from pathlib import Path
from six_wheel.simulation.drive import drive
commands, ending = Path(sys.argv[1]), sys.argv[2]
rover = sw.Rover.six_wheel(
    front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, middle_track_width=0.9, wheel_radius=0.15
)
summary = drive(rover, commands, commands.with_name("run" + ending), chunk_rows=20_000)
print(summary.rows, re.search("VmHWM:\\\\s*(\\\\d+) kB", Path("/proc/self/status").read_text())[1])
"""


@pytest.mark.slow
# Not ru_maxrss: a new process inherits that from the one that starts it, here all of pytest.
@pytest.mark.skipif(
    not Path("/proc/self/status").exists(), reason="Linux says there what a process took at most"
)
@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_memory_does_not_grow_with_the_table(tmp_path: Path, ending: str) -> None:
    peaks = []
    for rows in (60_000, 600_000):
        time, twists = winding(rows, 0.01)
        commands = write(tmp_path / f"c{ending}", time, twists)
        arguments = [sys.executable, "-c", PEAK_MEMORY, str(commands), ending]
        done, peak = subprocess.run(arguments, check=True, capture_output=True, text=True).stdout.split()
        assert int(done) == rows
        peaks.append(1024 * int(peak))
    # Ten times the rows are 90 MB more of joints and poses alone. Arrow keeps some freed pages for later.
    assert peaks[1] - peaks[0] < 45e6


def test_drive_can_be_used_chunk_by_chunk(tmp_path: Path) -> None:
    time, twists = winding(30)
    with logs.CommandTable(write(tmp_path / "c.csv", time, twists)) as table:
        engine = Drive(LIMITED, table.time_unit, keep="nearest")
        rows = [engine.advance(chunk) for chunk in table.chunks(10)]
    assert [len(columns) for columns in rows] == [len(engine.units)] * 3
    assert engine.summary.rows == 30
