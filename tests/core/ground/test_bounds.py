"""Bounds of how a rover stands hold what settles, are the same everywhere, and say when they know nothing."""

import math
import os
from typing import Any

import numpy as np
import pytest

import six_wheel as sw

SOAK = int(os.environ.get("SOAK", "1"))
IN_FRONT = {
    "rocker_pivot": (0.1, 0.6, 0.6),
    "rocker_to_rear": (-0.8, 0.2, -0.35),
    "rocker_to_bogie": (0.5, 0.05, -0.15),
    "bogie_to_front": (0.45, 0.15, -0.2),
    "bogie_to_middle": (-0.4, 0.25, -0.2),
    "wheel_radius": 0.2,
}
QUANTITIES = ("z", "roll", "pitch", "tilt", "clearance", "rocker", "bogies", "wheel_drop")


def rovers() -> dict[str, sw.RockerBogie]:
    return {
        "perseverance": sw.RockerBogie.preset("perseverance"),
        "curiosity": sw.RockerBogie.preset("curiosity"),
        "in front": sw.RockerBogie(**IN_FRONT),
        "bar": sw.RockerBogie(**IN_FRONT, differential_bar=(0.5, 0.3, 0.4)),
    }


def some(ground: sw.Terrain, count: int, seed: int, margin: float = 3.3) -> Any:
    random = np.random.default_rng(seed)
    size = ground.spacing[0] * (ground.shape[0] - 1)
    return np.column_stack(
        [random.uniform(margin, size - margin, (count, 2)), random.uniform(-math.pi, math.pi, count)]
    )


def outside(rover: sw.RockerBogie, ground: sw.Terrain, poses: Any, **options: Any) -> tuple[int, int, Any]:
    """Settled poses outside their bounds, and those inside; the bounds."""
    bound, stand = rover.bounds(ground, poses, **options), rover.settle(ground, poses)
    known = (bound.status == "bounded") & (stand.status == "settled")
    stability = rover.stability(stand, mass=1.0)
    values = {
        "z": stand.z,
        "roll": stand.roll,
        "pitch": stand.pitch,
        "tilt": stability.tilt,
        "clearance": stability.clearance,
        "rocker": stand.joints[:, 0],
        "bogies": stand.joints[:, 1:],
        "wheel_drop": drop(rover, stand),
    }
    bad = np.zeros(len(poses), bool)
    for name, value in values.items():
        interval = getattr(bound, name)
        wrong = (value < interval[..., 0]) | (value > interval[..., 1])
        bad |= wrong.reshape(len(poses), -1).any(axis=1)
    return int((bad & known).sum()), int(known.sum()), bound


def drop(rover: sw.RockerBogie, stand: sw.SettledPose) -> Any:
    """Drop of the wheel that has come down most below its place, from the frames of the chain.

    Of poses at which the rover does not stand, which have no joints, as with level joints.
    """
    joints = np.nan_to_num(stand.joints)
    frames = rover.frames(joints)
    level = rover.frames((0.0, 0.0, 0.0))
    return np.max([level[f"A{k}"][2, 3] - frames[f"A{k}"][:, 2, 3] for k in range(1, 7)], axis=0)


@pytest.mark.parametrize("name", ["perseverance", "curiosity", "in front"])
@pytest.mark.parametrize("cover", [0.05, 0.1, 0.15, 0.2])
def test_no_settled_pose_is_outside(name: str, cover: float) -> None:
    rover = rovers()[name]
    inside = 0
    for seed in range(SOAK):
        ground = sw.Terrain.yard(30, 0.1, cover, seed=seed + 17)
        wrong, known, _ = outside(rover, ground, some(ground, 1500, seed))
        assert wrong == 0
        inside += known
    assert inside > 300 * SOAK


def test_a_bar_between_the_rockers_is_allowed_for() -> None:
    ground = sw.Terrain.yard(30, 0.1, 0.05, seed=3)
    bar = rovers()["bar"]
    bound, stand = bar.bounds(ground, some(ground, 800, 1)), bar.settle(ground, some(ground, 800, 1))
    known = (bound.status == "bounded") & (stand.status == "settled")
    assert known.sum() > 200
    for value, interval in ((stand.roll, bound.roll), (stand.pitch, bound.pitch)):
        assert np.all((interval[known, 0] <= value[known]) & (value[known] <= interval[known, 1]))
    rho = stand.joints[known, 0]
    assert np.all((bound.rocker[known, 0] <= rho) & (rho <= bound.rocker[known, 1]))


