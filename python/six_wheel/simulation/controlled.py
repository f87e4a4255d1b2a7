"""Record of a controller in a simulated drive."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Limits
from six_wheel.kinematics.controller import reason_shares
from six_wheel.kinematics.poses import Floats


@dataclass(frozen=True, eq=False)
class Controlled:
    """Record of a controller's steps.

    Attributes
    ----------
    limits : Limits
        Those it kept.
    times : ndarray, shape (n,)
        Of its steps, since the first command [s].
    values : ndarray, shape (n, 6 + 2 steered + wheels)
        Commanded and limited twists, commanded steering angles, their rates and wheel speeds.
    reasons : ndarray, shape (n,)
        Bits of `Reason`.
    joint : str or None
        The joint that it found stuck.
    found : float or None
        When, since the first command [s].
    error : float or None
        Reading less command of that joint then [rad].
    """

    limits: Limits
    times: Floats
    values: Floats
    reasons: NDArray[np.uint32]
    joint: str | None = None
    found: float | None = None
    error: float | None = None

    @property
    def shares(self) -> dict[str, float]:
        """Share of the steps, 0 to 1, of every reason there was."""
        return reason_shares(self.reasons)
