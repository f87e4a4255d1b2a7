"""Calls of the tests of single calls."""

import numpy as np

import six_wheel as sw
from tests.core.oracles.test_batch import ROVERS

ROVER = ROVERS["perseverance"]
TWIST = (0.1, 0.0, 0.2)
QUICK = ["inverse", "forward", "project", "admissible"]


def outputs(rover: sw.Rover, fill: float = 7.0) -> tuple[np.ndarray, np.ndarray]:
    return np.full(len(rover.steered_wheel_names), fill), np.full(len(rover.wheels), fill)
