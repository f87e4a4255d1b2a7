"""Wheels that are said to touch do, and none is in the ground, by a search that shares nothing."""

import os

import numpy as np
import pytest

import six_wheel as sw

from .grounds import ROVERS, bilinear, dense_gaps, numbers_of, random_poses

SOAK = int(os.environ.get("SOAK", "1"))
CLOSED = 1e-10  # [m] gaps close to 2e-12; the search of the rim adds 1e-12
IN_AIR = {"rocker_limit": (-0.2, 0.2), "bogie_limit": (-0.3, 0.3)}
NAMES = ("z", "roll", "pitch", "joints", "gap", "contacts", "stands")


def one_by_one(rover, ground, poses, steering):
    """Results of single calls, in the form of a batch."""
    stands = [rover.settle(ground, pose, angles) for pose, angles in zip(poses, steering, strict=True)]
    return {name: np.array([getattr(stand, name) for stand in stands]) for name in NAMES}


def in_batch(rover, ground, poses, steering):
    stand = rover.settle(ground, poses, steering)
    return {name: getattr(stand, name) for name in NAMES}


def untrue(rover, ground, poses, steering, said):
    """Poses that stand and have a wheel whose gap, or whose contact, is not what is said of it."""
    stands = said["stands"]
    poses, steering, said = poses[stands], steering[stands], {k: v[stands] for k, v in said.items()}
    numbers = np.column_stack([said["z"], said["roll"], said["pitch"], said["joints"]])
    heights, spacing = ground.heights, ground.spacing[0]
    # Two minima may lie between samples that are 0.4 degrees apart: where it disagrees it looks once more.
    wrong = np.ones(len(poses), bool)
    for samples in (1001, 40_001):
        chosen = np.nonzero(wrong)[0]
        for part in np.array_split(chosen, len(chosen) // 200 + 1):
            gaps = dense_gaps(rover, heights, spacing, poses[part], numbers[part], steering[part], samples)
            wrong[part] = (np.abs(gaps - said["gap"][part]) > CLOSED).any(-1)
    x, y, z = np.moveaxis(said["contacts"], -1, 0)
    wrong |= (np.abs(z - bilinear(heights, spacing, x, y) - said["gap"]) > CLOSED).any(-1)
    touching = np.abs(said["gap"]) < CLOSED
    wrong |= (touching.sum(-1) < 3) | (said["gap"] < -CLOSED).any(-1)
    return np.nonzero(stands)[0][wrong]


@pytest.mark.parametrize("cover", [0.2, 0.3])
@pytest.mark.parametrize("settle", [one_by_one, in_batch])
def test_every_wheel_that_is_said_to_touch_does(settle, cover):
    rovers = [ROVERS["perseverance"], sw.RockerBogie(**ROVERS["perseverance"].dimensions | IN_AIR)]
    rovers += [ROVERS["curiosity"]]
    tried = 0
    for seed in range(SOAK):
        ground = sw.Terrain.yard(30, 0.1, cover, seed=seed)
        for k, rover in enumerate(rovers):
            poses = random_poses(200, 30.0, 3.5, 3 * seed + k)
            steering = np.random.default_rng(seed).uniform(-0.8, 0.8, (200, 4)) * (seed % 2)
            said = settle(rover, ground, poses, steering)
            wrong = untrue(rover, ground, poses, steering, said)
            assert not len(wrong), (seed, k, poses[wrong[0]].tolist(), steering[wrong[0]].tolist())
            tried += said["stands"].sum()
    assert tried > 0.9 * 600 * SOAK


def test_no_wheel_in_the_air_is_taken_for_one_that_touches():
    """A rim without a candidate once took the ground of the map's first cell, prolonged to the wheel."""
    rover, ground = ROVERS["perseverance"], sw.Terrain.yard(40, 0.1, 0.2, seed=1171)
    pose = np.array([8.933279351382634, 6.262430786693921, 2.487737241371753])
    stand = rover.settle(ground, np.tile(pose, (8, 1)))
    assert (stand.status == "settled").all()
    gaps = dense_gaps(rover, ground.heights, ground.spacing[0], np.tile(pose, (8, 1)), numbers_of(stand))
    assert np.abs(gaps).max() < CLOSED


@pytest.mark.parametrize("settle", [one_by_one, in_batch])
def test_ground_that_no_wheel_is_near_has_no_say(settle):
    rover = ROVERS["perseverance"]
    for seed, level in ((0, 0.1), (0, 0.5), (2, 0.2)):
        ground = sw.Terrain.yard(30, 0.1, 0.2, seed=seed)
        poses, steering = random_poses(3000, 30.0, 3.5, seed), np.zeros((3000, 4))
        heights = ground.heights.copy()
        heights[:2, :2] = level  # prolonged, it would be a plane through the rover
        said, other = (settle(rover, g, poses, steering) for g in (ground, sw.Terrain(heights, 0.1)))
        for name, value in said.items():
            np.testing.assert_array_equal(other[name], value, strict=True)
