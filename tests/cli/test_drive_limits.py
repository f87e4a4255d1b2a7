"""The commands drive and show: limits, plots, files that cannot be written."""

import io
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import six_wheel as sw
from six_wheel.cli import shared
from six_wheel.cli.commands.show import left_turn
from six_wheel.robot_description.named_rover import NamedRover
from tests.cli_runs import ROVER, Run

EXAMPLES = Path(__file__).parents[2] / "examples"
LIMITED = ROVER + "limits: {speed: 0.4, acceleration: 0.5, wheel_speed: 3.0}\n"
WAITING = "control: {timeout: 2.0}\n"  # the commands are a second apart


def test_drive_goes_through_the_controller_if_there_are_limits(run: Run) -> None:
    Path("limited.yaml").write_text(LIMITED + WAITING)
    code, out, err = run("drive", "limited.yaml", "commands.csv", "-o", "run.csv")
    assert (code, err) == (0, "")
    assert re.search(r"driven +the controller, at 50 Hz\s", out)
    assert re.search(r"largest speed +0\.4 m/s of 0\.4 allowed, in row \d+\s", out)
    assert re.search(r"limited by +(\w+ \d+\.\d%(, )?)*SPEED \d+\.\d%", out)
    assert "over the limit" not in out
    assert Path("run.csv").read_text().splitlines()[0].endswith("limited_omega,reasons,reason_names")


def test_drive_warns_of_commands_too_far_apart(run: Run) -> None:
    Path("limited.yaml").write_text(LIMITED)
    code, out, err = run("drive", "limited.yaml", "commands.csv")
    assert code == 0
    words = "commands are up to 1 s apart, longer than the timeout of 0.5 s: meanwhile the rover stops; "
    words += "a longer control.timeout lets it go on"
    assert err == f"six-wheel: warning: {words}\n"
    assert re.search(r"STALE \d+\.\d%", out)


def test_drive_at_a_rate_or_directly(run: Run, refused: Callable[..., str]) -> None:
    Path("limited.yaml").write_text(LIMITED + "control: {period: 0.01}\n")
    assert "at 100 Hz" in run("drive", "limited.yaml", "commands.csv")[1]
    assert "at 20 Hz" in run("drive", "limited.yaml", "commands.csv", "--rate", "20")[1]
    code, out, _ = run("drive", "rover.yaml", "commands.csv", "--rate", "200")
    assert code == 0
    assert "the controller, at 200 Hz" in out
    for arguments in (["limited.yaml", "commands.csv", "--direct"], ["rover.yaml", "commands.csv"]):
        out = run("drive", *arguments)[1]
        assert re.search(r"driven +directly", out)
        assert "limited by" not in out
    for rate, words in (("0", "positive, got 0"), ("nan", "got nan"), ("5", "at least 10 Hz")):
        assert words in refused("drive", "limited.yaml", "commands.csv", "--rate", rate)
    words = "--rate must be left out with --direct"
    assert words in refused("drive", "limited.yaml", "commands.csv", "--rate", "50", "--direct")


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("", "at least one row"),
        ("0,nan,0\n", "row 1 (line 2): vx must be finite, got nan"),
        ("0,1,0\n0,1,0\n", "row 2 (line 3): time must increase, got 0.0 after 0.0"),
        ("0,1,0\n1,1\n", "row 2 (line 3): a row must have 3 cells"),
        ("0,1,zero\n", 'row 1 (line 2): omega must be a number, got "zero"'),
        ("0,1e308,0\n", "row 1 (line 2): twist must keep every wheel speed finite"),
    ],
)
def test_bad_tables_are_one_line_and_leave_the_output_alone(
    refused: Callable[..., str], rows: str, words: str
) -> None:
    Path("bad.csv").write_text("time,vx,omega\n" + rows)
    Path("run.csv").write_text("precious")
    assert words in refused("drive", "rover.yaml", "bad.csv", "-o", "run.csv")
    assert Path("run.csv").read_text() == "precious"


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("run.txt", 'must be .csv, .parquet or .mcap, got ".txt"'),
        ("commands.csv", "must be another file than commands.csv"),
        ("none/run.csv", "the folder of the output must exist"),
    ],
)
def test_bad_outputs(refused: Callable[..., str], output: str, words: str) -> None:
    assert words in refused("drive", "rover.yaml", "commands.csv", "-o", output)


def test_a_picture_that_cannot_be_drawn_leaves_no_table(refused: Callable[..., str]) -> None:
    pytest.importorskip("matplotlib")
    message = refused("drive", "rover.yaml", "commands.csv", "-o", "run.csv", "--plot", "run.xyz")
    assert message == 'run.xyz: the ending must be one of .png, .svg, .pdf, got ".xyz"'
    assert 'got ""' in refused("show", "rover.yaml", "-o", "run")


def test_the_rover_file_is_not_overwritten(refused: Callable[..., str]) -> None:
    Path("rover.csv").write_text(ROVER)
    assert "another file than rover.csv" in refused("drive", "rover.csv", "commands.csv", "-o", "rover.csv")


