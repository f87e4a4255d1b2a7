"""Bags of a drive: what was wanted and why it is not."""

import itertools
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
import pytest
from rosbags.highlevel import AnyReader

import six_wheel as sw
from six_wheel.kinematics.errors import TableError
from six_wheel.simulation.drive import DriveLoop, drive
from tests.rovers import SIX_WHEELS as ROVER


def test_a_record_of_a_drive_says_what_was_wanted_and_why_it_is_not(tmp_path: Path) -> None:
    (tmp_path / "c.csv").write_text("time,vx,omega\n0,0.5,0\n1,0.5,0.3\n2,0,0\n")
    loop = DriveLoop(sw.Limits(speed=0.3, acceleration=0.5), 20.0)
    drive(ROVER, tmp_path / "c.csv", tmp_path / "run.mcap", loop=loop, chunk_rows=7)
    drive(ROVER, tmp_path / "c.csv", tmp_path / "run.parquet", loop=loop)
    table = pyarrow.parquet.read_table(tmp_path / "run.parquet").to_pydict()
    seen: dict[str, list[Any]] = {}
    with AnyReader([tmp_path / "run.mcap"]) as reader:
        for connection, _, data in reader.messages():
            seen.setdefault(connection.topic, []).append(reader.deserialize(data, connection.msgtype))
    rows = len(table["time"])
    steady = ("/joint_commands", "/cmd_vel_out", "/odom", "/tf", "/wheel_slip")
    assert {topic: len(seen[topic]) for topic in steady} == dict.fromkeys(steady, rows)
    assert [m.twist.linear.x for m in seen["/cmd_vel"]] == [0.5, 0.5, 0.0]
    assert [m.twist.linear.x for m in seen["/cmd_vel_out"]] == table["limited_vx"]
    places = [m.pose.pose.position.x for m in seen["/odom"]]
    np.testing.assert_allclose(places, table["x"], atol=1e-12)  # in other chunks: rounding
    names = [name for name, _ in itertools.groupby(table["reason_names"])]
    assert [m.data for m in seen["/reasons"]] == names
    last = seen["/odom"][-1]
    pose, motion = (np.reshape(each.covariance, (6, 6)) for each in (last.pose, last.twist))
    for covariance in (pose, motion):
        assert (np.linalg.eigvalsh(covariance) >= 0.0).all()
        assert covariance[2, 2] == 1e6
    assert pose[0, 0] > 0.0


def test_a_drive_that_fails_leaves_no_bag(tmp_path: Path) -> None:
    commands = tmp_path / "c.csv"
    for lines, words in (
        ("0,0.5,0\n1,0.5,x\n", r"row 2 \(line 3\): omega must be a number"),
        (
            "-2,0.5,0\n-1,0.5,0\n",
            r"row 1 \(line 2\): a time in a bag must be from 0 to 2\^31 seconds, got -2.0",
        ),
    ):
        commands.write_text("time,vx,omega\n" + lines)
        with pytest.raises(TableError, match=words):
            drive(ROVER, commands, tmp_path / "run.mcap", chunk_rows=1)
        assert [path.name for path in tmp_path.iterdir()] == ["c.csv"]


def test_without_rosbags_the_install_line_is_named(tmp_path: Path) -> None:
    (tmp_path / "c.csv").write_text("time,vx,omega\n0,0.5,0\n1,0.5,0\n")
    (tmp_path / "log.mcap").write_bytes(b"")
    code = (
        "import sys; sys.modules['rosbags'] = None\n"
        "from six_wheel.__main__ import main\n"
        "import six_wheel as sw\n"
        "from six_wheel.logs import JointLog\n"
        "try: JointLog('log.mcap', sw.Rover.differential(0.5, 0.1))\n"
        "except ModuleNotFoundError as error: print(error)\n"
        "sys.exit(main(['drive', 'perseverance', 'c.csv', '-o', 'run.mcap']))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2
    for text in (done.stdout, done.stderr):
        assert 'pip install "six-wheel[bags]"' in text
        assert len(text.splitlines()) == 1
    assert not (tmp_path / "run.mcap").exists()
