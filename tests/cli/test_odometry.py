"""`six-wheel odometry`: logs of every kind in; track, findings, errors, a picture and a report out."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.log_odometry.slip import SlipSum
from tests.cli.odometry_tables import CART, WAY, Refused, read, table
from tests.cli_runs import Run
from tests.odometry_logs import drive
from tests.optiodom_data import FOLDER, REQUIRED, RUNS
from tests.rovers import PAIR, SIX_WHEELS


def value(out: str, name: str) -> str:
    """The figure of that name in a summary."""
    found = re.search(rf"^{re.escape(name)} {{2,}}(.*\S)", out, re.MULTILINE)
    assert found, f"{name} in\n{out}"
    return found[1]


# --- what comes out --------------------------------------------------------------------------------------


@pytest.mark.parametrize("ending", ["csv", "parquet"])
@pytest.mark.parametrize("chunk_rows", ["7", "200000"])
def test_the_track_is_that_of_dead_reckon(run: Run, cart: None, ending: str, chunk_rows: str) -> None:
    code, out, err = run("odometry", "cart.yaml", "log.csv", "-o", f"t.{ending}", "--chunk-rows", chunk_rows)
    assert (code, err) == (0, "")
    track = sw.dead_reckon(PAIR, None, WAY.angles, WAY.stamps)
    written = read(f"t.{ending}")
    assert written["row"].tolist() == list(range(1, len(WAY.stamps) + 1))
    for name, expected in {
        "time": WAY.stamps,
        "x": track.poses[:, 0],
        "yaw": track.poses[:, 2],
        "omega": track.twists[:, 2],
        "covariance_x_yaw": track.covariances[:, 0, 2],
        "covariance_y_y": track.covariances[:, 1, 1],
        "residual_right": track.residuals[:, 1],
        "health": track.health,
    }.items():
        np.testing.assert_allclose(written[name], expected, rtol=1e-14, atol=0, err_msg=name)  # as written
    x, y, yaw = track.poses[-1]
    dx, dy, dyaw = np.sqrt(np.diag(track.covariances[-1]))
    end = f"x {x:.4f} ± {dx:.4f} m, y {y:.4f} ± {dy:.4f} m, yaw {yaw:.4f} ± {dyaw:.4f} rad"
    assert value(out, "end pose (1 σ)").startswith(end)
    assert value(out, "rows") == f"{len(track)}"
    assert value(out, "duration") == "10 s"
    assert value(out, "rows left out") == "none"
    assert value(out, "results") == f"t.{ending}"


def test_the_truth_is_compared_wherever_it_is(run: Run, cart: None) -> None:
    """In columns of the log, in some of its rows, in another file and frame: the same figures."""
    Path("sparse.csv").write_text(table(every=4))
    lines = ["stamp;truth_x [mm];truth_y [mm];heading [deg]"]
    for stamp, (x, y, yaw) in zip(WAY.stamps.tolist(), WAY.poses.tolist(), strict=True):
        turned = (1000 * (5 - y), 1000 * (7 + x), math.degrees(yaw) + 90)  # a quarter turn to the left
        lines.append(";".join(map(repr, (stamp, *turned))))
    Path("truth.csv").write_text("\n".join(lines) + "\n")
    Path("bare.csv").write_text("".join(f"{line.rsplit(',', 3)[0]}\n" for line in table().splitlines()))
    Path("long.yaml").write_text(CART.replace("0.1", "0.101"))
    said = set()
    for log, *truth in (["log.csv"], ["bare.csv", "--truth", "truth.csv"]):
        code, out, err = run("odometry", "long.yaml", log, *truth)
        assert (code, err) == (0, "")
        said.add((value(out, "ATE"), value(out, "error per distance"), value(out, "error at the end")))
        # Wheels that are 1 % too large make the way 1 % too long: that is what is found of every half metre.
        assert value(out, "error per distance").startswith("1.0")
    assert len(said) == 1
    assert "ATE" in run("odometry", "long.yaml", "sparse.csv")[1]
    assert "ATE" not in run("odometry", "long.yaml", "bare.csv")[1]


def test_a_right_rover_has_no_error(run: Run, cart: None) -> None:
    _, out, _ = run("odometry", "cart.yaml", "log.csv", "--segment", "1")
    assert value(out, "ATE") == "0.0000 m with the first pose given, 0.0000 m after the best alignment"
    assert value(out, "error per distance") == "0.00 % and 0.00° over 1 m"


def test_picture_and_report_go_together(run: Run, cart: None) -> None:
    pytest.importorskip("matplotlib")
    code, out, err = run("odometry", "cart.yaml", "log.csv", "--plot", "p.svg", "--report", "drive 1.md")
    assert (code, err) == (0, "")
    assert "<svg" in Path("p.svg").read_text()
    assert Path("drive 1.png").read_bytes().startswith(b"\x89PNG")
    text = Path("drive 1.md").read_text()
    assert text.startswith("# Odometry of log.csv\n")
    for picture in re.findall(r"!\[.*?\]\(<(.*?)>\)", text):
        assert Path(picture).exists()
    for row in ("| rows left out | none |", "| left |", "## Against the truth", "| ATE |"):
        assert row in text
    assert not [line for line in text.splitlines() if line.startswith("|") and line.count("|") < 3]
    assert (value(out, "picture"), value(out, "report")) == ("p.svg", "drive 1.md")


def test_without_truth_there_is_a_picture_too(run: Run, cart: None) -> None:
    pytest.importorskip("matplotlib")
    Path("bare.csv").write_text("".join(f"{line.rsplit(',', 3)[0]}\n" for line in table().splitlines()))
    assert run("odometry", "cart.yaml", "bare.csv", "--plot", "p.png", "--report", "p.md")[0] == 0
    assert Path("p.png").read_bytes().startswith(b"\x89PNG")
    assert "## Against the truth" not in Path("p.md").read_text()


# --- what is said of bad rows and slip -------------------------------------------------------------------


def test_bad_rows_are_named_by_reason_and_cost_only_themselves(run: Run, cart: None) -> None:
    lines = table().splitlines()
    cells = [line.split(",") for line in lines]
    cells[11][1] = "nan"
    cells[21] = cells[21][:2]
    cells[31][0] = cells[30][0]
    cells[41][1] = "abc"
    Path("bad.csv").write_text("\n".join(",".join(row) for row in cells) + "\n0.5,12")
    code, out, err = run("odometry", "cart.yaml", "bad.csv", "-o", "t.csv")
    assert (code, err) == (0, "")
    assert "wheel left must be a finite number: 1 (row 11)" in out
    assert "a row must have 6 cells as the header has: 1 (row 21)" in out
    assert "time must increase: 1 (row 31)" in out
    assert "wheel left must be a number: 1 (row 41)" in out
    assert "the last row must end in a line end, or its last number may be cut short: 1 (row 202)" in out
    assert value(out, "rows") == f"{len(WAY.stamps) - 4}"
    # Angles are running totals: what was lost with a row is in the next one.
    assert value(out, "ATE").startswith("0.000")
    assert read("t.csv")["row"].tolist() == [k for k in range(1, 202) if k not in (11, 21, 31, 41)]


def test_many_bad_rows_are_counted_and_the_first_are_named(run: Run, cart: None) -> None:
    lines = table().splitlines()
    for k in range(11, 200, 10):
        lines[k] = "nan" + lines[k][lines[k].index(",") :]
    Path("bad.csv").write_text("\n".join(lines) + "\n")
    _, out, _ = run("odometry", "cart.yaml", "bad.csv")
    assert "time must be a finite number: 19 (rows 11, 21, 31, 41, 51, ...)" in out


def test_a_wheel_that_slips_is_named_with_the_stretch(run: Run) -> None:
    way = drive(SIX_WHEELS, n=100)
    angles = way.angles.copy()
    slip = (way.stamps > 4.0) & (way.stamps <= 6.0)
    angles[:, 2] += np.cumsum(np.where(slip, 0.4, 0.0))  # middle left, 1.2 m/s too fast
    names = [*way.rover.traction_joints, *way.rover.steering_joints]
    header = ",".join(["time", *(f"{name}/position" for name in names)])
    rows = np.column_stack([way.stamps, angles, way.steering])
    np.savetxt("log.csv", rows, delimiter=",", header=header, comments="", fmt="%.17g")
    Path("six.yaml").write_text("{d1: 0.4, d2: 0.5, d3: 0.5, d4: 0.45, wheel_radius: 0.15}")
    for chunk_rows in ("9", "1000"):
        code, out, err = run("odometry", "six.yaml", "log.csv", "--chunk-rows", chunk_rows)
        assert (code, err) == (0, "")
        assert value(out, "most at odds").startswith("middle_left: ")
        found = re.fullmatch(r"middle_left, (\S+) s to (\S+) s \(rows .*\): (\S+) mm", value(out, "slip"))
        assert found, out
        begin, end, slid = map(float, found.groups())
        assert begin == pytest.approx(4.1, abs=0.11)
        assert end == pytest.approx(6.0, abs=0.11)
        assert slid > 500
    robust = run("odometry", "six.yaml", "log.csv", "--robust", "-o", "t.csv")
    assert robust[0] == 0
    end = [read("t.csv")[name][-1] for name in ("x", "y")]
    assert math.dist(end, way.poses[-1][:2]) < 0.01  # [m]; of the six wheels five agree


def test_pieces_of_a_slip_report_are_the_whole(run: Run) -> None:
    way = drive(SIX_WHEELS, n=60)
    angles = way.angles.copy()
    angles[30:60, 4] = angles[30, 4]
    track = sw.dead_reckon(way.rover, way.steering, angles, way.stamps, method="robust")
    whole, pieces = track.slip_report(), SlipSum()
    odometry = sw.Odometry(way.rover, method="robust")
    for start in range(0, len(track), 25):
        part = slice(start, start + 25)
        piece = odometry.run(way.steering[part], angles[part], way.stamps[part])
        pieces.add(piece, np.arange(start, start + len(piece)))
    joined = pieces.report(way.rover)
    assert joined.rows == whole.rows
    for one, other in zip(joined.wheels, whole.wheels, strict=True):
        assert (one.name, one.worst, one.worst_row) == (other.name, other.worst, other.worst_row)
        for name in ("rms", "mean", "worst_share", "weight"):
            assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-12)
    (one,), (other,) = joined.windows, whole.windows
    assert (one.wheel, one.first_row, one.last_row) == (other.wheel, other.first_row, other.last_row)
    # At a seam the step before it is not seen: three of them, at 0.05 s and the largest residual.
    assert one.distance == pytest.approx(other.distance, abs=3 * 0.05 * other.worst)


def test_a_wheel_that_reads_nothing_cannot_slip() -> None:
    """The sides of a passive wheel slide by the rounding of the others' fit, which is no finding."""
    rover = sw.Rover.bicycle(0.6, 0.1, driven="front")
    way = drive(rover, n=100)
    angles = way.angles.copy()
    angles[:, rover.wheel_names.index("rear")] = math.nan
    track = sw.dead_reckon(rover, way.steering, angles, way.stamps)
    assert not len(track.rows(sw.OdometryHealth.SLIP))


