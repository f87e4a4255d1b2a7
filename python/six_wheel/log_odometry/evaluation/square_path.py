"""The square-path test UMBmark: a differential drive's two systematic errors from where it stops.

Borenstein & Feng, Measurement and Correction of Systematic Odometry Errors in Mobile Robots, IEEE
Transactions on Robotics and Automation 12(6), 1996. It needs a tape measure only and is an independent
check of `calibrate`.
"""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import Rover, Wheel
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.poses import Floats
from six_wheel.robot_description.wheels_of_rover import with_wheels


@dataclass(frozen=True, eq=False)
class SquareTest:
    """Result of a square-path test.

    Attributes
    ----------
    rover : Rover
        With the corrected radii and track width; their mean radius is that of the given one.
    diameter_ratio : float
        E_d: diameter of the right wheel by that of the left.
    track_ratio : float
        E_b: true track width by the nominal one.
    clockwise, counter_clockwise : ndarray, shape (2,)
        Centres of gravity of the return errors [m].
    error : float
        The larger distance of the two from the start [m]: "the measure of dead-reckoning accuracy for
        systematic errors", E_max,syst.
    spread : float
        Root mean square distance of the single runs from their centre [m]: what is not systematic.
    """

    rover: Rover
    diameter_ratio: float
    track_ratio: float
    clockwise: Floats
    counter_clockwise: Floats
    error: float
    spread: float

    def __repr__(self) -> str:
        return (
            f"SquareTest(E_d {self.diameter_ratio:.6f}, E_b {self.track_ratio:.6f}, "
            f"systematic {self.error:.4f} m, spread {self.spread:.4f} m)"
        )


@checked()
def umbmark(rover: Rover, clockwise: ArrayLike, counter_clockwise: ArrayLike, side: float) -> SquareTest:
    """Wheel diameters and track width of a differential drive from its return errors on a square.

    The rover drives the square by its own odometry: four times straight on by `side` and a quarter turn on
    the spot, starting along +x, with the square to its left (counter-clockwise) or right (clockwise). It
    stops where it believes to have started.

    Parameters
    ----------
    rover : Rover
        Two unsteered wheels side by side.
    clockwise, counter_clockwise : array_like, shape (n, 2)
        Return errors, true position less that of the odometry, per run, seen from the start pose [m].
    side : float
        Length of a side [m].

    Returns
    -------
    SquareTest

    Raises
    ------
    ValueError
        If the rover is not such a drive, an error is not finite or a side not positive.

    Source: Borenstein & Feng 1996, with both coordinates of both centres where the paper takes one of them,
    and the curvature of the sides in place of their radius: a straight side is not special.
    """
    left, right, track = _pair(rover)
    if not (math.isfinite(side) and side > 0.0):
        raise ValueError(f"side must be finite and positive, got {side}")
    turns = {"clockwise": _errors("clockwise", clockwise)}
    turns["counter_clockwise"] = _errors("counter_clockwise", counter_clockwise)
    centres = {name: errors.mean(axis=0) for name, errors in turns.items()}

    # If every corner turns too far by `over` and every side bends left by `bend`, to first order side k
    # sets off k (over + bend) wrong to its left, counter-clockwise, or k (bend - over), clockwise. Summed
    # over the four sides: (2, -2) L (over + bend), and (2, 2) L (over - bend).
    both = float(centres["counter_clockwise"] @ (1.0, -1.0)) / (4.0 * side)
    difference = float(centres["clockwise"] @ (1.0, 1.0)) / (4.0 * side)
    over, bend = (both + difference) / 2.0, (both - difference) / 2.0
    track_ratio = (math.pi / 2.0) / (math.pi / 2.0 + over)
    lead = bend / side * track * track_ratio / 2.0  # of the right wheel before the middle, per distance
    diameter_ratio = (1.0 + lead) / (1.0 - lead)

    mean = (left.radius + right.radius) / 2.0
    radii = {left.name: 2.0 * mean / (1.0 + diameter_ratio)}
    radii[right.name] = diameter_ratio * radii[left.name]
    middle = (left.y + right.y) / 2.0
    corrected = with_wheels(
        rover,
        (
            {"radius": radii[wheel.name], "y": middle + (wheel.y - middle) * track_ratio}
            if wheel.name in radii
            else {}
            for wheel in rover.wheels
        ),
    )
    away = np.concatenate([errors - centres[name] for name, errors in turns.items()])
    return SquareTest(
        corrected,
        diameter_ratio,
        track_ratio,
        centres["clockwise"],
        centres["counter_clockwise"],
        max(float(np.hypot(*centre)) for centre in centres.values()),
        math.sqrt(float(np.mean(np.sum(away * away, axis=1)))),
    )


def _pair(rover: Rover) -> tuple[Wheel, Wheel, float]:
    """The left and the right wheel, and how far apart they are."""
    driven = [wheel for wheel in rover.wheels if wheel.driven]
    plain = all(not (w.steered or w.castor or w.heading or w.scrub or w.roller_angle) for w in driven)
    if len(driven) != 2 or not plain or driven[0].x != driven[1].x or driven[0].y == driven[1].y:
        raise ValueError(f"rover must have two driven, unsteered wheels side by side, got {rover!r}")
    left, right = sorted(driven, key=lambda wheel: -wheel.y)
    return left, right, left.y - right.y


def _errors(name: str, values: ArrayLike) -> Floats:
    errors = np.asarray(values, dtype=np.float64)
    if errors.ndim != 2 or errors.shape[1] != 2 or len(errors) == 0:
        raise ValueError(f"{name} must have shape (n, 2), n >= 1, got {errors.shape}")
    if not np.isfinite(errors).all():
        raise ValueError(f"{name} must be finite, got {errors.tolist()}")
    return errors
