"""Outputs of a step of the loop."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

from six_wheel._core import OdometryState

Send: TypeAlias = Callable[[int, list[float], list[float]], None]
"""Receiver of commands: a time [ns], steering angles and wheel speeds in the order of the joints."""


class Step(NamedTuple):
    """Outputs of one step.

    Attributes
    ----------
    now : int
        Its time [ns].
    steering, wheel_speeds : list of float, or None
        Joint commands in the order of `Rover.joint_names` [rad, rad/s]; None where nothing is commanded.
    twist : tuple of float
        The motion they make.
    reasons : int
        Bits of `Reason`.
    stamp : int or None
        When the readings were taken [ns] that odometry has counted with this step; None if it has not.
    state : OdometryState or None
    """

    now: int
    steering: list[float] | None
    wheel_speeds: list[float] | None
    twist: tuple[float, float, float]
    reasons: int
    stamp: int | None
    state: OdometryState | None
