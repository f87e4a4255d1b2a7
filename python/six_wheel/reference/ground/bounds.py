"""Bounds of how a rocker-bogie stands, in plain NumPy: boxes are looked at densely, every corner is tried.

Symbols are those of the closed form: heights of wheel centres, divided by cos(g) and freed of what lateral
places add, make each side a planar chain (g is the inclination of the body's y axis).
"""

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.ground.terrain import Terrain
from six_wheel.reference.planar.geometry import Floats

WITHIN = (math.radians(15), math.radians(7), math.radians(17))  # roll and pitch, rocker, bogie


def _arms(size: Mapping[str, Any]) -> tuple[Floats, Floats, Floats, Floats, Floats, bool]:
    """Pivot, to the rocker's wheel, to the bogie, and from it ahead and behind; whether it is in front."""
    names = ["rocker_pivot", "rocker_to_front", "rocker_to_bogie", "bogie_to_middle", "bogie_to_rear"]
    if in_front := size.get("bogie_to_front") is not None:
        names = ["rocker_pivot", "rocker_to_rear", "rocker_to_bogie", "bogie_to_front", "bogie_to_middle"]
    pivot, wheel, joint, ahead, behind = (np.asarray(size[name], float) for name in names)
    return pivot, wheel, joint, ahead, behind, in_front


def _turned(v: Floats, angle: float) -> Floats:
    """A vector turned about +y."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([v[0] * cos + v[2] * sin, v[1], v[2] * cos - v[0] * sin])


def boxes(size: Mapping[str, Any], steps: int = 7) -> Floats:
    """Boxes of the left wheels seen from above in the heading's frame, by sampling, so never too large.

    Rows ``x_min, x_max, y_min, y_max`` [m] of the rocker's wheel, the bogie's ahead and behind: (3, 4).
    """
    pivot, wheel, joint, ahead, behind, _ = _arms(size)
    tilt, rocker, bogie = (np.linspace(-limit, limit, steps) for limit in WITHIN)
    found = np.tile([math.inf, -math.inf, math.inf, -math.inf], (3, 1))
    for rho, beta in itertools.product(rocker, bogie):
        at_joint = pivot + _turned(joint, rho)
        centres = [pivot + _turned(wheel, rho), *(at_joint + _turned(v, rho + beta) for v in (ahead, behind))]
        for roll, pitch in itertools.product(tilt, tilt):
            for k, (x, y, z) in enumerate(centres):
                up = y * math.sin(roll) + z * math.cos(roll)
                place = (x * math.cos(pitch) + up * math.sin(pitch), y * math.cos(roll) - z * math.sin(roll))
                axle = (math.sin(roll) * math.sin(pitch), math.cos(roll))
                for axis in (0, 1):
                    reach = size["wheel_radius"] * math.sqrt(1 - axle[axis] ** 2)
                    found[k, 2 * axis] = min(found[k, 2 * axis], place[axis] - reach)
                    found[k, 2 * axis + 1] = max(found[k, 2 * axis + 1], place[axis] + reach)
    return found


def _extremes(ground: Terrain, pose: Floats, box: Floats) -> tuple[float, float]:
    """Lowest and highest of a grid of points of the box; NaN where one is not known."""
    x, y, yaw = pose
    cos, sin = math.cos(yaw), math.sin(yaw)
    u, v = np.meshgrid(np.linspace(box[0], box[1], 25), np.linspace(box[2], box[3], 25))
    points = np.stack([x + cos * u - sin * v, y + sin * u + cos * v], axis=-1).reshape(-1, 2)
    heights = ground.height_at(points)
    return float(np.min(heights)), float(np.max(heights))


def _side(arms: tuple[Floats, ...], in_front: bool, e: tuple[float, ...]) -> tuple[float, float, float]:
    """Height of D, angle of the rocker and of the bogie, from the heights of its three wheels."""
    wheel, joint, ahead, behind = arms

    def lever(front: Floats, back: Floats, rise: float) -> float:
        w = front - back
        return math.atan2(w[2], w[0]) - math.asin(rise / math.hypot(w[0], w[2]))

    single, first, second = e
    bogie = lever(ahead, behind, first - second)
    at_joint = first - _turned(ahead, bogie)[2]
    rocker = lever(joint, wheel, at_joint - single) if in_front else lever(wheel, joint, single - at_joint)
    return single - _turned(wheel, rocker)[2], rocker, bogie - rocker


def bounds(
    ground: Terrain, size: Mapping[str, Any], pose: ArrayLike, patches: Floats
) -> dict[str, Floats] | None:
    """Intervals of ``roll``, ``pitch``, ``rocker``, ``bogies``; None where a corner has no solution.

    `size` are the dimensions of a rocker-bogie with a gear as differential, `patches` its `boxes`.
    """
    at = np.asarray(pose, float)
    *arms, in_front = _arms(size)
    pivot, wheel, joint, ahead, behind = arms
    lateral = pivot[1] + np.array([wheel[1], joint[1] + ahead[1], joint[1] + behind[1]])
    least = lateral.min()
    mirrored = patches * [1, 1, 0, 0] + patches[:, [0, 1, 3, 2]] * [0, 0, -1, -1]
    spans = [[_extremes(ground, at, box) for box in side] for side in (patches, mirrored)]
    if np.isnan(spans).any():
        return None
    low, high = -math.radians(30), math.radians(30)
    try:
        for _ in range(4):
            gs = np.linspace(low, high, 9)  # every height is monotone or nearly so in between
            sides: list[list[tuple[float, float, float]]] = []
            for sign, side in zip((1, -1), spans, strict=True):
                ends = []
                for span, y in zip(side, lateral, strict=True):
                    reduced = [
                        z / math.cos(g) + size["wheel_radius"] - sign * math.tan(g) * (y - least)
                        for z in span
                        for g in gs
                    ]
                    ends.append((min(reduced), max(reduced)))
                sides.append([_side(tuple(arms[1:]), in_front, e) for e in itertools.product(*ends)])
            heights = [[corner[0] for corner in side] for side in sides]
            tan = [
                (min(heights[0]) - max(heights[1])) / (2 * least),
                (max(heights[0]) - min(heights[1])) / (2 * least),
            ]
            low, high = max(low, math.atan(tan[0])), min(high, math.atan(tan[1]))
            if low > high:
                return None
    except ValueError:  # of an arc sine
        return None
    rockers = [[corner[1] for corner in side] for side in sides]
    bogies = np.array([(min(c[2] for c in side), max(c[2] for c in side)) for side in sides])
    left, right = ((min(angles), max(angles)) for angles in rockers)
    lean = np.linspace((left[0] + right[0]) / 2, (left[1] + right[1]) / 2, 33)[:, None]
    g = np.linspace(low, high, 33)
    pitch = np.arcsin(np.sin(lean) * np.cos(g))
    roll = np.arcsin(np.sin(g) / np.cos(pitch))
    return {
        "roll": np.array([roll.min(), roll.max()]),
        "pitch": np.array([pitch.min(), pitch.max()]),
        "rocker": np.array([(left[0] - right[1]) / 2, (left[1] - right[0]) / 2]),
        "bogies": bogies,
    }