# --- logs of every kind ----------------------------------------------------------------------------------


def test_counts_are_read_by_the_encoders_of_the_file(run: Run, cart: None) -> None:
    per_turn = 64 * 30.0
    counts = np.rint(WAY.angles * per_turn / math.tau) % 4096
    counts[:, 1] = -counts[:, 1] % 4096
    lines = ["time_ms,left [ticks],right [ticks]"]
    lines += [f"{1000 * t!r},{a:g},{b:g}" for t, (a, b) in zip(WAY.stamps.tolist(), counts, strict=True)]
    Path("counts.csv").write_text("\n".join(lines) + "\n")
    encoders = "wheel_encoders: {ticks_per_turn: 64, gear_ratio: 30, wraps_at: 4096, reversed: [right]}\n"
    Path("counted.yaml").write_text(CART + encoders)
    assert run("odometry", "counted.yaml", "counts.csv", "-o", "t.csv")[0] == 0
    track = read("t.csv")
    # Half a count of a wheel, over its radius and the track.
    np.testing.assert_allclose(track["yaw"], WAY.poses[:, 2], atol=2 * math.pi * 0.1 / per_turn / 0.4)
    short = CART + "wheel_encoders: {reversed: [right_wheel_joint]}\n"
    Path("short.yaml").write_text(short)
    options = ("--ticks-per-turn", "64", "--gear-ratio", "30", "--wraps-at", "4096")
    assert run("odometry", "short.yaml", "counts.csv", "-o", "u.csv", *options)[0] == 0
    assert Path("t.csv").read_text() == Path("u.csv").read_text()
    # Encoders that count have nothing to do with angles.
    _, out, _ = run("odometry", "counted.yaml", "log.csv")
    assert value(out, "ATE").startswith("0.0000 m")


