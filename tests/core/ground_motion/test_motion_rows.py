"""Motion on the ground at every level: the same bits, row by row, whatever a row holds."""

import math
import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.core.ground.grounds import rocks, scaled

COUNT = 203  # no multiple of any register
LEVELS = sw.simd_levels()[1:]


def vehicles() -> dict[str, sw.Suspension]:
    """Bogies behind and in front, a bar, joints with stops, and chains that are no rocker-bogies."""
    perseverance = dict(sw.RockerBogie.preset("perseverance").dimensions)
    return {
        "rocky7": sw.RockerBogie(
            **dict(sw.RockerBogie.preset("rocky7").dimensions) | {"steering_limit": math.pi}
        ),
        "perseverance": sw.RockerBogie(**perseverance | {"steering_limit": math.pi}),
        "bar": sw.RockerBogie(
            **perseverance
            | {"differential_bar": (0.6, 0.2, 0.3), "steered": "all", "steering_limit": math.pi}
        ),
        "in front": sw.RockerBogie.preset("open_source_rover"),
        "stops": sw.RockerBogie(
            **perseverance
            | {"rocker_limit": (-0.05, 0.05), "bogie_limit": (-0.1, 0.1), "steering_limit": math.pi}
        ),
        "axles": sw.Suspension.pivoting_axles(
            wheelbase=1.91, track_width=1.64, drop=0.119, wheel_radius=0.325, steering_limit=math.pi
        ),
        "bogies": sw.Suspension.triple_bogie(
            bogie_pivot=(0.13, 0.3, 0.1),
            bogie_to_front=(0.13, 0, -0.1),
            bogie_to_middle=(-0.13, 0, -0.1),
            rear_pivot=(-0.26, 0, 0.1),
            rear_to_wheel=(0, 0.3, -0.1),
            wheel_radius=0.07,
            steered="all",
            steering_limit=math.pi,
        ),
        "rigid": sw.Suspension.rigid(
            [(0.5, 0.4, 0.1), (0.5, -0.4, 0.1), (-0.5, 0.4, 0.1), (-0.5, -0.4, 0.1)],
            0.1,
            steered=(0, 1),
            steering_limit=math.pi,
        ),
    }


VEHICLES = vehicles()


def widths(arm: sw.Suspension) -> tuple[int, int, int]:
    """Wheels, free angles, steering joints."""
    still = arm.traction(0, 0, (0, 0, 0), [0.0] * len(arm.free_joints), [0.0] * len(arm.free_joints))
    return still.wheel_speeds.size, len(arm.free_joints), still.steering.size


def told(arm: sw.Suspension, seed: int, count: int = COUNT) -> Any:
    """Random stands with the face of settled ones; wheels in the air, rows of nothing."""
    rng, (wheels, joints, steered) = np.random.default_rng(seed), widths(arm)
    roll, pitch, yaw = rng.uniform([-0.2, -0.2, -3], [0.2, 0.2, 3], (count, 3)).T
    transform = np.zeros((count, 4, 4))
    transform[:, 0, 0], transform[:, 1, 0] = np.cos(yaw), np.sin(yaw)
    normals = rng.uniform([-0.3, -0.3, 1], [0.3, 0.3, 1], (count, wheels, 3))
    gap = np.zeros((count, wheels))
    gap[5::17, 0] = 0.1
    gap[9::31, 1] = 0.2
    gap[11:12] = math.nan
    gap[12:13] = 0.3
    return SimpleNamespace(
        roll=roll,
        pitch=pitch,
        transform=transform,
        joints=rng.uniform(-0.3, 0.3, (count, joints)),
        steering=rng.uniform(-0.5, 0.5, (count, steered)),
        contact_angles=rng.uniform(-0.7, 0.7, (count, wheels)),
        normals=normals / np.linalg.norm(normals, axis=-1)[..., None],
        gap=gap,
    )


def settled(arm: sw.Suspension, seed: int) -> sw.SettledPose:
    """Stands among rocks, some of them off the map."""
    size = 20 * scaled(arm) if isinstance(arm, sw.RockerBogie) else 20
    heights = rocks(20.0, 0.1, 300, seed) * size / 20
    rng = np.random.default_rng(seed)
    poses = rng.uniform([0, 0, -math.pi], [size, size, math.pi], (COUNT, 3))
    steering = rng.uniform(-0.4, 0.4, (COUNT, widths(arm)[2]))
    return arm.settle(sw.Terrain(heights, 0.1 * size / 20), poses, steering)


