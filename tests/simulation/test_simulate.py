"""Logs from nowhere: the truth is true, readings err as they are told to, and files hold what was made."""

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.simulation import Slip, write_log
from tests.rovers import OMNI, PAIR, SIX_WHEELS, SMALL_MECANUM, SMALL_SWERVE, SMALL_TRICYCLE

ROVERS = {
    "six_wheel": SIX_WHEELS,
    "differential": PAIR,
    "tricycle": SMALL_TRICYCLE,
    "ackermann": sw.Rover.ackermann(wheelbase=0.6, track_width=0.4, wheel_radius=0.1),
    "swerve": SMALL_SWERVE,
    "mecanum": SMALL_MECANUM,
    "omni": OMNI,
}
TIMES = np.linspace(0.0, 8.0, 33)
TWISTS = np.stack((0.4 + 0.1 * np.sin(TIMES), 0.1 * np.sin(0.7 * TIMES), 0.4 * np.sin(0.9 * TIMES)), axis=-1)


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_without_noise_dead_reckoning_finds_the_truth(rover):
    log = sw.simulate(rover, (TIMES, TWISTS), start=(1.0, 2.0, 0.5))
    track = sw.dead_reckon(rover, log, start=(1.0, 2.0, 0.5))
    # A step takes the angles of its middle: second order in what steers within 20 ms.
    np.testing.assert_allclose(track.poses, log.truth.poses, atol=2e-4)


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
@pytest.mark.parametrize(
    "noise",
    [
        sw.Noise(speed=0.01, steering=0.003, slip=0.002, side_slip=0.002),
        sw.Noise(speed=0.0, steering=0.0, slip=0.005, side_slip=0.01),
    ],
    ids=["readings", "slip"],
)
def test_dead_reckoning_is_as_far_off_as_it_says(rover, noise):
    """Mean NEES of n runs: 3 with a deviation of sqrt(6 / n), 3.5 of which bound it.

    What a mecanum wheel slips across counted for nothing: three of four ends were within their bound of 95 %.
    """
    runs = 40
    path = (TIMES[:17], TWISTS[:17])
    values = []
    for seed in range(runs):
        log = sw.simulate(rover, path, noise=noise, rate=20.0, seed=seed)
        track = sw.dead_reckon(rover, log, noise=noise, residuals=False)
        error = track.poses[-1] - log.truth.poses[-1]
        values.append(error @ np.linalg.solve(track.covariances[-1], error))
    assert abs(np.mean(values) - 3.0) < 3.5 * np.sqrt(6.0 / runs)


def test_the_same_seed_is_the_same_log():
    keywords = {
        "noise": sw.Noise(slip=0.01),
        "gyroscope": sw.Gyroscope(),
        "jitter": 0.002,
        "dropped": 0.1,
        "truth_noise": (1e-3, 1e-3),
    }
    one, same, other = (sw.simulate(PAIR, (TIMES, TWISTS), seed=seed, **keywords) for seed in (3, 3, 4))
    for name in ("stamps", "wheel_angles", "yaw_rate"):
        np.testing.assert_array_equal(getattr(one, name), getattr(same, name))
    np.testing.assert_array_equal(one.truth.poses, same.truth.poses)
    assert len(one) != len(other) or np.abs(one.wheel_angles - other.wheel_angles).max() > 0.0
    assert len(one) < 0.97 * 401
    steps = np.diff(one.stamps)
    assert steps.min() > 0.0
    assert np.ptp(steps[steps < 0.03]) > 0.002


def test_counters_tick_and_start_over_and_odometry_reads_them():
    wheels = sw.Encoder(64, gear_ratio=20.0, wraps_at=2**8)
    log = sw.simulate(PAIR, (TIMES, TWISTS), wheel_encoders=wheels)
    assert (log.wheel_angles == np.floor(log.wheel_angles)).all()
    assert log.wheel_angles.max() < 2**8
    track = sw.dead_reckon(PAIR, log)
    assert len(track.rows(sw.OdometryHealth.WRAPPED))
    tick = wheels.angle_per_tick * 0.1
    # A tick on one side turns the rover by a tick over the track, which 4 m of way swing.
    assert np.abs(track.poses - log.truth.poses).max() < 4.0 * 2 * tick / 0.4


