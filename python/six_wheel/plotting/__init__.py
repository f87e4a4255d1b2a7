"""Pictures of rovers, drives, tracks and limits: each takes a result and returns a figure.

>>> import six_wheel as sw
>>> picture = sw.plot(sw.Rover.preset("perseverance"), twist=(0.04, 0.0, 0.02))
>>> sw.plot.save(picture, "perseverance.png")  # doctest: +SKIP

Only matplotlib's object interface is used: no global state and no display, so the figures can be made in any
thread and on any machine. `save` writes them as PNG, SVG or PDF.
"""

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

try:
    import matplotlib  # noqa: F401
except ImportError as missing:
    raise ImportError('pictures need matplotlib: pip install "six-wheel[plot]"') from missing

from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from six_wheel.plotting.drawing import draw_rover
    from six_wheel.plotting.drive import drive_figure, engine_figure
    from six_wheel.plotting.four_axle import four_axle_figure
    from six_wheel.plotting.ground.map import map_figure
    from six_wheel.plotting.ground.run import film_figure, ground_figure, speeds_figure
    from six_wheel.plotting.ground.safety import traverse_figure
    from six_wheel.plotting.ground.side import side_figure
    from six_wheel.plotting.limits import limits_figure
    from six_wheel.plotting.log_odometry import reckoning_figure
    from six_wheel.plotting.path import draw_path, path_figure
    from six_wheel.plotting.planning import draw_costmap, plan_figure
    from six_wheel.plotting.replay import replay_figure
    from six_wheel.plotting.results import figure
    from six_wheel.plotting.saving import picture_path, save
    from six_wheel.plotting.tracks import residual_figure, track_figure
    from six_wheel.plotting.twist import show_figure

__all__ = [
    "draw_costmap",
    "draw_path",
    "draw_rover",
    "drive_figure",
    "engine_figure",
    "figure",
    "film_figure",
    "four_axle_figure",
    "ground_figure",
    "limits_figure",
    "map_figure",
    "path_figure",
    "picture_path",
    "plan_figure",
    "reckoning_figure",
    "replay_figure",
    "residual_figure",
    "save",
    "show_figure",
    "side_figure",
    "speeds_figure",
    "track_figure",
    "traverse_figure",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "drawing": ("draw_rover",),
        "drive": ("drive_figure", "engine_figure"),
        "four_axle": ("four_axle_figure",),
        "ground.map": ("map_figure",),
        "ground.run": ("film_figure", "ground_figure", "speeds_figure"),
        "ground.safety": ("traverse_figure",),
        "ground.side": ("side_figure",),
        "limits": ("limits_figure",),
        "path": ("draw_path", "path_figure"),
        "planning": ("draw_costmap", "plan_figure"),
        "log_odometry": ("reckoning_figure",),
        "replay": ("replay_figure",),
        "results": ("figure",),
        "saving": ("picture_path", "save"),
        "tracks": ("residual_figure", "track_figure"),
        "twist": ("show_figure",),
    },
)


class _Pictures(ModuleType):
    """This package, which can be called: ``six_wheel.plot(track)`` is ``six_wheel.plot.figure(track)``."""

    @checked(call="sw.plot")
    def __call__(self, result: Any, **options: Any) -> "Figure":
        from six_wheel.plotting.results import figure

        return figure(result, **options)


plot: _Pictures = cast(_Pictures, sys.modules[__name__])  # `six_wheel.plot`
sys.modules[__name__].__class__ = _Pictures
