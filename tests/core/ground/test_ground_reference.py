"""The plain ground model against what needs no model: planes, differences, and the planar formulas."""

import math

import numpy as np
import pytest

from six_wheel import RockerBogie
from six_wheel.reference import ground as plain

PERSEVERANCE = {
    "rocker_pivot": (0.30402, 0.79959, 0.89288),
    "rocker_to_front": (0.881, 0.26291, -0.63),
    "rocker_to_bogie": (-0.754, 0.12, -0.23),
    "bogie_to_middle": (0.44998, 0.26491, -0.4),
    "bogie_to_rear": (-0.625, 0.14291, -0.4),
    "wheel_radius": 0.26288,
}
TURNED_ROUND = {  # the same rover driving backwards: its bogies are in front
    "rocker_pivot": (-0.30402, 0.79959, 0.89288),
    "rocker_to_rear": (-0.881, 0.26291, -0.63),
    "rocker_to_bogie": (0.754, 0.12, -0.23),
    "bogie_to_middle": (-0.44998, 0.26491, -0.4),
    "bogie_to_front": (0.625, 0.14291, -0.4),
    "wheel_radius": 0.26288,
}


def rough(seed: int = 1) -> plain.Terrain:
    """Hills with a little of everything on them, 40 m wide."""
    x = 0.1 * np.arange(400)
    waves = 0.12 * np.sin(0.55 * x + 0.3) * np.cos(0.43 * x[:, None])
    return plain.Terrain(waves + 0.04 * np.random.default_rng(seed).standard_normal((400, 400)), 0.1)


def numbers(stand: plain.SettledPose) -> np.ndarray:
    """``z, roll, pitch, joints``."""
    assert stand.joints is not None
    return np.array([stand.z, stand.roll, stand.pitch, *stand.joints])


def test_a_gap_is_the_least_of_a_dense_rim() -> None:
    """Sampled a hundred times closer than the search begins with."""
    land, rng = rough(), np.random.default_rng(4)
    t = np.linspace(-math.pi, math.pi, 144001)
    for _ in range(20):
        yaw, centre = rng.uniform(-3, 3), np.array([*rng.uniform(5, 35, 2), 0.4])
        h, u = np.array([math.cos(yaw), math.sin(yaw), 0]), np.array([0, 0, 1.0])
        found = plain.gap(land, centre, h, u, 0.26)
        rim = centre + 0.26 * (np.sin(t)[:, None] * h - np.cos(t)[:, None] * u)
        dense = (rim[:, 2] - land.height_at(rim[:, :2])).min()
        # Within half a sample, at slopes of the ground up to 2 against the rim: 0.26 m * 2.2e-5 rad * 2.
        assert dense - 2e-5 < found.value <= dense + 1e-12


@pytest.mark.parametrize("dimensions", [PERSEVERANCE, TURNED_ROUND])
def test_a_plane_only_turns_the_answer(dimensions: dict) -> None:
    """A rover that stands level on the level stands as level on a slope, and drives as on the level."""
    chain = plain.rocker_bogie(**dimensions)
    slope = np.array([0.2, -0.1])
    x = np.arange(40.0)
    land = plain.Terrain(slope[0] * x + slope[1] * x[:, None], 1.0)
    stand = plain.settle(land, chain, (20.3, 19.6, 0.7))
    assert stand.status == "settled"
    np.testing.assert_allclose(stand.joints, 0, atol=1e-11)  # gaps are closed to 1e-12 m
    upwards = plain.attitude(stand.roll, stand.pitch, 0.7)[:, 2]
    np.testing.assert_allclose(upwards, np.array([*-slope, 1]) / math.hypot(1, *slope), atol=1e-11)
    level = plain.settle(plain.Terrain(np.zeros((40, 40)), 1.0), chain, (20, 20, 0))
    for command in ((0.3, 0.0), (0.1, 0.05), (-0.1, 0.08), (0.0, 0.1)):
        there, here = plain.inverse(chain, stand, *command), plain.inverse(chain, level, *command)
        np.testing.assert_allclose(there.wheel_speeds, here.wheel_speeds, atol=1e-10)
        np.testing.assert_allclose(there.steering, here.steering, atol=1e-9)


