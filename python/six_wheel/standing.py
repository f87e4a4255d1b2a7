"""What came of settling a rover on ground."""

from __future__ import annotations  # NumPy is not loaded for its names

from enum import StrEnum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["SettleStatus"]


class SettleStatus(StrEnum):
    """Whether a rover stands at a pose, and if not, why. Prints, and compares with text, by its name."""

    settled = "settled"
    """Every wheel touches that can."""
    at_stop = "at_stop"
    """A joint is at its stop, and a wheel hangs in the air for it."""
    off_map = "off_map"
    """The rim of a wheel leaves the map."""
    unknown_cells = "unknown_cells"
    """The rim of a wheel lies over ground that is not known."""
    not_converged = "not_converged"
    """No way to stand was found: `Stand.reason` says more."""

    def __repr__(self) -> str:
        return self.value


def statuses(codes: int | NDArray[np.int64]) -> SettleStatus | NDArray[Any]:
    """The status of a code of the core, or an array of them."""
    import numpy as np

    known = np.empty(len(SettleStatus), dtype=object)
    known[:] = list(SettleStatus)
    found: SettleStatus | NDArray[Any] = known[codes]
    return found
