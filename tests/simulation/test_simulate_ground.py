"""Drives over ground: what they are on level ground, on slopes, and in files."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.simulation import Slip, simulate, write_ground

ARM = sw.RockerBogie.preset("perseverance")
COMMANDS = np.array([[0, 0.2, 0, 0.0], [10, 0.2, 0, 0.08], [20, 0.2, 0, -0.08]])
LEVEL = sw.Terrain(np.zeros((40, 40)), 1.0)


def rocks() -> sw.Terrain:
    return sw.Terrain.yard((30, 30), 0.1, cover=0.1, seed=3)


def test_level_ground_is_the_planar_simulation():
    """The rover stands level: readings, poses and steering are those of the rover seen from above."""
    planar = simulate(ARM.planar(), COMMANDS, rate=5, start=(10, 15, 0.3))
    run = simulate(ARM, COMMANDS, ground=LEVEL, rate=5, start=(10, 15, 0.3))
    np.testing.assert_allclose(run.truth.poses, planar.truth.poses, atol=1e-12)
    np.testing.assert_allclose(run.steering, planar.steering, atol=1e-12)
    # One sums what is in the middle of a step, the other the mean of its ends: an eighth of the second
    # difference, 2e-6 rad a step here, over 800 steps.
    np.testing.assert_allclose(run.wheel_angles, planar.wheel_angles, atol=1e-5)
    np.testing.assert_allclose(run.wheel_speeds, run.flat_wheel_speeds, atol=1e-12)
    # A step of 25 ms, speeds that change by 0.05 rad/s in a second, and less than a quarter of that twice.
    np.testing.assert_allclose(run.slip.ratio, 0, atol=4e-3)


def test_a_ramp_is_driven_at_its_own_speed():
    """25 degrees up, 0.2 m/s seen from above: wheels turn faster by 1 / cos."""
    slope = math.tan(math.radians(25))
    ramp = sw.Terrain(np.broadcast_to(slope * np.arange(40.0), (40, 40)), 1.0)
    run = simulate(ARM, np.array([[0, 0.2, 0, 0], [10, 0.2, 0, 0.0]]), ground=ramp, rate=5, start=(10, 15, 0))
    expected = 0.2 / math.cos(math.radians(25)) / 0.26288
    np.testing.assert_allclose(run.wheel_speeds, expected, atol=1e-10)
    np.testing.assert_allclose(np.diff(run.stand.z), 0.2 / 5 * slope, atol=1e-10)
    np.testing.assert_allclose(run.stand.pitch, -math.radians(25), atol=1e-10)
    half = -math.radians(25) / 2
    np.testing.assert_allclose(run.orientations, [[0, math.sin(half), 0, math.cos(half)]] * 51, atol=1e-10)


def test_truth_is_differentiable():
    """Among rocks: the body's velocity is that of its settled poses, wheels stay on the ground."""
    run = simulate(ARM, COMMANDS, ground=rocks(), rate=200, start=(10, 15, 0.3))
    places = run.stand.transform[:, :3, 3]
    velocity = np.gradient(places, run.stamps, axis=0)
    turned = np.einsum("nij,nj->ni", run.stand.transform[:, :3, :3], run.twists[:, :3])
    # Differences over 10 ms; where a wheel changes from one cell to the next rates jump.
    assert np.median(np.abs(velocity - turned)) < 1e-4
    assert np.nanmax(np.abs(run.stand.gap)) < 1e-9
    rates = np.gradient(run.stand.joints, run.stamps, axis=0)
    assert np.median(np.abs(rates - run.joint_rates)) < 1e-4


def test_the_seed_decides():
    """Twice the same; other numbers for another seed; slip shows in the wheels."""
    options = {"ground": rocks(), "rate": 5, "start": (10, 15, 0), "noise": sw.Noise(0.01, 0.01)}
    one, two = (simulate(ARM, COMMANDS, seed=1, **options) for _ in range(2))
    np.testing.assert_array_equal(one.wheel_angles, two.wheel_angles)
    other = simulate(ARM, COMMANDS, seed=2, **options)
    assert (one.wheel_angles[-1] != other.wheel_angles[-1]).all()
    slipping = simulate(ARM, COMMANDS, slip=Slip(5, 10, ["middle_left"], 0.5), **options)
    assert np.nanmedian(slipping.slip.ratio[30:45, 2]) == pytest.approx(0.5, abs=0.02)
    assert np.nanmedian(slipping.slip.ratio[60:, 2]) == pytest.approx(0, abs=0.02)


