"""Drives that never were: any rover along a wandering path, its encoders and its truth."""

import numpy as np

import six_wheel as sw
from six_wheel.logs import GroundTruth, WheelLog

DT = 0.05  # [s]


def wander(seed: int, seconds: float, *, straight: bool = False) -> np.ndarray:
    """Smooth twists (n, 3) around 0.2 m/s that turn both ways."""
    random = np.random.default_rng(seed)
    time = np.arange(round(seconds / DT) + 1) * DT

    def wave() -> np.ndarray:
        height, period, phase = random.normal(), random.uniform(4.0, 20.0), random.uniform(0.0, 6.0)
        return height * np.sin(2.0 * np.pi * time / period + phase)

    waves = [wave() + wave() + wave() for _ in range(3)]
    twists = np.column_stack((0.2 + 0.04 * waves[0], 0.08 * waves[1], 0.35 * waves[2]))
    return twists * (1.0, 0.0, 0.0) if straight else twists


def drive(
    rover: sw.Rover,
    seed: int = 0,
    seconds: float = 60.0,
    *,
    straight: bool = False,
    noise: float = 2e-4,
    resolution: float = 2e-3,
    slips: int = 0,
    sensor: tuple[float, float, float] = (0.0, 0.0, 0.0),
    offset: float = 0.0,
    session: str = "",
) -> WheelLog:
    """Readings of a rover that is built like `rover`: truth with noise [m, rad], angles rounded [rad].

    `slips` times a wheel spins for half a second without effect. `sensor` is what the truth follows in the
    body, `offset` how much later its clock shows the same instant [s].
    """
    random = np.random.default_rng(1000 + seed)
    wanted = rover.project(wander(seed, seconds, straight=straight), keep="nearest")
    commanded, _ = rover.inverse(wanted)
    middle = (commanded[1:] + commanded[:-1]) / 2.0
    speeds = rover.inverse((wanted[1:] + wanted[:-1]) / 2.0)[1]
    poses = sw.integrate(rover.forward(middle, speeds), DT)
    reported = speeds.copy()
    for row in random.integers(0, len(speeds) - 10, slips):
        reported[row : row + 10, random.integers(speeds.shape[1])] += 20.0
    angles = np.concatenate((np.zeros((1, speeds.shape[1])), np.cumsum(reported * DT, axis=0)))
    angles = np.round(angles / resolution) * resolution
    angles[:, [not wheel.driven for wheel in rover.wheels]] = np.nan
    stamps = np.arange(len(poses)) * DT
    tracked = sw.compose(poses, np.broadcast_to(sensor, poses.shape)) + noise * random.normal(
        size=poses.shape
    )
    steering = commanded if commanded.shape[1] else None
    return WheelLog(stamps, steering, angles, GroundTruth(stamps + offset, tracked), f"drive {seed}", session)
