"""Faults that no fit can mend are recognised with their remedy; the model that predicts best wins."""

import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("scipy")

import six_wheel as sw
from six_wheel.calibration import Candidate, calibrate
from six_wheel.calibration.cross_validation import choose
from six_wheel.calibration.log_checks.units import unsettled
from tests.calibration.drives import drive
from tests.rovers import SMALL_PAIR as PAIR

TRICYCLE = sw.Rover.tricycle(wheelbase=0.3, track_width=0.2, wheel_radius=0.05)


def said(rover, log, parameters=("wheel_radius", "track_width"), **how):
    result = calibrate(rover, [log], parameters=parameters, cross_validation=False, **how)
    return "\n".join(result.observability.messages)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda angles: angles[:, ::-1], "left and right are swapped: exchange the columns"),
        (lambda angles: -angles, "all wheels count the other way round: give the encoders a negative gear"),
        (lambda angles: angles * (-1, 1), "wheel left counts the other way round"),
        (lambda angles: 2.0 * angles, "the wheels turn 0.5 times as far: a gear of 2 is missing"),
        (np.degrees, "the wheels turn 0.0175 times as far: degrees are taken for radians"),
    ],
    ids=["swapped", "reversed", "one reversed", "gear", "degrees"],
)
def test_a_wrong_reading_is_named_with_its_remedy(change, message):
    log = drive(PAIR, 1, 30.0)
    wrong = replace(log, wheel_angles=change(log.wheel_angles))
    assert message in said(PAIR, wrong, plausibility=change is not np.degrees)
    assert "far better" not in said(PAIR, log)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda poses: poses * (1, 1, 180 / np.pi), "the headings of the truth are in degrees: write deg"),
        (lambda poses: poses * (1000, 1000, 1), "the positions of the truth are in mm: write mm"),
        (lambda poses: poses * (100, 100, 1), "the positions of the truth are in cm: write cm"),
        (lambda poses: poses * (1, 1, -1), "the headings of the truth count the other way round"),
        (lambda poses: poses * (1, 1, -1) + (0, 0, np.pi / 2), "or take those of a compass from 90 deg"),
        (lambda poses: poses * (1, -1, -1), "; or if y and yaw of the truth count the other way round"),
        (lambda poses: poses[:, [1, 0, 2]], "x and y of the truth are exchanged: exchange its columns"),
    ],
    ids=["degrees", "mm", "cm", "clockwise", "compass", "from below", "x for y"],
)
def test_a_truth_that_is_read_wrongly_is_named(change, message):
    """A truth in degrees was called drives that hardly tell: ask for fewer parameters."""
    log = drive(PAIR, 1, 30.0)
    words = said(PAIR, replace(log, truth=sw.GroundTruth(log.truth.stamps, change(log.truth.poses))))
    assert message in words
    assert "hardly tell some" not in words
    assert words.count("far better") == 1


@pytest.mark.parametrize("factor", [0.1, 0.16, 9.0, 40.0])
def test_any_other_factor_is_found(factor):
    """A radius six times too large was left where it was, and the drives called poor."""
    log = drive(PAIR, 1, 30.0)
    words = said(PAIR, replace(log, wheel_angles=log.wheel_angles / factor))
    by = float(words.partition("the wheels turn ")[2].partition(" times")[0])
    assert by == pytest.approx(factor, rel=0.05)


def test_a_truth_of_another_drive_is_said_to_be_a_stranger():
    log, other = drive(PAIR, 1, 30.0), drive(PAIR, 2, 30.0)
    words = said(PAIR, replace(log, truth=other.truth))
    assert "the drives and their truth do not go together" in words
    assert "every log has its own truth" in words


def test_a_truth_of_another_clock_is_said_to_be_one():
    """It was: must move while its truth is known, got 19 m of motion."""
    log = drive(PAIR, 1, 30.0)
    late = replace(log, truth=sw.GroundTruth(log.truth.stamps + 1000.0, log.truth.poses))
    with pytest.raises(
        ValueError, match="a truth of 1000 to 1030 s for a log of 0 to 30 s: give both the same"
    ):
        said(PAIR, late)


