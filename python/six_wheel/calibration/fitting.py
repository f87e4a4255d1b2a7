"""Robust nonlinear least squares over windows: values, what the data leave open, and honest covariances."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from six_wheel.calibration.drives import OVERLAP, STRETCHES
from six_wheel.calibration.model import Model
from six_wheel.calibration.problem import (
    DOUBT,
    FIRST_SCALE,
    LOSSES,
    Problem,
    Solution,
    scales_of,
)
from six_wheel.kinematics.errors import needed
from six_wheel.kinematics.poses import Floats

with needed("six-wheel[calibrate]", "calibration needs"):
    from scipy.optimize import least_squares
    from scipy.special import stdtrit

# A direction is open if the data leave it wider than this share of what is plausible.
OPEN = 0.5
# A parameter of which the data see less than this, in units of what is plausible, stays exactly where it is.
UNTOUCHED = 1e-2
# Parameters less open than this share are known.
KNOWN = 0.05
ROUNDS, STEPS = 12, 8
# Rounds of reweighting, and the change of the sum of squares that ends them.
REWEIGHTED, NOTHING = 60, 1e-14
# Tolerance of the first, coarse fit; the second begins there.
COARSE = 1e-3
SETTLED = 1e-3  # of a standard deviation
FEWEST_SESSIONS, FEWEST_RUNS = 4, 3
# Of intervals that a normal distribution shall have as wide as Student's t.
NORMAL = 0.95


def solve(problem: Problem, start: Floats | None = None) -> Solution:
    """Fit all parameters the data see; the others keep their nominal values.

    From the nominal values the way may be long and bent: a trust region finds it, with a weak hold on them
    that keeps what nothing is known about where it is. From there on, as from a given start, the drives are
    simulated once per step and everything else settles on their linearisation.
    """
    model = problem.model
    scales = np.repeat(FIRST_SCALE * np.append(problem.lengths, problem.lengths[-1])[:, None], 2, axis=1)
    values = model.start.copy() if start is None else start.copy()
    if start is None and len(values):
        values = _descend(problem, model.likely, values, scales, hold=1.0, fine=False)
    errors, _ = problem.errors(values)
    scales, _ = scales_of(problem, errors, scales)
    solution = _settle(problem.linearised(values, scales), values, scales)
    for _ in range(STEPS):
        moved = np.abs(solution.values - values)
        close = SETTLED * model.plausible * min(float(solution.spread.min(initial=1.0)), 1.0)
        values = solution.values
        linear = problem.linearised(values, solution.scales)
        solution = _settle(linear, values, solution.scales)
        if np.all(moved <= close):
            break
    else:
        solution = replace(solution, converged=False)
    errors, by = linear.errors(solution.values)
    scales, weights = scales_of(problem, errors, solution.scales)
    return replace(solution, errors=errors, by=by, scales=scales, weights=weights)


def _settle(problem: "Problem", values: Floats, scales: Floats) -> Solution:
    """Scales, weights, what the data see and the values that follow, until none of them changes any more."""
    model = problem.model
    nominal, plausible = model.start, model.plausible
    errors, by = problem.errors(values)
    for _ in range(ROUNDS):
        scales, weights = scales_of(problem, errors, scales)
        seen, unseen, spread = _directions(problem, by, weights, scales)
        values = nominal + plausible * (seen @ _steps(model, seen, values))
        now = Solution(values, errors, weights, scales, by, seen, unseen, spread, False)
        found = _descend(problem, seen, values, scales, hold=_hold(problem, now), fine=True)
        moved, values = np.abs(found - values), found
        errors, by = problem.errors(values)
        converged = bool(np.all(moved <= SETTLED * plausible * min(float(spread.min(initial=1.0)), 1.0)))
        if converged:
            break
    return replace(now, values=values, errors=errors, by=by, converged=converged)


def _descend(
    problem: "Problem", directions: Floats, values: Floats, scales: Floats, *, hold: float, fine: bool
) -> Floats:
    """One robust least-squares fit along `directions` with fixed scales.

    `hold` is for how many windows what is plausible counts.
    """
    model, which = problem.model, problem.which
    nominal, plausible = model.start, model.plausible
    if not directions.shape[1]:
        return nominal.copy()
    per_row = DOUBT * scales[which][:, [0, 0, 1]]
    latest: dict[bytes, tuple[Floats, Floats]] = {}
    low, high = problem.bounds()
    held = math.sqrt(hold) / DOUBT * np.eye(directions.shape[1])

    def place(steps: Floats) -> Floats:
        return np.clip(nominal + plausible * (directions @ steps), low, high)

    def both(steps: Floats) -> tuple[Floats, Floats]:
        key = steps.tobytes()
        if key not in latest:
            latest.clear()
            errors, by = problem.errors(place(steps))
            rows = (errors / per_row).ravel()
            slopes = ((by * plausible) @ directions / per_row[:, :, None]).reshape(len(rows), -1)
            rows = np.concatenate((rows, held @ steps))
            slopes = np.concatenate((slopes, held))
            latest[key] = rows, slopes
        return latest[key]

    start = _steps(model, directions, values)
    if problem.around is not None:
        found = _reweighted(problem, directions, start, per_row, hold)
        inside = nominal + plausible * (directions @ found)
        if np.all((low < inside) & (inside < high)):
            return inside
    result = least_squares(
        lambda steps: both(steps)[0],
        start,
        jac=lambda steps: both(steps)[1],
        loss=problem.loss,
        x_scale="jac",
        xtol=1e-8 if fine else COARSE,
        ftol=1e-8 if fine else COARSE,
        max_nfev=60,
    )
    return place(result.x)


def _reweighted(
    problem: "Problem", directions: Floats, start: Floats, per_row: Floats, hold: float
) -> Floats:
    """The same of a linearised problem by least squares reweighted until they settle, bounds aside."""
    model = problem.model
    here, by = problem.errors(model.start + model.plausible * (directions @ start))
    rows = (here / per_row).ravel()
    slopes = ((by * model.plausible) @ directions / per_row[:, :, None]).reshape(len(rows), -1)
    firm = hold / DOUBT**2
    steps = start.copy()
    for _ in range(REWEIGHTED):
        weights = LOSSES[problem.loss][0](rows)
        heavy = slopes * weights[:, None]
        stiff = heavy.T @ slopes + firm * np.eye(len(steps))
        change = np.linalg.solve(stiff, -(heavy.T @ rows) - firm * steps)
        steps, rows = steps + change, rows + slopes @ change
        # As a share of how far the windows alone would let it go.
        if change @ stiff @ change <= NOTHING:
            break
    return steps


def _steps(model: Model, directions: Floats, values: Floats) -> Floats:
    """Offsets of `values` from the start along independent directions, in plausible deviations."""
    independent = model.surprise @ directions
    found: Floats = independent.T @ (model.surprise @ ((values - model.start) / model.plausible))
    return found


def _directions(
    problem: Problem, by: Floats, weights: Floats, scales: Floats
) -> tuple[Floats, Floats, Floats]:
    """Directions of the parameters the data see and do not, in units of what is plausible.

    Windows that overlap tell the same story again: each counts for the share of new distance in it.
    """
    which, plausible = problem.which, problem.model.plausible
    if not len(plausible):  # the nominal dimensions have won
        return np.empty((0, 0)), np.empty((0, 0)), np.empty(0)
    kinds = np.append(problem.lengths, problem.lengths[-1])
    new = problem.lengths[0] / OVERLAP / kinds[which] / len(kinds)
    factor = np.sqrt(weights * new[:, None]) / scales[which][:, [0, 0, 1]]
    slopes = (by * plausible * factor[:, :, None]).reshape(-1, len(plausible)) @ problem.model.likely
    triangle = np.linalg.qr(np.concatenate((slopes, np.zeros((len(plausible), len(plausible))))), mode="r")
    _, sizes, rows = np.linalg.svd(triangle)
    known = (sizes > 1.0 / OPEN) & (sizes > 1e-9 * sizes.max(initial=0.0))
    with np.errstate(divide="ignore"):
        spread = 1.0 / sizes
    likely = problem.model.likely
    # Without the dust of the decomposition what is not concerned stays exactly where it is.
    clean = (likely @ rows[one].T for one in (known, ~known))
    seen, unseen = (np.where(np.abs(each) < 1e-9, 0.0, each) for each in clean)
    seen[np.linalg.norm(seen, axis=1) < UNTOUCHED] = 0.0
    return seen, unseen, np.concatenate((spread[known], spread[~known]))


def covariance(problem: Problem, solution: Solution) -> tuple[Floats, Floats, str]:
    """Covariance of the values, degrees of freedom of the rover's, and in words what it rests on.

    Errors of neighbouring windows go together and have heavy tails: the usual formula would promise ten times
    too much. What the values do when a whole cluster of windows is taken away knows no such assumption.
    With enough sessions these are the clusters. Within one or a few, errors differ from run to run and from
    stretch to stretch of a path that the runs repeat: both variances are added, which is never too little.
    One or two runs say nothing about the first; then every stretch of each counts as one cluster.

    Source: Cameron & Miller, A Practitioner's Guide to Cluster-Robust Inference, J. Human Resources 50(2),
    2015: the jackknife estimate CV3 with Student's t, section VI, and two ways of clustering, section V.
    """
    labels, basis = _clusters(problem)
    parts = [_jackknife(problem, solution, one) for one in labels]
    degrees = np.min([part[1] for part in parts], axis=0)
    # A value that is known for the most part may err by the plausible deviation of the rest.
    rest = problem.model.plausible[:, None] * solution.unseen
    rest[openness(solution.unseen) >= KNOWN] = 0.0
    return np.sum([part[0] for part in parts], axis=0) + rest @ rest.T, degrees, basis


def openness(unseen: Floats) -> Floats:
    """The share of every parameter that no window sees (p,), of directions as in `Solution`."""
    share: Floats = (unseen * unseen).sum(axis=1)
    return share


def _clusters(problem: Problem) -> tuple[list[NDArray[np.int64]], str]:
    """Labels of the windows whose errors may go together, in one or two ways, and what they are."""
    drives = problem.drives
    counts = [len(drive.rows) for drive in drives]
    sessions = list(dict.fromkeys(drive.session for drive in drives))
    runs = np.repeat(np.arange(len(drives)), counts)
    stretches = np.concatenate([drive.blocks for drive in drives])
    if len(sessions) >= FEWEST_SESSIONS:
        labels = np.repeat([sessions.index(drive.session) for drive in drives], counts)
        return [labels], f"{len(sessions)} sessions"
    if len(drives) >= FEWEST_RUNS:
        return [runs, stretches], f"{len(drives)} runs and {STRETCHES} stretches of the path"
    return [STRETCHES * runs + stretches], f"{STRETCHES} stretches of each of {len(drives)} runs"


def _per_cluster(problem: Problem, solution: Solution, clusters: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Score vectors (k, q) and information matrices (k, q, q) of every cluster along the directions seen.

    The information of a robust fit is the second derivative of its loss, averaged over each kind of window.
    The weights alone would overstate it, and the intervals would be too narrow.
    """
    which, errors, seen = problem.which, solution.errors, solution.seen
    size = solution.scales[which][:, [0, 0, 1]]
    each = LOSSES[problem.loss][1](errors / (DOUBT * size))
    kinds = np.bincount(which)
    sums = np.stack([np.bincount(which, one) for one in (each[:, :2].mean(axis=1), each[:, 2])], axis=1)
    stiff = np.maximum(sums / np.maximum(kinds, 1)[:, None], 0.0)[which][:, [0, 0, 1]]
    slopes = (solution.by * problem.model.plausible) @ seen / size[:, :, None]
    pulls = np.einsum("mrq,mr->mq", slopes, solution.weights * errors / size)
    bent = slopes * np.sqrt(stiff)[:, :, None]
    names = np.unique(clusters)
    rows = [clusters == name for name in names]
    count = seen.shape[1]
    return (
        np.array([pulls[one].sum(axis=0) for one in rows]).reshape(len(names), count),
        np.array([np.tensordot(bent[one], bent[one], ((0, 1), (0, 1))) for one in rows]),
    )


