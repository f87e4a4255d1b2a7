"""Cases of the tests of profiles."""

import numpy as np

from six_wheel import profiles


def cuts(profile: profiles.Profile, count: int = 200) -> np.ndarray:
    return np.linspace(0.0, profile.duration, count)
