"""Logs as they are given to a calibration, each with its truth."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.logs.recordings import Reference, WheelLog, as_truth


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
        replace(log, truth=as_truth(one) if hasattr(one, "stamps") else one)
        for log, one in zip(logs, truths, strict=True)
    ]
