"""Names of the codes of the core: how a rover settled, its bounds, and whether it may stand somewhere."""

import math
from collections.abc import Callable
from functools import wraps
from typing import Any, NamedTuple, Self, TypeVar

import numpy as np

from six_wheel._core import ask_settings
from six_wheel.kinematics import rover_edit
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.objects.checked_values import of_numbers
from six_wheel.kinematics.objects.flags import TextName


class SettleStatus(TextName):
    """Status of a settled pose; prints, and compares with text, by its name; `help` has more."""

    settled = "settled", "every wheel touches that can"
    at_stop = "at_stop", "a joint is at its stop, and a wheel hangs: go elsewhere, or widen its stops"
    off_map = "off_map", "the rim of a wheel leaves the map: give a larger one"
    unknown_cells = (
        "unknown_cells",
        "a rim lies over ground that is not known: fill the map, or go elsewhere",
    )
    not_converged = "not_converged", "no way to stand was found: `SettledPose.reason` says more"


class BoundsStatus(TextName):
    """Validity of the bounds of a pose; prints, and compares with text, by its name; `help` has more."""

    bounded = "bounded", "the rover, settled, is inside the intervals"
    off_map = "off_map", "a wheel or the belly may be outside the map: give a larger one"
    unknown_cells = "unknown_cells", "a height under them is not known: fill the map"
    unsolved = "unsolved", "heights of wheels without a solution, or not proved extreme: `settle` decides"
    beyond = "beyond", "tilt may carry a wheel out of the box that was looked at: give `within`"
    at_stop = "at_stop", "a joint may be at its stop, with a wheel in the air: `settle` decides"


class FeasibilityReason(TextName):
    """Reason for which a rover may not stand at a pose: the limit exceeded most, or the unknown ground."""

    ok = "ok", "it may stand there"
    roll = "roll", "too much roll: try another heading, or allow more `roll`"
    pitch = "pitch", "too much pitch: try another heading, or allow more `pitch`"
    tilt = "tilt", "too much tilt: go elsewhere, or allow more `tilt`"
    clearance = "clearance", "too little room under the belly: go elsewhere, or ask for less `clearance`"
    rocker = "rocker", "a rocker turned too far: go elsewhere, or allow more `rocker`"
    bogie = "bogie", "a bogie turned too far: go elsewhere, or allow more `bogie`"
    wheel_drop = "wheel_drop", "a wheel too far down: go elsewhere, or allow more `wheel_drop`"
    off_map = "off_map", "a wheel or the belly may leave the map: give a larger one"
    unknown_cells = "unknown_cells", "a wheel or the belly may be over ground that is not known: fill the map"
    not_settled = "not_settled", "no way to stand was found: `settle` says why"


def _by_code(kind: type[TextName]) -> Callable[[Any], Any]:
    """The name of a code of the core, or an array of names."""
    names = np.empty(len(kind), dtype=object)
    names[:] = list(kind)
    return names.__getitem__


settle_statuses, bound_statuses, feasible_reasons = map(
    _by_code, (SettleStatus, BoundsStatus, FeasibilityReason)
)

_Class = TypeVar("_Class", bound=type[Any])


def _with_plausible_units(limits: _Class) -> _Class:
    """The class, which warns of angles that are likely in degrees when it is called."""
    plain: Any = limits.__new__

    @wraps(plain)
    def new(cls: type[Any], /, *given: float, **named: float) -> Any:
        made = plain(cls, *given, **named)
        ask_settings(made._asdict())
        return made

    limits.__new__ = new  # type: ignore[assignment]
    return limits


@of_numbers
@checked_class
@_with_plausible_units
class FeasibilityLimits(NamedTuple):
    """Limits for standing at a pose; by default none but a belly that touches nothing.

    Warns
    -----
    SuspiciousUnitsWarning
        If an angle is above a quarter turn.
    """

    roll: float = math.inf
    """Largest roll [rad]."""
    pitch: float = math.inf
    """Largest pitch [rad]."""
    tilt: float = math.inf
    """Largest tilt [rad]."""
    rocker: float = math.inf
    """Largest angle of a rocker [rad]."""
    bogie: float = math.inf
    """Largest angle of a bogie [rad]."""
    clearance: float = 0.0
    """Least clearance of the belly [m]."""
    wheel_drop: float = math.inf
    """Largest drop of a wheel in the rover's frame [m]."""

    @classmethod
    def curiosity(cls) -> Self:
        """Those of Curiosity: 15 degrees of roll and pitch, 30 of tilt, 7 of a rocker and 17 of a bogie.

        Source: A. Rankin, M. Maimone, J. Biesiadecki, N. Patel, D. Levine, O. Toupet, Driving Curiosity: Mars
        rover mobility trends during the first seven years, IEEE Aerospace Conference 2020.
        """
        return cls(*map(math.radians, (15, 15, 30, 7, 17)))

    def __repr__(self) -> str:
        if self == type(self).curiosity():
            return "FeasibilityLimits.curiosity()"
        usual = self._field_defaults
        given = (f"{name}={value!r}" for name, value in self._asdict().items() if value != usual[name])
        return f"FeasibilityLimits({', '.join(given)})"

    def replace(self, **changes: Any) -> Self:
        """The same with some of its values given anew; None is the default of one that has it."""
        return rover_edit.replace(self, **changes)

    def __replace__(self, **changes: Any) -> Self:
        return rover_edit.replace(self, **changes)
