"""`Odometry3` told what cannot be: readings, options, a pose off the map, eight threads at once."""

import math
import threading
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.kinematics.odometry.slopes import simulated


def test_eight_threads_take_turns() -> None:
    """None is lost, none torn."""
    arm = sw.RockerBogie.preset("perseverance")
    odometry, taken = sw.Odometry3(arm), []

    def work() -> None:
        for k in range(200):
            try:
                odometry.update(np.zeros(4), np.full(6, 0.1 * k), k, joints=np.zeros(3), attitude=(0.0, 0.0))
                taken.append(k)
            except ValueError as error:
                assert "stamp must be later" in str(error)  # noqa: PT017

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(set(taken)) == sorted(taken)
    np.testing.assert_allclose(odometry.state.position, [0.1 * 199 * 0.26288, 0, 0], atol=1e-9)


ARM = sw.RockerBogie.preset("perseverance")


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({"attitude": None}, "attitude must be given where there is no ground"),
        ({"attitude": (np.nan, 0.0)}, "attitude must be finite"),
        ({"attitude": (math.pi, 0.0)}, r"attitude must be upright.*180\.0°"),
        ({"attitude": (1.0, 0.0, 0.0, 0.0)}, r"attitude must be upright.*180\.0°"),
        ({"attitude": (0.0, 0.0, 0.0, 2.0)}, "attitude must be a quaternion"),
        ({"attitude": (0.0,)}, r"attitude must have shape \(2,\), \(3,\) or \(4,\)"),
        ({"joints": None}, "joints must hold 3 angles where there is no ground"),
        ({"joints": (0.0, np.nan, 0.0)}, "joints must be finite"),
        ({"joints": (0.0, 0.0)}, r"joints must have shape \(\.\.\., 3\)"),
        ({"wheel_angles": np.full(6, np.nan)}, "wheel_angles must be finite"),
        ({"wheel_angles": np.full(6, 1e300)}, "wheel_angles must be small enough"),
        ({"steering": (0.0, 0.0, np.inf, 0.0)}, "steering must be finite"),
        ({"steering": None}, "steering must hold the angles"),
        ({"stamp": 0.0}, "stamp must be later than the last one, 0.0, got 0.0"),
        ({"stamp": -1.0}, "stamp must be later"),
        ({"stamp": np.nan}, "stamp must be finite"),
        ({"yaw_rate": np.inf}, "yaw_rate must be finite"),
    ],
)
def test_bad_readings_are_named_and_change_nothing(row: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {
        "steering": np.zeros(4),
        "wheel_angles": np.zeros(6),
        "stamp": 0.0,
        "joints": np.zeros(3),
        "attitude": (0.0, 0.1),
    }
    odometry = sw.Odometry3(ARM)
    odometry.update(**good)
    before = odometry.state
    with pytest.raises(ValueError, match=message) as raised:
        odometry.update(**{**good, "stamp": 1.0, **row})
    assert "\n" not in str(raised.value)
    np.testing.assert_array_equal(odometry.state.pose, before.pose)
    np.testing.assert_array_equal(odometry.state.covariance, before.covariance)
    after = odometry.update(**{**good, "stamp": 1.0, "wheel_angles": np.full(6, 1.0)})
    np.testing.assert_allclose(np.linalg.norm(after.position), 0.26288, atol=1e-12)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"attitude_noise": -1.0}, "attitude_noise must be finite and not negative, got -1.0"),
        ({"joint_noise": np.nan}, "joint_noise must be finite"),
        ({"lag": -1.0}, "lag must be finite"),
        ({"readings": "ticks"}, "wheel_encoders must be given with readings='ticks'"),
        ({"wheel_encoders": [sw.Encoder()] * 4}, "wheel_encoders must be one encoder or 6, got 4"),
    ],
)
def test_bad_options_are_named(keywords: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sw.Odometry3(ARM, **keywords)


def test_off_the_ground() -> None:
    """Refused at the start; on the way rows are left out, or go by joints and attitude."""
    arm, ground, log = simulated()
    nowhere = sw.Odometry3(arm, ground=ground)
    nowhere.reset((20.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="pose must be one at which the rover stands.*off_map"):
        nowhere.update(log.steering[0], log.wheel_angles[0], 0.0)
    small = sw.Terrain(np.zeros((60, 60)), spacing=0.1, origin=(-3.0, -3.0))
    stamps, totals = np.arange(100.0), 0.3 * np.arange(100.0)[:, None] * np.ones(6)
    steering = np.zeros((100, 4))
    track = sw.dead_reckon(arm, steering, totals, stamps, ground=small)
    assert len(track.rows(sw.OdometryHealth.OFF_GROUND)) > 50
    assert track.poses[-1, 0] < 3.0
    told = {"joints": np.zeros((100, 3)), "attitude": np.zeros((100, 2))}
    track = sw.dead_reckon(arm, steering, totals, stamps, ground=small, **told)
    assert len(track.rows(sw.OdometryHealth.UNSETTLED)) > 50
    np.testing.assert_allclose(track.positions[-1], [99 * 0.3 * 0.26288, 0, 0], atol=1e-9)


def test_on_a_map_a_log_starts_where_its_truth_does() -> None:
    """Before, a drive that began elsewhere on the map was dead-reckoned from the map's origin."""
    arm, ground, log = simulated()
    first = log.truth.at(log.stamps[:1])[0]
    track = sw.dead_reckon(arm, log, ground=ground)
    np.testing.assert_array_equal(track.poses, sw.dead_reckon(arm, log, ground=ground, start=first).poses)
    commands = [(0, 0.1, 0, 0), (10, 0.1, 0, 0.02)]
    away = sw.simulate(arm, commands, ground=ground, rate=20.0, start=(1.0, 0.5, 0.3))
    track = sw.dead_reckon(arm, away, ground=ground)
    np.testing.assert_allclose(track.positions[-1, :2], away.truth.poses[-1, :2], rtol=0, atol=5e-3)  # of 1 m
    assert np.abs(sw.dead_reckon(arm, away, ground=ground, start=(0, 0, 0)).positions[0, :2]).max() < 0.01


def test_dead_reckon_names_what_is_not_for_it() -> None:
    arm = sw.RockerBogie.preset("perseverance")
    with pytest.raises(ValueError, match="yaw must be left out for a suspension"):
        sw.dead_reckon(arm, None, None, None, yaw=[0.0])
    with pytest.raises(ValueError, match="joints must be left out for a rover"):
        sw.dead_reckon(arm.planar(), None, None, None, joints=[0.0])
    with pytest.raises(ValueError, match="wheel_angles and stamps must be given"):
        sw.dead_reckon(arm, np.zeros((3, 4)))
