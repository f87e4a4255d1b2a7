"""Joint logs: the columns of tables, units, encoders, truth."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw

pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

from six_wheel._core import Encoder  # noqa: E402
from six_wheel.logs import (  # noqa: E402
    JointLog,
    JointRows,
    optiodom,
    read_truth,
)
from six_wheel.logs.headers.columns import TableError  # noqa: E402
from six_wheel.logs.headers.joint_columns import joint_columns  # noqa: E402
from six_wheel.logs.plausibility.jumps import find_jumps  # noqa: E402
from six_wheel.simulation.drive import drive  # noqa: E402
from tests import optiodom_data  # noqa: E402
from tests.logs.carts import write  # noqa: E402
from tests.rovers import CART  # noqa: E402
from tests.rovers import SIX_WHEELS as ROVER  # noqa: E402


def rows_of(path: Path, rover: sw.Rover = CART, chunk_rows: int = 1000, **options) -> JointRows:
    """The whole log, put together again."""
    with JointLog(path, rover, **options) as log:
        parts = list(log.chunks(chunk_rows))
        assert log.position == log.size
    joined = [
        None if getattr(parts[0], name) is None else np.concatenate([getattr(part, name) for part in parts])
        for name in ("rows", "stamps", "steering", "wheel_angles", "truth")
    ]
    return JointRows(*joined)


# --- columns ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("header", "reading", "symbol"),
    [
        ("left [rad]", "angles", "rad"),
        ("left_wheel [deg]", "angles", "deg"),
        ("left_wheel_joint/position", "angles", "rad"),
        ("/joint_states/left_wheel_joint/position", "angles", "rad"),
        ("Left_Angle_deg", "angles", "deg"),
        ("left (rev)", "angles", "rev"),
        ("left_wheel_joint/velocity", "speeds", "rad/s"),
        ("left speed", "speeds", "rad/s"),
        ("left_rpm", "speeds", "rpm"),
        ("left_speed [deg/s]", "speeds", "deg/s"),
        ("left_rev_s", "speeds", "rev/s"),
        ("left [ticks]", "ticks", "ticks"),
        ("left_encoder", "ticks", "ticks"),
        ("left_wheel_joint_counts", "ticks", "ticks"),
    ],
)
def test_a_header_names_a_joint_and_what_is_read(header: str, reading: str, symbol: str) -> None:
    found = joint_columns(["t", header, "battery [V]", "left [V]", "left_effort"], CART)
    column = found.columns["wheel left"]
    assert (column.index, column.unit.symbol, found.readings) == (1, symbol, reading)
    assert found.silent == ("right",)


def test_every_joint_of_a_rover_is_found_in_any_order() -> None:
    joints = {f"{joint}/position": f"steering {wheel}" for joint, wheel in ROVER.steering_joints.items()}
    joints |= {f"{joint}/velocity": f"wheel {wheel}" for joint, wheel in ROVER.traction_joints.items()}
    rates = [f"{joint}/velocity" for joint in ROVER.steering_joints]  # of no use, and no obstacle
    headers = ["stamp_ns", *reversed(joints), *rates]
    found = joint_columns(headers, ROVER)
    assert {headers[column.index]: name for name, column in found.columns.items() if name != "time"} == joints
    assert found.silent == ()


def test_of_several_readings_the_angle_is_taken_unless_told() -> None:
    headers = [
        "t",
        *(f"{side}_wheel_joint/{kind}" for side in ("left", "right") for kind in ("velocity", "position")),
    ]
    assert joint_columns(headers, CART).readings == "angles"
    assert joint_columns(headers, CART, "speeds").readings == "speeds"
    assert joint_columns(headers[:-1], CART).readings == "speeds"  # all wheels in one way


def test_the_joints_that_wheels_have_by_themselves_are_known_whatever_a_file_calls_them():
    wheels = sw.Rover.bicycle(1.0, 0.2, driven="all").wheels
    rover = sw.Rover(wheels, traction_joints={"m1": "front", "m2": "rear"}, steering_joints={"s": "front"})
    plain = ["time", "front_steering_joint [rad]", "front_wheel_joint [rad]", "rear_wheel_joint [rad]"]
    assert joint_columns(plain, rover).columns.keys() == {
        "time",
        "steering front",
        "wheel front",
        "wheel rear",
    }


@pytest.mark.parametrize(
    ("headers", "words"),
    [
        ("left [rad]", ["no column for time"]),
        ("time,a,b", ["no column for any wheel", '"left_wheel_joint", "right_wheel_joint"', '"a", "b"']),
        ("time,left,right", ['column "left" must state its unit', '"left [rad/s]"', "got none"]),
        (
            "time,left_temp [rad]",
            ['"left_temp [rad]" must say what it is by one of angle, count', 'got "temp"'],
        ),
        ("time,left [V]", ['column "left [V]" must state its unit', 'got "V"']),
        ("time,left [rad],left_position", ['wheel left must be in one column, got "left [rad]" and']),
        ("time,left [rad],right [rpm]", ["must be read in one way", '"right [rpm]" (speeds)']),
    ],
)
def test_columns_that_are_missing_or_open_are_named(tmp_path: Path, headers: str, words: list[str]) -> None:
    path = write(tmp_path / "log.csv", f"{headers}\n")
    with pytest.raises(TableError) as caught:
        JointLog(path, CART)
    for word in [str(path), *words]:
        assert word in str(caught.value)


def test_a_steered_wheel_needs_its_angle() -> None:
    headers = ["t", *(f"{wheel} [rad/s]" for wheel in ROVER.wheel_names), *list(ROVER.steering_joints)[1:]]
    with pytest.raises(TableError, match="the steering angle of front_left"):
        joint_columns(headers, ROVER)
    found = joint_columns([*headers, "front_left_steering_angle [deg]"], ROVER)
    assert found.columns["steering front_left"].unit.symbol == "deg"


def test_columns_may_be_renamed(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "clock,encL,encR\n0,1,2\n10,3,5\n")
    renamed = {"clock": "time_ms", "encL": "left [deg]", "encR": "right [deg]"}
    rows = rows_of(path, columns=renamed)
    np.testing.assert_allclose(rows.stamps, [0, 0.01], rtol=1e-15)
    np.testing.assert_allclose(np.degrees(rows.wheel_angles), [[1, 2], [3, 5]], rtol=1e-15)
    with pytest.raises(TableError, match='columns must name headers of the table, got "enc_l"'):
        JointLog(path, CART, columns={"enc_l": "left"})


# --- readings --------------------------------------------------------------------------------------------

STEPS = st.lists(st.integers(-30_000, 30_000), min_size=2, max_size=30)


@given(
    steps=STEPS, bits=st.sampled_from([16, 32]), offset=st.integers(0, 1 << 32), chunk_rows=st.integers(1, 40)
)
def test_counters_that_wrap_and_counts_per_row_are_the_same_angle(
    tmp_path_factory: pytest.TempPathFactory, steps: list[int], bits: int, offset: int, chunk_rows: int
) -> None:
    totals = np.cumsum([offset, *steps])
    wrapped = totals % (1 << bits)
    lines = [
        f"{k},{t},{w},{s}\n" for k, (t, w, s) in enumerate(zip(totals, wrapped, [0, *steps], strict=True))
    ]
    path = write(tmp_path_factory.mktemp("ticks") / "log.csv", "t,a,b,c\n" + "".join(lines))
    for column, encoder in {
        "a": Encoder(4000),
        "b": Encoder(4000, wraps_at=1 << bits),
        "c": Encoder(4000),
    }.items():
        options = {
            "columns": {column: "left [ticks]"},
            "wheel_encoders": encoder,
            "increments": column == "c",
        }
        rows = rows_of(path, chunk_rows=chunk_rows, **options)
        turned = rows.wheel_angles[:, 0] - rows.wheel_angles[0, 0]
        # Ticks are whole and exact; one rounding in the scale, one in the product.
        np.testing.assert_allclose(turned, (totals - offset) * 2 * np.pi / 4000, rtol=1e-15, atol=1e-15)
        assert np.isnan(rows.wheel_angles[:, 1]).all()


@pytest.mark.parametrize(
    ("steps", "offset"),
    [([0] * 17 + [8, -239], 0), ([0] * 17 + [250, -5], 0), ([0] * 22 + [22, -231], 250)],
)
def test_a_wheel_that_starts_or_halts_is_no_counter_that_starts_over(steps: list[int], offset: int) -> None:
    # A total of a few rows at rest and two others was taken for one that wraps at 256, or was set anew.
    assert find_jumps(np.cumsum([offset, *steps]).astype(float), whole=True) is None


@pytest.mark.parametrize("bits", [8, 12, 16, 24, 32])
@pytest.mark.parametrize("low", [0.0, 0.5, 0.3])
@pytest.mark.parametrize("share", [1 / 12, 1 / 100, 1 / 3000])
def test_counters_that_start_over_are_found(bits: int, low: float, share: float) -> None:
    # From 0, from half their range below it, and shifted by software, over and over.
    size, rows = float(1 << bits), np.arange(500)
    rates = np.maximum(share * size, 2.0) * np.sin(np.minimum(rows / 8.0, 1.0)) * (1.0 + 0.1 * np.cos(rows))
    totals = np.floor(0.9 * size + np.cumsum(rates))
    below = np.floor(low * size)
    readings = (totals + below) % size - below
    jumps = np.count_nonzero(np.abs(np.diff(readings)) > size / 2.0)
    found = find_jumps(readings, whole=True)
    if jumps > (low == 0.3):
        assert found is not None
        assert (found.wraps_at, len(found.rows)) == (size, jumps)


def test_encoders_per_wheel_and_backwards(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "t,left [ticks],right [ticks]\n0,0,0\n1,100,-100\n")
    encoders = {"left": Encoder(100), "right": Encoder(25, gear_ratio=-2)}
    rows = rows_of(path, wheel_encoders=encoders)
    np.testing.assert_allclose(rows.wheel_angles[1], [2 * np.pi, 4 * np.pi])
    with pytest.raises(ValueError, match="wheel_encoders must say how many ticks a turn of right has"):
        JointLog(path, CART, wheel_encoders={"left": Encoder(100)})
    for bad in ({"ticks_per_turn": 0}, {"wraps_at": -1}, {"gear_ratio": 0}, {"offset": math.inf}):
        with pytest.raises(ValueError, match=f"{next(iter(bad))} must be finite"):
            Encoder(**bad)
    rates = write(tmp_path / "rates.csv", "t,left [rpm]\n0,0\n1,1\n")
    with pytest.raises(ValueError, match="must be left out where wheels are read as speeds"):
        JointLog(rates, CART, wheel_encoders=Encoder(100))


@given(
    angles=st.lists(st.floats(-1.5, 1.5), min_size=1, max_size=20),
    offset=st.floats(-3, 3),
    chunk_rows=st.integers(1, 30),
)
def test_absolute_steering_encoders(
    tmp_path_factory: pytest.TempPathFactory, angles: list[float], offset: float, chunk_rows: int
) -> None:
    # Whole counts of a 12 bit encoder that starts over anywhere, and a joint that stays within its range.
    bicycle = sw.Rover.bicycle(1.0, 0.3)
    wheel = bicycle.steered_wheel_names[0]
    counts = np.round((np.array(angles) - offset) * 4096 / (2 * np.pi)) % 4096
    lines = [f"{k},{count:.0f},0\n" for k, count in enumerate(counts)]
    header = f"t,{wheel}_steering [ticks],rear [rad]\n"
    path = write(tmp_path_factory.mktemp("steer") / "log.csv", header + "".join(lines))
    with pytest.raises(ValueError, match="steering_encoders must say"):
        JointLog(path, bicycle)
    encoder = Encoder(4096, wraps_at=4096, offset=offset)
    rows = rows_of(path, bicycle, chunk_rows, steering_encoders={wheel: encoder})
    np.testing.assert_allclose(rows.steering[:, 0], angles, rtol=0, atol=0.5001 * 2 * np.pi / 4096)


@pytest.mark.parametrize("chunk_rows", [1, 3, 1000])
def test_rates_add_up_to_angles(tmp_path: Path, chunk_rows: int) -> None:
    # The trapezium rule is exact for a rate that grows evenly, whatever the steps.
    stamps = np.cumsum([0.1, 0.3, 0.2, 0.5, 0.1])
    path = write(tmp_path / "log.csv", "t,left [rpm]\n" + "".join(f"{t},{60 * t}\n" for t in stamps))
    rows = rows_of(path, chunk_rows=chunk_rows)
    expected = np.pi * (stamps**2 - stamps[0] ** 2)
    np.testing.assert_allclose(rows.wheel_angles[:, 0], expected, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_stamps_of_nanoseconds_keep_their_digits(tmp_path: Path, ending: str) -> None:
    nanoseconds = 1_700_000_000_123_456_789 + 1_000_003 * np.arange(5)
    path = tmp_path / f"log{ending}"
    if ending == ".csv":
        write(path, "stamp_ns,left [rad]\n" + "".join(f"{n},0\n" for n in nanoseconds))
    else:
        parquet.write_table(pa.table({"stamp_ns": nanoseconds, "left [rad]": [0.0] * 5}), path)
    with JointLog(path, CART) as log:
        (rows,) = log.chunks()
        assert log.origin == 1_700_000_000
    np.testing.assert_array_equal(rows.stamps, (nanoseconds - 1_700_000_000 * 10**9) / 1e9)


def test_the_unit_of_a_parquet_field_counts(tmp_path: Path) -> None:
    commands = write(
        tmp_path / "c.csv", "time,vx,omega\n" + "".join(f"{k / 10},0.5,0.2\n" for k in range(50))
    )
    drive(ROVER, commands, tmp_path / "run.parquet")
    drive(ROVER, commands, tmp_path / "run.csv")
    rows = rows_of(tmp_path / "run.parquet", ROVER)
    steering, speeds = ROVER.inverse((0.5, 0, 0.2))
    np.testing.assert_allclose(rows.steering, np.tile(steering, (50, 1)), rtol=1e-15)
    np.testing.assert_allclose(rows.wheel_angles[-1], 4.9 * speeds, rtol=1e-13)  # 49 sums
    np.testing.assert_array_equal(rows.truth[0], 0)
    with pytest.raises(TableError, match="must state its unit"):
        JointLog(tmp_path / "run.csv", ROVER)
    again = rows_of(tmp_path / "run.csv", ROVER, readings="speeds")
    np.testing.assert_allclose(again.wheel_angles, rows.wheel_angles, rtol=1e-15)


# --- truth -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "header",
    [
        "x,y,yaw",
        "x [m],y [m],heading [rad]",
        "truth_x,truth_y,truth_theta",
        "pose.position.x,pose.position.y,yaw",
    ],
)
def test_truth_beside_the_joints_may_be_rarer(tmp_path: Path, header: str) -> None:
    lines = [f"{k},{k},{k}," + (f"{k},{2 * k},{k / 10}\n" if k % 2 == 0 else ",,\n") for k in range(6)]
    path = write(tmp_path / "log.csv", f"time,left [rad],right [rad],{header}\n" + "".join(lines))
    with JointLog(path, CART) as joints:
        log = joints.read(session="monday")
        assert joints.findings.rows == 0
    assert (log.name, log.session, len(log)) == ("log", "monday", 6)
    np.testing.assert_array_equal(log.truth.stamps, [0, 2, 4])
    np.testing.assert_allclose(log.truth.poses, [[0, 0, 0], [2, 4, 0.2], [4, 8, 0.4]], rtol=1e-15)


@given(yaw=st.floats(-3.1, 3.1), roll=st.floats(-0.3, 0.3), length=st.floats(1e-3, 1e3))
def test_truth_of_its_own_with_quaternions(
    tmp_path_factory: pytest.TempPathFactory, yaw: float, roll: float, length: float
) -> None:
    folder = tmp_path_factory.mktemp("truth")
    # A roll about the body's own x axis does not change where that axis points.
    w, z, c, s = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(roll / 2), math.sin(roll / 2)
    q = length * np.array([w * s, z * s, z * c, w * c])
    start = 1_700_000_000
    write(folder / "log.csv", f"t,left [rad]\n{start}.5,0\n{start + 1}.5,1\n")
    lines = f"{start * 10**9},1000,2000," + ",".join(map(repr, q.tolist())) + "\n"
    lines += f"{start * 10**9 + 5},0,0,0,0,0,0\n{start * 10**9 + 10},1,2,nan,0,0,1\n" + lines.replace(
        str(start), str(start + 2), 1
    )
    header = "time_ns,x [mm],y [mm],orientation.x,orientation.y,orientation.z,orientation.w\n"
    write(folder / "truth.csv", header + lines)
    with JointLog(folder / "log.csv", CART) as joints:
        log = joints.read(truth=folder / "truth.csv")
        flaws = [str(finding) for finding in joints.truth_findings.listed]
    assert len(flaws) == 2
    assert "row 2 (line 3): the quaternion of a pose must not be zero" in flaws[1]
    assert log.stamps.tolist() == [0.5, 1.5]
    assert log.truth.stamps.tolist() == [0, 2]
    np.testing.assert_allclose(log.truth.poses[0], [1, 2, yaw], rtol=0, atol=1e-14)


def test_truth_that_is_none_is_named(tmp_path: Path) -> None:
    with pytest.raises(TableError, match="the truth must have columns x, y and yaw"):
        read_truth(write(tmp_path / "truth.csv", "t,x,yaw\n0,0,0\n"))
    _, poses, _ = read_truth(write(tmp_path / "truth.csv", "t,x,y\n0,1,2\n1,1,2\n"))
    np.testing.assert_array_equal(poses, [[1.0, 2.0, np.nan]] * 2)
    with pytest.raises(TableError, match="truth.csv: the truth must have at least two rows that can be used"):
        read_truth(write(tmp_path / "truth.csv", "t,x,y\n0,1,2\n"))
    with pytest.raises(TableError, match="at least one row that can be used"):
        read_truth(write(tmp_path / "truth.csv", "t,x,y,yaw\n0,0,0,nan\n"))


# --- a real recording ------------------------------------------------------------------------------------


@optiodom_data.REQUIRED
@pytest.mark.parametrize(
    ("robot", "header"),
    [
        ("diff", "time,x,y,heading,right [ticks],left [ticks]"),
        ("tricyc", "time,x,y,heading,front [ticks],front_steering [rad]"),
    ],
)
def test_named_columns_read_as_the_reader_of_the_format_does(tmp_path: Path, robot: str, header: str) -> None:
    path = optiodom.runs(optiodom_data.FOLDER / robot)[0]
    rover, expected = optiodom.read_rover(path), optiodom.read(path)
    named = write(tmp_path / "log.csv", header + "\n" + path.read_text())
    counts = {name: float(words[0]) for name, *words in map(str.split, metadata_of(path)) if words}
    ticks = counts["ngear"] * counts["encRes"]
    with JointLog(named, rover, wheel_encoders=Encoder(ticks), increments=True) as joint_log:
        log = joint_log.read()
        assert joint_log.findings.listed == []
    np.testing.assert_array_equal(log.stamps, expected.stamps)
    np.testing.assert_array_equal(log.truth.poses, expected.truth.poses)
    if robot == "tricyc":
        np.testing.assert_array_equal(log.steering, expected.steering)
    steps = expected.wheel_angles - expected.wheel_angles[0]
    np.testing.assert_allclose(log.wheel_angles, steps, rtol=0, atol=1e-9)  # [rad], of sums of thousands
    assert np.isnan(log.wheel_angles).sum() == (len(log) if robot == "tricyc" else 0)


def metadata_of(path: Path) -> list[str]:
    text = next(path.parent.glob("*_metadata.csv")).read_text()
    return [line.replace(",", " ") for line in text.splitlines() if line.startswith(("ngear", "encRes"))]
