"""Input that leaves something open, and what settles it: a key of a file, an option, an argument."""

from __future__ import annotations

from typing import NamedTuple

from six_wheel.kinematics.errors import printable


class Proposal(NamedTuple):
    """An option that settles a doubt, as a parameter file, the command line and Python write it."""

    key: str
    option: str
    argument: str

    def __str__(self) -> str:
        option = f"{self.option}, or " if self.option else ""
        return f"{option}{self.key} in the parameter file, or {self.argument} in Python"

    def beside(self, other: Proposal) -> Proposal:
        """Two options together."""
        option = f"{self.option} {other.option}".strip()
        return Proposal(f"{self.key}, {other.key}", option, f"{self.argument}, {other.argument}")


class Option(str):
    """The same where the other forms are written in other words: options of the command line alone."""

    __slots__ = ()

    @property
    def option(self) -> str:
        return str(self)


class DoubtError(ValueError):
    """Input that leaves something open. Its text, `parts` in order, has what settles it, as Python writes
    it."""

    def __init__(self, *parts: str | Proposal) -> None:
        super().__init__("".join(part if isinstance(part, str) else part.argument for part in parts))
        self.parts = parts

    def told(self, form: str) -> str:
        """The text with proposals in another form: ``key``, ``option`` or ``argument``."""
        words = (part if isinstance(part, str) else getattr(part, form) for part in self.parts)
        return printable("".join(words))
