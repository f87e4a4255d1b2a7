"""What a sampling planner gets back for its rollouts."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class RolloutCost(NamedTuple):
    """Poses of k rollouts of t steps, and the worst each asks of the wheels: see `Rover.rollout_cost`."""

    poses: NDArray[np.float64]
    """Rows ``[x, y, yaw]``, shape (..., k, t + 1, 3) [m, m, rad]."""
    wheel_speed: NDArray[np.float64]
    """Largest wheel speed, either way round, shape (..., k) [rad/s]."""
    steering_angle: NDArray[np.float64]
    """Largest steering angle, to either side, shape (..., k) [rad]."""
    steering_rate: NDArray[np.float64]
    """Largest steering rate, shape (..., k) [rad/s]."""
    scrub: NDArray[np.float64]
    """Largest speed at which a wheel slides sideways, shape (..., k) [m/s]."""
