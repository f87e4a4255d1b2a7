"""Rows that were left out of a log, and why."""

from dataclasses import dataclass, field, replace
from pathlib import Path

__all__ = ["Finding", "Findings"]

MOST_FINDINGS = 1000  # that are kept; more are counted


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
    """Rows that were left out: the first `MOST_FINDINGS` findings in full, and the number of `rows`."""

    path: Path
    listed: list[Finding] = field(default_factory=list)
    rows: int = 0
    _flaw: str = ""
    _last: int = 0

    def add(self, row: int, flaw: str, got: str = "", line: int | None = None) -> None:
        """Report a row: `flaw` is the rule it breaks, the same for all that break it, `got` what it has."""
        self.rows += 1
        if flaw == self._flaw and row == self._last + 1 and self.listed:
            if len(self.listed) < MOST_FINDINGS or self.listed[-1].last_row == self._last:
                self.listed[-1] = replace(self.listed[-1], last_row=row)
        elif len(self.listed) < MOST_FINDINGS:
            self.listed.append(Finding(self.path, row, f"{flaw}{got}", line))
        self._flaw, self._last = flaw, row
