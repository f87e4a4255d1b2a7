"""Rows that were left out of a log, and why."""

from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path

__all__ = ["Finding", "Findings"]

MOST_FINDINGS = 1000  # that are kept; more are counted
MANY = 0.1  # share of the rows of a log, that are left out as they are no numbers


@dataclass(frozen=True)
class Finding:
    """A row that was left out and why, or consecutive rows with the same flaw; ``str()`` is one line.

    Rows are counted from 1; in a bag they are messages. `line` is that of `row`, in a CSV file.
    """

    path: Path
    row: int
    message: str
    line: int | None = None
    last_row: int | None = None

    def __str__(self) -> str:
        line = "" if self.line is None else f" (line {self.line})"
        last = "" if self.last_row is None else f" to {self.last_row}"
        return f"{self.path}: row{'s' if last else ''} {self.row}{line}{last}: {self.message}"


@dataclass
class Findings:
    """Rows that were left out: the first `MOST_FINDINGS` findings in full, and the number of `rows` and of
    each of their `flaws`."""

    path: Path
    listed: list[Finding] = field(default_factory=list)
    rows: int = 0
    flaws: Counter[str] = field(default_factory=Counter)
    _flaw: str = ""
    _last: int = 0

    def add(self, row: int, flaw: str, got: str = "", line: int | None = None) -> None:
        """Report a row: `flaw` is the rule it breaks, the same for all that break it, `got` what it has."""
        self.rows += 1
        self.flaws[flaw] += 1
        if flaw == self._flaw and row == self._last + 1 and self.listed:
            if len(self.listed) < MOST_FINDINGS or self.listed[-1].last_row == self._last:
                self.listed[-1] = replace(self.listed[-1], last_row=row)
        elif len(self.listed) < MOST_FINDINGS:
            self.listed.append(Finding(self.path, row, f"{flaw}{got}", line))
        self._flaw, self._last = flaw, row

    def many_left_out(self, kept: int) -> str:
        """The line about a log of which many rows are no rows of numbers; empty if few are.

        Parameters
        ----------
        kept : int
            Rows that were used.
        """
        many = sum(number for flaw, number in self.flaws.items() if "must be a" in flaw or "cells as" in flaw)
        if many <= MANY * (kept + self.rows):
            return ""
        first = next(
            each for each in self.listed if "must be a" in each.message or "cells as" in each.message
        )
        rest = f"row {first.row}: {first.message}"
        return (
            f"{many} of {kept + self.rows} rows are left out, first {rest}: is the table read as it is meant?"
        )
