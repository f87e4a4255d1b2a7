"""Logs as they are given to a calibration: each with its truth, and each once."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.logs.recordings import Reference, WheelLog, as_truth

__all__ = ["with_truth", "without_copies"]

SHARE = 0.9  # of the rows of a log that are in another one, from which on it is a part of that
ROWS = 20  # in which a wheel moves, that tell a log
DIGITS = 9


def without_copies(logs: Sequence[WheelLog]) -> tuple[list[WheelLog], list[str]]:
    """The logs, each once, and a line for each that is another one or a part of it: a log counts once."""
    rows = [_rows(log) for log in logs]
    order = sorted(range(len(logs)), key=lambda number: -len(rows[number]))
    kept: list[int] = []
    said = []
    for number in order:
        mine = rows[number]
        for other in kept if len(mine) >= ROWS else ():
            if len(mine & rows[other]) > SHARE * len(mine):
                who, of = (logs[k].name or f"logs[{k}]" for k in (number, other))
                said.append(
                    f"{who} (logs[{number}]) has the readings of {of} (logs[{other}]): they count once"
                )
                break
        else:
            kept.append(number)
    return [logs[number] for number in sorted(kept)], said


def _rows(log: WheelLog) -> set[bytes]:
    """The stamps at which a wheel moved, with what each wheel turned and every steering angle."""
    steps = np.diff(log.wheel_angles, axis=0)
    columns = [log.stamps[1:, None], steps] + ([] if log.steering is None else [log.steering[1:]])
    table = np.nan_to_num(np.hstack(columns)).round(DIGITS) + 0.0  # no negative zeros
    moved = np.nan_to_num(np.abs(steps)).max(axis=1, initial=0.0) > 0.0
    return {row.tobytes() for row in table[moved]}


def with_truth(
    logs: list[WheelLog], truth: Reference | ArrayLike | Sequence[Reference | ArrayLike] | None
) -> list[WheelLog]:
    """The logs, each with the truth given for it."""
    if not logs:
        raise ValueError("logs must hold one at least, got none")
    if truth is None:
        return logs
    single = hasattr(truth, "stamps") or np.ndim(truth) == 2  # type: ignore[arg-type]
    if not single and (isinstance(truth, str) or not isinstance(truth, Iterable)):
        rule = "must be a GroundTruth, poses, a WheelLog that has one or a Track, one for each log"
        raise ArgumentTypeError(f"truth {rule}, got {truth!r}")
    truths = [truth] if single else list(truth)  # type: ignore[arg-type]
    if len(truths) != len(logs):
        raise ValueError(f"truth must be given once per log, got {len(truths)} for {len(logs)}")
    return [
        replace(log, truth=as_truth(one) if hasattr(one, "stamps") else one)  # type: ignore[arg-type]
        for log, one in zip(logs, truths, strict=True)
    ]
