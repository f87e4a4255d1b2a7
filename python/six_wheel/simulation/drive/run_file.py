"""Driving a command table: joint commands, odometry and residuals, chunk by chunk in constant memory.

Directly, the command of a row holds from its time to that of the next row. Through a `Controller`, commands
come when their stamps say and the rows of the results are the steps of its loop. The pose in a row is the one
at its time, integrated from the twists that `Rover.fit` reads back from the joint commands: what odometry
would say.
"""

import contextlib
import os
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from six_wheel._core import Rover
from six_wheel.kinematics.errors import as_path
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.objects.whole_files import replacing
from six_wheel.logs.tables import FORMATS, CommandTable, RowError, table_format
from six_wheel.logs.writing import TableWriter
from six_wheel.robot_description.parameters.writing import text_of
from six_wheel.simulation.drive.closed_loop import REASONS_METADATA, ControlledDrive, DriveLoop
from six_wheel.simulation.drive.feedforward import Drive
from six_wheel.simulation.drive.recording import DriveRecord
from six_wheel.simulation.drive.run_commands import Engine, Summary

BAG = ".mcap"


@checked()
def drive(
    rover: Rover,
    commands: str | os.PathLike[str],
    output: str | os.PathLike[str] | None = None,
    *,
    loop: DriveLoop | None = None,
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
    commands : path
        A command table, see `logs`.
    output : path, optional
        Joint commands, poses, twists and residuals, .csv or .parquet; .mcap: a record with the topics of
        `logs.mcap.rover_record`, for viewers.
    loop : DriveLoop, optional
        The controller to drive through, and how often it steps; without it, directly.
    finish : callable, optional
        Called with the drive at its end, before the output is replaced: what it raises leaves all as it was.
    keep : str, optional
        Part to keep of a twist that the rover cannot make: curvature, speed, yaw_rate or nearest.
    chunk_rows : int, default 200,000
        Most rows in memory at a time.
    sources : sequence of Path
        Files that must not be overwritten, beside `commands`.
    progress : callable, optional
        Called after every chunk with how far it is and how far it will go.

    Returns
    -------
    Summary
        Rows, duration [s], length of the path [m], largest speeds and angles, reasons of limits.

    Raises
    ------
    TableError
        If the table, a row of it or an output file cannot be used.
    """
    commands = as_path("commands", commands)
    output = None if output is None else as_path("output", output)
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
        with _writer(result, engine, loop) if result else contextlib.nullcontext() as writer:
            try:
                for chunk in table.chunks(chunk_rows):
                    if isinstance(writer, DriveRecord):
                        writer.given(chunk)
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


def _write(writer: "TableWriter | DriveRecord | None", blocks: Iterator[list[Any]]) -> None:
    for columns in blocks:
        if writer is not None:
            writer.write(columns)


def _writer(path: Path, engine: Engine, loop: DriveLoop | None) -> "TableWriter | DriveRecord":
    if path.suffix.lower() == BAG:
        others = {} if loop is None else {"limits": loop.limits, "control": loop.control}
        return DriveRecord(path, engine, text_of(engine.rover, **others))
    return TableWriter(path, engine.units, REASONS_METADATA)
