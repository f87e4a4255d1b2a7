"""Mistakes of newcomers at the lines of README and tutorials: one line that names argument and remedy."""

import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("scipy")

import six_wheel as sw


@cache
def names() -> dict[str, Any]:
    """Objects that the lines of the pages have made before, under their names there."""
    rover = sw.Rover.six_wheel(
        front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, wheel_radius=0.15, steering_limit=1.05
    )
    pair = sw.Rover.differential(track_width=0.4, wheel_radius=0.1)
    encoder = sw.Encoder(4096, wraps_at=65536)
    commands = [(0, 0.4, 0.0, 0.0), (6, 0.4, 0.0, 0.5), (9, 0.4, 0.0, 0.0)]
    drive = sw.simulate(pair, commands, wheel_encoders=encoder, seed=4)
    path = Path(tempfile.mkdtemp()) / "log.csv"
    drive.save(path, rover=pair)
    log = sw.read_log(path, pair, wheel_encoders=encoder)
    ground = sw.Terrain.yard((16.0, 10.0), spacing=0.1, cover=0.08, seed=3)
    suspension = sw.RockerBogie.preset("perseverance")
    stand = suspension.settle(ground, (4.0, 5.0, 0.0))
    return {
        "sw": sw, "np": np, "rover": rover, "pair": pair, "drive": drive, "log": log, "path": path,
        "track": sw.dead_reckon(pair, log), "limits": sw.Limits(speed=0.5), "commands": commands,
        "ground": ground, "suspension": suspension, "stand": stand, "folder": path.parent,
        "command": suspension.inverse(stand, (0.1, 0.0)),
    }  # fmt: skip


# The line, and the beginning of what it says.
MISTAKES = [
    ("sw.Twist('a')", "vx must be a number, got 'a'"),
    ("sw.Pose(None, 0, 0)", "x must be a number, got None"),
    ("sw.Terrain.yard('big')", "size must be one or two lengths, got 'big'"),
    ("sw.plot(rover, twist='a')", "twist must be real numbers, got 'a'"),
    ("sw.plot(rover, limits=0.5)", "limits must be a Limits, got 0.5"),
    ("sw.plot(limits, rover='rover.yaml')", "rover must be a Rover, got 'rover.yaml': give sw.load("),
    ("sw.plot(command, stand='x')", "stand must be a SettledPose, got 'x'"),
    ("sw.plot(track, truth=3)", "truth must be a GroundTruth, "),
    ("sw.simulate(pair, None)", "path must be rows of as many numbers each, got None"),
    (
        "sw.simulate(pair, 'commands.csv')",
        "path must be rows of as many numbers each, got 'commands.csv'; `six-wheel simulate` reads files",
    ),
    ("drive.save(folder / 'a.csv', rover='x')", "rover must be a Rover, got 'x': give sw.load('x')"),
    ("drive.to_csv(folder / 'a.csv', rover=3)", "rover must be a Rover, got 3"),
    (
        "sw.read_log(path, pair, wheel_encoders=4096)",
        "wheel_encoders must be an Encoder, or a dict of them by the names of joints, got 4096: give ",
    ),
    ("sw.read_log(None, pair)", "path must be a path or a table of named columns, such as a DataFrame or "),
    ("sw.read_log(np.zeros((3, 3)), pair)", "path must be a path or a table of named columns, such as "),
    ("sw.WheelLog.from_pandas(3, pair)", "frame must be a path or a table of named columns, such as "),
    ("sw.read_log('.', pair)", ".: the folder must hold metadata.yaml or "),
    ("sw.dead_reckon(log, pair)", "rover must be a Rover, got WheelLog("),
    ("sw.evaluate(track, None)", "truth must be poses, rows of three or six numbers, got None"),
    ("sw.calibrate(pair, log, parameters=['wheel_radus'])", "parameters must be some of wheel_radius, "),
]


@pytest.mark.parametrize(("line", "message"), MISTAKES, ids=[line for line, _ in MISTAKES])
def test_a_mistake_is_told_in_one_line(line: str, message: str) -> None:
    with pytest.raises((TypeError, ValueError)) as caught:
        eval(line, dict(names()))
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_a_parameter_that_is_misspelt_is_told_with_the_nearest() -> None:
    known = names()
    with pytest.raises(ValueError, match=r"got 'wheel_radus'; did you mean wheel_radius\?$"):
        sw.calibrate(known["pair"], known["log"], parameters=["wheel_radus"])
