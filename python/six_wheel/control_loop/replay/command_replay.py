"""A drive through a table of commands, done again from the rows that its record has."""

import contextlib
import itertools
import json
import tempfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from six_wheel.control_loop import Settings
from six_wheel.control_loop.replay.run_summary import OUT, Collected, Replayed
from six_wheel.logs.headers.columns import TIME
from six_wheel.logs.mcap import Record, RecordError, rover_record
from six_wheel.logs.mcap.reader import Message
from six_wheel.logs.tables import Chunk, RowError
from six_wheel.simulation.drive.closed_loop import ControlledDrive, DriveLoop
from six_wheel.simulation.drive.feedforward import Drive
from six_wheel.simulation.drive.recording import DriveRecord

DRIVE = "drive"


def replay_drive(
    record: Record,
    before: Settings,
    after: Settings,
    output: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Replayed:
    """A drive, done again with what was changed; see `six_wheel.control_loop.replay.replay`.

    What comes of it is written as the first time and read back like that: the same numbers are the same bits.
    """
    if "drive" not in record.settings:
        raise RecordError(f"{record.path}: the record must hold the table of commands, got none")
    with record.reading("what it says of the drive"):
        told = json.loads(record.settings["drive"])
        _engine(before, told)
    engine = _engine(after, told)
    with contextlib.ExitStack() as stack:
        if output is None:
            folder = stack.enter_context(tempfile.TemporaryDirectory())
            output = Path(folder) / "again.mcap"
        with DriveRecord(output, engine, after.text) as writer:
            wanted = _again(record, engine, writer, progress)
        again = _collect(Record(output), after)
    recorded = _collect(record, before)
    if record.cut_off:  # in the middle of a step, perhaps
        steps = max(min(len(recorded.times), len(recorded.stamps)) - 1, 0)
        for each in (recorded, again):
            each.end(steps, steps)
    commands = np.array(wanted).reshape(-1, 4)
    return Replayed(record.path.name, before, after, recorded.run(), again.run(), commands)


def _engine(settings: Settings, told: dict[str, Any]) -> ControlledDrive | Drive:
    unit = next(each for each in TIME.units if each.symbol == told["unit"])
    rover, said = settings.rover, settings.parameters
    if told["rate"] is None:
        return Drive(rover, unit, told["keep"])
    loop, rows = DriveLoop(said.limits, told["rate"], said.control, told["halt"]), told["block_rows"]
    return ControlledDrive(rover, unit, loop, told["keep"], block_rows=rows)


def _again(
    record: Record,
    engine: ControlledDrive | Drive,
    writer: DriveRecord,
    progress: Callable[[int, int], None] | None,
) -> list[list[float]]:
    """Drives through the rows; what they are: times [ns] and twists."""
    scale, wanted, row = 1e9 * engine.time_unit.scale, [], 1
    rows = (_row(record, each) for each in record.messages([rover_record.GIVEN]))
    try:
        for chunk in _chunks(rows):
            writer.given(chunk)
            row = chunk.first_row
            wanted += np.column_stack([chunk.stamps * scale, chunk.twists]).tolist()
            _write(writer, engine.blocks(chunk))
            if progress is not None:
                progress(row, record.count)
        if not wanted:
            raise RecordError(f"{record.path}: the record must hold the table of commands, got none")
        _write(writer, engine.end())
    except RowError as error:
        raise RecordError(f"{record.path}: command {error.row}: {error.message}") from None
    return wanted


def _row(record: Record, message: Message) -> list[float]:
    """A command: its time and twist; nothing at the end of a part of the table."""
    with record.reading("a command"):
        row: list[float] = json.loads(record.parsed(message).data)
        if row and (len(row) != 4 or not all(isinstance(each, int | float) for each in row)):
            raise ValueError(f"a command must be a time and three numbers, got {row}")
    return row


def _write(writer: DriveRecord, blocks: Iterable[list[Any]]) -> None:
    for columns in blocks:
        writer.write(columns)


def _chunks(rows: Iterator[list[float]]) -> Iterator[Chunk]:
    """Chunks of commands: the rows up to each empty row."""
    first = 1
    while part := list(itertools.takewhile(bool, rows)):
        time = np.array([row[0] for row in part])
        yield Chunk(first, time, np.array([row[1:] for row in part], dtype=np.float64))
        first += len(part)


def _collect(record: Record, settings: Settings) -> Collected:
    """Commands and odometry of a record."""
    collected = Collected(settings.rover)
    for message in record.messages(OUT):
        collected.read(record, message)
    return collected
