"""Arguments: masks are refused, an argument's own errors come through, shapes go together."""

import subprocess
import sys
import textwrap
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.rovers import SWERVE

ROVER = sw.Rover.preset("perseverance")
TWISTS = np.random.default_rng(1).normal(size=(5, 3)) * [1.0, 0.0, 0.3]
STEERING, SPEEDS = ROVER.inverse(TWISTS)
ROCKY, ARM = sw.RockerBogie.preset("rocky7"), sw.RockerBogie.preset("perseverance")
LEVEL = sw.Terrain(np.zeros((100, 100)), 0.1)
STAND = ARM.settle(LEVEL, (5.0, 5.0, 0.0))


# Masks


MASKED = {
    "masked": lambda a: np.ma.masked_greater(a, 1e8),
    "without a masked value": np.ma.array,
    "in a list": lambda a: [np.ma.array(row) for row in a],
    "in a tuple of lists": lambda a: ([np.ma.masked, *a[0, 1:]], *a[1:]),
}

FIRST_CALLS = [
    "sw.exp((1.0, 0.0, 0.0))",
    "sw.integrate([(1.0, 0.0, 0.0)], 0.1)",
    "sw.Rover.preset('perseverance')",
    "sw.Odometry3(sw.RockerBogie.preset('rocky7')).state.pose",
    "sw.FourAxle((0.3, 0.0), 0.2, 0.1)",
    "sw.Terrain([(0.0, 1.0), (0.0, 1.0)], 0.1)",
]


@pytest.mark.parametrize("mask", MASKED.values(), ids=MASKED.keys())
@pytest.mark.parametrize(
    ("argument", "call"),
    [
        ("twist", lambda rows: ROVER.inverse(rows)),
        ("twists", lambda rows: sw.integrate(rows, 0.1)),
        ("twist", lambda rows: ROVER.project(rows)),
        ("twist", lambda rows: sw.exp(rows)),
        ("poses", lambda rows: sw.differentiate(rows, 0.1)),
        ("start", lambda rows: sw.integrate(TWISTS, 0.1, rows)),
        ("poses", lambda rows: ARM.settle(LEVEL, rows)),
        ("poses", lambda rows: ARM.bounds(LEVEL, rows)),
    ],
)
def test_a_masked_array_is_refused_by_name(mask, argument, call):
    rows = TWISTS.copy()
    rows[2, 0] = 1e9
    with pytest.raises(sw.ArgumentTypeError, match=f"^{argument} must be without a mask, got a masked array"):
        call(mask(rows))


def test_masked_heights_are_unknown_where_they_are_masked():
    for kind in (np.float64, np.float32):
        heights = np.ma.masked_greater(np.array([[0, 1, 2], [3, 4, 9]], kind), 5)
        expected = np.where(heights.mask, np.nan, heights.data)
        np.testing.assert_array_equal(sw.Terrain(heights, 0.1).heights, expected)
    rows = np.zeros((3, 3))
    for mask in ("in a list", "in a tuple of lists"):
        with pytest.raises(sw.ArgumentTypeError, match="^heights must be without a mask"):
            sw.Terrain(MASKED[mask](rows), 0.1)


def test_masked_numbers_and_logs_are_refused_by_name():
    stamps = np.ma.masked_less(np.arange(5.0), -1)
    with pytest.raises(ValueError, match="^stamps must be without a mask"):
        sw.Odometry(ROVER).run(STEERING, SPEEDS, stamps)
    with pytest.raises(ValueError, match="^stamp must be without a mask"):
        sw.Odometry(ROVER).update(STEERING[0], SPEEDS[0], np.ma.masked)
    with pytest.raises(ValueError, match="must be without a mask"):
        sw.dead_reckon(ROVER, STEERING, np.ma.array(SPEEDS), np.arange(5.0))
    with pytest.raises(ValueError, match="^twist must be without a mask"):
        sw.Controller(ROVER).command(np.ma.array([1.0, 0.0, 0.0]), 0.0)
    with pytest.raises(ValueError, match="^track_width must be without a mask"):
        sw.Rover.differential(np.ma.array(0.4), 0.15)


# Errors that an argument's own code raises


class Raises:
    """Raises whatever way it is looked at."""

    def __init__(self, error: BaseException) -> None:
        self.error = error

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        raise self.error

    def __float__(self) -> float:
        raise self.error


ERRORS = [
    KeyboardInterrupt(),
    MemoryError("no room on the card"),
    RuntimeError("use .cpu() first"),
    ValueError("this argument has its own rules"),
    TypeError("can't convert a tensor on another device"),
    SystemExit(3),
]

