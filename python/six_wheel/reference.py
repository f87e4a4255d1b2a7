"""The mathematics of the library in plain Python, to be read beside the design notes.

Nothing here is shared with the compiled core: this module is the oracle its tests compare with and the
yardstick of its benchmarks. Clarity comes first: batches are loops, and every vehicle is a list of wheels
with one wheel equation (`Wheel.rows`). x forward, y left, angles counter-clockwise, SI units; a twist is
``(vx, vy, omega)`` in body axes [m/s, m/s, rad/s], a pose ``(x, y, yaw)`` [m, m, rad].
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass, fields
from functools import cached_property
from itertools import combinations, pairwise, takewhile
from typing import Any, Literal, NamedTuple, Self, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Fit", "InfeasibleMotionError", "Rover", "UnderdeterminedError", "Wheel"]
__all__ += ["compose", "differentiate", "exp", "integrate", "log", "wrap_angle"]

Floats: TypeAlias = NDArray[np.float64]
Limit: TypeAlias = float | tuple[float, float] | None
MaybeArray: TypeAlias = ArrayLike | None
Keep: TypeAlias = Literal["curvature", "speed", "yaw_rate", "nearest"]
Method: TypeAlias = Literal["least_squares", "middle_wheels", "robust"]

SLIP_TOLERANCE = 1e-9  # side slip that passes as rounding, as a share of the fastest wheel pivot's speed
ANGLE_TOLERANCE = 1e-9  # a wheel so little past a limit stands at it, so close a tie is a tie [rad]
REST_TOLERANCE = 4.0 * math.ulp(1.0)  # a pivot is at rest below this share of what its velocity is the sum of
RANK_TOLERANCE = 1e-12  # singular values below this share of the largest are zero where faces meet


class InfeasibleMotionError(ValueError):
    """The rover cannot make this motion without side slip inside its steering limits."""


class UnderdeterminedError(ValueError):
    """The wheels do not determine the twist."""


def wrap_angle(angle: ArrayLike) -> Any:
    """Bring angles [rad] into [-pi, pi]; what lies there already is returned as it is. Any shape."""
    angles = _finite("angle", angle)
    wrapped = [a if abs(a) <= math.pi else math.remainder(a, math.tau) for a in angles.flat]
    return np.array(wrapped, dtype=float).reshape(angles.shape) if angles.ndim else float(wrapped[0])


def _rotate(angle: float, x: float, y: float) -> tuple[float, float]:
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * x - sin * y, sin * x + cos * y


def _compose(first: Floats, second: Floats) -> tuple[float, float, float]:
    dx, dy = _rotate(first[2], second[0], second[1])
    return first[0] + dx, first[1] + dy, first[2] + second[2]


def compose(first: ArrayLike, second: ArrayLike) -> Floats:
    """``a_from_c = a_from_b * b_from_c``: poses (..., 3) and (..., 3) -> (..., 3), yaw not wrapped."""
    return _rowwise(_compose, _finite("first", first), _finite("second", second))


def exp(twist: ArrayLike, dt: ArrayLike = 1.0) -> Floats:
    """Where holding a twist for `dt` [s] takes the body frame: (..., 3) -> (..., 3), yaw not wrapped."""

    def pose(row: Floats, step: Floats) -> tuple[float, float, float]:
        turn = row[2] * step[0]
        # The chord leaves at half the turn, and np.sinc(x) is sin(pi x) / (pi x): nothing cancels near zero.
        length = np.sinc(turn / math.tau) * step[0]
        return *_rotate(turn / 2.0, length * row[0], length * row[1]), turn

    return _rowwise(pose, _finite("twist", twist), _steps(dt))


def log(pose: ArrayLike, dt: ArrayLike = 1.0) -> Floats:
    """The constant twist that reaches a pose in `dt` [s] by the shortest turn: (..., 3) -> (..., 3)."""

    def twist(row: Floats, step: Floats) -> tuple[float, float, float]:
        turn = wrap_angle(row[2])
        length = np.sinc(turn / math.tau) * step[0]
        return *_rotate(-turn / 2.0, row[0] / length, row[1] / length), turn / step[0]

    return _rowwise(twist, _finite("pose", pose), _steps(dt))


def integrate(twists: ArrayLike, dt: ArrayLike, start: ArrayLike = (0.0, 0.0, 0.0)) -> Floats:
    """Hold twists (..., n, 3) for `dt` [s], scalar or (n,): poses (..., n + 1, 3), yaw not wrapped."""
    steps = exp(twists, dt)
    poses = np.empty((*steps.shape[:-2], steps.shape[-2] + 1, 3))
    for index in np.ndindex(steps.shape[:-2]):
        poses[(*index, 0)] = _finite("start", start)
        for k, step in enumerate(steps[index]):
            poses[(*index, k + 1)] = _compose(poses[(*index, k)], step)
    return poses


def differentiate(poses: ArrayLike, dt: ArrayLike) -> Floats:
    """The inverse of `integrate`: poses (..., n + 1, 3) -> twists (..., n, 3), each by the shortest turn."""

    def step(before: Floats, after: Floats) -> tuple[float, float, float]:
        x, y, turn = after - before
        return *_rotate(-before[2], x, y), turn

    rows = _finite("poses", poses)
    return log(_rowwise(step, rows[..., :-1, :], rows[..., 1:, :]), dt)


@dataclass(frozen=True)
class Wheel:
    """One wheel: pivot ``(x, y)`` [m] in body axes, `radius` [m], and whether it steers.

    The contact point lies `trail` behind the pivot and `scrub` to the left of it [m]. A steering angle is
    counted from `heading`; `steering_limit` is a half range, a pair (lower, upper) or None for +-pi/2 [rad].
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
        """
        cos, sin = math.cos(self.heading + angle), math.sin(self.heading + angle)
        rolling = [cos, sin, self.x * sin - self.y * cos - self.scrub]
        side = [-sin, cos, self.x * cos + self.y * sin - self.trail]
        return np.array(rolling), np.array(side)

    def steer(self, twist: Floats, previous: float, rate: float, tolerance: float) -> float | None:
        """The steering angle under which the wheel rolls, None if there is none inside the range.

        Of the equivalent angles the one nearest to `previous`, of two equally near the one driving forwards.
        """
        lower, upper = self.steering_range or (0.0, 0.0)
        held = min(max(previous, lower), upper)
        vx, vy, omega = twist
        ux, uy = self.pivot_velocity(twist)
        speed = math.hypot(ux, uy)
        # No side slip is n . u = side; the rest of the pivot's speed is along the wheel, either way round.
        side = (omega + rate) * self.trail
        if speed <= REST_TOLERANCE * (abs(vx) + abs(vy) + abs(omega) * (abs(self.x) + abs(self.y))):
            return held if abs(side) <= tolerance else None
        if abs(side) > speed + tolerance:
            return None
        along = math.sqrt(max((speed - side) * (speed + side), 0.0))
        choices = []  # (distance to the range, angle brought into the range, driving direction)
        for direction in (1, -1):
            angle = math.atan2(uy, ux) - math.atan2(side, direction * along) - self.heading
            turns = range(math.floor((lower - angle) / math.tau), math.ceil((upper - angle) / math.tau) + 1)
            for equivalent in (angle + turn * math.tau for turn in turns):
                inside = min(max(equivalent, lower), upper)
                choices.append((abs(equivalent - inside), inside, direction))
        allowed = [choice for choice in choices if choice[0] <= ANGLE_TOLERANCE]
        if allowed:
            nearest = min(abs(angle - held) for _, angle, _ in allowed)
            ties = [choice for choice in allowed if abs(choice[1] - held) <= nearest + ANGLE_TOLERANCE]
            return max(ties, key=lambda choice: choice[2])[1]
        # A pivot that hardly moves may stand at a limit: its slip there is rounding beside the fast wheels.
        _, angle, _ = min(choices)
        return angle if abs(float(self.rows(angle)[1] @ twist) - rate * self.trail) <= tolerance else None


class Fit(NamedTuple):
    """A twist (..., 3) fitted to wheel readings, and how well every wheel agrees with it."""

    twist: Floats
    residual: Floats  # (..., wheels) [m/s], length of what is left of the wheel's two rows
    rank: int | NDArray[np.int64]
    sigma_min: float | Floats  # smallest of the three singular values of the weighted rows
    weights: Floats  # (..., wheels)


@dataclass(frozen=True)
class Rover:
    """Wheels on one rigid body. Rows of a batch are independent; nothing is remembered between calls."""

    wheels: tuple[Wheel, ...]

    @classmethod
    def six_wheel(
        cls, d1: float, d2: float, d3: float, d4: float, wheel_radius: float, steering_limit: Limit = None
    ) -> Self:
        """Four steered corners: `d1`, `d4` half tracks, `d2`, `d3` centre to rear and front axle [m]."""
        middle: dict[str, Any] = {"radius": wheel_radius}
        corner = middle | {"steered": True, "steering_limit": steering_limit}
        axles = ("front", d3, d1, corner), ("middle", 0.0, d4, middle), ("rear", -d2, d1, corner)
        sides = ("left", 1.0), ("right", -1.0)
        return cls(tuple(Wheel(f"{a}_{b}", x, sign * y, **w) for a, x, y, w in axles for b, sign in sides))

    @classmethod
    def like(cls, other: Any) -> Self:
        """The same rover from any object whose `wheels` have the attributes of `Wheel`."""
        limits = {"steering_limit": "steering_range"}
        names = {field.name: limits.get(field.name, field.name) for field in fields(Wheel)}
        return cls(tuple(Wheel(**{k: getattr(w, name) for k, name in names.items()}) for w in other.wheels))

    @cached_property
    def steered(self) -> tuple[Wheel, ...]:
        """The wheels that steer, in order."""
        return tuple(wheel for wheel in self.wheels if wheel.steered)

    @cached_property
    def _banks(self) -> list[tuple[Floats, list[int]]]:
        """Unsteered wheels with parallel axles: the mean of their side-slip rows, and their indices."""
        fixed = {i: wheel.rows(0.0)[1] for i, wheel in enumerate(self.wheels) if not wheel.steered}
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
    def _limit_planes(self) -> list[Floats]:
        """Rows that are zero where a wheel rolls exactly at a limit: the faces of the admissible set."""
        narrow = [(w, w.steering_range) for w in self.steered if np.ptp(w.steering_range or ()) < math.pi]
        return [wheel.rows(angle)[1] for wheel, limits in narrow for angle in limits or ()]

    def inverse(
        self, twist: ArrayLike, previous: MaybeArray = None, steering_rates: MaybeArray = None
    ) -> tuple[Floats, Floats]:
        """Twists (..., 3) -> steering angles (..., steered) [rad] and wheel speeds (..., wheels) [rad/s].

        `previous` [rad] and `steering_rates` [rad/s] are (steered,) or (..., steered), 0 by default.
        Raises `InfeasibleMotionError` on a twist the rover cannot make, `ValueError` on NaN or infinity.
        """
        twists = _finite("twist", twist)
        lead = twists.shape[:-1]
        steering, speeds = np.empty((*lead, len(self.steered))), np.empty((*lead, len(self.wheels)))
        held = _or_zeros("previous", previous, steering.shape)
        rates = _or_zeros("steering_rates", steering_rates, steering.shape)
        for index in np.ndindex(lead):
            steering[index], speeds[index] = self._inverse(twists[index], held[index], rates[index])
        return steering, speeds

    def _inverse(self, twist: Floats, previous: Floats, rates: Floats) -> tuple[list[float], list[float]]:
        tolerance = SLIP_TOLERANCE * self._fastest_pivot(twist)
        if any(abs(float(row @ twist)) > tolerance for row, _ in self._banks):
            raise InfeasibleMotionError(f"twist must not make an unsteered wheel slip sideways, got {twist}")
        steering: list[float] = []
        speeds = []
        steer = iter(zip(previous, rates, strict=True))
        for wheel in self.wheels:
            angle, (held, rate) = 0.0, next(steer) if wheel.steered else (0.0, 0.0)
            if wheel.steered:
                found = wheel.steer(twist, held, rate, tolerance)
                if found is None:
                    raise InfeasibleMotionError(
                        f"twist must keep {wheel.name} inside its limits, got {twist}"
                    )
                steering.append(angle := found)
            speeds.append((float(wheel.rows(angle)[0] @ twist) - wheel.scrub * rate) / wheel.radius)
        return steering, speeds

    def _fastest_pivot(self, twist: Floats) -> float:
        return max(math.hypot(*wheel.pivot_velocity(twist)) for wheel in self.wheels)

    def forward(self, steering: ArrayLike, speeds: ArrayLike, steering_rates: MaybeArray = None) -> Floats:
        """The twist (..., 3) that fits all wheels best; `UnderdeterminedError` if they leave it open."""
        fit = self.fit(steering, speeds, steering_rates=steering_rates)
        if np.any(np.asarray(fit.rank) < 3):
            raise UnderdeterminedError(f"wheels must determine the twist, got rank {fit.rank}")
        return fit.twist

    def fit(
        self, steering: ArrayLike, speeds: ArrayLike, method: Method = "least_squares",
        steering_rates: MaybeArray = None
    ) -> Fit:  # fmt: skip
        """Least squares on both rows of every wheel: steering (..., steered), speeds (..., wheels) -> `Fit`.

        "middle_wheels" trusts the unsteered wheels alone, "robust" re-weights wheels by how well they agree.
        """
        if method not in get_args(Method):
            raise ValueError(f"method must be one of {', '.join(get_args(Method))}, got {method!r}")
        angles, rim = _finite("steering", steering), _finite("speeds", speeds)
        lead, wheels = np.broadcast_shapes(angles.shape[:-1], rim.shape[:-1]), len(self.wheels)
        angles = np.broadcast_to(angles, (*lead, len(self.steered)))
        rim = np.broadcast_to(rim, (*lead, wheels)) * [wheel.radius for wheel in self.wheels]
        rates = _or_zeros("steering_rates", steering_rates, angles.shape)
        fits = [self._fit(angles[i], rim[i], rates[i], method) for i in np.ndindex(lead)]
        if not lead:
            return fits[0]
        shapes = enumerate(((3,), (wheels,), (), (), (wheels,)))
        return Fit(*(np.array([fit[k] for fit in fits]).reshape(*lead, *shape) for k, shape in shapes))

    def _fit(self, angles: Floats, rim: Floats, rates: Floats, method: Method) -> Fit:
        a, b = np.empty((len(rim), 2, 3)), np.empty((len(rim), 2))
        ignored = [method == "middle_wheels" and wheel.steered for wheel in self.wheels]
        steer = iter(zip(angles, rates, strict=True))
        for i, wheel in enumerate(self.wheels):
            angle, rate = next(steer) if wheel.steered else (0.0, 0.0)
            a[i] = wheel.rows(angle)
            b[i] = rim[i] + wheel.scrub * rate, wheel.trail * rate
        for row, indices in self._banks:
            a[indices, 1] = row
        fit = _weighted(a, b, np.where(ignored, 0.0, 1.0))
        return _robust(a, b, fit, 0.01 * math.sqrt(float(np.mean(rim**2)))) if method == "robust" else fit

    def icr(self, twist: ArrayLike) -> Floats:
        """Instantaneous centre of rotation (..., 2) [m] in body axes; infinite when straight, NaN at rest."""

        def centre(row: Floats) -> tuple[float, float]:
            vx, vy, omega = row
            if omega != 0.0:
                return -vy / omega, vx / omega
            if vx == vy == 0.0:
                return math.nan, math.nan
            return -vy * math.inf if vy != 0.0 else 0.0, vx * math.inf if vx != 0.0 else 0.0

        return _rowwise(centre, _finite("twist", twist), width=2)

    def admissible(self, twist: ArrayLike) -> Any:
        """Whether each twist (..., 3) is possible without side slip and inside the steering limits."""
        rows = _finite("twist", twist)
        possible = np.array([self._admissible(rows[i]) for i in np.ndindex(rows.shape[:-1])], dtype=bool)
        return bool(possible[0]) if rows.ndim == 1 else possible.reshape(rows.shape[:-1])

    def _admissible(self, twist: Floats) -> bool:
        still = np.zeros(len(self.steered))
        try:
            self._inverse(twist, still, still)
        except InfeasibleMotionError:
            return False
        return True

    def project(self, twist: ArrayLike, keep: Keep = "curvature") -> Floats:
        """The next best twist the rover can make; an admissible one is returned unchanged.

        Nearest means the smallest mean square change of the wheel pivots' velocities. "speed" keeps vx,
        "yaw_rate" omega, "curvature" both, or else takes the nearest twist, scaled until neither has grown.
        For steered wheels with trail the result is admissible, but there may be a nearer one.
        """
        return _rowwise(lambda row: self._project(row, keep), _finite("twist", twist))

    def _project(self, twist: Floats, keep: Keep) -> Floats:
        if self._admissible(twist):
            return twist
        kept = {"curvature": [0, 2], "speed": [0], "yaw_rate": [2], "nearest": []}[keep]
        found = self._nearest(twist, kept)
        if found is not None:
            return found
        nearest = self._nearest(twist, [])
        if keep != "curvature" or nearest is None:
            raise InfeasibleMotionError(f"{keep} must be one the rover can keep, got twist {twist}")
        rounding = SLIP_TOLERANCE * self._fastest_pivot(nearest)
        grown = [k for k in (0, 2) if abs(nearest[k]) > abs(twist[k]) + rounding]
        return nearest * min([abs(twist[k] / nearest[k]) for k in grown], default=1.0)

    def _nearest(self, twist: Floats, kept: list[int]) -> Floats | None:
        """The nearest admissible twist with the components `kept` as they are, None if there is none.

        The nearest point of a set bounded by planes is the nearest point of one of its faces, and a face is
        where some of the planes meet; so meet them in every way and take the best that is admissible.
        """
        to_pivots = np.array([row for w in self.wheels for row in ([1.0, 0.0, -w.y], [0.0, 1.0, w.x])])
        zero = [row for row, _ in self._banks]
        faces = [[*zero, *face] for size in range(3) for face in combinations(self._limit_planes, size)]
        found = [_closest(twist, np.array(face).reshape(-1, 3), kept, to_pivots) for face in faces]
        found.append(np.zeros(3) if not np.any(twist[kept]) else None)
        possible = [point for point in found if point is not None and self._admissible(point)]
        return min(possible, key=lambda p: float(np.linalg.norm(to_pivots @ (p - twist))), default=None)

    @cached_property
    def min_radius(self) -> float:
        """All turns with |R| >= min_radius [m] are possible; R along the line of the unsteered wheels."""
        outside = takewhile(lambda turns: turns[1], reversed(self._turns))
        return min((inner for inner, _ in outside), default=math.inf)

    @cached_property
    def spin_radius(self) -> float:
        """All turns with |R| <= spin_radius [m] are possible; 0 if the rover cannot turn on the spot."""
        return next((inner for inner, possible in self._turns if not possible), math.inf)

    @cached_property
    def _turns(self) -> list[tuple[float, bool]]:
        """Where limits cut |R|, from 0 outwards, and whether all turns between there and the next cut go.

        The turns about the line of the unsteered wheels, else about the y axis, are ``R * along + spin``.
        """
        along, spin = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        if len(self._banks) > 1:
            return [(0.0, False)]
        for (x, y, turn), _ in self._banks:
            along, spin = np.array([y, -x, 0.0]), np.array([-x * turn, -y * turn, 1.0])
        cuts = {0.0} | {abs(float(p @ spin / (p @ along))) for p in self._limit_planes if p @ along != 0.0}
        for wheel in self.steered:
            # A trail can be held while the pivot is no slower than |trail * omega|, outside these two R.
            (cos, sin, _), (ux, uy) = along, wheel.pivot_velocity(spin)
            middle, across = -cos * ux - sin * uy, cos * uy - sin * ux
            if abs(across) <= abs(wheel.trail):
                half = math.sqrt(wheel.trail**2 - across**2)
                cuts |= {abs(middle - half), abs(middle + half)}
        edges = sorted(cuts)
        between = [(inner + outer) / 2.0 for inner, outer in pairwise(edges)] + [2.0 * edges[-1] + 1.0]
        both = [self._admissible(r * along + spin) and self._admissible(-r * along + spin) for r in between]
        return list(zip(edges, both, strict=True))


def _weighted(a: Floats, b: Floats, weights: Floats) -> Fit:
    """Rows `a` (wheels, 2, 3), readings `b` (wheels, 2): the twist of least weighted squares."""
    root = np.sqrt(weights)
    rows, readings = (a * root[:, None, None]).reshape(-1, 3), (b * root[:, None]).ravel()
    twist, _, rank, sigma = np.linalg.lstsq(rows, readings, rcond=None)
    residual = np.array([math.hypot(*row) for row in a @ twist - b])
    return Fit(
        np.asarray(twist, dtype=float),
        residual,
        int(rank),
        float(sigma[2]) if len(sigma) == 3 else 0.0,
        weights,
    )


def _robust(a: Floats, b: Floats, fit: Fit, least: float) -> Fit:
    """Iteratively re-weighted least squares with the Geman-McClure loss on the residual of each wheel.

    The scale starts where every wheel has a say, at the largest residual, and is halved down to the noise:
    three times the median residual, or `least`. It never grows again, so the steps converge.
    """
    scale = max(float(np.max(fit.residual)), least)
    for _ in range(100):
        scale = min(scale, max(0.5 * scale, 3.0 * float(np.median(fit.residual)), least))
        if scale == 0.0:
            break
        weights = 1.0 / (1.0 + (fit.residual / scale) ** 2) ** 2
        change = float(np.max(np.abs(weights - fit.weights)))
        fit = _weighted(a, b, weights)
        if change <= 1e-12:
            break
    return fit


def _closest(twist: Floats, zero: Floats, kept: list[int], metric: Floats) -> Floats | None:
    """The twist nearest in ``|metric @ .|`` where the rows `zero` vanish and the components `kept` stay."""
    # Sums of columns of `free` are free of slip to rounding of their own size, however small that is.
    free = _null_space(zero)
    start = free @ np.linalg.lstsq(free[kept], twist[kept], rcond=RANK_TOLERANCE)[0]
    if np.any(np.abs(start - twist)[kept] > RANK_TOLERANCE * np.max(np.abs(twist[kept]), initial=0.0)):
        return None
    within = free @ _null_space(free[kept])
    found = start + within @ np.linalg.lstsq(metric @ within, metric @ (twist - start), rcond=None)[0]
    found[kept] = twist[kept]
    return np.asarray(found)


def _null_space(rows: Floats) -> Floats:
    """Columns that span what `rows` map to zero."""
    _, sigma, basis = np.linalg.svd(rows)
    return np.asarray(basis[np.sum(sigma > RANK_TOLERANCE * np.max(sigma, initial=0.0)) :].T)


def _finite(name: str, values: ArrayLike) -> Floats:
    array = np.asarray(values, dtype=float)
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name} must be finite, got {array[~np.isfinite(array)][0]}")
    return array


def _steps(dt: ArrayLike) -> Floats:
    steps = _finite("dt", dt)
    if np.any(steps <= 0.0):
        raise ValueError(f"dt must be positive, got {np.min(steps)}")
    return steps[..., None]  # an axis of length 1, to stand beside rows


def _or_zeros(name: str, values: MaybeArray, shape: tuple[int, ...]) -> Floats:
    return np.zeros(shape) if values is None else np.broadcast_to(_finite(name, values), shape)


def _rowwise(function: Callable[..., Sequence[float] | Floats], *arrays: Floats, width: int = 3) -> Floats:
    """`function` of the last axes of `arrays`, over their leading axes broadcast together."""
    lead = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
    spread = [np.broadcast_to(array, (*lead, array.shape[-1])) for array in arrays]
    rows = [function(*(array[i] for array in spread)) for i in np.ndindex(lead)]
    return np.array(rows, dtype=float).reshape(*lead, width)
