"""Poses at which Newton's method closes no gaps: they are settled by ground that grows, or have a reason."""

import math

import numpy as np
import pytest

import six_wheel as sw

from .grounds import ROVERS, dense_gaps, holes, numbers_of, random_poses

TIPS = "as the ground grows from flat to what it is, the rover or a bogie tips over"


def yard_and_poses(size=40.0, count=20_000):
    """Rocks as large as the small rovers that are on it, and larger."""
    ground = sw.Terrain.yard(size, 0.05, cover=0.2, seed=11)
    return ground, np.random.default_rng(3).uniform([3, 3, -math.pi], [37, 37, math.pi], (count, 3))


@pytest.mark.parametrize(("name", "hard"), [("rocky7", [7140, 8894]), ("open_source_rover", [])])
def test_small_rovers_among_large_rocks(name, hard):
    """What Newton's method alone has lost (`hard`) stands on every wheel; most of what does not tips over."""
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
