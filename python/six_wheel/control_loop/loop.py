"""The loop on a rover: a `Controller` and an `Odometry`, and what happens when something is wrong.

Every call has the time `now` [ns]; nothing else is known of time. Steps are made when a set of joint readings
is complete, and by `tick` where none come in time. What a fault leads to:

- Without all joints for longer than `joint_state_timeout` the rover stops, its steering held, until they are
  back and a command newer than the stop has come.
- Where time jumps back, commands and readings from before are forgotten, and the loop begins as after a
  start.
- Where the gyroscope is silent or late odometry goes by the wheels alone.
- At a start the rover may be moving. The first commands are those of the motion that odometry measures.
- A joint that does not follow halts the rover. A halt lasts until `release`, time that jumps included.
"""

import math
from collections import Counter
from collections.abc import Sequence

from six_wheel._core import Controller, ControllerOutput, OdometryState
from six_wheel.control_loop.clock import SECOND, Clock
from six_wheel.control_loop.faults import ERROR, WARN, Faults
from six_wheel.control_loop.joints import JointReader, Numbers
from six_wheel.control_loop.loop_odometry import Odometer
from six_wheel.control_loop.settings import Settings
from six_wheel.control_loop.starting import StartMotion
from six_wheel.control_loop.steps import Send, Step
from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.keywords import checked_class
from six_wheel.robot_description.wheels_of_rover import joints_as_given

AHEAD = SECOND // 10  # of a stamp, that is not just another clock's rounding
STALE, STUCK = int(Reason.STALE), int(Reason.JOINT_STUCK)


