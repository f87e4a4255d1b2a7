"""The command line: what it prints and writes, its exit codes, and one line for everything that is wrong."""

import io
import math
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")
pytest.importorskip("pyarrow")

import six_wheel as sw
from six_wheel import __main__, __version__
from six_wheel.cli import app as cli
from six_wheel.cli import shared
from six_wheel.cli.commands.show import left_turn
from six_wheel.cli.names import COMMANDS
from six_wheel.cli.shared import Chosen
from tests.cli_runs import ROVER, Run

EXAMPLES = Path(__file__).parents[2] / "examples"

# --- help ------------------------------------------------------------------------------------------------


def test_help_and_the_commands_agree(run: Run) -> None:
    code, overview, _ = run("--help")
    assert code == 0
    assert run("-h")[1] == overview
    for name, summary in COMMANDS.items():
        assert re.search(rf"^  {name} +{re.escape(summary)}$", overview, re.MULTILINE)
        code, text, _ = run(name, "--help")
        assert code == 0
        assert text.startswith(f"Usage: six-wheel {name} ")
        assert summary in " ".join(text.split())
    code, text, _ = run("drive", "-o", "run.csv", "--help")
    assert code == 0
    assert text.rstrip() == run("drive", "--help")[1].rstrip()
    assert {command.name for command in cli.app.registered_commands} <= {None, *COMMANDS}
    assert len(cli.app.registered_commands) == len(COMMANDS)


def test_without_a_command_there_is_the_overview_and_an_error(run: Run) -> None:
    code, out, _ = run()
    assert code == 2
    assert out == run("--help")[1]


def test_version(run: Run) -> None:
    assert run("--version") == (0, f"six-wheel {__version__}\n", "")


@pytest.mark.parametrize(
    ("arguments", "absent"),
    [
        (["--help"], ["typer", "rich", "numpy", "pyarrow"]),
        (["drive", "--help"], ["numpy", "pyarrow", "pydantic"]),
    ],
)
def test_help_loads_nothing_heavy(arguments: list[str], absent: list[str]) -> None:
    script = f"import sys; from six_wheel.__main__ import main; main({arguments}); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    loaded = done.stdout.splitlines()[-1].split()
    assert not set(absent) & set(loaded)


def test_without_typer_the_install_line_is_printed(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(__main__, "find_spec", lambda name: None)
    code, out, err = run("check", "rover.yaml")
    assert (code, out) == (2, "")
    assert err == (
        'six-wheel: the command line needs typer, which is not installed: pip install "six-wheel[cli]"\n'
    )


def test_other_missing_packages_name_the_install_line(
    refused: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    message = refused("drive", "rover.yaml", "commands.csv")
    assert message == 'this needs pyarrow, which is not installed: pip install "six-wheel[cli]"'


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["drvie"], "drvie"),
        (["check"], "ROVER"),
        (["drive", "rover.yaml"], "COMMANDS"),
        (["drive", "rover.yaml", "commands.csv", "--keap", "speed"], "--keap"),
        (["drive", "rover.yaml", "commands.csv", "--chunk-rows", "many"], "--chunk-rows"),
        (["drive", "rover.yaml", "commands.csv", "--chunk-rows", "0"], "chunk_rows must be positive, got 0"),
        (["show", "rover.yaml", "--twist", "1", "2"], "--twist"),
        (["show", "rover.yaml", "--twist", "1", "2", "fast"], "--twist"),
    ],
)
def test_wrong_usage_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused(*arguments)


# --- check -----------------------------------------------------------------------------------------------


def test_check_shows_what_a_rover_can_do(run: Run) -> None:
    code, out, err = run("check", "rover.yaml")
    assert (code, err) == (0, "")
    for words in ("front_left", "turn_rear_right", "-57.3° to 57.3°", "fixed"):
        assert words in out
    assert re.search(r"minimum radius +0\.721 m", out)  # 0.4 + 0.5 / tan(1)
    assert re.search(r"spin in place +possible, with the centre up to 0\.07895 m", out)  # 0.4 - 0.5 / tan(1)
    assert re.search(r"frames +odom to base_link", out)
    assert re.search(r"steering joints +turn_front_left, turn_front_right", out)


