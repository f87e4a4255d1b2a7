"""`Odometry3`: laws, planes, simulated drives, whole logs, noise, late poses."""

import math
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.kinematics.odometry.slopes import QUIET, ramp, simulated

EXACT = {"attitude_noise": 0.0, "joint_noise": 0.0}


def drive(arm: sw.RockerBogie, rows: int = 60, seed: int = 0) -> tuple[Any, Any, Any]:
    """Steering, totals and stamps of a rover that goes about level ground, noise in all of its readings."""
    rng = np.random.default_rng(seed)
    stamps = np.cumsum(rng.uniform(0.05, 0.15, rows))
    curvature = 0.4 * np.sin(0.7 * stamps)
    twists = np.stack([np.full(rows, 0.2), np.zeros(rows), 0.2 * curvature], axis=-1)
    planar = arm.planar()
    steering, speeds = planar.inverse(planar.project(twists))
    totals = np.cumsum(speeds * np.gradient(stamps)[:, None], axis=0)
    return steering + 0.01 * rng.standard_normal(steering.shape), totals, stamps


def two_fixed_pairs() -> sw.RockerBogie:
    """Like Rocky 7, front wheels steered, but with its wheels at one height."""
    return sw.RockerBogie(
        rocker_pivot=(0.12, 0.2, 0.2),
        rocker_to_front=(0.3, 0.02, -0.125),
        rocker_to_bogie=(-0.12, 0.0, -0.1),
        bogie_to_middle=(0.07, 0.03, -0.025),
        bogie_to_rear=(-0.07, 0.01, -0.025),
        wheel_radius=0.075,
        steered="front",
    )


@pytest.mark.parametrize("name", ["perseverance", "curiosity", "two fixed pairs"])
@pytest.mark.parametrize("on", ["imu", "quaternion", "ground"])
def test_level_ground_is_the_plane(name: str, on: str) -> None:
    """Noisy, contradictory readings: pose, twist and residual of the planar one, nearly its covariance."""
    arm = two_fixed_pairs() if name == "two fixed pairs" else sw.RockerBogie.preset(name)
    steering, totals, stamps = drive(arm)
    noise = sw.Noise(0.01, 0.009, slip=0.01, side_slip=0.02)
    planar = sw.dead_reckon(arm.planar(), steering, totals, stamps, noise=noise)
    more: dict[str, Any] = {"noise": noise, **EXACT}
    level = np.zeros((len(stamps), 3))
    if on == "ground":
        more["ground"] = ramp(0.0)
    else:
        more |= {"attitude": level[:, :2], "joints": level}
    if on == "quaternion":
        halves = planar.poses[:, 2] / 2
        more["attitude"] = np.stack([0 * halves, 0 * halves, np.sin(halves), np.cos(halves)], axis=-1)
    track = sw.dead_reckon(arm, steering, totals, stamps, **more)
    assert (track.health == planar.health).all()
    # Rounding of some tens of steps; settled attitudes are good to 1e-12, and swing the way.
    rounding = 5e-12 if on == "ground" else 1e-12
    np.testing.assert_allclose(track.poses[:, [0, 1, 5]], planar.poses, rtol=0, atol=rounding)
    np.testing.assert_allclose(track.twists[1:, [0, 1, 5]], planar.twists[1:], rtol=0, atol=20 * rounding)
    np.testing.assert_allclose(track.attitudes[:, :2], 0, atol=rounding)
    assert track.covariances is not None
    assert planar.covariances is not None
    if on == "quaternion":
        assert track.covariances[-1][5, 5] < 1e-15  # its yaw is taken at its word
        return
    np.testing.assert_allclose(track.residuals[1:], planar.residuals[1:], atol=1e-11)
    block = track.covariances[:, [[0], [1], [5]], [[0, 1, 5]]]
    # To first order in how the wheels contradict each other the covariances are the same.
    np.testing.assert_allclose(block, planar.covariances, atol=0.02 * np.abs(planar.covariances).max())