def test_angles_that_wrap(run: Run, cart: None) -> None:
    angles = WAY.angles % math.tau
    rows = zip(WAY.stamps.tolist(), *angles.T.tolist(), strict=True)
    lines = ["time,left [rad],right [rad]", *(",".join(map(repr, row)) for row in rows)]
    Path("wrapped.csv").write_text("\n".join(lines) + "\n")
    assert run("odometry", "cart.yaml", "wrapped.csv", "--wraps-at", repr(math.tau), "-o", "t.csv")[0] == 0
    np.testing.assert_allclose(read("t.csv")["x"], WAY.poses[:, 0], atol=1e-9)  # sums of 200 roundings


def test_odd_headers_are_mapped(run: Run, refused: Refused, cart: None) -> None:
    Path("odd.csv").write_text(table().replace("left [rad]", "encL").replace("right [rad]", "encR"))
    columns = ("--column", "encL=left [rad]", "--column", "encR=right [rad]")
    _, out, _ = run("odometry", "cart.yaml", "odd.csv", *columns)
    assert value(out, "ATE").startswith("0.0000 m")
    message = refused("odometry", "cart.yaml", "odd.csv", "--column", "encL")
    assert message.startswith("column must be HEADER=MEANING")
    assert '"encX"' in refused("odometry", "cart.yaml", "odd.csv", "--column", "encX=left [rad]")


