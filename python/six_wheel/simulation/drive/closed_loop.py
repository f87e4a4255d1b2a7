"""Driving a command table through a `Controller`: commands in at their stamps, rows out at its rate."""

import inspect
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Controller, Limits, Rover
from six_wheel.kinematics.controller import Reason, reason_counts, reason_names
from six_wheel.kinematics.objects.tables import TWIST
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.headers.columns import Unit
from six_wheel.logs.tables import Chunk, RowError
from six_wheel.simulation.drive.min_max_thinning import Course
from six_wheel.simulation.drive.run_commands import Engine

RATE = 50.0  # [Hz] usual for rovers: what `DriveLoop` steps at unless told otherwise
SNAP = 1e-6  # [s] a stamp this near to a step is that of the step: tables write times in microseconds
MOST_STEPS = 10_000_000  # between two commands: two days at 50 Hz; more is a wrong stamp
BLOCK_ROWS = 1 << 16  # at a time: more is no faster
END_STEPS = 256  # of the stop after the last command, at a time
REASONS_METADATA = {"reasons": {"bits": " ".join(f"{each.name}={each.value}" for each in Reason)}}


@dataclass(frozen=True)
class DriveLoop:
    """A controller and how often it steps.

    Attributes
    ----------
    limits : Limits
        Limits of the motion.
    rate : float, optional
        Steps per second [Hz]; without it 1 / `control["period"]`, or else 50.
    control : mapping of str to object
        Other keywords of `Controller`.
    halt : float, optional
        Time since the first command at which the rover is halted, for good [s].
    """

    limits: Limits = field(default_factory=Limits)
    rate: float | None = None
    control: Mapping[str, Any] = field(default_factory=dict)
    halt: float | None = None

    def option(self, name: str) -> Any:
        """A keyword of the controller: as given, or else its default."""
        return self.control.get(name, inspect.signature(Controller).parameters[name].default)

    def start(self, rover: Rover) -> tuple[Controller, float]:
        """The controller at rest, and its rate [Hz].

        Raises
        ------
        ValueError
            If the rate is not positive, or a step would take longer than the controller lets one count for;
            if the halt is negative or not finite; or as `Controller` does.
        """
        if self.halt is not None and not (math.isfinite(self.halt) and self.halt >= 0.0):
            raise ValueError(f"halt must be finite and not negative, got {self.halt:g}")
        if self.rate is None:
            rate = 1.0 / self.control["period"] if "period" in self.control else RATE
        else:
            rate = float(self.rate)
        if not (math.isfinite(rate) and rate > 0.0):
            raise ValueError(f"rate must be finite and positive, got {rate:g}")
        longest = self.option("max_step")
        if rate * longest < 1.0:
            rule = f"at least {1.0 / longest:g} Hz: a step counts for at most max_step={longest:g} s"
            raise ValueError(f"rate must be {rule}, got {rate:g}")
        if rate * SNAP > 0.1:
            raise ValueError(f"rate must be at most {0.1 / SNAP:g} Hz, got {rate:g}")
        return Controller(rover, self.limits, **{**self.control, "period": 1.0 / rate}), rate


