"""Twists and poses in the plane."""

from typing import NamedTuple

from six_wheel._core import compose, differentiate, exp, integrate, log, wrap_angle

__all__ = ["Pose", "Twist", "compose", "differentiate", "exp", "integrate", "log", "wrap_angle"]


class Twist(NamedTuple):
    """Velocity of the body frame in body axes; goes wherever three floats do."""

    vx: float
    """Forward [m/s]."""
    vy: float
    """To the left [m/s]."""
    omega: float
    """Counter-clockwise [rad/s]."""


class Pose(NamedTuple):
    """Where the body frame is in the world; goes wherever three floats do."""

    x: float
    """[m]"""
    y: float
    """[m]"""
    yaw: float
    """Counter-clockwise [rad]; keeps its full turns."""
