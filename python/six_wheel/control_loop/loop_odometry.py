"""Odometry of a loop: joint readings as they come, with those of a gyroscope where there is one."""

from collections.abc import Callable, Sequence

from six_wheel._core import OdometryState
from six_wheel.control_loop.clock import SECOND
from six_wheel.control_loop.faults import ERROR, WARN, Faults
from six_wheel.control_loop.gyroscope_sync import Row, Rows
from six_wheel.control_loop.joints import Numbers, Readings
from six_wheel.control_loop.settings import Settings
from six_wheel.kinematics.odometry.tracks import OdometryHealth

Counted = tuple[int | None, OdometryState | None]
"""The stamp [ns] of the readings that were counted last, and what odometry says then; None if none were."""


class Odometer:
    """An `Odometry` that says what is wrong; `moved` is called with what odometry says after every step."""

    def __init__(self, settings: Settings, faults: Faults, moved: Callable[[OdometryState], None]) -> None:
        self._faults, self._moved = faults, moved
        self._rows = Rows(settings.parameters.gyroscope) if settings.listens else None
        self._apart: float | None = None
        self._stamp_origin: int | None = None
        self._first: int | None = None  # when readings came first
        self._take(settings)
        self.odometry = settings.odometry()

    def _take(self, settings: Settings) -> None:
        self._settings = settings
        options = settings.options
        self._timeout = round(options.joint_state_timeout * SECOND)
        self._patience = round(options.imu_timeout * SECOND)

    def change(self, settings: Settings) -> None:
        """By other settings from here on."""
        old, new = self._settings.parameters, settings.parameters
        self._take(settings)
        if (old.noise, old.odometry, old.calibration) != (new.noise, new.odometry, new.calibration):
            self.rest()
            self._renew()

    def _renew(self) -> None:
        """By the settings there are, from the present pose on, and with the bias that was learnt."""
        state, bias = self.odometry.state, self.odometry.gyroscope_bias
        self.odometry = self._settings.odometry(self._apart, bias)
        self.odometry.reset(state.pose, state.covariance)

    def set_pose(self, pose: Numbers, covariance: Sequence[Numbers] | None) -> None:
        """The rover is known to be here; readings count on."""
        self.rest()
        self.odometry.set_pose(pose, covariance)

    def reset(self, pose: Numbers, covariance: Numbers | None) -> None:
        """Restart the odometry at a pose."""
        self.rest()
        self.odometry.reset(pose, covariance)
        self._stamp_origin = None

    def start_over(self) -> None:
        """Readings from before are forgotten, and the pose where the options say so."""
        self._stamp_origin = self._first = None
        if self._rows is not None:
            self._rows.forget()
        if self._settings.options.reset_on_time_jump:
            self.odometry.reset()
        else:
            state = self.odometry.state
            self.odometry.reset(state.pose, state.covariance)

    def mount(self, up: Sequence[float]) -> None:
        """As `Loop.mount`."""
        if self._rows is not None:
            self._rows.mount(up)

    def add_rates(self, rates: Sequence[float], stamp: int, now: int) -> Counted:
        """As `Loop.imu`."""
        if self._rows is None:
            return None, None
        timeout = self._timeout
        if abs(now - stamp) > timeout:
            rule = f"stamps of the gyroscope must be within {timeout / SECOND:g} s of the clock"
            self._faults.add("odometry", WARN, rule, f"{(now - stamp) / SECOND:.3g} s")
        elif not self._rows.add_rates(rates, stamp, now):
            self._faults.add("odometry", WARN, "a gyroscope must read finite rates at stamps that increase")
        return self._ready(now)

    def take_in(self, readings: Readings, stamp: int, now: int) -> Counted:
        """Give readings to the odometry: which of them it has counted last with that, and what it says."""
        rows = self._rows
        if self._first is None:
            self._first = now
        if rows is None:
            return stamp, self._update(readings, stamp)
        newest = rows.newest
        if newest is not None and stamp == newest:
            self._say_health(OdometryHealth.DUPLICATE)
        elif newest is not None and stamp < newest:
            # Odometry knows what to do with a clock that was set back; the gyroscope's is as uncertain.
            self.rest()
            rows.forget()
            return stamp, self._update(readings, stamp)
        else:
            rows.add(Row(readings, stamp, now))
        return self._ready(now)

    def _ready(self, now: int) -> Counted:
        """Count what waits for the gyroscope no more."""
        rows, counted, state = self._rows, None, None
        assert rows is not None
        begun = self._first is not None and now - self._first > self._timeout
        for row, rate in rows.ready(now, self._patience):
            if self._apart != rows.apart:
                self._apart = rows.apart
                self._renew()
            if rate is None and begun:
                heard = rows.came
                got = "nothing" if heard is None else f"the last one {(now - heard) / SECOND:.3g} s ago"
                rule = "a gyroscope must speak in time: odometry goes by the wheels alone"
                self._faults.add("odometry", WARN, rule, got)
            if (said := self._update(row.readings, row.stamp, rate)) is not None:
                counted, state = row.stamp, said
        return counted, state

    def rest(self) -> None:
        """Count all that waits."""
        if self._rows is not None:
            for row, _ in self._rows.rest():
                self._update(row.readings, row.stamp)

    def _update(self, readings: Readings, stamp: int, rate: float | None = None) -> OdometryState | None:
        """One step of odometry; what it says, if the readings count."""
        if self._stamp_origin is None:
            self._stamp_origin = stamp
        seconds = (stamp - self._stamp_origin) / SECOND
        steering = readings.steering or None
        try:
            state = self.odometry.update(steering, readings.wheels, seconds, yaw_rate=rate)
        except ValueError:
            # For rows it says which rule one breaks, and follows a clock or counter that moved for good.
            rows = None if steering is None else [steering]
            rates = None if rate is None else [rate]
            track = self.odometry.run(
                rows, [readings.wheels], [seconds], yaw_rate=rates, covariances=False, residuals=False
            )
            health = OdometryHealth(int(track.health[0]))
            self._say_health(health)
            return None if health & OdometryHealth.LEFT_OUT else self.odometry.state
        if health := state.health:
            self._say_health(health)
        self._moved(state)
        return state

    def _say_health(self, health: OdometryHealth) -> None:
        for each in health:
            if each is not OdometryHealth.FIRST:
                level = WARN if each & COUNTED else ERROR
                self._faults.add("odometry", level, f"{each.name}: {HEALTH[each]}")


COUNTED = OdometryHealth.GAP | OdometryHealth.WRAPPED | OdometryHealth.SLIP
HEALTH = {
    OdometryHealth.GAP: "a gap between readings, counted as one arc",
    OdometryHealth.WRAPPED: "a counter started over",
    OdometryHealth.SLIP: "a wheel contradicts the others",
    OdometryHealth.NOT_FINITE: "a reading is not finite, left out",
    OdometryHealth.DUPLICATE: "readings have the stamp of those before, left out",
    OdometryHealth.BACKWARDS: "readings are older than those before, left out",
    OdometryHealth.JUMP: "faster than the rover can be, left out",
    OdometryHealth.UNDETERMINED: "the wheels do not determine the motion, left out",
    OdometryHealth.RESTARTED: "clock or counters restarted, followed",
}
