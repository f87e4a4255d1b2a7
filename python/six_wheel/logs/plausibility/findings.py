"""Rows that were left out of a log, and why."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, TypeAlias

MOST_FINDINGS = 1000  # that are kept; more are counted
MANY = 0.1  # share of the rows of a log, that are left out as they are no numbers

Kind: TypeAlias = Literal["no number", "nan", "same time", "other"]


@dataclass(frozen=True)
class Finding:
    """A row that was left out and why, or consecutive rows with the same flaw; ``str()`` is one line.

    Rows are counted from 1; in a bag they are messages. The row breaks `rule`, and `got` is the end of the
    message, with its value. `kind` tells rows without numbers, and those at the time of the row before.
    `line` is that of `row`, in a CSV file.
    """

    path: Path
    row: int
    rule: str
    got: str = ""
    kind: Kind = "other"
    line: int | None = None
    last_row: int | None = None

    @property
    def message(self) -> str:
        return f"{self.rule}{self.got}"

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
    _no_numbers: int = 0
    _first: Finding | None = None  # of those
    _flaw: tuple[str, Kind] = "", "other"
    _last: int = 0

    def add(self, row: int, rule: str, got: str = "", line: int = 0, kind: Kind = "other") -> None:
        """Report a row, as a `Finding` has it, with a `line` of 0 where it has none."""
        finding = Finding(self.path, row, rule, got, kind, line or None)
        self.rows += 1
        if kind in ("no number", "nan"):
            self._no_numbers += 1
            self._first = self._first or finding
        if (rule, kind) == self._flaw and row == self._last + 1 and self.listed:
            if len(self.listed) < MOST_FINDINGS or self.listed[-1].last_row == self._last:
                self.listed[-1] = replace(self.listed[-1], last_row=row)
        elif len(self.listed) < MOST_FINDINGS:
            self.listed.append(finding)
        self._flaw, self._last = (rule, kind), row

    def many_left_out(self, kept: int) -> str:
        """The line about a log with many rows that are no numbers, beside those `kept`; empty for few."""
        rows = kept + self.rows
        if self._first is None or self._no_numbers <= MANY * rows:
            return ""
        first = f"{self._no_numbers} of {rows} rows are left out, first row {self._first.row}"
        return f"{first}: {self._first.message}: is the table read as it is meant?"
