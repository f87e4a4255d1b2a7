"""Options by name: single precision, threads; and units that are questioned."""

import inspect
import math
import re
import warnings

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import six_wheel as sw
from six_wheel import SuspiciousUnitsWarning
from tests.rovers import SIX_SIZES

ROVER = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.2)
ROWS = 50_001  # more than one thread is started for, and no multiple of a block
TWISTS = np.random.default_rng(0).uniform((0.5, 0.0, -0.3), (1.0, 0.0, 0.3), (ROWS, 3))
STEERING, SPEEDS = ROVER.inverse(TWISTS)
ASIDE = np.array((0.0, 0.1, 1.0))
POINTS = TWISTS[:, 1:]
AXLES = sw.FourAxle(pivots=(0.4, 0.3), axle_length=0.2, wheel_radius=0.1)
CONTROLS = TWISTS[:50_000].reshape(500, 100, 3)

# Every call that takes rows and gives arrays as they are, with what says how.
BATCHES = {
    "inverse": lambda **how: ROVER.inverse(TWISTS, **how),
    "forward": lambda **how: ROVER.forward(STEERING, SPEEDS, **how),
    "project": lambda **how: ROVER.project(TWISTS + ASIDE, **how),
    "integrate": lambda **how: sw.integrate(CONTROLS, 0.1, **how),
    "rollout": lambda **how: sw.rollout(CONTROLS, 0.1, **how),
    "rollout_cost": lambda **how: ROVER.rollout_cost(CONTROLS, 0.1, **how),
    "icr": lambda **how: ROVER.icr(TWISTS, **how),
    "exp": lambda **how: sw.exp(TWISTS, 0.1, **how),
    "log": lambda **how: sw.log(TWISTS, 0.1, **how),
    "compose": lambda **how: sw.compose(TWISTS, TWISTS[::-1], **how),
    "differentiate": lambda **how: sw.differentiate(TWISTS, 0.1, **how),
    "wrap_angle": lambda **how: sw.wrap_angle(9 * TWISTS, **how),
    "four axles": lambda **how: AXLES.inverse(TWISTS, **how),
    "concurrent_angles": lambda **how: AXLES.concurrent_angles(2 + POINTS, **how),
}
GROUND = sw.Terrain(np.random.default_rng(1).uniform(0, 0.1, (9, 9)), 0.1, (-0.4, -0.4))
ARM = sw.RockerBogie.preset("rocky7")
JOINTS = 0.1 * TWISTS
OTHERS = {
    "commands": lambda **how: tuple(ROVER.commands(TWISTS, **how).values()),
    "height": lambda **how: GROUND.height_at(POINTS, **how),
    "gradient": lambda **how: GROUND.gradient_at(POINTS, method="bicubic", **how),
    "normal": lambda **how: GROUND.normal_at(POINTS, **how),
    "contains": lambda **how: GROUND.contains(2 * POINTS, **how),
    "icr_offset": lambda **how: ARM.icr_offset(JOINTS, **how),
    "frames": lambda **how: tuple(ARM.frames(JOINTS, **how).values()),
    "jacobians": lambda **how: tuple(ARM.jacobians(JOINTS, **how).values()),
    "steer": lambda **how: _of(
        ARM.steer(TWISTS[:, 0], 0.1, JOINTS, **how), ("steering", "wheel_speeds", "turning_radius", "scrub")
    ),
    "admissible": lambda **how: ROVER.admissible(TWISTS, **how),
    "project strictly": lambda **how: ROVER.project(TWISTS, "yaw_rate", out=np.empty_like(TWISTS), **how),
    "fit": lambda **how: _of(ROVER.fit(STEERING, SPEEDS, **how), ("twist", "residuals", "weights", "rank")),
    "robust": lambda **how: _of(
        ROVER.fit(STEERING, SPEEDS, method="robust", **how), ("twist", "residuals", "weights")
    ),
    "sensitivity": lambda **how: _of(
        ROVER.sensitivity(STEERING, SPEEDS, **how), ("twist", "wheel_speeds", "steering", "x")
    ),
}


def _of(result, names):
    return tuple(getattr(result, name) for name in names)


def _arrays(result):
    return list(result) if isinstance(result, tuple) else [result]


@pytest.mark.parametrize("call", {**BATCHES, **OTHERS})
def test_threads_change_no_bit(call):
    run = {**BATCHES, **OTHERS}[call]
    for one, many in zip(_arrays(run(threads=1)), _arrays(run(threads=3)), strict=True):
        assert_array_equal(one, many)
    with pytest.raises(ValueError, match="threads must be at least 1, got 0"):
        run(threads=0)


def _calls():
    """Whatever can be called, by name."""
    for name in sw.__all__:
        thing = getattr(sw, name)
        members = inspect.getmembers(thing, callable) if inspect.isclass(thing) else [("", thing)]
        for member, call in members:
            if callable(call) and not member.startswith("_"):
                yield f"{name}.{member}", call