def test_progress_is_shown_on_a_terminal(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    from rich.console import Console

    screen = io.StringIO()
    console = Console(file=screen, force_terminal=True, width=100)
    monkeypatch.setattr(shared, "new_console", lambda stderr=False: console)
    monkeypatch.setattr(shared, "PROGRESS_AFTER", 0.0)
    run("drive", "rover.yaml", "commands.csv", "--chunk-rows", "1")
    assert "driving commands.csv" in screen.getvalue()
    assert "100%" in screen.getvalue()


@pytest.mark.skipif(os.name != "posix", reason="sends SIGINT")
def test_ctrl_c_leaves_nothing_behind(tmp_path: Path) -> None:
    with (tmp_path / "long.csv").open("w") as file:
        file.write("time,vx,omega\n")
        file.writelines(f"{k},0.5,0\n" for k in range(1_000_000))
    arguments = ["drive", "curiosity", "long.csv", "-o", "run.csv", "--chunk-rows", "1000"]
    command = [sys.executable, "-m", "six_wheel", *arguments]
    # A shell that starts a job in the background has it ignore SIGINT, and so would its children.
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    deadline = time.monotonic() + 30
    while {path.name for path in tmp_path.iterdir()} == {"long.csv"}:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out, err) == (130, b"", b"")
    assert [path.name for path in tmp_path.iterdir()] == ["long.csv"]


# --- show, demo, bench -----------------------------------------------------------------------------------


def test_show_draws_and_says_where(run: Run, refused: Callable[..., str]) -> None:
    pytest.importorskip("matplotlib")
    code, out, _ = run("show", "rover.yaml")
    assert code == 0
    assert out.strip() == str(Path("rover_from_above.png").resolve())
    assert Path("rover_from_above.png").read_bytes().startswith(b"\x89PNG")
    code, out, _ = run("show", "perseverance", "--twist", "-0.5", "0", "-0.3", "-o", "p.svg")
    assert code == 0
    assert "<svg" in Path("p.svg").read_text()
    assert "steer" in refused("show", "rover.yaml", "--twist", "0.5", "0", "1.0")
    assert "finite" in refused("show", "rover.yaml", "--twist", "nan", "0", "0")


def test_show_keeps_to_the_limits_of_the_file_or_says_so(run: Run) -> None:
    # Once it drew 11.34 rad/s under wheel_speed: 8.0, without a word.
    pytest.importorskip("matplotlib")
    Path("slow.yaml").write_text(ROVER + "limits: {wheel_speed: 2.0, speed: 1.0}\n")
    code, _, err = run("show", "slow.yaml", "-o", "slow.svg")
    assert (code, err) == (0, "")
    speeds = [float(each) for each in re.findall(r">(-?\d+\.\d+) rad/s", Path("slow.svg").read_text())]
    assert all(abs(speed) <= 2.0 for speed in speeds)
    code, _, err = run("show", "slow.yaml", "--twist", "1.5", "0", "0")
    assert code == 0
    assert err.splitlines() == [
        "six-wheel: warning: wheel_speed is 10 rad/s, 2 allowed",
        "six-wheel: warning: speed is 1.5 m/s, 1 allowed",
    ]


def test_examples_are_files_that_the_commands_take(run: Run, refused: Callable[..., str]) -> None:
    code, out, _ = run("example")
    assert (code, out.split()) == (0, ["commands.csv", "log.csv", "map.asc", "rover.yaml"])
    Path("own").mkdir()
    for name in out.split():
        assert run("example", name, "-o", f"own/{name}")[0] == 0
    assert "there already" in refused("example", "rover.yaml")
    assert 'did you mean "log.csv"?' in refused("example", "lgo.csv")
    assert sw.Terrain.read("own/map.asc").shape == (65, 65)
    assert run("check", "own/rover.yaml")[0] == 0
    code, out, err = run("drive", "own/rover.yaml", "own/commands.csv", "-o", "run.csv")
    assert (code, err) == (0, "")
    assert re.search(r"projected rows +200 steps, by the controller", out)  # once 0, beside PROJECTED
    assert "PROJECTED 20.0%" in " ".join(out.split())
    code, out, _ = run("odometry", "own/rover.yaml", "own/log.csv")
    assert code == 0
    assert re.search(r"slip +middle_right, 12\.1 s to 13\.5 s", out)


def test_demo_is_given_its_folder(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    from six_wheel.cli.demo import running as demo

    folders = []
    monkeypatch.setattr(demo, "run", lambda directory, *, console: folders.append(directory))
    assert run("demo")[0] == 0
    assert run("demo", "-o", "here")[0] == 0
    assert folders == [Path("six_wheel_demo"), Path("here")]


def test_bench_compares_both_sides(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    from six_wheel.cli import benchmark

    monkeypatch.setattr(benchmark, "ROWS", 500)
    monkeypatch.setattr(benchmark, "REPEATS", 1)
    monkeypatch.setattr(benchmark, "SPAN", 1e-5)
    code, out, _ = run("bench")
    assert code == 0
    for name in ("inverse, one call", "forward, batch of 500 rows", "integrate, batch"):
        assert name in out
    assert all(0 < timing.best < 1 for job in benchmark.measure() for timing in job.timings.values())


@pytest.mark.parametrize("name", sw.Rover.presets())
def test_every_preset_can_make_the_turn_that_show_draws(name):
    rover = sw.Rover.preset(name)
    assert rover.admissible(left_turn(NamedRover(rover, "rover")))


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_example_can_make_the_turn_that_show_draws(path):
    rover = sw.load(path)
    turn = left_turn(NamedRover(rover, "rover"))
    assert rover.admissible(turn)
    assert turn[2] > 0


def test_show_draws_a_suspension_from_the_side(run, refused):
    code, out, _ = run("show", "open_source_rover", "--side", "-o", "side.svg")
    assert (code, Path(out.strip()).name) == (0, "side.svg")
    assert refused("show", "rover.yaml", "--side") == (
        "ROVER must have a suspension, as the kind rocker_bogie, the URDF of one, or one of "
        'perseverance, curiosity, rocky7, open_source_rover; got "rover.yaml"'
    )
