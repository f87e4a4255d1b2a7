"""A map in words."""

import math

import numpy as np

from six_wheel._core import Terrain


def map_facts(ground: Terrain, description: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """Rows on a map: its form, cells, extent, heights, slopes, unknown cells, units and coordinate system."""
    heights = np.asarray(ground.heights)
    (rows, columns), (dx, dy), (x, y) = ground.shape, ground.spacing, ground.origin
    known = heights[~np.isnan(heights)]
    share = 1.0 - known.size / heights.size
    across, along = np.gradient(heights, dy, dx)
    slopes = np.degrees(np.arctan(np.hypot(along, across)))
    slopes = slopes[~np.isnan(slopes)]
    turned = f", turned by {math.degrees(ground.yaw):.6g} degrees" if ground.yaw else ""
    facts = [
        description[0],
        ("cells", f"{rows} x {columns} of {dx:.6g} x {dy:.6g} m, in {heights.dtype}"),
        ("extent", f"{dx * (columns - 1):.6g} m along x, {dy * (rows - 1):.6g} m along y{turned}"),
        ("first node", f"x {x:.12g}, y {y:.12g}, heights[0, 0], the southern end"),
    ]
    if known.size:
        facts.append(
            ("heights", f"{known.min():.6g} to {known.max():.6g} m, median {np.median(known):.6g} m")
        )
    if slopes.size:
        steep = np.percentile(slopes, 99)
        facts.append(("slopes", f"median {np.median(slopes):.3g}, 99 % below {steep:.3g} degrees"))
    facts.append(("unknown", f"{share:.2%} of the cells"))
    return [*facts, *description[1:]]
