"""The mathematics of the library in plain Python, to be read beside the design notes.

Nothing here is shared with the compiled core: this package is the oracle its tests compare with and the
yardstick of its benchmarks. Clarity comes first: batches are loops, and every vehicle is a list of wheels
with one wheel equation (`Wheel.rows`). x forward, y left, angles counter-clockwise, SI units; a twist is
``(vx, vy, omega)`` in body axes [m/s, m/s, rad/s], a pose ``(x, y, yaw)`` [m, m, rad].

`planar` is rovers in the plane, `ground` suspensions on a height grid, `control` motion over time within
limits.
"""

from six_wheel.reference.control import controller, profiles
from six_wheel.reference.planar.estimate import TwistFit
from six_wheel.reference.planar.geometry import compose, differentiate, exp, integrate, log, wrap_angle
from six_wheel.reference.planar.mobility import Mobility
from six_wheel.reference.planar.rollouts import rollout_cost
from six_wheel.reference.planar.rover import Rover
from six_wheel.reference.planar.wheels import InfeasibleMotionError, UnderdeterminedError, Wheel

__all__ = ["InfeasibleMotionError", "Mobility", "Rover", "TwistFit", "UnderdeterminedError", "Wheel"]
__all__ += ["compose", "controller", "differentiate", "exp", "integrate", "log", "profiles", "rollout_cost"]
__all__ += ["wrap_angle"]
