"""Driving a command table: joint commands, odometry and residuals, chunk by chunk in constant memory.

Directly, the command of a row holds from its time to that of the next row. Through a `Controller`, commands
come when their stamps say and the rows of the results are the steps of its loop. The pose in a row is the one
at its time, integrated from the twists that `Rover.fit` reads back from the joint commands: what odometry
would say.
"""

import contextlib
import csv
import io
import os
import secrets
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from six_wheel.logs.columns import TableError, Unit
from six_wheel.drive.controlled import REASONS_METADATA, ControlledDrive, Loop
from six_wheel._core import Rover
from six_wheel.drive.engine import TRACE_ROWS, Engine, Floats, Peak, Summary, Trace, by_row
from six_wheel.logs.tables import FORMATS, Chunk, CommandTable, RowError, table_format

__all__ = [
    "TRACE_ROWS",
    "CommandWriter",
    "ControlledDrive",
    "Drive",
    "Loop",
    "Peak",
    "Summary",
    "TableWriter",
    "Trace",
    "drive",
    "picture_path",
    "replacing",
]

BAG = ".mcap"
PICTURES = (".png", ".svg", ".pdf")


# --- driving ---------------------------------------------------------------------------------------------


class Drive(Engine):
    """A rover on its way through a table, doing at once what each row says.

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
        super().__init__(rover, time_unit, keep)
        ranges = [wheel.steering_range for wheel in rover.wheels if wheel.steered]
        self._ends = np.array([ends for ends in ranges if ends is not None]).reshape(-1, 2).T
        self._time: Any = None

    def blocks(self, chunk: Chunk) -> Iterator[list[Any]]:
        """The columns of the next rows."""
        yield self.advance(chunk)

    def end(self) -> Iterator[list[Any]]:
        """The columns of what comes after the last row: nothing."""
        return iter(())

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
        steering, speeds = self._invert(self._project(chunk), chunk.first_row)
        before = chunk.time[:0] if self._time is None else np.array([self._time])
        # Differences first, in the file's own numbers: 1.7e18 ns would lose 256 ns as a double.
        steps = np.diff(np.concatenate([before, chunk.time])) * self.time_unit.scale
        self._time = chunk.time[-1]
        return self.account(chunk.time, steps, steering, speeds)

    def _invert(self, twists: Floats, row: int) -> tuple[Floats, Floats]:
        """Steering angles and wheel speeds; the angles of a row are the `previous` ones of the next."""
        hint = "; --keep curvature drives the nearest twist that it can make"
        low, high = (np.broadcast_to(end, (len(twists), len(end))) for end in self._ends)
        steering, speeds = by_row(partial(self.rover.inverse, twists, previous=low), row, hint)
        # If the angle nearest to either end of the range is the same, there is only one, whatever was before.
        # The other rows (at rest, or with two angles to choose from) are asked one by one.
        open_rows = (steering != self.rover.inverse(twists, previous=high)[0]).any(axis=1)
        for k in np.flatnonzero(open_rows):
            previous = steering[k - 1] if k else self._steering
            steering[k], speeds[k] = self.rover.inverse(twists[k], previous=previous)
        return steering, speeds


def drive(
    rover: Rover,
    commands: Path,
    output: Path | None = None,
    *,
    loop: Loop | None = None,
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
    loop : Loop, optional
        The controller to drive through, and how often it steps; without it, directly.
    plot : Path, optional
        A picture of the path with the rover along it; through a controller also of commands, joints and
        reasons over time.
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
        engine: Drive | ControlledDrive
        if loop is None:
            engine = Drive(rover, table.time_unit, keep)
        else:
            engine = ControlledDrive(rover, table.time_unit, loop, keep, block_rows=chunk_rows)
        taken = [commands, *sources]
        picture = None
        if plot is not None:
            # Before the drive, which may take long: what is missing should be said at once.
            from six_wheel.plot.path import drive_figure, path_figure, save

            picture = stack.enter_context(replacing(picture_path(plot), taken))
        result = stack.enter_context(replacing(output, taken)) if output else None
        with _writer(result, engine) if result else contextlib.nullcontext() as writer:
            try:
                for chunk in table.chunks(chunk_rows):
                    _write(writer, engine.blocks(chunk))
                    if progress is not None:
                        progress(table.position, table.size)
                _write(writer, engine.end())
            except RowError as error:
                raise table.error(error.row, error.message) from None
        if picture is not None and isinstance(engine, ControlledDrive):
            figure = drive_figure(
                rover,
                engine.course,
                *engine.trace.path(),
                limits=engine.limits,
                shares=engine.summary.shares,
                title=commands.name,
            )
            save(figure, picture)
        elif picture is not None:
            save(path_figure(rover, *engine.trace.path(), title=commands.name), picture)
    engine.summary.elapsed = time.perf_counter() - begin
    engine.summary.warnings += table.warnings
    return engine.summary


def _write(writer: "TableWriter | CommandWriter | None", blocks: Iterator[list[Any]]) -> None:
    for columns in blocks:
        if writer is not None:
            writer.write(columns)


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


def _writer(path: Path, engine: Engine) -> "TableWriter | CommandWriter":
    return CommandWriter(path, engine) if path.suffix.lower() == BAG else TableWriter(path, engine.units)


class CommandWriter:
    """Writes the joint commands of a drive into a bag, one message a row, chunk by chunk.

    Parameters
    ----------
    path : Path
        A .mcap file.
    engine : Drive or ControlledDrive
        Whose columns come to `write`.
    """

    def __init__(self, path: Path, engine: Engine) -> None:
        from six_wheel.logs.bags import JointCommandWriter

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

    def write(self, columns: Sequence[Any]) -> None:
        """Append rows: one array (n,) per column, of the same types every time."""
        import pyarrow as pa

        arrays = [column if isinstance(column, pa.Array) else pa.array(column) for column in columns]
        fields = [
            pa.field(
                name, array.type, nullable=False, metadata={"unit": unit, **REASONS_METADATA.get(name, {})}
            )
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
