"""One call: the quick way gives what the general way gives, fails as it fails, keeps and takes no memory.

The general way is asked by what only it knows: a tuple of a class of its own, or `threads=1`. `SOAK` in the
environment multiplies the random rows, and makes the races last a minute.
"""

import math
import os
import pickle
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from tests.core.oracles.fast_calls import QUICK, ROVER, TWIST, outputs
from tests.core.oracles.test_batch import ROVERS, corners, possible, random_twists, worst
from tests.strategies import any_twists, layouts, speeds

SWERVE = ROVERS["turning swerve"]
SOAK = int(os.environ.get("SOAK", "1"))
SECONDS = 60.0 if SOAK > 1 else 0.3
CALLS = 100_000


class Slow(tuple):
    """Arguments that the fast path leaves to the general one."""


class Real(float):
    """A float as good as any."""


def outcome(call: Callable[..., Any], *arguments: Any, **keywords: Any) -> Any:
    """Result of a call, or its error."""
    try:
        result = call(*arguments, **keywords)
    except Exception as error:
        return type(error), str(error)
    if isinstance(result, tuple):
        return [array.tolist() for array in result]
    return result.tolist() if isinstance(result, np.ndarray) else result


def test_the_quick_way_is_taken():
    out = outputs(ROVER)
    assert ROVER.inverse(TWIST, out=out) is out  # the general way makes a tuple of its own
    assert ROVER.inverse(Slow(TWIST), out=out) is not out


# The same results


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())
def test_one_call_is_a_row_of_the_plain_core(rover):
    generator = np.random.default_rng(11)
    twists = possible(rover, np.concatenate([corners(rover)[::5], random_twists(generator, 2000)]))[:4000]
    previous = generator.normal(size=(len(twists), len(rover.steered_wheel_names))) * 2
    for given_ in (None, previous):
        expected = rover.inverse(twists, previous=given_, level="scalar")
        found = [
            rover.inverse(twist, previous=None if given_ is None else given_[k])
            for k, twist in enumerate(map(tuple, twists.tolist()))
        ]
        for ours, theirs in zip(zip(*found, strict=True), expected, strict=True):
            assert worst(np.array(ours), theirs) <= 1.0


@given(layouts(offset=True), st.lists(any_twists(), min_size=1, max_size=8), st.data())
def test_inverse_of_any_layout(rover, twists, data):
    angle = st.floats(-4, 4)
    previous = data.draw(
        st.lists(angle, min_size=len(rover.steered_wheel_names), max_size=len(rover.steered_wheel_names))
    )
    for twist in twists:
        twist = tuple(rover.project(twist, keep="nearest").tolist())
        for options in ({}, {"previous": previous}, {"previous": np.array(previous)}):
            expected = rover.inverse(twist, level="scalar", **options)
            for ours, theirs in zip(rover.inverse(twist, **options), expected, strict=True):
                assert worst(ours, theirs) <= 1.0
            out = outputs(rover)
            assert rover.inverse(twist, out=out, **options)[0] is out[0]
            assert [a.tolist() for a in out] == [a.tolist() for a in rover.inverse(Slow(twist), **options)]
        assert rover.admissible(twist) is True
        assert rover.project(twist).tolist() == list(twist)


@given(layouts(offset=True), st.data())
def test_forward_of_any_layout(rover, data):
    def numbers(count: int, size: float) -> st.SearchStrategy[list[float]]:
        return st.lists(st.floats(-size, size), min_size=count, max_size=count)

    steering, rates = (
        data.draw(numbers(len(rover.steered_wheel_names), 7)),
        data.draw(numbers(len(rover.wheels), 30)),
    )
    expected = rover.forward(steering, rates, level="scalar")
    # 5 ulp of the summands: the wheels' speeds, and as yaw rates at the pivots' spread, over the wheels.
    pivots = np.array([(wheel.x, wheel.y) for wheel in rover.wheels])
    spread = math.sqrt(((pivots - pivots.mean(axis=0)) ** 2).sum(axis=1).mean())
    fastest = 30 * max(wheel.radius for wheel in rover.wheels) * (1 + np.abs(pivots).max())
    scale = fastest * len(rover.wheels) * max(1, 1 / spread)
    for given_ in ((steering, rates), (tuple(steering), tuple(rates)), (np.array(steering), np.array(rates))):
        found, out = rover.forward(*given_), np.full(3, 7.0)
        assert worst(found, expected, scale) <= 1.0
        assert rover.forward(*given_, out=out) is out
        assert out.tolist() == found.tolist() == rover.forward(Slow(steering), rates).tolist()


@given(st.tuples(st.floats(), st.floats(), st.floats()), st.sampled_from(sorted(ROVERS)))
def test_any_three_floats_end_alike_on_both_ways(twist, name):
    rover = ROVERS[name]
    for method in QUICK[:1] + QUICK[2:]:
        call = getattr(rover, method)
        assert outcome(call, twist) == outcome(call, Slow(twist))


