"""A view shows the results of the package: every node that is sent, every colour of the map."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import six_wheel as sw
from six_wheel.view.commands import start_state
from six_wheel.view.motion import find_motion, path_ahead, words
from six_wheel.view.possible import FAST, FORBIDDEN, FREE, verdicts
from six_wheel.view.scene import shapes
from six_wheel.view.scene.ground import cut, triangles
from six_wheel.view.subject import find_subject

Open = Callable[..., Any]
SUSPENDED = ("perseverance", "curiosity", "rocky7", "open_source_rover")
GROUNDS = {
    "plane": sw.Terrain(np.zeros((80, 80)), 0.5, (-20.0, -20.0)),
    "slope": sw.Terrain(np.add.outer(np.zeros(80), 0.1 * np.arange(80)), 0.5, (-20.0, -20.0)),
    "yard": sw.Terrain.yard(40.0, 0.1, 0.08, 5).replace(origin=(-20.0, -20.0)),
}
PLACES = 1e-6  # [m], of single precision within some metres


def node(view: Any, name: str) -> Any:
    return view._server.scene.get_handle_by_name(name)


def pose_of(view: Any, *names: str) -> NDArray[np.float64]:
    from viser.transforms import SE3, SO3

    found = SE3.identity()
    for name in names:
        handle = node(view, name)
        found = found @ SE3.from_rotation_and_translation(
            SO3(np.array(handle.wxyz)), np.array(handle.position)
        )
    return np.asarray(found.as_matrix())


@pytest.mark.parametrize("preset", [name for name in sw.Rover.presets() if name not in SUSPENDED])
def test_wheels_of_a_rover_on_a_plane_are_where_inverse_says(opened: Open, preset: str) -> None:
    rover = sw.Rover.preset(preset)
    view = opened(preset, "flat", at=(1.0, -2.0, 0.7))
    view.twist = rover.project((0.03, 0.01, 0.02))
    steering, speeds = rover.inverse(view.motion.twist)
    np.testing.assert_allclose(view.motion.wheel_speeds, speeds, rtol=1e-9, atol=1e-12)
    turned = iter(steering)
    for number, wheel in enumerate(rover.wheels):
        placed = pose_of(view, "/world/rover", f"/world/rover/wheel_{number}")
        heading = 0.7 + wheel.heading + (next(turned) if wheel.steered else 0.0)
        along = np.array([np.cos(heading), np.sin(heading), 0.0])
        np.testing.assert_allclose(placed[:3, 0], along, atol=1e-6)
        assert placed[2, 3] == pytest.approx(wheel.radius, abs=PLACES)


@pytest.mark.parametrize("preset", SUSPENDED)
@pytest.mark.parametrize("ground", GROUNDS)
def test_links_and_wheels_on_ground_are_where_settle_and_frames_say(
    opened: Open, preset: str, ground: str
) -> None:
    suspension = sw.RockerBogie.preset(preset)
    view = opened(suspension, GROUNDS[ground], at=(0.0, 0.0, 0.3))
    twist = np.array([0.4, 0.0, 0.1]) * view._subject.radius
    for pose in ((0.4, 0.2, 0.3), (1.1, -0.7, -2.0)):
        view.pose = pose
        view.twist = twist
        motion = view.motion
        stand = suspension.settle(GROUNDS[ground], pose, motion.steering)
        assert stand.stands
        frames = suspension.frames(stand.joints, motion.steering)
        for number in range(6):
            world = stand.transform @ frames[f"A{number + 1}"]
            drawn = pose_of(view, "/world/rover", f"/world/rover/wheel_{number}")
            np.testing.assert_allclose(drawn[:3, 3] + view._subject.origin, world[:3, 3], atol=PLACES)
            np.testing.assert_allclose(drawn[:3, :3], world[:3, :3], atol=PLACES)
        for name in ("B1", "B2", "S1", "S6"):
            drawn = pose_of(view, "/world/rover", f"/world/rover/{name}")
            world = stand.transform @ frames[name]
            np.testing.assert_allclose(drawn[:3, 3] + view._subject.origin, world[:3, 3], atol=PLACES)
        told = suspension.inverse(stand, motion.twist[[0, 2]], view="plan", steering=motion.steering)
        np.testing.assert_allclose(motion.wheel_speeds, told.wheel_speeds, rtol=1e-12)


def test_axes_meet_in_the_centre_of_rotation(opened: Open) -> None:
    view = opened("perseverance", "flat")
    view.twist = (0.06, 0.0, 0.02)
    ends = np.asarray(node(view, "/world/motion/axes").points)[:, 1]
    wanted = [*view.motion.twist[:1] * 0.0, 3.0]
    np.testing.assert_allclose(ends[:, :2], np.broadcast_to(wanted, (6, 2)), atol=1e-5)
    assert node(view, "/world/motion/icr/label").text == "R 3.00 m"
    for number, wheel in enumerate(view._subject.rover.wheels):  # every axle points there
        placed = pose_of(view, "/world/rover", f"/world/rover/wheel_{number}")
        to = np.array(wanted) - placed[:2, 3]
        assert abs(to @ placed[:2, 0]) < 1e-5, wheel.name
    view.twist = (0.06, 0.0, 0.0)
    assert not node(view, "/world/motion/icr").visible


def test_the_path_ahead_is_that_of_integrate() -> None:
    subject = find_subject("curiosity", "flat")
    motion = find_motion(subject, start_state(subject, twist=(0.1, 0.0, 0.05)))
    poses, places = path_ahead(subject, motion, motion.twist)
    steps = len(poses) - 1
    radius = motion.twist[0] / motion.twist[2]
    np.testing.assert_allclose(np.hypot(poses[:, 0], poses[:, 1] - radius), radius, rtol=1e-9)
    wheel = subject.rover.wheels[0]
    np.testing.assert_allclose(places[0, 0, :2], (wheel.x, wheel.y), atol=1e-3)
    own = np.hypot(places[0, 0, 0], places[0, 0, 1] - radius)
    np.testing.assert_allclose(np.hypot(places[0, :, 0], places[0, :, 1] - radius), own, rtol=1e-9)
    assert steps == 40


def test_what_cannot_be_done_is_said_and_shown_in_red(opened: Open) -> None:
    view = opened("perseverance", "flat", twist=(0.06, 0.03, 0.02))
    assert not view.motion.possible
    assert "not without sliding" in view._panels.status.content
    assert node(view, "/world/motion/commanded").visible
    view.twist = (0.06, 0.0, 0.02)
    assert not node(view, "/world/motion/commanded").visible
    view.twist = (0.38, 0.0, 0.1)
    assert "slowed by the wheel speed of" in view._panels.status.content
    assert np.abs(view.motion.wheel_speeds).max() == pytest.approx(1.0, rel=1e-9)
    tight = opened("perseverance", "flat", twist=(0.02, 0.0, 0.1), steering_limit=0.5)
    assert "steering range" in words(tight._subject, tight.motion)
    assert np.abs(tight.motion.steering).max() <= 0.5 + 1e-9


@pytest.mark.parametrize("preset", sw.Rover.presets())
def test_the_map_is_that_of_admissible_and_inverse(preset: str) -> None:
    rover = sw.Rover.preset(preset)
    random = np.random.default_rng(7)
    twists = random.uniform(-1.0, 1.0, (300, 3)) * [0.5, 0.0, 0.5]
    limits = sw.Limits(wheel_speed=2.0, speed=0.4)
    found = verdicts(rover, limits, twists)
    for twist, verdict in zip(twists, found, strict=True):
        if not rover.admissible(twist):
            assert verdict == FORBIDDEN
            continue
        _, speeds = rover.inverse(twist)
        fast = np.abs(speeds).max() > 2.0 or np.hypot(*twist[:2]) > 0.4
        assert verdict == (FAST if fast else FREE)


@pytest.mark.parametrize("x", [sw.Rover.swerve([(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25)], 0.1), "curiosity"])
def test_scrub_is_that_of_the_rover(opened: Open, x: Any) -> None:
    rover = find_subject(x, "flat").rover
    name, wheel = rover.wheel_names[1], rover.wheels[1]
    view = opened(x, "flat", twist=(0.02, 0.0, 0.1), scrub={name: 0.05})
    steering, speeds = rover.replace(name, scrub=0.05).inverse(view.motion.twist)
    np.testing.assert_allclose(view.motion.steering, steering, atol=1e-12)
    np.testing.assert_allclose(view.motion.wheel_speeds, speeds, atol=1e-12)
    without = rover.inverse(view.motion.twist)[1]
    assert speeds[1] - without[1] == pytest.approx(-0.05 * view.motion.twist[2] / wheel.radius, rel=1e-9)
    hub = pose_of(view, "/world/rover", "/world/rover/wheel_1")
    np.testing.assert_allclose(hub[:2, 3], (wheel.x, wheel.y) + 0.05 * hub[:2, 1], atol=PLACES)
    assert f"{speeds[1]:+.4f}" in view._panels._numbers.content


def test_flat_strips_are_seen_from_above() -> None:
    """Single-sided strips are half the work: a circle of a steering range showed its back to the camera."""
    turn = np.linspace(0.0, 4.0, 30)
    path = np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=1)
    for mesh in (shapes.arc(1.0, -1.0, 2.0, 0.1), shapes.ribbon(path, 0.1), shapes.ribbon(path[::-1], 0.1)):
        a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
        assert (np.cross(b - a, c - a)[:, 2] > 0.0).all()


def test_nothing_is_sent_twice_for_nothing(opened: Open) -> None:
    view = opened("curiosity")
    sent: list[Any] = []
    queue = view._server._websock_server.queue_message
    view._server._websock_server.queue_message = lambda message: (sent.append(message), queue(message))
    view._ask()
    view._worker.wait()
    assert sent == []


def test_a_hole_in_the_map_is_a_hole_in_the_picture() -> None:
    heights = np.zeros((50, 50))
    heights[20:25, 20:25] = np.nan
    points, _ = cut(sw.Terrain(heights, 0.2), np.array([5.0, 5.0]), 6.0)
    faces = triangles(points)
    unknown = ~np.isfinite(points[..., 2]).ravel()
    assert unknown.any()
    assert not unknown[faces].any()
    assert len(faces) > 1000


def test_the_rover_stays_where_it_stood_at_the_edge_of_the_map(opened: Open) -> None:
    view = opened("perseverance", GROUNDS["plane"], at=(0.0, 0.0, 0.0))
    view.pose = (13.0, 0.0, 0.0)
    assert view.pose[0] == pytest.approx(13.0)
    view._state = view._state.__class__(**{**view._state.__dict__, "pose": (19.9, 0.0, 0.0)})
    motion = find_motion(view._subject, view._state, view.motion)
    assert motion.state.pose == (13.0, 0.0, 0.0)
    assert any("off_map" in remark for remark in motion.remarks)


def test_handles_are_where_the_rover_stands_unless_somebody_holds_them(opened: Open) -> None:
    """They stayed where they were first shown, and the next drag took the rover back there."""
    view = opened("curiosity", GROUNDS["yard"])
    view._panels._drag.value = True

    def stands() -> Any:
        return view.motion.transform[:3, 3] - view._subject.origin

    for pose in ((0.4, 0.3, 0.2), (-0.5, 0.1, 1.0)):
        view.pose = pose
        np.testing.assert_allclose(view._handle.position, stands(), atol=PLACES)
    held = np.array(view._handle.position)
    view._dragged = True
    view.pose = (0.2, 0.2, 0.0)
    np.testing.assert_array_equal(view._handle.position, held)
    view._let_go(None)  # the browser went away
    assert view._worker.wait(10.0)
    np.testing.assert_allclose(view._handle.position, stands(), atol=PLACES)
