"""Ctrl-C in the middle of a long call: it ends while it computes, objects at a row that the error names.

Once all of a call was computed before the interpreter heard of the signal: 5.4 s for a log on ground.
"""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest

import six_wheel as sw

# Each call takes a second at least on the machines of 2026. A thread sends SIGINT 0.2 s after it began: what
# has not returned by then is interrupted, and the process says so.
CHILD = """
import os, signal, threading, time
from functools import partial
import numpy as np
import six_wheel as sw

signal.signal(signal.SIGINT, signal.default_int_handler)
random = np.random.default_rng(1)
rover, arm = sw.Rover.preset("perseverance"), sw.RockerBogie.preset("perseverance")
x = 0.1 * np.arange(400)
heights = 0.1 * np.sin(x[:, None]) * np.cos(0.7 * x[None, :])
ground = sw.Terrain(heights, spacing=0.1, origin=(-20.0, -20.0))
poses = random.uniform(-15.0, 15.0, (COUNT, 3))
angles, speeds = rover.inverse((0.0, 0.0, 0.1))
rows = np.arange(COUNT)[:, None]
call = CALLS
began = threading.Event()

def interrupt():
    began.wait()
    time.sleep(0.2)
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt, daemon=True).start()
try:
    began.set()
    call()
    print("returned")
except KeyboardInterrupt as error:
    print("interrupted", *getattr(error, "__notes__", []))
"""
CALLS = {
    "settle": (10**6, "lambda: arm.settle(ground, poses)"),
    "settle by two threads": (10**6, "lambda: arm.settle(ground, poses, threads=2)"),
    "a log on ground": (
        10**6,
        "partial(sw.Odometry3(arm, ground=ground).run, np.tile(angles, (COUNT, 1)), 0.01 * rows * speeds,"
        " 0.01 * rows[:, 0])",
    ),
    "four axles": (
        10**6,
        "partial(sw.FourAxle((0.3, 0.3), 0.4, 0.1).simulate,"
        " [sw.FourAxleStep('drive', 1e3, 'locked', 'locked', (1.0,) * 4)], 1e3 / COUNT)",
    ),
    "a transition at many times": (
        10**6,
        "partial(sw.profiles.BodyTransition.between(rover, (0.0, 0.0, 0.0), (0.04, 0.0, 0.02), 2.0).at,"
        " 2.0 * rows[:, 0] / COUNT)",
    ),
    "bounds on a large map": (
        4000,
        "partial(arm.bounds, sw.Terrain(np.zeros((COUNT, COUNT)), 0.1), [(100.0, 100.0, 0.0)])",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CALLS)
def test_a_long_call_ends_when_the_interpreter_is_told_to(name: str) -> None:
    count, call = CALLS[name]
    code = CHILD.replace("CALLS", call).replace("COUNT", str(count))
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.stdout.startswith("interrupted"), done.stderr
    assert ("before row" in done.stdout) == (name == "a log on ground")


@pytest.fixture
def log():
    """A rover and a log of it that takes a second to go through: steering, wheel angles, stamps."""
    rover = sw.Rover.preset("perseverance")
    angles, speeds = rover.inverse((0.1, 0.0, 0.02))
    stamps = 0.01 * np.arange(5_000_000)
    return rover, (np.tile(angles, (len(stamps), 1)), stamps[:, None] * speeds, stamps)


@contextmanager
def interrupted(handler: Callable[..., object]) -> Iterator[None]:
    """SIGINT 0.3 s from now, taken by this handler."""
    before = signal.signal(signal.SIGINT, handler)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        yield
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)


def test_an_odometry_interrupted_is_at_the_row_that_is_named(log) -> None:
    rover, readings = log
    ended, whole = sw.Odometry(rover), sw.Odometry(rover)
    with interrupted(signal.default_int_handler), pytest.raises(KeyboardInterrupt) as error:
        ended.run(*readings)
    (note,) = error.value.__notes__
    row = int(note.removeprefix("before row "))
    whole.run(*(column[:row] for column in readings))
    rest = tuple(column[row : row + 10] for column in readings)
    for name in ("poses", "covariances"):
        after, wanted = (getattr(odometry.run(*rest), name) for odometry in (ended, whole))
        np.testing.assert_array_equal(after, wanted)
        rest = tuple(column[row + 10 : row + 20] for column in readings)


def test_a_handler_that_uses_the_object_at_work_is_refused(log) -> None:
    """It would wait for itself."""
    rover, readings = log
    odometry = sw.Odometry(rover)
    with (
        interrupted(lambda *_: odometry.reset()),
        pytest.raises(RuntimeError, match="at work in this thread"),
    ):
        odometry.run(*readings)
    odometry.reset()
    odometry.run(*(column[:10] for column in readings))