@pytest.mark.parametrize("known", ["joints", "ground"])
@pytest.mark.parametrize("turn", [0.0, 0.06])
def test_a_ramp_of_25_degrees_is_that_ramp(known: str, turn: float) -> None:
    """Driving up a plane and turning on it ends at the plane's pose, to a micrometre and a microradian."""
    arm, slope = sw.RockerBogie.preset("perseverance"), math.radians(25)
    commands = [(0.0, 0.1, 0.0, turn), (30.0, 0.1, 0.0, turn)]
    ground = ramp(slope)
    log = sw.simulate(arm, commands, ground=ground, rate=10.0)
    kwargs: dict[str, Any] = {"ground": ground} if known == "ground" else {}
    start = (*log.truth.poses[0, :2], log.stand.z[0], 0.0, 0.0, log.truth.poses[0, 2])
    track = sw.dead_reckon(arm, log, noise=QUIET, start=start, **kwargs, **EXACT)
    true = np.column_stack([log.truth.poses[:, :2], log.stand.z])
    assert np.ptp(true[:, 2]) > 0.5
    if turn == 0.0:
        np.testing.assert_allclose(track.positions, true, rtol=0, atol=1e-6)
        np.testing.assert_allclose(track.attitudes[:, 1], -slope, atol=1e-6)
        return
    # The rover steers as on level ground, so that its wheels scrub on the slope: the way stays on the plane.
    height = math.tan(slope) * track.positions[:, 0]
    above = true[:, 2] - math.tan(slope) * true[:, 0]
    np.testing.assert_allclose(track.positions[:, 2] - height, above, atol=1e-6)


def inclined(
    arm: sw.RockerBogie, rotation: Any, twist: Any, rows: int = 50, dt: float = 0.2
) -> tuple[dict[str, Any], Any]:
    """A rover that turns on a plane with a constant twist, seen by an IMU; and its way."""
    from scipy.spatial.transform import Rotation

    planar = arm.planar()
    steering, speeds = planar.inverse(twist)
    stamps = dt * np.arange(rows)
    poses = sw.integrate(np.tile(twist, (rows - 1, 1)), dt)
    turned = Rotation.from_quat(rotation) * Rotation.from_euler("z", poses[:, 2:])
    places = Rotation.from_quat(rotation).apply(np.column_stack([poses[:, :2], np.zeros(rows)]))
    log = {
        "steering": np.tile(steering, (rows, 1)),
        "wheel_angles": speeds * stamps[:, None],
        "stamps": stamps,
        "joints": np.zeros((rows, 3)),
    }
    return log, (places, turned)


@pytest.mark.parametrize("numbers", [2, 3, 4])
def test_a_plane_only_turns_the_way(numbers: int) -> None:
    """Arcs on slopes of any direction, by roll and pitch alone too: the plane's own, turned with it."""
    from scipy.spatial.transform import Rotation

    arm = sw.RockerBogie.preset("perseverance")
    for roll, pitch, yaw in [(0.0, 0.0, 0.3), (0.0, -0.43, 0.0), (0.3, 0.2, -2.0), (-0.4, 0.1, 1.0)]:
        rotation = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_quat()
        twist = arm.planar().project((0.1, 0.0, 0.05))
        log, (places, turned) = inclined(arm, rotation, twist)
        angles = turned.as_euler("ZYX")[:, ::-1]
        attitude = {2: angles[:, :2], 3: angles, 4: turned.as_quat()}[numbers]
        start = np.concatenate([places[0], angles[0]])
        track = sw.dead_reckon(arm, **log, attitude=attitude, noise=QUIET, start=start, **EXACT)
        # The wheels of Perseverance stand level to 1e-9; 50 steps.
        np.testing.assert_allclose(track.positions, places, rtol=0, atol=1e-9)
        np.testing.assert_allclose(np.abs((track.orientations * turned.as_quat()).sum(1)), 1, atol=1e-9)


def error(track: Any, log: Any) -> Any:
    true = np.column_stack([log.truth.poses[:, :2], log.stand.z])
    return track.positions - true


def test_a_drive_over_bumps_is_found_again() -> None:
    """With the map nearly; from joints and attitude to a percent of the way."""
    arm, ground, log = simulated()
    start = (0.0, 0.0, log.stand.z[0], log.stand.roll[0], log.stand.pitch[0], 0.0)
    way = 0.15 * 30
    known = sw.dead_reckon(arm, log, ground=ground, noise=QUIET, start=start, **EXACT)
    unknown = sw.dead_reckon(arm, log, noise=QUIET, start=start, **EXACT)
    for track, share in ((known, 0.02), (unknown, 0.02)):
        assert np.abs(error(track, log)[-1]).max() < share * way, error(track, log)[-1]
    planar = sw.dead_reckon(arm.planar(), log, noise=QUIET)
    flat = np.linalg.norm(planar.poses[-1, :2] - log.truth.poses[-1, :2])
    assert np.linalg.norm(error(known, log)[-1, :2]) < flat


