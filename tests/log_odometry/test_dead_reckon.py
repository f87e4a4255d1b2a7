"""Whole logs: the numbers of one sample at a time, bad rows flagged, good ones kept, tables, slip, runs."""

import math
import os
import tracemalloc
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.kinematics.odometry import OdometryHealth
from six_wheel.log_odometry import dead_reckon_chunks, table_columns
from tests import optiodom_data as data
from tests.odometry_logs import VEHICLES, drive
from tests.strategies import at_most

SOAK = "SOAK" in os.environ
SIX = drive(VEHICLES["six_wheel"], n=60)


@pytest.mark.parametrize("name", VEHICLES)
@pytest.mark.parametrize("method", ["least_squares", "robust"])
def test_the_same_numbers_as_sample_by_sample(name, method):
    log = drive(VEHICLES[name], n=40)
    generator = np.random.default_rng(2)
    steering = log.steering + generator.normal(0, 0.01, log.steering.shape)
    angles = log.angles + generator.normal(0, 0.01, log.angles.shape)
    yaw = log.poses[:, 2] + generator.normal(0, 0.01, len(log.stamps))
    options = {"noise": sw.Noise(0.02, 0.01, slip=0.01, yaw=0.01), "method": method, "inflate": True}
    track = sw.dead_reckon(log.rover, steering, angles, log.stamps, yaw=yaw, **options)
    odometry = sw.Odometry(log.rover, **options)
    for k in range(len(log.stamps)):
        state = odometry.update(steering[k], angles[k], log.stamps[k], yaw=yaw[k])
        np.testing.assert_array_equal(track.poses[k], state.pose)
        np.testing.assert_array_equal(track.twists[k], state.twist)
        np.testing.assert_array_equal(track.covariances[k], state.covariance)
        np.testing.assert_array_equal(track.residuals[k], state.residuals)
        assert track.health[k] == state.health
        if method == "robust":
            np.testing.assert_array_equal(track.weights[k], state.weights)
    for one in ("pose", "twist", "covariance", "residual"):
        assert not hasattr(track, one)
    assert len(track) == len(log.stamps)


@pytest.mark.parametrize("cut", [0, 1, 17, 60, 121])
def test_a_log_goes_on_where_it_was_cut(cut):
    whole = sw.dead_reckon(SIX.rover, SIX.steering, SIX.angles, SIX.stamps)
    odometry = sw.Odometry(SIX.rover)
    parts = [
        odometry.run(SIX.steering[rows], SIX.angles[rows], SIX.stamps[rows])
        for rows in (slice(None, cut), slice(cut, None))
    ]
    for column in ("poses", "twists", "covariances", "residuals", "health"):
        joined = np.concatenate([getattr(part, column) for part in parts])
        np.testing.assert_array_equal(joined, getattr(whole, column))


def test_only_what_is_asked_for():
    track = sw.dead_reckon(
        SIX.rover, SIX.steering, SIX.angles, SIX.stamps, covariances=False, residuals=False
    )
    assert track.covariances is None
    assert track.residuals is None
    assert track.weights is None
    with pytest.raises(ValueError, match="track must hold residuals"):
        track.slip_report()


def test_start_and_empty_logs():
    start = (1.0, -2.0, 0.5)
    track = sw.dead_reckon(
        SIX.rover, SIX.steering, SIX.angles, SIX.stamps, start=start, start_covariance=(0.01, 0.02, 0.0)
    )
    expected = sw.compose(np.tile(start, (len(SIX.poses), 1)), SIX.poses)
    np.testing.assert_allclose(track.poses, expected, rtol=0, atol=1e-11)
    np.testing.assert_allclose(np.diag(track.covariances[0]), (0.01, 0.02, 0.0), atol=1e-15)
    empty = sw.dead_reckon(SIX.rover, np.zeros((0, 4)), np.zeros((0, 6)), [])
    assert len(empty) == 0
    assert empty.poses.shape == (0, 3)
    assert "0 rows" in repr(empty)


# Each puts something bad into a log and says in which rows it lies, and what the flag is.
def nan_wheel(steering, angles, stamps, k):
    angles[k, 2] = np.nan
    return OdometryHealth.NOT_FINITE


def nan_steering(steering, angles, stamps, k):
    steering[k, 0] = np.inf
    return OdometryHealth.NOT_FINITE


def no_stamp(steering, angles, stamps, k):
    stamps[k] = np.nan
    return OdometryHealth.NOT_FINITE


def duplicate(steering, angles, stamps, k):
    stamps[k] = stamps[k - 1]
    return OdometryHealth.DUPLICATE


def backwards(steering, angles, stamps, k):
    stamps[k] = stamps[k - 1] - 0.7
    return OdometryHealth.BACKWARDS


