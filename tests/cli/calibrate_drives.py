"""Drives of the tests of six-wheel calibrate."""

import numpy as np

import six_wheel as sw
from tests.odometry_logs import drive

NOMINAL = """\
# Measured with a tape.
kind: differential
track_width: 0.40  # hub to hub
wheel_radius: 0.10
noise: {slip: 0.01}
"""

TRUE = sw.Rover.differential(0.408, 0.0985)


def write(path: str, *, seed: int, truth: bool = True, straight: bool = False, gain: float = 1.0) -> None:
    """A drive of `TRUE`, with truth to 0.1 mm and wheels to 1 mrad."""
    way = drive(TRUE, n=150, turning=0.0 if straight else 0.8 - 0.1 * seed)
    noise = np.random.default_rng(seed)
    angles = way.angles / gain + noise.normal(0.0, 1e-3, way.angles.shape)
    poses = way.poses + noise.normal(0.0, 1e-4, way.poses.shape)
    columns = [way.stamps, *angles.T, *(poses.T if truth else ())]
    header = "time,left [rad],right [rad]" + (",x,y,yaw" if truth else "")
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="", fmt="%.9f")
