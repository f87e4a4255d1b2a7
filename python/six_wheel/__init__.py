"""Kinematics of wheeled rovers: one wheel equation, any layout, a Rust core.

>>> import six_wheel as sw
>>> rover = sw.Rover.preset("perseverance")
>>> steering, speeds = rover.inverse((0.04, 0.0, 0.02))
>>> twist = rover.forward(steering, speeds)

Axes: x forward, y left, angles counter-clockwise (REP 103). Units: metres, seconds, radians.
"""

from os import PathLike
from typing import TYPE_CHECKING

from six_wheel._core import (
    Fit,
    FourAxle,
    Link,
    Mobility,
    RockerBogie,
    Rover,
    Sensitivity,
    SteeringCommand,
    Wheel,
    __version__,
    compose,
    default_threads,
    differentiate,
    exp,
    integrate,
    kernels,
    log,
    rollout,
    set_default_threads,
    wrap_angle,
)
from six_wheel.errors import ArgumentTypeError, InfeasibleMotionError, UnderdeterminedError
from six_wheel.geometry import Pose, Twist

if TYPE_CHECKING:
    from six_wheel.calibration import calibrate
    from six_wheel.four_axle import FourAxleState, FourAxleStep
    from six_wheel.recordings import Log, Truth
    from six_wheel.square_test import umbmark

__all__ = [
    "ArgumentTypeError",
    "Fit",
    "FourAxle",
    "FourAxleState",
    "FourAxleStep",
    "InfeasibleMotionError",
    "Link",
    "Log",
    "Mobility",
    "Pose",
    "RockerBogie",
    "Rover",
    "Sensitivity",
    "SteeringCommand",
    "Truth",
    "Twist",
    "UnderdeterminedError",
    "Wheel",
    "__version__",
    "calibrate",
    "compose",
    "default_threads",
    "differentiate",
    "exp",
    "integrate",
    "kernels",
    "load",
    "log",
    "rollout",
    "set_default_threads",
    "umbmark",
    "wrap_angle",
]


def load(path: str | PathLike[str], *, node: str | None = None) -> Rover:
    """Read a rover from a parameter file: a ROS 2 parameter file as teams have it, or plain keys.

    Parameters
    ----------
    path : str or PathLike
        A YAML file.
    node : str, optional
        Which node of the file describes the rover, where several do.

    Returns
    -------
    Rover
        With the file's joint names, so that `commands` come out in the file's order.

    Raises
    ------
    six_wheel.config.ParameterFileError
        A `ValueError` that lists every mistake in the file with its line, the rule and a remedy.
    ModuleNotFoundError
        If what reads parameter files is not installed; the message has the install line.
    """
    try:
        from six_wheel import config
    except ModuleNotFoundError as error:
        message = f'parameter files need {error.name}: pip install "six-wheel[cli]"'
        raise ModuleNotFoundError(message, name=error.name) from None
    return config.load(path, node=node)


def __getattr__(name: str) -> object:
    """What is loaded when asked for: dataclasses double the import time, and calibration needs SciPy."""
    if name in ("Log", "Truth"):
        from six_wheel import recordings

        return getattr(recordings, name)
    if name == "umbmark":
        from six_wheel.square_test import umbmark

        return umbmark
    if name == "calibrate":
        from six_wheel.calibration import calibrate

        return calibrate
    if name in ("FourAxleState", "FourAxleStep"):
        from six_wheel import four_axle

        return getattr(four_axle, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