def test_check_says_that_noise_is_a_guess(run: Run) -> None:
    lines = [line for line in Path("rover.yaml").read_text().splitlines() if "noise" not in line]
    Path("guessed.yaml").write_text("\n".join(lines) + "\n")
    _, out, _ = run("check", "guessed.yaml")
    assert "a guess, wide on purpose: slip of 0.1 m per root m" in " ".join(out.split())
    Path("measured.yaml").write_text("\n".join([*lines, "noise: {slip: 0.01}"]) + "\n")
    _, out, _ = run("check", "measured.yaml")
    assert "slip 0.01" in out
    assert "guess" not in out


def test_check_knows_presets(run: Run) -> None:
    code, out, _ = run("check", "perseverance")
    assert code == 0
    assert re.search(r"minimum radius +none: every radius is possible", out)
    assert re.search(r"spin in place +possible\s", out)


def test_check_shows_every_mistake_at_once(run: Run) -> None:
    Path("bad.yaml").write_text(ROVER.replace("0.15", "-0.15").replace("d2: 0.5", "d2: wide"))
    code, out, err = run("check", "bad.yaml")
    assert (code, out) == (2, "")
    lines = err.splitlines()
    assert len(lines) == 2
    assert lines[0].startswith("bad.yaml:4: d2 ")
    assert lines[1].startswith("bad.yaml:7: wheel_radius ")


def test_check_shows_warnings_of_a_good_file(run: Run) -> None:
    Path("odd.yaml").write_text(ROVER + "wheel_colour: red\n")
    code, out, err = run("check", "odd.yaml")
    assert code == 0
    assert err.startswith("odd.yaml:9: warning: ")
    assert "wheel_colour" in err
    assert "minimum radius" in out


def test_a_rover_that_is_not_there(refused: Callable[..., str]) -> None:
    assert 'did you mean "perseverance"?' in refused("check", "persverance")
    assert "none.yaml" in refused("drive", "none.yaml", "commands.csv")


def test_a_value_that_is_no_number_is_shown(refused: Callable[..., str]) -> None:
    said = refused("show", "perseverance", "--twist", "a", "0", "0")
    assert said == "--twist must be a valid number, got 'a'; see six-wheel show --help"
    said = refused("drive", "perseverance", "commands.csv", "--rate", "quick")
    assert said == "--rate must be a valid number, got 'quick'; see six-wheel drive --help"


def test_other_commands_name_the_first_mistake_and_count_the_others(
    refused: Callable[..., str], run: Run
) -> None:
    Path("bad.yaml").write_text(ROVER.replace("0.15", "-0.15").replace("d2: 0.5", "d2: wide"))
    message = refused("drive", "bad.yaml", "commands.csv")
    assert message.startswith("bad.yaml:4: d2 ")
    assert message.endswith("; and 1 more: six-wheel check shows all")


# --- drive -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_drive_writes_a_table_a_picture_and_a_summary(run: Run, ending: str) -> None:
    pytest.importorskip("matplotlib")
    code, out, err = run("drive", "rover.yaml", "commands.csv", "-o", f"run.{ending}", "--plot", "run.png")
    assert (code, err) == (0, "")
    assert Path("run.png").read_bytes().startswith(b"\x89PNG")
    assert Path(f"run.{ending}").stat().st_size > 0
    for words in (r"rows +4\s", r"duration +3 s", r"path length +1\.5 m", r"projected rows +0\s"):
        assert re.search(words, out), words
    assert re.search(r"largest steering angle +0\.2\d+ rad \(\d+\.\d°\), front_left in row 2", out)
    assert re.search(rf"results +run\.{ending}", out)
    assert re.search(r"picture +run\.png", out)


def test_drive_without_outputs_is_a_summary(run: Run) -> None:
    before = sorted(Path().iterdir())
    code, out, _ = run("drive", "rover.yaml", "commands.csv")
    assert code == 0
    assert "end pose" in out
    assert sorted(Path().iterdir()) == before


