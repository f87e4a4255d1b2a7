"""The lines under *Say this* give the same numbers again when they are run."""

import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.view.commands import command_line, python_lines
from tests.cli_runs import ROVER, Run

Open = Callable[..., Any]
SCENES: dict[str, tuple[tuple[Any, ...], dict[str, Any]]] = {
    "rocks": (("perseverance",), {"twist": (0.1, 0.0, -0.05), "at": (19.5, 18.0, 0.7), "tilt": 0.2}),
    "still": (("curiosity", "yard"), {"twist": (0.0, 0.0, 0.0), "wheel_speed": 0.3}),
    "plane": (("rocky7", "flat"), {"joints": (0.1, -0.2, 0.05), "scrub": {"front_left": 0.02}}),
    "planar": (("zoe",), {"twist": (0.2, 0.0, 0.1), "speed": 0.05, "steering_limit": 0.3}),
    "map": (("perseverance", "hills.asc"), {"at": (12.0, 11.0, -0.3)}),
    "rover.yaml": (("rover.yaml",), {"scrub": {"rear_left": -0.03}}),
    "record": (("run.csv",), {"rover": "husky"}),
}


@pytest.fixture
def files(run: Run) -> None:
    x = np.linspace(0.0, 6.0, 60)
    head = "ncols 60\nnrows 60\nxllcorner 0\nyllcorner 0\ncellsize 0.4"
    np.savetxt("hills.asc", 0.2 * np.add.outer(np.sin(x), np.cos(x)), header=head, comments="")
    Path("rover.yaml").write_text(ROVER)
    rows = [f"{t / 10},0.2,0,0.1" for t in range(50)]
    Path("table.csv").write_text("\n".join(["time,vx,vy,omega", *rows]) + "\n")
    assert run("drive", "husky", "table.csv", "-o", "run.csv")[0] == 0


@pytest.mark.parametrize("name", SCENES)
def test_the_lines_give_the_picture_again(
    opened: Open, run: Run, files: None, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    given, options = SCENES[name]
    view = opened(*given, **options)
    if view.time is not None:
        view.time = 3.2
    wanted = view.motion
    command = command_line(view._subject, view._state, view.time)
    assert command is not None
    seen: list[Any] = []

    def keep(again: Any, path: Any) -> Path:
        seen.append(again.motion)
        return Path(path)

    monkeypatch.setattr(type(view), "save", keep)
    program, *arguments = shlex.split(command)
    assert program == "six-wheel"
    assert run(*arguments, "--export", "page.html")[0] == 0
    lines = python_lines(view._subject, view._state, view.time)
    names: dict[str, Any] = {}
    monkeypatch.setattr("six_wheel.view.opening.browse", lambda url: False)
    exec(lines, names)
    with names["view"] as again:
        seen.append(again.motion)
    assert len(seen) == 2
    for motion in seen:
        np.testing.assert_allclose(motion.transform, wanted.transform, atol=1e-5)
        np.testing.assert_allclose(motion.twist, wanted.twist, atol=1e-6)
        np.testing.assert_allclose(motion.steering, wanted.steering, atol=1e-5)
        np.testing.assert_allclose(motion.wheel_speeds, wanted.wheel_speeds, atol=1e-5)
        np.testing.assert_allclose(motion.joints, wanted.joints, atol=1e-5)


def test_what_a_program_made_is_called_x(opened: Open) -> None:
    view = opened(sw.Rover.preset("husky"), twist=(0.1, 0.0, 0.0))
    assert command_line(view._subject, view._state) is None
    assert python_lines(view._subject, view._state) == (
        "import six_wheel as sw\nview = sw.view(x, twist=(0.1, 0, 0))"
    )
