"""`six-wheel calibrate`: logs and truth in; a parameter file ready to use, a picture and a report out."""

import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.calibration import Estimate
from six_wheel.calibration.files import calibrate_files, interval
from six_wheel.logs.log_options import LogOptions
from six_wheel.logs.optiodom import example, example_run
from six_wheel.robot_description.parameters import read_parameters
from tests.calibration.drives import drive as wandering
from tests.cli.calibrate_drives import NOMINAL, TRUE, write
from tests.cli_runs import Run
from tests.odometry_logs import drive

Refused = Callable[..., str]
FIND = ("--parameters", "wheel_radius,track_width")


def write_still(path: str, rows: int = 100) -> None:
    """A log in which the rover of `write` stands where it is."""
    stamps = 0.05 * np.arange(rows)
    columns = np.column_stack([stamps, np.zeros((rows, 5))])
    np.savetxt(path, columns, delimiter=",", header="time,left [rad],right [rad],x,y,yaw", comments="")


def row(out: str, name: str) -> list[str]:
    found = re.search(rf"^ *{re.escape(name)} +(.*\S)", out, re.MULTILINE)
    assert found, f"{name} in\n{out}"
    return found[1].split()


def test_the_true_dimensions_are_found_and_written_into_the_file(run: Run, drives: None) -> None:
    logs = ("run1.csv", "run2.csv", "run3.csv")
    code, out, err = run("calibrate", "cart.yaml", *logs, *FIND, "-o", "true.yaml")
    assert (code, err) == (0, "")
    nominal, value, low, _, high, unit = row(out, "track_width")
    assert (nominal, unit) == ("0.4", "m")
    assert float(low) <= float(value) <= float(high)
    assert float(value) == pytest.approx(0.408, abs=2e-4)  # [m], of 1 mrad and 0.1 mm
    assert float(row(out, "wheel_radius")[1]) == pytest.approx(0.0985, abs=2e-5)
    for name in ("run1", "run2", "run3"):
        _, before, after = map(float, row(out, name))
        assert after < 0.1 * before
    assert "each predicted by a fit without it" in out

    text = Path("true.yaml").read_text()
    assert text.startswith("# Calibrated by six-wheel ")
    for kept in ("# Measured with a tape.", "# hub to hub", 'noise: {"slip": ', "kind: differential"):
        assert kept in text
    rover = sw.load("true.yaml")
    found = calibrate_files(
        sw.load("cart.yaml"),
        [Path(log) for log in logs],
        options={"parameters": ["wheel_radius", "track_width"]},
    )
    for one, other in zip(rover.wheels, found.result.rover.wheels, strict=True):
        assert (one.y, one.radius) == pytest.approx((other.y, other.radius), rel=1e-12)

    _, out, _ = run("odometry", "true.yaml", "run1.csv")
    said = re.search(r"ATE +(\S+) m", out)
    assert said
    assert float(said[1]) == pytest.approx(found.result.runs[0].after, abs=1e-4)  # as printed


def test_one_command_calibrates_the_example(run: Run) -> None:
    pytest.importorskip("matplotlib")
    code, out, err = run("calibrate", "--example", "-o", "r.yaml", "--plot", "p.png", "--report", "r.md")
    assert (code, err) == (0, "")
    before, after = map(float, row(out, "140120211508_run-01")[1:])
    assert after < 0.1 * before
    page = (Path(__file__).parents[2] / "docs" / "tutorials" / "log.md").read_text(encoding="utf-8")
    assert f"errs by {before:.3f} m rms; with those found, by {after:.3f} m." in " ".join(page.split())
    assert Path("p.png").read_bytes().startswith(b"\x89PNG")
    text = Path("r.md").read_text()
    pictures = re.findall(r"!\[.*?\]\(<(.*?)>\)", text)
    assert pictures == ["r.png", "r_windows.png"]
    assert all(Path(picture).exists() for picture in pictures)
    for part in (
        "# Calibration of 140120211508",
        "## Runs",
        "## Cross-validation",
        "six-wheel odometry r.yaml LOG",
    ):
        assert part in text
    _, out, _ = run("odometry", "r.yaml", "--example")
    said = re.search(r"ATE +(\S+) m", out)
    assert said
    assert float(said[1]) == pytest.approx(after, abs=1e-4)  # as printed
    assert example()[0] == sw.logs.optiodom.read_rover(example_run())


