"""Playing a record: its time, the path it took, plots of what it did and why."""

from __future__ import annotations  # viser is loaded when a player is made

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.poses import Floats
from six_wheel.view.motion import State, on_ground
from six_wheel.view.records.plots import thin_columns
from six_wheel.view.records.record import Record, thin_path
from six_wheel.view.subject import Subject

if TYPE_CHECKING:
    import viser

DRIVEN, TRUE, ELLIPSE = (236, 228, 206), (122, 214, 96), (255, 201, 74)
OTHER = (154, 143, 208)  # path of the record beside it
INKS = ("#26a8b2", "#ffc94a", "#d0643c", "#9a8fd0", "#7ad660", "#e85a8c", "#7fb2ff", "#c0c0c0")
SPEEDS = ("0.25x", "1x", "4x", "16x")
ELLIPSES = 24  # along the path
SIGMAS = 3.0
SPANS = 240  # of coloured reasons


class Player:
    """Controls and nodes of the record of a subject; `changed` is called after each change by a person."""

    def __init__(self, server: viser.ViserServer, subject: Subject, changed: Callable[[], None]) -> None:
        assert subject.record is not None
        self._server, self._subject, self._changed = server, subject, changed
        self._record: Record = subject.record
        self.time = 0.0
        self._lines: list[Any] = []
        self._cursors: list[Any] = []
        self._add_controls()
        self._add_paths()

    @property
    def playing(self) -> bool:
        """True while time goes on."""
        return bool(self._play.value)

    def go(self, time: float) -> None:
        """Go to a time [s] within the record."""
        if not math.isfinite(time):
            raise ValueError(f"time must be finite, got {time}")
        self.time = min(max(time, 0.0), self._record.duration)
        self._slider.value = min(round(self.time, 3), self._slider.max)

    def advance(self, dt: float) -> bool:
        """Let time go on by `dt` of a clock on the wall [s]; whether it did."""
        if not self.playing:
            return False
        factor = float(str(self._factor.value).removesuffix("x"))
        time = self.time + factor * dt
        if time >= self._record.duration:
            self._play.value = False
        self.go(time)
        return True

    def state(self, before: State, of: Subject | None = None) -> State:
        """The state of the rover at this time, or that of another record `of`."""
        subject = self._subject if of is None else of
        record, rover = subject.record, subject.rover
        assert record is not None
        row = record.row(self.time)

        def known(values: Floats | None, count: int) -> Any:
            return (0.0,) * count if values is None else tuple(np.nan_to_num(values[row]).tolist())

        steering = record.steering
        if steering is not None and not np.isfinite(steering[row]).all():
            steering = None
        rolled = () if record.rolled is None else tuple(record.rolled[row].tolist())
        return replace(
            before, twist=known(record.twists, 3), pose=known(record.poses, 3), rolled=rolled,
            steering=known(steering, len(rover.steered_wheel_names)),
            wheel_speeds=known(record.wheel_speeds, len(rover.wheels)),
        )  # fmt: skip

    def show(self, full: bool) -> None:
        """Draw what belongs to this time: the ellipse of the pose, the reasons."""
        record, row = self._record, self._record.row(self.time)
        if record.covariances is not None:
            self._now.points = self._ellipse(row)
        if full:
            if record.reasons is not None:
                found = Reason(int(record.reasons[row]))
                names = found.name or "as commanded"
                self._why.content = _spans(self._found, record.duration, self.time, names)
            # A plot is sent whole: while time goes on, the bar above has its own mark.
            for cursor, (times, columns) in () if self.playing else self._cursors:
                cursor.data = _with_cursor(times, columns, self.time)

    def show_path(self, visible: bool) -> None:
        """Show or hide the paths."""
        for line in self._lines:
            line.visible = visible

    def _add_controls(self) -> None:
        gui, record = self._server.gui, self._record
        with gui.add_folder("Drive"):
            self._play = gui.add_checkbox("Play", False)
            self._factor = gui.add_dropdown("Speed", SPEEDS, initial_value="1x")
            longest = max(math.ceil(1000.0 * record.duration) / 1000.0, 0.001)
            self._slider = gui.add_slider("time [s]", 0.0, longest, 0.001, 0.0)
            self._why = gui.add_html("")

        def seek(event: Any) -> None:
            if event.client is not None:
                self.time = min(float(self._slider.value), self._record.duration)
                self._changed()

        def begin(event: Any) -> None:
            if self.playing and self.time >= self._record.duration:
                self.go(0.0)
            self._changed()

        def toggle(event: Any) -> None:
            self._play.value = not self._play.value
            begin(event)

        self._slider.on_update(seek)
        self._play.on_update(begin)
        gui.add_command("Play or pause", hotkey="space").on_trigger(toggle)
        gui.add_command("A second back", hotkey="arrowleft").on_trigger(partial(self._step, -1.0))
        gui.add_command("A second on", hotkey="arrowright").on_trigger(partial(self._step, 1.0))
        self._add_plots()

    async def _step(self, dt: float, event: Any) -> None:
        self.go(self.time + dt)
        self._changed()

    def _add_plots(self) -> None:
        record, rover = self._record, self._subject.rover
        motion = None if record.twists is None else record.twists[:, [0, 2]]
        columns: list[tuple[str, Floats | None, tuple[str, ...]]] = [
            ("wheel speeds [rad/s]", record.wheel_speeds, rover.wheel_names),
            ("steering [rad]", record.steering, rover.steered_wheel_names),
            ("sliding [m/s]", record.slips, rover.wheel_names),
            ("vx [m/s], yaw rate [rad/s]", motion, ("vx", "omega")),
        ]
        *_, self._found = thin_columns(record.times, np.zeros((len(record.times), 1)), record.reasons)
        drawn = [
            (title, values, names) for title, values, names in columns if values is not None and len(names)
        ]
        if not drawn:
            return
        # Without a range viser's page shows the first second.
        longest = max(record.duration, 0.001)
        with self._server.gui.add_folder("Plots", expand_by_default=True):
            for title, values, names in drawn:
                times, thin, _, _ = thin_columns(record.times, values)
                inks: Any = [
                    {"label": name, "stroke": ink, "width": 1.2}
                    for name, ink in zip(names, INKS * 2, strict=False)
                ]
                series = ({"label": "t [s]"}, *inks, {"label": "now", "stroke": "#e85a5a", "width": 1.5})
                plot = self._server.gui.add_uplot(
                    _with_cursor(times, thin, 0.0), series, title=title, aspect=2.0,
                    scales={"x": {"time": False, "range": (0.0, longest)}}, legend={"show": False},
                    axes=({"stroke": "#9a9a9a"}, {"stroke": "#9a9a9a", "size": 44}),
                )  # fmt: skip
                self._cursors.append((plot, (times, thin)))

    def _add_paths(self) -> None:
        record, scene = self._record, self._server.scene
        self._line("/world/record/path", record.poses, DRIVEN)
        if self._subject.other is not None and (other := self._subject.other.record) is not None:
            self._line("/world/record/other", other.poses, OTHER)
        if record.truth is not None and record.truth.has_positions:
            self._line("/world/record/truth", record.truth.poses, TRUE)
        if record.covariances is not None:
            rows = np.unique(np.linspace(0, len(record.times) - 1, ELLIPSES).astype(int))
            rings = np.concatenate([self._ellipse(row) for row in rows])
            thick = 0.06 * self._subject.radius
            self._lines.append(
                scene.add_line_segments("/world/record/ellipses", rings, ELLIPSE, thickness=0.6 * thick)
            )
            self._now = scene.add_line_segments(
                "/world/record/ellipse", self._ellipse(0), ELLIPSE, thickness=thick
            )

    def _line(self, name: str, poses: Floats, color: tuple[int, int, int]) -> None:
        points = thin_path(np.asarray(poses)[:, :2])
        if len(points) < 2:
            return
        placed = self._placed(points)
        segments = np.stack([placed[:-1], placed[1:]], axis=1).astype(np.float32)
        thick = 0.12 * self._subject.radius
        self._lines.append(self._server.scene.add_line_segments(name, segments, color, thickness=thick))

    def _placed(self, points: Floats) -> Floats:
        up = [0.0, 0.0, 0.15 * self._subject.radius]
        placed: Floats = on_ground(self._subject, points) - self._subject.origin + up
        return placed

    def _ellipse(self, row: int) -> Any:
        """The ellipse of three sigmas around a pose, as segments (n, 2, 3)."""
        assert self._record.covariances is not None
        values, axes = np.linalg.eigh(np.nan_to_num(self._record.covariances[row]))
        t = np.linspace(0.0, math.tau, 33)
        circle = np.stack([np.cos(t), np.sin(t)], axis=-1) * SIGMAS * np.sqrt(np.maximum(values, 0.0))
        points = self._placed(np.nan_to_num(self._record.poses[row, :2]) + circle @ axes.T)
        return np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)


