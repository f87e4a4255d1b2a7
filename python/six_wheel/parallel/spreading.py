"""The face: one function over many items, wherever they run."""

import contextlib
from collections.abc import Callable, Generator, Iterable, Iterator
from typing import Any

from six_wheel.parallel.journal import Journal
from six_wheel.parallel.local import cores, here, processes
from six_wheel.parallel.outcomes import Failure, Outcome, Outcomes
from six_wheel.parallel.remote import client_of, on_cluster

__all__ = ["collect", "spread"]


def spread(
    function: Callable[[Any], Any],
    items: Iterable[Any],
    *,
    cluster: Any = None,
    workers: int | None = None,
    journal: Journal | None = None,
    prepare: Callable[[Any], Any] | None = None,
    tell: Callable[[int], object] | None = None,
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
    tell : callable, optional
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
    finished = 0

    def count() -> None:
        nonlocal finished
        finished += 1
        if tell is not None:
            tell(finished)

    resumed: list[int] = []

    def remaining() -> Iterator[tuple[int, Any]]:
        for index, item in enumerate(items):
            if journal is not None and index in journal:
                resumed.append(index)
            else:
                yield index, item if prepare is None else prepare(item)

    with contextlib.ExitStack() as stack:
        pairs = remaining()
        outcomes: Generator[Outcome]
        if cluster is not None:
            client = stack.enter_context(client_of(cluster))
            outcomes = on_cluster(function, pairs, client)
        elif workers == 1 or (workers is None and cores() == 1):
            outcomes = here(function, pairs)
        else:
            outcomes = processes(function, pairs, workers or cores())
        stack.enter_context(contextlib.closing(outcomes))

        def known() -> Iterator[Outcome]:
            while resumed and journal is not None:
                index = resumed.pop()
                count()
                yield Outcome(index, journal.read(index), resumed=True)

        for outcome in outcomes:
            yield from known()
            if journal is not None and outcome.failure is None:
                journal.write(outcome.index, outcome.value)
            count()
            yield outcome
        yield from known()


def collect(function: Callable[[Any], Any], items: Iterable[Any], **options: Any) -> Outcomes:
    """`spread`, all of it, in the order of the items."""
    values: dict[int, Any] = {}
    failures: dict[int, Failure] = {}
    for outcome in spread(function, items, **options):
        values[outcome.index] = outcome.value
        if outcome.failure is not None:
            failures[outcome.index] = outcome.failure
    return Outcomes([values[index] for index in sorted(values)], dict(sorted(failures.items())))
