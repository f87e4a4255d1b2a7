"""The recording as commands to a controller: a new one in every step, joints with and without noise."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from six_wheel._core import Controller, Limits, Rover, integrate
from six_wheel.cli.demo.motion import DemoResult
from six_wheel.kinematics.controller import reason_shares
from six_wheel.kinematics.poses import Floats
from six_wheel.plotting.drive import drive_figure
from six_wheel.simulation.drive.min_max_thinning import Course

RATE = 50.0  # [Hz]
NOISE = 0.002  # [rad] standard deviation of the measured steering angles
SEED = 1
STANDING = 1e-3  # [m/s] of the slowest wheel that counts as driving
LIMITS = Limits(
    speed=1.0,
    acceleration=0.3,
    jerk=2.0,
    angular_acceleration=0.6,
    wheel_speed=8.0,
    steering_rate=1.0,
    halt_deceleration=1.0,
)


@dataclass(frozen=True, eq=False)
class ControlResult:
    """One drive of a rover through a controller.

    `noise` is the standard deviation of the measured steering angles [rad]. Of the steps at `times` (n,) [s]
    there are the commands and the motions they got (n, 3) [m/s, m/s, rad/s], the joint commands (n, joints)
    [rad, rad/s, rad/s] and the bits of `Reason` (n,).
    """

    name: str
    rover: Rover
    noise: float
    times: Floats
    commanded: Floats
    twists: Floats
    steering: Floats
    steering_rates: Floats
    wheel_speeds: Floats
    reasons: NDArray[np.uint32]

    @property
    def shares(self) -> dict[str, float]:
        """Share of the steps, 0 to 1, of every reason there was."""
        return reason_shares(self.reasons)

    def length(self, twists: Floats) -> float:
        """Length of the path of twists held for a step each [m]."""
        return float(np.sum(np.hypot(twists[:, 0], twists[:, 1])) / RATE)

    @property
    def standing(self) -> float:
        """Longest time for which the rover stands although it is told to drive [s]."""
        driving = np.hypot(self.commanded[:, 0], self.commanded[:, 1]) > STANDING
        waits = driving & ~self.wheel_speeds.any(axis=1)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], waits.astype(np.int8), [0]])))
        return float(np.max(np.diff(edges)[::2], initial=0.0) / RATE)

    @property
    def poses(self) -> Floats:
        """Poses of the motion at every step, shape (n, 3)."""
        return integrate(self.twists[:-1], 1.0 / RATE)


def drive_controlled(result: DemoResult, noise: float) -> ControlResult:
    """Give a controller the recorded twist of its time in every step, in the size of the rover; the measured
    steering angles have `noise` as standard deviation [rad]."""
    rover = result.rover
    begin, end = result.times[0], result.times[-2]
    times = np.arange(round((end - begin) * RATE)) / RATE
    stamps = result.times[:-1] - begin
    commanded = np.stack([np.interp(times, stamps, column) for column in result.twists.T], axis=1)
    controller = Controller(rover, LIMITS, period=1.0 / RATE)
    random = np.random.default_rng(SEED)
    measured = np.zeros(len(rover.steered_wheel_names))
    outputs = []
    for now, twist in zip(times.tolist(), commanded.tolist(), strict=True):
        controller.command((twist[0], twist[1], twist[2]), now)
        outputs.append(controller.step(now, measured))
        measured = outputs[-1].steering + noise * random.standard_normal(len(measured))
    columns = ("twist", "steering", "steering_rates", "wheel_speeds")
    twists, steering, rates, speeds = (
        np.array([getattr(output, name) for output in outputs]) for name in columns
    )
    reasons = np.array([int(output.reasons) for output in outputs], np.uint32)
    return ControlResult(
        result.name, rover, noise, times, commanded, twists, steering, rates, speeds, reasons
    )


def draw_control(result: ControlResult) -> Figure:
    """The path; commanded and driven speed, joints and reasons over time."""
    values = np.hstack(
        [result.commanded, result.twists, result.steering, result.steering_rates, result.wheel_speeds]
    )
    course = Course(values.shape[1])
    course.add(result.times, values, result.reasons)
    measured = f"joints measured with {1e3 * result.noise:g} mrad of noise"
    title = f"{result.name} through the controller, a new command in every step, {measured}"
    path = (result.poses, result.steering)
    return drive_figure(result.rover, course, *path, limits=LIMITS, shares=result.shares, title=title)


def summary(result: ControlResult) -> dict[str, str]:
    """Cells of the table of the drives by the names of their rows."""
    asked, driven = result.length(result.commanded), result.length(result.twists)
    reasons = sorted(result.shares.items(), key=lambda item: -item[1])[:3]
    return {
        "noise of the measured joints": f"{1e3 * result.noise:g} mrad",
        "commanded": f"{asked:.2f} m",
        "driven": f"{driven:.2f} m, {driven / asked:.1%}",
        "stands at most for": f"{result.standing:.2f} s",
        "limited by": "\n".join(f"{name} {share:.0%}" for name, share in reasons),
    }
