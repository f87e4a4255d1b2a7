"""Every control of a page, moved in a browser, changes what it says: scene, numbers or camera.

The controls are those that the view itself has in its server. One without a case here is a failure.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import six_wheel as sw
from six_wheel.view.scene.shapes import about_z
from tests.view.browsing import DRAWN, PATIENCE, SMALL, Page, pull
from tests.view.test_browser import page, until

__all__ = ["page"]

Open = Callable[..., Any]
CLOSED = ("Limits", "Scrub [cm]", "Rover", "Show")
SPEEDS, AHEAD, ROVER = "/world/motion/speeds", "/world/motion/track_", "/world/rover"
ICR = "/world/motion/icr"
CORNERS = [(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25), (-0.3, -0.25)]


@dataclass(frozen=True)
class Case:
    """Action of a person, condition after it, and the beginning of the names of nodes that it changes."""

    do: Callable[[Page, Any], None]
    true: Callable[[Any], bool]
    changes: str


def scene(view: Any) -> dict[str, Any]:
    """Data of all nodes and of the panel, as they were sent to the browser."""
    found: dict[str, Any] = {}
    for name, handle in view._server.scene._handle_from_node_name.items():
        parts = [handle.position, handle.wxyz, np.array([handle.visible])]
        for part in ("points", "vertices", "text", "glb_data"):
            if hasattr(handle, part):
                parts.append(getattr(handle, part))
        found[name] = [part.tobytes() if isinstance(part, np.ndarray) else part for part in parts]
    panels = view._panels
    found["status"], found["numbers"] = panels.status.content, panels._numbers.content
    found["say"] = panels._say.content
    if hasattr(panels, "_map"):
        found["map"] = panels._map.image.tobytes()
    return found


def node(view: Any, name: str) -> Any:
    return view._server.scene.get_handle_by_name(name)


def close(value: Any, wanted: Any) -> bool:
    return bool(np.allclose(value, wanted, rtol=1e-6, atol=1e-9))


def slide(label: str, value: float, found: Callable[[Any], Any], wanted: Any, changes: str) -> Case:
    return Case(
        lambda shown, _: shown.type(label, f"{value:g}"), lambda view: close(found(view), wanted), changes
    )


def press(name: str, signs: tuple[float, float, float]) -> Case:
    def true(view: Any) -> bool:
        return close(np.sign(np.round(view.twist, 9)), signs)

    return Case(lambda shown, _: shown.press(name), true, SPEEDS)


def tick(label: str, true: Callable[[Any], bool], changes: str) -> Case:
    return Case(lambda shown, _: shown.tick(label), true, changes)


def driven_by(name: str, axis: int, way: int) -> Case:
    """A key that changes a part of the twist by a step, with which the rover drives; the camera stays."""
    before: dict[str, Any] = {}

    def do(shown: Page, view: Any) -> None:
        (client,) = view._server.get_clients().values()
        rest(shown, client.camera)  # from the case before, which began to move it
        before.update(twist=view.twist, camera=np.asarray(client.camera.wxyz))
        key(shown, name)

    def true(view: Any) -> bool:
        (client,) = view._server.get_clients().values()
        stays = close(before["camera"], client.camera.wxyz)
        return stays and way * (view.twist[axis] - before["twist"][axis]) > 0.0 and view._panels.driving

    return Case(do, true, ROVER)


def sought_by(name: str, time: float) -> Case:
    """A key that goes from 20 s to another time."""
    return Case(
        lambda shown, view: (setattr(view, "time", 20.0), key(shown, name)),
        lambda view: close(view.time, time),
        ROVER,
    )


def hide(label: str, name: str) -> list[Case]:
    """Off and on again."""
    return [
        tick(label, lambda view: not node(view, name).visible, name),
        tick(label, lambda view: bool(node(view, name).visible), name),
    ]


def camera(view: Any) -> NDArray[np.float64]:
    """Place of the camera from the point it looks at, in the axes and in sizes of the rover."""
    (client,) = view._server.get_clients().values()
    away = np.asarray(client.camera.position) - np.asarray(client.camera.look_at)
    return np.asarray(about_z(-view.pose[2]) @ away / view._subject.size)


def above(view: Any) -> bool:
    return bool(np.hypot(*camera(view)[:2]) < 0.1 and camera(view)[2] > 2.5)


def side(view: Any) -> bool:
    return bool(camera(view)[1] < -1.5 and abs(camera(view)[0]) < 0.1)


def chase(view: Any) -> bool:
    return bool(camera(view)[0] < -1.5)


def free(view: Any) -> bool:
    return bool(camera(view)[0] > 1.0)


CAMERAS = [("Above", above), ("Side", side), ("Chase", chase), ("Free", free)]


def key(shown: Page, name: str) -> None:
    shown.page.mouse.click(20, 20)
    shown.page.keyboard.press(name)


def point_turns(view: Any) -> bool:
    """One contact stands still: that of the wheel farthest to the left."""
    left = max(view._subject.rover.wheels, key=lambda wheel: (wheel.y, -abs(wheel.x)))
    return view.twist[2] > 0.0 and close(view.motion.icr, (left.x, left.y))


def moves(view: Any, patience: float = PATIENCE / 1000.0) -> bool:
    """True if the rover leaves its pose within so many seconds."""
    start = view.pose
    return until(lambda: view.pose != start, patience)


def coloured(label: str) -> Case:
    return Case(
        lambda shown, _: shown.choose("Ground by", label),
        lambda view: view._panels.coloring == label and view._block._shown[1] == label,
        "/world/ground/top",
    )


def drag(shown: Page, view: Any) -> None:
    """Take the rover by the arrow of its handle along x, seen from above, and pull."""
    shown.tick("Move it by hand")
    assert until(lambda: view._handle is not None and view._handle.visible)
    (client,) = view._server.get_clients().values()
    start, size = view.pose[0], view._subject.size
    # A pull beside the arrow turns the camera, and a slow browser may see a part of it only.
    for _ in range(20):
        key(shown, "3")
        assert until(lambda: above(view))
        rest(shown, client.camera)
        handle = np.asarray(view._handle.position) + np.asarray(view._world.position)
        pull(shown, client.camera, handle, size)
        if view.pose[0] > start + 0.15 * size:
            return


def rest(shown: Page, camera: Any) -> None:
    """Wait until the camera has come to rest, which takes long where software draws and has other work."""
    seen = np.full(7, np.nan)

    def rests() -> bool:
        nonlocal seen
        shown.page.evaluate(DRAWN)
        shown.page.wait_for_timeout(500)
        before, seen = seen, np.concatenate([camera.position, camera.wxyz])
        return close(before, seen)

    assert until(rests)


def turned(shown: Page, view: Any, label: str, value: str, button: str) -> None:
    """Begin a motion, of which a record has its own, and set a slider that matters to it."""
    if view._player is None:
        shown.press(button)
        assert until(lambda: bool(np.any(view.twist)))
    shown.type(label, value)


def widest(label: str, slider: Callable[[Any], Any]) -> Case:
    """The limit is taken away again."""
    return Case(
        lambda shown, v: shown.type(label, str(slider(v).max)),
        lambda v: close(slider(v).value, slider(v).max),
        "",
    )


def cases(view: Any) -> dict[str, list[Case]]:
    """The cases of all controls there are, by their labels; those of commands by their names."""
    motion = {
        "vx [cm/s]": [slide("vx [cm/s]", 5, lambda v: v.twist[0], 0.05, SPEEDS)],
        "vy [cm/s]": [slide("vy [cm/s]", 3, lambda v: v.twist[1], 0.03, "status")],
        "yaw [°/s]": [slide("yaw [°/s]", -4, lambda v: v.twist[2], np.radians(-4.0), AHEAD)],
        "Turns": [
            press("Spin", (0, 0, 1)), press("Straight", (1, 0, 0)), press("Crab", (1, 1, 0)),
            Case(lambda shown, _: shown.press("Point turn"), point_turns, ICR),
            press("Stop", (0, 0, 0)),
        ],
        "Pad": [press("↖", (1, 0, 1)), press("↗", (1, 0, -1)), press("↑", (1, 0, 0))],
        "pad, turns": [press("⟲", (0, 0, 1)), press("⟳", (0, 0, -1)), press("■", (0, 0, 0))],
        "pad, backwards": [press("↙", (-1, 0, -1)), press("↘", (-1, 0, 1)), press("↓", (-1, 0, 0))],
        "Plane": [
            Case(lambda shown, _, plane=plane: shown.choose("Plane", plane),
                 lambda v, plane=plane: v._panels._plane.value == plane, "map")
            for plane in ("vy over yaw rate", "vx over vy", "vx over yaw rate")
        ],
        "Drive": [
            Case(lambda shown, v: (shown.press("↖"), shown.tick("Drive")),
                 lambda v: v._player is None and np.hypot(*np.subtract(v.pose, v._subject.start)[:2]) > 0.02,
                 f"{ROVER}/wheel_0"),
            Case(lambda shown, v: (moves(v), shown.tick("Drive")),
                 lambda v: not v._panels.driving and not moves(v, 0.3), "say"),
        ],
        "Drive: ahead": [driven_by("ArrowUp", 0, 1)], "Drive: back": [driven_by("ArrowDown", 0, -1)],
        "Drive: left": [driven_by("ArrowLeft", 2, 1)], "Drive: right": [driven_by("ArrowRight", 2, -1)],
        "Drive: stop": [
            Case(lambda shown, v: (key(shown, "ArrowUp"), moves(v), key(shown, "Space")),
                 lambda v: not v._panels.driving and not np.any(v.twist) and not moves(v, 0.3), "say"),
        ],
    }  # fmt: skip
    limits = {
        "steering [°]": [
            Case(lambda shown, v: turned(shown, v, "steering [°]", "25", "↖"),
                 lambda v: close(v._state.steering_limit, np.radians(25.0))
                 and (v._player is not None or np.abs(v.motion.steering).max() <= np.radians(25.0) + 1e-9),
                 f"{ROVER}/fan_0"),
            widest("steering [°]", lambda v: v._panels._steering),
        ],
        "wheel [rad/s]": [
            Case(lambda shown, v: turned(shown, v, "wheel [rad/s]", "0.2", "↑"),
                 lambda v: v._player is not None or close(v.motion.twist[0], 0.2 * v._subject.radius),
                 SPEEDS),
            widest("wheel [rad/s]", lambda v: v._panels._wheel_speed),
        ],
        "speed [cm/s]": [
            Case(lambda shown, v: turned(shown, v, "speed [cm/s]", "1", "↑"),
                 lambda v: close(v.motion.twist[0], 0.01), "map"),
            widest("speed [cm/s]", lambda v: v._panels._speed),
        ],
        "tilt [°]": [
            slide("tilt [°]", 5, lambda v: v._state.tilt, np.radians(5.0), "say"),
        ],
    }  # fmt: skip
    wheels = view._subject.rover.wheels
    scrubs = {
        wheel.name.replace("_", " "): [
            Case(lambda shown, v, wheel=wheel: turned(shown, v, wheel.name.replace("_", " "), "4", "⟲"),
                 lambda v, k=k: close(v._state.scrub[k], 0.04), f"{ROVER}/wheel_{k}"),
            # With other scrub at every wheel no motion is left.
            slide(wheel.name.replace("_", " "), 0, lambda v, k=k: v._state.scrub[k], 0.0,
                  f"{ROVER}/wheel_{k}"),
        ]
        for k, wheel in enumerate(wheels)
    }  # fmt: skip
    x, y = (round(view._subject.start[k] + (0.3, -0.2)[k], 1) for k in (0, 1))
    place = {
        "x [m]": [slide("x [m]", x, lambda v: v.pose[0], x, ROVER)],
        "y [m]": [slide("y [m]", y, lambda v: v.pose[1], y, ROVER)],
        "yaw [°]": [slide("yaw [°]", 40, lambda v: v.pose[2], np.radians(40.0), ROVER)],
        "Move it by hand": [
            Case(drag, lambda v: v.pose[0] > x + 0.15 * v._subject.size, ROVER),
            tick("Move it by hand", lambda v: not v._handle.visible, "/world/handle"),
        ],
        "Ground by": [coloured(name) for name in ("slope", "unevenness", "feasible", "relief")],
    }
    joints = {
        f"{name} [°]": [slide(f"{name} [°]", 8, lambda v, k=k: v.motion.joints[k], np.radians(8.0), ROVER)]
        for k, name in enumerate(("rocker", "bogie L", "bogie R"))
    }
    show = {
        "body": hide("body", f"{ROVER}/body"),
        "fans": hide("fans", f"{ROVER}/fan_0"),
        "arrows": hide("arrows", SPEEDS),
        # The centre is seen in a turn alone: a view may draw two changes at once, so the turn is a case.
        "centre": [
            Case(
                lambda shown, v: None if v._player else shown.press("↖"),
                lambda v: bool(node(v, ICR).visible),
                "" if view._player else ICR,
            ),
            *hide("centre", ICR),
        ],
        "ahead": hide("ahead", f"{AHEAD}0"),
        "path": hide("path", "/world/record/path"),
        "follow": [tick("follow", lambda v: not v._panels.shows("follow"), "")],
        "Camera": [Case(lambda shown, _, n=n: shown.press(n), t, "") for n, t in CAMERAS],
    } | {
        f"Camera: {name}": [Case(lambda shown, _, k=k: key(shown, k), true, "")]
        for k, name in zip("1234", ("Free", "Chase", "Above", "Side"), strict=True)
        for other, true in CAMERAS
        if other == name
    }
    record = {
        "time [s]": [slide("time [s]", 12, lambda v: v.time, 12.0, ROVER)],
        "Speed": [
            Case(lambda shown, _: shown.choose("Speed", "4x"), lambda v: v._player._factor.value == "4x", "")
        ],
        "Play": [
            tick("Play", lambda v: v._player.playing and v.time > 5.5, f"{ROVER}/wheel_0"),
            tick("Play", lambda v: not v._player.playing, ""),
        ],
        "Play or pause": [
            Case(lambda shown, _: key(shown, "Space"), lambda v: v._player.playing, ROVER),
            Case(lambda shown, _: key(shown, "Space"), lambda v: not v._player.playing, ""),
        ],
        "A second back": [sought_by("ArrowLeft", 19.0)],
        "A second on": [sought_by("ArrowRight", 21.0)],
    }
    return motion | limits | scrubs | place | joints | show | record


def controls(view: Any) -> list[str]:
    """The labels of everything that a person can move, and of commands with a key."""
    gui = view._server.gui
    labels = []
    for handle in gui._gui_input_handle_from_uuid.values():
        label = handle.label
        if not label:
            label = {"⟲": "pad, turns", "↙": "pad, backwards"}[handle.options[0]]
        labels.append(label)
    return [*labels, *(command.label for command in gui._command_handle_from_uuid.values())]


def subject(kind: str) -> tuple[Any, Any, dict[str, Any]]:
    """A suspension on a plane and on rocks, and a record: together they have every control."""
    if kind == "record":
        stamps = np.linspace(0.0, 60.0, 1200)
        rover = sw.Rover.swerve(CORNERS, 0.1)
        return sw.simulate(rover, (stamps, np.tile([0.05, 0.0, 0.02], (1200, 1)))), None, {"rover": rover}
    return "curiosity", {"flat": "flat", "rocks": "yard"}[kind], {"twist": (0.15, 0.0, 0.05)}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["flat", "rocks", "record"])
def test_every_control_of_the_page_changes_what_it_says(opened: Open, page: Any, kind: str) -> None:
    x, ground, options = subject(kind)
    view = opened(x, ground, **options)
    known, there = cases(view), controls(view)
    assert [label for label in there if label not in known] == []
    if view.time is not None:
        view.time = 5.0
    shown = page(view.url, SMALL)
    shown.page.wait_for_selector("text=driven")
    for folder in CLOSED:
        if shown.page.get_by_text(folder, exact=True).count():
            shown.unfold(folder)
    failed = [
        (label, number)
        for label in there
        for number, case in enumerate(known[label])
        if not does(shown, view, case)
    ]
    assert failed == []
    assert shown.complaints == []


def does(shown: Page, view: Any, case: Case) -> bool:
    """True if a control does what its case says."""
    before = scene(view)

    def changed() -> bool:
        after = scene(view)
        return any(after[name] != before.get(name) for name in after if name.startswith(case.changes))

    case.do(shown, view)
    return until(lambda: case.true(view) and (not case.changes or changed()))
