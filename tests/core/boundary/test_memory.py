"""One call, many times and from many threads: no reference and no memory is kept, and nothing races.

`SOAK` in the environment makes the races last a minute.
"""

import gc
import os
import sys
import threading
import time
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.core.oracles.test_fast import ROVER, TWIST, outputs

SOAK = int(os.environ.get("SOAK", "1"))
SECONDS = 60.0 if SOAK > 1 else 0.3
CALLS = 100_000


# Memory that is kept, and memory that is allocated


def loops() -> dict[str, tuple[Callable[[], Any], list[Any]]]:
    out, target = outputs(ROVER, 0.1), np.empty(3)
    twist, array = (0.1, 0.0, 0.2), np.array(TWIST)
    bad, wrong = (0.0, 1.0, 0.0), np.empty(5)
    arrays = [*out, target, array, wrong]

    def fails(call: Callable[[], Any]) -> Callable[[], None]:
        def run() -> None:
            try:
                call()
            except ValueError:
                return
            raise AssertionError("it should have failed")

        return run

    everything = [out, twist, bad, *arrays, ROVER, *twist]
    calls: dict[str, Callable[[], Any]] = {
        "inverse": lambda: ROVER.inverse(twist),
        "inverse, out": lambda: ROVER.inverse(twist, out=out),
        "inverse, array, out": lambda: ROVER.inverse(array, out=out),
        "inverse, previous, out": lambda: ROVER.inverse(twist, previous=out[0], out=out),
        "forward": lambda: ROVER.forward(*out),
        "forward, out": lambda: ROVER.forward(*out, out=target),
        "project": lambda: ROVER.project(twist),
        "project, out": lambda: ROVER.project(twist, out=target),
        "admissible": lambda: ROVER.admissible(twist),
        "inverse fails": fails(lambda: ROVER.inverse(bad, out=out)),
        "inverse refuses": fails(lambda: ROVER.inverse(twist, out=(wrong, out[1]))),
        "forward refuses": fails(lambda: ROVER.forward(wrong, out[1], out=target)),
    }
    return {name: (call, everything) for name, call in calls.items()}


@pytest.mark.parametrize("name", loops())
def test_no_reference_is_kept(name):
    call, objects = loops()[name]
    for _ in range(10):
        call()
    before = [sys.getrefcount(thing) for thing in objects]
    for _ in range(CALLS if "fail" not in name and "refuse" not in name else CALLS // 20):
        call()
    assert [sys.getrefcount(thing) for thing in objects] == before


@pytest.mark.parametrize("name", loops())
def test_no_memory_is_kept_and_none_taken_with_out(name):
    call, _ = loops()[name]
    for _ in range(100):
        call()
    gc.collect()
    tracemalloc.start()
    try:
        for _ in range(10):
            call()  # memory of the loop itself
        before = tracemalloc.get_traced_memory()[0]
        tracemalloc.reset_peak()
        for _ in range(CALLS if ", out" in name else CALLS // 20):
            call()
        after, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert after - before < 1000  # the counter of the loop, whatever the number of calls
    if ", out" in name:
        assert peak - before < 1000


# Threads


def test_eight_threads_on_one_rover_and_one_array():
    twist, failures = np.array(TWIST), []
    end = time.monotonic() + SECONDS
    expected = [array.tolist() for array in ROVER.inverse(twist)]
    batch = np.tile(TWIST, (256, 1))
    rows = ROVER.inverse(batch)

    def work(number: int) -> None:
        out, target = outputs(ROVER), np.empty(3)
        calls = 0
        while time.monotonic() < end or calls < 100:
            calls += 1
            if number % 4 == 3:  # batches let go of the lock: the others take the general way meanwhile
                if not np.array_equal(ROVER.inverse(batch)[0], rows[0]):
                    failures.append(number)
                continue
            ROVER.inverse(twist, previous=out[0] * 0.0, out=out)
            back = ROVER.forward(*out, out=target)
            if [array.tolist() for array in out] != expected or abs(back - twist).max() > 1e-14:
                failures.append(number)

    threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []


def test_a_call_beside_a_batch_that_writes_its_array_is_refused_or_waits():
    """An array that a batch of another thread writes to is not read meanwhile."""
    shared, stop, seen = np.tile(TWIST, (100_000, 1)), threading.Event(), set()
    source = shared.copy()

    def write() -> None:
        while not stop.is_set():
            ROVER.project(source, out=shared)

    thread = threading.Thread(target=write)
    thread.start()
    end = time.monotonic() + SECONDS
    try:
        while time.monotonic() < end:
            try:
                ROVER.admissible(shared[50])
                seen.add("answered")
            except ValueError as error:
                seen.add(str(error))
    finally:
        stop.set()
        thread.join()
    assert seen <= {"answered", "twist must not be written to meanwhile, got an array in use as out="}
