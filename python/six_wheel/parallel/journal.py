"""Finished items in a folder, so that a run that was stopped goes on where it was.

One file per item, written beside its place and moved there when it is whole: a stop or a full disk leaves
nothing half-written. Values are what JSON knows, arrays, and lists, tuples and dicts of them, kept to the
bit; nothing in a journal is executed when it is read.
"""

import contextlib
import json
import os
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Self

import numpy as np

from six_wheel.kinematics.errors import FileError

MANIFEST = "journal.json"
ARRAY = "__array__"  # key of a stand-in for an array
TUPLE = "__tuple__"  # key of a stand-in for a tuple


def file_states(paths: Iterable[Path]) -> list[list[Any]]:
    """Path, size and time of change of files, and of those in folders, as far as a run depends on them."""
    files = [file for path in paths for file in (sorted(path.rglob("*")) if path.is_dir() else [path])]
    stats = [(str(file.resolve()), file.stat()) for file in files if file.is_file()]
    return [[name, stat.st_size, stat.st_mtime_ns] for name, stat in stats]


class JournalError(FileError):
    """A journal that is not one, or that belongs to another run."""


class Journal:
    """The folder of a run's finished items.

    Parameters
    ----------
    path : path
        The folder; made if it is not there.
    run : mapping of str to what JSON knows
        Everything the values depend on. A folder of another run is refused, so that no value is taken for
        what it is not.

    Raises
    ------
    JournalError
        If the folder holds something else, or another run.
    """

    def __init__(self, path: str | os.PathLike[str], run: Mapping[str, Any]) -> None:
        self.path = Path(path)
        mine = json.loads(json.dumps(dict(run), sort_keys=True))
        manifest = self.path / MANIFEST
        if manifest.exists():
            try:
                theirs = json.loads(manifest.read_text())
            except (ValueError, RecursionError):
                raise JournalError(f"{manifest} must be a journal's, it is not JSON") from None
            if theirs != mine:
                raise JournalError(f"{self.path} holds another run: {_difference(theirs, mine)}")
        elif self.path.exists() and (not self.path.is_dir() or any(self.path.iterdir())):
            raise JournalError(f"{self.path} must be a journal or an empty folder")
        else:
            self.path.mkdir(parents=True, exist_ok=True)
            _write(manifest, lambda file: file.write(json.dumps(mine, indent=1, sort_keys=True).encode()))
        self.done = {int(file.stem) for file in self.path.glob("*.npz") if file.stem.isdigit()}

    @classmethod
    def of_this_run(cls, path: str | os.PathLike[str], run: Mapping[str, Any]) -> Self:
        """The journal of this run; what another run has left in its place is removed first.

        Raises
        ------
        JournalError
            If the folder holds something that is no journal.
        """
        try:
            return cls(path, run)
        except JournalError:
            manifest = Path(path) / MANIFEST
            try:
                theirs = json.loads(manifest.read_text())
            except (OSError, ValueError, RecursionError):
                theirs = None
            if not isinstance(theirs, dict):
                raise
        cls(path, theirs).discard()
        return cls(path, run)

    def __contains__(self, index: int) -> bool:
        return index in self.done

    def read(self, index: int) -> Any:
        """The value of a finished item.

        Raises
        ------
        JournalError
            If its file cannot be read.
        """
        path = self._file(index)
        try:
            with np.load(path, allow_pickle=False) as arrays:

                def joined(part: dict[str, Any]) -> Any:
                    if ARRAY in part:
                        return arrays[part[ARRAY]][()]
                    return tuple(part[TUPLE]) if TUPLE in part else part

                return json.loads(arrays["value"].tobytes(), object_hook=joined)
        except (OSError, ValueError, KeyError, EOFError, RecursionError, zipfile.BadZipFile) as error:
            raise JournalError(f"{path} must be a finished item: {error}") from error

    def write(self, index: int, value: Any) -> None:
        """Keep the value of an item. Fails with `OSError` where there is no room; leaves no piece of it."""
        arrays: dict[str, np.ndarray] = {}
        text = json.dumps(_parted(value, arrays))
        arrays["value"] = np.frombuffer(text.encode(), np.uint8)
        _write(self._file(index), lambda file: np.savez(file, **arrays))  # type: ignore[arg-type]
        self.done.add(index)

    def discard(self) -> None:
        """Remove the folder, once the run's result is kept elsewhere."""
        for index in sorted(self.done):
            self._file(index).unlink(missing_ok=True)
        for unfinished in self.path.glob(".*.npz.*"):  # of a run that was killed
            unfinished.unlink(missing_ok=True)
        (self.path / MANIFEST).unlink(missing_ok=True)
        with contextlib.suppress(OSError):  # files of others stay
            self.path.rmdir()
        self.done = set()

    def _file(self, index: int) -> Path:
        return self.path / f"{index:08}.npz"


def _write(path: Path, fill: Any) -> None:
    """Fill a file beside its place, then move it there."""
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with beside.open("wb") as file:
            fill(file)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except BaseException as error:
        beside.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.errno is not None:
            raise OSError(error.errno, os.strerror(error.errno), str(path)) from None
        raise


def _parted(value: Any, arrays: dict[str, np.ndarray]) -> Any:
    """A value for JSON, its arrays put aside."""
    if isinstance(value, np.ndarray | np.generic):
        if value.dtype.hasobject:
            raise TypeError(
                "a value that is kept must be numbers, text, arrays or lists of them, got objects"
            )
        arrays[f"array{len(arrays)}"] = np.asarray(value)
        return {ARRAY: f"array{len(arrays) - 1}"}
    if isinstance(value, Mapping):
        if not all(isinstance(key, str) for key in value):
            raise TypeError("a dict that is kept must have text for keys")
        return {key: _parted(item, arrays) for key, item in value.items()}
    if isinstance(value, tuple):
        return {TUPLE: [_parted(item, arrays) for item in value]}
    if isinstance(value, list):
        return [_parted(item, arrays) for item in value]
    return value


def _difference(theirs: Any, mine: dict[str, Any]) -> str:
    if not isinstance(theirs, dict):
        return "its manifest is not one"
    for key in sorted({*theirs, *mine}):
        if theirs.get(key) != mine.get(key):
            return f"{key} was {json.dumps(theirs.get(key))}, now {json.dumps(mine.get(key))}"
    return "it differs"