def _with_cursor(times: Floats, columns: Floats, now: float) -> tuple[Floats, ...]:
    """Columns over time with a last one that rises at a time, from the lowest to the highest of all.

    Numbers that are not known are 0: the plot has no gaps.
    """
    known = np.nan_to_num(columns)
    low, high = float(known.min()), float(known.max())
    k = min(int(np.searchsorted(times, now)), len(times) - 1)
    joined = np.concatenate([known[:k], np.repeat(known[k : k + 1], 3, axis=0), known[k:]])
    line = np.full(len(joined), low)
    line[k + 1] = high
    stamps = np.concatenate([times[:k], [now, now, now], times[k:]])
    return (np.maximum.accumulate(stamps), *joined.T, line)


def _spans(found: NDArray[np.uint32], duration: float, now: float, names: str) -> str:
    """A bar over time, coloured where something limited the motion, and what does so now."""
    count = min(SPANS, len(found))
    edges = np.linspace(0, len(found), count + 1).astype(int)
    limited = np.array([found[a:b].any() for a, b in pairwise(edges)])
    cells = "".join(
        f'<i style="flex:1;background:{"#d9a441" if each else "#4a4a50"}"></i>' for each in limited
    )
    share = 100.0 * now / max(duration, 1e-12)
    return (
        '<div style="padding:0 .9em;font:12px ui-monospace,monospace">'
        '<div style="position:relative;display:flex;'
        f'height:10px">{cells}<b style="position:absolute;left:{share:.2f}%;top:-2px;width:2px;height:14px;'
        f'background:#e85a5a"></b></div>{names.lower().replace("_", " ").replace("|", ", ")}</div>'
    )
