"""Tracks and logs as columns, and back."""

import math
import subprocess
import sys

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.log_odometry.evaluation import evaluate
from tests.objects.samples import ROVER, samples

pytest.importorskip("scipy", reason="calibration needs SciPy")
pandas = pytest.importorskip("pandas")

TABLES = ("Track", "Track3", "WheelLog", "Simulation", "GroundSimulation", "GroundTruth")


@pytest.mark.parametrize("name", TABLES)
def test_all_forms_have_the_same_columns(name, tmp_path):
    one = samples()[name]
    arrays = one.to_arrays()
    assert next(iter(arrays)) == "time"
    assert {len(values) for values in arrays.values()} == {len(one)}
    frame = one.to_pandas()
    assert list(frame.columns) == list(arrays)
    one.to_csv(tmp_path / "table.csv")
    read = pandas.read_csv(tmp_path / "table.csv")
    for column, values in arrays.items():
        np.testing.assert_array_equal(frame[column], values)
        np.testing.assert_array_equal(read[column], values)  # every digit
    arrow = pytest.importorskip("pyarrow") and one.to_arrow()
    assert arrow.column_names == list(arrays)
    assert arrow.schema.field("time").metadata == {b"unit": b"s"}


def test_runs_samples_and_evaluations_are_tables_too(tmp_path):
    run = samples()["ControllerRun"]
    assert list(run.to_arrays())[:2] == ["time", ROVER.joint_names[0]]
    frame = run.to_pandas()
    np.testing.assert_array_equal(frame["omega"], run.twist[:, 2])
    np.testing.assert_array_equal(frame[ROVER.joint_names[-1]], run.commands[ROVER.joint_names[-1]])
    run.to_csv(tmp_path / "run.csv")
    assert list(pandas.read_csv(tmp_path / "run.csv")) == list(frame)
    times = np.linspace(0.0, 2.0, 5)
    profile = sw.profiles.linear((0.0, 1.0), (1.0, 3.0), 2.0)
    assert list(profile.at(times).to_arrays(times=times))[:3] == ["time", "value_0", "value_1"]
    one = sw.profiles.linear(0.0, 1.0, 2.0).at(1.0).to_pandas()
    assert one["value"].tolist() == [0.5]
    state = samples()["BodyTransition"].at(times)
    np.testing.assert_array_equal(state.to_arrays()["vx"], state.twist[:, 0])
    found = samples()["Evaluation"].to_arrays()
    assert set(found) == {
        "distance",
        "position_error_first",
        "yaw_error_first",
        "position_error_se2",
        "yaw_error_se2",
    }
    assert found["distance"][-1] == samples()["Evaluation"].distance


def test_a_table_is_saved_by_its_ending(tmp_path):
    log = samples()["WheelLog"]
    for ending in ("csv", "parquet"):
        pytest.importorskip("pyarrow")
        path = tmp_path / f"log.{ending}"
        log.save(path, rover=ROVER)
        again = sw.read_log(path, ROVER)
        np.testing.assert_array_equal(again.wheel_angles, log.wheel_angles)
        np.testing.assert_allclose(again.truth.poses, log.truth.at(log.stamps), atol=0)
    with pytest.raises(ValueError, match="path must end in .csv or .parquet, got 'log.txt'"):
        log.save("log.txt")


def test_a_log_is_read_from_a_frame():
    log = samples()["WheelLog"]
    again = sw.read_log(log.to_pandas(rover=ROVER), ROVER, name="a")
    np.testing.assert_array_equal(again.wheel_angles, log.wheel_angles)
    assert again.name == "a"
    for table in (log.to_arrays(rover=ROVER), log.to_arrow(rover=ROVER)):  # Arrow lost its truth
        known = sw.read_log(table, ROVER).truth
        np.testing.assert_array_equal(known.poses, again.truth.poses)
    with pytest.raises(ValueError, match="truth must be left out for a table in memory"):
        sw.read_log({"time": [0.0]}, ROVER, truth="truth.csv")


def test_a_track_comes_back_from_its_frame():
    track = samples()["Track"]
    again = sw.Track.from_pandas(track.to_pandas(), ROVER)
    for name in ("stamps", "poses", "twists", "covariances", "residuals", "health"):
        np.testing.assert_array_equal(getattr(again, name), getattr(track, name))
    bare = sw.Track.from_pandas({"t": [0.0, 1.0], "x": [0, 1], "y": [0, 0], "yaw": [0, 0]}, ROVER)
    assert (bare.covariances, bare.residuals, len(bare)) == (None, None, 2)


@pytest.mark.parametrize("name", ["Track", "Track3"])
def test_rows_of_a_track_are_a_track(name):
    track = samples()[name]
    part = track[10:20]
    assert type(part) is type(track)
    assert len(part) == 10
    np.testing.assert_array_equal(part.stamps, track.stamps[10:20])
    np.testing.assert_array_equal(part.covariances, track.covariances[10:20])
    np.testing.assert_array_equal(track[-1].poses, track.poses[-1:])
    np.testing.assert_array_equal(track[track.health == 0].poses, track.poses[track.health == 0])
    assert track[2:2].to_arrays()["x"].shape == (0,)
    with pytest.raises(IndexError, match=f"row must be from -{len(track)} to {len(track) - 1}, got 999"):
        track[999]
    with pytest.raises(TypeError):
        iter(track)
    with pytest.raises(TypeError):
        np.asarray(track)  # no array of arrays by mistake


