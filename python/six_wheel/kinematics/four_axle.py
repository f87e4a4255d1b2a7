"""States, steps and results of `FourAxle`, as plain values.

Axles come in the order front left, front right, rear left, rear right.
"""

from __future__ import annotations  # NumPy is not loaded for its names

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, TypeAlias

from six_wheel.kinematics import rover_edit
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.objects.notebooks import Shown
from six_wheel.kinematics.objects.short_text import short_repr

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from six_wheel._core import Rover
    from six_wheel.kinematics.poses import Floats

Brake: TypeAlias = Literal["locked", "free"]
Four: TypeAlias = tuple[float, float, float, float]


@checked_class
@dataclass(frozen=True, slots=True)
class FourAxleState:
    """All that changes while a `FourAxle` drives. `replace` makes another one.

    Parameters
    ----------
    steering : sequence of float, length 4
        Headings of the wheels in the body [rad].
    front_brake, rear_brake : {'locked', 'free'}
        Brakes of the two pairs.
    pose : sequence of float, length 3
        x, y, yaw of the body in the world [m, m, rad].

    Raises
    ------
    ValueError
        If a number is not finite, there are too few or too many, or a brake is neither locked nor free.
    """

    steering: Four = (0.0, 0.0, 0.0, 0.0)
    front_brake: Brake = "locked"
    rear_brake: Brake = "locked"
    pose: tuple[float, float, float] = (0.0, 0.0, 0.0)

    replace = __replace__ = rover_edit.replace

    def __post_init__(self) -> None:
        object.__setattr__(self, "steering", _numbers("steering", self.steering, 4))
        object.__setattr__(self, "pose", _numbers("pose", self.pose, 3))
        _check_brakes(self.front_brake, self.rear_brake)


@checked_class
@dataclass(frozen=True, slots=True)
class FourAxleStep:
    """One step of a `FourAxle`: the brakes are set, then the wheels turn at constant speeds.

    Parameters
    ----------
    action : str
        Its purpose, such as "free rear" or "turn rear".
    duration : float
        For how long [s]; 0 for a brake alone.
    front_brake, rear_brake : {'locked', 'free'}
        Brakes during the step.
    wheel_speeds : sequence of float or None, length 4
        Wheel speeds [rad/s]; None where the drive follows, turning as the ground makes it turn. `simulate`
        tells at which speeds it does.
    end : FourAxleState, optional
        Pose at the end of a planned step.

    Raises
    ------
    ValueError
        If a number is not finite, the duration negative, or a brake neither locked nor free.
    """

    action: str
    duration: float
    front_brake: Brake
    rear_brake: Brake
    wheel_speeds: tuple[float | None, float | None, float | None, float | None]
    end: FourAxleState | None = None

    replace = __replace__ = rover_edit.replace

    def __post_init__(self) -> None:
        if not isinstance(self.action, str):
            raise ArgumentTypeError(f"action must be a str, got {self.action!r}")
        if not isinstance(self.end, FourAxleState | None):
            raise ArgumentTypeError(f"end must be a FourAxleState, got {self.end!r}")
        wanted: Any = self.wheel_speeds
        if hasattr(wanted, "__iter__"):
            wanted = [0.0 if speed is None else speed for speed in wanted]
        given = _numbers("wheel_speeds", wanted, 4)
        speeds = (None if old is None else new for old, new in zip(self.wheel_speeds, given, strict=True))
        object.__setattr__(self, "wheel_speeds", tuple(speeds))
        (duration,) = _numbers("duration", [self.duration], 1)
        if duration < 0.0:
            raise ValueError(f"duration must be finite and not negative, got {duration}")
        object.__setattr__(self, "duration", duration)
        _check_brakes(self.front_brake, self.rear_brake)


