"""Dead reckoning of whole logs: tracks, what the wheels say about slip, tables of readings.

`Odometry` itself, sample by sample, is in the core.
"""

from typing import TYPE_CHECKING

from six_wheel._core import Encoder, Noise, Odometry, Odometry3, Odometry3State, OdometryState
from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.kinematics.odometry.dead_reckoning import dead_reckon, dead_reckon_chunks, table_columns
    from six_wheel.kinematics.odometry.dead_reckoning3 import Track3
    from six_wheel.kinematics.odometry.dimensions import deviations
    from six_wheel.kinematics.odometry.thinning import Trace
    from six_wheel.kinematics.odometry.tracks import OdometryHealth, SlipReport, SlipWindow, Track, WheelSlip

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
    "Trace",
    "Track",
    "Track3",
    "WheelSlip",
    "dead_reckon",
    "dead_reckon_chunks",
    "deviations",
    "table_columns",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "dead_reckoning": ("dead_reckon", "dead_reckon_chunks", "table_columns"),
        "dimensions": ("deviations",),
        "gyroscope_errors": (),
        "sensor_frames": (),
        "dead_reckoning3": ("Track3",),
        "tabular_input": (),
        "thinning": ("Trace",),
        "tracks": ("OdometryHealth", "SlipReport", "SlipWindow", "Track", "WheelSlip"),
    },
)
