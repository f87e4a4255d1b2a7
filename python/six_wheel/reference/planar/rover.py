"""A rover: a list of wheels and what follows from the wheel equation of each."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from functools import cached_property
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.planar import estimate
from six_wheel.reference.planar import mobility as degrees
from six_wheel.reference.planar.admissible import SLIP_TOLERANCE, AdmissibleSet, Keep, fastest_pivot
from six_wheel.reference.planar.estimate import TwistFit
from six_wheel.reference.planar.geometry import Floats, MaybeArray, finite, or_zeros, rowwise
from six_wheel.reference.planar.layouts import Layout
from six_wheel.reference.planar.wheels import (
    ANGLE_TOLERANCE,
    InfeasibleMotionError,
    UnderdeterminedError,
    choose,
)

Method: TypeAlias = Literal["least_squares", "middle_wheels", "robust"]


class Rover(Layout):
    """Wheels on one rigid body. Rows of a batch are independent; nothing is remembered between calls."""

    @cached_property
    def _banks(self) -> list[tuple[Floats, list[int]]]:
        """Unsteered wheels with parallel axles: the mean of their side-slip rows, and their indices."""
        walls = [i for i, wheel in enumerate(self.wheels) if wheel.fixed and wheel.roller_angle is None]
        fixed = {i: self.wheels[i].rows(0.0)[1] for i in walls}
        banks = []
        while fixed:
            a, b, _ = next(iter(fixed.values()))
            bank = [i for i, row in fixed.items() if abs(a * row[1] - b * row[0]) <= ANGLE_TOLERANCE]
            rows = [fixed.pop(i) for i in bank]
            # Wheels of a bank may point opposite ways; turn their rows the same way round.
            aligned = [row * math.copysign(1.0, a * row[0] + b * row[1]) for row in rows]
            banks.append((np.mean(aligned, axis=0), bank))
        return banks

    @cached_property
    def _shared_rows(self) -> dict[int, Floats]:
        """Side-slip rows of the unsteered wheels: the mean over all about as they point.

        The say of a wheel in the row of another is 1 if their axles are parallel; it falls smoothly to 0 at
        10 degrees.
        """
        walls = [i for i, wheel in enumerate(self.wheels) if wheel.fixed and wheel.roller_angle is None]
        rows = np.array([self.wheels[i].rows(0.0)[1] for i in walls]).reshape(-1, 3)
        sines = np.outer(rows[:, 0], rows[:, 1]) - np.outer(rows[:, 1], rows[:, 0])
        says = np.maximum(1.0 - (sines / math.sin(math.radians(10))) ** 2, 0.0) ** 2
        ways = np.where(rows[:, :2] @ rows[:, :2].T < 0.0, -1.0, 1.0)
        means = (says * ways) @ rows / says.sum(axis=1, keepdims=True)
        return dict(zip(walls, means, strict=True))

    def inverse(
        self,
        twist: ArrayLike,
        previous: MaybeArray = None,
        steering_rates: MaybeArray = None,
        centre: ArrayLike = (0.0, 0.0),
        previous_wheel_speeds: MaybeArray = None,
    ) -> tuple[Floats, Floats]:
        """Twists (..., 3) -> steering angles (..., steered) [rad] and wheel speeds (..., wheels) [rad/s].

        `twist` is that of the point `centre` (2,) or (..., 2) [m]. `previous` [rad] and `steering_rates`
        [rad/s] are (steered,) or (..., steered), `previous_wheel_speeds` [rad/s] (wheels,) or (...,
        wheels); 0 by default.
        Raises `InfeasibleMotionError` on a twist the rover cannot make, `ValueError` on NaN or infinity.
        """
        twists = rowwise(_moved, finite("twist", twist), finite("centre", centre))
        lead = twists.shape[:-1]
        steering, wheel_speeds = np.empty((*lead, len(self.steered))), np.empty((*lead, len(self.wheels)))
        held = or_zeros("previous", previous, steering.shape)
        rates = or_zeros("steering_rates", steering_rates, steering.shape)
        rolling = or_zeros("previous_wheel_speeds", previous_wheel_speeds, wheel_speeds.shape)
        for i in np.ndindex(lead):
            steering[i], wheel_speeds[i] = self._inverse(twists[i], held[i], rates[i], rolling[i])
        return steering, wheel_speeds

    def _inverse(
        self, twist: Floats, previous: Floats, rates: Floats, rolling: Floats
    ) -> tuple[list[float], list[float]]:
        tolerance = SLIP_TOLERANCE * fastest_pivot(self.wheels, twist)
        if any(abs(float(row @ twist)) > tolerance for row, _ in self._banks):
            raise InfeasibleMotionError(f"twist must not make an unsteered wheel slip sideways, got {twist}")
        ways = []
        for wheel, held, rate in zip(self.steered, previous, rates, strict=True):
            ways.append(wheel.ways(twist, held, rate, tolerance))
            if not ways[-1]:
                raise InfeasibleMotionError(f"twist must keep {wheel.name} inside its limits, got {twist}")
        taken = choose(
            ways, [speed for speed, wheel in zip(rolling, self.wheels, strict=True) if wheel.steered]
        )
        steering = [way.angle for way in taken]
        steer = iter(zip(steering, rates, strict=True))
        rim = []
        for wheel in self.wheels:
            angle, rate = next(steer) if wheel.steered else (0.0, 0.0)
            rolled = float(wheel.rows(angle)[0] @ twist) - wheel.scrub * rate
            rim.append(wheel.trailing_rim_speed(twist) if wheel.castor else rolled)
        return steering, [speed / wheel.radius for speed, wheel in zip(rim, self.wheels, strict=True)]

    def forward(
        self,
        steering: MaybeArray,
        wheel_speeds: ArrayLike,
        steering_rates: MaybeArray = None,
        allow_underdetermined: bool = False,
    ) -> Floats:
        """The twist (..., 3) that fits all wheels best; `UnderdeterminedError` if they leave it open."""
        fit = self.fit(steering, wheel_speeds, steering_rates=steering_rates)
        if np.any(np.asarray(fit.rank) < 3) and not allow_underdetermined:
            raise UnderdeterminedError(f"wheels must determine the twist, got rank {fit.rank}")
        return fit.twist

    def fit(
        self, steering: MaybeArray, wheel_speeds: ArrayLike, method: Method = "least_squares",
        steering_rates: MaybeArray = None
    ) -> TwistFit:  # fmt: skip
        """Least squares on the rows of every wheel; steering (..., steered), speeds (..., wheels).

        "middle_wheels" trusts the unsteered wheels alone, "robust" re-weights wheels by how well they agree.
        Of the twists that fit equally well it is the one with the least mean square velocity of the pivots.
        The speed of a wheel without a motor may be NaN; that it does not slip sideways is a reading still.
        """
        if method not in get_args(Method):
            raise ValueError(f"method must be one of {', '.join(get_args(Method))}, got {method!r}")
        if method == "middle_wheels" and not any(wheel.fixed for wheel in self.wheels):
            raise ValueError(
                "method must be another one for a rover without unsteered wheels, got 'middle_wheels'"
            )
        silent = [not wheel.driven or wheel.castor for wheel in self.wheels]
        rim = np.asarray(wheel_speeds, dtype=float) * [wheel.radius for wheel in self.wheels]
        finite("wheel_speeds", np.where(np.isnan(rim) & silent, 0.0, rim))
        angles = np.zeros((*rim.shape[:-1], 0)) if steering is None else finite("steering", steering)
        lead, wheels = np.broadcast_shapes(angles.shape[:-1], rim.shape[:-1]), len(self.wheels)
        angles = np.broadcast_to(angles, (*lead, len(self.steered)))
        rim = np.broadcast_to(rim, (*lead, wheels))
        rates = or_zeros("steering_rates", steering_rates, angles.shape)
        fits = [self._fit(angles[i], rim[i], rates[i], method) for i in np.ndindex(lead)]
        if not lead:
            return fits[0]
        shapes = enumerate(((3,), (wheels,), (), (), (wheels,)))
        return TwistFit(*(np.array([fit[k] for fit in fits]).reshape(*lead, *shape) for k, shape in shapes))

    def equations(self, angles: Floats, rim: Floats, rates: Floats) -> tuple[Floats, Floats]:
        """Rows (wheels, 2, 3) and readings (wheels, 2) of every wheel; what was not read is NaN."""
        a, b = np.empty((len(rim), 2, 3)), np.zeros((len(rim), 2))
        steer = iter(zip(angles, rates, strict=True))
        for i, wheel in enumerate(self.wheels):
            angle, rate = next(steer) if wheel.steered else (0.0, 0.0)
            a[i] = wheel.rows(angle)
            if not wheel.castor:
                b[i] = rim[i] + wheel.scrub * rate, wheel.trail * rate
        for i, row in self._shared_rows.items():
            a[i, 1] = row
        return a, b

    def _fit(self, angles: Floats, rim: Floats, rates: Floats, method: Method) -> TwistFit:
        a, b = self.equations(angles, rim, rates)
        unread = np.isnan(b[:, 0])
        a[unread, 0] = b[unread, 0] = 0.0
        trusted = [wheel.fixed or method != "middle_wheels" for wheel in self.wheels]
        fit = estimate.weighted(a, b, np.where(trusted, 1.0, 0.0), self._metric)
        castor = [wheel.castor for wheel in self.wheels]
        least = 0.01 * math.sqrt(float(np.mean(np.where(unread | castor, 0.0, rim) ** 2)))
        return estimate.robust(a, b, fit, self._metric, least) if method == "robust" else fit

    @cached_property
    def _metric(self) -> Floats:
        """``|metric @ twist|`` is the root mean square of the pivots' velocities."""
        pivots = np.array([(wheel.x, wheel.y) for wheel in self.wheels])
        x, y = pivots.mean(axis=0)
        size = math.sqrt(float(np.mean(np.sum((pivots - (x, y)) ** 2, axis=1)))) or self.wheels[0].radius
        return np.array([[1.0, 0.0, -y], [0.0, 1.0, x], [0.0, 0.0, size]])

    def mobility(self, steering: MaybeArray = None) -> degrees.Mobility:
        """Mobility at steering angles (steered,) [rad]; by default at those of some turn.

        Unsteered wheels with parallel axles count with their mean axle.
        """
        if steering is None:
            size = self._metric[2, 2]
            steering, _ = self.inverse(self.project((1.0, 0.0, 0.1 / size), keep="nearest"))
        angles = finite("steering", steering).reshape(len(self.steered))
        fixed = [row for row, bank in self._banks for _ in bank]
        steered = [wheel.rows(angle)[1] for wheel, angle in zip(self.steered, angles, strict=True)]
        return degrees.mobility(np.reshape(fixed, (-1, 3)), np.reshape(steered, (-1, 3)))

    def icr(self, twist: ArrayLike) -> Floats:
        """Instantaneous centre of rotation (..., 2) [m] in body axes; infinite when straight, NaN at rest."""

        def centre(row: Floats) -> tuple[float, float]:
            vx, vy, omega = row
            if omega != 0.0:
                return -vy / omega, vx / omega
            if vx == vy == 0.0:
                return math.nan, math.nan
            return -vy * math.inf if vy != 0.0 else 0.0, vx * math.inf if vx != 0.0 else 0.0

        return rowwise(centre, finite("twist", twist), width=2)

    def admissible(self, twist: ArrayLike) -> Any:
        """True for each twist (..., 3) that is possible without side slip and inside the steering limits."""
        rows = finite("twist", twist)
        possible = np.array([self._possible(rows[i]) for i in np.ndindex(rows.shape[:-1])], dtype=bool)
        return bool(possible[0]) if rows.ndim == 1 else possible.reshape(rows.shape[:-1])

    def _possible(self, twist: Floats) -> bool:
        still = np.zeros(len(self.steered))
        try:
            self._inverse(twist, still, still, np.zeros(len(self.wheels)))
        except InfeasibleMotionError:
            return False
        return True

    @cached_property
    def _admissible_set(self) -> AdmissibleSet:
        return AdmissibleSet(self.wheels, [row for row, _ in self._banks], self._possible)

    def project(self, twist: ArrayLike, keep: Keep = "curvature") -> Floats:
        """The next best twist the rover can make; an admissible one is returned unchanged.

        Nearest means the smallest mean square change of the wheel pivots' velocities. "speed" keeps vx,
        "yaw_rate" omega, "curvature" both, or else takes the nearest twist, scaled until neither has grown.
        For steered wheels with trail the result is admissible, but there may be a nearer one.
        """
        return rowwise(lambda row: self._admissible_set.project(row, keep), finite("twist", twist))

    @property
    def min_radius(self) -> float:
        """All turns with ``|R| >= min_radius`` [m] are possible; R along the line of the unsteered wheels."""
        return self._admissible_set.min_radius

    @property
    def spin_radius(self) -> float:
        """All turns with ``|R| <= spin_radius`` [m] are possible; 0 if the rover cannot turn on the spot."""
        return self._admissible_set.spin_radius


def _moved(twist: Floats, centre: Floats) -> tuple[float, float, float]:
    """The twist of the origin, from the velocity of another point of the body."""
    vx, vy, omega = twist
    return vx + omega * centre[1], vy - omega * centre[0], omega
