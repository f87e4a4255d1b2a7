"""Slip where wheels cannot tell: found in time by a truth or a gyroscope, and left out of a calibration."""

import math

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.kinematics.odometry.tracks import (
    SILENT,
    SlipReport,
    SlipWindow,
    WheelContradiction,
    can_contradict,
)
from six_wheel.log_odometry.evaluation import evaluate, slip_against
from six_wheel.logs import GroundTruth, WheelLog
from six_wheel.simulation.planar import Slip
from tests.rovers import SIX_SIZES, SIX_WHEELS, SMALL_PAIR

PAIR = sw.Rover.differential(0.5, (0.1, 0.102))
STEP, FIRST, LAST = 0.02, 3400, 3550  # [s]; rows in which the left wheel slips


def slipped(rover=PAIR, slip=0.5, count=6000):
    """A winding drive whose left wheel turns `1 / (1 - slip)` times as fast for 3 s, with its truth."""
    times = STEP * np.arange(count)
    twists = np.stack(
        (
            0.3 + 0.1 * np.sin(0.11 * times),
            0 * times,
            0.5 * np.sin(0.3 * times) + 0.3 * np.sin(0.071 * times),
        ),
        -1,
    )
    _, speeds = rover.inverse(twists)
    truth = sw.integrate(twists[1:], STEP)
    speeds[FIRST:LAST, 0] /= 1.0 - slip
    turned = np.vstack((np.zeros(speeds.shape[1]), np.cumsum(STEP * speeds[1:], axis=0)))
    return WheelLog(times, None, turned, truth, "slid"), twists


@pytest.mark.parametrize("noise", [0.0, 0.001])
def test_a_truth_tells_when_it_was(noise):
    log, _ = slipped()
    truth = GroundTruth(
        log.stamps, log.truth.poses + noise * np.random.default_rng(0).normal(size=(len(log), 3))
    )
    for rover in (PAIR, sw.Rover.differential(0.52, 0.101)):  # a dimension that is wrong is no slip
        (found,) = slip_against(sw.dead_reckon(rover, log), truth)
        # Half a window to either side.
        assert abs(found.start - STEP * FIRST) < 0.25
        assert abs(found.end - STEP * LAST) < 0.25
        assert 0.3 < found.distance < 1.0


def test_a_gyroscope_tells_it_too_whatever_its_bias():
    log, twists = slipped()
    rate = twists[:, 2] + 0.02 + 0.01 * np.random.default_rng(1).normal(size=len(log))
    rate[5] = math.nan
    (found,) = slip_against(sw.dead_reckon(PAIR, log), yaw_rate=rate)
    assert abs(found.start - STEP * FIRST) < 0.3
    assert abs(found.end - STEP * LAST) < 0.3


def test_no_slip_is_no_stretch():
    log, twists = slipped(slip=0.0)
    track = sw.dead_reckon(PAIR, log)
    assert slip_against(track, log.truth) == ()
    assert slip_against(track, yaw_rate=twists[:, 2]) == ()
    with pytest.raises(ValueError, match="truth or yaw_rate must be given"):
        slip_against(track)
    with pytest.raises(ValueError, match="yaw_rate must have shape"):
        slip_against(track, yaw_rate=np.zeros(3))


def test_wheels_that_cannot_contradict_each_other_say_so():
    log, _ = slipped()
    report = sw.dead_reckon(PAIR, log).slip_report()
    assert not report.observable
    assert SILENT in str(report)
    six = sw.Rover.preset("perseverance")
    steering, speeds = six.inverse((0.04, 0.0, 0.01))
    times = np.arange(10.0)
    track = sw.dead_reckon(six, np.tile(steering, (10, 1)), np.outer(times, speeds), times)
    assert track.slip_report().observable
    assert "no stretch in which a wheel slipped" in str(track.slip_report())


