"""Dialect of a text table: its encoding, what separates cells, decimal commas, and where its header is."""

import csv
import io
import lzma
import re
import shutil
import tempfile
import zlib
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from six_wheel.kinematics.errors import TableError, one_line
from six_wheel.logs.headers.clock_times import is_clock_time
from six_wheel.logs.headers.columns import BRACKETS, TIME, is_number, means, words
from six_wheel.logs.headers.joint_columns import unit_words
from six_wheel.logs.text.foreign import FOREIGN, PACKED

LONGEST_LINE = 1 << 16  # [byte]
HEAD = 40  # lines among which a header is looked for
ROWS = 8  # lines below a header that tell how cells are written
SPACES = " "
SEPARATORS = (",", ";", "\t", "|")
COMMENT = re.compile(r"^\s*(?:#+|%+|//)\s*")
SPACED = r"['\u2019\u00a0\u2009\u202f ]"  # between thousands, which mean nothing else in a number
_GROUPED = re.compile(rf"[+-]?\d{{1,3}}(?:{SPACED}\d{{3}})+(?:[.,]\d+)?")
_DECIMAL = re.compile(r"\s*[+-]?\d*,\d+(?:[eE][+-]?\d+)?\s*")
UNIT_WORDS = unit_words() | {"v", "a", "c", "w", "hz", "n", "nm", "kg", "g", "g_s", "percent", "celsius"}
UNIT_WORDS |= {"bool", "int", "float", "none", "unit", "units"}


@dataclass
class Dialect:
    """Form of a text table."""

    delimiter: str  # between cells; a space stands for any number of spaces and tabs
    decimal: str = "."  # point or comma
    headers: list[str] = field(default_factory=list)  # empty texts where the file has none
    skip_lines: int = 0  # lines and bytes before the first row
    header_bytes: int = 0
    units: dict[int, str] = field(default_factory=dict)  # of columns, from a row below the header
    first: list[list[str]] = field(default_factory=list)  # cells of the first rows
    has_header: bool = True


def open_text(path: Path) -> BinaryIO:
    """A file as UTF-8: itself if it is, or else a copy."""
    handle = open(path, "rb")  # noqa: SIM115
    head = handle.read(4096)
    handle.seek(0)
    encoding = _encoding(head)
    returns = b"\r" in head and b"\n" not in head  # lines of an old Macintosh
    unpack = next((each for begin, each in PACKED.items() if head.startswith(begin)), None)
    if unpack is None and (foreign := next((k for k in FOREIGN if head.lstrip().startswith(k)), None)):
        handle.close()
        raise TableError(f"the file must be a table of text, and it is {FOREIGN[foreign]}")
    if unpack is None and encoding is None and not returns:
        return handle
    with handle:
        source: BinaryIO = handle
        copy = tempfile.TemporaryFile()  # noqa: SIM115
        try:
            if unpack is not None:
                source = unpack(handle)
                encoding = _encoding(source.read(4096)) or "utf-8-sig"
                source.seek(0)
            text = io.TextIOWrapper(
                source, encoding=encoding or "utf-8", errors="replace", newline=None if returns else ""
            )
            target = io.TextIOWrapper(copy, encoding="utf-8", newline="", write_through=True)
            shutil.copyfileobj(text, target)
            target.detach()
        except (OSError, EOFError, UnicodeError, zlib.error, lzma.LZMAError) as error:
            copy.close()
            raise TableError(f"the text cannot be read: {one_line(error)}") from None
        copy.seek(0)
        return copy


def _encoding(head: bytes) -> str | None:
    """Encoding of a text that is not UTF-8, by its first bytes."""
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    if len(head) > 7 and head.count(b"\0") >= len(head) // 3:
        evens, odds = head[::2].count(b"\0"), head[1::2].count(b"\0")
        if min(evens, odds) == 0:
            return "utf-16-le" if odds else "utf-16-be"
    try:
        head.decode("utf-8")
    except UnicodeDecodeError as error:
        cut = error.end >= len(head) - 3  # in the middle of a character
        if not cut and b"\0" not in head:
            return "cp1252"
    return None


