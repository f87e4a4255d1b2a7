"""What no fit can mend: logs that fit far better if something about them is read another way, and slip."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from six_wheel._core import Rover
from six_wheel.calibration.drives import Drive
from six_wheel.calibration.fitting import Problem, Solution, solve
from six_wheel.calibration.model import Model
from six_wheel.calibration.values import timed_path
from six_wheel.evaluation.slip import Stretch, lost_stretches, merged
from six_wheel.logs.recordings import Log
from six_wheel.odometry.dimensions import size
from six_wheel.poses import Floats

# How much better another reading must fit than the one given, nominal dimensions both.
FAR_BETTER = 3.0
# A place counts as the same from which this share of the size is missing.
SAME_PLACE = 0.05
# Shares of a bound within which a value is at it.
AT_BOUND = 1e-6
# A direction known no better than to this share of what is plausible.
HARDLY = 0.1
# Sizes of the rover that a slide is at least to be cut out: smaller ones a robust loss bears,
LARGE = 1.5
# unless they last for so long [s]: a steering joint that lags, a corner that scrubs is over before.
LASTING = 1.75
# By what share of a usual motion a slide errs at least: under a fit, dimensions err by far less.
LEAST = 0.1
# Left out on either side of a slide [s]: where it begins is known to half a window.
MARGIN = 0.5
FEWEST_ROWS = 10

Reading = tuple[str, str, Callable[[Drive], Drive]]

FACTORS = (
    (2.0, "a gear or resolution is taken twice, or a radius for a diameter"),
    (0.5, "a gear of 2 is missing, or a diameter is taken for a radius"),
    (4.0, "edges are counted four times a tick"),
    (0.25, "ticks are a quarter of what they are"),
    (math.tau, "turns are taken for radians"),
    (math.radians(1.0), "degrees are taken for radians"),
)


def mistaken(rover: Rover, drives: Sequence[Drive]) -> list[str]:
    """What is probably wrong with the logs or the rover, and the remedy; nothing if they fit as they are.

    Every suspicion is tried: sides swapped, wheels that count backwards, factors of two, degrees for radians.
    """
    model = Model(rover, [])
    nothing = model.start

    def misfit(change: Callable[[Drive], Drive] | None) -> float:
        squares: list[Floats] = []
        for drive in drives:
            errors, _ = model.errors(drive if change is None else change(drive), nothing)
            squares.append(np.sum(errors * errors * (1.0, 1.0, size(rover) ** 2), axis=1))
        return math.sqrt(float(np.median(np.concatenate(squares))))

    given = misfit(None)
    tried = [(misfit(change), what, remedy) for what, remedy, change in _readings(rover)]
    found, what, remedy = min(tried, key=lambda one: one[0], default=(math.inf, "", ""))
    if found * FAR_BETTER > given:
        return []
    return [f"the drives fit far better ({given:.3g} m to {found:.3g} m a window) if {what}: {remedy}"]


def _readings(rover: Rover) -> Iterator[Reading]:
    """Other ways to read a log: what would be so, the remedy, and how a drive reads then."""

    def factor(by: float) -> Callable[[Drive], Drive]:
        return lambda drive: replace(drive, speeds=drive.speeds * by)

    for by, why in FACTORS:
        remedy = f"{why}; check resolution and gear of the encoders, and the unit of the columns"
        yield f"the wheels turn {by:.3g} times as far", remedy, factor(by)
    yield (
        "all wheels count the other way round",
        "give the encoders a negative gear",
        factor(-1.0),
    )
    for number, name in enumerate(rover.wheel_names):
        signs = np.ones(len(rover.wheels))
        signs[number] = -1.0
        remedy = f"give the encoder of {name} a negative gear"
        yield (
            f"wheel {name} counts the other way round",
            remedy,
            lambda drive, signs=signs: replace(drive, speeds=drive.speeds * signs),  # type: ignore[misc]
        )
    if (order := _mirrored(rover)) is not None:
        steered = [number for number, wheel in enumerate(rover.wheels) if wheel.steered]
        joints = [steered.index(order[number]) for number in steered]
        yield (
            "left and right are swapped",
            "exchange the columns or the names of the wheels on both sides",
            lambda drive: replace(drive, speeds=drive.speeds[:, order], steering=drive.steering[:, joints]),
        )
    if rover.steered_names:
        units = "write deg into the header, or convert them"
        for by, what, remedy in (
            (-1.0, "steering angles count the other way round", "give the steering encoders a negative gear"),
            (math.radians(1.0), "steering angles are in degrees", units),
        ):
            yield (
                what,
                remedy,
                lambda drive, by=by: replace(drive, steering=drive.steering * by),  # type: ignore[misc]
            )


def _mirrored(rover: Rover) -> list[int] | None:
    """For every wheel the one on the other side; None if one has none."""
    places = np.array([(wheel.x, wheel.y) for wheel in rover.wheels])
    if not np.abs(places[:, 1]).any():
        return None
    apart = np.hypot(places[:, None, 0] - places[None, :, 0], places[:, None, 1] + places[None, :, 1])
    partners = apart.argmin(axis=1)
    if (apart[np.arange(len(places)), partners] > SAME_PLACE * size(rover)).any():
        return None
    alike = [rover.wheels[a].steered == rover.wheels[b].steered for a, b in enumerate(partners)]
    return partners.tolist() if all(alike) else None


def at_bounds(problem: Problem, solution: Solution) -> list[str]:
    """Parameters that went as far as they may."""
    low, high = problem.bounds()
    said = []
    for one, value, least, most in zip(problem.model.parameters, solution.values, low, high, strict=True):
        room = AT_BOUND * (most - least)
        if not (value - least > room and most - value > room):
            unit = f" {one.unit}".rstrip()
            said.append(
                f"{one.name} went as far as it may, to {value:.4g}{unit} from {one.value:.4g}{unit}: "
                "check what the wheels read and in which unit, or leave it out"
            )
    return said


def unsettled(solution: Solution) -> list[str]:
    """Why a fit did not settle, and what to do."""
    if solution.converged:
        return []
    widest = float(solution.spread.max(initial=0.0))
    why = (
        "the drives hardly tell some of the parameters; ask for fewer, or drive turns both ways"
        if widest > HARDLY
        else "stretches fit one another badly; try loss='cauchy', which forgets where it slipped"
    )
    return [f"the values still moved after the last round: {why}"]


@dataclass(frozen=True)
class Slip:
    """What was left out of one log."""

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


def slipped(problem: Problem, records: Sequence[Log], parts: int) -> list[Slip]:
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
    for number, (drive, log) in enumerate(zip(problem.drives, records, strict=True)):
        lost = _lost(model, drive, values)
        stretches = tuple(
            one for one in lost if one.distance > LARGE * reach or one.end - one.start > LASTING
        )
        if stretches:
            edges = np.linspace(log.stamps[0], log.stamps[-1], parts + 1)
            longest = max(stretches, key=lambda one: one.distance)
            middle = (longest.start + longest.end) / 2.0
            part = int(np.clip(np.searchsorted(edges, middle), 1, parts))
            found.append(Slip(number, drive.name, part, parts, stretches))
    return found


def _lost(model: Model, drive: Drive, values: Floats) -> tuple[Stretch, ...]:
    if not (drive.truth.has_positions and drive.truth.has_headings):
        return ()  # a motion needs both
    return lost_stretches(*timed_path(model, drive, values), size(model.nominal), LEAST)


def _outside(drive: Drive, stretches: Sequence[Stretch]) -> Drive:
    """The drive without the windows that see one of these stretches."""
    first, last = drive.stamps[drive.rows].T
    kept = np.ones(len(drive.rows), dtype=bool)
    for start, end in merged(stretches, MARGIN):
        kept &= (last <= start) | (first >= end)
    rows, middles, lengths, blocks = (
        drive.rows[kept],
        drive.middles[kept],
        drive.lengths[kept],
        drive.blocks[kept],
    )
    return replace(drive, rows=rows, middles=middles, lengths=lengths, blocks=blocks)


def clean(
    log: Log, stretches: Sequence[Stretch], ready: Callable[[Log], Drive], session: str
) -> list[tuple[Log, Drive]]:
    """What is left of a log without its slides, ready to be fitted; each piece begins where the truth is."""
    spans = merged(stretches, MARGIN)
    begins, ends = [-np.inf, *(end for _, end in spans)], [*(start for start, _ in spans), np.inf]
    pieces = []
    for begin, end in zip(begins, ends, strict=True):
        rows = slice(*np.searchsorted(log.stamps, (begin, end)).tolist())
        if len(log.stamps[rows]) < FEWEST_ROWS:
            continue
        name = f"{log.name or session} from {log.stamps[rows][0]:.1f} s to {log.stamps[rows][-1]:.1f} s"
        piece = replace(
            log,
            stamps=log.stamps[rows],
            steering=None if log.steering is None else log.steering[rows],
            wheel_angles=log.wheel_angles[rows],
            yaw=None if log.yaw is None else log.yaw[rows],
            yaw_rate=None if log.yaw_rate is None else log.yaw_rate[rows],
            name=name,
            session=session,
        )
        try:
            pieces.append((piece, ready(piece)))
        except ValueError:
            continue  # it stands still there, or its truth is not known
    return pieces
