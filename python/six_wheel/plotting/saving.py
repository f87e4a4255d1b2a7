"""Figures to files."""

import io
from pathlib import Path

from matplotlib.figure import Figure

from six_wheel.logs.headers.columns import TableError
from six_wheel.logs.writing import replacing

__all__ = ["picture_path", "render", "save"]

PICTURES = (".png", ".svg", ".pdf")


def picture_path(path: Path) -> Path:
    """The path itself, if its ending is one of `PICTURES`; else a `TableError`."""
    if path.suffix.lower() not in PICTURES:
        raise TableError(f'{path}: the ending must be one of {", ".join(PICTURES)}, got "{path.suffix}"')
    return path


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure, whole or not at all; the ending of the name says as what (png, svg, pdf).

    Raises
    ------
    ValueError
        If matplotlib knows no such ending, or the file cannot be written.
    """
    with replacing(Path(path)) as temporary:
        render(figure, temporary)


def render(figure: Figure, temporary: Path) -> None:
    """Write a figure to a file that `replacing` has made.

    It is drawn in memory: some formats answer a full disk by other errors, and leave the file open.
    """
    drawn = io.BytesIO()
    figure.savefig(drawn, format=temporary.suffix.lower().removeprefix("."), dpi=160)
    temporary.write_bytes(drawn.getbuffer())
