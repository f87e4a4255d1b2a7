"""Records of every kind become the rows they hold; thinned columns lose no peak; time moves the rover."""

import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import six_wheel as sw
from six_wheel.view.records.plots import thin_columns
from six_wheel.view.records.record import PATH_POINTS, thin_path
from six_wheel.view.scene.meshes import robot_meshes
from six_wheel.view.subject import find_subject
from tests.cli_runs import Run

Open = Callable[..., Any]
DATA = Path(__file__).parents[3] / "shared" / "data" / "urdf"


def commands(path: str) -> NDArray[np.float64]:
    stamps = np.arange(0.0, 20.0, 0.1)
    rows = np.stack([stamps, np.full(200, 0.1), np.zeros(200), 0.05 * np.sin(stamps / 4.0)], axis=1)
    lines = ["time,vx,vy,omega", *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    Path(path).write_text("\n".join(lines) + "\n")
    return rows


@pytest.mark.parametrize("ending", ["mcap", "csv", "parquet"])
def test_a_drive_on_disk_is_its_rows(run: Run, ending: str) -> None:
    commands("table.csv")
    for target in (f"run.{ending}", "reference.csv"):
        assert run("drive", "perseverance", "table.csv", "-o", target, "--rate", "20")[0] == 0
    known = np.genfromtxt("reference.csv", delimiter=",", names=True, dtype=None, encoding=None)
    record = find_subject(f"run.{ending}", rover=None if ending == "mcap" else "perseverance").record
    assert record is not None
    np.testing.assert_allclose(record.times, known["time"], atol=1e-9)
    for name, column in zip(("x", "y", "yaw"), record.poses.T, strict=True):
        np.testing.assert_allclose(column, known[name], atol=1e-9)
    rover = record.rover
    assert record.steering is not None
    assert record.wheel_speeds is not None
    for joint, wheel in rover.steering_joints.items():
        column = record.steering[:, rover.steered_wheel_names.index(wheel)]
        np.testing.assert_allclose(column, known[joint], atol=1e-9)
    for joint, wheel in rover.traction_joints.items():
        np.testing.assert_allclose(
            record.wheel_speeds[:, rover.wheel_names.index(wheel)], known[joint], atol=1e-9
        )
    assert record.reasons is not None
    np.testing.assert_array_equal(record.reasons > 0, known["reasons"] > 0)


@pytest.mark.parametrize("ending", ["mcap", "csv"])
def test_a_log_is_reckoned_and_has_its_truth(run: Run, ending: str) -> None:
    commands("table.csv")
    assert run("simulate", "husky", "table.csv", "-o", f"log.{ending}")[0] == 0
    record = find_subject(f"log.{ending}", rover=None if ending == "mcap" else "husky").record
    assert record is not None
    assert record.truth is not None
    np.testing.assert_allclose(record.poses[-1, :2], record.truth.poses[-1, :2], atol=1e-3)
    assert run("odometry", "husky", f"log.{ending}", "-o", "track.csv")[0] == 0
    track = find_subject("track.csv", rover="husky").record
    assert track is not None
    assert track.covariances is not None
    np.testing.assert_allclose(track.poses, record.poses, atol=1e-9)


def test_objects_are_the_same_records(opened: Open) -> None:
    rover, stamps = sw.Rover.preset("husky"), np.linspace(0.0, 10.0, 101)
    log = sw.simulate(rover, (stamps, np.tile([0.2, 0.0, 0.1], (101, 1))))
    track = sw.dead_reckon(rover, log)
    one, two = find_subject(track).record, find_subject(log, rover=rover).record
    assert one is not None
    assert two is not None
    np.testing.assert_allclose(one.poses, track.poses)
    np.testing.assert_allclose(two.poses, track.poses, atol=1e-6)
    with pytest.raises(ValueError, match="rover must say whose record it is"):
        find_subject(log)
    view = opened(track)
    for time in (0.0, 4.2, 99.0):
        view.time = time
        row = one.row(time)
        assert view.time == min(time, view.duration)
        np.testing.assert_allclose(view.pose, track.poses[row], atol=1e-12)
    with pytest.raises(ValueError, match="twist must be left alone"):
        view.twist = (0.1, 0.0, 0.0)
    with pytest.raises(ValueError, match="time must be finite"):
        view.time = np.nan
    for time in (None, "3", [1.0]):
        with pytest.raises(TypeError, match="^time must be a number, got "):
            view.time = time


def test_two_records_are_shown_beside_each_other(run: Run, opened: Open) -> None:
    slower = commands("run.csv") * [1.0, 0.5, 1.0, 1.0]
    np.savetxt("other.csv", slower, delimiter=",", header="time,vx,vy,omega", comments="")
    for name in ("run", "other"):
        assert run("drive", "perseverance", f"{name}.csv", "-o", f"{name}.mcap")[0] == 0
    assert run("view", "run.mcap", "--with", "other.mcap", "--export", "page.html")[0] == 0
    slow = find_subject("other.mcap").record
    assert slow is not None
    view = opened("run.mcap", other="other.mcap")
    scene = view._server.scene
    for time in (0.0, 8.0, 15.0):
        view.time = time
        there = scene.get_handle_by_name("/world/other").position + view._subject.origin
        np.testing.assert_allclose(there[:2], slow.poses[slow.row(time), :2], atol=1e-9)
    here = scene.get_handle_by_name("/world/rover").position
    assert np.hypot(*(here - scene.get_handle_by_name("/world/other").position)[:2]) > 0.3
    assert scene.get_handle_by_name("/world/record/other").visible
    assert "six-wheel view run.mcap --with other.mcap --time 15" in view._panels._say.content
    with pytest.raises(ValueError, match=r"^other \(--with\) must be left out unless a record is shown, got"):
        find_subject("husky", other="other.mcap")
    with pytest.raises(TypeError, match=r"^other \(--with\) must be a record, got 'husky'"):
        find_subject("run.mcap", other="husky")


def test_a_simulation_on_ground_stands_as_it_stood(opened: Open) -> None:
    suspension = sw.RockerBogie.preset("curiosity")
    ground = sw.Terrain.yard(20.0, 0.1, 0.08, 2)
    stamps = np.arange(0.0, 12.0, 1.0)
    run = sw.simulate(
        suspension, (stamps, np.tile([0.2, 0.0, 0.03], (12, 1))), ground=ground, start=(7, 10, 0), rate=5
    )
    view = opened(run)
    for row in (0, 17, 40):
        view.time = run.stamps[row] - run.stamps[0]
        stand = run.stand
        assert stand is not None
        motion = view.motion
        np.testing.assert_allclose(motion.transform, stand.transform[row], atol=1e-9)
        np.testing.assert_allclose(motion.joints, stand.joints[row], atol=1e-9)
        np.testing.assert_allclose(motion.wheel_speeds, run.wheel_speeds[row], atol=1e-12)


def test_a_settled_pose_stands_as_it_settled(opened: Open) -> None:
    """It was refused as nothing to see."""
    suspension = sw.RockerBogie.preset("curiosity")
    ground = sw.Terrain.yard(20.0, 0.1, 0.08, 2)
    rover, pose = suspension.planar(), (9.0, 11.0, 0.4)
    steering, _ = rover.inverse((0.1, 0.0, 0.05))
    for angles in (None, steering):
        stand = suspension.settle(ground, pose, angles)
        view = opened(stand)
        np.testing.assert_allclose(view.motion.transform, stand.transform, atol=1e-9)
        np.testing.assert_allclose(view.motion.joints, stand.joints, atol=1e-9)
        np.testing.assert_allclose(view.motion.steering, stand.steering, atol=1e-9)
    assert opened(stand, at=(12.0, 8.0, 0.0)).pose == (12.0, 8.0, 0.0)
    with pytest.raises(TypeError, match="^x must be one settled pose, got SettledPose"):
        find_subject(suspension.settle(ground, [pose, pose]))
    with pytest.raises(ValueError, match="^ground must be left out for a settled pose, got yard$"):
        find_subject(stand, "yard")


def test_thin_columns_lose_no_peak() -> None:
    random = np.random.default_rng(3)
    times, columns = np.arange(300_000) / 50.0, random.normal(size=(300_000, 2))
    columns[123_456, 1] = 40.0
    reasons = np.zeros(300_000, np.uint32)
    reasons[200_000] = 8
    stamps, thin, begins, found = thin_columns(times, columns, reasons)
    assert len(stamps) == len(thin) <= 8_000
    np.testing.assert_array_equal(thin.min(axis=0), columns.min(axis=0))
    np.testing.assert_array_equal(thin.max(axis=0), columns.max(axis=0))
    assert found[np.searchsorted(begins, times[200_000], side="right") - 1] == 8


def test_a_thin_path_keeps_its_corners() -> None:
    straight = np.stack([np.linspace(0.0, 1000.0, 50_000), np.zeros(50_000)], axis=1)
    corner = np.stack([np.full(50_000, 1000.0), np.linspace(0.0, 1000.0, 50_000)], axis=1)
    thin = thin_path(np.concatenate([straight, corner]))
    assert len(thin) <= PATH_POINTS
    assert np.hypot(*(thin - [1000.0, 0.0]).T).min() < 1.0
    np.testing.assert_allclose(thin[[0, -1]], [[0.0, 0.0], [1000.0, 1000.0]], atol=0.5)


@pytest.mark.slow
def test_a_million_rows_take_the_memory_of_their_columns(opened: Open) -> None:
    rover, n = sw.Rover.preset("husky"), 1_000_000
    times = np.arange(n) / 100.0
    twists = np.stack([np.full(n, 0.3), np.zeros(n), 0.1 * np.sin(times / 40.0)], axis=1)
    poses = sw.integrate(twists[:-1], 0.01)
    speeds = rover.inverse(twists)[1]
    track = sw.Track(rover, times, poses, twists, None, speeds, None, np.zeros(n, np.uint32))
    tracemalloc.start()
    view = opened(track)
    view.time = 5000.0
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 3 * sum(column.nbytes for column in (times, poses, twists, speeds))
    np.testing.assert_allclose(view.pose, poses[500_000], atol=1e-9)


@pytest.mark.parametrize("name", ["osr", "curio", "banksia"])
def test_a_description_with_missing_meshes_is_drawn_all_the_same(opened: Open, name: str) -> None:
    path = DATA / f"{name}.urdf"
    if not path.exists():
        pytest.skip("needs ../shared/data")
    view = opened(path)
    assert "is missing" in view._panels.status.content
    drawn, remarks = robot_meshes(view._subject, view.motion)
    assert len(remarks) == 1
    assert isinstance(drawn, dict)
    for number in range(len(view._subject.rover.wheels)):
        assert view._server.scene.get_handle_by_name(f"/world/rover/wheel_{number}") is not None


def test_shapes_of_a_description_are_where_its_joints_are(opened: Open, tmp_path: Path) -> None:
    rover = sw.Rover.preset("husky")
    path = tmp_path / "husky.urdf"
    path.write_text(rover.urdf())
    subject = opened(path)._subject
    view = opened(path)
    drawn, remarks = robot_meshes(subject, view.motion)
    assert remarks == []
    for number, wheel in enumerate(subject.rover.wheels):
        vertices = np.concatenate([mesh.vertices for mesh, _ in drawn[f"wheel_{number}"]])
        np.testing.assert_allclose(vertices.mean(axis=0), 0.0, atol=1e-6)
        assert np.hypot(vertices[:, 0], vertices[:, 2]).max() == pytest.approx(wheel.radius, rel=1e-6)
