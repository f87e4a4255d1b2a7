"""Encoders that logs were read with go into the file of a calibration, which reads these logs again."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("scipy")
pytest.importorskip("pyarrow")

import six_wheel as sw
from six_wheel.calibration import calibrate_files
from six_wheel.logs import LogOptions, read_log
from six_wheel.logs.log_options import keys_of
from six_wheel.robot_description.parameters import read_parameters
from tests.calibration.drives import drive

CAR = sw.Rover.ackermann(1.0, 0.7, 0.15, steering_limit=0.7)
WHEELS = sw.Encoder(1024, gear_ratio=2.0, wraps_at=2**16)
STEERING = {
    "front_left": sw.Encoder(2**16, offset=0.1),
    "front_right": sw.Encoder(2**16, gear_ratio=-1.0, offset=0.2),
}
FIND = {"parameters": ["wheel_radius"], "cross_validation": False}


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Counts of a car's driven wheels and steering joints, with its truth."""
    made = drive(CAR, seconds=40.0)
    driven = [wheel.name for wheel in CAR.wheels if wheel.driven]
    turned = made.wheel_angles[:, [CAR.wheel_names.index(name) for name in driven]]
    columns = [np.rint(turned / WHEELS.angle_per_tick) % 2**16]
    columns += [
        np.rint((angles - STEERING[name].offset) / STEERING[name].angle_per_tick)[:, None]
        for name, angles in zip(CAR.steered_wheel_names, made.steering.T, strict=True)
    ]
    heads = ["time", *(f"{name} [ticks]" for name in driven)]
    heads += [*(f"{name}_steering [ticks]" for name in CAR.steered_wheel_names), "x", "y", "yaw"]
    table = np.hstack((made.stamps[:, None], *columns, made.truth.poses))
    np.savetxt(tmp_path / "log.csv", table, "%.9g", ",", header=",".join(heads), comments="")
    return tmp_path / "log.csv"


def test_encoders_are_written_into_the_file(log: Path) -> None:
    """Those given as `Encoder` were not in the file: it did not read the log that it came from."""
    given = LogOptions(wheel_encoders=WHEELS, steering_encoders=STEERING)
    done = calibrate_files(CAR, [log], log.with_name("true.yaml"), log_options=given, options=FIND)
    assert not done.warnings
    read = read_parameters(log.with_name("true.yaml"))
    said = LogOptions(wheel_encoders=read.wheel_encoders, steering_encoders=read.steering_encoders)
    again, first = (read_log(log, CAR, options)[0] for options in (said, given))
    np.testing.assert_array_equal(again.wheel_angles, first.wheel_angles)
    np.testing.assert_allclose(again.steering, first.steering, rtol=0, atol=1e-12)  # [rad], rounding


def test_encoders_that_differ_are_named(log: Path) -> None:
    """No key of a parameter file says them."""
    each = dict.fromkeys(CAR.wheel_names, WHEELS) | {
        "rear_left": WHEELS.replace(ticks_per_turn=2048, gear_ratio=1)
    }
    assert keys_of("wheel_encoders", each, CAR.wheel_names) is None
    given = LogOptions(wheel_encoders=each, steering_encoders=STEERING)
    done = calibrate_files(CAR, [log], log.with_name("true.yaml"), log_options=given, options=FIND)
    assert "wheel_encoders that differ have no keys: they are not written" in done.warnings
    assert not read_parameters(log.with_name("true.yaml")).wheel_encoders


def test_a_log_that_is_taken_at_its_word_is_so_in_the_file(log: Path) -> None:
    """The file of a rover without one was refused: "rover must be one that a parameter file can describe"."""
    given = LogOptions(wheel_encoders=WHEELS, steering_encoders=STEERING, plausibility=False)
    calibrate_files(CAR, [log], log.with_name("true.yaml"), log_options=given, options=FIND)
    assert read_parameters(log.with_name("true.yaml")).plausibility is False
