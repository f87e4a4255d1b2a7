"""Outcome of an item: its value, or the failure."""

from dataclasses import dataclass
from typing import Any

__all__ = ["Failure", "Outcome", "Outcomes", "failed"]


@dataclass(frozen=True)
class Failure:
    """Failure of an item: the exception that it raised, or the death of its worker."""

    kind: str
    """Name of the exception, or ``WorkerDied``."""
    message: str
    """Message of the exception, in one line."""

    def __str__(self) -> str:
        return f"{self.kind}: {self.message}" if self.message else self.kind


@dataclass(frozen=True)
class Outcome:
    """One item, done or failed."""

    index: int
    """Place of the item among the items."""
    value: Any = None
    """Value of the function; None if it failed."""
    failure: Failure | None = None
    """None where it did not."""
    resumed: bool = False
    """True if the value was read from a journal."""


@dataclass(frozen=True)
class Outcomes:
    """All items, in their order."""

    values: list[Any]
    """One per item; None where it failed."""
    failures: dict[int, Failure]
    """Place of every item that failed, and why."""


def failed(index: int, error: BaseException) -> Outcome:
    """The outcome of an item whose function raised."""
    return Outcome(index, failure=Failure(type(error).__name__, " ".join(str(error).split())))
