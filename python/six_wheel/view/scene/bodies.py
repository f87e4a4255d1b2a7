"""The rover: links as tubes, wheels that one sees turn, a body of about its size."""

from __future__ import annotations  # viser is loaded when a scene is made

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel.kinematics.poses import Floats
from six_wheel.view.motion import Motion
from six_wheel.view.scene import shapes
from six_wheel.view.scene.meshes import robot_meshes
from six_wheel.view.subject import Subject

if TYPE_CHECKING:
    import viser

BLACK, METAL, COPPER = (34, 34, 38), (128, 124, 134), (176, 96, 62)
PANEL, LID, PALE = (150, 140, 158), (70, 66, 78), (228, 222, 205)
WIDTH = 0.75  # of a wheel in radii: a Rover does not know how wide its wheels are
FAN = 1.45  # radius of the fan of a steering range in wheel radii


def quaternions(rotations: Floats) -> Floats:
    """Quaternions w, x, y, z (..., 4) of rotations (..., 3, 3)."""
    from viser.transforms import SO3

    return np.asarray(SO3.from_matrix(np.ascontiguousarray(rotations)).wxyz)


ROOT = "/world/rover"  # name of the node
PALER = {"opacity": 0.35, "cast_shadow": False}  # look of a rover beside the one of the view