def test_slip_happens_where_it_is_said():
    rover = ROVERS["six_wheel"]
    log = sw.simulate(rover, (TIMES, TWISTS), slip=Slip(3.0, 5.0, ["rear_right"], ratio=0.5))
    (window,) = sw.dead_reckon(rover, log, method="robust").slip_report().windows
    assert window.wheel == "rear_right"
    assert abs(window.start - 3.0) < 0.05
    assert abs(window.end - 5.0) < 0.05
    drifted = sw.simulate(PAIR, (TIMES, TWISTS), slip=Slip(3.0, 5.0, drift=(0.0, 0.1, 0.0)))
    assert abs(drifted.motion.poses[-1] - sw.simulate(PAIR, (TIMES, TWISTS)).motion.poses[-1])[:2].max() > 0.1


def test_a_path_of_poses_is_driven_through():
    rover = ROVERS["swerve"]
    corners = np.array([(0, 0, 0), (2, 0, 0), (2, 0, np.pi / 2), (2, 2, np.pi / 2), (1, 2, np.pi / 2)])
    log = sw.simulate(rover, corners, speed=0.5)
    poses = log.motion.poses
    for corner in corners:
        # Where the twist jumps, a row of 2.5 ms at 0.5 m/s has part of both arcs.
        assert np.abs(poses - corner).max(axis=1).min() < 3e-3
    # A path lies where its poses are, not where the origin is, unless it is moved.
    there = sw.simulate(rover, sw.compose((10.0, 11.0, 0.7), corners), speed=0.5)
    np.testing.assert_allclose(there.motion.poses, sw.compose((10.0, 11.0, 0.7), poses), atol=3e-3)
    moved = sw.simulate(rover, corners, speed=0.5, start=(10.0, 11.0, 0.7))
    np.testing.assert_allclose(moved.motion.poses, there.motion.poses, atol=3e-3)


def test_a_log_is_written_and_read_again(tmp_path):
    pytest.importorskip("pyarrow")
    from six_wheel.logs import LogOptions, read_log

    rover = ROVERS["tricycle"]
    log = sw.simulate(rover, (TIMES, TWISTS), gyroscope=sw.Gyroscope())
    for name in ("log.csv", "log.parquet"):
        write_log(log, rover, tmp_path / name)
        again, _ = read_log(tmp_path / name, rover, LogOptions())
        np.testing.assert_allclose(again.wheel_angles[:, 0], log.wheel_angles[:, 0], atol=1e-12)
        np.testing.assert_allclose(again.steering, log.steering, atol=1e-12)
        np.testing.assert_allclose(again.truth.poses, log.truth.poses, atol=1e-12)


def test_a_bag_is_written_and_read_again(tmp_path):
    pytest.importorskip("rosbags")
    pytest.importorskip("pyarrow")
    from six_wheel.logs import LogOptions, read_log

    rover = ROVERS["tricycle"]
    log = sw.simulate(rover, (TIMES, TWISTS), gyroscope=sw.Gyroscope())
    write_log(log, rover, tmp_path / "log.mcap")
    again, _ = read_log(tmp_path / "log.mcap", rover, LogOptions(), truth=tmp_path / "log.mcap")
    np.testing.assert_allclose(again.wheel_angles[:, 0], log.wheel_angles[:, 0], atol=1e-12)
    np.testing.assert_allclose(again.truth.poses, log.truth.poses, atol=1e-9)
    said, _ = read_log(
        tmp_path / "log.mcap", rover, LogOptions(truth_topic="/odom"), truth=tmp_path / "log.mcap"
    )
    steps = sw.dead_reckon(rover, log.steering, log.wheel_angles, log.stamps).poses
    np.testing.assert_allclose(said.truth.poses, steps, atol=1e-9)  # from the origin, as the truth


