"""Folder of the OptiOdom recordings beside the repository, and the error of plain dead reckoning on them."""

import json
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.logs import WheelLog, optiodom

DATA = Path(__file__).parents[2] / "shared" / "data"
FOLDER = DATA / "optiodom"
HERE = (DATA / "baselines.json").exists()
REQUIRED = pytest.mark.skipif(not HERE, reason=f"the OptiOdom recordings are not in {FOLDER}")
ROBOTS = ("diff", "tricyc", "omni3", "omni4")

BASELINES: dict = json.loads((DATA / "baselines.json").read_text())["optiodom"] if HERE else {}
RUNS = {robot: BASELINES[robot]["runs"] if HERE else [] for robot in ROBOTS}


def read(run: dict) -> tuple[sw.Rover, WheelLog]:
    return optiodom.read_rover(FOLDER / run["run"]), optiodom.read(FOLDER / run["run"])


def reckon(rover: sw.Rover, log: WheelLog) -> np.ndarray:
    """Dead reckoning in three lines: angles of mid-step, twists by least squares, exact arcs."""
    dt = np.diff(log.stamps)
    steering = np.empty((len(dt), 0)) if log.steering is None else (log.steering[1:] + log.steering[:-1]) / 2
    twists = rover.forward(steering, np.diff(log.wheel_angles, axis=0) / dt[:, None])
    return sw.integrate(twists, dt, start=log.truth.poses[0])
