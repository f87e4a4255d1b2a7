"""Choice of the parameters to calibrate: those that best predict drives left out of the fit."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from six_wheel.calibration.drives import Drive
from six_wheel.calibration.estimates import RunErrors
from six_wheel.calibration.fitting import quantile, refit, solve
from six_wheel.calibration.model import Model, with_mounts
from six_wheel.calibration.problem import Problem
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry.copies import cut
from six_wheel.logs.recordings import WheelLog
from six_wheel.parallel import Journal, collect, one_thread
from six_wheel.robot_description.dimensions import Catalogue

# A set of parameters must predict better than the nominal dimensions by this share to be worth its numbers,
WORTH = 0.05
# and than a smaller set by this share for each number more, on half of what was left out at least,
WORTH_A_NUMBER = 0.1
# and so surely that chance alone would seem to say so this seldom.
CHANCE = 0.05
# From so many sessions on they are compared as a whole; of fewer, their runs.
ENOUGH_FOLDS = 3
# Into so many parts a single run is cut.
PIECES = 4


@dataclass(frozen=True, eq=False)
class Candidate:
    """A set of parameters, the errors on what was left out of its fits, and their score.

    `errors` (folds,) [m] is the mean over the runs of a fold of their root mean square position error, first
    pose given; `runs` are those of each run. `score` is their root mean square over the folds as a share of
    that with the nominal dimensions: below 1 the set helps where it was not fitted, and one fold gone wrong
    counts.
    """

    parameters: tuple[str, ...]
    count: int
    errors: Floats
    score: float
    runs: Floats

    def clearly_beats(self, other: "Candidate") -> bool:
        """True if this set is worth its parameters beside a smaller one: the median error of what was left
        out is a tenth smaller for every parameter more, and by more than chance (paired, one-sided t test).

        Of logarithms, so that what is large by itself counts no more; over sessions, whose runs go together,
        or over runs where there are too few.
        """
        by_fold = len(self.errors) >= ENOUGH_FOLDS
        mine, theirs = (self.errors, other.errors) if by_fold else (self.runs, other.runs)
        if len(mine) < 2:
            return False
        least = np.finfo(float).tiny
        gains = np.log(np.maximum(theirs, least) / np.maximum(mine, least))
        usual = np.sort(gains)[(len(gains) - 1) // 2]
        chance = quantile(len(gains) - 1, 1.0 - 2.0 * CHANCE) * gains.std(ddof=1) / math.sqrt(len(gains))
        worth = (self.count - other.count) * -math.log(1.0 - WORTH_A_NUMBER)
        return bool(self.score < other.score and usual > worth and gains.mean() > chance)


@dataclass(frozen=True, eq=False)
class CrossValidation:
    """Errors on drives that were not fitted, for every set of parameters that was tried.

    Attributes
    ----------
    kind : {'session', 'run', 'part'}
        Unit that was left out at a time.
    folds : tuple of str
        Their names.
    nominal : ndarray, shape (folds,)
        Errors with the nominal dimensions.
    candidates : tuple of Candidate
        From the best score to the worst.
    chosen : tuple of str
        See `choose`; () if no set beats the nominal dimensions.
    unit : {'m', 'rad'}
        Of the errors: rad where a gyroscope alone was the truth.
    """

    kind: str
    folds: tuple[str, ...]
    nominal: Floats
    candidates: tuple[Candidate, ...]
    chosen: tuple[str, ...]
    runs: dict[str, float] = field(repr=False, default_factory=dict)
    unit: str = "m"

    @property
    def best(self) -> Candidate:
        """The set that was chosen."""
        return next(one for one in self.candidates if one.parameters == self.chosen)

    def to_markdown(self) -> str:
        """Table of the sets, their scores and their errors on every fold."""
        head = (
            f"| parameters | numbers | score | {' | '.join(f'{fold} [{self.unit}]' for fold in self.folds)} |"
        )
        lines = [head, "|---" * (3 + len(self.folds)) + "|"]
        for one in self.candidates:
            name = ", ".join(one.parameters) or "nominal"
            marked = f"**{name}**" if one.parameters == self.chosen else name
            errors = " | ".join(f"{error:.4f}" for error in one.errors)
            lines.append(f"| {marked} | {one.count} | {one.score:.3f} | {errors} |")
        return "\n".join(lines)

    def __repr__(self) -> str:
        name = ", ".join(self.chosen) or "nominal"
        before, after = float(np.mean(self.nominal)), float(np.mean(self.best.errors))
        folds = f"{len(self.folds)} {self.kind}s left out"
        return f"CrossValidation({name}: {before:.4f} -> {after:.4f} {self.unit} on {folds})"


def candidates(catalogue: Catalogue) -> list[tuple[str, ...]]:
    """Sets worth trying on a rover: radii together or apart, its geometry, where the truth looks."""
    names = set(catalogue.names)
    radii = [(name,) for name in ("wheel_radius", "side_radii", "wheel_radii") if name in names]
    if {"wheel_radius_left", "side_radii"} <= names and len(catalogue.find(["wheel_radii"])) == 2:
        radii.remove(("side_radii",))  # the same as one per wheel
    if len(catalogue.find(["wheel_radii"])) < 2:
        radii = [("wheel_radius",)]
    if catalogue.has_rollers:
        shapes: list[tuple[str, ...]] = [("arm_length",)]
        if "roller_angle" in names:
            shapes.append(("arm_length", "roller_angle"))
    elif "steering_offset" in names:
        lengths = tuple(name for name in ("wheelbase", "track_width") if name in names)
        shapes = [(*lengths, "steering_offset"), (*lengths, "steering_offset", "steering_gain")]
    else:
        shapes = [tuple(name for name in ("track_width",) if name in names)]
    frames: list[tuple[str, ...]] = [(), ("origin_yaw",), ("origin",)]
    return [radius + shape + frame for radius in radii for shape in shapes for frame in frames]


def pieces(log: WheelLog) -> list[WheelLog]:
    """A single run cut into parts, as if they were runs."""
    if log.truth is None:
        return [log]
    edges = np.linspace(0, len(log) - 1, PIECES + 1).astype(int).tolist()
    return [
        replace(cut(log, slice(first, last + 1)), name=f"part {number}", session="")
        for number, (first, last) in enumerate(pairwise(edges), start=1)
    ]


def cross_validate(
    problem: Problem,
    catalogue: Catalogue,
    sets: Sequence[tuple[str, ...]],
    progress: Callable[[int, int, str], object] | None,
    cluster: Any = None,
    workers: int | None = 1,
    journal: Journal | None = None,
) -> CrossValidation | None:
    """Every set, in place of the model of a problem, fitted without one fold after another and tried there;
    None if there is but one.

    The sets are independent of one another: on a cluster or in processes each is an item, and what a journal
    holds already is not done again.
    """
    rover, drives = problem.model.nominal, problem.drives
    sessions = list(dict.fromkeys(drive.session for drive in drives))
    by_run = len(sessions) == 1 or len(sessions) == len(drives)
    folds = [drive.name for drive in drives] if by_run else sessions
    keys = list(range(len(drives))) if by_run else [sessions.index(drive.session) for drive in drives]
    if len(set(keys)) < 2:
        return None
    parts = all(drive.name.startswith("part ") for drive in drives)
    kind = "part" if parts else "run" if by_run else "session"

    empty = Model(rover, [])
    each = _errors(empty, empty.start, drives)
    nominal = _per_fold(each, keys)
    tried = [Candidate((), 0, nominal, 1.0, each)]
    total = len(sets)

    def report_progress(done: int) -> None:
        if progress is not None:
            progress(done, total, f"sets of parameters, each without one {kind} after another")

    report_progress(0)
    items = [
        Trial(replace(problem, model=with_mounts(rover, catalogue.find(names), drives)), tuple(keys))
        for names in sets
    ]
    workers = None if cluster else workers
    outcomes = collect(
        errors_left_out, items, cluster=cluster, workers=workers, journal=journal, progress=report_progress
    )
    for number, failure in outcomes.failures.items():
        raise ValueError(f"{', '.join(sets[number])} could not be fitted: {failure}")
    for names, item, each in zip(sets, items, outcomes.values, strict=True):
        errors = _per_fold(each, keys)
        count = item.problem.model.own
        score = math.sqrt(float(np.mean(errors**2)) / max(float(np.mean(nominal**2)), 1e-24))
        tried.append(Candidate(tuple(names), count, errors, score, each))
    chosen = choose(tried)
    tried.sort(key=lambda one: (one.score, one.count))
    unit = "m" if any(drive.truth.has_positions for drive in drives) else "rad"
    return CrossValidation(kind, tuple(folds), nominal, tuple(tried), chosen.parameters, unit=unit)


@dataclass(frozen=True, eq=False)
class Trial:
    """A set of parameters on all drives, and which fold each drive belongs to."""

    problem: Problem
    keys: tuple[int, ...]


@one_thread()
def errors_left_out(trial: Trial) -> Floats:
    """Error of every run under a fit without its fold [m]."""
    whole, keys = trial.problem, np.array(trial.keys)
    solution = solve(whole)
    linear = whole.linearised(solution.values, solution.scales)
    errors = np.empty(len(keys))
    for fold in np.unique(keys):
        values = refit(linear.only((keys != fold).tolist()), solution)[1].values
        left = [drive for drive, key in zip(whole.drives, keys, strict=True) if key == fold]
        errors[keys == fold] = _errors(whole.model, values, left)
    return errors


def choose(tried: Sequence[Candidate]) -> Candidate:
    """The set to take: fewer numbers unless more of them win clearly.

    From the smallest set on, a larger one is taken if it clearly beats what was taken before. The first set
    has to beat the nominal dimensions by its score.
    """
    chosen = min(tried, key=lambda one: one.count)
    for one in sorted(tried, key=lambda one: (one.count, one.score)):
        better = one.score < 1.0 - WORTH if chosen.count == 0 else one.clearly_beats(chosen)
        chosen = one if better else chosen
    return chosen


def _errors(model: Model, values: Floats, drives: Sequence[Drive]) -> Floats:
    return np.array([RunErrors.of(model, drive, values).after for drive in drives])


def _per_fold(errors: Floats, keys: Sequence[int]) -> Floats:
    """The mean of every fold."""
    labels = np.array(keys)
    return np.array([errors[labels == fold].mean() for fold in range(int(labels.max()) + 1)])
