"""Files that Arrow reads: Parquet, Feather or Arrow IPC, and JSON with one object in a line, in batches of
columns."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from six_wheel.kinematics.errors import TableError
from six_wheel.logs.headers.columns import TIME_UNITS, Unit

if TYPE_CHECKING:
    import pyarrow as pa


class ColumnarFile:
    """A Parquet, Arrow or JSON file, open for reading. Raises `TableError` if it cannot be read."""

    def __init__(self, path: Path, format: str) -> None:
        import pyarrow as pa
        import pyarrow.ipc
        import pyarrow.json
        import pyarrow.parquet

        self._path, self._kind = path, {"parquet": "Parquet", "json": "JSON"}.get(format, "Arrow")
        self._handle: Any = None
        self._file: Any
        try:
            arrow = format not in ("parquet", "json")
            self._handle = pa.memory_map(str(path)) if arrow else pa.OSFile(str(path))
            if format == "parquet":
                # Pre-buffering would hold a whole row group, which may be the whole file.
                self._file = pa.parquet.ParquetFile(self._handle, pre_buffer=False, buffer_size=1 << 20)
                self.schema: pa.Schema = self._file.schema_arrow
                self.rows: int = self._file.metadata.num_rows
            elif format == "json":
                table = pa.json.read_json(self._handle)
                while any(pa.types.is_struct(field.type) for field in table.schema):
                    table = table.flatten()  # objects within objects become columns such as stamp.sec
                self._file = table
                self.schema, self.rows = self._file.schema, self._file.num_rows
            else:
                self._file = pa.ipc.open_file(self._handle)
                self.schema = self._file.schema
                self.rows = sum(
                    self._file.get_batch(k).num_rows for k in range(self._file.num_record_batches)
                )
            self.headers: list[str] = list(self.schema.names)
        except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
            self.close()
            raise TableError(self._unreadable(error)) from None
        self._format = format

    def batches(self, chunk_rows: int, headers: Sequence[str]) -> "Iterator[pa.RecordBatch]":
        """The rows in order, of some columns. Raises `TableError` if a part of the file is damaged."""
        import pyarrow as pa

        try:
            yield from self._batches(chunk_rows, headers)
        except MemoryError:
            raise
        except (pa.ArrowException, OSError) as error:
            raise TableError(f"{self._path}: {self._unreadable(error)}") from None

    def _unreadable(self, error: Exception) -> str:
        told = "a name of a column is no UTF-8" if isinstance(error, UnicodeDecodeError) else str(error)
        return f"not a readable {self._kind} file: {' '.join(told.split())}"

    def _batches(self, chunk_rows: int, headers: Sequence[str]) -> "Iterator[pa.RecordBatch]":
        if self._format == "parquet":
            yield from self._file.iter_batches(batch_size=chunk_rows, columns=[*headers], use_threads=False)
            return
        if self._format == "json":
            yield from self._file.select([*dict.fromkeys(headers)]).to_batches(max_chunksize=chunk_rows)
            return
        for number in range(self._file.num_record_batches):
            whole = self._file.get_batch(number).select([*dict.fromkeys(headers)])
            for start in range(0, whole.num_rows, chunk_rows):
                yield whole.slice(start, chunk_rows)

    def close(self) -> None:
        """Close the file."""
        if self._handle is not None:
            self._handle.close()


def units_of(schema: "pa.Schema") -> dict[int, str]:
    """Units of columns that a schema states, in the metadata of their fields."""
    units = {}
    for index, field in enumerate(schema):
        stated = {key.lower(): value for key, value in (field.metadata or {}).items()}
        if unit := stated.get(b"unit") or stated.get(b"units"):
            units[index] = unit.decode("utf-8", "replace")
    return units


def time_unit_of(kind: "pa.DataType") -> Unit | None:
    """Unit of a column of dates, times of day or durations; None for any other."""
    import pyarrow as pa

    if pa.types.is_timestamp(kind) or pa.types.is_duration(kind) or pa.types.is_time(kind):
        return next(each for each in TIME_UNITS if each.symbol == kind.unit)
    return None
