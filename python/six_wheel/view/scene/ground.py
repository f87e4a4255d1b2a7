"""A block cut out of a map around the rover, coloured by relief, slope, unevenness or where it may stand."""

from __future__ import annotations  # viser is loaded when a block is made

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Terrain
from six_wheel.kinematics.poses import Floats
from six_wheel.view.scene.glb import colored_glb
from six_wheel.view.scene.shapes import Mesh, add_mesh, merge, strip
from six_wheel.view.subject import Subject

if TYPE_CHECKING:
    import viser

COLORINGS = ("relief", "slope", "unevenness", "feasible")
POINTS = 200  # along an edge of the block
WIDTH = 6.0  # sizes of the rover that the block is wide
MOVES = 0.2  # of its width: farther from its middle, a new block is cut
JUDGED = 60  # places along an edge at which it is judged whether the rover may stand
STEEP = np.radians(35.0)
ROUGH = 0.5  # wheel radii of a height that differs from those around, the most that colours tell apart
RELIEF = np.array([[112, 66, 50], [168, 98, 70], [198, 124, 90], [222, 168, 130]], float)
RAMP = np.array([[38, 120, 142], [62, 174, 140], [214, 196, 82], [226, 112, 66], [160, 40, 60]], float)
FORBIDDEN, FREE = np.array([214.0, 84.0, 78.0]), np.array([52.0, 158.0, 142.0])


def cut(ground: Terrain, centre: Floats, width: float) -> tuple[Floats, float]:
    """Points (n, n, 3) of a square around a place, unknown heights NaN; and their spacing [m]."""
    spacing = max(min(ground.spacing), width / (POINTS - 1))
    count = max(2, min(POINTS, int(width / spacing) + 1))
    # On multiples of the spacing: cells stay where they are as the block follows the rover.
    first = np.round((centre - spacing * (count - 1) / 2.0) / spacing) * spacing
    x, y = (first[k] + spacing * np.arange(count) for k in (0, 1))
    places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    heights = np.asarray(ground.height_at(places))
    return np.concatenate([places, heights[..., None]], axis=-1), spacing


def colors(subject: Subject, points: Floats, coloring: str, yaw: float) -> NDArray[np.uint8]:
    """A colour (n, n, 3) for each of the points of a block."""
    ground = subject.ground
    assert ground is not None
    heights = points[..., 2]
    if coloring == "feasible" and subject.suspension is not None:
        steps = np.linspace(0, len(points) - 1, JUDGED).round().astype(int)
        poses = points[np.ix_(steps, steps)].copy()
        poses[..., 2] = yaw
        ok = np.asarray(subject.suspension.feasible(ground, poses.reshape(-1, 3)).ok).reshape(JUDGED, JUDGED)
        nearest = np.round(np.linspace(0, JUDGED - 1, len(points))).astype(int)
        fine = ok[np.ix_(nearest, nearest)]
        return np.where(fine[..., None], FREE, FORBIDDEN).astype(np.uint8)
    if coloring == "slope":
        gradient = np.asarray(ground.gradient_at(np.ascontiguousarray(points[..., :2])))
        share = np.arctan(np.hypot(gradient[..., 0], gradient[..., 1])) / STEEP
        return _ramp(share, RAMP)
    if coloring == "unevenness":
        around = np.stack([np.roll(heights, shift, axis) for shift in (-2, 2) for axis in (0, 1)])
        share = np.abs(heights - around.mean(axis=0)) / (ROUGH * subject.radius)
        return _ramp(share, RAMP)
    known = heights[np.isfinite(heights)]
    low, high = np.percentile(known, [2, 98]) if known.size else (0.0, 1.0)
    return _ramp((heights - low) / max(high - low, 1e-9), RELIEF)


def _ramp(share: Floats, ramp: Floats) -> NDArray[np.uint8]:
    places = np.clip(np.nan_to_num(share), 0.0, 1.0) * (len(ramp) - 1)
    return np.stack([np.interp(places, np.arange(len(ramp)), part) for part in ramp.T], -1).astype(np.uint8)


def triangles(points: Floats) -> NDArray[np.int64]:
    """Faces (m, 3) of a grid of points (n, n, 3), without those of cells with an unknown height."""
    rows, columns = points.shape[:2]
    i, k = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = i * columns + k
    corners = np.stack([a, a + columns, a + columns + 1, a + 1], axis=-1)
    known = np.isfinite(points[..., 2])
    whole = known[:-1, :-1] & known[1:, :-1] & known[1:, 1:] & known[:-1, 1:]
    corners = corners[whole]
    return np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])


class Block:
    """The node of the block, cut anew when the rover has left its middle."""

    def __init__(self, server: viser.ViserServer, subject: Subject) -> None:
        self._server, self._subject = server, subject
        self.width = WIDTH * subject.size
        self._shown: tuple[Any, ...] | None = None

    def show(self, pose: tuple[float, float, float], coloring: str) -> None:
        """Have the block around a pose."""
        if (ground := self._subject.ground) is None:
            return
        centre = np.array(pose[:2])
        heading = round(pose[2], 1) if coloring == "feasible" else 0.0
        if self._shown is not None:
            middle, *rest = self._shown
            if np.abs(centre - middle).max() < MOVES * self.width and rest == [coloring, heading]:
                return
        self._shown = (centre, coloring, heading)
        self._make(ground, centre, coloring, pose[2])

    def _make(self, ground: Terrain, centre: Floats, coloring: str, yaw: float) -> None:
        points, _ = cut(ground, centre, self.width)
        painted = colors(self._subject, points, coloring, yaw).reshape(-1, 3)
        origin = np.array([*centre, self._subject.origin[2]])
        place = tuple(origin - self._subject.origin)
        top = Mesh(np.nan_to_num(points - origin).reshape(-1, 3), triangles(points))
        if not len(top.faces):
            return
        places = np.ascontiguousarray(points[..., :2])
        normals = np.nan_to_num(ground.normal_at(places), nan=0.0).reshape(-1, 3)
        normals[~normals.any(axis=1)] = (0.0, 0.0, 1.0)
        walls = self._sides(points - origin)
        scene = self._server.scene
        with self._server.atomic():
            scene.add_glb(
                "/world/ground/top", colored_glb(top, painted, normals), position=place, cast_shadow=False
            )
            add_mesh(
                scene, "/world/ground/sides", walls,
                color=(84, 54, 44), flat_shading=True, side="double", cast_shadow=False, position=place,
            )  # fmt: skip

    def _sides(self, points: Floats) -> Mesh:
        """Walls from the edges down to a common bottom."""
        bottom = np.nanmin(points[..., 2]) - 0.5 * self._subject.radius if np.isfinite(points).any() else 0.0
        walls = []
        for edge in (points[0], points[-1], points[:, 0], points[:, -1]):
            top = edge[np.isfinite(edge[:, 2])]
            if len(top) > 1:
                walls.append(strip(top, np.column_stack([top[:, :2], np.full(len(top), bottom)])))
        return merge(walls) if walls else Mesh(np.zeros((3, 3)), np.zeros((1, 3), np.int64))
