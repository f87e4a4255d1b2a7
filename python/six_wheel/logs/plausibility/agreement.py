"""Wheels that turn against the others, sides that turn against each other, readings that are held."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from six_wheel._core import Rover
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.proposals import TAKEN, ImplausibleReadingError
from six_wheel.logs.plausibility.readings import Readings
from six_wheel.robot_description.doubts import Proposal

Units: TypeAlias = Mapping[str, Proposal]

STRETCHES = 30  # stretches with moving wheels that tell
KEPT = 2048  # stretches
QUICK = 0.3  # of the usual rate of the fastest wheel, from which on a stretch counts
APART = 0.3  # of the rates, that the wheels differ from one motion, for one to be reversed
TOGETHER = 0.25  # of that difference, that is left with it turned round
OPPOSITE = 0.95  # share of the stretches in which the sides turn against each other
SWAY = 0.04  # range of speed over rim speed, that turning on the spot does not have
TURNS = 4.0 * np.pi  # [rad] of the rover
WINDOWS = 400  # of a log, in which its turning is compared
ALIKE = 0.9  # squared correlation of two rates of turning
NEAR = 0.06  # of the ratio that another unit makes
HELD = 0.3  # share of rows in which a reading repeats between others that change
COARSE = 5.0  # times its shortest step, that a wheel turns in a row


@dataclass
class WheelAgreement:
    """Rates of the wheels in some stretches of a log."""

    rates: Floats = field(default_factory=lambda: np.zeros((0, 0)))  # (n, wheels): [rad/s]
    steering: Floats = field(default_factory=lambda: np.zeros((0, 0)))  # (n, steered wheels): [rad]
    judged_later: bool = False  # a calibration tells by the truth which wheels turn the other way
    _share: int = 1

    def add(self, rates: Floats, steering: Floats | None) -> None:
        """Take in rates (n, wheels) [rad/s] and steering angles (n, steered wheels) [rad]."""
        angles = np.zeros((len(rates), 0)) if steering is None else steering
        there = np.isfinite(rates).all(axis=1) & np.isfinite(angles).all(axis=1)
        new = rates[there][:: self._share], angles[there][:: self._share]
        if not len(self.rates):
            self.rates, self.steering = new
        else:
            self.rates, self.steering = np.vstack((self.rates, new[0])), np.vstack((self.steering, new[1]))
        while len(self.rates) > KEPT:
            self.rates, self.steering = self.rates[::2], self.steering[::2]
            self._share *= 2

    def doubts(self, known: Readings, duration: float) -> list[str]:
        """Lines about wheels that turn the other way, as far as the others tell."""
        fastest = np.abs(self.rates).max(axis=1, initial=0.0)
        usual = float(np.quantile(fastest, 0.9)) if len(fastest) else 0.0
        moves = fastest > QUICK * usual
        if self.judged_later or usual == 0.0 or np.count_nonzero(moves) < STRETCHES:
            return []
        rates, steering = self.rates[moves], self.steering[moves]
        share = np.count_nonzero(moves) / len(moves)
        found = _reversed_wheel(known.rover, rates, steering)
        if found is not None:
            column = known.wheels[found]
            what = f'"{column.header}" turns against the other wheels'
            return [f"{what}: is it counted the other way round? {_remedy([column.wheel])}"]
        if _sides_are_opposite(known.rover, rates, steering, share * duration):
            right = [wheel.name for wheel in known.rover.wheels if wheel.y < 0.0]
            what = "left and right wheels turn against each other nearly all the time, and not as on the spot"
            return [f"{what}: is a side counted the other way round? {_remedy(right)}"]
        return []


def held_readings(raw: Floats, known: Readings) -> str:
    """The line about a wheel (column of (n, wheels)) that repeats its reading in every few rows while
    another one does not; empty if there is none."""
    if raw.shape[1] < 2 or len(raw) < STRETCHES:
        return ""
    steps = np.diff(raw, axis=0)
    held = np.zeros(raw.shape[1])
    for place, column in enumerate(steps.T):
        sizes = np.abs(column[np.nan_to_num(column) != 0.0])
        if len(sizes) < STRETCHES or not np.isfinite(column).all():
            return ""
        if float(np.median(sizes)) < COARSE * float(np.quantile(sizes, 0.02)):
            return ""
        between = (column[1:-1] == 0.0) & (column[:-2] != 0.0) & (column[2:] != 0.0)
        held[place] = np.count_nonzero(between) / len(sizes)
    slow, quick = int(np.argmax(held)), int(np.argmin(held))
    if held[slow] < HELD or held[quick] > HELD / 10.0:
        return ""
    first, other = known.wheels[slow].header, known.wheels[quick].header
    what = f'"{first}" repeats its reading every few rows while "{other}" changes'
    return f"{what}: is it read more rarely and held? The path is off by what it turns meanwhile"


def check_turning(
    rover: Rover, wheels: Floats, steering: Floats | None, stamps: Floats, yaw_rate: Floats, proposals: Units
) -> None:
    """Refuses totals (n, wheels) that turn the rover as a gyroscope does, but for the ratio of two units.

    `yaw_rate` (n,) is in rad/s; `proposals` has one for each unit that readings may have instead of radians.
    """
    there = np.isfinite(yaw_rate) & np.isfinite(wheels).all(axis=1)
    if np.count_nonzero(there) < WINDOWS // 4:
        return
    rows = np.flatnonzero(there)
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, WINDOWS).astype(np.int64))]
    rates, periods = yaw_rate[there], np.diff(stamps[there], prepend=stamps[there][0])
    headings = np.full(len(stamps), np.nan)
    headings[there] = np.cumsum((rates + np.concatenate((rates[:1], rates[:-1]))) / 2.0 * periods)
    spans = np.diff(stamps[rows])
    if not (spans > 0.0).all():
        return
    turned = np.zeros((len(rows) - 1, 0)) if steering is None else steering[rows[:-1]]
    try:
        twists = np.asarray(rover.forward(turned, np.diff(wheels[rows], axis=0) / spans[:, None]))
    except ValueError:
        return
    ours, theirs = twists[:, 2], np.diff(headings[rows]) / spans
    product, power = float(ours @ theirs), float(theirs @ theirs)
    if not (ours.any() and power > 0.0 and product**2 > ALIKE * power * float(ours @ ours)):
        return
    radius = float(np.median([wheel.radius for wheel in rover.wheels]))
    for unit, ratio in (("rev", 0.5 / np.pi), ("deg", 180.0 / np.pi), ("m", radius)):
        if abs(product / power - ratio) < NEAR * ratio and not 0.5 < ratio < 2.0:
            what = f"the wheels turn the rover by {product / power:.3g} of what the gyroscope says"
            raise ImplausibleReadingError(f"{what}: {unit}, and not rad? Give ", proposals[unit], TAKEN)


def _remedy(wheels: list[str]) -> str:
    names = ", ".join(wheels)
    return f"wheel_encoders: {{reversed: [{names}]}} in the parameter file, or gear_ratio=-1 of its Encoder"


def _differ(rover: Rover, rates: Floats, steering: Floats) -> float:
    """Root mean square by which rates differ from those of the motion that fits them best, relative."""
    twists = np.asarray(rover.forward(steering, rates))
    _, fitted = map(np.asarray, rover.inverse(twists))
    steered = np.array([wheel.steered for wheel in rover.wheels])
    error = np.where(steered, np.abs(fitted) - np.abs(rates), fitted - rates)
    return float(np.sqrt(np.mean(error**2) / np.mean(rates**2)))


def _reversed_wheel(rover: Rover, rates: Floats, steering: Floats) -> int | None:
    """The wheel without whose sign all wheels agree."""
    try:
        now = _differ(rover, rates, steering)
        if now < APART:
            return None
        turned = np.ones((rates.shape[1], rates.shape[1])) - 2.0 * np.eye(rates.shape[1])
        with_other_sign = [_differ(rover, rates * signs, steering) for signs in turned]
    except ValueError:  # a motion that the rover cannot make
        return None
    best = int(np.argmin(with_other_sign))
    return best if with_other_sign[best] < TOGETHER * now else None


def _sides_are_opposite(rover: Rover, rates: Floats, steering: Floats, duration: float) -> bool:
    """True if a rover without steering turns all the time and moves on as it never does on the spot."""
    if rover.steered_wheel_names or any(wheel.roller_angle for wheel in rover.wheels):
        return False
    try:
        twists = np.asarray(rover.forward(steering, rates))
    except ValueError:
        return False
    half = max(abs(wheel.y) for wheel in rover.wheels)
    turning = twists[:, 2] * half
    opposite = np.abs(turning) > np.abs(twists[:, 0])
    whole = float(np.abs(twists[:, 2]).mean()) * duration
    if np.mean(opposite) < OPPOSITE or whole < TURNS:
        return False
    sway = twists[opposite, 0] / turning[opposite]
    return bool(np.quantile(sway, 0.75) - np.quantile(sway, 0.25) > SWAY)
