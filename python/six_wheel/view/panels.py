"""The panels, made once: sliders and buttons, read by `Panels.state`; numbers, written by `Panels.report`."""

from __future__ import annotations  # viser is loaded when panels are made

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel.view.commands import command_line, python_lines
from six_wheel.view.motion import Motion, State
from six_wheel.view.possible import PLANES, possible_image
from six_wheel.view.report import LEGEND, failure, lines_to_say, numbers, status
from six_wheel.view.scene.ground import COLORINGS
from six_wheel.view.scene.stage import CAMERAS
from six_wheel.view.subject import Subject

if TYPE_CHECKING:
    import viser

STEPS = 200  # of a slider over its range
PAD = (("↖", "↑", "↗"), ("⟲", "■", "⟳"), ("↙", "↓", "↘"))
TURNS = ("Straight", "Crab", "Spin", "Point turn", "Stop")
# Commands with a key: changes of vx and of the yaw rate, in tenths of the ranges of their sliders.
KEYS: dict[str, tuple[Any, int, int]] = {
    "Drive: ahead": ("arrowup", 1, 0),
    "Drive: back": ("arrowdown", -1, 0),
    "Drive: left": ("arrowleft", 0, 1),
    "Drive: right": ("arrowright", 0, -1),
    "Drive: stop": ("space", 0, 0),
}
SHOWN = ("body", "arrows", "centre", "ahead", "fans", "path", "follow")  # the path is that of a record


