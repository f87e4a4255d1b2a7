"""The picture of a result, whichever it is."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import inspect
from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure

from six_wheel._core import Rover
from six_wheel.kinematics.keywords import unknown_keyword
from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.logs.recordings import Reference

__all__ = ["figure"]


def figure(result: Any, *, title: str | None = None, **options: Any) -> Figure:
    """Picture of a result: what ``six_wheel.plotting(result)`` draws.

    Parameters
    ----------
    result : Track, Rover, Calibration, FourAxleSimulation, or a drive that has ended
        A track takes ``truth=`` (a `GroundTruth`, a `WheelLog` that has one, another track), a rover
        ``twist=`` or ``limits=``.
    title : str, optional
        Written above the picture.
    **options
        Those of the picture.

    Returns
    -------
    matplotlib.figure.Figure
        To be written by `save`.

    Raises
    ------
    TypeError
        If there is no picture of such a thing; the message lists those there are.
    """
    for kind in type(result).__mro__:
        if draw := PICTURES.get(kind.__name__):
            known = [name for name in inspect.signature(draw).parameters if name != "title"][1:]
            for name in options:
                if name not in known:
                    raise TypeError(unknown_keyword("sw.plot", name, ["title", *known]))
            return draw(result, title=title, **options)
    raise TypeError(f"result must be one of {', '.join(PICTURES)}, got {type(result).__name__}")


def _track(track: Track, *, title: str | None, truth: Reference | None = None) -> Figure:
    from six_wheel.log_odometry.tracks import of_track

    return _reckoned(of_track(track, truth), title=title)


def _reckoned(result: Any, *, title: str | None) -> Figure:
    from six_wheel.plotting.log_odometry import reckoning_figure

    return reckoning_figure(result, title=title)


def _rover(rover: Rover, *, title: str | None, twist: Any = None, limits: Any = None) -> Figure:
    from six_wheel.plotting.limits import limits_figure
    from six_wheel.plotting.twist import show_figure

    if (twist is None) == (limits is None):
        raise TypeError("a rover's picture needs twist= or limits=, got neither or both")
    if limits is not None:
        return limits_figure(rover, limits, title=title)
    return show_figure(rover, twist, title=title)


def _calibration(found: Any, *, title: str | None) -> Figure:
    from six_wheel.plotting.tracks import residual_figure

    return residual_figure(found.windows.before, found.windows.after, title=title)


def _four_axles(found: Any, *, title: str | None) -> Figure:
    from six_wheel.plotting.four_axle import four_axle_figure

    return four_axle_figure(found, title=title)


def _drive(engine: Any, *, title: str | None) -> Figure:
    from six_wheel.plotting.drive import engine_figure

    return engine_figure(engine, title=title or "drive")


# By name: most of these need what a picture of another does not.
PICTURES: dict[str, Callable[..., Figure]] = {
    "Track": _track,
    "Rover": _rover,
    "Calibration": _calibration,
    "FourAxleSimulation": _four_axles,
    "Drive": _drive,
    "ControlledDrive": _drive,
    "Reckoned": _reckoned,
}
