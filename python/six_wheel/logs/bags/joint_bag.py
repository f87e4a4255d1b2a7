"""The joint states of a bag.

Joints come in any order, in messages of their own, with positions or velocities. A row is made for every
message of the first wheel that has any; what comes in other messages is interpolated between the two around.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.kinematics.errors import TableError
from six_wheel.logs.bags.messages import JOINT_STATE, LINE, LOOK_AHEAD, Bag
from six_wheel.logs.headers.joint_columns import Reading, did_you_mean
from six_wheel.logs.plausibility.findings import Findings
from six_wheel.logs.skip_bad_rows import Batch
from six_wheel.robot_description.joint_names import said_by

LONGEST_GAP = 500_000_000  # [ns] between two messages of a joint, across which it is not interpolated


class JointBag(Bag):
    """The joint states of a rover in a bag: a folder with metadata.yaml, a .mcap or .db3 file.

    `readings` is the kind to take of the wheels where both are there; angles by default. `names` are
    ``"steering NAME"`` and ``"wheel NAME"`` of what is in the bag.
    """

    def __init__(
        self, path: Path, rover: Rover, readings: Reading | None = None, topics: Sequence[str] | None = None
    ) -> None:
        super().__init__(path)
        self._choose([JOINT_STATE], topics, usual="joint_states")
        self._joints = {wheel: f"wheel {wheel}" for wheel in rover.wheel_names}
        self._joints |= {joint: f"wheel {wheel}" for joint, wheel in rover.traction_joints.items()}
        self._joints |= {joint: f"steering {wheel}" for joint, wheel in rover.steering_joints.items()}
        self._turned = frozenset(rover.reversed_joints)
        try:
            self.readings = self._find_joints(rover, readings)
        except BaseException:
            self.close()
            raise

    def _find_joints(self, rover: Rover, readings: Reading | None) -> Reading:
        """Reads ahead for the joints of the bag, and returns the kind of reading for the wheels."""
        kinds: dict[str, set[Reading]] = {}
        strangers: dict[str, None] = {}
        for number, _, message in self.messages():
            for joint, position, velocity in self._states(message):
                if (name := self._joints.get(joint)) is None:
                    strangers[joint] = None
                    continue
                known = kinds.setdefault(name, set())
                known |= {"angles"} if math.isfinite(position) else set()
                known |= {"speeds"} if math.isfinite(velocity) else set()
            lacking = [j for j, wheel in rover.steering_joints.items() if not kinds.get(f"steering {wheel}")]
            if number >= LOOK_AHEAD and not lacking:
                break
        self.findings = Findings(self.path)  # all of it is read again
        listed = ", ".join([*(j for j, name in self._joints.items() if name in kinds), *strangers]) or "none"
        for joint, wheel in rover.steering_joints.items():
            if "angles" not in kinds.get(f"steering {wheel}", ()):
                hint = did_you_mean([joint], _like_wheels(strangers))
                raise TableError(f"{self.path}: no position of joint {joint} among {listed}{hint}")
        wheels = {name: known for name, known in kinds.items() if name.startswith("wheel ") and known}
        if not wheels:
            joints = ", ".join(rover.traction_joints)
            hint = did_you_mean([*rover.traction_joints], _like_wheels(strangers))
            raise TableError(f"{self.path}: no joint of any wheel ({joints}) among {listed}{hint}")
        self.names = [name for name in dict.fromkeys(self._joints.values()) if kinds.get(name)]
        choices: tuple[Reading, ...] = ("angles", "speeds") if readings is None else (readings,)
        for choice in choices:
            if all(choice in known for known in wheels.values()):
                return choice
        raise TableError(
            f"{self.path}: wheels must be read in one way, all as {' or '.join(choices)}, got "
            + ", ".join(f"{name} ({' and '.join(sorted(known))})" for name, known in wheels.items())
        )

    def _states(self, message: Any) -> Iterator[tuple[str, float, float]]:
        """Joint, position and velocity; NaN for what the message leaves out."""
        try:
            names = [str(name) for name in message.name]
            positions, velocities = message.position.tolist(), message.velocity.tolist()
        except (AttributeError, TypeError):  # bags bring the definitions of their messages along
            rule = "joint states must have names, positions and velocities, which this bag's have not"
            raise TableError(f"{self.path}: {rule}") from None
        for what, values in (("positions", positions), ("velocities", velocities)):
            if len(values) not in (0, len(names)):
                rule = f"joint states must have as many {what} as names"
                raise TableError(f"{self.path}: {rule}, got {len(values)} and {len(names)}")
        nothing = [math.nan] * len(names)
        positions, velocities = (
            values if len(values) == len(names) else nothing for values in (positions, velocities)
        )
        return zip(names, positions, velocities, strict=True)

    def batches(self, chunk_rows: int) -> Iterator[Batch]:
        """Rows at the messages of the first wheel, numbered as those messages are."""
        series = {name: _Series() for name in self.names}
        first = next(name for name in self.names if name.startswith("wheel "))
        for number, stamp, message in self.messages():
            self.position = number
            for joint, position, velocity in self._states(message):
                if (name := self._joints.get(joint)) in series:
                    speed = name.startswith("wheel ") and self.readings == "speeds"
                    value = velocity if speed else position
                    flaw = series[name].add(number, stamp, -value if joint in self._turned else value)
                    if flaw and name == first:
                        self.findings.add(*flaw)
            if len(series[first].stamps) > chunk_rows and number % chunk_rows == 0:
                yield from self._rows(series, first, last=False)
        yield from self._rows(series, first, last=True)

    def _rows(self, series: "Mapping[str, _Series]", first: str, last: bool) -> Iterator[Batch]:
        pivot = series[first]
        # The newest message of a joint may yet turn out to run ahead. A joint that has been silent for longer
        # than can be interpolated is not waited for.
        silent = pivot.stamps[-2] - 2 * LONGEST_GAP if len(pivot.stamps) > 1 else 0
        ends = [each.stamps[-2] if len(each.stamps) > 1 else 0 for each in series.values()]
        horizon = math.inf if last else max(min(ends), silent)
        count = int(np.searchsorted(np.array(pivot.stamps, dtype=np.int64), horizon, side="right"))
        if not count:
            return
        rows = np.array(pivot.numbers[:count], dtype=np.int64)
        stamps = np.array(pivot.stamps[:count], dtype=np.int64)
        values = {name: each.at(stamps) for name, each in series.items()}
        for each in series.values():
            each.forget(int(stamps[-1]), keep=each is not pivot)
        yield Batch(rows, np.full(count, LINE), stamps, values)


class _Series:
    """Readings of one joint, as far back as they are still needed."""

    def __init__(self) -> None:
        self.numbers: list[int] = []
        self.stamps: list[int] = []
        self._values: list[float] = []
        self._forgotten: float = -math.inf  # the stamp of the last value that was dropped

    def add(self, number: int, stamp: int, value: float) -> tuple[int, str, str] | None:
        """Take in a value; the message that is left out, if one is, and why."""
        if not math.isfinite(value):
            return number, "every joint must have a finite value", f", got {value}"
        flaw = None
        if self.stamps and stamp <= self.stamps[-1]:
            before = self.stamps[-2] if len(self.stamps) > 1 else self._forgotten
            if stamp <= before or stamp == self.stamps[-1]:
                return number, "stamps must increase", f", got {stamp} ns after {self.stamps[-1]} ns"
            ahead = self.stamps.pop()
            flaw = self.numbers.pop(), "stamps must not run ahead", f", got {ahead} ns before {stamp} ns"
            self._values.pop()
        self.numbers.append(number)
        self.stamps.append(stamp)
        self._values.append(value)
        return flaw

    def at(self, stamps: NDArray[np.int64]) -> NDArray[np.float64]:
        """Values at other stamps, straight from message to message; NaN across gaps and beyond the ends."""
        result = np.full(len(stamps), np.nan)
        if not self.stamps:
            return result
        own, values = np.array(self.stamps, dtype=np.int64), np.array(self._values)
        after = np.minimum(np.searchsorted(own, stamps), len(own) - 1)
        exact = own[after] == stamps
        result[exact] = values[after[exact]]
        before = after - 1
        step = own[after] - own[before]
        inside = ~exact & (after > 0) & (own[after] > stamps) & (step <= LONGEST_GAP)
        b, a = before[inside], after[inside]
        part = (stamps[inside] - own[b]) / step[inside]
        result[inside] = values[b] + part * (values[a] - values[b])
        return result

    def forget(self, stamp: int, keep: bool) -> None:
        """Drop what is up to `stamp`; `keep` the last of it, to interpolate from."""
        count = int(np.searchsorted(np.array(self.stamps, dtype=np.int64), stamp, side="right"))
        count = max(count - keep, 0)
        if count:
            self._forgotten = self.stamps[count - 1]
            del self.numbers[:count], self.stamps[:count], self._values[:count]


def _like_wheels(joints: Iterable[str]) -> list[str]:
    """Joints whose names tell a place, as a wheel's do; all joints if no name does."""
    return [joint for joint in joints if said_by(joint) is not None] or [*joints]
