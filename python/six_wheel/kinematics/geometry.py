"""Twists and poses in the plane: a twist is a vector, a pose an element of the group SE(2)."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple, NoReturn, Self

from six_wheel._core import compose, differentiate, exp, integrate, log, wrap_angle
from six_wheel.kinematics import rover_edit, se2
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.objects.checked_values import is_number, of_numbers

__all__ = ["Pose", "Twist", "compose", "differentiate", "exp", "integrate", "log", "wrap_angle"]


@of_numbers
@checked_class
class Twist(NamedTuple):
    """Velocity of the body frame in body axes; goes wherever three floats do.

    Twists are vectors: they add, subtract, and are multiplied and divided by numbers.

    Parameters
    ----------
    vx, vy : float, default 0.0
        Forward and to the left [m/s].
    omega : float, default 0.0
        Counter-clockwise [rad/s].

    Examples
    --------
    >>> 2 * Twist(0.5, omega=0.1) - (0.2, 0.0, 0.0)
    Twist(vx=0.8, vy=0.0, omega=0.2)
    """

    vx: float = 0.0
    """Forward [m/s]."""
    vy: float = 0.0
    """To the left [m/s]."""
    omega: float = 0.0
    """Counter-clockwise [rad/s]."""

    def replace(self, **changes: Any) -> Self:
        """The same with some of its values given anew; None is the default of one that has it."""
        return rover_edit.replace(self, **changes)

    def __replace__(self, **changes: Any) -> Self:
        return rover_edit.replace(self, **changes)

    def to_body(self, yaw: float) -> Self:
        """A twist with `vx` and `vy` along axes of the world, in body axes of a rover with this yaw [rad].

        Field-relative driving: ``rover.inverse(stick.to_body(odometry.state.yaw))``. Raises
        ValueError if `yaw` is not finite.
        """
        if not math.isfinite(yaw):
            raise ValueError(f"yaw must be finite, got {yaw}")
        sin, cos = math.sin(yaw), math.cos(yaw)
        return type(self)._make((cos * self.vx + sin * self.vy, cos * self.vy - sin * self.vx, self.omega))

    def to_world(self, yaw: float) -> Self:
        """The inverse of `to_body`: `vx` and `vy` along the axes of the world, at this yaw [rad]."""
        return self.to_body(-yaw)

    def discretized(self, dt: float) -> Self:
        """The twist that, held for a step, ends where this velocity points: at ``(vx, vy, omega) dt``.

        Without it, a rover that is commanded step by step to drive straight in the world while it turns goes
        astray sideways.

        Parameters
        ----------
        dt : float
            Duration of the step [s].

        Raises
        ------
        ValueError
            If `dt` is not finite and positive.
        """
        if not (math.isfinite(dt) and dt > 0.0):
            raise ValueError(f"dt must be finite and positive, got {dt}")
        return type(self)._make(log([self.vx * dt, self.vy * dt, self.omega * dt], dt).tolist())

    def __add__(self, other: Sequence[float]) -> Self:  # type: ignore[override]
        return type(self)._make(a + b for a, b in zip(self, _twist("+", other), strict=True))

    def __radd__(self, other: Sequence[float]) -> Self:
        return self + other

    def __sub__(self, other: Sequence[float]) -> Self:
        return type(self)._make(a - b for a, b in zip(self, _twist("-", other), strict=True))

    def __rsub__(self, other: Sequence[float]) -> Self:
        return type(self)._make(b - a for a, b in zip(self, _twist("-", other), strict=True))

    def __mul__(self, factor: float) -> Self:  # type: ignore[override]
        if not is_number(factor):
            return NotImplemented
        return type(self)._make(float(factor) * part for part in self)

    def __rmul__(self, factor: float) -> Self:  # type: ignore[override]
        return self * factor

    def __truediv__(self, divisor: float) -> Self:
        if not is_number(divisor):
            return NotImplemented
        return type(self)._make(part / float(divisor) for part in self)

    def __neg__(self) -> Self:
        return type(self)._make(-part for part in self)

    def __pos__(self) -> Self:
        return self

    def __abs__(self) -> NoReturn:
        raise TypeError(
            "a twist has no length: metres and radians do not add; take hypot(vx, vy) or abs(omega)"
        )


@of_numbers
@checked_class
class Pose(NamedTuple):
    """Pose of the body frame in the world; it can be given wherever three floats can.

    Poses are no vectors: ``pose @ step`` goes on by a step in body axes, ``pose.inverse()`` is the way back.

    Parameters
    ----------
    x, y : float, default 0.0
        Place [m].
    yaw : float, default 0.0
        Counter-clockwise [rad]; keeps its full turns.

    Examples
    --------
    >>> Pose(1.0, 2.0) @ (0.5, 0.0, 0.1)
    Pose(x=1.5, y=2.0, yaw=0.1)
    """

    x: float = 0.0
    """[m]"""
    y: float = 0.0
    """[m]"""
    yaw: float = 0.0
    """Counter-clockwise [rad]; keeps its full turns."""

    def replace(self, **changes: Any) -> Self:
        """The same with some of its values given anew; None is the default of one that has it."""
        return rover_edit.replace(self, **changes)

    def __replace__(self, **changes: Any) -> Self:
        return rover_edit.replace(self, **changes)

    def inverse(self) -> Self:
        """The pose of the world in the body: ``pose @ pose.inverse()`` is the origin."""
        sin, cos = math.sin(self.yaw), math.cos(self.yaw)
        return type(self)._make((-cos * self.x - sin * self.y, sin * self.x - cos * self.y, -self.yaw))

    def to_body(self, twist: Sequence[float]) -> Twist:
        """`twist` [m/s, m/s, rad/s], its linear part along axes of the world, in body axes at this pose."""
        return Twist._make(_three("to_body", twist)).to_body(self.yaw)

    def between(self, other: Sequence[float]) -> Self:
        """`other` as seen from here, its yaw between -pi and pi: ``pose @ between`` is `other`."""
        return type(self)._make(se2.between(self, _three("between", other)).tolist())

    def interpolate(self, other: Sequence[float], share: float) -> Self:
        """The pose after a share of the way to `other` on the arc of constant twist, the shorter way round.

        Parameters
        ----------
        other : Pose or (float, float, float)
            End of the way [m, m, rad].
        share : float
            0 is this pose, 1 is `other`.

        Raises
        ------
        ValueError
            If `other` is no pose, or `share` no number.
        """
        return type(self)._make(se2.interpolate(self, _three("interpolate", other), share).tolist())

    def __matmul__(self, other: Sequence[float]) -> Self:
        return type(self)._make(compose(self, _three("@", other)).tolist())

    def __rmatmul__(self, other: Sequence[float]) -> Self:
        return type(self)._make(compose(_three("@", other), self).tolist())

    def __add__(self, other: object) -> NoReturn:
        _refuse()

    def __radd__(self, other: object) -> NoReturn:
        _refuse()

    def __sub__(self, other: object) -> NoReturn:
        _refuse()

    def __rsub__(self, other: object) -> NoReturn:
        _refuse()

    def __mul__(self, other: object) -> NoReturn:
        _refuse()

    def __rmul__(self, other: object) -> NoReturn:
        _refuse()

    def __truediv__(self, other: object) -> NoReturn:
        _refuse()

    def __neg__(self) -> NoReturn:
        _refuse()

    def __abs__(self) -> NoReturn:
        _refuse()


def _refuse() -> NoReturn:
    rule = "pose @ other composes, as se2.compose does, pose.inverse() is the way back"
    raise TypeError(f"poses do not add or scale: {rule}")


def _twist(operator: str, value: object) -> tuple[float, float, float]:
    """Three numbers beside an operator of twists, which are not those of a pose."""
    if isinstance(value, Pose):
        _refuse()
    return _three(operator, value)


def _three(operator: str, value: object) -> tuple[float, float, float]:
    """Three numbers beside an operator."""
    try:
        a, b, c = map(float, value)  # type: ignore[call-overload]
    except (TypeError, ValueError):
        raise ArgumentTypeError(f"{operator} needs three numbers beside it, got {value!r}") from None
    return a, b, c
