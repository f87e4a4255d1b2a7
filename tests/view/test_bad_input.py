"""Whatever cannot be shown is said in one line, before a port is opened."""

import inspect
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.view.opening import browse
from six_wheel.view.scene.ground import POINTS, cut
from six_wheel.view.subject import find_subject
from tests.cli_runs import Run

Open = Callable[..., Any]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["perseverence"], 'x must be a file or a preset, got "perseverence"; did you mean "perseverance"?'),
        (["missing.yaml"], "missing.yaml: "),
        (["missing.mcap"], "missing.mcap: no such file"),
        (["missing.urdf"], "missing.urdf: "),
        (["missing.csv", "--rover", "husky"], "missing.csv: no such file"),
        (["commands.csv"], "commands.csv: rover must say whose record it is; give --rover ROVER"),
        (["notes.txt"], "notes.txt: no such file"),
        (["husky", "--ground", "yard"], "ground must be left out for a rover without a suspension, got yard"),
        (["perseverance", "--ground", "missing.tif"], "missing.tif must be a file, there is none"),
        (["husky", "--port", "70000"], "port must be from 0 to 65535, got 70000"),
        (["husky", "--port", "many"], "--port must be a valid integer"),
        (
            ["husky", "--steering-limit", "20"],
            "steering_limit must be left out for a rover that does not steer",
        ),
        (
            ["perseverance", "--steering-limit", "120"],
            "steering_limit must be positive and at most 1.5708 rad",
        ),
        (["husky", "--twist", "nan", "0", "0"], "twist must be three finite numbers, got"),
        (["husky", "--at", "inf", "0", "0"], "at must be three finite numbers, got"),
        (["husky", "--time", "3"], "time must be left alone without a record"),
        (["husky", "--scrub", "front=0.1"], "scrub must be by names of wheels (front_left, "),
        (
            ["husky", "--scrub", "front_left"],
            'scrub must be WHEEL=M, such as "front_left=0.05", got "front_left"',
        ),
        (["husky", "--scrub", "front_left=inf"], "scrub must be finite, got inf for front_left"),
        (["perseverance", "--scrub", "front_left=0.1"], "scrub must be left out on ground and for a record"),
        (["perseverance", "--joints", "1", "2", "3"], "joints must be left out unless a suspension is shown"),
        (["husky", "--wheel-speed", "0"], "wheel_speed must be finite and positive, got 0"),
        (["husky", "--speed", "nan"], "speed must be finite and positive, got nan"),
        (["husky", "--theme", "pink"], 'theme must be dark or light, got "pink"'),
        (["husky", "--export", "page.png"], 'path must end in .html, got "page.png"'),
        (["husky", "--export", "nowhere/page.html"], "the folder of the output must exist"),
    ],
)
def test_the_command_refuses_in_one_line(
    refused: Callable[..., str], arguments: list[str], message: str
) -> None:
    assert message in refused("view", *arguments)


@pytest.mark.parametrize("content", [b"", b"\x89MCAP0\r\n", b"\x00" * 100, b"time,x\n1,2\n"])
@pytest.mark.parametrize("name", ["bad.mcap", "bad.csv", "bad.parquet", "bad.yaml", "bad.urdf"])
def test_a_broken_file_is_one_line(refused: Callable[..., str], name: str, content: bytes, run: Run) -> None:
    Path(name).write_bytes(content)
    assert name in refused("view", name, "--rover", "husky")


def test_a_table_whose_time_runs_backwards(refused: Callable[..., str], run: Run) -> None:
    rows = ["time,x,y,yaw,vx,vy,omega", "0,0,0,0,0,0,0", "1,0,0,0,0,0,0", "0.5,0,0,0,0,0,0"]
    Path("bad.csv").write_text("\n".join(rows) + "\n")
    said = refused("view", "bad.csv", "--rover", "husky")
    assert said == "bad.csv: time must not run backwards, got 0.5 s in row 3"
    Path("bad.csv").write_text("\n".join([rows[0], "0,word,0,0,0,0,0"]) + "\n")
    assert "the column x must hold numbers" in refused("view", "bad.csv", "--rover", "husky")


def test_what_is_nothing_to_see_is_a_type_error() -> None:
    for x in (3, None, object(), sw.Suspension.preset("zoe")):
        with pytest.raises(TypeError, match="x must be a"):
            find_subject(x)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sw.view("husky", twst=(0, 0, 0)), "view() has no twst; did you mean twist? It takes x, "),
        (lambda: sw.view(), "view() needs the argument x"),
        (lambda: sw.view("husky", speed="fast"), "speed must be a number, got 'fast'"),
        (lambda: sw.view("perseverance", steering_limit=[0.1]), "steering_limit must be a number, got [0.1]"),
    ],
)
def test_arguments_are_named_as_those_of_other_calls(call: Callable[[], Any], message: str) -> None:
    """They were in words of Python, which named no keyword that was meant."""
    with pytest.raises(TypeError, match="^" + re.escape(message)):
        call()
    assert list(inspect.signature(sw.view).parameters)[:3] == ["x", "ground", "rover"]


def test_a_missing_extra_is_named_with_its_install_line() -> None:
    code = (
        "import sys; sys.modules['viser'] = None\n"
        "import importlib.util as u; find = u.find_spec\n"
        "u.find_spec = lambda name, *rest: None if name == 'viser' else find(name, *rest)\n"
        "from six_wheel.__main__ import main; sys.exit(main(['view', 'husky']))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    wanted = 'six-wheel: the view needs viser: pip install "six-wheel[view]"\n'
    assert (done.returncode, done.stdout, done.stderr) == (2, "", wanted)


def test_importing_the_package_loads_no_viser() -> None:
    code = "import six_wheel as sw, sys; sw.view; print('viser' in sys.modules, 'trimesh' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


def test_without_a_display_no_browser_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    import webbrowser

    for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(webbrowser, "open", lambda url: pytest.fail("it was opened"))
    assert not browse("http://127.0.0.1:1")

    def broken(url: str) -> bool:
        raise webbrowser.Error("no browser")

    monkeypatch.setenv("DISPLAY", ":9")
    monkeypatch.setattr(webbrowser, "open", broken)
    assert not browse("http://127.0.0.1:1")


@pytest.mark.slow
def test_a_map_of_ten_thousand_cells_square_is_cut_to_what_is_seen(opened: Open) -> None:
    rows = np.arange(10_000, dtype=np.float32)
    large = sw.Terrain(np.add.outer(np.sin(rows / 40.0), np.sin(rows / 60.0)), 0.1, (4e5, 4.2e6))
    points, _ = cut(large, np.array([400_500.0, 4_200_500.0]), 14.0)
    assert len(points) <= POINTS
    view = opened("perseverance", large)
    assert view.motion.stands
    position = view._server.scene.get_handle_by_name("/world/rover").position
    assert np.abs(position).max() < 10.0  # the browser has single precision


def test_a_callback_that_fails_is_said_and_the_view_goes_on(
    opened: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    from six_wheel.view import viewing

    view, find = opened("husky"), viewing.find_motion
    monkeypatch.setattr(viewing, "find_motion", lambda *_: 1 / 0)
    view._ask()
    view._worker.wait()
    assert "ZeroDivisionError" in view._panels.status.content
    monkeypatch.setattr(viewing, "find_motion", find)
    view.twist = (0.1, 0.0, 0.0)
    assert "possible as commanded" in view._panels.status.content
