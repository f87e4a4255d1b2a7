"""Calibration: derivatives, vehicles of known dimensions, what drives do not tell, and real recordings."""

import math
import os

import numpy as np
import pytest
from numpy.testing import assert_allclose

import six_wheel as sw
from six_wheel.log_odometry import evaluation
from six_wheel.logs import GroundTruth, WheelLog, optiodom
from six_wheel.robot_description.wheels_of_rover import with_wheels
from tests.calibration.drives import drive
from tests.optiodom_data import REQUIRED, ROBOTS, RUNS, read, reckon

pytest.importorskip("scipy", reason="SciPy is not installed")

from six_wheel.calibration import calibrate, parameter_names
from six_wheel.calibration import drives as _drives
from six_wheel.calibration import model as _drive_model
from six_wheel.robot_description import dimensions as _parameters
from tests.rovers import SIX_WHEELS, SMALL_PAIR

SOAK = int(os.environ.get("SOAK", "0"))
TRIANGLE = np.array([(0.2, 0.0), (-0.1, 0.17), (-0.1, -0.17)])
HEADINGS = (1.57, 3.66, -0.52)

# Nominal rover, the true one, and what to find.
VEHICLES = {
    "differential": (
        SMALL_PAIR,
        sw.Rover.differential(0.21, (0.0415, 0.0422)),
        {"wheel_radius[left]": 0.0415, "wheel_radius[right]": 0.0422, "track_width": 0.21},
    ),
    "tricycle": (
        sw.Rover.tricycle(0.4, 0.3, 0.08),
        with_wheels(sw.Rover.tricycle(0.42, 0.3, 0.078), [{"heading": 0.02}, {}, {}]),
        {"wheel_radius": 0.078, "wheelbase": 0.42, "steering_offset[front]": 0.02},
    ),
    "mecanum": (
        sw.Rover.mecanum(0.3, 0.3, 0.05),
        sw.Rover.mecanum(0.308, 0.308, 0.051),
        {"wheel_radius": 0.051, "arm_length": 0.154 * math.sqrt(2.0)},
    ),
    "omni": (
        sw.Rover.omni(TRIANGLE, HEADINGS, 0.05),
        sw.Rover.omni(1.03 * TRIANGLE, HEADINGS, 0.052),
        {"wheel_radius": 0.052, "arm_length": 1.03 * np.hypot(*TRIANGLE.T).mean()},
    ),
    "six wheels": (
        SIX_WHEELS,
        sw.Rover.six_wheel(
            front_to_middle=0.49,
            middle_to_rear=0.49,
            track_width=0.84,
            middle_track_width=0.945,
            wheel_radius=0.147,
        ),
        {"wheel_radius": 0.147, "track_width": 0.945, "wheelbase": 0.98},
    ),
    "tracked": (
        sw.Rover.tracked(0.5, 0.1),
        sw.Rover.tracked(0.5, 0.102, icr_left=0.4, icr_right=-0.35, icr_forward=0.05),
        {"wheel_radius": 0.102, "icr_left": 0.4, "icr_right": -0.35, "icr_forward": 0.05},
    ),
}
PAIR = VEHICLES["differential"][0]


def quick(rover, logs, parameters, **options):
    return calibrate(rover, logs, parameters=parameters, cross_validation=False, **options)


# --- derivatives -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", VEHICLES)
def test_derivatives_are_those_of_finite_differences(name):
    rover, true, _ = VEHICLES[name]
    log = drive(true, 1, 20.0)
    catalogue = _parameters.Catalogue(rover, _drives.encoders(rover, [log]))
    model = _drive_model.Model(rover, catalogue.find(catalogue.names))
    prepared = _drives.prepare(rover, log, _drives.default_lengths(rover), 0.5, 0)
    values = model.start + 0.2 * model.plausible * np.random.default_rng(2).normal(size=len(model.start))
    errors, by = model.errors(prepared, values)
    for number, parameter in enumerate(model.parameters):
        step = np.zeros(len(values))
        step[number] = 1e-5 * parameter.plausible
        ahead, behind = (model.errors(prepared, values + sign * step)[0] for sign in (1.0, -1.0))
        change = ahead - behind
        change[:, 2] = sw.wrap_angle(change[:, 2])
        numeric = change / (2.0 * step[number])
        # Central differences: rounding of 1e-16 m over a step of 1e-5 of the parameter.
        atol = 1e-7 * np.abs(numeric).max() + 1e-15 / step[number]
        assert_allclose(by[:, :, number], numeric, atol=atol, err_msg=parameter.name)
    assert errors.shape == (len(prepared.rows), 3)


