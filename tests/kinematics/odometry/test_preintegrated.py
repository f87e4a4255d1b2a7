"""Pre-integrated motion: parts and whole, derivatives, honest at any rate, and graphs that use it."""

import copy
import re
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from tests.rovers import OMNI, PAIR, SIX_WHEELS, SMALL_MECANUM, SMALL_TRICYCLE

ROVERS = {
    "six_wheel": SIX_WHEELS,
    "differential": PAIR,
    "tricycle": SMALL_TRICYCLE,
    "mecanum": SMALL_MECANUM,
    "omni": OMNI,
}
NOISE = sw.Noise(speed=0.01, steering=0.005, slip=0.01, side_slip=0.02)
DIMENSIONS = ("radius", "x", "y", "heading", "scrub", "trail", "roller_angle")


def drive(rover, seconds=6.0, dt=0.05):
    """Readings along a wandering path: steering (n, joints) or None, totals (n, wheels), stamps (n,)."""
    stamps = np.arange(round(seconds / dt) + 1) * dt
    twists = np.stack(
        (0.5 + 0.1 * np.sin(stamps), 0.1 * np.sin(0.7 * stamps), 0.4 * np.sin(0.9 * stamps)), -1
    )
    steering, speeds = rover.inverse(rover.project(twists, keep="nearest"))
    totals = np.zeros_like(speeds)
    totals[1:] = np.cumsum(dt * (speeds[1:] + speeds[:-1]) / 2, axis=0)
    totals[:, [not wheel.driven for wheel in rover.wheels]] = np.nan
    return (steering if steering.shape[1] else None), totals, stamps


def motion(rover, rows=slice(None), noise=NOISE, built=None, **options):
    """Of what the encoders of `rover` report, as another rover understands it."""
    steering, totals, stamps = drive(rover)
    pre = sw.Preintegrated(built or rover, noise, **options)
    pre.add(None if steering is None else steering[rows], totals[rows], stamps[rows])
    return pre


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_it_is_the_motion_of_odometry(rover):
    track = sw.dead_reckon(rover, *drive(rover), noise=NOISE)
    pre = motion(rover)
    np.testing.assert_array_equal(pre.delta, track.poses[-1])
    # Rounding of two ways to the same sums.
    np.testing.assert_allclose(pre.covariance_in("coordinates"), track.covariances[-1], atol=1e-15)
    end, turn = pre.covariance, pre.delta[2]
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    np.testing.assert_allclose(rotation @ end @ rotation.T, track.covariances[-1], atol=1e-14)


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_a_sample_at_a_time_is_the_whole_log(rover):
    steering, totals, stamps = drive(rover)
    pre = sw.Preintegrated(rover, NOISE)
    for k, stamp in enumerate(stamps):
        pre.add(None if steering is None else steering[k], totals[k], stamp)
    assert len(pre) == len(stamps)
    np.testing.assert_array_equal(pre.delta, motion(rover).delta)
    log = sw.Preintegrated(rover, NOISE)
    log.add(sw.WheelLog(stamps, steering, totals))
    np.testing.assert_array_equal(log.delta, pre.delta)


@pytest.mark.parametrize("stamp", [0.0, 0.02, 2.0, 2.0123, 5.99, 6.0])
@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_parts_make_the_whole(rover, stamp):
    whole = motion(rover)
    a, b = whole.split(stamp)
    assert a.begin == 0.0
    assert a.end == b.begin == stamp
    assert b.end == whole.end
    # The law asks for 1e-12; rounding over some hundred steps of centimetres is below it.
    np.testing.assert_allclose(sw.compose([a.delta], [b.delta])[0], whole.delta, atol=1e-12)
    again = a.merge(b)
    np.testing.assert_allclose(again.delta, whole.delta, atol=1e-12)
    np.testing.assert_allclose(again.covariance, whole.covariance, atol=1e-15)
    for name in DIMENSIONS:
        np.testing.assert_allclose(again.by_dimension[name], whole.by_dimension[name], atol=1e-12)


