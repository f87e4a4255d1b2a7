"""The group SE(2): poses in the plane, and the twists that lead from one to the other.

>>> from six_wheel import se2
>>> se2.compose((1.0, 2.0, 0.0), se2.exp((0.5, 0.0, 0.0), 2.0))
array([2., 2., 0.])

Poses are rows ``[x, y, yaw]`` [m, m, rad], twists rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s],
with any leading axes. For one pose `Pose` has the same as methods.
"""

from __future__ import annotations  # NumPy is not loaded for its names

from typing import TYPE_CHECKING

from six_wheel._core import compose, differentiate, exp, integrate, log, wrap_angle
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from six_wheel.kinematics.poses import Floats

__all__ = [
    "between",
    "compose",
    "differentiate",
    "exp",
    "integrate",
    "interpolate",
    "inverse",
    "log",
    "wrap_angle",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = attach(__name__, {})


@checked()
def inverse(pose: ArrayLike) -> Floats:
    """The pose of the world in the body: composed with the pose it is the origin.

    Parameters
    ----------
    pose : array_like, shape (..., 3)
        Rows ``[x, y, yaw]`` [m, m, rad].

    Returns
    -------
    ndarray, shape (..., 3)

    Raises
    ------
    ValueError
        If the shape does not fit.
    """
    from six_wheel.kinematics import poses

    return poses.inverse(_rows("pose", pose))


@checked()
def between(first: ArrayLike, second: ArrayLike) -> Floats:
    """`second` as seen from `first`: ``compose(first, between(first, second))`` is `second`.

    Parameters
    ----------
    first, second : array_like, shape (..., 3)
        Rows ``[x, y, yaw]`` [m, m, rad]; their leading axes broadcast.

    Returns
    -------
    ndarray, shape (..., 3)
        The yaw lies between -pi and pi.

    Raises
    ------
    ValueError
        If a shape does not fit.
    """
    from six_wheel.kinematics import poses

    return poses.between(_rows("first", first), _rows("second", second))


@checked()
def interpolate(first: ArrayLike, second: ArrayLike, share: ArrayLike) -> Floats:
    """Poses on the arc of constant twist from `first` to `second`, the shorter way round.

    Parameters
    ----------
    first, second : array_like, shape (..., 3)
        Rows ``[x, y, yaw]`` [m, m, rad]; leading axes broadcast, with those of `share`.
    share : array_like, shape (...)
        Of the way: 0 is `first`, 1 is `second`; others go on along the arc.

    Returns
    -------
    ndarray, shape (..., 3)

    Raises
    ------
    ValueError
        If a shape does not fit, or a share is not finite.
    """
    import numpy as np

    from six_wheel.kinematics import poses

    start, shares = _rows("first", first), np.asarray(share, dtype=np.float64)
    if not np.isfinite(shares).all():
        raise ValueError(f"share must be finite, got {shares[~np.isfinite(shares)][0]}")
    step = log(poses.between(start, _rows("second", second)))
    return poses.joined(start, exp(shares[..., None] * step))


def _rows(argument: str, value: ArrayLike) -> Floats:
    """Poses as an array of shape (..., 3)."""
    import numpy as np

    rows = np.asarray(value, dtype=np.float64)
    if rows.shape[-1:] != (3,):
        raise ValueError(f"{argument} must have shape (..., 3), got {rows.shape}")
    return rows
