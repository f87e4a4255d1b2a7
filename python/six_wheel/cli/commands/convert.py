"""`six-wheel convert`: a rover as another kind of file, a record or a rover as a layout of viewers."""

from pathlib import Path
from typing import Annotated

import typer

from six_wheel.cli.shared import Reading, choose
from six_wheel.robot_description.missing_files import no_file
from six_wheel.robot_description.named_rover import NamedRover

ROVERS = (".yaml", ".yml", ".urdf")


def convert(
    rover: Annotated[
        str, typer.Argument(metavar="ROVER", help="Parameter file, URDF, name of a preset, or a record.")
    ],
    output: Annotated[
        Path,
        typer.Argument(
            metavar="OUTPUT",
            help="The rover as .yaml or .urdf; how viewers show its records as .json (Foxglove) or .rbl "
            "(Rerun); of a record .rrd (the record for Rerun, with its layout).",
        ),
    ],
    *,
    reading: Reading,
) -> None:
    if output.suffix.lower() in ROVERS:
        print(_write_rover(choose(rover, reading), output))
    else:
        print(_write_layout(rover, reading, output))


def _write_rover(chosen: NamedRover, target: Path) -> Path:
    """Write a rover as a parameter file, with all else that its file says, or as a URDF; where it is."""
    if target.suffix.lower() == ".urdf":
        chosen.rover.save(target)
    elif chosen.parameters is None:
        chosen.rover.save(target, limits=chosen.limits)
    else:
        from six_wheel.control_loop.settings import own_text
        from six_wheel.kinematics.objects.whole_files import replacing

        with replacing(target) as temporary:
            temporary.write_text(own_text(chosen.parameters), encoding="utf-8")
    return target.resolve()


def _write_layout(rover: str, reading: Reading, target: Path) -> Path:
    """Write a layout for the rover of a parameter file, a preset or a record; where it is."""
    from six_wheel.logs.mcap import layouts

    record = Path(rover) if Path(rover).suffix.lower() == ".mcap" else None
    if record is None:
        chosen = choose(rover, reading)
        shown = chosen.rover
    else:
        from six_wheel.control_loop.replay.rerun import settings_of
        from six_wheel.logs.mcap import Record

        if not record.is_file():
            raise ValueError(no_file(record))
        shown = settings_of(Record(record)).rover
    layouts.write(target, shown, record)
    return target.resolve()
