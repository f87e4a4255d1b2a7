"""Tables, CSV or Parquet, read in chunks; command tables, checked row by row.

A command table has one row per command: a time, `vx`, `vy` (optional, 0 without it) and `omega`. Its columns
are found by their headers, in the spellings of `headers.columns.QUANTITIES`, and a header may state its unit:
``time_ns``, ``vx [mm/s]``, ``yaw_rate_deg_s``. Rows are counted from 1, lines as an editor counts them. Needs
pyarrow.
"""

import contextlib
import csv
import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Literal, Self

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.errors import FileError
from six_wheel.kinematics.odometry.headers.columns import (
    TIME_UNITS,
    Column,
    TableError,
    find_columns,
    is_number,
)

if TYPE_CHECKING:
    import pyarrow as pa

Format = Literal["csv", "parquet"]
FORMATS: Mapping[str, Format] = {".csv": "csv", ".parquet": "parquet"}

# A bare "time" is in seconds. Larger than this (the year 5138) it is a count of something shorter.
LATEST_SECOND = 1e11
LONGEST_LINE, LARGEST_BLOCK = 1 << 16, 1 << 24  # [byte]


class RowError(FileError):
    """A row that cannot be used: `row` (counted from 1) and what is wrong with it."""

    def __init__(self, row: int, message: str) -> None:
        super().__init__(f"row {row}: {message}")
        self.row = row
        self.message = message


@dataclass(frozen=True)
class Chunk:
    """Consecutive rows: `time` (n,) as the file has it, float64 or int64; `twists` (n, 3), SI."""

    first_row: int
    time: NDArray[Any]
    twists: NDArray[np.float64]


def table_format(path: Path, endings: Collection[str] = FORMATS) -> Format:
    """The format that the ending of a file stands for; an error names the `endings` there are.

    Raises
    ------
    TableError
        If it is none of `FORMATS`.
    """
    try:
        return FORMATS[path.suffix.lower()]
    except KeyError:
        *others, last = endings
        rule = f"the ending must be {', '.join(others)} or {last}"
        raise TableError(f'{path}: {rule}, got "{path.suffix}"') from None


