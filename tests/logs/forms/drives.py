"""Short drives whose truth is known: wheel angles of four rovers at 20 Hz, and where they end."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import six_wheel as sw
from six_wheel.kinematics.poses import Floats
from tests import rovers
from tests.rovers import MECANUM

PERIOD, ROWS = 0.05, 500
TICKS = 4096.0


@dataclass(frozen=True)
class Course:
    """A drive: stamps [s], running totals and steering angles [rad], the pose at the end."""

    rover: sw.Rover
    stamps: Floats
    angles: Floats
    steering: Floats | None
    pose: NDArray[np.float64]

    @property
    def rates(self) -> Floats:
        """Rates at the stamps whose trapezium comes to the totals [rad/s]."""
        return np.gradient(self.angles, self.stamps, axis=0)

    @property
    def counts(self) -> NDArray[np.int64]:
        """Totals in ticks."""
        return np.rint(self.angles * TICKS / (2.0 * np.pi)).astype(np.int64)

    def thinned(self, every: int) -> "Course":
        """Of the same drive some rows, and the pose that they tell: an arc from each to the next."""
        stamps, angles = self.stamps[::every], self.angles[::every]
        steering = None if self.steering is None else self.steering[::every]
        pose = sw.dead_reckon(self.rover, steering, angles, stamps, plausibility=False).poses[-1]
        return replace(self, stamps=stamps, angles=angles, steering=steering, pose=pose)


def course(rover: sw.Rover, sideways: bool = False) -> Course:
    """Forwards in an arc, a stop, backwards a little, forwards in the other direction."""
    stamps = np.arange(ROWS) * PERIOD
    speed = 0.35 * np.tanh(stamps) * np.where(stamps < 15.0, 1.0, np.clip(16.0 - stamps, -0.6, 1.0))
    speed = np.where(stamps < 18.0, speed, np.clip(stamps - 18.6, -0.6, 1.0) * 0.35)
    omega = 0.12 * np.sin(stamps / 4.0) * speed / 0.35
    twists = np.stack([speed, 0.3 * speed if sideways else 0.0 * speed, omega], axis=1)
    found, rates = map(np.asarray, rover.inverse(twists))
    steering = found if rover.steered_wheel_names else None
    steps = (rates[1:] + rates[:-1]) / 2.0 * PERIOD
    angles = np.vstack([np.zeros(len(rover.wheels)), np.cumsum(steps, axis=0)])
    track = sw.dead_reckon(rover, steering, angles, stamps, plausibility=False)
    return Course(rover, stamps, angles, steering, track.poses[-1])


PAIR = course(rovers.PAIR)
SIX = course(rovers.SIX_WHEELS)
OMNI = course(MECANUM, sideways=True)
CAR = course(sw.Rover.ackermann(1.0, 0.6, 0.15, steering_limit=0.6))