def spike(steering, angles, stamps, k):
    angles[k, 3] += 500.0
    return OdometryHealth.JUMP


BAD = [nan_wheel, nan_steering, no_stamp, duplicate, backwards, spike]


@given(
    st.lists(
        st.tuples(st.sampled_from(BAD), st.integers(1, 118)), min_size=1, max_size=8, unique_by=lambda b: b[1]
    )
)
@at_most(60)
def test_bad_rows_are_flagged_and_good_rows_are_not_lost(bad):
    # Two of a kind in a row may mean that clock or counter moved for good: see below.
    bad = [(flaw, k) for flaw, k in bad if not any(abs(k - other) == 1 for _, other in bad)]
    steering, angles, stamps = (column.copy() for column in (SIX.steering, SIX.angles, SIX.stamps))
    expected = {k: flaw(steering, angles, stamps, k) for flaw, k in bad}
    track = sw.dead_reckon(SIX.rover, steering, angles, stamps, max_speed=5.0)
    np.testing.assert_array_equal(track.left_out, sorted(expected))
    for k, flag in expected.items():
        assert track.health[k] == flag
        np.testing.assert_array_equal(track.poses[k], track.poses[k - 1])
        assert np.isnan(track.residuals[k]).all()
    # Running totals make good for what was left out: where a row and the one before are good, and no turn was
    # held together with a straight over the hole, the pose is the true one again.
    plain = sw.dead_reckon(
        SIX.rover, *(np.delete(column, sorted(expected), axis=0) for column in (steering, angles, stamps))
    )
    good = np.delete(np.arange(len(stamps)), sorted(expected))
    np.testing.assert_array_equal(track.poses[good], plain.poses)
    np.testing.assert_array_equal(track.covariances[good], plain.covariances)
    assert f"of {len(stamps)} rows" in str(track) or not bad


def test_raise_names_the_row():
    angles = SIX.angles.copy()
    angles[33, 1] = np.nan
    with pytest.raises(ValueError, match=r"wheel_angles\[33\] must be finite, got \("):
        sw.dead_reckon(SIX.rover, SIX.steering, angles, SIX.stamps, errors="raise")
    stamps = SIX.stamps.copy()
    stamps[7] = stamps[6]
    with pytest.raises(ValueError, match=r"stamp\[7\] must be later than the last one"):
        sw.dead_reckon(SIX.rover, SIX.steering, SIX.angles, stamps, errors="raise")
    with pytest.raises(ValueError, match="errors must be 'flag' or 'raise', got 'ignore'"):
        sw.dead_reckon(SIX.rover, SIX.steering, SIX.angles, stamps, errors="ignore")


