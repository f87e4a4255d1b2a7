"""Grounds and rovers that tests share, and a slow search for gaps that shares nothing with the core."""

import math

import numpy as np

import six_wheel as sw

ROVERS = {
    name: sw.RockerBogie.preset(name) for name in ("rocky7", "perseverance", "curiosity", "open_source_rover")
}
LEVEL = ("perseverance", "curiosity")  # their wheel centres are level with all joints at 0


def hills(size=20.0, spacing=0.1):
    x = spacing * np.arange(round(size / spacing) + 1)
    X, Y = np.meshgrid(x, x)
    return 0.12 * np.sin(0.55 * X + 0.3) * np.cos(0.43 * Y) + 0.025 * np.sin(2.9 * X + 1.6 * Y)


def rocks(size=20.0, spacing=0.1, number=300, seed=0):
    """Hills strewn with half-buried balls."""
    generator = np.random.default_rng(seed)
    heights = hills(size, spacing)
    x = spacing * np.arange(len(heights))
    for _ in range(number):
        (cx, cy), radius = generator.uniform(0, size, 2), generator.uniform(0.1, 0.45)
        square = (x[None] - cx) ** 2 + (x[:, None] - cy) ** 2
        heights += np.sqrt(np.maximum(radius**2 - square, 0)) * (square < radius**2)
    return np.round(heights, 4)


def scaled(rover, size=1.0):
    """Size of a map for a rover, as a share of that for Perseverance."""
    return size * rover.dimensions["wheel_radius"] / 0.26288


def holes(size=20.0, spacing=0.1, number=60, seed=5):
    """Hills with pits whose walls are one cell wide."""
    generator = np.random.default_rng(seed)
    heights = hills(size, spacing)
    for _ in range(number):
        i, j = generator.integers(0, len(heights) - 12, 2)
        rows, columns = generator.integers(4, 12, 2)
        heights[i : i + rows, j : j + columns] -= generator.uniform(0.1, 1.2)
    return heights


def random_poses(count, size, margin, seed):
    generator = np.random.default_rng(seed)
    return np.column_stack(
        [generator.uniform(margin, size - margin, (count, 2)), generator.uniform(-math.pi, math.pi, count)]
    )


def turn(axis, angle):
    """Rotations about an axis, by any array of angles."""
    cos, sin, zero, unit = np.broadcast_arrays(np.cos(angle), np.sin(angle), 0.0, 1.0)
    rows = {
        "x": [unit, zero, zero, zero, cos, -sin, zero, sin, cos],
        "y": [cos, zero, sin, zero, unit, zero, -sin, zero, cos],
        "z": [cos, -sin, zero, sin, cos, zero, zero, zero, unit],
    }[axis]
    return np.stack(rows, -1).reshape(*np.shape(angle), 3, 3)


