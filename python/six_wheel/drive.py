"""Driving a command table: joint commands, odometry and residuals, chunk by chunk in constant memory.

The command of a row holds from its time to that of the next row. The pose in a row is the one at its time,
integrated from the twists that `Rover.fit` reads back from the joint commands: what odometry would say.
"""

import contextlib
import csv
import io
import os
import re
import secrets
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover, integrate
from six_wheel.errors import InfeasibleMotionError
from six_wheel.logs import FORMATS, Chunk, CommandTable, RowError, TableError, Unit, table_format

KEEP = ("curvature", "speed", "yaw_rate", "nearest")
BAG = ".mcap"
PICTURES = (".png", ".svg", ".pdf")
TRACE_ROWS = 20_000
Floats = NDArray[np.float64]


# --- driving ---------------------------------------------------------------------------------------------


@dataclass
class Peak:
    """The value of largest magnitude, what has it and in which row."""

    value: float = 0.0
    name: str = ""
    row: int = 0

    def update(self, values: Floats, names: Sequence[str], first_row: int) -> None:
        """Take in values (n, len(names)) of the rows from `first_row` on."""
        if values.size:
            row, column = divmod(int(np.abs(values).argmax()), len(names))
            if not self.row or abs(values[row, column]) > abs(self.value):
                self.value, self.name, self.row = float(values[row, column]), names[column], first_row + row


class Trace:
    """Poses and steering angles of at most `TRACE_ROWS` rows, evenly spread, and of the last one."""

    def __init__(self) -> None:
        self._rows = np.empty((0, 0))
        self._last = np.empty((0, 0))
        self._stride, self._seen = 1, 0

    def add(self, poses: Floats, steering: Floats) -> None:
        """Take in the rows of one chunk."""
        rows = np.hstack([poses, steering])
        kept = rows[-self._seen % self._stride :: self._stride]
        self._rows = np.vstack([self._rows, kept]) if self._seen else kept
        self._seen += len(rows)
        self._last = rows[-1:]
        while len(self._rows) >= TRACE_ROWS:
            self._rows, self._stride = self._rows[::2], 2 * self._stride

    def path(self) -> tuple[Floats, Floats]:
        """Poses (n, 3) and steering angles (n, steered wheels) so far."""
        last = self._last[: (self._seen - 1) % self._stride > 0]
        rows = np.vstack([self._rows, last])
        return rows[:, :3], rows[:, 3:]


@dataclass
class Summary:
    """What a drive came to, in SI units; `changed` (3,) is the largest change of a projected twist."""

    rows: int = 0
    duration: float = 0.0
    path_length: float = 0.0
    end_pose: Floats = field(default_factory=lambda: np.zeros(3))
    steering_angle: Peak = field(default_factory=Peak)
    steering_rate: Peak = field(default_factory=Peak)
    wheel_speed: Peak = field(default_factory=Peak)
    residual: Peak = field(default_factory=Peak)
    projected_rows: int = 0
    changed: Floats = field(default_factory=lambda: np.zeros(3))
    elapsed: float = 0.0
    warnings: list[str] = field(default_factory=list)


