"""Errors and warnings about a file that describes a rover, one line for each."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from six_wheel.kinematics.errors import FileError, printable

Severity: TypeAlias = Literal["error", "warning"]


@dataclass(frozen=True)
class Finding:
    """One thing to put right in a file that describes a rover; ``str()`` is a line as a compiler prints."""

    line: int | None
    key: str
    message: str
    remedy: str | None = None
    severity: Severity = "error"
    path: str = ""

    def __str__(self) -> str:
        place = self.path if self.line is None else f"{self.path}:{self.line}"
        warning = "warning: " if self.severity == "warning" else ""
        remedy = f" ({self.remedy})" if self.remedy else ""
        return printable(" ".join(f"{place}: {warning}{self.message}{remedy}".splitlines()))


class ParameterFileError(FileError):
    """A file that does not describe a rover; ``str()`` has one line for each finding."""

    def __init__(self, findings: Iterable[Finding]) -> None:
        self.findings: tuple[Finding, ...] = tuple(findings)
        super().__init__(self.findings)

    def __str__(self) -> str:
        return "\n".join(map(str, self.findings))
