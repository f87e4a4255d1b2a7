"""Tables of readings, a piece at a time: frames, dicts of columns and Parquet files."""

from __future__ import annotations

import os
import reprlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, fields, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import Odometry, Rover
from six_wheel.kinematics.errors import ArgumentTypeError, TableError, needed, one_line
from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.columnar import ColumnarFile, units_of
from six_wheel.logs.frames.table_headers import STAMPS, Meaning, Sensors, meaning_of, steering_keys
from six_wheel.logs.headers.clock_times import KNOWN, ClockTimes
from six_wheel.logs.headers.columns import TIME, means
from six_wheel.logs.headers.joint_columns import direction_columns
from six_wheel.logs.headers.renamed import Columns
from six_wheel.logs.headers.time_columns import in_seconds
from six_wheel.logs.plausibility.arrays import FEW, array_checks
from six_wheel.logs.plausibility.checks import ReadingChecks
from six_wheel.logs.plausibility.proposals import encoders
from six_wheel.robot_description.missing_files import no_file

LONGEST_RUN = 1e6  # [s] beyond which stamps count from the first
CHUNK_ROWS = 65_536  # a few megabytes, and so many that a call costs nothing


@dataclass(frozen=True)
class Piece:
    """Consecutive rows of a log, as `Odometry.run` takes them."""

    steering: Any
    wheels: Floats
    stamps: Floats
    sensors: dict[str, Any]


@dataclass(frozen=True)
class Source:
    """All pieces of a log, and how many rows they have together.

    `options` has the option `readings` of `Odometry` if the headers of a table say it; `checks` looks at the
    pieces before they are used.
    """

    rows: int
    pieces: Iterable[Piece]
    options: dict[str, str] = field(default_factory=dict)
    checks: ReadingChecks | None = None


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


def whole(source: Source) -> Piece:
    """A log in one piece. Raises `ValueError` if it has no rows."""
    pieces = list(source.pieces)
    if not pieces:
        raise ValueError("frame must have rows, got none")
    stamps, wheels = (np.concatenate([getattr(one, of) for one in pieces]) for of in ("stamps", "wheels"))
    steered = [piece.steering for piece in pieces if piece.steering is not None]
    return Piece(np.concatenate(steered) if steered else None, wheels, stamps, {})


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


def table(
    rover: Rover,
    source: Any,
    columns: Columns | None,
    sensors: Sensors,
    options: Mapping[str, Any],
    chunk_rows: int = CHUNK_ROWS,
    stamp_unit: str | None = None,
    plausibility: bool = True,
) -> Source:
    """A log in a frame, a dict of columns or a Parquet file."""
    of_file = isinstance(source, str | os.PathLike)
    source = source if of_file else _with_times(source)
    opened = _parquet(Path(source)) if of_file else None
    schema: Any = opened.schema if opened is not None else getattr(source, "schema", None)
    headers = opened.headers if opened is not None else list(map(str, _headers(source)))
    units = units_of(schema) if hasattr(schema, "field") else {}
    meaning = meaning_of(rover, headers, columns, sensors, options, units, stamp_unit)
    if meaning.readings == "ticks" and options.get("wheel_encoders") is None:
        raise ValueError(
            f"the wheels are in ticks, and how many a turn has must be said: give {encoders(counts=True)}"
        )
    said = {"readings": "angles" if meaning.readings == "ticks" else meaning.readings}
    known = {name: readings for name, readings in said.items() if readings is not None}
    options = {**options, **known}
    directions = direction_columns(headers, rover)
    checks = _checks(rover, options, meaning, directions) if plausibility else None
    wanted = sorted({header for header in meaning.found.values() if header})

    def batches() -> Iterator[dict[str, NDArray[Any]]]:
        if opened is None:
            whole = {header: _column(source, header) for header in wanted}
            stated = meaning.found["stamp"]
            for header, values in whole.items():
                if header != stated and values.dtype.kind not in "fiu":
                    raise ValueError(f'column "{header}" must be numbers, got {values[:1].tolist()}')
            count = len(whole[stated])
            for header, values in whole.items():
                if len(values) != count:
                    rule = f'have {count} rows, as column "{stated}"'
                    raise ValueError(f'column "{header}" must {rule}, got {len(values)}')
            for first in range(0, count, chunk_rows):
                yield {header: column[first : first + chunk_rows] for header, column in whole.items()}
            return
        with closing(opened):
            for batch in opened.batches(chunk_rows, wanted):
                yield {header: _numbers(batch.column(header)) for header in wanted}

    def pieces() -> Iterator[Piece]:
        clock, origin = ClockTimes(), None
        for read in batches():
            read[meaning.found["stamp"]] = _stamps(read[meaning.found["stamp"]], clock)
            if rest := meaning.found.get("nanoseconds"):
                nanoseconds = read[rest] * round(meaning.scales[rest])
                read[meaning.found["stamp"]] = _added(read[meaning.found["stamp"]], nanoseconds)
            origin = _origin(read[meaning.found["stamp"]], meaning) if origin is None else origin
            _turn(rover, read, meaning)
            yield _piece(rover, meaning, read, origin)

    rows = opened.rows if opened is not None else len(source[meaning.found["stamp"]])
    return Source(rows, _checked(pieces(), checks), known, checks)


