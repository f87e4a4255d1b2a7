"""Error model of a gyroscope for the rows of a log."""

import math

from six_wheel._core import Gyroscope

ARGUMENTS = ("noise", "bias", "bias_noise", "bias_walk", "scale_noise")  # of `Gyroscope`


def with_readings_apart(known: Gyroscope, period: float | None, apart: float | None) -> Gyroscope:
    """A gyroscope whose readings are means over `apart` [s], of what is known of those over `period` [s]: the
    longer, the less white noise."""
    if not (period and apart):
        return known
    return known.replace(noise=known.noise * math.sqrt(period / apart))
