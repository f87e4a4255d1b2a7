"""Odometry in space: whole logs, covariance of many drives, late poses, restarts, other chains."""

import math
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.core.ground.test_ground_reference import PERSEVERANCE
from tests.kinematics.odometry.slopes import QUIET, ramp, simulated


@pytest.mark.parametrize("known", ["joints", "ground"])
def test_a_whole_log_is_its_rows(known: str) -> None:
    """Bit by bit, bad rows among them."""
    arm, ground, log = simulated()
    totals, stamps = log.wheel_angles.copy(), log.stamps.copy()
    totals[20, 2], stamps[40] = np.nan, stamps[39]
    totals[20, :] = np.nan
    attitude = np.column_stack([log.stand.roll, log.stand.pitch])
    more = {"ground": ground} if known == "ground" else {}
    columns = {} if known == "ground" else {"joints": log.stand.joints, "attitude": attitude}
    track = sw.dead_reckon(arm, log.steering, totals, stamps, **columns, **more)
    assert track.left_out.tolist() == [20, 40]
    odometry = sw.Odometry3(arm, **more)
    for k in range(len(stamps)):
        row = {name: column[k] for name, column in columns.items()}
        if k in (20, 40):
            before = odometry.state.pose
            with pytest.raises(ValueError, match="must be"):
                odometry.update(log.steering[k], totals[k], stamps[k], **row)
            np.testing.assert_array_equal(odometry.state.pose, before)
            np.testing.assert_array_equal(track.poses[k], before)
            continue
        state = odometry.update(log.steering[k], totals[k], stamps[k], **row)
        np.testing.assert_array_equal(state.pose, track.poses[k])
        np.testing.assert_array_equal(state.twist, track.twists[k])
        np.testing.assert_array_equal(state.covariance, track.covariances[k])
        np.testing.assert_array_equal(state.slips, track.slips[k])
        np.testing.assert_array_equal(state.residuals, track.residuals[k])
    np.testing.assert_allclose(state.transform[:3, 3], state.position)
    assert track.findings()[0].startswith("FIRST")


@pytest.mark.parametrize("known", ["joints", "yaw", "ground"])
def test_the_covariance_is_that_of_many_drives(known: str) -> None:
    """Noise in every reading: the normalised error squared of 150 drives over bumps lies in its band."""
    arm, ground, log = simulated()
    noise = sw.Noise(speed=0.01, steering=0.01)
    attitude_noise, joint_noise, rows = 0.001, 0.0005, 120
    stand = log.stand
    yaw = log.truth.poses[:rows, 2]
    attitude = np.column_stack([stand.roll[:rows], stand.pitch[:rows], yaw])
    if known != "yaw":
        attitude = attitude[:, :2]
    joints, stamps = stand.joints[:rows], log.stamps[:rows]
    dt = np.diff(stamps)[:, None]
    rng = np.random.default_rng(3)
    options: dict[str, Any] = {"noise": noise, "attitude_noise": attitude_noise, "joint_noise": joint_noise}
    if known == "ground":
        options["ground"] = ground

    def reckon(read: Any) -> Any:
        radius = 0.26288
        rolled = np.zeros((rows, 6))
        rolled[1:] = np.cumsum(read((rows - 1, 6)) * noise.speed * dt / radius, axis=0)
        more = dict(options)
        if known != "ground":
            tilt = attitude.copy()
            tilt[:, :2] += attitude_noise * read((rows, 2))
            more |= {"attitude": tilt, "joints": joints + joint_noise * read(joints.shape)}
        steering = log.steering[:rows] + noise.steering * read((rows, 4))
        return sw.dead_reckon(arm, steering, log.wheel_angles[:rows] + rolled, stamps, **more)

    true = reckon(np.zeros)
    nees, ends = [], []
    for _ in range(150):
        track = reckon(rng.standard_normal)
        gap = track.poses[-1] - true.poses[-1]
        turn = np.array([gap[5]]) if known != "yaw" else np.zeros(0)
        picked = [0, 1, 5] if known != "yaw" else [0, 1, 2]
        gap = np.concatenate([gap[:2], turn]) if known != "yaw" else gap[:3]
        ends.append(gap)
        nees.append(gap @ np.linalg.solve(track.covariances[-1][np.ix_(picked, picked)], gap))
    spread, told = np.cov(np.array(ends).T), true.covariances[-1][np.ix_(picked, picked)]
    # Chi-square with 3 degrees of freedom over 150 drives: 3 ± 4 x 0.2. Twice the noise of joints and tilt
    # makes wheels climb by its square, 0.3 % of the way.
    assert 2.2 < np.mean(nees) < 3.8, (np.mean(nees), np.sqrt(np.diag(spread)), np.sqrt(np.diag(told)))


