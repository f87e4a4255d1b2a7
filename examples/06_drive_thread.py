"""The control loop of a robot: a thread at 200 Hz, measured joints, faults, and wheels at rest at its end.

`Bus` stands for the motor drivers; everything else is meant to be copied. However the program ends, by
Ctrl-C, by SIGTERM or by an exception in any thread, the rover is halted and the last command of every wheel
is 0. Against `kill -9` and a lost supply only the drivers' own timeout helps.
"""

import math
import signal
import sys
import threading
import time

import six_wheel as sw

PERIOD = 1.0 / 200.0  # [s]
SILENCE = 0.1  # [s] without joint readings after which the rover stops within its limits
LAST = 1.0  # [s] for the halt at the end; then the wheels are commanded to rest in one step

ROVER = sw.Rover.six_wheel(
    front_to_middle=0.5,
    middle_to_rear=0.5,
    track_width=0.8,
    middle_track_width=0.9,
    wheel_radius=0.15,
    steering_limit=1.0,
)
LIMITS = sw.Limits(
    speed=0.8,
    acceleration=1.0,
    angular_acceleration=2.0,
    wheel_speed=6.0,
    steering_rate=2.0,
    halt_deceleration=3.0,
)
STEERING = {wheel: joint for joint, wheel in ROVER.steering_joints.items()}


class Bus:
    """Motor drivers whose joints follow at once, until one sticks."""

    def __init__(self) -> None:
        self.joints = dict.fromkeys([*ROVER.steering_joints, *ROVER.traction_joints], 0.0)
        self.stuck: str | None = None

    def read(self) -> dict[str, float]:
        """Angles of the steering joints [rad], by name and in any order; fewer of them if some are silent."""
        return {joint: self.joints[joint] for joint in ROVER.steering_joints}

    def write(self, commands: dict[str, float]) -> None:
        """Angles of the steering joints [rad] and speeds of the wheels [rad/s]."""
        self.joints |= {joint: value for joint, value in commands.items() if joint != self.stuck}


class DriveThread(threading.Thread):
    """Steps a `Controller`; used as a context, whose end is a halt."""

    def __init__(self, bus: Bus) -> None:
        super().__init__(name="drive")
        self.bus, self.fault = bus, ""
        self.controller = sw.Controller(
            ROVER, LIMITS, period=PERIOD, timeout=0.5, following_error=0.2, following_time=0.3
        )
        self._ending = threading.Event()
        self._measured: list[float] | None = None
        self._heard = time.monotonic()

    def drive(self, twist: tuple[float, float, float]) -> bool:
        """Give a command [m/s, m/s, rad/s], from any thread; False while the rover is halted."""
        return self.controller.command(twist, time.monotonic())

    def run(self) -> None:
        """200 steps a second by the monotonic clock, until told to end."""
        due = time.monotonic()
        try:
            while not self._ending.wait(max(0.0, due - time.monotonic())):
                self._step()
                due = max(due + PERIOD, time.monotonic() - PERIOD)  # after a pause it does not catch up
        except Exception as error:
            self._note(error)
        finally:
            self._come_to_rest()

    def _note(self, error: Exception) -> None:
        self.fault = f"{type(error).__name__}: {error}"

    def _step(self) -> None:
        now, readings = time.monotonic(), self.bus.read()
        # By name: a bus has an order of its own.
        measured = [readings.get(STEERING[wheel], math.nan) for wheel in ROVER.steered_wheel_names]
        if all(map(math.isfinite, measured)):
            self._measured, self._heard = measured, now
        elif now - self._heard > SILENCE:
            self.fault = "joint readings are missing"
            self.controller.command((0.0, 0.0, 0.0), now)
        out = self.controller.step(now, self._measured)
        self.bus.write(out.commands)
        if out.reasons & sw.Reason.JOINT_STUCK and not self.fault:
            self.fault = f"{out.worst_joint} does not follow"

    def _come_to_rest(self) -> None:
        """Halt; and whatever happens meanwhile, the last command is rest."""
        rest = dict.fromkeys(ROVER.traction_joints, 0.0)
        end = time.monotonic() + LAST
        try:
            self.controller.halt()
            while not self.controller.stopped and time.monotonic() < end:
                self.bus.write(self.controller.step(time.monotonic()).commands)
                time.sleep(PERIOD)
        except Exception as error:  # a bus that fails, say: the last command is tried all the same
            self._note(error)
        finally:
            self.bus.write(rest)

    def __enter__(self) -> "DriveThread":
        self.start()
        return self

    def __exit__(self, *error: object) -> None:
        # From here on a second Ctrl-C changes nothing: the end takes `LAST` at most.
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)
        self._ending.set()
        self.join()


def main() -> None:
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("told to end"))  # as an exception, like Ctrl-C
    bus = Bus()
    try:
        with DriveThread(bus) as rover:

            def drive_for(duration: float, speed: float, yaw_rate: float) -> None:
                """A joystick that is never quite still, read 50 times a second."""
                end = time.monotonic() + duration
                while (left := end - time.monotonic()) > 0.0:
                    rover.drive((speed, 0.0, yaw_rate + 0.01 * math.sin(40.0 * left)))
                    time.sleep(0.02)
                vx, _, omega = rover.controller.twist
                print(f"driving {vx:.2f} m/s, {omega:.2f} rad/s  {rover.fault}", flush=True)

            drive_for(1.2, 0.5, 0.3)
            bus.stuck = STEERING["front_left"]
            drive_for(1.2, 0.5, -0.3)
            bus.stuck, rover.fault = None, ""
            print("released:", rover.controller.release())
            drive_for(1.0, 0.5, -0.3)
    finally:
        fastest = max(abs(bus.joints[joint]) for joint in ROVER.traction_joints)
        print(f"the end: {fastest:.2f} rad/s commanded", flush=True)
        for number, handler in before.items():
            signal.signal(number, handler)


if __name__ == "__main__":
    main()
