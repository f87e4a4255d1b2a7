"""Times as clocks write them: times of day, dates with times, zones, numbers with their unit.

A time of day counts from midnight, and goes on behind the next one. A date without a zone counts as UTC.
"""

import math
import re
from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

KNOWN = (
    "12:59:59.95, 59:59.95, 11:59:59.95 PM, 2026-11-23 12:59:59.95, 2026-11-23T12:59:59Z, "
    "23.11.2026 12:59:59 or 2026_11_23_12_59_59_950"
)

SECOND = 1_000_000_000
DAY = 86_400 * SECOND
MONTHS = "janfebmaraprmayjunjulaugsepoctnovdec"
UNITS = {"s": SECOND, "sec": SECOND, "ms": 1_000_000, "us": 1000, "µs": 1000, "ns": 1}

_FRACTION = r"(?:(?:[.,]|:(?=\d{3}\b))(?P<fraction>\d{1,9})\d*)?"
_HALF = r"(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?"
_CLOCK = re.compile(
    r"(?:(?P<days>\d+) days?,? )?(?:(?P<hour>\d{1,3}):)?(?P<minute>\d{1,2}):(?P<second>\d{2})"
    + _FRACTION
    + _HALF
)
_ZONE = r"\s*(?:Z|UTC|GMT|(?P<sign>[+-])(?P<zh>\d{2}):?(?P<zm>\d{2})?)?"
_DATES = (
    r"(?P<year>\d{4})(?P<s>[-/.])(?P<month>\d{1,2})(?P=s)(?P<day>\d{1,2})",
    r"(?P<day>\d{1,2})\.(?P<month>\d{1,2})\.(?P<year>\d{4}|\d{2})",
    r"(?P<day>\d{1,2})[- ](?P<month>[A-Za-z]{3})[- ](?P<year>\d{4})",
    # With strokes only a number above 12 tells the day from the month.
    r"(?P<month>\d{1,2})/(?P<day>1[3-9]|2\d|3[01])/(?P<year>\d{4})",
    r"(?P<day>1[3-9]|2\d|3[01])/(?P<month>\d{1,2})/(?P<year>\d{4})",
)
_STAMPS = (
    *(
        re.compile(
            rf"{date}[T _,]+(?P<hour>\d{{1,2}}):(?P<minute>\d{{2}}):(?P<second>\d{{2}})"
            + _FRACTION
            + _HALF
            + _ZONE
        )
        for date in _DATES
    ),
    re.compile(
        r"(?P<year>\d{4})([_-])(?P<month>\d{2})\2(?P<day>\d{2})\2(?P<hour>\d{2})\2(?P<minute>\d{2})\2"
        r"(?P<second>\d{2})(?:[_.-](?P<fraction>\d{1,9}))?"
    ),
    re.compile(
        r"(?P<year>\d{4})(?P<month>\d{2})(?P<day>\d{2})[T_-](?P<hour>\d{2})(?P<minute>\d{2})(?P<second>\d{2})"
        rf"{_FRACTION}{_ZONE}"
    ),
)
_WITH_UNIT = re.compile(r"(?P<number>-?\d+(?:[.,]\d+)?)\s*(?P<unit>s|sec|ms|us|µs|ns)", re.IGNORECASE)


def is_clock_time(text: str) -> bool:
    """True if a cell is a time that `ClockTimes` reads and no number."""
    return _read(text.strip()) is not None


class ClockTimes:
    """Reads consecutive cells; times of day go on behind midnight."""

    def __init__(self) -> None:
        self._days, self._last = 0, -math.inf

    def read(self, texts: Sequence[str | None]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Nanoseconds (n,), since 1970 where there is a date, and whether each cell is such a time."""
        times = np.zeros(len(texts), dtype=np.int64)
        good = np.zeros(len(texts), dtype=bool)
        for place, text in enumerate(texts):
            found = None if text is None else _read(text.strip())
            if found is None:
                continue
            time, of_day = found
            if of_day:
                if time < self._last - DAY // 2:
                    self._days += 1
                self._last = time
                time += self._days * DAY
            times[place], good[place] = time, True
        return times, good


def _read(text: str) -> tuple[int, bool] | None:
    """Nanoseconds, and whether they count from midnight; None for anything else."""
    if found := _CLOCK.fullmatch(text):
        if found["hour"] is None and found["fraction"] is None:
            return None  # hours and minutes, or minutes and seconds
        days = int(found["days"] or 0)
        minutes = 60 * (24 * days + _hour(found["hour"] or "0", found["half"])) + int(found["minute"])
        seconds = 60 * minutes + int(found["second"])
        within = int(found["second"]) < 61 and (found["hour"] is None or int(found["minute"]) < 60)
        of_day = found["days"] is None and seconds < 86_400
        return (seconds * SECOND + _nanoseconds(found["fraction"]), of_day) if within else None
    for form in _STAMPS:
        if found := form.fullmatch(text):
            return _of_date(found)
    if found := _WITH_UNIT.fullmatch(text):
        return round(float(found["number"].replace(",", ".")) * UNITS[found["unit"].lower()]), False
    return None


def _of_date(found: re.Match[str]) -> tuple[int, bool] | None:
    written = found.groupdict()
    if not written["month"].isdigit():  # in letters; 0 for none
        written["month"] = 1 + MONTHS.find(written["month"].lower()) // 3
    parts = [int(written[name]) for name in ("year", "month", "day", "hour", "minute", "second")]
    parts[0] += 2000 if len(found["year"]) == 2 else 0
    parts[3] = _hour(found["hour"], found.groupdict().get("half"))
    try:
        seconds = round(datetime(*parts, tzinfo=UTC).timestamp())  # type: ignore[arg-type, misc]
    except ValueError:
        return None
    if found.groupdict().get("sign"):
        offset = 3600 * int(found["zh"]) + 60 * int(found["zm"] or 0)
        seconds -= offset if found["sign"] == "+" else -offset
    return seconds * SECOND + _nanoseconds(found["fraction"]), False


def _hour(text: str, half: str | None) -> int:
    """Hour of the day, also of a clock with two halves."""
    hour = int(text)
    return hour if half is None else hour % 12 + (12 if half in "pP" else 0)


def _nanoseconds(fraction: str | None) -> int:
    return int((fraction or "0").ljust(9, "0"))
