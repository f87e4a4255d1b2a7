"""Any terminal will do: what it cannot show is replaced, and whoever stops reading is no error."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import six_wheel
from six_wheel.cli.names import COMMANDS
from tests.cli.command_lines import callbacks, line, written

ENVIRONMENTS: dict[str, dict[str, str | None]] = {
    "ascii": {"PYTHONIOENCODING": "ascii"},
    "latin-1": {"PYTHONIOENCODING": "latin-1"},
    "the C locale": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    "20 columns": {"COLUMNS": "20"},
    "a time zone that is none": {"TZ": "Nowhere/None", "TERM": "dumb"},
    "no TERM and no HOME": {"TERM": None, "HOME": None, "XDG_CACHE_HOME": None, "XDG_CONFIG_HOME": None},
    "a HOME that is none": {"HOME": "/nowhere/at/all", "MPLCONFIGDIR": None},
    "Latin-1 by its locale": {"LC_ALL": "de_DE.ISO-8859-1", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    "odd columns and time": {"COLUMNS": "20", "LINES": "1", "TZ": "XXX-27:30"},
}
# Every command's help, and what commands print of a rover and a log.
PROGRAM = """
import sys
from six_wheel.__main__ import main
from six_wheel.cli.names import COMMANDS

calls = [["--help"], ["--version"], *([name, "--help"] for name in COMMANDS)]
calls += [["check", "perseverance"], ["check", "n\\N{LATIN SMALL LETTER O WITH DIAERESIS}.yaml"]]
calls += [["odometry", "--example"], ["drive", "rover.yaml", "commands.csv"]]
print([main(call) for call in calls], file=sys.stderr)
"""


def child(command: list[str], **options: Any) -> subprocess.CompletedProcess[bytes]:
    environment = os.environ | {"PYTHONPATH": str(Path(six_wheel.__file__).parents[1])}
    environment |= options.pop("env", {})
    environment = {name: value for name, value in environment.items() if value is not None}
    return subprocess.run([sys.executable, *command], env=environment, timeout=300, check=False, **options)


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_every_command_speaks_to_any_terminal(run: Any, name: str) -> None:
    """A degree sign once ended `check` on an ASCII terminal, with the exit code of a mistake in the file."""
    run("--version")  # in the folder of the run, where rover.yaml and commands.csv are
    done = child(["-c", PROGRAM], env=ENVIRONMENTS[name], capture_output=True)
    codes = done.stderr.decode("latin-1").splitlines()[-1]
    assert codes == str([0] * (len(COMMANDS) + 3) + [2, 0, 0]), done.stderr


# Command lines, one after another in one process.
LINES = """
import json, sys
from six_wheel.__main__ import main

print([main(line) for line in json.loads(sys.argv[1])], file=sys.stderr)
"""


def made(environment: dict[str, str | None]) -> tuple[str, dict[str, bytes]]:
    """Exit codes of all commands with their outputs, one of which is a picture; and these."""
    lines = []
    for name in [each for each in callbacks() if each != "demo"]:  # which drives for a minute
        plain = [one for one in written(name) if name == "check" or not re.match("plot|report", one.name)]
        outputs = {one.name: f"{name}_{one.name}{one.endings[0]}" for one in plain}
        lines.append(line(name, **outputs))
    before = {*Path().iterdir()}
    done = child(["-c", LINES, json.dumps(lines)], env=environment, capture_output=True)
    files = sorted({*Path().iterdir()} - before)
    found = {path.name: path.read_bytes() for path in files if path.is_file()}
    for path in files:
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    assert b"Traceback" not in done.stderr, done.stderr
    return done.stderr.decode("latin-1").splitlines()[-1], found


def test_every_environment_is_among_those_together() -> None:
    assert sorted(name for names in TOGETHER for name in names) == sorted(ENVIRONMENTS)


@pytest.fixture(scope="module")
def ordinary() -> dict[str, Any]:
    """Exit codes and files in the environment of the tests, once they are made."""
    return {}


# All of these environments, few together.
TOGETHER = [
    ("ascii", "the C locale", "20 columns", "a time zone that is none"),
    ("latin-1", "Latin-1 by its locale", "no TERM and no HOME", "odd columns and time"),
    ("a HOME that is none",),
]


@pytest.mark.slow
@pytest.mark.parametrize("names", TOGETHER, ids="-".join)
@pytest.mark.usefixtures("files")
def test_every_command_makes_the_same_files_anywhere(
    names: tuple[str, ...], ordinary: dict[str, Any]
) -> None:
    if not ordinary:
        ordinary["codes"], ordinary["files"] = made({})
    together: dict[str, str | None] = {}
    for name in names:
        together |= ENVIRONMENTS[name]
    codes, files = made(together)
    assert codes == ordinary["codes"]
    assert files.keys() == ordinary["files"].keys()
    for path in files:
        if path.endswith((".csv", ".md", ".yaml", ".urdf", ".tif")):
            assert files[path] == ordinary["files"][path], path


@pytest.mark.skipif(not hasattr(os, "pipe2"), reason="no such pipes here")
@pytest.mark.parametrize(
    "arguments", [[], ["--help"], ["--version"], ["drive", "--help"], ["check", "perseverance"]]
)
def test_nobody_reads_on(arguments: list[str]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        done = child(["-m", "six_wheel", *arguments], stdout=writer, stderr=subprocess.PIPE)
    finally:
        os.close(writer)
    assert (done.returncode, done.stderr) == (1, b"")


@pytest.mark.skipif(os.name == "nt", reason="streams are closed by a shell of POSIX")
@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-"])
@pytest.mark.parametrize(
    "arguments", [["--help"], ["drive", "--help"], ["drive", "rover.yaml", "commands.csv", "-o", "made.csv"]]
)
def test_streams_that_are_closed(run: Any, closed: str, arguments: list[str]) -> None:
    """Without a standard output every command ended with a traceback."""
    run("--version")  # in the folder of the run, where rover.yaml and commands.csv are
    command = f'exec "$0" "$@" {closed}'
    options: dict[str, Any] = {"env": os.environ | {"PYTHONPATH": str(Path(six_wheel.__file__).parents[1])}}
    shell = ["sh", "-c", command, sys.executable, "-m", "six_wheel", *arguments]
    done = subprocess.run(shell, capture_output=True, timeout=300, check=False, **options)
    assert (done.returncode, done.stderr) == (0, b"")
    if "made.csv" in arguments:
        assert Path("made.csv").read_text().startswith("time,")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device here")
@pytest.mark.parametrize("arguments", [["--help"], ["check", "perseverance"]])
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_the_standard_output_is_on_a_full_disk(arguments: list[str], unbuffered: str) -> None:
    """With a buffer `check` once said it twice."""
    variables = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    with open("/dev/full", "wb") as full:
        done = child(["-m", "six_wheel", *arguments], stdout=full, stderr=subprocess.PIPE, env=variables)
    assert done.returncode == 2
    assert done.stderr.count(b"\n") == 1
    assert done.stderr.endswith(b"No space left on device\n")
