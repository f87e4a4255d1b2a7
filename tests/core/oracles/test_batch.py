"""Batches: the same bits at every level, and rows against those of the scalar level.

`SOAK` in the environment multiplies the number of random rows (`make soak`); `-s` shows the worst cases.
"""

import math
import os
from collections.abc import Iterable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from tests.core.oracles.batch_rovers import ROVERS
from tests.rovers import SIX_SIZES
from tests.strategies import any_twists, layouts

SOAK = int(os.environ.get("SOAK", "1"))
ROWS = 20_000 * SOAK
KERNELS = [name for name in sw.simd_levels() if name != "scalar"]
ALL_KERNELS = pytest.mark.parametrize("kernel", KERNELS)
SIZES = [0.0, -0.0, 5e-324, 1e-310, 1e-200, 1e-120, 1e-30, 1e-9, 0.1, 1.0, 3.0, 1e9, 1e90, 1e120, 1e300]

ALL_ROVERS = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())


def corners(rover: sw.Rover) -> np.ndarray:
    """Every combination of sizes, and turning exactly about every wheel."""
    grid = np.array(np.meshgrid(SIZES, SIZES, SIZES)).reshape(3, -1).T
    signs = np.array([(1, 1, 1), (-1, 1, 1), (1, -1, -1)])
    about = [(w.y * s, -w.x * s, s) for w in rover.wheels for s in SIZES]
    along = [(s * math.cos(a), s * math.sin(a), 0.0) for s in SIZES for a in np.arange(-8, 9) * math.pi / 8]
    return np.concatenate([*(grid * sign for sign in signs), about, np.reshape(along, (-1, 3))])


def random_twists(generator: np.random.Generator, count: int) -> np.ndarray:
    """Mostly ordinary; some at rest, straight or on the spot, some of any size there is."""
    twists = generator.normal(size=(count, 3))
    twists[generator.random((count, 3)) < 0.2] = 0.0
    odd = generator.random(count) < 0.1
    return np.where(odd[:, None], twists * 10.0 ** generator.uniform(-320, 307, (count, 1)), twists)


def possible(rover: sw.Rover, twists: np.ndarray) -> np.ndarray:
    """The twists the rover can make: those given, or with its fixed wheels' line respected."""
    with np.errstate(over="ignore", invalid="ignore"):
        fixed = [w for w in rover.wheels if not w.steered and not w.castor and w.roller_angle is None]
        if fixed:
            line = np.mean([w.x for w in fixed])
            twists = np.concatenate(
                [twists, np.stack([twists[:, 0], -line * twists[:, 2], twists[:, 2]], axis=1)]
            )
        finite = np.isfinite(twists).all(axis=1) & (np.abs(twists).max(axis=1) < 1e306)
    twists = twists[finite]
    return twists[rover.admissible(twists)]


def worst(found: np.ndarray, expected: np.ndarray, scale: np.ndarray | float = 0.0) -> float:
    """Largest error as a share of what is allowed: 4 ulp of the number, or of `scale`, or 1e-14."""
    allowed = np.maximum(4 * np.spacing(np.maximum(np.abs(expected), scale)), 1e-14)
    return float(np.max(np.abs(found - expected) / allowed, initial=0.0))


@ALL_KERNELS
@ALL_ROVERS
def test_inverse(kernel, rover):
    generator = np.random.default_rng(1)
    twists = possible(rover, np.concatenate([corners(rover), random_twists(generator, ROWS)]))
    expected = rover.inverse(twists, level="scalar")
    found = rover.inverse(twists, level=kernel)
    shares = [worst(*pair) for pair in zip(found, expected, strict=True)]
    print(f"inverse {kernel}: {len(twists)} rows, worst {max(shares):.2f} of 4 ulp or 1e-14")
    assert max(shares) <= 1.0


