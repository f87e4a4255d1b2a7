"""A recorded path as twists, and rovers driven along it.

A tricycle robot was followed by motion capture. Its path becomes twists at their true time stamps, two rovers
drive them, and odometry from the rovers' joint commands leads back to the path.
"""

import math
from dataclasses import dataclass
from importlib import resources

import numpy as np
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import Rover, differentiate, integrate
from six_wheel.kinematics.poses import Floats

ROVERS = {"perseverance": "Perseverance", "open_source_rover": "Open Source Rover"}
SMOOTHING = 2.0  # [s] width of the local quadratics; their weights make half of it count
REST_SPEED = 0.005  # [m/s] slower than this the noise of the recording hides which way the robot goes
REST_YAW_RATE = 0.02  # [rad/s] the same for its heading
SUSTAINED = 1.0  # [s] what is held for less is the beginning or end of something else


@dataclass(frozen=True, eq=False)
class DemoMotion:
    """DemoMotion of the recorded robot, seen from its fixed axle, where a robot cannot move sideways."""

    times: Floats
    """(n,) time stamps [s]."""
    poses: Floats
    """(n, 3) recorded x, y, yaw of the axle, not smoothed [m, m, rad]."""
    twists: Floats
    """(n - 1, 3) smoothed motion from each pose to the next [m/s, m/s, rad/s]."""
    start: Floats
    """(3,) smoothed first pose."""
    frame: tuple[float, float]
    """Recorded frame, seen from the axle: yaw [rad] and distance ahead [m]."""


@dataclass(frozen=True, eq=False)
class DemoResult:
    """One rover's drive along the recording; commands hold from their time to the next."""

    name: str
    rover: Rover
    scale: float
    tightest_radius: float
    """Smallest radius of the turns held for `SUSTAINED` seconds, before scaling [m]."""
    needed_radius: float
    """The tightest turn this rover is asked to drive [m]."""
    times: Floats
    recorded: Floats
    """(n, 3) recorded poses, scaled."""
    asked: Floats
    """(n - 1, 3) twists of the recording, scaled."""
    twists: Floats
    """(n - 1, 3) twists the rover was given."""
    steering: Floats
    """(n - 1, steered wheels) joint angles [rad]."""
    wheel_speeds: Floats
    """(n - 1, wheels) wheel speeds [rad/s]."""
    driven: Floats
    """(n, 3) where the twists lead."""
    odometry: Floats
    """(n, 3) where odometry from the joint commands leads."""

    @property
    def length(self) -> float:
        """Length of the driven path [m]."""
        return float(np.sum(np.hypot(*np.diff(self.driven[:, :2], axis=0).T)))

    @property
    def deviation(self) -> Floats:
        """(n,) distance from the recorded to the driven position at the same time [m]."""
        return np.asarray(np.hypot(*(self.driven - self.recorded)[:, :2].T))

    @property
    def closing_error(self) -> tuple[float, float]:
        """Largest distance [m] and turn [rad] between odometry and the integrated twists."""
        error = np.abs(self.odometry - self.driven)
        return float(np.max(np.hypot(error[:, 0], error[:, 1]))), float(np.max(error[:, 2]))

    @property
    def steering_rates(self) -> Floats:
        """(n - 2, steered wheels) turning rate of the joints from each command to the next [rad/s]."""
        return np.diff(self.steering, axis=0) / np.diff(self.times[:-1])[:, None]


def load_path() -> tuple[Floats, Floats]:
    """The recording shipped with the package: times (n,) [s] and poses (n, 3) x, y, yaw [m, m, rad]."""
    source = resources.files("six_wheel.cli.demo") / "data" / "optiodom_tricycle_free.csv"
    with source.open(encoding="utf-8") as lines:
        table = np.loadtxt(lines, delimiter=",", skiprows=1)
    return table[:, 0], table[:, 1:]


def recorded_motion(times: ArrayLike, poses: ArrayLike) -> DemoMotion:
    """Twists of a recorded robot with a fixed axle, from its poses (n, 3) [m, m, rad] at evenly spaced times
    (n,) [s].

    Positions and yaw are smoothed by local quadratics. The recorded frame is never exactly the robot's: the
    yaw and the distance ahead of the axle that explain most of its sideways motion are fitted and taken out.
    Below `REST_SPEED` the robot turns on the spot or, below `REST_YAW_RATE` too, stands. So it does where it
    drives or turns for less than `SUSTAINED` seconds. Raises `ValueError` if the shapes do not fit or the
    times are not evenly spaced.
    """
    stamps, recorded = np.asarray(times, dtype=np.float64), np.array(poses, dtype=np.float64)
    if stamps.ndim != 1 or recorded.shape != (len(stamps), 3) or len(stamps) < 3:
        raise ValueError(
            f"poses must have shape (n, 3) with n times, n >= 3, got {recorded.shape}, {stamps.shape}"
        )
    steps = np.diff(stamps)
    if not np.allclose(steps, steps[0], rtol=1e-3) or steps[0] <= 0.0:
        raise ValueError(f"times must be evenly spaced, got steps from {steps.min():g} to {steps.max():g} s")
    recorded[:, 2] = np.unwrap(recorded[:, 2])

    half = max(1, round(SMOOTHING / 2 / steps[0]))
    smoothed = _smooth(recorded, half)
    raw = differentiate(smoothed, steps)
    moving = (np.abs(raw[:, 0]) > REST_SPEED) | (np.abs(raw[:, 2]) > REST_YAW_RATE)
    # A point `ahead` of the axle, whose frame is turned by `yaw`, sees vy = ahead omega - yaw vx.
    (turned, ahead), *_ = np.linalg.lstsq(raw[moving][:, [0, 2]], raw[moving, 1], rcond=None)
    frame = -float(turned), float(ahead)
    start = _axle(smoothed[:1], frame)[0]
    twists = differentiate(_axle(smoothed, frame), steps)

    held = round(SUSTAINED / steps[0])
    driving = _held(np.abs(twists[:, 0]) > REST_SPEED, held)
    turning = _held(~driving & (np.abs(twists[:, 2]) > REST_YAW_RATE), held)
    twists[~driving, :2] = 0.0
    twists[~(driving | turning)] = 0.0
    return DemoMotion(stamps, _axle(recorded, frame), twists, start, frame)


