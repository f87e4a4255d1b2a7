"""Dead reckoning of a log on disk: chunk by chunk in constant memory, with what is to be said about it.

Only where the truth is known are all poses kept, for the evaluation; a thinned trace serves the pictures.
"""

import contextlib
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Odometry, Rover
from six_wheel.kinematics.errors import TableError
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.objects.tables import Columns
from six_wheel.kinematics.objects.whole_files import replacing
from six_wheel.kinematics.odometry.tracks import OdometryHealth, Track
from six_wheel.kinematics.poses import Floats, joined
from six_wheel.log_odometry.evaluation.paths import absolute_error, align, evaluate
from six_wheel.log_odometry.evaluation.slip import lost_stretches, reach
from six_wheel.log_odometry.recording import TrackRecord
from six_wheel.log_odometry.results import Count, Reckoned, ReckonSettings
from six_wheel.log_odometry.slip import SlipSum
from six_wheel.logs.detect_reader import AnyLog, open_log
from six_wheel.logs.frames.tabular_input import concatenate
from six_wheel.logs.ground_truth import read_truth
from six_wheel.logs.joint_totals import JointRows
from six_wheel.logs.log_options import LogOptions, corrections
from six_wheel.logs.recordings import GroundTruth
from six_wheel.logs.tables import FORMATS, RowError, table_format
from six_wheel.logs.writing import TableWriter
from six_wheel.robot_description.parameters.writing import text_of

RECORD = ".mcap"
LATEST_NANOSECONDS = 9_000_000_000  # [s] since 1970


# Reasons for which a row was not used, in words; the others come from the file's reader.
REASONS = {
    OdometryHealth.NOT_FINITE: "a reading is not a finite number",
    OdometryHealth.DUPLICATE: "the same time twice",
    OdometryHealth.BACKWARDS: "time runs backwards",
    OdometryHealth.JUMP: "faster than the rover can be",
    OdometryHealth.UNDETERMINED: "the wheels do not determine the motion",
}
REMARKS = {
    OdometryHealth.GAP: "after a gap",
    OdometryHealth.WRAPPED: "a counter started over",
    OdometryHealth.SLIP: "a wheel contradicts the others",
    OdometryHealth.RESTARTED: "clock or counters restarted",
}

UNUSED = (
    "the gyroscope is not used, for nobody said what it errs by: "
    "the key gyroscope of a parameter file does, as six-wheel calibrate writes it"
)


