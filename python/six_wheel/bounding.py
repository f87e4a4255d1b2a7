"""What the bounds of a pose are worth, and what may be driven on."""

from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["BoundStatus", "statuses"]


class BoundStatus(StrEnum):
    """What the bounds of a pose are worth. Prints, and compares with text, by its name."""

    bounded = "bounded"
    """The rover, settled, is inside the intervals."""
    off_map = "off_map"
    """A wheel or the belly may be outside the map."""
    unknown_cells = "unknown_cells"
    """A height under them is not known."""
    unsolved = "unsolved"
    """Some heights of the wheels have no solution, or are not proved to be extreme: not known, not impossible."""
    beyond = "beyond"
    """The rover may be inclined so far that a wheel leaves the box that was looked at."""
    at_stop = "at_stop"
    """A joint may be at its stop, with a wheel in the air."""

    def __repr__(self) -> str:
        return self.value


_ALL = np.empty(len(BoundStatus), dtype=object)
_ALL[:] = list(BoundStatus)


def statuses(codes: int | NDArray[np.uint8]) -> BoundStatus | NDArray[Any]:
    """The status of a code of the core, or an array of them."""
    found: BoundStatus | NDArray[Any] = _ALL[codes]
    return found
