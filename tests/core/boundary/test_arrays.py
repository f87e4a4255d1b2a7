"""Where Python meets the core: every kind of array in, clear errors out, nothing half done."""

import math
import sys
import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

import six_wheel as sw
from tests.rovers import SIX_SIZES
from tests.rovers import SIX_WHEELS as ROVER

TWISTS = np.array([[0.5, 0.0, 0.3], [0.2, 0.0, -1.0], [0.0, 0.0, 0.5], [-0.4, 0.0, 0.0], [0.0, 0.0, 0.0]])
STEERING, SPEEDS = ROVER.inverse(TWISTS)
ROCKY = sw.RockerBogie.preset("rocky7")


def unaligned(array: np.ndarray) -> np.ndarray:
    buffer = np.zeros(array.nbytes + 1, dtype=np.uint8)
    view = buffer[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    assert not view.flags.aligned
    return view


def read_only(array: np.ndarray) -> np.ndarray:
    array = array.copy()
    array.flags.writeable = False
    return array


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
    lambda a: ROCKY.frames(0.1, a),
    lambda a: ROCKY.frames(a, (0.1, 0.2), a),
    lambda a: ROCKY.jacobians(a, np.zeros((3, 2))),
    lambda a: ROCKY.planar(a, (0.1, 0.2)),
    lambda a: ROCKY.icr_offset(0.1, a),
    lambda a: ROCKY.steer(a, 0.0, 0.1, np.zeros((3, 2))),
    lambda a: ROCKY.steer(0.5, a, 0.1, (0.1, 0.2), previous=a),
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


def test_middle_wheels_may_meet_on_the_centre_line():
    assert (
        sw.Rover.six_wheel(
            front_to_middle=0.5,
            middle_to_rear=0.5,
            track_width=0.8,
            middle_track_width=0.0,
            wheel_radius=0.15,
        )
        .wheels[2]
        .y
        == 0.0
    )


def wheel(name="w", x=0.0, y=0.0, **keywords):
    return sw.Wheel(name, x, y, **{"radius": 0.1, **keywords})


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: wheel(""), "name must not be empty"),
        (lambda: wheel(x=math.nan), "x must be finite, got nan"),
        (lambda: wheel(radius=0), "radius must be finite and positive, got 0.0"),
        (lambda: wheel(heading=math.inf), "heading must be finite, got inf"),
        (
            lambda: wheel(steering_limit=1.0),
            "steering_limit must be left out for a wheel that is not steered, got 1.0",
        ),
        (lambda: wheel(steered=True, steering_limit=(1.0, -1.0)), "the lower angle below the upper"),
        (lambda: wheel(steered=True, steering_limit=(1.0, math.nan)), "steering_limit must be finite"),
        (lambda: sw.Rover([]), "wheels must hold 1 to 64 wheels, got 0"),
        (lambda: sw.Rover([wheel(str(i)) for i in range(65)]), "wheels must hold 1 to 64 wheels, got 65"),
        (lambda: sw.Rover([wheel(), wheel()]), 'wheels must have a name each, got "w" twice'),
        (lambda: ROVER.project((0, 0, 0), "everything"), "keep must be 'curvature', .* got \"everything\""),
        (lambda: ROVER.fit(STEERING, SPEEDS, method="best"), "method must be 'least_squares'"),
        (
            lambda: ROVER.forward(None, SPEEDS),
            "steering must hold the angles of the steered wheels, got None",
        ),
        (
            lambda: ROVER.forward(STEERING, SPEEDS[:2]),
            r"steering must have shape \(2, 4\), got shape \(5, 4\)",
        ),
        (lambda: ROVER.inverse(TWISTS, previous=STEERING[:2]), r"previous must have shape \(5, 4\)"),
        (lambda: ROVER.inverse(TWISTS[0], previous=[math.nan] * 4), "previous must be finite"),
        (lambda: ROVER.forward(STEERING[0], [1e308] * 6), "speeds must be small enough for a finite twist"),
    ],
)
def test_other_bad_arguments(build, message):
    with pytest.raises(ValueError, match=message) as caught:
        build()
    assert "\n" not in str(caught.value)


def test_one_wheel_does_not_determine_a_twist():
    unicycle = sw.Rover([wheel(steered=True)])
    with pytest.raises(sw.UnderdeterminedError, match=r"no reading of the motion \(vx, vy, omega\)"):
        unicycle.forward([0.1], [1.0])


def test_empty_batches():
    steering, speeds = ROVER.inverse(np.empty((0, 3)))
    assert steering.shape == (0, 4)
    assert speeds.shape == (0, 6)
    assert ROVER.forward(steering, speeds).shape == (0, 3)
    assert ROVER.project(np.empty((2, 0, 3))).shape == (2, 0, 3)
    assert ROVER.admissible(np.empty((0, 3))).shape == (0,)
    assert ROVER.fit(steering, speeds).rank.shape == (0,)
    np.testing.assert_array_equal(sw.integrate(np.empty((0, 3)), 0.1, (1, 2, 3)), [(1, 2, 3)])


def test_leading_axes_of_any_shape():
    twists = np.broadcast_to(TWISTS, (2, 3, 5, 3))
    steering, speeds = ROVER.inverse(twists)
    assert steering.shape == (2, 3, 5, 4)
    np.testing.assert_array_equal(speeds[1, 2], SPEEDS)
    fit = ROVER.fit(steering, speeds)
    assert fit.rank.shape == fit.sigma_min.shape == (2, 3, 5)
    assert np.shape(fit.worst_wheel) == (2, 3, 5)
    assert ROVER.icr(twists).shape == (2, 3, 5, 2)


# out=


