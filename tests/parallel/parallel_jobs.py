"""Jobs of the workers in the tests, importable by name."""

import os
import signal
import time
from pathlib import Path
from typing import Any

import numpy as np


def waves(seed: int) -> dict[str, Any]:
    """Numbers whose last digits would show another order of work."""
    numbers = np.random.default_rng(seed).standard_normal(1000)
    return {"sum": float(np.sin(numbers).sum()), "numbers": np.cumsum(numbers), "seed": seed}


def careful(item: int) -> int:
    """Refuses 3."""
    if item == 3:
        raise ValueError("three is\nnot possible")
    return item * item


def deadly(item: int) -> int:
    """Kills its own process at 2."""
    if item == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return item


def deadly_once(item: tuple[str, int]) -> int:
    """Kills its own process at 2, the first time."""
    folder, number = item
    mark = Path(folder) / "died"
    if number == 2 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.01)
    return number


def process(_: int) -> int:
    """Number of the process that runs it."""
    time.sleep(0.05)
    return os.getpid()


def lasting(seconds: float) -> float:
    """Takes its time."""
    time.sleep(seconds)
    return seconds