def test_a_shared_reading_errs_in_both_motions():
    rover = ROVERS["six_wheel"]
    noise = sw.Noise(speed=0.0, steering=0.01)  # only what the two share
    whole = motion(rover, noise=noise)
    a, b = whole.split(3.0)
    turn = b.delta
    c, s = np.cos(turn[2]), np.sin(turn[2])
    # begin_from_end seen from the end: what carries errors of a to the end of b
    back = np.array([[c, s, s * turn[0] - c * turn[1]], [-s, c, c * turn[0] + s * turn[1]], [0, 0, 1]])
    apart = back @ a.covariance @ back.T + b.covariance
    assert np.abs(apart - whole.covariance).max() > 1e-3 * whole.covariance.max()
    np.testing.assert_allclose(a.merge(b).covariance, whole.covariance, atol=1e-15)


def changed(rover, wheel, name, by):
    from six_wheel.robot_description.wheels_of_rover import with_wheels

    changes = [{} for _ in rover.wheels]
    changes[wheel] = {name: (getattr(rover.wheels[wheel], name) or 0.0) + by}
    return with_wheels(rover, changes)


@pytest.mark.parametrize("name", ["radius", "x", "y", "scrub", "trail"])
@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_derivatives_are_differences(rover, name):
    pre, step = motion(rover), 1e-6
    for wheel, one in enumerate(rover.wheels):
        if one.roller_angle is not None and name in ("scrub", "trail"):
            continue  # a wheel of rollers has neither
        ends = [motion(rover, built=changed(rover, wheel, name, sign * step)).delta for sign in (1, -1)]
        apart = [sw.log(sw.compose([inverse(pre.delta)], [end])[0], 1.0) for end in ends]
        difference = (apart[0] - apart[1]) / (2 * step)
        np.testing.assert_allclose(pre.by_dimension[name][:, wheel], difference, atol=1e-7)


def inverse(pose):
    x, y, yaw = pose
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array((-c * x - s * y, s * x - c * y, -yaw))


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_a_radius_one_percent_off_is_corrected(rover):
    """To 1 % of the motion for one wheel, to 1 % of the correction for all: the rest is of second order."""
    pre = motion(rover)
    for wheels, measure in ((slice(0, 1), pre.delta), (slice(None), None)):
        change = np.zeros(len(rover.wheels))
        change[wheels] = 0.01 * np.array([wheel.radius for wheel in rover.wheels])[wheels]
        built = rover
        for wheel in np.flatnonzero(change):
            built = changed(built, wheel, "radius", change[wheel])
        wanted = motion(rover, built=built).delta
        left = np.abs(pre.corrected({"radius": change}) - wanted).max()
        assert left < 0.01 * np.abs(wanted - pre.delta if measure is None else measure).max()


def test_slip_and_bias_have_their_derivatives():
    rover = ROVERS["differential"]
    pre = motion(rover)
    # A share of the way as slip is the same share of the radius.
    radii = np.array([wheel.radius for wheel in rover.wheels])
    np.testing.assert_allclose(pre.by_slip["slip"], pre.by_dimension["radius"] * radii, atol=1e-14)
    assert not pre.by_gyroscope_bias.any()
    steering, totals, stamps = drive(rover)

    def with_bias(bias):
        fused = sw.Preintegrated(rover, NOISE, gyroscope=sw.Gyroscope(noise=0.01, bias=bias))
        fused.add(steering, totals, stamps, yaw_rate=0.4 * np.sin(0.9 * stamps) + 0.02)
        return fused

    pre = with_bias(0.02)
    ends = [
        sw.log(sw.compose([inverse(pre.delta)], [with_bias(0.02 + d).delta])[0], 1.0) for d in (1e-6, -1e-6)
    ]
    np.testing.assert_allclose(pre.by_gyroscope_bias, (ends[0] - ends[1]) / 2e-6, atol=1e-7)
    assert abs(pre.by_gyroscope_bias[2]) > 1.0  # 6 s of it


