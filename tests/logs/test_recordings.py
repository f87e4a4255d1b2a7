"""Logs, and the OptiOdom reader on files as they are and as they should not be."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

import six_wheel as sw
from six_wheel.logs import GroundTruth, WheelLog, optiodom

METADATA = "type,diff,\nngear,43.7,\nencRes,64,\nLi,0.2,\nDi,0.084,0.084\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "day_metadata.csv").write_text(METADATA)
    return tmp_path


def write(folder, text, name="day_run-01.csv"):
    path = folder / name
    path.write_text(text)
    return path


def test_a_run_becomes_a_log(folder):
    path = write(folder, "0,0,0,0,0,0\n0.05,0.001,0,0.1,437,0\n0.1,0.002,0,0.2,0,-43.7\n")
    rover, log = optiodom.read_rover(path), optiodom.read(path)
    assert rover == optiodom.read_rover(folder / "day_metadata.csv")
    assert rover.wheel_names == ("left", "right")  # the file has the right wheel first
    turn = 2 * math.pi / (43.7 * 64)
    assert_allclose(log.wheel_angles, [(0, 0), (0, 437 * turn), (-43.7 * turn, 437 * turn)])
    assert log.steering is None
    assert log.session == "day"
    assert log.name == "day_run-01"
    assert_allclose(log.truth.poses[-1], (0.002, 0.0, 0.2))
    assert repr(log) == "WheelLog('day_run-01', 3 rows, 0.1 s, with truth)"
    assert optiodom.runs(folder) == [path]


def test_a_last_line_that_was_cut_costs_no_row(folder):
    rows = "0,0,0,0,0,0\n0.05,0,0,0,1,1\n"
    for cut in ("", "0.1,0,0,0,1", "0.1,0,0,0,1,", "0.1,0,0,0,1,-", "0.1,0,0"):
        assert len(optiodom.read(write(folder, rows + cut))) == 2


def test_a_broken_line_is_named(folder):
    for broken in ("0.05,0,0,0,1", "0.05,0,0,0,1,1,1", "0.05,0,0,0,x,1", "0.05,0,0,nan,1,1"):
        path = write(folder, f"0,0,0,0,0,0\n{broken}\n0.1,0,0,0,1,1\n")
        with pytest.raises(ValueError, match=r"day_run-01.csv: line 2 must be 6 finite numbers"):
            optiodom.read(path)


def test_a_robot_that_is_not_known_is_refused(folder):
    path = write(folder, "0,0,0,0,0,0\n")
    (folder / "day_metadata.csv").write_text(METADATA.replace("diff", "hexapod"))
    with pytest.raises(ValueError, match="type must be one of diff, tricyc, omni3, omni4, got 'hexapod'"):
        optiodom.read(path)
    (folder / "day_metadata.csv").write_text(METADATA.replace("Li,0.2,", "Li,,"))
    with pytest.raises(ValueError, match="Li must be given"):
        optiodom.read(path)


def test_the_example_is_whole():
    rover, log = optiodom.example()
    assert len(log) == 2401
    assert log.duration == pytest.approx(120.0)
    assert rover.wheels[0].steered
    assert np.isnan(log.wheel_angles[:, 1]).all()
    assert not log.wheel_angles.flags.writeable


def test_shapes_that_do_not_fit_are_refused():
    for arguments, rule in (
        (([0.0], None, [(0.0,)]), "stamps must have shape"),
        (([0.0, 1.0], None, [(0.0,)]), r"wheel_angles must have shape \(2, wheels\)"),
        (([0.0, 1.0], [(0.0,)], [(0.0,), (0.0,)]), "steering must have shape"),
        (([0.0, 1.0], None, [(0.0,), (0.0,)], [(0.0, 0.0, 0.0)]), r"poses must have shape \(2, 3\)"),
    ):
        with pytest.raises(ValueError, match=rule):
            WheelLog(*arguments)
    with pytest.raises(ValueError, match="poses must be finite"):
        GroundTruth([0.0, 1.0], [(0.0, 0.0, 0.0), (math.nan, 0.0, 0.0)])


def test_a_log_refuses_time_that_is_none_or_runs_backwards():
    angles = np.zeros((3, 2))
    with pytest.raises(ValueError, match="stamps must be finite, got nan in row 1"):
        WheelLog([0.0, math.nan, 1.0], None, angles)
    with pytest.raises(ValueError, match=r"stamps must not run backwards, got 0.5 after 1.0 in row 2"):
        WheelLog([0.0, 1.0, 0.5], None, angles)
    with pytest.raises(ValueError, match=r"yaw_rate must have shape \(3,\), got \(2,\)"):
        WheelLog([0.0, 1.0, 2.0], None, angles, yaw_rate=[0.0, 1.0])
    assert len(WheelLog([0.0, 1.0, 1.0], None, angles)) == 3  # twice the same is for readers to leave out


@pytest.mark.parametrize(
    ("options", "columns"),
    [
        ({"wheel_encoders": sw.Encoder(100, wraps_at=50)}, [[0.0, 40, 80, 120, 160], [0.0, 40, 30, 20, 10]]),
        ({"readings": "speeds"}, [[1.0, 1, 1, 1, 1], [1.0, 1, 1, 1, 1]]),
        ({"increments": True}, [[0.0, 1, 1, 1, 1], [0.0, 1, 1, 1, 1]]),
    ],
    ids=["ticks", "speeds", "increments"],
)
def test_a_reading_that_is_missing_costs_no_other(options, columns):
    """One cell without a count ended all that came behind it, and a wheel without an encoder every row."""
    values = np.array([columns[1], columns[1], [math.nan] * 5]).T
    tricycle = sw.Rover.tricycle(1.0, 0.5, 0.2)
    whole = sw.WheelLog(np.arange(5.0), np.zeros((5, 1)), values, options=options).in_radians(tricycle)
    values[2, 0] = math.nan
    found = sw.WheelLog(np.arange(5.0), np.zeros((5, 1)), values, options=options).in_radians(tricycle)
    assert np.isfinite(whole.wheel_angles[:, :2]).all()
    assert np.isnan(found.wheel_angles[:, 2]).all()
    np.testing.assert_array_equal(np.isnan(found.wheel_angles[:, 0]), np.arange(5) == 2)
    np.testing.assert_array_equal(found.wheel_angles[:, 1], whole.wheel_angles[:, 1])
    lost = 1.0 if options == {"increments": True} else 0.0  # nobody knows what was turned there
    rest = [0, 1, 3, 4]
    expected = whole.wheel_angles[rest, 0] - lost * np.array([0, 0, 1, 1])
    np.testing.assert_allclose(found.wheel_angles[rest, 0], expected, rtol=1e-14)


def test_an_option_that_is_none_is_refused():
    """`calibrate` took a misspelt one without a word, and counts for radians."""
    with pytest.raises(
        ValueError, match="options must be some of readings, increments, wheel_encoders, .* got 'encoders'"
    ):
        sw.WheelLog([0.0, 1.0], None, [[0, 0], [1, 1]], options={"encoders": sw.Encoder(100)})


def test_what_are_no_numbers_is_named():
    for name, given in (
        ("stamps", {"stamps": "ab"}),
        ("wheel_angles", {"wheel_angles": [["a", 0], [1, 1]]}),
        ("steering", {"steering": [[0.0], []]}),
        ("yaw_rate", {"yaw_rate": "fast"}),
        ("options", {"options": 5}),
    ):
        keywords = {"stamps": [0, 1], "steering": None, "wheel_angles": [[0, 0], [1, 1]]} | given
        with pytest.raises(TypeError, match=f"{name} must be"):
            WheelLog(**keywords)
    with pytest.raises(TypeError, match="poses must be rows of as many numbers each, got 'ab'"):
        GroundTruth([0, 1], "ab")
    with pytest.raises(ValueError, match="max_gap must be a number, got 'a'"):
        GroundTruth([0, 1], [[0, 0, 0], [1, 1, 1]], max_gap="a")


def test_increments_are_an_argument_of_every_reader(tmp_path):
    """`increments=True in Python` was proposed, and `read_log` and `calibrate` had no such argument."""
    rover, encoder = sw.Rover.differential(0.2, 0.042), sw.Encoder(4096)
    stamps = 0.05 * np.arange(400)
    speeds = 120.0 + 60.0 * np.sin(np.outer(stamps, (0.4, 0.5)))
    totals = np.rint(np.cumsum(speeds, axis=0))
    steps = np.diff(totals, axis=0, prepend=totals[:1])
    path = tmp_path / "log.csv"
    rows = [f"{t:.2f},{left:.0f},{right:.0f}" for t, (left, right) in zip(stamps, steps, strict=True)]
    path.write_text("\n".join(["time,left [ticks],right [ticks]", *rows]) + "\n")
    given = {"wheel_encoders": encoder, "increments": True}
    log = sw.read_log(path, rover, **given)
    assert_allclose(log.wheel_angles, (totals - totals[0]) * encoder.angle_per_tick, atol=1e-12)
    truth = GroundTruth(stamps, sw.dead_reckon(rover, log).poses)
    for drive in (path, WheelLog(stamps, None, steps)):
        found = sw.calibrate(rover, drive, truth, ["wheel_radius"], cross_validation=False, **given)
        assert_allclose(found.values, [0.042], rtol=1e-6)
    path.write_text(path.read_text().replace("[ticks]", "[rad/s]"))
    with pytest.raises(ValueError, match="increments must be left out where wheels are read as speeds"):
        sw.read_log(path, rover, increments=True)