class Drive:
    """A rover on its way through a table: what one chunk hands to the next, and the summary so far.

    Parameters
    ----------
    rover : Rover
        Any layout of wheels.
    time_unit : Unit
        Unit of the times to come.
    keep : str, optional
        What `Rover.project` keeps of a twist that the rover cannot make. Without it such a twist is an error.

    Attributes
    ----------
    units : dict
        Name to unit of the columns that `advance` returns, in order.
    summary : Summary
    trace : Trace
    """

    def __init__(self, rover: Rover, time_unit: Unit, keep: str | None = None) -> None:
        if keep is not None and keep not in KEEP:
            raise ValueError(f'keep must be one of {", ".join(KEEP)}, got "{keep}"')
        self.rover, self.keep, self.summary, self.trace = rover, keep, Summary(), Trace()
        self.time_unit, self._scale = time_unit, time_unit.scale
        self._steered, self._wheels = list(rover.steered_names), list(rover.wheel_names)
        # Rows come out in the order of the user's joints, which is not that of the rover's wheels.
        self._steering_order = [self._steered.index(wheel) for wheel in rover.steering_joints.values()]
        self._traction_order = [self._wheels.index(wheel) for wheel in rover.traction_joints.values()]
        ranges = [wheel.steering_range for wheel in rover.wheels if wheel.steered]
        self._ends = np.array([ends for ends in ranges if ends is not None]).reshape(-1, 2).T
        self.units = self._name_columns(time_unit)
        # The row before the chunk to come.
        self._time: Any = None
        self._pose, self._twist, self._steering = np.zeros(3), np.zeros(3), np.zeros(len(self._steered))

    def _name_columns(self, time_unit: Unit) -> dict[str, str]:
        steering, traction = list(self.rover.steering_joints), list(self.rover.traction_joints)
        time_name = "time" if time_unit.symbol == "s" else f"time_{time_unit.symbol}"
        before = {time_name: time_unit.symbol}
        after = {"x": "m", "y": "m", "yaw": "rad", "vx": "m/s", "vy": "m/s", "omega": "rad/s"}
        after |= {f"residual_{wheel}": "m/s" for wheel in self._wheels}
        if len({*steering, *traction, *before, *after}) < len(steering + traction) + len(before | after):
            # One name for two columns: then every joint says which of its interfaces is meant, as in ROS 2.
            steering = [f"{joint}/position" for joint in steering]
            traction = [f"{joint}/velocity" for joint in traction]
        return before | dict.fromkeys(steering, "rad") | dict.fromkeys(traction, "rad/s") | after

    def advance(self, chunk: Chunk) -> list[NDArray[Any]]:
        """Drive through the next rows.

        Returns
        -------
        list of array
            One array (n,) for each of `units`.

        Raises
        ------
        RowError
            If the rover cannot make the twist of a row, or its pose would not be finite.
        """
        rover, summary, row = self.rover, self.summary, chunk.first_row
        twists = self._project(chunk)
        steering, speeds = self._invert(twists, row)
        fit = rover.fit(steering, speeds)

        first = int(self._time is None)
        before = chunk.time[:1] if first else np.array([self._time])
        # Differences first, in the file's own numbers: 1.7e18 ns would lose 256 ns as a double.
        steps = np.diff(np.concatenate([before, chunk.time])) * self._scale
        held = np.vstack([self._twist, fit.twist[:-1]])
        # The first row of all has no step before it.
        moved = _by_row(partial(integrate, held[first:], steps[first:], self._pose), row + first)
        poses = moved if first else moved[1:]

        turned = np.diff(steering, axis=0, prepend=steering[:1] if first else self._steering[None])
        rates = turned[first:] / steps[first:, None]
        summary.rows += len(steps)
        summary.duration += float(steps.sum())
        summary.path_length += float(np.hypot(held[:, 0], held[:, 1]) @ steps)
        summary.end_pose = poses[-1]
        summary.steering_angle.update(steering, self._steered, row)
        summary.steering_rate.update(rates, self._steered, row + first)
        summary.wheel_speed.update(speeds, self._wheels, row)
        summary.residual.update(fit.residual, self._wheels, row)
        self.trace.add(poses, steering)
        self._time, self._pose = chunk.time[-1], poses[-1]
        self._twist, self._steering = fit.twist[-1], steering[-1]

        joints = [*steering.T[self._steering_order], *speeds.T[self._traction_order]]
        return [chunk.time, *joints, *poses.T, *fit.twist.T, *fit.residual.T]

    def _project(self, chunk: Chunk) -> Floats:
        if self.keep is None:
            return chunk.twists
        keep: Any = self.keep
        project = partial(self.rover.project, chunk.twists, keep=keep)
        twists: Floats = _by_row(project, chunk.first_row)
        changes = np.abs(twists - chunk.twists)
        self.summary.projected_rows += int(changes.any(axis=1).sum())
        self.summary.changed = np.maximum(self.summary.changed, changes.max(axis=0))
        return twists

    def _invert(self, twists: Floats, row: int) -> tuple[Floats, Floats]:
        """Steering angles and wheel speeds; the angles of a row are the `previous` ones of the next."""
        hint = "; --keep curvature drives the nearest twist that it can make"
        low, high = (np.broadcast_to(end, (len(twists), len(end))) for end in self._ends)
        steering, speeds = _by_row(partial(self.rover.inverse, twists, previous=low), row, hint)
        # If the angle nearest to either end of the range is the same, there is only one, whatever was before.
        # The other rows (at rest, or with two angles to choose from) are asked one by one.
        open_rows = (steering != self.rover.inverse(twists, previous=high)[0]).any(axis=1)
        for k in np.flatnonzero(open_rows):
            previous = steering[k - 1] if k else self._steering
            steering[k], speeds[k] = self.rover.inverse(twists[k], previous=previous)
        return steering, speeds