@checked_class
class Loop:
    """A rover on its way.

    Parameters
    ----------
    settings : Settings
        In every method `now` is the time of the call, and `stamp` that of the command or reading [ns].

    Attributes
    ----------
    settings : Settings
    faults : Faults
    reasons : Counter
        Steps with each combination of reasons, since `reasons` was cleared.
    stopping : str or None
        Why the rover is stopped, whatever the commands; None if it is not.
    stuck : tuple of str and float, or None
        The joint that did not follow, and by how much its reading differed from the command [rad], with the
        signs of the joint; None after `release`.
    """

    def __init__(self, settings: Settings) -> None:
        self._take(settings)
        self.faults = Faults()
        self.reasons: Counter[int] = Counter()
        self.stopping: str | None = None
        self.stuck: tuple[str, float] | None = None
        self.active = True
        self._halted = False  # for a controller yet to be made
        self._last: Step | None = None  # with commands, while they are in force
        rover = settings.rover
        steered, wheels = list(rover.steered_wheel_names), list(rover.wheel_names)
        # Commands go out in the order and with the signs of the file's joints, not of the rover's wheels.
        sign = dict.fromkeys(rover.reversed_joints, -1.0)
        self._steering_out, self._traction_out = (
            [(sign.get(joint, 1.0), places.index(wheel)) for joint, wheel in joints.items()]
            for joints, places in zip(joints_as_given(rover), (steered, wheels), strict=True)
        )
        self._controller: Controller | None = None
        self._odometer = Odometer(settings, self.faults, self._measure)
        positions = settings.options.position_feedback
        self._reader = JointReader(rover, positions, settings.steering_factors(), self.faults)
        self._clock = Clock(self.faults)
        self._stepped: int | None = None
        self._measured: list[float] | None = None
        self._read = 0
        self._moved = StartMotion()
        self._command: tuple[tuple[float, float, float], float] | None = None
        self._latest = -math.inf  # the latest stamp that the controller was given
        self._wanted = (0.0, 0.0, 0.0)

    # Inputs
    def command(self, twist: tuple[float, float, float], stamp: int, now: int) -> None:
        """A command ``[vx, vy, omega]`` that was given at `stamp` and came at `now` [ns]; stamp 0: now."""
        now = self._move_on(now)
        stamp = stamp or now
        if not all(map(math.isfinite, twist)):
            self.faults.add("commands", ERROR, "a command must be finite", str(twist))
        elif stamp - now > AHEAD:
            ahead = f"{(stamp - now) / SECOND:.3g} s ahead"
            self.faults.add("commands", WARN, "the stamp of a command must not be ahead of the clock", ahead)
        else:
            timeout = self.settings.parameters.control.get("timeout", 0.5)
            if timeout is not None and now - stamp > timeout * SECOND:
                age = f"{(now - stamp) / SECOND:.3g} s old"
                self.faults.add("commands", WARN, f"a command must not be older than {timeout:g} s", age)
        if self.stopping is not None or not self.active or self.halted:
            return
        self._wanted = twist
        self._give(twist, self._clock.seconds(min(stamp, now)))

    def joints(
        self,
        names: Sequence[str],
        positions: Numbers,
        velocities: Numbers,
        stamp: int,
        now: int,
        send: Send | None = None,
    ) -> Step | None:
        """Joint states, read at `stamp` (0: now), that came at `now` [ns]. A step if they are complete.

        `send` is given the time and the commands as soon as they are there, before odometry counts.
        """
        now = self._move_on(now)
        stamp = stamp or now
        timeout = self._timeout
        if abs(now - stamp) > timeout:
            age = f"{(now - stamp) / SECOND:.3g} s"
            self.faults.add(
                "joints", ERROR, f"stamps must be within {timeout / SECOND:g} s of the clock", age
            )
            return None
        readings = self._reader.read(names, positions, velocities, now)
        if readings is None:
            return None
        self._measured, self._read = readings.steering or None, now
        again = self._stepped is not None and now <= self._stepped  # as a simulation may have it
        if self._controller is not None and not again:
            step = self._step(now, stamp, send)
            counted, state = self._odometer.take_in(readings, stamp, now)
            return step._replace(stamp=counted, state=state)
        counted, state = self._odometer.take_in(readings, stamp, now)
        if again:
            return None
        if not self._begin():
            return Step(now, None, None, (0.0, 0.0, 0.0), 0, counted, state)
        return self._step(now, stamp, send)._replace(stamp=counted, state=state)

    def imu(self, rates: Sequence[float], stamp: int, now: int) -> Step | None:
        """Take readings of a gyroscope about its axes [rad/s] at `stamp` (0: now), that came at `now` [ns].
        Returns a step, without commands, if odometry counts with it."""
        now = self._move_on(now)
        counted, state = self._odometer.add_rates(rates, stamp or now, now)
        return None if state is None else Step(now, None, None, self.twist, 0, counted, state)

    def mount(self, up: Sequence[float], now: int) -> None:
        """Mounting of the gyroscope: `up`, the rover's z in its axes. The parameter file comes first."""
        self._move_on(now)
        self._odometer.mount(up)

    def tick(self, now: int) -> Step | None:
        """The timer at `now` [ns]: a step if there has been none by joint states for a period."""
        now = self._move_on(now)
        if self._stepped is not None and now - self._stepped < self._period:
            return None
        if self._open_loop:
            if self._controller is None:
                self._start(self.settings.controller())
            return self._step(now, now)
        missing = self._reader.missing(now, self._timeout)
        assert self._clock.origin is not None
        if missing and now - self._clock.origin > self._timeout:
            self.stopping = "joint states are missing"
            self._reader.report_missing(missing)
            self._odometer.rest()  # there is nothing more to wait for
        return None if self._controller is None else self._step(now, None)

    def set_pose(self, pose: Numbers, covariance: Sequence[Numbers] | None, now: int) -> None:
        """The rover is known to be at `pose` [m, m, rad] with `covariance` (3, 3); readings count on."""
        self._move_on(now)
        self._odometer.set_pose(pose, covariance)

    def reset(self, now: int, pose: Numbers = (0.0, 0.0, 0.0), covariance: Numbers | None = None) -> None:
        """Odometry starts over at `pose` [m, m, rad] with `covariance` (3, 3); the motion goes on."""
        self._move_on(now)
        self._odometer.reset(pose, covariance)

    def change(self, settings: Settings, now: int) -> None:
        """Other limits, options or noise, from the present motion on; the rover itself and its gyroscope stay
        what they are. ValueError, and nothing is changed, if the rover cannot meet them."""
        self._move_on(now)
        if settings.rover != self.settings.rover:
            raise ValueError("the rover must stay what it is while it drives; start again with the other one")
        if settings.parameters.gyroscope != self.settings.parameters.gyroscope:
            rule = "the gyroscope must stay what it is while the rover drives; start again with the other one"
            raise ValueError(rule)
        old, new, last = self.settings.parameters, settings.parameters, self._controller
        if last is not None and old.control != new.control:
            if last.halted:
                raise ValueError("control must stay what it is while the rover is halted; release it first")
            self._controller = settings.controller(steering=last.steering, twist=last.twist)
            self._latest = -math.inf
            self._give_again()
        elif last is not None and old.limits != new.limits:
            last.limits = new.limits
        self._take(settings)
        self._odometer.change(settings)

    def activate(self, now: int, active: bool = True) -> None:
        """Take commands if `active`; or stop within the limits, and take none."""
        self._move_on(now)
        self.active = active

    def begin(self, now: int, twist: Numbers) -> None:
        """The rover moves with `twist` [m/s, m/s, rad/s]; without joint states, before its first step."""
        self._move_on(now)
        if self._controller is None:
            self._start(self.settings.controller(twist=twist))

    def halt(self, now: int) -> None:
        """Stop at `halt_deceleration`, and take no commands until `release`."""
        self._move_on(now)
        self._halted = True
        if self._controller is not None:
            self._controller.halt()

    def release(self, now: int) -> bool:
        """End a halt: only a command newer than this drives the rover again. False while it still moves."""
        now = self._move_on(now)
        if (controller := self._controller) is not None:
            if not controller.release():
                return False
            self._stop(controller, self._clock.seconds(now))
        self._halted, self.stuck, self._command = False, None, None
        return True

    def end(self, now: int) -> Step | None:
        """The last step: wheels at rest at once, steering held. None where no command is in force."""
        now = self._move_on(now)
        self._halted = self.halted
        last, self._last, self._controller, self.active = self._last, None, None, False
        if last is None or last.wheel_speeds is None:
            return None
        rest = [0.0] * len(last.wheel_speeds)
        return Step(now, last.steering, rest, (0.0, 0.0, 0.0), int(Reason.HALTED), None, None)

    @property
    def halted(self) -> bool:
        """True if a halt, or a joint that did not follow, keeps the rover from taking commands."""
        return self._halted if self._controller is None else self._controller.halted

    @property
    def stopped(self) -> bool:
        """True if the commands that are in force move nothing."""
        if self._controller is None:
            return self._last is None or self._last.wheel_speeds is None or not any(self._last.wheel_speeds)
        return self._controller.stopped

    @property
    def twist(self) -> tuple[float, float, float]:
        """The motion that is commanded."""
        if self._controller is None:
            return 0.0, 0.0, 0.0
        vx, vy, omega = self._controller.twist.tolist()
        return vx, vy, omega

    @property
    def stopping_distance(self) -> float:
        """Largest distance that the rover covers if it is told to stop now [m]."""
        return 0.0 if self._controller is None else self._controller.stopping_distance

    @property
    def state(self) -> OdometryState:
        """State of the odometry."""
        return self._odometer.odometry.state

    @property
    def gyroscope_bias(self) -> tuple[float, float] | None:
        """Estimated bias of the gyroscope and its standard deviation [rad/s]; None without a gyroscope."""
        return self._odometer.odometry.gyroscope_bias

    @property
    def wanted(self) -> tuple[float, float, float]:
        """The last command that was taken."""
        return self._wanted

    def _take(self, settings: Settings) -> None:
        self.settings = settings
        options = settings.options
        self._timeout = round(options.joint_state_timeout * SECOND)
        # Between two ticks, but for the jitter of the timer.
        self._period = round(0.9 * SECOND / options.update_rate)
        self._open_loop = options.open_loop
        # Older readings say nothing of a joint that does not follow. Missing ones stop the rover, they do not
        # halt it.
        time = settings.controller_option("following_time")
        never = settings.controller_option("following_error") is None
        self._known = self._timeout if never else min(self._timeout, round(time * SECOND / 2.0))

    # Time

    def _move_on(self, now: int) -> int:
        """The time from here on; the loop starts over where it jumps back."""
        now, is_back = self._clock.move_on(now)
        if is_back:
            self._start_over()
        return now

    def _start_over(self) -> None:
        self._halted = self.halted
        self._stepped = self._command = self._controller = self._measured = None
        self._moved = StartMotion()
        self._latest = -math.inf
        self.stopping = None
        self._reader.forget()
        self._odometer.start_over()

    # Steps

    def _give(self, twist: tuple[float, float, float], stamp: float) -> None:
        self._command = twist, stamp
        if self._controller is None:
            return
        if self._controller.command(twist, stamp):
            self._latest = stamp
        elif stamp < self._latest:
            self.faults.add("commands", WARN, "commands must come in the order of their stamps")

    def _measure(self, state: OdometryState) -> None:
        if self._controller is None:
            self._moved.measure(state)

    def _start(self, controller: Controller) -> None:
        self._controller = controller
        if self._halted:
            controller.halt()
        self._give_again()

    def _begin(self) -> bool:
        """Make a controller from the measured joints; True if that succeeded."""
        try:
            controller = self._moved.controller(self.settings, self._measured)
        except ValueError as error:
            self.faults.add("joints", ERROR, "steering angles must be possible", str(error))
            return False
        if controller is None:
            return False
        self._start(controller)
        return True

    def _step(self, now: int, stamp: int | None, send: Send | None = None) -> Step:
        controller, seconds = self._controller, self._clock.seconds(now)
        assert controller is not None
        if stamp is not None:
            self.stopping = None
        if self.stopping is not None or not self.active:
            self._stop(controller, seconds)
        silent = not self.active and controller.stopped
        try:
            known = self.stopping is None and now - self._read <= self._known
            output = controller.step(seconds, self._measured if known else None)
        except ValueError as error:
            # An angle that no joint can have: as good as none.
            self.faults.add("joints", ERROR, "steering angles must be possible", str(error))
            self._stop(controller, seconds)
            output = controller.step(seconds)
        steering = speeds = None
        if not silent:
            angles, rates = output.steering.tolist(), output.wheel_speeds.tolist()
            steering = [sign * angles[k] for sign, k in self._steering_out]
            speeds = [sign * rates[k] for sign, k in self._traction_out]
            if send is not None:
                send(now, steering, speeds)
        self._stepped = now
        reasons = int(output.reasons)
        self.reasons[reasons] += 1
        if reasons & STALE:
            self.faults.add("commands", WARN, "commands must keep coming", "none in time: the rover stops")
        if reasons & STUCK and self.stuck is None:
            self._say_stuck(output)
        vx, vy, omega = output.twist.tolist()
        state = self._odometer.odometry.command((vx, vy, omega), seconds) if self._open_loop else None
        step = Step(now, steering, speeds, (vx, vy, omega), reasons, stamp, state)
        self._last = step if not silent else None
        return step

    def _stop(self, controller: Controller, seconds: float) -> None:
        """The rover is to stop, and only a newer command than this drives it again."""
        self._command = None
        self._latest = max(self._latest, seconds)
        controller.command((0.0, 0.0, 0.0), self._latest)

    def _give_again(self) -> None:
        if self._command is not None:
            self._give(*self._command)

    def _say_stuck(self, output: ControllerOutput) -> None:
        rover, joint, errors = self.settings.rover, output.worst_joint, output.joint_errors
        assert joint is not None
        assert errors is not None
        sign = -1.0 if joint in rover.reversed_joints else 1.0
        error = sign * float(errors[rover.steered_wheel_names.index(rover.steering_joints[joint])])
        self.stuck = joint, error
        self.faults.add("joints", ERROR, f"joint {joint} must follow its command", f"{error:.3g} rad off it")
