"""A rover, its limits and a drive of the tests of the controller."""

import math

import six_wheel as sw
from six_wheel.reference.control import controller as slow
from tests.rovers import SIX_SIZES

ROVER = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(60))

LIMITS = sw.Limits(
    speed=1.0,
    acceleration=0.5,
    deceleration=0.8,
    jerk=2.0,
    angular_acceleration=1.0,
    wheel_speed=8.0,
    wheel_acceleration=10.0,
    steering_rate=1.0,
    steering_acceleration=4.0,
    lateral_acceleration=0.4,
)


# Rounding of divided differences of numbers near 1, over steps of 1 ms: 1e-16 / 1e-6 beside limits near 1.
ALL = 1.0 + 1e-6


def shot(now: float, out: sw.ControllerOutput) -> slow.Shot:
    return slow.Shot(now, out.twist, out.steering, out.wheel_speeds)


def drive(controller, seconds, *, start=0.0, dt=0.01, commands=()):
    """A log of steps; `commands` are pairs of step and twist."""
    commands, log = dict(commands), []
    for k in range(round(seconds / dt) + 1):
        now = start + k * dt
        if k in commands:
            controller.command(commands[k], now)
        log.append((now, controller.step(now)))
    return log
