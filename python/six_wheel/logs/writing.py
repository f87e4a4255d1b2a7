"""Files that are written whole or not at all, and tables written chunk by chunk."""

import contextlib
import csv
import io
import os
import secrets
from collections.abc import Iterator, Mapping, Sequence
from glob import escape
from pathlib import Path
from typing import Any, Self

from six_wheel.kinematics.odometry.headers.columns import TableError
from six_wheel.logs.tables import table_format

__all__ = ["TableWriter", "remove_leftovers", "replacing"]


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


def remove_leftovers(path: Path) -> None:
    """Delete temporary files that killed writers of `path` left beside it. No writer may be at work."""
    for rest in path.parent.glob(f".{escape(path.stem)}.{'[0-9a-f]' * 8}{escape(path.suffix)}"):
        rest.unlink(missing_ok=True)


class TableWriter:
    """Writes a table chunk by chunk, as CSV or Parquet by the ending of `path`.

    Parameters
    ----------
    path : Path
        A .csv or .parquet file.
    units : mapping
        Column name to unit, in order; Parquet keeps the units in the metadata of the fields.
    metadata : mapping, optional
        Column name to more metadata of its field.
    """

    def __init__(
        self, path: Path, units: Mapping[str, str], metadata: Mapping[str, Mapping[str, str]] | None = None
    ) -> None:
        self._metadata = metadata or {}
        self._units, self._format = dict(units), table_format(path)
        self._handle = path.open("wb")
        self._writer: Any = None

    def write(self, columns: Sequence[Any]) -> None:
        """Append rows: one array (n,) per column, of the same types every time."""
        import pyarrow as pa

        arrays = [column if isinstance(column, pa.Array) else pa.array(column) for column in columns]
        fields = [
            pa.field(
                name, array.type, nullable=False, metadata={"unit": unit, **self._metadata.get(name, {})}
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
