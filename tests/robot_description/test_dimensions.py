"""Dimensions that are not known for sure err the same all along the way, and enter the covariance."""

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.calibration import deviations
from six_wheel.robot_description.wheels_of_rover import with_wheels
from tests.kinematics.odometry.test_preintegrated import DIMENSIONS, ROVERS, drive

NUMBERS = len(DIMENSIONS) + 2
READINGS = sw.Noise(speed=0.01, slip=0.01)
NONE = sw.Noise(0.0, 0.0)
BAND = 3.5  # deviations of chance


def moved(rover, table):
    """The rover whose wheels have numbers that are off by a table (wheels, 9), readings aside."""
    changes = []
    for wheel, row in zip(rover.wheels, table, strict=True):
        off = dict(zip(DIMENSIONS, row, strict=False))
        changes.append(
            {name: getattr(wheel, name) + by for name, by in off.items() if getattr(wheel, name) is not None}
        )
    return with_wheels(rover, changes)


KINDS = {"angles": {}, "speeds": {"readings": "speeds"}, "increments": {"increments": True}}


def read(rover, readings):
    """Readings of this kind along a wandering path."""
    steering, totals, stamps = drive(rover)
    steps = np.diff(totals, axis=0, prepend=totals[:1])
    return steering, {"angles": totals, "speeds": steps / 0.05, "increments": steps}[readings], stamps


def end(rover, table, readings="angles"):
    """End pose of a rover whose dimensions are off by a table and whose readings are off by theirs."""
    steering, totals, stamps = read(rover, readings)
    if steering is not None:
        steering = steering * (1.0 + table[[wheel.steered for wheel in rover.wheels], 8])
    turned = totals * (1.0 + table[:, 7])
    return sw.dead_reckon(moved(rover, table), steering, turned, stamps, **KINDS[readings]).poses[-1]


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
@pytest.mark.parametrize("readings", KINDS)
def test_it_is_that_of_the_derivatives_of_the_end(rover, readings):
    """To a thousandth of the whole: how an arc's chord answers to a steering angle is left out."""
    tables = 1e-3 * np.random.default_rng(0).normal(size=(3, len(rover.wheels), NUMBERS))
    by = [(end(rover, 1e-2 * t, readings) - end(rover, -1e-2 * t, readings)) / 2e-2 for t in tables]
    options = {"noise": NONE, "residuals": False} | KINDS[readings]
    track = sw.dead_reckon(rover, *read(rover, readings), dimensions=tables, **options)
    wanted = np.array(by).T @ np.array(by)
    np.testing.assert_allclose(track.covariances[-1], wanted, atol=1e-3 * np.trace(wanted))
    # And it adds to what the readings make of it.
    noisy = options | {"noise": READINGS}
    both = sw.dead_reckon(rover, *read(rover, readings), dimensions=tables, **noisy).covariances[-1]
    alone = sw.dead_reckon(rover, *read(rover, readings), **noisy).covariances[-1]
    np.testing.assert_allclose(both, track.covariances[-1] + alone, atol=1e-12)
    # By another way to the same sums, but for rounding.
    np.testing.assert_allclose(track.poses[-1], end(rover, 0.0 * tables[0], readings), atol=1e-12)


def test_the_twist_may_be_off_by_them():
    rover = ROVERS["differential"]
    table = np.zeros((1, 2, NUMBERS))
    table[0, :, 0] = 0.002  # both radii by 2 %
    odometry = sw.Odometry(rover, NONE, dimensions=table)
    for k in range(3):
        state = odometry.update(None, (0.5 * k, 0.5 * k), 0.1 * k)
    np.testing.assert_allclose(np.sqrt(np.diag(state.twist_covariance)), (0.01, 0, 0), atol=1e-12)


def test_a_late_pose_is_worth_as_much_as_a_timely_one():
    rover = ROVERS["tricycle"]
    tables = 3e-3 * np.random.default_rng(1).normal(size=(2, 3, NUMBERS))
    steering, totals, stamps = drive(rover)
    ends = []
    for late in (0, 20):
        odometry = sw.Odometry(rover, READINGS, dimensions=tables, lag=2.0)
        for k, stamp in enumerate(stamps):
            state = odometry.update(steering[k], totals[k], stamp)
            if k == 80 + late:
                odometry.correct((2.0, 0.1, 0.3), stamps[80], (1e-4, 1e-4, 1e-4))
        ends.append(odometry.state)
        del state
    np.testing.assert_allclose(ends[0].covariance, ends[1].covariance, atol=1e-14)
    # Knowledge of the pose does not teach the dimensions: the end is less sure than by readings alone.
    plain = sw.Odometry(rover, READINGS)
    for k, stamp in enumerate(stamps):
        plain.update(steering[k], totals[k], stamp)
        if k == 80:
            plain.correct((2.0, 0.1, 0.3), stamp, (1e-4, 1e-4, 1e-4))
    assert np.linalg.eigvalsh(ends[0].covariance - plain.state.covariance).min() > -1e-12
    assert np.trace(ends[0].covariance) > 1.1 * np.trace(plain.state.covariance)