class Bodies:
    """Nodes of a rover, made once, its links placed by the frames of a motion, and then moved.

    `root` is the name of their node; a rover of another name than `ROOT` is drawn paler, without fans.
    """

    def __init__(self, server: viser.ViserServer, subject: Subject, motion: Motion, root: str = ROOT) -> None:
        self._scene, self._subject = server.scene, subject
        self._name, self._look = root, {} if root == ROOT else PALER
        self._root = server.scene.add_frame(root, show_axes=False)
        self._frames: dict[str, Any] = {}
        self.decoration: list[Any] = []
        self.remarks: list[str] = []
        drawn, self.remarks = robot_meshes(subject, motion)
        for name, parts in drawn.items():
            self._group(name, parts)
        for number, wheel in enumerate(subject.rover.wheels):
            if (name := f"wheel_{number}") not in drawn:
                width = WIDTH * wheel.radius
                tyre = shapes.tyre(wheel.radius, width, wheel.roller_angle or 0.0)
                self._group(name, [(tyre, BLACK), (shapes.wheel_hub(wheel.radius, width), COPPER)])
        if not drawn:
            if motion.frames:
                self._add_links(motion)
            self._add_body(motion)
        steered = [k for k, wheel in enumerate(subject.rover.wheels) if wheel.steered and root == ROOT]
        look = {"color": PALE, "opacity": 0.85, "cast_shadow": False, "receive_shadow": False}
        self._fans = {
            k: shapes.add_mesh(
                server.scene, f"{ROOT}/fan_{k}", self._arc(k, motion.state.steering_limit), **look
            )
            for k in steered
        }

    def show(self, motion: Motion) -> None:
        """Move what moved."""
        self._root.position = motion.transform[:3, 3] - self._subject.origin
        self._root.wxyz = quaternions(motion.transform[:3, :3])
        rolled = np.zeros(len(motion.wheels))
        rolled[: len(motion.state.rolled)] = motion.state.rolled
        c, s, zero = np.cos(rolled), np.sin(rolled), np.zeros_like(rolled)
        spin = np.stack([c, zero, s, zero, zero + 1.0, zero, -s, zero, c], axis=-1).reshape(-1, 3, 3)
        turned = motion.wheels.copy()
        turned[:, :3, :3] = turned[:, :3, :3] @ spin
        names = [f"wheel_{number}" for number in range(len(turned))]
        poses = dict(zip(names, turned, strict=True)) | motion.frames
        poses["body"] = np.eye(4)
        poses |= {f"knuckle_{number}": frame for number, frame in enumerate(motion.wheels)}
        wanted = [name for name in self._frames if name in poses]
        stacked = np.stack([poses[name] for name in wanted])
        for name, pose, wxyz in zip(wanted, stacked, quaternions(stacked[:, :3, :3]), strict=True):
            self._frames[name].position, self._frames[name].wxyz = pose[:3, 3], wxyz
        for number, fan in self._fans.items():
            frame = motion.straight[number]
            lift = 0.1 * self._subject.rover.wheels[number].radius  # there it is seen from all around
            fan.position, fan.wxyz = frame[:3, 3] + lift * frame[:3, 2], quaternions(frame[:3, :3])

    def set_steering_limit(self, limit: float | None) -> None:
        """Draw the fans as wide as the steering ranges with this limit are."""
        for number, fan in self._fans.items():
            fan.vertices = self._arc(number, limit).vertices.astype(np.float32)

    def show_fans(self, visible: bool) -> None:
        """Show or hide the fans."""
        for fan in self._fans.values():
            fan.visible = visible

    def _group(self, name: str, parts: list[tuple[shapes.Mesh, tuple[int, int, int]]]) -> list[Any]:
        """Meshes that move together: the first is the node that is moved, the others hang on it.

        Few nodes are made, for each costs a message to the thread of the server.
        """
        colors = dict.fromkeys(color for _, color in parts)
        joined = [(shapes.merge([mesh for mesh, c in parts if c == color]), color) for color in colors]
        first = self._frames[name] = self._add(name, *joined[0])
        return [first, *(self._add(f"{name}/{k}", *part) for k, part in enumerate(joined[1:]))]

    def _add(self, name: str, mesh: shapes.Mesh, color: tuple[int, int, int]) -> Any:
        # Large flat faces in the light of the sun would show the steps of their own shadow.
        shaded = color not in (PANEL, LID)
        return shapes.add_mesh(
            self._scene, f"{self._name}/{name}", mesh,
            color=color, flat_shading=True, side="double", receive_shadow=shaded, **self._look,
        )  # fmt: skip

    def _add_links(self, motion: Motion) -> None:
        """Tubes along the offsets of every link, in its own frame, in which its joint does not move them."""
        suspension = self._subject.suspension
        assert suspension is not None
        thick = 0.16 * self._subject.radius
        for link in suspension.links:
            if link.parent == "R":
                continue
            parent, child = motion.frames[link.parent], motion.frames[link.frame]
            # d is along the parent's z axis, about which the joint turns: then a, across it.
            along = parent @ np.array([0.0, 0.0, link.d, 1.0])
            corner = along if link.frame[0] != "A" else parent[:, 3]
            inside = np.linalg.inv(child)
            path = [(inside @ point)[:3] for point in (parent[:, 3], corner, child[:, 3])]
            parts = [
                shapes.cylinder(start, end, thick)
                for start, end in pairwise(path)
                if np.linalg.norm(end - start) > 1e-6
            ]
            if not parts:
                continue
            ball = shapes.cylinder(path[1] - [0.0, thick, 0.0], path[1] + [0.0, thick, 0.0], 1.25 * thick)
            self._group(link.frame, [(shapes.merge([*parts, ball]), METAL)])

    def _add_body(self, motion: Motion) -> None:
        """A box of about the body's size, or a plate for a rover without a suspension."""
        radius = self._subject.radius
        places = motion.straight[:, :3, 3]
        low, high = places[:, :2].min(axis=0), places[:, :2].max(axis=0)
        suspension = self._subject.suspension
        if suspension is None:
            length, breadth = np.maximum(high - low, 2.2 * radius).tolist()
            centre = (high + low) / 2.0
            size = (length + 0.7 * radius, max(breadth - 1.1 * radius, 1.2 * radius), 0.35 * radius)
            middle = (centre[0], centre[1], 1.55 * radius)
            plates = [(size, middle, PANEL), self._lid(size, middle)]
            columns = [  # about which the wheels steer
                shapes.cylinder([x, y, 1.05 * radius], [x, y, 1.75 * radius], 0.24 * radius)
                for x, y in ((wheel.x, wheel.y) for wheel in self._subject.rover.wheels if wheel.steered)
            ]
        else:
            pivot = np.array(suspension.dimensions["rocker_pivot"])
            size = (0.66 * float(high[0] - low[0]), 1.7 * abs(float(pivot[1])), 1.5 * radius)
            middle = (float(high[0] + low[0]) / 2.0, 0.0, float(pivot[2]) + 0.55 * radius)
            plates = [(size, middle, PANEL), self._lid(size, middle), *self._mast(size, middle)]
            columns = []
        length = size[0]
        nose = (
            (0.06 * length, 0.9 * size[1], 0.4 * size[2]),
            (middle[0] + 0.5 * length, middle[1], middle[2]),
        )
        parts = [(shapes.box(extent, place), color) for extent, place, color in [*plates, (*nose, COPPER)]]
        self.decoration = self._group("body", [*parts, *((column, METAL) for column in columns)])

    def _lid(self, size: Any, middle: Any) -> tuple[Any, Any, tuple[int, int, int]]:
        thick = 0.12 * size[2]
        top = (middle[0], middle[1], middle[2] + size[2] / 2.0 + thick / 2.0)
        return (1.02 * size[0], 1.02 * size[1], thick), top, LID

    def _mast(self, size: Any, middle: Any) -> list[tuple[Any, Any, tuple[int, int, int]]]:
        """A mast with a camera at the right front corner."""
        radius = self._subject.radius
        x, y = middle[0] + 0.38 * size[0], middle[1] - 0.3 * size[1]
        top = middle[2] + size[2] / 2.0 + 2.3 * radius
        pole = (0.2 * radius, 0.2 * radius, 2.3 * radius)
        head = (0.5 * radius, 1.1 * radius, 0.6 * radius)
        eye = (0.06 * radius, 0.26 * radius, 0.26 * radius)
        return [
            (pole, (x, y, top - 1.15 * radius), METAL),
            (head, (x, y, top + 0.2 * radius), PALE),
            (eye, (x + 0.27 * radius, y - 0.28 * radius, top + 0.2 * radius), BLACK),
            (eye, (x + 0.27 * radius, y + 0.28 * radius, top + 0.2 * radius), BLACK),
        ]

    def _arc(self, number: int, limit: float | None) -> shapes.Mesh:
        wheel = self._subject.rover.wheels[number]
        low, high = wheel.steering_range or (-np.pi / 2, np.pi / 2)
        limit = np.pi if limit is None else limit
        low, high = max(low, -limit), min(high, limit)
        return shapes.arc(FAN * wheel.radius, low, high, 0.16 * wheel.radius)
