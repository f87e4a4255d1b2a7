"""The items on this machine's cores, a process each."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Generator, Iterator
from dataclasses import replace
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, NamedTuple

from six_wheel.parallel.outcomes import Failure, Outcome, failed

__all__ = ["cores", "here", "processes"]

Items = Iterator[tuple[int, Any]]

LIVES = 3  # an item whose process dies so often is not tried again


class Worker(NamedTuple):
    """A process, and this end of the pipe to it."""

    process: BaseProcess
    pipe: Connection


def cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def here(function: Callable[[Any], Any], items: Items) -> Generator[Outcome]:
    """One after the other, in this process."""
    for index, item in items:
        yield _outcome(function, index, item)


def processes(function: Callable[[Any], Any], items: Items, workers: int) -> Generator[Outcome]:
    """Outcomes in the order in which they finish, in `workers` processes with a pipe each."""
    busy: dict[Connection, tuple[Worker, int, Any]] = {}
    idle: list[Worker] = []
    again: list[tuple[int, Any]] = []
    deaths: dict[int, int] = {}
    try:
        while True:
            while len(busy) < workers:
                pair = again.pop() if again else next(items, None)
                if pair is None:
                    break
                worker = idle.pop() if idle else _hire(function)
                busy[worker.pipe] = (worker, *pair)
                try:
                    worker.pipe.send(pair)
                except OSError:
                    pass  # it is dead, which is noticed where its answer is read
                except Exception as error:  # an item that does not go through a pipe
                    del busy[worker.pipe]
                    idle.append(worker)
                    yield failed(pair[0], error)
            if not busy:
                return
            for pipe in wait(list(busy)):
                assert isinstance(pipe, Connection)
                worker, index, item = busy.pop(pipe)
                try:
                    outcome = pipe.recv()
                except (EOFError, OSError):
                    _dismiss(worker)
                    deaths[index] = deaths.get(index, 0) + 1
                    if deaths[index] < LIVES:
                        again.append((index, item))
                        continue
                    outcome = Outcome(index, failure=Failure("WorkerDied", f"its process died {LIVES} times"))
                else:
                    idle.append(worker)
                yield replace(outcome, index=index)
    finally:
        # Items that nobody waits for any more need not be finished.
        for worker, _, _ in busy.values():
            worker.process.terminate()
        for worker in [*idle, *(worker for worker, _, _ in busy.values())]:
            _dismiss(worker)


def _hire(function: Callable[[Any], Any]) -> Worker:
    # A forked copy of a process with threads may hold a lock for ever.
    context = multiprocessing.get_context("spawn")
    mine, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, function), daemon=True)
    process.start()
    theirs.close()
    return Worker(process, mine)


def _dismiss(worker: Worker) -> None:
    worker.pipe.close()
    worker.process.join()


def _work(pipe: Connection, function: Callable[[Any], Any]) -> None:
    """In a process of its own, until nobody is at the other end. Ctrl-C is for the one that started it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    while True:
        try:
            index, item = pipe.recv()
        except EOFError:
            return
        except Exception as error:  # an item that cannot be unpacked here: which one, the other end knows
            pipe.send(failed(-1, error))
            continue
        outcome = _outcome(function, index, item)
        try:
            pipe.send(outcome)
        except OSError:
            return
        except Exception as error:  # a value that does not go through a pipe
            pipe.send(failed(index, error))


def _outcome(function: Callable[[Any], Any], index: int, item: Any) -> Outcome:
    try:
        return Outcome(index, function(item))
    except Exception as error:
        return failed(index, error)
