"""Laws of rows on the ground: no row depends on another or on what was asked before.

Rows without an answer go through every call.
"""

import contextlib
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import six_wheel as sw

from .grounds import ROVERS, holes, random_poses, rocks, scaled

COMMAND = (0.1, 0.2)


def ground_for(rover, make):
    scale = scaled(rover)
    return sw.Terrain(make(20.0, 0.1) * scale, 0.1 * scale), scale


def poses_for(count, scale, seed=3):
    # Some of them leave the map.
    return random_poses(count, 20.0, 0.4, seed) * [scale, scale, 1]


def bits(pose):
    """Every number of settled poses, and their status; the leading axes are one."""
    names = ("z", "roll", "pitch", "joints", "gap", "contact_angles", "next_contact_angles", "normals")
    count = np.size(pose.z)
    numbers = [np.asarray(getattr(pose, name)).reshape(count, -1) for name in names]
    status = np.atleast_1d([str(status) for status in np.atleast_1d(pose.status)])
    return np.concatenate(numbers, axis=1).view(np.uint64), status


def assert_same_bits(left, right):
    for one, other in zip(left, right, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", ROVERS)
@pytest.mark.parametrize("make", [rocks, holes])
def test_a_pose_settles_alone_as_in_any_batch(name, make):
    rover = ROVERS[name]
    ground, scale = ground_for(rover, make)
    poses = poses_for(60, scale)
    together = bits(rover.settle(ground, poses))
    alone = [bits(rover.settle(ground, pose)) for pose in poses]
    assert_same_bits(together, [np.concatenate(parts) for parts in zip(*alone, strict=True)])
    order = np.random.default_rng(1).permutation(len(poses))
    assert_same_bits([part[order] for part in together], bits(rover.settle(ground, poses[order])))
    for level in sw.simd_levels():
        assert_same_bits(together, bits(rover.settle(ground, poses, level=level)))


def test_nothing_depends_on_what_was_asked_of_the_map_before():
    rover = ROVERS["perseverance"]
    poses = poses_for(40, 1.0)
    fresh, asked = (ground_for(rover, rocks)[0] for _ in range(2))
    rover.bounds(asked, poses)
    rover.settle(asked, np.repeat(poses, 50, axis=0))  # so many that extremes of windows are made
    for part in (slice(0, 1), slice(0, 5), slice(5, 40)):
        assert_same_bits(bits(rover.settle(fresh, poses[part])), bits(rover.settle(asked, poses[part])))


def test_threads_settle_the_same():
    rover = ROVERS["perseverance"]
    ground, _ = ground_for(rover, holes)
    poses = poses_for(200, 1.0)
    expected = bits(rover.settle(ground, poses, threads=1))
    with ThreadPoolExecutor(8) as pool:
        for found in pool.map(lambda k: bits(rover.settle(ground, poses, threads=1 + k)), range(8)):
            assert_same_bits(expected, found)


def same(left, right):
    np.testing.assert_array_equal(np.asarray(left).view(np.uint64), np.asarray(right).view(np.uint64))


def test_rows_without_an_answer_go_through_every_call():
    rover = ROVERS["perseverance"]
    heights = rocks(20.0, 0.1)
    heights[60:64, 60:64] = np.nan
    ground = sw.Terrain(heights, 0.1)
    poses = np.array([(9.0, 9.0, 0.3), (0.1, 5.0, 0.0), (6.2, 6.4, 0.3), (12.0, 8.0, 1.0)])
    for rows in (poses, np.repeat(poses, 5, axis=0)):
        pose = rover.settle(ground, rows)
        stands = pose.stands
        assert stands.any()
        assert not stands.all()
        only = rover.settle(ground, rows[stands])
        command, expected = rover.inverse(pose, COMMAND), rover.inverse(only, COMMAND)
        for name in ("steering", "wheel_speeds", "twist", "joint_rates", "scale"):
            assert np.isnan(getattr(command, name)[~stands]).all()
            same(getattr(command, name)[stands], getattr(expected, name))
        again, alone = (
            rover.settle(ground, rows, command.steering),
            rover.settle(ground, rows[stands], expected.steering),
        )
        assert_same_bits([part[stands] for part in bits(again)], bits(alone))
        np.testing.assert_array_equal(again.stands, stands)
        assert np.isnan(again.z[~stands]).all()
        kept = rover.inverse(again, COMMAND, steering=command.steering)
        same(
            kept.wheel_speeds[stands], rover.inverse(alone, COMMAND, steering=expected.steering).wheel_speeds
        )
        assert np.isnan(kept.wheel_speeds[~stands]).all()
        motion = rover.forward(again, command.steering, command.wheel_speeds)
        same(motion.twist[stands], rover.forward(alone, expected.steering, expected.wheel_speeds).twist)
        assert np.isnan(motion.twist[~stands]).all()
        slip = rover.slip(again, command.wheel_speeds, command.twist, command.joint_rates)
        same(
            slip.ratio[stands],
            rover.slip(alone, expected.wheel_speeds, expected.twist, expected.joint_rates).ratio,
        )
        assert np.isnan(slip.ratio[~stands]).all()


def test_a_single_pose_without_an_answer_goes_through():
    rover = ROVERS["perseverance"]
    ground, _ = ground_for(rover, rocks)
    pose = rover.settle(ground, (0.1, 5.0, 0.0))
    command = rover.inverse(pose, COMMAND)
    assert not pose.stands
    assert np.isnan(command.steering).all()
    assert not rover.settle(ground, (0.1, 5.0, 0.0), command.steering).stands
    assert np.isnan(rover.forward(pose, command.steering, command.wheel_speeds).twist).all()


def test_other_rows_of_nan_are_errors():
    rover = ROVERS["perseverance"]
    ground, _ = ground_for(rover, rocks)
    poses = [(9.0, 9.0, 0.3), (12.0, 8.0, 1.0)]
    pose = rover.settle(ground, poses)
    assert pose.stands.all()
    command = rover.inverse(pose, COMMAND)
    nan = np.full_like(command.steering, np.nan)
    with pytest.raises(ValueError, match=r"steering.* must be finite"):
        rover.settle(ground, poses, nan[0])
    with pytest.raises(ValueError, match=r"steering\[0\] must be finite"):
        rover.settle(ground, poses, [[np.nan, 0, 0, 0], [0, 0, 0, 0]])
    with pytest.raises(ValueError, match=r"steering\[0\] must be finite"):
        rover.inverse(pose, COMMAND, steering=nan)
    with pytest.raises(ValueError, match=r"twist\[0\] must be finite"):
        rover.slip(pose, command.wheel_speeds, np.full((2, 6), np.nan), command.joint_rates)


@pytest.mark.parametrize("size", [1e3, 1e9, 9.99e14])
@pytest.mark.parametrize("kind", ["random", "flat", "step"])
def test_every_height_is_answered(size, kind):
    rng = np.random.default_rng(1)
    made = {
        "random": lambda: rng.uniform(-1, 1, (60, 60)),
        "flat": lambda: np.ones((60, 60)),
        "step": lambda: np.where(np.arange(60) < 30, 0.0, 1.0) * np.ones((60, 1)),
    }
    # The upper half of a step of such sizes looks like a mark of unknown heights.
    ground = sw.Terrain(made[kind]() * size, 0.1, nodata=np.nan if kind == "step" else None)
    rover = ROVERS["perseverance"]
    pose = rover.settle(ground, [(3.0, 3.0, 0.3), (3.1, 2.9, 1.0)])
    rover.bounds(ground, [(3.0, 3.0, 0.3)])
    rover.feasible(ground, [(3.0, 3.0, 0.3)])
    command = rover.inverse(pose, COMMAND)
    # Ground as steep as 1e10 leaves a pose that stands no motion: NaN, which `forward` then refuses by name.
    with (
        contextlib.nullcontext()
        if np.isfinite(command.scale[pose.stands]).all()
        else pytest.raises(ValueError, match="steering")
    ):
        rover.forward(pose, command.steering, command.wheel_speeds)
    assert np.isfinite(pose.z[pose.stands]).all()
    assert pose.stands.all() or kind != "flat"


@pytest.mark.parametrize("height", [1e15, -1e15, 1e154, 1.7e308])
def test_heights_without_digits_are_refused(height):
    heights = np.zeros((4, 5))
    heights[2, 3] = height
    with pytest.raises(ValueError, match=r"heights\[2, 3\] must be below 1e15 m, or nan where unknown, got"):
        sw.Terrain(heights, 0.1, nodata=np.nan)
    with pytest.raises(ValueError, match=r"heights\[2, 3\] must be"):
        sw.Terrain(np.where(heights == 0, 0, 3e38).astype(np.float32), 0.1, nodata=np.nan)


def test_at_a_stop_no_more_wheels_hang_than_have_to():
    """A wheel over a hole that is deeper than its bogie reaches: it hangs, and no other one on its bogie."""
    dimensions = dict(ROVERS["perseverance"].dimensions) | {
        "bogie_limit": (-0.3, 0.3),
        "rocker_limit": (-0.3, 0.3),
    }
    rover = sw.RockerBogie(**dimensions)
    flat = sw.Terrain(np.zeros((120, 120)), 0.1)
    centres = rover.settle(flat, (6.0, 6.0, 0.0)).wheel_centres
    for wheel in range(6):
        heights = np.zeros((120, 120))
        x, y = np.round(centres[wheel, :2] / 0.1).astype(int)
        heights[y - 4 : y + 5, x - 5 : x + 6] = -3.0
        pose = rover.settle(sw.Terrain(heights, 0.1), (6.0, 6.0, 0.0))
        assert pose.status == "at_stop"
        hanging = pose.gap > 1e-6
        # Beyond a front wheel the rocker and the bogie behind it are both at their stops.
        assert hanging.sum() == (2 if wheel < 2 else 1), wheel
        assert np.hypot(pose.roll, pose.pitch) < 0.35
