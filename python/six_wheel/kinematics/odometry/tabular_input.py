"""Tables of readings, a piece at a time: frames, dicts of columns and Parquet files."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import Odometry, Rover
from six_wheel.kinematics.odometry.tracks import Track

CHUNK_ROWS = 65_536  # a few megabytes, and so many that a call costs nothing

STAMPS = ("stamp", "stamps", "time", "timestamp", "t")
ENDINGS = {"angles": ("", ".position"), "speeds": ("", ".velocity"), "increments": ("",)}

Floats: TypeAlias = NDArray[np.float64]
Sensors: TypeAlias = Mapping[str, Any]


@dataclass(frozen=True)
class Piece:
    """Consecutive rows of a log, as `Odometry.run` takes them."""

    steering: Any
    wheels: Floats
    stamps: Floats
    sensors: dict[str, Any]


@dataclass(frozen=True)
class Source:
    """All pieces of a log, and how many rows they have together."""

    rows: int
    pieces: Iterable[Piece]


def follow(
    odometry: Odometry,
    source: Source,
    keywords: Mapping[str, Any],
    progress: Callable[[int, int], object] | None,
) -> Iterator[Track]:
    """The tracks of the pieces, one after the other."""
    done = 0
    for piece in source.pieces:
        try:
            yield odometry.run(piece.steering, piece.wheels, piece.stamps, **piece.sensors, **keywords)
        except ValueError as error:
            # The row counts from the start of the piece.
            raise ValueError(f"{error} (after the first {done} rows)" if done else str(error)) from None
        done += len(piece.stamps)
        if progress is not None:
            progress(done, source.rows)


def concatenate(rover: Rover, tracks: Sequence[Track]) -> Track:
    """Consecutive tracks as one."""
    if len(tracks) == 1:
        return tracks[0]
    if not tracks:
        none = np.zeros((0, len(rover.wheels)))
        track = Odometry(rover).run(np.zeros((0, len(rover.steered_wheel_names))), none, np.zeros(0))
        return replace(track)
    joined: dict[str, Any] = {}
    for column in fields(Track):
        parts = [getattr(track, column.name) for track in tracks]
        joined[column.name] = np.concatenate(parts) if isinstance(parts[0], np.ndarray) else parts[0]
    return Track(**joined)


def arrays(steering: ArrayLike | None, wheels: ArrayLike, stamps: ArrayLike, sensors: Sensors) -> Source:
    """A log in arrays, in pieces."""
    angles = None if steering is None else np.asarray(steering)
    columns, times = np.asarray(wheels), np.asarray(stamps)
    given = {name: np.asarray(column) for name, column in sensors.items() if column is not None}
    for name, column in {"steering": angles, "stamps": times, **given}.items():
        if column is not None and (column.ndim == 0 or len(column) != len(columns)):
            rule = f"have {len(columns)} rows, as wheel_angles"
            raise ValueError(f"{name} must {rule}, got shape {column.shape}")

    def pieces() -> Iterator[Piece]:
        for first in range(0, len(times), CHUNK_ROWS):
            rows = slice(first, first + CHUNK_ROWS)
            yield Piece(
                None if angles is None else angles[rows],
                columns[rows],
                times[rows],
                {name: column[rows] for name, column in given.items()},
            )

    return Source(len(times), pieces())


def names(rover: Rover, readings: str = "angles") -> dict[str, tuple[str, ...]]:
    """Accepted names of the columns: by joint for steering, by wheel, and the stamp."""
    steering = {wheel: joint for joint, wheel in rover.steering_joints.items()}
    traction = {wheel: joint for joint, wheel in rover.traction_joints.items()}
    known: dict[str, tuple[str, ...]] = {"stamp": STAMPS}
    for wheel in rover.steered_wheel_names:
        joint = steering.get(wheel, f"{wheel}_steering_joint")
        known[joint] = tuple(joint + ending for ending in ENDINGS["angles"])
    for wheel in rover.wheel_names:
        stems = (traction.get(wheel, wheel), wheel)
        known[wheel] = tuple(stem + ending for stem in stems for ending in ENDINGS[readings])
    return known


def table(
    rover: Rover,
    source: Any,
    columns: Mapping[str, str] | None,
    sensors: Sensors,
    options: Mapping[str, Any],
    chunk_rows: int = CHUNK_ROWS,
) -> Source:
    """A log in a frame, a dict of columns or a Parquet file."""
    if isinstance(source, str | os.PathLike):
        return _parquet(rover, Path(source), columns, sensors, options, chunk_rows)
    headers = list(map(str, _headers(source)))
    found = _find(rover, headers, columns, sensors, options)
    stamps = source[found["stamp"]]
    rows = len(stamps)

    def pieces() -> Iterator[Piece]:
        read = {header: _numbers(source[header]) for header in {*found.values()} if header}
        _turn(rover, read, found)
        origin = _origin(read[found["stamp"]])
        for first in range(0, rows, chunk_rows):
            part = {header: column[first : first + chunk_rows] for header, column in read.items()}
            yield _piece(rover, found, part, origin)

    return Source(rows, pieces())


def _parquet(
    rover: Rover,
    path: Path,
    columns: Mapping[str, str] | None,
    sensors: Sensors,
    options: Mapping[str, Any],
    chunk_rows: int,
) -> Source:
    try:
        from pyarrow import ArrowInvalid, parquet
    except ModuleNotFoundError as error:
        message = f'Parquet files need {error.name}: pip install "six-wheel[cli]"'
        raise ModuleNotFoundError(message, name=error.name) from None
    try:
        opened = parquet.ParquetFile(path)
    except FileNotFoundError:
        raise FileNotFoundError(f"{path}: no such file") from None
    except ArrowInvalid:
        rule = "be a Parquet file; six_wheel.logs.read_log makes a WheelLog of tables, bags and others"
        raise ValueError(f"a path must {rule}, got {str(path)!r}") from None
    found = _find(rover, opened.schema_arrow.names, columns, sensors, options)

    def pieces() -> Iterator[Piece]:
        wanted = sorted({header for header in found.values() if header})
        origin = None
        with opened:
            for batch in opened.iter_batches(batch_size=chunk_rows, columns=wanted, use_threads=False):
                read = {header: _numbers(batch.column(header)) for header in wanted}
                _turn(rover, read, found)
                origin = _origin(read[found["stamp"]]) if origin is None else origin
                yield _piece(rover, found, read, origin)

    return Source(opened.metadata.num_rows, pieces())


def is_table(source: Any) -> bool:
    """True if the source has columns with names."""
    return any(hasattr(source, attribute) for attribute in ("column_names", "columns", "keys"))


def _headers(source: Any) -> Iterable[Any]:
    """The names of the columns: polars and pandas, pyarrow, a mapping."""
    for attribute in ("column_names", "columns", "keys"):
        found = getattr(source, attribute, None)
        if found is not None and not (attribute == "columns" and hasattr(source, "column_names")):
            headers: Iterable[Any] = found() if callable(found) else found
            return headers
    got = type(source).__name__
    raise ValueError(f"steering must come with wheel_angles and stamps, or be a table or a path, got {got}")


def _find(
    rover: Rover,
    headers: Sequence[str],
    columns: Mapping[str, str] | None,
    sensors: Sensors,
    options: Mapping[str, Any],
) -> dict[str, str]:
    """Column of each quantity; empty for a passive wheel without a column."""
    known = names(rover, options.get("readings", "angles"))
    given = dict(columns or {})
    joints = {**rover.traction_joints, **{joint: joint for joint in rover.steering_joints}}
    stated = {joints.get(name, name): header for name, header in given.items()}
    for name in stated:
        if name not in known:
            raise ValueError(f"columns must name some of {', '.join(known)}, got {name!r}")
    passive = {wheel.name for wheel in rover.wheels if not wheel.driven}
    found = {}
    for name, candidates in known.items():
        wanted = (stated[name],) if name in stated else candidates
        present = [header for header in wanted if header in headers]
        if present:
            found[name] = present[0]
        elif name in passive and name not in stated:
            found[name] = ""
        else:
            raise ValueError(f"table must have a column {' or '.join(wanted)}, got {', '.join(headers)}")
    for name, header in sensors.items():
        if header is not None:
            if header not in headers:
                raise ValueError(f"{name} must name a column, got {header!r} of {', '.join(headers)}")
            found[name] = header
    return found


def _turn(rover: Rover, read: dict[str, NDArray[Any]], found: Mapping[str, str]) -> None:
    """Give columns that go by the name of a reversed joint the sign of its wheel."""
    for joint in rover.reversed_joints:
        name = rover.traction_joints.get(joint, joint)
        header = found.get(name, "")
        if header and header.partition(".")[0] == joint.partition(".")[0] and header.startswith(joint):
            read[header] = -read[header]


def _numbers(column: Any) -> NDArray[Any]:
    """A column as numbers or dates, missing values NaN or NaT."""
    if hasattr(column, "to_numpy"):
        if type(column).__module__.startswith("pyarrow"):
            chunked = hasattr(column, "chunks")
            values = column.to_numpy() if chunked else column.to_numpy(zero_copy_only=False)
        else:
            values = column.to_numpy()
    else:
        values = np.asarray(column)
    return np.asarray(values) if values.dtype.kind == "M" else np.asarray(values, dtype=np.float64)


def _origin(stamps: NDArray[Any]) -> Any:
    """Origin of the stamps: the first date that is not NaT, or 0.0 for stamps in seconds."""
    if stamps.dtype.kind != "M":
        return 0.0
    there = stamps[~np.isnat(stamps)]
    return there[0] if len(there) else np.datetime64(0, "s")


def _piece(rover: Rover, found: Mapping[str, str], read: Mapping[str, NDArray[Any]], origin: Any) -> Piece:
    stamps = read[found["stamp"]]
    if stamps.dtype.kind == "M":
        since = (stamps - origin).astype("timedelta64[ns]")
        seconds = since.astype(np.float64) * 1e-9
        seconds[np.isnat(stamps)] = np.nan
    else:
        seconds = stamps
    nothing = np.full(len(stamps), np.nan)
    wheels = [read[found[name]] if found[name] else nothing for name in rover.wheel_names]
    steered = [read[header] for name, header in found.items() if name in _steering(rover)]
    return Piece(
        np.stack(steered, axis=-1) if steered else None,
        np.stack(wheels, axis=-1),
        seconds,
        {name: read[found[name]] for name in ("yaw", "yaw_rate") if name in found},
    )


def _steering(rover: Rover) -> set[str]:
    """The keys of `names` that stand for steering joints."""
    return set(names(rover)) - {"stamp", *rover.wheel_names}
