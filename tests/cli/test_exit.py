"""However a command ends, it ends by 0, 1, 2 or 130: no reader is at work any more when the interpreter goes.

`SOAK` in the environment makes as many runs of it, several at a time.
"""

import contextlib
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pyarrow
import pytest

from six_wheel.logs.tables import CommandTable
from tests.cli_runs import ROVER

RUNS = int(os.environ.get("SOAK", "3"))
TOGETHER = 8  # more than there are cores: whoever is late is late
SEED = 1


def table(path: Path, rows: int = 5000, bad: str = "nan") -> Path:
    """Commands at 100 Hz, the last of which cannot be driven."""
    lines = [f"{k / 100},0.1,0.05" for k in range(rows)]
    path.write_text("\n".join(["time,vx,omega", *lines, f"{rows / 100},{bad},0", ""]))
    return path


@pytest.mark.parametrize("bad", ["nan", "much"])
def test_nothing_holds_what_was_read(tmp_path: Path, bad: str) -> None:
    """Not even just after a failure: a thread that did would let go of it when there is no interpreter."""
    with CommandTable(table(tmp_path / "commands.csv", bad=bad)) as opened:
        for _ in range(200):
            (lines,) = opened._blocks(1 << 20)
            count = sys.getrefcount(lines)
            with contextlib.suppress(pyarrow.ArrowInvalid):
                opened._parse(lines)
            assert sys.getrefcount(lines) == count


@pytest.mark.skipif(sys.platform == "win32", reason="no signals to send")
@pytest.mark.parametrize("interrupted", [False, True])
def test_every_run_ends_by_a_code_of_its_own(tmp_path: Path, interrupted: bool) -> None:
    """A table with a NaN, and Ctrl-C at any moment."""
    (tmp_path / "rover.yaml").write_text(ROVER)
    table(tmp_path / "commands.csv", 20_000 if interrupted else 500)
    generator = random.Random(SEED)
    program = "import sys; from six_wheel.__main__ import main; print(flush=True); sys.exit(main())"
    command = [sys.executable, "-c", program, "drive", "rover.yaml", "commands.csv"]

    def start(number: int) -> subprocess.Popen[bytes]:
        out = f"run{number}.csv"
        return subprocess.Popen(
            [*command, "-o", out], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )

    for first in range(0, RUNS, TOGETHER):
        processes = [start(number) for number in range(first, min(first + TOGETHER, RUNS))]
        if interrupted:
            for process in processes:
                assert process.stdout is not None
                process.stdout.readline()  # before that it is the interpreter's own affair
                time.sleep(generator.uniform(0.01, 0.3))
                process.send_signal(signal.SIGINT)
        for process in processes:
            _, told = process.communicate(timeout=120)
            assert process.returncode in ({2, 130} if interrupted else {2}), told.decode()
            assert b"terminate called" not in told
    assert not [path for path in tmp_path.iterdir() if path.name.startswith("run")]