@pytest.mark.parametrize("name", ["log.csv", "log.parquet", "log.mcap"])
def test_counts_are_counts_wherever_they_are_written(tmp_path, name):
    """A rover with encoders in its file could be simulated into a table, but into no bag."""
    pytest.importorskip("rosbags")
    pytest.importorskip("pyarrow")
    from six_wheel.logs import LogOptions, read_log

    rover, ticks = ROVERS["tricycle"], {"ticks_per_turn": 512, "wraps_at": 4096}
    wheels, joints = sw.Encoder(512, wraps_at=4096), sw.Encoder(8192, wraps_at=8192)
    log = sw.simulate(rover, (TIMES, TWISTS), wheel_encoders=wheels, steering_encoders=joints)
    write_log(log, rover, tmp_path / name)
    known = LogOptions(wheel_encoders=ticks, steering_encoders={"ticks_per_turn": 8192, "wraps_at": 8192})
    again, _ = read_log(tmp_path / name, rover, known)
    plain = log.in_radians(rover)
    np.testing.assert_allclose(again.wheel_angles[:, 0], plain.wheel_angles[:, 0], atol=1e-12)
    np.testing.assert_allclose(again.steering, plain.steering, atol=1e-12)


def test_what_was_read_otherwise_is_written_as_what_was_turned(tmp_path):
    """Speeds were written under a header that said radians."""
    pytest.importorskip("pyarrow")
    from six_wheel.logs import read_log

    stamps = 0.1 * np.arange(50)
    for options in ({"readings": "speeds"}, {"increments": True}):
        values = np.stack((np.sin(stamps), np.cos(stamps)), axis=-1)
        log = sw.WheelLog(stamps, None, values, options=options)
        write_log(log, PAIR, tmp_path / "log.csv")
        again = read_log(tmp_path / "log.csv", PAIR)[0]
        np.testing.assert_allclose(again.wheel_angles, log.in_radians(PAIR).wheel_angles, atol=1e-12)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"rate": 0.0}, "rate must be finite and positive, got 0.0"),
        ({"jitter": -1.0}, "jitter must be finite and not negative, got -1.0"),
        ({"dropped": 1.0}, "dropped must be below 1, got 1.0"),
        ({"start": (0.0, np.nan, 0.0)}, "start must be three finite numbers"),
        ({"truth_noise": (0.0, np.inf)}, "truth_noise must be finite and not negative, got inf"),
        ({"slip": [Slip(0.0, 1.0, ["front"])]}, "wheels must be some of left, right, got 'front'"),
        ({"wheel_encoders": [sw.Encoder()]}, "wheel_encoders must be one or 2, got 1"),
        ({"truth_noise": (0.1,)}, "truth_noise must be two deviations"),
        ({"truth_noise": 0.1}, "truth_noise must be two deviations"),
        ({"seed": -1}, "seed must be a whole number, 0 or more, got -1"),
        ({"seed": "a"}, "seed must be a whole number, 0 or more, got 'a'"),
        ({"jitter": "a"}, "jitter must be a number, got 'a'"),
        ({"speed": 0.0}, "speed must be finite and positive, got 0.0"),
    ],
)
def test_what_it_refuses(keywords, message):
    with pytest.raises(ValueError, match=message):
        sw.simulate(PAIR, (TIMES, TWISTS), **keywords)


def test_paths_that_are_none():
    for path, message in (
        (np.zeros((3, 2)), "path must be rows of time, vx, vy, omega"),
        ((TIMES[::-1], TWISTS), "path must go on in time"),
        (np.zeros((2, 3)), "path must move"),
        (np.full((2, 4), np.nan), "path must be finite, got nan"),
        ("run.csv", "path must be rows of as many numbers each, got 'run.csv'"),
        ([(0, 1, 0, 0), (1, 1)], "path must be rows of as many numbers each"),
    ):
        with pytest.raises(ValueError, match=message):
            sw.simulate(PAIR, path)
    with pytest.raises(ValueError, match="ratio must be finite and below 1, got 1"):
        Slip(0.0, 1.0, ratio=1.0)


@pytest.mark.parametrize(
    ("rate", "rule"),
    [(1e-12, "at least two"), (0.2, "at least two"), (1e12, "at most 100,000,000"), (1e300, "at most")],
)
def test_rates_of_too_few_or_too_many_samples_are_named(rate: float, rule: str) -> None:
    """Too few were told as the shape of stamps, an argument that nobody had given."""
    drive = [(0.0, 0.1, 0.0, 0.0), (4.0, 0.1, 0.0, 0.0)]
    with pytest.raises(ValueError, match=f"rate must make {rule}.* samples of 4 s, got "):
        sw.simulate(sw.Rover.differential(0.4, 0.1), drive, rate=rate)
