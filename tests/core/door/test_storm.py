"""Every door at once, under limits of memory: no panic, no abort, no input changed, no wrong number.

`SOAK` in the environment makes it as many processes, twenty seconds each; `-s` shows what came of how many
calls.
"""

import json
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

pytest.importorskip("resource", reason="no limits of memory to set here")

SOAK = int(os.environ.get("SOAK", "0"))
PROGRAM = Path(__file__).with_name("storm.py")


def test_any_calls_with_any_arguments():
    counts: Counter[str] = Counter()
    for seed in range(max(SOAK, 2)):
        mebibytes = (600, 1000, 3000)[seed % 3]
        command = [sys.executable, str(PROGRAM), str(seed), "20" if SOAK else "1.5", str(mebibytes)]
        result = subprocess.run(command, capture_output=True, text=True, timeout=300)
        assert result.returncode == 0, (seed, result.stderr)
        told = json.loads(result.stdout)
        assert told["failures"] == [], seed
        counts.update(told["counts"])
    print(dict(counts))
    assert counts.keys() == {"answered", "refused", "no memory", "raised by the argument"}
