"""One function over many items: the same to the bit wherever it runs, whatever dies on the way."""

import contextlib
import errno
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from six_wheel import parallel
from six_wheel.parallel import Failure, Journal, JournalError, collect, spread, spreading
from tests.parallel import parallel_jobs as jobs

ITEMS = list(range(12))


def equal(one: Any, other: Any) -> None:
    for a, b in zip(one, other, strict=True):
        assert a["sum"] == b["sum"]
        assert a["seed"] == b["seed"]
        np.testing.assert_array_equal(a["numbers"], b["numbers"])


@pytest.fixture(params=["here", "processes", "dask"])
def where(request: pytest.FixtureRequest) -> dict[str, Any]:
    if request.param == "dask":
        return {"cluster": request.getfixturevalue("local_cluster").scheduler_address}
    return {"workers": 1 if request.param == "here" else 2}


def test_results_are_the_same_to_the_bit_and_in_order(where: dict[str, Any]) -> None:
    equal(collect(jobs.waves, ITEMS, **where).values, [jobs.waves(item) for item in ITEMS])


def test_a_failure_is_reported_and_stops_nothing(where: dict[str, Any]) -> None:
    outcomes = collect(jobs.careful, range(6), **where)
    assert outcomes.values == [0, 1, 4, None, 16, 25]
    assert outcomes.failures == {3: Failure("ValueError", "three is not possible")}
    assert str(outcomes.failures[3]) == "ValueError: three is not possible"


@pytest.mark.slow
@pytest.mark.parametrize("where", ["processes", "dask"], indirect=True)
def test_a_worker_that_dies_loses_nothing(where: dict[str, Any], tmp_path: Path) -> None:
    outcomes = collect(jobs.deadly_once, [(str(tmp_path), number) for number in range(20)], **where)
    assert (tmp_path / "died").exists()
    assert outcomes.values == list(range(20))
    assert outcomes.failures == {}


@pytest.mark.slow
def test_an_item_that_kills_every_process_is_the_only_one_given_up() -> None:
    outcomes = collect(jobs.deadly, range(8), workers=2)
    assert outcomes.values == [0, 1, None, 3, 4, 5, 6, 7]
    assert outcomes.failures == {2: Failure("WorkerDied", "its process died 3 times")}


def test_a_process_may_start_while_a_pool_ends() -> None:
    """The thread of a pool whose process had died met a new one among those it went through, and failed."""
    pool = spreading._Pool(2)
    processes = pool._processes
    processes[1] = "a process"
    for _ in processes.values():
        processes[2] = "another"
    assert list(processes) == [1, 2]
    processes.clear()
    pool.end()


def test_a_worker_killed_from_outside_loses_nothing(local_cluster: Any) -> None:
    with contextlib.ExitStack() as stack:
        distributed = pytest.importorskip("distributed", reason="needs Dask")
        client = stack.enter_context(distributed.Client(local_cluster, set_as_default=False))
        victim = next(iter(client.run(os.getpid).values()))
        done = []
        for outcome in spread(jobs.lasting, [0.05] * 24, cluster=client):
            done.append(outcome)
            if len(done) == 5:
                os.kill(victim, signal.SIGKILL)
        assert sorted(outcome.index for outcome in done) == list(range(24))
        assert all(outcome.value == 0.05 for outcome in done)


def test_the_work_is_shared(where: dict[str, Any]) -> None:
    found = set(collect(jobs.process, range(12), **where).values)
    assert len(found) == (1 if where.get("workers") == 1 else 2)
    assert (os.getpid() in found) == (where.get("workers") == 1)


def test_only_some_items_are_read_ahead() -> None:
    read = 0

    def items() -> Iterator[int]:
        nonlocal read
        for item in range(1000):
            read += 1
            yield item

    outcomes = spread(jobs.careful, items(), workers=2)
    for _ in range(10):
        next(outcomes)
    outcomes.close()
    assert read <= 10 + 2 * 2 * 2


@pytest.mark.parametrize("stop", [0, 5, 12])
def test_a_stopped_run_goes_on_where_it_was(where: dict[str, Any], stop: int, tmp_path: Path) -> None:
    run = {"job": "waves", "threshold": 0.5}
    outcomes = spread(jobs.waves, ITEMS, journal=Journal(tmp_path / "journal", run), **where)
    for _ in range(stop):
        next(outcomes)
    outcomes.close()
    journal = Journal(tmp_path / "journal", run)
    assert len(journal.done) == stop
    prepared: list[int] = []
    told: list[int] = []

    def prepare(item: int) -> int:
        prepared.append(item)
        return item

    again = list(spread(jobs.waves, ITEMS, journal=journal, prepare=prepare, progress=told.append, **where))
    assert sum(outcome.resumed for outcome in again) == stop
    assert len(prepared) == len(ITEMS) - stop
    assert told == list(range(1, len(ITEMS) + 1))
    values = {outcome.index: outcome.value for outcome in again}
    equal([values[k] for k in ITEMS], [jobs.waves(item) for item in ITEMS])
    journal.discard()
    assert list(tmp_path.iterdir()) == []