@pytest.mark.parametrize("known", ["joints", "ground"])
def test_simulated_noise_is_found_again(known: str) -> None:
    """Wheels that slip and err as they were told to: the way ends within what the covariance says."""
    noise = sw.Noise(speed=0.01, steering=0.01, slip=0.03, side_slip=0.03)
    within = 0
    for seed in range(12):
        arm, ground, log = simulated(seed, noise=noise)
        start = (0.0, 0.0, log.stand.z[0], log.stand.roll[0], log.stand.pitch[0], 0.0)
        more: dict[str, Any] = {"ground": ground} if known == "ground" else {}
        track = sw.dead_reckon(arm, log, noise=noise, start=start, **more, **EXACT)
        assert track.covariances is not None
        within += squared(track, log) < 11.3  # 99 % of chi-square, 3 degrees of freedom
    assert within >= 10


def squared(track: Any, log: Any) -> float:
    """Normalised error squared of the end, in plan."""
    gap = np.array([*error(track, log)[-1, :2], track.poses[-1, 5] - log.truth.poses[-1, 2]])
    block = track.covariances[-1][np.ix_([0, 1, 5], [0, 1, 5])]
    return float(gap @ np.linalg.solve(block, gap))


@pytest.mark.parametrize("known", ["joints", "ground"])
def test_a_typical_rover_ends_within_the_default_noise_on_ground_too(known: str) -> None:
    noise = sw.Noise.typical()
    values = []
    for seed in range(9):
        arm, ground, log = simulated(seed, noise=noise)
        start = (0.0, 0.0, log.stand.z[0], log.stand.roll[0], log.stand.pitch[0], 0.0)
        more: dict[str, Any] = {"ground": ground} if known == "ground" else {}
        values.append(squared(sw.dead_reckon(arm, log, start=start, **more), log))
    assert max(values) < 16.3  # 99.9 % of chi-square with 3 degrees of freedom
    assert 2.366 / 2.0 < np.median(values) < 2.0 * 2.366  # about its median


@pytest.mark.parametrize("known", ["joints", "ground"])
def test_mirror_yaw_and_translation(known: str) -> None:
    """Another start moves and turns the way; mirrored readings mirror it."""
    arm, ground, log = simulated()
    base: dict[str, Any] = {"noise": sw.Noise(slip=0.01), **EXACT}
    readings = (log.steering, log.wheel_angles, log.stamps)
    imu = {"joints": log.stand.joints, "attitude": np.column_stack([log.stand.roll, log.stand.pitch])}
    if known == "joints":
        one = sw.dead_reckon(arm, *readings, **imu, **base)
        other = sw.dead_reckon(arm, *readings, **imu, start=(3.0, -2.0, 5.0, 0.0, 0.0, 0.7), **base)
    else:
        x, y = 3.0, -2.0
        one = sw.dead_reckon(arm, *readings, ground=ground, **base)
        turned = sw.Terrain(np.asarray(ground.heights), spacing=0.1, origin=moved(-6, -6, x, y, 0.7), yaw=0.7)
        other = sw.dead_reckon(arm, *readings, ground=turned, start=(x, y, 0.7), **base)
    c, s = math.cos(0.7), math.sin(0.7)
    plan = one.positions[:, :2] @ [[c, s], [-s, c]] + [3.0, -2.0]
    np.testing.assert_allclose(other.positions[:, :2], plan, rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        np.diff(other.poses[:, 2:], axis=0), np.diff(one.poses[:, 2:], axis=0), atol=1e-9
    )
    swap = np.array([1, 0, 3, 2, 5, 4])
    if known == "joints":
        sided = {"joints": log.stand.joints[:, [0, 2, 1]] * [-1, 1, 1], "attitude": imu["attitude"] * [-1, 1]}
        mirrored = sw.dead_reckon(
            arm, -log.steering[:, [1, 0, 3, 2]], log.wheel_angles[:, swap], log.stamps, **sided, **base
        )
        np.testing.assert_allclose(mirrored.poses, one.poses * [1, -1, 1, -1, 1, -1], rtol=0, atol=1e-9)


def moved(x: float, y: float, dx: float, dy: float, yaw: float) -> tuple[float, float]:
    c, s = math.cos(yaw), math.sin(yaw)
    return (c * x - s * y + dx, s * x + c * y + dy)
