"""Whole logs: from arrays, tables or files to a `Track`, in one call or piece by piece."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import reprlib
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import Gyroscope, Noise, Odometry, Odometry3, Rover, Suspension, Terrain
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.kinematics.odometry.tracks3 import Track3
from six_wheel.log_odometry.sensor_frames import mount, seen_by, start_of_body
from six_wheel.logs.frames import tabular_input
from six_wheel.logs.frames.table_headers import names
from six_wheel.logs.headers.renamed import Columns
from six_wheel.logs.headers.time_columns import in_seconds, scale_of
from six_wheel.logs.plausibility.arrays import FEW, array_checks, check_arrays

Errors = Literal["flag", "raise"]
ORIGIN = (0.0, 0.0, 0.0)


@overload
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
    sensor: ArrayLike | None = None,
    errors: Errors = "flag",
    covariances: bool = True,
    residuals: bool = True,
    columns: Columns | None = None,
    stamp_unit: str | None = None,
    plausibility: bool = True,
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> Track: ...


@overload
def dead_reckon(
    rover: Suspension,
    steering: Any,
    wheel_angles: ArrayLike | None = None,
    stamps: ArrayLike | None = None,
    *,
    noise: Noise | None = None,
    ground: Terrain | None = None,
    joints: ArrayLike | None = None,
    attitude: ArrayLike | None = None,
    yaw_rate: ArrayLike | None = None,
    start: ArrayLike | None = None,
    start_covariance: ArrayLike | None = None,
    errors: Errors = "flag",
    covariances: bool = True,
    residuals: bool = True,
    **options: Any,
) -> Track3: ...


@checked(Odometry, Odometry3)
def dead_reckon(
    rover: Rover | Suspension,
    steering: Any,
    wheel_angles: ArrayLike | None = None,
    stamps: ArrayLike | None = None,
    *,
    noise: Noise | None = None,
    ground: Terrain | None = None,
    joints: ArrayLike | None = None,
    attitude: ArrayLike | None = None,
    yaw: ArrayLike | str | None = None,
    yaw_rate: ArrayLike | str | None = None,
    start: ArrayLike | None = None,
    start_covariance: ArrayLike | None = None,
    sensor: ArrayLike | None = None,
    errors: Errors = "flag",
    covariances: bool = True,
    residuals: bool = True,
    columns: Columns | None = None,
    stamp_unit: str | None = None,
    plausibility: bool = True,
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> Track | Track3:
    """Dead reckoning over a whole log in one call: the numbers of `Odometry.update`, row by row.

    Of a suspension it is that of `Odometry3.update`, in space; `yaw`, `columns`, `progress` and tables are
    for the plane.

    Parameters
    ----------
    rover : Rover or Suspension
        Any vehicle, or a suspension on ground.
    steering : array_like of shape (n, steered wheels), or a table, or a path
        Steering angles [rad], or counts of their encoders; None for a rover that does not steer. A table
        (a frame of pandas or polars, a pyarrow table, a dict of columns) or the path of a Parquet file stands
        for this and the next two; see `table_columns` for what its columns are called. So does a `WheelLog`,
        with its gyroscope and the encoders it was read with.
    wheel_angles : array_like, shape (n, wheels)
        Running totals [rad], or what the option `readings` says; NaN where a passive wheel has no encoder.
    stamps : array_like, shape (n,)
        When they were read [s].
    noise : Noise, optional
        Standard deviations of readings and slip, default ``Noise()``.
    ground : Terrain, optional
        Ground that a suspension drives on, if that is known.
    joints : array_like, shape (n, joints), optional
        Free angles of a suspension [rad]; a log that was simulated on ground brings its own.
    attitude : array_like, shape (n, 2), (n, 3) or (n, 4), optional
        Of its body, from an IMU: roll and pitch, with yaw, or quaternions x, y, z, w; likewise.
    yaw, yaw_rate : array_like of shape (n,), or str, optional
        Absolute yaw [rad] and gyroscope [rad/s], NaN in rows without; the name of a column for a table. That
        of a `WheelLog` counts as that of `Gyroscope()` unless the noise or ``gyroscope=`` says what it errs
        by.
    start : array_like, shape (3,), optional
        First pose ``[x, y, yaw]`` [m, m, rad], default (0, 0, 0); of a suspension also as in
        `Odometry3.reset`, default on `ground` the pose of a log's truth at its first stamp, if it has one.
    start_covariance : array_like, shape (3,) or (3, 3), optional
        Of the first pose, default 0.
    sensor : array_like, shape (3,), optional
        Pose ``[x, y, yaw]`` in the body of what the track shall be of, as a GPS antenna, markers or
        `Calibration.sensor`; `start` is where that begins. Default the body itself.
    errors : {'flag', 'raise'}
        Leave out rows that cannot be (NaN, time that stands still or runs backwards, jumps) and flag them in
        `Track.health`, or raise on the first one.
    covariances, residuals : bool
        True to compute these; what is not is None.
    columns : dict of str to str, or sequence of str, optional
        Column of a table that holds a joint, a wheel or the ``"stamp"``, where it is called otherwise; or
        headers with what to read them as, ``{"encL": "left [ticks]"}``; or the names of all columns in order.
    stamp_unit : {'s', 'ms', 'us', 'ns', 'min', 'h', 'd'}, optional
        Unit of the stamps.
    plausibility : bool, default True
        True if readings that no rover has are refused: counts as radians, counters that start over, stamps in
        another unit. The message says what to give instead.
    progress : callable, optional
        Called with the rows done and all rows, after every chunk of a log.
    **options
        Those of `Odometry`: `readings`, `wheel_encoders`, `steering_encoders`, `method`, `inflate`, `max_gap`
        and the others; or of `Odometry3`.

    Returns
    -------
    Track or Track3
        `poses`, `twists`, `covariances`, `residuals`, `health`, one row per sample.

    Raises
    ------
    ValueError
        If a shape does not fit, a column is missing or an option makes no sense; with ``errors="raise"`` on
        the first bad row.
    ModuleNotFoundError
        If a Parquet file is given and what reads it is not installed.
    """
    common: dict[str, Any] = {"errors": errors, "covariances": covariances}
    spatial = {"ground": ground, "joints": joints, "attitude": attitude}
    if isinstance(rover, Suspension):
        planar = {"yaw": yaw, "columns": columns, "progress": progress, "sensor": sensor}
        _refuse(planar, "for a suspension")
        run = common | spatial | {"yaw_rate": yaw_rate, "slips": residuals}
        readings = (steering, wheel_angles, stamps)
        return _in_space(rover, readings, run, noise, options, start, start_covariance)
    if not isinstance(rover, Rover):
        hint = "give one that sw.Rover makes, or sw.load(...) of a file, or a Suspension"
        raise ArgumentTypeError(f"rover must be a Rover, got {reprlib.repr(rover)}: {hint}")
    common["residuals"] = residuals
    _refuse(spatial, "for a rover without a suspension")
    known = None
    if wheel_angles is None and hasattr(steering, "wheel_angles"):
        log = steering
        known = None if log.truth is None else log.truth.poses
        steering, wheel_angles, stamps = log.steering, log.wheel_angles, log.stamps
        yaw = log.yaw if yaw is None else yaw
        options = {**log.options, **options}
        plausibility = plausibility and log.plausibility
        if yaw_rate is None and log.yaw_rate is not None:
            yaw_rate = log.yaw_rate
            if (noise is None or noise.yaw_rate == 0.0) and options.get("gyroscope") is None:
                options["gyroscope"] = Gyroscope()  # nobody said that it is to be taken at its word
    start = ORIGIN if start is None else start
    place = None if sensor is None else mount(sensor)
    if place is not None:
        start, start_covariance = start_of_body(start, start_covariance, place)
    rates: dict[str, Any] = {"yaw": yaw, "yaw_rate": yaw_rate}
    source = None
    if wheel_angles is None and stamps is None:
        source = tabular_input.table(
            rover, steering, columns, rates, options, stamp_unit=stamp_unit, plausibility=plausibility
        )
        options |= source.options
    odometry = Odometry(rover, noise, **{"lag": 0.0} | options)  # no pose from outside comes late
    odometry.reset(start, start_covariance)
    stamps = None if stamps is None else tabular_input.seconds_of(stamps)
    if stamps is not None and stamp_unit is not None:
        stamps = in_seconds(np.asarray(stamps), scale_of(stamp_unit))
    if wheel_angles is not None and stamps is not None and plausibility and _rows(stamps) >= FEW:
        checks = array_checks(rover, options, clock_stated=stamp_unit is not None)
        check_arrays(checks, steering, wheel_angles, stamps, known, yaw_rate)
    if wheel_angles is not None and stamps is not None and progress is None:
        track = odometry.run(steering, wheel_angles, stamps, **rates, **common)
    else:
        if source is None and (wheel_angles is None or stamps is None):
            raise ValueError("wheel_angles and stamps must come together, got one of them")
        if source is None:
            source = tabular_input.arrays(steering, wheel_angles, stamps, rates)  # type: ignore[arg-type]
        tracks = list(tabular_input.follow(odometry, source, common, progress))
        track = tabular_input.concatenate(rover, tracks)
    return track if place is None else seen_by(track, place)


def _in_space(
    suspension: Suspension,
    readings: tuple[Any, ArrayLike | None, ArrayLike | None],
    run: dict[str, Any],
    noise: Noise | None,
    options: dict[str, Any],
    start: ArrayLike | None,
    start_covariance: ArrayLike | None,
) -> Track3:
    """`dead_reckon` of a suspension; `run` has the arguments of `Odometry3.run`, and the ground."""
    ground, log = run.pop("ground"), readings[0]
    if readings[1] is None and hasattr(log, "wheel_angles"):
        readings = (log.steering, log.wheel_angles, log.stamps)
        own = {"yaw_rate": log.yaw_rate}
        if ground is None and getattr(log, "stand", None) is not None:
            own |= {"joints": log.stand.joints, "attitude": log.orientations}
        run |= {name: value for name, value in own.items() if run[name] is None}
        if start is None and ground is not None and log.truth is not None and log.truth.has_positions:
            first = log.truth.at(log.stamps[:1])[0]
            start = first if np.isfinite(first).all() else None
        options = {**log.options, **options}
    steering, wheel_angles, stamps = readings
    if wheel_angles is None or stamps is None:
        raise ValueError("wheel_angles and stamps must be given for a suspension, got none of them")
    odometry = Odometry3(suspension, noise, ground=ground, **{"lag": 0.0} | options)
    odometry.reset(ORIGIN if start is None else start, start_covariance)
    return odometry.run(steering, wheel_angles, stamps, **run)


def _rows(stamps: Any) -> int:
    """The number of stamps; 0 for a single number, which `Odometry.run` refuses in its words."""
    try:
        return len(stamps)
    except TypeError:
        return next(iter(np.shape(stamps)), 0)


def _refuse(arguments: Mapping[str, object], where: str) -> None:
    for argument, value in arguments.items():
        if value is not None:
            raise ValueError(f"{argument} must be left out {where}, got one")


@checked(Odometry)
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
    columns: Columns | None = None,
    stamp_unit: str | None = None,
    plausibility: bool = True,
    progress: Callable[[int, int], object] | None = None,
    chunk_rows: int | None = None,
    **options: Any,
) -> Iterator[Track]:
    """`dead_reckon` of a table or a Parquet file, a piece at a time and in constant memory.

    Parameters
    ----------
    rover, noise, yaw, yaw_rate, start, start_covariance, errors, covariances, residuals, progress
        As in `dead_reckon`.
    columns, stamp_unit, plausibility
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
    keywords: dict[str, Any] = {"errors": errors, "covariances": covariances, "residuals": residuals}
    sensors, rows = {"yaw": yaw, "yaw_rate": yaw_rate}, chunk_rows or tabular_input.CHUNK_ROWS
    source = tabular_input.table(rover, table, columns, sensors, options, rows, stamp_unit, plausibility)
    odometry = Odometry(rover, noise, **{"lag": 0.0} | options | source.options)
    odometry.reset(start, start_covariance)
    return tabular_input.follow(odometry, source, keywords, progress)


def table_columns(rover: Rover) -> dict[str, tuple[str, ...]]:
    """Accepted names of the columns of a table, by quantity; the first name that the table has is taken.

    Wheels and steering joints go by the rover's joint names (`Rover.traction_joints`, `steering_joints`),
    alone or with ``.position`` or ``.velocity`` behind; wheels by their own names as well. The ``"stamp"`` is
    in seconds, or a column of dates. A wheel without a motor may have no column.
    """
    return names(rover)
