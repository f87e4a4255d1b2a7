"""Whole logs: `dead_reckon` from arrays, tables or files to a `Track`, and what the wheels say about slip."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Noise, Rover
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.objects.checked_values import check_columns
from six_wheel.kinematics.objects.flags import TextFlag
from six_wheel.kinematics.objects.notebooks import Shown
from six_wheel.kinematics.objects.short_text import described, few, short_repr
from six_wheel.kinematics.objects.tables import (
    Columns,
    Tabular,
    covariance_columns,
    covariances_of,
    headers_of,
    pose_columns,
    rows_of,
    rows_taken,
    times_of,
    twist_columns,
)
from six_wheel.kinematics.poses import Floats

ROUNDING = 1e-9  # [m/s], below which wheels agree: as many readings as unknowns leave no other residual
SHOWN_WHEELS = 2  # of a slip report in words, by size
SILENT = "the wheels cannot contradict each other: of slip nothing can be told from them alone"


class OdometryHealth(TextFlag):
    """Flags of one sample. Each has a text, `help`: its meaning, and what to do."""

    GOOD = 0, "nothing is wrong"
    FIRST = 1, "the reference from which the next sample counts"
    GAP = 2, "after more than `max_gap`; the way in between is one arc: look for lost samples"
    WRAPPED = 4, "a counter started over, and was followed"
    SLIP = 8, "a wheel contradicts the others by more than the noise explains: see `slip_report`"
    NOT_FINITE = 16, "left out: a reading is not a finite number; look for a lost encoder"
    DUPLICATE = 32, "left out: its stamp is that of the sample before"
    BACKWARDS = 64, "left out: its stamp is before that of the sample before; sort the log, or mend its clock"
    JUMP = (
        128,
        "left out: the rover would have moved or steered faster than `max_speed` or `max_steering_rate`",
    )
    UNDETERMINED = 256, "left out: its wheels do not determine the motion; read more wheels"
    RESTARTED = (
        512,
        "a counter started at zero again, and it counts from there; or clock or counters went on from "
        "another value for good, and it counts from the sample left out before",
    )
    OVERTURNED = 1024, "left out: the attitude is upside down; look at the axes of the sensor"
    UNSETTLED = (
        2048,
        "it does not settle on the ground there: the pose goes by joints and attitude, or on as it went",
    )
    OFF_GROUND = (
        4096,
        "left out: it does not settle on the ground there; give a larger map, or joints and attitude",
    )

    LEFT_OUT = 16 | 32 | 64 | 128 | 256 | 1024 | 4096, "left out, for any of its reasons"


def rows_with(health: NDArray[np.uint32], flag: OdometryHealth) -> NDArray[np.int64]:
    """Rows with any of these flags."""
    return np.flatnonzero(health & int(flag))


def findings(health: NDArray[np.uint32]) -> list[str]:
    """One line per kind of flag: how many rows, and the first of them."""
    lines = []
    for flag in OdometryHealth:
        rows = rows_with(health, flag)
        if flag and len(rows) > 0:
            shown = ", ".join(str(row) for row in rows[:5]) + (", ..." if len(rows) > 5 else "")
            lines.append(f"{flag.name}: {len(rows)} of {len(health)} rows ({shown})")
    return lines


@checked_class
@dataclass(frozen=True, slots=True, eq=False)
class Track(Tabular):
    """Poses of a rover over a whole log, one row per sample.

    Rows that were left out (`health`) hold the state of the row before; their residuals are NaN.

    Attributes
    ----------
    rover : Rover
        The rover that was driven.
    stamps : ndarray, shape (n,)
        As given [s].
    poses : ndarray, shape (n, 3)
        ``[x, y, yaw]`` in the world, yaw with its full turns [m, m, rad].
    twists : ndarray, shape (n, 3)
        Mean ``[vx, vy, omega]`` over the step that ends at the sample, in body axes [m/s, m/s, rad/s].
    covariances : ndarray, shape (n, 3, 3), or None
        Of the poses, in world axes.
    residuals : ndarray, shape (n, wheels), or None
        Speed at which each wheel's contact slid [m/s].
    weights : ndarray, shape (n, wheels), or None
        Say of each wheel, of the robust method.
    health : ndarray of uint32, shape (n,)
        `OdometryHealth` flags.
    noise : Noise or None
        By which the covariances grew, if that is known.
    """

    rover: Rover
    stamps: Floats
    poses: Floats
    twists: Floats
    covariances: Floats | Any  # None where it was not asked for
    residuals: Floats | Any  # None where it was not asked for
    weights: Floats | Any  # None where it was not asked for
    health: NDArray[np.uint32]
    noise: Noise | None = None

    def __post_init__(self) -> None:
        check_columns(self, {
            "stamps": "(n,)", "poses": "(n, 3)", "twists": "(n, 3)", "covariances": "(n, 3, 3)",
            "residuals": "(n, wheels)", "weights": "(n, wheels)", "health": "(n,)",
        }, optional=("covariances", "residuals", "weights"))  # fmt: skip

    def __len__(self) -> int:
        return len(self.stamps)

    @property
    def left_out(self) -> NDArray[np.int64]:
        """Rows that were left out."""
        return self.rows(OdometryHealth.LEFT_OUT)

    def rows(self, flag: OdometryHealth) -> NDArray[np.int64]:
        """Numbers of the rows with any flag of `flag`."""
        return rows_with(self.health, flag)

    def findings(self) -> list[str]:
        """One line per kind of flag: how many rows, and the first of them."""
        return findings(self.health)

    def slip_report(
        self, *, threshold: float | None = None, gap: float = 0.5, min_rows: int = 2
    ) -> SlipReport:
        """Wheels that disagree with the others, with size and times of the disagreement; see `SlipReport`.

        Parameters
        ----------
        threshold : float, optional
            Residual from which on a wheel slips [m/s]; default the rows flagged `OdometryHealth.SLIP`.
        gap : float, default 0.5
            Rows of slip that lie no further apart than this are one window [s].
        min_rows : int, default 2
            Rows that make a window: fewer are noise.

        Raises
        ------
        ValueError
            If the track has no residuals.
        """
        return SlipReport.of(self, threshold, gap, min_rows)

    def _columns(self) -> Columns:
        columns = pose_columns(self.stamps, self.poses) | twist_columns(self.twists)
        if self.covariances is not None:
            columns |= covariance_columns(self.covariances)
        if self.residuals is not None:
            names = self.rover.wheel_names
            columns |= {f"residual_{name}": ("m/s", self.residuals[:, k]) for k, name in enumerate(names)}
        return columns | {"health": ("", self.health)}

    __getitem__ = rows_taken
    __iter__ = None  # a table of columns, no sequence

    @classmethod
    def from_pandas(cls, frame: Any, rover: Rover) -> Self:
        """A track of the columns that `to_pandas` makes, from a DataFrame or a dict of columns.

        Parameters
        ----------
        frame : DataFrame or mapping
            With ``time``, ``x``, ``y`` and ``yaw`` [s, m, m, rad]; what else a track holds is None, or 0,
            where its columns are missing.
        rover : Rover
            The rover that was driven.

        Raises
        ------
        ValueError
            If a column is missing.
        """
        headers = set(headers_of(frame))
        stamps, poses = times_of(frame), rows_of(frame, ("x", "y", "yaw"))
        twists = rows_of(frame, ("vx", "vy", "omega")) if "vx" in headers else np.zeros_like(poses)
        names = tuple(f"residual_{name}" for name in rover.wheel_names)
        residuals = rows_of(frame, names) if headers.issuperset(names) else None
        covariances = covariances_of(frame, len(stamps))
        health = np.zeros(len(stamps), dtype=np.uint32)
        if "health" in headers:
            health = np.asarray(frame["health"], dtype=np.uint32)
        return cls(rover, stamps, poses, twists, covariances, residuals, None, health)

    def __repr__(self) -> str:
        return described("Track", self.stamps, self.poses)

    def __str__(self) -> str:
        return "\n  ".join([repr(self), *few(self.findings())])


@dataclass(frozen=True, slots=True)
class WheelContradiction:
    """Statistics of the residual of one wheel over a log."""

    name: str
    rms: float  # of its residual [m/s]
    mean: float  # of its residual: what it disagrees by all the time [m/s]
    worst: float  # largest residual [m/s]
    worst_row: int
    worst_share: float  # share of the moving rows in which no wheel disagrees more
    weight: float | None  # mean say, of the robust method


@dataclass(frozen=True, slots=True)
class SlipWindow:
    """A stretch of a log in which wheels slid."""

    start: float  # stamp [s]
    end: float
    first_row: int
    last_row: int
    wheel: str  # that slid furthest
    distance: float  # length of the slide [m]
    worst: float  # largest residual of it [m/s]

    @classmethod
    def of_rows(
        cls,
        names: tuple[str, ...],
        residuals: NDArray[np.float64],
        stamps: NDArray[np.float64],
        rows: NDArray[np.intp],
        first: int,
        last: int,
    ) -> SlipWindow:
        """The stretch from one row to another of those that count; `rows` are their numbers in the log."""
        slid = residuals[first : last + 1]
        steps = np.diff(stamps[first : last + 1], prepend=stamps[max(first - 1, 0)])
        distances = (slid * steps[:, None]).sum(axis=0)
        wheel = int(np.argmax(distances))
        begin, end = float(stamps[first]), float(stamps[last])
        distance, worst = float(distances[wheel]), float(slid[:, wheel].max())
        return cls(begin, end, int(rows[first]), int(rows[last]), names[wheel], distance, worst)


@checked_class
@dataclass(frozen=True, slots=True, repr=False)
class SlipReport(Shown):
    """Per wheel and over time, how the wheels contradict the motion that fits all of them best.

    A residual is a speed: how fast the contact slides if the fitted twist is the rover's. When one wheel
    slips the fit gives way a little, so others seem to slide as well; the one that slides most is named.
    """

    wheels: tuple[WheelContradiction, ...]
    windows: tuple[SlipWindow, ...]
    rows: int
    observable: bool = True
    """True where the wheels can contradict each other: two wheels of a differential drive cannot."""

    def __repr__(self) -> str:
        found = {"wheels": len(self.wheels), "rows": self.rows, "windows": len(self.windows)}
        return short_repr(
            "SlipReport", found | {"worst_wheel": self.worst_wheel, "observable": self.observable}
        )

    @property
    def worst_wheel(self) -> str | None:
        """The wheel with the largest residual over the log; None if none slides."""
        worst = max(self.wheels, key=lambda wheel: wheel.rms)
        return worst.name if worst.rms > 0.0 else None

    @classmethod
    def of(cls, track: Track, threshold: float | None, gap: float, min_rows: int) -> SlipReport:
        """The report of a track, with `threshold`, `gap` and `min_rows` of `Track.slip_report`."""
        if track.residuals is None:
            raise ValueError("track must hold residuals, got one without")
        used = (track.health & int(OdometryHealth.LEFT_OUT | OdometryHealth.FIRST)) == 0
        residuals = track.residuals[used]
        rows, stamps = np.flatnonzero(used), track.stamps[used]
        names = track.rover.wheel_names
        weights = None if track.weights is None else track.weights[used].mean(axis=0)
        if not len(residuals):
            wheels = [WheelContradiction(name, 0.0, 0.0, 0.0, 0, 0.0, None) for name in names]
            return cls(tuple(wheels), (), 0, can_contradict(track.rover))
        largest = residuals.max(axis=1)
        moving = largest > 0.0
        leads = np.argmax(residuals, axis=1)
        wheels = []
        for i, name in enumerate(names):
            worst = int(np.argmax(residuals[:, i]))
            wheels.append(
                WheelContradiction(
                    name,
                    float(np.sqrt(np.mean(residuals[:, i] ** 2))),
                    float(np.mean(residuals[:, i])),
                    float(residuals[worst, i]),
                    int(rows[worst]),
                    float(np.mean(leads[moving] == i)) if moving.any() else 0.0,
                    None if weights is None else float(weights[i]),
                )
            )
        flagged = (track.health[used] & int(OdometryHealth.SLIP)) != 0
        places = np.flatnonzero(flagged if threshold is None else largest > threshold)
        windows = []
        for run in np.split(places, np.flatnonzero(np.diff(stamps[places]) > gap) + 1):
            if len(run) >= max(min_rows, 1):
                first, last = int(run[0]), int(run[-1])
                windows.append(SlipWindow.of_rows(names, residuals, stamps, rows, first, last))
        observable = can_contradict(track.rover, largest=float(largest.max()))
        return cls(tuple(wheels), tuple(windows), len(residuals), observable)

    def __str__(self) -> str:
        by_size = sorted(self.wheels, key=lambda wheel: -wheel.rms)
        shown = by_size if len(by_size) <= SHOWN_WHEELS + 1 else by_size[:SHOWN_WHEELS]
        width = max(len(wheel.name) for wheel in shown)
        head = f"{'wheel':{width}}  rms [m/s]  mean [m/s]  worst [m/s]  in row  worst wheel in"
        lines = [f"slip of {len(self.wheels)} wheels over {self.rows} rows", head]
        for wheel in shown:
            line = f"{wheel.name:{width}}  {wheel.rms:9.4f}  {wheel.mean:10.4f}  {wheel.worst:11.4f}"
            weight = "" if wheel.weight is None else f"  weight {wheel.weight:.2f}"
            lines.append(f"{line}  {wheel.worst_row:6d}  {wheel.worst_share:13.0%}{weight}")
        others = by_size[len(shown) :]
        lines += [f"{len(others)} others: at most {others[0].rms:.4f} m/s rms"] if others else []
        return "\n".join([*lines, self._stretches()])

    def _stretches(self) -> str:
        """One line on the windows: the one with the longest slide, and how many others there are."""
        instead = "(a gyroscope or a truth can: six_wheel.log_odometry.evaluation.slip_against)"
        if not (self.observable and self.windows):
            return "no stretch in which a wheel slipped" if self.observable else f"{SILENT} {instead}"
        longest = max(self.windows, key=lambda window: window.distance)
        others = f"; {len(self.windows) - 1} other stretches" if len(self.windows) > 1 else ""
        rows = f"rows {longest.first_row} to {longest.last_row}"
        size = f"{longest.wheel} slid {longest.distance:.3f} m, at {longest.worst:.3f} m/s at most"
        return f"{longest.start:.3f} s to {longest.end:.3f} s ({rows}): {size}{others}"


def can_contradict(rover: Rover, largest: float = math.inf) -> bool:
    """True if slip shows in residuals: readings of the rover that belong to no motion leave some.

    `largest` is that of a log [m/s]: where there is none, wheels without a motor may have had no encoder.
    """
    numbers = np.random.default_rng(0)  # any readings that are not those of a motion
    ranges = [wheel.steering_range for wheel in rover.wheels if wheel.steering_range is not None]
    steering = np.array([numbers.uniform(max(low, -1.0), min(high, 1.0)) for low, high in ranges])
    speeds = numbers.normal(size=len(rover.wheels))
    driven = np.array([wheel.driven for wheel in rover.wheels])
    heard = [speeds] if largest > ROUNDING else [speeds, np.where(driven, speeds, np.nan)]
    return all(
        np.nanmax(rover.fit(steering, one, allow_underdetermined=True).residuals) > ROUNDING for one in heard
    )
