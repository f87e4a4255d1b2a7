"""Triangles: vertices (n, 3) [m] and the three of every face (m, 3)."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats

GROUSERS = 18  # of a tyre: so many that one sees it turn
SPOKES = 6


class Mesh(NamedTuple):
    """Vertices (n, 3) [m] and faces (m, 3)."""

    vertices: Floats
    faces: NDArray[Any]


def add_mesh(scene: Any, name: str, mesh: Mesh, **look: Any) -> Any:
    """Add a mesh to a scene of viser, in single precision; `look` as of `add_mesh_simple`."""
    return scene.add_mesh_simple(name, mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32), **look)


def merge(meshes: Sequence[Mesh]) -> Mesh:
    """Meshes as one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def move(mesh: Mesh, rotation: Floats, offset: Sequence[float] | Floats = (0.0, 0.0, 0.0)) -> Mesh:
    """A mesh, turned by a rotation (3, 3) and then moved."""
    return Mesh(mesh.vertices @ rotation.T + np.asarray(offset), mesh.faces)


def box(size: Sequence[float], centre: Sequence[float] = (0.0, 0.0, 0.0)) -> Mesh:
    """A box along the axes."""
    corners = np.array([[x, y, z] for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
    sides = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    faces = [each for a, b, c, d in sides for each in ((a, b, c), (a, c, d))]
    # Corners of their own for every side: a smooth shade would round the box.
    flat = (corners * size + centre)[np.array(faces).ravel()]
    return Mesh(flat, np.arange(len(flat)).reshape(-1, 3))


def cylinder(
    start: Sequence[float] | Floats, end: Sequence[float] | Floats, radius: float, sides: int = 12
) -> Mesh:
    """A closed cylinder between two points."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    along = end - start
    along = along / np.linalg.norm(along)
    across = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    across /= np.linalg.norm(across)
    t = np.linspace(0.0, math.tau, sides, endpoint=False)[:, None]
    ring = radius * (np.cos(t) * across + np.sin(t) * np.cross(along, across))
    k = np.arange(sides)
    after = (k + 1) % sides
    wall = np.concatenate(
        [np.stack([k, after, k + sides], 1), np.stack([after, after + sides, k + sides], 1)]
    )
    lids = np.concatenate(
        [np.stack([0 * k[2:], k[2:], k[1:-1]], 1), np.stack([0 * k[2:], k[1:-1], k[2:]], 1) + sides]
    )
    ends = np.concatenate([start + ring, end + ring])
    return Mesh(np.concatenate([ends, ends]), np.concatenate([wall, lids + 2 * sides]))


def tyre(radius: float, width: float, slant: float = 0.0) -> Mesh:
    """A tyre about +y with grousers; with a slant [rad], the angle of their axes to its own, with rollers."""
    inner = 0.9 * radius
    t = np.linspace(0.0, math.tau, 36, endpoint=False)
    profile = np.array([[0.72, 0.5], [0.97, 0.5], [1.0, 0.36], [1.0, -0.36], [0.97, -0.5], [0.72, -0.5]])
    rings = np.stack(
        [
            np.outer(np.sin(t), inner * profile[:, 0]),
            np.broadcast_to(width * profile[:, 1], (len(t), len(profile))),
            np.outer(np.cos(t), inner * profile[:, 0]),
        ],
        axis=-1,
    )
    i, k = np.meshgrid(np.arange(len(t)), np.arange(len(profile)), indexing="ij")
    a, b = i * len(profile) + k, (i + 1) % len(t) * len(profile) + k
    c, d = (
        i * len(profile) + (k + 1) % len(profile),
        (i + 1) % len(t) * len(profile) + (k + 1) % len(profile),
    )
    quads = np.stack([a, b, c, b, d, c], axis=-1).reshape(-1, 3)
    parts = [Mesh(rings.reshape(-1, 3), quads)]
    for angle in np.linspace(0.0, math.tau, GROUSERS, endpoint=False).tolist():
        bar = box((0.09 * radius, width * 1.02, 0.16 * radius))
        if slant:
            bar = move(bar, about_z(math.pi / 2 - slant))
        bar = move(bar, np.eye(3), (0.0, 0.0, 0.92 * radius))
        parts.append(move(bar, _about_y(angle)))
    return merge(parts)


def wheel_hub(radius: float, width: float) -> Mesh:
    """Hub and spokes of a wheel about +y."""
    parts = [cylinder((0.0, -0.42 * width, 0.0), (0.0, 0.42 * width, 0.0), 0.2 * radius, 16)]
    for angle in np.linspace(0.0, math.tau, SPOKES, endpoint=False).tolist():
        spoke = box((0.09 * radius, 0.3 * width, 0.6 * radius), (0.0, 0.0, 0.42 * radius))
        parts.append(move(spoke, _about_y(angle)))
    return merge(parts)


def arc(radius: float, low: float, high: float, width: float) -> Mesh:
    """A flat strip around the z axis between two angles from +x, seen from above."""
    t = np.linspace(low, high, 25)
    ring = np.stack([np.cos(t), np.sin(t), np.zeros_like(t)], axis=-1)
    return strip((radius + width / 2) * ring, (radius - width / 2) * ring)


def ribbon(points: Floats, width: float) -> Mesh:
    """A strip of a width along points (n, 3), level across its direction, seen from above."""
    along = np.gradient(points[:, :2], axis=0)
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    across = np.zeros_like(points)
    across[:, :2] = width / 2.0 * np.stack([-along[:, 1], along[:, 0]], axis=-1) / length
    return strip(points - across, points + across)


def strip(right: Floats, left: Floats) -> Mesh:
    """Triangles between two lines of as many points (n, 3), seen from where right is right."""
    k = np.arange(len(right) - 1)
    n = len(right)
    faces = np.concatenate([np.stack([k, k + 1, n + k], 1), np.stack([k + 1, n + k + 1, n + k], 1)])
    return Mesh(np.concatenate([right, left]), faces)


def nice_step(length: float) -> float:
    """1, 2 or 5 times a power of ten, the largest up to a length."""
    power = 10.0 ** math.floor(math.log10(length))
    return power * max(each for each in (1.0, 2.0, 5.0) if each * power <= length * (1.0 + 1e-12))


def _about_y(angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def about_z(angle: float) -> Floats:
    """Rotation (3, 3) about z by an angle [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
