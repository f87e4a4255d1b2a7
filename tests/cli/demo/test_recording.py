import io
import math
import sys
from importlib import resources

import numpy as np
import pytest

from six_wheel import Rover, Wheel, integrate
from six_wheel.cli.demo import running as demo

TIMES, POSES = demo.load_path()
STEP = 0.05  # [s]


def recording(twists, yaw=0.0, ahead=0.0):
    """Times and poses of a frame so much turned and so far ahead of an axle that has these twists."""
    axle = integrate(twists, STEP, (0.3, -0.2, 2.0))
    heading = axle[:, 2]
    x, y = axle[:, 0] + ahead * np.cos(heading), axle[:, 1] + ahead * np.sin(heading)
    return STEP * np.arange(len(axle)), np.stack((x, y, heading + yaw), axis=1)


def trip():
    """Arcs and a turn on the spot, with pauses: each 3 s at full speed, ramps of 2 s and rests of 3 s."""
    ramp = np.linspace(0.0, 1.0, 40)
    shape = np.concatenate((np.zeros(60), ramp, np.ones(60), ramp[::-1]))
    legs = [(0.2, 0.0, 0.0), (0.2, 0.0, 0.4), (0.0, 0.0, 0.4), (0.15, 0.0, -0.5)]
    return np.concatenate([shape[:, None] * leg for leg in legs] + [np.zeros((60, 3))])


@pytest.fixture(scope="module", params=["perseverance", "open_source_rover"])
def result(request):
    return demo.drive_path(Rover.preset(request.param), request.param, TIMES, POSES)


def test_recording_is_what_its_readme_says():
    assert POSES.shape == (len(TIMES), 3) == (3671, 3)
    np.testing.assert_allclose(np.diff(TIMES), STEP, rtol=1e-9)
    assert (TIMES[0], TIMES[-1]) == (0.0, 183.5)
    words = (resources.files("six_wheel.cli.demo") / "data" / "README.md").read_text(encoding="utf-8")
    for expected in (
        "MIT License",
        "Copyright (c) 2021 Ricardo Sousa",
        "10.1007/s10846-022-01630-3",
        "8e025fd",
    ):
        assert expected in words


def test_frame_of_the_recording_is_found():
    motion = demo.recorded_motion(*recording(trip(), yaw=0.02, ahead=-0.05))
    # The rest comes from smoothing of the corners of the ramps.
    np.testing.assert_allclose(motion.frame, (0.02, -0.05), atol=1e-3)
    np.testing.assert_allclose(motion.poses, recording(trip())[1], atol=1e-3)


def test_steady_motion_is_recovered():
    twists = trip()
    motion = demo.recorded_motion(*recording(twists))
    # Away from every corner a local quadratic is an arc, up to the fourth power of the turn in half a width.
    steady = np.flatnonzero(np.all(np.abs(twists - np.roll(twists, 1, axis=0)) == 0.0, axis=1))
    steady = [row for row in steady if np.ptp(twists[max(0, row - 25) : row + 25], axis=0).max() == 0.0]
    assert len(steady) > 40
    np.testing.assert_allclose(motion.twists[steady], twists[steady], atol=1e-3)


def test_noise_at_rest_is_rest():
    random = np.random.default_rng(1)
    times, poses = recording(trip())
    motion = demo.recorded_motion(times, poses + random.normal(scale=(2e-4, 2e-4, 5e-4), size=poses.shape))
    assert np.all(motion.twists[:20] == 0.0)
    assert np.all(motion.twists[-20:] == 0.0)


def test_yaw_may_wrap():
    times, poses = recording(trip())
    wrapped = poses.copy()
    wrapped[:, 2] = (wrapped[:, 2] + math.pi) % (2 * math.pi) - math.pi
    assert np.ptp(np.diff(wrapped[:, 2])) > 6.0
    np.testing.assert_allclose(
        demo.recorded_motion(times, wrapped).twists, demo.recorded_motion(times, poses).twists, atol=1e-9
    )


def test_rover_is_given_only_what_it_can_do(result):
    assert np.all(result.rover.admissible(result.twists))
    assert not np.all(result.rover.admissible(result.asked))  # or the recording would be no test of `project`


def test_odometry_leads_back_along_the_drive(result):
    # Rounding, accumulated over the steps of a path of this length.
    distance, turn = result.closing_error
    assert distance < 1e-15 * len(TIMES) * result.length
    assert turn < 1e-15 * len(TIMES)


def test_drive_stays_on_the_recording(result):
    assert result.deviation.max() < 0.01 * result.length
    assert math.sqrt(np.mean(result.deviation**2)) < 0.003 * result.length


