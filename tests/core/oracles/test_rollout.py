"""Rollouts of a sampling planner: poses and what they ask of the wheels, against one call per step."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel import reference
from tests.rovers import CAR, MECANUM, SIX_SIZES, THREE_AXLES
from tests.strategies import layouts

SOAK = int(os.environ.get("SOAK", "1"))
ALL_KERNELS = pytest.mark.parametrize("kernel", sw.simd_levels())
ROVERS = {
    "perseverance": sw.Rover.preset("perseverance"),
    "limited": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=0.9),
    "one-sided": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=(-1.0, 0.3)),
    "wide": sw.Rover.six_wheel(**SIX_SIZES, steering_limit=(-2.0, 2.5)),
    "ackermann": CAR,
    "differential": THREE_AXLES,
    "mecanum": MECANUM,
}
ALL_ROVERS = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())


def samples(seed: int, rollouts: int, steps: int) -> np.ndarray:
    """Controls as a planner samples them, some of them at rest, straight on, sideways or on the spot."""
    generator = np.random.default_rng(seed)
    controls = generator.normal((0.3, 0.0, 0.0), (0.4, 0.05, 0.6), (rollouts, steps, 3))
    return np.where(generator.random(controls.shape) < 0.1, 0.0, controls)


def costs(result: sw.RolloutCost) -> np.ndarray:
    return np.stack(result[1:], axis=-1)


def close(found: np.ndarray, expected: np.ndarray) -> None:
    # 5 ulp or 1e-14 of each angle and speed; a rate is a difference of two angles over 0.1 s.
    np.testing.assert_allclose(found, expected, rtol=1e-15, atol=4e-13)


@ALL_KERNELS
@ALL_ROVERS
@pytest.mark.parametrize("given", [False, True], ids=["no previous", "previous"])
def test_costs_are_those_of_the_reference(kernel, rover, given):
    controls, start = samples(1, 19, 11), (1.0, -2.0, 0.5)
    previous = np.linspace(-0.5, 0.4, len(rover.steered_wheel_names)) if given else None
    twin = reference.Rover([reference_wheel(wheel) for wheel in rover.wheels])
    poses, expected = reference.rollout_cost(twin, controls, 0.1, start, previous)
    found = rover.rollout_cost(controls, 0.1, start, previous=previous, level=kernel)
    np.testing.assert_allclose(found.poses, poses, rtol=0, atol=1e-13)
    # The slack of a wheel near the end of its range, 1e-9 rad, is an error of the angle in either.
    np.testing.assert_allclose(costs(found), expected, rtol=1e-12, atol=1e-11)


def reference_wheel(wheel: sw.Wheel) -> reference.Wheel:
    steered = wheel.steering_limit if wheel.steered else None
    names = ("name", "x", "y", "radius", "heading", "scrub", "trail", "roller_angle", "castor", "driven")
    fields = {name: getattr(wheel, name) for name in names}
    return reference.Wheel(**fields, steered=wheel.steered, steering_limit=steered)


@pytest.mark.parametrize("kernel", [name for name in sw.simd_levels() if name != "scalar"])
@ALL_ROVERS
@pytest.mark.parametrize("dt", ["constant", "each"])
def test_kernels_agree_with_the_plain_core(kernel, rover, dt):
    controls = samples(2, 203 * min(SOAK, 500), 37)
    controls[3] *= 1e-310
    controls[4] *= 1e150
    controls[5, 7:] = 0.0
    controls[6, :, 1] = 5.0 * controls[6, :, 0]
    dts = 0.1 if dt == "constant" else np.random.default_rng(3).uniform(0.05, 0.2, 37)
    previous = np.full(len(rover.steered_wheel_names), 0.2)
    expected = rover.rollout_cost(controls, dts, previous=previous, level="scalar")
    found = rover.rollout_cost(controls, dts, previous=previous, level=kernel)
    for ours, theirs in zip(found[1:], expected[1:], strict=True):
        close(ours, theirs)
    way = 1.0 + np.abs(controls).max(axis=2).sum(axis=1)[:, None, None] * 0.2
    assert (np.abs(found.poses - expected.poses) <= 4 * np.spacing(way) + 1e-14).all()


@ALL_KERNELS
@given(layouts(), st.integers(0, 2**32 - 1))
def test_any_layout(kernel, rover, seed):
    controls = samples(seed, 9, 10)
    expected = rover.rollout_cost(controls, 0.1, level="scalar")
    close(costs(rover.rollout_cost(controls, 0.1, level=kernel)), costs(expected))


@ALL_KERNELS
@ALL_ROVERS
def test_possible_controls_cost_what_the_inverse_says(kernel, rover):
    controls = rover.project(samples(4, 12, 9))
    found = rover.rollout_cost(controls, 0.1, level=kernel)
    assert found.max_side_slip.max() < 1e-9
    np.testing.assert_array_equal(found.poses, sw.rollout(controls, 0.1, level=kernel))
    speeds, steering = np.zeros(len(rover.wheels)), np.zeros(len(rover.steered_wheel_names))
    fastest, widest, quickest = [], [], []
    for twist in controls[7]:
        before = steering.copy()
        rover.inverse(twist, previous=before, out=(steering, speeds))
        fastest.append(np.abs(speeds).max())
        widest.append(np.abs(steering).max(initial=0.0))
        quickest.append(np.abs(steering - before).max(initial=0.0) / 0.1)
    expected = max(fastest), max(widest), max(quickest[1:]), 0.0
    np.testing.assert_allclose(costs(found)[7], expected, rtol=1e-12, atol=1e-9)


@ALL_KERNELS
def test_what_impossible_controls_cost(kernel):
    rover = ROVERS["perseverance"]
    controls = np.zeros((9, 3, 3))
    controls[:, :, 0], controls[:, 1, 1] = 1.0, 0.25
    sideways = rover.rollout_cost(controls, 0.5, level=kernel)
    # The middle wheels cannot steer: they slide with the whole of vy. The others just point there.
    np.testing.assert_allclose(sideways.max_side_slip, 0.25, rtol=1e-15)
    np.testing.assert_allclose(sideways.max_steering_angle, math.atan2(0.25, 1.0), rtol=1e-15)
    np.testing.assert_allclose(sideways.max_steering_rate, math.atan2(0.25, 1.0) / 0.5, rtol=1e-15)
    radius = min(wheel.radius for wheel in rover.wheels)
    np.testing.assert_allclose(sideways.max_wheel_speed, math.hypot(1.0, 0.25) / radius, rtol=1e-15)
    previous = np.full(len(rover.steered_wheel_names), 0.5)
    turned = rover.rollout_cost(controls[:, :1], 0.5, previous=previous, level=kernel)
    np.testing.assert_allclose(turned.max_steering_rate, 1.0, rtol=1e-15)


@ALL_KERNELS
def test_at_rest_the_wheels_hold_their_angles(kernel):
    rover = ROVERS["limited"]
    previous = np.array([0.1, -0.2, 0.3, -0.4])
    found = rover.rollout_cost(np.zeros((10, 9, 3)), 0.1, previous=previous, level=kernel)
    np.testing.assert_array_equal(costs(found), np.tile([0.0, 0.4, 0.0, 0.0], (10, 1)))


@ALL_KERNELS
@pytest.mark.parametrize("threads", [2, 3, 7])
def test_threads_change_no_bit(kernel, threads):
    rover, controls = ROVERS["limited"], samples(5, 450, 50)
    one = rover.rollout_cost(controls, 0.1, level=kernel, threads=1)
    many = rover.rollout_cost(controls, 0.1, level=kernel, threads=threads)
    for ours, theirs in zip(one, many, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_a_result_can_be_written_again():
    rover = ROVERS["limited"]
    first = rover.rollout_cost(samples(6, 20, 10), 0.1)
    expected = rover.rollout_cost(samples(7, 20, 10), 0.1, (1, 2, 3))
    again = rover.rollout_cost(samples(7, 20, 10), 0.1, (1, 2, 3), out=first)
    assert all(ours is theirs for ours, theirs in zip(again, first, strict=True))
    for ours, theirs in zip(again, expected, strict=True):
        np.testing.assert_array_equal(ours, theirs)


@ALL_KERNELS
def test_shapes(kernel):
    rover, controls = ROVERS["limited"], samples(8, 24, 6).reshape(2, 12, 6, 3)
    starts = np.random.default_rng(9).normal(size=(2, 12, 3))
    found = rover.rollout_cost(controls, 0.1, starts, level=kernel)
    assert found.poses.shape == (2, 12, 7, 3)
    assert found.max_side_slip.shape == (2, 12)
    one = rover.rollout_cost(controls[1], 0.1, starts[1], level=kernel)
    np.testing.assert_array_equal(found.poses[1], one.poses)
    np.testing.assert_array_equal(found.max_steering_rate[1], one.max_steering_rate)
    for empty in ((0, 6, 3), (12, 0, 3)):
        nothing = rover.rollout_cost(np.zeros(empty), 0.1, level=kernel)
        assert not costs(nothing).any()


@ALL_KERNELS
@pytest.mark.parametrize("bad", [(math.nan, 0, 0), (0, math.inf, 0), (1e308, 0, 1e308)])
def test_a_failure_writes_nothing(kernel, bad):
    rover, controls = ROVERS["limited"], samples(10, 12, 9)
    controls[7, 5] = bad
    out = sw.RolloutCost(np.full((12, 10, 3), 7.0), *(np.full(12, 7.0) for _ in range(4)))
    for target in (out, None):
        with pytest.raises(ValueError, match=r"^controls\[7, 5\] must"):
            rover.rollout_cost(controls, 0.1, out=target, level=kernel)
    assert all((array == 7.0).all() for array in out)


def test_what_does_not_fit_is_refused():
    rover, controls = ROVERS["limited"], np.zeros((3, 4, 3))
    with pytest.raises(ValueError, match=r"^controls must have shape \(..., k, t, 3\), got shape \(4, 3\)"):
        rover.rollout_cost(controls[0], 0.1)
    with pytest.raises(ValueError, match=r"^previous must have shape \(..., 4\), got shape \(3,\)"):
        rover.rollout_cost(controls, 0.1, previous=np.zeros(3))
    with pytest.raises(ValueError, match=r"^previous must be finite"):
        rover.rollout_cost(controls, 0.1, previous=[0, 0, 0, math.nan])
    with pytest.raises(
        ValueError, match=r"^out must be a RolloutCost or a tuple of its five arrays, got list"
    ):
        rover.rollout_cost(controls, 0.1, out=[])
    shared = np.zeros(3)
    with pytest.raises(ValueError, match=r"^out must not overlap itself"):
        rover.rollout_cost(controls, 0.1, out=(np.zeros((3, 5, 3)), shared, shared, *np.zeros((2, 3))))


MEMORY = """
import resource, sys
import numpy as np
import six_wheel as sw

