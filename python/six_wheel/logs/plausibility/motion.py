"""Motion that no rover makes: wheels that spin, rims that gain speed as if thrown, bodies that whirl."""

import math
from collections.abc import Sequence

import numpy as np

from six_wheel._core import Rover
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.proposals import (
    AS_READ,
    TAKEN,
    Column,
    ImplausibleReadingError,
    columns,
    encoders,
    stamp_unit,
)
from six_wheel.logs.plausibility.readings import Readings
from six_wheel.robot_description.doubts import Option, Proposal

STRETCH = 0.5  # [s] over which rates are taken
FASTEST_RIM = 100.0  # [m/s]
FASTEST_WHEEL = 200.0  # [rad/s] for two stretches in a row
HARDEST_START = 20.0  # [m/s²] of the median rim from one stretch to the next
HARDEST_TURN = 50.0  # [m/s²] towards the centre of the turn
FASTEST_TURN = 12.6  # [rad/s] of the body, for two stretches in a row
ENOUGH = 4  # stretches
SHARP = 0.3  # sine between where joints are and where the motion would have them, if they are in another unit
FLAT = 0.1  # the same, if they are in this one
SOME = 200  # rows that tell
PLAY = 0.1  # [rad] beyond its range at which a joint may be measured


def check_motion(
    rover: Rover, rates: Floats, steering: Floats | None, periods: Floats
) -> tuple[int, int, str] | None:
    """A stretch in which wheels move as none can: its number, the wheel, and the figure in words.

    `rates` (n, wheels) are means over stretches [rad/s], NaN without a reading, `steering` (n, steered
    wheels) the angles in the middle of them [rad], `periods` (n,) their lengths [s].
    """
    if len(rates) < ENOUGH:
        return None
    radii = np.array([wheel.radius for wheel in rover.wheels])
    turning = np.abs(rates)
    rims = turning * radii
    fastest = float(np.fmax.reduce(rims, axis=None))
    if fastest < 1.0 and float(np.fmax.reduce(turning, axis=None)) <= FASTEST_WHEEL:
        return None
    spinning = np.fmax.reduce(turning, axis=1) > FASTEST_WHEEL
    spinning[1:] &= spinning[:-1]
    spinning[0] = False
    for found in (np.fmax.reduce(rims, axis=1) > FASTEST_RIM, spinning):
        if found.any():
            row = int(np.argmax(found))
            wheel = int(np.nanargmax(rims[row]))
            turned = abs(float(rates[row, wheel]))
            return row, wheel, f"turns at {turned:.4g} rad/s, {rims[row, wheel]:.4g} m/s at the rim,"
    return None if fastest < 1.0 else _of_body(rover, rates, steering, periods, rims)


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


def degrees(read: Sequence[Column], named: bool, meaning: str = "{} [deg]") -> Proposal:
    """The proposal to read columns in degrees; `named` where they have headers, which get a `meaning`."""
    if not named:
        return encoders(turn=360, steering="steering" in meaning)
    return columns({column.header: meaning.format(column.wheel) for column in read if column.header})


def check_steering(
    rover: Rover, steering: Floats, rates: Floats, joints: Sequence[Column], row: int, named: bool
) -> None:
    """Refuses steering angles (n, steered wheels) beyond what a joint can, and those at which wheels with
    these rates (n, wheels) [rad/s] would slip, but not in degrees. Raises `ImplausibleReadingError` if a
    joint is turned so far."""
    steered = [wheel for wheel in rover.wheels if wheel.steered]
    proposal = degrees(joints, named, "{}_steering [deg]")
    with np.errstate(invalid="ignore"):
        reach = np.nanmax(np.abs(steering), axis=0, initial=0.0)
    for number, (wheel, column) in enumerate(zip(steered, joints, strict=True)):
        # A joint may be measured a little beyond its range.
        most = max(map(abs, wheel.steering_range or (math.inf,)))
        most = max(1.5 * most, most + PLAY)
        if math.isinf(most) or reach[number] <= most:
            continue
        at = row + int(np.nanargmax(np.abs(steering[:, number])))
        what = (
            f'"{column.header}" is at {reach[number]:.4g} rad in row {at}, beyond the joint of {column.wheel}'
        )
        rest = f"; {AS_READ} takes it as it is"
        raise ImplausibleReadingError(f"{what}: degrees? Give ", proposal, rest)
    off, turned = (_off(rover, rates, angles) for angles in (steering, np.radians(steering)))
    if off > SHARP and turned < FLAT:
        names = ", ".join(f'"{column.header}"' for column in joints)
        what = "wheels would slip sideways at these angles in radians, and roll in degrees: give "
        rest = f"; {AS_READ} takes them as they are"
        raise ImplausibleReadingError(f"{names} from row {row} on: {what}", proposal, rest)


def _off(rover: Rover, rates: Floats, steering: Floats) -> float:
    """Median sine between joints and where the motion by all wheels would have them; 0 where none tells."""
    rims = np.nan_to_num(np.abs(rates)).max(axis=1)
    there = (rims > 0.0) & np.isfinite(rates).all(axis=1) & np.isfinite(steering).all(axis=1)
    rows = np.flatnonzero(there)
    if len(rows) < ENOUGH:
        return 0.0
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, SOME).astype(np.int64))]
    try:
        twists = rover.forward(steering[rows], rates[rows])
        angles, _ = map(np.asarray, rover.inverse(twists))
    except ValueError:
        return 0.0
    return float(np.median(np.abs(np.sin(angles - steering[rows])).max(axis=1)))


def impossible(known: Readings, wheel: int, figure: str) -> ImplausibleReadingError:
    """The error for a wheel that does what none can; `figure` says what and in which row."""
    what = f'"{known.wheels[wheel].header}" {figure}'
    if known.kind in ("ticks", "increments"):
        guess = "are there as many counts in a turn, and are its stamps seconds?"
        by_turn = Option("--ticks-per-turn COUNTS")
        return ImplausibleReadingError(f"{what}: {guess} Give ", by_turn, f", or {stamp_unit('ms')}{TAKEN}")
    proposal = degrees(known.wheels, known.named, "{} [deg/s]" if known.kind == "speeds" else "{} [deg]")
    more = "" if known.clock_stated else f", or {stamp_unit('ms').option}"
    guess = "degrees, or counts, or stamps in another unit?"
    counts = f"--ticks-per-turn COUNTS{more}"
    return ImplausibleReadingError(f"{what}: {guess} Give ", proposal, f"; for others {counts}{TAKEN}")
