"""Columns of a record as they are plotted: the lowest and the highest value of every stretch of time."""

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats
from six_wheel.simulation.drive.min_max_thinning import Course

BLOCK = 65_536  # rows that are copied at a time


def thin_columns(
    times: Floats, columns: Floats, reasons: NDArray[np.uint32] | None = None
) -> tuple[Floats, Floats, Floats, NDArray[np.uint32]]:
    """Of columns (n, k) over times (n,): each stretch's time twice with its lowest and highest values (m, k);
    its begin, and all reasons there were in it. No peak is lost."""
    course = Course(columns.shape[1])
    none = np.zeros(len(times), np.uint32) if reasons is None else reasons
    for start in range(0, len(times), BLOCK):
        part = slice(start, start + BLOCK)
        course.add(times[part], columns[part], none[part])
    begins, low, high, found = course.stretches()
    values = np.stack([low, high], axis=1).reshape(-1, columns.shape[1])
    return np.repeat(begins, 2), values, begins, found
