"""`out=` of calls on the ground: the numbers of fresh arrays, in the caller's; nothing if a call fails."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.core.ground.grounds import hills

COUNT = 37
ARM = sw.RockerBogie.preset("perseverance")
GROUND = sw.Terrain(hills(), 0.1)
RNG = np.random.default_rng(1)
POSES = RNG.uniform([4, 4, -3], [16, 16, 3], (COUNT, 3))
STAND = ARM.settle(GROUND, POSES)
COMMANDS = np.column_stack([np.full(COUNT, 0.05), RNG.uniform(-0.02, 0.02, COUNT)])
TOLD = ARM.inverse(STAND, COMMANDS)
RATES = RNG.uniform(-0.1, 0.1, (COUNT, 3))
DRIVE = (COMMANDS[:, 0], 0.1, np.zeros((COUNT, 3)), STAND.joints, RATES)
MOTION = ARM.forward(STAND, None, TOLD.wheel_speeds)
XY = POSES[:, :2]

# A call, what of its result is written, and with which widths.
CALLS: dict[str, tuple[Callable[..., Any], dict[str, tuple[int, ...]]]] = {
    "inverse": (
        lambda **how: ARM.inverse(STAND, COMMANDS, **how),
        {"steering": (4,), "wheel_speeds": (6,), "twist": (6,), "joint_rates": (3,), "scale": ()},
    ),
    "forward": (
        lambda **how: ARM.forward(STAND, None, TOLD.wheel_speeds, **how),
        {"twist": (6,), "joint_rates": (3,), "residuals": (6, 3)},
    ),
    "traction": (
        lambda **how: ARM.traction(*DRIVE, **how),
        {"wheel_speeds": (6,), "steering": (4,), "contact_angles": (6,)},
    ),
    "slip": (
        lambda **how: ARM.slip(STAND, TOLD.wheel_speeds, MOTION.twist, MOTION.joint_rates, **how),
        {"ratio": (6,), "angle": (6,)},
    ),
    "bounds": (
        lambda **how: ARM.bounds(GROUND, POSES, **how),
        dict.fromkeys(("z", "roll", "pitch", "tilt", "clearance", "rocker"), (2,))
        | {"bogies": (2, 2), "wheel_drop": (2,)},
    ),
    "feasible": (
        lambda **how: ARM.feasible(GROUND, POSES, **how),
        {"margin": (), "tilt": (), "clearance": ()},
    ),
    "stability": (
        lambda **how: ARM.stability(STAND, mass=1025.0, **how),
        {"loads": (6,), "tip_over_angle": (), "clearance": (), "joint_margins": (3,), "tilt": ()},
    ),
    "height": (lambda **how: SimpleNamespace(all=GROUND.height_at(XY, **how)), {"all": ()}),
    "gradient": (lambda **how: SimpleNamespace(all=GROUND.gradient_at(XY, **how)), {"all": (2,)}),
    "normal": (lambda **how: SimpleNamespace(all=GROUND.normal_at(XY, **how)), {"all": (3,)}),
}


def rooms(widths: dict[str, tuple[int, ...]]) -> tuple[np.ndarray, ...]:
    return tuple(np.full((COUNT, *width), 7.0) for width in widths.values())


@pytest.mark.parametrize("name", CALLS)
def test_out_is_written_and_returned(name: str) -> None:
    """Contiguous, or any view of float64; as many results as there are arrays."""
    call, widths = CALLS[name]
    fresh = call()
    for view in (False, True):
        outs = rooms(widths)
        if view:
            outs = tuple(np.repeat(out, 2, axis=0)[::2] for out in outs)
        alone = "all" in widths
        result = call(out=outs[0] if alone else outs)
        for key, out in zip(widths, outs, strict=True):
            assert getattr(result, key) is out
            np.testing.assert_array_equal(out, getattr(fresh, key))
        single = tuple(out.astype(np.float32) for out in rooms(widths))
        result = call(out=single[0] if alone else single)
        for key, out in zip(widths, single, strict=True):
            np.testing.assert_array_equal(out, np.asarray(getattr(fresh, key), np.float32))
        if not alone:
            first, *rest = rooms(widths)
            result = call(out=(first, *[None] * len(rest)))
            assert getattr(result, next(iter(widths))) is first
            result = call(out=(first,))
            for key in list(widths)[1:]:
                np.testing.assert_array_equal(getattr(result, key), getattr(fresh, key))


@pytest.mark.parametrize("name", CALLS)
def test_bad_outputs_are_refused_and_nothing_is_written(name: str) -> None:
    call, widths = CALLS[name]
    outs, alone = rooms(widths), "all" in widths
    lone = "out" if alone else r"out\[0\]"

    def refused(bad: Any, *rest: Any, says: str) -> None:
        with pytest.raises(ValueError, match=says):
            call(out=bad if alone else (bad, *rest))
        for out in outs:
            assert (out == 7.0).all()

    refused(outs[0][1:], says=rf"^{lone} must be a writeable float64 array of shape \(37")
    refused(outs[0].astype(np.float16), says=rf"^{lone} must be .* got an array of dtype float16")
    refused(outs[0].tolist(), says=rf"^{lone} must be")
    fixed = outs[0].view()
    fixed.flags.writeable = False
    refused(fixed, says=rf"^{lone} must be .* got a read-only array")
    if not alone:
        for bad in ((), outs + outs):
            with pytest.raises(ValueError, match="^out must be arrays for"):
                call(out=bad)
        if name != "forward":  # whose twist is what is asked for
            with pytest.raises(
                ValueError, match=rf"^out must be a tuple of arrays for \({next(iter(widths))}, .* ndarray$"
            ):
                call(out=outs[0])
            assert (outs[0] == 7.0).all()
        second = list(widths.values())[1]
        refused(outs[0], np.empty((COUNT + 1, *second)), says=r"^out\[1\] must be")
        both = np.full(COUNT * 40, 7.0)
        first = both[: outs[0].size].reshape(outs[0].shape)
        last = both[1 : 1 + outs[1].size].reshape(outs[1].shape)
        refused(first, last, says=r"^out\[0\] must not overlap out\[1\]")
        assert (both == 7.0).all()


def test_what_is_read_is_not_written() -> None:
    speeds = np.array(TOLD.wheel_speeds)
    with pytest.raises(ValueError, match="^out must not overlap the input"):
        ARM.forward(STAND, None, speeds, out=speeds)
    with pytest.raises(ValueError, match=r"^out\[1\] must not overlap the input"):
        ARM.slip(STAND, speeds, MOTION.twist, MOTION.joint_rates, out=(None, speeds))
    rates = np.zeros((COUNT, 6))
    with pytest.raises(ValueError, match=r"^out\[0\] must not overlap the input"):
        ARM.traction(*DRIVE[:4], rates[:, ::2], out=(rates,))
    plane = np.zeros((COUNT, 4))
    with pytest.raises(ValueError, match="^out must not overlap the input"):
        GROUND.gradient_at(plane[:, :2], out=plane[:, 1:3])
    poses, margins = np.array(POSES), np.zeros((COUNT, 2))
    with pytest.raises(ValueError, match=r"^out\[1\] must not overlap the input"):
        ARM.bounds(GROUND, poses, out=(None, poses[:, 1:]))
    with pytest.raises(ValueError, match=r"^out\[0\] must not overlap the input"):
        ARM.bounds(GROUND, poses, margins[:, 0], out=(margins,))
    with pytest.raises(ValueError, match=r"^out\[2\] must not overlap the input"):
        ARM.feasible(GROUND, poses, out=(None, None, poses[:, 2]))
    np.testing.assert_array_equal(poses, POSES)
    np.testing.assert_array_equal(speeds, TOLD.wheel_speeds)


@pytest.mark.parametrize("kernel", sw.simd_levels())
def test_a_motion_that_is_refused_writes_nothing(kernel: str) -> None:
    """Even if the row that fails is the last one."""
    commands = np.array(COMMANDS)
    dimensions = dict(ARM.dimensions)
    arm = sw.RockerBogie(**dimensions | {"steering_limit": 0.6})
    commands[:, 1] = 0
    commands[-1] = 0.0, 0.5
    calls: list[tuple[Callable[..., Any], dict[str, tuple[int, ...]]]] = [
        (lambda **how: arm.inverse(arm.settle(GROUND, POSES), commands, **how), CALLS["inverse"][1]),
        (
            lambda **how: arm.traction(commands[:, 0], None, *DRIVE[2:], yaw_rate=commands[:, 1], **how),
            CALLS["traction"][1],
        ),
    ]
    for call, widths in calls:
        outs = rooms(widths)
        with pytest.raises(sw.InfeasibleMotionError, match=r"command\[36\]"):
            call(out=outs, level=kernel)
        for out in outs:
            assert (out == 7.0).all()


def test_one_pose() -> None:
    """A single call writes rows without leading axes, and its one number into an array of none."""
    stand = ARM.settle(GROUND, POSES[0])
    outs = (np.empty(4), np.empty(6), np.empty(6), np.empty(3), np.empty(()))
    told = ARM.inverse(stand, COMMANDS[0], out=outs)
    assert told.scale is outs[-1]
    plain = ARM.inverse(stand, tuple(COMMANDS[0]))
    assert isinstance(plain.scale, float)
    for key, out in zip(CALLS["inverse"][1], outs, strict=True):
        np.testing.assert_array_equal(getattr(plain, key), out)
    steering, speeds = plain
    np.testing.assert_array_equal(steering, outs[0])
    np.testing.assert_array_equal(plain[-1], speeds)
    assert len(plain) == 2
    assert repr(plain).startswith("GroundCommand(steering=[")
    outs = (np.empty(()), np.empty(()), np.empty(()))
    safe = ARM.feasible(GROUND, POSES[0], out=outs)
    assert safe.clearance is outs[2]
    assert ARM.feasible(GROUND, POSES[0]).clearance == outs[2]
    assert isinstance(ARM.feasible(GROUND, POSES[0], out=outs[:2]).clearance, float)
    tipping = np.empty(())
    assert ARM.stability(stand, mass=1.0, out=(None, tipping)).tip_over_angle is tipping
    assert isinstance(ARM.stability(stand, mass=1.0).tip_over_angle, float)
    pitch = np.empty(2)
    assert ARM.bounds(GROUND, POSES[0], out=(None, None, pitch)).pitch is pitch
    twist = np.empty(6)
    assert ARM.forward(stand, None, speeds, out=twist).twist is twist


@pytest.mark.parametrize("kernel", sw.simd_levels())
def test_rows_that_are_not_known_are_nan_in_the_given_arrays_too(kernel: str) -> None:
    """Whatever they held: poses off the map, and rows in any order among others."""
    poses = np.array(POSES)
    poses[::3, 0] = -50.0
    fresh = ARM.bounds(GROUND, poses, level=kernel)
    widths = CALLS["bounds"][1]
    ARM.bounds(GROUND, poses, level=kernel, out=(outs := rooms(widths)))
    for name, out in zip(widths, outs, strict=True):
        assert np.isnan(out[::3]).all()
        np.testing.assert_array_equal(out, getattr(fresh, name))
    widths = CALLS["stability"][1]
    ARM.stability(ARM.settle(GROUND, poses), mass=1025.0, out=(outs := rooms(widths)))
    for out in outs:
        assert np.isnan(out[::3]).all()
    ARM.feasible(GROUND, poses, out=(outs := rooms(CALLS["feasible"][1])))
    for out in outs:
        assert np.isnan(out[::3]).all()
    plain = ARM.bounds(GROUND, poses, level="scalar")
    np.testing.assert_array_equal(fresh.bogies, plain.bogies)
