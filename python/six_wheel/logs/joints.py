"""Joint logs: what wheels and steering joints did and where the rover was, for odometry and calibration.

A log is a table (CSV or Parquet, see `docs/howto/logs.md` for its columns) or a ROS 2 bag. It is read in
chunks, in constant memory. A row that cannot be used is left out and reported with its number; no other row
is lost.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Self

import numpy as np

from six_wheel._core import Rover
from six_wheel.kinematics.errors import TableError
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.objects.closing import Closing
from six_wheel.logs.bags.bag_files import Topics
from six_wheel.logs.ground_truth import TRUTH, poses_of, read_truth
from six_wheel.logs.gyroscope.rates import Turning, about_z, edges_of
from six_wheel.logs.headers.joint_columns import Reading
from six_wheel.logs.headers.rate_columns import RATES
from six_wheel.logs.headers.renamed import Columns
from six_wheel.logs.headers.time_columns import in_seconds, whole_second
from six_wheel.logs.joint_sources import JointSource
from six_wheel.logs.joint_totals import Encoders, Integral, JointRows, Total, encoder_of
from six_wheel.logs.log_options import LogOptions
from six_wheel.logs.plausibility.checks import ReadingChecks
from six_wheel.logs.plausibility.findings import Findings
from six_wheel.logs.plausibility.proposals import ImplausibleReadingError
from six_wheel.logs.recordings import GroundTruth, WheelLog
from six_wheel.logs.skip_bad_rows import Batch, Sieve


@checked_class
class JointLog(Closing):
    """A joint log on disk.

    Parameters
    ----------
    path : Path
        A .csv or .parquet file; a ROS 2 bag as a folder, .mcap or .db3 file.
    rover : Rover
        The columns or messages name its joints and wheels.
    readings : {"angles", "speeds", "ticks"}, optional
        Kind of the wheels' columns if their headers do not state it, and the one to take of several.
    wheel_encoders, steering_encoders : Encoder or mapping of wheel to Encoder, optional
        For readings that are no running total in radians; needed for ticks.
    increments : bool, optional
        True if a row holds what a wheel has turned since the row before, and not the total; False by default,
        and then asked about where the readings look like that.
    columns : mapping or sequence of str, optional
        Header to the header it should be read as, such as ``{"encL": "left [ticks]"}``; or the names of all
        columns in order, of a table without a header line.
    topics : sequence of str or mapping, optional
        Topics of a bag that hold joint states; or topics of numbers with what they are, such as
        ``{"/left/velocity": "left [rad/s]"}``.
    gyroscope : mapping, optional
        The key ``gyroscope`` of a parameter file: how the sensor sits (`roll`, `pitch`), what its readings
        are to be multiplied by (`scale`), its clock (`time_offset`), its `topic`.
    frame : str
        The rover's own frame in the transforms of a bag, beside base_link and base_footprint.
    stamp_unit : {"s", "ms", "us", "ns"}, optional
        Unit of the times, whatever their header says.
    plausibility : bool, default True
        True if readings that no rover has are refused.
    max_speed : float, optional
        Fastest rim [m/s]: a longer step counts as none.
    max_gap : float, optional
        Time without rates that is all right [s].

    Attributes
    ----------
    findings : Findings
        Rows left out so far: `listed`, and the number of `rows`.
    warnings : list of str
        Lines on readings that look wrong, but can be read.
    origin : int
        The second from which stamps are counted: 0, unless the times are too large for that.
    truth_findings : Findings or None
        Rows left out of a truth of its own, after `read`.

    Raises
    ------
    TableError
        If the file is no such log.
    ModuleNotFoundError
        If what reads it is not installed; the message has the install line.
    """

    origin = 0
    truth_findings: Findings | None = None

    def __init__(
        self,
        path: Path | str,
        rover: Rover,
        *,
        readings: Reading | None = None,
        wheel_encoders: Encoders = None,
        steering_encoders: Encoders = None,
        increments: bool | None = None,
        columns: Columns | None = None,
        topics: Topics | None = None,
        gyroscope: Mapping[str, Any] | None = None,
        frame: str = "",
        stamp_unit: str | None = None,
        plausibility: bool = True,
        max_speed: float | None = None,
        max_gap: float | None = None,
    ) -> None:
        options = LogOptions(
            readings=readings,
            columns=columns or {},
            topics=topics or (),
            gyroscope=gyroscope or {},
            frame=frame,
            stamp_unit=stamp_unit,
            plausibility=plausibility,
            max_speed=max_speed,
            max_gap=max_gap,
        )
        source = JointSource(Path(path), rover, options)
        self._count(source, wheel_encoders, steering_encoders, increments)

    @classmethod
    def of_source(
        cls, source: JointSource, wheels: Encoders, steering: Encoders, increments: bool | None
    ) -> Self:
        """The log of an open source, whose readings these encoders make angles."""
        log = cls.__new__(cls)
        log._count(source, wheels, steering, increments)
        return log

    def _count(
        self,
        source: JointSource,
        wheel_encoders: Encoders,
        steering_encoders: Encoders,
        increments: bool | None,
    ) -> None:
        self._source, self.path, self.rover = source, source.path, source.rover
        self.readings, self.findings, self.warnings = source.readings, source.rows.findings, source.warnings
        speeds, ticks, counted = self.readings == "speeds", self.readings == "ticks", source.counted
        fastest = source.options.max_speed
        try:
            known = source.describe(wheel_encoders, steering_encoders, increments)
            self._checks = ReadingChecks(known, self._warn) if source.options.plausibility else None
            if speeds and (wheel_encoders is not None or increments):
                rule = "wheel_encoders and increments must be left out where wheels are read as speeds"
                raise ValueError(rule)
            untouched = (speeds, increments, wheel_encoders, steering_encoders, fastest)
            self._as_read = not any(untouched)  # readings are angles already
            self._wheels: dict[str, Total | Integral] = {}
            for wheel in self.rover.wheels:
                if f"wheel {wheel.name}" in source.names:
                    encoder = encoder_of("wheel_encoders", wheel_encoders, wheel.name, ticks)
                    longest = None if fastest is None else fastest / wheel.radius
                    total = Total(encoder, bool(increments), longest=longest)
                    self._wheels[wheel.name] = Integral() if speeds else total
            self._steering = {
                wheel: Total(encoder, increments=False, absolute=True)
                for wheel in self.rover.steered_wheel_names
                for encoder in [encoder_of("steering_encoders", steering_encoders, wheel, wheel in counted)]
            }
        except BaseException:
            self.close()
            raise
        # Messages have no units, but counts are whole numbers; those of other wheels may be interpolated.
        first = next((name for name in source.names if name.startswith("wheel ")), "")
        pivot = self._wheels.get(first.removeprefix("wheel "))
        self._counter = first if source.bagged and isinstance(pivot, Total) and pivot.counts else ""

    def _warn(self, line: str) -> None:
        self.warnings.append(f"{self.path}: {line}")

    def close(self) -> None:
        """Close the file."""
        self._source.close()

    @property
    def has_gyroscope(self) -> bool:
        """True if rows have yaw rates."""
        return self._source.has_rates or self._source.rates is not None

    @property
    def size(self) -> int:
        """Largest value of `position`: bytes of a CSV file, rows or messages of others."""
        return self._source.rows.size

    @property
    def position(self) -> int:
        """Progress of readings, in the unit of `size`."""
        return self._source.rows.position

    def chunks(self, chunk_rows: int = 200_000) -> Iterator[JointRows]:
        """The rows that can be used, in order, some `chunk_rows` at a time.

        Raises
        ------
        TableError
            If there is none.
        """
        if chunk_rows < 1:
            raise ValueError(f"chunk_rows must be positive, got {chunk_rows}")
        first = True
        spare, strict = (*TRUTH, *RATES), self._checks is not None
        warn = self._warn if self.readings == "speeds" else None
        sieve = Sieve(self.findings, spare, self._source.stated, strict, warn)
        turning: Turning | None = None
        held: JointRows | None = None  # a row's rate is not known before the row behind it
        before: float | None = None
        for batch in sieve.pass_on(self._source.rows.batches(chunk_rows)):
            if first:
                self.origin = whole_second(batch.time[0], self._source.time_unit)
                turning = self._source.turning(self.origin)
            first, rows = False, self._rows(batch)
            if turning is None:
                yield rows
                continue
            if held is not None:
                yield _with_rates(held, turning, before, float(rows.stamps[0]))
                before = float(held.stamps[-1])
            held = rows
        if held is not None and turning is not None:
            yield _with_rates(held, turning, before, None)
        if self._checks is not None:
            self._refuse(self._checks.finish)
            if line := self.findings.many_left_out(self._checks.rows):
                self._warn(line)
        if first:
            flaw = "".join(f"; {finding}" for finding in self.findings.listed[:1])
            if self.findings.listed and self.findings.listed[0].kind == "nan":
                flaw += (
                    ": does each row hold one wheel? Give it the last reading of the others (forward fill)"
                )
            rule = "the log must have at least one row that can be used"
            raise TableError(f"{self.path}: {rule}, got none{flaw}")

    def read(
        self,
        *,
        truth: Path | str | None = None,
        truth_columns: Mapping[str, str] | None = None,
        truth_topic: str | None = None,
        session: str = "",
        progress: Callable[[int, int], None] | None = None,
    ) -> WheelLog:
        """The whole log, named after its file, with the truth if there is one.

        Parameters
        ----------
        truth : Path, optional
            File of the truth, see `read_truth`; the same bag, if that holds it. Without it the log's own
            columns are the truth, if it has them.
        truth_columns : mapping, optional
            Header of that file to the header it should be read as.
        truth_topic : str, optional
            Topic of a bag.
        session : str
            The same for drives that belong together.
        progress : callable, optional
            Called after every chunk with how far it is and how far it will go.

        Raises
        ------
        TableError
            If log or truth have fewer than two rows that can be used.
        """
        parts = []
        for part in self.chunks():
            parts.append(part)
            if progress is not None:
                progress(self.position, self.size)

        def column(name: str) -> Any:
            each = [getattr(part, name) for part in parts]
            return None if each[0] is None else np.concatenate(each)

        stamps, angles, steering, poses, rates = map(
            column, ("stamps", "wheel_angles", "steering", "truth", "yaw_rate")
        )
        known = None
        try:
            if truth is not None:
                options: Any = {"columns": truth_columns, "topic": truth_topic, "progress": progress}
                times, places, self.truth_findings = read_truth(truth, origin=self.origin, **options)
                known = GroundTruth(times, places)
            elif poses is not None:
                there = np.isfinite(poses).all(axis=1)
                known = GroundTruth(stamps[there], poses[there]) if there.any() else None
            rates = rates if rates is not None and np.isfinite(rates).any() else None
            name = self.path.stem
            return WheelLog(
                stamps, steering, angles, known, name, session, yaw_rate=rates, plausibility=False
            )
        except TableError:
            raise
        except ValueError as error:
            raise TableError(f"{self.path}: ", error) from None

    def _rows(self, batch: Batch) -> JointRows:
        stamps = in_seconds(batch.time, self._source.time_unit.scale, self.origin)
        for name in self._source.turned:
            np.negative(batch.values[name], out=batch.values[name])
        if self._counter and np.any(batch.values[self._counter] % 1.0 != 0.0):
            rule = (
                "joint states are counts where encoders have ticks_per_turn, and these are no whole numbers"
            )
            self.warnings.append(f"{self.path}: {rule}: leave it out if they are in radians")
            self._counter = ""
        steering = [
            total.advance(batch.values[f"steering {w}"], stamps) for w, total in self._steering.items()
        ]
        angles = np.full((len(batch), len(self.rover.wheel_names)), np.nan)
        for k, wheel in enumerate(self.rover.wheel_names):
            if wheel in self._wheels:
                angles[:, k] = self._wheels[wheel].advance(batch.values[f"wheel {wheel}"], stamps)
        steered = np.stack(steering, axis=1) if steering else None
        truth = poses_of(batch.values) if "x" in batch.values else None
        if self._checks is not None:
            self._checks.turns.see(truth)
            raw, joints = angles, steered
            if not self._as_read:
                raw = batch.columns([f"wheel {wheel}" for wheel in self.rover.wheel_names])
                names = [f"steering {wheel}" for wheel in self._steering]
                joints = batch.columns(names) if names else None
            self._refuse(partial(self._checks.take, stamps, raw, angles, joints, batch.rows, steered))
        rates = None
        if self._source.has_rates:
            try:
                scale = self._source.options.gyroscope.get("scale", 1.0)
                rates = scale * about_z(batch.values, self._source.up)
            except ValueError as error:
                raise TableError(f"{self.path}: {error}") from None
        return JointRows(batch.rows, stamps, steered, angles, truth, rates)

    def _refuse(self, check: Callable[[], None]) -> None:
        """Put the path before what a check has to say."""
        try:
            check()
        except ImplausibleReadingError as error:
            raise TableError(f"{self.path}: ", error) from None


def _with_rates(rows: JointRows, turning: Turning, before: float | None, after: float | None) -> JointRows:
    """Rows with what a gyroscope says around each, given the stamps of their neighbours."""
    return replace(rows, yaw_rate=turning.rates(edges_of(rows.stamps, before, after)))