def test_path_is_scaled_just_enough(result):
    half_width = max(abs(wheel.y) for wheel in result.rover.wheels)
    assert result.needed_radius == max(half_width, result.rover.min_radius)
    assert result.scale * result.tightest_radius >= result.needed_radius
    assert (result.scale - 0.01) * result.tightest_radius < result.needed_radius  # two digits are kept


def test_path_that_is_wide_enough_keeps_its_size():
    small = Rover.six_wheel(
        front_to_middle=0.03,
        middle_to_rear=0.03,
        track_width=0.04,
        middle_track_width=0.05,
        wheel_radius=0.01,
    )
    result = demo.drive_path(small, "small", TIMES, POSES)
    assert result.scale == 1.0


def test_steering_limit_enlarges_the_path():
    free = Rover.preset("open_source_rover")
    limited = Rover.preset("open_source_rover", steering_limit=math.radians(60))
    results = [demo.drive_path(rover, "rover", TIMES, POSES) for rover in (free, limited)]
    assert results[1].needed_radius == limited.min_radius
    assert results[1].scale > results[0].scale
    assert np.all(np.abs(results[1].steering) <= math.radians(60))


def test_wheels_turn_steadily_while_the_rover_stands(result):
    resting = np.flatnonzero(~np.any(result.twists != 0.0, axis=1))
    inside = [row for row in resting if row - 1 in resting and row + 1 in resting]
    bends = (
        result.steering[np.add(inside, 1)] - 2 * result.steering[inside] + result.steering[np.add(inside, -1)]
    )
    assert np.abs(bends).max() < 1e-12
    assert np.all(result.wheel_speeds[resting] == 0.0)


@pytest.mark.parametrize(
    ("times", "poses", "message"),
    [
        (TIMES[:-1], POSES, r"poses must have shape \(n, 3\) with n times"),
        (TIMES[:2], POSES[:2], "n >= 3"),
        (TIMES[::-1], POSES, "times must be evenly spaced"),
        (TIMES**2, POSES, "times must be evenly spaced"),
        (TIMES, np.zeros_like(POSES), "the path must move"),
    ],
)
def test_bad_recording_is_an_error(times, poses, message):
    with pytest.raises(ValueError, match=message):
        demo.drive_path(Rover.preset("perseverance"), "rover", times, poses)


def test_rover_that_cannot_turn_is_an_error():
    corners = [(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25), (-0.3, -0.25)]
    wheels = [Wheel(f"w{i}", x, y, radius=0.1, heading=0.2 * i) for i, (x, y) in enumerate(corners)]
    with pytest.raises(ValueError, match="stuck"):
        demo.drive_path(Rover(wheels), "stuck", TIMES, POSES)


class Paper:
    """The plainest console there is."""

    def __init__(self):
        self.words = ""

    def print(self, *objects):
        self.words += " ".join(map(str, objects)) + "\n"


def test_run_reports_and_writes(tmp_path):
    pytest.importorskip("matplotlib")
    console = pytest.importorskip("rich.console").Console(record=True, width=120, file=io.StringIO())
    target = tmp_path / "new" / "folder"
    demo.run(target, console=console)
    words = console.export_text()
    for expected in (
        "Perseverance",
        "Open Source Rover",
        "path is scaled by",
        "demo.png",
        "reference",
        "RMS",
        "over a yard of rocks",
        "off those on level ground",
    ):
        assert expected in words
    for picture in ("demo.png", "demo_ground.png", "demo_ground_speeds.png"):
        assert (target / picture).read_bytes().startswith(b"\x89PNG")

    rover = Rover.preset("perseverance")
    table = np.genfromtxt(target / "demo_perseverance.csv", delimiter=",", names=True)
    assert table.dtype.names is not None
    assert set(rover.steering_joints) | set(rover.traction_joints) <= set(table.dtype.names)
    row = np.argmax(np.abs(table["omega"]))
    twist = np.array([table[name][row] for name in ("vx", "vy", "omega")])
    for joint, value in rover.commands(twist).items():
        assert table[joint][row] == pytest.approx(value, rel=1e-6, abs=1e-8)
    assert all(table[joint][-1] == 0.0 for joint in rover.traction_joints)


def test_report_needs_no_rich(monkeypatch):
    pytest.importorskip("matplotlib")
    from six_wheel.cli.demo import figures

    monkeypatch.setitem(sys.modules, "rich", None)
    words = figures.table("Time", ["", "one"], [["inverse", "35 ns"]])
    assert words == "Time\n  one\ninverse  35 ns"
