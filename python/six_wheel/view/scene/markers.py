"""Motion drawn: arrows of the wheels, their axes meeting in the centre of rotation, the path ahead."""

from __future__ import annotations  # viser is loaded when a scene is made

from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel.kinematics.poses import Floats
from six_wheel.view.motion import Motion, on_ground, path_ahead
from six_wheel.view.scene import shapes
from six_wheel.view.subject import Subject

if TYPE_CHECKING:
    import viser

TEAL, AMBER, RED = (26, 168, 178), (255, 201, 74), (232, 70, 70)
FARTHEST = 12.0  # sizes of the rover up to which a centre of rotation is drawn


class Markers:
    """Nodes of a motion, made once and then changed."""

    def __init__(self, server: viser.ViserServer, subject: Subject, motion: Motion) -> None:
        self._subject, scene = subject, server.scene
        radius, count = subject.radius, len(subject.rover.wheels)
        self._arrows = scene.add_arrows(
            "/world/motion/speeds", np.zeros((count, 2, 3)), TEAL, shaft_radius=0.1 * radius,
            head_radius=0.25 * radius, head_length=0.45 * radius,
        )  # fmt: skip
        self._axes = scene.add_line_segments(
            "/world/motion/axes", np.zeros((count, 2, 3)), AMBER, thickness=0.035 * radius
        )
        self._post = scene.add_frame("/world/motion/icr", show_axes=False)
        tall = 0.85 * subject.size
        post = shapes.cylinder((0.0, 0.0, -0.2 * tall), (0.0, 0.0, tall), 0.055 * radius)
        ring = shapes.cylinder((0.0, 0.0, tall), (0.0, 0.0, tall + 0.06 * radius), 0.35 * radius, 24)
        mesh = shapes.merge([post, ring])
        shapes.add_mesh(scene, "/world/motion/icr/post", mesh, color=AMBER, flat_shading=True, side="double")
        self._label = scene.add_label(
            "/world/motion/icr/label", "R", position=(0.0, 0.0, tall + 0.5 * radius), anchor="bottom-center"
        )
        self._ribbons = [self._ribbon(scene, number, motion) for number in range(count)]
        self._commanded = scene.add_line_segments(
            "/world/motion/commanded", np.zeros((1, 2, 3)), RED, thickness=0.09 * radius, visible=False
        )
        self.visible = dict.fromkeys(("arrows", "centre", "ahead"), True)

    def show(self, motion: Motion, paths: bool = True) -> None:
        """Draw a motion; without `paths` what lies ahead stays as it was."""
        radius, subject = self._subject.radius, self._subject
        world = motion.transform @ motion.wheels
        hubs = world[:, :3, 3] - subject.origin
        lift = motion.transform[:3, 2] * radius * 1.2
        rims = np.array([wheel.radius for wheel in subject.rover.wheels]) * motion.wheel_speeds
        longest = subject.radius * max(motion.state.wheel_speed, 1e-12)
        ends = hubs + world[:, :3, 0] * (4.0 * subject.radius * rims / longest)[:, None]
        arrows = np.stack([hubs, ends], axis=1)
        arrows[:, 1] += np.where(np.abs(rims) > 1e-9 * longest, 0.0, 1e-6)[:, None]
        self._arrows.visible = self.visible["arrows"] and bool(motion.twist.any())
        self._arrows.points = arrows.astype(np.float32)
        self._show_centre(motion, hubs, lift)
        if paths:
            self._show_ahead(motion)

    def _show_centre(self, motion: Motion, hubs: Floats, lift: Floats) -> None:
        icr, subject = motion.icr, self._subject
        near = bool(np.isfinite(icr).all()) and float(np.hypot(*icr)) < FARTHEST * subject.size
        near = near and bool(motion.twist[2])
        shown = near and self.visible["centre"]
        for node in (self._axes, self._post):
            node.visible = shown
        if not shown:
            return
        # At the height of the wheels: the axes of level wheels meet there.
        place = motion.transform @ np.array([*icr, 0.0, 1.0])
        place = place[:3] + lift / 1.2
        target = place - subject.origin
        self._axes.points = np.stack([hubs, np.broadcast_to(target, hubs.shape)], axis=1).astype(np.float32)
        foot = on_ground(subject, place[None])[0]
        self._post.position = foot - subject.origin
        self._label.text = f"R {np.hypot(*icr):.2f} m"

    def _show_ahead(self, motion: Motion) -> None:
        subject = self._subject
        moving = bool(motion.twist.any()) and motion.stands and self.visible["ahead"]
        if moving:
            _, places = path_ahead(subject, motion, motion.twist)
            for number, (handle, points) in enumerate(zip(self._ribbons, places, strict=True)):
                handle.vertices = self._strip(number, points)
        for handle in self._ribbons:
            handle.visible = moving
        other = not motion.possible and motion.stands and self.visible["ahead"]
        if other:
            poses, _ = path_ahead(subject, motion, motion.state.twist)
            line = on_ground(subject, poses) - subject.origin + [0.0, 0.0, 0.25 * subject.radius]
            # Dashes as long as the gaps between them.
            self._commanded.points = np.stack([line[:-1:2], line[1::2]], axis=1).astype(np.float32)
        self._commanded.visible = other

    def _strip(self, number: int, points: Floats) -> Floats:
        # Wheels follow each other: one strip above the other, or they flicker.
        radius = self._subject.radius
        lifted = points - self._subject.origin + [0.0, 0.0, (0.1 + 0.016 * number) * radius]
        return shapes.ribbon(lifted, 0.45 * radius).vertices.astype(np.float32)

    def _ribbon(self, scene: Any, number: int, motion: Motion) -> Any:
        _, places = path_ahead(self._subject, motion, (self._subject.top_speed, 0.0, 0.0))
        mesh = shapes.ribbon(places[number], 0.45 * self._subject.radius)
        return shapes.add_mesh(
            scene, f"/world/motion/track_{number}", mesh,
            color=TEAL, opacity=0.8, cast_shadow=False, visible=False,
        )  # fmt: skip
