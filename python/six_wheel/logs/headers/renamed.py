"""Headers as their owner wants them read."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from six_wheel.kinematics.errors import TableError
from six_wheel.logs.headers.columns import listed
from six_wheel.robot_description.doubts import Option

Columns: TypeAlias = Mapping[str, str] | Sequence[str]
SHOWN = 40  # letters of a row


def renamed(headers: Sequence[str], columns: Columns, nameless: bool = False) -> list[str]:
    """The names of the columns of a table, with those that its owner gives.

    `columns` lead from a header to the header it should be read as, or from a name to the header that has it;
    or are the names of all columns in their order, of which an empty one is not read. In a `nameless` table,
    one without a header line, columns go by their numbers, from 1. Raises `TableError` if a header is not
    there, or the number of names is not that of the columns.
    """
    if nameless:
        headers = [str(number) for number in range(1, len(headers) + 1)]
    if not isinstance(columns, Mapping):
        names = [columns] if isinstance(columns, str) else list(columns)
        if len(names) > len(headers):
            raise TableError(f"columns must name {len(headers)} columns, got {len(names)}")
        return names + [""] * (len(headers) - len(names))
    # Headers are without the signs of a comment before them.
    columns = {_bare(one, headers): _bare(other, headers) for one, other in columns.items()}
    # A name may stand on either side; the side that is a header decides.
    meaning = {
        **{header: name for name, header in columns.items() if header in headers and name not in headers},
        **{header: name for header, name in columns.items() if header in headers},
    }
    for one, other in columns.items():
        if one not in headers and other not in headers:
            raise TableError(f'columns must name headers of the table, got "{one}" among {listed(headers)}')
    return [meaning.get(header, "" if nameless else header) for header in headers]


def _bare(name: str, headers: Sequence[str]) -> str:
    """A name without the signs of a comment, if that is a header."""
    bare = name.lstrip("#% ").strip()
    return bare if name not in headers and bare in headers else name


def without_header(cells: Sequence[str]) -> tuple[str, ...]:
    """Parts of the message for a table that begins with numbers."""
    row = ",".join(cells)
    row = row if len(row) <= SHOWN else row[:SHOWN] + "..."
    return f'the first line must name the columns, got "{row}": ', *all_names(cells)


def all_names(cells: Sequence[str]) -> tuple[str, ...]:
    """Parts of a proposal to name all columns in their order."""
    such = ",".join(("time", *(f"NAME{number}" for number in range(2, len(cells) + 1))))
    python = ", ".join(f'"{name}"' for name in such.split(","))
    names = 'each NAME such as "left [rad]" or "left [ticks]", or nothing for what is not to be read'
    listed = f"columns: [{python}] in the parameter file, or columns=[{python}] in Python"
    return "give ", Option(f'--columns "{such}"'), f", or {listed}, {names}"