def rims(rover, pose, numbers, steering=None):
    """Centre, forward and upward axis of every wheel in the world, by rotation matrices written out.

    The last axis has the numbers; others are those of the poses.
    """
    of, pose, numbers = rover.dimensions, np.asarray(pose, float), np.asarray(numbers, float)
    body = turn("z", pose[..., 2]) @ turn("y", numbers[..., 2]) @ turn("x", numbers[..., 1])
    origin = np.concatenate([pose[..., :2], numbers[..., :1]], -1)
    steered = {"front": (0, 1), "corners": (0, 1, 4, 5), "all": range(6)}[of["steered"]]
    angles = np.zeros(len(steered)) if steering is None else np.asarray(steering, float)
    found = []
    for wheel in range(6):
        name, side = ("front", "middle", "rear")[wheel // 2], 1 - 2 * (wheel % 2)
        mirror = np.array([1, side, 1])
        axes = rocker = turn("y", side * numbers[..., 3])
        at = np.array(of["rocker_pivot"]) * mirror
        if f"rocker_to_{name}" in of:
            at = at + axes @ (np.array(of[f"rocker_to_{name}"]) * mirror)
        else:
            axes = rocker @ turn("y", numbers[..., 4 + wheel % 2])
            at = at + rocker @ (np.array(of["rocker_to_bogie"]) * mirror)
            at = at + axes @ (np.array(of[f"bogie_to_{name}"]) * mirror)
        axes = body @ axes
        if wheel in steered:
            axes = axes @ turn("z", angles[..., list(steered).index(wheel)])
        found.append((origin + (body @ at[..., None])[..., 0], axes[..., 0], axes[..., 2]))
    return found


def bilinear(heights, spacing, x, y):
    """Heights of a map that begins at the origin; NaN off it."""
    u, v = x / spacing, y / spacing
    inside = (u >= 0) & (v >= 0) & (u <= heights.shape[1] - 1) & (v <= heights.shape[0] - 1)
    i = np.clip(np.floor(u), 0, heights.shape[1] - 2).astype(int)
    j = np.clip(np.floor(v), 0, heights.shape[0] - 2).astype(int)
    a, b = u - i, v - j
    low = (1 - a) * heights[j, i] + a * heights[j, i + 1]
    high = (1 - a) * heights[j + 1, i] + a * heights[j + 1, i + 1]
    return np.where(inside, (1 - b) * low + b * high, np.nan)


def dense_gaps(rover, heights, spacing, pose, numbers, steering=None, samples=4001):
    """The six gaps by sampling the whole rim and a golden section about every low sample: good to 1e-12 m.

    The last axis has the wheels; others are those of the poses.
    """
    found, radius = [], rover.dimensions["wheel_radius"]
    t, golden = np.linspace(-math.pi, math.pi, samples), (math.sqrt(5) - 1) / 2
    for frames in rims(rover, pose, numbers, steering):
        wheels = [np.atleast_2d(vectors) for vectors in frames]

        def distance(t, centre, forward, up):
            p = [centre[k] + radius * (forward[k] * np.sin(t) - up[k] * np.cos(t)) for k in range(3)]
            return p[2] - bilinear(heights, spacing, p[0], p[1])

        sampled = distance(t, *(vectors.T[..., None] for vectors in wheels))
        inner = sampled[:, 1:-1]
        low = (inner <= sampled[:, :-2]) & (inner <= sampled[:, 2:])
        which, at = np.nonzero(low & (inner < sampled.min(-1, keepdims=True) + 0.01))
        before, after = t[at], t[at + 2]
        nearby = [vectors[which].T for vectors in wheels]
        for _ in range(45):
            a, b = after - golden * (after - before), before + golden * (after - before)
            left = distance(a, *nearby) < distance(b, *nearby)
            before, after = np.where(left, before, a), np.where(left, b, after)
        least = np.full(len(sampled), math.inf)
        np.minimum.at(least, which, distance(0.5 * (before + after), *nearby))
        found.append(least.reshape(np.shape(pose)[:-1]))
    return np.stack(found, -1)


def balance(rover, stand, k, pose, centre, wheel_share=0.01, step=1e-6):
    """Loads of the wheels that touch and moments of the stops, of the weight, by differences.

    Loads push straight up; a share of the weight acts in every wheel. Matrices are written out.
    """
    numbers, angles, radius = numbers_of(stand)[k], stand.contact_angles[k], rover.dimensions["wheel_radius"]

    def heights(numbers):
        wheels = rims(rover, pose, numbers)
        points = [
            centre + radius * (forward * math.sin(t) - up * math.cos(t))
            for (centre, forward, up), t in zip(wheels, angles, strict=True)
        ]
        body = turn("z", pose[2]) @ turn("y", numbers[2]) @ turn("x", numbers[1]) @ centre
        weight = (1 - 6 * wheel_share) * (numbers[0] + body[2])
        weight += wheel_share * sum(wheel[0][2] for wheel in wheels)
        return np.array([*(point[2] for point in points), weight])

    slopes = np.array([heights(numbers + d) - heights(numbers - d) for d in step * np.eye(6)]) / (2 * step)
    touching, stopped = stand.gap[k] < 1e-9, np.nonzero(stand.stops[k])[0]
    pushes = np.zeros((6, len(stopped)))
    for column, joint in enumerate(stopped):
        pushes[3 + joint, column] = -stand.stops[k, joint]
    found = np.linalg.solve(np.hstack([slopes[:, :6][:, touching], pushes]), slopes[:, 6])
    return np.split(found, [touching.sum()])


def numbers_of(stand):
    """z, roll, pitch and joints side by side."""
    return np.concatenate([np.stack([stand.z, stand.roll, stand.pitch], -1), stand.joints], axis=-1)
