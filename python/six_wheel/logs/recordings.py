"""Recordings of a drive: what the wheels reported and, where it was measured, how the rover really moved."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from numbers import Real
from os import PathLike
from typing import TYPE_CHECKING, Any, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import Rover, check_kind, wrap_angle
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.objects.tables import (
    Columns,
    Tabular,
    headers_of,
    joint_columns,
    pose_columns,
    rows_of,
)  # fmt: skip
from six_wheel.kinematics.poses import Floats, as_poses
from six_wheel.logs.joint_totals import Integral, Total, encoder_of_each, whole_columns
from six_wheel.logs.plausibility.proposals import Column
from six_wheel.logs.plausibility.whole_numbers import check_increments

if TYPE_CHECKING:
    from six_wheel.kinematics.odometry.tracks import Track
    from six_wheel.kinematics.odometry.tracks3 import Track3

OPTIONS = ("readings", "increments", "wheel_encoders", "steering_encoders")


def interpolate(stamps: Floats, poses: Floats, wanted: Floats) -> tuple[Floats, Floats]:
    """Poses at `wanted` times, all within the recording, and their rates of change, both of shape (n, 3).

    Even motion along the chord between two rows: it differs from the arc by less than the sensor sees.
    """
    row = np.clip(np.searchsorted(stamps, wanted, side="right") - 1, 0, len(stamps) - 2)
    length, step = (stamps[row + 1] - stamps[row])[:, None], poses[row + 1] - poses[row]
    turned = np.isfinite(step[:, 2])  # positions may come without headings
    step[turned, 2] = wrap_angle(step[turned, 2])
    return poses[row] + (wanted - stamps[row])[:, None] / length * step, step / length


@checked_class
@dataclass(frozen=True, eq=False)
class GroundTruth(Tabular):
    """Poses, positions or headings measured from outside, with stamps of their own.

    Parameters
    ----------
    stamps : array_like, shape (n,)
        When, in the clock of the log up to a constant offset [s]; each later than the one before, n >= 2.
    poses : array_like, shape (n, 3), (n, 2) or (n, 6)
        x, y, yaw of what was tracked, in a fixed frame [m, m, rad]. Positions alone, as of a single GPS or a
        total station, have two columns, or NaN for yaw; headings alone NaN for x and y. Six columns are x, y,
        z, roll, pitch, yaw, as those of a `Track3`; `poses` keeps x, y and yaw of them.
    max_gap : float, default 1.5
        Longest time between two rows across which is interpolated [s].
    space : array_like, shape (n, 3), optional
        z, roll, pitch [m, rad, rad], where they are not in `poses`.

    Raises
    ------
    ValueError
        If the shapes do not fit, a number is not finite or time does not go on.
    """

    stamps: Floats | Any
    poses: Floats | Any
    max_gap: float = 1.5
    space: Floats | Any = field(default=None, repr=False)

    def __post_init__(self) -> None:
        stamps = _numbers("stamps", self.stamps)
        if stamps.ndim != 1 or len(stamps) < 2:
            raise ValueError(f"stamps must have shape (n,), n >= 2, got {stamps.shape}")
        if not (isinstance(self.max_gap, Real) and self.max_gap > 0.0):
            raise ValueError(f"max_gap must be positive, got {self.max_gap!r}")
        poses = _numbers("poses", self.poses)
        space = self.space
        if poses.ndim == 2 and poses.shape[1] == 6:
            poses, space = poses[:, [0, 1, 5]], poses[:, 2:5]
        if space is not None:
            space = as_poses("space", _numbers("space", space), len(stamps))
        if poses.ndim == 2 and poses.shape[1] == 2:
            poses = np.column_stack((poses, np.full(len(poses), math.nan)))
        checked = poses.copy()
        if poses.ndim == 2 and poses.shape[1] == 3:
            absent = [bool(np.isnan(poses[:, part]).all()) for part in (slice(0, 2), slice(2, 3))]
            if all(absent):
                raise ValueError("poses must have positions or headings, got neither")
            checked[:, np.repeat(absent, [2, 1])] = 0.0
        as_poses("poses", checked, len(stamps))
        later = np.isfinite(stamps[0]) & (np.diff(stamps) > 0.0) & np.isfinite(stamps[1:])
        if not later.all():
            row = int(np.argmin(later)) + 1
            raise ValueError(f"stamps must grow, got {stamps[row]} after {stamps[row - 1]} in row {row}")
        _freeze(self, stamps=stamps, poses=poses, space=space)

    @property
    def has_space(self) -> bool:
        """True if z, roll and pitch are known beside x, y and yaw."""
        return self.space is not None and self.has_positions and self.has_yaw

    @property
    def has_positions(self) -> bool:
        """True if x and y are known."""
        return not np.isnan(self.poses[0, 0])

    @property
    def has_yaw(self) -> bool:
        """True if yaw is known."""
        return not np.isnan(self.poses[0, 2])

    def covers(self, stamps: ArrayLike, margin: float = 0.0) -> NDArray[np.bool_]:
        """True where the truth is known throughout `margin` [s] before and after `stamps` [s]. Shape (m,)."""
        wanted = np.asarray(stamps, dtype=np.float64)
        first = np.searchsorted(self.stamps, wanted - margin, side="right") - 1
        last = np.searchsorted(self.stamps, wanted + margin, side="left")
        inside = (first >= 0) & (last < len(self.stamps))
        gaps = np.concatenate(([0], np.cumsum(np.diff(self.stamps) > self.max_gap)))
        ends = np.clip(first, 0, None), np.clip(last, None, len(self.stamps) - 1)
        known: NDArray[np.bool_] = inside & (gaps[ends[0]] == gaps[np.maximum(*ends)])
        return known

    def at(self, stamps: ArrayLike) -> Floats:
        """Poses x, y, yaw at `stamps` [s], between the recorded ones, shape (m, 3), or (3,) for a number; NaN
        outside the recording and in gaps; an error if they are no numbers."""
        wanted = _numbers("stamps", stamps)
        poses, _ = interpolate(self.stamps, self.poses, wanted.ravel())
        poses[~self.covers(wanted.ravel())] = math.nan
        return poses.reshape(*wanted.shape, 3)

    def at_in_space(self, stamps: ArrayLike) -> Floats:
        """Poses x, y, z, roll, pitch, yaw at `stamps` [s], (m, 6) or (6,); NaN as in `at`, or if unknown."""
        poses = self.at(stamps)
        x, y, yaw = poses.reshape(-1, 3).T
        known = np.full((len(self), 3), math.nan) if self.space is None else self.space[:, [0, 2, 1]]
        space, _ = interpolate(self.stamps, known, _numbers("stamps", stamps).ravel())
        space[np.isnan(x)] = math.nan
        rows = np.column_stack((x, y, space[:, 0], space[:, 2], space[:, 1], yaw))
        return rows.reshape(*poses.shape[:-1], 6)

    def __len__(self) -> int:
        return len(self.stamps)

    def _columns(self) -> Columns:
        columns = pose_columns(self.stamps, self.poses)
        if self.space is not None:
            columns |= pose_columns(self.stamps, self.space, {"z": "m", "roll": "rad", "pitch": "rad"})
        return columns

    def __repr__(self) -> str:
        return f"GroundTruth({len(self)} poses, {self.stamps[-1] - self.stamps[0]:.1f} s)"


@checked_class
@dataclass(frozen=True, eq=False)
class WheelLog(Tabular):
    """Encoder readings of one drive, and the truth if it is known.

    Parameters
    ----------
    stamps : array_like, shape (n,)
        Time of each row [s].
    steering : array_like, shape (n, steered wheels), or None
        Angles of the steered wheels at those times, in the rover's order [rad]; None without such wheels.
    wheel_angles : array_like, shape (n, wheels)
        Running totals of each wheel from any start, in the rover's order [rad]. NaN all the
        way down where a passive wheel has no encoder; NaN in a row, here or in `steering`, is a reading that
        is missing: `dead_reckon` flags that row, `calibrate` leaves it out.
    truth : GroundTruth, or array_like of shape (n, 3), optional
        The reference; bare poses are taken to be measured at `stamps`.
    name, session : str
        Name of the drive, and a name shared by drives of the same day, floor and load.
    yaw_rate, yaw : array_like, shape (n,), optional
        Of a gyroscope [rad/s], and absolute yaw of a sensor with a zero of its own [rad].
    options : mapping
        Options of `Odometry` for a log that is not in radians: `readings`, `increments`,
        `wheel_encoders`, `steering_encoders`. `dead_reckon` and `calibrate` mind them.
    plausibility : bool
        True if `dead_reckon` and `calibrate` refuse readings that no rover has; False if they were checked.
    rover : Rover, optional
        Whose joints name the columns of tables; that of `read_log` and `simulate`.

    Raises
    ------
    ValueError
        If shapes do not fit, a stamp is not finite or before the one above it, or an option is none of these.
    """

    stamps: Floats | Any  # an array, made of what is given
    steering: Floats | Any  # None of a rover that does not steer
    wheel_angles: Floats | Any
    truth: GroundTruth | Any = None
    name: str = ""
    session: str = field(default="")
    yaw_rate: Floats | Any = None
    yaw: Floats | Any = None
    options: Mapping[str, Any] = field(default_factory=dict)
    plausibility: bool = field(default=True, repr=False)
    rover: Rover | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        stamps = _numbers("stamps", self.stamps)
        if stamps.ndim != 1 or len(stamps) < 2:
            raise ValueError(f"stamps must have shape (n,), n >= 2, got {stamps.shape}")
        _check_order(stamps)
        angles = _numbers("wheel_angles", self.wheel_angles)
        if angles.ndim != 2 or len(angles) != len(stamps):
            raise ValueError(f"wheel_angles must have shape ({len(stamps)}, wheels), got {angles.shape}")
        steering = None if self.steering is None else _numbers("steering", self.steering)
        if steering is not None and (steering.ndim != 2 or len(steering) != len(stamps)):
            rule = f"steering must have shape ({len(stamps)}, steered wheels)"
            raise ValueError(f"{rule}, got {steering.shape}")
        check_kind("rover", self.rover) if self.rover is not None else None
        truth = self.truth
        if truth is not None and not isinstance(truth, GroundTruth):
            truth = GroundTruth(stamps, truth)
        _freeze(self, stamps=stamps, steering=steering, wheel_angles=angles, truth=truth)
        if not isinstance(self.options, Mapping):
            raise ArgumentTypeError(f"options must be a mapping, got {self.options!r}")
        if strangers := [name for name in self.options if name not in OPTIONS]:
            raise ValueError(f"options must be some of {', '.join(OPTIONS)}, got {strangers[0]!r}")
        for name in ("yaw_rate", "yaw"):
            if (given := getattr(self, name)) is not None:
                column = _numbers(name, given)
                if column.shape != stamps.shape:
                    raise ValueError(f"{name} must have shape ({len(stamps)},), got {column.shape}")
                _freeze(self, **{name: column})

    @classmethod
    def from_increments(
        cls,
        stamps: ArrayLike,
        steering: ArrayLike | None,
        increments: ArrayLike,
        truth: GroundTruth | ArrayLike | None = None,
        *,
        name: str = "",
        session: str = "",
    ) -> Self:
        """A log from `increments` of the wheels since the row before [rad], the first from 0; `stamps`,
        `steering`, `truth`, `name`, `session` and errors as of the class."""
        steps = np.asarray(increments, dtype=np.float64)
        for number, column in enumerate(steps.T if steps.ndim == 2 else ()):
            check_increments(column, Column(f"increments of wheel {number}", ""), 0)
        return cls(stamps, steering, np.cumsum(steps, axis=0), truth, name, session)

    @classmethod
    def from_pandas(cls, frame: Any, rover: Rover, *, name: str = "", **options: Any) -> Self:
        """A log of a DataFrame or a dict of columns: joints by their names, ``time``, and what else there is.

        Parameters
        ----------
        frame : DataFrame or mapping
            Columns as `dead_reckon` takes them; ``yaw_rate`` and the truth, ``x``, ``y``, ``yaw``, if there.
        rover : Rover
            Names the joints.
        name, **options
            As of `WheelLog`; `columns`, `stamp_unit`, `plausibility` as of `dead_reckon`.

        Raises
        ------
        ValueError
            If a joint or the time is missing.
        """
        from six_wheel.logs.frames.tabular_input import check_table, table, whole

        check_table("frame", frame)
        how = {key: options.pop(key) for key in ("stamp_unit", "plausibility") if key in options}
        log = whole(table(rover, frame, options.pop("columns", None), {}, options, **how))
        headers = set(headers_of(frame))
        truth = None
        if headers >= {"x", "y", "yaw"}:
            places = rows_of(frame, ("x", "y", "yaw"))
            known = np.isfinite(places).all(axis=1)
            truth = GroundTruth(log.stamps[known], places[known])
        rate = rows_of(frame, ("yaw_rate",))[:, 0] if "yaw_rate" in headers else None
        named: dict[str, Any] = {"name": name, "yaw_rate": rate, "options": options, "rover": rover}
        return cls(log.stamps, log.steering, log.wheels, truth, **named)

    def _columns(self, rover: Rover | None = None) -> Columns:
        """Columns by the joints of a rover, by default its own; without by number, as ``steering_0``."""
        rover, columns = self.rover if rover is None else rover, {"time": ("s", self.stamps)}
        unit = "ticks" if {"wheel_encoders", "steering_encoders"} & set(self.options) else "rad"
        if self.steering is not None:
            columns |= joint_columns(rover, "steering", self.steering, unit)
        columns |= joint_columns(rover, "wheel", self.wheel_angles, unit)
        if self.yaw_rate is not None:
            columns["yaw_rate"] = ("rad/s", self.yaw_rate)
        if self.truth is not None:
            columns |= pose_columns(self.stamps, self.truth.at(self.stamps))
        return columns

    def in_radians(self, rover: Rover) -> WheelLog:
        """The same log as running totals and angles in radians, as `options` say how to read it.

        Counters that start over are followed the shorter way; speeds change evenly from row to row;
        the first row of increments counts from 0.

        Raises
        ------
        ValueError
            If an option does not fit the rover.
        """
        if not (known := self.options):
            return self
        wheels = encoder_of_each("wheel_encoders", known.get("wheel_encoders"), rover.wheel_names)
        steered = rover.steered_wheel_names
        joints = encoder_of_each("steering_encoders", known.get("steering_encoders"), steered)
        readings = known.get("readings", "angles")
        if readings not in ("angles", "speeds", "ticks"):
            raise ValueError(f"readings must be 'angles', 'speeds' or 'ticks', got {readings!r}")
        turned, steering = self.wheel_angles, self.steering
        for name, columns, one_each in (("wheel_angles", turned, wheels), ("steering", steering, joints)):
            if columns is not None and columns.shape[1] != len(one_each):
                raise ValueError(f"{name} must have shape (n, {len(one_each)}), got {columns.shape}")
        if readings == "speeds":
            turned = whole_columns([Integral() for _ in wheels], turned, self.stamps)
        increments = readings != "speeds" and bool(known.get("increments"))
        angles = whole_columns([Total(one, increments) for one in wheels], turned, self.stamps)
        if steering is not None:
            totals = [Total(one, increments=False, absolute=True) for one in joints]
            steering = whole_columns(totals, steering, self.stamps)
        return replace(self, steering=steering, wheel_angles=angles, options={})

    @property
    def duration(self) -> float:
        """From the first row to the last [s]."""
        return float(self.stamps[-1] - self.stamps[0])

    def __len__(self) -> int:
        return len(self.stamps)

    def __repr__(self) -> str:
        known = "without truth" if self.truth is None else "with truth"
        return f"{type(self).__name__}({self.name!r}, {len(self)} rows, {self.duration:.1f} s, {known})"


Reference: TypeAlias = "GroundTruth | WheelLog | Track | Track3 | str | PathLike[str]"


def as_truth(given: object) -> GroundTruth:
    """The reference in an object: a `GroundTruth`, the truth of a `WheelLog`, the poses of a track, or those
    of the file of a path, with the stamps of the file. Raises `ValueError` if it is a log without a truth, or
    a file without poses. Raises `TypeError` if it tells no poses with their stamps."""
    if isinstance(given, str | PathLike):
        from six_wheel.logs.ground_truth import read_truth

        stamps, poses, _ = read_truth(given)
        return GroundTruth(stamps, poses)
    if isinstance(given, WheelLog):
        if given.truth is None:
            raise ValueError(f"truth must be known, got a log without one: {given!r}")
        return given.truth
    if isinstance(given, GroundTruth):
        return given
    try:
        return GroundTruth(given.stamps, given.poses)  # type: ignore[attr-defined]
    except AttributeError:
        known = "a GroundTruth, a WheelLog with one, a Track, or the path of a file of poses"
        raise TypeError(f"truth must be {known}, got {type(given).__name__}") from None


def _check_order(stamps: Floats) -> None:
    """Fails where time is no number or runs backwards; the same time twice is for readers to leave out."""
    steps = np.diff(stamps)
    if np.min(steps) >= 0.0 and np.isfinite(stamps[[0, -1]]).all():
        return
    if (bad := ~np.isfinite(stamps)).any():
        raise ValueError(f"stamps must be finite, got {stamps[bad][0]} in row {int(np.argmax(bad))}")
    row = int(np.argmax(steps < 0.0)) + 1
    raise ValueError(f"stamps must not run backwards, got {stamps[row]} after {stamps[row - 1]} in row {row}")


def _numbers(name: str, values: object) -> Floats:
    """A copy of what is given, as numbers."""
    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        got = reprlib.repr(values)
        raise ArgumentTypeError(f"{name} must be rows of as many numbers each, got {got}") from None


def _freeze(record: object, **arrays: object) -> None:
    """Put checked values into a frozen record, arrays read-only."""
    for name, value in arrays.items():
        if isinstance(value, np.ndarray):
            value.setflags(write=False)
        object.__setattr__(record, name, value)