def test_two_numbers_are_never_known_but_for_seven_combinations():
    """Open directions were counted with those of the mounts of all sessions."""
    logs = [replace(drive(PAIR, seed, 30.0), session=f"day {seed}") for seed in range(3)]
    backwards = [replace(log, wheel_angles=log.wheel_angles * (1, -1)) for log in logs]
    names = ("wheel_radius", "track_width")
    result = calibrate(PAIR, backwards, parameters=names, cross_validation=False)
    (words,) = [one for one in result.observability.messages if one.startswith("wheel_radius, track_width")]
    assert "one combination of them" in words


def test_no_rover_that_a_fit_tries_is_asked_about():
    """Every one of them warned of a radius of half a metre, a hundred times."""
    with pytest.warns(sw.SuspiciousUnitsWarning):
        large = sw.Rover.differential(0.2, 0.3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        said(large, drive(PAIR, 1, 20.0))


def test_steering_in_degrees_is_named():
    log = drive(TRICYCLE, 2, 30.0)
    parameters = ("wheel_radius", "steering_offset")
    wrong = replace(log, steering=np.degrees(log.steering))
    assert "steering angles are in degrees" in said(TRICYCLE, wrong, parameters, plausibility=False)
    assert "far better" not in said(TRICYCLE, log, parameters)


@pytest.mark.parametrize("wheels", [True, False])
def test_degrees_that_no_rover_drives_are_refused_before_the_fit(wheels):
    rover = PAIR if wheels else TRICYCLE
    log = drive(rover, 2, 30.0)
    name = "wheel_angles" if wheels else "steering"
    with pytest.raises(ValueError, match=r"logs\[0\]: .* degrees"):
        said(rover, replace(log, **{name: np.degrees(getattr(log, name))}))


@pytest.mark.slow
def test_a_value_at_its_bound_is_said_and_not_called_converged():
    log = drive(PAIR, 1, 30.0)
    wrong = replace(log, wheel_angles=np.degrees(log.wheel_angles))
    names = ["wheel_radius", "track_width"]
    result = calibrate(PAIR, [wrong], parameters=names, cross_validation=False, plausibility=False)
    assert not result.converged
    assert any(
        "wheel_radius went as far as it may, to 0.0084 m" in one for one in result.observability.messages
    )


def test_the_nominal_rover_may_win():
    """An exact rover, one minute, a truth of 2 cm and 0.02 rad: nothing to find, and nothing breaks."""
    result = calibrate(PAIR, [drive(PAIR, 1, 60.0, noise=2e-2)])
    assert result.chosen == ()
    assert result.rover == PAIR
    assert "no set of parameters predicts better" in repr(result)
    assert result.covariance.shape == (0, 0)


def test_a_lone_window_weighs_as_its_length_deserves():
    """The truth jumps a little at its very end, which only windows that end there see."""
    log = drive(PAIR, 3, 30.0)
    poses = np.array(log.truth.poses)
    poses[-1, :2] += 0.01
    jumped = sw.WheelLog(log.stamps, None, log.wheel_angles, poses)
    for window in (None, (1.0, 4.0)):
        result = calibrate(PAIR, [jumped], parameters=["wheel_radius", "track_width"], window=window)
        np.testing.assert_allclose(result.values, (0.042, 0.2), rtol=2e-3)


def test_readings_of_any_kind_are_calibrated():
    times = np.linspace(0.0, 30.0, 61)
    twists = np.stack((0.2 + 0 * times, 0 * times, 0.5 * np.sin(times)), axis=-1)
    wheels = sw.Encoder(64, gear_ratio=43.7, wraps_at=2**12)
    counted = sw.simulate(PAIR, (times, twists), wheel_encoders=wheels)
    start = sw.Rover.differential(0.19, 0.044)
    options = {"parameters": ["wheel_radius", "track_width"], "cross_validation": False}
    np.testing.assert_allclose(calibrate(start, counted, **options).values, (0.042, 0.2), rtol=1e-3)
    exact = sw.simulate(PAIR, (times, twists))
    turned = np.diff(exact.wheel_angles, axis=0, prepend=0.0)
    rates = PAIR.inverse(np.stack([np.interp(exact.stamps, times, one) for one in twists.T], axis=-1))[1]
    for kind, values in (({"increments": True}, turned), ({"readings": "speeds"}, rates)):
        log = sw.WheelLog(exact.stamps, None, values, exact.truth, options=kind)
        np.testing.assert_allclose(calibrate(start, log, **options).values, (0.042, 0.2), rtol=1e-4)


def test_fewer_numbers_unless_more_win_clearly():
    def candidate(count, *errors):
        errors = np.array(errors)
        names = (f"set of {count}",) if count else ()
        return Candidate(names, count, errors, float(np.sqrt(np.mean(errors**2))), errors)

    nominal, two = candidate(0, 1.0, 1.0, 1.0), candidate(2, 0.5, 0.5, 0.6)
    assert choose([nominal, candidate(1, 0.99, 0.98, 1.0)]) is nominal
    assert choose([nominal, two]) is two
    # Much better on one session, a little worse on two: not worth its numbers.
    assert choose([nominal, two, candidate(4, 0.1, 0.52, 0.61)]) is two
    # Much better on two of three, worse on the third: it may be chance.
    assert choose([nominal, two, candidate(4, 0.1, 0.1, 0.8)]) is two
    # Much better on all: worth them.
    assert choose([nominal, two, four := candidate(4, 0.1, 0.1, 0.3)]) is four
    # Better on most, but wrong altogether on one.
    assert choose([nominal, two, candidate(4, 0.1, 0.1, 3.0)]) is two
    # A tenth for every number more is asked.
    assert choose([nominal, two, candidate(4, 0.42, 0.42, 0.5)]) is two


def test_a_fit_that_does_not_settle_says_why_and_what_to_do():
    """Drives that hardly tell, and drives that contradict each other, have different remedies."""
    log = drive(PAIR, 1, 30.0)
    result = calibrate(PAIR, [log], parameters=["wheel_radius"], cross_validation=False)
    assert result.converged
    spread = {0.0: "stretches fit one another badly; try loss='cauchy'", 1.0: "ask for fewer, or drive turns"}
    for widest, words in spread.items():
        ended = SimpleNamespace(converged=False, spread=np.array([widest]))
        (said,) = unsettled(ended)
        assert words in said
    (said,) = unsettled(SimpleNamespace(converged=False, spread=np.ones(1)), mistaken=True)
    assert "mend it first" in said
    assert not unsettled(SimpleNamespace(converged=True, spread=np.zeros(1)))


def test_what_stays_at_its_nominal_value_has_it():
    """A message never contradicts the table, whatever the drives leave open."""
    turned = np.linspace(0.0, 60.0, 300)
    arc = sw.Rover.differential(0.206, 0.0415)
    for shares in ((1.0, 1.0), (1.0, 0.8), (1.0, -1.0)):
        angles = turned[:, None] * np.array(shares)
        poses = sw.integrate(arc.forward(None, np.diff(angles, axis=0)), 1.0)
        log = sw.WheelLog(0.05 * np.arange(300), None, angles, poses)
        names = ["wheel_radius", "track_width", "encoder_scale"]
        result = calibrate(PAIR, log, parameters=names, cross_validation=False)
        assert result.observability.messages
        for name in names:
            stays = any(f"{name} stays at its nominal" in one for one in result.observability.messages)
            moved = any(f"{name} went from" in one for one in result.observability.messages)
            value, nominal = result[name].value, result[name].nominal
            assert not (stays and moved)
            if stays:
                assert value == pytest.approx(nominal, rel=2e-3)
            if moved:
                assert value != nominal
