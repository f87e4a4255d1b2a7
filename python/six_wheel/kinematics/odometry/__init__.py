"""Odometry: tracks of whole logs, slip by the wheels.

`Odometry` itself is in the core; `log_odometry.dead_reckon` reads whole logs.
"""

from typing import TYPE_CHECKING

from six_wheel._core import Encoder, Noise, Odometry, Odometry3, Odometry3State, OdometryState
from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.kinematics.odometry.tracks import (
        OdometryHealth,
        SlipReport,
        SlipWindow,
        Track,
        WheelContradiction,
    )
    from six_wheel.kinematics.odometry.tracks3 import Track3

__all__ = [
    "Encoder",
    "Noise",
    "Odometry",
    "Odometry3",
    "Odometry3State",
    "OdometryHealth",
    "OdometryState",
    "SlipReport",
    "SlipWindow",
    "Track",
    "Track3",
    "WheelContradiction",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "tracks3": ("Track3",),
        "tracks": ("OdometryHealth", "SlipReport", "SlipWindow", "Track", "WheelContradiction"),
    },
)