def test_a_journal_keeps_values_to_the_bit(tmp_path: Path) -> None:
    value = {
        "none": None,
        "text": "ä",
        "numbers": (1, 2.5, float("nan"), -0.0),
        "nested": [{"array": np.array([[1.0, np.nan], [-0.0, np.inf]], np.float32)}, np.int64(7)],
        "empty": np.zeros((0, 3)),
    }
    Journal(tmp_path, {}).write(4, value)
    read = Journal(tmp_path, {}).read(4)
    assert repr(read) == repr(value)
    np.testing.assert_array_equal(read["nested"][0]["array"], value["nested"][0]["array"])  # type: ignore[index]
    assert read["nested"][0]["array"].dtype == np.float32


def test_a_failed_item_is_tried_again_next_time(tmp_path: Path) -> None:
    journal = Journal(tmp_path, {})
    assert list(collect(jobs.careful, range(6), workers=1, journal=journal).failures) == [3]
    assert Journal(tmp_path, {}).done == {0, 1, 2, 4, 5}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: Journal(path, {"cells": 4}), "holds another run: cells was 4, now 5"),
        (lambda path: (path / "notes.txt").write_text("mine"), "must be a journal or an empty folder"),
        (lambda path: (path / "journal.json").write_text("]"), "must be a journal's, it is not JSON"),
        (lambda path: (path / "journal.json").write_text("[]"), "its manifest is not one"),
    ],
)
def test_someone_elses_folder_is_refused(make: Callable[[Path], Any], message: str, tmp_path: Path) -> None:
    make(tmp_path)
    before = sorted(tmp_path.iterdir())
    with pytest.raises(JournalError, match=message):
        Journal(tmp_path, {"cells": 5})
    assert sorted(tmp_path.iterdir()) == before


def test_a_damaged_item_is_named(tmp_path: Path) -> None:
    journal = Journal(tmp_path, {})
    journal.write(0, [1, 2])
    (tmp_path / "00000000.npz").write_bytes(b"PK")
    with pytest.raises(JournalError, match=r"00000000\.npz must be a finished item"):
        journal.read(0)


def test_a_full_disk_leaves_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    journal = Journal(tmp_path, {})

    def full(file: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    outcomes = spread(jobs.waves, ITEMS, workers=1, journal=journal)
    next(outcomes)
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        next(outcomes)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["00000000.npz", "journal.json"]


def test_a_cluster_that_does_not_answer_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed", reason="needs Dask")
    monkeypatch.setattr("six_wheel.parallel.spreading.ANSWER", 0.5)
    with pytest.raises(
        parallel.ClusterError, match=r"cluster tcp://127\.0\.0\.1:9 does not answer"
    ) as caught:
        collect(jobs.careful, [1], cluster="tcp://127.0.0.1:9")
    assert "\n" not in str(caught.value)
    with pytest.raises(parallel.ClusterError, match="cluster nonsense://x does not answer"):
        collect(jobs.careful, [1], cluster="nonsense://x")


def test_a_missing_dask_names_the_install_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ImportError, match=r'pip install "six-wheel\[cluster\]"'):
        collect(jobs.careful, [1], cluster="tcp://127.0.0.1:9")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"workers": 0}, "workers must be at least 1, got 0"),
        ({"workers": 2, "cluster": "tcp://a:1"}, "workers must not be given with a cluster, got 2"),
    ],
)
def test_options_that_make_no_sense_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        collect(jobs.careful, [1], **options)


def test_no_items_are_no_outcomes(where: dict[str, Any]) -> None:
    assert collect(jobs.careful, [], **where).values == []


@pytest.mark.slow
def test_a_cluster_that_goes_away_is_one_line(tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="needs Dask")
    python = [sys.executable, "-m"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    address = tmp_path / "scheduler.json"
    files = ["--scheduler-file", str(address)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    scheduler = subprocess.Popen(
        [*python, "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard", *files],
        env=environment,
        **quiet,
    )
    worker = subprocess.Popen(
        [*python, "distributed.cli.dask_worker", "--no-dashboard", "--nthreads", "1", *files],
        env=environment,
        **quiet,
    )
    try:
        where = None
        while where is None:  # the file is there a moment before what is in it
            assert scheduler.poll() is None
            time.sleep(0.01)
            with contextlib.suppress(FileNotFoundError, json.JSONDecodeError):
                where = json.loads(address.read_text())["address"]
        journal = Journal(tmp_path / "journal", {})
        outcomes = spread(jobs.lasting, [0.05] * 500, cluster=where, journal=journal)
        assert next(outcomes).failure is None
        scheduler.kill()
        with pytest.raises(parallel.ClusterError, match="the cluster went away") as caught:
            list(outcomes)
        assert "\n" not in str(caught.value)
        assert 1 <= len(Journal(tmp_path / "journal", {}).done) < 500
    finally:
        for process in (scheduler, worker):
            process.kill()
            process.wait()
