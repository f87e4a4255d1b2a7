"""Arguments of wheels and rovers, and objects as values."""

import math
import sys
import threading

import numpy as np
import pytest

import six_wheel as sw
from tests.core.boundary.boundary_rover import SPEEDS, STEERING, TWISTS, read_only
from tests.rovers import SIX_SIZES
from tests.rovers import SIX_WHEELS as ROVER


def test_middle_wheels_may_meet_on_the_centre_line():
    assert sw.Rover.six_wheel(**SIX_SIZES | {"middle_track_width": 0.0}).wheels[2].y == 0.0


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