@pytest.mark.parametrize("in_space", [False, True])
def test_residuals_have_their_derivatives(in_space):
    rover = ROVERS["six_wheel"]
    steering, totals, stamps = drive(rover)
    pre = sw.Preintegrated(rover, NOISE, in_space=in_space)
    tilt = 0.1 * np.sin(stamps)
    attitude = np.stack((np.sin(tilt), 0 * tilt, 0 * tilt, np.cos(tilt)), -1) if in_space else None
    pre.add(steering, totals, stamps, attitude=attitude)
    size, exp = (6, exp3) if in_space else (3, lambda e: sw.exp(e, 1.0))
    compose = np.matmul if in_space else lambda a, b: sw.compose([a], [b])[0]
    start = exp(np.array((0.5, -0.2, 0.1, 0.2, -0.1, 0.7)[:size]))
    end = compose(compose(start, pre.delta), exp(np.linspace(-0.05, 0.08, size)))
    changes = {"radius": np.linspace(-1e-3, 1e-3, 6), "gyroscope_bias": 0.0}
    error, by_i, by_j, by = pre.factor(start, end, changes)
    assert error.shape == (size,)

    def difference(at, count, step=1e-6):
        moves = step * np.eye(count)
        return np.stack([(at(move) - at(-move)) / (2 * step) for move in moves], axis=-1)

    def radii(move):
        return pre.factor(start, end, changes | {"radius": changes["radius"] + move})[0]

    by_start = difference(lambda e: pre.factor(compose(start, exp(e)), end, changes)[0], size)
    by_end = difference(lambda e: pre.factor(start, compose(end, exp(e)), changes)[0], size)
    np.testing.assert_allclose(by_i, by_start, atol=1e-7)
    np.testing.assert_allclose(by_j, by_end, atol=1e-7)
    np.testing.assert_allclose(by["radius"], difference(radii, 6), atol=1e-7)
    none, *_ = pre.residual(start, compose(start, pre.delta))
    np.testing.assert_allclose(none, 0.0, atol=1e-12)


def exp3(tangent):
    """SE(3) by its power series: slow and sure."""
    x, y, z, a, b, c = tangent
    algebra = np.array([[0, -c, b, x], [c, 0, -a, y], [-b, a, 0, z], [0, 0, 0, 0]])
    term, total = np.eye(4), np.eye(4)
    for k in range(1, 30):
        term = term @ algebra / k
        total = total + term
    return total


def test_a_level_attitude_is_the_plane():
    rover = ROVERS["six_wheel"]
    steering, totals, stamps = drive(rover)
    flat = motion(rover)
    yaws = np.array([motion(rover, slice(0, k)).delta[2] for k in range(1, len(stamps) + 1)])
    attitude = np.stack((0 * yaws, 0 * yaws, np.sin(yaws / 2), np.cos(yaws / 2)), -1)
    pre = sw.Preintegrated(rover, NOISE, in_space=True, attitude_noise=0.02)
    pre.add(steering, totals, stamps, attitude=attitude)
    x, y, yaw = flat.delta
    c, s = np.cos(yaw), np.sin(yaw)
    level = np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]])
    np.testing.assert_allclose(pre.delta, level, atol=1e-12)
    np.testing.assert_allclose(pre.covariance[2, 3:5], pre.covariance[3:5, 2], atol=1e-18)
    assert np.linalg.eigvalsh(pre.covariance).min() > -1e-15
    # The tilt of an absolute attitude errs at both ends, however long the way.
    np.testing.assert_allclose(np.diag(pre.covariance)[3:5], 2 * 0.02**2, rtol=1e-9)


