"""Pictures of a calibration before and after, and its written report."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from six_wheel.calibration.files import Calibrated, paths_of
from six_wheel.cli.report.markdown import CALIBRATION_PICTURES, Pages, picture
from six_wheel.plotting.tracks import residual_figure, track_figure


def before_and_after(done: Calibrated, title: str) -> Figure:
    """Picture of one run as dead-reckoned before and after, with the truth."""
    tracks, truth = paths_of(done, done.shown)
    return track_figure(tracks, truth, title=f"{title}, {done.logs[done.shown].name}")


def write_calibration(pages: Pages, done: Calibrated, title: str, output: Path | None) -> None:
    """Write the picture and the report of a calibration whose rover went to `output`."""
    windows = done.result.windows
    figures = [
        (CALIBRATION_PICTURES[0], before_and_after(done, title)),
        (CALIBRATION_PICTURES[1], residual_figure(windows.before, windows.after)),
    ]
    pages.write(figures, lambda names: _report(done, title, names, output))


def _report(done: Calibrated, title: str, names: Sequence[str], output: Path | None) -> str:
    """The report of the calibration with its pictures below the title."""
    head, _, rest = done.result.to_markdown(title=f"Calibration of {title}").partition("\n")
    run = done.logs[done.shown].name
    parts = [
        head,
        picture(f"{run} before and after", names[0]),
        picture("errors of the motion over windows", names[1]),
        rest.strip(),
    ]
    if np.any(done.result.sensor) or done.result.time_offset:
        x, y, yaw = done.result.sensor
        ahead = done.result.time_offset
        where = f"({x:.4f}, {y:.4f}) m, turned by {math.degrees(yaw):.3f}°"
        parts.append(
            f"What the truth follows sits at {where}; its clock is {ahead:.4f} s ahead of the log's."
        )
    if output is not None:
        parts.append(f"The calibrated rover is in `{output}`: `six-wheel odometry {output} LOG`.")
    if done.warnings:
        parts += ["## Warnings", "\n".join(f"- {warning}" for warning in done.warnings)]
    return "\n\n".join(parts) + "\n"