class ControlledDrive(Engine):
    """A rover on its way through a table, steered by a controller.

    The first step is at the first stamp. After the last command the loop goes on until the rover stands: when
    the timeout of the controller is over and the stop done. Without a timeout the rover is told to stop one
    step after the last command.

    Arguments and attributes beside these are those of `Engine`.

    Parameters
    ----------
    loop : DriveLoop
        The controller and its rate.
    block_rows : int
        Most rows in memory at a time.

    Attributes
    ----------
    course : Course
        Over time: commanded and limited twists, steering angles, their rates, wheel speeds.
    limits : Limits
    """

    def __init__(
        self,
        rover: Rover,
        time_unit: Unit,
        loop: DriveLoop,
        keep: str | None = None,
        *,
        block_rows: int = 200_000,
    ) -> None:
        super().__init__(rover, time_unit, keep)
        self._controller, self._rate = loop.start(rover)
        self.limits, self._timeout = loop.limits, loop.option("timeout")
        self.summary.rate = self._rate
        self.halt = loop.halt
        self._halt_step = None if loop.halt is None else self._first_step(loop.halt)
        self.block_rows = min(block_rows, BLOCK_ROWS)
        self.course = Course(6 + 2 * len(self._steered) + len(self._wheels))
        self._names: dict[int, str] = {0: ""}
        # Commands that no step has been given yet, their rows, and the latest one that was given.
        self._stamps, self._twists = np.empty(0), np.empty((0, 3))
        self._rows = np.empty(0, np.int64)
        self._commanded, self._row = np.zeros(3), 1
        self._start: Any = None
        self._last = self._longest = 0.0
        self._step = 0

    def _more_columns(self) -> dict[str, str]:
        more = {f"{which}_{name}": unit for which in ("commanded", "limited") for name, unit in TWIST.items()}
        return more | {"reasons": "1", "reason_names": ""}

    def blocks(self, chunk: Chunk) -> Iterator[list[Any]]:
        """The columns of the steps that the next rows decide: those before the last of them.

        Raises
        ------
        RowError
            If the time to a row is too long, or the pose would not be finite.
        """
        if self._start is None:
            self._start = chunk.stamps[0]
            self._choose_times(chunk.stamps)
        # Differences first, in the file's own numbers: 1.7e18 ns would lose 256 ns as a double.
        stamps = (chunk.stamps - self._start) * self.time_unit.scale
        gaps = np.diff(stamps, prepend=self._last)
        # Integers of opposite ends of time wrap around, to a gap that is negative.
        far = ~((gaps >= 0.0) & (gaps * self._rate < MOST_STEPS))
        if far.any():
            k = int(far.argmax())
            most = f"{MOST_STEPS / self._rate:g} s ({MOST_STEPS:,} steps)"
            rule = f"time must be less than {most} after the row before"
            raise RowError(chunk.first_row + k, f"{rule}, got {gaps[k]:g} s")
        self._last, self._longest = float(stamps[-1]), max(self._longest, float(gaps.max()))
        steps = np.rint(stamps * self._rate)
        stamps = np.where(np.abs(stamps - steps / self._rate) <= self._snap, steps / self._rate, stamps)
        self._stamps = np.concatenate([self._stamps, stamps])
        self._twists = np.concatenate([self._twists, self._project(chunk)])
        self._rows = np.concatenate([self._rows, chunk.first_row + np.arange(len(stamps))])
        yield from self._go(self._first_step(float(stamps[-1])))

    def end(self) -> Iterator[list[Any]]:
        """The columns of the steps from the last command on, until the rover stands.

        Raises
        ------
        RowError
            If that takes too long.
        """
        yield from self._to_rest()
        if self._halt_step is not None:
            end = (self._step - 1) / self._rate
            self.summary.warnings.append(
                f"halt must be before the drive ends at {end:g} s, got {self.halt:g}"
            )

    def _to_rest(self) -> Iterator[list[Any]]:
        if self._timeout is not None and self._longest > self._timeout + self._snap:
            self.summary.warnings.append(
                f"commands are up to {self._longest:g} s apart, longer than the timeout of "
                f"{self._timeout:g} s: meanwhile the rover stops; a longer control.timeout lets it go on"
            )
        last = self._first_step(float(self._stamps[-1]))
        yield from self._go(last + 1)
        if self._timeout is None:
            self._stamps = np.append(self._stamps, (last + 1) / self._rate)
            self._twists = np.vstack([self._twists, np.zeros(3)])
            self._rows = np.append(self._rows, self._row)
            yield from self._go(last + 2)
        asleep = not self._commanded.any()
        if asleep and self._controller.stopped:
            return
        while True:
            if self._step - last > MOST_STEPS:
                raise RowError(self._row, f"the rover must stop within {MOST_STEPS:,} steps of the last row")
            times, run = self._run(min(END_STEPS, self.block_rows))
            idle = (run.reasons & (Reason.STALE | Reason.HALTED) > 0) | asleep
            still = idle & ~run.wheel_speeds.any(axis=1) & ~run.steering_rates.any(axis=1)
            if self._controller.stopped and still[-1]:
                rows = len(still) - int(np.argmin(still[::-1])) + 1 if not still.all() else 1
                yield self._columns(times, run, rows)
                return
            yield self._columns(times, run, len(times))

    # Steps

    def _choose_times(self, time: NDArray[Any]) -> None:
        """Set the tolerance of times and the flag for steps that are whole numbers of the file's unit."""
        per_second = round(1.0 / self.time_unit.scale)
        whole = np.issubdtype(time.dtype, np.integer)
        spacing = 1.0 if whole else float(np.spacing(np.abs(time).max()))
        self._snap = min(max(SNAP, 4.0 * spacing * self.time_unit.scale), 0.1 / self._rate)
        self._per_second = per_second
        # Nanoseconds since 1970 do not fit into a double, so that they are whole even if steps are not.
        self._whole = whole and (per_second >= 1e9 or (per_second / self._rate).is_integer())

    def _first_step(self, stamp: float) -> int:
        """The first step that is not earlier than a stamp [s]."""
        step = math.ceil(stamp * self._rate)
        step -= (step - 1) / self._rate >= stamp
        return step + (step / self._rate < stamp)

    def _go(self, end: int) -> Iterator[list[Any]]:
        while self._step < end:
            times, run = self._run(min(end - self._step, self.block_rows))
            yield self._columns(times, run, len(times))

    def _run(self, count: int) -> tuple[Floats, Any]:
        """The next steps, fewer up to that of a halt: their times, what the controller says; commands go to
        `_given`."""
        if self._halt_step is not None and self._step < self._halt_step:
            count = min(count, self._halt_step - self._step)
        elif self._halt_step is not None:
            self._controller.halt()
            self._halt_step = None
        times = np.arange(self._step, self._step + count) / self._rate
        given = int(np.searchsorted(self._stamps, times[-1], side="right"))
        run = self._controller.run(self._twists[:given], self._stamps[:given], times)
        # Index of the latest command at every step; 0 is the one before these.
        latest = np.searchsorted(self._stamps[:given], times, side="right")
        self._given = np.vstack([self._commanded, self._twists[:given]])[latest]
        self._given_rows = np.concatenate([[self._row], self._rows[:given]])[latest]
        self._commanded, self._row = self._given[-1], int(self._given_rows[-1])
        self._stamps, self._twists = self._stamps[given:], self._twists[given:]
        self._rows = self._rows[given:]
        self._step += count
        return times, run

    def _columns(self, times: Floats, run: Any, count: int) -> list[Any]:
        """The columns of the first `count` of these steps."""
        times, given = times[:count], self._given[:count]
        steering, speeds, rates = run.steering[:count], run.wheel_speeds[:count], run.steering_rates[:count]
        twists, reasons = run.twist[:count], run.reasons[:count]
        since = times * self._per_second
        written = self._start + (np.rint(since).astype(np.int64) if self._whole else since)
        first = int(self.summary.rows == 0)
        earlier = (self._step - len(run.reasons) - 1) / self._rate
        steps = np.diff(times) if first else np.diff(times, prepend=earlier)
        row = self.summary.rows + 1
        # As the steps make them: a joint without a limit is told to be there at once, at no rate at all.
        before = steering[:1] if first else self._steering[None]
        turned = np.diff(steering, axis=0, prepend=before) / np.diff(times, prepend=earlier)[:, None]
        try:
            columns = self.account(written, steps, steering, speeds, rates)
        except RowError as error:
            raise RowError(int(self._given_rows[error.row - row]), error.message) from None
        self.course.add(times, np.hstack([given, twists, steering, turned, speeds]), reasons)
        for name, found in reason_counts(reasons).items():
            self.summary.reasons[name] = self.summary.reasons.get(name, 0) + found
        return [*columns, *given.T, *twists.T, reasons, self._named(reasons)]

    def _named(self, reasons: NDArray[np.uint32]) -> Any:
        """The names of the reasons of every row, joined by ``|``, as a column of Arrow."""
        import pyarrow as pa

        kinds, places = np.unique(reasons, return_inverse=True)
        for kind in kinds.tolist():
            if kind not in self._names:
                self._names[kind] = reason_names(kind)
        names = pa.array([self._names[kind] for kind in kinds.tolist()], pa.string())
        return names.take(pa.array(places))