def alike(found: Any, other: Any, names: tuple[str, ...], part: float = 1e-12) -> None:
    """NaN where it is, and the rest to a part of what is largest in its row."""
    for name in names:
        a, b = np.asarray(getattr(found, name), float), np.asarray(getattr(other, name), float)
        np.testing.assert_array_equal(np.isnan(a), np.isnan(b), err_msg=name)
        rows = b.reshape(len(b), -1)
        size = np.nanmax(np.abs(np.where(np.isnan(rows), 0, rows)), axis=1, initial=1e-3)
        error = np.nanmax(np.abs(np.where(np.isnan(b), 0, a - b)).reshape(len(b), -1), axis=1, initial=0)
        assert (error <= part * np.maximum(size, 1)).all(), (name, error.max(), int(error.argmax()))


COMMAND = ("steering", "wheel_speeds", "twist", "joint_rates", "scale")
MOTION = ("twist", "joint_rates", "residuals")
TRACTION = ("wheel_speeds", "steering", "contact_angles", "lifted", "vertical_speed")


@pytest.mark.parametrize("name", VEHICLES)
@pytest.mark.parametrize("level", LEVELS)
def test_forward_is_the_same_at_every_level(name: str, level: str) -> None:
    """Whatever was measured, in all rows, some or none; weights; other angles than those of the stand."""
    arm, rng = VEHICLES[name], np.random.default_rng(1)
    wheels, joints, steered = widths(arm)
    speeds, turning = rng.uniform(-1, 1, (COUNT, wheels)), rng.uniform(-0.1, 0.1, (COUNT, 3))
    rates = rng.uniform(-0.1, 0.1, (COUNT, joints))
    for stand in (told(arm, 2), settled(arm, 3)):
        angles = rng.uniform(-0.5, 0.5, (COUNT, steered))
        angles[::3] = stand.steering[::3]
        gaps = [
            np.where(rng.random(values.shape) < 0.1, math.nan, values) for values in (speeds, turning, rates)
        ]
        for steering, given, more in (
            (None, speeds, {}),
            (angles, speeds, {"angular_velocity": turning}),
            (None, speeds, {"joint_rates": rates}),
            (angles, speeds, {"angular_velocity": turning, "joint_rates": rates}),
            (None, gaps[0], {"angular_velocity": gaps[1], "joint_rates": gaps[2]}),
            (angles, gaps[0], {"steering_rates": angles, "weights": rng.uniform(0.1, 2, wheels)}),
            (None, speeds, {"weights": np.column_stack([rng.uniform(0.1, 2, wheels), np.zeros(wheels)])}),
        ):
            scalar = arm.forward(stand, steering, given, level="scalar", **more)
            found = arm.forward(stand, steering, given, level=level, **more)
            alike(found, scalar, MOTION, 0)


def leave_out_what_no_wheel_can(arm: sw.Suspension, stand: Any, commands: np.ndarray, level: str) -> None:
    """Wheels beside their axis, or with stops, roll at no angle here and there: both ways refuse the same."""
    while True:
        said = []
        for which in ("scalar", level):
            try:
                arm.inverse(stand, commands, level=which)
            except sw.InfeasibleMotionError as error:
                said.append(re.sub(r"got .*", "", str(error)))
        if not said:
            return
        assert said[0] == said[-1]
        assert len(said) == 2
        found = re.search(r"\[(\d+)\]", said[0])
        assert found is not None
        commands[int(found[1])] = 0


@pytest.mark.parametrize("name", VEHICLES)
@pytest.mark.parametrize("level", LEVELS)
def test_inverse_is_the_same_at_every_level(name: str, level: str) -> None:
    """Driving, turning, at rest; of the body and seen from above; with angles to keep, and a limit."""
    arm, rng = VEHICLES[name], np.random.default_rng(1)
    steered = widths(arm)[2]
    for stand in (told(arm, 2), settled(arm, 3)):
        commands = rng.uniform(-0.2, 0.2, (COUNT, 2))
        commands[::20], commands[3::20, 0], commands[7::20, 1] = 0, 0, 0
        leave_out_what_no_wheel_can(arm, stand, commands, level)
        angles = rng.uniform(-0.5, 0.5, (COUNT, steered))
        angles[::3] = stand.steering[::3]
        for view in ("body", "plan"):
            for more in ({}, {"steering": angles}, {"max_wheel_speed": 0.5}):
                scalar, found = (
                    arm.inverse(stand, commands, view=view, level=which, **more)
                    for which in ("scalar", level)
                )
                alike(found, scalar, COMMAND, 0)


