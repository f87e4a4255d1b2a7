"""`drive --halt` and `simulate --stick`: in the table, in the results and in the picture."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")
pytest.importorskip("pyarrow")
pytest.importorskip("matplotlib")

from tests.cli_runs import ROVER, Run

LIMITED = ROVER + "limits: {speed: 0.4, acceleration: 0.5, wheel_speed: 3.0, halt_deceleration: 2.0}\n"


def test_drive_halts_on_its_way(run: Run, refused: Callable[..., str]) -> None:
    Path("limited.yaml").write_text(LIMITED)
    Path("straight.csv").write_text("time,vx,omega\n" + "".join(f"{k / 10},0.5,0\n" for k in range(31)))
    code, out, err = run(
        "drive", "limited.yaml", "straight.csv", "--halt", "1.5", "-o", "run.csv", "--plot", "run.png"
    )
    assert (code, err) == (0, ""), err
    assert re.search(r"halted +at 1\.5 s, at 2 m/s\^2", out)
    assert re.search(r"limited by .*HALTED", " ".join(out.split()))
    assert Path("run.png").read_bytes().startswith(b"\x89PNG")
    table = np.genfromtxt("run.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    before, after = table[table["time"] < 1.5], table[table["time"] >= 1.5]
    assert not any("HALTED" in names for names in before["reason_names"])
    assert all("HALTED" in names for names in after["reason_names"])
    assert before["vx"][-1] > 0.35
    assert abs(after["vx"][after["time"] > 1.5 + 0.4 / 2.0 + 0.05]).max() == 0.0
    assert "--halt must be left out" in refused(
        "drive", "rover.yaml", "commands.csv", "--direct", "--halt", "1"
    )
    assert "halt must be finite and not negative" in refused(
        "drive", "limited.yaml", "straight.csv", "--halt", "-1"
    )
    assert (
        "halt must be before the drive ends"
        in run("drive", "limited.yaml", "straight.csv", "--halt", "99")[2]
    )


def test_a_joint_that_sticks_is_found(run: Run, refused: Callable[..., str]):
    Path("limited.yaml").write_text(f"{ROVER}limits: {{speed: 0.6, acceleration: 0.5, steering_rate: 1.0}}\n")
    Path("turn.csv").write_text("time,vx,omega\n0,0.4,0.2\n3,0.4,0.2\n4,0.4,-0.3\n9,0.4,-0.3\n")
    arguments = ("simulate", "limited.yaml", "turn.csv", "--stick", "turn_front_left@3")
    code, out, err = run(*arguments, "-o", "run.csv", "--plot", "run.png")
    assert (code, err) == (0, ""), err
    words = " ".join(out.split())
    assert re.search(
        r"found stuck turn_front_left at [34]\.\d+ s, -?0\.\d+ rad off its command: halted", words
    )
    assert re.search(r"limited by .*JOINT_STUCK", words)
    assert Path("run.png").read_bytes().startswith(b"\x89PNG")
    assert "--stick must be JOINT@T" in refused(*arguments[:-1], "turn_front_left")
    assert "stick must name a steering joint" in refused(*arguments[:-1], "wheel@3")
