"""Columns of results over time: as arrays, pandas and Arrow tables, and CSV files."""

from __future__ import annotations  # NumPy is not loaded for its names

import os
import reprlib
from collections.abc import Mapping
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from six_wheel._core import Rover
from six_wheel.kinematics.errors import ArgumentTypeError, as_path, needed
from six_wheel.kinematics.keywords import unknown_keyword
from six_wheel.kinematics.objects.notebooks import Shown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

Columns: TypeAlias = "dict[str, tuple[str, NDArray[Any]]]"
"""Unit and values, shape (n,), by name."""
TWIST = {"vx": "m/s", "vy": "m/s", "omega": "rad/s"}
BLOCK, GROUP = 4096, 1 << 16  # rows of text and of Parquet that are written between two looks at signals
UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


Table = TypeVar("Table", bound="Tabular")


class Tabular(Shown):
    """A result with one row per sample, which is a table as well.

    Methods take the keywords of its columns: ``rover=`` of a `WheelLog`, for columns by the names of joints.
    """

    __slots__ = ()

    if TYPE_CHECKING:

        def _columns(self, *args: Any, **names: Any) -> Columns: ...

    def to_arrays(self, **names: Any) -> dict[str, NDArray[Any]]:
        """The columns by name, arrays of shape (n,), in the units of `to_arrow`."""
        return {name: values for name, (_, values) in _columns_of(self, "to_arrays", names).items()}

    def to_pandas(self, **names: Any) -> Any:
        """The columns as a `pandas.DataFrame`.

        Raises
        ------
        ModuleNotFoundError
            If pandas is not installed; the message has the install line.
        """
        pandas = _needed("pandas", "pandas")
        columns = _columns_of(self, "to_pandas", names)
        return pandas.DataFrame({name: values for name, (_, values) in columns.items()})

    def to_arrow(self, **names: Any) -> Any:
        """The columns as a `pyarrow.Table`, each with its ``unit`` in the metadata of its field.

        Raises
        ------
        ModuleNotFoundError
            If pyarrow is not installed; the message has the install line.
        """
        arrow = _needed("pyarrow", "six-wheel[cli]")
        columns = _columns_of(self, "to_arrow", names)
        units = {name: {"unit": unit} if unit else None for name, (unit, _) in columns.items()}
        arrays = {name: arrow.array(values) for name, (_, values) in columns.items()}
        fields = [arrow.field(name, array.type, metadata=units[name]) for name, array in arrays.items()]
        return arrow.table(list(arrays.values()), schema=arrow.schema(fields))

    def to_csv(self, path: str | os.PathLike[str], **names: Any) -> None:
        """Write the columns to the CSV file `path` with all their digits, whole or not at all.

        Raises
        ------
        ValueError
            If the file cannot be written.
        """
        _write_csv(path, {name: values for name, (_, values) in _columns_of(self, "to_csv", names).items()})

    def save(self, path: str | os.PathLike[str], **names: Any) -> None:
        """Write the columns to a file with their units: CSV in its header, Parquet in its metadata.

        It is written whole or not at all.

        Parameters
        ----------
        path : path
            Ends in .csv or .parquet. A file that is there is replaced.
        **names
            As of `to_csv`: of a `WheelLog` ``rover=``, so that `read_log` finds joints by their names.

        Raises
        ------
        ValueError
            If the ending is none of these, or the file cannot be written.
        ModuleNotFoundError
            If pyarrow is needed and not installed; the message has the install line.
        """
        target = as_path("path", path)
        ending = target.suffix.lower()
        if ending == ".csv":
            columns = _columns_of(self, "save", names)
            stated = {
                f"{name} [{unit}]" if unit else name: values for name, (unit, values) in columns.items()
            }
            _write_csv(path, stated)
        elif ending == ".parquet":
            table = self.to_arrow(**names)
            from six_wheel.kinematics.objects.whole_files import replacing

            parquet = _needed("pyarrow.parquet", "six-wheel[cli]")
            with (
                replacing(target) as temporary,
                parquet.ParquetWriter(temporary, table.schema) as writer,
            ):
                for batch in table.to_batches(max_chunksize=GROUP):
                    writer.write_batch(batch)
        else:
            raise ValueError(f"path must end in .csv or .parquet, got {str(path)!r}")