@pytest.mark.parametrize("name", VEHICLES)
@pytest.mark.parametrize("level", LEVELS)
def test_traction_is_the_same_at_every_level(name: str, level: str) -> None:
    """Driving, turning, at rest, and with the speeds of wheels."""
    arm, rng = VEHICLES[name], np.random.default_rng(1)
    wheels, joints, steered = widths(arm)
    speed, turn = rng.uniform(-0.1, 0.1, COUNT), rng.uniform(-0.03, 0.03, COUNT)
    speed[::20], turn[::20] = 0, 0
    turning = rng.uniform(-0.1, 0.1, (COUNT, 3))
    angles, rates = rng.uniform(-0.5, 0.5, (COUNT, joints)), rng.uniform(-0.2, 0.2, (COUNT, joints))
    present = rng.uniform(-0.4, 0.4, (COUNT, steered))
    for more in ({}, {"steering": present}, {"wheel_speeds": rng.uniform(-1, 1, (COUNT, wheels))}):
        scalar, found = (
            arm.traction(speed, None, turning, angles, rates, yaw_rate=turn, level=which, **more)
            for which in ("scalar", level)
        )
        alike(found, scalar, TRACTION, 0)


@pytest.mark.parametrize("name", VEHICLES)
@pytest.mark.parametrize("level", LEVELS)
def test_one_row_of_traction_is_the_same_at_every_level(name: str, level: str) -> None:
    """With the wheels in the lanes: driving, turning, at rest, far from level; by the quick way too."""
    arm, rng = VEHICLES[name], np.random.default_rng(2)
    wheels, joints, steered = widths(arm)
    for k in range(60):
        turning, angles = rng.uniform(-0.2, 0.2, 3), rng.uniform(-1, 1, joints)
        rates = rng.uniform(-0.2, 0.2, joints) * (k % 5 > 0)
        given = (0.1 * (k % 3 - 1), None, turning * (k % 5 > 0), angles * (k % 7 > 0), rates)
        turn = {"yaw_rate": rng.uniform(-0.1, 0.1) * (k % 4 > 0)}
        for more in (
            {},
            {"steering": rng.uniform(-0.4, 0.4, steered)},
            {"wheel_speeds": rng.uniform(-1, 1, wheels)},
        ):
            scalar, found = (arm.traction(*given, **turn, **more, level=which) for which in ("scalar", level))
            for number in TRACTION:
                np.testing.assert_array_equal(getattr(found, number), getattr(scalar, number), err_msg=number)
        quick, general = arm.traction(*given, **turn), arm.traction(*given, **turn, threads=1)
        for number in TRACTION:
            np.testing.assert_array_equal(getattr(quick, number), getattr(general, number), err_msg=number)


@pytest.mark.parametrize("level", sw.simd_levels())
def test_the_vertical_speed_fits_measured_speeds_best_however_wrong_they_are(level: str) -> None:
    """A centre's speed changes with the vertical one by the sine of its contact angle, where no link pitches.

    Steps of Gauss and Newton swung about the minimum in every second row, and nothing said so.
    """
    arm, rng, still, count = VEHICLES["perseverance"], np.random.default_rng(3), np.zeros(3), 3000
    rolling = rng.uniform(-1, 1, (count, 3)) * [1, 0, 0]
    speed, measured = rng.uniform(-1, 1, count), rng.uniform(-1, 1, (count, 6))
    told = arm.traction(speed, 0, rolling, still, still, wheel_speeds=measured, level=level)
    growth = np.sign(told.wheel_speeds) * np.sin(told.contact_angles)
    slope = np.sum(growth * (np.abs(measured) - np.abs(told.wheel_speeds)), axis=1)
    assert np.abs(slope).max() < 1e-14  # the rounding of a sum of six terms of about 1 rad/s


