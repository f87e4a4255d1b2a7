"""`six-wheel simulate`: files in, files and pictures out, one line for what is wrong."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.cli_runs import Run


@pytest.fixture
def land(run: Run) -> str:
    """A level map with a bump, as an ESRI grid."""
    heights = np.zeros((80, 120))
    heights[38:43, 60:64] = 0.1
    header = "ncols 120\nnrows 80\nxllcorner 0\nyllcorner 0\ncellsize 0.1\nNODATA_value -9999"
    np.savetxt("map.asc", heights, fmt="%.2f", header=header, comments="")
    Path("over.csv").write_text("time,vx,vy,omega\n0,0.1,0,0\n6,0.1,0,0.02\n")
    return "map.asc"


def test_results_and_pictures_are_written(run: Run, land: str):
    results = ("-o", "run.csv", "--plot", "run.png", "--speeds", "speeds.png")
    code, out, err = run("simulate", "perseverance", "over.csv", "--ground", land, *results)
    assert (code, err) == (0, "")
    assert "settled" in out
    assert "largest tilt" in out
    header = Path("run.csv").read_text().splitlines()[0]
    assert "front_left_contact_angle" in header
    for picture in ("run.png", "speeds.png"):
        assert Path(picture).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [  # ROVER and COMMANDS, then options beside the map
        (("spirit", "over.csv"), "ROVER must be a preset with a suspension"),
        (("perseverance", "none.csv"), "none.csv: no such file"),
        (
            ("perseverance", "over.csv", "--start", "1,2"),
            "--start must be three numbers",
        ),
        (
            ("perseverance", "over.csv", "--start", "0,0,0"),
            "path must stay on the map",
        ),
        (("perseverance", "over.csv", "-o", "run.txt"), "run.txt: the ending must be"),
        (
            ("perseverance", "over.csv", "--plot", "run.txt"),
            "run.txt: the ending must be",
        ),
    ],
)
def test_what_is_wrong_is_one_line(
    refused: Callable[..., str], land: str, arguments: tuple[str, ...], message: str
):
    assert refused("simulate", *arguments, "--ground", land).startswith(message)
