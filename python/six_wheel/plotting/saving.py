"""Figures to files."""

from pathlib import Path

from matplotlib.figure import Figure

from six_wheel.logs.headers.columns import TableError

__all__ = ["picture_path", "save"]

PICTURES = (".png", ".svg", ".pdf")


def picture_path(path: Path) -> Path:
    """The path itself, if its ending is one of `PICTURES`; else a `TableError`."""
    if path.suffix.lower() not in PICTURES:
        raise TableError(f'{path}: the ending must be one of {", ".join(PICTURES)}, got "{path.suffix}"')
    return path


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure; the ending of the name says as what (png, svg, pdf).

    Raises
    ------
    ValueError
        If matplotlib knows no such ending.
    OSError
        If the file cannot be written.
    """
    figure.savefig(path, dpi=160)
