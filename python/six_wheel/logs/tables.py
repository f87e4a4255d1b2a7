"""Tables, CSV or Parquet, read in chunks; command tables, checked row by row.

A command table has one row per command: a time, `vx`, `vy` (optional, 0 without it) and `omega`. Its columns
are found by their headers, in the spellings of `headers.columns.QUANTITIES`, and a header may state its unit:
``time_ns``, ``vx [mm/s]``, ``yaw_rate_deg_s``. Rows are counted from 1, lines as an editor counts them. Needs
pyarrow.
"""

import io
import itertools
import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Literal

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.errors import FileError, TableError, one_line
from six_wheel.kinematics.objects.closing import Closing
from six_wheel.logs.columnar import ColumnarFile, time_unit_of, units_of
from six_wheel.logs.headers.clock_times import is_clock_time
from six_wheel.logs.headers.columns import TIME_UNITS, Column, find_columns, is_number
from six_wheel.logs.plausibility.stamps import LATEST_SECOND
from six_wheel.logs.text.dialect import LONGEST_LINE, SPACES, cells_of, open_text, read_dialect
from six_wheel.robot_description.missing_files import no_file

if TYPE_CHECKING:
    import pyarrow as pa

Format = Literal["csv", "parquet", "arrow", "json"]
FORMATS: Mapping[str, Format] = {".csv": "csv", ".parquet": "parquet"}
# Further endings that are read, and not written.
READ: Mapping[str, Format] = {
    **FORMATS,
    **dict.fromkeys(
        (".txt", ".tsv", ".tum", ".dat", ".log", ".gz", ".bz2", ".xz", ".asc", ".lvm", ".prn"), "csv"
    ),
    **dict.fromkeys((".feather", ".arrow", ".ipc"), "arrow"),
    ".pq": "parquet",
    **dict.fromkeys((".jsonl", ".ndjson"), "json"),
}

LARGEST_BLOCK = 1 << 24  # [byte]


class RowError(FileError):
    """A row that cannot be used: `row` (counted from 1) and what is wrong with it."""

    def __init__(self, row: int, message: str) -> None:
        super().__init__(f"row {row}: {message}")
        self.row = row
        self.message = message


@dataclass(frozen=True)
class Chunk:
    """Consecutive rows: `stamps` (n,) as the file has them, float64 or int64; `twists` (n, 3), SI."""

    first_row: int
    stamps: NDArray[Any]
    twists: NDArray[np.float64]


def table_format(
    path: Path, endings: Collection[str] = FORMATS, formats: Mapping[str, Format] = FORMATS
) -> Format:
    """The format that the ending of a file stands for; an error names the `endings` there are. Raises
    `TableError` if it is none of `FORMATS`."""
    try:
        return formats[path.suffix.lower()]
    except KeyError:
        *others, last = endings
        rule = f"the ending must be {', '.join(others)} or {last}"
        raise TableError(f'{path}: {rule}, got "{path.suffix}"') from None


