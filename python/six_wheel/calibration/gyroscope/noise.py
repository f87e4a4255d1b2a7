"""White noise and wandering bias of a gyroscope, by maximum likelihood from where the rover stands.

At rest a reading is the bias and white noise, and the bias takes random steps. What two readings differ by
knows nothing of the bias itself: variance `2 w² + b² dt`, and `-w²` in common with the next one. Across a
drive it is the same with a longer `dt`, so that stretches of rest far apart show how far the bias wandered.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import LinAlgError, cholesky_banded, solveh_banded
from scipy.optimize import minimize
from scipy.special import chdtri

from six_wheel._core import Gyroscope
from six_wheel.calibration.drives import RESTED, at_rest, known_rows
from six_wheel.calibration.estimates import Estimate, likelihood_end, three_digits
from six_wheel.calibration.noise import MeasuredNoise
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.recordings import WheelLog

# Readings at rest of which two numbers can be told.
FEWEST = 10
# Wandering in a second that is looked for, in shares of the white noise.
LEAST, MOST = 1e-6, 1e2


@dataclass(frozen=True, eq=False)
class MeasuredGyroscope:
    """Measured errors of a gyroscope.

    Attributes
    ----------
    noise : Estimate
        White, of one reading [rad/s].
    bias_walk : Estimate
        Random walk of the bias [rad/s per root s]. Where its interval begins at 0 the readings at rest
        do not show it.
    bias : float
        The bias itself, root mean square over the logs [rad/s].
    period : float
        Time between the readings [s]: of means over twice that the white noise is less by root two.
    readings : int
        That were taken at rest.
    scale : Estimate or None
        Factor of the readings, where a truth with headings tells.
    """

    noise: Estimate
    bias_walk: Estimate
    bias: float
    period: float
    readings: int
    scale: Estimate | None = None

    @property
    def known(self) -> Gyroscope:
        """To give to `Odometry`, of readings that were multiplied by `scale`; a wandering that did not show
        is the usual one, within what is likely."""
        walk, guess = self.bias_walk, Gyroscope().bias_walk
        value = walk.value if walk.interval[0] > 0.0 else min(max(walk.value, guess), walk.interval[1])
        factor = self.scale
        return Gyroscope(
            three_digits(self.noise.value),
            bias_noise=three_digits(self.bias),
            bias_walk=three_digits(value),
            scale_noise=0.0 if factor is None else three_digits(factor.std / abs(factor.value)),
        )

    def __repr__(self) -> str:
        return f"MeasuredGyroscope({self.known!r}, from {self.readings} readings at rest)"


Rests = list[tuple[Floats, Floats]]


def resting(log: WheelLog) -> Iterator[tuple[Floats, Floats]]:
    """Stamps and readings of a gyroscope in each stretch in which no wheel turns for a second or more."""
    if log.yaw_rate is None:
        return
    rows = known_rows(log.stamps, log.yaw_rate, log.stamps)
    if len(rows) < 2:
        return
    dt = np.diff(log.stamps[rows])
    still = at_rest(np.diff(log.wheel_angles[rows], axis=0) / dt[:, None])
    edges = np.flatnonzero(np.diff(np.concatenate(([False], still, [False])).astype(int)))
    for first, last in edges.reshape(-1, 2).tolist():
        if dt[first:last].sum() >= RESTED and last - first > 2:
            inside = rows[first + 1 : last]  # at its ends the rover may already move
            yield log.stamps[inside], log.yaw_rate[inside]


def measure(logs: Sequence[WheelLog], confidence: float) -> MeasuredGyroscope | None:
    """White noise and wandering with intervals by the profile of the likelihood; None if nothing rests."""
    rests: Rests = []
    for log in logs:
        found = list(resting(log))
        if found:
            stamps, rates = (np.concatenate(part) for part in zip(*found, strict=True))
            rests.append((stamps, rates))
    steps = [np.diff(rates) for _, rates in rests]
    count = sum(map(len, steps))
    rough = math.sqrt(sum(float(step @ step) for step in steps) / (2.0 * count)) if count else 0.0
    if count < FEWEST or rough == 0.0:
        return None
    apart = [np.diff(stamps) for stamps, _ in rests]
    scaled = [step / rough for step in steps]

    def cost(logs_of: Floats) -> float:
        white, walk = np.exp(2.0 * logs_of)
        return sum(_cost(step, dt, float(white), float(walk)) for step, dt in zip(scaled, apart, strict=True))

    edges = np.log(((1e-3, 1e3), (LEAST, MOST)))
    tried = [
        minimize(cost, (0.0, begin), method="Nelder-Mead", bounds=edges)
        for begin in np.log((1e-3, 1e-1, 1.0))
    ]
    best = min(tried, key=lambda one: float(one.fun))
    allowed = float(best.fun) + 0.5 * float(chdtri(1, 1.0 - confidence))

    def estimate(place: int, name: str, unit: str) -> Estimate:
        """A value with its interval: as far as the likelihood, the other number at its best, is not too
        small. One that can be as small as is looked for begins at 0."""

        def profile(value: float) -> float:
            def others(other: Floats) -> float:
                return cost(np.insert(other, place, value))

            # Between them the two are nearly independent: a simplex of one dimension settles at once.
            found = minimize(others, best.x[1 - place], method="Nelder-Mead", options={"fatol": 1e-3})
            return float(found.fun)

        interval = []
        for edge in edges[place].tolist():
            if profile(edge) <= allowed:
                interval.append(0.0 if edge == edges[place, 0] else rough * math.exp(edge))
                continue
            end = likelihood_end(profile, allowed, float(best.x[place]), edge, close=1e-3)
            interval.append(rough * math.exp(end))
        value = rough * math.exp(float(best.x[place]))
        return Estimate.of_interval(name, unit, 0.0, value, interval, confidence)

    noise, walk = estimate(0, "yaw_rate", "rad/s"), estimate(1, "bias_walk", "rad/s per root s")
    biases = np.array([rates.mean() for _, rates in rests])
    period = float(np.median(np.concatenate(apart)))
    return MeasuredGyroscope(noise, walk, math.sqrt(float(np.mean(biases**2))), period, count + len(rests))


def with_gyroscope(measured: MeasuredNoise, gyroscope: MeasuredGyroscope) -> MeasuredNoise:
    """The measured noise of slip with that of a gyroscope, whose bias counts as noise of the yaw rate."""
    known = gyroscope.known
    rate = three_digits(math.hypot(known.noise, known.bias_noise))
    noise, beside = (was.replace(yaw_rate=rate) for was in (measured.noise, measured.beside))
    return replace(measured, noise=noise, beside=beside, yaw_rate=gyroscope.noise, gyroscope=known)


def _cost(steps: Floats, dt: Floats, white: float, walk: float) -> float:
    """Negative log-likelihood of differences of readings, by variances of noise and bias walk per second."""
    band = np.full((2, len(steps)), -white)
    band[0] = 2.0 * white + walk * dt
    try:
        root = cholesky_banded(band, lower=True)
    except LinAlgError:  # by rounding, where nothing is left but white noise
        return math.inf
    solved = solveh_banded(band, steps, lower=True)
    return float(np.log(root[0]).sum() + 0.5 * steps @ solved)
