"""A log counts once: readings that are given again make no interval of a calibration narrower."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("scipy")

import six_wheel as sw
from six_wheel.calibration import calibrate
from six_wheel.log_odometry.copies import cut, without_copies
from six_wheel.logs import GroundTruth, WheelLog
from tests.calibration.drives import drive
from tests.rovers import SMALL_PAIR as PAIR

PARAMETERS = ("wheel_radius", "track_width")
LOG = drive(PAIR, seconds=40.0)


def later(log: WheelLog, by: float) -> WheelLog:
    """The same drive by a clock that shows another time, counters that began elsewhere, and another name."""
    truth = GroundTruth(log.truth.stamps + by, log.truth.poses)
    return replace(
        log, stamps=log.stamps + by, wheel_angles=log.wheel_angles + 7.0, truth=truth, name="again"
    )


def rounded(log: WheelLog) -> WheelLog:
    """The same drive as a format with few digits has it."""
    return replace(log, stamps=log.stamps.round(3), wheel_angles=log.wheel_angles.round(4), name="few digits")


@pytest.mark.parametrize(
    "again",
    [
        LOG,
        replace(LOG, name="a copy"),
        later(LOG, 0.0),
        later(LOG, 1000.0),
        rounded(LOG),
        cut(LOG, slice(100, 600)),
        cut(later(LOG, 50.0), slice(0, 300)),
        replace(LOG, session="another day"),
    ],
    ids=["itself", "name", "counters", "clock", "digits", "part", "part by another clock", "session"],
)
def test_what_is_given_again_changes_nothing_but_a_warning(again: WheelLog) -> None:
    alone = calibrate(PAIR, [LOG], parameters=PARAMETERS, cross_validation=False)
    both = calibrate(PAIR, [LOG, again], parameters=PARAMETERS, cross_validation=False)
    np.testing.assert_array_equal(both.values, alone.values)
    np.testing.assert_array_equal(both.covariance, alone.covariance)
    lines = [line for line in both.observability.messages if "they count once" in line]
    assert len(lines) == 1
    assert "(logs[0])" in lines[0]
    assert "(logs[1])" in lines[0]


@pytest.mark.parametrize("rows", [3, 10, 20])
def test_the_shortest_part_counts_once(rows: int) -> None:
    """Fifteen of thirty rows, given again, once took an interval of a radius from 1.3 m to 0.03 mm."""
    part = replace(cut(LOG, slice(300, 300 + rows)), name="part")
    assert without_copies([LOG, part])[1] == [0]
    assert without_copies([LOG, replace(part, wheel_angles=part.wheel_angles + 7.0)])[1] == [0]
    turned = part.wheel_angles + np.linspace(0.0, 1e-6, rows)[:, None]
    assert without_copies([LOG, replace(part, wheel_angles=turned)])[1] == [0, 1]


def test_the_same_log_in_two_formats_counts_once(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    from six_wheel.simulation import write_log

    drive_of = sw.simulate(PAIR, [(0, 0.2, 0, 0.4), (9, 0.2, 0, -0.5), (20, 0, 0, 0)], rate=20.0, seed=1)
    for ending in (".csv", ".parquet"):
        write_log(drive_of, PAIR, tmp_path / f"log{ending}")
    paths = [tmp_path / "log.csv", tmp_path / "log.parquet"]
    result = calibrate(PAIR, paths, parameters=PARAMETERS, cross_validation=False)
    assert sum("they count once" in line for line in result.observability.messages) == 1


def test_the_rest_of_a_log_that_overlaps_another_one_counts() -> None:
    first, second = cut(LOG, slice(0, 500)), cut(LOG, slice(400, 801))
    kept, places, said = without_copies([first, second])
    assert places == [0, 1]
    assert len(said) == 1
    assert sum(map(len, kept)) <= len(LOG) + 2  # one row is an end and a beginning


@pytest.mark.parametrize("straight", [False, True], ids=["curves", "straight"])
def test_drives_of_one_rover_are_no_copies(straight: bool) -> None:
    drives = [drive(PAIR, seed, 40.0, straight=straight) for seed in range(4)]
    kept, places, said = without_copies(drives)
    assert (len(kept), places, said) == (4, [0, 1, 2, 3], [])


def test_the_same_commands_driven_twice_are_no_copies() -> None:
    """Their readings are alike, as far as wheels slip and stamps jitter."""
    commands = [(0, 0.2, 0, 0.4), (9, 0.2, 0, -0.5), (20, 0, 0, 0)]
    noise = sw.Noise(slip=0.005, side_slip=0.005)
    drives = [sw.simulate(PAIR, commands, noise=noise, rate=20.0, seed=seed) for seed in range(3)]
    assert without_copies(drives)[2] == []