class Table(Closing):
    """A table on disk: a .parquet file, or a .csv file (comma, semicolon or tab; one header line).

    Opening it reads the headers and finds what a subclass wants among them. Raises `TableError` if the file
    is no such table.
    """

    text_stamps = False  # True if times may be written as clocks write them
    formats: Mapping[str, Format] = FORMATS

    def __init__(self, path: Path) -> None:
        self.path = path
        self.format = table_format(path, formats=self.formats)
        self.warnings: list[str] = []  # lines on readings that look wrong, but can be read
        self.size: int  # bytes of a CSV file, rows of a Parquet file: what `position` counts up to
        self._handle: BinaryIO | None = None
        self._file: ColumnarFile | None = None
        self._rows_read = 0
        self._field_units: dict[int, str] = {}  # of the columns of a Parquet file that states them apart
        if not path.is_file():
            raise TableError(f"{path}: not a file" if path.exists() else no_file(path))
        try:
            if self.format == "csv":
                self._open_csv()
            else:
                self._open_columnar()
        except BaseException as error:
            self.close()
            if isinstance(error, TableError):
                raise TableError(f"{path}: ", error) from None
            raise
        self.time_unit = self._columns["time"].unit

    def close(self) -> None:
        """Close the file."""
        for each in (self._handle, self._file):
            if each is not None:
                each.close()

    @property
    def position(self) -> int:
        """Progress of reading, in the unit of `size`."""
        if self.format != "csv" or self._handle is None or self._handle.closed:
            return self._rows_read
        return self._handle.tell()

    def error(self, row: int, message: str) -> TableError:
        """The error for a row, with the file, the row and, in a CSV file, the line."""
        number = next(itertools.islice(self._rows(), row - 1, None))[0] if self.format == "csv" else 0
        return TableError(f"{self.path}: row {row}{f' (line {number})' if number else ''}: {message}")

    def _find(self, headers: Sequence[str]) -> dict[str, Column]:
        """The columns to read, ``"time"`` among them."""
        return find_columns(headers)

    # CSV

    def _open_csv(self) -> None:
        if self.path.stat().st_size == 0:
            raise TableError("the table must have a header line, got an empty file")
        self._handle = handle = open_text(self.path)
        self.size = handle.seek(0, os.SEEK_END)
        if self.size == 0:
            raise TableError("the header must be a line of text, got none")
        handle.seek(-1, os.SEEK_END)
        if handle.read(1) not in b"\r\n":
            self.warnings.append(f"{self.path}: the last line has no line end: is the file complete?")
        self._dialect = dialect = read_dialect(handle, self._known_headers())
        self._skip_lines, self._header_bytes = dialect.skip_lines, dialect.header_bytes
        self._line_bytes = max((sum(map(len, row)) + len(row) for row in dialect.first), default=1)
        self._delimiter, self._headers = dialect.delimiter, dialect.headers
        self._field_units |= dialect.units
        self._columns = self._find(self._headers)
        self._types = dict.fromkeys(self._columns, "float64")
        self._types |= dict.fromkeys(self._types.keys() & {"nanoseconds"}, "int64")
        time = self._columns["time"]
        cells = [row[time.index].strip() for row in dialect.first if len(row) > time.index]
        # Only nanoseconds since 1970 are too long for a double; written as 1.7e18 they are lost already.
        whole = time.unit.symbol == "ns" and cells and re.fullmatch(r"-?\d+", cells[0])
        if whole or "nanoseconds" in self._columns:
            self._types["time"] = "int64"
        elif self.text_stamps and any(map(is_clock_time, cells)) and not any(map(is_number, cells)):
            self._types["time"] = "string"
            self._columns["time"] = replace(time, unit=TIME_UNITS[-1], stated=True)

    def _known_headers(self) -> Collection[str]:
        """Headers that the owner of the table named."""
        return ()

    def _csv_batches(self, chunk_rows: int) -> "Iterator[pa.RecordBatch]":
        for lines in self._blocks(min(max(chunk_rows * self._line_bytes, LONGEST_LINE), LARGEST_BLOCK)):
            yield from self._parse(lines)

    def _parse(self, lines: bytes) -> "list[pa.RecordBatch]":
        """Rows of whole lines. Raises `pyarrow.ArrowInvalid` if one of them is no row of numbers."""
        import pyarrow as pa
        import pyarrow.csv

        # By position, so that headers may repeat where nobody reads them.
        names = [f"c{index}" for index in range(len(self._headers))]
        wanted = {names[column.index]: self._types[name] for name, column in self._columns.items()}
        types = {name: getattr(pa, kind)() for name, kind in wanted.items()}
        convert = pa.csv.ConvertOptions(
            column_types=types,
            include_columns=list(wanted),
            null_values=[""],
            decimal_point=self._dialect.decimal,
        )
        parse = pa.csv.ParseOptions(delimiter=self._delimiter)
        # One block is parsed by one thread anyway; without others none is left at work when the process ends.
        read = pa.csv.ReadOptions(use_threads=False, column_names=names, block_size=len(lines) + 1)
        batches: list[pa.RecordBatch] = pa.csv.read_csv(
            pa.BufferReader(lines), read, parse, convert
        ).to_batches()
        return batches

    def _blocks(self, size: int) -> Iterator[bytes]:
        """Lines after the header, some `size` bytes at a time; Arrow's own stream reads 32 blocks ahead."""
        assert self._handle is not None
        self._handle.seek(self._header_bytes)
        rest = b""
        while data := self._handle.read(size):
            whole, end, rest = (rest + data).rpartition(b"\n")
            if whole.strip():
                yield self._single_spaced(whole + end)
            if len(rest) > LONGEST_LINE:
                raise RowError(self._rows_read + 1, f"a line must be shorter than {LONGEST_LINE} bytes")
        if rest.strip():
            yield self._single_spaced(rest)

    def _single_spaced(self, lines: bytes) -> bytes:
        """Lines with one space between cells, if spaces separate them."""
        if self._delimiter != SPACES:
            return lines
        return re.sub(rb"(?m)^ | (?=\r?$)", b"", re.sub(rb"[ \t]+", b" ", lines))

    def _rows(self) -> Iterator[tuple[int, str]]:
        """Line number and text of every row, slowly: only an error needs the line of a row."""
        with open_text(self.path) as handle:
            text = io.TextIOWrapper(handle, encoding="utf-8-sig", errors="replace", newline="\n")
            for number, line in enumerate(text, start=1):
                if number > self._skip_lines and line.strip("\r\n"):
                    yield number, line

    # Parquet and Arrow

    def _open_columnar(self) -> None:
        import pyarrow as pa

        self._file = ColumnarFile(self.path, self.format)
        self.size, schema = self._file.rows, self._file.schema
        self._headers = self._file.headers
        self._field_units |= units_of(schema)
        self._columns = self._find(self._headers)
        self._types = {}
        for name, column in self._columns.items():
            kind = schema.field(column.index).type
            self._types[name] = "float64"
            if name == "time" and (unit := time_unit_of(kind)) is not None:
                self._columns[name] = replace(column, unit=unit, stated=True)
                self._types[name] = "int64"
            elif name in ("time", "nanoseconds") and pa.types.is_integer(kind):
                self._types[name] = "int64"
            elif name == "time" and self.text_stamps and _is_text(kind):
                self._columns[name] = replace(column, unit=TIME_UNITS[-1], stated=True)
                self._types[name] = "string"
            elif not (pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind)):
                raise TableError(f'{name} must be numbers, got {kind} in column "{column.header}"')

    def _columnar_batches(self, chunk_rows: int) -> "Iterator[pa.RecordBatch]":
        import pyarrow as pa

        assert self._file is not None
        headers = {name: self._headers[column.index] for name, column in self._columns.items()}
        for batch in self._file.batches(chunk_rows, list(headers.values())):
            columns = {name: batch.column(header) for name, header in headers.items()}
            if pa.types.is_time32(columns["time"].type):
                columns["time"] = columns["time"].cast("int32")
            arrays = [column.cast(self._types[name]) for name, column in columns.items()]
            yield pa.RecordBatch.from_arrays(arrays, names=list(headers))