class Panels:
    """Controls of a view, at first with the values of `state`.

    `changed` is called after each change by a person, `look` with the client and the name of a camera.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        subject: Subject,
        state: State,
        changed: Callable[[], None],
        look: Callable[[Any, str], None],
    ) -> None:
        self._gui, self._subject, self._changed, self._look = server.gui, subject, changed, look
        self._fast = subject.top_speed >= 1.0
        self._unit = 1.0 if self._fast else 100.0  # of the sliders for a metre
        self._spans = (subject.top_speed, subject.top_speed, subject.top_yaw_rate)
        self._joint_sliders: list[Any] = []
        # of a slider, which moves in steps: as shown, as given
        self._exact: dict[int, tuple[float, float]] = {}
        self._mapped: tuple[Any, ...] | None = None
        self.status = self._gui.add_html("")
        if subject.record is None:
            self._add_motion(state)
        self._add_limits(state)
        self._add_rover(state)
        with self._gui.add_folder("Wheels", expand_by_default=False):
            self._numbers = self._gui.add_html("")
        with self._gui.add_folder("Say this", expand_by_default=False):
            self._say = self._gui.add_html("")
        self._add_show()

    def state(self, before: State) -> State:
        """The state that the controls give, of one with all they do not say."""
        values: dict[str, Any] = {}
        if self._subject.record is None:
            values["twist"] = self._commanded()
        if self._steering is not None:
            values["steering_limit"] = math.radians(self._value(self._steering))
        values["wheel_speed"] = self._value(self._wheel_speed)
        if self._speed is not None:
            top = self._speed.value >= self._speed.max
            values["speed"] = math.inf if top else self._value(self._speed) / self._unit
        if self._tilt is not None:
            values["tilt"] = math.radians(self._value(self._tilt))
        if self._joint_sliders:
            values["joints"] = tuple(math.radians(self._value(each)) for each in self._joint_sliders)
        if self._scrub:
            values["scrub"] = tuple(self._value(each) / 100.0 for each in self._scrub)
        if self._place:
            x, y, yaw = map(self._value, self._place)
            values["pose"] = (x, y, math.radians(yaw))
        return replace(before, **values)

    def _commanded(self) -> tuple[float, float, float]:
        """The twist that the sliders give [m/s, m/s, rad/s]."""
        vx, vy, omega = map(self._value, self._twist)
        return (vx / self._unit, vy / self._unit, math.radians(omega))

    def set_twist(self, twist: Any) -> None:
        """Move the sliders of the motion."""
        shown = (twist[0] * self._unit, twist[1] * self._unit, math.degrees(twist[2]))
        for slider, value in zip(self._twist, shown, strict=True):
            self._set(slider, value)

    def set_pose(self, pose: Any) -> None:
        """Move the sliders of the place."""
        if self._place:
            yaw = math.remainder(pose[2], math.tau)
            for slider, value in zip(self._place, (pose[0], pose[1], math.degrees(yaw)), strict=True):
                self._set(slider, value)

    def report(self, motion: Motion, time: float | None = None) -> None:
        """Write what came of the state."""
        subject, state = self._subject, motion.state
        self.status.content = status(subject, motion)
        self._numbers.content = numbers(subject, motion)
        shown = command_line(subject, state, time), python_lines(subject, state, time)
        self._say.content = lines_to_say(*shown)
        if subject.record is not None:
            return
        limits, plane = state.limits(subject), self._plane.value
        key = (state.twist, tuple(motion.twist), state.steering_limit, state.scrub, limits, plane)
        if key != self._mapped:
            self._mapped = key
            twists = np.array(state.twist), motion.twist
            self._map.image = possible_image(state.rover(subject), limits, *twists, self._spans, plane)

    def fail(self, error: Exception) -> None:
        """Write what went wrong where the state is written."""
        self.status.content = failure(error)

    def shows(self, name: str) -> bool:
        """True if this part is to be drawn."""
        return bool(self._show[name].value)

    @property
    def coloring(self) -> str:
        """The quantity that colours the ground."""
        return str(self._coloring.value) if self._coloring is not None else "relief"

    @property
    def driving(self) -> bool:
        """True if the rover is to drive on."""
        return self._subject.record is None and bool(self._drive.value)

    @property
    def moved_by_hand(self) -> bool:
        """True if the rover is to be dragged in the picture."""
        return self._drag is not None and bool(self._drag.value)

    def stop_driving(self) -> None:
        """The rover has come to an end."""
        if self._subject.record is None:
            self._drive.value = False

    def _slider(self, label: str, low: float, high: float, value: float, digits: int | None = None) -> Any:
        step = (high - low) / STEPS
        step = 10.0 ** math.floor(math.log10(step)) if step > 0 else 1.0
        if digits is not None:
            step = 10.0**-digits
        low, high = math.floor(low / step + 1e-9) * step, math.ceil(high / step - 1e-9) * step
        places = max(0, round(-math.log10(step)))
        made = self._gui.add_slider(
            label, round(low, places), round(high, places), step, min(max(round(value, places), low), high)
        )
        self._exact[id(made)] = (made.value, value)
        self._watch(made)
        return made

    def _value(self, slider: Any) -> float:
        """Value of a slider: the number it was given, unless a person has moved it since."""
        shown, exact = self._exact[id(slider)]
        return exact if slider.value == shown else float(slider.value)

    def _set(self, slider: Any, value: float) -> None:
        slider.value = float(min(max(value, slider.min), slider.max))
        self._exact[id(slider)] = (slider.value, value)

    def _watch(self, control: Any) -> None:
        def told(event: Any) -> None:
            if event.client is not None:  # values that the program sets have been computed already
                self._changed()

        control.on_update(told)

    def _add_motion(self, state: State) -> None:
        gui, unit = self._gui, self._unit
        name = "m/s" if self._fast else "cm/s"
        with gui.add_folder("Motion"):
            top, turn = self._spans[0] * unit, math.degrees(self._spans[2])
            vx, vy, omega = state.twist
            self._twist = [
                self._slider(f"vx [{name}]", -top, top, vx * unit),
                self._slider(f"vy [{name}]", -top, top, vy * unit),
                self._slider("yaw [°/s]", -turn, turn, math.degrees(omega)),
            ]
            self._buttons(TURNS, "Turns", self._turn)
            for number, row in enumerate(PAD):
                self._buttons(row, ("Pad", "", "")[number], self._step)
            self._drive = gui.add_checkbox("Drive", False, hint="drive on with this motion")
            self._watch(self._drive)
        for label, (hotkey, ahead, left) in KEYS.items():
            gui.add_command(label, hotkey=hotkey).on_trigger(partial(self._press, ahead, left))
        with gui.add_folder("Possible motions"):
            self._plane = gui.add_dropdown("Plane", list(PLANES), initial_value="vx over yaw rate")
            self._watch(self._plane)
            self._map = gui.add_image(np.zeros((2, 2, 3), np.uint8), format="png")
            gui.add_html(LEGEND)

    def _buttons(self, options: Any, label: str, act: Callable[[str], None]) -> None:
        group = self._gui.add_button_group(label, tuple(options))

        def click(event: Any) -> None:
            act(str(group.value))
            self._changed()

        group.on_click(click)

    def _turn(self, name: str) -> None:
        speed, turn = self._spans[0] / 3.0, self._spans[2] / 3.0
        left = max(self._subject.rover.wheels, key=lambda wheel: (wheel.y, -abs(wheel.x)))
        twists = {
            "Straight": (speed, 0.0, 0.0),
            "Crab": (speed * math.cos(0.5), speed * math.sin(0.5), 0.0),
            "Spin": (0.0, 0.0, turn),
            # About the contact of the wheel farthest to the left, which only turns there.
            "Point turn": (turn * left.y, -turn * left.x, turn),
            "Stop": (0.0, 0.0, 0.0),
        }
        self.set_twist(twists[name])

    def _step(self, key: str) -> None:
        place = next((row, line.index(key)) for row, line in enumerate(PAD) if key in line)
        ahead, left = 1 - place[0], 1 - place[1]
        if key == "■":
            self.set_twist((0.0, 0.0, 0.0))
            return
        turn = left if ahead >= 0 else -left  # backwards to the left is a turn to the right
        self.set_twist((ahead * self._spans[0] / 3.0, 0.0, turn * self._spans[2] / 3.0))

    # The server calls coroutines in the order of the events: none of two keys is lost.
    async def _press(self, ahead: int, left: int, event: Any) -> None:
        """Drive with a motion that is changed by a step, or stop."""
        drives = bool(ahead or left)
        before = self._commanded() if drives else (0.0, 0.0, 0.0)
        self.set_twist(
            [
                0.1 * span * (round(10.0 * value / span) + change) if change else value
                for value, span, change in zip(before, self._spans, (ahead, 0, left), strict=True)
            ]
        )
        self._drive.value = drives
        self._changed()

    def _add_limits(self, state: State) -> None:
        gui, subject = self._gui, self._subject
        with gui.add_folder("Limits", expand_by_default=False):
            limit = subject.steering_limit
            self._steering = None
            if limit is not None:
                widest = math.degrees(limit)
                value = widest if state.steering_limit is None else math.degrees(state.steering_limit)
                self._steering = self._slider("steering [°]", min(5.0, widest), widest, value, 1)
            self._wheel_speed = self._slider(
                "wheel [rad/s]", 0.05 * subject.wheel_speed, 2.0 * subject.wheel_speed, state.wheel_speed
            )
            top = subject.top_speed * self._unit
            name = "m/s" if self._fast else "cm/s"
            self._speed = self._tilt = None
            if subject.record is None:
                value = min(state.speed * self._unit, top)
                self._speed = self._slider(f"speed [{name}]", 0.05 * top, top, value)
            if subject.ground is not None:
                self._tilt = self._slider("tilt [°]", 5.0, 60.0, math.degrees(state.tilt), 0)
        self._scrub: list[Any] = []
        if subject.ground is None and subject.record is None:
            wheels = subject.rover.wheels
            given = [wheel.scrub for wheel in wheels] if state.scrub is None else state.scrub
            reach = 100.0 * max(subject.radius, 1.5 * max(map(abs, given)))
            with gui.add_folder("Scrub [cm]", expand_by_default=False):
                self._scrub = [
                    self._slider(wheel.name.replace("_", " "), -reach, reach, 100.0 * scrub)
                    for wheel, scrub in zip(wheels, given, strict=True)
                ]

    def _add_rover(self, state: State) -> None:
        gui, subject = self._gui, self._subject
        self._place: list[Any] = []
        self._coloring = self._drag = None
        if subject.record is not None and subject.ground is None:
            return
        with gui.add_folder("Rover", expand_by_default=False):
            if subject.record is None:
                x, y, yaw = state.pose
                reach = 6.0 * subject.size
                self._place = [
                    self._slider("x [m]", x - reach, x + reach, x),
                    self._slider("y [m]", y - reach, y + reach, y),
                    self._slider("yaw [°]", -180.0, 180.0, math.degrees(yaw), 0),
                ]
                self._drag = gui.add_checkbox(
                    "Move it by hand", False, hint="handles at the rover, in the picture"
                )
                self._watch(self._drag)
            if subject.ground is not None:
                self._coloring = gui.add_dropdown("Ground by", COLORINGS, initial_value="relief")
                self._watch(self._coloring)
            elif subject.suspension is not None:
                named = zip(("rocker", "bogie L", "bogie R"), state.joints, strict=True)
                self._joint_sliders = [
                    self._slider(f"{name} [°]", -30.0, 30.0, math.degrees(value), 1) for name, value in named
                ]

    def _add_show(self) -> None:
        gui = self._gui
        with gui.add_folder("Show", expand_by_default=False):
            names = [name for name in SHOWN if name != "path" or self._subject.record is not None]
            self._show = {name: gui.add_checkbox(name, True) for name in names}
        for box in self._show.values():
            self._watch(box)
        cameras = gui.add_button_group("Camera", tuple(CAMERAS))

        def look(event: Any, name: str = "") -> None:
            if event.client is not None:
                self._look(event.client, name or str(cameras.value))

        cameras.on_click(look)
        for key, name in zip("1234", CAMERAS, strict=True):
            gui.add_command(f"Camera: {name}", hotkey=key).on_trigger(partial(look, name=name))