def _by_row(call: Callable[[], Any], first_row: int, hint: str = "") -> Any:
    """`call()`; the row of a batch that the core refuses, naming it in brackets, becomes one of the table."""
    try:
        return call()
    except ValueError as error:
        named = re.fullmatch(r"(\w+)\[(\d+)\] (.*)", str(error))
        if named is None:
            raise
        advice = hint if isinstance(error, InfeasibleMotionError) else ""
        raise RowError(first_row + int(named[2]), f"{named[1]} {named[3]}{advice}") from None


def drive(
    rover: Rover,
    commands: Path,
    output: Path | None = None,
    *,
    plot: Path | None = None,
    keep: str | None = None,
    chunk_rows: int = 200_000,
    sources: Sequence[Path] = (),
    progress: Callable[[int, int], None] | None = None,
) -> Summary:
    """Drive a command table and write what comes of it. Outputs are replaced only if all went well.

    Parameters
    ----------
    rover : Rover
        Any layout of wheels.
    commands : Path
        A command table, see `logs`.
    output : Path, optional
        Joint commands, poses, twists and residuals, .csv or .parquet; the joint commands alone as
        sensor_msgs/JointState on the topic /joint_commands, .mcap.
    plot : Path, optional
        A picture of the path with the rover along it.
    keep : str, optional
        What to keep of a twist that the rover cannot make: curvature, speed, yaw_rate or nearest.
    chunk_rows : int
        Most rows in memory at a time.
    sources : sequence of Path
        Files that must not be overwritten, beside `commands`.
    progress : callable, optional
        Called after every chunk with how far it is and how far it will go.

    Raises
    ------
    TableError
        If the table, a row of it or an output file cannot be used.
    """
    if chunk_rows < 1:
        raise ValueError(f"chunk_rows must be positive, got {chunk_rows}")
    begin = time.perf_counter()
    with contextlib.ExitStack() as stack:
        if output is not None and output.suffix.lower() != BAG:
            table_format(output, (*FORMATS, BAG))
        table = stack.enter_context(CommandTable(commands))
        engine = Drive(rover, table.time_unit, keep)
        taken = [commands, *sources]
        picture = None
        if plot is not None:
            # Before the drive, which may take long: what is missing should be said at once.
            from six_wheel.plot import path_figure, save

            picture = stack.enter_context(replacing(picture_path(plot), taken))
        result = stack.enter_context(replacing(output, taken)) if output else None
        with _writer(result, engine) if result else contextlib.nullcontext() as writer:
            for chunk in table.chunks(chunk_rows):
                try:
                    columns = engine.advance(chunk)
                    if writer is not None:
                        writer.write(columns)
                except RowError as error:
                    raise table.error(error.row, error.message) from None
                if progress is not None:
                    progress(table.position, table.size)
        if picture is not None:
            save(path_figure(rover, *engine.trace.path(), title=commands.name), picture)
    engine.summary.elapsed = time.perf_counter() - begin
    engine.summary.warnings += table.warnings
    return engine.summary


# --- writing ---------------------------------------------------------------------------------------------


def picture_path(path: Path) -> Path:
    """The path itself, if its ending is one of `PICTURES`; else a `TableError`."""
    if path.suffix.lower() not in PICTURES:
        raise TableError(f'{path}: the ending must be one of {", ".join(PICTURES)}, got "{path.suffix}"')
    return path