def test_tables_and_bags_hold_the_drive(tmp_path: Path):
    """The columns are those of the run; a bag has a transform of every wheel at every sample."""
    run = simulate(ARM, COMMANDS, ground=rocks(), rate=5, start=(10, 15, 0))
    for ending in (".csv", ".parquet", ".mcap"):
        write_ground(run, ARM, tmp_path / f"run{ending}")
    with (tmp_path / "run.csv").open() as file:
        rows = list(csv.DictReader(file))
    np.testing.assert_array_equal([float(row["z [m]"]) for row in rows], run.stand.z)
    np.testing.assert_array_equal([float(row["beta_2 [rad]"]) for row in rows], run.stand.joints[:, 2])
    assert {row["status"] for row in rows} == {"settled"}
    rosbags = pytest.importorskip("rosbags.highlevel")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.LATEST)
    with rosbags.AnyReader([tmp_path / "run.mcap"], default_typestore=store) as bag:
        of = [c for c in bag.connections if c.topic == "/tf"]
        messages = [bag.deserialize(raw, c.msgtype) for c, _, raw in bag.messages(of)]
    assert len(messages) == len(run.stamps)
    for number, message in ((0, messages[0]), (60, messages[60])):
        frames = {each.child_frame_id: each for each in message.transforms}
        assert set(frames) == {"base_link", *ARM.wheel_names}
        body = frames["base_link"].transform.translation
        np.testing.assert_allclose([body.x, body.y, body.z], run.stand.transform[number, :3, 3], atol=1e-12)
        wheel = frames["rear_left"].transform
        at = run.stand.transform[number] @ [
            wheel.translation.x,
            wheel.translation.y,
            wheel.translation.z,
            1.0,
        ]
        reach = np.linalg.norm(at[:3] - run.stand.contacts[number, 4])
        assert reach == pytest.approx(0.26288, abs=1e-9)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"ground": LEVEL, "start": (0, 0, 0)}, "path must stay on the map, got x 0, y 0 after 0 s"),
        ({}, "ground must be given for a suspension, got None; or simulate rover.planar(...)"),
        ({"ground": LEVEL, "rate": 0}, "rate must be finite and positive, got 0"),
        ({"ground": LEVEL, "jitter": 1}, "jitter, dropped, truth_noise and stick must be left out on ground"),
    ],
)
def test_bad_input_is_named(more: dict, message: str):
    with pytest.raises(ValueError, match="must") as caught:
        simulate(ARM, COMMANDS, **more)
    assert str(caught.value) == message


def test_unknown_ground_is_named():
    heights = np.zeros((300, 300))
    heights[:, 150] = math.nan
    with pytest.raises(ValueError, match=r"path must stay on known ground, got x .* after .* s"):
        simulate(ARM, COMMANDS, ground=sw.Terrain(heights, 0.1), start=(12, 15, 0))


def test_the_planar_rover_has_no_ground():
    with pytest.raises(ValueError, match="rover must be a RockerBogie to drive over ground, got a Rover"):
        simulate(ARM.planar(), COMMANDS, ground=LEVEL)


def test_counts_of_a_drive_over_ground_are_counts_in_a_bag(tmp_path: Path):
    """They were refused there; wheels turn in it by what they rolled, not by their counts."""
    pytest.importorskip("rosbags")
    from six_wheel.logs import LogOptions, read_log

    planar = ARM.planar()
    options = {"ground": LEVEL, "rate": 5, "start": (10, 15, 0)}
    run = simulate(ARM, COMMANDS, wheel_encoders=sw.Encoder(1 << 20), **options)
    write_ground(run, ARM, tmp_path / "run.mcap")
    again, _ = read_log(tmp_path / "run.mcap", planar, LogOptions(wheel_encoders={"ticks_per_turn": 1 << 20}))
    whole = simulate(ARM, COMMANDS, **options).wheel_angles
    np.testing.assert_allclose(again.wheel_angles - again.wheel_angles[0], whole - whole[0], atol=1e-5)
