"""Commands on rough ground: there is one wherever a rover stands, and it moves the rover as it says."""

import math
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.core.ground.grounds import LEVEL, hills, random_poses, scaled

ROVERS = ("rocky7", "perseverance", "curiosity", "zoe")
SIZE = 30.0  # of a yard for Perseverance [m]


def made(name: str) -> sw.Suspension:
    """A preset whose steering nothing limits: no motion is infeasible but for the ground."""
    if name == "zoe":
        return sw.Suspension.pivoting_axles(
            wheelbase=1.91, track_width=1.64, drop=0.119, wheel_radius=0.325, steering_limit=math.pi
        )
    dimensions = dict(sw.RockerBogie.preset(name).dimensions)
    return sw.RockerBogie(**dimensions | {"steering_limit": math.pi})


def share(arm: sw.Suspension) -> float:
    """Size of its ground, as a share of that for Perseverance."""
    return scaled(arm) if isinstance(arm, sw.RockerBogie) else 1.0


def asked(arm: sw.Suspension, count: int, seed: int) -> np.ndarray:
    """Speeds and yaw rates, some of them on the spot, some of them none."""
    commands = np.random.default_rng(seed).uniform(-1, 1, (count, 2)) * [0.2, 0.2 / share(arm)]
    commands[::7, 0], commands[3::50] = 0, 0
    return commands


@pytest.mark.parametrize("name", ROVERS)
def test_wherever_a_rover_settles_it_can_go(name: str) -> None:
    """Among rocks that cover a fifth of the ground, where wheels' rims go faster than their centres."""
    arm, count = made(name), 4000
    size = SIZE * share(arm)
    yard = sw.Terrain.yard(size, spacing=0.1 * share(arm), cover=0.2, seed=3, roughness=0.1 * share(arm))
    stand = arm.settle(yard, random_poses(count, size, 0.1 * size, 4))
    told = arm.inverse(stand, asked(arm, count, 5))
    stands = np.isfinite(stand.z)
    assert stands.mean() > 0.99
    for values in (told.steering, told.wheel_speeds, told.twist, told.joint_rates):
        np.testing.assert_array_equal(np.isfinite(values).all(-1), stands)


def there_and_back(arm: Any, stand: sw.SettledPose, commands: np.ndarray, sides: Any, **more: Any) -> None:
    """Wheel rates to motion, of wheels of which some need not hold sideways."""
    told = arm.inverse(stand, commands, **more)
    weights = np.column_stack([np.ones(len(sides)), sides])
    back = arm.forward(stand, None, told.wheel_speeds, weights=weights)
    assert np.isfinite(stand.z).mean() > 0.99
    # Rounding of 1e-16, in systems whose columns are a thousandth of each other at worst.
    np.testing.assert_allclose(back.twist, told.twist, rtol=0, atol=1e-9)
    np.testing.assert_allclose(back.joint_rates, told.joint_rates, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", ROVERS)
def test_inverse_then_forward_is_the_identity(name: str) -> None:
    """Among rocks, at the angles that wheels have."""
    arm, count = made(name), 1000
    size = SIZE * share(arm)
    yard = sw.Terrain.yard(size, spacing=0.1 * share(arm), cover=0.2, seed=6, roughness=0.1 * share(arm))
    wheels = len(arm.wheel_names)
    steered = arm.traction(0, 0, (0, 0, 0), *[np.zeros(len(arm.free_joints))] * 2).steering.size
    angles = np.random.default_rng(7).uniform(0.2, 0.5, (count, steered)) * [1, -1, 1, -1][:steered]
    stand = arm.settle(yard, random_poses(count, size, 0.1 * size, 8), angles)
    there_and_back(arm, stand, asked(arm, count, 9), np.zeros(wheels), steering=stand.steering)


@pytest.mark.parametrize("name", ROVERS[:3])
def test_steered_wheels_roll_where_a_rover_stands_with_them(name: str) -> None:
    """Settled with the angles that come out until they stay: then nothing that is steered slips sideways."""
    arm, count = made(name), 300
    ground = sw.Terrain(hills(SIZE) * share(arm), 0.1 * share(arm))
    poses, commands = random_poses(count, SIZE * share(arm), 4 * share(arm), 10), asked(arm, count, 11)
    stand = arm.settle(ground, poses)
    for _ in range(30):
        angles = arm.inverse(stand, commands).steering
        still = np.abs(angles - stand.steering).max(1) < 1e-12
        stand = arm.settle(ground, poses, angles)
    # The others go to and fro between two cells of the ground.
    assert still.mean() > 0.9
    assert isinstance(arm, sw.RockerBogie)
    sides = np.array([wheel.steered for wheel in arm.planar().wheels], float)
    kept = arm.settle(ground, poses[still], angles[still])
    there_and_back(arm, kept, commands[still], sides)


@pytest.mark.parametrize("name", LEVEL)
def test_on_level_ground_it_is_the_rover_seen_from_above(name: str) -> None:
    arm, commands = made(name), asked(made(name), 200, 12)
    stand = arm.settle(sw.Terrain(np.zeros((9, 9)), 1.0, (-4, -4)), np.zeros((200, 3)))
    told = arm.inverse(stand, commands)
    assert isinstance(arm, sw.RockerBogie)
    above = arm.steer(*commands.T, (0, 0, 0))
    np.testing.assert_allclose(told.wheel_speeds, above.wheel_speeds, rtol=0, atol=1e-12)
    np.testing.assert_allclose(told.steering, above.steering, rtol=0, atol=1e-12)
