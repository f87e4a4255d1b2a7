"""A log counts once: readings that are in several logs, by their content and not by their files.

Two logs share readings where one is a copy of the other, the same in another format, a part of it, or where
parts of one recording overlap. Stamps of a copy may count from another instant.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats
from six_wheel.logs.recordings import WheelLog

__all__ = ["cut", "without_copies"]

ANGLE = 1e-3  # [rad] by which angles differ at most that were rounded by a format
INSTANT = 1e-3  # [s] of stamps, likewise
PLACE = 5e-3  # [m] of true positions, likewise
RATE = 2e-4  # [rad/s] of a gyroscope, likewise
ROWS = 20  # in which a wheel moves, that tell a drive
SHARE = 0.1  # of the rows of the shorter log that both have at least
FEW = 64  # rows that are compared before all
ANCHORS = (0.2, 0.5, 0.8)  # shares of the motion where rows of one log are looked for in another
WINDOW = 32  # rows of an anchor
BEST = 4  # places of an anchor that are tried


def without_copies(logs: Sequence[WheelLog]) -> tuple[list[WheelLog], list[int], list[str]]:
    """Logs without the readings that a longer one has, their places in `logs`, and a line for each change.

    Parameters
    ----------
    logs : sequence of WheelLog
        In radians.
    """
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
        error = mine[rows] - _at(other.stamps, theirs, times)
        error = error[np.isfinite(error)]
        if not len(error):
            continue
        turned = np.abs(np.diff(mine[rows])) / np.diff(stamps)
        fastest = float(np.nanmax(turned, initial=0.0))
        if np.abs(error - np.median(error)).max() > ANGLE + INSTANT * fastest:
            return False
    if log.steering is not None and other.steering is not None:
        for mine, theirs in zip(log.steering.T, other.steering.T, strict=True):
            error = np.abs(mine[rows] - _at(other.stamps, theirs, times))
            if np.nanquantile(error, 0.9) > ANGLE if np.isfinite(error).any() else False:
                return False
    if log.yaw_rate is not None and other.yaw_rate is not None:
        error = np.abs(log.yaw_rate[rows] - _at(other.stamps, other.yaw_rate, times))
        return not np.isfinite(error).any() or float(np.nanmedian(error)) <= RATE
    if log.truth is not None and other.truth is not None:
        apart = np.abs(log.truth.at(stamps) - other.truth.at(times))
        error = apart[:, :2].max(axis=1) if log.truth.has_positions else np.sin(apart[:, 2] / 2.0)
        return not np.isfinite(error).any() or float(np.nanquantile(error, 0.9)) <= PLACE
    return True


def _at(stamps: Floats, column: Floats, times: Floats) -> Floats:
    """A column at other times, NaN if it has no numbers."""
    there = np.isfinite(column)
    if not there.any():
        return np.full(len(times), np.nan)
    return np.interp(times, stamps[there], column[there])