class _Run:
    """A log under way through odometry: the state between two chunks."""

    def __init__(self, log: AnyLog, settings: ReckonSettings, options: LogOptions) -> None:
        self.record: TrackRecord | None = None
        self.log = log
        self._options = options
        self._gains, self._scale = corrections(log.rover, options.wheel_keys)
        self.result = Reckoned(log.path.name, log.rover)
        self._settings = settings
        self._odometry: Odometry | None = None  # until it is known what the log holds
        self._last = np.array(settings.start)
        self._begin: float | None = None
        self._slip = SlipSum()
        self._known: list[tuple[Floats, Floats, Floats]] = []
        self._own: list[tuple[Floats, Floats]] = []
        self._reckoned: list[tuple[Floats, Floats]] = []
        self._places: list[tuple[Floats, Floats]] = []
        self._used = 0

    def advance(self, chunk: JointRows, truth: GroundTruth | None) -> Columns:
        """Reckon the rows of a chunk; the columns of the results, times since 1970 in whole nanoseconds."""
        result = self.result
        if self._odometry is None:
            options = self._settings.options_for(chunk)
            self._odometry = Odometry(self._rover_of(chunk), self._settings.noise, **{"lag": 0.0} | options)
            self._odometry.reset(self._settings.start)
            result.noise = self._odometry.noise
        steering = None if chunk.steering is None else chunk.steering * self._gains
        track = self._reckon(self._odometry, chunk, steering, chunk.wheel_angles * self._scale)
        result._sketch.add(chunk.wheel_angles)
        result.gyroscope_bias = self._odometry.gyroscope_bias
        covariances, residuals = track.covariances, track.residuals
        if covariances is None or residuals is None:
            raise RuntimeError("a track without covariances or residuals")  # they were not declined
        self._say(track, chunk.rows)
        self._begin = float(chunk.stamps[0]) if self._begin is None else self._begin
        result.rows += len(track)
        result.duration = float(chunk.stamps[-1]) - self._begin
        steps = np.diff(np.vstack([self._last, track.poses])[:, :2], axis=0)
        result.distance += float(np.hypot(*steps.T).sum())
        self._last = track.poses[-1]
        result.pose, result.covariance = track.poses[-1], covariances[-1]
        self._note_truth(chunk, track.poses, truth)
        flat = covariances.reshape(-1, 9)
        result._trace.add(track.poses, np.hstack([chunk.stamps[:, None], flat, residuals]))
        columns: Columns = {"time": ("s", chunk.stamps)}
        if self._since_1970:
            nanoseconds = self.log.origin * 1_000_000_000 + np.rint(1e9 * chunk.stamps).astype(np.int64)
            columns = {"time_ns": ("ns", nanoseconds)}
        columns["row"] = ("", chunk.rows)
        columns |= {name: column for name, column in track._columns().items() if name != "time"}
        return columns | {"health": ("", track.health.astype(np.int64))}

    def _rover_of(self, chunk: JointRows) -> Rover:
        """The rover, whose wheels without an encoder do not drive as far as odometry knows."""
        rover = self.log.rover
        for wheel, angles in zip(rover.wheels, chunk.wheel_angles.T, strict=True):
            if wheel.driven and np.isnan(angles).all():
                rover = rover.replace(wheel.name, driven=False)
        return rover

    def _reckon(self, odometry: Odometry, chunk: JointRows, steering: Floats | None, angles: Floats) -> Track:
        """The track of a chunk; into the record as well, if there is one."""
        rates = None if odometry.gyroscope_bias is None else chunk.yaw_rate
        if self.record is None:
            return odometry.run(steering, angles, chunk.stamps, yaw_rate=rates)
        parts, covariances = [], []
        for k in range(len(chunk.stamps)):  # row by row: only a state has the covariance of the twist
            row = slice(k, k + 1)
            steered = None if steering is None else steering[row]
            rate = None if rates is None else rates[row]
            parts.append(odometry.run(steered, angles[row], chunk.stamps[row], yaw_rate=rate))
            state = odometry.state
            covariances.append((state.covariance_6x6(), state.twist_covariance_6x6()))
        track = concatenate(self.log.rover, parts)
        self.record.write(chunk, track, covariances)
        return track

    def _note_truth(self, chunk: JointRows, poses: Floats, truth: GroundTruth | None) -> None:
        """Keep what can be compared: now, or at the end where the log's own truth has another clock."""
        if truth is None and chunk.truth is not None and self._options.truth:
            there = np.isfinite(chunk.truth).all(axis=1)
            self._own.append((chunk.stamps[there], chunk.truth[there]))
            self._reckoned.append((chunk.stamps, poses))
            return
        wanted = chunk.truth if truth is None else truth.at(chunk.stamps)
        if truth is not None and wanted is not None and not truth.has_yaw:
            there = np.isfinite(wanted[:, 0])
            self._places.append((poses[there], wanted[there]))
            return
        if wanted is not None and (there := np.isfinite(wanted).all(axis=1)).any():
            self._known.append((chunk.stamps[there], poses[there], wanted[there]))

    def _place(self) -> None:
        """The track of what the truth follows, against positions alone."""
        estimate, wanted = (np.concatenate(part) for part in zip(*self._places, strict=True))
        if len(estimate) < 2:
            return
        seen = joined(estimate, self._options.sensor)
        wanted = np.column_stack((wanted[:, :2], np.zeros(len(wanted))))
        wanted[:, 2] = align(seen, wanted)[:, 2]  # nobody knows it: it counts as right
        self.result.placed = absolute_error(seen, wanted, "se2")

    def _compare(self) -> None:
        """Compare the rows kept so far with the truth that the log itself holds."""
        stamps, poses = (np.concatenate(part) for part in zip(*self._own, strict=True))
        later = np.concatenate(([True], np.diff(np.maximum.accumulate(stamps)) > 0.0))
        if later.sum() < 2:
            return
        truth = self._options.of_body(GroundTruth(stamps[later], poses[later]))
        for times, estimate in self._reckoned:
            wanted = truth.at(times)
            there = np.isfinite(wanted).all(axis=1)
            self._known.append((times[there], estimate[there], wanted[there]))

    @property
    def _since_1970(self) -> bool:
        """True for times since 1970, which fit whole nanoseconds; others count from the first second."""
        return bool(self.log.origin) and abs(self.log.origin) < LATEST_NANOSECONDS

    def _say(self, track: Track, rows: NDArray[np.int64]) -> None:
        for flag, reason in REASONS.items():
            if len(found := track.rows(flag)):
                self.result.left_out.setdefault(reason, Count()).add(rows[found].tolist())
        for flag in REMARKS:
            if len(found := track.rows(flag)):
                self.result.flags.setdefault(flag, Count()).add(rows[found].tolist())
        self._used += len(track) - len(track.left_out)
        self._slip.add(track, rows)

    def finish(self, length: float, truth: GroundTruth | None) -> Reckoned:
        """Sum up."""
        result, path = self.result, self.log.path
        by_reader: dict[str, Count] = {}
        for finding in self.log.findings.listed:
            rows = range(finding.row, (finding.last_row or finding.row) + 1)
            by_reader.setdefault(finding.rule, Count()).add(rows)
        result.left_out = by_reader | result.left_out
        result.warnings += self.log.warnings
        if self.log.has_gyroscope and self._settings.gyroscope is None:
            result.warnings.append(f"{path}: {UNUSED}")
        if self._used < 2:
            reasons = [f"; {reason}: {count}" for reason, count in result.left_out.items()]
            why = "".join([*reasons, *(f"; {warning}" for warning in self.log.warnings)])
            rule = "the log must have at least two rows that can be used"
            raise TableError(f"{path}: {rule}, got {self._used}{why}")
        result.slip = self._slip.report(result.rover)
        if self._own:
            self._compare()
        if self._known:
            stamps, result.estimate, result.truth = map(np.concatenate, zip(*self._known, strict=True))
            result.lost = lost_stretches(stamps, result.estimate, result.truth, reach(result.rover))
        if self._places:
            self._place()
        if truth is not None and len(result.truth) < 2 and result.placed is None:
            ours = (
                f"{self._begin:g} to {self._begin + result.duration:g} s" if self._begin is not None else ""
            )
            theirs = f"{truth.stamps[0]:g} to {truth.stamps[-1]:g} s"
            raise TableError(f"{path}: the truth must overlap the log in time, got {theirs} and {ours}")
        if len(result.truth) >= 2:
            result.evaluation = evaluate(result.estimate, result.truth, length=length)
        return result