CALLS = {
    "inverse": lambda a: ROVER.inverse(a),
    "inverse, previous": lambda a: ROVER.inverse(TWISTS, previous=a),
    "inverse, centre": lambda a: ROVER.inverse(TWISTS, centre=a),
    "forward": lambda a: ROVER.forward(a, SPEEDS),
    "integrate": lambda a: sw.integrate(a, 0.1),
    "integrate, dt": lambda a: sw.integrate(TWISTS, a),
    "exp": lambda a: sw.exp(a),
    "wrap_angle": lambda a: sw.wrap_angle(a),
    "dead_reckon": lambda a: sw.dead_reckon(ROVER, STEERING, SPEEDS, a),
    "Odometry.update": lambda a: sw.Odometry(ROVER).update(STEERING[0], a, 0.0),
    "Odometry.update, stamp": lambda a: sw.Odometry(ROVER).update(STEERING[0], SPEEDS[0], a),
    "Controller.step": lambda a: sw.Controller(ROVER).step(a),
    "Wheel": lambda a: sw.Wheel("w", a, 0.0, radius=0.1),
    "Limits": lambda a: sw.Limits(speed=a),
    "Noise": lambda a: sw.Noise(a),
    "Terrain": lambda a: sw.Terrain(a, 0.1),
    "Terrain, spacing": lambda a: sw.Terrain(np.zeros((3, 3)), a),
    "height": lambda a: LEVEL.height_at(a),
    "settle": lambda a: ARM.settle(LEVEL, a),
    "settle, steering": lambda a: ARM.settle(LEVEL, (5.0, 5.0, 0.0), a),
    "bounds, yaw_margin": lambda a: ARM.bounds(LEVEL, (5.0, 5.0, 0.0), a),
    "inverse on the ground": lambda a: ARM.inverse(STAND, a),
    "forward on the ground": lambda a: ARM.forward(STAND, None, a),
    "traction": lambda a: ARM.traction(0.1, 0.1, a, [0.0] * 3, [0.0] * 3),
    "Preintegrated.add": lambda a: sw.Preintegrated(ROVER).add(STEERING, a, np.arange(5.0)),
}


@pytest.mark.parametrize("error", ERRORS, ids=[type(error).__name__ for error in ERRORS])
@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS.keys())
def test_what_an_argument_raises_comes_through(call, error):
    with pytest.raises(type(error)) as caught:
        call(Raises(error))
    assert caught.value is error


