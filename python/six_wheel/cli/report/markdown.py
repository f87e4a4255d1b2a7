"""Written reports: Markdown, its pictures beside it."""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from six_wheel.kinematics.errors import TableError
from six_wheel.kinematics.objects.whole_files import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ENDINGS = (".md", ".markdown")
CALIBRATION_PICTURES = ("", "_windows")  # endings of their names


class Pages:
    """A picture, and a report with pictures of its own, that are written in the end.

    `plot` and `report` are where they go, `targets` the files to write instead of these until all went well.
    """

    def __init__(self, plot: Path | None, report: Path | None, targets: dict[Path, Path]) -> None:
        self._plot, self._report, self._targets = plot, report, targets

    def write(
        self, figures: Sequence[tuple[str, "Figure"]], words: Callable[[list[str]], str] | None = None
    ) -> None:
        """Write figures, each with the ending of its name in the report, and the report: `words` makes its
        text of the names of the pictures. The first figure is the picture."""
        from six_wheel.plotting.saving import render

        if self._plot is not None:
            render(figures[0][1], self._targets[self._plot])
        if self._report is not None and words is not None:
            pictures = [beside(self._report, ending) for ending, _ in figures]
            for path, (_, figure) in zip(pictures, figures, strict=True):
                render(figure, self._targets[path])
            text = words([path.name for path in pictures])
            with replacing(self._targets[self._report]) as temporary:
                temporary.write_text(text, encoding="utf-8")


def beside(report: Path, ending: str) -> Path:
    """Path of a picture of a report."""
    return report.with_name(f"{report.stem}{ending}.png")


@contextlib.contextmanager
def reporting(
    plot: Path | None, report: Path | None, sources: Sequence[Path | None], endings: Sequence[str] = ("",)
) -> Iterator[Pages | None]:
    """Context of a writer of picture and report, replaced if the block succeeds; None if neither is wanted.

    Raises `TableError` if one of them has an ending that cannot be, or would replace one of `sources`. Raises
    `ImportError` if what draws is not installed: at once, and not after a long run.
    """
    if plot is None and report is None:
        yield None
        return
    from six_wheel.plotting.saving import picture_path

    wanted = [] if plot is None else [picture_path(plot)]
    if report is not None:
        if report.suffix.lower() not in ENDINGS:
            raise TableError(f'{report}: the ending must be {" or ".join(ENDINGS)}, got "{report.suffix}"')
        first, *others = (beside(report, ending) for ending in endings)
        wanted += [report, *([] if plot == first else [first]), *others]  # the first one is what `plot` shows
    taken = [source for source in sources if source is not None]
    with contextlib.ExitStack() as stack:
        targets = {path: stack.enter_context(replacing(path, taken)) for path in wanted}
        yield Pages(plot, report, targets)


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; what is in a cell cannot break it."""
    return "\n".join([_row(heads), _row(["---"] * len(heads)), *map(_row, rows)])


def picture(words: str, name: str) -> str:
    """A picture in the same folder."""
    return f"![{words}](<{name}>)"


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", "<br>") for cell in cells) + " |"
