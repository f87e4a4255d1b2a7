"""Set of the twists that a rover can make, and the nearest of them to one that it cannot.

The unsteered wheels leave a subspace of twists. Each narrow steering range leaves a double wedge of it,
between the two planes on which the wheel rolls exactly at a limit. The admissible set is their intersection.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise, takewhile
from typing import Literal, TypeAlias

import numpy as np

from six_wheel.reference.planar.geometry import Floats
from six_wheel.reference.planar.wheels import InfeasibleMotionError, Wheel

Keep: TypeAlias = Literal["curvature", "speed", "yaw_rate", "nearest"]

SLIP_TOLERANCE = 1e-9  # side slip that passes as rounding, as a share of the fastest wheel pivot's speed
RANK_TOLERANCE = 1e-12  # singular values below this share of the largest are zero where faces meet


@dataclass(frozen=True)
class AdmissibleSet:
    """The twists some wheels allow: the rows `zero` vanish, and each steered wheel is within its range."""

    wheels: tuple[Wheel, ...]
    zero: list[Floats]
    contains: Callable[[Floats], bool]

    @cached_property
    def _steered(self) -> list[Wheel]:
        return [wheel for wheel in self.wheels if wheel.steered]

    @cached_property
    def _limit_planes(self) -> list[Floats]:
        """Rows that are zero where a wheel rolls exactly at a limit: the faces of the admissible set."""
        narrow = [(w, w.steering_range) for w in self._steered if np.ptp(w.steering_range or ()) < math.pi]
        return [wheel.rows(angle)[1] for wheel, limits in narrow for angle in limits or ()]

    def project(self, twist: Floats, keep: Keep) -> Floats:
        """The next best twist: as `Rover.project` says."""
        if self.contains(twist):
            return twist
        kept = {"curvature": [0, 2], "speed": [0], "yaw_rate": [2], "nearest": []}[keep]
        found = self._nearest(twist, kept)
        if found is not None:
            return found
        nearest = self._nearest(twist, [])
        if keep != "curvature" or nearest is None:
            raise InfeasibleMotionError(f"{keep} must be one the rover can keep, got twist {twist}")
        rounding = SLIP_TOLERANCE * fastest_pivot(self.wheels, nearest)
        grown = [k for k in (0, 2) if abs(nearest[k]) > abs(twist[k]) + rounding]
        return nearest * min([abs(twist[k] / nearest[k]) for k in grown], default=1.0)

    def _nearest(self, twist: Floats, kept: list[int]) -> Floats | None:
        """The nearest admissible twist with the components `kept` as they are, None if there is none.

        The nearest point of a set bounded by planes is the nearest point of one of its faces, and a face is
        where some of the planes meet; so meet them in every way and take the best that is admissible.
        """
        to_pivots = np.array([row for w in self.wheels for row in ([1.0, 0.0, -w.y], [0.0, 1.0, w.x])])
        faces = [[*self.zero, *face] for size in range(3) for face in combinations(self._limit_planes, size)]
        found = [_closest(twist, np.array(face).reshape(-1, 3), kept, to_pivots) for face in faces]
        found.append(np.zeros(3) if not np.any(twist[kept]) else None)
        possible = [point for point in found if point is not None and self.contains(point)]
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
        """Cuts of |R| by the limits, from 0 outwards; True if all turns up to the next cut are possible.

        The turns about the line of the unsteered wheels, else about the y axis, are ``R * along + spin``.
        """
        along, spin = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        if len(self.zero) > 1:
            return [(0.0, False)]
        for x, y, turn in self.zero:
            along, spin = np.array([y, -x, 0.0]), np.array([-x * turn, -y * turn, 1.0])
        # Wide ranges cut too, where a trail holds the wheel back; too many cuts do no harm.
        ranges = [(wheel, angle) for wheel in self._steered for angle in wheel.steering_range or ()]
        ends = [wheel.rows(angle)[1] for wheel, angle in ranges if math.isfinite(angle)]
        cuts = {0.0} | {abs(float(end @ spin / (end @ along))) for end in ends if end @ along != 0.0}
        for wheel in self._steered:
            # A trail can be held while the pivot is no slower than |trail * omega|, outside these two R.
            (cos, sin, _), (ux, uy) = along, wheel.pivot_velocity(spin)
            middle, across = -cos * ux - sin * uy, cos * uy - sin * ux
            if abs(across) <= abs(wheel.trail):
                half = math.sqrt(wheel.trail**2 - across**2)
                cuts |= {abs(middle - half), abs(middle + half)}
        edges = sorted(cuts)
        between = [(inner + outer) / 2.0 for inner, outer in pairwise(edges)] + [2.0 * edges[-1] + 1.0]
        both = [self.contains(r * along + spin) and self.contains(-r * along + spin) for r in between]
        return list(zip(edges, both, strict=True))


def fastest_pivot(wheels: tuple[Wheel, ...], twist: Floats) -> float:
    """Speed of the fastest wheel pivot [m/s]."""
    return max(math.hypot(*wheel.pivot_velocity(twist)) for wheel in wheels)


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
