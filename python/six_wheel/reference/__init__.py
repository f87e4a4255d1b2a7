"""The mathematics of the library in plain Python, to be read beside the design notes.

Nothing here is shared with the compiled core: this package is the oracle its tests compare with and the
yardstick of its benchmarks. Clarity comes first: batches are loops, and every vehicle is a list of wheels
with one wheel equation (`Wheel.rows`). x forward, y left, angles counter-clockwise, SI units; a twist is
``(vx, vy, omega)`` in body axes [m/s, m/s, rad/s], a pose ``(x, y, yaw)`` [m, m, rad].

Rooms, in the order in which they build on each other: `geometry` (poses), `wheels` (the wheel equation),
`layouts` (the named lists of wheels), `estimate` (wheels to twist), `admissible` (which twists are possible),
`mobility`, and `rover`, where they come together; `odometry`, `suspension`, `four_axle`, `profiles` and
`controller` (limits along a motion) beside them.
"""

from six_wheel.reference import controller, profiles
from six_wheel.reference.estimate import Fit
from six_wheel.reference.geometry import compose, differentiate, exp, integrate, log, wrap_angle
from six_wheel.reference.mobility import Mobility
from six_wheel.reference.rollouts import rollout_cost
from six_wheel.reference.rover import Rover
from six_wheel.reference.wheels import InfeasibleMotionError, UnderdeterminedError, Wheel

__all__ = ["Fit", "InfeasibleMotionError", "Mobility", "Rover", "UnderdeterminedError", "Wheel"]
__all__ += ["compose", "controller", "differentiate", "exp", "integrate", "log", "profiles", "rollout_cost"]
__all__ += ["wrap_angle"]
