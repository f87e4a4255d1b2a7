"""Tables of which a bad row costs that row and no other: cut lines, text among numbers, NaN, wrong order."""

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.errors import TableError, one_line
from six_wheel.logs.headers.clock_times import KNOWN, ClockTimes
from six_wheel.logs.headers.columns import Column, Unit, is_number
from six_wheel.logs.headers.renamed import Columns, renamed, without_header
from six_wheel.logs.plausibility.findings import Findings, Kind
from six_wheel.logs.plausibility.stamps import LATEST_SECOND, out_of_order, rows_behind, since_1970
from six_wheel.logs.tables import READ, RowError, Table
from six_wheel.logs.text.dialect import cells_of, has_groups, without_groups

if TYPE_CHECKING:
    import pyarrow as pa

BLOCK = 1 << 20  # [byte] that are read line by line if one of the lines is bad

Find: TypeAlias = Callable[[Sequence[str], Mapping[int, str]], dict[str, Column]]


@dataclass(frozen=True)
class Batch:
    """Rows with their numbers and lines (0 without), times as the file has them, and values in SI by name."""

    rows: NDArray[np.int64]
    lines: NDArray[np.int64]
    time: NDArray[Any]
    values: dict[str, NDArray[np.float64]]

    def __len__(self) -> int:
        return len(self.time)

    def __getitem__(self, chosen: Any) -> "Batch":
        values = {name: column[chosen] for name, column in self.values.items()}
        return Batch(self.rows[chosen], self.lines[chosen], self.time[chosen], values)

    def columns(self, names: Sequence[str]) -> NDArray[np.float64]:
        """Values side by side (n, names), NaN where there are none of a name."""
        found = np.full((len(self), len(names)), np.nan)
        for place, name in enumerate(names):
            if name in self.values:
                found[:, place] = self.values[name]
        return found


class Source(Protocol):
    """Source of batches: a table or a bag."""

    time_unit: Unit
    findings: Findings

    @property
    def size(self) -> int: ...

    @property
    def position(self) -> int: ...

    def batches(self, chunk_rows: int) -> Iterator[Batch]: ...

    def close(self) -> None: ...


@dataclass
class CellError(Exception):
    """A line that is no row of numbers: the `rule` it breaks, and the cell or line that does."""

    rule: str
    got: str