def test_a_log_comes_back_from_its_frame():
    log = samples()["WheelLog"]
    again = sw.WheelLog.from_pandas(log.to_pandas(rover=ROVER), ROVER)
    for name in ("stamps", "steering", "wheel_angles"):
        np.testing.assert_array_equal(getattr(again, name), getattr(log, name))
    np.testing.assert_allclose(again.truth.poses, log.truth.at(log.stamps), atol=0)


def test_a_log_that_came_with_a_rover_has_the_names_of_its_joints(tmp_path):
    """A simulated log was not found again in its own table: its columns had numbers."""
    drive = sw.simulate(ROVER, [(0.0, 0.04, 0.0, 0.02), (5.0, 0.04, 0.0, 0.02)], rate=10.0)
    drive.save(tmp_path / "log.csv")
    for log in (drive, sw.read_log(tmp_path / "log.csv", ROVER)):
        for table in (log.to_pandas(), log.to_arrow(), log.to_arrays()):
            again = sw.WheelLog.from_pandas(table, ROVER)
            np.testing.assert_array_equal(again.wheel_angles, drive.wheel_angles)
            np.testing.assert_array_equal(again.steering, drive.steering)
            assert list(again.to_arrays()) == list(log.to_arrays())
    bare = sw.WheelLog(drive.stamps, drive.steering, drive.wheel_angles)
    assert list(bare.to_arrays())[1] == "steering_0"
    with pytest.raises(TypeError, match="^rover must be a Rover, got 3"):
        sw.WheelLog(drive.stamps, drive.steering, drive.wheel_angles, rover=3)


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        ({"x": [0.0], "y": [0.0], "yaw": [0.0]}, "frame must have a column time or stamp"),
        ({"time": [0.0], "x": [0.0]}, "frame must have the columns y, yaw, got time, x"),
    ],
)
def test_a_frame_without_what_is_needed(frame, message):
    with pytest.raises(ValueError, match=message):
        sw.Track.from_pandas(pandas.DataFrame(frame), ROVER)


def test_a_table_without_its_library_says_how_to_install_it():
    code = (
        "import sys; sys.modules['pandas'] = None\n"
        "import numpy as np, six_wheel as sw\n"
        "truth = sw.GroundTruth([0.0, 1.0], np.zeros((2, 3)))\n"
        "try: truth.to_pandas()\n"
        "except ModuleNotFoundError as error: print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout == 'this table needs pandas: pip install "pandas"\n'


def test_a_track_in_space_is_compared_as_seen_from_above_where_the_truth_has_no_height():
    drive, track = samples()["GroundSimulation"], samples()["Track3"]
    truth = sw.GroundTruth(drive.truth.stamps, drive.truth.poses)
    found = evaluate(track, truth)
    same = evaluate(track.poses[:, [0, 1, 5]], truth.at(track.stamps))
    assert found.first.rmse == same.first.rmse
    assert found.distance == pytest.approx(1.2, abs=0.05)  # 12 s at 0.1 m/s
    assert math.isfinite(found.aligned.rmse)


def test_a_track_in_space_is_compared_in_space():
    drive, track = samples()["GroundSimulation"], samples()["Track3"]
    assert drive.truth.has_space
    found = evaluate(track, drive)
    assert found.aligned.align == "se3"
    assert found.first.rmse < 0.005  # an exact log on a known map
    assert "rotation_error_se3" in found.to_arrays()
    raised = track.poses + np.array((0.0, 0.0, 0.1, 0.0, 0.0, 0.0))
    lifted = sw.GroundTruth(track.stamps, raised)
    assert evaluate(track, lifted).first.maximum < 1e-12  # wherever the paths lie
    raised[60:, 2] += 0.3
    assert evaluate(track, sw.GroundTruth(track.stamps, raised)).first.final == pytest.approx(0.3, abs=1e-12)
    assert evaluate(track, track).first.maximum < 1e-12
    assert evaluate(track, raised).first.final == pytest.approx(0.3, abs=1e-12)


def test_a_truth_in_space_keeps_its_heights(tmp_path):
    truth = samples()["GroundSimulation"].truth
    np.testing.assert_array_equal(truth.at_in_space(truth.stamps)[:, 2:5], truth.space)
    np.testing.assert_array_equal(truth.at_in_space(truth.stamps)[:, [0, 1, 5]], truth.poses)
    assert np.isnan(truth.at_in_space([truth.stamps[-1] + 1.0])).all()
    assert {"z", "roll", "pitch"} < set(truth.to_arrays())
    same = sw.GroundTruth(truth.stamps, truth.at_in_space(truth.stamps))
    np.testing.assert_array_equal(same.space, truth.space)
    half = truth.stamps[:-1] + 0.5 * np.diff(truth.stamps)
    between = truth.at_in_space(half)
    np.testing.assert_allclose(between[:, 2:5], (truth.space[1:] + truth.space[:-1]) / 2, atol=1e-12)
    with pytest.raises(ValueError, match=r"space must have shape \(2, 3\), got \(3, 3\)"):
        sw.GroundTruth([0.0, 1.0], np.zeros((2, 3)), space=np.zeros((3, 3)))
