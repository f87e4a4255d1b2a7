"""A record run again: the same bits, or what other parameters make of it."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mcap", reason='needs pip install "six-wheel[bags]"')
pytest.importorskip("pydantic", reason='needs pip install "six-wheel[cli]"')

from six_wheel.control_loop import Loop, Options, Settings
from six_wheel.control_loop.diagnostics import statuses
from six_wheel.control_loop.recorder import Recorder
from six_wheel.control_loop.replay import compare, replay
from six_wheel.logs.mcap import Record, RecordError, RecordWriter, layouts
from six_wheel.logs.mcap.frames import joint_state
from tests.limits import SMOOTH as LIMITS
from tests.rovers import SIX_WHEELS as ROVER

NAMES = [*ROVER.steering_joints, *ROVER.traction_joints]
START = 1_700_000_000_000_000_000
PERIOD = 5_000_000


def record(path: Path, periods: int = 800, options: Options | None = None) -> None:
    """A drive in which everything happens: changes, poses, gaps, wrong messages, time that jumps."""
    settings = Settings.of_rover(ROVER, options, limits=LIMITS)
    loop, recorder = Loop(settings), Recorder(path, settings)
    random = np.random.default_rng(1)
    now, steering, angles, speeds = START, [0.0] * 4, np.zeros(6), np.zeros(6)
    for k in range(periods):
        now += PERIOD + int(random.integers(-400_000, 400_000)) - (70_000_000_000 if k == 500 else 0)
        angles = angles + PERIOD * 1e-9 * speeds
        steps = []
        if k % 9 == 0:
            wanted = (0.6, 0.0, 0.5 * math.sin(k / 70)) if k % 90 else (math.nan, 0.0, 0.0)
            loop.command(wanted, now - 1_000_000, now)
            recorder.wanted(now, now - 1_000_000, wanted)
        if k % 4 == 0:
            steps.append(loop.tick(now))
            recorder.tick(now)
        if k in (200, 300):
            change = {"limits.speed": 0.3 if k == 200 else 0.8}
            loop.change(loop.settings.changed(change), now)
            recorder.change(now, {"set": change})
        if k == 400:
            loop.set_pose([1.0, 2.0, 0.5], None, now)
            recorder.change(now, {"pose": [1.0, 2.0, 0.5], "covariance": None})
        if k == 450:
            loop.reset(now)
            recorder.change(now, {"reset": [0.0, 0.0, 0.0]})
        if k in (520, 745):
            loop.halt(now)
            recorder.change(now, {"halt": True})
        if k in (525, 580, 790):  # in motion, at rest, at the end
            loop.release(now)
            recorder.change(now, {"release": True})
        if not 600 <= k < 720:
            values = [*steering, *angles.tolist()]
            values[9] = math.nan if k == 350 else values[9]
            message = joint_state(NAMES, len(NAMES), 0).pack(now, values)
            steps.append(loop.joints(NAMES, values, (), now, now))
            recorder.joint_message(now, now, message)
        for step in filter(None, steps):
            recorder.step(step)
            if step.steering is not None:
                steering, speeds = step.steering, np.array(step.wheel_speeds)
        if k % 200 == 0:
            recorder.diagnostics(now, statuses(loop, "rover"))
    recorder.change(now, {"end": True})
    if (step := loop.end(now)) is not None:
        recorder.step(step)
    recorder.close()


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("record") / "run.mcap"
    record(path)
    return path


def test_without_a_change_it_is_the_same_to_the_bit(path, tmp_path):
    replayed = replay(path, output=tmp_path / "again.mcap")
    assert len(replayed.recorded.times) > 600
    assert replayed.same_bits
    assert compare(replayed).first is None
    # And so is a record of the replay.
    assert replay(tmp_path / "again.mcap").same_bits
    first, second = (
        list(Record(each).messages(["/joint_commands", "/odom"])) for each in (path, tmp_path / "again.mcap")
    )
    assert [each.data for each in first] == [each.data for each in second]


def test_other_parameters_make_a_difference_and_no_other(path):
    plain = compare(replay(path))
    replayed = replay(path, {"limits.speed": 0.2})
    slower = compare(replayed)
    assert not slower.same_bits
    before = replayed.again.times >= START  # the jump of time, where it begins with what was measured
    assert replayed.again.twists[before, 0].max() == pytest.approx(0.2)
    assert slower.first > 0.0
    assert slower.twist > 0.3
    assert 0 < slower.differing < slower.common
    assert slower.again.path_length < plain.recorded.path_length
    np.testing.assert_array_equal(slower.again.odometry_end, plain.recorded.odometry_end)
    noisy = replay(path, {"noise.speed": 0.5})
    np.testing.assert_array_equal(noisy.again.wheel_speeds, noisy.recorded.wheel_speeds)
    assert not noisy.same_bits  # the covariances
    other = replay(path, {"wheel_radius": 0.2, "joint_state_timeout": 1.0})
    assert other.after.rover.wheels[0].radius == 0.2


def test_a_record_that_was_cut_off_is_replayed_up_to_there(path, tmp_path):
    whole = path.read_bytes()
    for part in (0.4, 0.7, 0.95):
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(whole[: int(part * len(whole))])
        replayed = replay(cut)
        assert replayed.same_bits
        assert "cut off" in replayed.warnings[0] or not len(replayed.recorded.times)


def test_what_cannot_be_replayed_is_said(path, tmp_path):
    for name, content, message in (
        ("no.mcap", b"time,vx\n", "the record must be an MCAP file"),
        ("empty.mcap", b"", "the record must be an MCAP file"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(RecordError, match=message):
            replay(tmp_path / name)
    with RecordWriter(tmp_path / "other.mcap", {"made_by": "other"}):
        pass
    with pytest.raises(RecordError, match="only a record of node or drive has commands to run again"):
        replay(tmp_path / "other.mcap")
    with RecordWriter(tmp_path / "bare.mcap", {"made_by": "node"}):
        pass
    with pytest.raises(RecordError, match="the record must hold the parameter file"):
        replay(tmp_path / "bare.mcap")
    for changes, message in (
        ({"limits.speed": -1.0}, "limits.speed must be finite and positive"),
        ({"traction_joints": ["a"] * 6}, "traction_joints"),
    ):
        with pytest.raises(ValueError, match=message):
            replay(path, changes)


def test_other_readers_know_it(path):
    rosbags = pytest.importorskip("rosbags.highlevel")
    from rosbags.typesys import Stores, get_typestore

    with rosbags.AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:
        topics = {each.topic: each.msgtype for each in reader.connections}
        assert topics["/odom"] == "nav_msgs/msg/Odometry"
        assert {
            "/cmd_vel",
            "/joint_states",
            "/joint_commands",
            "/cmd_vel_out",
            "/tf",
            "/diagnostics",
        } <= topics.keys()
        for connection, _, data in reader.messages():
            reader.deserialize(data, connection.msgtype)


def test_commands(path, run, refused):
    code, out, err = run("replay", str(path))
    assert (code, err) == (0, "")
    assert "the same bits in all" in out
    code, out, err = run(
        "replay", str(path), "--change", "limits.speed=0.2", "--plot", "a.png", "-o", "b.mcap"
    )
    assert (code, err) == (0, "")
    assert "differ in" in out
    assert Path("a.png").stat().st_size > 10_000
    assert run("replay", "b.mcap")[0] == 0
    assert "no such file" in refused("replay", "nothing.mcap")
    assert "change must be KEY=VALUE" in refused("replay", str(path), "--change", "speed")
    assert "limits.speed must be a number" in refused("replay", str(path), "--change", "limits.speed=fast")
    assert "must be .mcap" in refused("replay", str(path), "-o", "b.csv")


def test_layouts(path, run, refused):
    code, out, _ = run("convert", str(path), "layout.json")
    assert (code, Path(out.strip()).name) == (0, "layout.json")
    layout = json.loads(Path("layout.json").read_text())
    assert layout == layouts.foxglove(ROVER)
    shown = json.dumps(layout)
    for topic in (
        "/cmd_vel",
        "/cmd_vel_out",
        "/joint_commands",
        "/reasons",
        "/odom",
        "/diagnostics",
        "/wheel_slip",
    ):
        assert topic in shown
    panels = set(layout["configById"])

    def used(part):
        return {part} if isinstance(part, str) else used(part["first"]) | used(part["second"])

    assert used(layout["layout"]) == panels
    assert "the ending of a layout must be one of .json" in refused("convert", "husky", "a.txt")
    assert "a rover without its record" in refused("convert", "husky", "a.rrd")