class TolerantTable(Table):
    """A table whose bad rows are reported to `findings` and left out.

    `find` leads from headers, and units of columns whose header states none, to columns, ``"time"`` among
    them. `renamed` are names of columns as `headers.renamed` takes them, `unnamed` those of as many columns
    without a header line; the columns `spare` may lack a value in any row.
    """

    text_stamps = True
    formats = READ

    def __init__(
        self,
        path: Path,
        find: Find,
        renamed: Columns | None = None,
        spare: Collection[str] = (),
        unnamed: Sequence[str] = (),
    ) -> None:
        self._find_in, self._renamed, self._spare, self._unnamed = find, renamed or {}, spare, unnamed
        self._clock = ClockTimes()
        super().__init__(path)
        self.findings = Findings(path)

    def _known_headers(self) -> Collection[str]:
        given = self._renamed
        return {*given, *given.values()} if isinstance(given, Mapping) else ()

    def _find(self, headers: Sequence[str]) -> dict[str, Column]:
        nameless = self.format == "csv" and not self._dialect.has_header
        if nameless and not self._renamed and len(headers) == len(self._unnamed):
            self._renamed = self._unnamed
        if nameless and not self._renamed:
            raise TableError(*without_header(headers))
        return self._find_in(renamed(headers, self._renamed, nameless), self._field_units)

    @property
    def stated(self) -> bool:
        """True if the header of the times states their unit, False if it is the default."""
        return self._columns["time"].stated

    @property
    def of_clock(self) -> bool:
        """True if times are written as clocks write them."""
        return self._types["time"] == "string"

    def batches(self, chunk_rows: int) -> Iterator[Batch]:
        """The rows in the file's order, at most `chunk_rows` at a time, without those that are no rows."""
        for batch in self._tolerant_lines() if self.format == "csv" else self._tolerant_groups(chunk_rows):
            for start in range(0, len(batch), chunk_rows):
                yield batch[start : start + chunk_rows]

    def _tolerant_groups(self, chunk_rows: int) -> Iterator[Batch]:
        import pyarrow as pa

        row = 1
        try:
            for batch in self._columnar_batches(chunk_rows):
                lines = np.zeros(batch.num_rows, dtype=np.int64)
                yield self._columns_of(batch, row, lines)
                row += batch.num_rows
                self._rows_read = row - 1
        except pa.ArrowException as error:
            raise TableError(f"{self.path}: {one_line(error)}") from None

    def _tolerant_lines(self) -> Iterator[Batch]:
        import pyarrow as pa

        row, line = 1, self._skip_lines + 1
        try:
            for block in self._blocks(BLOCK):
                whole, end, cut = block.rpartition(b"\n")
                if cut.strip():  # only the last block of a file has such a rest
                    block = whole + end
                lines = self._numbered(block, line)
                if len(lines):
                    try:
                        batches = self._parse(block)
                        # Arrow drops lines that hold nothing but a line end, and so did the numbering.
                        if sum(batch.num_rows for batch in batches) != len(lines):
                            raise pa.ArrowInvalid("a cell with a line end")
                    except pa.ArrowInvalid:
                        yield self._line_by_line(block, row, lines)
                    else:
                        start = 0
                        for batch in batches:
                            yield self._columns_of(batch, row + start, lines[start : start + batch.num_rows])
                            start += batch.num_rows
                row, line = row + len(lines), line + block.count(b"\n")
                self._rows_read = row - 1
                if cut.strip():
                    rule = "the last row must end in a line end, or its last number may be cut short"
                    self.findings.add(row, rule, line=line)
        except RowError as error:
            self.findings.add(row, f"{error.message}; what follows is not read", line=line)

    @staticmethod
    def _numbered(block: bytes, first: int) -> NDArray[np.int64]:
        """The numbers of the lines that hold something."""
        count = block.count(b"\n")
        if b"\n\n" not in block and b"\n\r\n" not in block and not block.startswith((b"\n", b"\r\n")):
            return np.arange(first, first + count)
        held = [bool(line.strip(b"\r")) for line in block.split(b"\n")[:count]]
        return first + np.flatnonzero(held)

    def _columns_of(self, batch: "pa.RecordBatch", row: int, lines: NDArray[np.int64]) -> Batch:
        import pyarrow.compute as pc

        columns = dict(zip(self._columns, batch.columns, strict=True))
        rows = np.arange(row, row + batch.num_rows)
        time = columns.pop("time")
        fraction = columns.pop("nanoseconds", None)
        values = {name: column.to_numpy(zero_copy_only=False) for name, column in columns.items()}
        if self._types["time"] == "string":
            return self._batch(rows, lines, time.to_pylist(), values)
        if fraction is not None:
            time = pc.add(pc.multiply(time, 1_000_000_000), pc.multiply(fraction, self._finer))
        void = time.is_null().to_numpy(zero_copy_only=False)
        return self._batch(rows, lines, time.fill_null(0).to_numpy(zero_copy_only=False), values, void)

    @property
    def _finer(self) -> int:
        """Nanoseconds of one in the second column of stamps."""
        return round(1e9 * self._columns["nanoseconds"].unit.scale)

    def _batch(
        self,
        rows: NDArray[np.int64],
        lines: NDArray[np.int64],
        time: Any,
        values: Mapping[str, Any],
        void: NDArray[np.bool_] | None = None,
    ) -> Batch:
        """Rows with times, or their texts; those without (`void`) and of texts that are none are reported."""
        rule, got = "time must be a number", ", got an empty cell"
        kind: Kind = "no number"
        texts: Sequence[str | None] | None = time if self._types["time"] == "string" else None
        if texts is not None:
            time, good = self._clock.read(texts)
            rule, kind, void = f"time must be such as {KNOWN}", "other", ~good
        for k in [] if void is None else np.flatnonzero(void).tolist():
            got = got if texts is None else f', got "{texts[k] or ""}"'
            self.findings.add(int(rows[k]), rule, got, int(lines[k]), kind)
        scale = {name: self._columns[name].unit.scale for name in values}
        scaled = {name: np.asarray(each, dtype=float) * scale[name] for name, each in values.items()}
        batch = Batch(rows, lines, time, scaled)
        return batch if void is None or not void.any() else batch[~void]

    def _line_by_line(self, block: bytes, row: int, lines: NDArray[np.int64]) -> Batch:
        """Valid rows of a block that Arrow refused as a whole, read line by line; the others are reported."""
        texts = [line for line in block.decode("utf-8", "replace").split("\n") if line.strip("\r")]
        kept: list[int] = []
        cells: list[list[Any]] = []
        for k, text in enumerate(texts):
            try:
                cells.append(self._numbers(text.strip("\r")))
                kept.append(k)
            except CellError as error:
                self.findings.add(row + k, error.rule, f", got {error.got}", int(lines[k]), "no number")
        columns = list(zip(*cells, strict=True)) or [()] * len(self._columns)
        by_name = dict(zip(self._columns, columns, strict=True))
        times, rows = by_name.pop("time"), row + np.array(kept, dtype=np.int64)
        nanoseconds = np.array(by_name.pop("nanoseconds", [0] * len(kept)), dtype=np.int64)
        if self._types["time"] == "string":
            return self._batch(rows, lines[kept], times, by_name)
        time = np.array(times, dtype=self._types["time"])
        if "nanoseconds" in self._columns:
            time = time * 1_000_000_000 + self._finer * nanoseconds
        return self._batch(rows, lines[kept], time, by_name)

    def _numbers(self, text: str) -> list[Any]:
        try:
            cells = cells_of(text, self._delimiter)
        except TableError:
            raise CellError("a row must be a line of cells", f"{text!r:.60}") from None
        if len(cells) != len(self._headers):
            raise CellError(f"a row must have {len(self._headers)} cells as the header has", f"{len(cells)}")
        numbers: list[Any] = []
        for name, column in self._columns.items():
            cell = without_groups(cells[column.index].strip())
            if self._dialect.decimal == ",":
                cell = cell.replace(",", ".")
            if self._types[name] == "string":
                numbers.append(cell)
            elif self._types[name] == "int64":
                if not re.fullmatch(r"[+-]?0*\d{1,19}", cell) or abs(int(cell)) >= 1 << 63:
                    raise CellError(f"{name} must be a whole number of nanoseconds", f'"{cell}"')
                numbers.append(int(cell))
            elif is_number(cell):
                numbers.append(float(cell))
            elif name in self._spare or (not cell and name != "time"):
                numbers.append(np.nan)
            else:
                such = f", or such as {KNOWN}" if name == "time" else ""
                such += ", without commas or points between thousands" if has_groups(cell) else ""
                raise CellError(f"{name} must be a number{such}", f'"{cell}" in column "{column.header}"')
        return numbers


