"""Files that are written whole or not at all."""

import contextlib
import errno
import hashlib
import os
import platform
import secrets
from collections import deque
from collections.abc import Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass, field
from glob import escape
from itertools import starmap
from pathlib import Path

from six_wheel.kinematics.errors import TableError

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS)
_PROBE = 1 << 16  # bytes that still go onto a disk with room


@dataclass
class _Files:
    """Files that one command reads, and those it writes: temporary file to (path as given, target).

    A target is here from the moment it is opened.
    """

    sources: tuple[Path, ...]
    targets: dict[Path, tuple[Path, Path]] = field(default_factory=dict)


_at_work: set[Path] = set()  # temporary files of this process that are being written
_files: ContextVar[_Files | None] = ContextVar("files of the command", default=None)


@contextlib.contextmanager
def together(sources: Sequence[Path] = ()) -> Iterator[None]:
    """All files that `replacing` writes within the block are replaced when it succeeds, or none is.

    A block within another one replaces its own files when it ends. `sources` are read, and not replaced.
    """
    outer = _files.get()
    files = _Files((*sources, *(outer.sources if outer else ())))
    token = _files.set(files)
    try:
        yield
        # One call without Python's code: a signal is handled after it, not between two of the files.
        names = [(os.fspath(one), os.fspath(target)) for one, (_, target) in files.targets.items()]
        deque(starmap(os.replace, names), maxlen=0)
    finally:
        _files.reset(token)
        for temporary in files.targets:
            temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def replacing(path: Path, sources: Sequence[Path] = ()) -> Iterator[Path]:
    """A temporary file beside `path`, which it replaces if the block succeeds; if not, it is removed.

    Within `together` it replaces `path` when that block ends. A temporary file itself is written as it is, so
    that whatever writes a file begins here, within another writer too. Raises `TableError` if `path` is one
    of `sources`, another output, not a file, or in no folder, or cannot be written.
    """
    if path in _at_work:
        yield path
        return
    files = _files.get()
    target = check_target(path, [*sources, *(files.sources if files else ())])
    targets = files.targets if files else {}
    if given := next((given for given, other in targets.values() if same_file(other, target)), None):
        raise TableError(f"{path}: the output must be another file than the output {given}")
    remove_leftovers(target)
    temporary = target.with_name(f"{_beside(target)}{os.getpid()}-{secrets.token_hex(4)}{target.suffix}")
    _at_work.add(temporary)
    targets[temporary] = (path, target)
    # The file is created within the block that removes it: a signal may come right after.
    try:
        _create(path, temporary)
        yield temporary
        if files is None:
            os.replace(temporary, target)
    except BaseException as error:
        del targets[temporary]
        is_full = _is_full(temporary)  # it may be the disk of another file that is written at the same time
        with contextlib.suppress(OSError):  # nothing was created on a disk that nobody may write to
            temporary.unlink()
        if isinstance(error, OSError) and error.errno in _FULL and is_full:
            raise TableError(f"{path}: could not be written: {os.strerror(error.errno)}") from None
        raise
    finally:
        _at_work.discard(temporary)


def _create(path: Path, temporary: Path) -> None:
    """An empty file whose permissions follow the umask, which those of tempfile do not."""
    try:
        temporary.open("xb").close()
    except OSError as error:
        raise TableError(f"{path}: the output must be writeable, got: {error.strerror}") from None


def _is_full(temporary: Path) -> bool:
    """True where no more can be written to a file."""
    try:
        with temporary.open("ab") as file:
            file.write(bytes(_PROBE))
    except OSError:
        return True
    return False


def check_target(path: Path, sources: Sequence[Path]) -> Path:
    """The file that a path to be written leads to. Raises `TableError` if it is one of `sources`, not a file,
    or in no folder."""
    try:
        target = path.resolve()
        is_there = target.exists() or target.is_symlink()
    except (OSError, RuntimeError) as error:  # a name that is too long, links in a circle
        why = getattr(error, "strerror", None) or "its links lead in a circle"
        raise TableError(f"{path}: the output must be writeable, got: {why}") from None
    check_source(path, target, sources)
    if is_there and not target.is_file():
        raise TableError(f"{path}: the output must be a file")
    if not target.parent.is_dir():
        raise TableError(f"{path}: the folder of the output must exist")
    return target


def check_source(path: Path, target: Path, sources: Sequence[Path]) -> None:
    """Refuse a path to be written that leads to a file which is read."""
    for source in sources:
        if same_file(source, target):
            raise TableError(f"{path}: the output must be another file than {source}")


def same_file(one: Path, other: Path) -> bool:
    """True where two paths lead to one file, through links and other spellings."""
    if os.path.realpath(one) == os.path.realpath(other):  # unlike `resolve`, also of links in a circle
        return True
    return one.exists() and other.exists() and one.samefile(other)


def remove_leftovers(path: Path) -> None:
    """Delete temporary files beside `path` that writers left which were killed."""
    for rest in path.parent.glob(f"{_beside(path)}*-{'[0-9a-f]' * 8}{escape(path.suffix)}"):
        writer = rest.name.removeprefix(_beside(path)).partition("-")[0]
        if writer.isdecimal() and not _runs(int(writer)):
            rest.unlink(missing_ok=True)


def _beside(path: Path) -> str:
    """Beginning of the names of this machine's temporary files for `path`, however long its own name is."""
    named = os.fsencode(f"{platform.node()}/{path.name}")
    return f".{hashlib.blake2s(named, digest_size=6).hexdigest()}-"


def _runs(process: int) -> bool:
    """True where a process may still run; on Windows always, where asking would end it."""
    if os.name == "nt":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # of another user
        return True
    return process != os.getpid()