@ALL_KERNELS
@ALL_ROVERS
def test_forward(kernel, rover):
    generator = np.random.default_rng(2)
    joints, wheels = len(rover.steered_wheel_names), len(rover.wheels)
    steering = generator.normal(size=(ROWS, joints)) * 2
    speeds = generator.normal(size=(ROWS, wheels)) * 10
    odd = generator.random(ROWS) < 0.1
    speeds[odd] *= 10.0 ** generator.uniform(-320, 300, (odd.sum(), 1))
    steering[odd] *= 10.0 ** generator.uniform(-320, 300, (odd.sum(), 1))
    speeds[generator.random(speeds.shape) < 0.05] = 0.0
    expected = rover.forward(steering, speeds, level="scalar")
    found = rover.forward(steering, speeds, level=kernel)
    # Sums may cancel: 5 ulp of the summands, not of the rest.
    scale = np.abs(speeds).max(axis=1, keepdims=True) * max(w.radius for w in rover.wheels)
    share = worst(found, expected, scale * wheels)
    print(f"forward {kernel}: {ROWS} rows, worst {share:.2f} of 4 ulp or 1e-14")
    assert share <= 1.0


@ALL_KERNELS
@pytest.mark.parametrize("dt", [1e-3, 0.1, 3.0])
def test_integrate(kernel, dt):
    generator = np.random.default_rng(3)
    twists = random_twists(generator, ROWS)
    twists = np.where(np.abs(twists) < 1e3, twists, 1.0)
    each = np.full(ROWS, dt)
    expected = sw.integrate(twists, dt, (1.0, -2.0, 300.0), level="scalar")
    found = sw.integrate(twists, each, (1.0, -2.0, 300.0), level=kernel)
    # Rounding grows with the way driven, not with the place it leads to.
    way = np.concatenate([[3.0], 3.0 + np.cumsum(np.abs(twists).max(axis=1) * dt)])
    shares = [worst(found[:, :2], expected[:, :2], way[:, None]), worst(found[:, 2], expected[:, 2], 300.0)]
    print(f"integrate {kernel}: {ROWS} steps of {dt} s, worst {max(shares):.2f} of 4 ulp or 1e-14")
    assert max(shares) <= 1.0


def bits(arrays: Iterable[np.ndarray]) -> list[bytes]:
    """The bits of arrays; both zeros are one."""
    return [(array + 0.0).tobytes() for array in arrays]


GIVEN = ["previous", "previous_wheel_speeds", "steering_rates"]


def same_at_every_level(rover: sw.Rover, given_: list[str]) -> None:
    """The inverse with these inputs has the same bits at every level."""
    generator = np.random.default_rng(14)
    twists = possible(rover, np.concatenate([corners(rover), random_twists(generator, ROWS)]))
    shape = len(twists), len(rover.steered_wheel_names)
    every = {
        "previous": generator.normal(size=shape) * generator.choice([0.0, 0.3, 3.0, 1e9], size=shape),
        "previous_wheel_speeds": generator.normal(size=(len(twists), len(rover.wheels))),
        # Zero for wheels with trail: what they can do depends on it.
        "steering_rates": generator.normal(size=shape)
        * [not w.trail for w in rover.wheels if w.steered]
        * (generator.random(shape) < 0.5),
    }
    options = {name: every[name] for name in given_}
    expected = bits(rover.inverse(twists, level="scalar", **options))
    for level in KERNELS:
        assert bits(rover.inverse(twists, level=level, **options)) == expected


@ALL_ROVERS
@pytest.mark.parametrize("given_", [[], *([name] for name in GIVEN), GIVEN], ids=str)
def test_every_level_gives_the_same_bits(rover, given_):
    same_at_every_level(rover, given_)


@pytest.mark.parametrize("name", sw.Rover.presets())
def test_every_level_gives_the_same_bits_for_presets(name):
    same_at_every_level(sw.Rover.preset(name), [])
    same_at_every_level(sw.Rover.preset(name), GIVEN)


