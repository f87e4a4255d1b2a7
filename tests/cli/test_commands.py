"""The command line: what it prints and writes, its exit codes, and one line for everything that is wrong."""

import math
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import typer

from six_wheel import __main__, __version__
from six_wheel.cli import app as cli
from six_wheel.cli.names import COMMANDS
from tests.cli_runs import ROVER, Run

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


@pytest.mark.parametrize("name", ["nothing.tif", "nothing.npy", "nothing.csv"])
def test_a_map_that_is_missing_is_no_rover(refused: Callable[..., str], name: str) -> None:
    """`show nothing.tif` asked for the path of a parameter file."""
    assert refused("show", name).startswith(f"{name} must be a file, there is none")


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
        (["node", "rover.yaml", "a:=1"], "arguments of ROS must follow --ros-args, got a:=1"),
        (
            ["node", "-p", "a:=1"],
            "No such option: -p; arguments of ROS must follow --ros-args; see six-wheel",
        ),
    ],
)
def test_wrong_usage_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused(*arguments)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_misspelt_option_is_told_with_the_nearest(refused: Callable[..., str], command: str) -> None:
    """A node took a misspelt option for its ROVER."""
    group: Any = typer.main.get_command(cli.app)
    for parameter in group.commands[command].params:
        option = parameter.opts[-1]
        if option.startswith("--") and len(option) > 5:
            words = refused(command, f"{option[:-1]}q", "1")
            assert f"No such option: {option[:-1]}q (Possible options: " in words
            assert option in words


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


def test_check_says_that_noise_is_that_of_a_typical_rover(run: Run) -> None:
    lines = [line for line in Path("rover.yaml").read_text().splitlines() if "noise" not in line]
    Path("guessed.yaml").write_text("\n".join(lines) + "\n")
    _, out, _ = run("check", "guessed.yaml")
    assert "that of a typical rover, slip of 0.03 m per root m" in " ".join(out.split())
    Path("measured.yaml").write_text("\n".join([*lines, "noise: {slip: 0.01}"]) + "\n")
    _, out, _ = run("check", "measured.yaml")
    assert "slip 0.01" in out
    assert "typical" not in out


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


def test_only_a_node_speaks_of_ros(refused: Callable[..., str]) -> None:
    """A misspelt command was told that arguments of ROS must follow --ros-args."""
    assert (
        refused("odometri", "a")
        == "No such command 'odometri'. Did you mean 'odometry'?; see six-wheel --help"
    )
