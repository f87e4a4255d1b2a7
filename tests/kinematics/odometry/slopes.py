"""Ground that is not level, and a drive over it."""

import math
from typing import Any

import numpy as np

import six_wheel as sw


def ramp(angle: float, heading: float = 0.0) -> sw.Terrain:
    """A plane that rises along a heading."""
    x = np.arange(-20.0, 21.0)
    rise = math.tan(angle) * (np.cos(heading) * x + np.sin(heading) * x[:, None])
    return sw.Terrain(rise, spacing=1.0, origin=(-20.0, -20.0))


def simulated(seed: int = 1, **more: Any) -> tuple[sw.RockerBogie, sw.Terrain, Any]:
    """A drive over bumps."""
    arm = sw.RockerBogie.preset("perseverance")
    x = 0.1 * np.arange(-60, 140)
    heights = 0.12 * np.sin(1.1 * x) * np.cos(0.9 * x[:, None]) + 0.1 * x
    ground = sw.Terrain(heights, spacing=0.1, origin=(-6.0, -6.0))
    commands = [(0, 0.15, 0, 0.0), (10, 0.15, 0, 0.06), (25, 0.15, 0, -0.06), (30, 0.15, 0, 0.0)]
    return arm, ground, sw.simulate(arm, commands, ground=ground, rate=10.0, seed=seed, **more)


QUIET = sw.Noise(0.0, 0.0)
