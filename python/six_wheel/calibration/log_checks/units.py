"""Logs that fit far better if something about them is read another way."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from six_wheel._core import Rover
from six_wheel.calibration.drives import Drive
from six_wheel.calibration.model import Model
from six_wheel.calibration.problem import Problem, Solution
from six_wheel.kinematics.poses import Floats
from six_wheel.robot_description.dimensions import size

# Ratio of misfits by which another reading must beat the given one, both with nominal dimensions.
FAR_BETTER = 3.0
# Readings that fit as well as the best one, but for this factor, are told with it.
ALIKE = 1.1
# Error after a fit, as a share of the length of usual windows, above which logs and truth do not match.
STRANGE = 0.25
# Least difference of the logarithms between a free factor and every factor that has a known reason.
ANOTHER = 0.2
# About a factor that is guessed by the ways.
NEAR = np.geomspace(0.5, 2.0, 25)
# Over which a truth of some noise goes somewhere [s].
A_STEP = 1.0
# A place counts as the same from which this share of the size is missing.
SAME_PLACE = 0.05
# Shares of a bound within which a value is at it.
AT_BOUND = 1e-6
# A direction known no better than to this share of what is plausible.
HARDLY = 0.1


class Reading(NamedTuple):
    """Another way to read a log: what would be so, the remedy, how a drive reads then, and by what its truth
    grows, so that one which shrinks to nothing is not taken for one that fits."""

    what: str
    remedy: str
    change: Callable[[Drive], Drive]
    grows: float = 1.0


FACTORS = (
    (2.0, "a gear or the ticks per turn are taken twice, or a radius for a diameter"),
    (0.5, "a gear of 2 is missing, or a diameter is taken for a radius"),
    (4.0, "edges are counted four times a tick"),
    (0.25, "ticks are a quarter of what they are"),
    (math.tau, "turns are taken for radians"),
    (math.radians(1.0), "degrees are taken for radians"),
)


def mistaken(problem: Problem, solution: Solution) -> list[str]:
    """Messages on probable mistakes in the logs, their truth or the rover, with remedies; empty if they fit.

    Every suspicion is tried: sides swapped, wheels that count backwards, factors of two, degrees for radians;
    where nothing else explains what a fit leaves, any other factor.
    """
    rover, drives = problem.model.nominal, problem.drives
    model = Model(rover, [])
    given = _misfit(model, drives)
    readings = [*_other_readings(rover), *_other_truths()]
    tried = [(_misfit(model, list(map(one.change, drives))) / one.grows, one) for one in readings]
    best = min(misfit for misfit, _ in tried)
    likely = [one for misfit, one in tried if misfit <= ALIKE * best]
    left = _error_share(problem, solution)
    if left > STRANGE or at_bounds(problem, solution):
        by, misfit = _factor(model, drives)
        other = all(abs(math.log(by / listed)) > ANOTHER for listed, _ in FACTORS)
        if other and misfit * FAR_BETTER <= best:
            remedy = "check ticks_per_turn and gear_ratio of the encoders, the radius, and the units of both"
            best, likely = misfit, [Reading(f"the wheels turn {by:.2g} times as far", remedy, _turned(by))]
    if best * FAR_BETTER <= given:
        what = "; or if ".join(f"{one.what}: {one.remedy}" for one in likely)
        return [f"the drives fit far better ({given:.3g} m to {best:.3g} m a window) if {what}"]
    if not left > STRANGE:
        return []
    share = f"half of the windows are off by {100.0 * left:.0f} % of their length or more"
    remedy = "check that every log has its own truth, and the clock, axes and units of that"
    return [f"the drives and their truth do not go together, {share} whatever the dimensions: {remedy}"]


def _error_share(problem: Problem, solution: Solution) -> float:
    """Median error of usual windows after a fit, as a share of their length; 0 if all begin at the start."""
    some = problem.which < len(problem.lengths)
    errors = solution.errors[some] * (1.0, 1.0, size(problem.model.nominal))
    shares = np.linalg.norm(errors, axis=1) / problem.lengths[problem.which[some]]
    return float(np.median(shares)) if len(shares) else 0.0


def _misfit(model: Model, drives: Sequence[Drive]) -> float:
    """Size of the errors of usual windows under the nominal dimensions [m]."""
    errors = np.concatenate([model.errors(drive, model.start)[0] for drive in drives])
    squares = np.sum(errors * errors * (1.0, 1.0, size(model.nominal) ** 2), axis=1)
    return math.sqrt(float(np.median(squares)))


def _factor(model: Model, drives: Sequence[Drive]) -> tuple[float, float]:
    """Factor on the rotation of all wheels that fits the truth best, and the misfit with it [m]."""
    reach, ways = size(model.nominal) * np.array((0.0, 0.0, 1.0)) + (1.0, 1.0, 0.0), np.zeros(2)
    for drive in drives:
        times = np.arange(drive.stamps[0], drive.stamps[-1], A_STEP)
        seen = np.linalg.norm(np.diff(np.nan_to_num(drive.truth.at(times)), axis=0) * reach, axis=1)
        there = drive.truth.covers(times)
        known = there[1:] & there[:-1]
        pace = np.linalg.norm(model.nominal.forward(drive.steering, drive.wheel_speeds) * reach, axis=1)
        driven = np.diff(np.interp(times, drive.stamps, np.concatenate(([0.0], np.cumsum(pace * drive.dt)))))
        ways += seen[known].sum(), driven[known].sum()
    if not ways.all():
        return 1.0, math.inf
    about = float(ways[0] / ways[1])
    tried = [about * by for by in NEAR.tolist()]
    best, by = min((_misfit(model, list(map(_turned(by), drives))), by) for by in tried)
    return by, best


def _turned(by: float | Floats) -> Callable[[Drive], Drive]:
    return lambda drive: replace(drive, wheel_speeds=drive.wheel_speeds * by)


def _steered(by: float) -> Callable[[Drive], Drive]:
    return lambda drive: replace(drive, steering=drive.steering * by)


Three = tuple[float, float, float]


def _seen(
    times: Three, more: Three = (0.0, 0.0, 0.0), order: Sequence[int] = (0, 1, 2)
) -> Callable[[Drive], Drive]:
    """A drive whose truth has its columns in this order, times these and these more."""

    def change(drive: Drive) -> Drive:
        poses = drive.truth.poses[:, order] * times + more
        return replace(drive, truth=replace(drive.truth, poses=poses))

    return change


def _other_truths() -> Iterator[Reading]:
    degrees = "write deg into the header, or convert them"
    yield Reading("the headings of the truth are in degrees", degrees, _seen((1.0, 1.0, math.radians(1.0))))
    for unit, by in (("mm", 1e-3), ("cm", 1e-2)):
        remedy = f"write {unit} into the header, or convert them"
        yield Reading(f"the positions of the truth are in {unit}", remedy, _seen((by, by, 1.0)), by)
    yield Reading(
        "y and yaw of the truth count the other way round",
        "its axes are north, east, down, or seen from below: reverse both",
        _seen((1.0, -1.0, -1.0)),
    )
    against = "they count from x towards y: reverse them, or take those of a compass from 90 deg"
    for begin in (0.0, math.pi / 2.0):
        what = "the headings of the truth count the other way round"
        yield Reading(what, against, _seen((1.0, 1.0, -1.0), (0.0, 0.0, begin)))
    exchanged = _seen((1.0, 1.0, 1.0), order=(1, 0, 2))
    yield Reading("x and y of the truth are exchanged", "exchange its columns", exchanged)


def _other_readings(rover: Rover) -> Iterator[Reading]:
    for by, why in FACTORS:
        remedy = f"{why}; check ticks_per_turn and gear_ratio of the encoders, and the unit of the columns"
        yield Reading(f"the wheels turn {by:.3g} times as far", remedy, _turned(by))
    backwards = "give the encoders a negative gear_ratio"
    yield Reading("all wheels count the other way round", backwards, _turned(-1.0))
    for number, name in enumerate(rover.wheel_names):
        signs = np.ones(len(rover.wheels))
        signs[number] = -1.0
        remedy = f"give the encoder of {name} a negative gear_ratio"
        yield Reading(f"wheel {name} counts the other way round", remedy, _turned(signs))
    if (order := _mirrored(rover)) is not None:
        steered = [number for number, wheel in enumerate(rover.wheels) if wheel.steered]
        joints = [steered.index(order[number]) for number in steered]
        yield Reading(
            "left and right are swapped",
            "exchange the columns or the names of the wheels on both sides",
            lambda drive: replace(
                drive, wheel_speeds=drive.wheel_speeds[:, order], steering=drive.steering[:, joints]
            ),
        )
    if rover.steered_wheel_names:
        remedy = "give the steering encoders a negative gear_ratio"
        yield Reading("steering angles count the other way round", remedy, _steered(-1.0))
        units = "write deg into the header, or convert them"
        yield Reading("steering angles are in degrees", units, _steered(math.radians(1.0)))


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


def unsettled(solution: Solution, mistaken: bool = False) -> list[str]:
    """The reason that a fit did not settle, with a remedy; empty if it settled."""
    if solution.converged:
        return []
    widest = float(solution.spread.max(initial=0.0))
    if mistaken:
        why = "nothing fits as long as that is so; mend it first"
    elif widest > HARDLY:
        why = "the drives hardly tell some of the parameters; ask for fewer, or drive turns both ways"
    else:
        why = "stretches fit one another badly; try loss='cauchy', which forgets where it slipped"
    return [f"the values still moved after the last round: {why}"]
