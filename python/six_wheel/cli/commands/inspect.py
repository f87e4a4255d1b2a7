"""`six-wheel inspect`: the columns or topics of a log, and what to do with it next."""

from pathlib import Path
from typing import Annotated

import typer

from six_wheel.cli.log_options import LogReading
from six_wheel.cli.names import PROGRAM
from six_wheel.cli.shared import Reading, choose, grid, new_console, text_table
from six_wheel.robot_description.named_rover import NamedRover


def inspect(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="Table or ROS bag.")],
    rover: Annotated[
        str | None, typer.Argument(metavar="[ROVER]", help="Parameter file, or the name of a preset.")
    ] = None,
    *,
    log_reading: LogReading,
    file: Reading,
) -> None:
    from rich.box import SIMPLE

    from six_wheel.cli.report.log_overview import overview

    chosen: NamedRover | None = None if rover is None else choose(rover, file)
    options = None if chosen is None else log_reading.options(chosen)
    found = overview(log, None if chosen is None else chosen.rover, options)
    console = new_console()
    rows = [(column.name, column.values, column.meaning) for column in found.columns]
    console.print(text_table(("column", "values", "seems to be"), rows, box=SIMPLE))
    console.print(grid([*found.facts.items(), ("is not read", found.refusal)]))
    if chosen is None:
        console.print(f"next: {PROGRAM} inspect {log} ROVER")
    elif found.refusal is None:
        console.print(f"next: {PROGRAM} odometry {rover} {log}")
