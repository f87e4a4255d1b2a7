"""True motion of a simulated rover: joints, poses and wheels with slip, in steps finer than any sampling."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Noise, Rover, integrate
from six_wheel.kinematics.errors import ArgumentTypeError, shown
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.recordings import GroundTruth, WheelLog
from six_wheel.simulation.controlled import Controlled
from six_wheel.simulation.course import Course

# Rows of the true motion per sample: what is lost between them is far below what any sensor sees.
FINER = 8
BLOCK = 4096  # rows between two looks at signals
MOST_SAMPLES = 10**8  # of a simulated log


@checked_class
@dataclass(frozen=True, slots=True)
class Slip:
    """A stretch in which wheels slip for a reason.

    Parameters
    ----------
    start, stop : float
        From when to when [s].
    wheels : sequence of str, optional
        Wheels that spin, default all with a motor.
    ratio : float
        Share of their turning that is lost: at 0.5 they turn twice as far as they roll; below 1.
    drift : tuple of float
        Twist ``(vx, vy, omega)`` of the body beside what its wheels do, as on a slope, in body axes.
    """

    start: float
    stop: float
    wheels: Sequence[str] | None = None
    ratio: float = 0.0
    drift: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not (math.isfinite(self.start) and math.isfinite(self.stop) and self.start < self.stop):
            raise ValueError(f"stop must be later than start, {self.start}, got {self.stop}")
        if not -math.inf < self.ratio < 1.0:
            raise ValueError(f"ratio must be finite and below 1, got {self.ratio}")
        if len(self.drift) != 3 or not all(map(math.isfinite, self.drift)):
            raise ValueError(f"drift must be three finite numbers, got {self.drift}")


@dataclass(frozen=True, eq=False)
class Motion:
    """True motion, the interface between the model of the rover and that of its sensors.

    `stamps` (n,) [s]; `poses` (n, 3) [m, m, rad]; `steering` (n, steered) [rad]; `turned` (n, wheels),
    running totals [rad]; `yaw_rate` (n,) about the body's vertical axis [rad/s]. Between rows everything
    changes evenly.
    """

    stamps: Floats
    poses: Floats
    steering: Floats
    turned: Floats
    yaw_rate: Floats

    def at(self, stamps: Floats) -> "Motion":
        """The same at other times within it."""
        columns = np.column_stack((self.poses, self.steering, self.turned, self.yaw_rate))
        row = np.clip(np.searchsorted(self.stamps, stamps, side="right") - 1, 0, len(self.stamps) - 2)
        share = (stamps - self.stamps[row]) / (self.stamps[row + 1] - self.stamps[row])
        values = columns[row] + share[:, None] * (columns[row + 1] - columns[row])
        joints, wheels = self.steering.shape[1], self.turned.shape[1]
        poses, steering, turned, rate = np.split(values, np.cumsum((3, joints, wheels)), axis=1)
        return Motion(stamps, poses, steering, turned, rate[:, 0])


@checked_class
@dataclass(frozen=True, eq=False, repr=False)
class Simulation(WheelLog):
    """A log with its truth, and what only a simulation knows.

    Attributes
    ----------
    motion : Motion
        The true motion, eight times as fine as the samples.
    controlled : Controlled or None
        Record of the controller, of a drive with a joint that sticks.
    """

    truth: GroundTruth = field(kw_only=True)
    """The true poses at the times of the rows."""
    motion: Motion | None = None
    controlled: Controlled | None = None


def generator(seed: int) -> np.random.Generator:
    """Random generator, the same for the same seed."""
    try:
        return np.random.default_rng(seed)
    except (TypeError, ValueError):
        raise ArgumentTypeError(f"seed must be a whole number, 0 or more, got {shown(seed)}") from None


def step_of(course: Course, rate: float) -> float:
    """Longest time between two rows of the motion [s] at `rate` samples per second. Raises `ValueError` if
    the samples would be too many, or fewer than two."""
    duration = float(course.stamps[-1] - course.stamps[0])
    if not 1.0 <= duration * rate <= MOST_SAMPLES:
        rule = f"at most {MOST_SAMPLES:,}" if duration * rate > 1.0 else "at least two"
        raise ValueError(f"rate must make {rule} samples of {duration:g} s, got {rate:g}")
    return 1.0 / (FINER * rate)


@dataclass(frozen=True, eq=False)
class SlippingRover:
    """A rover on a plane whose contacts slip: by chance, with `noise.slip` and `noise.side_slip` per root
    metre, independently, and as `slips` say. The body goes where the sliding of all of them is least, as
    odometry has it."""

    rover: Rover
    noise: Noise
    slips: Sequence[Slip]
    random: np.random.Generator

    def drive(self, course: Course, step: float, start: Floats) -> Motion:
        """Simulate the motion of a rover whose wheels do what they are told, in rows at most a `step` apart
        [s]."""
        rover, begin, end = self.rover, course.stamps[0], course.stamps[-1]
        count = max(math.ceil((end - begin) / step), 1)
        stamps = np.linspace(begin, end, count + 1)
        # Between two twists that a rover can make there may be some that it cannot.
        steering = _along(rover, rover.project(course.at(stamps), keep="nearest"))[0]
        middle = (steering[1:] + steering[:-1]) / 2.0
        wanted = rover.project(course.at((stamps[1:] + stamps[:-1]) / 2.0), keep="nearest")
        return self.follow_joints(stamps, steering, _along(rover, wanted, middle)[1], start)

    def follow_joints(self, stamps: Floats, steering: Floats, speeds: Floats, start: Floats) -> Motion:
        """The motion under steering angles (n, steered) at evenly spaced `stamps` (n,) and wheel speeds
        (n - 1, wheels) between them; where they contradict each other, the sliding is least."""
        rover, dt = self.rover, stamps[1] - stamps[0]
        middle = (steering[1:] + steering[:-1]) / 2.0
        rates = np.diff(steering, axis=0) / dt
        twists = rover.forward(middle, speeds, steering_rates=rates)
        twists = twists + self._sliding(middle, speeds, rates, twists, dt)
        turning = speeds.copy()
        for slip in self.slips:
            twists[during(slip, stamps)] += np.array(slip.drift)
        self.spin(stamps, turning)
        turned = np.concatenate((np.zeros((1, len(rover.wheels))), np.cumsum(turning * dt, axis=0)))
        rate = np.concatenate((twists[:1, 2], (twists[1:, 2] + twists[:-1, 2]) / 2.0, twists[-1:, 2]))
        return Motion(stamps, integrate(twists, dt, start=start), steering, turned, rate)

    def spin(self, stamps: Floats, turning: Floats) -> None:
        """Turns wheels further than they roll: `turning` (n - 1, wheels) [rad/s], in place."""
        for slip in self.slips:
            for wheel in _wheels(self.rover, slip):
                turning[during(slip, stamps), wheel] /= 1.0 - slip.ratio

    def _sliding(self, steering: Floats, speeds: Floats, rates: Floats, twists: Floats, dt: float) -> Floats:
        """Random change of the twists by slip of the contacts, (n, 3)."""
        rover, noise = self.rover, self.noise
        if noise.slip == 0.0 and noise.side_slip == 0.0:
            return np.zeros_like(twists)
        by = rover.sensitivity(steering, speeds, steering_rates=rates, quantities=("slip", "side_slip"))
        places = np.array([(wheel.x, wheel.y) for wheel in rover.wheels])
        vx = twists[:, 0, None] - twists[:, 2, None] * places[:, 1]
        vy = twists[:, 1, None] + twists[:, 2, None] * places[:, 0]
        root = np.sqrt(np.hypot(vx, vy) * dt) / dt
        added = np.zeros_like(twists)
        for deviation, by_slip in ((noise.slip, by.slip), (noise.side_slip, by.side_slip)):
            slid = deviation * root * self.random.standard_normal(root.shape)
            added += np.einsum("nij,nj->ni", by_slip, slid)
        return added


def _along(rover: Rover, twists: Floats, near: Floats | None = None) -> tuple[Floats, Floats]:
    """Steering angles and wheel speeds along twists: of two equivalent angles the one nearer to that of
    the row in `near`, or to the one before."""
    if not rover.steered_wheel_names:
        return np.empty((len(twists), 0)), rover.inverse(twists)[1]
    angles = np.empty((len(twists), len(rover.steered_wheel_names)))
    speeds = np.empty((len(twists), len(rover.wheels)))
    moves = twists.any(axis=1)
    previous = rover.inverse(twists[moves.argmax()])[0]
    for begin in range(0, len(twists), BLOCK):
        for row, twist in enumerate(twists[begin : begin + BLOCK].tolist(), begin):
            angles[row], speeds[row] = rover.inverse(
                tuple(twist), previous=previous if near is None else near[row]
            )
            previous = angles[row]
    return angles, speeds


def during(slip: Slip, stamps: Floats) -> NDArray[np.bool_]:
    """True for the steps between these stamps that the slip covers, (n - 1,)."""
    return (stamps[:-1] >= slip.start) & (stamps[1:] <= slip.stop)


def _wheels(rover: Rover, slip: Slip) -> list[int]:
    names = list(rover.wheel_names)
    if slip.wheels is None:
        return [number for number, wheel in enumerate(rover.wheels) if wheel.driven]
    for name in slip.wheels:
        if name not in names:
            raise ValueError(f"wheels must be some of {', '.join(names)}, got {name!r}")
    return [names.index(name) for name in slip.wheels]