def test_a_turn_too_small_to_see_has_the_same_derivatives_from_both_sides():
    edge = 2.0 * _drive_model.SMALL_TURN
    found = []
    for turn in (edge * (1.0 - 1e-9), edge * (1.0 + 1e-9)):
        twists = np.array([(0.3, 0.1, turn)])
        by_twist = np.broadcast_to(np.eye(3), (1, 3, 3))
        poses = sw.integrate(twists, np.ones(1))
        found.append(_drive_model.carried(poses, twists, by_twist, np.ones(1)))
    assert_allclose(found[0], found[1], atol=1e-9)


# --- known dimensions ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", VEHICLES)
def test_any_vehicle_gets_its_dimensions_back(name):
    nominal, true, wanted = VEHICLES[name]
    groups = ["wheel_radii" if key.startswith("wheel_radius[") else key.partition("[")[0] for key in wanted]
    result = quick(nominal, [drive(true, seed) for seed in range(3)], list(dict.fromkeys(groups)))
    assert result.converged
    assert result.observability.complete
    for key, value in wanted.items():
        found = result[key]
        # Rounded counts and rounded steering leave a trace of their own: ten micrometres per metre.
        assert found.value == pytest.approx(value, abs=max(3.0 * found.std, 2e-5)), key
        assert found.std < 0.02 * value if value > 0.04 else found.std < 1e-3
    for wheel, like in zip(result.rover.wheels, true.wheels, strict=True):
        if wheel.driven:
            assert wheel.radius == pytest.approx(like.radius, rel=1e-4)
    assert max(run.after for run in result.runs) < 5e-3 < max(run.before for run in result.runs)


def test_gains_of_the_encoders():
    nominal, _, _ = VEHICLES["tricycle"]
    logs = []
    for seed in range(3):
        log = drive(nominal, seed)
        logs.append(WheelLog(log.stamps, log.steering / 1.05, log.wheel_angles / 0.97, log.truth))
    result = quick(nominal, logs, ["steering_gain", "encoder_scale"])
    assert result["steering_gain[front]"].value == pytest.approx(1.05, abs=1e-3)
    assert result["encoder_scale"].value == pytest.approx(0.97, abs=1e-4)
    assert result.rover == nominal


def test_time_offset_and_lever_arm():
    sensor = (0.05, -0.03, 0.2)
    logs = [drive(PAIR, seed, sensor=sensor, offset=0.12) for seed in range(3)]
    result = quick(PAIR, logs, ["wheel_radius", "track_width", "sensor", "time_offset"])
    assert_allclose(result.sensor, sensor, atol=5e-4)
    assert result.time_offset == pytest.approx(0.12, abs=1e-3)
    assert result["track_width"].value == pytest.approx(0.2, abs=1e-4)
    assert all(abs(wheel.x) < 1e-12 for wheel in result.rover.wheels)  # the rover stays about its own origin


def test_the_rover_about_what_the_truth_follows():
    sensor = (0.05, -0.03, 0.2)
    logs = [drive(PAIR, seed, sensor=sensor) for seed in range(3)]
    result = quick(PAIR, logs, ["wheel_radius", "track_width", "origin"])
    assert_allclose([result[f"origin_{axis}"].value for axis in ("x", "y", "yaw")], sensor, atol=5e-4)
    for log in logs:  # plain dead reckoning with the new rover is compared with the truth as it stands
        assert evaluation.absolute_error(reckon(result.rover, log), log.truth.poses).rmse < 3e-3
    assert_allclose(result.sensor, 0.0)


@pytest.mark.slow
def test_a_drive_that_slips_needs_a_robust_loss():
    true = sw.Rover.differential(0.21, 0.041)
    logs = [drive(true, seed, 120.0, slips=1) for seed in range(3)]
    off = {
        loss: abs(quick(PAIR, logs, ["wheel_radius", "track_width"], loss=loss)["wheel_radius"].value - 0.041)
        for loss in ("linear", "soft_l1", "huber", "cauchy")
    }
    assert off["cauchy"] < 1e-4 < off["linear"]
    assert max(off["soft_l1"], off["huber"]) < 0.8 * off["linear"]


@pytest.mark.parametrize("seed", range(max(6, SOAK)))
def test_intervals_hold_the_truth(seed):
    """With noise of no memory, as the formula has it, and not by being too wide to be of use."""
    true = sw.Rover.differential(0.21, 0.041)
    logs = [drive(true, 10 * seed + part, 40.0, noise=1e-3, resolution=0.02) for part in range(4)]
    result = quick(PAIR, logs, ["wheel_radius", "track_width"], confidence=0.99)
    for name, value in {"wheel_radius": 0.041, "track_width": 0.21}.items():
        low, high = result[name].interval
        assert low < value < high
        assert high - low < 0.02 * value  # and they are worth something


