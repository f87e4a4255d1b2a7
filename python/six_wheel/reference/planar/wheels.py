"""The wheel equation: what one wheel asks of a twist, and in which ways it can follow one."""

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from six_wheel.reference.planar.geometry import Floats

Limit: TypeAlias = float | tuple[float, float] | None

ANGLE_TOLERANCE = 1e-9  # a wheel so little past a limit stands at it, so close a tie is a tie [rad]
REST_TOLERANCE = 4.0 * math.ulp(1.0)  # a pivot is at rest below this share of what its velocity is the sum of
UNDECIDED = math.radians(10.0)  # two ways that differ by less are about equally near


class InfeasibleMotionError(ValueError):
    """The rover cannot make this motion without side slip inside its steering limits."""


class UnderdeterminedError(ValueError):
    """The wheels do not determine the twist."""


class Way(NamedTuple):
    """One way of following a twist: a steering angle [rad] and how far it lies from the previous one."""

    direction: int  # 1 rolls forwards, -1 backwards, 0 stays
    angle: float
    turn: float


@dataclass(frozen=True)
class Wheel:
    """One wheel: pivot ``(x, y)`` [m] in body axes, `radius` [m], and what decides its direction.

    The contact point lies `trail` behind the pivot and `scrub` to the left of it [m]. A steering angle is
    counted from `heading`; `steering_limit` is a half range (infinite: endless), a pair (lower, upper) or
    None for +-pi/2 [rad].
    `roller_angle` lies between the axes of rollers and wheel [rad]. A `castor` swivels freely and asks
    nothing of the twist; a wheel that is not `driven` need not have a reading.
    """

    name: str
    x: float
    y: float
    _: KW_ONLY
    radius: float
    steered: bool = False
    heading: float = 0.0
    steering_limit: Limit = None
    scrub: float = 0.0
    trail: float = 0.0
    roller_angle: float | None = None
    driven: bool = True
    castor: bool = False

    @property
    def fixed(self) -> bool:
        """True if the direction of the wheel is part of the layout."""
        return not (self.steered or self.castor)

    @property
    def steering_range(self) -> tuple[float, float] | None:
        """Lower and upper steering angle [rad]; None for a wheel that does not steer."""
        if not self.steered:
            return None
        limit = math.pi / 2.0 if self.steering_limit is None else self.steering_limit
        return limit if isinstance(limit, tuple) else (-limit, limit)

    def pivot_velocity(self, twist: Floats) -> tuple[float, float]:
        """``u = (vx - omega y, vy + omega x)`` [m/s]."""
        return twist[0] - twist[2] * self.y, twist[1] + twist[2] * self.x

    def rows(self, angle: float) -> tuple[Floats, Floats]:
        """The wheel equation at a steering angle, two rows: with heading e and left normal n

        rolling: ``e . u - scrub * omega = radius * speed + scrub * steering_rate``
        side slip: ``n . u - trail * omega = trail * steering_rate``

        Rollers at an angle gamma give way across their axes: what is left of both rows is the one along them,
        ``rolling + cot(gamma) * side slip``. A castor has no rows.
        """
        cos, sin = math.cos(self.heading + angle), math.sin(self.heading + angle)
        rolling = np.array([cos, sin, self.x * sin - self.y * cos - self.scrub])
        side = np.array([-sin, cos, self.x * cos + self.y * sin - self.trail])
        nothing = np.zeros(3)
        if self.castor:
            return nothing, nothing
        if self.roller_angle is not None:
            return rolling + side / math.tan(self.roller_angle), nothing
        return rolling, side

    def trailing_rim_speed(self, twist: Floats) -> float:
        """Rim speed [m/s] of a castor that has swung in: its contact follows the pivot at a fixed angle."""
        swing = twist[2] * self.trail  # n . u; the rest of the pivot's speed is along the wheel
        along = math.sqrt(max(math.hypot(*self.pivot_velocity(twist)) ** 2 - swing**2, 0.0))
        return math.copysign(along, self.trail) - float(twist[2]) * self.scrub

    def ways(self, twist: Floats, previous: float, rate: float, tolerance: float) -> list[Way]:
        """Ways to roll without side slip inside the steering range: forwards, backwards, both or none.

        Of the angles that differ by whole turns the one nearest to `previous` is taken.
        """
        lower, upper = self.steering_range or (0.0, 0.0)
        held = min(max(previous, lower), upper)
        if math.isinf(upper):  # endless: among the angles within a turn is the nearest one
            lower, upper = held - math.tau, held + math.tau
        vx, vy, omega = twist
        ux, uy = self.pivot_velocity(twist)
        speed = math.hypot(ux, uy)
        # No side slip is n . u = side; the rest of the pivot's speed is along the wheel, either way round.
        side = (omega + rate) * self.trail
        if speed <= REST_TOLERANCE * (abs(vx) + abs(vy) + abs(omega) * (abs(self.x) + abs(self.y))):
            return [Way(0, held, 0.0)] if abs(side) <= tolerance else []
        if abs(side) > speed + tolerance:
            return []
        along = math.sqrt(max((speed - side) * (speed + side), 0.0))
        found, beyond = [], []
        for direction in (1, -1):
            angle = math.atan2(uy, ux) - math.atan2(side, direction * along) - self.heading
            turns = range(math.floor((lower - angle) / math.tau), math.ceil((upper - angle) / math.tau) + 1)
            equivalent = [angle + turn * math.tau for turn in turns]
            inside = [min(max(a, lower), upper) for a in equivalent]
            pairs = list(zip(equivalent, inside, strict=True))
            allowed = [b for a, b in pairs if abs(a - b) <= ANGLE_TOLERANCE]
            found += [
                Way(direction, b, abs(b - held)) for b in sorted(allowed, key=lambda b: abs(b - held))[:1]
            ]
            beyond += [(abs(a - b), b, direction) for a, b in pairs]
        if found:
            return found
        # A pivot that hardly moves may stand at a limit: its slip there is rounding beside the fast wheels.
        _, angle, direction = min(beyond)
        slip = abs(float(self.rows(angle)[1] @ twist) - rate * self.trail)
        return [Way(direction, angle, abs(angle - held))] if slip <= tolerance else []


def choose(ways: Sequence[Sequence[Way]], rolling: Sequence[float]) -> list[Way]:
    """One way for each wheel, `rolling` [rad/s] now: the nearer, of two equally near the one forwards.

    Wheels whose two ways are about equally near are undecided and go together: as they roll already, else
    the way that is shorter for all of them. So angles about a quarter turn do not split the rover.
    """
    taken = [min(pair, key=lambda way: way.turn) for pair in ways]
    for i, pair in enumerate(ways):
        if len(pair) == 2 and abs(pair[0].turn - pair[1].turn) <= ANGLE_TOLERANCE:
            taken[i] = pair[0]
    undecided = [
        i for i, pair in enumerate(ways) if len(pair) == 2 and abs(pair[0].turn - pair[1].turn) < UNDECIDED
    ]
    speed = sum(rolling[i] for i in undecided)
    if speed == 0.0 and len({taken[i].direction for i in undecided}) < 2:
        return taken
    lead = sum(ways[i][0].turn - ways[i][1].turn for i in undecided)  # length by which backwards is shorter
    backwards = lead > ANGLE_TOLERANCE if speed == 0.0 else speed < 0.0
    for i in undecided:
        taken[i] = ways[i][int(backwards)]
    return taken