def _write_csv(path: str | os.PathLike[str], columns: Mapping[str, NDArray[Any]]) -> None:
    import csv

    from six_wheel.kinematics.objects.whole_files import replacing

    with (
        replacing(as_path("path", path)) as temporary,
        temporary.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        count = max((len(values) for values in columns.values()), default=0)
        for first in range(0, count, BLOCK):
            block = (values[first : first + BLOCK].tolist() for values in columns.values())
            writer.writerows(zip(*block, strict=True))


def _columns_of(table: Tabular, method: str, names: Mapping[str, Any]) -> Columns:
    """The columns of a table by the keywords of one of its methods."""
    if names:
        import inspect

        known = list(inspect.signature(table._columns).parameters)
        for name in names:
            if name not in known:
                raise TypeError(unknown_keyword(f"{type(table).__name__}.{method}", name, known))
    return table._columns(**names)


def pose_columns(
    stamps: NDArray[Any], poses: NDArray[Any], names: Mapping[str, str] = {"x": "m", "y": "m", "yaw": "rad"}
) -> Columns:
    """Time and poses."""
    times: Columns = {"time": ("s", stamps)}
    return times | {name: (unit, poses[:, k]) for k, (name, unit) in enumerate(names.items())}


def twist_columns(twists: NDArray[Any]) -> Columns:
    """Twists in the plane."""
    return {name: (unit, twists[:, k]) for k, (name, unit) in enumerate(TWIST.items())}


def covariance_columns(covariances: NDArray[Any]) -> Columns:
    """The upper half of covariances of x, y and yaw."""
    names = ("x", "y", "yaw")
    columns: Columns = {}
    for i, k in UPPER:
        unit = {0: "m^2", 1: "m rad", 2: "rad^2"}[(i == 2) + (k == 2)]
        columns[f"covariance_{names[i]}_{names[k]}"] = (unit, covariances[:, i, k])
    return columns


def joint_columns(rover: Rover | None, kind: str, readings: NDArray[Any], unit: str) -> Columns:
    """Readings of wheels or steering joints by the names of the joints, or by number without a rover."""
    columns = range(readings.shape[1])
    if rover is None:
        return {f"{kind}_{k}": (unit, readings[:, k]) for k in columns}
    if not isinstance(rover, Rover):
        hint = f": give sw.load({rover!r})" if isinstance(rover, str) else ""
        raise ArgumentTypeError(f"rover must be a Rover, got {reprlib.repr(rover)}{hint}")
    wheels = rover.wheel_names if kind == "wheel" else rover.steered_wheel_names
    joints = rover.traction_joints if kind == "wheel" else rover.steering_joints
    by_wheel = {wheel: joint for joint, wheel in joints.items()}
    return {by_wheel.get(wheels[k], wheels[k]): (unit, readings[:, k]) for k in columns}


def covariances_of(frame: Any, count: int) -> NDArray[np.float64] | None:
    """Covariances of x, y and yaw, shape (count, 3, 3), from columns of their upper half; None without."""
    import numpy as np

    if "covariance_x_x" not in headers_of(frame):
        return None
    names = ("x", "y", "yaw")
    upper = rows_of(frame, tuple(f"covariance_{names[i]}_{names[k]}" for i, k in UPPER))
    covariances = np.zeros((count, 3, 3))
    for (i, k), column in zip(UPPER, upper.T, strict=True):
        covariances[:, i, k] = covariances[:, k, i] = column
    return covariances


def headers_of(frame: Any) -> list[str]:
    """Names of the columns of a frame, or of a mapping of columns."""
    named = getattr(frame, "column_names", None)  # of Arrow, whose `columns` are their values
    return list(map(str, getattr(frame, "columns", frame) if named is None else named))


def rows_of(frame: Any, names: tuple[str, ...]) -> NDArray[np.float64]:
    """Columns of a frame side by side; ValueError names those that are missing."""
    import numpy as np

    headers = headers_of(frame)
    if missing := [name for name in names if name not in headers]:
        raise ValueError(f"frame must have the columns {', '.join(missing)}, got {', '.join(headers)}")
    return np.stack([np.asarray(frame[name], dtype=float) for name in names], axis=-1)


def times_of(frame: Any) -> NDArray[np.float64]:
    """The times of a frame [s], from a column ``time`` or ``stamp``."""
    headers = headers_of(frame)
    name = next((name for name in ("time", "stamp", "stamps", "t") if name in headers), None)
    if name is None:
        raise ValueError(f"frame must have a column time or stamp [s], got {', '.join(headers)}")
    times: NDArray[np.float64] = rows_of(frame, (name,))[:, 0]
    return times


def _needed(module: str, package: str) -> Any:
    """A module that is imported when a method needs it."""
    from importlib import import_module

    with needed(package, "this table needs"):
        return import_module(module)


def rows_taken(table: Table, rows: int | slice | ArrayLike) -> Table:
    """Some rows as such a table: a slice, a row (negative from the end), or as NumPy selects them."""
    import numpy as np

    known: Any = table
    chosen: Any = rows
    if isinstance(rows, int | np.integer):
        count = len(known)
        if not -count <= rows < count:
            raise IndexError(f"row must be from {-count} to {count - 1}, got {rows}")
        chosen = [int(rows)]
    columns = {each.name: getattr(table, each.name) for each in fields(known)}
    taken = {name: value[chosen] for name, value in columns.items() if isinstance(value, np.ndarray)}
    made: Table = replace(known, **taken)
    return made