@checked()
def reckon(
    rover: Rover,
    path: Path,
    output: Path | None = None,
    *,
    truth: Path | None = None,
    finish: Callable[[Reckoned], None] | None = None,
    log_options: LogOptions | None = None,
    settings: ReckonSettings | None = None,
    length: float = 0.5,
    chunk_rows: int = 65_536,
    sources: Sequence[Path] = (),
    progress: Callable[[int, int], None] | None = None,
) -> Reckoned:
    """Dead-reckon a log and write what comes of it. Outputs are replaced only if all went well.

    Parameters
    ----------
    rover : Rover
        Any vehicle.
    path : Path
        A log, see `_log_files`.
    output : Path, optional
        Times, poses, twists, covariances, residuals and health, .csv or .parquet; .mcap: a record with the
        topics of `logs.mcap.rover_record`, for viewers.
    truth : Path, optional
        True path of the rover, if the log does not have it.
    finish : callable, optional
        Called with the result before the output is replaced: what it raises leaves all as it was.
    log_options, settings
        Options of reading and of dead reckoning.
    length : float
        Of the stretches for the relative error [m].
    chunk_rows : int
        Most rows in memory at a time.
    sources : sequence of Path
        Files that must not be overwritten, beside the log and the truth.
    progress : callable, optional
        Called after every chunk with how far it is and how far it will go.

    Raises
    ------
    TableError
        If the log, the truth or the output cannot be used.
    """
    if chunk_rows < 1:
        raise ValueError(f"chunk_rows must be positive, got {chunk_rows}")
    options, begin = log_options or LogOptions(), time.perf_counter()
    with contextlib.ExitStack() as stack:
        if output is not None and output.suffix.lower() != RECORD:
            table_format(output, (*FORMATS, RECORD))
        log: AnyLog = open_log(path, rover, options)
        stack.callback(log.close)
        run = _Run(log, settings or ReckonSettings(), options)
        taken = [each for each in (path, truth, *sources) if each is not None]
        target = stack.enter_context(replacing(output, taken)) if output else None
        writer: TableWriter | None = None
        known: GroundTruth | None = None
        for chunk in log.chunks(chunk_rows):
            if truth is not None and known is None:
                known = _read_truth(truth, log, options, run.result)
            # Only now is it known how the times are written.
            if target is not None and target.suffix.lower() == RECORD and run.record is None:
                record = TrackRecord(target, rover, text_of(rover), log.origin)
                run.record = stack.enter_context(record)
            try:
                columns = run.advance(chunk, known)
            except RowError as error:
                raise TableError(f"{path}: {error}") from None
            if target is not None and run.record is None:
                if writer is None:
                    units = {name: unit for name, (unit, _) in columns.items()}
                    writer = stack.enter_context(TableWriter(target, units))
                writer.write([values for _, values in columns.values()])
            if progress is not None:
                progress(log.position, log.size)
        result = run.finish(length, known)
        if finish is not None:
            finish(result)
    result.elapsed = time.perf_counter() - begin
    return result


def _read_truth(path: Path, log: AnyLog, options: LogOptions, result: Reckoned) -> GroundTruth:
    stamps, poses, findings = read_truth(path, origin=log.origin, topic=options.truth_topic)
    if findings.rows:
        result.warnings.append(
            f"{path}: {findings.rows} rows of the truth were left out; {findings.listed[0]}"
        )
    try:
        return options.of_body(GroundTruth(stamps, poses))
    except ValueError as error:
        raise TableError(f"{path}: {error}") from None
