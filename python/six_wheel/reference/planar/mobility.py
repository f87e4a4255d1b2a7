"""Degrees of freedom at given steering angles, from the rank of the rows of no side slip.

Campion, Bastin & d'Andrea-Novel, IEEE Transactions on Robotics and Automation 12(1), 1996.
"""

from typing import NamedTuple

import numpy as np

from six_wheel.reference.planar.geometry import Floats

CONCURRENT = 1e-6  # side slip per metre driven below which steering angles agree on a motion [m/m]


class Mobility(NamedTuple):
    """The classification of a vehicle at given steering angles."""

    degree_of_mobility: int  # dimension of the motions that no wheel resists
    degree_of_steerability: int  # steering directions that can be chosen independently
    degree_of_manoeuvrability: int  # the sum of both
    rank: int
    singular_values: Floats  # (3,), of the rows of no side slip
    motion: Floats  # (degree_of_mobility, 3), orthonormal twists
    margin: float  # smallest singular value that is not zero


def mobility(fixed: Floats, steered: Floats) -> Mobility:
    """From the rows of no side slip (n, 3) of the unsteered and of the steered wheels."""
    fixed_rank = int(np.sum(np.linalg.svd(fixed, compute_uv=False) > CONCURRENT))
    _, sigma, directions = np.linalg.svd(np.concatenate((fixed, steered)))
    sigma = np.concatenate((sigma, np.zeros(3 - len(sigma))))
    rank = int(np.sum(sigma > CONCURRENT))
    margin = float(sigma[rank - 1]) if rank > 0 else 0.0
    free, steering = 3 - rank, rank - fixed_rank
    return Mobility(free, steering, free + steering, rank, sigma, directions[rank:], margin)
