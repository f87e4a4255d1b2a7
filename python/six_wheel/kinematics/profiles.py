"""Profiles of a value over time, and transitions of a rover built on them.

>>> from six_wheel import profiles
>>> profiles.s_curve(0.0, 1.0, 2.0).at(1.0)
State(value=0.5, velocity=1.0, acceleration=0.0, jerk=-4.0)
"""

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from six_wheel._core import BodyTransition, IcrTransition, ModuleTransition, Profile
from six_wheel.kinematics.objects.short_text import short_repr

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Floats: TypeAlias = "float | NDArray[np.float64]"

__all__ = [
    "BodyTransition",
    "IcrTransition",
    "ModuleTransition",
    "Peaks",
    "Phase",
    "Profile",
    "State",
    "TransitionState",
    "body_transition",
    "icr_transition",
    "linear",
    "module_transition",
    "s_curve",
    "time_optimal",
    "trapezoid",
]

linear = Profile.linear
trapezoid = Profile.trapezoid
s_curve = Profile.s_curve
time_optimal = Profile.time_optimal
body_transition = BodyTransition.between
module_transition = ModuleTransition.between
icr_transition = IcrTransition.between


class State(NamedTuple):
    """State of a profile at one time, or at many: floats or arrays of shape (..., [axes])."""

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


class TransitionState(NamedTuple):
    """Motion of body and wheels at one time of a transition, or at many, along leading axes."""

    twist: Floats
    """``[vx, vy, omega]``, shape (..., 3) [m/s, m/s, rad/s]; of modules, the one that fits them best."""
    steering: Floats
    """Angles of the steered wheels, shape (..., steered wheels) [rad]."""
    wheel_speeds: Floats
    """Wheel speeds, shape (..., wheels) [rad/s]."""
    steering_rates: Floats
    """Shape (..., steered wheels) [rad/s]."""
    steering_accelerations: Floats
    """Shape (..., steered wheels) [rad/s^2]."""
    scrub: Floats
    """Largest sliding speed of a wheel under the twist that fits all wheels best [m/s]."""

    def __repr__(self) -> str:
        return short_repr("TransitionState", self._asdict())


class Phase(NamedTuple):
    """A part of a transition."""

    action: str
    """``'drive'``, ``'stop'`` or ``'align'``."""
    start: float
    """When it begins [s]."""
    duration: float
    """Duration [s]."""
    reason: str
    """Why it is there."""
