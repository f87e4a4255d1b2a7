"""Wheel speeds within their limits on the same path."""

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import Rover
from six_wheel.kinematics.poses import Floats


def desaturate(rover: Rover, wheel_speeds: ArrayLike, max_wheel_speed: ArrayLike) -> Floats:
    """See `Rover.desaturate`."""
    given = np.asarray(wheel_speeds, dtype=float)
    count = len(rover.wheels)
    if given.ndim == 0 or given.shape[-1] != count:
        raise ValueError(f"wheel_speeds must have shape (..., {count}), got {given.shape}")
    if not np.isfinite(given).all():
        raise ValueError("wheel_speeds must be finite, got some that are not")
    limits = np.asarray(max_wheel_speed, dtype=float)
    if limits.shape not in ((), (count,)):
        raise ValueError(f"max_wheel_speed must have shape () or ({count},), got {limits.shape}")
    if not (limits > 0.0).all():
        raise ValueError(f"max_wheel_speed must be positive, got {max_wheel_speed!r}")
    excess = (np.abs(given) / limits).max(axis=-1, keepdims=True, initial=1.0)
    return np.asarray(given / excess)
