"""`six-wheel simulate`: files in, files and pictures out, one line for what is wrong."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.cli_runs import Run

EXAMPLES = Path(__file__).parents[2] / "examples"


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
    results = ("-o", "run.csv", "--plot", "run.png", "--plot-speeds", "speeds.png")
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
        (("spirit", "over.csv"), "ROVER must be a parameter file or a preset"),
        (("perseverance", "none.csv"), "none.csv: no such file"),
        (
            ("perseverance", "over.csv", "--start", "1", "2"),
            "--start must be a valid number, got '--",
        ),
        (
            ("perseverance", "over.csv", "--start", "0", "0", "0"),
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


@pytest.mark.parametrize("name", ["run.csv", "run.parquet"])
def test_on_a_plane_a_log_is_as_noisy_as_its_file_and_reckons_back_to_its_truth(run: Run, name: str):
    for example in ("rover.yaml", "commands.csv"):
        Path(example).unlink(missing_ok=True)
        assert run("example", example)[0] == 0
    code, out, err = run("simulate", "rover.yaml", "commands.csv", "-o", name, "--plot", "run.png")
    assert (code, err) == (0, "")
    assert "distance" in out
    assert Path("run.png").read_bytes().startswith(b"\x89PNG")
    code, out, err = run("odometry", "rover.yaml", name)
    assert (code, err) == (0, "")
    assert "truth" in out or "ATE" in out


def test_counts_are_those_of_the_parameter_file(run: Run):
    Path("rover.yaml").write_text(
        "kind: differential\ntrack_width: 0.4\nwheel_radius: 0.1\n"
        "wheel_encoders: {ticks_per_turn: 42, gear_ratio: 5}\n"
    )
    Path("ahead.csv").write_text("time,vx,vy,omega\n0,0.5,0,0\n10,0.5,0,0\n")
    code, out, err = run("simulate", "rover.yaml", "ahead.csv", "-o", "run.csv")
    assert (code, err) == (0, "")
    assert "[ticks]" in Path("run.csv").read_text().splitlines()[0]
    code, out, err = run("odometry", "rover.yaml", "run.csv")
    assert (code, err) == (0, "")
    assert "5 m" in out


def test_speeds_on_level_ground_are_no_picture(refused: Callable[..., str]):
    Path("ahead.csv").write_text("time,vx,vy,omega\n0,0.5,0,0\n10,0.5,0,0\n")
    assert refused("simulate", "perseverance", "ahead.csv", "--plot-speeds", "speeds.png").startswith(
        "--plot-speeds must come with --ground"
    )


def test_a_suspension_of_ones_own_drives_over_a_map(run: Run, land: str):
    Path("own.yaml").write_text((EXAMPLES / "rocker_bogie.yaml").read_text(encoding="utf-8"))
    code, out, err = run("simulate", "own.yaml", "over.csv", "--ground", land)
    assert (code, err) == (0, "")
    assert "settled" in out
    assert run("show", "own.yaml", "--side")[0] == 0
    assert Path("own_from_the_side.png").read_bytes().startswith(b"\x89PNG")


def test_a_rover_without_a_suspension_stays_on_the_plane(refused: Callable[..., str], land: str):
    Path("flat.yaml").write_text("kind: differential\ntrack_width: 0.4\nwheel_radius: 0.1\n")
    said = refused("simulate", "flat.yaml", "over.csv", "--ground", land)
    assert said.startswith("ROVER must have a suspension, as the kind rocker_bogie")


@pytest.mark.parametrize("ground", [(), ("--ground", "map.asc")])
def test_a_path_is_driven_from_its_first_pose_to_its_last(run: Run, land: str, ground: tuple[str, ...]):
    Path("path.csv").write_text("time,x,y,yaw\n0,4,4,0\n1,5,4,0\n2,6,4.2,0.4\n")
    code, out, err = run("simulate", "perseverance", "path.csv", *ground, "--speed", "0.2", "-o", "run.csv")
    assert (code, err) == (0, "")
    assert "10" in out.partition("duration")[2]  # 2.03 m at 0.2 m/s
    rows = np.genfromtxt("run.csv", delimiter=",", names=True, deletechars="")
    names = [name for name in rows.dtype.names or () if name.split("_")[0] in ("x", "y")][:2]
    ends = [[float(rows[name][k]) for name in names] for k in (0, -1)]
    np.testing.assert_allclose(ends, [[4, 4], [6, 4.2]], atol=0.03)


def test_neither_commands_nor_a_path(refused: Callable[..., str]):
    Path("odd.csv").write_text("time,a,b\n0,1,2\n1,2,3\n")
    assert "vx" in refused("simulate", "perseverance", "odd.csv")
