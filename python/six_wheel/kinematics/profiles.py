"""Profiles of a value over time, and transitions of a rover built on them.

>>> from six_wheel import profiles
>>> profiles.s_curve(0.0, 1.0, 2.0).at(1.0)
State(value=0.5, velocity=1.0, acceleration=0.0, jerk=-4.0)
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from six_wheel._core import BodyTransition, IcrTransition, ModuleTransition, Profile
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.lazy import attach
from six_wheel.kinematics.objects import tables
from six_wheel.kinematics.objects.short_text import of_arrays

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

if not TYPE_CHECKING:
    __getattr__, __dir__ = attach(__name__, {})

linear = Profile.linear
trapezoid = Profile.trapezoid
s_curve = Profile.s_curve
time_optimal = Profile.time_optimal
body_transition = BodyTransition.between
module_transition = ModuleTransition.between
icr_transition = IcrTransition.between


@checked_class
@of_arrays
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

    def _columns(self, times: Any = None) -> tables.Columns:
        """Columns of the fields, of several axes with their numbers; ``time`` where it is given."""
        return _samples(self._asdict(), times)

    to_arrays, to_pandas = tables.Tabular.to_arrays, tables.Tabular.to_pandas  # type: ignore[misc]
    to_arrow, to_csv = tables.Tabular.to_arrow, tables.Tabular.to_csv  # type: ignore[misc]


@checked_class
@of_arrays
class Peaks(NamedTuple):
    """Largest magnitudes of a profile: floats, or arrays of shape (axes,)."""

    velocity: Floats
    """Per [s]."""
    acceleration: Floats
    """Per [s^2]."""
    jerk: Floats
    """Per [s^3]."""


@checked_class
@of_arrays
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

    def _columns(self, times: Any = None) -> tables.Columns:
        """A column for every number of the fields; ``time`` where it is given."""
        return _samples(self._asdict(), times)

    to_arrays, to_pandas = tables.Tabular.to_arrays, tables.Tabular.to_pandas  # type: ignore[misc]
    to_arrow, to_csv = tables.Tabular.to_arrow, tables.Tabular.to_csv  # type: ignore[misc]


@checked_class
class Phase(NamedTuple):
    """A part of a transition."""

    action: str
    """``'drive'``, ``'stop'`` or ``'align'``."""
    start: float
    """Time of its begin [s]."""
    duration: float
    """Duration [s]."""
    reason: str
    """Its reason."""


_UNITS = {
    "velocity": "1/s",
    "acceleration": "1/s^2",
    "jerk": "1/s^3",
    "vx": "m/s",
    "vy": "m/s",
    "omega": "rad/s",
    "steering": "rad",
    "wheel_speeds": "rad/s",
    "steering_rates": "rad/s",
    "steering_accelerations": "rad/s^2",
    "scrub": "m/s",
}


def _samples(fields: Mapping[str, Any], times: Any) -> tables.Columns:
    """Columns of samples at one time or many: fields with a last axis have one for each of its numbers."""
    import numpy as np

    scalar = "value" if "value" in fields else "scrub"
    count = len(np.atleast_1d(fields[scalar]))
    if times is not None and np.shape(times) != (count,):
        raise ValueError(f"times must have shape ({count},), got {np.shape(times)}")
    columns: tables.Columns = {} if times is None else {"time": ("s", np.asarray(times, dtype=np.float64))}
    for name, values in fields.items():
        rows = np.asarray(values, dtype=np.float64).reshape(count, -1)
        parts = [f"{name}_{k}" for k in range(rows.shape[1])] if np.ndim(values) > 1 else [name]
        parts = list(tables.TWIST) if name == "twist" else parts
        columns |= {
            part: (_UNITS.get(part, _UNITS.get(name, "")), rows[:, k]) for k, part in enumerate(parts)
        }
    return columns