class Table:
    """A table on disk. Opening it reads the headers and finds what a subclass wants among them.

    Parameters
    ----------
    path : Path
        A .csv file (comma, semicolon or tab between cells; one header line) or a .parquet file.

    Attributes
    ----------
    time_unit : Unit
        Unit of the time column.
    size : int
        Bytes of a CSV file, rows of a Parquet file: what `position` counts up to.
    warnings : list of str
        What looks wrong, but can be read.

    Raises
    ------
    TableError
        If the file is no such table.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.format = table_format(path)
        self.warnings: list[str] = []
        self._handle: BinaryIO | None = None
        self._rows_read = 0
        self._field_units: dict[int, str] = {}  # of the columns of a Parquet file that states them apart
        if not path.is_file():
            raise TableError(f"{path}: {'not a file' if path.exists() else 'no such file'}")
        try:
            if self.format == "csv":
                self._open_csv()
            else:
                self._open_parquet()
        except BaseException as error:
            self.close()
            if isinstance(error, TableError):
                raise TableError(f"{path}: {error}") from None
            raise
        self.time_unit = self._columns["time"].unit

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: object, traceback: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        if self._handle is not None:
            self._handle.close()

    @property
    def position(self) -> int:
        """Progress of reading, in the unit of `size`."""
        if self.format == "parquet" or self._handle is None or self._handle.closed:
            return self._rows_read
        return self._handle.tell()

    def error(self, row: int, message: str) -> TableError:
        """The error for a row, with the file, the row and, in a CSV file, the line."""
        line = "" if self.format == "parquet" else f" (line {self._line_of(row)})"
        return TableError(f"{self.path}: row {row}{line}: {message}")

    def _find(self, headers: Sequence[str]) -> dict[str, Column]:
        """The columns to read, ``"time"`` among them."""
        return find_columns(headers)

    # CSV

    def _open_csv(self) -> None:
        self.size = self.path.stat().st_size
        if self.size == 0:
            raise TableError("the table must have a header line, got an empty file")
        self._handle = handle = open(self.path, "rb")  # noqa: SIM115
        self._skip_lines = self._header_bytes = 0
        lines: list[bytes] = []
        while len(lines) < 2 and (line := handle.readline(LONGEST_LINE)):
            self._skip_lines += not lines
            if line.strip():
                lines.append(line)
                self._header_bytes = self._header_bytes or handle.tell()
        self._line_bytes = max(map(len, lines), default=1)
        handle.seek(-1, os.SEEK_END)
        if handle.read(1) not in b"\r\n":
            self.warnings.append(f"{self.path}: the last line has no line end: is the file complete?")
        try:
            first = [line.decode("utf-8-sig") for line in lines]
        except UnicodeDecodeError as error:
            byte = error.object[error.start]
            raise TableError(f"the header must be UTF-8 text, got byte 0x{byte:02x}") from None
        if not first or "\0" in first[0]:
            raise TableError("the header must be a line of text, got none")
        self._delimiter = max((",", ";", "\t"), key=first[0].count)
        # numpy.savetxt puts "# " before its header, rostopic "%".
        self._headers = [cell.strip().lstrip("#% ") for cell in self._cells(first[0])]
        self._columns = self._find(self._headers)
        self._types = dict.fromkeys(self._columns, "float64")
        # Only nanoseconds since 1970 are too long for a double; written as 1.7e18 they are lost already.
        time = self._columns["time"]
        cell = self._cells(first[1])[time.index : time.index + 1] if len(first) == 2 else []
        if time.unit.symbol == "ns" and cell and re.fullmatch(r"-?\d+", cell[0].strip()):
            self._types["time"] = "int64"

    def _cells(self, line: str) -> list[str]:
        try:
            return next(csv.reader([line], delimiter=self._delimiter))
        except csv.Error as error:
            raise TableError(f"the header must be a line of cells, got {line!r:.60} ({error})") from None

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
        convert = pa.csv.ConvertOptions(column_types=types, include_columns=list(wanted), null_values=[""])
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
                yield whole + end
            if len(rest) > LONGEST_LINE:
                raise RowError(self._rows_read + 1, f"a line must be shorter than {LONGEST_LINE} bytes")
        if rest.strip():
            yield rest

    def _rows(self) -> Iterator[tuple[int, str]]:
        """Line number and text of every row, slowly: only an error needs the line of a row."""
        with open(self.path, encoding="utf-8-sig", errors="replace", newline="\n") as text:
            for number, line in enumerate(text, start=1):
                if number > self._skip_lines and line.strip("\r\n"):
                    yield number, line

    def _line_of(self, row: int) -> int:
        return next(number for k, (number, _) in enumerate(self._rows(), start=1) if k == row)

    # Parquet

    def _open_parquet(self) -> None:
        import pyarrow as pa
        import pyarrow.parquet

        self._handle = open(self.path, "rb")  # noqa: SIM115
        try:
            # Pre-buffering would hold a whole row group, which may be the whole file.
            self._file = pa.parquet.ParquetFile(self._handle, pre_buffer=False, buffer_size=1 << 20)
        except (pa.ArrowException, OSError) as error:
            raise TableError(f"not a readable Parquet file: {' '.join(str(error).split())}") from None
        self.size = self._file.metadata.num_rows
        schema = self._file.schema_arrow
        self._headers = list(schema.names)
        for index, field in enumerate(schema):
            if unit := (field.metadata or {}).get(b"unit"):
                self._field_units[index] = unit.decode("utf-8", "replace")
        self._columns = self._find(self._headers)
        self._types = {}
        for name, column in self._columns.items():
            kind = schema.field(column.index).type
            self._types[name] = "float64"
            if name == "time" and (pa.types.is_timestamp(kind) or pa.types.is_duration(kind)):
                unit = next(each for each in TIME_UNITS if each.symbol == kind.unit)
                self._columns[name] = replace(column, unit=unit, stated=True)
                self._types[name] = "int64"
            elif name == "time" and pa.types.is_integer(kind):
                self._types[name] = "int64"
            elif not (pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind)):
                raise TableError(f'{name} must be numbers, got {kind} in column "{column.header}"')

    def _parquet_batches(self, chunk_rows: int) -> "Iterator[pa.RecordBatch]":
        import pyarrow as pa

        headers = {name: column.header for name, column in self._columns.items()}
        wanted = list(headers.values())
        for batch in self._file.iter_batches(batch_size=chunk_rows, columns=wanted, use_threads=False):
            arrays = [batch.column(header).cast(self._types[name]) for name, header in headers.items()]
            yield pa.RecordBatch.from_arrays(arrays, names=list(headers))


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

        batches = self._csv_batches(chunk_rows) if self.format == "csv" else self._parquet_batches(chunk_rows)
        row, last = 1, None
        while True:
            try:
                batch = next(batches, None)
            except pa.ArrowException as error:
                raise self._unreadable(error) from None
            except RowError as error:
                raise self.error(error.row, error.message) from None
            if batch is None:
                break
            for start in range(0, batch.num_rows, chunk_rows):
                try:
                    chunk = self._check(batch.slice(start, chunk_rows), row, last)
                except RowError as error:
                    raise self.error(error.row, error.message) from None
                row += len(chunk.time)
                last = chunk.time[-1]
                self._rows_read = row - 1
                yield chunk
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
            with contextlib.suppress(csv.Error):
                for row, (_, line) in enumerate(self._rows(), start=1):
                    if message := self._bad_record(self._cells(line)):
                        return self.error(row, message)
        return TableError(f"{self.path}: {' '.join(str(error).split())}")

    def _bad_record(self, cells: list[str]) -> str | None:
        if len(cells) != len(self._headers):
            cut = "; is the file cut off?" if len(cells) < len(self._headers) else ""
            return f"a row must have {len(self._headers)} cells as the header has, got {len(cells)}{cut}"
        for name, column in self._columns.items():
            cell = cells[column.index].strip()
            whole = self._types[name] == "int64"
            fits = re.fullmatch(r"-?\d+", cell) and abs(int(cell)) < 1 << 63 if whole else is_number(cell)
            if cell and not fits:
                kind = "a whole number of nanoseconds" if whole else "a number"
                return f'{name} must be {kind}, got "{cell}" in column "{column.header}"'
        return None