def test_on_level_ground_they_are_what_settles() -> None:
    level = sw.Terrain(np.full((90, 90), 2.5), 0.1)
    bound = sw.RockerBogie.preset("perseverance").bounds(level, (4.5, 4.5, 0.7))
    assert bound.status == "bounded"
    # The wheels' radius plus the height of their centres differ by 2e-5 m in these dimensions.
    for name in ("roll", "pitch", "rocker", "bogies"):
        assert np.abs(getattr(bound, name)).max() < 1e-4
    np.testing.assert_allclose(bound.z, 2.5, atol=1e-4)
    np.testing.assert_allclose(bound.clearance, 0.5972, atol=1e-4)
    assert bound.tilt[0] == 0  # no less: a tilt has no sign


def test_no_tilt_is_negative() -> None:
    ground = sw.Terrain.yard(30, 0.1, 0.05, seed=9, roughness=0.01)
    for rover in rovers().values():
        lowest = rover.bounds(ground, some(ground, 2000, 9)).tilt[:, 0]
        assert np.nanmin(lowest) == 0 < np.nanmax(lowest)


@pytest.mark.parametrize("slope", [(0.15, 0.0), (0.0, 0.15), (-0.1, 0.1)])
def test_on_a_plane_they_hold_the_plane(slope: tuple[float, float]) -> None:
    x = 0.1 * np.arange(120)
    ground = sw.Terrain(slope[0] * x + slope[1] * x[:, None], 0.1)
    for rover in rovers().values():
        yaws = np.linspace(-3, 3, 13)
        poses = np.column_stack([np.full((13, 2), 6.0), yaws])
        bound, stand = rover.bounds(ground, poses), rover.settle(ground, poses)
        known = bound.status == "bounded"
        assert known.any()
        for value, interval in ((stand.roll, bound.roll), (stand.pitch, bound.pitch)):
            assert np.all((interval[known, 0] <= value[known]) & (value[known] <= interval[known, 1]))


def test_every_kernel_and_number_of_threads_gives_the_same_to_the_bit() -> None:
    ground = sw.Terrain.yard(30, 0.1, 0.15, seed=5)
    rover, poses = sw.RockerBogie.preset("perseverance"), some(ground, 1003, 5)
    plain = rover.bounds(ground, poses, level="scalar")
    for options in [*({"level": kernel} for kernel in sw.simd_levels()), {"threads": 3}]:
        other = rover.bounds(ground, poses, **options)
        assert np.array_equal(plain.status, other.status)
        for name in QUANTITIES:
            assert getattr(plain, name).tobytes() == getattr(other, name).tobytes()
    alone = rover.bounds(ground, poses[7])
    assert alone.status == plain.status[7]
    np.testing.assert_array_equal(alone.pitch, plain.pitch[7])


def test_margins_hold_every_pose_within_them() -> None:
    ground = sw.Terrain.yard(30, 0.1, 0.05, seed=6, roughness=0.05)
    rover, random = sw.RockerBogie.preset("perseverance"), np.random.default_rng(6)
    poses = some(ground, 300, 6, margin=4.0)
    wide = rover.bounds(ground, poses, 0.2, position_margin=0.15)
    known = wide.status == "bounded"
    assert known.sum() > 50
    for _ in range(5):
        turn, way = random.uniform(-0.2, 0.2, 300), random.uniform(-math.pi, math.pi, 300)
        far = random.uniform(0, 0.15, 300)
        moved = poses + np.column_stack([far * np.cos(way), far * np.sin(way), turn])
        stand = rover.settle(ground, moved)
        both = known & (stand.status == "settled")
        for value, interval in ((stand.roll, wide.roll), (stand.pitch, wide.pitch), (stand.z, wide.z)):
            assert np.all((interval[both, 0] <= value[both]) & (value[both] <= interval[both, 1]))


def test_an_error_of_the_map_is_allowed_for() -> None:
    ground = sw.Terrain.yard(30, 0.1, 0.05, seed=8, roughness=0.05)
    noise = np.random.default_rng(8).uniform(-0.02, 0.02, ground.shape)
    true = sw.Terrain(ground.heights + noise, 0.1)
    rover, poses = sw.RockerBogie.preset("perseverance"), some(ground, 400, 8)
    bound, stand = rover.bounds(ground, poses, map_error=0.02), rover.settle(true, poses)
    known = (bound.status == "bounded") & (stand.status == "settled")
    assert known.sum() > 100
    for value, interval in ((stand.roll, bound.roll), (stand.z, bound.z)):
        assert np.all((interval[known, 0] <= value[known]) & (value[known] <= interval[known, 1]))