@pytest.mark.parametrize(
    ("rover", "told", "without_encoders"),
    [
        (PAIR, False, False),
        (sw.Rover.tracked(0.5, 0.1), False, False),
        (sw.Rover.omni([(0, 0.2), (0.2, 0), (-0.2, 0)], [0, 1, 2], 0.05), False, False),
        (sw.Rover.bicycle(1.0, 0.1), True, False),
        (sw.Rover.tricycle(1.0, 0.5, 0.1), True, False),
        (sw.Rover.mecanum(0.6, 0.6, 0.1), True, True),
        (sw.Rover.differential(0.5, 0.1, wheels_per_side=2, wheelbase=0.5), True, True),
        (sw.Rover.preset("perseverance"), True, True),
    ],
)
def test_which_rovers_can(rover, told, without_encoders):
    assert can_contradict(rover) == told
    assert can_contradict(rover, largest=0.0) == without_encoders


def test_tracks_and_truths_meet():
    log, _ = slipped()
    track = sw.dead_reckon(PAIR, log)
    later = GroundTruth(log.stamps[100:-50:3] + 0.001, log.truth.at(log.stamps[100:-50:3] + 0.001))
    found = evaluate(track, later)
    inside = (track.stamps >= later.stamps[0]) & (track.stamps <= later.stamps[-1])
    assert found.distance == evaluate(track.poses[inside], later.at(track.stamps[inside])).distance
    assert len(found.first.position) == inside.sum()
    assert evaluate(track, log.truth.poses).first.rmse == evaluate(track, log.truth).first.rmse
    with pytest.raises(ValueError, match="truth must overlap the track in time, got"):
        evaluate(track, GroundTruth([1e6, 2e6], np.zeros((2, 3))))
    with pytest.raises(
        ValueError, match="estimate must be a Track where truth is a GroundTruth, got ndarray"
    ):
        evaluate(track.poses, log.truth)


@pytest.mark.parametrize("parameters", ["auto", ["wheel_radii", "track_width"]])
def test_a_calibration_leaves_a_slide_out_and_says_where(parameters):
    pytest.importorskip("scipy")
    log, _ = slipped()
    nominal = sw.Rover.differential(0.52, (0.101, 0.099))
    found = sw.calibrate(nominal, log, parameters=parameters)
    assert found.chosen == ("wheel_radii", "track_width")
    np.testing.assert_allclose(found.values, (0.1, 0.102, 0.5), rtol=1e-6)
    (sentence,) = found.slips
    assert sentence.startswith("slip in part 3 of 4 of slid (")
    assert sentence in repr(found)
    assert sentence in found.to_markdown()
    assert found.loss == "cauchy"
    assert max(run.after for run in found.runs) < 1e-6  # [m]: each piece begins where the truth is
    assert found.cross_validation.best.errors.max() < 1e-6  # one bad part does not drown the others
    plain = sw.calibrate(
        nominal, log, parameters=parameters, loss="soft_l1", cross_validation=parameters == "auto"
    )
    assert abs(plain.values[0] - 0.1) > 1e-4
    assert plain.slips == ()


ROVERS = {
    "differential": (SMALL_PAIR, sw.Rover.differential(0.2, 0.044)),
    "six wheels": (SIX_WHEELS, sw.Rover.six_wheel(**SIX_SIZES | {"wheel_radius": 0.157})),
    "mecanum": (sw.Rover.mecanum(0.4, 0.4, 0.05), sw.Rover.mecanum(0.4, 0.4, 0.052)),
}
SLID = (70.0, 73.0)  # [s]: in part 3 of 4


@pytest.mark.parametrize("name", ROVERS)
@pytest.mark.parametrize("factor", [1.0, 1.3, 1.5, 2.0, 3.0])
def test_one_slip_in_a_clean_log_is_named_whatever_its_size(name, factor):
    """Wheels turn `factor` times as far for 3 s of 100; motion capture errs by 1 mm."""
    pytest.importorskip("scipy")
    true, nominal = ROVERS[name]
    times = np.arange(0.0, 100.5, 0.5)
    twists = np.stack(
        (
            0.25 + 0.05 * np.sin(0.4 * times),
            0 * times,
            0.3 * np.sin(0.3 * times) + 0.2 * np.sin(0.071 * times),
        ),
        -1,
    )
    slip = () if factor == 1.0 else Slip(*SLID, ratio=1.0 - 1.0 / factor)
    log = sw.simulate(
        true, (times, twists), slip=slip, rate=20, truth_noise=(1e-3, 2e-3), seed=3, name="drive"
    )
    found = sw.calibrate(nominal, log, parameters=["wheel_radius"], cross_validation=False)
    assert found.values[0] == pytest.approx(true.wheels[0].radius, rel=1e-3)
    if factor == 1.0:
        assert found.slips == ()
        return
    (sentence,) = found.slips
    assert sentence.startswith("slip in part 3 of 4 of drive (")


