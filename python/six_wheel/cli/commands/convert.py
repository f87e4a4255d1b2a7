"""`six-wheel convert`: a rover as another kind of file, a record or a rover as a layout of viewers."""

from pathlib import Path
from typing import Annotated

import typer

from six_wheel.cli.shared import Reading, choose
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
    from six_wheel.logs.writing import replacing

    with replacing(target, [chosen.path] if chosen.path else []) as temporary:
        if target.suffix.lower() == ".urdf":
            chosen.rover.save(temporary)
        elif chosen.parameters is not None:
            from six_wheel.control_loop.settings import own_text

            temporary.write_text(own_text(chosen.parameters), encoding="utf-8")
        else:
            chosen.rover.save(temporary, limits=chosen.limits)
    return target.resolve()


def _write_layout(rover: str, reading: Reading, target: Path) -> Path:
    """Write a layout for the rover of a parameter file, a preset or a record; where it is."""
    from six_wheel.logs.mcap import layouts
    from six_wheel.logs.writing import replacing

    record = Path(rover) if Path(rover).suffix.lower() == ".mcap" else None
    if record is None:
        chosen = choose(rover, reading)
        shown, source = chosen.rover, chosen.path
    else:
        from six_wheel.control_loop.replay.rerun import settings_of
        from six_wheel.logs.mcap import Record

        if not record.is_file():
            raise ValueError(f"{record}: no such file")
        shown, source = settings_of(Record(record)).rover, record
    layouts.check(target, record)
    with replacing(target, [source] if source else []) as temporary:
        layouts.write(temporary, shown, record)
    return target.resolve()
