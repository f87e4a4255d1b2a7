"""The items on a Dask cluster, given by its address or its client."""

import contextlib
import importlib
from collections.abc import Callable, Generator, Iterator
from typing import Any

from six_wheel._core import __version__
from six_wheel.parallel.outcomes import Failure, Outcome, failed

__all__ = ["ClusterError", "client_of", "on_cluster"]

Items = Iterator[tuple[int, Any]]

ANSWER = 10.0  # [s] in which a cluster has to answer
AHEAD = 2  # items per thread of a worker that wait for it


class ClusterError(ConnectionError):
    """A cluster that does not answer, has no workers, or has another six_wheel."""


@contextlib.contextmanager
def client_of(cluster: Any) -> Iterator[Any]:
    """A client of the cluster, closed afterwards if it was made here.

    Raises
    ------
    ImportError
        If Dask is not installed.
    ClusterError
        If nobody answers at the address, no worker is there, or one has another six_wheel.
    """
    timeout = ANSWER
    try:
        distributed = importlib.import_module("distributed")
    except ImportError as missing:
        raise ImportError('clusters need Dask: pip install "six-wheel[cluster]"') from missing
    if not isinstance(cluster, str):
        _check(cluster, timeout, "the cluster")
        yield cluster
        return
    try:
        client = distributed.Client(cluster, timeout=timeout, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        said = " ".join(str(error).split())
        raise ClusterError(f"cluster {cluster} does not answer within {timeout:g} s ({said})") from error
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


def on_cluster(function: Callable[[Any], Any], items: Items, client: Any) -> Generator[Outcome]:
    """Outcomes in the order in which they finish, on the workers of a client.

    Items of a worker that dies go to another.

    Raises
    ------
    ClusterError
        If the cluster itself goes away.
    """
    distributed = importlib.import_module("distributed")
    done = distributed.as_completed(loop=client.loop)
    on_their_way: dict[Any, int] = {}

    def fill() -> None:
        threads = max(1, sum(client.nthreads().values()))
        while len(on_their_way) < AHEAD * threads:
            pair = next(items, None)
            if pair is None:
                return
            # Scattering by hand would lose the item with the worker that holds it.
            future = client.submit(function, pair[1], pure=False)
            on_their_way[future] = pair[0]
            done.add(future)

    try:
        fill()
        while on_their_way:
            future = next(done)
            index = on_their_way.pop(future)
            if future.status == "lost" and client.status == "running":
                # Its worker died with what it had computed; somebody else is at it.
                on_their_way[future] = index
                done.add(future)
                continue
            if future.status in ("cancelled", "lost"):
                on_their_way.clear()
                raise ClusterError("the cluster went away")
            yield _outcome(index, future)
            fill()
    except distributed.comm.CommClosedError as error:
        on_their_way.clear()  # there is nobody to tell
        raise ClusterError(f"the cluster went away ({' '.join(str(error).split())})") from error
    finally:
        if on_their_way:
            client.cancel(list(on_their_way))


def _outcome(index: int, future: Any) -> Outcome:
    error = future.exception()
    if error is None:
        return Outcome(index, future.result())
    if type(error).__name__ == "KilledWorker":
        return Outcome(index, failure=Failure("WorkerDied", "the workers it was given to died"))
    return failed(index, error)
