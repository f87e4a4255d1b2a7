"""Common parts of the commands of `six-wheel`: the rover they are given, the console, progress, figures."""

import contextlib
import inspect
import math
import sys
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, get_type_hints

import typer

from six_wheel.cli.names import PROGRAM
from six_wheel.kinematics.errors import printable
from six_wheel.robot_description.named_rover import NamedRover, find_rover

if TYPE_CHECKING:
    from rich.console import Console

    from six_wheel._core import RockerBogie

SUSPENDED = (
    "perseverance",
    "curiosity",
    "rocky7",
    "open_source_rover",
)  # presets with their whole suspension
PROGRESS_AFTER = 1.0  # [s] what is over sooner needs no bar

RoverArgument = Annotated[
    str, typer.Argument(metavar="ROVER", help="Parameter file, URDF or xacro file, or the name of a preset.")
]
ResultsOption = Annotated[
    Path | None, typer.Option("-o", "--output", help="Where the results go: .csv, .parquet or .mcap.")
]
NodeOption = Annotated[
    str | None,
    typer.Option("--parameters-node", help="Node whose parameters to read, if the file has several."),
]
KindOption = Annotated[
    str | None,
    typer.Option(metavar="KIND", help="Kind or controller whose keys the file has, if unclear."),
]
RadiusOption = Annotated[
    float | None, typer.Option(help="Radius of the wheels [m], for a URDF that does not tell it.")
]

WRITTEN = (
    "output",
    "plot",
    "plot_speeds",
    "report",
    "export",
)  # parameters that name files to write


def with_options(command: Callable[..., None]) -> Callable[..., None]:
    """The command as typer has to see it: each field of its groups of options is an option of its own.

    A group is a `NamedTuple` whose fields are annotated as options are.
    """
    signature = inspect.signature(command)
    groups = {
        name: p.annotation for name, p in signature.parameters.items() if hasattr(p.annotation, "_fields")
    }
    flat: dict[str, inspect.Parameter] = {}
    for name, parameter in signature.parameters.items():
        group = groups.get(name)
        hints = {name: parameter.annotation} if group is None else get_type_hints(group, include_extras=True)
        for option, hint in hints.items():
            default = parameter.default if group is None else group._field_defaults[option]
            flat[option] = inspect.Parameter(option, parameter.KEYWORD_ONLY, default=default, annotation=hint)

    def run(**given: Any) -> None:
        from six_wheel.kinematics.objects.whole_files import together

        outputs = {name: given[name] for name in WRITTEN if given.get(name) is not None}
        sources = [path for name in given.keys() - outputs for path in _files(given[name])]
        _check_outputs(outputs, sources)
        for name, group in groups.items():
            given[name] = group(*(given.pop(option) for option in group._fields))
        with together(sources):
            command(**given)

    run.__signature__ = signature.replace(parameters=list(flat.values()))  # type: ignore[attr-defined]
    run.__annotations__ = {name: parameter.annotation for name, parameter in flat.items()}
    run.__name__ = command.__name__
    return run


def _check_outputs(outputs: dict[str, Path], sources: Sequence[Path]) -> None:
    """Refuse files to be written that are read or written twice, by the options that name them.

    A folder that is there is for several files.
    """
    from six_wheel.kinematics.errors import TableError
    from six_wheel.kinematics.objects.whole_files import check_source, same_file

    files = {name: path for name, path in outputs.items() if not path.is_dir()}
    for name, path in files.items():
        check_source(path, path, sources)
        for other, one in files.items():
            if other != name and same_file(one, path):
                options = f"--{name} and --{other}".replace("_", "-")
                raise TableError(f"{path}: {options} must be two files")


def several(given: Sequence[str] | None, sign: str = "") -> list[str]:
    """Values of an option that is given several times, or once with commas between them.

    A text with commas in which a part lacks the sign, as ``key=[1,2]`` lacks a second ``=``, is one value.
    """
    found = []
    for text in given or ():
        parts = [part.strip() for part in text.split(",")]
        found += [part for part in parts if part] if all(sign in part for part in parts) else [text]
    return found