def test_a_straight_run_cannot_tell_the_track(run: Run, drives: None) -> None:
    write("straight.csv", seed=0, straight=True)
    code, out, _ = run("calibrate", "cart.yaml", "straight.csv", *FIND, "-o", "s.yaml")
    assert code == 0
    assert row(out, "track_width")[2:4] == ["not", "identified"]
    assert re.search(r"^- track_width stays at its nominal 0\.4 m: a straight run cannot", out, re.MULTILINE)
    assert sw.load("s.yaml").wheels[0].y == pytest.approx(0.2, abs=1e-9)
    assert "a straight run cannot identify it" in Path("s.yaml").read_text()


def test_truth_of_its_own_for_all_logs_or_for_each(run: Run, refused: Refused, drives: None) -> None:
    for seed in (1, 2):
        write(f"bare{seed}.csv", seed=seed, truth=False)
    joint = run("calibrate", "cart.yaml", "run1.csv", "run2.csv", *FIND, "--no-cross-validation")[1]
    truths = ("--truth", "run1.csv", "--truth", "run2.csv")
    apart = run("calibrate", "cart.yaml", "bare1.csv", "bare2.csv", *truths, *FIND, "--no-cross-validation")[
        1
    ]
    assert row(joint, "track_width") == row(apart, "track_width")
    both = ("calibrate", "cart.yaml", "bare1.csv", "bare2.csv", "run3.csv", *truths)
    assert "truth must be given once, or once for every log, got 2 for 3 logs" in refused(*both)
    assert "where the rover really was; give --truth" in refused("calibrate", "cart.yaml", "bare1.csv")


def test_factors_of_readings_go_into_the_file_and_are_applied(run: Run, drives: None) -> None:
    """Wheels of the right size whose encoders count 2 % too few."""
    for seed in (1, 2):
        write(f"few{seed}.csv", seed=seed, gain=1.02)
    Path("cart.yaml").write_text(NOMINAL.replace("0.40 ", "0.408").replace("0.10", "0.0985"))
    options = ("--parameters", "encoder_scale", "-o", "scaled.yaml")
    code, _, err = run("calibrate", "cart.yaml", "few1.csv", "few2.csv", *options)
    assert (code, err) == (0, "")
    parameters = read_parameters("scaled.yaml")
    assert parameters.rover == sw.load("cart.yaml")
    assert parameters.wheel_encoders["scale"] == pytest.approx(1.02, abs=2e-4)
    _, out, _ = run("odometry", "scaled.yaml", "few1.csv")
    said = re.search(r"ATE +(\S+) m", out)
    assert said
    assert float(said[1]) < 0.01
    # Once more: what was found is built upon, not found again.
    run(
        "calibrate",
        "scaled.yaml",
        "few1.csv",
        "few2.csv",
        "--parameters",
        "encoder_scale",
        "-o",
        "twice.yaml",
    )
    again = read_parameters("twice.yaml").wheel_encoders["scale"]
    assert again == pytest.approx(1.02, abs=2e-4)


def test_where_the_sensor_sits_and_its_clock_go_into_the_file_and_are_used(run: Run, drives: None) -> None:
    """The truth follows a point 8 cm ahead, its clock 0.1 s ahead; twice found is found once."""
    for seed in (1, 2, 3):
        log = wandering(TRUE, seed, noise=1e-5, resolution=1e-6, sensor=(0.08, 0.02, 0.01), offset=0.1)
        rows = np.column_stack((log.stamps, log.wheel_angles))
        header = "time,left [rad],right [rad]"
        np.savetxt(f"bare{seed}.csv", rows, delimiter=",", header=header, comments="", fmt="%.9f")
        rows = np.column_stack((log.truth.stamps, log.truth.poses))
        np.savetxt(f"truth{seed}.csv", rows, delimiter=",", header="time,x,y,yaw", comments="", fmt="%.9f")
    logs = [f"bare{seed}.csv" for seed in (1, 2, 3)]
    truths = [part for seed in (1, 2, 3) for part in ("--truth", f"truth{seed}.csv")]
    find = ("--parameters", "wheel_radius,track_width,sensor,time_offset", "--no-cross-validation")
    for source, target in (("cart.yaml", "once.yaml"), ("once.yaml", "twice.yaml")):
        code, _, err = run("calibrate", source, *logs, *truths, *find, "-o", target)
        assert (code, err) == (0, "")
        found = read_parameters(target)
        assert found.truth == pytest.approx({"x": 0.08, "y": 0.02, "yaw": 0.01, "time_offset": 0.1}, abs=1e-3)
        assert found.rover.wheels[0].y == pytest.approx(0.204, abs=1e-4)
    names = found.calibration["parameters"]
    assert names[:2] == ["wheel_radius", "track_width"]
    assert np.shape(found.calibration["covariance"]) == (len(names), len(names))
    for kept, error in (("once.yaml", 1e-3), ("bad.yaml", 0.05)):
        if kept == "bad.yaml":
            whole = Path("once.yaml").read_text()
            Path(kept).write_text(re.sub(r"^truth: .*$", "", whole, flags=re.MULTILINE))
        _, out, _ = run("odometry", kept, "bare1.csv", "--truth", "truth1.csv")
        said = re.search(r"ATE +(\S+) m", out)
        assert said
        assert (float(said[1]) < error) == (kept == "once.yaml")


