"""Logs that are fine are read without a word: at rest, slow, with stamps in two columns."""

import warnings
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pyarrow")

import pyarrow as pa
from pyarrow import csv, parquet

import six_wheel as sw
from six_wheel.log_odometry import reckon_all
from six_wheel.logs import read_log
from tests.rovers import PAIR

ROWS = np.arange(400)


def table(angles: np.ndarray, stamps: np.ndarray, **more: np.ndarray) -> pa.Table:
    return pa.table({"time": stamps, "left [rad]": angles, "right [rad]": angles, **more})


def said_of(made: pa.Table, folder: Path) -> list[str]:
    csv.write_csv(made, folder / "log.csv")
    return list(read_log(folder / "log.csv", PAIR)[1].warnings)


def test_a_rover_at_rest_is_not_doubted_unless_its_truth_moves(tmp_path: Path) -> None:
    # "no wheel turns in all 400 rows" was said of every log of a rover that stands.
    still, stamps = np.full(400, 3.25), 0.05 * ROWS
    pose = {"y": 0.0 * stamps, "yaw": 0.0 * stamps}
    assert said_of(table(still, stamps), tmp_path) == []
    assert said_of(table(still + 0.0015 * (ROWS % 3 == 0), stamps), tmp_path) == []
    noise = 0.01 * np.random.default_rng(1).normal(size=400)
    assert said_of(table(still, stamps, x=noise, **pose), tmp_path) == []
    (line,) = said_of(table(still, stamps, x=0.3 * stamps, **pose), tmp_path)
    assert "no wheel turns in all 400 rows, and the truth moves 5.99 m: are the encoders connected?" in line


@pytest.mark.parametrize("speed", [1e-5, 1e-3, 4e-2])
def test_angles_at_whole_seconds_are_seconds(tmp_path: Path, speed: float) -> None:
    # A rover slower than 4 mm/s was refused as one whose stamps are milliseconds.
    angles = np.cumsum(speed / 0.1 * (1.0 + 0.1 * np.sin(ROWS / 5.0)))
    assert said_of(table(angles, ROWS), tmp_path) == []


def test_frames_may_have_their_stamps_in_two_columns() -> None:
    stamps = 1_764_000_000_000_000_000 + 50_000_000 * ROWS
    angles = np.cumsum(0.1 + 0.02 * np.sin(ROWS / 9.0))
    frame = {"left [rad]": angles, "right [rad]": 1.1 * angles}
    parts = {"stamp.sec": stamps // 10**9, "stamp.nanosec": stamps % 10**9}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        track = sw.dead_reckon(PAIR, {**parts, **frame})
    np.testing.assert_array_equal(track.poses, sw.dead_reckon(PAIR, {"stamp_ns": stamps, **frame}).poses)


def test_a_log_in_another_format_counts_once(tmp_path: Path) -> None:
    made = table(np.cumsum(0.1 + 0.02 * np.sin(ROWS / 9.0)), 0.05 * ROWS)
    (tmp_path / "logs").mkdir()
    csv.write_csv(made, tmp_path / "logs" / "a.csv")
    parquet.write_table(made, tmp_path / "logs" / "b.parquet")
    with pytest.warns(UserWarning, match="has the readings of .* they count once"):
        found = list(reckon_all(PAIR, [tmp_path / "logs"], tmp_path / "tracks", workers=1))
    assert len(found) == 1
    assert [path.suffix for path in (tmp_path / "tracks").glob("[ab].*")] == [".csv"]