@given(st.tuples(speeds(), speeds(), speeds()))
def test_project_of_what_the_rover_cannot_do(twist):
    for name in ("limited", "perseverance", "ackermann"):
        rover, out = ROVERS[name], np.empty(3)
        expected = rover.project(Slow(twist))
        assert rover.project(twist).tolist() == expected.tolist()
        assert rover.project(twist, out=out) is out
        assert out.tolist() == expected.tolist()
        assert rover.admissible(twist) == rover.admissible(Slow(twist))


def test_a_batch_of_few_rows_is_its_single_calls():
    twists = np.random.default_rng(3).normal(size=(5, 3)) * [1, 0, 1]
    for rover in (ROVER, SWERVE):
        steering, rates = rover.inverse(twists)
        back = rover.forward(steering, rates)
        for k, twist in enumerate(twists):
            one = rover.inverse(tuple(twist))
            np.testing.assert_array_equal(steering[k], one[0])
            np.testing.assert_array_equal(rates[k], one[1])
            np.testing.assert_array_equal(back[k], rover.forward(*one))


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0, "corners"])
@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())
def test_present_angles(rover, scale):
    """Batches with present angles go through the kernel of one row."""
    generator = np.random.default_rng(12)
    twists = possible(rover, np.concatenate([corners(rover), random_twists(generator, 5000 * SOAK)]))
    shape = len(twists), len(rover.steered_wheel_names)
    if scale == "corners":
        angles = [0.0, -0.0, math.pi / 2, -math.pi / 2, math.pi, -math.pi, 5e-324, 1e300]
        previous = generator.choice(angles, size=shape)
    else:
        previous = generator.normal(size=shape) * scale
    expected = rover.inverse(twists, previous=previous, level="scalar")
    found = rover.inverse(twists, previous=previous)
    share = max(worst(*pair) for pair in zip(found, expected, strict=True))
    print(f"inverse with present angles: {len(twists)} rows, worst {share:.2f} of 5 ulp or 1e-14")
    assert share <= 1.0


@pytest.mark.parametrize("rover", [ROVER, SWERVE, ROVERS["turned"]], ids=["six", "swerve", "turned"])
def test_a_batch_with_present_angles_is_its_single_calls(rover):
    generator = np.random.default_rng(4)
    twists = possible(rover, generator.normal(size=(60, 3)))
    previous = generator.normal(size=(len(twists), len(rover.steered_wheel_names)))
    steering, rates = rover.inverse(twists, previous=previous)
    for k, twist in enumerate(twists):
        one = rover.inverse(twist, previous=previous[k])
        # To rounding: here the lanes are rows, there wheels, and sums of half turns are rounded elsewhere.
        np.testing.assert_allclose(steering[k], one[0], rtol=1e-15, atol=2e-15)
        np.testing.assert_allclose(rates[k], one[1], rtol=1e-15)


# Changes of a steered wheel while the loop runs


def test_a_wheel_at_rest_holds_its_angle_and_one_beyond_its_range_its_end():
    previous = np.array([0.3, -0.2, 9.0, -0.1])
    steering, rates = ROVER.inverse((0.0, 0.0, 0.0), previous=previous)
    np.testing.assert_array_equal(steering, np.clip(previous, -math.pi / 2, math.pi / 2))
    assert not rates.any()
    wheel = ROVER.wheels[0]
    about = (wheel.y, -wheel.x, 1.0)  # this pivot alone rests
    lone = sw.Rover([w for w in ROVER.wheels if w.steered])
    assert lone.inverse(about, previous=previous)[0][0] == previous[0]
    assert lone.inverse(about, previous=previous)[1][0] == 0.0


def test_a_loop_may_write_over_its_own_angles():
    out, expected = outputs(SWERVE, 0.0), outputs(SWERVE, 0.0)
    for angle in np.linspace(0, 12, 400):
        twist = (math.cos(angle), math.sin(angle), 0.1)
        assert SWERVE.inverse(twist, previous=out[0], out=out)[0] is out[0]
        expected = SWERVE.inverse(twist, previous=expected[0], level="scalar")
        assert worst(out[0], expected[0]) <= 1.0
        assert worst(out[1], expected[1]) <= 1.0


# Odd arguments: as the general way has them


