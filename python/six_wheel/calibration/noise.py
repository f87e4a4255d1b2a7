"""Noise of a calibrated rover's dead reckoning: slip along and across, by maximum likelihood.

What is compared is where dead reckoning ends with where the rover was, on drives whose own session was left
out of the fit: so what the dimensions are still off by is in it, and a rover that drives with this noise is
as far off as it says. Slip grows with the root of the way, whatever the rate of the samples. Beside
dimensions whose errors are counted by themselves, it holds the rest.
"""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize
from scipy.special import chdtri, fdtri

from six_wheel._core import Gyroscope, Noise, Rover, wrap_angle
from six_wheel.calibration.estimates import Estimate, likelihood_end, three_digits
from six_wheel.calibration.log_checks.records import with_truth
from six_wheel.calibration.wheel_noise import normalised, told_apart
from six_wheel.kinematics.errors import SuspiciousReadingsWarning
from six_wheel.kinematics.poses import Floats, inverse, joined
from six_wheel.log_odometry import dead_reckon
from six_wheel.log_odometry.copies import without_copies
from six_wheel.logs import WheelLog
from six_wheel.logs.detect_reader import as_logs
from six_wheel.robot_description.dimensions import NUMBERS

# Standard deviation of the truth itself [m, m, rad]: motion capture.
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
        The same where `Odometry` is given `Calibration.dimensions` and `wheel_noise` as well: without what
        these explain.
    slip, side_slip : Estimate
        Along and across the wheels [m per root m], by maximum likelihood, with intervals.
    sections : int
        Stretches whose ends were compared.
    basis : str
        Kind of these units.
    nees : ndarray, shape (sections,)
        Normalised error squared of their ends under `noise`: 95 % are meant to lie below 7.81.
    yaw_rate : Estimate or None
        Of one reading of the gyroscope [rad/s], from where the rover stands; None where no log has one and
        stands for a second.
    wheels : tuple of Estimate
        Factor on it of each wheel; none where the ends do not tell wheels apart.
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
    wheels: tuple[Estimate, ...] = ()
    gyroscope: Gyroscope | None = None

    @property
    def covered(self) -> float:
        """Share of the ends within the 95 % bound."""
        return float(np.mean(self.nees <= _bound()))

    @property
    def wheel_noise(self) -> dict[str, float] | None:
        """For `Odometry`, by the names of the wheels."""
        return {one.name: one.value for one in self.wheels} or None

    def __repr__(self) -> str:
        return f"MeasuredNoise({self.noise!r}, {100 * self.covered:.0f} % of {self.basis} within their bound)"


# Errors, covariances by slip along and across, and by the rest.
Weighed = tuple[Floats, Floats, Floats, Floats]


class End(NamedTuple):
    """Error of an end (3,), and its covariance by slip of 1 m per root m along and across each of the wheels
    (wheels, 2, 3, 3), and by what the dimensions may be off (3, 3); or arrays of these, of many ends."""

    error: Floats
    wheels: Floats
    fixed: Floats

    def weighed(self, times: Floats, share: float = 0.0) -> Weighed:
        """With so many times the slip for each wheel, and a share of what the dimensions explain."""
        along, across = np.einsum("w,ewkij->keij", times * times, self.wheels)
        return self.error, along, across, share * self.fixed + np.diag(TRUTH**2)


def _bound() -> float:
    return float(chdtri(3, 1.0 - COVERED))


def ends(
    rover: Rover, dimensions: Floats, log: WheelLog, sensor: Floats, offset: float, pieces: int
) -> list[End]:
    """Ends of dead reckoning against the truth, for each of `pieces` pieces of a log."""
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
        part = slice(known[first], known[last] + 1)  # rows without a known truth are driven as well
        readings = (
            None if log.steering is None else log.steering[part],
            log.wheel_angles[part],
            log.stamps[part],
        )
        end = partial(_end, rover, readings, body[first])
        pose, fixed = end(Noise(0.0, 0.0), dimensions=dimensions)
        kinds = Noise(0.0, 0.0, slip=1.0), Noise(0.0, 0.0, side_slip=1.0)
        wheels = [
            [end(noise, wheel_noise=alone)[1] for noise in kinds] for alone in np.eye(len(rover.wheels))
        ]
        error = pose - body[last]
        error[2] = wrap_angle(error[2])
        if np.any(wheels):  # it moved
            found.append(End(error, np.array(wheels), fixed))
    return found


def _end(
    rover: Rover, readings: tuple[Floats | None, Floats, Floats], start: Floats, noise: Noise, **options: Any
) -> tuple[Floats, Floats]:
    """Pose at the end of a drive (3,), and its covariance (3, 3)."""
    track = dead_reckon(
        rover, *readings, noise=noise, start=start, residuals=False, plausibility=False, **options
    )
    assert track.covariances is not None
    return track.poses[-1], track.covariances[-1]


def noise_of(rover: Rover, logs: Any, truth: Any = None) -> Noise:
    """See `Noise.from_logs`."""
    drives = [log.in_radians(rover) for log in with_truth(as_logs(logs, rover), truth)]
    if not all(log.truth is not None and log.truth.has_positions and log.truth.has_yaw for log in drives):
        raise ValueError("logs must have their truth, with positions and yaw: give truth")
    drives, _, copies = without_copies(drives)
    for line in copies:
        warnings.warn(line, SuspiciousReadingsWarning, stacklevel=3)
    pieces, exact = 1 if len(drives) >= ENOUGH else PIECES, np.zeros((0, len(rover.wheels), NUMBERS))
    sessions: dict[str, list[End]] = {}
    for number, log in enumerate(drives):
        found = ends(rover, exact, log, np.zeros(3), 0.0, pieces)
        sessions.setdefault(log.session or str(number), []).extend(found)
    measured = measure(list(sessions.values()), rover.wheel_names, len(sessions), COVERED, "ends of runs")
    if measured is None:
        raise ValueError("logs must hold a drive within their truth, got none that moves")
    return measured.noise


