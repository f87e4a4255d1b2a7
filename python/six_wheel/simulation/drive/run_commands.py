"""Drive through a command table: names of the output's columns, odometry, and a summary."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover, integrate
from six_wheel.kinematics.errors import InfeasibleMotionError
from six_wheel.kinematics.objects.notebooks import Shown
from six_wheel.kinematics.objects.tables import TWIST
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.frames.thinning import Trace
from six_wheel.logs.headers.columns import Unit
from six_wheel.logs.tables import Chunk, RowError
from six_wheel.robot_description.wheels_of_rover import joints_as_given

KEEP = ("curvature", "speed", "yaw_rate", "nearest")


@dataclass
class Peak:
    """The value of largest magnitude, what has it and in which row."""

    value: float = 0.0
    name: str = ""
    row: int = 0

    def update(self, values: Floats, names: Sequence[str], first_row: int) -> None:
        """Take in values (n, len(names)) of the rows from `first_row` on."""
        if values.size:
            row, column = divmod(int(np.abs(values).argmax()), len(names))
            if not self.row or abs(values[row, column]) > abs(self.value):
                self.value, self.name, self.row = float(values[row, column]), names[column], first_row + row


@dataclass
class Summary:
    """Summary of a drive, in SI units.

    `changed` (3,) is the largest change of a projected twist. Of a drive through a controller there are its
    `rate` and the number of rows for each of the `reasons` there were.
    """

    rows: int = 0
    duration: float = 0.0
    path_length: float = 0.0
    end_pose: Floats = field(default_factory=lambda: np.zeros(3))
    steering_angle: Peak = field(default_factory=Peak)
    steering_rate: Peak = field(default_factory=Peak)
    wheel_speed: Peak = field(default_factory=Peak)
    residuals: Peak = field(default_factory=Peak)
    speed: Peak = field(default_factory=Peak)
    yaw_rate: Peak = field(default_factory=Peak)
    acceleration: Peak = field(default_factory=Peak)
    wheel_acceleration: Peak = field(default_factory=Peak)
    projected_rows: int = 0
    changed: Floats = field(default_factory=lambda: np.zeros(3))
    rate: float | None = None
    reasons: dict[str, int] = field(default_factory=dict)
    elapsed: float = 0.0
    warnings: list[str] = field(default_factory=list)

    @property
    def shares(self) -> dict[str, float]:
        """Share of the rows, 0 to 1, for each of the `reasons`."""
        return {name: count / self.rows for name, count in self.reasons.items()}


class Engine(Shown):
    """A drive under way: the state between two blocks of rows, and the summary so far.

    Parameters
    ----------
    rover : Rover
        Any layout of wheels.
    time_unit : Unit
        Unit of the times to come.
    keep : str, optional
        Part of a twist that `Rover.project` keeps where the rover cannot make it.

    Attributes
    ----------
    units : dict
        Name to unit of the columns that `account` returns, in order.
    summary : Summary
    trace : Trace
    """

    block_rows = 0
    """Most rows that come out at a time; 0 if those that came in."""
    halt: float | None = None
    """Time since the first row at which a controller halts the rover [s]."""

    def __init__(self, rover: Rover, time_unit: Unit, keep: str | None = None) -> None:
        if keep is not None and keep not in KEEP:
            raise ValueError(f'keep must be one of {", ".join(KEEP)}, got "{keep}"')
        self.rover, self.keep, self.summary, self.trace = rover, keep, Summary(), Trace()
        self.time_unit = time_unit
        self._steered, self._wheels = list(rover.steered_wheel_names), list(rover.wheel_names)
        # Rows come out in the order of the user's joints, which is not that of the rover's wheels.
        self.joints = steering, traction = joints_as_given(rover)
        self._steering_order = [self._steered.index(wheel) for wheel in steering.values()]
        self._traction_order = [self._wheels.index(wheel) for wheel in traction.values()]
        backwards = rover.reversed_joints
        self._steering_signs, self._traction_signs = (
            np.array([-1.0 if joint in backwards else 1.0 for joint in joints])[:, None]
            for joints in (steering, traction)
        )
        self.units = self._name_columns(time_unit)
        # The row before the block to come.
        self._pose, self._twist = np.zeros(3), np.zeros(3)
        self._steering, self._speeds = np.zeros(len(self._steered)), np.zeros(len(self._wheels))

    def _more_columns(self) -> dict[str, str]:
        """Name to unit of the columns that come after those of every drive."""
        return {}

    def _name_columns(self, time_unit: Unit) -> dict[str, str]:
        steering, traction = map(list, self.joints)
        time_name = "time" if time_unit.symbol == "s" else f"time_{time_unit.symbol}"
        before = {time_name: time_unit.symbol}
        after = {"x": "m", "y": "m", "yaw": "rad"} | TWIST
        after |= {f"residual_{wheel}": "m/s" for wheel in self._wheels}
        after |= self._more_columns()
        if len({*steering, *traction, *before, *after}) < len(steering + traction) + len(before | after):
            # One name for two columns: then every joint says which of its interfaces is meant, as in ROS 2.
            steering = [f"{joint}/position" for joint in steering]
            traction = [f"{joint}/velocity" for joint in traction]
        return before | dict.fromkeys(steering, "rad") | dict.fromkeys(traction, "rad/s") | after

    def account(
        self,
        time: NDArray[Any],
        steps: Floats,
        steering: Floats,
        speeds: Floats,
        steering_rates: Floats | None = None,
    ) -> list[NDArray[Any]]:
        """Take in the joint commands of the next rows.

        Parameters
        ----------
        time : array, shape (n,)
            As it is to be written.
        steps : array, shape (n,)
            Time since the row before [s]; the first row of all has none: shape (n - 1,).
        steering, speeds, steering_rates : array, shape (n, joints)
            Joint commands [rad, rad/s, rad/s]; rates matter to wheels with scrub.

        Returns
        -------
        list of array
            One array (n,) for each of `units` before those of `_more_columns`.

        Raises
        ------
        RowError
            If a pose would not be finite.
        """
        summary = self.summary
        row, first = summary.rows + 1, len(time) - len(steps)
        fit = self.rover.fit(steering, speeds, steering_rates=steering_rates)
        held = np.vstack([self._twist, fit.twist[:-1]])
        # The first row of all has no step before it.
        moved = by_row(partial(integrate, held[first:], steps, self._pose), row + first)
        poses = moved if first else moved[1:]

        def changes(values: Floats, before: Floats) -> Floats:
            return (
                np.diff(values, axis=0, prepend=values[:1] if first else before[None])[first:]
                / steps[:, None]
            )

        linear = changes(fit.twist, self._twist)[:, :2]
        summary.rows += len(time)
        summary.duration += float(steps.sum())
        summary.path_length += float(np.hypot(held[first:, 0], held[first:, 1]) @ steps)
        summary.end_pose = poses[-1]
        for peak, values, names, start in (
            (summary.steering_angle, steering, self._steered, row),
            (summary.steering_rate, changes(steering, self._steering), self._steered, row + first),
            (summary.wheel_speed, speeds, self._wheels, row),
            (summary.wheel_acceleration, changes(speeds, self._speeds), self._wheels, row + first),
            (summary.residuals, fit.residuals, self._wheels, row),
            (summary.speed, np.hypot(*fit.twist[:, :2].T)[:, None], ["body"], row),
            (summary.yaw_rate, fit.twist[:, 2:], ["body"], row),
            (summary.acceleration, np.hypot(*linear.T)[:, None], ["body"], row + first),
        ):
            peak.update(values, names, start)
        self.trace.add(poses, steering)
        self._pose, self._twist = poses[-1], fit.twist[-1]
        self._steering, self._speeds = steering[-1], speeds[-1]
        angles = steering.T[self._steering_order] * self._steering_signs
        joints = [*angles, *speeds.T[self._traction_order] * self._traction_signs]
        return [time, *joints, *poses.T, *fit.twist.T, *fit.residuals.T]

    def _project(self, chunk: Chunk) -> Floats:
        if self.keep is None:
            return chunk.twists
        keep: Any = self.keep
        project = partial(self.rover.project, chunk.twists, keep=keep)
        twists: Floats = by_row(project, chunk.first_row)
        changes = np.abs(twists - chunk.twists)
        self.summary.projected_rows += int(changes.any(axis=1).sum())
        self.summary.changed = np.maximum(self.summary.changed, changes.max(axis=0))
        return twists


def by_row(call: Callable[[], Any], first_row: int, hint: str = "") -> Any:
    """`call()`; the row of a batch that the core refuses, naming it in brackets, becomes one of the table."""
    try:
        return call()
    except ValueError as error:
        row: tuple[int, ...] = getattr(error, "row", ())
        if len(row) != 1:
            raise
        advice = hint if isinstance(error, InfeasibleMotionError) else ""
        problem = f"{getattr(error, 'argument', '')} {getattr(error, 'problem', '')}"
        raise RowError(first_row + row[0], f"{problem}{advice}") from None
