"""One function over many items: on this machine's cores or, unchanged, on a Dask cluster.

`spread` hands out every item as soon as it is done, with its place; `collect` waits for all and keeps the
order. An item that fails is reported and stops nothing else; a worker that dies loses nothing, its items are
done again. A `Journal` keeps what is done on disk, so that a run that was stopped goes on where it was.
Values are those of ``function(item)`` wherever it ran, to the last bit.
"""

import contextlib
import importlib
import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Generator, Iterable, Iterator, Sized
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from itertools import chain
from multiprocessing.connection import Connection
from typing import Any

from six_wheel._core import __version__
from six_wheel.kinematics.errors import needed, one_line
from six_wheel.kinematics.keywords import checked
from six_wheel.parallel.journal import Journal

Items = Iterator[tuple[int, Any]]

LIVES = 3  # an item whose process dies so often is not tried again
ANSWER = 10.0  # [s] in which a cluster has to answer
AHEAD = 2  # items per thread of a cluster's worker that wait for it


class ClusterError(ConnectionError):
    """A cluster that does not answer, has no workers, or has another six_wheel."""


@dataclass(frozen=True)
class Failure:
    """Failure of an item: the exception that it raised, or the death of its worker."""

    kind: str
    """Name of the exception, or ``WorkerDied``."""
    message: str
    """Message of the exception, in one line."""

    def __str__(self) -> str:
        return f"{self.kind}: {self.message}" if self.message else self.kind


@dataclass(frozen=True)
class Outcome:
    """One item, done or failed."""

    index: int
    """Place of the item among the items."""
    value: Any = None
    """Value of the function; None if it failed."""
    failure: Failure | None = None
    """None where it did not."""
    resumed: bool = False
    """True if the value was read from a journal."""


@dataclass(frozen=True)
class Outcomes:
    """All items, in their order."""

    values: list[Any]
    """One per item; None where it failed."""
    failures: dict[int, Failure]
    """Place of every item that failed, and why."""


@checked()
def spread(
    function: Callable[[Any], Any],
    items: Iterable[Any],
    *,
    cluster: Any = None,
    workers: int | None = None,
    journal: Journal | None = None,
    prepare: Callable[[Any], Any] | None = None,
    progress: Callable[[int], object] | None = None,
) -> Generator[Outcome]:
    """Outcomes of a function for every item, in the order in which they finish.

    Only some items per worker are on their way at a time: many items need no more memory than few.

    Parameters
    ----------
    function : callable
        Takes an item, returns its value. Importable by name where it does not run in this process, as its
        items and values are picklable.
    items : iterable
        Read as they are needed.
    cluster : str or distributed.Client, optional
        A Dask cluster instead of this machine (extra ``[cluster]``).
    workers : int, optional
        Processes of this machine, default one per core; 1 stays in this process.
    journal : Journal, optional
        Keeps every value before it is handed out; items it holds already are not done again.
    prepare : callable, optional
        Called here with an item that is to be done, just before it is sent; its answer is sent instead.
    progress : callable, optional
        Called with the number of items that are finished, after each.

    Yields
    ------
    Outcome
        In the order in which they get done. An item whose function raised, or whose worker died again and
        again, has a `failure` and is in no journal.

    Raises
    ------
    ClusterError
        If the cluster does not answer, has no workers, or has another six_wheel.
    ImportError
        If a cluster is given and Dask is not installed.
    OSError
        If the journal's disk is full. What is in the journal stays good.
    """
    if workers is not None and workers < 1:
        raise ValueError(f"workers must be at least 1, got {workers}")
    if cluster is not None and workers is not None:
        raise ValueError(f"workers must not be given with a cluster, got {workers}")
    workers = workers or _cores()
    if isinstance(items, Sized):
        workers = min(workers, max(len(items), 1))
    resumed: list[int] = []

    def remaining() -> Iterator[tuple[int, Any]]:
        for index, item in enumerate(items):
            if journal is not None and index in journal:
                resumed.append(index)
            else:
                yield index, item if prepare is None else prepare(item)

    def outcomes() -> Generator[Outcome]:
        if cluster is not None:
            with _client_of(cluster) as client:
                yield from _on_cluster(function, remaining(), client)
        elif workers == 1:
            for index, item in remaining():
                yield Outcome(index, *_attempt(function, item))
        else:
            yield from _in_processes(function, remaining(), workers)

    def known() -> Iterator[Outcome]:
        while journal is not None and resumed:
            index = resumed.pop()
            yield Outcome(index, journal.read(index), resumed=True)

    finished = 0
    with contextlib.closing(outcomes()) as running:
        for latest in chain(running, (None,)):
            for outcome in chain(known(), () if latest is None else (latest,)):
                if journal is not None and outcome.failure is None and not outcome.resumed:
                    journal.write(outcome.index, outcome.value)
                finished += 1
                if progress is not None:
                    progress(finished)
                yield outcome


@checked(spread)
def collect(function: Callable[[Any], Any], items: Iterable[Any], **options: Any) -> Outcomes:
    """`spread`, all of it, in the order of the items."""
    done = sorted(spread(function, items, **options), key=lambda outcome: outcome.index)
    failures = {outcome.index: outcome.failure for outcome in done if outcome.failure is not None}
    return Outcomes([outcome.value for outcome in done], failures)


def _cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _attempt(function: Callable[[Any], Any], item: Any) -> tuple[Any, Failure | None]:
    try:
        return function(item), None
    except Exception as error:
        return None, _failure(error)


def _failure(error: BaseException) -> Failure:
    return Failure(type(error).__name__, one_line(error))


# --- processes of this machine ---------------------------------------------------------------------------


