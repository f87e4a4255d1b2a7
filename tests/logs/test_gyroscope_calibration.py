"""Calibrated logs of a gyroscope, and those of a gyroscope alone."""

import math
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.log_odometry import ReckonSettings
from six_wheel.logs import JointLog, read_log
from six_wheel.simulation import write_log
from tests.cli_runs import Run
from tests.logs.gyroscope_logs import simulated
from tests.rovers import CART


def test_the_file_of_a_calibration_makes_odometry_use_the_gyroscope(run: Run) -> None:
    """The wheels slip sideways in every turn; the gyroscope knows, its bias of 0.03 rad/s taken off."""
    pytest.importorskip("scipy")
    slip = sw.Noise(0.0, 0.0, slip=0.03)
    for seed in range(3):
        log = simulated(seed, noise=slip)
        write_log(log, CART, f"run{seed}.csv")
    Path("cart.yaml").write_text("kind: differential\ntrack_width: 0.5\nwheel_radius: 0.1\n")
    code, out, err = run("odometry", "cart.yaml", "run0.csv")
    assert code == 0, err
    assert "the gyroscope is not used, for nobody said what it errs by" in err
    assert "its bias at the end" not in out
    find = ("--parameters", "wheel_radius,track_width", "-o", "found.yaml")
    code, _, err = run("calibrate", "cart.yaml", "run1.csv", "run2.csv", *find)
    assert code == 0, err
    text = Path("found.yaml").read_text()
    assert "gyroscope:" in text
    found = sw.robot_description.parameters.read_parameters("found.yaml")
    assert found.known_gyroscope.noise == pytest.approx(0.002, rel=0.2)  # 250 readings at rest: 5 %
    assert found.gyroscope["period"] == pytest.approx(0.05)
    code, out, err = run("odometry", "found.yaml", "run0.csv", "-o", "track.csv")
    assert code == 0, err
    assert "its bias at the end" in out
    assert "not used" not in err
    header = Path("track.csv").read_text().partition("\n")[0].split(",")
    end = np.genfromtxt("track.csv", delimiter=",", skip_header=1)[-1]
    names = [name.partition(" ")[0] for name in header]
    truth = simulated(0, noise=slip).truth.poses[-1]
    error = abs(end[names.index("yaw")] - truth[2])
    deviation = math.sqrt(end[names.index("covariance_yaw_yaw")])
    alone = sw.dead_reckon(CART, (same := simulated(0, noise=slip)).steering, same.wheel_angles, same.stamps)
    assert error < 4.0 * deviation < 0.2
    assert error < abs(alone.poses[-1, 2] - truth[2])


def test_a_log_of_a_gyroscope_alone_calibrates_and_keeps_its_clock(run: Run) -> None:
    pytest.importorskip("scipy")
    log = simulated(5)
    columns = np.column_stack((log.stamps[2:], log.wheel_angles[2:], log.yaw_rate[:-2]))  # 0.1 s late
    header = "time,left [rad],right [rad],yaw_rate"
    np.savetxt("log.csv", columns, delimiter=",", header=header, comments="", fmt="%.12g")
    Path("cart.yaml").write_text("kind: differential\ntrack_width: 0.48\nwheel_radius: 0.1\n")
    find = ("--parameters", "track_width,time_offset", "-o", "found.yaml")
    code, out, err = run("calibrate", "cart.yaml", "log.csv", *find)
    assert code == 0, err
    assert "a gyroscope alone tells turns and no distances" in " ".join(out.split())
    found = sw.robot_description.parameters.read_parameters("found.yaml")
    assert found.gyroscope["time_offset"] == pytest.approx(0.1, abs=0.01)
    assert not found.truth
    assert found.rover.wheels[0].y == pytest.approx(0.25, rel=0.01)
    code, _, err = run(
        "calibrate", "found.yaml", "log.csv", "--parameters", "time_offset", "-o", "again.yaml"
    )
    assert code == 0, err
    again = sw.robot_description.parameters.read_parameters("again.yaml")
    assert again.gyroscope["time_offset"] == pytest.approx(found.gyroscope["time_offset"], abs=5e-3)


def test_white_noise_is_that_of_the_readings_whatever_their_rate(run: Run) -> None:
    """Simulated and reckoned at another rate than it was measured at: means over less time err more."""
    known = "{noise: 0.002, period: 0.05, bias: 0.0, bias_noise: 0.0, bias_walk: 0.0}"
    Path("cart.yaml").write_text(
        f"kind: differential\ntrack_width: 0.5\nwheel_radius: 0.1\ngyroscope: {known}\n"
    )
    Path("still.csv").write_text("time,vx,omega\n0,0,0\n20,0,0\n")
    for rate, noise in (("20", 0.002), ("80", 0.004)):
        code, _, err = run("simulate", "cart.yaml", "still.csv", "-o", "log.csv", "--rate", rate)
        assert code == 0, err
        log, _ = read_log("log.csv", CART)
        assert np.std(log.yaw_rate) == pytest.approx(noise, rel=0.15)  # 400 readings: 4 %
    gyroscope = sw.robot_description.parameters.read_parameters("cart.yaml").known_gyroscope
    settings = ReckonSettings(gyroscope=gyroscope, period=0.05)
    with JointLog("log.csv", CART) as opened:
        (chunk,) = opened.chunks()
    assert settings.options_for(chunk)["gyroscope"].noise == pytest.approx(0.004)


@pytest.mark.parametrize("ending", [".csv", ".mcap"])
def test_reading_in_chunks_is_reckoned_alike(run: Run, ending: str) -> None:
    write_log(simulated(), CART, f"log{ending}")
    Path("cart.yaml").write_text(
        "kind: differential\ntrack_width: 0.5\nwheel_radius: 0.1\ngyroscope: {noise: 0.002, period: 0.05}\n"
    )
    for rows, name in (("65536", "one.csv"), ("50", "many.csv")):
        assert run("odometry", "cart.yaml", f"log{ending}", "-o", name, "--chunk-rows", rows)[0] == 0
    one, many = (np.genfromtxt(name, delimiter=",", skip_header=1) for name in ("one.csv", "many.csv"))
    np.testing.assert_allclose(many, one, atol=1e-9)
