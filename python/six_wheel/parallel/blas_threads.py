"""Linear algebra of small matrices on one thread.

Threads of a BLAS that wait for each other spin: on a machine with other work a product of small matrices then
takes several times as long as on one thread, and its time depends on what runs beside it.
"""

import contextlib
from collections.abc import Iterator


@contextlib.contextmanager
def one_thread() -> Iterator[None]:
    """Holds BLAS to one thread, if threadpoolctl (extra ``[calibrate]``) is there to ask it."""
    try:
        from threadpoolctl import threadpool_limits
    except ModuleNotFoundError:
        yield
        return
    with threadpool_limits(1, user_api="blas"):
        yield
