"""Motion that no rover makes: wheels that spin, rims that gain speed as if thrown, bodies that whirl."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover, Wheel
from six_wheel.logs.plausibility.proposals import (
    Column,
    ImplausibleReadingError,
    Proposal,
    at_its_word,
    columns,
    encoders,
)

__all__ = ["STRETCH", "check_motion", "check_steering", "degrees"]

Floats = NDArray[np.float64]

STRETCH = 0.5  # [s] over which rates are taken
FASTEST_RIM = 100.0  # [m/s]
FASTEST_WHEEL = 200.0  # [rad/s] for two stretches in a row
HARDEST_START = 20.0  # [m/s²] of the median rim from one stretch to the next
HARDEST_TURN = 50.0  # [m/s²] towards the centre of the turn
FASTEST_TURN = 12.6  # [rad/s] of the body, for two stretches in a row
ENOUGH = 4  # stretches
PLAY = 0.1  # [rad] beyond its range at which a joint may be measured


def check_motion(
    rover: Rover, rates: Floats, steering: Floats | None, periods: Floats
) -> tuple[int, int, str] | None:
    """A stretch in which wheels move as none can: its number, the wheel, and the figure in words.

    Parameters
    ----------
    rates : array, shape (n, wheels)
        Of rotation, means over stretches [rad/s]; NaN without a reading.
    steering : array, shape (n, steered wheels), or None
        Angles in the middle of them [rad].
    periods : array, shape (n,)
        Their lengths [s].
    """
    if len(rates) < ENOUGH:
        return None
    radii = np.array([wheel.radius for wheel in rover.wheels])
    rims = np.abs(rates) * radii
    fastest = np.nan_to_num(rims).max(axis=1)
    spinning = np.nan_to_num(np.abs(rates)).max(axis=1) > FASTEST_WHEEL
    spinning[1:] &= spinning[:-1]
    spinning[0] = False
    for found in (fastest > FASTEST_RIM, spinning):
        if found.any():
            row = int(np.argmax(found))
            wheel = int(np.nanargmax(rims[row]))
            turning = abs(float(rates[row, wheel]))
            return row, wheel, f"turns at {turning:.4g} rad/s, {rims[row, wheel]:.4g} m/s at the rim,"
    if float(fastest.max()) < 1.0:
        return None
    return _of_body(rover, rates, steering, periods, rims)


def _of_body(
    rover: Rover, rates: Floats, steering: Floats | None, periods: Floats, rims: Floats
) -> tuple[int, int, str] | None:
    """As `check_motion`, by what all wheels do together."""
    heard = ~np.isnan(rates).all(axis=0)
    there = np.isfinite(rates[:, heard]).all(axis=1)
    if there.sum() < ENOUGH:
        return None
    spans = np.maximum((periods[1:] + periods[:-1]) / 2.0, STRETCH / 2.0)
    gained = np.zeros(len(spans))
    if float(np.nanmax(rims)) > HARDEST_START * STRETCH / 2.0:  # slower rims cannot gain so much
        middle = np.full(len(rates), np.nan)
        middle[there] = np.median(rims[there][:, heard], axis=1)
        gained = np.abs(np.diff(middle)) / spans
    found = np.nan_to_num(gained) > HARDEST_START
    if found.any():
        row = int(np.argmax(found)) + 1
        wheel = int(np.nanargmax(rims[row]))
        return row, wheel, f"gains or loses {gained[row - 1] / 9.81:.3g} g at the rim"
    try:
        turned = np.zeros((int(there.sum()), 0)) if steering is None else steering[there]
        twists = np.asarray(rover.forward(turned, np.nan_to_num(rates[there])))
    except ValueError:
        return None
    rows = np.flatnonzero(there)
    whirling = np.abs(twists[:, 2]) > FASTEST_TURN
    whirling[1:] &= whirling[:-1]
    whirling[0] = False
    pulled = np.abs(twists[:, 2]) * np.hypot(twists[:, 0], twists[:, 1])
    for found, figures, unit in (
        (pulled > HARDEST_TURN, pulled / 9.81, "with {:.3g} g"),
        (whirling, np.abs(twists[:, 2]), "at {:.3g} rad/s"),
    ):
        if found.any():
            first = int(np.argmax(found))
            row = int(rows[first])
            what = f"makes the rover turn {unit.format(figures[first])}"
            return row, int(np.nanargmax(rims[row])), what
    return None


def degrees(wheels: Sequence[Column], rates: bool, named: bool) -> Proposal:
    """The proposal to read these columns in degrees; `named` where they have headers."""
    if not named:
        return encoders(turn=360)
    unit = "deg/s" if rates else "deg"
    return columns({column.header: f"{column.wheel} [{unit}]" for column in wheels if column.header})


def check_steering(rover: Rover, steering: Floats, joints: Sequence[Column], row: int, named: bool) -> None:
    """Refuses steering angles (n, steered wheels) beyond what a joint can, as degrees are.

    Raises
    ------
    ImplausibleReadingError
        If a joint is turned so far.
    """
    steered = [wheel for wheel in rover.wheels if wheel.steered]
    with np.errstate(invalid="ignore"):
        reach = np.nanmax(np.abs(steering), axis=0, initial=0.0)
    for number, (wheel, column) in enumerate(zip(steered, joints, strict=True)):
        most = _range(wheel)
        if math.isinf(most) or reach[number] <= most:
            continue
        at = row + int(np.nanargmax(np.abs(steering[:, number])))
        what = (
            f'"{column.header}" is at {reach[number]:.4g} rad in row {at}, beyond the joint of {column.wheel}'
        )
        if named:
            proposal = columns(
                {each.header: f"{each.wheel}_steering [deg]" for each in joints if each.header}
            )
        else:
            proposal = encoders(turn=360, steering=True)
        rest = at_its_word().option
        raise ImplausibleReadingError(f"{what}: degrees? Give {proposal}; {rest} takes it as it is")


def _range(wheel: Wheel) -> float:
    """The largest angle at which a joint may be measured [rad]."""
    most = max(map(abs, wheel.steering_range or (math.inf,)))
    return max(1.5 * most, most + PLAY)
