"""All checks of a log, chunk by chunk, at little cost.

Sums telescope: a jump in one row shows in the difference over a stretch of rows. So a clean log is judged by
few of its rows, and only a stretch that is odd is read row by row.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.agreement import WheelAgreement, held_readings
from six_wheel.logs.plausibility.granularity import check_steps_of_turns
from six_wheel.logs.plausibility.jumps import (
    WHOLE_TURNS,
    Jumps,
    find_jumps,
    goes_to_and_fro,
    longest_step,
    lost_readings,
    may_jump,
)
from six_wheel.logs.plausibility.motion import (
    STRETCH,
    check_motion,
    check_steering,
    impossible,
)
from six_wheel.logs.plausibility.proposals import (
    AS_READ,
    Column,
    ImplausibleReadingError,
    encoders,
    max_speed,
    number,
    rows,
)
from six_wheel.logs.plausibility.readings import Readings
from six_wheel.logs.plausibility.stamps import (
    FEW_ROWS,
    LONG_GAP,
    LostIncrements,
    check_clock,
    check_order,
    check_origin,
    gap_line,
)
from six_wheel.logs.plausibility.still import WheelTurns
from six_wheel.logs.plausibility.whole_numbers import (
    all_whole,
    check_counts,
    check_increments,
    check_increments_as_totals,
    check_thousands,
    returned_counts,
)

SAMPLE = 4096  # rows in a row that are read closely for what only neighbours tell
COARSE = 32_768, 32  # rows that come at once, from which on stretches have so many at least
FASTEST_STEP = 30.0  # [m/s] of a rim from one row to the next


@dataclass
class ReadingChecks:
    """Checks of the rows of a log as they come."""

    readings: Readings
    warn: Callable[[str], None]  # called with a line for what can be read but not be trusted
    rows: int = 0  # that were checked so far
    _last: tuple[float, Floats, Floats, Floats | None] | None = None
    turns: WheelTurns = field(default_factory=WheelTurns)
    agreement: WheelAgreement = field(default_factory=WheelAgreement)
    _lost: LostIncrements = field(default_factory=LostIncrements)
    _last_read: Floats = field(default_factory=lambda: np.zeros(0))
    _begin: float = 0.0
    _turned: Floats = field(default_factory=lambda: np.zeros(0))
    _clock_known: bool = False
    _numbers: NDArray[np.int64] | None = None  # of the rows of this chunk
    _numbered: tuple[int, int] = (0, -1)
    _looked: bool = False

    def take(
        self,
        stamps: Floats,
        raw: Floats,
        angles: Floats | None,
        steering: Floats | None,
        numbers: NDArray[np.int64] | None = None,
        joints: Floats | None = None,
    ) -> None:
        """Check consecutive rows at stamps (n,) [s], whose rows have these `numbers`, by default in order.

        `raw` (n, wheels) and `steering` (n, steered wheels) are as the log has them, in radians or counts;
        `angles` (n, wheels) are running totals [rad], None if only `raw` tells, `joints` steering angles
        [rad], if the log has them otherwise. Raises `ImplausibleReadingError` if readings cannot be meant as
        they are read.
        """
        if not len(stamps):
            return
        known, self._numbers = self.readings, numbers
        if not self.rows:
            self._begin = float(stamps[0])
            self.turns.least = 10.0 * math.pi / known.turn if known.turn else self.turns.least
            if not known.clock_stated:
                check_origin(float(stamps[0]), known.time, self._row(0))
        if numbers is None:
            check_order(stamps, self.warn, known.time)
        with np.errstate(invalid="ignore", over="ignore"):  # rows without numbers are left to others
            chosen = self._stretches(stamps)
            self._look(raw, steering)
            if known.kind in ("angles", "ticks") and not known.wraps:
                self._check_columns(raw, known.wheels, chosen, steering=False)
            if steering is not None and not known.steering_wraps:
                self._check_columns(steering, known.steering, chosen, steering=True)
            self._check_steps(stamps, raw if angles is None else angles, angles is None)
            self._check_motion(stamps, raw, angles, steering if joints is None else joints, chosen)
            if not known.wraps or angles is not None:
                self._check_gaps(stamps, raw if angles is None else angles)
        if numbers is not None:
            self._numbered = int(self._numbered[0] or numbers[0]), int(numbers[-1])
        self.rows += len(stamps)
        last = None if steering is None else steering[-1]
        self._last = (float(stamps[-1]), raw[-1].copy(), self._turned, last)

    def finish(self) -> None:
        """Warn of wheels that do not move while others or the truth do."""
        known = self.readings
        for line in self.turns.without_sign(known) if known.directions and len(self.turns.way) else ():
            self.warn(line)
        if known.kind == "increments":
            missing = self._numbered[1] - self._numbered[0] + 1 - self.rows
            if missing > 0 and self.rows:
                self.warn(f"the path misses what wheels turned in {missing} rows that are left out")
            if self._lost.rows:
                what = f"about {self._lost.rows:.0f} rows that are not there"
                self.warn(f"the path misses what wheels turned in {what}, from row {self._lost.first} on")
            return
        if self._last is None:
            return
        if known.turn and self.turns.returned and not known.increments_stated:
            column = next(each for each in known.wheels if each.header)
            raise returned_counts(column)
        duration = self._last[0] - self._begin
        for line in (
            *self.turns.doubts(known, self.rows, duration),
            *self.agreement.doubts(known, duration),
        ):
            self.warn(line)

    def _row(self, place: int) -> int:
        """The number of a row of this chunk."""
        numbers = self._numbers
        return self.readings.first_row + self.rows + place if numbers is None else int(numbers[place])

    def _stretches(self, stamps: Floats) -> NDArray[np.int64]:
        """Rows about `STRETCH` apart, farther where they are many, with the first and the last among them."""
        few = stamps[: SAMPLE // 4]
        steps = np.diff(few)
        steps = steps[steps > 0.0]
        period = float(np.median(steps)) if len(steps) else STRETCH
        width = max(1, min(round(STRETCH / period) if period < STRETCH else 1, max(1, len(stamps) // 8)))
        width = max(width, COARSE[1]) if len(stamps) >= COARSE[0] else width
        chosen = np.arange(0, len(stamps), width)
        return chosen if chosen[-1] == len(stamps) - 1 else np.append(chosen, len(stamps) - 1)

    def _look(self, raw: Floats, steering: Floats | None) -> None:
        """Counts and increments under another name, by rows that follow one another."""
        known = self.readings
        if self._looked:
            return
        self._looked = len(raw) >= SAMPLE // 4
        piece, row = raw[:SAMPLE], self._row(0)
        if known.kind in ("angles", "ticks") and not known.wraps and (line := held_readings(piece, known)):
            self.warn(line)
        for column, readings in zip(known.wheels, piece.T, strict=True) if known.kind == "ticks" else ():
            check_thousands(readings, column, row)
        if known.kind == "angles" and not known.wheels_stated:
            check_steps_of_turns(piece, known.wheels, row, known.named)
        if known.kind in ("angles", "speeds") and not known.wheels_stated:
            mapped = known.named and known.first_row > 0
            check_counts(piece if known.kind == "angles" else piece[:0], known.wheels, row, mapped=mapped)
        if steering is not None and not known.steering_stated:
            mapped = known.named and known.first_row > 0
            check_counts(steering[:SAMPLE], known.steering, row, steering=True, mapped=mapped)
        if known.kind == "increments" or not (known.increments_stated or known.wraps):
            # Quicker rows hold fewer counts each: more of them show the motion.
            for column, readings in zip(known.wheels, raw[: 4 * SAMPLE].T, strict=True):
                if known.kind in ("angles", "ticks"):
                    check_increments_as_totals(readings, column, row)
                elif known.kind == "increments":
                    check_increments(readings, column, row)

    def _check_columns(
        self, values: Floats, named: Sequence[Column], chosen: NDArray[np.int64], steering: bool
    ) -> None:
        """Refuses columns that jump."""
        last = self._last
        before = None if last is None else last[3] if steering else last[1]
        for place, column in enumerate(named):
            samples = values[chosen, place]
            if before is not None:
                samples = np.concatenate((before[place : place + 1], samples))
            if not may_jump(samples, np.diff(samples)):
                continue
            whole = values[:, place]
            if before is not None:
                whole = np.concatenate((before[place : place + 1], whole))
            turns = [self.readings.turn] if self.readings.turn else []
            found = find_jumps(whole, turns, all_whole(samples), steering)
            reset = not steering and self.readings.max_speed is None
            if found is not None and (reset or found.wraps_at is not None):
                shift = 0 if before is None else 1
                at = [self._row(int(k) - shift) for k in found.rows]
                raise self._jumping(column, found, at, steering)

    def _check_steps(self, stamps: Floats, turned: Floats, raw: bool) -> None:
        """Refuses single steps that no wheel makes: lost readings, counters set to another value."""
        known = self.readings
        unknown = (raw and (known.wraps or known.scale is None)) or known.kind in ("speeds", "increments")
        if unknown or known.max_speed is not None or len(stamps) < FEW_ROWS:
            return
        scale = np.ones(1) if known.scale is None or not raw else np.abs(known.scale)
        radii = np.array([wheel.radius for wheel in known.rover.wheels]) * scale
        usual = float(np.median(np.diff(stamps[:SAMPLE])))
        if usual <= 0.0 or longest_step(turned) * float(radii.max()) <= FASTEST_STEP * usual:
            return
        longest = FASTEST_STEP * np.maximum(np.diff(stamps), usual)
        for place, column in enumerate(known.wheels):
            found = lost_readings(turned[:, place] * radii[place], longest)
            if found is not None:
                at = [self._row(int(k)) for k in found.rows]
                steps = f"from {found.before:.4g} to {found.after:.4g} m at the rim"
                what = f'"{column.header}" jumps in {rows(at)} ({steps})'
                raise _too_far(what)
            if goes_to_and_fro(turned[:, place] * radii[place], longest):
                what = f'"{column.header}" goes to and fro from row to row, farther than a wheel can'
                guess = "readings of two rovers or of two logs in one table?"
                raise ImplausibleReadingError(f"{what}: {guess} Make a file of each, or {AS_READ}")

    def _jumping(
        self, column: Column, found: Jumps, at: Sequence[int], steering: bool
    ) -> ImplausibleReadingError:
        """The error for a column that jumps."""
        known = self.readings
        steps = f"from {number(found.before)} to {number(found.after)}"
        if found.wraps_at is not None:
            counts = known.counts_unknown and not steering
            stated = known.steering_stated if steering else known.wheels_stated
            turn = None if steering else known.turn
            if turn is None and known.kind == "angles" and found.wraps_at in WHOLE_TURNS and not stated:
                turn = found.wraps_at  # degrees, or whole turns
            proposal = encoders(wraps_at=found.wraps_at, counts=counts, turn=turn, steering=steering)
            what = f'"{column.header}" wraps at {number(found.wraps_at)} in {rows(at)} ({steps})'
            return ImplausibleReadingError(f"{what}: give ", proposal)
        what = f'"{column.header}" was set anew in {rows(at)} ({steps})'
        return _too_far(what)

    def _check_motion(
        self,
        stamps: Floats,
        raw: Floats,
        angles: Floats | None,
        steering: Floats | None,
        chosen: NDArray[np.int64],
    ) -> None:
        known = self.readings
        scale = np.ones(1) if known.scale is None else known.scale
        unknown = known.scale is None or (known.wraps and known.wraps_at is None)
        if angles is None and (unknown or known.kind == "increments"):
            return
        times = stamps[chosen]
        if angles is not None:
            turned = angles[chosen]
        elif known.kind == "speeds":
            rates = raw[chosen] * scale
            periods = np.diff(times, prepend=times[0])[:, None]
            turned = np.cumsum(np.nan_to_num(rates * periods), axis=0)
            turned[:, np.isnan(rates).all(axis=0)] = np.nan
            turned += 0.0 if self._last is None else self._last[2]
        elif known.wraps and known.wraps_at is not None:
            before = raw[:1] if self._last is None else self._last[1][None]
            steps = np.diff(raw.astype(np.float64), axis=0, prepend=before)
            around = np.where(np.isfinite(known.wraps_at), known.wraps_at, 1.0)
            steps -= np.where(np.isfinite(known.wraps_at), around * np.round(steps / around), 0.0)
            turned = np.cumsum(np.nan_to_num(steps), axis=0)[chosen] * scale
            turned += 0.0 if self._last is None else self._last[2]
        else:
            turned = np.take(raw, chosen, axis=0) * scale
        turned = np.asfortranarray(turned)  # the checks that follow go along columns
        if not np.isfinite(turned).all():
            turned = np.where(np.isfinite(turned), turned, np.nan)
        self._turned = turned[-1].copy()
        if self._last is not None and len(self._last[2]):
            times = np.concatenate(([self._last[0]], times))
            turned = np.vstack((self._last[2], turned))
        self.turns.add(turned)
        periods = np.diff(times)
        later = periods > 0.0
        if not later.any():
            return
        steps = np.diff(turned, axis=0)
        rates = np.asfortranarray((steps if later.all() else steps[later]) / periods[later][:, None])
        ends = chosen[-len(periods) :][later]
        radii = np.array([wheel.radius for wheel in known.rover.wheels])
        if not known.clock_stated and not self._clock_known:
            rims = np.nan_to_num(np.fmax.reduce(np.abs(rates) * radii, axis=1))
            check_clock(stamps[:SAMPLE], rims, known.kind == "speeds", known.time, self._row(0))
            self._clock_known = bool(rims.any())
        middles = None
        if steering is not None:
            middles = np.where(np.isfinite(steering[ends]), steering[ends], np.nan)
            if not known.steering_stated:
                row = self._row(0)
                check_steering(known.rover, middles, rates, known.steering, row, known.named)
        if known.max_speed is not None:
            return
        self.agreement.add(rates, middles)
        found = check_motion(known.rover, rates, middles, periods[later])
        if found is not None:
            stretch, wheel, figure = found
            raise impossible(known, wheel, f"{figure} in row {self._row(int(ends[stretch]))}")

    def _check_gaps(self, stamps: Floats, readings: Floats) -> None:
        """Warns of long times without readings while wheels turn."""
        known, shift, before = self.readings, 0, self._last_read
        self._last_read = readings[-1].copy()
        if known.kind == "increments":
            self._lost.add(stamps, readings)
            return
        begin = stamps[0] if self._last is None else self._last[0]
        if max(longest_step(stamps), float(stamps[0] - begin)) <= LONG_GAP:
            return
        if self._last is not None:
            stamps, shift = np.concatenate(([begin], stamps)), 1
            readings = np.vstack((before, readings))
        found = gap_line(stamps, readings, known.kind, known.max_gap)
        if found is not None:
            gap, turning, place = found
            what = f"{gap} before row {self._row(place - shift)}, with {turning}"
            longest = stamps[place] - stamps[place - 1] + 0.1
            self.warn(f"{what}: the path across is a guess; max_gap={longest:.1f} accepts it")


def _too_far(what: str) -> ImplausibleReadingError:
    return ImplausibleReadingError(f"{what}: give ", max_speed(10.0), "; a step beyond it counts as none")