def test_only_the_log_that_slipped_is_cut():
    pytest.importorskip("scipy")
    good, bad = slipped(slip=0.0)[0], slipped()[0]
    found = sw.calibrate(
        sw.Rover.differential(0.52, 0.1), [good, bad], parameters=["wheel_radii", "track_width"]
    )
    assert [run.number for run in found.runs] == [0, 1, 1]
    assert found.runs[0].name == "slid"
    assert len(found.slips) == 1
    np.testing.assert_allclose(found.values, (0.1, 0.102, 0.5), rtol=1e-6)


def test_a_log_and_another_track_stand_for_a_truth():
    log, _ = slipped()
    track, better = sw.dead_reckon(PAIR, log), sw.dead_reckon(PAIR, slipped(slip=0.0)[0])
    assert slip_against(track, log) == slip_against(track, log.truth)
    assert evaluate(track, log).first.rmse == evaluate(track, log.truth).first.rmse
    assert evaluate(track, better).first.rmse == pytest.approx(evaluate(track, log).first.rmse, rel=1e-9)
    assert evaluate(track, track).first.rmse == 0.0
    unknown = WheelLog(log.stamps, None, log.wheel_angles, name="unknown")
    with pytest.raises(ValueError, match="truth must be known, got a log without one: WheelLog\\('unknown'"):
        evaluate(track, unknown)
    with pytest.raises(
        TypeError,
        match="a Track, or the path of a file of poses, got ndarray",
    ):
        slip_against(track, log.stamps)
    with pytest.raises(ValueError, match="estimate must be a Track where truth is a GroundTruth"):
        evaluate(track.poses, log)


def test_any_result_has_a_picture():
    pytest.importorskip("matplotlib")
    from six_wheel import plotting as plot

    log, _ = slipped()
    track = sw.dead_reckon(PAIR, log)
    assert len(plot.figure(track, truth=log.truth).axes) == 4
    assert len(sw.plot(track, truth=log).axes) == 4
    assert len(sw.plot(track).axes) == 3
    assert sw.plot(PAIR, twist=(0.3, 0.0, 0.2), title="pair").axes
    assert sw.plot(sw.Rover.preset("open_source_rover"), limits=sw.Limits(speed=0.5, wheel_speed=8.0)).axes
    with pytest.raises(TypeError, match="a list must hold results that have pictures, got an empty one"):
        sw.plot([])
    assert sw.plot(PAIR).axes
    both = plot.track_figure({"once": track, "again": track}, log.truth)
    assert len(both.axes) == 3


def test_a_report_of_any_number_of_wheels_and_stretches_is_six_lines():
    wheels = tuple(WheelContradiction(f"wheel_{k}", 0.1 * k, 0.0, 0.2 * k, k, 0.1, None) for k in range(1, 9))
    windows = tuple(
        SlipWindow(float(k), k + 0.5, 10 * k, 10 * k + 5, "wheel_8", 0.01 * k, 0.1) for k in range(1, 4)
    )
    text = str(SlipReport(wheels, windows, 100)).splitlines()
    assert len(text) == 6
    assert [line.split()[0] for line in text[2:4]] == ["wheel_8", "wheel_7"]
    assert text[4] == "6 others: at most 0.6000 m/s rms"
    assert text[5].startswith("3.000 s to 3.500 s (rows 30 to 35): wheel_8 slid 0.030 m")
    assert text[5].endswith("; 2 other stretches")
    assert len(str(SlipReport(wheels[:3], (), 100)).splitlines()) == 6