def test_every_call_that_takes_rows_of_any_shape_takes_threads():
    """Calls whose docstring says ``shape (...`` of an argument, which work row by row."""
    pytest.importorskip("scipy", reason="calibrate cannot be looked at without SciPy")
    taken = {}
    for name, call in _calls():
        arguments, found, _ = (inspect.getdoc(call) or "").partition("\nReturns\n")
        if found and "shape (..." in arguments:
            taken[name] = "threads" in inspect.signature(call).parameters
    assert {"Rover.inverse", "Suspension.slip", "Terrain.height_at"} < taken.keys()
    assert [name for name, threads in taken.items() if not threads] == []


def test_every_call_that_gives_arrays_as_they_are_has_out_and_dtype():
    """Calls whose docstring says ``ndarray, shape (...`` of their result."""
    pytest.importorskip("scipy", reason="calibrate cannot be looked at without SciPy")
    lacking, found = [], set()
    for name, call in _calls():
        result = (inspect.getdoc(call) or "").partition("\nReturns\n-------\n")[2].partition("\n")[0]
        if re.match(r"(float or |\w+(, \w+)* : )?ndarray, shape \(\.\.\.", result):
            found.add(name.rstrip("."))
            lacking += [name] if not {"out", "dtype"} <= set(inspect.signature(call).parameters) else []
    assert {"Rover.inverse", "FourAxle.inverse", "Terrain.height_at", "exp", "wrap_angle"} <= found
    assert lacking == []


@pytest.mark.parametrize("call", BATCHES)
def test_single_precision_is_the_double_one_rounded(call):
    for wide, narrow in zip(_arrays(BATCHES[call]()), _arrays(BATCHES[call](dtype=np.float32)), strict=True):
        assert narrow.dtype == np.float32
        assert_array_equal(narrow, wide.astype(np.float32))
    given = BATCHES[call](dtype="float32")
    into = BATCHES[call](out=tuple(_arrays(given)) if isinstance(given, tuple) else given)
    for one, other in zip(_arrays(given), _arrays(into), strict=True):
        assert one is other


def test_float32_goes_in_as_well():
    narrow = TWISTS.astype(np.float32)
    steering, speeds = ROVER.inverse(narrow, dtype=narrow.dtype)
    assert steering.dtype == speeds.dtype == np.float32
    assert_array_equal(speeds, ROVER.inverse(narrow.astype(np.float64))[1].astype(np.float32))