def cells_of(line: str, delimiter: str) -> list[str]:
    """The cells of a line."""
    if delimiter == SPACES:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=delimiter))
    except csv.Error as error:
        raise TableError(f"the header must be a line of cells, got {line!r:.60} ({error})") from None


def read_dialect(handle: BinaryIO, known: Collection[str] = ()) -> Dialect:
    """The dialect of a table, by its first lines; `known` are headers that somebody named. Raises
    `TableError` if there is no line of text."""
    lines: list[tuple[int, int, str]] = []  # lines up to and with it, bytes, text
    number = 0
    handle.seek(0)
    while len(lines) < HEAD + ROWS and (line := handle.readline(LONGEST_LINE)):
        number += 1
        if not line.strip():
            continue
        try:
            text = line.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            if len(lines):
                text = line.decode("utf-8", "replace")
            else:
                byte = error.object[error.start]
                raise TableError(f"the header must be UTF-8 text, got byte 0x{byte:02x}") from None
        lines.append((number, handle.tell(), text.rstrip("\r\n")))
    if not lines or "\0" in lines[0][2]:
        raise TableError("the header must be a line of text, got none")
    place, delimiter = _header_line([text for _, _, text in lines], known)
    return _dialect(lines, place, delimiter)


def _header_line(texts: Sequence[str], known: Collection[str]) -> tuple[int, str]:
    """The line of the header, and what separates its cells: the first one that names a time above a row of
    readings, one above several rows, one that names a time, or the first."""
    named = []
    for place, text in enumerate(texts[:HEAD]):
        bare = COMMENT.sub("", text)
        for delimiter in _separators(bare):
            headers = _headers(bare, delimiter)
            time = any(means(header, TIME) for header in headers) or not frozenset(known).isdisjoint(headers)
            if len(headers) > 1 and time and not any(map(_is_reading, headers)):
                named.append((place, delimiter))
    for place, delimiter in named:
        if any(_is_row(_cells(text, delimiter)) for text in texts[place + 1 : place + 4]):
            return place, delimiter
    if found := _above_rows(texts) or next(iter(named), None):
        return found
    place = next((k for k, text in enumerate(texts) if not _is_preamble(texts, k)), 0)
    bare = COMMENT.sub("", texts[place])
    return place, (_separators(bare) or [","])[0]


