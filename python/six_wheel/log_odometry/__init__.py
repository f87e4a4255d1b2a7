"""Logs to tracks: `dead_reckoning` of arrays and tables, `run_log` of a file in chunks of constant memory,
with what is to be said about it, `many_logs` over processes or a cluster, of which `copies` finds those that
share readings.

`sensor_frames` turns the track of the body into that of a sensor; `evaluation` compares tracks with the
truth.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.log_odometry.dead_reckoning import dead_reckon, dead_reckon_chunks, table_columns
    from six_wheel.log_odometry.many_logs import FleetLog, reckon_all
    from six_wheel.log_odometry.results import Count, Reckoned, ReckonSettings
    from six_wheel.log_odometry.run_log import reckon
    from six_wheel.log_odometry.slip import SlipSum
    from six_wheel.log_odometry.tracks import of_track

__all__ = [
    "Count",
    "FleetLog",
    "ReckonSettings",
    "Reckoned",
    "SlipSum",
    "dead_reckon",
    "dead_reckon_chunks",
    "of_track",
    "reckon",
    "reckon_all",
    "table_columns",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "dead_reckoning": ("dead_reckon", "dead_reckon_chunks", "table_columns"),
        "many_logs": ("FleetLog", "reckon_all"),
        "results": ("Count", "Reckoned", "ReckonSettings"),
        "run_log": ("reckon",),
        "slip": ("SlipSum",),
        "tracks": ("of_track",),
        "evaluation": (),
    },
)