def test_one_array_of_each_precision():
    out = np.empty((ROWS, 4), np.float32), np.empty((ROWS, 6))
    ROVER.inverse(TWISTS, out=out)
    assert_array_equal(out[0], STEERING.astype(np.float32))
    assert_array_equal(out[1], SPEEDS)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ROVER.inverse(TWISTS, dtype=int), "dtype must be float64 or float32, got int64"),
        (lambda: ROVER.inverse(TWISTS, dtype="no such"), "dtype must be float64 or float32, got 'no such'"),
        (lambda: ROVER.inverse(TWISTS, dtype=">f4"), "dtype must be float64 or float32, got >f4"),
        (
            lambda: ROVER.project(TWISTS, dtype="f4", out=np.empty_like(TWISTS)),
            "dtype must be left out with out, which has its own, got float32",
        ),
    ],
)
def test_bad_precisions(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_an_axle_that_leaves_its_range_at_the_last_row_leaves_the_others_unwritten():
    tight, out = sw.FourAxle((0.4, 0.3), 0.2, 0.1, steering_limit=0.3), np.full((3, 4), 7.0)
    with pytest.raises(sw.InfeasibleMotionError, match=r"icr\[2\]"):
        tight.concurrent_angles([(0.0, 5.0), (0.0, 6.0), (0.0, 0.1)], out=out)
    assert (out == 7.0).all()


def test_a_failed_call_writes_nothing_in_single_precision_either():
    out = np.full((ROWS, 3), 7.0, np.float32)
    with pytest.raises(ValueError, match="twist"):
        ROVER.project(np.where(np.arange(ROWS)[:, None] == ROWS - 1, math.nan, TWISTS), out=out)
    assert (out == 7.0).all()


ODD = {
    "degrees for a limit": (
        lambda: sw.Rover.six_wheel(**SIX_SIZES, steering_limit=40),
        "steering_limit of 40 rad is 6.366 turns; 40 degrees are 0.6981 radians",
    ),
    "degrees for angles": (
        lambda: ROVER.forward([40, 30, -40, -30], [1.0] * 6),
        'wheel "front_left" is 40 rad, 6.175 turns beyond its range; 40 degrees are 0.6981 radians',
    ),
    "degrees all through a log": (
        lambda: ROVER.fit(np.full((1000, 4), 30.0), np.ones((1000, 6))),
        "30 degrees are 0.5236 radians",
    ),
    "degrees for headings": (
        lambda: sw.Rover.omni([(0.2, 0.0), (-0.1, 0.17), (-0.1, -0.17)], [90.0, 210.0, 330.0], 0.05),
        'heading of wheel "wheel_0" is 90 rad, 14.32 turns; 90 degrees are 1.571 radians',
    ),
    "degrees for rollers": (
        lambda: sw.Rover.mecanum(0.6, 0.6, 0.1, roller_angle=45),
        'roller_angle of wheel "front_left" is -45 rad, -7.162 turns; -45 degrees are -0.7854 radians',
    ),
    "exchanged": (lambda: sw.Rover.differential(0.1, 0.5), "two lengths may have changed places"),
    "exchanged, too": (lambda: sw.Rover.bicycle(0.16, 1.0), "two lengths may have changed places"),
    "centimetres": (lambda: sw.Rover.differential(50, 10), "in centimetres they would be 0.1 m and 0.25 m"),
    "millimetres": (lambda: sw.Rover.differential(500, 100), "in millimetres they would be 0.1 m and 0.25 m"),
    "centimetres of wheels": (
        lambda: sw.Rover([sw.Wheel("a", 50, 40, radius=15), sw.Wheel("b", 50, -40, radius=15)]),
        "in centimetres they would be 0.15 m and 0.5 m",
    ),
}


@pytest.mark.parametrize("case", ODD)
def test_units_that_cannot_be_meant_are_asked_about(case):
    call, words = ODD[case]
    with pytest.warns(SuspiciousUnitsWarning) as caught:
        call()
    assert words in str(caught[0].message)
    assert caught[0].filename == __file__


def test_nothing_is_asked_about_what_can_be_meant():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in sw.Rover.presets():
            sw.Rover.preset(name)
        turns = sw.Rover.swerve([(0.3, 0.2), (-0.3, -0.2)], 0.1, steering_limit=math.radians(500))
        turns.forward([8.0, -8.0], [1.0, 1.0])
        ROVER.forward([1.2 + math.pi] * 4, [1.0] * 6)


WRONG = {
    "three numbers": (
        lambda: ROVER.inverse(0.2, 0, 0.1),
        r"as in inverse\(\(vx, vy, omega\)\), got 3 arguments",
    ),
    "three to project": (lambda: ROVER.project(0.2, 0, 0.1), r"as in project\(\(vx, .*, got 3 arguments"),
    "three to commands": (lambda: ROVER.commands(0.2, 0, 0.1), "as in commands"),
    "three to icr": (lambda: ROVER.icr(0.2, 0, 0.1), "as in icr"),
    "three to admissible": (lambda: ROVER.admissible(0.2, 0, 0.1), "as in admissible"),
    "None": (lambda: ROVER.inverse(None), "twist must be real numbers, got None"),
    "a dict": (lambda: ROVER.forward({"a": 1.0}, [1.0] * 6), "steering must be real numbers, got a dict"),
    "None among speeds": (
        lambda: ROVER.forward([0.0] * 4, [1.0, 1.0, None, 1.0, 1.0, 1.0]),
        r"speeds must be real numbers, got None at \[2\]",
    ),
    "None in a table": (
        lambda: ROVER.forward(np.zeros((2, 4)), np.array([[1.0] * 6, [1.0, None, *[1.0] * 4]], object)),
        r"speeds must be real numbers, got None at \[1, 1\]",
    ),
    "three to command": (
        lambda: sw.Controller(ROVER).command(0.2, 0.0, 0.1, 0.0),
        r"Controller.command\(\) takes one twist, as in command\(\(vx, vy, omega\), stamp\), got 4",
    ),
    "a number for wheels": (lambda: sw.Rover(5), "wheels must be a sequence of Wheel, got 5"),
    "no wheels": (lambda: sw.Rover(None), "wheels must be a sequence of Wheel, got None"),
    "no wheel": (lambda: sw.Rover([1]), r"wheels must be a sequence of Wheel, got 1 at \[0\]"),
    "keep": (lambda: ROVER.project((0.2, 0.0, 0.1), 3), "keep must be"),
    "mode": (
        lambda: sw.Controller(ROVER).command((0.2, 0.0, 0.1), 0.0, 3),
        "mode must be",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_calls_say_what_would_be_right(case):
    call, message = WRONG[case]
    with pytest.raises((TypeError, ValueError), match=message):
        call()


def test_angles_in_messages_have_four_digits_and_degrees():
    with pytest.raises(
        sw.InfeasibleMotionError, match=r"at -1.2 rad \(-68.8°\) it would slide at 0.08275 m/s"
    ):
        ROVER.inverse((0.5, 0.0, 2.0))
