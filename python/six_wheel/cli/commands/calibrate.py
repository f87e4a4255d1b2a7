"""`six-wheel calibrate`: a rover's true dimensions from its logs."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from six_wheel.cli.log_options import ExampleOption, LogReading, PlotOption, ReportOption, choose_with_logs
from six_wheel.cli.shared import Reading, grid, new_console, progress_bar, several, text_table, warn

if TYPE_CHECKING:
    from six_wheel.calibration.files import Calibrated


class FitOptions(NamedTuple):
    """Options of the fit."""

    parameters: Annotated[
        list[str] | None,
        typer.Option(
            metavar="auto|NAME,NAME,...",
            help="What to find: wheel_radius, wheel_radii, track_width, wheelbase, steering_offset, ... "
            "auto, the default, takes what predicts runs best that were not fitted.",
        ),
    ] = None
    loss: Annotated[
        str,
        typer.Option(
            metavar="auto|soft_l1|linear|huber|cauchy",
            help="How much stretches count in which it slipped; auto leaves long ones out.",
        ),
    ] = "auto"
    segment: Annotated[
        list[str] | None,
        typer.Option(metavar="LENGTH,...", help="Length of the stretches that are compared [m], or several."),
    ] = None
    confidence: Annotated[float, typer.Option(help="Of the intervals.")] = 0.95
    cross_validation: Annotated[
        bool, typer.Option(help="Leave out one session, run or part after another, and predict it.")
    ] = True
    max_time_offset: Annotated[
        float, typer.Option(help="Largest time offset looked for, with time_offset in --parameters [s].")
    ] = 0.5
    cluster: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Dask scheduler that fits, as tcp://10.0.0.7:8786."),
    ] = None
    workers: Annotated[
        int | None, typer.Option(help="Processes that fit; default one, one per core from eight logs on.")
    ] = None

    def of_calibrate(self) -> dict[str, Any]:
        """Arguments of `calibrate`."""
        names = several(self.parameters) if self.parameters else ["auto"]
        options = self._asdict() | {"parameters": "auto" if names == ["auto"] else names}
        del options["segment"]
        return options | {"window": [_length(text) for text in several(self.segment)] or None}


def _length(text: str) -> float:
    """A length of stretches [m]."""
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"--segment must be a length [m], or several, got {text!r}") from None


def calibrate(
    rover: Annotated[
        str | None, typer.Argument(metavar="ROVER", help="Parameter file, or the name of a preset.")
    ] = None,
    logs: Annotated[
        list[Path] | None,
        typer.Argument(metavar="LOG...", help="Tables (.csv, .parquet), ROS 2 bags, or OptiOdom runs."),
    ] = None,
    truth: Annotated[
        list[Path] | None,
        typer.Option(
            help="Where the rover really was: a table with time, x, y and yaw (or a quaternion), or a bag. "
            "Once for all logs, or once for each in their order; not needed if the logs say it themselves."
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="The calibrated rover, a parameter file ready to use: .yaml."),
    ] = None,
    plot: PlotOption = None,
    report: ReportOption = None,
    example: ExampleOption = False,
    *,
    fit: FitOptions,
    log_reading: LogReading,
    file: Reading,
) -> None:
    chosen, paths = choose_with_logs(rover, list(logs or []), example, file)
    # After the file of the rover is known to be good: SciPy takes its time.
    from six_wheel.calibration.files import calibrate_files
    from six_wheel.cli.report.markdown import CALIBRATION_PICTURES, reporting

    title = chosen.name.removesuffix("_metadata")
    sources = [*paths, *(truth or []), *([chosen.path] if chosen.path else [])]
    with (
        progress_bar("calibrating") as progress,
        reporting(plot, report, sources, CALIBRATION_PICTURES) as pages,
    ):

        def finish(done: "Calibrated") -> None:
            if pages is not None:
                from six_wheel.cli.report.calibration import write_calibration

                write_calibration(pages, done, title, output)

        done = calibrate_files(
            chosen.rover,
            paths,
            output,
            parameters=chosen.parameters,
            truths=truth or [],
            finish=finish,
            log_options=log_reading.options(chosen),
            options=fit.of_calibrate(),
            progress=progress,
        )
    warn(done.warnings)
    _show(done, [("calibrated rover", output), ("picture", plot), ("report", report)])


def _show(done: "Calibrated", written: list[tuple[str, Path | None]]) -> None:
    """The values, what could not be found, and the errors before and after."""
    from six_wheel.calibration.files import interval

    result, console = done.result, new_console()
    if result.parameters:
        heads = ("parameter", "nominal", "calibrated", f"{100 * result.confidence:g} % interval", "unit")
        rows = [
            (one.name, f"{one.nominal:.6g}", f"{one.value:.6g}", interval(one), one.unit)
            for one in result.parameters
        ]
        console.print(_table(heads, rows))
    else:
        console.print(
            "No set of parameters predicts better than the nominal dimensions: the rover stays as it is."
        )
    if not result.converged:
        console.print("The fit did not settle: do not trust these values.")
    for message in (*result.slips, *result.observability.messages):
        console.print(f"- {message}")
    for unit, what in (("m", "ATE"), ("rad", "heading")):
        runs = [
            (run.name, f"{run.distance:.2f}", f"{run.before:.4f}", f"{run.after:.4f}")
            for run in result.runs
            if run.unit == unit
        ]
        if runs:
            errors = f"{what} nominal [{unit}]", f"calibrated [{unit}]"
            console.print(_table(("run", "distance [m]", *errors), runs))
    console.print(grid([*_predicted(done), *written]))


def _predicted(done: "Calibrated") -> list[tuple[str, object]]:
    """Errors where it was not fitted."""
    checked = done.result.cross_validation
    if checked is None:
        return [("cross-validation", None)]
    best = next((one for one in checked.candidates if one.parameters == done.result.chosen), None)
    if best is None:
        return []
    before, after = checked.nominal.mean(), best.errors.mean()
    errors = f"{before:.4f} {checked.unit} nominal, {after:.4f} {checked.unit} calibrated"
    what = f"{errors}, mean over {len(checked.folds)} {checked.kind}s"
    return [
        ("cross-validation", f"{what}, each predicted by a fit without it"),
        ("chosen", ", ".join(done.result.chosen) or "nominal dimensions"),
    ]


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> Any:
    from rich.box import SIMPLE

    return text_table(heads, rows, right={*heads[1:]} - {"unit"}, box=SIMPLE)
