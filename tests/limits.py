"""Limits of tests."""

import math

import six_wheel as sw

# Limits whose default depends on others follow them: deceleration, the angular ones, the halt.
NO_DEFAULTS = {
    "acceleration": math.inf,
    "angular_acceleration": math.inf,
    "angular_jerk": math.inf,
    "steering_rate": math.inf,
}

SMOOTH = sw.Limits(speed=1.0, acceleration=0.5, jerk=2.0, wheel_speed=8.0, steering_rate=1.0)


def only(**given: float) -> sw.Limits:
    """These limits, and no default beside them."""
    return sw.Limits(**NO_DEFAULTS | given)
