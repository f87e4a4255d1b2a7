"""Robots on lockable pivots."""

import pytest

from six_wheel import FourAxle
from tests.core.control.four_axles import H_X, H_Y, LENGTH, RADIUS


@pytest.fixture(scope="module")
def car() -> FourAxle:
    return FourAxle(pivots=(H_X, H_Y), axle_length=LENGTH, wheel_radius=RADIUS)


@pytest.fixture(scope="module")
def tandem() -> FourAxle:
    return FourAxle(pivots=(H_X, 0.0), axle_length=0.3, wheel_radius=RADIUS)
