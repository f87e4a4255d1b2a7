"""Whole logs in space: the track of a rover on ground."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Suspension
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.objects.checked_values import check_columns
from six_wheel.kinematics.objects.short_text import described, few
from six_wheel.kinematics.objects.tables import Columns, Tabular, pose_columns, rows_taken
from six_wheel.kinematics.odometry.tracks import OdometryHealth, findings, rows_with
from six_wheel.kinematics.poses import Floats, quaternions


@checked_class
@dataclass(frozen=True, slots=True, eq=False)
class Track3(Tabular):
    """Poses of a rover on ground over a whole log, one row per sample.

    Rows that were left out (`health`) hold the state of the row before; their slips are NaN.

    Attributes
    ----------
    suspension : Suspension
        The rover that was driven.
    stamps : ndarray, shape (n,)
        As given [s].
    poses : ndarray, shape (n, 6)
        ``[x, y, z, roll, pitch, yaw]`` in the world, ``Rz(yaw) Ry(pitch) Rx(roll)``, yaw with its full turns
        [m, rad].
    twists : ndarray, shape (n, 6)
        Mean ``[vx, vy, vz, wx, wy, wz]`` over the step that ends at the sample, in axes of the body [m/s,
        rad/s].
    covariances : ndarray, shape (n, 6, 6), or None
        Of x, y, z and about the axes of the world.
    slips : ndarray, shape (n, wheels, 2), or None
        Speed at which each wheel's contact slid, along its rim and to its left [m/s].
    health : ndarray of uint32, shape (n,)
        `OdometryHealth` flags.
    """

    suspension: Suspension
    stamps: Floats
    poses: Floats
    twists: Floats
    covariances: Floats | Any  # None where it was not asked for
    slips: Floats | Any  # None where it was not asked for
    health: NDArray[np.uint32]

    def __post_init__(self) -> None:
        check_columns(self, {
            "stamps": "(n,)", "poses": "(n, 6)", "twists": "(n, 6)", "covariances": "(n, 6, 6)",
            "slips": "(n, wheels, 2)", "health": "(n,)",
        }, optional=("covariances", "slips"))  # fmt: skip

    def __len__(self) -> int:
        return len(self.stamps)

    __getitem__ = rows_taken
    __iter__ = None  # a table of columns, no sequence

    @property
    def positions(self) -> Floats:
        """Of the body's origin, shape (n, 3) [m]."""
        return self.poses[:, :3]

    @property
    def attitudes(self) -> Floats:
        """Rows ``[roll, pitch, yaw]``, shape (n, 3) [rad]."""
        return self.poses[:, 3:]

    @property
    def orientations(self) -> Floats:
        """``world_from_body`` as quaternions x, y, z, w, shape (n, 4)."""
        return quaternions(self.attitudes)

    @property
    def residuals(self) -> Floats | Any:
        """Speed at which each wheel's contact slid, shape (n, wheels) [m/s]; NaN in the air."""
        if self.slips is None:
            return None
        along, aside = self.slips[..., 0], self.slips[..., 1]
        sliding: Floats = np.where(np.isnan(along), np.abs(aside), np.hypot(along, aside))
        return sliding

    @property
    def left_out(self) -> NDArray[np.int64]:
        """Rows that were left out."""
        return self.rows(OdometryHealth.LEFT_OUT)

    def rows(self, flag: OdometryHealth) -> NDArray[np.int64]:
        """Numbers of the rows with any flag of `flag`."""
        return rows_with(self.health, flag)

    def findings(self) -> list[str]:
        """One line per kind of flag: how many rows, and the first of them."""
        return findings(self.health)

    def _columns(self) -> Columns:
        places = {"x": "m", "y": "m", "z": "m", "roll": "rad", "pitch": "rad", "yaw": "rad"}
        rates = {"vx": "m/s", "vy": "m/s", "vz": "m/s", "wx": "rad/s", "wy": "rad/s", "wz": "rad/s"}
        columns = pose_columns(self.stamps, self.poses, places)
        columns |= {name: (unit, self.twists[:, k]) for k, (name, unit) in enumerate(rates.items())}
        return columns | {"health": ("", self.health)}

    def __repr__(self) -> str:
        return described("Track3", self.stamps, self.poses)

    def __str__(self) -> str:
        return "\n  ".join([repr(self), *few(self.findings())])
