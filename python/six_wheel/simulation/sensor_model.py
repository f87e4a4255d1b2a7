"""Model of encoders and a gyroscope: noise, ticks, counters that start over, jitter, lost rows."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Encoder, Gyroscope, Noise, Rover
from six_wheel.logs.recordings import encoders_of
from six_wheel.simulation.planar import Motion

Floats = NDArray[np.float64]
Encoders = Encoder | Sequence[Encoder] | Mapping[str, Encoder]


@dataclass(frozen=True, eq=False)
class Sampled:
    """Stamps (n,) [s], counts of joints (n, steered) and wheels (n, wheels), yaw rates (n,) or None."""

    stamps: Floats
    steering: Floats
    wheels: Floats
    yaw_rate: Floats | None


def sample_times(begin: float, end: float, rate: float, jitter: float, random: np.random.Generator) -> Floats:
    """Even stamps but for a standard deviation of `jitter` [s], never out of order."""
    count = math.floor((end - begin) * rate + 1e-9) + 1
    stamps = begin + np.arange(count) / rate
    if jitter > 0.0:
        shift = np.clip(jitter * random.standard_normal(count), -0.45 / rate, 0.45 / rate)
        stamps = np.clip(stamps + shift, begin, end)
        stamps[0] = begin
    return stamps


def read(
    rover: Rover,
    motion: Motion,
    noise: Noise,
    encoder: Encoders | None,
    steering_encoder: Encoders | None,
    gyroscope: Gyroscope | None,
    random: np.random.Generator,
) -> Sampled:
    """Simulated readings of the sensors at the rows of a motion.

    Every step of a wheel errs on its own by `noise.speed` times its duration, so that totals wander as
    odometry takes them to; every reading of a joint errs on its own. The bias of the gyroscope starts
    where its deviation allows and wanders. `noise.period` holds errors for that long.
    """
    dt = np.diff(motion.stamps)
    share = np.ones_like(dt) if noise.period is None else np.sqrt(noise.period / dt)
    radii = np.array([wheel.radius for wheel in rover.wheels])
    error = random.standard_normal((len(dt), len(radii))) * (noise.speed * dt * share)[:, None] / radii
    turned = motion.turned.copy()
    turned[1:] += np.cumsum(error, axis=0)
    per_reading = np.append(share[:1], share)[:, None]
    angles = motion.steering + noise.steering * per_reading * random.standard_normal(motion.steering.shape)
    wheels = counts(turned, encoders_of("encoder", encoder, rover.wheel_names))
    passive = [not wheel.driven for wheel in rover.wheels]
    wheels[:, passive] = np.nan
    steering = counts(angles, encoders_of("steering_encoder", steering_encoder, rover.steered_names))
    rates = None
    if gyroscope is not None:
        start = gyroscope.bias + gyroscope.bias_noise * random.standard_normal()
        walk = gyroscope.bias_walk * np.sqrt(dt) * random.standard_normal(len(dt))
        bias = start + np.append(0.0, np.cumsum(walk))
        white = gyroscope.noise * random.standard_normal(len(bias))
        factor = 1.0 + (gyroscope.scale_noise * random.standard_normal() if gyroscope.scale_noise else 0.0)
        rates = factor * motion.yaw_rate + bias + white
    return Sampled(motion.stamps, steering, wheels, rates)


def counts(angles: Floats, every: Sequence[Encoder]) -> Floats:
    """Angles [rad] as encoders count them: whole ticks where they have a resolution, started over at the
    modulus."""
    read = np.array(angles)
    for column, one in zip(read.T, every, strict=True):
        column[:] = (column - one.offset) / one.angle_per_count
        if one.resolution is not None:
            np.floor(column, out=column)
        if one.modulus is not None:
            np.mod(column, one.modulus, out=column)
    return read
