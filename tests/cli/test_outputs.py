"""Files that commands write: never one that is read, never one twice, all or none; ends by signals."""

import inspect
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, get_args

import pytest

import six_wheel
from six_wheel.cli import app
from six_wheel.cli.shared import WRITTEN
from six_wheel.logs.headers.columns import TableError
from six_wheel.logs.writing import _beside, replacing, together
from tests.cli_runs import Run

READ = {"commands", "ground", "log", "logs", "map", "record", "truth"}  # parameters that name files to read


def parameters(command: Any) -> dict[str, Any]:
    """Parameters of a command that are paths, or texts that may be, by name."""
    signature = inspect.signature(command.callback)
    return {name: p for name, p in signature.parameters.items() if "Path" in str(p.annotation)}


COMMANDS = {
    command.name or command.callback.__name__: command
    for command in app.app.registered_commands
    if (command.name or command.callback.__name__) not in ("demo", "bench")
}


@pytest.mark.parametrize("name", COMMANDS)
def test_every_path_is_known_as_read_or_written(name: str) -> None:
    assert parameters(COMMANDS[name]).keys() <= READ | set(WRITTEN)


def option(parameter: inspect.Parameter) -> list[str]:
    """Name of an option on the command line; none of an argument."""
    info = next(each for each in get_args(parameter.annotation) if hasattr(each, "param_decls"))
    if type(info).__name__ == "ArgumentInfo":
        return []
    default = f"--{parameter.name}".replace("_", "-")
    return [next((each for each in info.param_decls or () if each.startswith("--")), default)]


def pairs() -> list[tuple[str, str]]:
    return [(name, each) for name in COMMANDS for each in parameters(COMMANDS[name]) if each in WRITTEN]


@pytest.mark.parametrize(("name", "output"), pairs())
@pytest.mark.parametrize("spelling", ["same", "other", "symbolic", "hard", "chain"])
def test_no_command_writes_what_it_reads(run: Run, name: str, output: str, spelling: str) -> None:
    """`simulate commands.csv -o commands.csv` once replaced its input."""
    run("--version")  # in the folder of the run
    arguments, files = [name], []
    for parameter in inspect.signature(COMMANDS[name].callback).parameters.values():
        info = next((each for each in get_args(parameter.annotation) if hasattr(each, "metavar")), None)
        if type(info).__name__ == "ArgumentInfo" and parameter.name != output:
            path = Path("rover.yaml" if parameter.name == "rover" else f"{parameter.name}.csv")
            if parameter.name != "rover":
                path.write_text("time,vx,vy,omega\n0,0.1,0,0\n1,0.1,0,0\n")
            arguments.append(str(path))
            files.append(path)
        elif parameter.default is inspect.Parameter.empty and parameter.name != output:
            given = f"{parameter.name}.tif" if parameter.name in WRITTEN else "perseverance"
            arguments += [f"--{parameter.name}", given]
    if not files:
        pytest.skip("reads no file")
    for source in files:
        before = source.read_bytes()
        target = Path(f"link{source.suffix}")
        target.unlink(missing_ok=True)
        Path("between.csv").unlink(missing_ok=True)
        match spelling:
            case "same":
                target = source
            case "other":
                target = Path("..") / Path.cwd().name / source
            case "symbolic":
                target.symlink_to(source)
            case "hard":
                os.link(source, target)
            case "chain":
                Path("between.csv").symlink_to(source)
                target.symlink_to("between.csv")
        written = inspect.signature(COMMANDS[name].callback).parameters[output]
        code, _, err = run(*arguments, *option(written), str(target))
        assert code == 2
        assert err.count("\n") == 1
        assert "must be another file than" in err
        assert source.read_bytes() == before


def test_two_outputs_are_two_files(run: Run) -> None:
    code, _, err = run("drive", "rover.yaml", "commands.csv", "-o", "run.csv", "--plot", "./run.csv")
    assert (code, Path("run.csv").exists()) == (2, False)
    assert "must be two files" in err


def test_all_outputs_are_replaced_or_none(run: Run) -> None:
    run("--version")
    Path("run.csv").write_text("before")
    Path("run.png").mkdir()
    code, _, err = run("drive", "rover.yaml", "commands.csv", "-o", "run.csv", "--plot", "run.png")
    assert code == 2
    assert "run.png" in err
    assert Path("run.csv").read_text() == "before"
    assert sorted(path.name for path in Path().iterdir()) == [
        "commands.csv",
        "rover.yaml",
        "run.csv",
        "run.png",
    ]


def test_files_together(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"

    def interrupted() -> None:
        with together(), replacing(one) as temporary:
            temporary.write_text("1")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []
    with together([tmp_path / "source"]):
        for path in (one, other):
            with replacing(path) as temporary:
                temporary.write_text(path.name)
            assert not path.exists()
        with pytest.raises(TableError, match="another file than the output"), replacing(one):
            pass
    assert (one.read_text(), other.read_text()) == ("one", "other")


def test_long_names_and_full_disks(tmp_path: Path) -> None:
    path = tmp_path / f"{'n' * 251}.csv"
    with replacing(path) as temporary:
        temporary.write_text("all")
    assert path.read_text() == "all"
    with (
        pytest.raises(TableError, match=re.escape(f"{path}: could not be written: No space left")),
        replacing(path),
    ):
        raise OSError(28, "No space left on device")
    assert path.read_text() == "all"


def test_what_a_killed_writer_left_is_removed_by_the_next(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    left = tmp_path / f"{_beside(path)}{dead.pid}-0123abcd.csv"
    at_work = tmp_path / f"{_beside(path)}{os.getppid()}-0123abcd.csv"
    for each in (left, at_work):
        each.write_text("half")
    with replacing(path) as temporary:
        temporary.write_text("all")
    assert sorted(tmp_path.iterdir()) == sorted([path, at_work])


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_an_end_by_a_signal_leaves_nothing(run: Run, number: int) -> None:
    run("--version")
    rows = "\n".join(f"{0.01 * k:.2f},0.1,0,0" for k in range(1_000_000))
    Path("long.csv").write_text(f"time,vx,vy,omega\n{rows}\n")
    before = sorted(Path().iterdir())
    environment = os.environ | {"PYTHONPATH": str(Path(six_wheel.__file__).parents[1])}
    command = [sys.executable, "-m", "six_wheel", "drive", "rover.yaml", "long.csv", "-o", "run.csv"]
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    try:
        end = time.monotonic() + 60
        while sorted(Path().iterdir()) == before and time.monotonic() < end:
            time.sleep(0.01)
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode in ((130, -number) if number == signal.SIGINT else (-number,))
    assert b"Traceback" not in err
    assert sorted(Path().iterdir()) == before


@pytest.mark.parametrize("arguments", [("check", ""), ("drive", "rover.yaml", "commands.csv", "--output=")])
def test_an_empty_argument_is_no_path(run: Run, arguments: tuple[str, ...]) -> None:
    code, _, err = run(*arguments)
    assert (code, err) == (2, "six-wheel: an argument must not be empty, got one that is\n")
