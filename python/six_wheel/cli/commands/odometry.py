"""`six-wheel odometry`: dead reckoning of a log."""

import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeAlias

import typer

from six_wheel.cli.log_options import (
    ExampleOption,
    LogReading,
    PlotOption,
    ReportOption,
    TruthOption,
    choose_with_logs,
)
from six_wheel.cli.names import PROGRAM
from six_wheel.cli.shared import Reading, grid, new_console, progress_bar, warn
from six_wheel.robot_description.named_rover import NamedRover

if TYPE_CHECKING:
    from six_wheel.log_odometry.results import Reckoned, ReckonSettings
Options: TypeAlias = Callable[[], dict[str, Any]]
"""Arguments of dead reckoning, refused if they are wrong once the files are known to be good."""


class Files(NamedTuple):
    """Files that are read beside the log, and written."""

    truth: TruthOption = None
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Poses, twists, covariances, residuals: .csv or .parquet; a record: .mcap; "
            "of several logs a folder, where a run that was stopped goes on.",
        ),
    ] = None
    plot: PlotOption = None
    report: ReportOption = None


class Estimate(NamedTuple):
    """Options of the estimated poses."""

    start: Annotated[
        tuple[float, float, float],
        typer.Option(metavar="X Y YAW", help="First pose [m, m, rad]."),
    ] = (0.0, 0.0, 0.0)
    speed_noise: Annotated[float | None, typer.Option(help="Of the wheels, as rim speed [m/s].")] = None
    steering_noise: Annotated[float | None, typer.Option(help="Of the steering angles [rad].")] = None
    slip_noise: Annotated[float | None, typer.Option(help="Along the wheels [m per root m].")] = None
    side_slip_noise: Annotated[float | None, typer.Option(help="Across the wheels [m per root m].")] = None
    robust: Annotated[
        bool, typer.Option("--robust", help="Give wheels that contradict the others less say.")
    ] = False
    inflate: Annotated[
        bool, typer.Option("--inflate", help="Widen the covariance where wheels disagree.")
    ] = False

    def settings(self, chosen: NamedRover, max_speed: float | None) -> "ReckonSettings":
        """Settings of dead reckoning: those of the parameter file, overridden by the arguments."""
        from six_wheel._core import Noise
        from six_wheel.log_odometry.results import ReckonSettings

        said = chosen.parameters
        noise = dict(said.noise) if said else {}
        for key in ("speed", "steering", "slip", "side_slip"):
            if (given := getattr(self, f"{key}_noise")) is not None:
                noise[key] = given
        options = dict(said.odometry) if said else {}
        if said and (dimensions := said.dimensions) is not None:
            options["dimensions"] = dimensions.tolist()  # a journal's key has their text
        options |= {"method": "robust"} if self.robust else {}
        options |= {"inflate": True} if self.inflate else {}
        options |= {} if max_speed is None else {"max_speed": max_speed}
        known, period = (said.known_gyroscope, said.gyroscope.get("period")) if said else (None, None)
        return ReckonSettings(Noise(**noise), options, self.start, known, period)


class ManyLogs(NamedTuple):
    """Options for several logs."""

    output_format: Annotated[
        str, typer.Option(metavar=".csv|.parquet", help="Of the tracks of several logs.")
    ] = ".csv"
    cluster: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Dask scheduler for several logs, as tcp://10.0.0.7:8786."),
    ] = None
    workers: Annotated[int | None, typer.Option(help="Processes for several logs; default one per core.")] = (
        None
    )


def odometry(
    rover: Annotated[
        str | None, typer.Argument(metavar="ROVER", help="Parameter file, or the name of a preset.")
    ] = None,
    log: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="LOG...",
            help="Table (.csv, .parquet), ROS 2 bag, or OptiOdom run; of several, or a folder, a track each.",
        ),
    ] = None,
    *,
    files: Files,
    example: ExampleOption = False,
    log_reading: LogReading,
    estimate: Estimate,
    segment: Annotated[
        float, typer.Option(help="Length of the stretches for the error per distance [m].")
    ] = 0.5,
    file: Reading,
    many: ManyLogs,
    chunk_rows: Annotated[int, typer.Option(help="Most rows in memory at a time.")] = 65_536,
) -> None:
    chosen, paths = choose_with_logs(rover, log or [], example, file)
    path = paths[0]

    def options() -> dict[str, Any]:
        return {
            "truth": files.truth,
            "log_options": log_reading.options(chosen),
            "settings": estimate.settings(chosen, log_reading.max_speed),
            "length": segment,
        }

    if len(paths) > 1 or (path.is_dir() and not (path / "metadata.yaml").exists()):
        _reckon_all(chosen, paths, files, many, options)
        return
    if many.cluster is not None:
        raise ValueError(f"--cluster is for several logs or a folder of them, got {path}")
    _reckon(chosen, path, files, options, chunk_rows)