@pytest.mark.parametrize("level", sw.simd_levels())
def test_contacts_stay_on_their_side_of_the_rim(level: str) -> None:
    """Wheels that lean far may touch with the far side: a little steering changes little there."""
    arm, rng = VEHICLES["perseverance"], np.random.default_rng(8)
    x = np.arange(30.0)
    slope = sw.Terrain(0.2 * x + 0.1 * x[:, None], 1.0)
    poses = rng.uniform([10, 10, -math.pi], [20, 20, math.pi], (COUNT, 3))
    settled = arm.settle(slope, poses, rng.uniform(-0.4, 0.4, (COUNT, 4)))
    stand = SimpleNamespace(**{name: np.array(getattr(settled, name)) for name in vars(told(arm, 1, 0))})
    stand.contact_angles += math.pi * (rng.random((COUNT, 6)) < 0.5)
    command, angles = (0.1, 0.05), stand.steering
    here, near = (arm.inverse(stand, command, steering=a, level=level) for a in (angles, angles + 1e-9))
    np.testing.assert_allclose(near.wheel_speeds, here.wheel_speeds, rtol=0, atol=1e-7)
    back, aside = (arm.forward(stand, a, here.wheel_speeds, level=level) for a in (angles, angles + 1e-9))
    np.testing.assert_allclose(aside.twist, back.twist, rtol=0, atol=1e-7)


def test_axles_that_steer_both_their_wheels_are_shared() -> None:
    """Without a map as on level ground: for what both wheels do together."""
    arm, rng = VEHICLES["axles"], np.random.default_rng(9)
    commands = rng.uniform(-0.2, 0.2, (COUNT, 2))
    stand = arm.settle(sw.Terrain(np.zeros((9, 9)), 1.0, (-4, -4)), np.zeros(3))
    still = np.zeros((COUNT, len(arm.free_joints)))
    for level in sw.simd_levels():
        given = (commands[:, 0], None, np.zeros((COUNT, 3)), still, still)
        blind = arm.traction(*given, yaw_rate=commands[:, 1], level=level)
        seen = arm.inverse(stand, commands, level=level)
        np.testing.assert_allclose(blind.steering, seen.steering, rtol=0, atol=1e-12)
        np.testing.assert_allclose(blind.wheel_speeds, seen.wheel_speeds, rtol=0, atol=1e-11)


@pytest.mark.parametrize("level", LEVELS)
def test_a_batch_is_its_rows(level: str) -> None:
    """In any cut, with any number of threads, and in other forms: to the bit."""
    arm = VEHICLES["perseverance"]
    stand = told(arm, 4, 20_003)
    rng = np.random.default_rng(5)
    commands = rng.uniform(-0.2, 0.2, (20_003, 2))
    whole = arm.inverse(stand, commands, level=level)
    moved = arm.forward(stand, stand.steering, whole.wheel_speeds, level=level)
    drive = (commands[:, 0], commands[:, 1], np.zeros((20_003, 3)), stand.joints, stand.joints)
    driven = arm.traction(*drive, level=level)
    # A value known in some rows only does not change their neighbours.
    gappy, rates = (
        np.where(rng.random(rows.shape) < 0.1, math.nan, rows)
        for rows in (whole.wheel_speeds, whole.joint_rates)
    )
    known = arm.forward(stand, stand.steering, gappy, rates, level=level)
    for threads in (2, 3):
        again = arm.inverse(stand, commands, level=level, threads=threads)
        alike(again, whole, COMMAND, 0)
        again = arm.forward(stand, stand.steering, whole.wheel_speeds, level=level, threads=threads)
        alike(again, moved, MOTION, 0)
        alike(arm.traction(*drive, level=level, threads=threads), driven, TRACTION, 0)
    for first in (1, 20_000):
        part = SimpleNamespace(**{key: value[first:] for key, value in vars(stand).items()})
        alike(
            arm.inverse(part, commands[first:], level=level),
            SimpleNamespace(**{key: getattr(whole, key)[first:] for key in COMMAND}),
            COMMAND,
            0,
        )
        part = arm.forward(part, part.steering, gappy[first:], rates[first:], level=level)
        alike(part, SimpleNamespace(**{key: getattr(known, key)[first:] for key in MOTION}), MOTION, 0)
    fortran = [np.asfortranarray(values) for values in drive]
    alike(arm.traction(*fortran, level=level), driven, TRACTION, 0)
    lists = [values[:4].tolist() for values in drive]
    head = SimpleNamespace(**{key: getattr(driven, key)[:4] for key in TRACTION})
    alike(arm.traction(*lists, level=level), head, TRACTION, 0)


