"""`six-wheel odometry`: dead reckoning of a log."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from six_wheel.cli.log_options import (
    ColumnOption,
    ExampleOption,
    FormatOption,
    GearOption,
    ModulusOption,
    PerSampleOption,
    PlotOption,
    ReadingOption,
    ReportOption,
    ResolutionOption,
    TopicOption,
    TruthOption,
    TruthTopicOption,
    choose_with_logs,
    log_options,
)
from six_wheel.cli.shared import (
    AsOption,
    Chosen,
    NodeOption,
    RadiusOption,
    Reading,
    grid,
    new_console,
    progress_bar,
)
from six_wheel.cli.words import PROGRAM

if TYPE_CHECKING:
    from six_wheel.reckoning.running import Reckoned

NOISE = {
    "speed_noise": "speed",
    "steering_noise": "steering",
    "slip_noise": "slip",
    "side_slip_noise": "side_slip",
}


def odometry(
    rover: Annotated[
        str | None, typer.Argument(metavar="ROVER", help="Parameter file, or the name of a preset.")
    ] = None,
    log: Annotated[
        Path | None,
        typer.Argument(metavar="LOG", help="Table (.csv, .parquet), ROS 2 bag, or OptiOdom run."),
    ] = None,
    truth: TruthOption = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="Poses, twists, covariances, residuals: .csv or .parquet; a record: .mcap."
        ),
    ] = None,
    plot: PlotOption = None,
    report: ReportOption = None,
    example: ExampleOption = False,
    format: FormatOption = None,
    reading: ReadingOption = None,
    resolution: ResolutionOption = None,
    gear: GearOption = None,
    modulus: ModulusOption = None,
    per_sample: PerSampleOption = False,
    column: ColumnOption = None,
    topic: TopicOption = None,
    truth_topic: TruthTopicOption = None,
    start: Annotated[
        tuple[float, float, float],
        typer.Option(metavar="X Y YAW", help="First pose [m, m, rad]."),
    ] = (0.0, 0.0, 0.0),
    speed_noise: Annotated[float | None, typer.Option(help="Of the wheels, as rim speed [m/s].")] = None,
    steering_noise: Annotated[float | None, typer.Option(help="Of the steering angles [rad].")] = None,
    slip_noise: Annotated[float | None, typer.Option(help="Along the wheels [m per root m].")] = None,
    side_slip_noise: Annotated[float | None, typer.Option(help="Across the wheels [m per root m].")] = None,
    robust: Annotated[
        bool, typer.Option("--robust", help="Give wheels that contradict the others less say.")
    ] = False,
    inflate: Annotated[
        bool, typer.Option("--inflate", help="Widen the covariance where wheels disagree.")
    ] = False,
    length: Annotated[float, typer.Option(help="Of the stretches for the error per distance [m].")] = 0.5,
    node: NodeOption = None,
    as_: AsOption = None,
    wheel_radius: RadiusOption = None,
    chunk_rows: Annotated[int, typer.Option(help="Most rows in memory at a time.")] = 65_536,
) -> None:
    given = dict(locals())
    chosen, (path,) = choose_with_logs(
        rover, [] if log is None else [log], example, Reading(node, as_, wheel_radius)
    )
    # After the file of the rover is known to be good: Arrow takes its time.
    from six_wheel.reckoning.running import reckon
    from six_wheel.report.pages import reporting
    from six_wheel.report.reckoning import facts, judged, slipped, written

    sources = [chosen.path] if chosen.path else []
    with (
        progress_bar(f"reckoning {path.name}") as progress,
        reporting(plot, report, [path, truth, *sources]) as pages,
    ):

        def finish(result: "Reckoned") -> None:
            if pages is not None:
                from six_wheel.plot.reckoning import reckoning_figure

                figure = reckoning_figure(result, title=result.name)
                pages.write([("", figure)], lambda names: written(result, names[0]))

        result = reckon(
            chosen.rover,
            path,
            output,
            truth=truth,
            finish=finish,
            log_options=log_options(chosen, given),
            settings=_settings(chosen, given),
            length=length,
            chunk_rows=chunk_rows,
            sources=sources,
            progress=progress,
        )
    for warning in result.warnings:
        print(f"{PROGRAM}: warning: {warning}", file=sys.stderr)
    rows = [*facts(result), *slipped(result), *judged(result.evaluation)]
    files = [("results", output), ("picture", plot), ("report", report)]
    took = f"{result.elapsed:.3g} s, {result.rows / result.elapsed:,.0f} rows/s"
    new_console().print(grid([*rows, *files, ("took", took)]))


def _settings(chosen: Chosen, given: dict[str, Any]) -> Any:
    """How to reckon: what the parameter file says, and over it the arguments."""
    from six_wheel._core import Noise
    from six_wheel.reckoning.running import Settings

    noise = dict(chosen.parameters.noise) if chosen.parameters else {}
    noise |= {key: given[option] for option, key in NOISE.items() if given[option] is not None}
    options = dict(chosen.parameters.odometry) if chosen.parameters else {}
    options |= {"method": "robust"} if given["robust"] else {}
    options |= {"inflate": True} if given["inflate"] else {}
    return Settings(Noise(**noise), options, given["start"])
