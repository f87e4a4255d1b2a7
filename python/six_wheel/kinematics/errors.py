"""Exceptions of this package beyond the built-in ones."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator
    from pathlib import Path


class InfeasibleMotionError(ValueError):
    """A motion the rover cannot make: a wheel would slide sideways or steer past its range."""


class UnderdeterminedError(ValueError):
    """The readings of the wheels do not determine the twist."""


class ArgumentTypeError(ValueError, TypeError):
    """An argument of the wrong type. Bad input like any other here, and a `TypeError` by Python's custom."""


@contextmanager
def needed(packages: str, what: str) -> Iterator[None]:
    """An import that fails inside says what needs the module, and the packages to install for it."""
    try:
        yield
    except ModuleNotFoundError as error:
        message = f'{what} {error.name}: pip install "{packages}"'
        raise ModuleNotFoundError(message, name=error.name) from None


def one_line(error: BaseException) -> str:
    """Text of an error in one line; the name of its type if it has none."""
    return " ".join(str(error).split()) or type(error).__name__


def shown(value: object) -> str:
    """A value in one line, as errors have it."""
    return " ".join(repr(value).split())[:100]


def as_path(argument: str, value: str | os.PathLike[str]) -> Path:
    """The path that an argument is."""
    from pathlib import Path  # nothing else needs it when the package is imported

    try:
        path = Path(value)
    except TypeError:
        got = " ".join(repr(value).split())
        raise ArgumentTypeError(f"{argument} must be a path, got {got}") from None
    if not str(value):
        raise ValueError(f"{argument} must name a file, got an empty text")
    if "\0" in str(path):
        raise ValueError(f"{argument} must name a file, got {printable(str(path))}")
    return path


def printable(text: str) -> str:
    """The text with control characters as escapes: what a file says must not move a terminal's cursor."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text)


class FileError(ValueError):
    """A file that cannot be used. Its text may hold words of the file, and is printable all the same.

    It is made of parts, one of which may have the `option` of the command line that settles it.
    """

    def __init__(self, *parts: object) -> None:
        super().__init__(*parts)
        self.option: str = next(filter(None, (getattr(part, "option", "") for part in parts)), "")

    def __str__(self) -> str:
        return printable("".join(map(str, self.args)))


class TableError(FileError):
    """A table that cannot be used. Its text is one line that names the file and what is wrong with it."""


class SuspiciousUnitsWarning(UserWarning):
    """A number that cannot be a rover's in metres or radians; its text says what may have been meant."""


class SuspiciousReadingsWarning(UserWarning):
    """Readings of a log that can be read but hardly are what they seem to be."""
