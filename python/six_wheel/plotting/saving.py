"""Figures to files."""

import io
from pathlib import Path

from matplotlib.figure import Figure

from six_wheel.kinematics.errors import ArgumentTypeError, TableError, as_path, one_line
from six_wheel.kinematics.objects.whole_files import replacing

PICTURES = (".png", ".svg", ".pdf")


def picture_path(path: Path) -> Path:
    """The path itself, if its ending is one of `PICTURES`.

    Raises
    ------
    TableError
        If it has another ending.
    """
    if path.suffix.lower() not in PICTURES:
        raise TableError(f'{path}: the ending must be one of {", ".join(PICTURES)}, got "{path.suffix}"')
    return path


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure, whole or not at all; the ending of the name says as what (png, svg, pdf).

    Raises
    ------
    ValueError
        If no picture is written by such an ending, the file cannot be written, or `figure` is none.
    """
    if not isinstance(figure, Figure):
        raise ArgumentTypeError(f"figure must be what sw.plot gives, got {type(figure).__name__}")
    render(figure, as_path("path", path))


def render(figure: Figure, path: Path) -> None:
    """Write a figure, whole or not at all.

    It is drawn in memory: some formats answer a full disk by other errors, and leave the file open.
    """
    ending = path.suffix.lower()
    if ending.removeprefix(".") not in figure.canvas.get_supported_filetypes():
        rule = f"the ending must be {', '.join(PICTURES)} or another of matplotlib's formats"
        raise TableError(f'{path}: {rule}, got "{path.suffix}"')
    with replacing(path) as temporary:
        drawn = io.BytesIO()
        try:
            figure.savefig(drawn, format=ending.removeprefix("."), dpi=160)
        except (RuntimeError, ValueError) as error:  # needs TeX, is too large
            told = one_line(error)
            raise TableError(f"{path}: the picture could not be drawn: {told}") from None
        temporary.write_bytes(drawn.getbuffer())
