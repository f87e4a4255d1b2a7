"""One slip report of a track that comes in pieces."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.kinematics.odometry.tracks import (
    OdometryHealth,
    SlipReport,
    SlipWindow,
    Track,
    WheelContradiction,
    can_contradict,
)
from six_wheel.kinematics.poses import Floats

GAP = 0.5  # [s], below which two stretches of slip are one


class SlipSum:
    """Sum of the reports of all pieces; its rows are those of the file."""

    def __init__(self) -> None:
        self._rows = self._moving = 0
        # By wheel: squares of residuals, residuals, rows in which it leads, weights (NaN without).
        self._sums: Floats = np.zeros((4, 1))
        self._worst: list[tuple[float, int]] = []
        self._windows: list[SlipWindow] = []

    def add(self, track: Track, rows: NDArray[np.int64]) -> None:
        """Take in the next piece, whose rows have these numbers in the file."""
        report = track.slip_report(gap=GAP)
        if not report.rows:
            return
        values = [(each.rms * each.rms, each.mean, each.worst_share, each.weight) for each in report.wheels]
        rows_of, moving = report.rows, self._moving_rows(track)
        self._rows += rows_of
        self._moving += moving
        shares = np.array(values, dtype=np.float64).T
        self._sums = self._sums + shares * np.array([rows_of, rows_of, moving, rows_of])[:, None]
        worst = [(wheel.worst, int(rows[wheel.worst_row])) for wheel in report.wheels]
        self._worst = [max(pair) for pair in zip(self._worst, worst, strict=True)] if self._worst else worst
        for window in report.windows:
            first, last = int(rows[window.first_row]), int(rows[window.last_row])
            self._join(replace(window, first_row=first, last_row=last))

    @staticmethod
    def _moving_rows(track: Track) -> int:
        used = (track.health & int(OdometryHealth.LEFT_OUT | OdometryHealth.FIRST)) == 0
        residuals = track.residuals
        return 0 if residuals is None else int((residuals[used].max(axis=1) > 0.0).sum())

    def _join(self, window: SlipWindow) -> None:
        last = self._windows[-1] if self._windows else None
        if last is None or window.start - last.end > GAP:
            self._windows.append(window)
            return
        further = max(last, window, key=lambda each: each.distance)
        slid = sum(each.distance for each in (last, window) if each.wheel == further.wheel)
        worst = max(each.worst for each in (last, window) if each.wheel == further.wheel)
        self._windows[-1] = replace(
            further, start=last.start, end=window.end, first_row=last.first_row, last_row=window.last_row,
            distance=slid, worst=worst,
        )  # fmt: skip

    def report(self, rover: Rover) -> SlipReport:
        """The report of all pieces."""
        if not self._rows:
            return SlipReport((), (), 0, can_contradict(rover))
        squares, mean, _, weights = self._sums / self._rows
        figures = np.column_stack((np.sqrt(squares), mean, self._sums[2] / max(self._moving, 1), weights))
        wheels = tuple(
            WheelContradiction(name, r, m, worst, row, s, None if math.isnan(w) else w)
            for name, (worst, row), (r, m, s, w) in zip(
                rover.wheel_names, self._worst, figures.tolist(), strict=True
            )
        )
        largest = max(worst for worst, _ in self._worst)
        return SlipReport(wheels, tuple(self._windows), self._rows, can_contradict(rover, largest))
