"""The boundary of Python and the core: every kind of array in, clear errors out, nothing half done."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

import six_wheel as sw
from tests.core.boundary.boundary_rover import SPEEDS, STEERING, TWISTS, read_only
from tests.rovers import SIX_SIZES
from tests.rovers import SIX_WHEELS as ROVER

ROCKY = sw.RockerBogie.preset("rocky7")


def unaligned(array: np.ndarray) -> np.ndarray:
    buffer = np.zeros(array.nbytes + 1, dtype=np.uint8)
    view = buffer[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    assert not view.flags.aligned
    return view


VIEWS = {
    "as it is": lambda a: a,
    "list": lambda a: a.tolist(),
    "Fortran order": np.asfortranarray,
    "every second row": lambda a: np.repeat(a, 2, axis=0)[::2],
    "every second column": lambda a: np.repeat(a, 2, axis=1)[:, ::2],
    "reversed": lambda a: a[::-1][::-1].copy()[::1][::-1][::-1],
    "negative strides": lambda a: np.ascontiguousarray(a[::-1, ::-1])[::-1, ::-1],
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "unaligned": unaligned,
    "read-only": read_only,
    "a subclass": lambda a: a.view(np.matrix) if a.ndim == 2 else a,
    "float32": lambda a: a.astype(np.float32),
    "longdouble": lambda a: a.astype(np.longdouble),
}


@pytest.mark.filterwarnings("ignore:the matrix subclass")
@pytest.mark.parametrize("view", VIEWS)
def test_any_view_of_the_numbers_will_do(view):
    # float32 changes the numbers themselves: compare with what it changes them to.
    exact = np.asarray(VIEWS[view](TWISTS), dtype=float)
    steering, speeds = ROVER.inverse(VIEWS[view](TWISTS))
    expected = ROVER.inverse(exact)
    np.testing.assert_array_equal(steering, expected[0])
    np.testing.assert_array_equal(speeds, expected[1])
    for result in (steering, speeds):
        assert result.flags.c_contiguous
        assert result.dtype == np.float64
    if view != "float32":
        twists = ROVER.forward(VIEWS[view](STEERING), VIEWS[view](SPEEDS))
        np.testing.assert_allclose(twists, TWISTS, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(sw.integrate(VIEWS[view](TWISTS), 0.1), sw.integrate(exact, 0.1))


DTYPES = st.one_of(
    npst.floating_dtypes(endianness="?"),
    npst.integer_dtypes(endianness="?"),
    npst.unsigned_integer_dtypes(endianness="?"),
    npst.boolean_dtypes(),
    npst.complex_number_dtypes(endianness="?"),
    npst.unicode_string_dtypes(),
    npst.byte_string_dtypes(),
    npst.datetime64_dtypes(),
    st.just(np.dtype(object)),
)


@st.composite
def arrays(draw: st.DrawFn) -> np.ndarray:
    dtype = draw(DTYPES)
    shape = draw(
        st.one_of(
            npst.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=6),
            npst.array_shapes(min_dims=0, max_dims=2, min_side=0, max_side=4).map(lambda s: (*s, 3)),
        )
    )
    array = draw(npst.arrays(dtype, shape)) if dtype.kind != "O" else np.full(shape, None)
    if array.ndim and draw(st.booleans()):
        array = np.asfortranarray(array)
    if array.ndim and draw(st.booleans()):
        array = array[:: draw(st.sampled_from([-2, -1, 2]))]
    if array.size and array.dtype.kind != "O" and draw(st.booleans()):
        array = unaligned(np.ascontiguousarray(array)) if array.dtype.alignment > 1 else array
    if draw(st.booleans()):
        array = read_only(array)
    return array


CALLS = [
    ROVER.inverse,
    ROVER.icr,
    ROVER.admissible,
    ROVER.project,
    ROVER.commands,
    lambda a: ROVER.forward(a, a),
    lambda a: ROVER.forward(STEERING, a),
    lambda a: ROVER.fit(a, SPEEDS, method="robust"),
    lambda a: ROVER.sensitivity(a, SPEEDS),
    lambda a: ROVER.sensitivity(STEERING, a),
    lambda a: sw.Odometry(ROVER).update(a, a, 0.0),
    lambda a: sw.Odometry(ROVER).update(STEERING[0], a, 0.0),
    lambda a: sw.Odometry(ROVER).update(STEERING[0], SPEEDS[0], a),
    lambda a: sw.Odometry(ROVER).set_pose(a, a),
    lambda a: sw.Odometry(ROVER).command(a, 0.0),
    lambda a: sw.dead_reckon(ROVER, a, a, a),
    lambda a: sw.dead_reckon(ROVER, STEERING, a, np.arange(5)),
    lambda a: sw.dead_reckon(ROVER, STEERING, SPEEDS, np.arange(5), yaw=a, start=(1, 2, 3)),
    lambda a: ROVER.inverse(TWISTS, previous=a),
    lambda a: ROVER.inverse(TWISTS, steering_rates=a),
    lambda a: ROVER.inverse(TWISTS[0], out=(a, a)),
    lambda a: ROVER.inverse(TWISTS[0], out=a),
    lambda a: sw.integrate(a, 0.1),
    lambda a: sw.integrate(TWISTS, a),
    lambda a: sw.integrate(TWISTS, 0.1, a),
    lambda a: sw.integrate(TWISTS, 0.1, out=a),
    lambda a: sw.differentiate(a, 0.1),
    sw.exp,
    sw.log,
    sw.wrap_angle,
    lambda a: sw.compose(a, a),
    lambda a: ROCKY.frames(a),
    lambda a: ROCKY.frames((0.3, 0.1, 0.2), a),
    lambda a: ROCKY.jacobians(a, a),
    lambda a: ROCKY.planar(a),
    lambda a: ROCKY.icr_offset(a),
    lambda a: ROCKY.steer(a, 0.0, np.zeros((3, 3))),
    lambda a: ROCKY.steer(0.5, a, (0.1, 0.1, 0.2), previous=a),
    lambda a: sw.RockerBogie(a, a, a, a, a, 0.1),
]


@pytest.mark.filterwarnings("ignore")  # NumPy warns of what it casts
@given(st.sampled_from(CALLS), arrays())
def test_any_array_gives_an_answer_or_a_named_error(call, array):
    before = array.tobytes()
    try:
        call(array)
    except ValueError as error:
        message = str(error)
        assert "\n" not in message
        assert " must " in message
        assert ", got " in message
        assert array.tobytes() == before


BAD_TWISTS = {
    "nan": ((0.5, math.nan, 0.3), ValueError, r"twist must be finite, got \(0.5, nan, 0.3\)"),
    "infinity": ((math.inf, 0.0, 0.0), ValueError, r"twist must be finite, got \(inf, 0.0, 0.0\)"),
    "overflow": ((1.7e308, 0.0, 1e308), ValueError, "twist must keep every wheel speed finite"),
    "too short": ((0.5, 0.0), ValueError, r"twist must have shape \(..., 3\), got shape \(2,\)"),
    "too long": ([0.5, 0.0, 0.0, 0.0], ValueError, r"got shape \(4,\)"),
    "a number": (0.5, ValueError, r"twist must have shape \(..., 3\), got a number"),
    "ragged": ([[1.0, 2.0], [3.0]], ValueError, "twist must be numbers of one rectangular shape"),
    "string": ("fast", TypeError, "twist must be real numbers, got 'fast'"),
    "strings": (("1", "2", "3"), TypeError, r"twist must be real numbers, got '1' at \[0\]"),
    "none": (None, TypeError, "twist must be real numbers, got None$"),
    "nones": ((0.0, None, 0.0), TypeError, r"twist must be real numbers, got None at \[1\]"),
    "complex": (np.ones(3, complex), TypeError, "twist must be real numbers, got dtype complex128"),
    "bool": (np.ones(3, bool), TypeError, "twist must be real numbers, got dtype bool"),
    "bools": ((True, False, True), TypeError, r"twist must be real numbers, got True at \[0\]"),
    "dict": ({"vx": 1.0}, TypeError, "got a dict: give its values as an array, in the order"),
    "huge integer": ((10**400, 0, 0), TypeError, r"twist must be real numbers, got 1(0+)\.\.\. at \[0\]"),
}


@pytest.mark.parametrize("case", BAD_TWISTS)
@pytest.mark.parametrize("method", ["inverse", "icr", "admissible", "project", "commands"])
def test_bad_twists(method, case):
    twist, kind, message = BAD_TWISTS[case]
    if case == "overflow" and method == "icr":
        return  # the centre of a huge twist is a point like any other
    with pytest.raises(kind, match=message) as caught:
        getattr(ROVER, method)(twist)
    assert isinstance(caught.value, ValueError)


def test_the_first_bad_row_is_named():
    twists = np.zeros((4, 5, 3))
    twists[2, 3] = math.nan
    twists[3, 0] = (0.0, 0.1, 0.0)
    with pytest.raises(ValueError, match=r"twist\[2, 3\] must be finite"):
        ROVER.inverse(twists)
    twists[2, 3] = 0.0
    with pytest.raises(
        sw.InfeasibleMotionError, match=r'twist\[3, 0\] must let the unsteered wheels "middle_left"'
    ):
        ROVER.inverse(twists)
    with pytest.raises(ValueError, match=r"speeds\[1\] must be finite"):
        ROVER.forward(STEERING[:2], [SPEEDS[0], [math.nan] * 6])


BAD_DIMENSIONS = [
    (name, value)
    for name in ("front_to_middle", "middle_to_rear", "track_width", "wheel_radius", "steering_limit")
    for value in (0.0, -0.1, math.nan, math.inf, -math.inf)
    if (name, value) != ("steering_limit", math.inf)  # endless
]
BAD_DIMENSIONS += [("middle_track_width", value) for value in (-0.1, math.nan, math.inf)]


@pytest.mark.parametrize(("name", "value"), BAD_DIMENSIONS)
def test_bad_dimensions(name, value):
    good = {
        "front_to_middle": 0.5,
        "middle_to_rear": 0.5,
        "track_width": 0.8,
        "middle_track_width": 0.9,
        "wheel_radius": 0.15,
        "steering_limit": 1.0,
    }
    with pytest.raises(ValueError, match=f"^{name} must be finite and .*, got {value}$"):
        sw.Rover.six_wheel(**{**good, name: value})


@pytest.mark.parametrize("value", ["0.4", None, True, [0.4], 1j])
def test_dimensions_of_the_wrong_type(value):
    with pytest.raises(sw.ArgumentTypeError, match="^front_to_middle must be a number, got "):
        sw.Rover.six_wheel(**SIX_SIZES | {"front_to_middle": value})
