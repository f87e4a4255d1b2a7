"""The examples run, and every parameter file among them loads."""

import runpy
from pathlib import Path

import pytest

import six_wheel as sw

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize("example", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_examples_run(example, capsys):
    runpy.run_path(str(example), run_name="__main__")
    assert capsys.readouterr().out


@pytest.mark.parametrize("example", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_parameter_files_load(example):
    rover = sw.load(example)
    twist = rover.project((0.2, 0.0, 0.05))
    assert abs(rover.forward(*rover.inverse(twist)) - twist).max() < 1e-12
