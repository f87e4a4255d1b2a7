"""A planner's cycle against the same cycle in plain NumPy, and the laws of its rollouts."""

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.reference.control import planner as plain
from six_wheel.reference.control import random_numbers
from tests.core.planner.layouts import LIMITS, ROVERS, components, twin
from tests.rovers import SIX_SIZES

ALL_ROVERS = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())
# One joint is always set for some motion; two may be set for none.
BEGUN = {
    f"{name}, {how}": (rover, how)
    for name, rover in ROVERS.items()
    for how in ("at rest", "moving", "loose")
    if how != "loose" or len(rover.steered_wheel_names) >= 2
}
DT, START = 0.05, (2.0, 1.5, 0.4)
HILLS = np.random.default_rng(3).random((40, 50)).astype(np.float32)
PATH = np.array([(1.0, 1.0), (2.1, 1.4), (3.0, 2.2), (3.2, 3.0)])
GROUND = {"spacing": 0.1, "origin": (0.3, -0.2)}


def begun(rover, drive, how):
    """Motion and angles to begin with, and what the joints are then set for."""
    steering = np.zeros(len(rover.steered_wheel_names))
    if how == "moving":
        twist = rover.project((0.3, 0.0, 0.15))
        if len(steering):
            steering = rover.inverse(twist)[0]
        return twist, steering, components(drive, twist), None
    if how == "loose":
        steering = np.array([0.5, -0.4, 0.3, 0.1][: len(steering)])
    set_for = components(drive, rover.project((1.0, 0.0, 0.0)))
    return np.zeros(3), steering, set_for, steering if how == "loose" and len(steering) else None


@pytest.mark.parametrize(("rover", "how"), BEGUN.values(), ids=BEGUN.keys())
@pytest.mark.parametrize("kernel", sw.simd_levels())
def test_a_cycle_is_that_of_the_reference(rover, how, kernel):
    options = {
        "sampling_std": (0.6, 0.4, 0.9),
        "temperature": 5.0,
        "cost_weights": {"effort": 0.3, "scrub": 0.7},
    }
    plan = sw.Mppi(
        rover, sw.Limits(**LIMITS), horizon=40, dt=DT, samples=200, seed=7, smoothing=False, **options
    )
    drive = twin(rover, LIMITS, DT)
    twist, steering, setting, loose = begun(rover, drive, how)
    costmap = sw.Costmap(HILLS, lethal=0.97, outside=0.9, **GROUND)
    found = plan.step(
        START, twist=twist, steering=steering, costmap=costmap, path=PATH, goal=(4.0, 3.0), level=kernel
    )

    wishes = components(drive, plan.wishes)
    motions = plain.drive(drive, wishes, components(drive, twist), setting, loose)
    way = plain.poses(drive, motions, START)
    value = plain.map_value(HILLS.astype(float), 0.1, (0.3, -0.2), way[:, 1:, :2], outside=0.9)
    total = plain.costs(drive, motions, way, plan.cost_weights, np.array([4.0, 3.0]), value, lethal=0.97)
    total += plain.path_costs(drive, way, PATH, plan.state["progress"], plan.cost_weights)
    # A rover that wants to turn on the spot and cannot is as far from a turn to the left as from one to the
    # right: rounding decides. So do two of the samples that are no noise, and one that brakes to exactly
    # zero speed.
    apart = np.abs(plan.costs / total - 1) > 1e-12
    assert apart.sum() <= (3 if rover.spin_radius == 0 else 0)
    _, mean = plain.mean(plan.costs, wishes, 5.0)
    # Costs of a hundred to 1e-12 over a temperature of 5.
    np.testing.assert_allclose(components(drive, found.controls), mean, rtol=0, atol=1e-11)
    assert found.cost == plan.costs.min()


@pytest.mark.parametrize("kernel", sw.simd_levels())
@pytest.mark.parametrize("yaw", [0.7, -2.5, np.pi / 2])
def test_a_turned_map_costs_what_it_costs_in_its_own_axes(kernel, yaw):
    rover = ROVERS["six wheels"]
    turn = sw.Pose(*GROUND["origin"], yaw) @ sw.Pose(*GROUND["origin"], 0.0).inverse()
    straight = sw.Costmap(HILLS, outside=0.9, **GROUND)
    plans = [sw.Mppi(rover, sw.Limits(**LIMITS), samples=200, seed=7) for _ in range(2)]
    for plan, by, costmap in zip(
        plans, (sw.Pose(), turn), (straight, straight.replace(yaw=yaw)), strict=True
    ):
        goal = by @ sw.Pose(4.0, 3.0, 0.0)
        plan.step(by @ sw.Pose(*START), costmap=costmap, goal=goal[:2], level=kernel)
    # The same positions in other axes: 1e-15 m apart, where costs change by 10 for every metre.
    np.testing.assert_allclose(plans[1].costs, plans[0].costs, rtol=1e-11)