def test_positions_of_a_total_station_are_a_truth(run: Run, drives: None) -> None:
    pytest.importorskip("matplotlib")
    log = wandering(TRUE, 1, noise=1e-4)
    rows = np.column_stack((log.stamps, log.wheel_angles))
    np.savetxt("bare.csv", rows, delimiter=",", header="time,left [rad],right [rad]", comments="", fmt="%.9f")
    rows = np.column_stack((log.truth.stamps, log.truth.poses[:, :2]))
    np.savetxt("station.csv", rows, delimiter=",", header="time,x,y", comments="", fmt="%.9f")
    given = ("cart.yaml", "bare.csv", "--truth", "station.csv")
    code, out, err = run("calibrate", *given, *FIND, "--plot", "p.png", "-o", "t.yaml")
    assert (code, err) == (0, "")
    assert float(row(out, "track_width")[1]) == pytest.approx(0.408, abs=2e-3)
    assert "positions alone tell no heading" in " ".join(out.split())
    code, out, err = run("odometry", *given)
    assert (code, err) == (0, "")
    assert re.search(r"ATE +0\.\d+ m after the best alignment: positions alone tell no heading", out)


def test_positions_find_a_clock_and_a_place_that_are_used_afterwards(run: Run, drives: None) -> None:
    """A prism 8 cm ahead and 2 cm to the left, a clock 0.1 s ahead; twice found is found once."""
    logs, truths = [], []
    for seed in (1, 2, 3):
        log = wandering(TRUE, seed, noise=1e-5, resolution=1e-6, sensor=(0.08, 0.02, 0.0), offset=0.1)
        for name, header, rows in (
            ("bare", "time,left [rad],right [rad]", np.column_stack((log.stamps, log.wheel_angles))),
            ("station", "time,x,y", np.column_stack((log.truth.stamps, log.truth.poses[:, :2]))),
        ):
            path = f"{name}{seed}.csv"
            np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.9f")
        logs.append(f"bare{seed}.csv")
        truths += ["--truth", f"station{seed}.csv"]
    find = "wheel_radius,track_width,sensor_x,sensor_y,time_offset"
    for source, target in (("cart.yaml", "once.yaml"), ("once.yaml", "twice.yaml")):
        options = ("--parameters", find, "--no-cross-validation", "-o", target)
        code, _, err = run("calibrate", source, *logs, *truths, *options)
        assert (code, err) == (0, "")
        found = read_parameters(target).truth
        assert found == pytest.approx({"x": 0.08, "y": 0.02, "yaw": 0.0, "time_offset": 0.1}, abs=2e-3)
    for file, error in (("once.yaml", 2e-3), ("cart.yaml", 0.02)):
        code, out, err = run("odometry", file, "bare1.csv", "--truth", "station1.csv")
        assert (code, err) == (0, "")
        said = re.search(r"ATE +(\S+) m after the best alignment", out)
        assert said
        assert (float(said[1]) < error) == (file == "once.yaml")


