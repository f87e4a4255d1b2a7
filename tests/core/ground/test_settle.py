"""Rovers that settle on ground: laws, slow independent oracles, exact cases, stops, the boundary."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.reference import ground as reference
from tests.core.ground.settling import CLOSED, ground_for, poses_for

from .grounds import LEVEL, ROVERS, dense_gaps, hills, numbers_of, rocks

LAWS = 1e-9  # [m, rad] what the same ground in other coordinates may differ by: rounding over the Jacobian

rovers = st.sampled_from(list(ROVERS.values()))
level = st.sampled_from([ROVERS[name] for name in LEVEL])


# Laws


@given(rovers, st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(-7, 7))
def test_on_any_plane_the_joints_are_those_on_the_flat(rover, east, north, yaw):
    x = np.arange(-8.0, 8.1, 0.5)
    flat, steep = (sw.Terrain(k * (east * x[None] + north * x[:, None]), 0.5, (-8.0, -8.0)) for k in (0, 1))
    expected = rover.settle(flat, (0.0, 0.0, 0.0)).joints
    np.testing.assert_allclose(rover.settle(steep, (0.3, -0.2, yaw)).joints, expected, atol=LAWS)


@given(level, st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(-3, 3), st.floats(-7, 7))
def test_a_plane_only_rotates_the_answer(rover, east, north, height, yaw):
    x = np.arange(-8.0, 8.1, 0.5)
    heights = height + east * x[None] + north * x[:, None]
    stand = rover.settle(sw.Terrain(heights, 0.5, (-8.0, -8.0)), (0.3, -0.2, yaw))
    assert stand.status is sw.SettleStatus.settled
    np.testing.assert_allclose(stand.joints, 0, atol=LAWS)
    normal = np.array([-east, -north, 1]) / math.hypot(east, north, 1)
    np.testing.assert_allclose(stand.transform[:3, 2], normal, atol=LAWS)
    np.testing.assert_allclose(stand.normals, [normal] * 6, atol=1e-12)
    # Every wheel touches where its radius is square to the plane.
    spokes = stand.contacts - stand.wheel_centres
    radius = rover.dimensions["wheel_radius"]
    # flat: the angle is as the root of it
    np.testing.assert_allclose(spokes, [-radius * normal] * 6, atol=1e-7)


@pytest.mark.slow
@given(rovers, st.integers(0, 2**32 - 1))
@example(ROVERS["open_source_rover"], 198083)
def test_the_mirrored_ground_mirrors_the_answer(rover, seed):
    ground, heights, spacing = ground_for(rover)
    width = spacing * (len(heights) - 1)
    mirrored = sw.Terrain(heights[::-1], spacing, (0.0, -width))
    pose = poses_for(rover, 1, seed)[0]
    stand, twin = rover.settle(ground, pose), rover.settle(mirrored, pose * [1, -1, -1])
    assert stand.stands
    assert twin.stands
    z, roll, pitch, rho, left, right = numbers_of(stand)
    np.testing.assert_allclose(numbers_of(twin), [z, -roll, pitch, -rho, right, left], atol=LAWS)
    np.testing.assert_allclose(twin.contacts[[1, 0, 3, 2, 5, 4]] * [1, -1, 1], stand.contacts, atol=1e-7)


@pytest.mark.slow
@given(rovers, st.floats(-4, 4), st.tuples(st.floats(-50, 50), st.floats(-50, 50)), st.integers(0, 2**32 - 1))
def test_a_map_may_lie_anywhere(rover, angle, origin, seed):
    ground, heights, spacing = ground_for(rover)
    there = sw.Terrain(heights, spacing, origin, angle)
    x, y, yaw = poses_for(rover, 1, seed)[0]
    cos, sin = math.cos(angle), math.sin(angle)
    moved = (origin[0] + cos * x - sin * y, origin[1] + sin * x + cos * y, yaw + angle)
    here, away = rover.settle(ground, (x, y, yaw)), rover.settle(there, moved)
    np.testing.assert_allclose(numbers_of(away), numbers_of(here), atol=LAWS)


@pytest.mark.slow
@given(rovers, st.floats(-3000, 3000))
def test_height_is_only_added(rover, height):
    ground, heights, spacing = ground_for(rover)
    pose = poses_for(rover, 1, 3)[0]
    low, high = rover.settle(ground, pose), rover.settle(sw.Terrain(heights + height, spacing), pose)
    difference = numbers_of(high) - numbers_of(low)
    # Heights of kilometres have 5e-13 m for their last digit.
    np.testing.assert_allclose(difference, [height, 0, 0, 0, 0, 0], atol=1e-8)


def test_a_batch_is_its_rows_whatever_the_threads():
    rover = ROVERS["perseverance"]
    ground, *_ = ground_for(rover)
    poses = poses_for(rover, 300).reshape(3, 100, 3)
    steering = np.random.default_rng(0).uniform(-0.5, 0.5, (3, 100, 4))
    stand = rover.settle(ground, poses, steering)
    again = rover.settle(ground, poses, steering, threads=3)
    for name in ("z", "roll", "pitch", "joints", "gap", "contacts", "normals", "transform", "status"):
        np.testing.assert_array_equal(getattr(stand, name), getattr(again, name))
    for k in [(0, 0), (1, 7), (2, 99)]:
        one = rover.settle(ground, poses[k], steering[k])
        np.testing.assert_allclose(numbers_of(one), numbers_of(stand)[k], rtol=0, atol=1e-10)
        assert one.status is stand.status[k]
        np.testing.assert_allclose(one.transform, stand.transform[k], rtol=0, atol=1e-10)
    for count in (65, 67):  # the part of the second thread is shorter than what is worth lanes
        few = poses.reshape(-1, 3)[:count]
        one, two = (numbers_of(rover.settle(ground, few, threads=threads)) for threads in (1, 2))
        np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize("make", [hills, rocks])
def test_every_kernel_finds_the_same(make):
    for rover in ROVERS.values():
        ground, *_ = ground_for(rover, make)
        poses = poses_for(rover, 300, seed=6)
        plain = rover.settle(ground, poses, level="scalar")
        for kernel in sw.simd_levels()[1:]:
            stand = rover.settle(ground, poses, level=kernel)
            assert (stand.status == plain.status).all()
            # Gaps close to 2e-12 m; a nearly singular stand multiplies that.
            np.testing.assert_allclose(numbers_of(stand), numbers_of(plain), rtol=0, atol=1e-8)
            np.testing.assert_allclose(stand.contacts, plain.contacts, rtol=0, atol=1e-6)


# Slow oracles


@pytest.mark.parametrize("name", ROVERS)
@pytest.mark.parametrize("make", [hills, rocks])
def test_every_gap_is_closed_along_the_whole_rim(name, make):
    rover = ROVERS[name]
    ground, heights, spacing = ground_for(rover, make)
    poses = poses_for(rover, 400)
    steering = np.random.default_rng(1).uniform(-0.8, 0.8, (400, len(rover.joint_names) - 3))
    stand = rover.settle(ground, poses, steering)
    assert (stand.status == "settled").all()
    assert np.abs(stand.gap).max() < 1e-10
    numbers = numbers_of(stand)
    for k in range(0, 400, 20):
        gaps = dense_gaps(rover, heights, spacing, poses[k], numbers[k], steering[k])
        assert np.abs(gaps).max() < CLOSED


@pytest.mark.parametrize("name", ROVERS)
def test_the_plain_solver_finds_the_same(name):
    rover = ROVERS[name]
    ground, heights, spacing = ground_for(rover)
    arguments = {k: v for k, v in rover.dimensions.items() if v is not None and k != "steering_limit"}
    chain = reference.rocker_bogie(**arguments)
    poses = poses_for(rover, 6, seed=4)
    stand = rover.settle(ground, poses)
    for k, pose in enumerate(poses):
        plain = reference.settle(reference.Terrain(heights, spacing), chain, pose)
        expected = [plain.z, plain.roll, plain.pitch, *plain.joints]
        np.testing.assert_allclose(numbers_of(stand)[k], expected, rtol=0, atol=1e-9)


def test_contacts_lie_on_the_ground_and_normals_are_square_to_the_rim():
    rover = ROVERS["perseverance"]
    ground, *_ = ground_for(rover)
    stand = rover.settle(ground, poses_for(rover, 500))
    np.testing.assert_allclose(ground.height_at(stand.contacts[..., :2]), stand.contacts[..., 2], atol=1e-10)
    np.testing.assert_allclose(np.linalg.norm(stand.normals, axis=-1), 1, atol=1e-15)
    spokes = stand.contacts - stand.wheel_centres
    np.testing.assert_allclose(np.linalg.norm(spokes, axis=-1), rover.dimensions["wheel_radius"], rtol=1e-12)
    axle = stand.transform[..., None, :3, 1]  # rockers and bogies turn about it
    tangent = np.cross(axle, spokes)
    # On creases too: their mix of gradients is made so.
    np.testing.assert_allclose(np.sum(tangent * stand.normals, -1), 0, atol=1e-6)
    steered = rover.settle(ground, poses_for(rover, 20), (0.3, -0.2, 0.1, 0.4))
    assert np.abs(steered.joints - rover.settle(ground, poses_for(rover, 20)).joints).max() > 1e-3


# Derivatives


def test_derivatives_are_differences():
    rover = ROVERS["perseverance"]
    ground, *_ = ground_for(rover, hills)
    poses = poses_for(rover, 60)
    stand, step = rover.settle(ground, poses, derivatives=True), 1e-6
    assert stand.by_pose.shape == (60, 6, 3)
    for k in range(3):
        shift = step * np.eye(3)[k]
        ahead, behind = (numbers_of(rover.settle(ground, poses + s * shift)) for s in (1, -1))
        error = np.abs((ahead - behind) / (2 * step) - stand.by_pose[..., k]).max(-1)
        # Where a contact moves over a crease within the step the derivative jumps.
        assert np.median(error) < 1e-7
        assert np.mean(error < 1e-6) > 0.9
    assert rover.settle(ground, poses).by_pose is None


def test_derivatives_by_dimensions_are_differences():
    for name in ("perseverance", "open_source_rover"):
        rover = ROVERS[name]
        ground, *_ = ground_for(rover, hills)
        poses, step = poses_for(rover, 20), 1e-6
        by_dimension = rover.settle(ground, poses, derivatives=True).by_dimension
        of = rover.dimensions
        column = 0
        for argument, value in list(of.items())[:6]:
            vector = np.atleast_1d(value)
            for k in range(len(vector)):
                sides = []
                for sign in (1, -1):
                    changed = vector.copy()
                    changed[k] += sign * step
                    changed = float(changed[0]) if argument == "wheel_radius" else tuple(changed)
                    other = sw.RockerBogie(**of | {argument: changed})
                    sides.append(numbers_of(other.settle(ground, poses)))
                error = np.abs((sides[0] - sides[1]) / (2 * step) - by_dimension[..., column]).max(-1)
                assert np.median(error) < 1e-7
                column += 1
        assert column == by_dimension.shape[-1]
