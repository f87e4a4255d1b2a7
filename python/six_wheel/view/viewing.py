"""A view: a server, the scene, the panels, and the thread that brings them together."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import atexit
import os
import threading
import time as clock
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel._core import integrate
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.objects.closing import Closing
from six_wheel.view.commands import start_state
from six_wheel.view.export import FRAMES, RATE, write_page
from six_wheel.view.motion import Motion, State, find_motion
from six_wheel.view.panels import Panels
from six_wheel.view.player import Player
from six_wheel.view.scene.bodies import Bodies
from six_wheel.view.scene.ground import Block
from six_wheel.view.scene.markers import Markers
from six_wheel.view.scene.stage import camera_of, set_stage
from six_wheel.view.server import HOST, open_server, stop_server
from six_wheel.view.subject import Subject, number, triple
from six_wheel.view.worker import Worker

if TYPE_CHECKING:
    import viser

PERIOD = 1.0 / 30.0  # [s] of a rover that drives
SLOW = 0.2  # [s] between changes of what takes long to draw while it drives


@checked_class
class View(Closing):
    """A rover in the browser, computed here.

    Made by `six_wheel.view`. It can be used in a ``with`` block, which closes it.

    Attributes
    ----------
    url : str
        Its address, on this machine only; nothing of one that is not served.
    """

    def __init__(
        self,
        subject: Subject,
        state: State,
        *,
        port: int | None = 0,
        theme: str = "dark",
    ) -> None:
        if theme not in ("dark", "light"):
            raise ValueError(f'theme must be dark or light, got "{theme}"')
        self._lock, self._closed = threading.RLock(), threading.Event()
        motion = find_motion(subject, state)
        self._server = open_server(port)
        self._dark = theme == "dark"
        self.url = "" if port is None else f"http://{HOST}:{self._server.get_port()}"
        try:
            self._make(subject, state, motion)
        except BaseException:
            stop_server(self._server)
            raise
        self._server.on_client_connect(self._greet)
        self._server.on_client_disconnect(self._let_go)
        atexit.register(self.close)

    def _make(self, subject: Subject, state: State, motion: Motion) -> None:
        """Everything that is seen, of a subject."""
        server = self._server
        self._subject, self._state, self._motion = subject, state, motion
        nodes = set_stage(server, subject.size, self._dark)
        nodes["floor"].visible = subject.ground is None
        self._world = nodes["world"]
        self._bodies = Bodies(server, subject, motion)
        if subject.other is not None:
            self._other_motion = find_motion(subject.other, start_state(subject.other))
            self._other_bodies = Bodies(server, subject.other, self._other_motion, "/world/other")
        self._markers = Markers(server, subject, motion)
        self._block = Block(server, subject)
        self._panels = Panels(server, subject, state, self._ask, self._look)
        self._player = None if subject.record is None else Player(server, subject, self._ask)
        self._handle: Any = None
        self._dragged = False
        self._drawn = 0.0
        position, target = self._camera("Free")
        server.initial_camera.position, server.initial_camera.look_at = position, target
        self._worker = Worker(self._update, self._fail)
        self._worker.ask()
        self._worker.wait(30.0)
        self._ticker = threading.Thread(target=self._tick, name="six_wheel view plays", daemon=True)
        self._ticker.start()

    @property
    def twist(self) -> tuple[float, float, float]:
        """The commanded motion vx, vy, omega [m/s, m/s, rad/s]; assigning it moves the sliders."""
        return self._state.twist

    @twist.setter
    def twist(self, twist: Any) -> None:
        if self._player is not None:
            raise ValueError("twist must be left alone of a record, which has its own")
        self._panels.set_twist(triple("twist", twist))
        self._compute()

    @property
    def pose(self) -> tuple[float, float, float]:
        """Pose of the rover: x, y, yaw [m, m, rad]; assigning it moves the rover."""
        return self._state.pose

    @pose.setter
    def pose(self, pose: Any) -> None:
        given = triple("pose", pose)
        if self._player is not None:
            raise ValueError("pose must be left alone of a record, which has its own; time moves it")
        self._panels.set_pose(given)
        self._compute()

    @property
    def time(self) -> float | None:
        """Time in a record since its first row [s]; None without one."""
        return None if self._player is None else self._player.time

    @time.setter
    def time(self, time: float) -> None:
        if self._player is None:
            raise ValueError("time must be left alone without a record")
        self._player.go(number("time", time))
        self._compute()

    @property
    def motion(self) -> Motion:
        """The numbers of the picture."""
        return self._motion

    @property
    def duration(self) -> float:
        """Of the record [s]; 0 without one."""
        return 0.0 if self._subject.record is None else self._subject.record.duration

    def show(self, x: Any, ground: Any = None, *, rover: Any = None, other: Any = None) -> None:
        """Show something else in the same page; arguments as of `six_wheel.view`."""
        from six_wheel.view.subject import find_subject

        subject = find_subject(x, ground, rover=rover, other=other)
        state = start_state(subject)
        motion = find_motion(subject, state)
        self._stop_threads()
        self._server.scene.reset()
        self._server.gui.reset()
        self._make(subject, state, motion)
        for client in self._server.get_clients().values():
            self._greet(client)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the picture as a page that needs no server; of a record with its motion.

        Parameters
        ----------
        path : path-like
            A file ending in .html.

        Raises
        ------
        ValueError
            If it has another ending.
        """
        target = Path(path)
        if target.suffix.lower() != ".html":
            raise ValueError(f'path must end in .html, got "{path}"')
        self._worker.wait(10.0)
        write_page(self._server, target, self._dark, self._frames())
        return target

    def _frames(self) -> Iterator[float]:
        """Go through a record, if there is one; how long every picture lasts [s]."""
        if self._player is None:
            return
        before = self._player.time
        count = int(min(FRAMES, max(2.0, self.duration * RATE)))
        for time in np.linspace(0.0, self.duration, count).tolist():
            self.time = time
            yield 1.0 / RATE
        self.time = before

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until it is closed from another thread, or for a time [s]; whether it is closed.

        Ctrl-C ends the wait with a `KeyboardInterrupt`.
        """
        return self._closed.wait(timeout)

    def close(self) -> None:
        """End it, within about a second; a second time nothing happens."""
        with self._lock:
            if self._closed.is_set():
                return
            self._closed.set()
        atexit.unregister(self.close)
        self._stop_threads()
        stop_server(self._server)

    def __repr__(self) -> str:
        state = ", closed" if self._closed.is_set() else ""
        return f"View({self._subject.name!r}, {self.url}{state})"

    def __reduce__(self) -> Any:
        raise TypeError("a View cannot be pickled: it is a server")

    def _repr_html_(self) -> str:
        """In a notebook: the page itself."""
        return f'<iframe src="{self.url}" width="100%" height="560" style="border:0"></iframe>'

    def _ask(self) -> None:
        self._worker.ask()

    def _compute(self) -> None:
        self._worker.ask()
        self._worker.wait(10.0)

    def _update(self) -> None:
        """Compute the state of the controls and draw it."""
        panels, subject, now = self._panels, self._subject, clock.monotonic()
        state = panels.state(self._state)
        player = self._player
        if player is not None:
            state = player.state(state)
        moving = panels.driving or (player is not None and player.playing)
        full = not moving or now - self._drawn > SLOW
        motion = find_motion(subject, state, self._motion)
        if motion.state.pose != state.pose:  # it stayed where it stood
            panels.set_pose(motion.state.pose)
            panels.stop_driving()
        limit_moved = state.steering_limit != self._motion.state.steering_limit
        self._state, self._motion = replace(state, pose=motion.state.pose), motion
        if player is not None and (other := subject.other) is not None:
            other_state = player.state(self._other_motion.state, other)
            self._other_motion = find_motion(other, other_state, self._other_motion)
        with self._server.atomic():
            self._follow(motion)
            if subject.other is not None:
                self._other_bodies.show(self._other_motion)
            self._bodies.show(motion)
            if limit_moved:
                self._bodies.set_steering_limit(state.steering_limit)
            self._show_parts()
            self._markers.show(motion, full)
            if player is not None:
                player.show(full)
        if full:
            self._drawn = now
            self._block.show(motion.state.pose, panels.coloring)
            self._show_handle(motion)
            motion = replace(motion, remarks=(*motion.remarks, *self._bodies.remarks))
            panels.report(motion, None if player is None else player.time)

    def _follow(self, motion: Motion) -> None:
        """Move the world instead of the rover: cameras, which are those of the browsers, stay with it."""
        if self._panels.shows("follow") and not self._panels.moved_by_hand:
            x, y, _ = motion.transform[:3, 3] - self._subject.origin
            self._world.position = (-float(x), -float(y), 0.0)

    def _show_parts(self) -> None:
        panels = self._panels
        for node in self._bodies.decoration:
            node.visible = panels.shows("body")
        for name in self._markers.visible:
            self._markers.visible[name] = panels.shows(name)
        self._bodies.show_fans(panels.shows("fans"))
        if self._player is not None:
            self._player.show_path(panels.shows("path"))

    def _show_handle(self, motion: Motion) -> None:
        """Handles to drag the rover by; they are where it stands while nobody holds them."""
        wanted = self._panels.moved_by_hand
        if self._handle is None:
            if not wanted:
                return
            self._handle = self._server.scene.add_transform_controls(
                "/world/handle",
                scale=0.6 * self._subject.size,
                active_axes=(True, True, False),
                disable_rotations=True,
            )

            # The server calls coroutines in the order of the events, so that the end of a drag comes last.
            async def drag(event: Any) -> None:
                self._dragged = event.phase != "end"
                x, y, _ = (float(value) for value in self._handle.position + self._subject.origin)
                self._panels.set_pose((x, y, self._state.pose[2]))
                self._ask()

            self._handle.on_update(drag)
        self._handle.visible = wanted
        place = motion.transform[:3, 3] - self._subject.origin
        if wanted and not self._dragged and not np.array_equal(self._handle.position, place):
            self._handle.position = place

    def _let_go(self, client: viser.ClientHandle) -> None:
        """A browser that goes away in the middle of a drag does not send its end."""
        self._dragged = False
        self._ask()

    def _tick(self) -> None:
        """Let time go on: that of a record, or of a rover that drives."""
        worker, before = self._worker, clock.monotonic()
        spent = 0.0
        while not self._closed.wait(max(PERIOD - spent, 1e-3)) and worker is self._worker:
            now = clock.monotonic()
            dt, before = now - before, now
            if self._player is not None:
                moved = self._player.advance(dt)
            elif moved := self._panels.driving:
                self._drive(min(dt, 0.2))
            if moved:
                worker.ask()
                worker.wait(1.0)
            spent = clock.monotonic() - now

    def _drive(self, dt: float) -> None:
        """The rover, so much later."""
        motion = self._motion
        pose = integrate(motion.twist[None], dt, motion.state.pose)[-1]
        rolled = np.zeros(len(motion.wheel_speeds))
        rolled[: len(self._state.rolled)] = self._state.rolled
        self._state = replace(self._state, rolled=tuple((rolled + motion.wheel_speeds * dt).tolist()))
        self._panels.set_pose(pose)

    def _fail(self, error: Exception) -> None:
        """Say in the panel what went wrong, and go on."""
        if not self._closed.is_set():
            self._panels.fail(error)

    def _look(self, client: viser.ClientHandle, name: str) -> None:
        """Put the camera of one browser in its place."""
        narrow = client.camera.image_width < client.camera.image_height
        position, target = self._camera(name, narrow)
        with client.atomic():
            client.camera.position, client.camera.look_at = position, target

    def _camera(self, name: str, narrow: bool = False) -> tuple[Any, Any]:
        """Place and target of a camera."""
        found = camera_of(name, self._subject.size, self._motion.transform, narrow)
        offset = np.asarray(self._world.position) - self._subject.origin
        return found[0] + offset, found[1] + offset

    def _greet(self, client: viser.ClientHandle) -> None:
        self._look(client, "Free")

    def _stop_threads(self) -> None:
        worker, self._worker = self._worker, Worker(lambda: None, lambda error: None)
        worker.close()
        self._worker.close()
