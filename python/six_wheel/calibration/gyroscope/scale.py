"""Scale factor of the readings of a gyroscope, and a check of their axis."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from scipy.special import stdtrit

from six_wheel._core import Rover
from six_wheel.calibration.drives import integral, known_rows
from six_wheel.calibration.estimates import Estimate
from six_wheel.calibration.gyroscope.noise import resting
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry.dead_reckoning import dead_reckon
from six_wheel.logs.recordings import WheelLog

STRETCH = 1.0  # [s] over which turns are compared
PARTS = 3  # of a log, between which errors may differ
ENOUGH = 3  # logs from which on each is left out as a whole
TURNED = 1.0  # [rad] that a log must turn, beside its bias, to tell a scale
KNOWN = 0.02  # half of the interval of a scale that is worth a word
ALIKE = 0.7  # correlation of turns below which two do not follow each other
DEGREE = np.pi / 180.0

# Turns by the gyroscope and by what it is compared with (n,), the bias taken off.
Turns = tuple[Floats, Floats]


def scale(logs: Sequence[WheelLog], offset: float, confidence: float) -> Estimate | None:
    """The factor that makes turns by the gyroscope those of the truth; None where that does not tell.

    Logs, or thirds of few of them, are left out one after another for the interval.
    """
    every = [_turns(log, _true_headings(log, offset)) for log in logs]
    kept = [turns for turns in every if turns is not None and np.abs(turns[0]).sum() > TURNED]
    parts = [
        (read[piece], true[piece])
        for read, true in kept
        for piece in np.array_split(np.arange(len(read)), 1 if len(kept) >= ENOUGH else PARTS)
    ]
    sums = np.array([(read @ true, read @ read) for read, true in parts]).reshape(-1, 2)
    if len(sums) < 2 or not (sums[:, 1] > 0.0).all():
        return None
    value = sums[:, 0].sum() / sums[:, 1].sum()
    left = (sums[:, 0].sum() - sums[:, 0]) / (sums[:, 1].sum() - sums[:, 1])
    count = len(sums)
    std = float(np.sqrt((count - 1) / count * np.square(left - left.mean()).sum()))
    half = float(stdtrit(count - 1, 0.5 + confidence / 2.0)) * std
    if not half < KNOWN * max(abs(value), 1e-9):
        return None
    return Estimate("gyroscope.scale", "", 1.0, float(value), std, (value - half, value + half))


def mistaken(rover: Rover, logs: Sequence[WheelLog]) -> list[str]:
    """Sentences about a gyroscope that does not turn as the wheels do, with the remedy."""
    turns = [found for log in logs if (found := _turns(log, _wheel_headings(rover, log))) is not None]
    if not turns:
        return []
    read, rolled = (np.concatenate(part) for part in zip(*turns, strict=True))
    if np.abs(rolled).sum() < TURNED:
        return []
    sizes = float(read @ read), float(rolled @ rolled)
    if min(sizes) == 0.0 or abs(read @ rolled) < ALIKE * np.sqrt(sizes[0] * sizes[1]):
        who = "the gyroscope does not turn as the wheels say"
        return [f"{who}: if it sits on another axis, gyroscope.roll and gyroscope.pitch say which"]
    factor = float(read @ rolled) / sizes[0]
    said = []
    if factor < 0.0:
        remedy = "if it hangs upside down, give gyroscope.roll: 3.14159"
        said.append(f"the gyroscope counts the other way than the wheels: {remedy}")
    if 0.7 * DEGREE < abs(factor) < 1.4 * DEGREE:
        times = f"turns {1.0 / abs(factor):.3g} times as far as the wheels"
        said.append(f"the gyroscope {times}: if its rates are in degrees, write deg/s into the header")
    return said


def _turns(log: WheelLog, headings: Floats) -> Turns | None:
    """Turns over stretches of a log, where both are known."""
    if log.yaw_rate is None:
        return None
    rows = known_rows(log.stamps, log.yaw_rate, headings)
    if len(rows) < 2:
        return None
    pieces = list(_stretches(log.stamps[rows], np.diff(rows) == 1))
    if not pieces:
        return None
    stamps, rates, true = log.stamps[rows], log.yaw_rate[rows], np.unwrap(headings[rows])
    turned = integral(stamps, rates)
    first, last = np.array(pieces).T
    read, moved, took = (column[last] - column[first] for column in (turned, true, stamps))
    rests = [rates for _, rates in resting(log)]
    if rests:
        return read - float(np.concatenate(rests).mean()) * took, moved
    # A bias that nobody saw at rest turns both by the same in every second.
    shares = took / float(took @ took)
    return read - shares * float(read @ took), moved - shares * float(moved @ took)


def _stretches(stamps: Floats, whole: Floats) -> Iterator[tuple[int, int]]:
    """First and last of the rows of each stretch in which no row lacks."""
    first = 0
    for row in range(1, len(stamps)):
        if not whole[row - 1]:
            first = row
        elif stamps[row] - stamps[first] >= STRETCH:
            yield first, row
            first = row


def _true_headings(log: WheelLog, offset: float) -> Floats:
    """Headings of a truth with poses [rad], otherwise NaN: headings alone may be the gyroscope's own."""
    if log.truth is None or not (log.truth.has_yaw and log.truth.has_positions):
        return np.full(len(log), np.nan)
    return log.truth.at(log.stamps + offset)[:, 2]


def _wheel_headings(rover: Rover, log: WheelLog) -> Floats:
    """Headings by the wheels alone, NaN in rows that cannot be used."""
    how: dict[str, Any] = {"covariances": False, "residuals": False, "plausibility": False}
    track = dead_reckon(rover, log.steering, log.wheel_angles, log.stamps, **how)
    headings = track.poses[:, 2].copy()
    headings[track.left_out] = np.nan
    return headings
