"""The motion of a rover when the loop starts, and the controller that goes on with it."""

from collections.abc import Sequence

from six_wheel._core import Controller, OdometryState
from six_wheel.control_loop.settings import Settings
from six_wheel.kinematics.odometry.tracks import OdometryHealth

SETTLE = 0.03  # [s] over which it is measured at the start how the rover moves
CLOSE = 0.1  # [rad] of the joints to those of the measured motion: then it is a motion, and not noise at rest


class StartMotion:
    """The mean twist since the first readings."""

    def __init__(self) -> None:
        self._ways = 0.0, 0.0, 0.0
        self._span = 0.0
        self._seen: float | None = None

    def measure(self, state: OdometryState) -> None:
        """Take in what odometry has counted."""
        before, self._seen = self._seen, state.stamp
        if before is None or state.stamp is None or state.health & OdometryHealth.FIRST:
            self._ways, self._span = (0.0, 0.0, 0.0), 0.0
            return
        step, ways = state.stamp - before, self._ways
        vx, vy, omega = state.twist.tolist()
        self._ways = ways[0] + step * vx, ways[1] + step * vy, ways[2] + step * omega
        self._span += step

    def controller(self, settings: Settings, measured: Sequence[float] | None) -> Controller | None:
        """A controller in this motion, its joints as measured; None until two readings are `SETTLE` apart.
        Raises `ValueError` if no joint can have such an angle."""
        if self._span < SETTLE:
            return None  # two readings alone may have stamps that jitter
        twist = [way / self._span for way in self._ways]
        resting = settings.controller(steering=measured)
        if not any(twist):
            return resting
        moving = settings.controller(steering=measured, twist=twist)
        errors = zip(moving.steering.tolist(), measured or (), strict=True)
        close = max((abs(a - b) for a, b in errors), default=0.0) <= CLOSE
        return moving if close else resting
