"""Wheels that stand still while others turn or the truth moves, and rates that are read as angles."""

import math
from dataclasses import dataclass, field

import numpy as np

from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.proposals import columns, encoders
from six_wheel.logs.plausibility.readings import Readings

ROWS = 50  # of a log in which a wheel does not move
TURN = 4.0 * math.pi  # [rad] that another one turns meanwhile
END = 16.0 * math.pi  # [rad] that another one turns after a wheel has moved for the last time
LITTLE = (1e-3, 2.0 * math.pi)  # [rad] that no wheel of a drive is within
TO_AND_FRO = 2.5  # times what it spans, that a rate goes up and down
LONG = 400, 20.0  # rows and [s] of a log for which that counts
LEVELS = 8  # different readings at least, of a wheel that turns and does not tremble by single counts
AWAY = 1.0  # [rad] from 0, from which on angles are not 0 again of all wheels, as rates are
TRAVELLED = 0.3  # [m] of a truth
SLIDES = 1.5  # times what its wheels roll, that a rover hardly comes along
STEADY = 10.0  # times the usual step of a truth, that it moves


@dataclass
class WheelTurns:
    """Rotation of the wheels in a log, by some of its rows as they come."""

    least: float = AWAY  # least distance from 0 of a wheel that counts as away [rad]
    low: Floats = field(default_factory=lambda: np.zeros(0))  # (wheels,): least and largest totals [rad]
    high: Floats = field(default_factory=lambda: np.zeros(0))
    # (wheels, wheels): totals of all wheels when each one moved last [rad].
    stopped: Floats = field(default_factory=lambda: np.zeros((0, 0)))
    way: Floats = field(default_factory=lambda: np.zeros(0))  # (wheels,): sums of all turns, to and fro [rad]
    # Some different totals of the first wheel that moves [rad].
    levels: Floats = field(default_factory=lambda: np.zeros(0))
    # Distance of the farthest wheel before all rested at 0 again and went on, 0 if they never did [rad].
    returned: float = 0.0
    _last: Floats = field(default_factory=lambda: np.zeros(0))
    _away: float = 0.0
    _rested: float = 0.0
    _truth: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    _usual: float = 0.0
    _of_rows: bool = True

    def see(self, truth: Floats | None, of_rows: bool = True) -> None:
        """Take in poses of a truth (n, 3) [m, m, rad], NaN without one; `of_rows` if each is of a row."""
        self._of_rows = of_rows
        there = np.zeros((0, 2)) if truth is None else truth[np.isfinite(truth[:, :2]).all(axis=1), :2]
        if len(there) > 1:
            self._usual = max(self._usual, float(np.median(np.hypot(*np.diff(there, axis=0).T))))
        if len(there):
            self._truth = np.vstack((self._truth[:1], there[:1], there[-1:]))

    @property
    def travelled(self) -> float:
        """From the first position of the truth to the last [m]; 0 where that is no more than its noise."""
        if len(self._truth) < 2:
            return 0.0
        way = float(np.hypot(*(self._truth[-1] - self._truth[0])))
        return way if way > max(TRAVELLED, STEADY * self._usual) else 0.0

    def add(self, turned: Floats) -> None:
        """Take in totals (n, wheels) [rad], NaN without a reading."""
        low, high = np.fmin.reduce(turned, axis=0), np.fmax.reduce(turned, axis=0)
        if not len(self._last):
            self.low, self.high = low, high
            self.stopped = np.tile(turned[0], (turned.shape[1], 1))
            self.way = np.zeros(turned.shape[1])
        self.low, self.high = np.fmin(self.low, low), np.fmax(self.high, high)
        steps = np.abs(np.diff(turned, axis=0))
        self.way += np.nansum(steps, axis=0)
        moves = steps > 0.0
        for wheel in np.flatnonzero(moves.any(axis=0)).tolist():
            self.stopped[wheel] = turned[len(moves) - int(np.argmax(moves[::-1, wheel]))]
        self._last = turned[-1]
        if len(self.levels) < LEVELS:
            some = turned[: 100 * LEVELS, int(np.argmax(np.nan_to_num(self.high - self.low)))]
            self.levels = np.union1d(self.levels, some[np.isfinite(some)])[:LEVELS]
        self._watch(turned)

    def _watch(self, turned: Floats) -> None:
        """Note how far wheels were before all of them rested at 0 and then went on."""
        still = (turned == 0.0).all(axis=1)
        if not self._rested and not (still[1:] & still[:-1]).any():
            self._away = max(self._away, float(np.fmax.reduce(np.abs(turned), axis=None)))
            return
        farthest = np.nan_to_num(np.abs(turned)).max(axis=1)
        before = np.maximum(np.maximum.accumulate(farthest), self._away)
        rests = (farthest[1:] == 0.0) & (farthest[:-1] == 0.0) & (before[1:] > self.least)
        if rests.any():
            first = int(np.argmax(rests))
            self._rested = self._rested or float(before[first])
            farthest = farthest[first:]
        if self._rested and farthest.max() > self.least:
            self.returned = self._rested
        self._away = float(before[-1])

    def without_sign(self, known: Readings) -> list[str]:
        """Lines about wheels that never turn back, beside columns with their directions."""
        said = []
        for place, column in enumerate(known.wheels):
            header, moved = known.directions.get(column.wheel), float((self.high - self.low)[place])
            if header is not None and moved > 0.0 and self.way[place] <= moved * (1.0 + 1e-9):
                what = f'"{header}" is not read, and "{column.header}" never goes back'
                said.append(f"{what}: has it a sign? Readings must fall where a wheel turns backwards")
        return said

    def doubts(self, known: Readings, rows: int, duration: float) -> list[str]:
        """Lines about wheels that do not turn, or hardly, and angles that may be something else."""
        wheels, totals = known.wheels, known.kind == "angles"
        moved = self.high - self.low
        heard = np.isfinite(moved)
        if rows < ROWS or not heard.any():
            return []
        fastest = int(np.argmax(np.where(heard, moved, -1.0)))
        if moved[fastest] == 0.0:
            way = self.travelled
            what = f"no wheel turns in all {rows} rows, and the truth moves {way:.3g} m"
            return [f"{what}: are the encoders connected?"] if way else []
        if totals and self.returned and not known.wheels_stated:
            units = {column.header: f"{column.wheel} [rad/s]" for column in wheels if column.header}
            remedy = f" {columns(units)}, or other units" if known.named else ' readings="speeds" in Python'
            what = f"all wheels rest at 0 again after {self.returned:.4g} rad"
            return [f"{what}: rates, and no angles? Give{remedy}"]
        trembles = len(self.levels) < LEVELS
        little = not trembles and LITTLE[0] < moved[fastest] < min(LITTLE[1], self.way[fastest] / TO_AND_FRO)
        if little and rows >= LONG[0] and duration >= LONG[1]:
            most = f"no wheel turns by more than {moved[fastest]:.3g} rad in {duration:.3g} s"
            if totals:
                return [f"{most}: are these angles, and not rates or what was turned in each row?"]
            if known.kind == "ticks" and not known.increments_stated:
                return [f"{most}: are these the counts of each row? Give {encoders(increments=True)}"]
        said = []
        rolled = float(np.nanmax(self.way * np.array([wheel.radius for wheel in known.rover.wheels])))
        if self._of_rows and self.travelled > SLIDES * rolled:
            what = f"the truth moves {self.travelled:.3g} m from its first place to its last"
            said.append(
                f"{what} while no wheel rolls more than {rolled:.3g} m: are the readings in this unit?"
            )
        for place, wheel in enumerate(known.rover.wheels):
            if not heard[place] or wheel.roller_angle:
                continue
            header, other = wheels[place].header, wheels[fastest].header
            since = np.nan_to_num(np.abs(self._last - self.stopped[place]))
            if moved[place] == 0.0 and moved[fastest] > TURN:
                what = f'"{header}" stands still in all {rows} rows while "{other}" turns'
                remedy = "is its encoder connected?"
                if known.named and heard.sum() > 2:
                    remedy += f" Without it: {columns({header: ''})}"
                said.append(f"{what} {moved[fastest]:.4g} rad: {remedy}")
            elif moved[place] > 0.0 and since.max() > END:
                other = wheels[int(np.argmax(since))].header
                what = f'"{header}" stands still from some row on while "{other}" turns {since.max():.4g} rad'
                said.append(f"{what}: does its encoder still count?")
        return said
