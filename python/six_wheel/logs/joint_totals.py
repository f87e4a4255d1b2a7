"""Angles of joints from the readings of their encoders, chunk after chunk."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Encoder
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.kinematics.poses import Floats

Encoders: TypeAlias = "Encoder | Mapping[str, Encoder] | None"


@dataclass(frozen=True)
class JointRows:
    """Consecutive rows of a log.

    Attributes
    ----------
    rows : array, shape (n,)
        Numbers of the rows in the file, from 1; those left out are missing.
    stamps : array, shape (n,)
        Seconds since the log's `origin`, increasing.
    steering : array, shape (n, steered wheels), or None
        Steering angles in the order of `Rover.steered_wheel_names` [rad]; None if no wheel steers.
    wheel_angles : array, shape (n, wheels)
        Running totals in the order of `Rover.wheel_names` [rad]; NaN for a wheel without a readings.
    truth : array, shape (n, 3), or None
        Poses x, y, yaw [m, m, rad], NaN in rows without one; None if the log has no such columns.
    yaw_rate : array, shape (n,), or None
        Of a gyroscope about the rover's z [rad/s], NaN in rows without one; None if the log has none.
    """

    rows: NDArray[np.int64]
    stamps: Floats
    steering: Floats | None
    wheel_angles: Floats
    truth: Floats | None
    yaw_rate: Floats | None = None


def encoder_of_each(argument: str, given: Any, names: Sequence[str]) -> list[Encoder]:
    """One encoder for every joint, from what `Odometry` takes: one, one each, or some by name. Raises
    `ValueError` if their number or a name does not fit."""
    if isinstance(given, Mapping):
        if strangers := [name for name in given if name not in names]:
            raise ValueError(f"{argument} must name some of {', '.join(names)}, got {strangers[0]!r}")
        return [given.get(name, Encoder()) for name in names]
    if given is None or isinstance(given, Encoder):
        return [given or Encoder()] * len(names)
    if not isinstance(given, Sequence) or not all(isinstance(one, Encoder) for one in given):
        rule = f"{argument} must be an Encoder, several of them or a dict of them by name"
        raise ArgumentTypeError(f"{rule}, got {given!r}")
    if len(given) != len(names):
        raise ValueError(f"{argument} must be one or {len(names)}, got {len(given)}")
    return list(given)


def encoder_of(name: str, encoders: Encoders, wheel: str, needed: bool) -> Encoder | None:
    """The encoder of a wheel. Raises `ValueError` if one is needed and there is none."""
    found = encoders.get(wheel) if isinstance(encoders, Mapping) else encoders
    if found is None and needed:
        raise ValueError(f"{name} must say how many ticks a turn of {wheel} has, got none")
    return found


class Total:
    """The angle of a joint from the readings of its encoder, from one chunk to the next."""

    def __init__(
        self,
        encoder: Encoder | None,
        increments: bool,
        absolute: bool = False,
        longest: float | None = None,
    ) -> None:
        self._encoder, self._increments, self._absolute = encoder, increments, absolute
        self._longest, self._stamp = longest, math.nan  # rate beyond which a step is none [rad/s]
        self._away = 0.0, math.nan  # the last step that was none, and when
        self._counts, self._last = 0.0, math.nan

    @property
    def counts(self) -> bool:
        """True if the encoder has a whole number of counts per turn."""
        ticks = None if self._encoder is None else self._encoder.ticks_per_turn
        return ticks is not None and ticks % 1.0 == 0.0

    def advance(self, readings: Floats, stamps: Floats) -> Floats:
        """Angles (n,) [rad]."""
        encoder = self._encoder
        if encoder is None and not self._increments and self._longest is None:
            return readings
        encoder = encoder or Encoder()
        if first := math.isnan(self._last):
            # A wheel has turned since anywhere: from zero on no digit is lost to a large count.
            self._counts = self._first(encoder, readings[0]) if self._absolute else 0.0
        steps = readings.copy() if self._increments else np.diff(readings, prepend=self._last)
        if first:
            steps[0] = 0.0  # turned before the log begins
        if encoder.wraps_at is not None:
            steps -= encoder.wraps_at * np.round(steps / encoder.wraps_at)
        if self._longest is not None:
            self._without_jumps(steps, stamps, abs(encoder.angle_per_tick))
        counts = self._counts + np.cumsum(steps)
        self._counts, self._last = float(counts[-1]), float(readings[-1])
        return counts * encoder.angle_per_tick + (encoder.offset if self._absolute else 0.0)

    def _without_jumps(self, steps: Floats, stamps: Floats, scale: float) -> None:
        """Steps that no wheel makes become 0; one that takes the last of them back leaves what was turned."""
        longest = (self._longest or 0.0) / scale
        for row in np.flatnonzero(np.abs(steps) > longest * np.diff(stamps, prepend=self._stamp)).tolist():
            step, stamp = self._away
            turned, self._away = step + float(steps[row]), (float(steps[row]), float(stamps[row]))
            back = abs(turned) <= longest * (float(stamps[row]) - stamp)
            steps[row] = turned if back else 0.0
            self._away = (0.0, math.nan) if back else self._away
        self._stamp = float(stamps[-1])

    @staticmethod
    def _first(encoder: Encoder, reading: float) -> float:
        """The counts to begin with: an absolute counter that starts over has no turns to tell."""
        if encoder.wraps_at is None:
            return reading
        zero = encoder.offset / encoder.angle_per_tick
        return reading - encoder.wraps_at * round((reading + zero) / encoder.wraps_at)


class Integral:
    """The angle of a wheel from its rate, from one chunk to the next."""

    def __init__(self) -> None:
        self._sum, self._last = 0.0, (math.nan, math.nan)

    def advance(self, readings: Floats, stamps: Floats) -> Floats:
        """Angles (n,) [rad]. A measured rate is that of an instant: from one to the next their mean holds."""
        rate, stamp = (readings[0], stamps[0]) if math.isnan(self._last[0]) else self._last
        held = np.concatenate([[rate], readings])
        totals: Floats = self._sum + np.cumsum((held[1:] + held[:-1]) / 2 * np.diff(stamps, prepend=stamp))
        self._sum, self._last = float(totals[-1]), (float(readings[-1]), float(stamps[-1]))
        return totals


def whole_columns(totals: Sequence[Total | Integral], columns: Floats, stamps: Floats) -> Floats:
    """Angles (n, joints) [rad] of a whole log, of each column by its total; missing readings stay NaN."""
    found = np.full_like(columns, math.nan)
    for place, total in enumerate(totals):
        rows = np.flatnonzero(np.isfinite(columns[:, place]))
        if len(rows):
            found[rows, place] = total.advance(columns[rows, place], stamps[rows])
    return found
