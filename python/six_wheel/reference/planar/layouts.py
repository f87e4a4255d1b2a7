"""The named vehicles: each is a list of wheels and nothing else."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Literal, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.planar.geometry import finite
from six_wheel.reference.planar.wheels import Limit, Wheel

Driven: TypeAlias = Literal["front", "rear", "all"]

SIDES = ("left", 1.0), ("right", -1.0)


@dataclass(frozen=True)
class Layout:
    """Wheels on one rigid body, in the order of every array."""

    wheels: tuple[Wheel, ...]

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

    @classmethod
    def six_wheel(
        cls,
        *,
        front_to_middle: float,
        middle_to_rear: float,
        track_width: float,
        middle_track_width: float | None = None,
        wheel_radius: float,
        steering_limit: Limit = None,
    ) -> Self:
        """Four steered corners; the origin is between the middle wheels."""
        half = track_width / 2.0
        inner = half if middle_track_width is None else middle_track_width / 2.0
        middle: dict[str, Any] = {"radius": wheel_radius}
        corner = middle | {"steered": True, "steering_limit": steering_limit}
        axles = (
            ("front", front_to_middle, half, corner),
            ("middle", 0.0, inner, middle),
            ("rear", -middle_to_rear, half, corner),
        )
        return cls(tuple(Wheel(f"{a}_{b}", x, sign * y, **w) for a, x, y, w in axles for b, sign in SIDES))

    @classmethod
    def swerve(cls, positions: ArrayLike, wheel_radius: float, *, steering_limit: Limit = None) -> Self:
        """Every wheel steered, endlessly without a limit, at `positions` (n, 2) [m]."""
        limit = math.inf if steering_limit is None else steering_limit
        module: dict[str, Any] = {"radius": wheel_radius, "steered": True, "steering_limit": limit}
        rows = enumerate(finite("positions", positions).tolist())
        return cls(tuple(Wheel(f"module_{i}", x, y, **module) for i, (x, y) in rows))

    @classmethod
    def differential(
        cls,
        track_width: float,
        wheel_radius: float | tuple[float, float],
        *,
        wheels_per_side: int = 1,
        wheelbase: float = 0.0,
        icr_left: float | None = None,
        icr_right: float | None = None,
        icr_forward: float = 0.0,
    ) -> Self:
        """Fixed wheels on two sides; where the ground lets a tread skid, its centre of rotation is given.

        A tread at y whose centre of rotation is ``(x_c, y_c)`` rolls like a wheel with its contact there:
        scrub ``y_c - y``, trail ``-x_c``.
        """
        half = track_width / 2.0
        radii = np.broadcast_to(wheel_radius, 2).tolist()
        centres = (half if icr_left is None else icr_left, -half if icr_right is None else icr_right)
        names = {1: [""], 2: ["front_", "rear_"], 3: ["front_", "middle_", "rear_"]}
        axles = names.get(wheels_per_side, [f"axle_{i}_" for i in range(wheels_per_side)])
        stations = (
            np.linspace(wheelbase / 2.0, -wheelbase / 2.0, wheels_per_side) if len(axles) > 1 else [0.0]
        )
        return cls(
            tuple(
                Wheel(
                    f"{axle}{side}",
                    float(x),
                    sign * half,
                    radius=r,
                    scrub=c - sign * half,
                    trail=-icr_forward,
                )
                for axle, x in zip(axles, stations, strict=True)
                for (side, sign), r, c in zip(SIDES, radii, centres, strict=True)
            )
        )

    @classmethod
    def tracked(cls, track_width: float, wheel_radius: float | tuple[float, float], **centres: Any) -> Self:
        """A left and a right track, each a wheel with the radius of its sprocket."""
        return cls.differential(track_width, wheel_radius, **centres)

    @classmethod
    def ackermann(
        cls,
        wheelbase: float,
        track_width: float,
        wheel_radius: float,
        *,
        steering_limit: Limit = None,
        driven: Driven = "rear",
    ) -> Self:
        """A car: two steered front wheels, two fixed rear wheels, origin between the rear ones."""
        pair = [(f"_{side}", sign * track_width / 2.0) for side, sign in SIDES]
        return cls(_car(wheelbase, wheel_radius, steering_limit, driven, pair, pair))

    @classmethod
    def tricycle(
        cls,
        wheelbase: float,
        track_width: float,
        wheel_radius: float,
        *,
        steering_limit: Limit = None,
        driven: Driven = "front",
    ) -> Self:
        """One steered front wheel, two fixed rear wheels, origin between the rear ones."""
        pair = [(f"_{side}", sign * track_width / 2.0) for side, sign in SIDES]
        return cls(_car(wheelbase, wheel_radius, steering_limit, driven, [("", 0.0)], pair))

    @classmethod
    def bicycle(
        cls, wheelbase: float, wheel_radius: float, *, steering_limit: Limit = None, driven: Driven = "rear"
    ) -> Self:
        """A steered front wheel, a fixed rear wheel, origin at the rear one."""
        return cls(_car(wheelbase, wheel_radius, steering_limit, driven, [("", 0.0)], [("", 0.0)]))

    @classmethod
    def mecanum(
        cls,
        wheelbase: float,
        track_width: float,
        wheel_radius: float,
        *,
        roller_angle: float = math.pi / 4.0,
    ) -> Self:
        """Four fixed wheels; the axes of the rollers on the ground form a diamond about the middle."""
        return cls(
            tuple(
                Wheel(
                    f"{axle}_{side}",
                    ahead * wheelbase / 2.0,
                    left * track_width / 2.0,
                    radius=wheel_radius,
                    roller_angle=-ahead * left * roller_angle,
                )
                for axle, ahead in (("front", 1.0), ("rear", -1.0))
                for side, left in SIDES
            )
        )

    @classmethod
    def omni(
        cls,
        positions: ArrayLike,
        headings: ArrayLike,
        wheel_radius: float,
        *,
        roller_angle: float = math.pi / 2.0,
    ) -> Self:
        """Fixed wheels with rollers at `positions` (n, 2) [m], driving in the directions `headings` [rad]."""
        places = zip(
            finite("positions", positions).tolist(), finite("headings", headings).tolist(), strict=True
        )
        rollers: dict[str, Any] = {"radius": wheel_radius, "roller_angle": roller_angle}
        return cls(
            tuple(Wheel(f"wheel_{i}", x, y, heading=h, **rollers) for i, ((x, y), h) in enumerate(places))
        )


def _car(
    wheelbase: float,
    wheel_radius: float,
    steering_limit: Limit,
    driven: Driven,
    front: Sequence[tuple[str, float]],
    rear: Sequence[tuple[str, float]],
) -> tuple[Wheel, ...]:
    """Steered front and fixed rear wheels, each with the rest of its name and its y."""
    ahead = {"steered": True, "steering_limit": steering_limit, "driven": driven in ("front", "all")}
    behind = {"driven": driven in ("rear", "all")}
    axles = ("front", wheelbase, front, ahead), ("rear", 0.0, rear, behind)
    return tuple(
        Wheel(f"{a}{end}", x, y, radius=wheel_radius, **w) for a, x, spots, w in axles for end, y in spots
    )
