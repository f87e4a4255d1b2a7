"""Faults of a loop: number, last time and severity of each; nothing is lost between two reports."""

from dataclasses import dataclass

# Levels of diagnostic_msgs/DiagnosticStatus.
OK, WARN, ERROR, STALE = range(4)
AREAS = ("commands", "joints", "odometry", "time")


@dataclass
class Fault:
    """One kind of thing that goes wrong in one of the `AREAS`, at level `WARN` or `ERROR`.

    `what` is the rule that was broken, `last` the value that came instead, the last time; `count` is how
    often it was in all, `new` since the last report.
    """

    area: str
    level: int
    what: str
    last: str = ""
    count: int = 0
    new: int = 0

    def __str__(self) -> str:
        return f"{self.what}, got {self.last}" if self.last else self.what


class Faults:
    """All of them, by what they are."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, str], Fault] = {}

    def add(self, area: str, level: int, what: str, got: str = "") -> bool:
        """Count one more fault; True if it is the first of its kind since the last report."""
        fault = self._known.get((area, what))
        if fault is None:
            fault = self._known[area, what] = Fault(area, level, what)
        fault.last = got
        fault.count += 1
        fault.new += 1
        return fault.new == 1

    def of(self, area: str) -> list[Fault]:
        """Faults of an area, the worst first."""
        found = [fault for fault in self._known.values() if fault.area == area]
        return sorted(found, key=lambda fault: -fault.level)

    def __iter__(self):  # type: ignore[no-untyped-def]
        return iter(self._known.values())

    def reported(self) -> None:
        """All that there is has been told."""
        for fault in self._known.values():
            fault.new = 0