@given(layouts(offset=True), st.lists(any_twists(), min_size=8, max_size=80))
def test_every_level_gives_the_same_bits_for_any_layout(rover, twists):
    twists = rover.project(twists, keep="nearest")
    expected = bits(rover.inverse(twists, level="scalar"))
    for level in KERNELS:
        assert bits(rover.inverse(twists, level=level)) == expected
    for k, twist in enumerate(twists):
        one = bits(rover.inverse(twist))
        assert one == bits(array[k] for array in rover.inverse(twists))


@ALL_KERNELS
@given(layouts(), st.lists(any_twists(), min_size=8, max_size=80))
def test_inverse_of_any_layout(kernel, rover, twists):
    twists = rover.project(twists)
    expected = rover.inverse(twists, level="scalar")
    found = rover.inverse(twists, level=kernel)
    assert max(worst(*pair) for pair in zip(found, expected, strict=True)) <= 1.0
    back = rover.forward(*expected, level=kernel)
    np.testing.assert_allclose(back, rover.forward(*expected, level="scalar"), rtol=0, atol=1e-12)


@ALL_KERNELS
@pytest.mark.parametrize(
    "bad", [(0.0, 1.0, 0.0), (math.nan, 0.0, 0.0), (0.0, 0.0, -math.inf), (1e308, 0, 1e308)]
)
@pytest.mark.parametrize("row", [0, 7, 63, 64, 130])
def test_a_failed_inverse_writes_nothing_and_says_what_the_plain_core_says(kernel, bad, row):
    rover = ROVERS["perseverance"]
    twists = np.tile([0.5, 0.0, 0.2], (131, 1))
    twists[row] = bad
    out = np.full((131, 4), 7.0), np.full((131, 6), 7.0)
    with pytest.raises(ValueError, match=rf"^twist\[{row}\] must") as plain:
        rover.inverse(twists, level="scalar")
    with pytest.raises(type(plain.value)) as found:
        rover.inverse(twists, out=out, level=kernel)
    assert str(found.value) == str(plain.value)
    assert all((array == 7.0).all() for array in out)


@ALL_KERNELS
@pytest.mark.parametrize("value", [math.nan, math.inf, 1e307])
@pytest.mark.parametrize("row", [0, 63, 64, 130])
def test_a_failed_forward_writes_nothing(kernel, value, row):
    steering, speeds = np.zeros((131, 4)), np.ones((131, 6))
    speeds[row, 3] = value
    out = np.full((131, 3), 7.0)
    rover = sw.Rover.six_wheel(**SIX_SIZES | {"wheel_radius": 150.0})
    with pytest.raises(ValueError, match=rf"^wheel_speeds\[{row}\] must be"):
        rover.forward(steering, speeds, out=out, level=kernel)
    assert (out == 7.0).all()


@ALL_KERNELS
@pytest.mark.parametrize("bad", [(math.nan, 0, 0), (0, -math.inf, 0), (1e308, 0, 0)])
def test_a_failed_rollout_writes_nothing(kernel, bad):
    controls, out = np.ones((5, 20, 3)), np.full((5, 21, 3), 7.0)
    controls[3, 11] = bad
    with pytest.raises(ValueError, match=r"^controls\[3, 11\] must"):
        sw.rollout(controls, 10.0, out=out, level=kernel)
    assert (out == 7.0).all()


@ALL_KERNELS
def test_wheels_without_encoder(kernel):
    rover = sw.Rover.ackermann(2.0, 1.2, 0.3)
    generator = np.random.default_rng(4)
    joints, wheels = len(rover.steered_wheel_names), len(rover.wheels)
    steering, speeds = generator.normal(size=(200, joints)), generator.normal(size=(200, wheels))
    passive = [i for i, w in enumerate(rover.wheels) if not w.driven]
    speeds[50:120, passive] = math.nan
    expected = rover.forward(steering, speeds, level="scalar")
    assert worst(rover.forward(steering, speeds, level=kernel), expected, 10.0) <= 1.0


