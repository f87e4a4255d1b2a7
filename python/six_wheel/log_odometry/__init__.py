"""A log on disk to a track on disk, in chunks of constant memory, with what is to be said about it."""

from typing import TYPE_CHECKING

from six_wheel.lazy import attach

if TYPE_CHECKING:
    from six_wheel.reckoning.fleet import FleetLog, reckon_all
    from six_wheel.reckoning.running import Count, Reckoned, Settings, reckon
    from six_wheel.reckoning.slip import SlipSum
    from six_wheel.reckoning.tracks import of_track

__all__ = [
    "Count",
    "FleetLog",
    "Reckoned",
    "Settings",
    "SlipSum",
    "of_track",
    "reckon",
    "reckon_all",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "fleet": ("FleetLog", "reckon_all"),
        "running": ("Count", "Reckoned", "Settings", "reckon"),
        "slip": ("SlipSum",),
        "tracks": ("of_track",),
    },
)