# --- what drives do not tell -----------------------------------------------------------------------------


def test_a_straight_run_cannot_identify_the_track():
    true = sw.Rover.differential(0.21, 0.041)
    logs = [drive(true, seed, straight=True) for seed in range(3)]
    result = quick(PAIR, logs, ["wheel_radius", "track_width"])
    assert result["wheel_radius"].value == pytest.approx(0.041, rel=1e-3)
    track = result["track_width"]
    assert track.value == 0.2
    assert not track.identified
    assert math.isnan(track.std)
    assert not result.observability.complete
    assert "track_width stays at its nominal 0.2 m: a straight run cannot identify it" in repr(result)
    assert "not identified" in result.to_markdown()


def test_a_mecanum_rover_shows_only_the_sum_of_its_base_lengths():
    true = sw.Rover.mecanum(0.3, 0.32, 0.051)
    result = quick(
        sw.Rover.mecanum(0.3, 0.3, 0.05),
        [drive(true, seed) for seed in range(2)],
        ["wheel_radius", "track_width", "wheelbase"],
    )
    assert [one.identified for one in result.parameters] == [True, False, False]
    # Nothing tells them apart: both move alike, and their sum is right.
    assert result["track_width"].value == pytest.approx(0.31, abs=1e-4)
    assert result["wheelbase"].value == pytest.approx(0.31, abs=1e-4)
    assert "track_width, wheelbase are identified only together" in repr(result.observability)


def test_radius_and_encoder_scale_are_one_thing():
    result = quick(PAIR, [drive(PAIR, 1)], ["wheel_radius", "encoder_scale"])
    assert not any(one.identified for one in result.parameters)
    assert result["wheel_radius"].value == pytest.approx(0.042, rel=1e-3)


def test_auto_takes_no_more_than_the_drives_support():
    true = sw.Rover.differential(0.21, 0.041)
    logs = [drive(true, seed, 40.0, session=f"day {seed % 3}") for seed in range(6)]
    steps: list[tuple[int, int, str]] = []
    result = calibrate(PAIR, logs, progress=lambda *step: steps.append(step))
    table = result.cross_validation
    assert table is not None
    assert table.kind == "session"
    assert len(table.folds) == 3
    assert result.chosen == (
        "wheel_radius",
        "track_width",
    )  # the wheels are alike, the truth looks straight on
    assert table.best.score < 0.1
    assert "| **wheel_radius, track_width** | 2 |" in result.to_markdown()
    assert steps[0][0] == 0
    assert all(done <= total for done, total, _ in steps)
    assert steps[-1][:2] == (1, 1)


def test_auto_keeps_nominal_dimensions_that_nothing_beats():
    logs = [drive(PAIR, seed, 20.0, noise=2e-3, resolution=0.05) for seed in range(3)]
    result = calibrate(PAIR, logs)
    assert result.cross_validation is not None
    assert result.cross_validation.best.score > 0.5
    assert_allclose([wheel.radius for wheel in result.rover.wheels], 0.042, rtol=0.01)


# --- bad input -------------------------------------------------------------------------------------------


def test_rows_that_cannot_be_used_are_left_out():
    log = drive(PAIR, 1)
    angles, stamps = log.wheel_angles.copy(), log.stamps.copy()
    angles[100, 0] = math.nan
    stamps[200] = stamps[199]  # twice the same
    whole = quick(PAIR, [log], ["wheel_radius", "track_width"])
    holed = quick(PAIR, [WheelLog(stamps, None, angles, log.truth)], ["wheel_radius", "track_width"])
    assert holed.runs[0].dropped == 2
    assert_allclose(holed.values, whole.values, rtol=1e-3)


@pytest.mark.filterwarnings("ignore:.*the truth moves:six_wheel.kinematics.errors.SuspiciousReadingsWarning")
def test_what_cannot_be_calibrated_is_refused():
    log = drive(PAIR, 1, 10.0)
    blind = WheelLog(log.stamps, None, log.wheel_angles)
    still = WheelLog(log.stamps, None, np.zeros_like(log.wheel_angles), log.truth)
    tricycle = VEHICLES["tricycle"][0]
    for logs, options, rule in (
        ([], {}, "logs must hold one at least"),
        (blind, {}, r"logs\[0\] must have a truth"),
        (still, {"parameters": "wheel_radius"}, "must move while its truth is known"),
        (log, {"parameters": "wheel_size"}, "parameters must be some of wheel_radius, .* got 'wheel_size'"),
        (log, {"parameters": "steering_offset"}, "parameters must be some of"),
        (log, {"parameters": []}, "parameters must name one at least"),
        (log, {"loss": "square"}, "loss must be one of"),
        (log, {"window": 0.0}, "window must be finite and positive"),
        (log, {"confidence": 1.0}, "confidence must be between 0 and 1"),
        (log, {"max_time_offset": math.inf}, "max_time_offset must be"),
        (log, {"truth": [log.truth, log.truth]}, "truth must be given once per log, got 2 for 1"),
    ):
        with pytest.raises(ValueError, match=rule):
            calibrate(PAIR, logs, **options)
    with pytest.raises(ValueError, match=r"wheel_angles must have shape \(n, 3\)"):
        calibrate(tricycle, log, parameters="wheelbase")
    with pytest.raises(ValueError, match="stamps must grow"):
        GroundTruth([0.0, 0.0], np.zeros((2, 3)))
    assert quick(PAIR, blind, "wheel_radius", truth=log.truth)["wheel_radius"].identified
    assert "track_width" in parameter_names(PAIR)
    assert "steering_gain" in parameter_names(tricycle)