def test_it_is_as_honest_at_any_rate():
    """Slip per root metre, one drive, read at 10, 50 and 200 Hz: the same NEES.

    A mean of chi-square with 3 degrees of freedom over n runs deviates by sqrt(6 / n); 4 of these bound it.
    """
    rover, noise = ROVERS["differential"], sw.Noise(speed=0.0, slip=0.02, side_slip=0.0)
    random, runs, dt = np.random.default_rng(5), 200, 1 / 200
    stamps = np.arange(1001) * dt
    rates = rover.inverse(np.stack((0.5 + 0 * stamps, 0 * stamps, 0.8 * np.sin(1.3 * stamps)), -1)[1:])[1]
    way = np.abs(rates) * 0.1 * dt
    exact = np.concatenate((np.zeros((1, 2)), np.cumsum(rates * dt, axis=0)))
    end = sw.dead_reckon(rover, None, exact, stamps).poses[-1]
    means = []
    slid = random.normal(size=(runs, *way.shape)) * 0.02 * np.sqrt(way) / 0.1
    for every in (20, 4, 1):
        values = []
        for run in range(runs):
            totals = exact.copy()
            totals[1:] -= np.cumsum(slid[run], axis=0)
            pre = sw.Preintegrated(rover, noise)
            pre.add(None, totals[::every], stamps[::every])
            error = pre.residual((0, 0, 0), end)[0]
            # Nothing slips across: a floor keeps the covariance regular.
            values.append(error @ np.linalg.solve(pre.covariance + 1e-9 * np.eye(3), error))
        means.append(np.mean(values))
    assert np.ptp(means) < 0.05
    assert abs(means[0] - 3.0) < 4 * np.sqrt(6 / runs)


def test_what_it_refuses():
    rover = ROVERS["six_wheel"]
    steering, totals, stamps = drive(rover)
    pre = motion(rover)
    before, count = pre.delta, len(pre)
    bad = totals + 1.0
    bad[50, 2] = np.nan
    late = stamps + 10.0
    with pytest.raises(ValueError, match=r"wheel_angles\[50\] must be finite"):
        pre.add(steering, bad, late)
    with pytest.raises(ValueError, match=r"stamp\[0\] must be later than the last one, 6"):
        pre.add(steering, totals, stamps)
    np.testing.assert_array_equal(pre.delta, before)
    assert len(pre) == count
    for call, message in (
        (lambda: pre.add(steering[0], totals[0], 7.0, attitude=(0, 0, 0, 1)), "attitude must be left out"),
        (lambda: pre.add(steering[0]), "come together with wheel_angles and stamp"),
        (lambda: pre.split(np.nan), "stamp must be between 0.0 and 6.0, got nan"),
        (lambda: pre.merge(pre), "other must begin where this one ends"),
        (lambda: pre.merge(motion(ROVERS["mecanum"])), "other must be of the same rover"),
        (lambda: pre.covariance_in("start"), "tangent must be 'end', 'begin' or 'coordinates'"),
        (lambda: pre.corrected({"colour": 1}), "changes must name some of radius"),
        (lambda: pre.corrected({"radius": [1, 2]}), "changes must have 1 or 6 numbers for radius, got 2"),
        (lambda: pre.residual((0, 0, np.nan), (0, 0, 0)), "pose_i must be finite"),
        (lambda: sw.Gyroscope(noise=-1.0), "noise must be finite and not negative, got -1"),
        (lambda: sw.Preintegrated(rover, attitude_noise=-1.0), "attitude_noise must be finite"),
        (
            lambda: sw.Preintegrated(rover, in_space=True).add(steering, totals, stamps),
            "attitude[0] must come with every sample",
        ),
    ):
        with pytest.raises(ValueError, match=re.escape(message)):
            call()


def test_without_samples_nothing_moved():
    pre = sw.Preintegrated(ROVERS["mecanum"])
    assert (len(pre), pre.begin, pre.end, pre.duration) == (0, None, None, 0.0)
    assert not pre.delta.any()
    assert not pre.covariance.any()
    assert pre.merge(pre).delta.tolist() == [0.0, 0.0, 0.0]
    assert copy.deepcopy(pre).delta.tolist() == [0.0, 0.0, 0.0]
    with pytest.raises(ValueError, match="stamp must lie within the samples"):
        pre.split(0.0)


def test_the_graph_of_the_page_closes_its_loop_and_finds_the_radii():
    pytest.importorskip("gtsam")
    page = (Path(__file__).parents[3] / "docs" / "howto" / "graphs.md").read_text(encoding="utf-8")
    shown: dict = {}
    exec(re.search(r"```python\n(.*?)```", page, re.S)[1], shown)
    # The logs are exact: what is left is what the optimiser leaves.
    np.testing.assert_allclose(shown["radii"], (0.102, 0.099), atol=1e-6)
    assert np.hypot(*shown["before"][:2]) > 0.5