def _hold(problem: Problem, solution: Solution) -> float:
    """Composite-likelihood factor `tr(H⁻¹ J) / p`, at least 1, for correlated windows.

    The prior is weighted by it against the windows, so that overlapping windows do not count as independent.

    Source: Ribatet, Cooley & Davison, Bayesian Inference from Composite Likelihoods, Statistica Sinica 22,
    2012: the magnitude adjustment, p / tr(H⁻¹ J).
    """
    if not solution.seen.shape[1]:
        return 1.0
    pulls, stiff = _per_cluster(problem, solution, _clusters(problem)[0][0])
    apart = pulls - pulls.mean(axis=0)
    share = len(pulls) / max(len(pulls) - 1, 1)
    trace = share * float(np.sum(apart * np.linalg.solve(stiff.sum(axis=0), apart.T).T))
    return max(trace / float(solution.seen.shape[1]), 1.0)


def _jackknife(problem: Problem, solution: Solution, clusters: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Covariance from leaving out one cluster of windows after another, and degrees of freedom of each of the
    rover's numbers."""
    pulls, stiff = _per_cluster(problem, solution, clusters)
    # Without the one cluster that shows a direction, only the plausible deviation is known: the identity.
    whole = stiff.sum(axis=0) + np.eye(solution.seen.shape[1])
    without = np.linalg.inv(whole - stiff)
    together = np.einsum("kqr,kr->kq", without, pulls)
    share = (len(pulls) - 1) / len(pulls)
    outer = problem.model.plausible[:, None] * solution.seen
    # As a square, so that no variance is negative by rounding.
    spread = math.sqrt(share) * outer @ together.T if len(pulls) > 1 else outer
    degrees = np.array([_degrees(row, without, stiff, whole) for row in outer[: problem.model.own]])
    return spread @ spread.T, degrees


def _degrees(direction: Floats, without: Floats, stiff: Floats, whole: Floats) -> float:
    """Degrees of freedom of the variance along a direction (Satterthwaite).

    They are the number of clusters less one if all clusters contribute alike, and near 1 if one of them
    dominates. The errors of the clusters are taken to be as the fit weights them.

    Source: Bell & McCaffrey, Bias Reduction in Standard Errors for Linear Regression with Multi-Stage
    Samples, Survey Methodology 28(2), 2002: Satterthwaite's degrees of freedom, here of the jackknife.
    """
    reach = without @ direction
    told = np.einsum("kqr,kr->kq", stiff, reach)
    squares = np.diag((reach * told).sum(axis=1)) - told @ np.linalg.solve(whole, told.T)
    total = float(np.sum(squares * squares))
    most = max(len(stiff) - 1, 1)
    return float(np.clip(np.trace(squares) ** 2 / total, 1.0, most)) if total > 0.0 else float(most)


def quantile(degrees: float, confidence: float) -> float:
    """Quantile of Student's t distribution: half the width of an interval in standard deviations."""
    return float(stdtrit(degrees, 0.5 + confidence / 2.0))


def refit(linear: Problem, start: Solution) -> tuple[Problem, Solution]:
    """Some of the drives of a problem that was solved for all of them, and what fits these, after one step in
    full."""
    values = _settle(linear, start.values, start.scales).values
    linear = linear.linearised(values, start.scales)
    return linear, _settle(linear, values, start.scales)