def test_what_is_not_known_is_said() -> None:
    heights = np.zeros((120, 120))
    heights[60, 60] = np.nan
    ground = sw.Terrain(heights, 0.1)
    rover = sw.RockerBogie.preset("perseverance")
    bound = rover.bounds(ground, [(6, 6, 0), (0.5, 6, 0), (1e140, 0, 0), (3.5, 3.5, 1e9), (9, 3.5, -1e18)])
    assert list(bound.status) == ["unknown_cells", "off_map", "off_map", "bounded", "bounded"]
    assert np.isnan(bound.roll[:3]).all()
    assert not np.isnan(bound.roll[3:]).any()
    wall = np.zeros((120, 120))
    wall[:, 60:] = 3.0
    assert rover.bounds(sw.Terrain(wall, 0.1), (6, 6, 0.3)).status in ("unsolved", "beyond")
    stops = sw.RockerBogie(**IN_FRONT, rocker_limit=1e-3, bogie_limit=1e-3)
    rough = sw.Terrain.yard(20, 0.1, 0.05, seed=1)
    assert "at_stop" in stops.bounds(rough, some(rough, 200, 1)).status
    assert rover.bounds(ground, np.zeros((0, 3))).roll.shape == (0, 2)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"yaw_margin": -1.0}, "yaw_margin must be finite and not negative, got -1.0"),
        ({"position_margin": [math.nan]}, "position_margin must be finite and not negative, got NaN"),
        ({"map_error": math.inf}, "map_error must be finite and not negative, got inf"),
        ({"within": (0.2, 0.0, 0.1)}, "rocker must be positive and at most 40 degrees, got 0"),
        ({"belly": (1.0, 0.0, 0.5, 0.5)}, "belly must be rear and front edge in order"),
        ({"level": "abacus"}, "level must be one this machine has"),
    ],
)
def test_bad_input_is_named(options: dict[str, Any], message: str) -> None:
    level = sw.Terrain(np.zeros((90, 90)), 0.1)
    with pytest.raises(ValueError, match=message.replace("(", r"\(").replace(")", r"\)")):
        sw.RockerBogie.preset("perseverance").bounds(level, [(4.5, 4.5, 0.0)], **options)
    with pytest.raises(ValueError, match="poses"):
        sw.RockerBogie.preset("perseverance").bounds(level, [(math.nan, 4.5, 0.0)])


def test_feasible_is_what_settling_says() -> None:
    ground = sw.Terrain.yard(30, 0.1, 0.1, seed=9)
    rover, poses = sw.RockerBogie.preset("perseverance"), some(ground, 800, 9)
    limits = sw.FeasibilityLimits.curiosity().replace(clearance=0.2)
    found = rover.feasible(ground, poses, limits)
    stand = rover.settle(ground, poses)
    stability = rover.stability(stand, mass=1.0)
    sizes = np.column_stack(
        [
            np.abs(stand.roll) / limits.roll,
            np.abs(stand.pitch) / limits.pitch,
            stability.tilt / limits.tilt,
            np.abs(stand.joints[:, 0]) / limits.rocker,
            np.abs(stand.joints[:, 1:]).max(axis=1) / limits.bogie,
        ]
    )
    ok = (sizes <= 1).all(axis=1) & (stability.clearance >= limits.clearance)
    np.testing.assert_array_equal(found.ok[stand.stands], ok[stand.stands])
    assert 0 < found.ok.sum() < len(poses)
    assert 0 < found.exact.sum() < len(poses)
    margin = np.minimum(1 - sizes.max(axis=1), (stability.clearance - limits.clearance) / 0.26288)
    exact = found.exact & stand.stands
    np.testing.assert_allclose(found.margin[exact], margin[exact], atol=1e-9)
    assert np.all(found.margin[found.ok] <= margin[found.ok] + 1e-9)
    assert set(found.reason[found.ok]) == {"ok"}
    other = rover.feasible(ground, poses, limits, threads=4)
    np.testing.assert_array_equal(found.margin, other.margin)
    for count in (9, 67):  # the part of the second thread is shorter than what is worth lanes
        few = rover.feasible(ground, poses[:count], limits, threads=2)
        np.testing.assert_array_equal(few.margin, found.margin[:count])
    one = rover.feasible(ground, poses[0], limits)
    assert one.reason is found.reason[0]
    np.testing.assert_allclose(one.margin, found.margin[0], rtol=0, atol=1e-10)
    reasons = np.array(list(sw.FeasibilityReason), object)
    np.testing.assert_array_equal(found.reason, reasons[found.reason_codes])
    assert reasons[one.reason_codes] == one.reason


def test_bounds_are_the_same_at_every_call() -> None:
    """Only bounds of the default belly and ranges are kept between calls."""
    ground = sw.Terrain.yard(20, 0.1, 0.1, seed=9)
    rover, poses = sw.RockerBogie.preset("perseverance"), some(ground, 200, 9)
    first, belly = rover.bounds(ground, poses), (-0.2, 0.2, 0.1, 1.5)
    narrow, high = (rover.bounds(ground, poses, **how) for how in ({"within": (0.2,) * 3}, {"belly": belly}))
    for again in (rover.bounds(ground, poses), sw.RockerBogie.preset("perseverance").bounds(ground, poses)):
        np.testing.assert_array_equal(again.clearance, first.clearance)
        np.testing.assert_array_equal(again.status, first.status)
    assert (narrow.status != first.status).any()
    known = ~np.isnan(high.clearance[:, 0] + first.clearance[:, 0])
    assert (high.clearance[known, 0] > first.clearance[known, 0]).all()


