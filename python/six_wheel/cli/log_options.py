"""Options of the commands that read logs, and the rover and log they mean."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from six_wheel.cli.shared import Chosen, Reading, choose

if TYPE_CHECKING:
    from six_wheel.logs.detect_reader import LogOptions

TruthOption = Annotated[
    Path | None,
    typer.Option(
        help="Where the rover really was: a table with time, x, y and yaw (or a quaternion), or a bag. "
        "Not needed if the log says it itself."
    ),
]
ExampleOption = Annotated[bool, typer.Option("--example", help="Use the recorded run that comes along.")]
FormatOption = Annotated[
    str | None,
    typer.Option(metavar="table|bag|optiodom|...", help="What the log is, if its name does not tell."),
]
ReadingOption = Annotated[
    str | None,
    typer.Option(
        metavar="angle|speed|ticks", help="What the columns of the wheels hold, if they do not say."
    ),
]
ResolutionOption = Annotated[
    float | None, typer.Option(help="Counts of an encoder in one turn of the motor.")
]
GearOption = Annotated[float | None, typer.Option(help="Turns of the motor for one of the wheel.")]
ModulusOption = Annotated[float | None, typer.Option(help="Where a reading begins again, such as 65536.")]
PerSampleOption = Annotated[bool, typer.Option("--per-sample", help="Rows count from the row before.")]
ColumnOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="HEADER=MEANING", help='An odd header, and what to read it as: "encL=left [ticks]".'
    ),
]
TopicOption = Annotated[list[str] | None, typer.Option(help="Topic of a bag with joint states.")]
TruthTopicOption = Annotated[str | None, typer.Option(help="Topic of a bag with the truth.")]
PlotOption = Annotated[Path | None, typer.Option(help="Picture: .png, .svg or .pdf.")]
ReportOption = Annotated[Path | None, typer.Option(help="Written report, .md, its pictures beside it.")]


def log_options(chosen: Chosen, given: dict[str, Any]) -> "LogOptions":
    """Options for reading a log: those of the parameter file, overridden by the arguments of a command."""
    from six_wheel._core import Encoder
    from six_wheel.logs.detect_reader import LogOptions

    encoders = dict(chosen.parameters.encoders) if chosen.parameters else {}
    counts = {key: given[key] for key in ("resolution", "gear", "modulus") if given[key] is not None}
    Encoder(**counts)  # refuses values that no encoder has
    encoders |= counts | ({"per_sample": True} if given["per_sample"] else {})
    columns = {}
    for text in given["column"] or []:
        header, equals, meaning = text.partition("=")
        if not (header and equals and meaning):
            raise ValueError(f'column must be HEADER=MEANING, such as "encL=left [ticks]", got "{text}"')
        columns[header] = meaning
    return LogOptions(
        given["format"],
        given["reading"],
        encoders,
        chosen.parameters.steering_encoders if chosen.parameters else {},
        columns,
        given["topic"] or (),
        given["truth_topic"],
        chosen.parameters.truth if chosen.parameters else {},
        chosen.parameters.gyroscope if chosen.parameters else {},
        chosen.parameters.base_frame_id if chosen.parameters else "",
    )


def choose_with_logs(
    rover: str | None, logs: list[Path], example: bool, reading: Reading
) -> tuple[Chosen, list[Path]]:
    """The rover and the logs that are asked for; the run that comes along, and its rover, with --example."""
    if not example:
        if rover is None or not logs:
            raise ValueError("ROVER and LOG must be given, or --example")
        return choose(rover, reading), logs
    if logs:
        raise ValueError(f"LOG must be left out with --example, got {logs[0]}")
    from six_wheel.logs.detect_reader import example_run, metadata_of

    run = example_run()
    return choose(str(metadata_of(run)) if rover is None else rover, reading), [run]