def test_a_clock_that_is_set_back_for_good():
    rover = VEHICLES["differential"]
    stamps = np.arange(40) * 0.1
    angles = np.repeat(stamps[:, None] * 3.0, 2, axis=1)
    stamps[20:] -= 1000.0
    track = sw.dead_reckon(rover, None, angles, stamps)
    np.testing.assert_array_equal(track.left_out, [20])
    assert track.health[20] == OdometryHealth.BACKWARDS
    assert track.health[21] == OdometryHealth.RESTARTED
    np.testing.assert_allclose(track.poses[-1], (0.1 * angles[-1, 0], 0.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(track.twists[1:, 0], 0.3, atol=1e-9)


def test_a_counter_that_starts_over_at_zero():
    rover = VEHICLES["differential"]
    stamps = np.arange(40) * 0.1
    angles = np.repeat(stamps[:, None] * 3.0 + 400.0, 2, axis=1)
    angles[20:] -= 406.0
    track = sw.dead_reckon(rover, None, angles, stamps, max_speed=2.0)
    assert len(track.left_out) == 0
    assert track.health[20] == OdometryHealth.RESTARTED
    # The way driven while the counter was reset is not known: one step of 3 cm.
    np.testing.assert_allclose(track.poses[-1], (0.1 * 3.0 * 3.9 - 0.03, 0.0, 0.0), atol=1e-12)


@pytest.mark.parametrize("flaw", [duplicate, backwards])
def test_increments_of_rows_left_out_are_owed_to_the_next(flaw):
    rover = VEHICLES["differential"]
    stamps = np.arange(40) * 0.1
    increments = np.full((40, 2), 0.3)
    flaw(None, None, stamps, 11)
    track = sw.dead_reckon(rover, None, increments, stamps, increments=True, max_speed=0.5)
    np.testing.assert_array_equal(track.left_out, [11])
    np.testing.assert_allclose(track.poses[-1], (0.1 * 0.3 * 39, 0.0, 0.0), atol=1e-12)


def test_wrap_and_gap_are_flagged():
    rover = VEHICLES["differential"]
    stamps = np.arange(40) * 0.1
    stamps[25:] += 3.0
    counts = np.repeat((np.arange(40) * 5000)[:, None] % 65536, 2, axis=1)
    encoder = sw.Encoder(10_000, wraps_at=65536)
    track = sw.dead_reckon(rover, None, counts, stamps, wheel_encoders=encoder, max_gap=1.0)
    np.testing.assert_array_equal(track.rows(OdometryHealth.GAP), [25])
    np.testing.assert_array_equal(track.rows(OdometryHealth.WRAPPED), [14, 27])
    np.testing.assert_allclose(track.poses[-1, 0], 39 * 5000 / 10_000 * math.tau * 0.1)
    assert "GAP: 1 of 40 rows (25)" in str(track)


def columns_of(log) -> dict[str, np.ndarray]:
    columns = {"stamp": log.stamps}
    for i, joint in enumerate(log.rover.steering_joints):
        columns[joint] = log.steering[:, i]
    for joint, wheel in log.rover.traction_joints.items():
        columns[f"{joint}.position"] = log.angles[:, log.rover.wheel_names.index(wheel)]
    return columns


FRAMES = {"dict": "", "pyarrow": "table", "pandas": "DataFrame", "polars": "DataFrame"}


@pytest.mark.parametrize("kind", FRAMES)
def test_tables_of_every_kind(kind):
    make = dict if kind == "dict" else getattr(pytest.importorskip(kind), FRAMES[kind])
    expected = sw.dead_reckon(SIX.rover, SIX.steering, SIX.angles, SIX.stamps)
    track = sw.dead_reckon(SIX.rover, make(columns_of(SIX)))
    np.testing.assert_array_equal(track.poses, expected.poses)
    np.testing.assert_array_equal(track.covariances, expected.covariances)


def test_parquet_in_pieces(tmp_path):
    pa, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    columns = columns_of(SIX)
    columns["stamp"] = np.datetime64(datetime(2026, 1, 1)) + (SIX.stamps * 1e9).astype("timedelta64[ns]")
    columns["imu"] = SIX.poses[:, 2] + 1.0
    path = tmp_path / "log.parquet"
    parquet.write_table(pa.table(columns), path, row_group_size=50)
    expected = sw.dead_reckon(SIX.rover, SIX.steering, SIX.angles, SIX.stamps, yaw=columns["imu"])
    calls = []
    track = sw.dead_reckon(SIX.rover, path, yaw="imu", progress=lambda *rows: calls.append(rows))
    np.testing.assert_allclose(track.poses, expected.poses, rtol=0, atol=1e-9)  # stamps are whole nanoseconds
    assert calls == [(121, 121)] or calls[-1] == (121, 121)
    pieces = list(dead_reckon_chunks(SIX.rover, path, yaw="imu", chunk_rows=30))
    assert len(pieces) >= 4
    np.testing.assert_array_equal(np.concatenate([piece.poses for piece in pieces]), track.poses)


def test_columns_by_other_names():
    columns = columns_of(SIX)
    renamed = {"when": columns["stamp"]}
    given = {"stamp": "when"}
    for i, wheel in enumerate(SIX.rover.wheel_names):
        renamed[f"q{i}"] = SIX.angles[:, i]
        given[wheel] = f"q{i}"
    for i, joint in enumerate(SIX.rover.steering_joints):
        renamed[f"d{i}"] = SIX.steering[:, i]
        given[joint] = f"d{i}"
    expected = sw.dead_reckon(SIX.rover, columns)
    np.testing.assert_array_equal(sw.dead_reckon(SIX.rover, renamed, columns=given).poses, expected.poses)
    with pytest.raises(ValueError, match="table must have a column stamp or stamps or time .* got when, q0"):
        sw.dead_reckon(SIX.rover, renamed)
    with pytest.raises(ValueError, match="columns must name some of stamp, .*, got 'spare'"):
        sw.dead_reckon(SIX.rover, renamed, columns={"spare": "q0"})
    with pytest.raises(ValueError, match="yaw must name a column, got 'imu' of"):
        sw.dead_reckon(SIX.rover, columns, yaw="imu")
    with pytest.raises(ValueError, match="or be a table or a path, got int"):
        sw.dead_reckon(SIX.rover, 5)
    assert "front_left_wheel_joint.position" in table_columns(SIX.rover)["front_left"]


def test_a_passive_wheel_needs_no_column():
    log = drive(VEHICLES["tricycle"], n=20)
    columns = columns_of(log)
    assert len(columns) == 1 + len(log.rover.steering_joints) + sum(w.driven for w in log.rover.wheels)
    track = sw.dead_reckon(log.rover, columns)
    np.testing.assert_allclose(track.poses, log.poses, atol=1e-11)


def test_dates_of_the_real_calendar():
    rover = VEHICLES["differential"]
    began = datetime(2026, 3, 29, 0, 59, 59, tzinfo=UTC)
    pa = pytest.importorskip("pyarrow")
    stamps = pa.array([began + timedelta(milliseconds=100 * k) for k in range(30)])
    angles = np.arange(30) * 0.3
    track = sw.dead_reckon(rover, pa.table({"time": stamps, **dict.fromkeys(rover.wheel_names, angles)}))
    np.testing.assert_allclose(track.twists[1:, 0], 0.3, rtol=1e-9)


def test_memory_does_not_grow_with_the_log():
    rover = VEHICLES["differential"]

    def peak(rows):
        stamps = np.arange(rows) * 0.01
        table = {"stamp": stamps, **dict.fromkeys(rover.wheel_names, stamps)}
        tracemalloc.start()
        for _ in dead_reckon_chunks(rover, table, chunk_rows=1000):
            pass
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    assert peak(40_000) < 2 * peak(4_000)


def test_slip_is_found_where_it_was():
    log = drive(VEHICLES["six_wheel"], n=200)
    angles = log.angles.copy()
    spun = np.zeros(len(angles))
    spun[150:200] = np.linspace(0.0, 8.0, 50)
    spun[200:] = 8.0
    angles[:, 5] += spun
    track = sw.dead_reckon(log.rover, log.steering, angles, log.stamps, method="robust")
    report = track.slip_report()
    assert report.worst_wheel == "rear_right"
    [window] = report.windows
    assert window.wheel == "rear_right"
    assert 150 <= window.first_row <= 152
    assert 197 <= window.last_row <= 200
    assert window.start == log.stamps[window.first_row]
    # 8 rad on a wheel of 15 cm; a robust fit gives way by next to nothing.
    assert window.distance == pytest.approx(8.0 * 0.15, rel=0.05)
    rear_right = report.wheels[5]
    assert rear_right.weight < 0.95 < min(wheel.weight for wheel in report.wheels[:5])
    text = str(report)
    assert "rear_right slid 1.2" in text
    assert len(track.slip_report(threshold=100.0).windows) == 0
    assert "no stretch in which a wheel slipped" in str(track.slip_report(threshold=100.0))


def test_ten_million_rows_are_read_in_pieces():
    rows = 10_000_000 if SOAK else 200_000
    rover = VEHICLES["differential"]
    stamps = np.arange(rows) * 1e-3
    angles = np.stack((5.0 * stamps, 5.1 * stamps), axis=-1)
    track = sw.dead_reckon(rover, None, angles, stamps, covariances=False, residuals=False)
    twist = rover.forward(None, [5.0, 5.1])
    expected = sw.exp(twist, stamps[-1])
    # Totals of up to 5e4 rad carry 4e-12 rad of rounding per step, at random.
    np.testing.assert_allclose(track.poses[-1], expected, atol=1e-6)


def ate(poses: np.ndarray, truth: np.ndarray) -> float:
    """Root mean square distance."""
    return float(np.sqrt(np.mean(np.sum((poses[:, :2] - truth[:, :2]) ** 2, axis=1))))


@data.REQUIRED
@pytest.mark.parametrize("robot", data.ROBOTS)
def test_nominal_dimensions_reach_the_published_figures(robot):
    worst = 0.0
    for run in data.RUNS[robot]:
        rover, log = data.read(run)
        poses = log.truth.poses
        track = sw.dead_reckon(rover, log.steering, log.wheel_angles, log.stamps, start=poses[0])
        assert not len(track.left_out)
        error = ate(track.poses, poses) / run["nominal"]["ate_first"] - 1
        worst = max(worst, abs(error))
        # A recording's increments are its readings: the same track from them.
        increments = np.diff(log.wheel_angles, axis=0, prepend=log.wheel_angles[:1])
        again = sw.dead_reckon(rover, log.steering, increments, log.stamps, start=poses[0], increments=True)
        np.testing.assert_allclose(again.poses, track.poses, rtol=0, atol=1e-8)
    print(f"{robot}: {len(data.RUNS[robot])} runs, within {worst:.2%} of the published errors")
    assert worst < 0.02


def test_a_file_of_another_kind_says_what_reads_it(tmp_path):
    pytest.importorskip("pyarrow")
    path = tmp_path / "log.csv"
    path.write_text("time,left,right\n0,0,0\n")
    with pytest.raises(ValueError, match="must be a Parquet file; read_log makes a WheelLog of"):
        sw.dead_reckon(VEHICLES["differential"], path)
    with pytest.raises(FileNotFoundError, match="no.csv: no such file"):
        sw.dead_reckon(VEHICLES["differential"], tmp_path / "no.csv")