class Sieve:
    """Lets the rows through that hold numbers and whose times increase; the others are reported.

    A row that is no later than the last one kept is left out. One that runs ahead, so that the next row is
    between it and the row before, is left out instead of all that follow.

    Columns of `spare` may lack a value; `stated` is True if the unit of the times is stated, and not only the
    default, `strict` if rows in another order than that of time are refused as a whole; `warn` is called with
    a line where rows are left out whose rates the path misses.
    """

    def __init__(
        self,
        findings: Findings,
        spare: Collection[str],
        stated: bool,
        strict: bool = False,
        warn: Callable[[str], None] | None = None,
    ) -> None:
        self._findings, self._spare, self._stated = findings, spare, stated
        self._strict, self._warn = strict, warn
        self._held: Batch | None = None
        self._last: Any = None

    def pass_on(self, batches: Iterator[Batch]) -> Iterator[Batch]:
        """The batches without the rows that are left out; none is empty."""
        for batch in batches:
            numbers = self._numbers_only(batch)
            if not len(numbers):
                continue
            # A batch waits for the first row of the next, which may show that its last row runs ahead.
            if self._held is not None and len(kept := self._in_order(self._held, numbers.time[:1])):
                yield kept
            self._held = numbers
        if self._held is not None and len(kept := self._in_order(self._held, self._held.time[:0])):
            yield kept

    def _numbers_only(self, batch: Batch) -> Batch:
        good = np.ones(len(batch), dtype=bool)
        columns = {"time": batch.time} | {n: c for n, c in batch.values.items() if n not in self._spare}
        flaws: dict[int, tuple[str, float]] = {}
        for name, column in columns.items():
            for k in np.flatnonzero(~np.isfinite(column)).tolist():
                flaws.setdefault(k, (f"{name} must be a finite number", column[k]))
        for k, (rule, value) in sorted(flaws.items()):
            self._report(batch, k, rule, f", got {value}", "nan" if np.isnan(value) else "no number")
            good[k] = False
        return batch if good.all() else batch[good]

    def _in_order(self, batch: Batch, following: NDArray[Any]) -> Batch:
        time = np.concatenate([batch.time, following])
        if self._last is None and not self._stated and abs(time[0]) > LATEST_SECOND:
            rule = "time must be in seconds unless its header states a unit, such as time_ns"
            got = f"{rule}, got {time[0]}: "
            first = f"{self._findings.path}: row {batch.rows[0]}: {got}"
            raise TableError(first, *since_1970(float(time[0])))
        late = self._last is not None and time[0] <= self._last
        if late or (np.diff(time) <= 0).any():
            kept = []
            for k in range(len(batch)):
                after = time[k + 1] if k + 1 < len(time) else np.inf
                if self._last is not None and time[k] == self._last:
                    self._report(
                        batch, k, "time must increase", f", got the same twice: {time[k]}", "same time"
                    )
                elif self._last is not None and time[k] < self._last:
                    self._report(batch, k, "time must increase", f", got {time[k]} after {self._last}")
                elif after < time[k] and (self._last is None or after > self._last):
                    self._report(batch, k, "time must not run ahead", f", got {time[k]} before {after}")
                else:
                    kept.append(k)
                    self._last = time[k]
            self._check_order(batch, time, kept)
            return batch[kept]
        self._last = batch.time[-1]
        return batch

    def _check_order(self, batch: Batch, time: NDArray[Any], kept: Sequence[int]) -> None:
        """Refuses rows in another order than that of time, and a clock that started anew."""
        late = np.setdiff1d(np.arange(len(batch)), kept)
        if self._warn is not None and (line := rows_behind(time, late, batch.rows)):
            self._warn(line)
        if self._strict and (line := out_of_order(time, "time", late, batch.rows)):
            raise TableError(f"{self._findings.path}: {line}")

    def _report(self, batch: Batch, k: int, rule: str, got: str, kind: Kind = "other") -> None:
        self._findings.add(int(batch.rows[k]), rule, got, int(batch.lines[k]), kind)
