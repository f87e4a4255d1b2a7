"""What comes back of an item: its value, or why there is none."""

from dataclasses import dataclass
from typing import Any

__all__ = ["Failure", "Outcome", "Outcomes", "failed"]


@dataclass(frozen=True)
class Failure:
    """Why an item has no value."""

    kind: str
    """Name of the exception, or ``WorkerDied``."""
    message: str
    """What it said, in one line."""

    def __str__(self) -> str:
        return f"{self.kind}: {self.message}" if self.message else self.kind


@dataclass(frozen=True)
class Outcome:
    """One item, done or failed."""

    index: int
    """Place of the item among the items."""
    value: Any = None
    """What the function made of it; None where it failed."""
    failure: Failure | None = None
    """None where it did not."""
    resumed: bool = False
    """Whether the value was read from a journal."""


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
