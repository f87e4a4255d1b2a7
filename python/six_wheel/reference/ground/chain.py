"""A suspension as data: links that turn about axes, and wheels mounted on them.

A joint coordinate may turn several links, each with its own factor: a differential is the coordinate rho that
turns the left rocker by rho and the right one by -rho. Everything else follows from the two lists.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.planar.geometry import Floats


@dataclass(frozen=True)
class Link:
    """A body that turns against its parent by ``factors . joints`` about an axis."""

    parent: int | None  # index of a link before it; None is the rover's body
    pivot: tuple[float, float, float]  # a point of the axis, in the body's axes with all joints at 0 [m]
    axis: tuple[float, float, float]  # unit vector, the same
    factors: tuple[float, ...]  # one per joint coordinate


@dataclass(frozen=True)
class Wheel:
    """A circle on a link; steered, it turns about the link's own z through its centre."""

    link: int | None
    centre: tuple[float, float, float]  # in the body's axes with all joints at 0 [m]
    radius: float
    steered: bool = False


@dataclass(frozen=True)
class Chain:
    """Links, parents first; wheels in the order of every array; limits of the joint coordinates [rad]."""

    links: tuple[Link, ...]
    wheels: tuple[Wheel, ...]
    limits: tuple[tuple[float, float], ...]

    @property
    def steered(self) -> list[int]:
        """Indices of the wheels that steer, in the order of their angles."""
        return [k for k, wheel in enumerate(self.wheels) if wheel.steered]


def axis_turn(axis: ArrayLike, angle: float) -> Floats:
    """The rotation about a unit axis (Rodrigues)."""
    x, y, z = np.asarray(axis, float)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: Floats = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return turned


class Posture:
    """Places and directions of all wheels at joint and steering angles, in the body's axes.

    `centres`, `forward`, `up` and `axle` are (wheels, 3); `levers` (wheels, joints, 3) moves the centres with
    the joints [m/rad], `turns` (wheels, joints, 3) turns their links [rad/rad], `mounts` are the axes about
    which the wheels steer.
    """

    def __init__(self, chain: Chain, joints: ArrayLike, steering: ArrayLike | None = None) -> None:
        """Composes the chain."""
        angles = np.asarray(joints, float)
        psi = np.zeros(len(chain.wheels))
        if steering is not None:
            psi[chain.steered] = steering
        rotations: list[Floats] = []
        pivots: list[Floats] = []
        for link in chain.links:
            parent = np.eye(3) if link.parent is None else rotations[link.parent]
            rotations.append(parent @ axis_turn(link.axis, float(np.dot(link.factors, angles))))
            pivots.append(self._place(chain, link.parent, link.pivot, rotations, pivots))
        count, joints_count = len(chain.wheels), len(angles)
        self.chain = chain
        self.centres, self.mounts = np.zeros((count, 3)), np.zeros((count, 3))
        self.forward, self.up, self.axle = (np.zeros((count, 3)) for _ in range(3))
        self.levers, self.turns = (np.zeros((count, joints_count, 3)) for _ in range(2))
        for k, wheel in enumerate(chain.wheels):
            rotation = np.eye(3) if wheel.link is None else rotations[wheel.link]
            self.centres[k] = self._place(chain, wheel.link, wheel.centre, rotations, pivots)
            turn = rotation @ axis_turn((0, 0, 1), psi[k])
            self.forward[k], self.axle[k], self.up[k] = turn.T
            self.mounts[k] = rotation[:, 2]
            at = wheel.link
            while at is not None:
                link = chain.links[at]
                axis = rotations[at] @ np.asarray(link.axis, float)
                for j, factor in enumerate(link.factors):
                    self.turns[k, j] += factor * axis
                    self.levers[k, j] += factor * np.cross(axis, self.centres[k] - pivots[at])
                at = link.parent

    @staticmethod
    def _place(
        chain: Chain, link: int | None, point: ArrayLike, rotations: list[Floats], pivots: list[Floats]
    ) -> Floats:
        """Place of a point that is fixed to a link [m]."""
        if link is None:
            return np.asarray(point, float)
        away = np.asarray(point, float) - np.asarray(chain.links[link].pivot, float)
        place: Floats = pivots[link] + rotations[link] @ away
        return place


def rocker_bogie(
    *,
    rocker_pivot: Sequence[float],
    rocker_to_bogie: Sequence[float],
    bogie_to_middle: Sequence[float],
    wheel_radius: float,
    rocker_to_front: Sequence[float] | None = None,
    bogie_to_rear: Sequence[float] | None = None,
    rocker_to_rear: Sequence[float] | None = None,
    bogie_to_front: Sequence[float] | None = None,
    steered: str = "corners",
    rocker_limit: tuple[float, float] = (-math.inf, math.inf),
    bogie_limit: tuple[float, float] = (-math.inf, math.inf),
) -> Chain:
    """Six wheels, front to rear, left before right; the bogie behind the rocker's joint or in front of it.

    Dimensions are those of the left-hand side with all joints at 0 [m]. The coordinates are rho, by which the
    left rocker turns about +y and the right one back, and the bogies' beta_1 (left) and beta_2 (right).
    """
    wheels: list[Wheel] = []
    links: list[Link] = []
    steering = {"front": (0, 1), "corners": (0, 1, 4, 5), "all": range(6), "none": ()}[steered]
    for side, sign in enumerate((1.0, -1.0)):
        mirror = np.array([1.0, sign, 1.0])
        pivot = np.asarray(rocker_pivot, float) * mirror
        joint = pivot + np.asarray(rocker_to_bogie, float) * mirror
        links += [
            Link(None, tuple(pivot), (0, 1, 0), (sign, 0, 0)),
            Link(2 * side, tuple(joint), (0, 1, 0), (0, 1.0 - side, float(side))),
        ]
        on_rocker = (rocker_to_front, None, rocker_to_rear)
        on_bogie = (bogie_to_front, bogie_to_middle, bogie_to_rear)
        for row, (rocker, bogie) in enumerate(zip(on_rocker, on_bogie, strict=True)):
            link, start, arm = (
                (2 * side, pivot, rocker) if rocker is not None else (2 * side + 1, joint, bogie)
            )
            centre = start + np.asarray(arm, float) * mirror
            wheels.append(Wheel(link, tuple(centre), wheel_radius, 2 * row + side in steering))
    ordered = tuple(wheels[row + 3 * side] for row in range(3) for side in (0, 1))
    return Chain(tuple(links), ordered, (rocker_limit, bogie_limit, bogie_limit))
