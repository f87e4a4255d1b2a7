"""`six-wheel inspect`: the columns or topics of a log, and what to do with it next."""

from pathlib import Path
from typing import Annotated

import typer

from six_wheel.cli.log_options import LogReading
from six_wheel.cli.names import PROGRAM
from six_wheel.cli.shared import Reading, choose, grid, new_console, text_table, warn
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
    console.print(grid(list(found.facts.items())))
    if found.refusal is not None:
        print(f"is not read: {found.refusal}")
    warn(found.doubts)
    given = log_reading.arguments()
    if chosen is None:
        command = f"inspect {log} ROVER"
    elif found.refusal is None:
        command = f"odometry {rover} {log}"
    elif found.option:
        command, given = f"inspect {log} {rover}", f"{given} {found.option}"
    else:
        return
    print(f"next: {' '.join([PROGRAM, command, given.strip()]).rstrip()}")  # one line, to be pasted
