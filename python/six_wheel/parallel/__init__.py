"""One function over many items: on this machine's cores or, unchanged, on a Dask cluster.

`spread` hands out every item as soon as it is done, with its place; `collect` waits for all and keeps the
order. An item that fails is reported and stops nothing else; a worker that dies loses nothing, its items are
done again. A `Journal` keeps what is done on disk, so that a run that was stopped goes on where it was.
Values are those of ``function(item)`` wherever it ran, to the last bit.

`spreading` is the face, `local` the processes of this machine, `remote` Dask (extra ``[cluster]``), `journal`
the folder of finished items, `outcomes` what comes back.
"""

from six_wheel.parallel.journal import Journal, JournalError
from six_wheel.parallel.outcomes import Failure, Outcome, Outcomes
from six_wheel.parallel.remote import ClusterError
from six_wheel.parallel.spreading import collect, spread

__all__ = ["ClusterError", "Failure", "Journal", "JournalError", "Outcome", "Outcomes", "collect", "spread"]