def _is_text(kind: "pa.DataType") -> bool:
    import pyarrow as pa

    kind = kind.value_type if pa.types.is_dictionary(kind) else kind
    return bool(pa.types.is_string(kind) or pa.types.is_large_string(kind))


class CommandTable(Table):
    """A command table on disk. `chunks` reads the rows, never all at once."""

    def chunks(self, chunk_rows: int) -> Iterator[Chunk]:
        """The rows in order, at most `chunk_rows` at a time; every number finite and time increasing.

        Raises
        ------
        TableError
            If a row is not like that, or the table has no rows.
        """
        import pyarrow as pa

        batches = (
            self._csv_batches(chunk_rows) if self.format == "csv" else self._columnar_batches(chunk_rows)
        )
        row, last = 1, None
        try:
            for batch in batches:
                for start in range(0, batch.num_rows, chunk_rows):
                    chunk = self._check(batch.slice(start, chunk_rows), row, last)
                    row += len(chunk.stamps)
                    last = chunk.stamps[-1]
                    self._rows_read = row - 1
                    yield chunk
        except pa.ArrowException as error:
            raise self._unreadable(error) from None
        except RowError as error:
            raise self.error(error.row, error.message) from None
        if row == 1:
            raise TableError(f"{self.path}: the table must have at least one row under its header, got none")

    def _check(self, batch: "pa.RecordBatch", row: int, last: Any) -> Chunk:
        values: dict[str, NDArray[Any]] = {}
        bad: list[tuple[int, str]] = []
        for (name, column), cells in zip(self._columns.items(), batch.columns, strict=True):
            if cells.null_count:
                k = int(np.flatnonzero(cells.is_null().to_numpy(zero_copy_only=False))[0])
                bad.append((k, f'{name} must be a number, got an empty cell in column "{column.header}"'))
            values[name] = cells.to_numpy(zero_copy_only=False)
            wrong = ~np.isfinite(values[name])
            if not cells.null_count and wrong.any():
                k = int(wrong.argmax())
                bad.append((k, f'{name} must be finite, got {values[name][k]} in column "{column.header}"'))
        if bad:
            k, message = min(bad)
            raise RowError(row + k, message)
        time = values["time"]
        # Row k of `late` against the row before it; the first row of all has none.
        late = np.concatenate([[last is not None and time[0] <= last], time[1:] <= time[:-1]])
        if late.any():
            k = int(late.argmax())
            raise RowError(row + k, f"time must increase, got {time[k]} after {time[k - 1] if k else last}")
        if last is None and not self._columns["time"].stated and abs(time[0]) > LATEST_SECOND:
            header = self._columns["time"].header
            rule = f'time must be in seconds unless its header states a unit, such as "{header}_ns"'
            raise RowError(row, f'{rule}, got {time[0]} in column "{header}"')
        twists = np.zeros((len(time), 3))
        for axis, name in enumerate(("vx", "vy", "omega")):
            if name in values:
                np.multiply(values[name], self._columns[name].unit.scale, out=twists[:, axis])
        return Chunk(row, time, twists)

    def _unreadable(self, error: Exception) -> TableError:
        """The error that names the first bad row and its line, which the parser's own message does not."""
        if self.format == "csv":
            for row, (_, line) in enumerate(self._rows(), start=1):
                if message := self._bad_record(line):
                    return self.error(row, message)
        return TableError(f"{self.path}: {one_line(error)}")

    def _bad_record(self, line: str) -> str | None:
        try:
            cells = cells_of(line, self._delimiter)
        except TableError:
            return f"a row must be a line of cells, got {line!r:.60}"
        if len(cells) != len(self._headers):
            cut = "; is the file cut off?" if len(cells) < len(self._headers) else ""
            return f"a row must have {len(self._headers)} cells as the header has, got {len(cells)}{cut}"
        for name, column in self._columns.items():
            cell = cells[column.index].strip()
            whole = self._types[name] == "int64"
            fits = (
                re.fullmatch(r"-?\d{1,19}", cell) and abs(int(cell)) < 1 << 63 if whole else is_number(cell)
            )
            if cell and not fits:
                kind = "a whole number of nanoseconds" if whole else "a number"
                return f'{name} must be {kind}, got "{cell:.60}" in column "{column.header}"'
        return None
