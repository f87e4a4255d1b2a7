"""One slip report of a track that comes in pieces."""

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
        self._squares: Floats | float = 0.0
        self._sums: Floats | float = 0.0
        self._leads: Floats | float = 0.0
        self._weights: Floats | float = 0.0
        self._worst: list[tuple[float, int]] = []
        self._windows: list[SlipWindow] = []
        self._weighted = False

    def add(self, track: Track, rows: NDArray[np.int64]) -> None:
        """Take in the next piece, whose rows have these numbers in the file."""
        report = track.slip_report(gap=GAP)
        if not report.rows:
            return
        values = np.array([(wheel.rms, wheel.mean, wheel.worst_share) for wheel in report.wheels]).T
        moving = self._moving_rows(track)
        self._rows += report.rows
        self._moving += moving
        self._squares += values[0] ** 2 * report.rows
        self._sums += values[1] * report.rows
        self._leads += values[2] * moving
        if report.wheels[0].weight is not None:
            self._weighted = True
            self._weights += np.array([wheel.weight for wheel in report.wheels]) * report.rows
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
        rms, mean = np.sqrt(self._squares / self._rows), self._sums / self._rows
        share = self._leads / max(self._moving, 1)
        weights = self._weights / self._rows if self._weighted else [None] * len(self._worst)
        figures = zip(rover.wheel_names, rms, mean, self._worst, share, weights, strict=True)  # type: ignore[arg-type]
        wheels = tuple(
            WheelContradiction(
                name, float(r), float(m), worst, row, float(s), None if w is None else float(w)
            )
            for name, r, m, (worst, row), s, w in figures
        )
        largest = max(worst for worst, _ in self._worst)
        return SlipReport(wheels, tuple(self._windows), self._rows, can_contradict(rover, largest))
