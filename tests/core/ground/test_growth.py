"""Poses at which Newton's method closes no gaps: they are settled by ground that grows, or have a reason."""

import math
import os

import numpy as np
import pytest

import six_wheel as sw

from .grounds import ROVERS, bilinear, dense_gaps, holes, numbers_of, random_poses, rims

SOAK = int(os.environ.get("SOAK", "1"))
FAR = math.radians(60)
TIPS = "as the ground grows from flat to what it is, the rover or a bogie tips over"


def yard_and_poses(size=40.0, count=20_000):
    """Rocks as large as the small rovers that are on it, and larger."""
    ground = sw.Terrain.yard(size, 0.05, cover=0.2, seed=11)
    return ground, np.random.default_rng(3).uniform([3, 3, -math.pi], [37, 37, math.pi], (count, 3))


@pytest.mark.parametrize(("name", "hard"), [("rocky7", [7140, 8894]), ("open_source_rover", [15280])])
def test_small_rovers_among_large_rocks(name, hard):
    """Poses that Newton's method alone has lost (`hard`) stand on every wheel; most others tip over."""
    rover = ROVERS[name]
    ground, poses = yard_and_poses()
    stand = rover.settle(ground, poses)
    lost = ~stand.stands
    assert lost.mean() < 1e-3
    assert set(stand.reason[~lost]) == {""}
    assert set(stand.status[lost]) == {"not_converged"}
    assert np.mean(stand.reason[lost] == TIPS) > 0.8
    for k in hard:
        numbers = numbers_of(rover.settle(ground, poses[k]))
        np.testing.assert_array_equal(numbers, numbers_of(stand)[k])
        gaps = dense_gaps(rover, ground.heights, 0.05, poses[k], numbers, samples=40_001)
        np.testing.assert_allclose(gaps, 0, atol=1e-10)  # closed to 2e-12, the search adds 1e-12


def test_reasons_are_words():
    rover = ROVERS["perseverance"]
    heights = np.zeros((200, 200))
    heights[100:, :100] = math.nan
    ground = sw.Terrain(heights, 0.1)
    stand = rover.settle(ground, [(14.0, 4.0, 0.0), (4.0, 14.0, 0.0), (-5.0, 0.0, 0.0)])
    assert list(stand.reason) == [
        "",
        "the rim of a wheel lies over ground that is not known",
        "the rim of a wheel leaves the map",
    ]
    assert rover.settle(ground, (14.0, 4.0, 0.0)).reason == ""
    assert rover.settle(ground, np.empty((0, 3))).reason.shape == (0,)


def test_where_free_joints_find_nothing_stops_are_tried():
    """Pits deeper than the suspension reaches: few are lost, and those at stops touch as they say."""
    free = ROVERS["perseverance"]
    rover = sw.RockerBogie(**free.dimensions | {"rocker_limit": (-0.3, 0.3), "bogie_limit": (-0.4, 0.4)})
    heights = holes()
    ground, poses = sw.Terrain(heights, 0.1), random_poses(400, 20.0, 4.0, 7)
    stand = rover.settle(ground, poses)
    assert (~stand.stands).mean() < 0.02
    for k in np.nonzero(stand.status == "at_stop")[0][:10]:
        gaps = dense_gaps(rover, heights, 0.1, poses[k], numbers_of(stand)[k])
        np.testing.assert_allclose(gaps, stand.gap[k], atol=1e-10)


def sampled_gaps(rover, heights, spacing, pose, states, samples=720):
    """Least gaps of all wheels in many states at a pose, by sampling whole rims."""
    t = np.linspace(-math.pi, math.pi, samples, endpoint=False)
    radius, found = rover.dimensions["wheel_radius"], []
    for wheel in rims(rover, np.broadcast_to(pose, (len(states), 3)), states):
        centre, forward, up = (vectors.T[..., None] for vectors in wheel)
        points = centre + radius * (forward * np.sin(t) - up * np.cos(t))
        found.append((points[2] - bilinear(heights, spacing, points[0], points[1])).min(-1))
    return np.stack(found, -1)


def states_found(rover, ground, pose, starts, seed):
    """States at which no gap is larger than 0.1 mm: damped least squares by differences, from random starts.

    No angle gets larger than `FAR`.
    """
    spacing, step, random = ground.spacing[0], 1e-5, np.random.default_rng(seed)
    numbers = random.uniform(-0.9, 0.9, (starts, 6))
    numbers[:, 0] = ground.height_at(pose[:2]) + random.uniform(-0.2, 0.3, starts)
    gaps = sampled_gaps(rover, ground.heights, spacing, pose, numbers)
    for _ in range(25):
        beside = [
            sampled_gaps(rover, ground.heights, spacing, pose, numbers + row) for row in step * np.eye(6)
        ]
        slopes = (np.stack(beside, -1) - gaps[..., None]) / step
        square = np.swapaxes(slopes, 1, 2) @ slopes + 1e-7 * np.eye(6)
        way = -np.linalg.solve(square, np.swapaxes(slopes, 1, 2) @ gaps[..., None])[..., 0]
        way *= np.minimum(1, 0.25 / np.maximum(np.abs(way[:, 1:]).max(1), 1e-9))[:, None]
        moved = np.zeros(starts, bool)
        for share in (1, 0.5, 0.25, 0.1, 0.03):
            there = numbers + share * way
            there[:, 1:] = there[:, 1:].clip(-FAR, FAR)
            gaps_there = sampled_gaps(rover, ground.heights, spacing, pose, there)
            better = np.abs(gaps_there).max(1) < np.abs(gaps).max(1) * (1 - 0.2 * share)
            take = ~moved & (better | (share < 0.1))
            numbers[take], gaps[take], moved = there[take], gaps_there[take], moved | take
    return numbers[np.abs(gaps).max(1) < 1e-4]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rocky7", "open_source_rover"])
def test_what_is_said_to_tip_over_closes_no_gaps_short_of_that(name):
    """Another search, which finds every pose that does stand, finds no state with all wheels on the ground.

    Not within 60 degrees. Beyond 77, where `settle` stops, bogies on end may touch with both wheels.
    """
    rover = ROVERS[name]
    ground, poses = yard_and_poses()
    stand = rover.settle(ground, poses)
    lost, count = np.nonzero(stand.reason == TIPS)[0], 2 * SOAK
    for k in np.nonzero(stand.stands)[0][:count]:
        found = states_found(rover, ground, poses[k], 16, k)
        assert np.abs(found - numbers_of(stand)[k]).max(1).min() < 1e-3  # 720 samples of a rim miss 1e-6 m
    for k in lost[:count]:
        assert len(states_found(rover, ground, poses[k], 16 * min(SOAK, 8), k)) == 0
