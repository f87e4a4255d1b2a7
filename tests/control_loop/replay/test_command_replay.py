"""The record of a drive done again: the same bits, or what other parameters make of its table."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mcap", reason='needs pip install "six-wheel[bags]"')
pytest.importorskip("pydantic", reason='needs pip install "six-wheel[cli]"')

from six_wheel.control_loop.replay import compare, replay
from six_wheel.logs.mcap import Record, RecordError
from six_wheel.simulation.drive.closed_loop import DriveLoop
from six_wheel.simulation.drive.run_file import drive
from tests.limits import only
from tests.rovers import SIX_WHEELS as ROVER

# Without limits of the yaw rate's change: curves of the table are met, and so is the speed in them.
GIVEN = {"acceleration": 0.5, "jerk": 2.0, "wheel_speed": 8.0, "steering_rate": 1.0}
LIMITS = only(speed=1.0, **GIVEN)
SINCE_1970 = 1_700_000_000_123_456_789  # [ns], which no double holds


def table(path: Path, unit: str = "s", rows: int = 200) -> Path:
    """Curves, a spin on the spot and a stop, at times that are no multiples of anything."""
    random = np.random.default_rng(3)
    times = np.cumsum(random.uniform(0.03, 0.07, rows))
    said = [f"{time:.9f}" for time in times]
    if unit == "ns":
        said = [str(SINCE_1970 + round(1e9 * time)) for time in times]
    lines = [f"time_{unit},vx,vy,omega"]
    for k, time in enumerate(said):
        vx, omega = (0.7, 0.6 * np.sin(k / 15)) if k < 150 else (0.0, 0.8 if k < 180 else 0.0)
        lines.append(f"{time},{vx!r},0,{float(omega)!r}")
    path.write_text("\n".join(lines) + "\n")
    return path


WAYS = {
    "controller": DriveLoop(LIMITS),
    "another rate": DriveLoop(LIMITS, rate=37.0, control={"timeout": 0.3}),
    "directly": None,
}


@pytest.mark.parametrize("unit", ["s", "ns"])
@pytest.mark.parametrize("way", WAYS)
def test_a_drive_done_again_is_the_same_to_the_bit(tmp_path: Path, way: str, unit: str) -> None:
    path, again = tmp_path / "run.mcap", tmp_path / "again.mcap"
    drive(ROVER, table(tmp_path / "commands.csv", unit), path, loop=WAYS[way], keep="curvature")
    replayed = replay(path, output=again)
    assert len(replayed.recorded.times) > 150
    assert len(replayed.wanted) == 200
    assert replayed.same_bits
    assert compare(replayed).first is None
    assert replay(again).same_bits
    first, second = ([each.data for each in Record(p).messages(["/joint_commands"])] for p in (path, again))
    assert first == second


@pytest.mark.parametrize("way", WAYS)
def test_chunks_of_the_table_are_those_of_the_first_time(tmp_path: Path, way: str) -> None:
    commands = table(tmp_path / "commands.csv")
    drive(ROVER, commands, tmp_path / "run.mcap", loop=WAYS[way], keep="curvature", chunk_rows=7)
    assert replay(tmp_path / "run.mcap").same_bits


def test_other_parameters_are_those_of_the_new_drive(tmp_path: Path) -> None:
    path, slow = tmp_path / "run.mcap", tmp_path / "slow.mcap"
    drive(ROVER, table(tmp_path / "commands.csv"), path, loop=WAYS["controller"])
    replayed = replay(path, {"limits.speed": 0.3})
    assert replayed.again.twists[:, 0].max() == pytest.approx(0.3, rel=1e-12)
    assert not replayed.same_bits
    # As if it had been driven so: not by the replay's own code.
    limits = only(speed=0.3, **GIVEN)
    drive(ROVER, tmp_path / "commands.csv", slow, loop=DriveLoop(limits))
    driven = replay(slow).recorded
    np.testing.assert_array_equal(replayed.again.wheel_speeds, driven.wheel_speeds)
    np.testing.assert_array_equal(replayed.again.steering, driven.steering)
    np.testing.assert_array_equal(replayed.again.poses, driven.poses)


def test_what_was_cut_off_is_replayed_up_to_there(tmp_path: Path) -> None:
    path, cut = tmp_path / "run.mcap", tmp_path / "cut.mcap"
    drive(ROVER, table(tmp_path / "commands.csv", rows=1200), path, loop=WAYS["controller"])
    whole = path.read_bytes()
    cut.write_bytes(whole[: int(0.7 * len(whole))])
    replayed = replay(cut)
    assert 100 < len(replayed.recorded.times) < len(replay(path).recorded.times)
    assert replayed.same_bits
    assert "cut off" in replayed.warnings[0]


def test_what_cannot_be_done_again_leaves_nothing_behind(tmp_path: Path, run, refused) -> None:
    path = Path("run.mcap")
    commands = table(tmp_path / "commands.csv")
    drive(ROVER, commands, path)
    line = refused("replay", "run.mcap", "--change", "steering_limit=0.1", "-o", "again.mcap")
    assert line.startswith("run.mcap: command ")
    assert not Path("again.mcap").exists()
    code, out, err = run("replay", "run.mcap", "--change", "wheel_radius=0.2", "--plot", "a.png")
    assert (code, err) == (0, "")
    assert "differ in" in out
    # Other records have readings, and no commands.
    rover = Path("rover.yaml")
    rover.write_text("d1: 0.4\nd2: 0.5\nd3: 0.5\nd4: 0.45\nwheel_radius: 0.15\n")
    assert run("simulate", str(rover), str(commands), "-o", "sim.mcap")[0] == 0
    assert run("odometry", str(rover), "sim.mcap", "-o", "odometry.mcap")[0] == 0
    for name in ("sim.mcap", "odometry.mcap"):
        assert f"six-wheel odometry ROVER {name} reckons it again" in refused("replay", name)


def test_a_drive_of_before_its_table_was_kept(tmp_path: Path) -> None:
    from six_wheel.logs.mcap import RecordWriter

    rover = "d1: 0.4\nd2: 0.5\nd3: 0.5\nd4: 0.45\nwheel_radius: 0.15\n"
    for told in ({}, {"drive": '{"unit": "s", "rate": null, "keep": null}'}):
        with RecordWriter(tmp_path / "run.mcap", {"made_by": "drive"} | told, {"rover.yaml": rover}):
            pass
        with pytest.raises(RecordError, match="the record must hold the table of commands, got none"):
            replay(tmp_path / "run.mcap")
