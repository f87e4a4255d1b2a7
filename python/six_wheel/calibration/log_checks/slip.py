"""Large slides in a drive, which a fit is better off without."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from six_wheel.calibration.drives import Drive
from six_wheel.calibration.estimates import timed_path
from six_wheel.calibration.fitting import solve
from six_wheel.calibration.model import Model
from six_wheel.calibration.problem import Problem
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry.copies import cut
from six_wheel.log_odometry.evaluation.slip import Stretch, lost_stretches, merged
from six_wheel.logs.recordings import WheelLog
from six_wheel.robot_description.dimensions import size

# Sizes of the rover that a slide is at least to be cut out: smaller ones a robust loss bears,
LARGE = 1.5
# unless they last for so long [s]: a steering joint that lags, a corner that scrubs is over before.
LASTING = 1.75
# Least error of a slide, as a share of a usual motion: under a fit, dimensions err by far less.
LEAST = 0.1
# Left out on either side of a slide [s]: where it begins is known to half a window.
MARGIN = 0.5
FEWEST_ROWS = 10


@dataclass(frozen=True)
class Slip:
    """Stretches of slip that were left out of one log."""

    number: int
    name: str
    part: int
    parts: int
    stretches: tuple[Stretch, ...]

    def __str__(self) -> str:
        when = ", ".join(map(str, self.stretches))
        slid = sum(one.distance for one in self.stretches)
        where = f"part {self.part} of {self.parts} of {self.name}"
        return f"slip in {where} ({when}, {slid:.2g} m): left out of the fit"


def slipped(problem: Problem, records: Sequence[WheelLog], parts: int) -> list[Slip]:
    """Large slides in the drives of a problem, under a fit of it that forgets them.

    The first fit nearly does: what it finds bends it still, and hides a part of itself. The second one has no
    windows in which there may be slip.
    """
    model = problem.model
    problem = replace(problem, loss="cauchy")
    values = solve(problem).values
    suspects = [_lost(model, drive, values) for drive in problem.drives]
    if any(suspects):
        rest = [_outside(drive, lost) for drive, lost in zip(problem.drives, suspects, strict=True)]
        if rest := [drive for drive in rest if len(drive.rows)]:
            values = solve(replace(problem, drives=rest), values).values
    reach = size(model.nominal)
    found = []
    for drive, log in zip(problem.drives, records, strict=True):
        lost = _lost(model, drive, values)
        stretches = tuple(
            one for one in lost if one.distance > LARGE * reach or one.end - one.start > LASTING
        )
        if stretches:
            edges = np.linspace(log.stamps[0], log.stamps[-1], parts + 1)
            longest = max(stretches, key=lambda one: one.distance)
            middle = (longest.start + longest.end) / 2.0
            part = int(np.clip(np.searchsorted(edges, middle), 1, parts))
            found.append(Slip(drive.number, drive.name, part, parts, stretches))
    return found


def _lost(model: Model, drive: Drive, values: Floats) -> tuple[Stretch, ...]:
    if not (drive.truth.has_positions and drive.truth.has_yaw):
        return ()  # a motion needs both
    return lost_stretches(*timed_path(model, drive, values), size(model.nominal), LEAST)


def _outside(drive: Drive, stretches: Sequence[Stretch]) -> Drive:
    """The drive without the windows that see one of these stretches."""
    first, last = drive.stamps[drive.rows].T
    kept = np.ones(len(drive.rows), dtype=bool)
    for start, end in merged(stretches, MARGIN):
        kept &= (last <= start) | (first >= end)
    arrays = {name: getattr(drive, name)[kept] for name in ("rows", "middles", "lengths", "blocks")}
    return replace(drive, **arrays)


def clean(
    log: WheelLog, stretches: Sequence[Stretch], ready: Callable[[WheelLog], Drive], session: str
) -> list[tuple[WheelLog, Drive]]:
    """Pieces of a log between its slides, ready to be fitted; each piece begins where the truth is."""
    spans = merged(stretches, MARGIN)
    begins, ends = [-np.inf, *(end for _, end in spans)], [*(start for start, _ in spans), np.inf]
    pieces = []
    for begin, end in zip(begins, ends, strict=True):
        rows = slice(*np.searchsorted(log.stamps, (begin, end)).tolist())
        if len(log.stamps[rows]) < FEWEST_ROWS:
            continue
        name = f"{log.name or session} from {log.stamps[rows][0]:.1f} s to {log.stamps[rows][-1]:.1f} s"
        piece = replace(cut(log, rows), name=name, session=session)
        try:
            pieces.append((piece, ready(piece)))
        except ValueError:
            continue  # it stands still there, or its truth is not known
    return pieces
