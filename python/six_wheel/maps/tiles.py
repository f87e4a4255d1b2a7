"""One tile of a map: feasibility of the settled pose at every node and every heading."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import RockerBogie, Terrain
from six_wheel.kinematics.statuses import FeasibilityLimits, FeasibilityReason

REASONS = tuple(FeasibilityReason)
POSES = 1 << 16  # judged at a time: their numbers take 10 MB


@dataclass(frozen=True)
class Tile:
    """Heights around some cells, and what is asked about them."""

    rover: RockerBogie
    heights: NDArray[np.floating]  # rows along +y of the grid, columns along +x [m]
    spacing: tuple[float, float]  # [m]
    yaw: float  # of the grid in the frame of the map [rad]
    cells: tuple[slice, slice]  # rows and columns that are asked about
    headings: int
    limits: FeasibilityLimits
    map_error: float = 0.0  # [m]
    belly: tuple[float, float, float, float] | None = None


def reach(rover: RockerBogie) -> float:
    """From the origin to the farthest point that a rim can get to, at any attitude and joint angles [m]."""
    size = rover.dimensions
    vectors = {name: math.hypot(*value) for name, value in size.items() if "_to_" in name}
    to_bogie = vectors.pop("rocker_to_bogie")
    farthest = max(
        length + (to_bogie if name.startswith("bogie") else 0.0) for name, length in vectors.items()
    )
    return math.hypot(*size["rocker_pivot"]) + farthest + float(size["wheel_radius"])


def judge(tile: Tile) -> dict[str, NDArray[Any]]:
    """The layers of a tile.

    Returns
    -------
    dict of str to ndarray
        `safe`: share of the headings at which it may stand; `tilt`: the worst [rad], `clearance`: the least
        more than is asked for [m], over the headings about which anything is known, NaN without; `reason`:
        the most frequent reason why not, 0 where it may at all.
    """
    rows, columns = tile.cells
    shape = (rows.stop - rows.start, columns.stop - columns.start)
    layers = {
        "safe": np.zeros(shape, np.float32),
        "tilt": np.full(shape, np.nan, np.float32),
        "clearance": np.full(shape, np.nan, np.float32),
        "reason": np.full(shape, REASONS.index(FeasibilityReason.unknown_cells), np.uint8),
    }
    if np.isnan(tile.heights).all():
        return layers
    ground = Terrain(tile.heights, tile.spacing, (0.0, 0.0), tile.yaw)
    cos, sin = math.cos(tile.yaw), math.sin(tile.yaw)
    yaws = 2 * math.pi / tile.headings * np.arange(tile.headings)
    u = tile.spacing[0] * np.arange(columns.start, columns.stop)
    step = max(1, POSES // (tile.headings * shape[1]))
    for first in range(0, shape[0], step):
        some = slice(first, min(first + step, shape[0]))
        v = tile.spacing[1] * np.arange(rows.start + some.start, rows.start + some.stop)[:, None]
        poses = np.empty((v.shape[0], shape[1], tile.headings, 3))
        poses[..., 0] = (cos * u - sin * v)[..., None]
        poses[..., 1] = (sin * u + cos * v)[..., None]
        poses[..., 2] = yaws
        found = tile.rover.feasible(
            ground, poses, tile.limits, map_error=tile.map_error, belly=tile.belly, threads=1
        )
        layers["safe"][some] = np.mean(found.ok, axis=-1)
        layers["tilt"][some] = np.fmax.reduce(found.tilt, axis=-1)  # NaN left out
        layers["clearance"][some] = np.fmin.reduce(found.clearance, axis=-1) - tile.limits.clearance
        layers["reason"][some] = _frequent(found.reason_codes)
    return layers


def _frequent(codes: Any) -> NDArray[np.intp]:
    """The most frequent reason over the last axis but ``ok``, the first of several; 0 where there is none."""
    counts = np.stack([np.sum(codes == code, axis=-1) for code in range(1, len(REASONS))])
    most: NDArray[np.intp] = np.where(counts.any(axis=0), counts.argmax(axis=0) + 1, 0)
    return most