def _checked(pieces: Iterator[Piece], checks: ReadingChecks | None) -> Iterator[Piece]:
    """The pieces, each looked at before it is used."""
    for piece in pieces:
        if checks is not None and len(piece.stamps) >= FEW:
            checks.take(piece.stamps, piece.wheels, None, piece.steering)
        yield piece
    if checks is not None:
        checks.finish()


def _checks(
    rover: Rover, options: Mapping[str, Any], meaning: Meaning, directions: Mapping[str, str]
) -> ReadingChecks:
    named = {name: meaning.found[name] for name in ("stamp", *rover.wheel_names)}
    named |= {f"{wheel} steering": meaning.found[key] for wheel, key in steering_keys(rover).items()}
    return array_checks(
        rover, options, named, meaning.clock_stated, meaning.units_stated, directions=directions
    )


def _parquet(path: Path) -> ColumnarFile:
    if not path.exists():
        raise FileNotFoundError(no_file(path))
    try:
        with needed("six-wheel[cli]", "Parquet files need"):
            return ColumnarFile(path, "parquet")
    except TableError:
        raise ValueError(f"{path}: must be a Parquet file; read_log makes a WheelLog of others") from None


def _with_times(source: Any) -> Any:
    """A frame that is computed, with the times of its rows as a column if they are its index."""
    source = source.collect() if hasattr(source, "collect") else source
    index: Any = getattr(source, "index", None)
    if not hasattr(source, "reset_index") or any(means(str(each), TIME) for each in _headers(source)):
        return source
    times = getattr(index.dtype, "kind", "") in ("m", "M") or index.name in STAMPS
    return source.rename_axis("stamp").reset_index() if times else source


def seconds_of(stamps: Any) -> Any:
    """Stamps as seconds since the first one, where they are dates or durations."""
    if isinstance(stamps, Sequence) and len(stamps) and isinstance(stamps[0], datetime):
        stamps = as_dates(stamps)
    dtype = getattr(stamps, "dtype", None)
    if getattr(dtype, "kind", "") not in ("m", "M") or np.ndim(stamps) == 0:
        return stamps
    times = np.asarray(stamps)
    return (times - times[:1]).astype("timedelta64[ns]").astype(np.float64) * 1e-9


def is_table(source: Any) -> bool:
    """True if the source has columns with names."""
    return any(hasattr(source, attribute) for attribute in ("column_names", "columns", "keys"))


def check_table(argument: str, source: Any) -> None:
    """Refuse what is neither a table of columns nor a path."""
    if not (is_table(source) or isinstance(source, str | os.PathLike)):
        such = 'such as a DataFrame or {"time": ..., "left": ...}'
        got = reprlib.repr(source)
        raise ArgumentTypeError(f"{argument} must be a path or a table of named columns, {such}, got {got}")


def _headers(source: Any) -> Iterable[Any]:
    """The names of the columns: polars and pandas, pyarrow, a mapping."""
    for attribute in ("column_names", "columns", "keys"):
        if (found := getattr(source, attribute, None)) is not None:
            headers: Iterable[Any] = found() if callable(found) else found
            return headers
    got = type(source).__name__
    rule = "steering must come with wheel_angles and stamps, or be a table or a path"
    such = 'columns with names, such as a DataFrame or {"time": ..., "left": ...}'
    raise ValueError(f"{rule}, got {got}; a table has {such}")


def _turn(rover: Rover, read: dict[str, NDArray[Any]], meaning: Meaning) -> None:
    """Give columns that go by the name of a reversed joint the sign of its wheel, and all their unit."""
    found = meaning.found
    for header, scale in meaning.scales.items():
        if scale != 1.0 and header != found["stamp"]:
            read[header] = read[header] * scale
    for header in meaning.reversed:
        read[header] = -read[header]
    for joint in rover.reversed_joints if not meaning.readings else ():
        name = rover.traction_joints.get(joint, joint)
        header = found.get(name, "")
        if header and header.partition(".")[0] == joint.partition(".")[0] and header.startswith(joint):
            read[header] = -read[header]


