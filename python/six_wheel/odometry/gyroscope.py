"""What a gyroscope errs by in the rows of a log."""

import math

from six_wheel._core import Gyroscope

__all__ = ["with_readings_apart"]


def with_readings_apart(known: Gyroscope, period: float | None, apart: float | None) -> Gyroscope:
    """A gyroscope whose readings are means over `apart` [s], of what is known of those over `period` [s]: the
    longer, the less white noise."""
    if not (period and apart):
        return known
    bias = {name: getattr(known, name) for name in ("bias", "bias_noise", "bias_walk")}
    return Gyroscope(known.noise * math.sqrt(period / apart), **bias)
