"""How a value goes from here to there: profiles over time, with three derivatives.

>>> from six_wheel import profiles
>>> profiles.s_curve(0.0, 1.0, 2.0).at(1.0)
State(value=0.5, velocity=1.0, acceleration=0.0, jerk=-4.0)
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from six_wheel._core import Profile

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Floats: TypeAlias = "float | NDArray[np.float64]"

__all__ = ["Peaks", "Profile", "State", "linear", "s_curve", "time_optimal", "trapezoid"]

linear = Profile.linear
trapezoid = Profile.trapezoid
s_curve = Profile.s_curve
time_optimal = Profile.time_optimal


class State(NamedTuple):
    """Where a profile is at one time, or at many: floats or arrays of shape (..., [axes])."""

    value: Floats
    """In the unit of start and end."""
    velocity: Floats
    """Per [s]."""
    acceleration: Floats
    """Per [s^2]."""
    jerk: Floats
    """Per [s^3]."""


class Peaks(NamedTuple):
    """Largest magnitudes of a profile: floats, or arrays of shape (axes,)."""

    velocity: Floats
    """Per [s]."""
    acceleration: Floats
    """Per [s^2]."""
    jerk: Floats
    """Per [s^3]."""


def _remake(maker: str, arguments: tuple[Any, ...], keywords: Mapping[str, Any]) -> Any:
    """Call one of this module's functions again: how its objects are unpickled."""
    return globals()[maker](*arguments, **keywords)