@dataclass(frozen=True, slots=True, repr=False)
class TurnSequence:
    """Steps that re-aim the axles, each checked at the angles where it begins. Iterates over them."""

    steps: tuple[FourAxleStep, ...]
    stops: bool
    """True where the robot has to stand during the step."""
    reason: str
    """Reason of a stop or a roundabout way; empty without either."""

    def __repr__(self) -> str:
        actions = " ".join(step.action for step in self.steps)
        found = {"steps": len(self.steps), "duration": self.duration, "stops": self.stops}
        return short_repr("TurnSequence", found | {"reason": self.reason, "actions": actions})

    def __iter__(self) -> Iterator[FourAxleStep]:
        return iter(self.steps)

    def __len__(self) -> int:
        return len(self.steps)

    @property
    def duration(self) -> float:
        """Of all steps [s]."""
        return math.fsum(step.duration for step in self.steps)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FourAxleMobility:
    """Mobility of the robot with its axles locked at some angles, from the rank of the side-slip rows."""

    rank: int
    """Rank of the four side-slip rows; 3 means locked."""
    degree_of_mobility: int
    """Independent motions left: 3 - rank."""
    singular_values: Floats
    """Of those rows, in their units, descending, shape (3,)."""
    motion: Floats
    """The free motions, shape (degree_of_mobility, 3): twists with the pivots at 1 m/s (root mean square)."""
    slip: float
    """Side slip of the least slipping motion per distance driven (both root mean square over the wheels)."""
    margin: float
    """Slip to spare: the vehicle's tolerance less the slip. Negative where a lock is refused."""

    def __repr__(self) -> str:
        names = ("rank", "degree_of_mobility", "slip", "margin", "singular_values", "motion")
        return short_repr("FourAxleMobility", {name: getattr(self, name) for name in names})


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FourAxleMotion:
    """Motion of body and pivots at some wheel speeds."""

    twist: Floats
    """Of the body: vx, vy, omega, shape (3,) [m/s, m/s, rad/s]."""
    pivot_rates: Floats
    """Of the axles in the body, shape (4,) [rad/s]; 0 where locked."""
    wheel_speeds: Floats
    """Of all wheels, the following ones included, shape (4,) [rad/s]."""
    residuals: Floats
    """Speed at which each contact slides, shape (4,) [m/s]."""
    rank: int
    """Unknowns of body and free pivots that the wheels determine: all of them."""

    def __repr__(self) -> str:
        names = ("twist", "pivot_rates", "wheel_speeds", "residuals", "rank")
        return short_repr("FourAxleMotion", {name: getattr(self, name) for name in names})


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FourAxleSimulation(Shown):
    """A simulated drive: n samples, the first of which is the start."""

    rover: Rover
    """The vehicle that drove."""
    steps: tuple[FourAxleStep, ...]
    """The steps that were simulated."""
    stamps: Floats
    """Since the beginning, shape (n,) [s]."""
    poses: Floats
    """x, y, yaw in the world, shape (n, 3) [m, m, rad]."""
    steering: Floats
    """Of the axles in the body, shape (n, 4) [rad]."""
    twists: Floats
    """Of the body, shape (n, 3), as the step that leads to the sample ends; the first as its step begins."""
    wheel_speeds: Floats
    """Of all wheels, shape (n, 4) [rad/s]; what to feed to drives that have to follow."""
    residuals: Floats
    """Speed at which each contact slides, shape (n, 4) [m/s]."""
    ends: NDArray[np.int64]
    """Row in which each step ends, shape (steps,)."""
    final: FourAxleState
    """State after the last step."""

    def __repr__(self) -> str:
        found = {"steps": len(self.steps), "samples": len(self.stamps), "pose": tuple(self.final.pose)}
        return short_repr("FourAxleSimulation", found | {"steering": tuple(self.final.steering)})


def _numbers(name: str, values: Sequence[SupportsFloat], count: int) -> tuple[float, ...]:
    try:
        numbers = tuple(float(value) for value in values)
    except (TypeError, ValueError):
        got = repr(values[0] if count == 1 else values)
        rule = "a number" if count == 1 else f"{count} numbers"
        raise ArgumentTypeError(f"{name} must be {rule}, got {got}") from None
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        rule = "be finite" if count == 1 else f"be {count} finite numbers"
        raise ValueError(f"{name} must {rule}, got {numbers[0] if len(numbers) == count == 1 else numbers}")
    return numbers


def _check_brakes(front: str, rear: str) -> None:
    for name, brake in (("front_brake", front), ("rear_brake", rear)):
        if brake not in ("locked", "free"):
            raise ValueError(f"{name} must be 'locked' or 'free', got {brake!r}")