# --- real recordings -------------------------------------------------------------------------------------


def test_the_run_that_comes_along():
    rover, log = optiodom.example()
    result = calibrate(rover, log)
    assert result.runs[0].before > 0.25
    assert result.runs[0].after < 0.02
    assert -0.024 < result["steering_offset[front]"].value < -0.016
    assert result.cross_validation is not None
    assert result.cross_validation.kind == "part"


def logs_of(robot):
    return [read(run) for run in RUNS[robot]]


def ate(rover, log):
    return evaluation.absolute_error(reckon(rover, log), log.truth.poses).rmse


# The choice of cross-validation on all recordings of a robot; `make soak` asks it again.
CHOSEN = {
    "diff": ("wheel_radius", "track_width"),
    "tricyc": ("wheel_radius", "wheelbase", "steering_offset", "origin_yaw"),
    "omni3": ("wheel_radii", "arm_length", "origin"),
    "omni4": ("wheel_radius", "arm_length"),
}


@pytest.mark.slow
@REQUIRED
@pytest.mark.parametrize("robot", ROBOTS)
def test_recordings_of_other_days(robot):
    """A fit on all sessions, and on all but one tried on that one; with plain dead reckoning throughout."""
    pairs = logs_of(robot)
    logs, nominal = [log for _, log in pairs], pairs[0][0]
    if SOAK:
        result = calibrate(nominal, logs)
        print(f"\n{result.to_markdown()}")
        assert result.chosen == CHOSEN[robot]
    else:
        result = quick(nominal, logs, CHOSEN[robot])
    published = np.median([run["calibrated"]["ate_first"] for run in RUNS[robot]])
    fitted = np.median([ate(result.rover, log) for log in logs])
    sessions = np.array([log.session for log in logs])
    before = np.array([ate(rover, log) for rover, log in pairs])
    after = np.empty(len(logs))
    for session in dict.fromkeys(sessions):
        held = quick(nominal, [log for log in logs if log.session != session], CHOSEN[robot]).rover
        for row in np.flatnonzero(sessions == session):
            after[row] = ate(held, logs[row])
    by_session = {
        str(name): [float(np.median(errors[sessions == name])) for errors in (before, after)]
        for name in dict.fromkeys(sessions)
    }
    print(
        f"\n{result}\nfitted {fitted:.4f}, published {published:.4f} m",
        f"one session left out {np.median(after):.4f} m",
    )
    print({name: f"{old:.4f} -> {new:.4f}" for name, (old, new) in by_session.items()})
    if robot == "diff":
        assert fitted <= published
        assert np.median(after) <= 0.016
    elif robot == "tricyc":
        assert fitted <= published
        assert np.median(after) <= 0.060
    elif robot == "omni3":
        assert fitted <= published
        assert all(new <= old for old, new in by_session.values())
    else:
        assert np.median(after) < np.median(before)


@pytest.mark.slow
@REQUIRED
@pytest.mark.parametrize(
    ("robot", "parameters"),
    [("diff", ["wheel_radii", "track_width"]), ("tricyc", ["wheel_radius", "wheelbase", "steering_offset"])],
)
def test_intervals_of_one_session_hold_the_pooled_value(robot, parameters):
    pairs = logs_of(robot)
    logs = [log for _, log in pairs]
    pooled = quick(pairs[0][0], logs, parameters)
    held = []
    for session in dict.fromkeys(log.session for log in logs):
        alone = quick(pairs[0][0], [log for log in logs if log.session == session], parameters)
        held += [
            low <= value <= high for value, (low, high) in zip(pooled.values, alone.intervals, strict=True)
        ]
    print(f"\n{robot}: {sum(held)} of {len(held)}")
    assert sum(held) >= 0.85 * len(held)
