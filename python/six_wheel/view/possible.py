"""The map of possible motions: a plane of twists, coloured by whether the rover can make them."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Limits, Rover
from six_wheel.kinematics.poses import Floats

WIDTH, HEIGHT = 302, 190  # [px]
CELL = 2  # [px] of a judged twist
PLANES = {"vx over yaw rate": (0, 2), "vy over yaw rate": (1, 2), "vx over vy": (0, 1)}
FREE, FAST, FORBIDDEN = 0, 1, 2
COLORS = ((38, 166, 158), (240, 200, 92), (226, 92, 88))
HATCH = (246, 164, 156)
INK, WHITE = (20, 22, 26), (255, 255, 255)


def verdicts(rover: Rover, limits: Limits, twists: Floats) -> NDArray[np.uint8]:
    """For twists (n, 3): `FREE`, `FAST` beyond a limit of speed, or `FORBIDDEN`, as wheels would slide."""
    possible = np.asarray(rover.admissible(twists))
    found = np.full(len(twists), FORBIDDEN, np.uint8)
    within = twists[possible]
    if len(within):
        _, speeds = rover.inverse(within)
        fast = np.abs(speeds).max(axis=1) > limits.wheel_speed
        fast |= np.hypot(within[:, 0], within[:, 1]) > limits.speed
        fast |= np.abs(within[:, 2]) > limits.yaw_rate
        found[possible] = np.where(fast, FAST, FREE)
    return found


def grid(
    plane: tuple[int, int], fixed: tuple[float, float, float], spans: tuple[float, float, float]
) -> Floats:
    """The twists (rows, columns, 3) of a plane: its first part grows upwards, its second to the left, as left
    turns go; the third is that of `fixed`."""
    up, across = plane
    rows, columns = HEIGHT // CELL, WIDTH // CELL
    twists = np.empty((rows, columns, 3))
    twists[:] = fixed
    twists[..., up] = np.linspace(spans[up], -spans[up], rows)[:, None]
    twists[..., across] = np.linspace(spans[across], -spans[across], columns)[None]
    return twists


def possible_image(
    rover: Rover,
    limits: Limits,
    commanded: Floats,
    driven: Floats,
    spans: tuple[float, float, float],
    plane: str,
) -> NDArray[np.uint8]:
    """The map as an image (rows, columns, 3): white is the commanded twist, black the one that is driven."""
    axes = PLANES[plane]
    (third,) = {0, 1, 2} - set(axes)
    fixed = [0.0, 0.0, 0.0]
    fixed[third] = float(commanded[third])
    image = _background(rover, limits, axes, (fixed[0], fixed[1], fixed[2]), spans).copy()
    for twist, color, size in ((commanded, WHITE, 6), (driven, INK, 4)):
        up, across = (float(twist[axis]) / spans[axis] for axis in axes)
        row = round((0.5 - 0.5 * up) * (HEIGHT - 1))
        column = round((0.5 - 0.5 * across) * (WIDTH - 1))
        row, column = min(max(row, size), HEIGHT - 1 - size), min(max(column, size), WIDTH - 1 - size)
        frame = INK if color == WHITE else WHITE
        image[row - size : row + size + 1, column - size : column + size + 1] = frame
        image[row - size + 2 : row + size - 1, column - size + 2 : column + size - 1] = color
    return image


@lru_cache(maxsize=8)
def _background(
    rover: Rover,
    limits: Limits,
    plane: tuple[int, int],
    fixed: tuple[float, float, float],
    spans: tuple[float, float, float],
) -> NDArray[np.uint8]:
    twists = grid(plane, fixed, spans)
    judged = verdicts(rover, limits, twists.reshape(-1, 3)).reshape(twists.shape[:2])
    judged = judged.repeat(CELL, axis=0).repeat(CELL, axis=1)
    image = np.array(COLORS, np.uint8)[judged]
    rows, columns = np.indices(judged.shape)
    hatched = (judged == FORBIDDEN) & ((rows + columns) % 9 < 4)
    image[hatched] = HATCH
    image[math.floor(HEIGHT / 2), :] = INK
    image[:, math.floor(WIDTH / 2)] = INK
    return image
