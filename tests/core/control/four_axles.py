"""Robots of the tests of four axles on lockable pivots."""

import numpy as np
from hypothesis import strategies as st

from six_wheel import FourAxle
from six_wheel.reference.control import four_axle as reference

H_X, H_Y, LENGTH, RADIUS = 0.4, 0.3, 0.2, 0.1


@st.composite
def cars(draw: st.DrawFn, *, rigid: bool = False) -> FourAxle:
    h_y = 0.0 if rigid else draw(st.floats(0.05, 0.6))
    return FourAxle((draw(st.floats(0.1, 1.0)), h_y), draw(st.floats(0.05, 0.4)), draw(st.floats(0.03, 0.3)))


def pivots_of(car: FourAxle) -> np.ndarray:
    return reference.pivot_points(*car.pivots)
