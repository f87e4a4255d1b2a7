"""How far a calibrated rover's dead reckoning errs: slip along and across, by maximum likelihood.

What is compared is where dead reckoning ends with where the rover was, on drives whose own session was left
out of the fit: so what the dimensions are still off by is in it, and a rover that drives with this noise is
as far off as it says. Slip grows with the root of the way, whatever the rate of the samples. Beside
dimensions whose errors are counted by themselves, it holds the rest.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq, minimize
from scipy.special import chdtri, fdtri, ndtri

from six_wheel._core import Gyroscope, Noise, Rover, wrap_angle
from six_wheel.calibration.drives import RESTED, at_rest
from six_wheel.calibration.values import Estimate
from six_wheel.logs import Log
from six_wheel.odometry import dead_reckon
from six_wheel.poses import Floats, inverse, joined

# What the truth itself is not better than [m, m, rad]: motion capture.
TRUTH = np.array([1e-3, 1e-3, 1e-3])
# Sections a few runs are cut into, and from how many runs on each is one section.
PIECES, ENOUGH = 4, 4
# Slip that is looked for [m per root m].
LEAST, MOST = 1e-5, 3.0
# Nothing that rolls slips less [m per root m].
FINEST = 1e-4
# Of ends that shall lie within what is said of them.
COVERED = 0.95


@dataclass(frozen=True, eq=False)
class MeasuredNoise:
    """Noise that was measured.

    Attributes
    ----------
    noise : Noise
        To give to `Odometry`; `speed` and `steering` are 0, for slip holds all that ends err by.
    beside : Noise
        The same where `Odometry` is given `Calibration.dimensions` as well: without what these explain.
    slip, side_slip : Estimate
        Along and across the wheels [m per root m], by maximum likelihood, with intervals.
    sections : int
        Stretches whose ends were compared.
    basis : str
        What these were.
    nees : ndarray, shape (sections,)
        Normalised error squared of their ends under `noise`: 95 % are meant to lie below 7.81.
    yaw_rate : Estimate or None
        Of one reading of the gyroscope [rad/s], from where the rover stands; None where no log has one and
        stands for a second.
    gyroscope : Gyroscope or None
        The same with the bias at rest, to give to `Odometry` beside `noise`, which counts the bias as noise.
    """

    noise: Noise
    beside: Noise
    slip: Estimate
    side_slip: Estimate
    sections: int
    basis: str
    nees: Floats
    yaw_rate: Estimate | None = None
    gyroscope: Gyroscope | None = None

    @property
    def covered(self) -> float:
        """Share of the ends within the 95 % bound."""
        return float(np.mean(self.nees <= _bound()))

    def __repr__(self) -> str:
        return f"MeasuredNoise({self.noise!r}, {100 * self.covered:.0f} % of {self.basis} within their bound)"


@dataclass(frozen=True, eq=False)
class End:
    """Error of an end (3,), and its covariance (3, 3) by slip of 1 m per root m along and across, and by what
    the dimensions may be off."""

    error: Floats
    along: Floats
    across: Floats
    fixed: Floats


def _bound() -> float:
    return float(chdtri(3, 1.0 - COVERED))


def ends(rover: Rover, dimensions: Floats, log: Log, sensor: Floats, offset: float, pieces: int) -> list[End]:
    """Where dead reckoning of a log ends, against the truth, for each of so many pieces of it."""
    if log.truth is None:
        return []
    truth = log.truth.at(log.stamps + offset)
    known = np.flatnonzero(np.isfinite(truth).all(axis=1))
    if len(known) < 2 * pieces:
        return []
    body = joined(truth[known], np.broadcast_to(inverse(sensor), (len(known), 3)))
    found = []
    for rows in np.array_split(np.arange(len(known)), pieces):
        first, last = int(rows[0]), int(rows[-1])
        part = known[first : last + 1]
        readings = (
            None if log.steering is None else log.steering[part],
            log.wheel_angles[part],
            log.stamps[part],
        )
        tracks = [
            dead_reckon(rover, *readings, noise=noise, start=body[first], residuals=False, dimensions=doubt)
            for noise, doubt in (
                (Noise(0.0, 0.0, slip=1.0), None),
                (Noise(0.0, 0.0, side_slip=1.0), None),
                (Noise(0.0, 0.0), dimensions),
            )
        ]
        along, across, fixed = (track.covariances[-1] for track in tracks)  # type: ignore[index]
        error = tracks[0].poses[-1] - body[last]
        error[2] = wrap_angle(error[2])
        if np.trace(along) > 0.0:  # it moved
            found.append(End(error, along, across, fixed))
    return found


def measure(
    groups: Sequence[Sequence[End]], sessions: int, confidence: float, basis: str
) -> MeasuredNoise | None:
    """Slip that makes errors most likely, sized for a session that is not among them; None without an end.

    Ends of one session go together: each tells three numbers of how large errors are, however many runs it
    has, and all weigh alike. Of a variance known from so few numbers 95 % of what is new lies within more
    than the bound of one that is known for sure: the size is that of a prediction, the wider the fewer.

    Parameters
    ----------
    groups : sequence of sequence of End
        Errors of what was left out together.
    sessions : int
        How many there were.

    Source: Fisher's F, as in Geisser, Predictive Inference: An Introduction, 1993, ch. 2.
    """
    groups = [group for group in groups if group]
    if not groups:
        return None
    whole = _stacked([end for group in groups for end in group])
    sides = np.trace(whole[2], axis1=1, axis2=2).max() > 1e-9 * np.trace(whole[1], axis1=1, axis2=2).max()
    usual = _bound() / float(fdtri(3, 3 * min(sessions, len(groups)), COVERED))
    noises = []
    for share in (1.0, 0.0):  # what the dimensions explain counts by itself, and last as slip

        def cost(logs: Floats, share: float = share) -> float:
            logs = np.clip(logs, math.log(LEAST), math.log(MOST))
            squares, sizes = _nees(logs, whole, share)
            return 0.5 * float((squares + sizes).sum())

        begin = [np.array([a, b]) for a in np.log([1e-3, 1e-2, 1e-1]) for b in np.log([1e-4, 1e-2])]
        best = min((minimize(cost, start, method="Nelder-Mead") for start in begin), key=lambda one: one.fun)
        logs = np.clip(best.x, math.log(LEAST), math.log(MOST))
        wide = logs + _widening(logs, [_stacked(group) for group in groups], share, usual)
        slip, side_slip = (_digits(max(float(np.exp(one)), FINEST)) for one in wide)
        noises.append(Noise(0.0, 0.0, slip=slip, side_slip=side_slip if sides else 0.0))
    across_wheels = Estimate("side_slip", "m per root m", 0.0, 0.0, 0.0, (0.0, 0.0))
    if sides:
        across_wheels = _estimate("side_slip", logs, 1, cost, confidence)
    along_wheels, nees = _estimate("slip", logs, 0, cost, confidence), _nees(wide, whole, 0.0)[0]
    return MeasuredNoise(noises[1], noises[0], along_wheels, across_wheels, len(nees), basis, nees)


def with_gyroscope(measured: MeasuredNoise, logs: Sequence[Log], confidence: float) -> MeasuredNoise:
    """What was measured, and what a gyroscope errs by about its mean where the rover stands for a second."""
    squares, degrees, biases = 0.0, 0, []
    for log in logs:
        for rates in _resting(log):
            squares += float(np.square(rates - rates.mean()).sum())
            degrees += len(rates) - 1
            biases.append(rates.mean())
    if degrees < 1 or squares == 0.0:
        return measured
    chance = (1.0 - confidence) / 2.0
    interval = [math.sqrt(squares / float(chdtri(degrees, one))) for one in (chance, 1.0 - chance)]
    value = math.sqrt(squares / degrees)
    std = value / math.sqrt(2.0 * degrees)
    bias = math.sqrt(float(np.mean(np.square(biases))))
    rate = _digits(math.hypot(value, bias))
    noise, beside = (
        Noise(0.0, 0.0, slip=was.slip, side_slip=was.side_slip, yaw_rate=rate)
        for was in (measured.noise, measured.beside)
    )
    return replace(
        measured,
        noise=noise,
        beside=beside,
        yaw_rate=Estimate("yaw_rate", "rad/s", 0.0, value, std, (interval[0], interval[1])),
        gyroscope=Gyroscope(_digits(value), bias_noise=_digits(bias)),
    )


def _resting(log: Log) -> Iterator[Floats]:
    """Readings of a gyroscope (k,) inside each stretch in which no wheel turns for a second or more."""
    if log.yaw_rate is None:
        return
    rows = np.flatnonzero(np.isfinite(log.yaw_rate) & np.isfinite(log.stamps))
    rows = rows[np.concatenate(([True], np.diff(log.stamps[rows]) > 0.0))] if len(rows) else rows
    if len(rows) < 2:
        return
    dt = np.diff(log.stamps[rows])
    still = at_rest(np.diff(log.wheel_angles[rows], axis=0) / dt[:, None])
    edges = np.flatnonzero(np.diff(np.concatenate(([False], still, [False])).astype(int)))
    for first, last in edges.reshape(-1, 2).tolist():
        if dt[first:last].sum() >= RESTED and last - first > 2:
            yield log.yaw_rate[rows[first + 1 : last]]  # at its ends the rover may already move


Stack = tuple[Floats, Floats, Floats, Floats]


def _stacked(found: Sequence[End]) -> Stack:
    errors, along, across, fixed = (
        np.array([getattr(end, name) for end in found]) for name in ("error", "along", "across", "fixed")
    )
    return errors, along, across, fixed


def _widening(logs: Floats, groups: Sequence[Stack], share: float, wanted: float) -> float:
    """By how much to move both logarithms of slip so that normalised errors squared come to what is wanted,
    in the mean over groups."""

    def excess(by: float) -> float:
        return math.log(np.mean([_nees(logs + by, group, share)[0].mean() for group in groups]) / wanted)

    low, high = math.log(LEAST), math.log(MOST)
    if excess(low) <= 0.0:
        return low  # the dimensions alone explain all
    return float(brentq(excess, low, high)) if excess(high) < 0.0 else high


def _nees(logs: Floats, ends: Stack, share: float) -> tuple[Floats, Floats]:
    """Normalised errors squared, and logarithms of determinants, under logarithms of slip and a share of what
    the dimensions explain."""
    errors, along, across, fixed = ends
    spread = math.exp(2.0 * logs[0]) * along + math.exp(2.0 * logs[1]) * across
    spread += share * fixed + np.diag(TRUTH**2)
    solved = np.linalg.solve(spread, errors[:, :, None])[:, :, 0]
    return (errors * solved).sum(axis=1), np.linalg.slogdet(spread)[1]


def _digits(value: float) -> float:
    """Three digits: more are not known."""
    return float(f"{value:.3g}")


def _estimate(
    name: str, logs: Floats, place: int, cost: Callable[[Floats], float], confidence: float
) -> Estimate:
    """A value with its interval by the profile of the likelihood: where it is not too unlikely."""
    allowed = cost(logs) + 0.5 * float(chdtri(1, 1.0 - confidence))
    interval = []
    for side in (-1.0, 1.0):
        edge = math.log(LEAST if side < 0.0 else MOST)
        near, far = logs[place], edge
        for _ in range(30):
            middle = (near + far) / 2.0
            trial = logs.copy()
            trial[place] = middle
            near, far = (middle, far) if cost(trial) <= allowed else (near, middle)
        interval.append(math.exp(near))
    value = math.exp(logs[place])
    std = (interval[1] - interval[0]) / (2.0 * float(ndtri(0.5 + confidence / 2.0)))
    return Estimate(name, "m per root m", 0.0, value, std, (interval[0], interval[1]))
