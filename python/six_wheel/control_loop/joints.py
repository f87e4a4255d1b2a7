"""Joint states by name: in any order, in one message or several, with whatever is wrong with them.

A message is used as far as it is good. Readings that come in messages of their own are put together: there is
a new set when every joint that is needed has come since the last one.
"""

import difflib
import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

from six_wheel._core import Rover
from six_wheel.control_loop.faults import ERROR, WARN, Faults
from six_wheel.robot_description.wheels_of_rover import reading_joints

Numbers = Sequence[float]
NAMED = 12  # strangers that are remembered, for a "did you mean"


class Readings(NamedTuple):
    """Readings of all joints, in the rover's order: steering angles [rad]; wheels, NaN for passive ones."""

    steering: list[float]
    wheels: list[float]


class JointReader:
    """Readings out of joint states; what is wrong goes to `faults`.

    Wheels report positions, or velocities if `positions` is False. `factors` has for every steered wheel the
    factor and the offset that make its reading an angle.
    """

    def __init__(
        self, rover: Rover, positions: bool, factors: Sequence[tuple[float, float]], faults: Faults
    ) -> None:
        self._faults = faults
        self._positions = positions
        self._factors = list(factors)
        self._joints, self._signs = reading_joints(rover)
        self._steered = len(rover.steered_wheel_names)
        needed = [*self._joints[: self._steered], *rover.traction_joints]
        self._needed = [self._joints.index(joint) for joint in needed]
        self._place = {joint: k for k, joint in enumerate(self._joints)}
        self._last: list[int | None] = []
        self.forget()
        self._names: list[str] = []
        self._columns: list[tuple[int, int]] = []
        self._strangers: dict[str, None] = {}
        self._whole: Callable[[Numbers, Numbers], Sequence[float]] | None = None
        self.known = self._joints

    def read(
        self, names: Sequence[str], positions: Numbers, velocities: Numbers, now: int
    ) -> Readings | None:
        """Take in a message that came at `now` [ns]; the readings, if they are complete with it."""
        if names != self._names and not self._look(names):
            return None
        wheels = positions if self._positions else velocities
        if self._whole is not None and min(len(positions), len(wheels)) >= len(names):
            picked = self._whole(positions, wheels)
            if math.isfinite(sum(picked)):
                # All joints at once, as they usually come: what the lines below do, in a fifth of the time.
                self._values = [value * sign for value, sign in zip(picked, self._signs, strict=True)]
                self._fresh, self._last = [False] * len(picked), [now] * len(picked)
                return self._readings()
        values, fresh, last = self._values, self._fresh, self._last
        for column, place in self._columns:
            group = positions if place < self._steered else wheels
            if column >= len(group):
                what = "velocity" if group is velocities and place >= self._steered else "position"
                rule = f"joint {self._joints[place]} must have a {what}"
                self._faults.add("joints", ERROR, rule, f"{len(group)} of them")
                continue
            value = group[column]
            if not math.isfinite(value):
                self._faults.add(
                    "joints", ERROR, f"joint {self._joints[place]} must have a finite value", str(value)
                )
                continue
            values[place] = value * self._signs[place]
            fresh[place] = True
            last[place] = now
        if not all(fresh[place] for place in self._needed):
            return None
        self._fresh = [False] * len(fresh)
        return self._readings()

    def _readings(self) -> Readings:
        values, steered = self._values, self._steered
        steering = [
            factor * value + offset
            for value, (factor, offset) in zip(values[:steered], self._factors, strict=True)
        ]
        return Readings(steering, values[steered:])

    def missing(self, now: int, timeout: int) -> list[str]:
        """The joints that are needed and have said nothing good for longer than `timeout` [ns], or never."""
        joints = self._joints
        return [
            joints[place]
            for place in self._needed
            if (last := self._last[place]) is None or now - last > timeout
        ]

    def report_missing(self, missing: Sequence[str]) -> None:
        """Report joints without a reading, each with the name that it may have in the messages."""
        for joint in missing:
            got = "none" + self._hint(joint)
            self._faults.add("joints", ERROR, f"joint {joint} must be in the joint states", got)

    def _hint(self, joint: str) -> str:
        """The name in the messages that a missing joint may have now."""
        close = difflib.get_close_matches(joint, self._strangers, 1)
        if close:
            return f"; is it {close[0]} now?"
        listed = ", ".join(self._strangers)
        return f"; others there: {listed}" if listed else ""

    def forget(self) -> None:
        """Nothing has been read yet."""
        self._values = [math.nan] * len(self._joints)
        self._fresh = [False] * len(self._joints)
        self._last = [None] * len(self._joints)

    def _look(self, names: Sequence[str]) -> bool:
        """Find the joints in messages with these names; True if such messages can be used."""
        columns: list[tuple[int, int]] = []
        seen: set[int] = set()
        for column, name in enumerate(names):
            place = self._place.get(name)
            if place is None:
                if len(self._strangers) < NAMED:
                    self._strangers[name] = None
                continue
            if place in seen:
                # Nothing tells which of the two is true.
                self._faults.add("joints", ERROR, "a joint must be in a message once", f"{name} twice")
                return False
            seen.add(place)
            columns.append((column, place))
        if not columns and names:
            self._faults.add(
                "joints", WARN, "messages must hold joints of this rover", ", ".join(list(names)[:4])
            )
        self._names, self._columns = list(names), columns
        self._whole = None
        if len(columns) == len(self._joints):
            order = [column for column, _ in sorted(columns, key=lambda each: each[1])]
            self._whole = partial(_pick, order[: self._steered], order[self._steered :])
        return True


def _pick(
    steering: Sequence[int], driving: Sequence[int], positions: Numbers, wheels: Numbers
) -> Sequence[float]:
    return [positions[k] for k in steering] + [wheels[k] for k in driving]