def _files(value: object) -> list[Path]:
    """Files that a value of an argument names."""
    several = value if isinstance(value, list | tuple) else [value]
    paths = [Path(each) for each in several if isinstance(each, str | Path)]
    found = []
    for path in paths:
        with contextlib.suppress(OSError, ValueError):  # a text that can be no path
            if path.is_file():
                found.append(path)
    return found


def warn(warnings: Sequence[object]) -> None:
    """Print warnings, a line each, on the standard error."""
    for warning in warnings:
        print(f"{PROGRAM}: warning: {printable(str(warning))}", file=sys.stderr)


class Reading(NamedTuple):
    """Options for reading a rover's file, for what it does not state itself."""

    node: NodeOption = None
    kind: KindOption = None
    wheel_radius: RadiusOption = None


def choose(argument: str, reading: Reading = Reading()) -> NamedRover:  # noqa: B008 - it is immutable
    """The rover of a parameter file, a robot description or the metadata of a run, or a preset."""
    path = Path(argument)
    if path.name.endswith("_metadata.csv") and reading.wheel_radius is None:
        from six_wheel.logs.optiodom import read_rover

        return NamedRover(read_rover(path), path.stem, path)
    return find_rover(argument, "ROVER must be a parameter file or a preset", **reading._asdict())


def choose_suspension(argument: str, reading: Reading = Reading()) -> "tuple[RockerBogie, str]":  # noqa: B008
    """The suspension of a preset, a parameter file or a robot description, and what to call it."""
    if argument in SUSPENDED:
        from six_wheel._core import RockerBogie

        return RockerBogie.preset(argument), argument
    chosen = choose(argument, reading)
    if chosen.rover.suspension is None:
        raise ValueError(
            f"ROVER must have a suspension, as the kind rocker_bogie, the URDF of one, or one of "
            f'{", ".join(SUSPENDED)}; got "{argument}"'
        )
    return chosen.rover.suspension, chosen.name


def new_console(stderr: bool = False) -> "Console":
    """Console on the standard output, or on the standard error."""
    from rich.console import Console

    stream = sys.stderr if stderr else sys.stdout
    # Names of joints and files may hold square brackets; a file or pipe has no width to keep to.
    return Console(stderr=stderr, markup=False, highlight=False, width=None if stream.isatty() else 120)


@contextlib.contextmanager
def progress_bar(what: str) -> Iterator[Callable[..., None]]:
    """A function to call with how much of how much is done, and what; it draws a bar once that is long."""
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    console = new_console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    task = bar.add_task(what, total=None)
    begin = time.monotonic()

    def update(done: int, total: int, doing: str | None = None) -> None:
        bar.update(task, completed=done, total=total, description=doing or what)
        if time.monotonic() - begin > PROGRESS_AFTER:
            bar.start()  # a second call does nothing

    try:
        yield update
    finally:
        if bar.live.is_started:  # some versions end even an unseen bar with an empty line
            bar.stop()


def grid(rows: Sequence[tuple[str, object]]) -> Any:
    """A table of names and values; what is None is left out."""
    from rich.table import Table

    grid = Table.grid(padding=(0, 2))
    grid.add_column(style="bold", no_wrap=True)
    grid.add_column(overflow="fold")
    for name, value in rows:
        if value is not None:
            grid.add_row(name, str(value))
    return grid


def text_table(
    heads: Sequence[str], rows: Iterable[Sequence[str]], *, right: Collection[str] = (), **options: Any
) -> Any:
    """A table of text; the columns of `right` are set to the right. `options` are those of rich."""
    from rich.table import Table

    table = Table(**options)
    for head in heads:
        table.add_column(head, justify="right" if head in right else "left", overflow="fold")
    for row in rows:
        table.add_row(*row)
    return table


def angle_text(radians: float) -> str:
    """An angle in both units."""
    return f"{radians:.4g} rad ({math.degrees(radians):.1f}°)"
