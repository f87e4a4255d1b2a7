"""Wheels to twist: the rows of every wheel, stacked and solved by least squares."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from six_wheel.reference.planar.geometry import Floats

RANK_TOLERANCE = 1e-9  # singular values below this share of the largest are zero


class TwistFit(NamedTuple):
    """A twist (..., 3) fitted to wheel readings, and how well every wheel agrees with it."""

    twist: Floats
    residuals: Floats  # (..., wheels) [m/s], length of what is left of the wheel's two rows
    rank: int | NDArray[np.int64]
    sigma_min: float | Floats  # smallest of the three singular values of the weighted rows
    weights: Floats  # (..., wheels)


def weighted(a: Floats, b: Floats, weights: Floats, metric: Floats) -> TwistFit:
    """Rows `a` (wheels, 2, 3), readings `b` (wheels, 2): the twist of least weighted squares.

    What the rows leave open is chosen so that ``|metric @ twist|`` is as small as it can be.
    """
    root = np.sqrt(weights)
    rows, readings = (a * root[:, None, None]).reshape(-1, 3), (b * root[:, None]).ravel()
    _, sigma, basis = np.linalg.svd(rows)
    sigma = np.concatenate((sigma, np.zeros(3 - len(sigma))))
    rank = int(np.sum(sigma > RANK_TOLERANCE * sigma[0]))
    twist = np.linalg.lstsq(rows, readings, rcond=RANK_TOLERANCE)[0]
    if rank < 3:
        open_ = basis[rank:].T
        twist = twist - open_ @ np.linalg.lstsq(metric @ open_, metric @ twist, rcond=None)[0]
    residual = np.array([math.hypot(*row) for row in a @ twist - b])
    return TwistFit(np.asarray(twist, dtype=float), residual, rank, float(sigma[2]), weights)


def robust(a: Floats, b: Floats, fit: TwistFit, metric: Floats, least: float) -> TwistFit:
    """Iteratively re-weighted least squares with the Geman-McClure loss on the residual of each wheel.

    The scale starts where every wheel has a say, at the largest residual, and is halved down to the noise:
    three times the median residual, or `least`. It never grows again, so the steps converge.
    """
    scale = max(float(np.max(fit.residuals)), least)
    for _ in range(100):
        scale = min(scale, max(0.5 * scale, 3.0 * float(np.median(fit.residuals)), least))
        if scale == 0.0:
            break
        weights = 1.0 / (1.0 + (fit.residuals / scale) ** 2) ** 2
        change = float(np.max(np.abs(weights - fit.weights)))
        fit = weighted(a, b, weights, metric)
        if change <= 1e-12:
            break
    return fit
