"""Suspensions other than the rocker-bogie on ground: they are data too."""

import copy
import math
import pickle

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import Suspension  # noqa: F401  (the name that a repr refers to)

from .grounds import hills, numbers_of, random_poses

BOX = [(0.5, 0.4, 0.2), (0.5, -0.4, 0.2), (-0.5, 0.4, 0.2), (-0.5, -0.4, 0.2)]
EXOMARS = {
    "bogie_pivot": (0.1325, 0.305, 0.1),
    "bogie_to_front": (0.1325, 0.0, -0.1),
    "bogie_to_middle": (-0.1325, 0.0, -0.1),
    "rear_pivot": (-0.265, 0.0, 0.1),
    "rear_to_wheel": (0.0, 0.305, -0.1),
    "wheel_radius": 0.0727,
}
CHAINS = {
    "triple_bogie": sw.Suspension.triple_bogie(**EXOMARS),
    "zoe": sw.Suspension.preset("zoe"),
    "rigid": sw.Suspension.rigid(BOX, 0.2, steered=[0, 1]),
    "bar": sw.RockerBogie(
        **sw.RockerBogie.preset("perseverance").dimensions | {"differential_bar": (0.6, 0.2, 0.3)}
    ),
}


@pytest.mark.parametrize("name", CHAINS)
def test_every_chain_stands_level_on_the_flat(name):
    chain = CHAINS[name]
    stand = chain.settle(sw.Terrain(np.zeros((80, 80)), 0.1), (4.0, 4.0, 0.3))
    assert stand.status == "settled"
    np.testing.assert_allclose([stand.roll, stand.pitch, *stand.joints], 0, atol=1e-9)
    assert stand.gap.shape == (len(chain.wheel_names),)
    assert stand.joints.shape == (len(chain.free_joints),)
    np.testing.assert_allclose(stand.gap, 0, atol=1e-11)


@pytest.mark.parametrize("name", CHAINS)
def test_every_chain_settles_on_hills(name):
    chain = CHAINS[name]
    ground = sw.Terrain(hills(), 0.1)
    stand = chain.settle(ground, random_poses(200, 20.0, 3.0, 1))
    assert (stand.status == "settled").all()
    touching = len(chain.free_joints) + 3
    np.testing.assert_array_equal((np.abs(stand.gap) < 1e-9).sum(-1), touching)
    assert stand.gap.min() > -1e-9
    contacts = stand.contacts[stand.gap < 1e-9]
    np.testing.assert_allclose(ground.height_at(contacts[:, :2]), contacts[:, 2], atol=1e-9)


def test_the_pivots_of_zoe_steer():
    zoe, ground = sw.Suspension.preset("zoe"), sw.Terrain(np.zeros((80, 80)), 0.1)
    stand = zoe.settle(ground, (4.0, 4.0, 0.0), (0.4, -0.4))
    left = stand.wheel_centres[0] - [4.0 + 1.91 / 2, 4.0, stand.z]
    np.testing.assert_allclose(left, 0.82 * np.array([-math.sin(0.4), math.cos(0.4), 0]) - [0, 0, 0.119])


def test_of_four_wheels_on_a_body_three_touch_and_bear_the_weight():
    box, heights = sw.Suspension.rigid(BOX, 0.2), np.zeros((60, 60))
    heights[30:, 30:] = -0.05  # under the left front wheel
    ground = sw.Terrain(heights, 0.1, (-2.95, -2.95))
    behind = box.settle(ground, (0.0, 0.0, 0.0), centre_of_mass=(-0.2, -0.1, 0.3))
    np.testing.assert_allclose(behind.gap, [0.05, 0, 0, 0], atol=1e-11)
    ahead = box.settle(ground, (0.0, 0.0, 0.0), centre_of_mass=(0.2, 0.1, 0.3))
    assert ahead.gap[0] == pytest.approx(0, abs=1e-11)
    assert ahead.gap[3] > 0.04  # the right rear one comes up
    assert ahead.pitch > 0


def test_a_bar_leaves_the_rockers_nearly_opposite():
    ground = sw.Terrain(hills(), 0.1)
    poses = random_poses(50, 20.0, 3.0, 2)
    gear = sw.RockerBogie.preset("perseverance").settle(ground, poses)
    bar = CHAINS["bar"].settle(ground, poses)
    difference = np.abs(numbers_of(bar) - numbers_of(gear)).max(-1)
    assert (difference > 0).all()
    assert (difference < 2 * gear.joints[:, 0] ** 2 + 1e-9).all()  # of second order in rho


@pytest.mark.parametrize("name", CHAINS)
def test_chains_are_values(name):
    chain = CHAINS[name]
    ground = sw.Terrain(np.zeros((80, 80)), 0.1)
    for same in (pickle.loads(pickle.dumps(chain)), copy.deepcopy(chain), eval(repr(chain), vars(sw))):
        assert same == chain
        assert hash(same) == hash(chain)
        assert same.settle(ground, (4.0, 4.0, 0.3)).z == chain.settle(ground, (4.0, 4.0, 0.3)).z
    assert chain != sw.RockerBogie.preset("rocky7")
    assert chain != "chain"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sw.Suspension.rigid(BOX[:2], 0.2), r"wheels must hold 3 to 6, got 2"),
        (lambda: sw.Suspension.rigid(BOX, -0.2), r"wheel_radius must be finite and positive, got -0\.2"),
        (lambda: sw.Suspension.rigid(BOX, 0.2, names=["a"]), r"names must hold 4, one for each"),
        (lambda: sw.Suspension.rigid(BOX, 0.2, steered=[4]), r"steered must hold indices of wheels"),
        (lambda: sw.Suspension.rigid([(0, 0, math.nan)] * 4, 0.2), r"wheels must be finite"),
        (
            lambda: sw.Suspension.pivoting_axles(wheelbase=0, track_width=1, drop=0, wheel_radius=0.1),
            r"wheelbase must be finite and positive, got 0\.0",
        ),
        (
            lambda: sw.Suspension.triple_bogie(**EXOMARS | {"bogie_limit": (0.1, 0.2)}),
            r"bogie_limit must hold the lower angle below the upper, and 0 between them, got \(0\.1, 0\.2\)",
        ),
        (lambda: sw.Suspension.triple_bogie(**EXOMARS | {"steered": "rear"}), r"steered must be 'front'"),
    ],
)
def test_wrong_dimensions_are_named(make, message):
    with pytest.raises(ValueError, match=message):
        make()