def test_drive_projects_on_request(run: Run, refused: Callable[..., str]) -> None:
    Path("sideways.csv").write_text("time,vx,vy,omega\n0,0.5,0,0\n1,0.5,0.25,0\n2,0.5,0,0\n")
    message = refused("drive", "rover.yaml", "sideways.csv", "-o", "run.csv")
    assert message.startswith("sideways.csv: row 2 (line 3): ")
    assert "--keep curvature" in message
    code, out, _ = run("drive", "rover.yaml", "sideways.csv", "-o", "run.csv", "--keep", "curvature")
    assert code == 0
    assert re.search(r"projected rows +1, by at most 0 m/s, 0\.25 m/s, 0 rad/s", out)
    assert "keep must be one of" in refused("drive", "rover.yaml", "sideways.csv", "--keep", "all")


def test_check_says_what_the_limits_leave(run: Run) -> None:
    limits = "{speed: 0.6, deceleration: 0.5, yaw_rate: 1.8, wheel_speed: 2.0, steering_rate: 0.5}"
    Path("limited.yaml").write_text(ROVER + f"limits: {limits}\n")
    code, out, err = run("check", "limited.yaml", "--plot", "limits.png")
    assert (code, err) == (0, "")
    assert re.search(r"top speed +0\.3 m/s, bound by wheel speed", out)  # 2 rad/s at 0.15 m
    assert re.search(r"time to full lock +2 s", out)  # 1 rad
    assert re.search(r"stopping distance +0\.09 m in 0\.6 s", out)  # v^2 / 2a
    assert re.search(r"halt distance +0\.09 m in 0\.6 s", out)  # as deceleration, unless the file has its own
    found = " ".join(out[out.index("limits by default") :].split())
    reach = math.hypot(0.5, 0.4)  # of the farthest wheel
    assert f"angular_acceleration {9.81 / reach:.4g} (acceleration at the farthest wheel)" in found
    assert "halt_deceleration 0.5 (as deceleration)" in found
    assert "steering_rate" not in found.partition("noise")[0]  # the file has it
    Path("halting.yaml").write_text(ROVER + f"limits: {limits[:-1]}, halt_deceleration: 1.5}}\n")
    assert re.search(r"halt distance +0\.03 m in 0\.2 s", run("check", "halting.yaml")[1])
    assert Path("limits.png").read_bytes().startswith(b"\x89PNG")


def test_check_draws_no_picture_of_unlimited_motion(run: Run, refused: Callable[..., str]) -> None:
    assert "limits must bound every motion" in refused("check", "rover.yaml", "--plot", "limits.png")
    assert not Path("limits.png").exists()


def test_drive_says_what_is_over_a_limit(run: Run) -> None:
    Path("limited.yaml").write_text(ROVER + "limits: {wheel_speed: 2.0}\n")
    code, out, err = run("drive", "limited.yaml", "commands.csv", "--direct")
    assert (code, err) == (0, "")
    assert re.search(r"largest wheel speed .* of 2 allowed, .*, over the limit\s", out)


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
    while not any(path.name.startswith(".run.") for path in tmp_path.iterdir()):
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
    assert rover.admissible(left_turn(Chosen(rover, "rover")))


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_example_can_make_the_turn_that_show_draws(path):
    rover = sw.load(path)
    turn = left_turn(Chosen(rover, "rover"))
    assert rover.admissible(turn)
    assert turn[2] > 0


def test_show_draws_a_suspension_from_the_side(run, refused):
    code, out, _ = run("show", "open_source_rover", "--side", "-o", "side.svg")
    assert (code, Path(out.strip()).name) == (0, "side.svg")
    assert refused("show", "rover.yaml", "--side") == (
        "ROVER must have a suspension, as the kind rocker_bogie, the URDF of one, or one of "
        'perseverance, curiosity, rocky7, open_source_rover; got "rover.yaml"'
    )