def test_a_late_pose_is_worth_a_timely_one() -> None:
    """The samples since are taken in again; with everything known at once the same comes out."""
    arm, ground, log = simulated()
    attitude = np.column_stack([log.stand.roll, log.stand.pitch])
    pose = [2.0, 0.1, 0.4, 0.0, 0.0, 0.05]
    for more in ({"attitude": attitude, "joints": log.stand.joints}, {}):
        options = {} if more else {"ground": ground}
        late, timely = (sw.Odometry3(arm, lag=5.0, **options) for _ in range(2))
        for k in range(120):
            row = {name: column[k] for name, column in more.items()}
            late.update(log.steering[k], log.wheel_angles[k], log.stamps[k], **row)
            timely.update(log.steering[k], log.wheel_angles[k], log.stamps[k], **row)
            if k == 90:
                timely.correct(pose, log.stamps[k], np.full(6, 1e-4))
        state = late.correct(pose, log.stamps[90], np.full(6, 1e-4))
        np.testing.assert_allclose(state.pose, timely.state.pose, rtol=0, atol=1e-12)
        np.testing.assert_allclose(state.covariance, timely.state.covariance, rtol=0, atol=1e-12)
        assert np.linalg.eigvalsh(state.covariance).min() > -1e-12
    exact = late.correct((2.5, 0.2, 0.1), log.stamps[119], (0.0, 0.0, 0.0))
    np.testing.assert_allclose(exact.pose[[0, 1, 5]], (2.5, 0.2, 0.1), atol=1e-9)
    with pytest.raises(ValueError, match="stamp must be between"):
        late.correct(pose, 0.0, np.full(6, 1.0))


def test_set_pose_and_reset() -> None:
    """Measured values, and those that the ground decides, stay."""
    arm, ground, log = simulated()
    odometry = sw.Odometry3(arm, ground=ground)
    for k in range(10):
        odometry.update(log.steering[k], log.wheel_angles[k], log.stamps[k])
    odometry.set_pose((1.0, 0.5, 0.2), (0.01, 0.01, 0.001))
    stand = arm.settle(ground, (1.0, 0.5, 0.2), log.steering[9])
    np.testing.assert_allclose(odometry.state.pose[2:5], [stand.z, stand.roll, stand.pitch], atol=1e-12)
    assert odometry.state.covariance[2, 2] > 0
    odometry.reset()
    assert odometry.state.stamp is None
    matrix = np.eye(4)
    matrix[:3, 3] = 1.0, 0.5, 9.0
    odometry.reset(matrix)
    np.testing.assert_array_equal(odometry.state.position, [1.0, 0.5, 9.0])