def strange_arrays(count: int) -> dict[str, Any]:
    plain = np.full(count, 0.25)
    frozen, buffer = plain.copy(), np.zeros(8 * count + 1, dtype=np.uint8)
    frozen.flags.writeable = False
    unaligned = buffer[1:].view(float)
    unaligned[:] = plain
    return {
        "array": plain,
        "unpickled": pickle.loads(pickle.dumps(plain)),
        "strided": np.full(2 * count, 0.25)[::2],
        "reversed": plain[::-1],
        "unaligned": unaligned,
        "other byte order": plain.astype(plain.dtype.newbyteorder()),
        "float32": plain.astype(np.float32),
        "longdouble": plain.astype(np.longdouble),
        "int": np.ones(count, dtype=int),
        "bool": np.ones(count, dtype=bool),
        "complex": plain.astype(complex),
        "object": plain.astype(object),
        "read-only": frozen,
        "zero-d": np.array(0.25),
        "a batch of one": plain[None],
        "too long": np.full(count + 1, 0.25),
        "too short": plain[1:],
        "empty": plain[:0],
        "a subclass": plain.view(type("Sub", (np.ndarray,), {})),
        "a broadcast": np.broadcast_to(0.25, count),
        "masked": np.ma.masked_array(plain),
        "list": plain.tolist(),
        "tuple": tuple(plain.tolist()),
        "range": range(count),
        "numpy scalars": list(plain),
        "float32 scalars": [np.float32(0.25)] * count,
        "ints": [1] + [0] * (count - 1),
        "bools": [True] + [0] * (count - 1),
        "huge ints": [10**400] + [0] * (count - 1),
        "ints beyond 2**53": [2**63 + 1] + [0] * (count - 1),
        "derived floats": [Real(0.25)] * count,
        "strings": ["0.25"] * count,
        "nested": [[0.25]] * count,
        "nan": np.full(count, math.nan),
        "infinite": [math.inf] * count,
        "huge": [1e307] * count,
        "a generator": (0.25 for _ in range(count)),
        "None": None,
        "a string": "abc",
        "a dict": {},
        "a float": 0.25,
    }


STRANGE = sorted(strange_arrays(3))


def both_ways(call: Callable[..., Any], slow: dict[str, Any]) -> None:
    """Calls with and without a keyword that only the general way knows and that changes nothing."""
    assert outcome(call) == outcome(call, **slow)


@pytest.mark.parametrize("what", STRANGE)
@pytest.mark.parametrize("rover", [ROVER, SWERVE, ROVERS["differential"]], ids=["six", "swerve", "unsteered"])
def test_strange_inputs(rover, what):
    joints, wheels = len(rover.steered_wheel_names), len(rover.wheels)
    steering, rates = [0.1] * joints, [1.0] * wheels

    def one(count: int) -> Any:  # fresh every time: a generator is used up
        return strange_arrays(count)[what]

    # `threads=1` is the default, and unknown to the quick way.
    both_ways(lambda **slow: rover.inverse(one(3), **slow), {"threads": 1})
    both_ways(lambda **slow: rover.inverse(TWIST, previous=one(joints), **slow), {"threads": 1})
    both_ways(lambda **slow: rover.forward(one(joints), rates, **slow), {"threads": 1})
    both_ways(lambda **slow: rover.forward(steering, one(wheels), **slow), {"threads": 1})
    for method in ("project", "admissible"):
        call = getattr(rover, method)
        if what != "a generator":
            slow = Slow(one(3)) if isinstance(one(3), list | tuple | range) else one(3)
            assert outcome(call, one(3)) == outcome(call, slow)


@pytest.mark.parametrize("what", STRANGE)
def test_strange_outputs(what):
    joints, wheels = len(ROVER.steered_wheel_names), len(ROVER.wheels)

    def results(**slow: Any) -> Any:
        steering, rates, pose = (strange_arrays(count)[what] for count in (joints, wheels, 3))
        found = [
            outcome(ROVER.inverse, TWIST, out=(steering, rates), **slow),
            outcome(ROVER.inverse, TWIST, out=(np.empty(joints), rates), **slow),
            outcome(ROVER.inverse, TWIST, out=steering, **slow),
            outcome(ROVER.inverse, TWIST, out=[np.empty(joints), np.empty(wheels)], **slow),
            outcome(ROVER.forward, [0.0] * joints, [1.0] * wheels, out=pose, **slow),
        ]
        left = [getattr(array, "tolist", lambda: None)() for array in (steering, rates, pose)]
        return found, left

    assert repr(results()) == repr(results(threads=1))  # by their text: NaN is not NaN


def test_arrays_that_overlap():
    buffer = np.arange(40.0)
    cuts = {
        "apart": (buffer[:4], buffer[4:10]),
        "one over the other": (buffer[:4], buffer[3:9]),
        "the same start": (buffer[:4], buffer[:6]),
        "interleaved": (buffer[0:8:2], buffer[1:13:2]),
    }
    for name, out in cuts.items():
        for options in ({}, {"previous": out[0]}, {"previous": out[1][:4]}, {"previous": buffer[2:6]}):
            both_ways(
                lambda o=out, p=options, **slow: ROVER.inverse(TWIST, out=o, **p, **slow), {"threads": 1}
            )
        with (
            pytest.raises(ValueError, match="must not overlap") if name in list(cuts)[1:3] else nullcontext()
        ):
            ROVER.inverse(TWIST, out=out)
    buffer[:3] = TWIST
    with pytest.raises(ValueError, match=r"^out\[0\] must not overlap the input"):
        ROVER.inverse(buffer[:3], out=(buffer[2:6], buffer[10:16]))
    with pytest.raises(ValueError, match="^out must not overlap the input"):
        ROVER.forward(buffer[:4], buffer[4:10], out=buffer[9:12])
    with pytest.raises(ValueError, match="^out must not overlap the input"):
        ROVER.project(buffer[:3], out=buffer[1:4])