@pytest.mark.parametrize("dimensions", [PERSEVERANCE, TURNED_ROUND])
def test_rates_are_differences_of_settled_poses(dimensions: dict) -> None:
    """The rover is driven a little forth and back; joints, attitude and twist move as predicted."""
    chain, land = plain.rocker_bogie(**dimensions), rough()
    rng, step, seen = np.random.default_rng(2), 1e-6, 0
    while seen < 2:
        pose = np.array([*rng.uniform(5, 35, 2), rng.uniform(-3, 3)])
        steering = rng.uniform(-0.4, 0.4, 4)
        stand = plain.settle(land, chain, pose, steering)
        way = np.array([0.3 * math.cos(pose[2]), 0.3 * math.sin(pose[2]), 0.1])
        ahead, behind = (plain.settle(land, chain, pose + s * step * way, steering) for s in (1, -1))
        if {stand.status, ahead.status, behind.status} != {"settled"}:
            continue
        seen += 1
        told = plain.inverse(chain, stand, 0.3, 0.1, plan=True, steering=steering)
        rates = (numbers(ahead) - numbers(behind)) / (2 * step)
        # Differences of solutions good to 1e-12 over 2e-6, and curvature of the ground.
        np.testing.assert_allclose(told.joint_rates, rates[3:], atol=2e-6)
        now, later, before = (
            plain.attitude(at.roll, at.pitch, float(at.pose[2])) for at in (stand, ahead, behind)
        )
        turning = now.T @ (later - before) / (2 * step)
        np.testing.assert_allclose(told.twist[3:], [turning[2, 1], turning[0, 2], turning[1, 0]], atol=2e-6)
        np.testing.assert_allclose(told.twist[:3], now.T @ [way[0], way[1], rates[0]], atol=2e-6)
        # The same motion from the wheels, once tilt and joints are measured and wheels may slide sideways.
        rolled = plain.forward(
            chain,
            stand,
            told.wheel_speeds,
            angular_velocity=told.twist[3:],
            joint_rates=told.joint_rates,
            weights=np.tile([1.0, 0.0], (6, 1)),
        )
        np.testing.assert_allclose(rolled.twist, told.twist, atol=1e-9)
        np.testing.assert_allclose(rolled.residuals[:, :2], 0, atol=1e-9)


def test_level_ground_is_the_planar_model() -> None:
    """Perseverance stands level: every command is that of the rover seen from above."""
    chain = plain.rocker_bogie(**PERSEVERANCE)
    stand = plain.settle(plain.Terrain(np.zeros((40, 40)), 1.0), chain, (20, 20, 0.3))
    for speed, yaw_rate in ((0.1, 0.0), (0.1, 0.05), (0.02, -0.3), (-0.1, 0.02)):
        planar = RockerBogie.preset("perseverance").steer(speed, yaw_rate, (0, 0, 0))
        told = plain.inverse(chain, stand, speed, yaw_rate)
        np.testing.assert_allclose(told.steering, planar.steering, atol=1e-12)
        np.testing.assert_allclose(told.wheel_speeds, planar.wheel_speeds, atol=1e-12)
        resting = plain.traction(chain, speed, yaw_rate / speed, (0, 0, yaw_rate), np.zeros(3), np.zeros(3))
        np.testing.assert_allclose(resting.steering, planar.steering, atol=1e-12)
        np.testing.assert_allclose(resting.wheel_speeds, planar.wheel_speeds, atol=1e-12)


def test_a_bogie_at_its_stop_lets_a_wheel_hang() -> None:
    """A trench under the middle left wheel, deeper than the bogie turns."""
    chain = plain.rocker_bogie(**PERSEVERANCE, bogie_limit=(-0.2, 0.2))
    x = 0.1 * np.arange(100)
    land = np.where((np.abs(x - 5.0) < 0.6) & (x[:, None] > 5.6), -1.0, 0.0)
    stand = plain.settle(plain.Terrain(land, 0.1), chain, (5.0, 5.0, 0.0))
    assert (stand.status, stand.hanging, stand.stopped) == ("at_stop", (2,), (1,))
    assert stand.joints is not None
    assert stand.joints[1] == 0.2
    assert stand.gaps[2].value > 0.1


@pytest.mark.parametrize(("heights", "status"), [(np.nan, "unknown_cells"), (0.0, "off_map")])
def test_what_is_not_known_is_an_answer(heights: float, status: str) -> None:
    """A hole in the map, and its edge."""
    land = np.full((60, 60), 0.0)
    land[30:32, 30:32] = heights
    place = (3.0, 1.9, 0.0) if status == "unknown_cells" else (0.5, 3.0, 0.0)
    chain = plain.rocker_bogie(**PERSEVERANCE)
    assert plain.settle(plain.Terrain(land, 0.1), chain, place).status == status
