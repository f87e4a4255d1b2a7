"""Rollouts of a sampling planner: where they lead, and what they ask of the wheels."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.planar.geometry import Floats, MaybeArray, finite, integrate
from six_wheel.reference.planar.rover import Rover
from six_wheel.reference.planar.wheels import choose


def rollout_cost(
    rover: Rover, controls: ArrayLike, dt: ArrayLike, start: ArrayLike = (0.0, 0.0, 0.0),
    previous: MaybeArray = None
) -> tuple[Floats, Floats]:  # fmt: skip
    """Controls (k, t, 3) -> poses (k, t + 1, 3) and costs (k, 4) of each rollout: the worst wheel speed
    [rad/s], steering angle [rad], steering rate [rad/s] and scrub [m/s].

    A steered wheel takes the angle nearest to the one it needs, and the angles of the step before decide
    between equivalent ones; `previous` (steered,) [rad] are those before the first step, whose rate counts
    only then.
    """
    rollouts = finite("controls", controls)
    dts = np.broadcast_to(np.asarray(dt, dtype=float), rollouts.shape[1:2])
    starts = np.broadcast_to(finite("start", start), (len(rollouts), 3))
    poses = np.array([integrate(twists, dts, first) for twists, first in zip(rollouts, starts, strict=True)])
    return poses, np.array([_worst(rover, twists, dts, previous) for twists in rollouts])


def _worst(rover: Rover, twists: Floats, dts: Floats, previous: MaybeArray) -> Floats:
    costs = np.zeros((len(twists), 4))
    held = np.zeros(len(rover.steered)) if previous is None else finite("previous", previous)
    for k, (twist, dt) in enumerate(zip(twists, dts, strict=True)):
        # Any slip is tolerable here: what is wanted is how much of it there is.
        pairs = zip(rover.steered, held, strict=True)
        taken = choose([wheel.ways(twist, angle, 0.0, math.inf) for wheel, angle in pairs], [0.0] * len(held))
        angles = np.array([way.angle for way in taken])
        steer = iter(angles)
        rows = [wheel.rows(next(steer) if wheel.steered else 0.0) for wheel in rover.wheels]
        along = [
            wheel.trailing_rim_speed(twist) if wheel.castor else float(row[0] @ twist)
            for wheel, row in zip(rover.wheels, rows, strict=True)
        ]
        slips = [float(row @ twist) for row, _ in rover._banks]
        slips += [
            float(row[1] @ twist) for wheel, row in zip(rover.wheels, rows, strict=True) if wheel.steered
        ]
        wheel_speeds = [rim / wheel.radius for rim, wheel in zip(along, rover.wheels, strict=True)]
        rate = 0.0 if k == 0 and previous is None else np.abs(angles - held).max(initial=0.0) / dt
        costs[k] = (
            np.abs(wheel_speeds).max(),
            np.abs(angles).max(initial=0.0),
            rate,
            np.abs(slips).max(initial=0.0),
        )
        held = angles
    return np.asarray(costs.max(axis=0, initial=0.0))
