"""Options of the commands that read logs, and the rover and log they mean."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

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
PlotOption = Annotated[Path | None, typer.Option(help="Picture: .png, .svg or .pdf.")]
ReportOption = Annotated[Path | None, typer.Option(help="Written report, .md, its pictures beside it.")]


class LogReading(NamedTuple):
    """Options for reading a log, for what it does not state itself."""

    log_format: Annotated[
        str | None,
        typer.Option(metavar="table|bag|optiodom|...", help="What the log is, if its name does not tell."),
    ] = None
    readings: Annotated[
        str | None,
        typer.Option(
            metavar="angles|speeds|ticks", help="What the columns of the wheels hold, if they do not say."
        ),
    ] = None
    ticks_per_turn: Annotated[
        float | None, typer.Option(help="Ticks of an encoder in one turn of the motor.")
    ] = None
    gear_ratio: Annotated[float | None, typer.Option(help="Turns of the motor for one of the wheel.")] = None
    wraps_at: Annotated[float | None, typer.Option(help="Where a reading begins again, such as 65536.")] = (
        None
    )
    increments: Annotated[bool, typer.Option("--increments", help="Rows count from the row before.")] = False
    column: Annotated[
        list[str] | None,
        typer.Option(
            metavar="HEADER=MEANING", help='An odd header, and what to read it as: "encL=left [ticks]".'
        ),
    ] = None
    topic: Annotated[list[str] | None, typer.Option(help="Topic of a bag with joint states.")] = None
    truth_topic: Annotated[str | None, typer.Option(help="Topic of a bag with the truth.")] = None

    def options(self, chosen: Chosen) -> "LogOptions":
        """Options for reading a log: those of the parameter file, overridden by the arguments."""
        from six_wheel._core import Encoder
        from six_wheel.logs.detect_reader import LogOptions

        said = chosen.parameters
        counts = {key: getattr(self, key) for key in ("ticks_per_turn", "gear_ratio", "wraps_at")}
        counts = {key: value for key, value in counts.items() if value is not None}
        Encoder(**counts)  # refuses values that no encoder has
        columns = {}
        for text in self.column or []:
            header, equals, meaning = text.partition("=")
            if not (header and equals and meaning):
                raise ValueError(f'column must be HEADER=MEANING, such as "encL=left [ticks]", got "{text}"')
            columns[header] = meaning
        return LogOptions(
            self.log_format,
            self.readings,  # type: ignore[arg-type]
            (said.wheel_encoders if said else {})
            | counts
            | ({"increments": True} if self.increments else {}),
            said.steering_encoders if said else {},
            columns,
            self.topic or (),
            self.truth_topic,
            said.truth if said else {},
            said.gyroscope if said else {},
            said.base_frame_id if said else "",
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