def test_times_since_1970_are_written_to_the_nanosecond(run: Run, cart: None) -> None:
    begin = 1_700_000_000_123_456_789
    lines = ["time_ns,left [rad],right [rad]"]
    lines += [f"{begin + 50_000_000 * k},{a!r},{b!r}" for k, (a, b) in enumerate(WAY.angles.tolist())]
    Path("long.csv").write_text("\n".join(lines) + "\n")
    assert run("odometry", "cart.yaml", "long.csv", "-o", "t.csv")[0] == 0
    first, second = (line.split(",")[0] for line in Path("t.csv").read_text().splitlines()[:2])
    assert (first, int(second)) == ("time_ns", begin)


@REQUIRED
def test_an_optiodom_run_is_known_by_its_metadata(run: Run, refused: Refused, tmp_path: Path) -> None:
    path = FOLDER / RUNS["diff"][0]["run"]
    metadata = path.with_name(path.stem.rpartition("_run-")[0] + "_metadata.csv")
    code, out, err = run("odometry", str(metadata), str(path))
    assert (code, err) == (0, "")
    assert "ATE" in out
    assert "wheels must be left, right" in refused("odometry", "perseverance", str(path))
    lonely = tmp_path / path.name
    lonely.write_bytes(path.read_bytes())
    assert "metadata.csv: No such file" in refused(
        "odometry", str(metadata), str(lonely), "--log-format", "optiodom"
    )


def test_a_bag_is_read_with_its_truth(run: Run, refused: Refused) -> None:
    pytest.importorskip("rosbags")
    Path("drive.csv").write_text("time,vx,omega\n" + "".join(f"{k / 10},0.5,0.2\n" for k in range(50)))
    Path("cart.yaml").write_text(CART)
    assert run("drive", "cart.yaml", "drive.csv", "-o", "run.mcap")[0] == 0
    code, out, _ = run("odometry", "cart.yaml", "run.mcap")
    assert code == 0
    assert float(value(out, "distance").split()[0]) == pytest.approx(0.5 * 4.9, rel=1e-3)  # chords
    assert "topic must be one of" in refused("odometry", "cart.yaml", "run.mcap", "--topic", "/none")


# --- settings --------------------------------------------------------------------------------------------


def test_noise_comes_from_the_file_and_over_it_from_options(run: Run, cart: None) -> None:
    Path("noisy.yaml").write_text(CART + "noise: {speed: 0.02, slip: 0.01}\nodometry: {method: robust}\n")
    run("odometry", "noisy.yaml", "log.csv", "-o", "t.csv")
    rover, noise = PAIR, sw.Noise(0.02, slip=0.01)
    track = sw.dead_reckon(rover, None, WAY.angles, WAY.stamps, noise=noise, method="robust")
    np.testing.assert_allclose(read("t.csv")["covariance_x_x"], track.covariances[:, 0, 0], rtol=1e-14)
    run("odometry", "noisy.yaml", "log.csv", "-o", "t.csv", "--slip-noise", "0", "--speed-noise", "0.03")
    track = sw.dead_reckon(rover, None, WAY.angles, WAY.stamps, noise=sw.Noise(0.03), method="robust")
    np.testing.assert_allclose(read("t.csv")["covariance_x_x"], track.covariances[:, 0, 0], rtol=1e-14)
