"""Overlap is judged on the memory that is really read: a call is right or refused, whatever it came in."""

import ctypes
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw
from tests.rovers import SWERVE

ROWS = 100


class Interface:
    """Hands its memory over by the array interface, and is no array itself."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = array

    @property
    def __array_interface__(self) -> Any:
        return self.array.__array_interface__


class Method:
    """Hands its memory over by `__array__`."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = array

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return self.array


class Subclass(np.ndarray):
    """An array with its own idea of what functions of NumPy do."""

    def __array_function__(self, *_: Any) -> Any:
        raise RuntimeError("functions of NumPy are not for this array")


def ctypes_array(array: np.ndarray) -> Any:
    kind = ctypes.c_double
    for length in reversed(array.shape):
        kind = kind * length
    return kind.from_buffer(array)


OBJECTS: dict[str, Callable[[np.ndarray], Any]] = {
    "array": lambda a: a,
    "memoryview": memoryview,
    "array interface": Interface,
    "__array__": Method,
    "subclass": lambda a: a.view(Subclass),
    "ctypes": ctypes_array,
    "from a buffer": lambda a: np.frombuffer(memoryview(a.reshape(-1))).reshape(a.shape),
}
ANY_OBJECT = pytest.mark.parametrize("wrap", OBJECTS.values(), ids=OBJECTS.keys())


def right_or_refused(call: Callable[..., Any], expected: Callable[[], Any], *outs: np.ndarray) -> None:
    """Either the numbers are those of apart memory, or nothing has been written."""
    wanted, before = expected(), [out.copy() for out in outs]
    try:
        found = call()
    except ValueError as error:
        if "must not overlap" not in str(error):
            raise
        for out, kept in zip(outs, before, strict=True):
            np.testing.assert_array_equal(out, kept)
        return
    for one, other in zip(np.atleast_1d(found), np.atleast_1d(wanted), strict=True):
        np.testing.assert_array_equal(one, other)


@ANY_OBJECT
@pytest.mark.parametrize("rows", [1, 5, ROWS])
def test_a_twist_in_the_memory_of_the_result(wrap, rows):
    buffer = np.random.default_rng(1).normal(size=4 * rows)
    twists, speeds = buffer[: 3 * rows].reshape(rows, 3), buffer.reshape(rows, 4)
    with pytest.raises(ValueError, match=r"^out\[1\] must not overlap the input"):
        SWERVE.inverse(wrap(twists), out=(np.zeros((rows, 4)), speeds))


@ANY_OBJECT
def test_steps_in_the_memory_of_the_poses(wrap):
    poses = np.ones((ROWS + 1, 3))
    steps = poses.reshape(-1)[:ROWS]
    with pytest.raises(ValueError, match="^out must not overlap the input"):
        sw.integrate(np.ones((ROWS, 3)), wrap(steps), out=poses)


def test_steps_of_another_dtype_in_the_memory_of_the_poses():
    poses = np.ones((ROWS + 1, 3))
    steps = poses.reshape(-1).view(np.float32)[1 : 2 * ROWS : 2]
    wanted = sw.integrate(np.ones((ROWS, 3)), steps.copy())
    right_or_refused(lambda: sw.integrate(np.ones((ROWS, 3)), steps, out=poses), lambda: wanted, poses)


@ANY_OBJECT
def test_a_start_in_the_memory_of_the_poses(wrap):
    poses = np.ones((ROWS + 1, 3))
    with pytest.raises(ValueError, match="^out must not overlap the input"):
        sw.integrate(np.ones((ROWS, 3)), 0.1, wrap(poses[3]), out=poses)


