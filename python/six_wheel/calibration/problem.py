"""Drives and a model whose parameters shall explain them; scales and weights of their errors."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from six_wheel.calibration.drives import Drive
from six_wheel.calibration.model import Model
from six_wheel.kinematics.poses import Floats

Loss = Literal["linear", "soft_l1", "huber", "cauchy"]
Curve = Callable[[Floats], Floats]
# By the ratio of a residual to where a loss begins to doubt: the weight of it, which is the derivative of the
# loss by the square of the ratio, and the curvature of the loss, half its second derivative by the ratio.
LOSSES: dict[Loss, tuple[Curve, Curve]] = {
    "linear": (np.ones_like, np.ones_like),
    "soft_l1": (lambda r: 1.0 / np.sqrt(1.0 + r * r), lambda r: (1.0 + r * r) ** -1.5),
    "huber": (lambda r: 1.0 / np.maximum(np.abs(r), 1.0), lambda r: (np.abs(r) <= 1.0).astype(np.float64)),
    "cauchy": (lambda r: 1.0 / (1.0 + r * r), lambda r: (1.0 - r * r) / np.square(1.0 + r * r)),
}


# A robust loss begins to doubt a window at this many times the usual error.
DOUBT = 3.0


# Errors smaller than this are rounding of the recording, not knowledge [m and rad].
SMALLEST_SCALE = 1e-6


# First guess of the error of a motion, as a share of its length.
FIRST_SCALE = 0.02


# Windows of one length that tell by themselves how much they err.
FEW = 10


@dataclass(frozen=True, eq=False)
class Problem:
    """Drives and a model whose parameters shall explain them."""

    model: Model
    drives: Sequence[Drive]
    loss: Loss
    lengths: Floats
    latest: float  # largest plausible time offset [s]
    around: tuple[Floats, Floats, Floats] | None = None

    def errors(self, values: Floats) -> tuple[Floats, Floats]:
        """Errors of all windows (m, 3) and their derivatives (m, 3, p)."""
        if self.around is not None:
            centre, errors, by = self.around
            return errors + by @ (values - centre), by
        parts = [self.model.errors(drive, values) for drive in self.drives]
        return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])

    def linearised(self, values: Floats, scales: Floats) -> "Problem":
        """The same with errors that change evenly from those at `values` on.

        A heading that errs by chance makes ways shorter on the average, never longer: what the usual error of
        the heading is taken to have cost each window is not held against the lengths.
        """
        errors, by = replace(self, around=None).errors(values)
        lost = np.concatenate([self.model.shortened(drive, values) for drive in self.drives])
        errors[:, :2] -= np.square(scales[self.which, 1])[:, None] / 2.0 * lost
        return replace(self, around=(values, errors, by))

    def only(self, kept: Sequence[bool]) -> "Problem":
        """Some of the drives, with what is known of them."""
        rows = np.repeat(kept, [len(drive.rows) for drive in self.drives])
        around = None if self.around is None else (self.around[0], self.around[1][rows], self.around[2][rows])
        drives = [drive for drive, keep in zip(self.drives, kept, strict=True) if keep]
        return replace(self, drives=drives, around=around)

    @property
    def which(self) -> NDArray[np.int64]:
        return np.concatenate([drive.lengths for drive in self.drives])

    def bounds(self) -> tuple[Floats, Floats]:
        """Bounds of the values: lengths stay positive, and clocks within what the windows leave."""
        ends = []
        for one in self.model.parameters:
            if one.positive:
                ends.append((0.2 * one.value, 5.0 * one.value))
            elif one.unit == "rad":
                ends.append((one.value - 1.5, one.value + 1.5))
            elif one.name == "time_offset":
                ends.append((-self.latest, self.latest))
            else:
                ends.append((one.value - 10.0 * one.plausible, one.value + 10.0 * one.plausible))
        low, high = np.array(ends).reshape(-1, 2).T
        return low, high


@dataclass(frozen=True, eq=False)
class Solution:
    """Values that fit best, and what is needed to say how well they are known.

    `seen` (p, q) are the directions the data see, in units of what is plausible for each parameter, `unseen`
    (p, p - q) the others; all of them are as long as is plausible, and independent of one another. `spread`
    (p,) says how far the data would let each go, as a share of that, seen ones first.
    """

    values: Floats
    errors: Floats
    weights: Floats
    scales: Floats
    by: Floats
    seen: Floats
    unseen: Floats
    spread: Floats
    converged: bool


def scales_of(problem: "Problem", errors: Floats, before: Floats) -> tuple[Floats, Floats]:
    """Usual errors per window length, in place and heading (k, 2), and robust weights (m, 3).

    Of a few windows the fit may hit every one, and what is left of them says nothing: they are taken to err
    as those of the length that has most, growing with the root of the length.
    """
    which, (weights_of, _) = problem.which, LOSSES[problem.loss]
    scales = before.copy()
    weights = np.ones_like(errors)
    kinds = np.append(problem.lengths, problem.lengths[-1])
    counts = np.bincount(which, minlength=len(kinds))
    usual = int(np.argmax(counts))
    order = np.unique(which)
    for number in sorted(order.tolist(), key=lambda kind: kind != usual):
        rows = which == number
        least = SMALLEST_SCALE
        for part, columns in ((0, slice(0, 2)), (1, slice(2, 3))):
            values = errors[rows, columns]
            if counts[number] < FEW and number != usual:
                least = max(SMALLEST_SCALE, scales[usual, part] * math.sqrt(kinds[number] / kinds[usual]))
            scale = max(rms_of(values, np.ones_like(values)), least)
            for _ in range(50 if problem.loss != "linear" else 0):
                again = max(rms_of(values, weights_of(values / (DOUBT * scale))), least)
                if abs(again - scale) <= 1e-6 * scale:
                    break
                scale = again
            scales[number, part] = scale
            weights[rows, columns] = weights_of(values / (DOUBT * scale))
    return scales, weights


def rms_of(values: Floats, weights: Floats) -> float:
    return math.sqrt(float((weights * values * values).sum() / weights.sum()))