@contextlib.contextmanager
def replacing(path: Path, sources: Sequence[Path] = ()) -> Iterator[Path]:
    """A temporary file beside `path`, which it replaces if the block succeeds; if not, it is removed.

    Raises
    ------
    TableError
        If `path` is one of `sources`, not a file, or in no folder.
    """
    target = path.resolve()
    for source in sources:
        if source.resolve() == target or (target.exists() and source.exists() and source.samefile(target)):
            raise TableError(f"{path}: the output must be another file than {source}")
    if target.exists() and not target.is_file():
        raise TableError(f"{path}: the output must be a file")
    if not target.parent.is_dir():
        raise TableError(f"{path}: the folder of the output must exist")
    # Created here and not by tempfile, so that the permissions follow the umask.
    temporary = target.with_name(f".{target.stem}.{secrets.token_hex(4)}{target.suffix}")
    try:
        temporary.open("xb").close()
    except OSError as error:
        raise TableError(f"{path}: the output must be writeable, got: {error.strerror}") from None
    try:
        yield temporary
        os.replace(temporary, target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _writer(path: Path, engine: Drive) -> "TableWriter | CommandWriter":
    return CommandWriter(path, engine) if path.suffix.lower() == BAG else TableWriter(path, engine.units)


class CommandWriter:
    """Writes the joint commands of a drive into a bag, one message a row, chunk by chunk.

    Parameters
    ----------
    path : Path
        A .mcap file.
    engine : Drive
        Whose columns come to `write`.
    """

    def __init__(self, path: Path, engine: Drive) -> None:
        from six_wheel.bags import JointCommandWriter

        steering, traction = list(engine.rover.steering_joints), list(engine.rover.traction_joints)
        self._writer = JointCommandWriter(path, steering, traction)
        self._joints = slice(1, 1 + len(steering) + len(traction))
        self._nanoseconds = round(1e9 * engine.time_unit.scale)
        self._rows = 0

    def write(self, columns: Sequence[NDArray[Any]]) -> None:
        """Append rows, those of the joint commands."""
        stamps = columns[0] * self._nanoseconds
        outside = ~((stamps >= 0) & (stamps < 2**31 * 1e9))
        if outside.any():
            k = int(outside.argmax())
            rule = "a time in a bag must be from 0 to 2^31 seconds"
            raise RowError(self._rows + k + 1, f"{rule}, got {columns[0][k]}")
        self._rows += len(stamps)
        if stamps.dtype != np.int64:
            stamps = np.rint(stamps).astype(np.int64)
        self._writer.write(stamps, np.stack(columns[self._joints], axis=1))

    def __enter__(self) -> Self:
        self._writer.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        self._writer.__exit__(*error)


class TableWriter:
    """Writes a table chunk by chunk, as CSV or Parquet by the ending of `path`.

    Parameters
    ----------
    path : Path
        A .csv or .parquet file.
    units : mapping
        Column name to unit, in order; Parquet keeps the units in the metadata of the fields.
    """

    def __init__(self, path: Path, units: Mapping[str, str]) -> None:
        self._units, self._format = dict(units), table_format(path)
        self._handle = path.open("wb")
        self._writer: Any = None

    def write(self, columns: Sequence[NDArray[Any]]) -> None:
        """Append rows: one array (n,) per column, of the same types every time."""
        import pyarrow as pa

        arrays = [pa.array(column) for column in columns]
        fields = [
            pa.field(name, array.type, nullable=False, metadata={"unit": unit})
            for (name, unit), array in zip(self._units.items(), arrays, strict=True)
        ]
        batch = pa.RecordBatch.from_arrays(arrays, schema=pa.schema(fields))
        if self._writer is None:
            self._writer = self._open(batch.schema)
        self._writer.write_batch(batch)

    def _open(self, schema: Any) -> Any:
        if self._format == "parquet":
            import pyarrow.parquet

            return pyarrow.parquet.ParquetWriter(self._handle, schema)
        import pyarrow.csv

        # Arrow quotes every header; ours need it only where a name holds a comma or a quote.
        header = io.StringIO()
        csv.writer(header, lineterminator="\n").writerow(schema.names)
        self._handle.write(header.getvalue().encode())
        options = pyarrow.csv.WriteOptions(include_header=False, quoting_style="none")
        return pyarrow.csv.CSVWriter(self._handle, schema, write_options=options)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: object, traceback: object) -> None:
        try:
            if self._writer is not None:
                self._writer.close()
        finally:
            self._handle.close()
