"""Twists and poses in the plane."""

from typing import Any, NamedTuple, Self

from six_wheel._core import compose, differentiate, exp, integrate, log, wrap_angle
from six_wheel.kinematics import rover_edit

__all__ = ["Pose", "Twist", "compose", "differentiate", "exp", "integrate", "log", "wrap_angle"]


class Twist(NamedTuple):
    """Velocity of the body frame in body axes; goes wherever three floats do."""

    vx: float
    """Forward [m/s]."""
    vy: float
    """To the left [m/s]."""
    omega: float
    """Counter-clockwise [rad/s]."""

    def replace(self, **changes: Any) -> Self:
        """The same with some of its values given anew; None is the default of one that has it."""
        return rover_edit.replace(self, **changes)

    def __replace__(self, **changes: Any) -> Self:
        return rover_edit.replace(self, **changes)


class Pose(NamedTuple):
    """Pose of the body frame in the world; it can be given wherever three floats can."""

    x: float
    """[m]"""
    y: float
    """[m]"""
    yaw: float
    """Counter-clockwise [rad]; keeps its full turns."""

    def replace(self, **changes: Any) -> Self:
        """The same with some of its values given anew; None is the default of one that has it."""
        return rover_edit.replace(self, **changes)

    def __replace__(self, **changes: Any) -> Self:
        return rover_edit.replace(self, **changes)