def drive_path(rover: Rover, name: str, times: ArrayLike, poses: ArrayLike) -> DemoResult:
    """Drive a rover along a recorded path, as large as the rover needs it, and come back by odometry.

    The path is scaled, time stamps as they are, so that in its tightest sustained turn the centre of rotation
    stays outside the rover's wheels. `Rover.project` takes out what the rover cannot do. While it stands, its
    wheels turn to the angles the next motion begins with. `name` is for the report. Raises `ValueError` as
    `recorded_motion` does, and if the rover cannot turn or the robot never moved.
    """
    motion = recorded_motion(times, poses)
    steps = np.diff(motion.times)
    tightest = _tightest_turn(motion.twists, steps)
    needed = max(rover.min_radius, max(abs(wheel.y + wheel.scrub) for wheel in rover.wheels))
    if not math.isfinite(needed):
        raise ValueError(f"{name} cannot turn, so it cannot follow a path")
    scale = max(1.0, math.ceil(100 * needed / tightest) / 100)
    enlarge = np.array((scale, scale, 1.0))

    asked = motion.twists * enlarge
    twists = rover.project(asked)
    moving = np.any(twists != 0.0, axis=1)
    if not np.any(moving):
        raise ValueError("the path must move for longer than the smoothing hides, got one at rest")
    steering, speeds = rover.inverse(twists)
    start_of_step = motion.times[:-1]
    for angles in steering.T:
        angles[:] = np.interp(start_of_step, start_of_step[moving], angles[moving])

    start = motion.start * enlarge
    return DemoResult(
        name=name,
        rover=rover,
        scale=scale,
        tightest_radius=tightest,
        needed_radius=needed,
        times=motion.times,
        recorded=motion.poses * enlarge,
        asked=asked,
        twists=twists,
        steering=steering,
        wheel_speeds=speeds,
        driven=integrate(twists, steps, start),
        odometry=integrate(rover.forward(steering, speeds), steps, start),
    )


def _smooth(poses: Floats, half: int) -> Floats:
    """Local quadratics over `half` samples to either side, tricube weights; it stands before and after."""
    offset = np.arange(-half, half + 1) / (half + 1)
    root_weight = np.sqrt((1 - np.abs(offset) ** 3) ** 3)
    powers = np.vander(offset, 3, increasing=True) * root_weight[:, None]
    kernel = np.linalg.pinv(powers)[0] * root_weight  # the constant term: the quadratic at the middle
    padded = np.pad(poses, ((half, half), (0, 0)), mode="edge")
    return np.stack([np.convolve(column, kernel[::-1], "valid") for column in padded.T], axis=1)


def _axle(poses: Floats, frame: tuple[float, float]) -> Floats:
    """Poses of the axle from poses of the recorded frame."""
    yaw, ahead = frame
    heading = poses[:, 2] - yaw
    return np.stack(
        (poses[:, 0] - ahead * np.cos(heading), poses[:, 1] - ahead * np.sin(heading), heading), axis=1
    )


def _held(condition: NDArray[np.bool_], samples: int) -> NDArray[np.bool_]:
    """True where a condition holds for at least `samples` samples in a row."""
    window = np.ones(max(1, samples))
    starts = np.convolve(condition, window, "valid") > len(window) - 0.5
    return np.asarray(np.convolve(starts, window, "full") > 0.5)


def _tightest_turn(twists: Floats, steps: Floats) -> float:
    """Smallest radius held for `SUSTAINED` seconds of driving [m]; infinity if there is none."""
    window = np.ones(max(1, round(SUSTAINED / float(steps[0]))))
    driving = np.convolve(twists[:, 0] != 0.0, window, "valid") > len(window) - 0.5
    way = np.convolve(np.abs(twists[:, 0]) * steps, window, "valid")[driving]
    turn = np.abs(np.convolve(twists[:, 2] * steps, window, "valid")[driving])
    return float(np.min(way[turn > 0] / turn[turn > 0], initial=math.inf))