def measure(
    groups: Sequence[Sequence[End]], names: Sequence[str], sessions: int, confidence: float, basis: str
) -> MeasuredNoise | None:
    """Slip that makes errors most likely, sized for a session that is not among them; None without an end.

    `groups` are the errors of what was left out together, `names` those of the wheels.

    Ends of one session go together: each tells three numbers of how large errors are, however many runs it
    has, and all weigh alike. Of a variance known from so few numbers 95 % of what is new lies within more
    than the bound of one that is known for sure: the size is that of a prediction, the wider the fewer.

    Source: Fisher's F, as in Geisser, Predictive Inference: An Introduction, 1993, ch. 2.
    """
    groups = [group for group in groups if group]
    if not groups:
        return None
    sessions = min(sessions, len(groups))
    stacks = [End(*map(np.array, zip(*group, strict=True))) for group in groups]
    alike = np.ones(len(names))
    whole = End(*map(np.concatenate, zip(*stacks, strict=True)))
    usual = _bound() / float(fdtri(3, 3 * sessions, COVERED))
    logs, cost = _likeliest(whole.weighed(alike))
    noise, wide = _sized(logs, [stack.weighed(alike) for stack in stacks], usual)
    nees = _nees(wide, whole.weighed(alike))[0]
    along_wheels, across_wheels = (
        _estimate(name, logs, place, cost, confidence)
        if np.any(whole.wheels[:, :, place])
        else Estimate(name, "m per root m", 0.0, 0.0, 0.0, (0.0, 0.0))
        for place, name in enumerate(("slip", "side_slip"))
    )
    # Differences between wheels and errors of the dimensions count by themselves; slip is the rest.
    common = np.exp(2.0 * logs)[:, None, None] * whole.wheels
    told = told_apart(whole.error, common, whole.fixed + np.diag(TRUTH**2), sessions, confidence)
    times = alike if told is None else np.array([three_digits(one) for one in told[0]])
    logs, _ = _likeliest(whole.weighed(times, 1.0))
    beside, _ = _sized(logs, [stack.weighed(times, 1.0) for stack in stacks], usual)
    wheels = []
    for number, name in enumerate(names if told is not None else ()):
        interval = told[1][number].tolist()  # type: ignore[index]
        wheels.append(Estimate.of_interval(name, "", 1.0, float(times[number]), interval, confidence))
    return MeasuredNoise(
        noise, beside, along_wheels, across_wheels, len(nees), basis, nees, wheels=tuple(wheels)
    )


def _likeliest(ends: Weighed) -> tuple[Floats, Callable[[Floats], float]]:
    """Logarithms of slip along and across that make errors most likely, and how unlikely others do."""

    def cost(logs: Floats) -> float:
        logs = np.clip(logs, math.log(LEAST), math.log(MOST))
        squares, sizes = _nees(logs, ends)
        return 0.5 * float((squares + sizes).sum())

    begin = [np.array([a, b]) for a in np.log([1e-3, 1e-2, 1e-1]) for b in np.log([1e-4, 1e-2])]
    best = min((minimize(cost, start, method="Nelder-Mead") for start in begin), key=lambda one: one.fun)
    logs = np.clip(best.x, math.log(LEAST), math.log(MOST))
    if np.allclose(ends[1], ends[2], rtol=1e-9, atol=0.0):
        # Rollers at 45 degrees pass all on: one is never told from the other, so they are taken to be alike.
        logs = np.full(2, 0.5 * math.log(float(np.mean(np.exp(2.0 * logs)))))
    return logs, cost


def _sized(logs: Floats, groups: Sequence[Weighed], wanted: float) -> tuple[Noise, Floats]:
    """Noise with logarithms of slip moved alike so that normalised errors squared come to what is wanted, in
    the mean over groups."""

    def excess(by: float) -> float:
        return math.log(np.mean([_nees(logs + by, group)[0].mean() for group in groups]) / wanted)

    low, high = math.log(LEAST), math.log(MOST)
    if excess(low) <= 0.0:
        wide = logs + low  # the dimensions alone explain all
    else:
        wide = logs + (float(brentq(excess, low, high)) if excess(high) < 0.0 else high)
    slip, side_slip = (three_digits(max(float(np.exp(one)), FINEST)) for one in wide)
    sides = any(np.any(group[2]) for group in groups)
    return Noise(0.0, 0.0, slip=slip, side_slip=side_slip if sides else 0.0), wide


def _nees(logs: Floats, ends: Weighed) -> tuple[Floats, Floats]:
    """Normalised errors squared, and logarithms of determinants, under logarithms of slip."""
    errors, along, across, rest = ends
    spread = math.exp(2.0 * logs[0]) * along + math.exp(2.0 * logs[1]) * across + rest
    return normalised(errors, spread)


def _estimate(
    name: str, logs: Floats, place: int, cost: Callable[[Floats], float], confidence: float
) -> Estimate:
    """A value with its interval by the profile of the likelihood: where it is not too unlikely."""
    allowed = cost(logs) + 0.5 * float(chdtri(1, 1.0 - confidence))

    def profile(value: float) -> float:
        trial = logs.copy()
        trial[place] = value
        return cost(trial)

    ends = (likelihood_end(profile, allowed, logs[place], math.log(edge)) for edge in (LEAST, MOST))
    interval = [math.exp(end) for end in ends]
    return Estimate.of_interval(name, "m per root m", 0.0, math.exp(logs[place]), interval, confidence)