def test_a_heading_that_is_known_is_not_off():
    rover = ROVERS["differential"]
    table = np.zeros((1, 2, NUMBERS))
    table[0, :, 2] = (0.01, -0.01)  # the track
    odometry = sw.Odometry(rover, sw.Noise(0.0, 0.0, yaw=0.0), dimensions=table)
    free = sw.Odometry(rover, sw.Noise(0.0, 0.0, yaw=0.02), dimensions=table)
    for k in range(100):
        state = odometry.update(None, (0.05 * k, 0.1 * k), 0.1 * k, yaw=0.0125 * k)
        other = free.update(None, (0.05 * k, 0.1 * k), 0.1 * k)
    assert state.covariance[2, 2] < 1e-15
    assert other.covariance[2, 2] == pytest.approx((0.0125 * 99 * 0.02 / 0.4) ** 2)
    # A zero that is learnt on the way is off by what the heading was off by there: it tells next to nothing.
    for k in range(100, 102):
        other = free.update(None, (0.05 * k, 0.1 * k), 0.1 * k, yaw=0.0125 * k)
    assert other.covariance[2, 2] == pytest.approx((0.0125 * 101 * 0.02 / 0.4) ** 2, rel=0.01)


KNOWN = {
    "differential": (("wheel_radius", "track_width"), (0.0005, 0.004)),
    "tricycle": (("wheel_radius", "wheelbase", "steering_offset[front]"), (0.0005, 0.005, 0.002)),
    "omni": (("wheel_radius", "arm_length"), (0.0003, 0.002)),
}


@pytest.mark.parametrize("name", KNOWN)
def test_rovers_that_are_drawn_end_where_they_may(name):
    """NEES over simulated logs of rovers drawn from what is known of the nominal one: in its band with it."""
    rover, (names, sizes) = ROVERS[name], KNOWN[name]
    tables = deviations(rover, names, np.diag(np.square(sizes)))
    noise, count = sw.Noise(0.0, 0.0, slip=0.001, side_slip=0.001), 60
    times = np.linspace(0.0, 30.0, 61)
    squares = {True: 0.0, False: 0.0}
    for seed in range(count):
        random = np.random.default_rng(seed)
        shift = random.uniform(0, 6, size=3)
        twists = np.stack(
            [0.3 * (b + np.sin(0.3 * times + a)) for a, b in zip(shift, (2, 0, 0), strict=True)], -1
        )
        true = moved(rover, np.tensordot(random.normal(size=len(tables)), tables, 1))
        log = sw.simulate(
            true, (times, true.project(twists, keep="nearest")), noise=noise, rate=10.0, seed=seed
        )
        for known in squares:
            track = sw.dead_reckon(
                rover, log, noise=noise, dimensions=tables if known else None, residuals=False
            )
            error = track.poses[-1] - log.truth.poses[-1]
            error[2] = sw.wrap_angle(error[2])
            squares[known] += error @ np.linalg.solve(track.covariances[-1], error) / count
    chance = BAND * np.sqrt(2.0 * 3.0 / count)
    assert abs(squares[True] - 3.0) < chance
    assert squares[False] > 3.0 + 3.0 * chance


def test_what_is_no_covariance_of_dimensions_is_refused():
    rover = ROVERS["differential"]
    good = np.zeros((1, 2, NUMBERS))
    for wrong, rule in (
        (good[0], r"dimensions must have shape \(k, 2, 9\)"),
        (good[:, :1], r"dimensions must have shape \(k, 2, 9\)"),
        (good + np.nan, r"dimensions.* must be finite"),
        (good + np.inf, r"dimensions.* must be finite"),
        (good + 1e70, r"dimensions.* must be finite"),
    ):
        with pytest.raises(ValueError, match=rule):
            sw.Odometry(rover, dimensions=wrong)
    names = ["wheel_radius", "track_width"]
    for covariance in (np.eye(3), [[np.nan, 0], [0, 1]], [[-1, 0], [0, 1]]):
        with pytest.raises(ValueError, match="covariance must be a finite covariance of 2 values"):
            deviations(rover, names, covariance)
    with pytest.raises(ValueError, match="parameters must be some of"):
        deviations(rover, ["wheelbase"], [[1.0]])
    with pytest.raises(ValueError, match="parameters must be single ones"):
        deviations(rover, ["wheel_radii"], [[1.0]])
    # None at all is none.
    steering, totals, stamps = drive(rover)
    plain = sw.dead_reckon(rover, steering, totals, stamps)
    for nothing in (np.zeros((0, 2, NUMBERS)), deviations(rover, [], np.empty((0, 0)))):
        track = sw.dead_reckon(rover, steering, totals, stamps, dimensions=nothing)
        np.testing.assert_array_equal(track.covariances, plain.covariances)


def test_each_wheel_slips_by_its_own_noise():
    rover = ROVERS["mecanum"]
    slip = sw.Noise(0.0, 0.0, slip=0.01)
    names = rover.wheel_names

    def spread(**options):
        return sw.dead_reckon(rover, *drive(rover), noise=slip, residuals=False, **options).covariances[-1]

    alone = [spread(wheel_noise=row) for row in np.eye(len(names))]
    np.testing.assert_allclose(np.sum(alone, axis=0), spread(), rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(spread(wheel_noise=[2.0] * 4), 4.0 * spread(), rtol=1e-9, atol=1e-15)
    np.testing.assert_array_equal(spread(wheel_noise={names[1]: 3.0}), spread(wheel_noise=[1, 3, 1, 1]))
    for wrong, rule in (
        ([1.0, 1.0], r"wheel_noise must have shape \(4,\)"),
        ({"fifth": 1.0}, f"wheel_noise must name some of {', '.join(names)}"),
        ([1.0, -1.0, 1.0, 1.0], "wheel_noise must be finite and not negative"),
        ([1.0, np.nan, 1.0, 1.0], "wheel_noise must be finite and not negative"),
    ):
        with pytest.raises(ValueError, match=rule):
            spread(wheel_noise=wrong)
