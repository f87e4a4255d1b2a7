"""A log counts once: readings that are in several logs, by their content and not by their files.

Two logs share readings where one is a copy of the other, the same in another format, a part of it, or where
parts of one recording overlap. Stamps of a copy may count from another instant. `Sketch` finds pairs of many
logs that may share readings without having them in memory; `rest_without` compares a pair.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats
from six_wheel.logs.recordings import WheelLog

ANGLE = 1e-3  # [rad] by which angles differ at most that were rounded by a format
INSTANT = 1e-3  # [s] of stamps, likewise
SAME = 1e-9  # [rad] by which turns between the same rows differ at most, by rounding of their sums
PLACE = 5e-3  # [m] of true positions, likewise
RATE = 2e-4  # [rad/s] of a gyroscope, likewise
ROWS = 20  # steps with a moving wheel that tell a drive
SHARE = 0.1  # of the rows of the shorter log that both have at least
FEW = 64  # rows that are compared before all
ANCHORS = (0.2, 0.5, 0.8)  # shares of the motion where rows of one log are looked for in another
WINDOW = 32  # rows of an anchor
BEST = 4  # places of an anchor that are tried

STEPS = 16  # steps from row to row that make one hash of a sketch
WHEELS = 2  # number of wheels with these steps
# [rad] to which they are rounded; no multiple of usual counts, which would lie on its edges
QUANTUM = 2.07e-3
KEPT = 256  # hashes of a sketch
COMMON = 2  # hashes that two sketches share, from which on the logs are compared
_FACTOR, _MIXER = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBF58476D1CE4E5B9)


def without_copies(logs: Sequence[WheelLog]) -> tuple[list[WheelLog], list[int], list[str]]:
    """Logs [rad] without the readings that a longer one has, their places, and a line for each change."""
    kept: dict[int, WheelLog] = {}
    said = []
    for number in sorted(range(len(logs)), key=lambda number: -len(logs[number])):
        log: WheelLog | None = logs[number]
        for other, known in kept.items():
            shared = None if log is None else _shared(log, known)
            if log is None or shared is None:
                continue
            names = [f"{logs[k].name} (logs[{k}])" if logs[k].name else f"logs[{k}]" for k in (number, other)]
            log, what = _rest(log, shared)
            said.append(f"{names[0]} has {what}the readings of {names[1]}: they count once")
        if log is not None:
            kept[number] = log
    return [kept[number] for number in sorted(kept)], sorted(kept), said


def rest_without(log: WheelLog, other: WheelLog) -> tuple[WheelLog | None, str] | None:
    """The log without rows whose readings another one has, None if little is left, and these rows in words;
    None for logs that share no readings."""
    shared = _shared(log, other)
    return None if shared is None else _rest(log, shared)


@dataclass
class Sketch:
    """Smallest hashes of steps of the wheels, by which logs that share readings are found (Broder 1997)."""

    # (n,): of `STEPS` steps in a row each, ascending, at most `KEPT`.
    hashes: NDArray[np.uint64] = field(default_factory=lambda: np.zeros(0, dtype=np.uint64))

    def add(self, angles: Floats) -> None:
        """Take in consecutive rows of totals (n, wheels) [rad]."""
        heard = np.flatnonzero(np.isfinite(angles[:1]).any(axis=0))[:WHEELS]
        turned = angles[:, heard]
        steps = np.diff(turned[np.isfinite(turned).all(axis=1)], axis=0)
        count = len(steps) - STEPS + 1
        if count < 1 or not len(heard):
            return
        # A wheel that stands still makes 0, whatever the factors.
        whole = np.rint(steps / QUANTUM).astype(np.int64).view(np.uint64)
        powers = np.cumprod(np.full(WHEELS * STEPS, _FACTOR))
        codes = np.zeros(count, dtype=np.uint64)
        for place in range(STEPS):
            for wheel, column in enumerate(whole.T):
                codes += column[place : place + count] * powers[WHEELS * place + wheel]
        codes = codes[codes != 0]
        codes = (codes ^ (codes >> np.uint64(29))) * _MIXER
        codes ^= codes >> np.uint64(32)
        if len(codes) > 4 * KEPT:  # hashes repeat where a drive is steady
            codes = np.unique(codes)
            codes = codes[:KEPT]
        self.hashes = np.unique(np.concatenate((self.hashes, codes)))[:KEPT]


def cut(log: WheelLog, rows: slice) -> WheelLog:
    """Some consecutive rows of a log, with the truth of all."""
    columns = {name: getattr(log, name) for name in ("steering", "yaw", "yaw_rate")}
    columns = {name: None if each is None else each[rows] for name, each in columns.items()}
    return replace(log, stamps=log.stamps[rows], wheel_angles=log.wheel_angles[rows], **columns)


def _rest(log: WheelLog, shared: slice) -> tuple[WheelLog | None, str]:
    """The log without rows that another one has, None if little is left; and these rows in words."""
    before, after = slice(0, shared.start + 1), slice(shared.stop - 1, len(log))
    longer = max(before, after, key=lambda rows: rows.stop - rows.start)
    rest = cut(log, longer) if longer.stop - longer.start > 1 else None
    if rest is None or len(_moving(rest.wheel_angles)) < ROWS:
        return None, ""
    first, last = log.stamps[shared.start], log.stamps[shared.stop - 1]
    return rest, f"from {first:.6g} to {last:.6g} s "


def _moving(angles: Floats) -> NDArray[np.int64]:
    """Rows in which a wheel has turned since the row before."""
    steps = np.nan_to_num(np.abs(np.diff(angles, axis=0)))
    return np.flatnonzero(steps.max(axis=1, initial=0.0) > 0.0) + 1


def _shared(log: WheelLog, other: WheelLog) -> slice | None:
    """The rows of a log whose readings another one has; None if there are too few."""
    if log.wheel_angles.shape[1] != other.wheel_angles.shape[1]:
        return None
    if _is_part(log, other):
        return slice(0, len(log))
    least = max(ROWS + 1, SHARE * min(len(log), len(other)))
    tried: list[float] = []
    for offset in _offsets(log, other):
        if any(abs(offset - each) < 1e-9 for each in tried):
            continue
        tried.append(offset)
        span = (other.stamps[0] - offset - INSTANT, other.stamps[-1] - offset + INSTANT)
        first, last = np.searchsorted(log.stamps, span).tolist()
        if last - first < least or len(_moving(log.wheel_angles[first:last])) < ROWS:
            continue
        few = np.unique(np.linspace(first, last - 1, FEW).astype(np.int64))
        if _agree(log, other, few, offset) and _agree(log, other, np.arange(first, last), offset):
            return slice(first, last)
    return None


def _is_part(log: WheelLog, other: WheelLog) -> bool:
    """True if every row of a log, be they few, is one of another log: the same instant, turns and truth."""
    places = np.minimum(np.searchsorted(other.stamps, log.stamps), len(other) - 1)
    if len(log) > len(other) or not np.array_equal(other.stamps[places], log.stamps):
        return False
    mine, theirs = np.diff(log.wheel_angles, axis=0), np.diff(other.wheel_angles[places], axis=0)
    same = np.allclose(mine, theirs, rtol=0.0, atol=SAME, equal_nan=True)
    return same and bool(len(_moving(log.wheel_angles))) and _agree(log, other, np.arange(len(log)), 0.0)


def _offsets(log: WheelLog, other: WheelLog) -> Iterator[float]:
    """Times to be added to the stamps of a log that may make them those of another one [s]."""
    yield 0.0
    for row in (0, -1):
        yield float(other.stamps[row] - log.stamps[row])
    mine, theirs = (np.nan_to_num(np.diff(each.wheel_angles, axis=0)) for each in (log, other))
    if len(mine) <= WINDOW or len(theirs) <= WINDOW:
        return
    moved = np.cumsum(np.abs(mine).max(axis=1, initial=0.0))
    for share in ANCHORS:
        row = min(int(np.searchsorted(moved, share * moved[-1])), len(mine) - WINDOW)
        found = np.arange(len(theirs) - WINDOW + 1)
        worst = np.zeros(len(found))
        for place in range(WINDOW):
            error = np.abs(theirs[found + place] - mine[row + place]).max(axis=1)
            worst = np.maximum(worst, error)
            near = worst <= 2.0 * ANGLE
            found, worst = found[near], worst[near]
            if not len(found):
                break
        for at in found[np.argsort(worst, kind="stable")[:BEST]].tolist():
            yield float(other.stamps[at] - log.stamps[row])


def _agree(log: WheelLog, other: WheelLog, rows: NDArray[np.int64], offset: float) -> bool:
    """True if the readings of two logs are the same in these rows of the first."""
    stamps = log.stamps[rows]
    times = stamps + offset
    fastest = 0.0
    for mine, theirs in zip(log.wheel_angles.T, other.wheel_angles.T, strict=True):
        error = mine[rows] - _interpolated(other.stamps, theirs, times)
        error = error[np.isfinite(error)]
        if not len(error):
            continue
        turned = np.abs(np.diff(mine[rows])) / np.diff(stamps)
        fastest = float(np.nanmax(turned, initial=0.0))
        if np.abs(error - np.median(error)).max() > ANGLE + INSTANT * fastest:
            return False
    if log.steering is not None and other.steering is not None:
        for mine, theirs in zip(log.steering.T, other.steering.T, strict=True):
            error = np.abs(mine[rows] - _interpolated(other.stamps, theirs, times))
            if np.nanquantile(error, 0.9) > ANGLE if np.isfinite(error).any() else False:
                return False
    if log.yaw_rate is not None and other.yaw_rate is not None:
        error = np.abs(log.yaw_rate[rows] - _interpolated(other.stamps, other.yaw_rate, times))
        return not np.isfinite(error).any() or float(np.nanmedian(error)) <= RATE
    if log.truth is not None and other.truth is not None:
        apart = np.abs(log.truth.at(stamps) - other.truth.at(times))
        error = apart[:, :2].max(axis=1) if log.truth.has_positions else np.sin(apart[:, 2] / 2.0)
        return not np.isfinite(error).any() or float(np.nanquantile(error, 0.9)) <= PLACE
    return True


def _interpolated(stamps: Floats, column: Floats, times: Floats) -> Floats:
    """A column at other times, NaN if it has no numbers."""
    there = np.isfinite(column)
    if not there.any():
        return np.full(len(times), np.nan)
    return np.interp(times, stamps[there], column[there])
