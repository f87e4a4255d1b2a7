"""Overview of an unknown log: its columns or topics, with rate, range and what each seems to be."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np

from six_wheel._core import Rover
from six_wheel.kinematics.errors import TableError
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.bags.bag_files import is_bag
from six_wheel.logs.detect_reader import log_format, open_log
from six_wheel.logs.headers.columns import Column, Unit
from six_wheel.logs.headers.joint_columns import joint_columns
from six_wheel.logs.headers.rate_columns import rate_columns
from six_wheel.logs.headers.time_columns import time_columns
from six_wheel.logs.headers.truth_columns import truth_columns
from six_wheel.logs.log_options import LogOptions
from six_wheel.logs.plausibility.jumps import find_jumps, may_jump
from six_wheel.logs.plausibility.proposals import number
from six_wheel.logs.plausibility.whole_numbers import all_whole
from six_wheel.logs.skip_bad_rows import TolerantTable

Found: TypeAlias = tuple[list["ColumnOverview"], dict[str, str]]
MEANINGS = {"JointState": "joint states", "Imu": "gyroscope", "Odometry": "poses", "PoseStamped": "poses"}
PLAIN = Unit("", 1.0, ())


@dataclass(frozen=True)
class ColumnOverview:
    """A column or topic: its name, what is in it, and what it seems to be."""

    name: str
    values: str
    meaning: str


@dataclass(frozen=True)
class LogOverview:
    """Content of a log: `columns`, `facts` about all of it, why it is not read, and what is doubted; the
    `option` with which it is read, where a refusal proposes one."""

    columns: tuple[ColumnOverview, ...]
    facts: Mapping[str, str]
    refusal: str | None
    doubts: tuple[str, ...] = ()
    option: str = ""


def overview(path: Path, rover: Rover | None = None, options: LogOptions | None = None) -> LogOverview:
    """An overview of a log: a table or a bag. The wheels of a rover are looked for, and the log is read with
    it.

    Raises `TableError` if it is nothing of these.
    """
    log_format(path)
    columns, facts = _of_bag(path) if is_bag(path) else _of_table(path, rover, options or LogOptions())
    refusal, doubts, option = None, list[str](), ""
    if rover is not None:
        try:
            with open_log(path, rover, options or LogOptions()) as log:
                rows = sum(len(chunk.stamps) for chunk in log.chunks())
                doubts = [line.removeprefix(f"{path}: ") for line in log.warnings]
                facts = facts | {"rows that can be used": f"{rows:,}", "wheels are read as": log.readings}
        except ValueError as error:
            refusal, option = str(error).removeprefix(f"{path}: "), getattr(error, "option", "")
    return LogOverview(tuple(columns), facts, refusal, tuple(doubts), option)


def _of_bag(path: Path) -> Found:
    from six_wheel.logs.bags.messages import Bag, numbers_in

    bag = Bag(path)
    try:
        seconds = max(bag.duration, 1e-9)
        found = []
        for each in sorted(bag.connections, key=lambda one: one.topic):
            rate = f"{each.msgcount:,} messages, {each.msgcount / seconds:.3g} Hz"
            kind = each.msgtype.rpartition("/")[2]
            hint = "readings of wheels, by --topic" if numbers_in([each]) else ""
            found.append(ColumnOverview(f"{each.topic} ({kind})", rate, MEANINGS.get(kind, hint)))
        return found, {"duration": f"{seconds:.6g} s"}
    finally:
        bag.close()


def _of_table(path: Path, rover: Rover | None, options: LogOptions) -> Found:
    names: list[str] = []

    def find(headers: Sequence[str], field_units: Mapping[int, str]) -> dict[str, Column]:
        names.extend(headers)
        time = time_columns(headers, field_units, options.stamp_unit)
        taken = {column.index for column in time.values()}
        others = {
            str(k): Column(k, header, PLAIN, False) for k, header in enumerate(headers) if k not in taken
        }
        return time | others

    table = TolerantTable(path, find, options.columns or None, [str(number) for number in range(10_000)])
    try:
        batches = list(table.batches(65_536))
    finally:
        table.close()
    stamps = np.concatenate([batch.time for batch in batches]) if batches else np.zeros(0)
    seconds = (stamps - stamps[0]) * table.time_unit.scale if len(stamps) else stamps
    meanings = _meanings(names, rover)
    found = []
    for place, header in enumerate(names):
        parts = [batch.values[str(place)] for batch in batches if str(place) in batch.values]
        meaning = meanings.get(place, "")
        if not parts:
            meaning = "time" if table.of_clock else f"time [{table.time_unit.symbol}]"
            found.append(ColumnOverview(header, "times", meaning))
            continue
        found.append(ColumnOverview(header, _values(np.concatenate(parts)), meaning))
    return found, dict(_facts(seconds, table.stated))


def _facts(seconds: Floats, stated: bool) -> Iterator[tuple[str, str]]:
    steps = np.diff(seconds)
    steps = steps[steps > 0.0]
    yield "rows", f"{len(seconds):,}"
    if len(steps):
        period = float(np.median(steps))
        yield "duration", f"{float(seconds[-1]):.6g} s{'' if stated else ', if the times are in seconds'}"
        yield "rate", f"{1.0 / period:.4g} Hz"
        longest = float(steps.max())
        if longest > 5.0 * period:
            yield "longest gap", f"{longest:.4g} s before row {int(np.argmax(np.diff(seconds))) + 2}"


def _values(column: Floats) -> str:
    there = column[np.isfinite(column)]
    if not len(there):
        return "no numbers"
    said = f"{number(float(there.min()))} to {number(float(there.max()))}"
    said += ", whole numbers" if all_whole(there) else ""
    said += f", {len(column) - len(there)} empty" if len(there) < len(column) else ""
    jumps = find_jumps(there, (), all_whole(there)) if may_jump(there, np.diff(there)) else None
    if jumps is not None and jumps.wraps_at is not None:
        turns = len(jumps.rows)
        said += f", wraps at {number(jumps.wraps_at)} ({f'{turns} times' if turns > 1 else 'once'})"
    elif jumps is not None:
        said += f", set anew {len(jumps.rows)} times"
    return said


def _meanings(headers: Sequence[str], rover: Rover | None) -> dict[int, str]:
    """The meanings of columns, by their numbers."""
    found: dict[str, Column] = {}
    for reader in (truth_columns, rate_columns):
        try:
            what = "truth " if reader is truth_columns else "gyroscope "
            found |= {what + name: column for name, column in reader(headers).items()}
        except TableError:
            continue
    if rover is not None:
        with contextlib.suppress(TableError):
            found |= joint_columns(headers, rover).columns
    return {
        column.index: f"{name} [{column.unit.symbol}]" for name, column in found.items() if name != "time"
    }