class _Processes(dict[int, Any]):
    """Processes of a pool by their ids: one may start while the pool's thread looks at all of them."""

    def values(self) -> Any:
        return tuple(super().values())


class _Pool(ProcessPoolExecutor):
    """Processes that end with the run, or with the process that started it: they hold one end of a pipe."""

    def __init__(self, workers: int) -> None:
        # A forked copy of a process with threads may hold a lock for ever.
        context = multiprocessing.get_context("spawn")
        ended, self._running = context.Pipe(duplex=False)
        super().__init__(workers, context, _begin, (ended,))
        self._processes: dict[int, Any] = _Processes()

    def end(self) -> None:
        """Stop all processes at once, also those that are still starting: nobody waits for their items."""
        self._running.close()
        for process in (self._processes or {}).values():
            process.kill()
        self.shutdown(cancel_futures=True)


def _begin(ended: Connection) -> None:
    """Start of a worker. Ctrl-C is for the process that started it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def end() -> None:
        ended.poll(None)
        os._exit(0)

    threading.Thread(target=end, daemon=True).start()


def _work(call: bytes) -> bytes:
    """Pickled value and failure of a pickled call: what cannot be pickled is a failure of its item alone."""
    try:
        return pickle.dumps(_attempt(*pickle.loads(call)))
    except Exception as error:
        return pickle.dumps((None, _failure(error)))


def _in_processes(function: Callable[[Any], Any], items: Items, workers: int) -> Generator[Outcome]:
    """Outcomes in the order in which they finish.

    A process that dies takes its pool along. Items that were under way then go alone through a new one, so
    that the item that killed it is found.
    """
    deaths: dict[int, int] = {}
    again: list[tuple[int, Any]] = []
    under_way: dict[Future[bytes], tuple[int, Any]] = {}
    pool = _Pool(workers)
    try:
        while True:
            suspects = again or any(index in deaths for index, _ in under_way.values())
            while len(under_way) < (1 if suspects else workers):
                pair = again.pop() if again else next(items, None)
                if pair is None:
                    break
                try:
                    call = pickle.dumps((function, pair[1]))
                except Exception as error:
                    yield Outcome(pair[0], failure=_failure(error))
                    continue
                try:
                    under_way[pool.submit(_work, call)] = pair
                except BrokenProcessPool:
                    again.append(pair)
                    pool.end()
                    pool = _Pool(workers)
            if not under_way:
                return
            for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                index, item = under_way.pop(future)
                if not isinstance(future.exception(), BrokenProcessPool):
                    yield Outcome(index, *pickle.loads(future.result()))
                    continue
                deaths[index] = deaths.get(index, 0) + 1
                if deaths[index] < LIVES:
                    again.append((index, item))
                else:
                    yield Outcome(index, failure=Failure("WorkerDied", f"its process died {LIVES} times"))
    finally:
        pool.end()


# --- a Dask cluster --------------------------------------------------------------------------------------


@contextlib.contextmanager
def _client_of(cluster: Any) -> Iterator[Any]:
    """A client of the cluster, closed afterwards if it was made here."""
    timeout = ANSWER
    with needed("six-wheel[cluster]", "clusters of Dask need"):
        distributed = importlib.import_module("distributed")
    if not isinstance(cluster, str):
        _check(cluster, timeout, "the cluster")
        yield cluster
        return
    try:
        client = distributed.Client(cluster, timeout=timeout, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        silent = f"cluster {cluster} does not answer within {timeout:g} s"
        raise ClusterError(f"{silent} ({one_line(error)})") from error
    try:
        _check(client, timeout, f"cluster {cluster}")
        yield client
    finally:
        client.close(timeout=timeout)


def _check(client: Any, timeout: float, name: str) -> None:
    """Results are only the same to the bit where the same code makes them."""
    try:
        client.wait_for_workers(1, timeout=timeout)
    except TimeoutError as error:
        raise ClusterError(f"{name} has no worker within {timeout:g} s") from error
    try:
        versions = client.run(_version)
    except ImportError as error:
        raise ClusterError(f"{name} has a worker without six_wheel {__version__}") from error
    for worker, version in versions.items():
        if version != __version__:
            raise ClusterError(f"{name} has a worker with six_wheel {version}, not {__version__}: {worker}")


def _version() -> str:
    return __version__


def _on_cluster(function: Callable[[Any], Any], items: Items, client: Any) -> Generator[Outcome]:
    """Outcomes in the order in which they finish. Items of a worker that dies go to another."""
    distributed = importlib.import_module("distributed")
    done = distributed.as_completed(loop=client.loop)
    under_way: dict[Any, int] = {}
    try:
        while True:
            threads = max(1, sum(client.nthreads().values()))
            while len(under_way) < AHEAD * threads and (pair := next(items, None)) is not None:
                # Scattering by hand would lose the item with the worker that holds it.
                future = client.submit(_attempt, function, pair[1], pure=False)
                under_way[future] = pair[0]
                done.add(future)
            if not under_way:
                return
            future = next(done)
            if future.status == "lost" and client.status == "running":
                done.add(future)  # its worker died with what it had computed; another one is at it
                continue
            if future.status in ("cancelled", "lost"):
                under_way.clear()  # there is nobody to tell
                raise ClusterError("the cluster went away")
            index, error = under_way.pop(future), future.exception()
            if type(error).__name__ == "KilledWorker":
                yield Outcome(index, failure=Failure("WorkerDied", "the workers it was given to died"))
            else:
                yield Outcome(index, *(future.result() if error is None else (None, _failure(error))))
    except distributed.comm.CommClosedError as error:
        under_way.clear()
        raise ClusterError(f"the cluster went away ({one_line(error)})") from error
    finally:
        if under_way:
            client.cancel(list(under_way))
