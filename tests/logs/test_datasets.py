"""Layouts of published data sets, in small files of our own writing."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pyarrow")

import six_wheel as sw
from six_wheel.log_odometry import reckon
from six_wheel.logs import read_log
from six_wheel.logs.detect_reader import log_format, logs_in
from tests.logs.forms.drives import SIX, Course, course

FOUR = course(sw.Rover.differential(0.6, 0.1, wheels_per_side=2, wheelbase=0.5))
LATITUDE, LONGITUDE = 52.2, 4.42  # [deg]


def stamp(seconds: float) -> str:
    whole = int(seconds)
    return f"2015_11_26_12_{whole // 60:02d}_{whole % 60:02d}_{round(1e3 * (seconds % 1.0)):03d}"


def part(
    folder: Path,
    drive: Course = SIX,
    columns: int = 34,
    degrees: bool = True,
    rates_in_degrees: bool = False,
) -> Path:
    """A part of a traverse in the layout of the Katwijk data set."""
    place = folder / "Traverse1" / "Part2"
    place.mkdir(parents=True)
    rows = []
    for when, wheels, joints in zip(drive.stamps, drive.angles, drive.steering, strict=True):
        numbers = [*wheels, *joints, 0.01, -0.02, 0.03]
        numbers += [0.0] * (columns - 1 - len(numbers))
        rows.append(" ".join([stamp(when), *(f"{number:.6f}" for number in numbers)]))
    (place / "odometry.txt").write_text("\n".join(rows) + "\n")
    track = sw.dead_reckon(drive.rover, drive.steering, drive.angles, drive.stamps)
    turn = 180.0 / np.pi if rates_in_degrees else 1.0
    # A sensor on its side: its y axis is up.
    imu = [
        f"{stamp(when)} 0 9.81 0 0 {turn * rate:.6f} 0 0 0"
        for when, rate in zip(drive.stamps, track.twists[:, 2], strict=True)
    ]
    (place / "imu.txt").write_text("\n".join(imu) + "\n")
    poses = track.poses[::20]
    places = []
    for when, (x, y, _) in zip(drive.stamps[::20], poses, strict=True):
        # East and north of the first fix; a minute of arc of latitude is about 1,855 m here.
        north = LATITUDE + y / 111_267.0
        east = LONGITUDE + x / 68_370.0
        cells = (f"{north:.10f}", f"{east:.10f}") if degrees else (f"{x + 6e5:.4f}", f"{y + 5.8e6:.4f}")
        places.append(" ".join([stamp(when), *cells, "0.0"]))
    (place / "gps-utm31.txt").write_text("\n".join(places) + "\n")
    return place / "odometry.txt"


@pytest.mark.parametrize("degrees", [True, False], ids=["degrees", "metres"])
def test_a_part_of_katwijk_is_read_with_its_positions(tmp_path: Path, degrees: bool) -> None:
    path = part(tmp_path, degrees=degrees)
    assert log_format(path) == log_format(path.parent) == "katwijk"
    log, reader = read_log(path, SIX.rover)
    np.testing.assert_allclose(log.wheel_angles, SIX.angles, atol=1e-6)
    np.testing.assert_allclose(log.steering, SIX.steering, atol=1e-6)
    np.testing.assert_allclose(log.stamps, SIX.stamps, atol=1e-9)
    track = sw.dead_reckon(SIX.rover, log)
    np.testing.assert_allclose(log.yaw_rate[1:-1], track.twists[1:-1, 2], atol=5e-3)
    true = log.truth.poses[:, :2]
    np.testing.assert_allclose(true, track.poses[::20, :2], atol=5e-3)  # of the ellipsoid's radii above
    said = " ".join(reader.warnings)
    assert "34 columns, of which 14 are described" in said
    assert ("latitudes and longitudes" in said) == degrees


def test_the_documented_columns_alone_are_taken_without_a_word(tmp_path: Path) -> None:
    path = part(tmp_path, columns=14, degrees=False)
    result = reckon(SIX.rover, path)
    np.testing.assert_allclose(result.pose, SIX.pose, atol=1e-3)
    assert [line for line in result.warnings if "columns, of which" in line] == []


def test_rates_that_no_rover_has_are_not_read(tmp_path: Path) -> None:
    log, reader = read_log(part(tmp_path, rates_in_degrees=True), SIX.rover)
    assert log.yaw_rate is None
    assert "which are not m/s² and rad/s of a rover: it is not read" in " ".join(reader.warnings)


def test_rows_of_a_data_set_are_looked_at_as_those_of_any_log(tmp_path: Path) -> None:
    path = part(tmp_path)
    rows = [line.split() for line in path.read_text().splitlines()]
    for row in rows[200:]:
        row[1] = str(float(row[1]) % 1.0 - 50.0)
    path.write_text("\n".join(map(" ".join, rows)) + "\n")
    with pytest.raises(ValueError, match=str(path)):
        read_log(path, SIX.rover)
    log, _ = read_log(path, SIX.rover, plausibility=False)
    assert len(log) == len(SIX.stamps)


def test_a_folder_of_parts_holds_their_odometry_alone(tmp_path: Path) -> None:
    path = part(tmp_path)
    assert logs_in([tmp_path]) == [path]


def test_katwijk_needs_six_wheels_and_whole_rows(tmp_path: Path) -> None:
    path = part(tmp_path)
    with pytest.raises(ValueError, match="must have 6 wheels, 4 of them steered"):
        read_log(path, FOUR.rover)
    path.write_text(" ".join([stamp(0.0), *["0.0"] * 11]) + "\n")
    with pytest.raises(ValueError, match="n >= 2"):
        read_log(path, SIX.rover)


def trial(folder: Path) -> Path:
    """A trial in the layout of the RoSE Lab's data set."""
    place = folder / "Trial_3" / "0.4_2.0_Left_0"
    (place / "Raw_Data").mkdir(parents=True)
    (place / "Raw_Data" / "motor_data.mcap").write_bytes(b"")
    poses = sw.dead_reckon(FOUR.rover, None, FOUR.angles, FOUR.stamps).poses
    heads = ["time_s", *(f"pos_{axis}" for axis in "xyz"), *(f"quat_{axis}" for axis in "xyzw")]
    heads += [*(f"enc{k}" for k in range(1, 5)), *(f"enc{k}_rad" for k in range(1, 5))]
    heads += [*(f"vel{k}_rad_s" for k in range(1, 5)), "ang_vel_z"]
    rows = [",".join(heads)]
    for when, (x, y, yaw), wheels, rates in zip(FOUR.stamps, poses, FOUR.angles, FOUR.rates, strict=True):
        pose = [x, y, 0.1, 0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)]
        rows.append(",".join(f"{number:.7f}" for number in [when, *pose, *wheels, *wheels, *rates, 0.0]))
    path = place / "Processed_Data.csv"
    path.write_text("\n".join(rows) + "\n")
    return path


def test_a_trial_of_the_rose_lab_is_read_with_its_truth(tmp_path: Path) -> None:
    path = trial(tmp_path)
    assert log_format(path) == "rose_lab"
    log, _ = read_log(path, FOUR.rover)
    np.testing.assert_allclose(log.wheel_angles, FOUR.angles, atol=1e-6)
    track = sw.dead_reckon(FOUR.rover, log)
    np.testing.assert_allclose(log.truth.poses, track.poses, atol=1e-4)
    assert logs_in([tmp_path]) == [path]
    with pytest.raises(ValueError, match="must have 4 wheels that do not steer"):
        read_log(path, SIX.rover)
