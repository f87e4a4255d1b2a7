"""Any terminal will do: what it cannot show is replaced, and whoever stops reading is no error."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import six_wheel
from six_wheel.cli.names import COMMANDS

ENVIRONMENTS = {
    "ascii": {"PYTHONIOENCODING": "ascii"},
    "latin-1": {"PYTHONIOENCODING": "latin-1"},
    "the C locale": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
    "20 columns": {"COLUMNS": "20"},
    "a time zone that is none": {"TZ": "Nowhere/None", "TERM": "dumb"},
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
    return subprocess.run([sys.executable, *command], env=environment, timeout=300, check=False, **options)


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_every_command_speaks_to_any_terminal(run: Any, name: str) -> None:
    """A degree sign once ended `check` on an ASCII terminal, with the exit code of a mistake in the file."""
    run("--version")  # in the folder of the run, where rover.yaml and commands.csv are
    done = child(["-c", PROGRAM], env=ENVIRONMENTS[name], capture_output=True)
    codes = done.stderr.decode("latin-1").splitlines()[-1]
    assert codes == str([0] * (len(COMMANDS) + 3) + [2, 0, 0]), done.stderr


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


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device here")
@pytest.mark.parametrize("arguments", [["--help"], ["check", "perseverance"]])
def test_the_standard_output_is_on_a_full_disk(arguments: list[str]) -> None:
    with open("/dev/full", "wb") as full:
        done = child(["-m", "six_wheel", *arguments], stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 2
    assert done.stderr.count(b"\n") == 1
    assert done.stderr.endswith(b"No space left on device\n")
