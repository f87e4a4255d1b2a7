"""Logs made ready for a calibration: rates between rows, windows, and the truth at their ends."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.calibration.parameters import size
from six_wheel.logs.recordings import Log, Truth
from six_wheel.poses import Floats, interpolate

Rows = NDArray[np.int64]

WINDOWS = (5.0, 10.0, 20.0, 40.0)  # lengths of the windows without others given, in sizes of the rover
OVERLAP = 2  # windows begin every so many-th part of the shortest length
MOST_WINDOWS = 4000  # of one length in one log; in longer logs they begin farther apart
STRETCHES = 3  # of a drive, between which errors may differ
SHORTEST = 1e-3  # a log that moves less than this many sizes of the rover does not move


class StandsStillError(ValueError):
    """A log, or what is known of its truth, in which the rover does not move: there is nothing to compare."""


@dataclass(frozen=True, eq=False)
class Drive:
    """One log: readings between its rows, the windows that compare it with the truth.

    `stamps` (n,) are those of the rows kept; `dt` (n - 1,), `speeds` (n - 1, wheels) and `steering`
    (n - 1, steered) what happened between them. `rows` (m, 2) are the ends of the windows, `lengths` (m,)
    which length each has and `blocks` (m,) in which third of the drive it lies.
    """

    name: str
    session: str
    stamps: Floats
    dt: Floats
    speeds: Floats
    steering: Floats
    truth: Truth
    rows: Rows
    lengths: Rows
    blocks: Rows
    distance: float
    turning: float
    dropped: int
    number: int  # of the log it comes from

    def truth_at_ends(self, offset: float) -> tuple[Floats, Floats]:
        """True poses and their rates at both ends of the windows, shapes (m, 2, 3)."""
        wanted = self.stamps[self.rows] + offset
        poses, rates = interpolate(self.truth.stamps, self.truth.poses, wanted.ravel())
        return poses.reshape(*wanted.shape, 3), rates.reshape(*wanted.shape, 3)


def encoders(rover: Rover, logs: Sequence[Log]) -> list[bool]:
    """Which wheels report how far they turn: those with a number somewhere.

    Raises
    ------
    ValueError
        If a log has other wheels than the rover.
    """
    for number, log in enumerate(logs):
        if log.wheel_angles.shape[1] != len(rover.wheels):
            wheels = len(rover.wheels)
            rule = f"wheel_angles must have shape (n, {wheels})"
            raise ValueError(f"{_who(log, number)}: {rule}, got {log.wheel_angles.shape}")
    heard = [np.isfinite(log.wheel_angles).any(axis=0) for log in logs]
    return np.any(heard, axis=0).tolist()  # type: ignore[no-any-return]


def _who(log: Log, number: int) -> str:
    return f"logs[{number}]" + (f" ({log.name})" if log.name else "")


def prepare(rover: Rover, log: Log, lengths: Floats, margin: float, number: int) -> Drive:
    """The windows of a log.

    Parameters
    ----------
    lengths : ndarray, shape (k,)
        Lengths of the windows [m]; see `drives` for what distance means.
    margin : float
        Windows end this long inside the truth, so that its clock may be moved [s].
    number : int
        Of the log, for the messages.

    Raises
    ------
    ValueError
        If the log does not fit the rover, has no truth or too few rows that can be used. A `StandsStillError`
        if the rover does not move.
    """
    who = _who(log, number)
    if log.truth is None:
        raise ValueError(f"{who} must have a truth to be calibrated against")
    steered = len(rover.steered_names)
    steering = log.steering if log.steering is not None else np.empty((len(log), 0))
    if steering.shape[1] != steered:
        raise ValueError(f"{who}: steering must have shape (n, {steered}), got {steering.shape}")

    kept = _usable(rover, log, steering)
    stamps, angles, steering = log.stamps[kept], log.wheel_angles[kept], steering[kept]
    if len(stamps) < 2:
        raise ValueError(f"{who} must have two rows or more that can be used, got {len(stamps)}")
    dt = np.diff(stamps)
    speeds = np.diff(angles, axis=0) / dt[:, None]
    middle = (steering[1:] + steering[:-1]) / 2.0

    twists = rover.forward(middle, speeds)
    reach = size(rover)
    pace = np.sqrt(twists[:, 0] ** 2 + twists[:, 1] ** 2 + (reach * twists[:, 2]) ** 2)
    along = np.concatenate(([0.0], np.cumsum(pace * dt)))
    known = np.flatnonzero(
        (stamps - margin >= log.truth.stamps[0]) & (stamps + margin <= log.truth.stamps[-1])
    )
    rows, which = _windows(along, known, lengths, SHORTEST * reach)
    if not len(rows):
        raise StandsStillError(f"{who} must move while its truth is known, got {along[-1]:.3g} m of motion")
    middles = along[rows].mean(axis=1) / along[-1]
    return Drive(
        log.name or f"log {number}",
        log.session or log.name or f"log {number}",
        stamps,
        dt,
        speeds,
        middle,
        log.truth,
        rows,
        which,
        np.minimum(STRETCHES * middles, STRETCHES - 1).astype(np.int64),
        float(along[-1]),
        float(np.abs(twists[:, 2] * dt).sum()),
        len(log) - len(stamps),
        number,
    )


def moving(rover: Rover, logs: Sequence[Log], margin: float = 0.0) -> list[bool]:
    """In which logs the rover moves while its truth is known; `margin` as for `prepare`.

    Raises
    ------
    ValueError
        If a log cannot be used, or the rover moves in none.
    """
    found: list[bool] = []
    refused: StandsStillError | None = None
    for number, log in enumerate(logs):
        try:
            prepare(rover, log.in_radians(rover), default_lengths(rover), margin, number)
        except StandsStillError as error:
            refused = error
            found.append(False)
        else:
            found.append(True)
    if refused is not None and not any(found):
        raise refused
    return found


def _usable(rover: Rover, log: Log, steering: Floats) -> Rows:
    """Rows whose numbers are all there and whose stamps come after those before: the others are left out."""
    driven = np.array([wheel.driven for wheel in rover.wheels])
    silent = ~np.isfinite(log.wheel_angles).any(axis=0) & ~driven
    whole = np.isfinite(log.stamps) & np.isfinite(log.wheel_angles[:, ~silent]).all(axis=1)
    whole &= np.isfinite(steering).all(axis=1)
    rows = np.flatnonzero(whole)
    stamps = log.stamps[rows]
    latest = np.concatenate(([-math.inf], np.maximum.accumulate(stamps)[:-1])) if len(rows) else stamps
    return rows[stamps > latest]


def default_lengths(rover: Rover) -> Floats:
    """Window lengths that suit the size of a rover [m]."""
    return size(rover) * np.array(WINDOWS)


def _windows(along: Floats, known: Rows, lengths: Floats, shortest: float) -> tuple[Rows, Rows]:
    """Windows of every length, at even distances; all of the drive where it is shorter than that."""
    if len(known) < 2:
        return np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)
    path = along[known]
    total = float(path[-1] - path[0])
    found, which = [], []
    for number, length in enumerate(lengths.tolist()):
        reach = min(length, total)
        if reach <= shortest or (length > total and number and lengths[number - 1] > total):
            continue  # one window over all of a short drive is enough
        apart = max(float(lengths[0]) / OVERLAP, (total - reach) / MOST_WINDOWS)
        begins = path[0] + np.arange(0.0, total - reach + 1e-9 * total, apart)
        first = np.searchsorted(path, begins - 1e-12 * total)
        last = np.minimum(np.searchsorted(path, path[first] + reach * (1.0 - 1e-12)), len(path) - 1)
        pairs = np.stack((known[first], known[last]), axis=1)[last > first]
        found.append(pairs)
        which.append(np.full(len(pairs), number))
    if found:
        # Windows from the start keep the long run honest: what is left of a slow drift shows nowhere else.
        apart = max(float(lengths[0]) / OVERLAP, total / MOST_WINDOWS)
        ends = np.searchsorted(path, path[0] + np.arange(apart, total * (1.0 + 1e-9), apart))
        last = known[np.minimum(ends, len(path) - 1)]
        found.append(np.stack((np.full(len(last), known[0]), last), axis=1))
        which.append(np.full(len(last), len(lengths)))
    else:
        return np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)
    return np.concatenate(found).astype(np.int64), np.concatenate(which).astype(np.int64)
