"""Batches in any form: headings of many turns, memory layouts, leading axes, options."""

import math

import numpy as np
import pytest

import six_wheel as sw
from tests.core.oracles.batch_rovers import ROVERS
from tests.rovers import CORNERS


@pytest.mark.parametrize("kernel", sw.simd_levels())
def test_a_heading_of_many_turns_loses_no_digits(kernel):
    # Two hundred million turns, where yaws lie 2e-7 rad apart, and then once round in 64 steps of 1 m.
    twists = np.tile([1.0, 0.0, 2 * math.pi / 64], (64, 1))
    poses = sw.integrate(twists, 1.0, (0.0, 0.0, 2.0**30), level=kernel)
    assert np.spacing(poses[-1, 2]) > 2e-7
    np.testing.assert_allclose(poses[-1, :2], 0, rtol=0, atol=1e-13)


def unaligned(rows: np.ndarray) -> np.ndarray:
    """The same numbers, one byte off."""
    memory = np.zeros(rows.nbytes + 1, dtype=np.uint8)
    moved = memory[1:].view(rows.dtype).reshape(rows.shape)
    moved[:] = rows
    return moved


FORMS = {
    "fortran": np.asfortranarray,
    "every other row": lambda rows: np.repeat(rows, 2, axis=0)[::2],
    "backwards": lambda rows: np.ascontiguousarray(rows[::-1, ::-1])[::-1, ::-1],
    "columns of a table": lambda rows: np.concatenate([rows, rows], axis=1)[:, : rows.shape[1]],
    "swapped": lambda rows: rows.astype(rows.dtype.newbyteorder()),
    "unaligned": unaligned,
    **{
        name: lambda rows, name=name: rows.astype(name)
        for name in ("f2", "f4", ">f4", "g", "i1", "i2", ">i4", "i8", "u1", "u2", "u4", ">u8")
    },
    "unaligned float32": lambda rows: unaligned(rows.astype("f4")),
    "list": np.ndarray.tolist,
}


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS.keys())
@pytest.mark.parametrize("threads", [1, 2])
def test_numbers_in_any_form_are_the_same_numbers(form, threads):
    # Small whole numbers: every dtype holds them. More of them than are read at a time.
    rover, generator = sw.Rover.swerve(CORNERS, 0.1), np.random.default_rng(8)
    for count in (5, 21_003):
        twists, previous = (1.0 * generator.integers(0, 9, (count, width)) for width in (3, 4))
        steering, speeds = rover.inverse(twists, previous=previous)
        found = rover.inverse(form(twists), previous=form(previous), threads=threads)
        np.testing.assert_array_equal(found[0], steering)
        np.testing.assert_array_equal(found[1], speeds)
        np.testing.assert_array_equal(rover.inverse(form(twists))[0], rover.inverse(twists)[0])
        back = rover.forward(previous, np.rint(speeds))
        np.testing.assert_array_equal(rover.forward(form(previous), np.rint(speeds)), back)
        np.testing.assert_array_equal(sw.integrate(form(twists), 0.01), sw.integrate(twists, 0.01))
        dts = 1.0 + generator.integers(0, 9, (2 * count, 1))
        twists = np.ones((2 * count, 3))
        in_form = np.asarray(form(dts))[:, 0]
        np.testing.assert_array_equal(sw.integrate(twists, in_form), sw.integrate(twists, dts[:, 0]))


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("leading", [(3, 5, 1000), (7001, 1, 2), (2, 9001)])
def test_leading_axes_in_any_order(order, leading):
    rover, generator = ROVERS["differential"], np.random.default_rng(9)
    twists = generator.normal(size=(*leading, 3))
    twists[..., 1] = 0.0
    axes = (*range(len(leading))[::-1], len(leading))
    moved = np.asarray(np.ascontiguousarray(twists.transpose(axes)), order=order).transpose(axes)
    for ours, theirs in zip(rover.inverse(moved), rover.inverse(twists), strict=True):
        np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_array_equal(sw.integrate(moved, 0.1), sw.integrate(twists, 0.1))


@pytest.mark.parametrize("kernel", sw.simd_levels())
@pytest.mark.parametrize("threads", [1, 3])
def test_whatever_is_returned_fresh_is_checked(kernel, threads):
    twists = np.tile([0.5, 0.0, 0.2], (50_000, 1))
    twists[[33_333, 44_444], 0] = math.nan
    steering, speeds = np.zeros((50_000, 4)), np.ones((50_000, 6))
    speeds[44_444, 5] = math.inf
    options = {"level": kernel, "threads": threads}
    for form in (twists, twists.astype("f4"), np.asfortranarray(twists)):
        with pytest.raises(ValueError, match=r"^twist\[33333\] must be finite"):
            ROVERS["perseverance"].inverse(form, **options)
        with pytest.raises(ValueError, match=r"^twists\[33333\] must be finite"):
            sw.integrate(form, 0.1, **options)
        with pytest.raises(ValueError, match=r"^controls\[666, 33\] must be finite"):
            sw.rollout(form.reshape(1000, 50, 3), 0.1, **options)
    with pytest.raises(ValueError, match=r"^wheel_speeds\[44444\] must be"):
        ROVERS["perseverance"].forward(steering, speeds.astype("f4"), **options)
    with pytest.raises(ValueError, match=r"^dt\[44444\] must be finite and not negative"):
        sw.integrate(
            np.zeros((50_000, 3)), np.where(np.arange(50_000) == 44_444, -1.0, 1.0).astype("f4"), **options
        )


def test_options():
    rover, twists = ROVERS["perseverance"], np.zeros((9, 3))
    assert sw.simd_levels()[0] == "scalar"
    with pytest.raises(ValueError, match=r"^level must be one this machine has \(\"scalar\".*got \"mmx\""):
        rover.inverse(twists, level="mmx")
    for call in (lambda: sw.integrate(twists, 0.1, threads=0), lambda: sw.set_default_threads(0)):
        with pytest.raises(ValueError, match="^threads must be at least 1, got 0"):
            call()
    with pytest.raises(ValueError, match=r"^controls must have shape \(..., k, t, 3\)"):
        sw.rollout(twists, 0.1)
    assert sw.default_threads() == 1
    try:
        sw.set_default_threads(2)
        assert sw.default_threads() == 2
    finally:
        sw.set_default_threads(1)