def test_a_place_beside_a_turned_map_is_refused():
    costmap = sw.Costmap(np.zeros((3, 5)), 1.0, (0.0, 0.0), np.pi / 4)
    plan = sw.Mppi(ROVERS["six wheels"], sw.Limits(**LIMITS), samples=8)
    assert plan.step((0.0, 2.0, 0.0), goal=(1.0, 2.0), costmap=costmap).poses[0, 1] == 2.0
    with pytest.raises(
        ValueError, match=r"^state.pose must lie on the costmap \(from \(0.0, 0.0\) to .* turned by 0.78"
    ):
        plan.step((3.0, 0.0, 0.0), goal=(1.0, 2.0), costmap=costmap)


def test_the_generator_gives_its_published_words():
    # Random123, kat_vectors: philox4x32 of zeros, 7 and 10 rounds.
    zeros = np.zeros(4, np.uint64)
    words = [0x5F6FB709, 0x0D893F64, 0x4F121F81, 0x4F730A48]
    assert random_numbers.philox(0, zeros).tolist() == words
    words = [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8]
    assert random_numbers.philox(0, zeros, rounds=10).tolist() == words


@pytest.mark.parametrize("name", ["differential", "mecanum"])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_wishes_are_the_noise_of_the_counter(name, dtype):
    rover = ROVERS[name]
    components = 2 if name == "differential" else 3
    plan = sw.Mppi(
        rover, horizon=11, samples=3000, seed=2**63 + 5, sampling_std=(1, 1, 1), correlation=0, dtype=dtype
    )
    plan.step((0, 0, 0), goal=(3, 1))
    noise = random_numbers.normals(2**63 + 5, 0, 3000, 11, components)
    wishes = plan.wishes if components == 3 else plan.wishes[..., [0, 2]]
    # Past the rollouts that are no noise; polynomials in single precision, at up to 6 standard deviations.
    np.testing.assert_allclose(wishes[6:], noise[6:], rtol=0, atol=4e-6)
    flat = noise.ravel()
    assert abs(flat.mean()) < 4 / np.sqrt(flat.size)
    assert abs(flat.var() - 1) < 6 / np.sqrt(flat.size)


@ALL_ROVERS
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_bits_depend_on_neither_threads_nor_kernels(rover, dtype):
    costmap = sw.Costmap(HILLS, lethal=0.97, **GROUND)
    path = [(2, 1.5), (3.5, 2), (4, 3)]

    def run(threads, kernel):
        plan = sw.Mppi(rover, sw.Limits(**LIMITS), horizon=24, samples=333, seed=1, dtype=dtype)
        for _ in range(2):
            found = plan.step(START, path=path, costmap=costmap, threads=threads, level=kernel)
        return plan.costs, found.controls, found.poses, found.steering

    first = run(1, sw.simd_levels()[-1])
    for threads, kernel in [
        (2, sw.simd_levels()[-1]),
        (7, sw.simd_levels()[0]),
        *((1, name) for name in sw.simd_levels()[:-1]),
    ]:
        for ours, theirs in zip(run(threads, kernel), first, strict=True):
            np.testing.assert_array_equal(ours, theirs)


@ALL_ROVERS
def test_no_rollout_asks_for_more_than_its_limits(rover):
    seen = []

    def look(poses, twists):
        seen.append((poses, twists))
        return np.zeros(len(poses))

    plan = sw.Mppi(rover, sw.Limits(**LIMITS), horizon=40, dt=DT, samples=300, seed=3)
    twist = rover.project((0.3, 0.0, 0.1))
    steering = rover.inverse(twist)[0]
    found = plan.step(START, twist=twist, steering=steering, goal=(5, 3), extra_cost=look)
    poses, twists = seen[0]
    np.testing.assert_allclose(sw.rollout(twists, DT, START), poses, rtol=0, atol=1e-12)
    asked = rover.rollout_cost(twists, DT, START, previous=steering)
    assert asked.max_wheel_speed.max() <= LIMITS["wheel_speed"] * (1 + 1e-12)
    # Wheels side by side in a fixed axle slide by design; steered ones never do.
    by_design = rover.rollout_cost(sw.Rover(rover.wheels).project(twists), DT, START).max_side_slip
    assert (asked.max_side_slip <= by_design + 1e-9).all()
    speed, yaw = np.hypot(twists[..., 0], twists[..., 1]), np.abs(twists[..., 2])
    assert speed.max() <= LIMITS["speed"] * (1 + 1e-12)
    assert yaw.max() <= LIMITS["yaw_rate"] * (1 + 1e-12)
    assert (speed * yaw).max() <= LIMITS["lateral_acceleration"] * (1 + 1e-12)
    # Where it never stops, the joints of two steps are as far apart as they may turn.
    moving = (np.abs(twists).max(axis=-1) > 1e-9).all(axis=1)
    assert moving.any()
    if len(steering) and rover.min_radius > 0:
        assert asked.max_steering_rate[moving].max() <= LIMITS["steering_rate"] * (1 + 1e-9)
    assert found.reason == ""


