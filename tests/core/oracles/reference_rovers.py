"""Rovers and limits of the tests against the reference."""

import numpy as np
from hypothesis import strategies as st

from six_wheel.reference import (
    Rover,
    Wheel,
)

speed = st.floats(-2.0, 2.0)
twists = st.tuples(speed, speed, speed).map(np.array)
lengths = st.floats(0.1, 1.5)

rovers = st.builds(
    Rover.six_wheel,
    front_to_middle=lengths,
    middle_to_rear=lengths,
    track_width=lengths,
    middle_track_width=lengths,
    wheel_radius=st.floats(0.05, 0.3),
)

limits = st.floats(0.1, 1.5)


def admissible_twist(vx, omega):
    return np.array([vx, 0.0, omega])


def swerve(limit=None):
    places = {"fl": (0.5, 0.3), "fr": (0.4, -0.3), "rl": (-0.4, 0.35), "rr": (-0.5, -0.3)}
    return Rover(
        tuple(Wheel(k, *p, radius=0.1, steered=True, steering_limit=limit) for k, p in places.items())
    )
