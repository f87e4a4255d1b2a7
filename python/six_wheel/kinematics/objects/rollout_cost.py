"""Results of the rollouts of a sampling planner."""

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.objects.short_text import of_arrays

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Floats: TypeAlias = "NDArray[np.float64]"


@checked_class
@of_arrays
class RolloutCost(NamedTuple):
    """Poses of k rollouts of t steps, and the worst each asks of the wheels: see `Rover.rollout_cost`."""

    poses: Floats
    """Rows ``[x, y, yaw]``, shape (..., k, t + 1, 3) [m, m, rad]."""
    max_wheel_speed: Floats
    """Largest wheel speed, either way round, shape (..., k) [rad/s]."""
    max_steering_angle: Floats
    """Largest steering angle, to either side, shape (..., k) [rad]."""
    max_steering_rate: Floats
    """Largest steering rate, shape (..., k) [rad/s]."""
    max_side_slip: Floats
    """Largest speed at which a wheel slides sideways, shape (..., k) [m/s]."""