def _stamps(stamps: NDArray[Any], clock: ClockTimes) -> NDArray[Any]:
    """Stamps as dates where they are texts."""
    if stamps.dtype.kind not in "OUT":
        return stamps
    times, good = clock.read([None if text is None else str(text) for text in stamps.tolist()])
    if not good.any():
        raise ValueError(f"stamps must be numbers, dates or such as {KNOWN}, got {stamps[0]!r}")
    dates = times.astype("datetime64[ns]")
    dates[~good] = np.datetime64("NaT")
    return dates


def _added(seconds: NDArray[Any], nanoseconds: NDArray[Any]) -> NDArray[Any]:
    """Whole nanoseconds of stamps in two columns; rows without a number stay NaN."""
    if np.isfinite(seconds).all() and np.isfinite(nanoseconds).all():
        return seconds.astype(np.int64) * 1_000_000_000 + nanoseconds.astype(np.int64)
    added: NDArray[Any] = seconds * 1e9 + nanoseconds
    return added


def _column(source: Any, header: str) -> NDArray[Any]:
    """A column of a table by its name. Raises `ValueError` if it is no single column of numbers or times."""
    try:
        values = _numbers(source[header])
    except (TypeError, ValueError) as error:
        got = type(source).__name__
        hint = ": collect() it first" if hasattr(source, "collect") else ""
        reason = one_line(error)
        raise ValueError(f'column "{header}" must be numbers or times, got {got}{hint} ({reason})') from None
    if values.ndim != 1:
        raise ValueError(f'column "{header}" must be there once, got {values.shape[1]} of that name')
    return values


def _numbers(column: Any) -> NDArray[Any]:
    """A column as numbers, dates or texts, missing values NaN or NaT."""
    if isinstance(column, np.ma.MaskedArray):
        return np.ma.filled(column.astype(np.float64), np.nan)
    how = {"zero_copy_only": False} if type(column).__module__.startswith("pyarrow") else {}
    values = np.asarray(column.to_numpy(**how) if hasattr(column, "to_numpy") else column)
    if values.dtype.kind in "MUT":
        return values
    if values.dtype.kind == "m":
        return values.astype("timedelta64[ns]").astype(np.float64) * 1e-9
    if values.dtype.kind == "O" and len(values):
        if isinstance(values[0], str):
            return values
        if isinstance(values[0], datetime):
            return as_dates(values)
    whole = values.dtype.kind in "iu" and len(values) and abs(int(values[0])) > 1 << 52
    return values if whole else np.asarray(values, dtype=np.float64)


def as_dates(stamps: Iterable[datetime]) -> NDArray[Any]:
    """Dates of Python or pandas, those with a zone in UTC."""
    naive = (one if one.tzinfo is None else one.astimezone(UTC).replace(tzinfo=None) for one in stamps)
    return np.array(list(naive), dtype="datetime64[ns]")


def _origin(stamps: NDArray[Any], meaning: Meaning) -> Any:
    """Origin of the stamps: the first date that is not NaT, 0 for stamps that count from a start."""
    if stamps.dtype.kind != "M":
        scale = meaning.scales.get(meaning.found["stamp"], 1.0)
        since_1970 = scale != 1.0 and len(stamps) and abs(float(stamps[0])) * scale > LONGEST_RUN
        return stamps[0] if since_1970 else stamps.dtype.type(0)
    there = stamps[~np.isnat(stamps)]
    return there[0] if len(there) else np.datetime64(0, "s")


def _piece(rover: Rover, meaning: Meaning, read: Mapping[str, NDArray[Any]], origin: Any) -> Piece:
    found = meaning.found
    stamps = read[found["stamp"]]
    scale = meaning.scales.get(found["stamp"], 1.0)
    if stamps.dtype.kind == "M":
        since = (stamps - origin).astype("timedelta64[ns]")
        seconds = since.astype(np.float64) * 1e-9
        seconds[np.isnat(stamps)] = np.nan
    elif scale != 1.0:
        seconds = in_seconds((stamps - origin).astype(np.float64), scale)
    else:
        seconds = np.asarray(stamps, dtype=np.float64)
    nothing = np.full(len(stamps), np.nan)
    wheels = [read[found[name]] if found[name] else nothing for name in rover.wheel_names]
    steered = [read[found[key]] for key in steering_keys(rover).values()]
    return Piece(
        np.stack(steered, axis=-1) if steered else None,
        np.stack(wheels, axis=-1),
        seconds,
        {name: read[found[name]] for name in ("yaw", "yaw_rate") if name in found},
    )
