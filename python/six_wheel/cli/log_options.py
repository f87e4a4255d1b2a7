"""Options of the commands that read logs, and the rover and log they mean."""

import csv
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from six_wheel.cli.shared import Reading, choose, several
from six_wheel.robot_description.named_rover import NamedRover

if TYPE_CHECKING:
    from six_wheel.logs.log_options import LogOptions

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
    columns: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME,NAME,...", help="Names of all columns in order, of a table without a header line."
        ),
    ] = None
    topic: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TOPIC[=MEANING]",
            help='Topic of a bag with joint states, or of numbers: "/enc/left=left [ticks]".',
        ),
    ] = None
    stamp_unit: Annotated[
        str | None, typer.Option(metavar="s|ms|us|ns|min|h|d", help="Unit of the times, if they do not say.")
    ] = None
    max_speed: Annotated[
        float | None, typer.Option(help="Fastest rim [m/s]; a longer step counts as none.")
    ] = None
    plausibility: Annotated[
        bool,
        typer.Option("--plausibility/--no-plausibility", help="Refuse readings that no rover has."),
    ] = True
    truth_topic: Annotated[str | None, typer.Option(help="Topic of a bag with the truth.")] = None

    def arguments(self) -> str:
        """The options that were given, as they are typed."""
        words = []
        for name, value in self._asdict().items():
            if value == self._field_defaults[name]:
                continue
            option = f"--{'no-' if value is False else ''}{name.replace('_', '-')}"
            values = [None] if isinstance(value, bool) else value if isinstance(value, list) else [value]
            for each in values:
                text = f"{each:g}" if isinstance(each, float) else str(each)
                quoted = f' "{text}"' if re.search(r"[\s\[,]", text) else f" {text}"
                words.append(option + ("" if each is None else quoted))
        return " ".join(words)

    def options(self, chosen: NamedRover) -> "LogOptions":
        """Options for reading a log: those of the parameter file, overridden by the arguments."""
        from six_wheel._core import Encoder
        from six_wheel.logs.log_options import LogOptions

        said = chosen.parameters
        counts = {key: getattr(self, key) for key in ("ticks_per_turn", "gear_ratio", "wraps_at")}
        counts = {key: value for key, value in counts.items() if value is not None}
        Encoder(**counts)  # refuses values that no encoder has
        odometry = said.odometry if said else {}
        given: dict[str, Any] = {"plausibility": self.plausibility and (said is None or said.plausibility)}
        for key in ("stamp_unit", "columns", "topics"):
            given[key] = getattr(said, key) if said else None
        if self.stamp_unit is not None:
            given["stamp_unit"] = self.stamp_unit
        if columns := self._columns():
            given["columns"] = columns
        if topics := several(self.topic, "=") if "=" in "".join(self.topic or ()) else several(self.topic):
            pairs = [text.partition("=") for text in topics]
            mapped = all(equals for _, equals, _ in pairs)
            given["topics"] = {topic: meaning for topic, _, meaning in pairs} if mapped else topics
        return LogOptions(
            self.log_format,
            self.readings,  # type: ignore[arg-type]
            (said.wheel_encoders if said else {})
            | counts
            | ({"increments": True} if self.increments else {}),
            said.steering_encoders if said else {},
            given["columns"] or {},
            given["topics"] or (),
            self.truth_topic,
            said.truth if said else {},
            said.gyroscope if said else {},
            said.base_frame_id if said else "",
            given["stamp_unit"],
            given["plausibility"],
            self.max_speed if self.max_speed is not None else odometry.get("max_speed"),
            odometry.get("max_gap"),
        )

    def _columns(self) -> "dict[str, str] | list[str]":
        """Headers with what to read them as, or the names of all columns."""
        if self.columns:
            if self.column:
                raise ValueError("columns must be left out with column, got both")
            return [name.strip() for text in self.columns for name in next(csv.reader([text]))]
        columns = {}
        for text in several(self.column, "="):
            header, equals, meaning = text.partition("=")
            if not (header and equals):
                raise ValueError(f'column must be HEADER=MEANING, such as "encL=left [ticks]", got "{text}"')
            columns[header] = meaning
        return columns


def choose_with_logs(
    rover: str | None, logs: list[Path], example: bool, reading: Reading
) -> tuple[NamedRover, list[Path]]:
    """The rover and the logs that are asked for; the run that comes along, and its rover, with --example."""
    if not example:
        if rover is None or not logs:
            raise ValueError("ROVER and LOG must be given, or --example")
        return choose(rover, reading), logs
    if logs:
        raise ValueError(f"LOG must be left out with --example, got {logs[0]}")
    from six_wheel.logs.optiodom import example_run, metadata_of

    run = example_run()
    return choose(str(metadata_of(run)) if rover is None else rover, reading), [run]