def test_clocks_and_counters_that_restart() -> None:
    """As in the plane: the second row that fits the one left out before goes on from there."""
    arm = sw.RockerBogie.preset("perseverance")
    stamps, totals = np.arange(30.0), 0.3 * np.arange(30.0)[:, None] * np.ones(6)
    told = {"joints": np.zeros((30, 3)), "attitude": np.zeros((30, 2))}
    clock = stamps.copy()
    clock[15:] -= 100.0
    jumped = totals.copy()
    jumped[15:] += 1e3
    for readings, more in (((totals, clock), {}), ((jumped, stamps), {"max_speed": 1.0})):
        track = sw.dead_reckon(arm, np.zeros((30, 4)), *readings, **told, **more)
        assert track.rows(sw.OdometryHealth.RESTARTED).tolist() == [16]
        assert abs(track.poses[-1, 0] - 29 * 0.3 * 0.26288) <= 0.3 * 0.26288 + 1e-9


def test_other_chains() -> None:
    """Without free joints, with three bogies, with pivoting axles: level ground is level ground."""
    centres = [(0.5, 0.4, 0.2), (0.5, -0.4, 0.2), (-0.5, 0.4, 0.2), (-0.5, -0.4, 0.2)]
    rigid = sw.Suspension.rigid(centres, 0.2)
    odometry = sw.Odometry3(rigid, QUIET)
    for k in range(3):
        state = odometry.update(None, np.full(4, float(k)), k, attitude=(0.0, -0.3))
    np.testing.assert_allclose(state.position, [0.4 * math.cos(0.3), 0, 0.4 * math.sin(0.3)], atol=1e-12)
    zoe = sw.Suspension.pivoting_axles(wheelbase=1.91, track_width=1.64, drop=0.119, wheel_radius=0.325)
    odometry = sw.Odometry3(zoe, QUIET)
    for k in range(2):
        # The front axle turns in place: its wheels roll round the pivot.
        turn, rolled = 0.1 * k, 0.1 * k * 0.82 / 0.325
        told = np.array([-rolled, rolled, 0, 0])
        state = odometry.update((turn, 0.0), told, k, joints=[0.0], attitude=(0.0, 0.0))
    np.testing.assert_allclose(state.pose, 0, atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("known", ["joints", "ground"])
def test_it_is_the_plain_one(known: str) -> None:
    """Steering, bumps and wheels that contradict each other, against a plain model that shares no code."""
    from six_wheel.reference import ground as plain
    from six_wheel.reference.ground.odometry import dead_reckon

    arm, chain = sw.RockerBogie(**PERSEVERANCE), plain.rocker_bogie(**PERSEVERANCE)
    _, ground, log = simulated()
    rows = slice(100, 140 if known == "joints" else 106)
    totals = log.wheel_angles[rows] + 0.002 * np.random.default_rng(4).standard_normal(
        log.wheel_angles[rows].shape
    )
    steering, stamps = log.steering[rows], log.stamps[rows]
    x, y, yaw = log.truth.poses[rows][0]
    z = float(log.stand.z[rows][0])
    if known == "joints":
        attitude = np.column_stack([log.stand.roll[rows], log.stand.pitch[rows]])
        told = {"joints": log.stand.joints[rows]}
        reach = np.linalg.norm(arm.settle(ramp(0.0), (0, 0, 0)).wheel_centres, axis=1).max()
        doubt = float(reach * math.sqrt(2 * (0.003**2 + 0.001**2)))
        slow = dead_reckon(
            chain, steering, totals, **told, attitudes=attitude, start=(x, y, z, yaw), doubt=doubt
        )
        start = (x, y, z, *attitude[0], yaw)
        fast = sw.dead_reckon(
            arm, steering, totals, stamps, **told, attitude=attitude, start=start, attitude_noise=0.003
        )
    else:
        grid = plain.Terrain(np.asarray(ground.heights), 0.1, (-6.0, -6.0))
        slow = dead_reckon(chain, steering, totals, ground=grid, start=(x, y, z, yaw))
        fast = sw.dead_reckon(arm, steering, totals, stamps, ground=ground, start=(x, y, yaw))
    # Settled to 1e-12, fixed points to 1e-14.
    np.testing.assert_allclose(fast.poses, slow, rtol=0, atol=1e-9)