def _above_rows(texts: Sequence[str]) -> tuple[int, str] | None:
    """The first line of names with rows of as many numbers below it, and what separates its cells."""
    for place, text in enumerate(texts[: -ROWS // 2]):
        bare = COMMENT.sub("", text)
        for delimiter in _separators(bare):
            headers = _headers(bare, delimiter)
            below = [_cells(each, delimiter) for each in texts[place + 1 : place + 1 + ROWS // 2]]
            fits = all(len(row) == len(headers) and _is_row(row) for row in below)
            if len(headers) > 1 and fits and not any(map(_is_reading, headers)):
                return place, delimiter
    return None


def _is_preamble(texts: Sequence[str], place: int) -> bool:
    """True for a comment that is not directly above the rows, and for a line in which Excel names them."""
    text = texts[place]
    if re.fullmatch(r"sep=.", text.strip(), re.IGNORECASE):
        return True
    below = texts[place + 1] if place + 1 < len(texts) else ""
    return bool(COMMENT.match(text)) and (bool(COMMENT.match(below)) or (below != "" and not _numbers(below)))


def _numbers(text: str) -> bool:
    return any(_is_row(cells_of(text, each)) for each in _separators(text) or [","])


def _separators(text: str) -> list[str]:
    """Possible separators of the cells of a line, the likeliest first."""
    there = [each for each in SEPARATORS if each in text]
    return sorted(there, key=text.count, reverse=True) or ([SPACES] if len(text.split()) > 1 else [])


def _headers(text: str, delimiter: str) -> list[str]:
    """The names in a line of headers."""
    if delimiter == SPACES:  # "left [rad]" is one name
        text = re.sub(r"(?<!\s)\s+(?=[\[(])", "", text)
    return [cell.strip().strip('"').lstrip("#% ").strip() for cell in _cells(text, delimiter)]


def _cells(text: str, delimiter: str) -> list[str]:
    """The cells of a line, none where it has none."""
    try:
        return cells_of(text, delimiter)
    except TableError:
        return []


def without_groups(cell: str) -> str:
    """A number without spaces or apostrophes between its thousands; other cells as they are."""
    return re.sub(SPACED, "", cell) if _GROUPED.fullmatch(cell) else cell


def has_groups(cell: str) -> bool:
    """True for a number with commas or points between its thousands."""
    return re.fullmatch(r"[+-]?\d{1,3}(?:(?:,\d{3})+(?:\.\d+)?|(?:\.\d{3}){2,})", cell) is not None


def _is_reading(cell: str) -> bool:
    """True for a cell that is a number or a time."""
    return bool(cell.strip()) and (is_number(cell.strip().replace(",", ".")) or is_clock_time(cell))


def _is_row(cells: Sequence[str]) -> bool:
    """True for cells that are numbers and times."""
    held = [cell for cell in cells if cell.strip()]
    return bool(held) and all(map(_is_reading, held))


def _is_headless(cells: Sequence[str]) -> bool:
    """True for the cells of a row, some of which may be words behind the first."""
    readings = sum(map(_is_reading, cells))
    return bool(cells) and _is_reading(cells[0]) and 2 * readings >= sum(bool(c.strip()) for c in cells)


def _dialect(lines: Sequence[tuple[int, int, str]], place: int, delimiter: str) -> Dialect:
    """The dialect of a table whose header is in a line."""
    number, end, text = lines[place]
    headers = _headers(COMMENT.sub("", text), delimiter)
    below = [each for each in lines[place + 1 : place + 1 + ROWS] if not COMMENT.match(each[2])]
    found = Dialect(delimiter, headers=headers, skip_lines=number, header_bytes=end)
    if _is_headless(headers):
        found.has_header = False
        found.skip_lines, found.header_bytes = lines[place - 1][:2] if place else (0, 0)
        below = list(lines[place : place + ROWS])
    rows = [cells_of(each[2], delimiter) for each in below]
    if found.has_header and rows and _is_unit_row(rows[0], headers):
        found.units = {k: _unit(cell) for k, cell in enumerate(rows[0]) if _unit(cell)}
        found.skip_lines, found.header_bytes = below[0][:2]
        rows = rows[1:]
    if rows and all(len(row) > len(headers) and not "".join(row[len(headers) :]).strip() for row in rows):
        headers += [""] * (len(rows[0]) - len(headers))  # separators behind the last cell
    found.first = rows
    if cells := [cell for row in rows for cell in row if "," in cell]:
        decimal = all(_DECIMAL.fullmatch(c) or is_clock_time(c) for c in cells)
        # In quotes between commas three digits may be thousands.
        thousands = delimiter == "," and all(re.search(r",\d{3}(?!\d)", cell) for cell in cells)
        found.decimal = "," if decimal and not thousands else "."
    return found


def _unit(cell: str) -> str:
    """The unit in a cell below a header."""
    bracketed = BRACKETS.match(cell.strip())
    return (bracketed[2] if bracketed else cell).strip()


def _is_unit_row(cells: Sequence[str], headers: Sequence[str]) -> bool:
    """True for a row of units."""
    if len(cells) != len(headers) or not any(cell.strip() for cell in cells):
        return False
    return all(
        words(_unit(cell)) in UNIT_WORDS or (not words(_unit(cell)) and not is_number(cell)) for cell in cells
    )
