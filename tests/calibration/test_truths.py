"""Forms of ground truth: positions without headings, gaps, a closed loop, headings alone."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("scipy")

import six_wheel as sw
from six_wheel.calibration import calibrate
from six_wheel.calibration import drives as _drives
from six_wheel.calibration import model as _model
from six_wheel.logs import GroundTruth, WheelLog
from six_wheel.robot_description import dimensions as _parameters
from tests.calibration.drives import drive
from tests.rovers import SMALL_PAIR as PAIR

TRUE = sw.Rover.differential(0.206, 0.0415)
SIZES = {"parameters": ["wheel_radius", "track_width"], "cross_validation": False}


def with_truth(log: WheelLog, truth: GroundTruth) -> WheelLog:
    return replace(log, truth=truth)


def positions(log: WheelLog) -> WheelLog:
    return with_truth(log, GroundTruth(log.truth.stamps, log.truth.poses[:, :2]))


@pytest.mark.parametrize("known", [slice(0, 2), slice(2, 3)], ids=["positions", "headings"])
def test_derivatives_are_those_of_finite_differences(known):
    log = drive(TRUE, 1, 20.0)
    poses = np.full((len(log), 3), np.nan)
    poses[:, known] = log.truth.poses[:, known]
    log = with_truth(log, GroundTruth(log.stamps, poses))
    catalogue = _parameters.Catalogue(PAIR, _drives.encoders(PAIR, [log]))
    model = _model.Model(PAIR, catalogue.find(catalogue.names))
    prepared = _drives.prepare(PAIR, log, _drives.default_lengths(PAIR), 0.5, 0)
    values = model.start + 0.2 * model.plausible * np.random.default_rng(2).normal(size=len(model.start))
    _, by = model.errors(prepared, values)
    for column, step in enumerate(1e-6 * np.maximum(model.plausible, 1e-2)):
        if model.names[column] == "time_offset":
            continue  # the truth is straight between its rows: differences across one are of no use
        moved = np.zeros(len(values))
        moved[column] = step
        ahead, behind = (model.errors(prepared, values + sign * moved)[0] for sign in (1.0, -1.0))
        # Rounding of positions of metres over steps of 1e-8 and more, and chords of 2 cm and more.
        np.testing.assert_allclose(by[:, :, column], (ahead - behind) / (2 * step), rtol=1e-4, atol=1e-4)


def test_positions_alone_tell_the_dimensions_but_no_heading():
    log = positions(drive(TRUE, 2, 60.0, noise=1e-3, sensor=(0.05, 0.02, 0.0)))
    options = {"parameters": ["wheel_radius", "track_width", "sensor"], "cross_validation": False}
    result = calibrate(PAIR, log, **options)
    assert result["wheel_radius"].value == pytest.approx(0.0415, rel=3e-3)
    assert result["track_width"].value == pytest.approx(0.206, rel=1e-2)
    assert result.sensor[:2] == pytest.approx((0.05, 0.02), abs=5e-3)
    assert not result["sensor_yaw"].identified
    assert any("positions alone" in message for message in result.observability.messages)
    assert result.runs[0].after < 0.2 * result.runs[0].before
    assert result.measured_noise is None
    assert calibrate(PAIR, log).chosen  # and sets are chosen by them


def test_nothing_is_made_up_across_a_gap():
    """Between 20 s and 29 s the truth is lost; straight across would be metres off."""
    log = drive(TRUE, 3, 60.0)
    kept = (log.truth.stamps < 20.0) | (log.truth.stamps > 29.0)
    truth = GroundTruth(log.truth.stamps[kept], log.truth.poses[kept])
    assert np.isnan(truth.at([20.5, 25.0, 28.9])).all()
    assert np.isfinite(truth.at([0.0, 10.0, 19.9, 29.1, 60.0])).all()
    assert np.isfinite(GroundTruth(truth.stamps, truth.poses, max_gap=10.0).at([25.0])).all()
    assert truth.covers([19.0, 19.99, 25.0], margin=0.5).tolist() == [True, False, False]
    result = calibrate(PAIR, with_truth(log, truth), **SIZES)
    np.testing.assert_allclose(result.values, (0.0415, 0.206), rtol=2e-3)
    assert result.runs[0].after < 0.01


def test_another_odometry_is_a_truth_over_its_short_stretches():
    """It wanders by a degree a metre and is calibrated by all the same: only motions are compared."""
    log = drive(TRUE, 4, 60.0)
    poses = log.truth.poses
    steps = sw.compose(_inverse(poses[:-1]), poses[1:])
    steps[:, 2] += np.random.default_rng(0).normal(0.0, 5e-4, len(steps))
    wandering = [poses[0]]
    for step in steps:
        wandering.append(sw.compose(wandering[-1], step))
    result = calibrate(PAIR, with_truth(log, GroundTruth(log.stamps, np.array(wandering))), **SIZES)
    np.testing.assert_allclose(result.values, (0.0415, 0.206), rtol=1e-2)
    said = calibrate(PAIR, log, sw.dead_reckon(TRUE, log), **SIZES).observability.messages
    assert any("what both err by alike does not show" in one for one in said)


def test_a_closed_loop_tells_ratios_and_no_scale():
    """Back where it began, known at four instants only, the first one between two rows of the log."""
    times = np.linspace(0.0, 90.0, 361)
    twists = np.stack((0.2 + 0 * times, 0 * times, 2 * np.pi / 30.0 + 0 * times), axis=-1)
    log = sw.simulate(sw.Rover.differential(0.206, 0.042), (times, twists), rate=20.0)
    begin = 0.013
    laps = begin + 30.0 * np.arange(3)
    poses = log.motion.poses
    at = [np.interp(laps, log.motion.stamps, poses[:, k]) for k in range(3)]
    seen = sw.WheelLog(log.stamps, None, log.wheel_angles, GroundTruth(laps, np.stack(at, axis=1)))
    result = calibrate(PAIR, seen, parameters=["track_width"], cross_validation=False)
    assert result["track_width"].value == pytest.approx(0.206, rel=1e-3)
    both = calibrate(PAIR, seen, **SIZES)
    assert not both["wheel_radius"].identified
    assert any("a closed loop alone tells ratios" in one for one in both.observability.messages)
    assert both["track_width"].value / both["wheel_radius"].value == pytest.approx(0.206 / 0.042, rel=1e-3)


def test_a_gyroscope_alone_tells_the_ratio_of_radius_and_track():
    times = np.linspace(0.0, 60.0, 121)
    twists = np.stack((0.2 + 0 * times, 0 * times, 0.5 * np.sin(0.5 * times)), axis=-1)
    twists[:20] = 0.0  # at rest, where the bias shows
    gyroscope = sw.Gyroscope(0.002, bias_noise=0.02, bias_walk=0.0)
    log = sw.simulate(TRUE, (times, twists), gyroscope=gyroscope, rate=20.0, seed=1)
    alone = replace(log, truth=None)
    start = sw.Rover.differential(0.2, 0.0415)
    result = calibrate(start, alone, parameters=["track_width"], cross_validation=False)
    assert result["track_width"].value == pytest.approx(0.206, rel=3e-3)
    both = calibrate(PAIR, alone, **SIZES)
    assert not both["wheel_radius"].identified
    assert both["track_width"].value / both["wheel_radius"].value == pytest.approx(0.206 / 0.0415, rel=3e-3)
    assert any("a gyroscope alone tells turns" in message for message in both.observability.messages)
    # Errors of headings were called metres.
    assert "rms heading error" in repr(both)
    assert "position error" not in repr(both)
    assert both.runs[0].unit == "rad"
    assert "| calibrated [rad] |" in both.to_markdown()
    restless = replace(alone, wheel_angles=alone.wheel_angles + 0.1 * alone.stamps[:, None])
    with pytest.raises(ValueError, match="must stand still for 1 s at least"):
        calibrate(start, restless, parameters=["track_width"])


def test_parts_in_which_it_stands_are_said():
    log = drive(TRUE, 5, 30.0)
    stamps = np.concatenate((log.stamps, log.stamps[-1] + 0.05 * np.arange(1, 401)))
    angles = np.concatenate((log.wheel_angles, np.tile(log.wheel_angles[-1], (400, 1))))
    poses = np.concatenate((log.truth.poses, np.tile(log.truth.poses[-1], (400, 1))))
    result = calibrate(PAIR, sw.WheelLog(stamps, None, angles, poses), **SIZES)
    np.testing.assert_allclose(result.values, (0.0415, 0.206), rtol=2e-3)
    assert any("stands for 20.0 s of 50.0 s" in message for message in result.observability.messages)


def test_what_a_truth_refuses():
    stamps = np.arange(3.0)
    for poses, message in (
        (np.full((3, 3), np.nan), "poses must have positions or headings"),
        ([(0, 0, 0), (1, 0, np.nan), (2, 0, 0)], "poses must be finite"),
        (np.zeros((3, 4)), r"poses must have shape \(n, 3\)"),
    ):
        with pytest.raises(ValueError, match=message):
            GroundTruth(stamps, poses)
    with pytest.raises(ValueError, match="max_gap must be positive, got 0"):
        GroundTruth(stamps, np.zeros((3, 3)), max_gap=0.0)


def _inverse(poses):
    from six_wheel.kinematics.poses import inverse

    return inverse(poses)


def test_what_dead_reckon_takes_is_calibrated(tmp_path):
    log = drive(TRUE, 1, 20.0)
    columns = {"time": log.stamps, "left": log.wheel_angles[:, 0], "right": log.wheel_angles[:, 1]}
    path = tmp_path / "log.csv"
    rows = np.column_stack((*columns.values(), log.truth.poses))
    header = "time,left [rad],right [rad],x,y,yaw"
    np.savetxt(path, rows, "%.17g", ",", header=header, comments="")
    values = calibrate(PAIR, log, **SIZES).values
    for logs, truth in (
        ((one for one in [log]), None),
        (path, None),
        ([str(path)], None),
        (columns, log),
        ([columns], [log.truth]),
    ):
        np.testing.assert_allclose(calibrate(PAIR, logs, truth, **SIZES).values, values, rtol=1e-9)
    track = sw.dead_reckon(TRUE, log)  # a truth but for rounding
    assert calibrate(PAIR, log, track, **SIZES).values == pytest.approx((0.0415, 0.206), rel=1e-6)


@pytest.mark.parametrize("truth", [5, "truth.csv"])
def test_what_is_no_truth_is_named(truth):
    """A path was told that nine had been given for one."""
    with pytest.raises(
        TypeError, match="truth must be a GroundTruth, poses, a WheelLog that has one or a Track"
    ):
        calibrate(PAIR, drive(TRUE, 1, 10.0), truth, **SIZES)


@pytest.mark.parametrize(
    ("logs", "kind"), [(5, "int"), (None, "NoneType"), ([5], "int"), (np.zeros((9, 2)), "ndarray")]
)
def test_what_is_no_log_is_named(logs, kind):
    with pytest.raises(TypeError, match=f"logs must be Logs, paths or tables of columns, got {kind}"):
        calibrate(PAIR, logs, **SIZES)


def test_a_reading_that_is_missing_is_left_out():
    log = drive(TRUE, 1, 20.0)
    angles = log.wheel_angles.copy()
    angles[[50, 300], 0] = np.nan
    found = calibrate(PAIR, replace(log, wheel_angles=angles), **SIZES)
    # Two of 401 rows that say the same.
    np.testing.assert_allclose(found.values, calibrate(PAIR, log, **SIZES).values, rtol=1e-4)
