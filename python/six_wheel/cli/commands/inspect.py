"""`six-wheel inspect`: the columns or topics of a log, and what to do with it next."""

from pathlib import Path
from typing import Annotated

import typer

from six_wheel.cli.log_options import LogReading
from six_wheel.cli.names import PROGRAM
from six_wheel.cli.shared import Chosen, Reading, choose, grid, new_console


def inspect(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="Table or ROS bag.")],
    rover: Annotated[
        str | None, typer.Argument(metavar="[ROVER]", help="Parameter file, or the name of a preset.")
    ] = None,
    *,
    log_reading: LogReading,
    file: Reading,
) -> None:
    from rich import box
    from rich.table import Table

    from six_wheel.cli.report.log_overview import overview

    chosen: Chosen | None = None if rover is None else choose(rover, file)
    options = None if chosen is None else log_reading.options(chosen)
    found = overview(log, None if chosen is None else chosen.rover, options)
    console = new_console()
    table = Table(box=box.SIMPLE)
    for head in ("column", "values", "seems to be"):
        table.add_column(head, overflow="fold")
    for column in found.columns:
        table.add_row(column.name, column.values, column.meaning)
    console.print(table)
    console.print(grid([*found.facts.items(), ("is not read", found.refusal)]))
    if chosen is None:
        console.print(f"next: {PROGRAM} inspect {log} ROVER")
    elif found.refusal is None:
        console.print(f"next: {PROGRAM} odometry {rover} {log}")