def test_feasible_says_why_not() -> None:
    rover = sw.RockerBogie.preset("perseverance")
    x = 0.1 * np.arange(120)
    steep = sw.Terrain(np.tile(0.5 * x, (120, 1)), 0.1)
    assert rover.feasible(steep, (6, 6, 0)).reason == "pitch"
    assert rover.feasible(steep, (6, 6, math.pi / 2)).reason == "roll"
    assert rover.feasible(steep, (6, 6, 0), sw.FeasibilityLimits()).ok  # nothing is asked of how it stands
    level = sw.Terrain(np.zeros((120, 120)), 0.1)
    assert rover.feasible(level, (6, 6, 0), sw.FeasibilityLimits(clearance=0.7)).reason == "clearance"
    assert rover.feasible(level, (0.2, 6, 0)).reason == "off_map"
    with pytest.raises(ValueError, match="roll must be positive, got 0"):
        rover.feasible(level, (6, 6, 0), sw.FeasibilityLimits(roll=0.0))
    with pytest.raises(ValueError, match="limits must be a FeasibilityLimits, got int"):
        rover.feasible(level, (6, 6, 0), 3)  # type: ignore[arg-type]


def test_loads_carry_the_weight_and_balance() -> None:
    rover = sw.RockerBogie.preset("perseverance")
    level = sw.Terrain(np.zeros((120, 120)), 0.1)
    stand = rover.settle(level, (6, 6, 0.4))
    found = rover.stability(stand, mass=1025.0, centre_of_mass=(0.1, 0.05, 0.8), gravity=3.71)
    assert found.loads.sum() == pytest.approx(1025 * 3.71, rel=1e-12)
    wheels = np.array([rover.frames((0.0, 0.0, 0.0))[f"A{k}"][:2, 3] for k in range(1, 7)])
    # The moments of the loads about the origin are that of the weight; bogies carry by their levers.
    np.testing.assert_allclose(found.loads @ wheels / found.loads.sum(), (0.1, 0.05), atol=1e-4)
    middle, rear = 0.44998, 0.625
    np.testing.assert_allclose(found.loads[2] * middle, found.loads[4] * rear, rtol=1e-3)
    # Over the front wheels.
    assert found.tip_over_angle == pytest.approx(math.atan2(1.18502 - 0.1, 0.8), abs=1e-4)
    high = rover.stability(stand, mass=1.0, centre_of_mass=(0.0, 0.0, 5.0))
    assert high.tip_over_angle < found.tip_over_angle
    out = rover.stability(stand, mass=1.0, centre_of_mass=(0.0, 2.0, 0.5))
    assert out.tip_over_angle < 0
    assert out.loads.min() < 0


@pytest.mark.parametrize("mass", [0.0, -1.0, math.nan, math.inf])
def test_a_mass_that_is_none_is_refused(mass: float) -> None:
    rover = sw.RockerBogie.preset("perseverance")
    level = sw.Terrain(np.zeros((120, 120)), 0.1)
    with pytest.raises(ValueError, match="mass must be finite and positive, got"):
        rover.stability(rover.settle(level, (6, 6, 0)), mass=mass)


@pytest.mark.parametrize("name", ["perseverance", "in front"])
def test_the_reference_is_inside_and_hardly_narrower(name: str) -> None:
    from six_wheel.reference.ground.bounds import bounds, boxes
    from six_wheel.reference.ground.terrain import Terrain

    size = {**sw.RockerBogie.preset("perseverance").dimensions} if name == "perseverance" else dict(IN_FRONT)
    rover = rovers()[name]
    ground = sw.Terrain.yard(20, 0.1, 0.03, seed=4, roughness=0.05)
    plain, patches = Terrain(ground.heights, 0.1), boxes(size)
    poses = some(ground, 40, 4)
    found = rover.bounds(ground, poses, within=(math.radians(15), math.radians(7), math.radians(17)))
    compared = 0
    for k, pose in enumerate(poses):
        if found.status[k] != "bounded" or (narrow := bounds(plain, size, pose, patches)) is None:
            continue
        compared += 1
        for quantity, interval in narrow.items():
            wide = getattr(found, quantity)[k]
            assert np.all(wide[..., 0] <= interval[..., 0] + 1e-9)
            assert np.all(interval[..., 1] <= wide[..., 1] + 1e-9)
            # It looks at points of the very boxes, the core at whole cells of hulls along the grid.
            assert np.all(np.ptp(wide, axis=-1) - np.ptp(interval, axis=-1) < 0.3)
    assert compared > 10
