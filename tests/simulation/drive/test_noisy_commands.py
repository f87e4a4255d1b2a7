"""Tables of a planner that is never still: the way driven is the way that was commanded."""

import math
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw

pa = pytest.importorskip("pyarrow")
csv = pytest.importorskip("pyarrow.csv")

from six_wheel.simulation.drive import DriveLoop, drive  # noqa: E402
from tests.limits import SMOOTH as LIMITS  # noqa: E402
from tests.rovers import LOW_SWERVE, SIX_SIZES  # noqa: E402

RATE, DURATION = 50.0, 10.0  # [Hz, s]
ROVERS = {
    "six_wheel": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.0472),
    "open_source_rover": sw.Rover.preset("open_source_rover"),
    "perseverance": sw.Rover.preset("perseverance"),
    "swerve": LOW_SWERVE,
}
SPEED, YAW_RATE = 0.4, 0.3


def write(path: Path, noise: float) -> Path:
    """Rows at the rate of the loop, every yaw rate off by its own bit."""
    count = round(DURATION * RATE)
    random = np.random.default_rng(1)
    rates = YAW_RATE * (1.0 + noise * random.standard_normal(count))
    columns = {"time": np.arange(count) / RATE, "vx": np.full(count, SPEED), "omega": rates}
    csv.write_csv(pa.table(columns), path)
    return path


@pytest.mark.parametrize("name", list(ROVERS))
@pytest.mark.parametrize("noise", [1e-8, 0.01])
def test_the_way_driven_is_the_way_commanded(tmp_path, name, noise):
    rover = ROVERS[name]
    summary = drive(rover, write(tmp_path / "commands.csv", noise), loop=DriveLoop(LIMITS, RATE))
    # A body that stands until its joints are there, and then follows at its acceleration.
    joints = max(np.abs(rover.inverse((SPEED, 0.0, YAW_RATE))[0])) / LIMITS.steering_rate
    ideal = SPEED * (DURATION - joints) - SPEED**2 / (2.0 * LIMITS.acceleration)
    # The stop after the last row, from when its timeout is over.
    after = SPEED * 0.5 + SPEED**2 / (2.0 * LIMITS.acceleration)
    assert 0.9 * ideal <= summary.path_length <= 1.02 * (ideal + after)
    assert math.hypot(*summary.end_pose[:2]) > 0.5
