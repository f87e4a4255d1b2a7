"""Model of encoders and a gyroscope: noise, ticks, counters that start over, jitter, lost rows."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from six_wheel._core import Encoder, Gyroscope, Noise, Rover
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.joint_totals import encoder_of_each
from six_wheel.simulation.planar import Motion

Encoders = Encoder | Sequence[Encoder] | Mapping[str, Encoder]


@dataclass(frozen=True, eq=False)
class Sensors:
    """Encoders of wheels and joints, a gyroscope, and how their readings err; see `simulate`."""

    noise: Noise
    wheel_encoders: Encoders | None
    steering_encoders: Encoders | None
    gyroscope: Gyroscope | None

    def read(self, rover: Rover, motion: Motion, random: np.random.Generator) -> dict[str, Any]:
        """Simulated readings at the rows of a motion, as arguments of a `WheelLog`.

        Every step of a wheel errs on its own by `noise.speed` times its duration, so that totals wander as
        odometry takes them to; every reading of a joint errs on its own. `noise.period` holds errors for
        that long.
        """
        noise, dt = self.noise, np.diff(motion.stamps)
        share = np.ones_like(dt) if noise.period is None else np.sqrt(noise.period / dt)
        radii = np.array([wheel.radius for wheel in rover.wheels])
        error = random.standard_normal((len(dt), len(radii))) * (noise.speed * dt * share)[:, None] / radii
        turned = motion.turned.copy()
        turned[1:] += np.cumsum(error, axis=0)
        per_reading = np.append(share[:1], share)[:, None]
        angles = motion.steering + noise.steering * per_reading * random.standard_normal(
            motion.steering.shape
        )
        wheels = counts(turned, encoder_of_each("wheel_encoders", self.wheel_encoders, rover.wheel_names))
        passive = [not wheel.driven for wheel in rover.wheels]
        wheels[:, passive] = np.nan
        steering = counts(
            angles, encoder_of_each("steering_encoders", self.steering_encoders, rover.steered_wheel_names)
        )
        encoders = {"wheel_encoders": self.wheel_encoders, "steering_encoders": self.steering_encoders}
        return {
            "stamps": motion.stamps,
            "steering": steering if steering.shape[1] else None,
            "wheel_angles": wheels,
            "yaw_rate": self._rates(motion.yaw_rate, dt, random),
            "options": {key: value for key, value in encoders.items() if value is not None},
            "rover": rover,
        }

    def _rates(self, rates: Floats, dt: Floats, random: np.random.Generator) -> Floats | None:
        """Readings of the gyroscope: its bias starts where its deviation allows and wanders."""
        gyroscope = self.gyroscope
        if gyroscope is None:
            return None
        start = gyroscope.bias + gyroscope.bias_noise * random.standard_normal()
        walk = gyroscope.bias_walk * np.sqrt(dt) * random.standard_normal(len(dt))
        bias = start + np.append(0.0, np.cumsum(walk))
        white = gyroscope.noise * random.standard_normal(len(bias))
        factor = 1.0 + (gyroscope.scale_noise * random.standard_normal() if gyroscope.scale_noise else 0.0)
        read: Floats = factor * rates + bias + white
        return read


def sample_times(
    begin: float, end: float, rate: float, jitter: float, dropped: float, random: np.random.Generator
) -> Floats:
    """Even stamps but for a standard deviation of `jitter` [s], never out of order; a share is `dropped`."""
    count = math.floor((end - begin) * rate + 1e-9) + 1
    stamps = begin + np.arange(count) / rate
    if jitter > 0.0:
        shift = np.clip(jitter * random.standard_normal(count), -0.45 / rate, 0.45 / rate)
        stamps = np.clip(stamps + shift, begin, end)
        stamps[0] = begin
    if dropped:
        kept = random.random(len(stamps)) >= dropped
        kept[[0, -1]] = True
        stamps = stamps[kept]
    return stamps


def counts(angles: Floats, every: Sequence[Encoder]) -> Floats:
    """Angles [rad] as encoders count them: whole ticks where they have ticks per turn, started over at the
    end of their range."""
    read = np.array(angles)
    for column, one in zip(read.T, every, strict=True):
        column[:] = (column - one.offset) / one.angle_per_tick
        if one.ticks_per_turn is not None:
            np.floor(column, out=column)
        if one.wraps_at is not None:
            np.mod(column, one.wraps_at, out=column)
    return read
