"""The command convert, lists as options, and pictures that are named by the command."""

from pathlib import Path

import pytest

import six_wheel as sw
from six_wheel.cli.app import with_pictures
from six_wheel.cli.shared import several
from tests.cli_runs import Run


def test_a_rover_goes_from_one_kind_of_file_to_the_other(run: Run) -> None:
    for first, second in (("perseverance", "a.urdf"), ("a.urdf", "b.yaml"), ("b.yaml", "c.yml")):
        code, out, err = run("convert", first, second)
        assert (code, err) == (0, "")
        assert Path(out.strip()) == Path(second).resolve()
    assert sw.load("c.yml").wheel_names == sw.Rover.preset("perseverance").wheel_names


def test_a_parameter_file_keeps_all_else_that_it_says(run: Run) -> None:
    text = Path("rover.yaml").read_text()
    code, _, _ = run("convert", "rover.yaml", "again.yaml")
    assert code == 0
    assert sw.load("again.yaml") == sw.load("rover.yaml")
    assert ("limits:" in text) == ("limits:" in Path("again.yaml").read_text())
    code, _, err = run("convert", "rover.yaml", "rover.yaml")
    assert code == 2
    assert "must be another file" in err


def test_values_come_by_commas_or_by_repeating_the_option() -> None:
    assert several(["a,b", "c"]) == ["a", "b", "c"]
    assert several(["x=1,y=2", "z=3"], "=") == ["x=1", "y=2", "z=3"]
    assert several(["key=[1,2]"], "=") == ["key=[1,2]"]
    assert several(None) == []


@pytest.mark.parametrize(
    ("given", "made"),
    [
        ("show rover.yaml --plot", "show rover.yaml --plot rover_show.png"),
        ("drive a/osr.yaml c.csv --plot -o b.csv", "drive a/osr.yaml c.csv --plot osr_drive.png -o b.csv"),
        ("drive osr.yaml c.csv --plot x.svg", "drive osr.yaml c.csv --plot x.svg"),
        ("odometry --example --plot", "odometry --example --plot six-wheel_odometry.png"),
    ],
)
def test_a_picture_without_a_name_is_called_after_rover_and_command(given: str, made: str) -> None:
    assert with_pictures(given.split()) == made.split()


def test_a_picture_without_a_name_is_drawn(run: Run) -> None:
    code, _, err = run("drive", "rover.yaml", "commands.csv", "--plot")
    assert (code, err) == (0, "")
    assert Path("rover_drive.png").read_bytes().startswith(b"\x89PNG")
