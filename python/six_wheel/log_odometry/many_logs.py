"""Dead reckoning of many logs: on this machine's cores or a cluster, a track on disk for each.

Every log goes through `reckon` wherever it runs, so its track is that of one by one, to the bit. What is done
is kept in a journal beside the tracks: a run that was stopped goes on where it was, and logs that came since,
or changed, are all that is left to do. A log that fails is reported, and the rest go on.
"""

import hashlib
import json
import os
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover, __version__
from six_wheel.kinematics.errors import SuspiciousReadingsWarning, TableError
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.objects.whole_files import remove_leftovers, together
from six_wheel.log_odometry.copies import COMMON, rest_without
from six_wheel.log_odometry.results import ReckonSettings
from six_wheel.log_odometry.run_log import reckon
from six_wheel.logs.detect_reader import logs_in, read_log
from six_wheel.logs.log_options import LogOptions
from six_wheel.logs.recordings import WheelLog
from six_wheel.logs.tables import table_format
from six_wheel.parallel import Failure, Journal, spread
from six_wheel.parallel.journal import file_states

JOURNAL = ".done"  # folder beside the tracks


@dataclass(frozen=True)
class FleetLog:
    """One log of many.

    Attributes
    ----------
    path, track : Path
        The log, and where its track is.
    summary : dict or None
        Rows, duration [s], distance [m], last pose and its standard deviations, `ate` [m] where the truth is
        known, warnings; None where it failed.
    failure : Failure or None
    resumed : bool
        True if it was done before.
    """

    path: Path
    track: Path
    summary: dict[str, Any] | None
    failure: Failure | None = None
    resumed: bool = False


@dataclass(frozen=True)
class LogTask:
    """Input of a worker for one log."""

    rover: Rover
    path: Path
    track: Path
    how: dict[str, Any]  # other arguments of `reckon`


@checked()
def reckon_all(
    rover: Rover,
    paths: Sequence[Path],
    output: Path,
    *,
    ending: str = ".csv",
    truth: Path | None = None,
    log_options: LogOptions | None = None,
    settings: ReckonSettings | None = None,
    length: float = 0.5,
    cluster: Any = None,
    workers: int | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Iterator[FleetLog]:
    """Dead-reckon many logs; those that were done before come first, the others as they get done.

    Parameters
    ----------
    rover : Rover
        Of all logs.
    paths : sequence of Path
        Logs, or folders of them. One that is given again, by its name, a link, a copy or a part, counts once;
        one that shares some of its readings with another one fails.
    output : Path
        Folder for the tracks, made if it is not there; they lie in it as the logs lie in theirs.
    ending : {'.csv', '.parquet'}
        Of the tracks.
    truth : Path, optional
        That holds the times of all logs.
    log_options, settings, length
        As in `reckon`.
    cluster : distributed.Client or str, optional
        A Dask cluster or its address, whose workers see the same files.
    workers : int, optional
        Processes of this machine, default one per core.
    progress : callable, optional
        Called with the logs that are done and all logs.

    Raises
    ------
    TableError
        If there is no log, or the output cannot be a folder.
    ClusterError
        If the cluster does not answer.
    """
    logs = _without_copies(logs_in(paths))
    table_format(Path(f"track{ending}"))
    if output.exists() and not output.is_dir():
        raise TableError(f"{output}: the output of several logs must be a folder")
    tracks = _tracks(logs, output, ending)
    output.mkdir(parents=True, exist_ok=True)
    journal = Journal(output / JOURNAL, {"kept": "summaries of tracks and sketches of logs"})
    options, reference = log_options or LogOptions(), truth and truth.resolve()
    how: dict[str, Any] = {"truth": reference, "log_options": options, "length": length}
    how["settings"] = settings or ReckonSettings()
    jobs = [
        LogTask(rover, path.resolve(), track.resolve(), how) for path, track in zip(logs, tracks, strict=True)
    ]
    keys = [_key(job) for job in jobs]
    done = 0
    once = _Counted(rover, options)

    def judged(one: FleetLog, sketch: NDArray[np.uint64] | None) -> list[FleetLog]:
        """The log, or none if another one has its readings; a failure if another one has some of them."""
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, len(jobs))
        shared = None if sketch is None else once.shared(one.path, sketch)
        if shared is None:
            return [one]
        one.track.unlink(missing_ok=True)
        other, rows = shared
        if not rows:
            _say_copy(one.path, other)
            return []
        what = f"it has {rows}the readings of {other}, which would count twice; give one of them, or cut it"
        return [replace(one, summary=None, failure=Failure("TableError", what))]

    left = []
    for number, key in enumerate(keys):
        if key in journal and tracks[number].is_file():
            value = journal.read(key)
            known = FleetLog(logs[number], tracks[number], value["summary"], resumed=True)
            yield from judged(known, value["sketch"])
        else:
            left.append(number)
    # Long logs first, so that a part finds the whole.
    left.sort(key=lambda number: -sum(file.stat().st_size for _, file in _files(logs[number])))
    for outcome in spread(reckon_one, [jobs[number] for number in left], cluster=cluster, workers=workers):
        number = left[outcome.index]
        failure = outcome.failure
        if failure is None and not tracks[number].is_file():
            failure = Failure("TableError", "the worker wrote its track where this machine does not see it")
        if failure is not None:
            yield from judged(FleetLog(logs[number], tracks[number], None, failure), None)
            continue
        remove_leftovers(tracks[number])  # of workers that died
        journal.write(keys[number], outcome.value)
        yield from judged(
            FleetLog(logs[number], tracks[number], outcome.value["summary"]), outcome.value["sketch"]
        )


