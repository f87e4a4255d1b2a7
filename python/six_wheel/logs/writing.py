"""Tables written chunk by chunk, into files that are written whole or not at all."""

import contextlib
import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from six_wheel.kinematics.objects.whole_files import replacing
from six_wheel.logs.tables import table_format


class TableWriter:
    """Writes a table chunk by chunk, as CSV or Parquet by the ending of `path`, whole or not at all.

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
        self._writer: Any = None
        with contextlib.ExitStack() as stack:
            temporary = stack.enter_context(replacing(path))
            self._handle = stack.enter_context(temporary.open("wb"))
            stack.callback(self._end)
            self._open_files = stack.pop_all()

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

    def _end(self) -> None:
        if self._writer is not None:
            self._writer.close()

    def __exit__(self, *error: Any) -> None:
        self._open_files.__exit__(*error)