def test_bad_rows_are_warned_of(run: Run, drives: None) -> None:
    lines = Path("run1.csv").read_text().splitlines()
    lines[10] = "nan" + lines[10]
    Path("bad.csv").write_text("\n".join(lines) + "\n")
    code, _, err = run("calibrate", "cart.yaml", "bad.csv", *FIND, "--no-cross-validation")
    assert code == 0
    assert err.startswith("six-wheel: warning: bad.csv: row 10 (line 11): ")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "ROVER and LOG must be given, or --example"),
        (["cart.yaml"], "ROVER and LOG must be given, or --example"),
        (["cart.yaml", "run1.csv", "--example"], "LOG must be left out with --example, got run1.csv"),
        (["cart.yaml", "runs1.csv"], 'no such file; did you mean "run1.csv"?'),
        (["cart.yaml", "run1.csv", "--parameters", "track_with"], "parameters must be some of"),
        (["cart.yaml", "run1.csv", "--parameters", ","], "parameters must name one at least"),
        (["cart.yaml", "run1.csv", "--loss", "l2"], "loss must be one of"),
        (["cart.yaml", "run1.csv", "--confidence", "2"], "confidence must be between 0 and 1, got 2"),
        (["cart.yaml", "run1.csv", "--segment", "-1"], "window must be finite and positive"),
        (["cart.yaml", "run1.csv", "-o", "r.csv"], 'the ending must be .yaml or .yml, got ".csv"'),
        (["cart.yaml", "run1.csv", "-o", "cart.yaml"], "the output must be another file than cart.yaml"),
        (["cart.yaml", "run1.csv", "-o", "none/r.yaml"], "the folder of the output must exist"),
        (["cart.yaml", "run1.csv", "--report", "r.txt"], "the ending must be .md or .markdown"),
        (["cart.yaml", "run1.csv", "--plot", "r.xyz"], "the ending must be one of .png, .svg, .pdf"),
        (["cart.yaml", "run1.csv", "--truth", "late.csv"], "the truth must overlap the log in time"),
    ],
)  # fmt: skip
def test_wrong_usage(refused: Refused, drives: None, arguments: list[str], words: str) -> None:
    way = drive(TRUE, n=5)
    late = "".join(
        f"{1000 + t},{x},{y},{yaw}\n" for t, (x, y, yaw) in zip(way.stamps, way.poses, strict=True)
    )
    Path("late.csv").write_text("time,x,y,yaw\n" + late)
    assert words in refused("calibrate", *arguments)


def test_progress_names_what_is_done(run: Run, drives: None) -> None:
    seen: list[tuple[int, int, str]] = []
    calibrate_files(
        sw.load("cart.yaml"),
        [Path("run1.csv"), Path("run2.csv")],
        log_options=LogOptions(),
        options={"parameters": ["wheel_radius"]},
        progress=lambda *step: seen.append(step),
    )
    assert seen[0] == (0, 2, "reading run1.csv")
    assert all(done <= total for done, total, _ in seen)
    assert len(seen) > 3


def test_without_scipy_the_install_line_is_named(refused: Refused, drives: None, monkeypatch) -> None:
    import sys

    for name in [name for name in sys.modules if name.startswith("scipy")]:
        monkeypatch.setitem(sys.modules, name, None)
    for name in [name for name in sys.modules if name.startswith("six_wheel.calibration")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delattr("six_wheel.calibration", raising=False)
    monkeypatch.setitem(sys.modules, "scipy", None)
    assert "pip install" in refused("calibrate", "cart.yaml", "run1.csv")


@pytest.mark.parametrize(
    ("low", "high", "words"),
    [
        (0.19983, 0.20017, "0.19983 to 0.20017"),
        (-0.16, 0.48, "-0.16 to 0.48"),
        (99.0, 101.0, "99.00 to 101.00"),
        (1.0, 1.0, "1.000000 to 1.000000"),
    ],
)
def test_intervals_have_the_digits_they_are_worth(low: float, high: float, words: str) -> None:
    middle = (low + high) / 2
    assert interval(Estimate("a", "m", middle, middle, (high - low) / 4, (low, high))) == words
    assert interval(Estimate("a", "m", middle, middle, math.nan, (math.nan, math.nan))) == "not identified"


def test_a_log_in_which_the_rover_stands_still_is_left_out_with_a_word(
    run: Run, refused: Refused, drives: None
) -> None:
    logs = ["run1.csv", "run2.csv", "run3.csv"]
    _, without, _ = run("calibrate", "cart.yaml", *logs, *FIND)
    write_still("still.csv")
    _, beside, said = run("calibrate", "cart.yaml", "still.csv", *logs, *FIND)
    assert beside == without
    assert "warning: still: left out: the rover stands still" in said
    assert "(still) must move while its truth is known" in refused(
        "calibrate", "cart.yaml", "still.csv", *FIND
    )


def test_a_log_that_begins_standing_still_is_validated_on_the_rest_of_it(run: Run, drives: None) -> None:
    moving = np.loadtxt("run1.csv", delimiter=",", skiprows=1)
    still = np.repeat(moving[:1], 3 * len(moving), axis=0)
    still[:, 0] -= 0.05 * np.arange(len(still), 0, -1)
    Path("late.csv").write_text("time,left [rad],right [rad],x,y,yaw\n")
    with Path("late.csv").open("a") as file:
        np.savetxt(file, np.concatenate([still, moving]), delimiter=",", fmt="%.9f")
    _, out, _ = run("calibrate", "cart.yaml", "late.csv", *FIND)
    assert row(out, "track_width")
