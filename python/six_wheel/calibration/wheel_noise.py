"""Noise of slip of each wheel relative to the others, by maximum likelihood, where ends of drives show it.

What a wheel slips by moves an end in a direction of its own, so how errors of an end go together tells one
wheel from another. Ends of one session go together: each session counts for one end, however many runs it
has, so that wheels are told apart only where that many clearly do it.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize
from scipy.special import chdtri, ndtri

from six_wheel.kinematics.poses import Floats

# Wheels are taken to differ where chance alike would seem to say so this seldom,
CHANCE = 0.05
# and by no more than this factor either way.
MOST_APART = 10.0


def told_apart(
    errors: Floats, by_wheel: Floats, rest: Floats, sessions: int, confidence: float
) -> tuple[Floats, Floats] | None:
    """Factor on the common noise of each wheel (wheels,), with intervals (wheels, 2); None if the ends do not
    tell the wheels apart.

    The `errors` of ends (ends, 3) have covariances `by_wheel` by the common slip along and across every wheel
    (ends, wheels, 2, 3, 3), and by the `rest` (ends, 3, 3). They count for as many independent ends as
    `sessions`.

    Source: Wilks' theorem, with the magnitude adjustment of composite likelihoods (see `fitting`).
    """
    every, moves = by_wheel.shape[1], by_wheel.any(axis=(0, 2, 3, 4))
    by_wheel = by_wheel[:, moves]
    count = by_wheel.shape[1]
    if 3 * sessions <= count + 1 or count < 2:
        return None  # not even as many numbers as there are to find
    share = sessions / len(errors)

    def cost(logs: Floats) -> float:
        shares = np.exp(2.0 * logs[:-1, None] + 2.0 * np.array([0.0, logs[-1]]))  # across as well as along
        spread = np.einsum("wk,ewkij->eij", shares, by_wheel) + rest
        squares, sizes = normalised(errors, spread)
        return 0.5 * share * float((squares + sizes).sum())

    edge = math.log(MOST_APART)
    bounds = [(-edge, edge)]
    alike = minimize(
        lambda two: cost(np.append(np.full(count, two[0]), two[1])), [0.0, 0.0], bounds=bounds * 2
    )
    begin = np.append(np.full(count, alike.x[0]), alike.x[1])
    found = minimize(cost, begin, method="L-BFGS-B", bounds=bounds * (count + 1))
    if 2.0 * (alike.fun - found.fun) < float(chdtri(count - 1, CHANCE)):
        return None
    curvature = _curvature(cost, found.x)
    sizes, directions = np.linalg.eigh(curvature)
    known = np.maximum(sizes, 1.0 / edge**2)  # no less than that they are within bounds
    logs = found.x[:-1]
    half = float(ndtri(0.5 + confidence / 2.0)) * np.sqrt((directions**2 @ (1.0 / known))[:-1])
    ends = np.stack((logs - half, logs + half), axis=1)
    values, intervals = np.ones(every), np.ones((every, 2))
    values[moves], intervals[moves] = np.exp(logs), np.exp(np.clip(ends, -edge, edge))
    return values, intervals


def normalised(errors: Floats, covariances: Floats) -> tuple[Floats, Floats]:
    """Normalised errors squared (n,) of errors (n, 3), and logarithms of determinants of the covariances."""
    solved = np.linalg.solve(covariances, errors[:, :, None])[:, :, 0]
    return (errors * solved).sum(axis=1), np.linalg.slogdet(covariances)[1]


def _curvature(cost: Callable[[Floats], float], at: Floats) -> Floats:
    """Second derivatives by differences."""
    count, step = len(at), 1e-3
    shifts = step * np.eye(count)
    found = np.empty((count, count))
    for i in range(count):
        for k in range(i + 1):
            values = [cost(at + a * shifts[i] + b * shifts[k]) for a in (1, -1) for b in (1, -1)]
            found[i, k] = found[k, i] = (values[0] - values[1] - values[2] + values[3]) / (4.0 * step**2)
    return found