class _Counted:
    """Logs that count, with the hashes of their readings."""

    def __init__(self, rover: Rover, options: LogOptions) -> None:
        self._rover, self._options = rover, options
        self._holders: dict[int, list[Path]] = {}

    def shared(self, path: Path, sketch: NDArray[np.uint64]) -> tuple[Path, str] | None:
        """A log that has readings of this one, and which in words, empty for all; None if this one counts."""
        hashes = sketch.tolist()
        common = Counter(other for each in hashes for other in self._holders.get(each, ()))
        likely = [other for other, number in common.most_common() if number >= COMMON]
        mine = self._read(path) if likely else None
        for other in likely:
            rest = None if mine is None else rest_without(mine, self._read(other))
            if rest is not None:
                return other, rest[1]
        for each in hashes:
            self._holders.setdefault(each, []).append(path)
        return None

    def _read(self, path: Path) -> WheelLog:
        return read_log(path, self._rover, self._options)[0].in_radians(self._rover)


def reckon_one(job: LogTask) -> dict[str, Any]:
    """Summary and sketch of a log, where the worker is; its track is in place before this returns."""
    job.track.parent.mkdir(parents=True, exist_ok=True)
    with together():
        result = reckon(job.rover, job.path, job.track, **job.how)
    judged = result.placed if result.evaluation is None else result.evaluation.first
    summary = {
        "rows": result.rows,
        "duration": result.duration,
        "distance": result.distance,
        "pose": result.pose,
        "deviations": result.deviations,
        "ate": None if judged is None else judged.rmse,
        "warnings": list(result.warnings),
    }
    return {"summary": summary, "sketch": result._sketch.hashes}


def _without_copies(paths: Sequence[Path]) -> list[Path]:
    """Logs once each: one that is given again, by its name, a link or a copy, is left out with a warning."""
    kept: list[Path] = []
    places: dict[Path, Path] = {}
    contents: dict[tuple[tuple[str, int], ...], list[Path]] = {}
    for path in paths:
        same = places.get(path.resolve())
        sizes = tuple((name, file.stat().st_size) for name, file in _files(path))
        alike = contents.setdefault(sizes, []) if sizes else []
        same = same or next((other for other in alike if _digest(other) == _digest(path)), None)
        if same is not None:
            _say_copy(path, same)
            continue
        places[path.resolve()] = path
        alike.append(path)
        kept.append(path)
    return kept


def _say_copy(path: Path, same: Path) -> None:
    line = f"{path} has the readings of {same}: they count once"
    warnings.warn(line, SuspiciousReadingsWarning, stacklevel=4)


def _files(path: Path) -> list[tuple[str, Path]]:
    """Files of a log; those of a folder by their names in it, but a single one without its name."""
    if not path.is_dir():
        return [("", path)] if path.is_file() else []
    return sorted((str(each.relative_to(path)), each) for each in path.rglob("*") if each.is_file())


def _digest(path: Path) -> list[bytes]:
    """Digests of the contents of a log."""
    found = []
    for _, file in _files(path):
        with open(file, "rb") as handle:
            found.append(hashlib.file_digest(handle, "sha256").digest())
    return found


def _tracks(logs: Sequence[Path], output: Path, ending: str) -> list[Path]:
    """Paths of the tracks: as the logs lie below their common folder, whole names where stems are equal."""
    places = [path.resolve() for path in logs]
    root = Path(os.path.commonpath([place.parent for place in places]))
    stems = [place.relative_to(root).with_suffix("") for place in places]
    found = [
        output / (f"{stem}{ending}" if stems.count(stem) == 1 else f"{place.relative_to(root)}{ending}")
        for stem, place in zip(stems, places, strict=True)
    ]
    taken = {place for place in places if place.suffix == ending}
    for track in found:
        if track.resolve() in taken:
            raise TableError(f"{track}: the output must be another file than the log")
    return found


def _key(job: LogTask) -> int:
    """Hash of everything that a track depends on; it changes with any of it."""
    states = file_states([job.path] if job.how["truth"] is None else [job.path, job.how["truth"]])
    said = [__version__, *map(repr, (job.rover, job.how, job.track))]
    return int(hashlib.sha256(json.dumps([said, states]).encode()).hexdigest()[:15], 16)
