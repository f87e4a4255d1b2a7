"""Coordinates of any size: every call on ground, moved with its map, tells the same."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel.maps import traverse
from tests.strategies import at_most

SUSPENSION = sw.RockerBogie.preset("perseverance")
SPACING = 0.25
HEIGHTS = np.add.outer(
    0.3 * np.sin(0.25 * np.arange(120.0)), 0.05 * np.arange(160.0) + 0.2 * np.cos(0.3 * np.arange(160.0))
)
# Whole numbers, and places in steps of 2^-20 m: a sum of both has no rounding, so that nothing may differ.
WHOLE = st.integers(-(10**8), 10**8)
OFFSETS = st.tuples(WHOLE, WHOLE)
FARTHEST = (10**8, -(10**8))
# Half a unit in the last place of 1e8 [m], in x, in y and in what is written.
LAST_DIGIT = 3 * np.spacing(1e8)


def moved(offset: Any, yaw: float = 0.0) -> sw.Terrain:
    return sw.Terrain(HEIGHTS, SPACING, offset, yaw)


def poses(count: int, seed: int = 0) -> np.ndarray:
    random = np.random.default_rng(seed)
    xy = np.round(random.uniform((6, 6), (34, 24), (count, 2)) * 2**20) / 2**20
    return np.concatenate((xy, random.uniform(-3, 3, (count, 1))), axis=1)


def shifted(places: np.ndarray, offset: Any) -> np.ndarray:
    return places + np.array([*offset, 0.0])


def same(here: Any, there: Any) -> None:
    """Fails unless both are the same to the bit."""
    np.testing.assert_array_equal(np.asarray(here), np.asarray(there))


STANDS = (
    "z",
    "roll",
    "pitch",
    "joints",
    "gap",
    "contact_angles",
    "normals",
    "stops",
    "by_pose",
    "by_dimension",
)
BOUNDS = ("z", "roll", "pitch", "tilt", "rocker", "bogies", "clearance", "wheel_drop")


@at_most(20)
@given(OFFSETS)
@example(FARTHEST)
@pytest.mark.parametrize("count", [3, 40])  # one by one, and in lanes
def test_settled_poses_are_the_same(count: int, offset: Any) -> None:
    places = poses(count)
    here = SUSPENSION.settle(moved((0, 0)), places, derivatives=True)
    there = SUSPENSION.settle(moved(offset), shifted(places, offset), derivatives=True)
    assert np.asarray(here.stands).all()
    for name in STANDS:
        same(getattr(here, name), getattr(there, name))
    for name in ("contacts", "wheel_centres"):
        back = getattr(there, name) - np.array([*offset, 0.0])
        np.testing.assert_allclose(back, getattr(here, name), rtol=0, atol=LAST_DIGIT)
    near, far = (
        SUSPENSION.stability(stand, mass=1000.0, belly=(-1.0, 1.0, 0.8, 0.4)) for stand in (here, there)
    )
    for name in ("loads", "tip_over_angle", "clearance", "joint_margins", "tilt"):
        same(getattr(near, name), getattr(far, name))
    for name in ("tilt", "joint_margins", "tip_over_angle", "clearance"):
        same(getattr(near.by_pose, name), getattr(far.by_pose, name))


@at_most(10)
@given(OFFSETS)
@example(FARTHEST)
def test_a_pose_alone_is_that_of_a_batch(offset: Any) -> None:
    ground, places = moved(offset, 0.7), shifted(poses(12, seed=4) - np.array([10.0, 10.0, 0.0]), offset)
    batch = SUSPENSION.settle(ground, places)
    for row, place in enumerate(places):
        alone = SUSPENSION.settle(ground, place)
        for name in ("z", "roll", "pitch", "joints", "gap", "contact_angles", "contacts"):
            same(getattr(alone, name), getattr(batch, name)[row])


@at_most(20)
@given(OFFSETS)
@example(FARTHEST)
def test_bounds_and_feasibility_are_the_same(offset: Any) -> None:
    places = poses(30, seed=1)
    here, there = (
        SUSPENSION.bounds(moved(by), shifted(places, by), yaw_margin=0.02, position_margin=0.05)
        for by in ((0, 0), offset)
    )
    for name in BOUNDS:
        same(getattr(here, name), getattr(there, name))
    here, there = (SUSPENSION.feasible(moved(by), shifted(places, by)) for by in ((0, 0), offset))
    for name in ("reason_codes", "margin", "tilt", "clearance"):
        same(getattr(here, name), getattr(there, name))


@at_most(20)
@given(OFFSETS)
@example(FARTHEST)
def test_motion_and_slip_are_the_same(offset: Any) -> None:
    places = poses(20, seed=2)
    here, there = (SUSPENSION.settle(moved(by), shifted(places, by)) for by in ((0, 0), offset))
    steering, wheel_speeds = SUSPENSION.inverse(here, (0.1, 0.03))
    far = SUSPENSION.inverse(there, (0.1, 0.03))
    same(steering, far.steering)
    same(wheel_speeds, far.wheel_speeds)
    near, far = (SUSPENSION.forward(stand, steering, wheel_speeds) for stand in (here, there))
    same(near.twist, far.twist)
    same(near.joint_rates, far.joint_rates)
    told = [SUSPENSION.slip(stand, wheel_speeds, near.twist, near.joint_rates) for stand in (here, there)]
    same(told[0].ratio, told[1].ratio)
    same(told[0].angle, told[1].angle)


@at_most(20)
@given(OFFSETS, st.floats(-3, 3))
@example(FARTHEST, 0.7)
def test_heights_are_the_same(offset: Any, yaw: float) -> None:
    places = poses(50, seed=3)[:, :2] - 20.0
    here, there = (moved(by, yaw) for by in ((0, 0), offset))
    for name in ("height_at", "gradient_at", "normal_at", "contains"):
        same(getattr(here, name)(places), getattr(there, name)(places + np.array(offset)))


COMMANDS = [(0, 0.5, 0, 0.05), (12, 0.5, 0, -0.08), (20, 0.5, 0, 0)]
START = (8.0, 9.0, 0.3)


def driven(ground: sw.Terrain, start: Any) -> Any:
    return sw.simulate(SUSPENSION, COMMANDS, ground=ground, start=start, rate=10.0)


@at_most(4)
@given(OFFSETS)
@example(FARTHEST)
@example((0, 4_600_000))
def test_drives_have_the_same_track_and_health(offset: Any) -> None:
    grounds = [moved((0, 0)), moved(offset)]
    starts = [START, tuple(shifted(np.array(START), offset))]
    logs = [driven(ground, start) for ground, start in zip(grounds, starts, strict=True)]
    back = logs[1].truth.poses - logs[0].truth.poses
    assert np.abs(back - np.array([*offset, 0.0])).max() < 1e-6
    # Wheels roll as the ground under them rises, where places have rounded by less than 1e-6 of a cell.
    np.testing.assert_allclose(logs[1].wheel_angles, logs[0].wheel_angles, rtol=0, atol=1e-5)
    log = logs[0]
    tracks = [
        sw.dead_reckon(SUSPENSION, log, ground=ground, start=start)
        for ground, start in zip(grounds, starts, strict=True)
    ]
    same(tracks[0].health, tracks[1].health)
    assert not (
        np.asarray(tracks[0].health) & int(sw.OdometryHealth.OFF_GROUND | sw.OdometryHealth.UNSETTLED)
    ).any()
    back = tracks[1].positions - np.array([*offset, 0.0])
    np.testing.assert_allclose(back, tracks[0].positions, rtol=0, atol=1e-6)


@pytest.mark.parametrize("offset", [FARTHEST, (500_000, 5_427_000)])
@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_odometry_keeps_its_track(offset: Any, yaw: float) -> None:
    grounds = [moved(by, yaw) for by in ((0, 0), offset)]
    cos, sin = math.cos(yaw), math.sin(yaw)
    start = (cos * 8 - sin * 9, sin * 8 + cos * 9, 0.3 + yaw)
    log = driven(grounds[0], start)
    ends = []
    for ground, by in zip(grounds, ((0, 0), offset), strict=True):
        odometry = sw.Odometry3(SUSPENSION, ground=ground)
        odometry.reset((start[0] + by[0], start[1] + by[1], 0.0, 0.0, 0.0, start[2]))
        for k in range(len(log)):
            state = odometry.update(log.steering[k], log.wheel_angles[k], log.stamps[k])
            assert not int(state.health) & int(sw.OdometryHealth.OFF_GROUND | sw.OdometryHealth.UNSETTLED)
        ends.append(np.asarray(state.position) - np.array([*by, 0.0]))
    np.testing.assert_allclose(ends[1], ends[0], rtol=0, atol=1e-6)


def test_traversability_is_the_same(tmp_path: Path) -> None:
    rasterio = pytest.importorskip("rasterio", reason="needs rasterio")
    from affine import Affine

    run: Callable[[Any], Any] = lambda by: traverse(  # noqa: E731
        write(tmp_path / f"{by[0]}.tif", by), SUSPENSION, tmp_path / f"{by[0]}_out.tif", headings=2, workers=1
    )

    def write(path: Path, by: Any) -> Path:
        place = Affine(SPACING, 0, by[0], 0, -SPACING, by[1])
        heights = HEIGHTS[:40, :48]
        profile = {"driver": "GTiff", "count": 1, "dtype": "float64", "transform": place, "crs": "EPSG:32633"}
        with rasterio.open(path, "w", height=40, width=48, **profile) as target:
            target.write(heights, 1)
        return path

    here, there = run((0, 0)), run(FARTHEST)
    assert here.safe > 0
    for near, far in zip(here.picture, there.picture, strict=True):
        same(near, far)
