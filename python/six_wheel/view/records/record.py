"""A record: where a rover was over time, what its wheels did, and why."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Limits, RockerBogie, Rover, Terrain
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.recordings import GroundTruth

PATH_POINTS = 5000  # of a drawn path


@dataclass(frozen=True, eq=False)
class Record:
    """Rows of a drive, in the clock of `times` (n,) since the first row [s], growing.

    `poses` (n, 3) are x, y, yaw [m, m, rad]; `steering`, `wheel_speeds` and `slips` (n, joints) the angles of
    the steered wheels [rad], wheel speeds [rad/s] and speeds at which contacts slid [m/s]; `twists` and
    `commanded` (n, 3) those of the body [m/s, m/s, rad/s]; `covariances` (n, 2, 2) those of x and y [m^2];
    `reasons` (n,) bits of `Reason`. None is what is not known.
    """

    rover: Rover
    name: str
    times: Floats
    poses: Floats
    steering: Floats | None = None
    wheel_speeds: Floats | None = None
    slips: Floats | None = None
    twists: Floats | None = None
    commanded: Floats | None = None
    covariances: Floats | None = None
    reasons: NDArray[np.uint32] | None = None
    truth: GroundTruth | None = None
    suspension: RockerBogie | None = None
    ground: Terrain | None = None
    limits: Limits = Limits()  # noqa: RUF009 - immutable

    def __post_init__(self) -> None:
        if not len(self.times):
            raise ValueError(f"{self.name} must have rows, got none")

    @property
    def duration(self) -> float:
        """From the first row to the last [s]."""
        return float(self.times[-1])

    @cached_property
    def rolled(self) -> NDArray[np.float32] | None:
        """Angles by which the wheels have turned (n, wheels), to be drawn [rad]."""
        if self.wheel_speeds is None:
            return None
        steps = np.diff(self.times, prepend=self.times[0])[:, None]
        return np.remainder(np.cumsum(np.nan_to_num(self.wheel_speeds) * steps, axis=0), 2.0 * np.pi).astype(
            np.float32
        )

    def row(self, time: float) -> int:
        """The last row that is not later than a time [s]."""
        return max(int(np.searchsorted(self.times, time, side="right")) - 1, 0)


def thin_path(points: Floats) -> Floats:
    """At most so many of the points (n, k), each for as much length and turning of the path as the others."""
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) <= PATH_POINTS:
        return points
    steps = np.diff(points[:, :2], axis=0)
    length = np.hypot(*steps.T)
    yaw = np.arctan2(steps[:, 1], steps[:, 0])
    turned = np.abs(np.angle(np.exp(1j * np.diff(yaw, prepend=yaw[0])))) * (length > 0.0)
    share = length / max(length.sum(), 1e-300) + turned / max(turned.sum(), 1e-300)
    along = np.concatenate([[0.0], np.cumsum(share)])
    wanted = np.linspace(0.0, along[-1], PATH_POINTS)
    rows = np.unique(np.searchsorted(along, wanted).clip(0, len(points) - 1))
    thin: Floats = points[rows]
    return thin