@pytest.mark.parametrize("first", FIRST_CALLS)
def test_what_loading_numpy_raises_comes_through(first):
    """A Ctrl-C in the very first call, which loads NumPy, was a PanicException; the next call works."""
    program = f"""
        import sys
        import six_wheel as sw

        class Interrupts:
            def find_spec(self, name, *_):
                if name.partition(".")[0] == "numpy":
                    sys.meta_path.remove(self)
                    raise KeyboardInterrupt(name)

        sys.meta_path.insert(0, Interrupts())
        try:
            {first}
        except KeyboardInterrupt as error:
            print(error)
        {first}
        print(sw.exp((1.0, 0.0, 0.0)))
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(program)], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("numpy\n[1. 0. 0.]\n", "")


def test_what_an_argument_in_a_list_raises_comes_through():
    error = RuntimeError("use .cpu() first")
    with pytest.raises(RuntimeError) as caught:
        ROVER.inverse([Raises(error), Raises(error)])
    assert caught.value is error


# Shapes


def test_compose_and_exp_and_log():
    poses, pose = np.random.default_rng(2).normal(size=(4, 5, 3)), np.array([1.0, -2.0, 0.3])
    times = np.linspace(0.1, 2.0, 5)

    def each(call: Any, *rows: np.ndarray) -> np.ndarray:
        return np.array([[call(*(r[i][k] for r in rows)) for k in range(5)] for i in range(4)])

    wide = np.broadcast_to(pose, poses.shape)
    np.testing.assert_array_equal(sw.compose(pose, poses), each(sw.compose, wide, poses))
    np.testing.assert_array_equal(sw.compose(poses, pose), each(sw.compose, poses, wide))
    np.testing.assert_array_equal(
        sw.compose(poses[:, :1], poses[0]),
        sw.compose(np.repeat(poses[:, :1], 5, axis=1), np.tile(poses[:1], (4, 1, 1))),
    )
    np.testing.assert_array_equal(sw.exp(pose, times), [sw.exp(pose, dt) for dt in times])
    np.testing.assert_array_equal(sw.log(poses, times), each(sw.log, poses, np.tile(times, (4, 1))))
    assert sw.exp(pose, np.ones((2, 1, 3))).shape == (2, 1, 3, 3)
    with pytest.raises(ValueError, match=r"^second must have shape \(4, 5, 3\), got shape \(2, 3\)"):
        sw.compose(poses, np.zeros((2, 3)))


@pytest.mark.parametrize("rows", [5, 40_000])
def test_inverse(rows):
    twists = np.resize(TWISTS, (rows, 3))
    previous, rolling = np.array([0.1, 0.2, -0.1, 0.3]), np.linspace(-1, 1, 6)
    wide = {"previous": np.tile(previous, (rows, 1)), "previous_wheel_speeds": np.tile(rolling, (rows, 1))}
    wanted = ROVER.inverse(twists, **wide)
    for given in (
        {"previous": previous, "previous_wheel_speeds": rolling},
        {"previous": previous.tolist(), "previous_wheel_speeds": rolling[None]},
    ):
        for one, other in zip(ROVER.inverse(twists, **given), wanted, strict=True):
            np.testing.assert_array_equal(one, other)
    one = ROVER.inverse(twists[0], previous=wide["previous"])
    assert one[0].shape == (rows, 4)
    np.testing.assert_array_equal(one[1], np.tile(ROVER.inverse(twists[0], previous=previous)[1], (rows, 1)))
    centred = SWERVE.inverse((0.3, 0.1, 0.2), centre=np.full((rows, 2), 0.1))
    np.testing.assert_array_equal(centred[0][-1], SWERVE.inverse((0.3, 0.1, 0.2), centre=(0.1, 0.1))[0])
    np.testing.assert_array_equal(ROVER.inverse(twists, centre=(0.0, 0.0))[0], ROVER.inverse(twists)[0])


@pytest.mark.parametrize("rows", [5, 40_000])
def test_forward_and_fit_and_sensitivity(rows):
    speeds = np.resize(SPEEDS, (rows, 6))
    wide = np.tile(STEERING[0], (rows, 1))
    np.testing.assert_array_equal(ROVER.forward(STEERING[0], speeds), ROVER.forward(wide, speeds))
    found = ROVER.forward(np.resize(STEERING, (rows, 4)), SPEEDS[0])[:5]
    # Batches of other lengths may end in other kernels, which agree to rounding.
    np.testing.assert_allclose(found, ROVER.forward(STEERING, np.tile(SPEEDS[0], (5, 1))), rtol=0, atol=1e-14)
    few = speeds[:7]
    fit, wanted = ROVER.fit(STEERING[0], few), ROVER.fit(wide[:7], few[: len(few)])
    np.testing.assert_array_equal(fit.residuals, wanted.residuals)
    assert fit.worst_wheel == wanted.worst_wheel
    np.testing.assert_array_equal(
        ROVER.sensitivity(STEERING[0], few).steering, ROVER.sensitivity(wide[: len(few)], few).steering
    )


def test_integrate_and_rollouts():
    twists, starts = TWISTS, np.random.default_rng(3).normal(size=(4, 3))
    each = np.array([sw.integrate(twists, 0.1, start) for start in starts])
    # Eight logs and more go side by side: another kernel, which agrees to rounding.
    for found, expected in [
        (sw.integrate(twists, 0.1, starts), each),
        (sw.integrate(np.tile(twists, (2, 1, 1, 1)), 0.1, starts), np.tile(each, (2, 1, 1, 1))),
        (sw.integrate(twists, [0.1]), sw.integrate(twists, 0.1)),
        (sw.rollout(twists[None], 0.1, starts), each),
    ]:
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)
    with pytest.raises(ValueError, match="^start must be one pose or have leading axes"):
        sw.integrate(np.tile(twists, (4, 1, 1)), 0.1, starts[:3])


def test_suspension():
    joints = np.random.default_rng(4).normal(size=(4, 3)) * 0.1
    np.testing.assert_array_equal(ROCKY.frames(joints)["A1"][2], ROCKY.frames(joints[2])["A1"])
    np.testing.assert_array_equal(ROCKY.icr_offset(joints[:, None])[1], ROCKY.icr_offset(joints[1:2]))
    command = ROCKY.steer(0.3, [0.0, 0.1], (0.05, 0.1, 0.05), previous=[0.0] * 2)
    assert command.wheel_speeds.shape == (2, 6)