@ANY_OBJECT
def test_the_results_over_each_other(wrap):
    """`out` has to be an array; one over the other's memory is refused."""
    buffer = np.zeros(8 * ROWS)
    first, second = buffer[: 4 * ROWS].reshape(ROWS, 4), buffer[2 * ROWS : 6 * ROWS].reshape(ROWS, 4)
    other = wrap(second)
    if not isinstance(other, np.ndarray):
        with pytest.raises(TypeError, match=r"^out\[1\] must be a writeable float64 array"):
            SWERVE.inverse(np.zeros((ROWS, 3)), out=(first, other))
        return
    with pytest.raises(ValueError, match=r"^out\[0\] must not overlap out\[1\]"):
        SWERVE.inverse(np.zeros((ROWS, 3)), out=(first, other))


def test_an_out_that_overlaps_itself():
    out = np.lib.stride_tricks.as_strided(np.zeros(10), (5, 3), (8, 8))
    with pytest.raises(ValueError, match="^out must not overlap itself"):
        SWERVE.project(np.zeros((5, 3)), out=out)


def test_previous_angles_may_be_the_result_but_not_in_disguise():
    twists = np.random.default_rng(2).normal(size=(ROWS, 3))
    steering, speeds = np.full((ROWS, 4), 0.3), np.zeros((ROWS, 4))
    wanted = SWERVE.inverse(twists, previous=steering.copy())
    found = SWERVE.inverse(twists, previous=steering, out=(steering, speeds))
    np.testing.assert_array_equal(found[0], wanted[0])
    with pytest.raises(ValueError, match=r"^out\[0\] must not overlap the input"):
        SWERVE.inverse(twists, previous=memoryview(steering), out=(steering, speeds))


@given(st.data())
def test_any_two_views_of_one_buffer(data):
    """Random views of one buffer as input and as `out`: right, or refused with nothing written."""
    rows = data.draw(st.sampled_from([1, 2, 7, 40]))
    buffer = np.linspace(-1.0, 1.0, 40 * 12)
    row, step = data.draw(st.sampled_from([8 * 3, 8 * 6, 8 * 12, 0])), data.draw(st.sampled_from([8, 16, 32]))
    start = data.draw(st.integers(0, 60))
    target = data.draw(st.integers(0, 60))
    line, column = data.draw(st.sampled_from([(24, 8), (48, 8), (96, 8), (48, 16), (96, 32)]))
    wrap = data.draw(st.sampled_from(list(OBJECTS.values())[:5]))
    strided = np.lib.stride_tricks.as_strided
    rows = min(rows, (len(buffer) - 60 - 12) // 12)
    twists = strided(buffer[start:], (rows, 3), (row, step), writeable=False)
    out = strided(buffer[target:], (rows, 3), (line, column))
    plain = np.array(twists)
    right_or_refused(
        lambda: SWERVE.project(wrap(twists) if wrap is not ctypes_array else twists, out=out),
        lambda: SWERVE.project(plain),
        out,
    )


def test_an_argument_whose_code_writes_over_an_earlier_one_is_refused():
    """An array that has been read is in use from then on, whoever asks."""
    twists, out = np.zeros((ROWS, 3)), np.zeros((ROWS, 3))

    class Writes:
        def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
            SWERVE.project(out, out=twists)
            return np.zeros((ROWS, 4))

    with pytest.raises(ValueError, match="^out must not overlap the input"):
        SWERVE.inverse(twists, previous=Writes())


@pytest.mark.parametrize("rows", [1, ROWS, 20_000])
@pytest.mark.parametrize("change", ["strides", "dtype", "shape"])
def test_an_argument_whose_code_changes_an_earlier_one(rows, change):
    """The numbers are those that were there when the argument was read."""
    twists = np.random.default_rng(3).normal(size=(rows, 3))
    rover, wanted = SWERVE, SWERVE.inverse(twists.copy())

    class Changes:
        def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # NumPy warns; what matters is that it is possible
                match change:
                    case "strides":
                        twists.strides = (8, 8)
                    case "dtype":
                        twists.dtype = np.uint8
                    case _:
                        twists.shape = (3 * rows,)
            return np.zeros((rows, 4))

    found = rover.inverse(twists, previous=Changes())
    for one, other in zip(found, wanted, strict=True):
        np.testing.assert_array_equal(one, other)