def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024

job, form, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
rover = sw.Rover.preset("perseverance")

def array(width, *leading):
    kind, order = np.float32 if form == "float32" else float, "F" if form == "fortran" else "C"
    rows = np.empty((*(leading or [count]), width), dtype=kind, order=order)
    rows[:] = [0.5, 0.0, 0.1, 0.2, 0.0, 0.3][:width]
    if form == "swapped":
        rows = rows.byteswap(inplace=True).view(rows.dtype.newbyteorder())
    return rows

if job == "inverse":
    twists = array(3)
    call = lambda: rover.inverse(twists, out=out)
    out = np.zeros((count, 4)), np.zeros((count, 6))
elif job == "forward":
    steering, speeds, out = array(4), array(6), np.zeros((count, 3))
    call = lambda: rover.forward(steering, speeds, out=out)
elif job == "integrate":
    twists, out = array(3), np.zeros((count + 1, 3))
    call = lambda: sw.integrate(twists, 0.01, out=out)
else:
    controls, out = array(3, count // 50, 50), np.zeros((count // 50, 51, 3))
    call = lambda: sw.rollout(controls, 0.01, out=out)
for touched in out if isinstance(out, tuple) else [out]:
    touched[:] = 1.0
before = peak()
call()
print(peak() - before)
"""


@pytest.mark.parametrize("form", ["doubles", "float32", "fortran", "swapped"])
@pytest.mark.parametrize("job", ["inverse", "forward", "integrate", "rollout"])
def test_memory_beside_inputs_and_outputs_stays_small(job, form):
    pytest.importorskip("resource")
    count = 10_000_000 if SOAK > 1 else 1_000_000
    command = [sys.executable, "-c", MEMORY, job, form, str(count)]
    more = int(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    if sys.platform == "darwin":
        more //= 1024  # which counts in bytes
    print(f"{job} of {count} rows, {form}: {more / 1e6:.1f} MB")
    assert more < 16e6
