"""Several threads, and several processes, on the same objects and arrays."""

import contextlib
import multiprocessing
import os
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

import six_wheel as sw

ROVER = sw.Rover.preset("perseverance")
forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")


def while_running(run: Callable[[], object], ask: Callable[[], object]) -> tuple[int, object]:
    """Asks while another thread runs, again until it has begun: how often a third one counted during the
    last of the asking, and the answer."""
    done, counted = threading.Event(), [0]

    def count() -> None:
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.0005)

    worker, counter = threading.Thread(target=run), threading.Thread(target=count)
    worker.start()
    counter.start()
    answer, seen = None, 0
    while answer is None:
        before = counted[0]
        answer = ask()
        seen = counted[0] - before
    done.set()
    worker.join()
    counter.join()
    return seen, answer


# Whoever waits with the interpreter's lock lets nobody count, however long the run and however often it is
# tried. Whoever waits without it lets others count, unless the system gave them no time or the run was over
# before it was asked: each further try is of a longer run.
ROWS = [400_000 * factor for factor in (1, 1, 2, 2, 4, 4, 8, 8, 8, 8)]


def test_whoever_waits_for_a_controller_lets_other_threads_run():
    for rows in ROWS:
        times, controller = np.arange(1.0, rows) / 100.0, sw.Controller(ROVER)
        run = partial(controller.run, [(0.05, 0.0, 0.0)], [0.0], times)
        seen, now = while_running(run, lambda controller=controller: controller.stamp)
        assert now == times[-1]  # after the run, never in the midst
        if seen > 3:
            return
    pytest.fail("nobody ran while another waited")


def test_whoever_waits_for_odometry_lets_other_threads_run():
    for rows in ROWS:
        stamps, odometry = np.arange(rows) / 100.0, sw.Odometry(ROVER)
        run = partial(odometry.run, np.zeros((rows, 4)), np.tile(stamps[:, None], (1, 6)), stamps)
        seen, stamp = while_running(run, lambda odometry=odometry: odometry.state.stamp)
        assert stamp == stamps[-1]
        if seen > 3:
            return
    pytest.fail("nobody ran while another waited")


@pytest.mark.parametrize("kind", ["controller", "odometry"])
def test_eight_threads_on_one_object(kind):
    """Every call is made whole, one after the other: nothing is lost and nothing raises."""
    if kind == "controller":
        controller = sw.Controller(ROVER)
        clock = iter(range(1, 10**9))
        lock = threading.Lock()

        def call() -> None:
            with lock:
                now = next(clock) / 100.0
                controller.step(now)
            controller.command((0.01, 0.0, 0.0), now)
            assert controller.stamp is not None

    else:
        odometry = sw.Odometry(ROVER, increments=True)
        odometry.update((0.0,) * 4, (0.0,) * 6, 0.0)
        clock = iter(range(1, 10**9))
        lock = threading.Lock()

        def call() -> None:
            with lock:
                odometry.update((0.0,) * 4, (0.1,) * 6, next(clock) / 100.0)
            assert odometry.state.stamp is not None
            odometry.noise  # noqa: B018

    failures: list[BaseException] = []

    def work() -> None:
        try:
            for _ in range(300):
                call()
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    if kind == "odometry":
        radius = ROVER.wheels[0].radius
        assert odometry.state.pose[0] == pytest.approx(8 * 300 * 0.1 * radius, rel=1e-12)


def test_two_threads_write_to_one_memory_by_two_objects():
    """One of them is refused, or they take turns; never both at once."""
    memory = np.zeros(3 * 200_000)
    other = np.frombuffer(memoryview(memory)).reshape(-1, 3)
    twists = [np.tile([value, 0.0, 0.0], (200_000, 1)) for value in (0.1, 0.2)]
    outs, outcomes = [memory.reshape(-1, 3), other], []

    def work(k: int) -> None:
        for _ in range(10):
            try:
                ROVER.project(twists[k], out=outs[k])
                outcomes.append("written")
            except ValueError as error:
                outcomes.append(str(error).rpartition("got ")[2])

    threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(outcomes) <= {"written", "a read-only array or one in use"}
    assert "written" in outcomes


@forks
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_child_of_a_fork_during_a_batch():
    """Its calls are quick again, its arrays free, and what another thread was at is refused by name."""
    twists, out = np.tile([0.05, 0.0, 0.01], (400_000, 1)), np.zeros((400_000, 3))
    controller, started, stop = sw.Controller(ROVER), threading.Event(), threading.Event()
    times = np.arange(1, 2_000_000) / 100.0

    def batches() -> None:
        started.set()
        while not stop.is_set():
            ROVER.project(twists, out=out)

    def run() -> None:
        controller.run([(0.05, 0.0, 0.0)], [0.0], times)

    workers = [threading.Thread(target=batches), threading.Thread(target=run)]
    for worker in workers:
        worker.start()
    started.wait()
    time.sleep(0.05)
    child = os.fork()
    if child == 0:
        code = 1
        try:
            single = (np.empty(4), np.empty(6))
            ROVER.project(twists[:50], out=out[:50])  # in use by the parent's thread, which is not here
            ROVER.inverse((0.05, 0.0, 0.01), out=single)
            with contextlib.suppress(RuntimeError):  # or the run was over, or had not begun
                _ = controller.stamp
            fresh = sw.Controller(ROVER)
            fresh.step(0.0)
            code = 0
        finally:
            os._exit(code)
    _, status = os.waitpid(child, 0)
    stop.set()
    for worker in workers:
        worker.join()
    assert os.waitstatus_to_exitcode(status) == 0


@forks
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_pool_of_forked_processes():
    with multiprocessing.get_context("fork").Pool(2) as pool:
        results = pool.map(ROVER.icr, [np.array([1.0, 0.0, 0.5])] * 4)
    np.testing.assert_array_equal(results, [[0.0, 2.0]] * 4)


def test_free_threaded_interpreters_switch_their_lock_on():
    """The module says that it needs the lock: a free-threaded interpreter runs with it, or refuses."""
    program = """
        import sys
        import six_wheel
        print(getattr(sys, "_is_gil_enabled", lambda: True)())
    """
    command = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(program)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert result.stdout == "True\n", result.stderr


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="nowhere to count threads here")
def test_no_more_threads_stay_than_the_machine_has_cores():
    """With threads=4000 as many stayed as could start, and their stacks kept all memory a limit had left."""
    program = """
        import os
        import numpy as np
        import six_wheel as sw

        before = len(os.listdir("/proc/self/task"))
        sw.Rover.preset("perseverance").project(np.zeros((200_000, 3)), threads=4000)
        print(len(os.listdir("/proc/self/task")) - before)
    """
    command = [sys.executable, "-c", textwrap.dedent(program)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert int(result.stdout) < (os.cpu_count() or 1), result.stderr
