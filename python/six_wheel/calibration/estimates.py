"""Parts of a calibration's result: values with their uncertainty, errors of windows and of runs."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Self

import numpy as np
from numpy.typing import NDArray

from six_wheel.calibration.drives import Drive
from six_wheel.calibration.model import Model
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry.evaluation.paths import absolute_error
from six_wheel.logs.recordings import GroundTruth, interpolate

HALVINGS = 30  # of the stretch in which the end of an interval lies


@dataclass(frozen=True)
class Estimate:
    """One parameter: what it was and is, standard deviation and interval; NaN where it is not identified."""

    name: str
    unit: str
    nominal: float
    value: float
    std: float
    interval: tuple[float, float]

    @property
    def identified(self) -> bool:
        """True if the data determine this value by itself."""
        return not math.isnan(self.std)

    @property
    def half_width(self) -> float:
        """Half the width of the interval."""
        low, high = self.interval
        return (high - low) / 2.0

    @classmethod
    def of_interval(
        cls, name: str, unit: str, nominal: float, value: float, interval: Sequence[float], confidence: float
    ) -> Self:
        """A value whose standard deviation is that of a normal distribution with this interval."""
        low, high = interval
        std = (high - low) / (2.0 * NormalDist().inv_cdf(0.5 + confidence / 2.0))
        return cls(name, unit, nominal, value, std, (low, high))

    def __repr__(self) -> str:
        low, high = self.interval
        known = f"[{low:.6g}, {high:.6g}]" if self.identified else "not identified"
        return f"Estimate({self.name} = {self.value:.6g} {self.unit}, {known}, nominal {self.nominal:.6g})"


def three_digits(value: float) -> float:
    """A value in three digits: more are not known."""
    return float(f"{value:.3g}")


def likelihood_end(
    cost: Callable[[float], float], allowed: float, inside: float, outside: float, close: float = 0.0
) -> float:
    """The place between a likely and an unlikely value at which the cost is as large as allowed."""
    for _ in range(HALVINGS):
        middle = (inside + outside) / 2.0
        inside, outside = (middle, outside) if cost(middle) <= allowed else (inside, middle)
        if abs(outside - inside) < close:
            break
    return inside


@dataclass(frozen=True, eq=False)
class Windows:
    """Errors of the motion over all windows.

    `before` and `after` (m, 3) hold errors forward [m], to the left [m] and of the heading [rad]; `kind`
    (m,) the row of `lengths` [m] a window belongs to, one more for those from the start of a drive;
    `weights` (m, 3) what the loss left of each; `scales` (k + 1, 2) the usual errors of place and heading.
    """

    kind: NDArray[np.int64]
    lengths: Floats
    before: Floats
    after: Floats
    weights: Floats
    scales: Floats

    def table(self) -> list[tuple[str, int, float, float, float, float]]:
        """Per length: its name, how many windows, rms before and after of place [m] and heading [rad]."""
        rows = []
        for kind in np.unique(self.kind).tolist():
            name = f"{self.lengths[kind]:.3g} m" if kind < len(self.lengths) else "from the start"
            chosen = self.kind == kind
            figures = [
                math.sqrt(float(np.mean(np.sum(np.square(errors[chosen][:, columns]), axis=1))))
                for columns in (slice(0, 2), slice(2, 3))
                for errors in (self.before, self.after)
            ]
            rows.append((name, int(chosen.sum()), *figures))
        return rows  # type: ignore[return-value]

    def __repr__(self) -> str:
        said = ", ".join(
            f"{name}: {before:.4f} -> {after:.4f} m" for name, _, before, after, *_ in self.table()
        )
        return f"Windows({said})"


@dataclass(frozen=True, eq=False)
class RunErrors:
    """Root mean square position error of one run with the first pose given, nominal and calibrated.

    After the best rigid alignment where the truth has no headings; of the heading where it has nothing else.
    `unit` is m, or rad.
    """

    name: str
    session: str
    distance: float
    before: float
    after: float
    dropped: int
    number: int = 0  # of the log it is, or is a piece of
    unit: str = "m"

    @classmethod
    def of(cls, model: Model, drive: Drive, values: Floats) -> Self:
        """Errors of a drive with these values; `before` with the nominal ones."""
        paths = (timed_path(model, drive, one)[1:] for one in (model.start, values))
        before, after = (_error(drive.truth, *path) for path in paths)
        ways = drive.distance, before, after, drive.dropped, drive.number
        return cls(drive.name, drive.session, *ways, "m" if drive.truth.has_positions else "rad")


def timed_path(model: Model, drive: Drive, values: Floats) -> tuple[Floats, Floats, Floats]:
    """Stamps, dead reckoning of what the truth follows, and the truth; rows where it is known."""
    followed = model.poses(drive, values)
    wanted = drive.stamps + model.value(values, "time_offset", 0.0)
    known = drive.truth.covers(wanted)
    truth, _ = interpolate(drive.truth.stamps, np.nan_to_num(drive.truth.poses), wanted[known])
    return drive.stamps[known], followed[known], truth


def _error(truth: GroundTruth, followed: Floats, poses: Floats) -> float:
    if not truth.has_positions:
        return absolute_error(followed, poses).yaw_rmse
    return absolute_error(followed, poses, "first" if truth.has_yaw else "se2").rmse
