"""The ground as text: how it is written."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.unseen.case import COLUMNS, NODE, ROWS, STEP, heights

FOOT = 0.3048
X = NODE[0] + STEP * np.arange(COLUMNS)
Y = NODE[1] + STEP * np.arange(ROWS)
UNPLACED = {"spacing": STEP, "origin": NODE}


def file(name: str, content: str | bytes | Callable[[], bytes], **beside: str) -> Any:
    """Writes a file, and others of the same stem by suffix; reads it."""

    def make(folder: Path) -> Any:
        path = folder / name
        made = content() if callable(content) else content
        path.write_bytes(made if isinstance(made, bytes) else made.encode())
        for suffix, text in beside.items():
            path.with_suffix(f".{suffix}").write_text(text)
        return lambda **options: sw.Terrain.read(path, **options)

    return make


def points(known: bool = True) -> Any:
    """Rows x, y, z of the nodes, those of unknown height left out."""
    x, y = np.meshgrid(X, Y)
    rows = np.stack((x, y, heights()), -1).reshape(-1, 3)
    return rows[~np.isnan(rows[:, 2])] if known else rows


def table(rows: Any, separator: str = ",", head: str = "", digits: int = 4, mark: str = "nan") -> str:
    lines = [separator.join(mark if np.isnan(v) else f"{v:.{digits}f}" for v in row) for row in rows]
    return (head + "\n" if head else "") + "\n".join(lines) + "\n"


def grid(
    mark: str = "-9999", factor: float = 1.0, line: int | None = None, digits: int = 4, **head: Any
) -> str:
    """An ESRI grid; `line` numbers a line, or a row of the map."""
    given = {
        "ncols": COLUMNS,
        "nrows": ROWS,
        "xllcorner": NODE[0] - STEP / 2,
        "yllcorner": NODE[1] - STEP / 2,
    }
    given |= {"cellsize": STEP, "nodata_value": -9999} | head
    cells = [mark if np.isnan(v) else f"{v:.{digits}f}" for v in (heights()[::-1] / factor).ravel()]
    width = line or COLUMNS
    rows = [" ".join(cells[k : k + width]) for k in range(0, len(cells), width)]
    return "\n".join([*(f"{k} {v}" for k, v in given.items() if v is not None), *rows]) + "\n"
