"""six-wheel odometry: the first pose, wrong usage, logs that cannot be used."""

import os
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.log_odometry.run_log import reckon
from six_wheel.logs.log_options import LogOptions
from tests.cli.odometry_tables import WAY, Refused, read, table
from tests.cli_runs import Run


def test_the_first_pose_can_be_given(run: Run, cart: None) -> None:
    run("odometry", "cart.yaml", "log.csv", "-o", "t.csv", "--start", "1", "2", "0.5")
    track = read("t.csv")
    assert (track["x"][0], track["y"][0], track["yaw"][0]) == (1.0, 2.0, 0.5)


# --- what is wrong is one line ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "ROVER and LOG must be given, or --example"),
        (["cart.yaml"], "ROVER and LOG must be given, or --example"),
        (["cart.yaml", "log.csv", "--example"], "LOG must be left out with --example, got log.csv"),
        (["cart.yaml", "lag.csv"], 'lag.csv: no such file; did you mean "log.csv"?'),
        (["cart.yaml", "cart.yaml"], "a log must be a bag's folder or end in .csv, .parquet, .mcap, .db3"),
        (["cart.yaml", "log.csv", "--log-format", "tabel"], "format must be one of table, bag, optiodom"),
        (["cart.yaml", "log.csv", "--log-format", "bag"], "the format bag is a folder or .mcap or .db3 file"),
        (["cart.yaml", "log.csv", "--readings", "angel"], "readings must be one of angles, speeds, ticks"),
        (["cart.yaml", "log.csv", "--truth", "none.csv"], "none.csv"),
        (["cart.yaml", "log.csv", "--truth", "commands.csv"], "the truth must have columns x, y and yaw"),
        (["cart.yaml", "log.csv", "-o", "t.txt"], 'the ending must be .csv, .parquet or .mcap, got ".txt"'),
        (["cart.yaml", "log.csv", "-o", "log.csv"], "the output must be another file than log.csv"),
        (["cart.yaml", "log.csv", "-o", "none/t.csv"], "the folder of the output must exist"),
        (["cart.yaml", "log.csv", "--plot", "p.xyz"], "the ending must be one of .png, .svg, .pdf"),
        (["cart.yaml", "log.csv", "--report", "report.yaml"], "the ending must be .md or .markdown"),
        (["cart.yaml", "log.csv", "--speed-noise", "-1"], "speed must be finite and not negative, got -1"),
        (
            ["cart.yaml", "log.csv", "--ticks-per-turn", "0"],
            "ticks_per_turn must be finite and positive, got 0",
        ),
        (["cart.yaml", "log.csv", "--start", "0", "nan", "0"], "pose must be finite"),
        (["cart.yaml", "log.csv", "--segment", "0"], "length must be finite and positive, got 0"),
        (["cart.yaml", "log.csv", "--chunk-rows", "0"], "chunk_rows must be positive, got 0"),
    ],
)  # fmt: skip
def test_wrong_usage(refused: Refused, cart: None, arguments: list[str], words: str) -> None:
    assert words in refused("odometry", *arguments)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "got an empty file"),
        ("time,left [rad],right [rad]\n", "at least one row that can be used, got none"),
        ("time,left [rad],right [rad]\n0,0,0\n", "at least two rows that can be used"),
        (
            "time,left [rad],right [rad]\n0,nan,0\n1,1,nan\n",
            "got none; bad.csv: row 1 (line 2): wheel left must",
        ),
        ("left [rad],right [rad]\n0,0\n", "no column for time"),
        ("time,lfet [rad],rihgt [rad]\n0,0,0\n", 'did you mean "rihgt [rad]" for "right"?'),
        ("time,left,right\n0,0,0\n", 'column "left" must state its unit'),
        (
            "time,left [ticks],right [ticks]\n0,0,0\n1,1,1\n",
            "wheel_encoders: {ticks_per_turn: COUNTS}",
        ),
        ("time,left [rad]\n0,0\n1,1\n", "no readings of right: taken as without encoder"),
        ("0,1,2\n", "the first line must name the columns"),
    ],
)
def test_logs_that_cannot_be_used(refused: Refused, cart: None, text: str, words: str) -> None:
    Path("bad.csv").write_text(text)
    Path("t.csv").write_text("precious")
    assert words in refused("odometry", "cart.yaml", "bad.csv", "-o", "t.csv")
    assert Path("t.csv").read_text() == "precious"


def test_a_truth_of_another_time_is_refused(run: Run, refused: Refused, cart: None) -> None:
    Path("later.csv").write_text(table(shift=1000.0))
    message = refused("odometry", "cart.yaml", "log.csv", "--truth", "later.csv", "-o", "t.csv")
    assert message.startswith(
        "log.csv: the truth must overlap the log in time, got 1000 to 1010 s and 0 to 10 s"
    )


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_must_not_be_written(run: Run, refused: Refused, cart: None) -> None:
    Path("locked").mkdir(mode=0o500)
    assert "the output must be writeable" in refused("odometry", "cart.yaml", "log.csv", "-o", "locked/t.csv")


def test_steps_of_a_log_are_shown_as_progress(cart: None) -> None:
    seen: list[tuple[int, int]] = []
    rover = sw.load("cart.yaml")
    result = reckon(
        rover, Path("log.csv"), log_options=LogOptions(), chunk_rows=20, progress=lambda *at: seen.append(at)
    )
    assert result.rows == len(WAY.stamps)
    assert seen == sorted(seen)
    assert len(seen) > 5
    assert seen[-1][0] == seen[-1][1]


def test_a_record_of_odometry_has_readings_poses_and_both_covariances(run: Run, cart: None) -> None:
    rosbags = pytest.importorskip("rosbags.highlevel")
    from rosbags.typesys import Stores, get_typestore

    for output in ("track.mcap", "track.csv"):
        assert run("odometry", "cart.yaml", "log.csv", "-o", output, "--chunk-rows", "50")[0] == 0
    track = read("track.csv")
    seen: dict[str, list] = {}
    with rosbags.AnyReader([Path("track.mcap")], default_typestore=get_typestore(Stores.LATEST)) as bag:
        for connection, _, data in bag.messages():
            seen.setdefault(connection.topic, []).append(bag.deserialize(data, connection.msgtype))
    assert {topic: len(each) for topic, each in seen.items()} == dict.fromkeys(
        ("/joint_states", "/odom", "/tf", "/wheel_slip"), len(track["x"])
    )
    poses = [message.pose.pose.position.x for message in seen["/odom"]]
    np.testing.assert_allclose(poses, track["x"], atol=1e-12)  # a row at a time: rounding only
    last = seen["/odom"][-1]
    assert last.pose.covariance[0] == pytest.approx(track["covariance_x_x"][-1], rel=1e-9)
    assert last.twist.covariance[35] > 0.0
    # And it is a log again.
    assert run("odometry", "cart.yaml", "track.mcap", "-o", "again.csv")[0] == 0
    np.testing.assert_allclose(read("again.csv")["x"], track["x"], atol=1e-9)
