"""Grounds and poses of the tests of settling."""

import six_wheel as sw

from .grounds import random_poses, rocks, scaled

CLOSED = 1e-10  # [m] gaps close to 2e-12; dense sampling of the rim and its golden section add 1e-12


def ground_for(rover, make=rocks, **options):
    """A map in the size of the rover, its heights, and its spacing."""
    scale = scaled(rover)
    heights, spacing = make(**options) * scale, 0.1 * scale
    return sw.Terrain(heights, spacing), heights, spacing


def poses_for(rover, count, seed=0):
    return random_poses(count, 20.0, 3.5, seed) * [scaled(rover), scaled(rover), 1]