def _reckon(chosen: NamedRover, path: Path, files: Files, options: Options, chunk_rows: int) -> None:
    """The track of one log."""
    # After the file of the rover is known to be good: Arrow takes its time.
    from six_wheel.cli.report.log_odometry import facts, judged, slipped, written
    from six_wheel.cli.report.markdown import reporting
    from six_wheel.log_odometry.run_log import reckon

    truth, output, plot, report = files
    sources = [chosen.path] if chosen.path else []
    with (
        progress_bar(f"reckoning {path.name}") as progress,
        reporting(plot, report, [path, truth, *sources]) as pages,
    ):

        def finish(result: "Reckoned") -> None:
            if pages is not None:
                from six_wheel.plotting.log_odometry import reckoning_figure

                figure = reckoning_figure(result, title=result.name)
                pages.write([("", figure)], lambda names: written(result, names[0]))

        result = reckon(
            chosen.rover,
            path,
            output,
            finish=finish,
            chunk_rows=chunk_rows,
            sources=sources,
            progress=progress,
            **options(),
        )
    warn(result.warnings)
    rows = [*facts(result), *slipped(result), *judged(result.evaluation)]
    written_files = [("results", output), ("picture", plot), ("report", report)]
    took = f"{result.elapsed:.3g} s, {result.rows / result.elapsed:,.0f} rows/s"
    new_console().print(grid([*rows, *written_files, ("took", took)]))


def _reckon_all(
    chosen: NamedRover, paths: list[Path], files: Files, many: ManyLogs, options: Options
) -> None:
    """A track for every log, and what failed; exit code 1 where some did."""
    from six_wheel.kinematics.errors import SuspiciousReadingsWarning
    from six_wheel.log_odometry.many_logs import FleetLog, reckon_all

    if files.output is None:
        raise ValueError(f"several logs need a folder for their tracks: give -o, got {len(paths)} paths")
    for option in ("plot", "report"):
        if getattr(files, option) is not None:
            raise ValueError(f"--{option} is for one log, got {paths[0]} and others")
    begin, done = time.monotonic(), list[FleetLog]()
    with warnings.catch_warnings(record=True) as caught, progress_bar("logs") as progress:
        warnings.simplefilter("always", SuspiciousReadingsWarning)
        for one in reckon_all(
            chosen.rover,
            paths,
            files.output,
            ending=many.output_format,
            cluster=many.cluster,
            workers=many.workers,
            progress=progress,
            **options(),
        ):
            done.append(one)
            if one.failure is not None:
                # A message about a file begins with it, as the worker sees it.
                why = one.failure.message.removeprefix(f"{one.path.resolve()}: ")
                print(f"{PROGRAM}: {one.path}: {why}", file=sys.stderr)
    warn([str(each.message) for each in caught])
    good = [one.summary for one in done if one.summary is not None]
    resumed, failed = sum(one.resumed for one in done), len(done) - len(good)
    errors = sorted(each["ate"] for each in good if each["ate"] is not None)
    rows: list[tuple[str, object]] = [
        ("logs", f"{len(done)}, {sum(each['rows'] for each in good):,} rows"),
        ("distance", f"{sum(each['distance'] for each in good):.6g} m"),
        ("ATE", f"{errors[len(errors) // 2]:.4f} m, the median of {len(errors)} logs" if errors else None),
        ("done before", resumed or None),
        ("failed", failed or None),
        ("tracks", files.output),
        ("took", f"{time.monotonic() - begin:.3g} s"),
    ]
    new_console().print(grid(rows))
    if failed:
        raise typer.Exit(1)
