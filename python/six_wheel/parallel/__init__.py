"""One function over many items: on this machine's cores or, unchanged, on a Dask cluster.

`spreading` runs the items in processes or on Dask (extra ``[cluster]``), `journal` keeps what is finished;
`blas_threads` holds linear algebra of small matrices to one thread.
"""

from six_wheel.parallel.blas_threads import one_thread
from six_wheel.parallel.journal import Journal, JournalError
from six_wheel.parallel.spreading import ClusterError, Failure, Outcome, Outcomes, collect, spread

__all__ = [
    "ClusterError",
    "Failure",
    "Journal",
    "JournalError",
    "Outcome",
    "Outcomes",
    "collect",
    "one_thread",
    "spread",
]
