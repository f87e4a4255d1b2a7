"""Names of the codes of the core: how a rover settled, its bounds, and whether it may stand somewhere."""

import math
from collections.abc import Callable
from enum import StrEnum
from functools import wraps
from typing import Any, NamedTuple, Self, TypeVar

import numpy as np

from six_wheel._core import ask_settings
from six_wheel.kinematics import rover_edit

__all__ = ["BoundsStatus", "FeasibilityLimits", "FeasibilityReason", "SettleStatus"]


class _Named(StrEnum):
    """A code of the core by its name."""

    def __repr__(self) -> str:
        return self.value


class SettleStatus(_Named):
    """Status of a settled pose. Prints, and compares with text, by its name."""

    settled = "settled"
    """Every wheel touches that can."""
    at_stop = "at_stop"
    """A joint is at its stop, and a wheel hangs in the air for it."""
    off_map = "off_map"
    """The rim of a wheel leaves the map."""
    unknown_cells = "unknown_cells"
    """The rim of a wheel lies over ground that is not known."""
    not_converged = "not_converged"
    """No way to stand was found: `SettledPose.reason` says more."""


class BoundsStatus(_Named):
    """Validity of the bounds of a pose. Prints, and compares with text, by its name."""

    bounded = "bounded"
    """The rover, settled, is inside the intervals."""
    off_map = "off_map"
    """A wheel or the belly may be outside the map."""
    unknown_cells = "unknown_cells"
    """A height under them is not known."""
    unsolved = "unsolved"
    """Some heights of the wheels have no solution, or are not proved to be extreme: not impossible."""
    beyond = "beyond"
    """The rover may be inclined so far that a wheel leaves the box that was looked at."""
    at_stop = "at_stop"
    """A joint may be at its stop, with a wheel in the air."""


class FeasibilityReason(_Named):
    """Reason for which a rover may not stand at a pose: the limit exceeded most, or the unknown ground."""

    ok = "ok"
    """It may."""
    roll = "roll"
    """Too much roll."""
    pitch = "pitch"
    """Too much pitch."""
    tilt = "tilt"
    """Too much tilt."""
    clearance = "clearance"
    """Too little room under the belly."""
    rocker = "rocker"
    """A rocker turned too far."""
    bogie = "bogie"
    """A bogie turned too far."""
    wheel_drop = "wheel_drop"
    """A wheel too far down."""
    off_map = "off_map"
    """A wheel or the belly may leave the map."""
    unknown_cells = "unknown_cells"
    """A wheel or the belly may be over ground that is not known."""
    not_settled = "not_settled"
    """No way to stand was found."""


def _by_code(kind: type[_Named]) -> Callable[[Any], Any]:
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


@_with_plausible_units
class FeasibilityLimits(NamedTuple):
    """Limits for standing at a pose; by default those of Curiosity, and a belly that touches nothing.

    Source: A. Rankin, M. Maimone, J. Biesiadecki, N. Patel, D. Levine, O. Toupet, Driving Curiosity: Mars
    rover mobility trends during the first seven years, IEEE Aerospace Conference 2020.

    Warns
    -----
    SuspiciousUnitsWarning
        If an angle is above a quarter turn.
    """

    roll: float = math.radians(15)
    """Largest roll [rad]."""
    pitch: float = math.radians(15)
    """Largest pitch [rad]."""
    tilt: float = math.radians(30)
    """Largest tilt [rad]."""
    rocker: float = math.radians(7)
    """Largest angle of a rocker [rad]."""
    bogie: float = math.radians(17)
    """Largest angle of a bogie [rad]."""
    clearance: float = 0.0
    """Least clearance of the belly [m]."""
    wheel_drop: float = math.inf
    """Largest drop of a wheel in the rover's frame [m]."""

    def replace(self, **changes: Any) -> Self:
        """The same with some of its values given anew; None is the default of one that has it."""
        return rover_edit.replace(self, **changes)

    def __replace__(self, **changes: Any) -> Self:
        return rover_edit.replace(self, **changes)
