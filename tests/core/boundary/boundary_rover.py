"""A rover and its arrays at the boundary."""

import numpy as np

from tests.rovers import SIX_WHEELS as ROVER

TWISTS = np.array([[0.5, 0.0, 0.3], [0.2, 0.0, -1.0], [0.0, 0.0, 0.5], [-0.4, 0.0, 0.0], [0.0, 0.0, 0.0]])
STEERING, SPEEDS = ROVER.inverse(TWISTS)


def read_only(array: np.ndarray) -> np.ndarray:
    array = array.copy()
    array.flags.writeable = False
    return array