def outputs(rows=5):
    return np.full((rows, 4), 7.0), np.full((rows, 6), 7.0)


def test_out_is_written_and_returned():
    steering, speeds = outputs()
    result = ROVER.inverse(TWISTS, out=(steering, speeds))
    assert result[0] is steering
    assert result[1] is speeds
    np.testing.assert_array_equal(steering, STEERING)
    np.testing.assert_array_equal(speeds, SPEEDS)
    twists = np.empty((5, 3))
    assert ROVER.forward(steering, speeds, out=twists) is twists
    assert ROVER.project(TWISTS, out=twists) is twists
    poses = np.empty((6, 3))
    assert sw.integrate(TWISTS, 0.1, out=poses) is poses


def test_out_may_be_any_view_of_float64():
    both = np.full((5, 20), 7.0)
    ROVER.inverse(TWISTS, out=(both[:, 0:8:2], both[:, 8:20:2]))
    np.testing.assert_array_equal(both[:, 0:8:2], STEERING)
    np.testing.assert_array_equal(both[:, 8:20:2], SPEEDS)
    assert (both[:, 1::2] == 7.0).all()


def test_out_may_be_the_previous_angles():
    steering, speeds = outputs()
    steering[:] = 0.3
    ROVER.inverse(TWISTS, previous=steering, out=(steering, speeds))
    np.testing.assert_array_equal(steering[4], [0.3] * 4)  # at rest: held
    np.testing.assert_array_equal(speeds, SPEEDS)


OVERLAP = np.zeros((5, 10))

BAD_OUTPUTS = {
    "not a pair": (lambda: np.empty((5, 4)), "out must be a pair of arrays"),
    "one of them": (lambda: (np.empty((5, 4)),), "out must be a pair of arrays"),
    "wrong shape": (
        lambda: (np.empty((5, 4)), np.empty((5, 5))),
        r"out\[1\] must be .* shape \(5, 6\), got shape \(5, 5\)",
    ),
    "float16": (
        lambda: (np.empty((5, 4), np.float16), np.empty((5, 6))),
        r"out\[0\] must be .* got an array of dtype float16",
    ),
    "integers": (lambda: (np.empty((5, 4)), np.empty((5, 6), int)), r"out\[1\] must be .* dtype int64"),
    "other byte order": (
        lambda: (np.empty((5, 4), ">f8"), np.empty((5, 6))),
        r"out\[0\] must be .* dtype >f8",
    ),
    "a list": (lambda: ([[0.0] * 4] * 5, np.empty((5, 6))), r"out\[0\] must be a writeable float64 array"),
    "read-only": (
        lambda: (read_only(np.empty((5, 4))), np.empty((5, 6))),
        r"out\[0\] must be .* got a read-only array",
    ),
    "a read-only view": (
        lambda: (np.empty((5, 4)), read_only(np.empty((5, 12)))[:, ::2]),
        r"out\[1\] must be .* got a read-only array",
    ),
    "each other": (lambda: (OVERLAP[:, :4], OVERLAP[:, 3:9]), r"out\[0\] must not overlap out\[1\]"),
}


@pytest.mark.parametrize("case", BAD_OUTPUTS)
def test_bad_outputs(case):
    build, message = BAD_OUTPUTS[case]
    with pytest.raises(ValueError, match=message):
        ROVER.inverse(TWISTS, out=build())


def test_outputs_over_inputs():
    shared = np.zeros((5, 7))
    shared[:, :3] = TWISTS
    with pytest.raises(ValueError, match=r"out\[0\] must not overlap the input"):
        ROVER.inverse(shared[:, :3], out=(shared[:, 2:6], np.empty((5, 6))))
    poses = np.zeros((6, 3))
    with pytest.raises(ValueError, match="out must not overlap the input"):
        sw.integrate(poses[1:], 0.1, out=poses)


def test_a_failed_call_writes_nothing():
    steering, speeds = outputs()
    bad = TWISTS.copy()
    bad[4] = (0.0, 0.1, 0.0)
    with pytest.raises(sw.InfeasibleMotionError):
        ROVER.inverse(bad, out=(steering, speeds))
    assert (steering == 7.0).all()
    assert (speeds == 7.0).all()
    poses = np.full((6, 3), 7.0)
    bad[4] = math.nan
    with pytest.raises(ValueError, match=r"twists\[4\] must be finite"):
        sw.integrate(bad, 0.1, out=poses)
    assert (poses == 7.0).all()
    twists = np.full((5, 3), 7.0)
    wrong = SPEEDS.copy()
    wrong[4, 5] = math.inf
    with pytest.raises(ValueError, match=r"speeds\[4\] must be finite"):
        ROVER.forward(STEERING, wrong, out=twists)
    assert (twists == 7.0).all()


def test_a_control_loop_leaks_nothing():
    twist, out = (0.5, 0.0, 0.3), (np.empty(4), np.empty(6))
    watched = [None, ROVER, *out, np.dtype(float)]
    for _ in range(100):
        ROVER.inverse(twist, out=out)
    before = [sys.getrefcount(thing) for thing in watched]
    for _ in range(1000):
        ROVER.inverse(twist, out=out)
        ROVER.forward(*out)
    after = [sys.getrefcount(thing) for thing in watched]
    assert np.abs(np.subtract(after, before)).max() < 100


def test_one_rover_on_many_threads():
    twists = np.tile(TWISTS, (2000, 1))
    expected = ROVER.inverse(twists)
    wrong = []

    def work():
        for _ in range(10):
            steering, speeds = ROVER.inverse(twists)
            if not (np.array_equal(steering, expected[0]) and np.array_equal(speeds, expected[1])):
                wrong.append(threading.get_ident())

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
