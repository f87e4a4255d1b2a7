"""What no fit can mend is recognised, and the remedy said; what wins is what predicts."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("scipy")

import six_wheel as sw
from six_wheel.calibration import Candidate, calibrate, mistakes
from six_wheel.calibration.cross_validation import choose
from tests.calibration.drives import drive

PAIR = sw.Rover.differential(0.2, 0.042)
TRICYCLE = sw.Rover.tricycle(wheelbase=0.3, track_width=0.2, wheel_radius=0.05)


def said(rover, log, parameters=("wheel_radius", "track_width")):
    result = calibrate(rover, [log], parameters=parameters, cross_validation=False)
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
    assert message in said(PAIR, replace(log, wheel_angles=change(log.wheel_angles)))
    assert "far better" not in said(PAIR, log)


def test_steering_in_degrees_is_named():
    log = drive(TRICYCLE, 2, 30.0)
    parameters = ("wheel_radius", "steering_offset")
    wrong = replace(log, steering=np.degrees(log.steering))
    assert "steering angles are in degrees" in said(TRICYCLE, wrong, parameters)
    assert "far better" not in said(TRICYCLE, log, parameters)


def test_a_value_at_its_bound_is_said_and_not_called_converged():
    log = drive(PAIR, 1, 30.0)
    wrong = replace(log, wheel_angles=np.degrees(log.wheel_angles))
    result = calibrate(PAIR, [wrong], parameters=["wheel_radius", "track_width"], cross_validation=False)
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
    jumped = sw.Log(log.stamps, None, log.wheel_angles, poses)
    for window in (None, (1.0, 4.0)):
        result = calibrate(PAIR, [jumped], parameters=["wheel_radius", "track_width"], window=window)
        np.testing.assert_allclose(result.values, (0.042, 0.2), rtol=2e-3)


def test_readings_of_any_kind_are_calibrated():
    times = np.linspace(0.0, 30.0, 61)
    twists = np.stack((0.2 + 0 * times, 0 * times, 0.5 * np.sin(times)), axis=-1)
    wheels = sw.Encoder(64, gear=43.7, modulus=2**12)
    counted = sw.simulate(PAIR, (times, twists), encoder=wheels)
    start = sw.Rover.differential(0.19, 0.044)
    options = {"parameters": ["wheel_radius", "track_width"], "cross_validation": False}
    np.testing.assert_allclose(calibrate(start, counted, **options).values, (0.042, 0.2), rtol=1e-3)
    exact = sw.simulate(PAIR, (times, twists))
    turned = np.diff(exact.wheel_angles, axis=0, prepend=0.0)
    rates = PAIR.inverse(np.stack([np.interp(exact.stamps, times, one) for one in twists.T], axis=-1))[1]
    for readings, values in (("increments", turned), ("speeds", rates)):
        log = sw.Log(exact.stamps, None, values, exact.truth, options={"readings": readings})
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
        (said,) = mistakes.unsettled(ended)
        assert words in said
    assert not mistakes.unsettled(SimpleNamespace(converged=True, spread=np.zeros(1)))


def test_what_stays_at_its_nominal_value_has_it():
    """A message never contradicts the table, whatever the drives leave open."""
    turned = np.linspace(0.0, 60.0, 300)
    arc = sw.Rover.differential(0.206, 0.0415)
    for shares in ((1.0, 1.0), (1.0, 0.8), (1.0, -1.0)):
        angles = turned[:, None] * np.array(shares)
        poses = sw.integrate(arc.forward(None, np.diff(angles, axis=0)), 1.0)
        log = sw.Log(0.05 * np.arange(300), None, angles, poses)
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
