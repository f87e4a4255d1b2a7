"""Opens a view."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import os
import sys
import webbrowser
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from six_wheel.view.server import free_port, require

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from six_wheel.view.viewing import View


def view(
    x: Any,
    ground: Any = None,
    *,
    rover: Any = None,
    twist: ArrayLike | None = None,
    at: ArrayLike | None = None,
    steering_limit: float | None = None,
    wheel_speed: float | None = None,
    speed: float | None = None,
    tilt: float | None = None,
    joints: ArrayLike | None = None,
    scrub: Mapping[str, float] | None = None,
    other: Any = None,
    port: int = 0,
    open: bool = True,
    theme: str = "dark",
) -> View:
    """Show a rover, or a record of one, in the browser.

    Parameters
    ----------
    x : Rover, RockerBogie, SettledPose, str, PathLike, Track, WheelLog, Simulation or ControlledDrive
        A rover; a settled pose of a RockerBogie, on its ground; the name of a preset; a file with a rover
        (.yaml, .urdf, .xacro) or a record (.mcap, .csv, .parquet); a result.
    ground : Terrain, str or PathLike, optional
        Ground of a suspension: a map, what `Terrain.read` takes, ``"yard"`` (rocks, the default) or
        ``"flat"``.
    rover : Rover, RockerBogie, str or PathLike, optional
        Rover of a record that does not have it itself.
    twist : array_like, shape (3,), optional
        Commanded vx, vy, omega [m/s, m/s, rad/s]; a left turn without it.
    at : array_like, shape (3,), optional
        First pose x, y, yaw [m, m, rad]; the middle of the map without it.
    steering_limit : float, optional
        Largest steering angle [rad].
    wheel_speed, speed, tilt : float, optional
        Other limits at first [rad/s, m/s, rad].
    joints : array_like, shape (3,), optional
        Rocker and bogies of a suspension without ground [rad].
    scrub : mapping of str to float, optional
        Scrub of wheels by name [m], without ground.
    other : Track, WheelLog, Simulation, ControlledDrive, str or PathLike, optional
        A second record, whose rover is drawn paler beside that of the record `x`, on the same ground; both
        begin at time 0.
    port : int, default 0
        On this machine only; 0 takes a free one.
    open : bool, default True
        True to open a browser, where there is one.
    theme : {"dark", "light"}

    Returns
    -------
    View
        At once; `View.wait` waits until it is closed.

    Raises
    ------
    ModuleNotFoundError
        If the extra is missing; the message has the install line.
    ValueError
        If an argument or a file cannot be used, or the port is taken.
    """
    require()
    free_port(port)
    from six_wheel.view.commands import start_state
    from six_wheel.view.subject import find_subject
    from six_wheel.view.viewing import View

    subject = find_subject(x, ground, rover=rover, at=at, other=other)
    state = start_state(
        subject, twist=twist, steering_limit=steering_limit, wheel_speed=wheel_speed, speed=speed, tilt=tilt,
        joints=joints, scrub=scrub,
    )  # fmt: skip
    made = View(subject, state, port=port, theme=theme)
    if open:
        browse(made.url)
    return made


def browse(url: str) -> bool:
    """Open a browser at an address; whether there is one to be seen."""
    unseen = sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )
    if unseen and "BROWSER" not in os.environ:
        return False
    try:
        return webbrowser.open(url)
    except webbrowser.Error:
        return False