def test_single_precision_is_near_double():
    rover, costmap = ROVERS["six wheels"], sw.Costmap(HILLS, **GROUND)
    costs = {}
    for dtype in ("float32", "float64"):
        plan = sw.Mppi(rover, sw.Limits(**LIMITS), samples=500, seed=1, dtype=dtype)
        plan.step(START, costmap=costmap, path=[(2, 1.5), (3.5, 2), (4, 3)])
        costs[dtype] = plan.costs
    apart = np.abs(costs["float32"] / costs["float64"] - 1)
    # A joint that turns a step earlier or later is another way; there are few.
    assert np.quantile(apart, 0.9) < 1e-4


def test_what_is_on_its_way_stays():
    rover = ROVERS["six wheels"]
    plan = sw.Mppi(rover, sw.Limits(**LIMITS), horizon=20, dt=0.1, samples=64, delay=0.3)
    plan.step((0, 0, 0), goal=(3, 0))
    np.testing.assert_array_equal(plan.wishes[:, :3], np.zeros((64, 3, 3)))
    before = plan.state["controls"]
    found = plan.step((0, 0, 0), goal=(3, 0))
    np.testing.assert_allclose(found.controls[:3], np.array(before)[1:4], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(found.twist, found.twists[3])


def test_a_state_goes_on_in_another_planner():
    rover = ROVERS["six wheels"]
    one, other = (sw.Mppi(rover, sw.Limits(**LIMITS), samples=100, seed=4) for _ in range(2))
    one.step((0, 0, 0), goal=(3, 1))
    other.restore(one.state)
    first, second = (plan.step((0.1, 0, 0), goal=(3, 1)) for plan in (one, other))
    np.testing.assert_array_equal(first.controls, second.controls)
    one.reset()
    again = sw.Mppi(rover, sw.Limits(**LIMITS), samples=100, seed=4)
    first, second = (plan.step((0, 0, 0), goal=(3, 1)) for plan in (one, again))
    np.testing.assert_array_equal(first.controls, second.controls)


@ALL_ROVERS
@pytest.mark.parametrize("kernel", sw.simd_levels())
def test_rollouts_apart_are_those_of_a_planner(rover, kernel):
    seen = []
    plan = sw.Mppi(rover, sw.Limits(**LIMITS), horizon=30, dt=DT, samples=70, seed=9)
    twist = rover.project((0.3, 0.0, 0.1))
    steering = rover.inverse(twist)[0]
    plan.step(
        START, twist=twist, steering=steering, extra_cost=lambda poses, _: seen.append(poses) or np.zeros(70)
    )
    found = sw.rollout(
        plan.wishes,
        DT,
        START,
        rover=rover,
        limits=sw.Limits(**LIMITS),
        twist=twist,
        steering=steering,
        level=kernel,
    )
    np.testing.assert_allclose(found, seen[0], rtol=0, atol=1e-12)


def test_rollouts_apart_wait_for_the_dead_time_and_start_where_they_are_told():
    rover, limits = ROVERS["six wheels"], sw.Limits(acceleration=1.0, speed=1.0)
    controls = np.tile((1.0, 0.0, 0.0), (2, 10, 1))
    starts = [(0, 0, 0), (1, 2, np.pi / 2)]
    poses = sw.rollout(controls, 0.1, starts, rover=rover, limits=limits, delay=0.3)
    way = np.cumsum(np.concatenate([np.zeros(4), np.arange(1, 8) * 0.01]))
    np.testing.assert_allclose(poses[0, :, 0], way, atol=1e-12)
    np.testing.assert_allclose(poses[1, :, :2], np.stack([np.ones(11), 2 + way], axis=1), atol=1e-12)
    stuck = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=(0.5, 1.0))
    assert (sw.rollout(controls, 0.1, starts, rover=stuck) == np.array(starts)[:, None]).all()
    with pytest.raises(ValueError, match="limits must come with a rover, got none"):
        sw.rollout(controls, 0.1, limits=limits)
    with pytest.raises(ValueError, match="delay must be finite and not negative, got nan"):
        sw.rollout(controls, 0.1, rover=rover, delay=np.nan)
