"""Driving a command table: joint commands, odometry and residuals, chunk by chunk in constant memory.

Directly, the command of a row holds from its time to that of the next row. Through a `Controller`, commands
come when their stamps say and the rows of the results are the steps of its loop. The pose in a row is the one
at its time, integrated from the twists that `Rover.fit` reads back from the joint commands: what odometry
would say.
"""

import contextlib
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.drive.controlled import REASONS_METADATA, ControlledDrive, Loop
from six_wheel.drive.direct import Drive
from six_wheel.drive.engine import Engine, Summary
from six_wheel.logs.bags import JointCommandWriter
from six_wheel.logs.tables import FORMATS, CommandTable, RowError, table_format
from six_wheel.logs.writing import TableWriter, replacing

__all__ = ["drive"]

BAG = ".mcap"


def drive(
    rover: Rover,
    commands: Path,
    output: Path | None = None,
    *,
    loop: Loop | None = None,
    finish: Callable[[Drive | ControlledDrive], None] | None = None,
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
    finish : callable, optional
        Called with the drive at its end, before the output is replaced: what it raises leaves all as it was.
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
        result = stack.enter_context(replacing(output, [commands, *sources])) if output else None
        with _writer(result, engine) if result else contextlib.nullcontext() as writer:
            try:
                for chunk in table.chunks(chunk_rows):
                    _write(writer, engine.blocks(chunk))
                    if progress is not None:
                        progress(table.position, table.size)
                _write(writer, engine.end())
            except RowError as error:
                raise table.error(error.row, error.message) from None
        if finish is not None:
            finish(engine)
    engine.summary.elapsed = time.perf_counter() - begin
    engine.summary.warnings += table.warnings
    return engine.summary


def _write(writer: "TableWriter | CommandWriter | None", blocks: Iterator[list[Any]]) -> None:
    for columns in blocks:
        if writer is not None:
            writer.write(columns)


def _writer(path: Path, engine: Engine) -> "TableWriter | CommandWriter":
    if path.suffix.lower() == BAG:
        return CommandWriter(path, engine)
    return TableWriter(path, engine.units, REASONS_METADATA)


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
        steering, traction = map(list, engine.joints)
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