@pytest.mark.parametrize("name", VEHICLES)
def test_one_call_is_a_row(name: str) -> None:
    """By the quick way and by the general one: to the bit."""
    arm = VEHICLES[name]
    x = 0.1 * np.arange(-80, 81)
    ground = sw.Terrain(0.05 * np.sin(2 * x) * np.cos(3 * x[:, None]), 0.1, (-8.0, -8.0))
    wheels, _, steered = widths(arm)
    rng = np.random.default_rng(6)
    for pose in rng.uniform([-3, -3, -3], [3, 3, 3], (20, 3)):
        angles, speeds = rng.uniform(-0.3, 0.3, steered), rng.uniform(-1, 1, wheels)
        speeds[rng.integers(wheels)] = math.nan if pose[0] > 1 else 0.0
        stand = arm.settle(ground, pose, angles)
        general = arm.forward(stand, angles, speeds, threads=1)
        for way in (np.asarray, tuple, list):
            quick = arm.forward(stand, way(angles), way(speeds))
            for number in MOTION:
                np.testing.assert_array_equal(
                    getattr(quick, number), getattr(general, number), err_msg=number
                )
                assert getattr(quick, number).shape == getattr(general, number).shape
        np.testing.assert_array_equal(arm.forward(stand, None, speeds).twist, general.twist)
        assert repr(quick) == repr(general)
    bad = {"wheel_speeds": (angles, speeds[:-1]), "wheel_speeds must be finite": (angles, speeds + math.inf)}
    if steered:
        bad |= {"steering": (angles[:-1], speeds), "steering must be finite": (angles + math.nan, speeds)}
    for words, arguments in bad.items():
        with pytest.raises(ValueError, match=words):
            arm.forward(stand, *arguments)


@pytest.mark.parametrize("level", LEVELS)
def test_nothing_to_do(level: str) -> None:
    """An empty batch is one."""
    arm = VEHICLES["perseverance"]
    still = np.empty((0, 3))
    assert arm.forward(told(arm, 6, 0), None, np.empty((0, 6)), level=level).twist.shape == (0, 6)
    assert arm.traction(np.empty(0), np.empty(0), still, still, still, level=level).wheel_speeds.shape == (
        0,
        6,
    )


@pytest.mark.parametrize("threads", [1, 3])
def test_the_first_row_that_steers_too_far_is_named(threads: int) -> None:
    """However many look at once; an empty batch is one."""
    dimensions = dict(sw.RockerBogie.preset("perseverance").dimensions)
    arm = sw.RockerBogie(**dimensions | {"steering_limit": 0.6})
    stand = told(arm, 6, 30_001)
    for level in (stand.steering, stand.joints, stand.roll, stand.pitch):
        level *= 0
    stand.normals[...] = 0, 0, 1
    commands = np.tile([0.2, 0.0], (30_001, 1))
    commands[[20_070, 29_000]] = 0.0, 0.5
    with pytest.raises(sw.InfeasibleMotionError, match=r"command\[20070\] must let \w+ steer within"):
        arm.inverse(stand, commands, threads=threads)
    nothing = arm.inverse(told(arm, 6, 0), np.empty((0, 2)), threads=threads)
    assert nothing.wheel_speeds.shape == (0, 6)


@pytest.mark.parametrize("call", ["slip", "stability", "settle", "bounds", "feasible"])
def test_threads_change_no_bit(call: str) -> None:
    """Whatever else takes a stand, or poses."""
    arm, rng, count = VEHICLES["rocky7"], np.random.default_rng(1), 20_003
    ground = sw.Terrain(rocks(4.0, 0.1, 20, 3) * 0.2, 0.05)
    poses = rng.uniform([0, 0, -math.pi], [2, 2, math.pi], (count, 3))
    rates, twists = rng.uniform(-0.1, 0.1, (count, 3)), rng.uniform(-0.1, 0.1, (count, 6))
    stand = arm.settle(ground, poses)
    assert np.isfinite(stand.z).sum() > count // 4
    run, names = {
        "slip": (lambda **how: arm.slip(stand, twists, twists, rates, **how), ("ratio", "angle")),
        "stability": (
            lambda **how: arm.stability(stand, mass=10.0, **how),
            ("loads", "tip_over_angle", "clearance", "joint_margins", "tilt"),
        ),
        "settle": (lambda **how: arm.settle(ground, poses, **how), ("z", "joints", "gap")),
        "bounds": (lambda **how: arm.bounds(ground, poses, **how), ("z", "tilt", "clearance")),
        "feasible": (lambda **how: arm.feasible(ground, poses, **how), ("margin", "tilt")),
    }[call]
    one = run(threads=1)
    for threads in (2, 3):
        many = run(threads=threads)
        for name in names:
            np.testing.assert_array_equal(getattr(many, name), getattr(one, name), err_msg=name)
    with pytest.raises(ValueError, match="threads must be at least 1, got 0"):
        run(threads=0)