@pytest.mark.parametrize("kernel", sw.simd_levels())
@pytest.mark.parametrize("threads", [2, 3, 7])
def test_threads_change_no_bit(kernel, threads):
    rover = ROVERS["perseverance"]
    twists = random_twists(np.random.default_rng(5), 25_001)
    twists[:, 1] = 0.0
    twists = twists[np.abs(twists).max(axis=1) < 1e300]
    one = rover.inverse(twists, level=kernel, threads=1)
    many = rover.inverse(twists, level=kernel, threads=threads)
    for ours, theirs in zip(one, many, strict=True):
        np.testing.assert_array_equal(ours, theirs)
    back = rover.forward(*one, level=kernel, threads=1)
    np.testing.assert_array_equal(rover.forward(*one, level=kernel, threads=threads), back)
    controls = np.random.default_rng(6).normal(size=(400, 64, 3))
    poses = sw.rollout(controls, 0.1, level=kernel, threads=1)
    np.testing.assert_array_equal(sw.rollout(controls, 0.1, level=kernel, threads=threads), poses)


@ALL_KERNELS
@pytest.mark.parametrize("threads", [1, 3])
def test_what_is_too_large_for_the_caches_is_its_parts(kernel, threads):
    rover = ROVERS["perseverance"]
    count = 450_001  # 36 MB of output
    twists = random_twists(np.random.default_rng(7), 9001)
    twists = np.resize(possible(rover, twists)[:5003], (count, 3))
    memory = np.full(10 * count + 16, np.inf)
    first = 5  # neither output begins with a line of the caches
    out = (
        memory[first : first + 4 * count].reshape(count, 4),
        memory[first + 4 * count : first + 10 * count].reshape(count, 6),
    )
    rover.inverse(twists, out=out, level=kernel, threads=threads)
    assert np.isposinf(memory[:first]).all()
    assert np.isposinf(memory[first + 10 * count :]).all()
    for k in range(0, count, 100_003):
        rows = slice(k, k + 100_003)
        parts = rover.inverse(twists[rows], level=kernel)
        assert all(np.array_equal(whole[rows], part) for whole, part in zip(out, parts, strict=True))


@pytest.mark.parametrize("threads", [1, 2])
def test_the_first_bad_row_is_named_whatever_the_threads(threads):
    twists = np.tile([0.5, 0.0, 0.2], (50_000, 1))
    twists[[12_345, 45_678], 1] = 1.0
    with pytest.raises(sw.InfeasibleMotionError, match=r"^twist\[12345\] must"):
        ROVERS["perseverance"].inverse(twists, threads=threads)


@pytest.mark.parametrize("kernel", sw.simd_levels())
def test_a_rollout_is_its_logs(kernel):
    generator = np.random.default_rng(7)
    controls, starts = generator.normal(size=(5, 13, 3)), generator.normal(size=(5, 3))
    poses = sw.rollout(controls, 0.1, starts, level=kernel)
    for k in range(5):
        np.testing.assert_array_equal(poses[k], sw.integrate(controls[k], 0.1, starts[k], level=kernel))
    same = sw.rollout(controls, np.full(13, 0.1), starts[0], level=kernel)
    np.testing.assert_array_equal(same[0], poses[0])


@pytest.mark.parametrize("kernel", sw.simd_levels())
def test_a_long_closed_circle_ends_where_it_began(kernel):
    count, radius = min(1_000_000 * SOAK, 100_000_000), 5.0
    twists = np.empty((count, 3))
    twists[:] = radius * 2 * math.pi / count * 100, 0.0, 2 * math.pi / count * 100  # a hundred rounds
    poses = sw.integrate(twists, 1.0, (0.0, 0.0, 1e3 * 2 * math.pi), level=kernel)
    way = 100 * 2 * math.pi * radius
    turn = poses[-1, 2] - poses[0, 2] - 100 * 2 * math.pi
    print(f"circle {kernel}: {count} steps, off by {np.hypot(*poses[-1, :2]) / way:.1e} of the way")
    # The steps' own rounding, half an ulp of each, adds up to that of the turn.
    assert np.hypot(*poses[-1, :2]) <= 1e-9 * way
    assert abs(turn) <= 1e-9
