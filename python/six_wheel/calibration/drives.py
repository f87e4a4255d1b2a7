"""Logs made ready for a calibration: rates between rows, windows, and the truth at their ends."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.recordings import GroundTruth, WheelLog, interpolate
from six_wheel.robot_description.dimensions import size

Rows = NDArray[np.int64]

WINDOWS = (5.0, 10.0, 20.0, 40.0)  # lengths of the windows without others given, in sizes of the rover
LONGER = 1.5  # times its length a window may be
OVERLAP = 2  # windows begin every so many-th part of the shortest length
MOST_WINDOWS = 4000  # of one length in one log; in longer logs they begin farther apart
STRETCHES = 3  # of a drive, between which errors may differ
STRAIGHT_ENOUGH = 0.25  # share of a way that its chord must have to have a direction
STILL = 0.01  # of the speed of most of a drive
RESTED = 1.0  # [s] for which a rover has to stand still for a bias to be known
SHORTEST = 1e-3  # a log that moves less than this many sizes of the rover does not move


class StandsStillError(ValueError):
    """A log, or what is known of its truth, in which the rover does not move: there is nothing to compare."""


@dataclass(frozen=True, eq=False)
class Drive:
    """One log: readings between its rows, the windows that compare it with the truth.

    `stamps` (n,) are those of the rows kept; `dt` (n - 1,), `wheel_speeds` (n - 1, wheels) and `steering`
    (n - 1, steered) what happened between them. `rows` (m, 2) are the ends of the windows, `middles` (m,)
    rows about halfway between them, `lengths` (m,) which length each has and `blocks` (m,) in which third
    of the drive it lies.
    """

    name: str
    session: str
    stamps: Floats
    dt: Floats
    wheel_speeds: Floats
    steering: Floats
    truth: GroundTruth
    rows: Rows
    middles: Rows
    lengths: Rows
    blocks: Rows
    distance: float
    turning: float
    dropped: int
    number: int  # of the log it comes from
    mount: str = ""  # the session as the log names it: within one, the truth looks from the same place

    def truth_at(self, rows: Rows, offset: float) -> tuple[Floats, Floats]:
        """True poses and their rates at rows (...), shapes (..., 3); 0 where a truth has no such part."""
        wanted = self.stamps[rows] + offset
        known = np.nan_to_num(self.truth.poses)
        poses, rates = interpolate(self.truth.stamps, known, wanted.ravel())
        return poses.reshape(*wanted.shape, 3), rates.reshape(*wanted.shape, 3)


def encoders(rover: Rover, logs: Sequence[WheelLog]) -> list[bool]:
    """One flag per wheel: True if it has an encoder, which is if any of its readings is a number.

    Raises `ValueError` if a log has other wheels than the rover.
    """
    for number, log in enumerate(logs):
        if log.wheel_angles.shape[1] != len(rover.wheels):
            wheels = len(rover.wheels)
            rule = f"wheel_angles must have shape (n, {wheels})"
            raise ValueError(f"{_who(log, number)}: {rule}, got {log.wheel_angles.shape}")
    heard = [np.isfinite(log.wheel_angles).any(axis=0) for log in logs]
    return np.any(heard, axis=0).tolist()  # type: ignore[no-any-return]


def _who(log: WheelLog, number: int) -> str:
    return f"logs[{number}]" + (f" ({log.name})" if log.name else "")


def prepare(rover: Rover, log: WheelLog, lengths: Floats, margin: float, number: int = 0) -> Drive:
    """The windows of a log.

    Windows of these lengths (k,) [m] end the `margin` [s] inside the truth, so that its clock may be moved;
    messages have the `number` of the log. Raises `ValueError` if the log does not fit the rover, has no truth
    or too few rows that can be used. A `StandsStillError` if the rover does not move.
    """
    who = _who(log, number)
    if log.truth is None:
        raise ValueError(f"{who} must have a truth to be calibrated against")
    steered = len(rover.steered_wheel_names)
    steering = log.steering if log.steering is not None else np.empty((len(log), 0))
    if steering.shape[1] != steered:
        raise ValueError(f"{who}: steering must have shape (n, {steered}), got {steering.shape}")

    kept = _usable(rover, log, steering)
    # Rows of a truth with a gap on both sides, as where a loop closes, are rows of the log too.
    gaps = np.concatenate(([True], np.diff(log.truth.stamps) > log.truth.max_gap, [True]))
    alone = log.truth.stamps[gaps[1:] & gaps[:-1]]
    stamps, angles, steering = _with_rows(alone, log.stamps[kept], log.wheel_angles[kept], steering[kept])
    if len(stamps) < 2:
        raise ValueError(f"{who} must have two rows or more that can be used, got {len(stamps)}")
    dt = np.diff(stamps)
    speeds = np.diff(angles, axis=0) / dt[:, None]
    middle = (steering[1:] + steering[:-1]) / 2.0

    twists = rover.forward(middle, speeds)
    reach = size(rover)
    pace = np.sqrt(twists[:, 0] ** 2 + twists[:, 1] ** 2 + (reach * twists[:, 2]) ** 2)
    along = np.concatenate(([0.0], np.cumsum(pace * dt)))
    known = np.flatnonzero(log.truth.covers(stamps, margin))
    rows, which = _windows(along, known, lengths, SHORTEST * reach)
    halves = along[rows].mean(axis=1)
    halfway = known[np.minimum(np.searchsorted(along[known], halves), len(known) - 1)] if len(rows) else which
    if not log.truth.has_yaw:
        good = _bent(log.truth.at(stamps)[:, :2], rows, halfway, along)
        rows, which, halfway = rows[good], which[good], halfway[good]
    if not len(rows):
        got = _nothing_known(log.truth, stamps, float(along[-1]))
        raise StandsStillError(f"{who} must move while its truth is known, got {got}")
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
        halfway,
        which,
        np.minimum(STRETCHES * middles, STRETCHES - 1).astype(np.int64),
        float(along[-1]),
        float(np.abs(twists[:, 2] * dt).sum()),
        len(log) - len(stamps),
        number,
        log.session,
    )


def _nothing_known(truth: GroundTruth, stamps: Floats, moved: float) -> str:
    """The reason that no part of a drive can be compared with its truth, for the error."""
    seen, driven = (f"{one[0]:.6g} to {one[-1]:.6g} s" for one in (truth.stamps, stamps))
    if truth.stamps[-1] < stamps[0] or stamps[-1] < truth.stamps[0]:
        return f"a truth of {seen} for a log of {driven}: give both the same clock"
    if moved <= 0.0:
        return "a log in which no wheel turns"
    gaps = f"between rows more than {truth.max_gap:g} s apart it is not known"
    return f"{moved:.3g} m in {driven} and a truth of {len(truth)} rows in {seen}: {gaps}"


def moving(rover: Rover, logs: Sequence[WheelLog], margin: float = 0.0) -> list[bool]:
    """One flag per log: True if the rover moves in it while its truth is known; `margin` as for `prepare`.
    Raises `ValueError` if a log cannot be used, or the rover moves in none."""
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


def heard(log: WheelLog, number: int) -> WheelLog:
    """A log without a truth but with a gyroscope, which then tells its headings, less its bias at rest.
    Raises `ValueError` if the rover never stands still for long enough to tell the bias."""
    if log.truth is not None or log.yaw_rate is None:
        return log
    rows = known_rows(log.stamps, log.yaw_rate, log.stamps)
    stamps, rates = log.stamps[rows], log.yaw_rate[rows]
    dt = np.diff(stamps)
    still = at_rest(np.diff(log.wheel_angles[rows], axis=0) / dt[:, None])
    if dt[still].sum() < RESTED:
        rule = f"must stand still for {RESTED:g} s at least, where the bias of its gyroscope shows"
        raise ValueError(f"{_who(log, number)} {rule}, got {dt[still].sum():.3g} s")
    turned = rates - np.average((rates[1:] + rates[:-1])[still] / 2.0, weights=dt[still])
    yaw = integral(stamps, turned)
    nowhere = np.full(len(yaw), np.nan)
    return replace(log, truth=GroundTruth(stamps, np.column_stack((nowhere, nowhere, yaw))))


def known_rows(stamps: Floats, *columns: Floats) -> Rows:
    """Rows in which all columns are known, without those whose stamps stand still."""
    rows = np.flatnonzero(np.isfinite(columns).all(axis=0))
    return rows[np.diff(stamps[rows], prepend=-np.inf) > 0.0]


def integral(stamps: Floats, rates: Floats) -> Floats:
    """Integral of rates (n,) from the first stamp to each, by the trapezoidal rule."""
    return np.concatenate(([0.0], np.cumsum((rates[1:] + rates[:-1]) / 2.0 * np.diff(stamps))))


def at_rest(speeds: Floats) -> NDArray[np.bool_]:
    """Steps (n,) in which no wheel turns, but for the noise of its reading, by their speeds (n, wheels)."""
    fastest = np.nan_to_num(np.abs(speeds)).max(axis=1, initial=0.0)
    still: NDArray[np.bool_] = fastest <= STILL * np.quantile(fastest, 0.9)
    return still


def _with_rows(
    wanted: Floats, stamps: Floats, angles: Floats, steering: Floats
) -> tuple[Floats, Floats, Floats]:
    """A log with rows at these stamps too, its readings between those beside them."""
    inside = wanted[(wanted > stamps[0]) & (wanted < stamps[-1])] if len(stamps) else wanted[:0]
    times = np.union1d(stamps, inside)
    if len(times) == len(stamps):
        return stamps, angles, steering

    def read(columns: Floats) -> Floats:
        values = [np.interp(times, stamps, column) for column in columns.T]
        return np.stack(values, axis=1) if values else np.empty((len(times), 0))

    return times, read(angles), read(steering)


def _bent(places: Floats, rows: Rows, middles: Rows, along: Floats) -> NDArray[np.bool_]:
    """Windows whose halves go somewhere: a chord has a direction if it is not short beside the way."""
    good = (rows[:, 0] < middles) & (middles < rows[:, 1])
    for first, last in ((rows[:, 0], middles), (middles, rows[:, 1])):
        chord = np.hypot(*(places[last] - places[first]).T)
        good &= chord > STRAIGHT_ENOUGH * (along[last] - along[first])
    return good


def _usable(rover: Rover, log: WheelLog, steering: Floats) -> Rows:
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
        # Across a gap of the truth a window would be longer than its kind.
        fits = (last > first) & (path[last] - path[first] < LONGER * reach)
        pairs = np.stack((known[first], known[last]), axis=1)[fits]
        found.append(pairs)
        which.append(np.full(len(pairs), number))
    if total > shortest:
        # Windows from the start keep the long run honest: what is left of a slow drift shows nowhere else.
        apart = max(float(lengths[0]) / OVERLAP, total / MOST_WINDOWS)
        apart = min(apart, total)
        ends = np.searchsorted(path, path[0] + np.arange(apart, total * (1.0 + 1e-9), apart))
        last = known[np.minimum(ends, len(path) - 1)]
        last = np.unique(last[last > known[0]])
        found.append(np.stack((np.full(len(last), known[0]), last), axis=1))
        which.append(np.full(len(last), len(lengths)))
    else:
        return np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)
    return np.concatenate(found).astype(np.int64), np.concatenate(which).astype(np.int64)
