"""Whole logs: `dead_reckon` from arrays, tables or files to a `Track`, and what the wheels say about slip."""

from __future__ import annotations  # NumPy is not loaded for its names

import enum
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from six_wheel._core import Encoder, Noise, Odometry, OdometryState, Rover

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "Encoder",
    "Health",
    "Noise",
    "Odometry",
    "OdometryState",
    "SlipReport",
    "SlipWindow",
    "Track",
    "WheelSlip",
    "dead_reckon",
    "dead_reckon_chunks",
    "table_columns",
]


class Health(enum.IntFlag):
    """What there is to say about one sample."""

    GOOD = 0
    FIRST = 1
    """The reference from which the next sample counts."""
    GAP = 2
    """After more than `max_gap`; the way in between is one arc."""
    WRAPPED = 4
    """A counter started over."""
    SLIP = 8
    """A wheel contradicts the others by more than the noise explains."""
    NOT_FINITE = 16
    """Left out: a reading is not a finite number."""
    DUPLICATE = 32
    """Left out: its stamp is that of the sample before."""
    BACKWARDS = 64
    """Left out: its stamp is before that of the sample before."""
    JUMP = 128
    """Left out: the rover would have moved or steered faster than `max_speed` or `max_steering_rate`."""
    UNDETERMINED = 256
    """Left out: its wheels do not determine the motion."""
    RESTARTED = 512
    """Clock or counters went on from another value for good; it counts from the sample left out before."""

    LEFT_OUT = NOT_FINITE | DUPLICATE | BACKWARDS | JUMP | UNDETERMINED


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Where a rover was over a whole log, one row per sample.

    Rows that were left out (`health`) hold the state of the row before; their residuals are NaN.

    Attributes
    ----------
    rover : Rover
        Whose log it was.
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
        `Health` flags.
    """

    rover: Rover
    stamps: Floats
    poses: Floats
    twists: Floats
    covariances: Floats | None
    residuals: Floats | None
    weights: Floats | None
    health: NDArray[np.uint32]

    def __len__(self) -> int:
        return len(self.stamps)

    @property
    def pose(self) -> Floats:
        """`poses`."""
        return self.poses

    @property
    def twist(self) -> Floats:
        """`twists`."""
        return self.twists

    @property
    def covariance(self) -> Floats | None:
        """`covariances`."""
        return self.covariances

    @property
    def residual(self) -> Floats | None:
        """`residuals`."""
        return self.residuals

    @property
    def left_out(self) -> NDArray[np.int64]:
        """Rows that were left out."""
        import numpy as np

        return np.flatnonzero(self.health & int(Health.LEFT_OUT))

    def rows(self, flag: Health) -> NDArray[np.int64]:
        """Rows with any of these flags."""
        import numpy as np

        return np.flatnonzero(self.health & int(flag))

    def findings(self) -> list[str]:
        """One line per kind of flag: how many rows, and the first of them."""
        lines = []
        for flag in Health:
            rows = self.rows(flag)
            if flag and len(rows) > 0:
                shown = ", ".join(str(row) for row in rows[:5]) + (", ..." if len(rows) > 5 else "")
                lines.append(f"{flag.name}: {len(rows)} of {len(self)} rows ({shown})")
        return lines

    def slip_report(
        self, *, threshold: float | None = None, gap: float = 0.5, shortest: int = 2
    ) -> SlipReport:
        """Which wheels disagree with the others, by how much and when; see `SlipReport`.

        Parameters
        ----------
        threshold : float, optional
            Residual from which on a wheel slips [m/s]; by default the rows flagged `Health.SLIP` count.
        gap : float
            Rows of slip that lie no further apart than this are one window [s].
        shortest : int
            Rows that make a window: fewer are noise.
        """
        return SlipReport.of(self, threshold, gap, shortest)

    def __repr__(self) -> str:
        lines = [f"Track({len(self)} rows"]
        if len(self):
            x, y, yaw = self.poses[-1]
            lines[0] += f", {self.stamps[-1] - self.stamps[0]:.6g} s, ends at ({x:.4f}, {y:.4f}, {yaw:.4f})"
        return "\n  ".join([lines[0], *self.findings()]) + ")"


@dataclass(frozen=True, slots=True)
class WheelSlip:
    """How one wheel disagrees with the others over a log."""

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
    distance: float  # how far it slid [m]
    worst: float  # largest residual of it [m/s]


@dataclass(frozen=True, slots=True)
class SlipReport:
    """Per wheel and over time, how the wheels contradict the motion that fits all of them best.

    A residual is a speed: how fast the contact slides if the fitted twist is the rover's. When one wheel
    slips the fit gives way a little, so others seem to slide as well; the one that slides most is named.
    """

    wheels: tuple[WheelSlip, ...]
    windows: tuple[SlipWindow, ...]
    rows: int

    @property
    def worst_wheel(self) -> str | None:
        """The wheel with the largest residual over the log; None if none slides."""
        worst = max(self.wheels, key=lambda wheel: wheel.rms)
        return worst.name if worst.rms > 0.0 else None

    @classmethod
    def of(cls, track: Track, threshold: float | None, gap: float, shortest: int) -> SlipReport:
        """The report of a track."""
        import numpy as np

        if track.residuals is None:
            raise ValueError("track must hold residuals, got one without")
        used = (track.health & int(Health.LEFT_OUT | Health.FIRST)) == 0
        residuals = track.residuals[used]
        rows, stamps = np.flatnonzero(used), track.stamps[used]
        names = track.rover.wheel_names
        weights = None if track.weights is None else track.weights[used].mean(axis=0)
        if not len(residuals):
            wheels = [WheelSlip(name, 0.0, 0.0, 0.0, 0, 0.0, None) for name in names]
            return cls(tuple(wheels), (), 0)
        largest = residuals.max(axis=1)
        moving = largest > 0.0
        leads = np.argmax(residuals, axis=1)
        wheels = []
        for i, name in enumerate(names):
            worst = int(np.argmax(residuals[:, i]))
            share = float(np.mean(leads[moving] == i)) if moving.any() else 0.0
            wheels.append(
                WheelSlip(
                    name,
                    float(np.sqrt(np.mean(residuals[:, i] ** 2))),
                    float(np.mean(residuals[:, i])),
                    float(residuals[worst, i]),
                    int(rows[worst]),
                    share,
                    None if weights is None else float(weights[i]),
                )
            )
        flagged = (track.health[used] & int(Health.SLIP)) != 0
        slips = flagged if threshold is None else largest > threshold
        windows = []
        places = np.flatnonzero(slips)
        if len(places):
            ends = np.flatnonzero(np.diff(stamps[places]) > gap)
            for run in np.split(places, ends + 1):
                if len(run) < shortest:
                    continue
                first, last = int(run[0]), int(run[-1])
                steps = (
                    np.diff(stamps[first - 1 : last + 1])
                    if first
                    else np.diff(stamps[first : last + 1], prepend=stamps[first])
                )
                slid = (residuals[first : last + 1] * steps[:, None]).sum(axis=0)
                wheel = int(np.argmax(slid))
                windows.append(
                    SlipWindow(
                        float(stamps[first]),
                        float(stamps[last]),
                        int(rows[first]),
                        int(rows[last]),
                        names[wheel],
                        float(slid[wheel]),
                        float(residuals[first : last + 1, wheel].max()),
                    )
                )
        return cls(tuple(wheels), tuple(windows), len(residuals))

    def __str__(self) -> str:
        width = max(len(wheel.name) for wheel in self.wheels)
        head = f"{'wheel':{width}}  rms [m/s]  mean [m/s]  worst [m/s]  in row  worst wheel in"
        lines = [f"slip of {len(self.wheels)} wheels over {self.rows} rows", head]
        for wheel in self.wheels:
            line = f"{wheel.name:{width}}  {wheel.rms:9.4f}  {wheel.mean:10.4f}  {wheel.worst:11.4f}"
            line += f"  {wheel.worst_row:6d}  {wheel.worst_share:13.0%}"
            lines.append(line if wheel.weight is None else f"{line}  weight {wheel.weight:.2f}")
        for window in self.windows:
            lines.append(
                f"{window.start:.3f} s to {window.end:.3f} s (rows {window.first_row} to {window.last_row}): "
                f"{window.wheel} slid {window.distance:.3f} m, at {window.worst:.3f} m/s at most"
            )
        if not self.windows:
            lines.append("no stretch in which a wheel slipped")
        return "\n".join(lines)


Errors = Literal["flag", "raise"]


def dead_reckon(
    rover: Rover,
    steering: Any,
    wheel_angles: ArrayLike | None = None,
    stamps: ArrayLike | None = None,
    *,
    noise: Noise | None = None,
    yaw: ArrayLike | str | None = None,
    yaw_rate: ArrayLike | str | None = None,
    start: ArrayLike = (0.0, 0.0, 0.0),
    start_covariance: ArrayLike | None = None,
    errors: Errors = "flag",
    covariances: bool = True,
    residuals: bool = True,
    columns: Mapping[str, str] | None = None,
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> Track:
    """Dead reckoning over a whole log in one call: the numbers of `Odometry.update`, row by row.

    Parameters
    ----------
    rover : Rover
        Any vehicle.
    steering : array_like of shape (n, steered wheels), or a table, or a path
        Steering angles [rad], or counts of their encoders; None for a rover that does not steer. A table
        (a frame of pandas or polars, a pyarrow table, a dict of columns) or the path of a Parquet file stands
        for this and the next two; see `table_columns` for what its columns are called.
    wheel_angles : array_like, shape (n, wheels)
        Running totals [rad], or what the option `readings` says; NaN where a passive wheel has no encoder.
    stamps : array_like, shape (n,)
        When they were read [s].
    noise : Noise, optional
        Standard deviations of readings and slip, default ``Noise()``.
    yaw, yaw_rate : array_like of shape (n,), or str, optional
        Absolute yaw [rad] and gyroscope [rad/s], NaN in rows without; the name of a column for a table.
    start : array_like, shape (3,)
        First pose ``[x, y, yaw]`` [m, m, rad].
    start_covariance : array_like, shape (3,) or (3, 3), optional
        Of the first pose, default 0.
    errors : {'flag', 'raise'}
        Leave out rows that cannot be (NaN, time that stands still or runs backwards, jumps) and flag them in
        `Track.health`, or raise on the first one.
    covariances, residuals : bool
        Whether to compute these; what is not is None.
    columns : dict of str to str, optional
        Which column of a table holds a joint, a wheel or the ``"stamp"``, where it is called otherwise.
    progress : callable, optional
        Called with the rows done and all rows, after every chunk of a log.
    **options
        Those of `Odometry`: `readings`, `wheel_encoders`, `steering_encoders`, `method`, `inflate`, `max_gap`
        and the others.

    Returns
    -------
    Track
        `poses`, `twists`, `covariances`, `residuals`, `health`, one row per sample.

    Raises
    ------
    ValueError
        If a shape does not fit, a column is missing or an option makes no sense; with ``errors="raise"`` on
        the first bad row.
    ModuleNotFoundError
        If a Parquet file is given and what reads it is not installed.
    """
    odometry = Odometry(rover, noise, **options)
    odometry.reset(start, start_covariance)
    keywords: dict[str, Any] = {"errors": errors, "covariances": covariances, "residuals": residuals}
    if wheel_angles is not None and stamps is not None and progress is None:
        return odometry.run(steering, wheel_angles, stamps, yaw=yaw, yaw_rate=yaw_rate, **keywords)
    from six_wheel.odometry import tables as tables

    if wheel_angles is None and stamps is None:
        source = tables.table(rover, steering, columns, {"yaw": yaw, "yaw_rate": yaw_rate}, options)
    elif wheel_angles is None or stamps is None:
        raise ValueError("wheel_angles and stamps must come together, got one of them")
    else:
        source = tables.arrays(steering, wheel_angles, stamps, {"yaw": yaw, "yaw_rate": yaw_rate})
    return tables.join(rover, list(tables.follow(odometry, source, keywords, progress)))


def dead_reckon_chunks(
    rover: Rover,
    table: Any,
    *,
    noise: Noise | None = None,
    yaw: str | None = None,
    yaw_rate: str | None = None,
    start: ArrayLike = (0.0, 0.0, 0.0),
    start_covariance: ArrayLike | None = None,
    errors: Errors = "flag",
    covariances: bool = True,
    residuals: bool = True,
    columns: Mapping[str, str] | None = None,
    progress: Callable[[int, int], object] | None = None,
    chunk_rows: int | None = None,
    **options: Any,
) -> Iterator[Track]:
    """`dead_reckon` of a table or a Parquet file, a piece at a time and in constant memory.

    Parameters
    ----------
    rover, noise, yaw, yaw_rate, start, start_covariance, errors, covariances, residuals, columns, progress
        As in `dead_reckon`.
    table : a table, or a path
        A frame of pandas or polars, a pyarrow table, a dict of columns, or the path of a Parquet file.
    chunk_rows : int, optional
        Rows of a piece, default 65536.
    **options
        Those of `Odometry`.

    Yields
    ------
    Track
        Of consecutive rows.

    Raises
    ------
    ValueError, ModuleNotFoundError
        As `dead_reckon`.
    """
    from six_wheel.odometry import tables as tables

    odometry = Odometry(rover, noise, **options)
    odometry.reset(start, start_covariance)
    keywords: dict[str, Any] = {"errors": errors, "covariances": covariances, "residuals": residuals}
    sensors = {"yaw": yaw, "yaw_rate": yaw_rate}
    source = tables.table(rover, table, columns, sensors, options, chunk_rows or tables.CHUNK_ROWS)
    return tables.follow(odometry, source, keywords, progress)


def table_columns(rover: Rover) -> dict[str, tuple[str, ...]]:
    """What the columns of a table may be called, by what they hold; the first that is there is taken.

    Wheels and steering joints go by the rover's joint names (`Rover.traction_joints`, `steering_joints`),
    alone or with ``.position`` or ``.velocity`` behind; wheels by their own names as well. The ``"stamp"`` is
    in seconds, or a column of dates. A wheel without a motor may have no column.
    """
    from six_wheel.odometry import tables as tables

    return tables.names(rover)
