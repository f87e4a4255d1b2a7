"""Performance of a rover within limits: top speeds, the limits that bound them, stopping distances.

Nothing is computed here: a `Controller` is asked.
"""

import inspect
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import Controller, Limits, Rover
from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.poses import Floats
from six_wheel.kinematics.profiles import time_optimal
from six_wheel.kinematics.rover_edit import limits_given

LASTING = ("speed", "yaw_rate", "lateral_acceleration", "wheel_speed", "steering_limit")
FAR = 1e6  # times what is likely: more than any limit allows
SETTLED = 1e-9  # share of the speed that is still to come
STEPS = 2000  # per time that speeding up takes


class Bound(NamedTuple):
    """The fastest motion (3,) of one direction, and what keeps it from being faster."""

    twist: Floats
    reasons: Reason


class Rim(NamedTuple):
    """The fastest motions of all directions in the plane of vx and omega, and what keeps them from more.

    Directions (n, 3) are twists as well, of a size that goes round the picture evenly.
    """

    directions: Floats
    twists: Floats
    reasons: list[Reason]


class Stop(NamedTuple):
    """Distance [m] and time [s] of a stop."""

    distance: float
    time: float


def _lasting(rover: Rover, limits: Limits) -> Controller:
    """One that knows only the limits that stay, and so is there in one step."""
    none = dict.fromkeys(inspect.signature(Limits).parameters, math.inf)
    lasting = {name: getattr(limits, name) for name in LASTING}
    return Controller(rover, Limits(**none | lasting), timeout=None, align=None)


def _fastest(controller: Controller, twist: ArrayLike) -> Bound:
    controller.reset()
    controller.command(twist, 0.0)
    for now in (0.0, 0.05):  # from rest, the wheels turn first
        output = controller.step(now)
    return Bound(np.array(output.twist), output.reasons)


def within(rover: Rover, limits: Limits, twist: ArrayLike) -> Bound:
    """The motion that comes of a twist in the end, and what keeps it from being as commanded."""
    return _fastest(_lasting(rover, limits), twist)


def bound(rover: Rover, limits: Limits, twist: ArrayLike) -> Bound | None:
    """The fastest motion along a twist; None if nothing limits it."""
    wanted = FAR * np.asarray(twist, dtype=np.float64)
    found = _fastest(_lasting(rover, limits), wanted)
    return None if np.array_equal(found.twist, wanted) else found


def rim(rover: Rover, limits: Limits, directions: int = 720) -> Rim | None:
    """The fastest motions of all directions; None unless every direction has one."""
    controller = _lasting(rover, limits)
    angles = math.tau / directions * np.arange(directions)
    around = np.stack((np.cos(angles), np.zeros(directions), np.sin(angles)), axis=1)
    scales = np.ones(3)
    for _ in range(2):  # even in the picture, whose scales come of the first round
        found = [_fastest(controller, FAR * scales * direction) for direction in around]
        twists = np.array([each.twist for each in found])
        if np.any(np.abs(twists) > math.sqrt(FAR) * scales):
            return None
        scales = np.abs(twists).max(axis=0)
        scales[scales == 0.0] = 1.0
    return Rim(scales * around, twists, [each.reasons for each in found])


def defaults(rover: Rover, limits: Limits) -> dict[str, float]:
    """The limits that were left out and have a default, by name, with that."""
    given, filled = limits_given(limits), limits_given(limits.on(rover))
    left_out = {name: value for name, value in filled.items() if name not in given and math.isfinite(value)}
    if not rover.steered_wheel_names:
        left_out.pop("steering_rate", None)
    return left_out


def time_to_full_lock(rover: Rover, limits: Limits) -> float | None:
    """Least time [s] from straight to the end of the range, for the widest range; None if unlimited
    or endless."""
    limits = limits.on(rover)
    ranges = [wheel.steering_range for wheel in rover.wheels if wheel.steering_range is not None]
    if not ranges or math.isinf(limits.steering_rate):
        return None
    farthest = max(max(abs(lower), abs(upper)) for lower, upper in ranges)
    farthest = min(farthest, limits.steering_limit)
    if math.isinf(farthest):
        return None
    changes = limits.steering_acceleration
    profile = time_optimal(
        0.0, farthest, velocity=limits.steering_rate, acceleration=changes if math.isfinite(changes) else None
    )
    return float(profile.duration)


def stop_from(rover: Rover, limits: Limits, twist: ArrayLike) -> Stop | None:
    """Distance [m] and time [s] from a steady twist to rest; None if it stops at once."""
    if (steady := _steady(rover, limits.on(rover), twist)) is None:
        return None
    controller, now, dt = steady
    controller.command((0.0, 0.0, 0.0), now)
    return _to_rest(controller, now, dt)


def halt_from(rover: Rover, limits: Limits, twist: ArrayLike) -> Stop | None:
    """Distance [m] and time [s] of a halt from a steady twist to rest; None if it stops at once."""
    filled = limits.on(rover)
    if (steady := _steady(rover, filled, twist)) is None or math.isinf(filled.halt_deceleration):
        return None
    controller, now, dt = steady
    controller.halt()
    return _to_rest(controller, now, dt)


def _to_rest(controller: Controller, now: float, dt: float) -> Stop:
    """The way from here to rest, which the controller has been told to come to."""
    distance, begin, end = 0.0, now, now + 100 * STEPS * dt
    speed = float(np.hypot(*controller.twist[:2]))
    while not controller.stopped and now < end:
        now += dt
        slower = float(np.hypot(*controller.step(now).twist[:2]))
        distance, speed = distance + dt * (speed + slower) / 2.0, slower
    return Stop(distance, now - begin)


def _steady(rover: Rover, limits: Limits, twist: ArrayLike) -> tuple[Controller, float, float] | None:
    """A controller in a steady twist, its time [s] and a step [s] that is short for these limits, all of them
    filled in; None if the rover stops at once."""
    speed = float(np.hypot(*np.asarray(twist, dtype=np.float64)[:2]))
    slowest = min(limits.acceleration, limits.deceleration)
    if speed == 0.0 or math.isinf(limits.deceleration):
        return None
    likely = speed / slowest + math.sqrt(speed / limits.jerk) if math.isfinite(slowest) else 1.0
    dt, now = likely / STEPS, 0.0
    controller = Controller(rover, limits, timeout=None, align=None, max_step=dt)
    controller.command(twist, now)
    for _ in range(100 * STEPS):
        now += dt
        if float(np.hypot(*controller.step(now).twist[:2])) >= (1.0 - SETTLED) * speed:
            break
    return controller, now, dt
