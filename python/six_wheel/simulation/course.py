"""Desired motion of a simulated rover: stamps and twists, from commands or from a path."""

import reprlib
from dataclasses import dataclass, field
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import Rover, differentiate
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.kinematics.poses import Floats

# A turn in place counts as this many metres a radian where a path has no other measure.
LEVER = 0.5


@dataclass(frozen=True, eq=False)
class Course:
    """Twists `twists` (n, 3) at `stamps` (n,) [s]; between them the twist changes evenly.

    A path of poses begins at `first` (3,) [m, m, rad], commands at the origin.
    """

    stamps: Floats
    twists: Floats
    first: Floats = field(default_factory=lambda: np.zeros(3))

    def begin(self, start: ArrayLike | None) -> Floats:
        """The first pose (3,) [m, m, rad]: the one asked for, or its own. Raises `ValueError` if it is not
        three finite numbers."""
        if start is None:
            return self.first
        first = np.array(start, dtype=np.float64)
        if first.shape != (3,) or not np.isfinite(first).all():
            raise ValueError(f"start must be three finite numbers, got {start}")
        return first

    def at(self, stamps: Floats) -> Floats:
        """Twists at other times, (m, 3)."""
        columns = [np.interp(stamps, self.stamps, column) for column in self.twists.T]
        return np.stack(columns, axis=-1)


def read_course(path: object, rover: Rover, speed: float) -> Course:
    """Convert the path or commands given to `simulate` into a `Course` of the nearest twists that a rover can
    make.

    `path` is a pair of stamps (n,) [s] and twists (n, 3); rows ``[time, vx, vy, omega]`` (n, 4), whose twist
    changes evenly from row to row; or poses (n, 3), which are driven through one after another at a speed
    [m/s], each on one arc. Raises `ValueError` if it is none of these, a number is not finite or time does
    not go on.
    """
    if isinstance(path, tuple) and len(path) == 2 and np.ndim(path[1]) == 2:
        stamps, twists = _table("stamps", path[0], 1), _table("twists", path[1], 2)
    else:
        rows = _table("path", path, 2)  # type: ignore[arg-type]
        if rows.shape[1] == 4:
            stamps, twists = rows[:, 0], rows[:, 1:]
        elif rows.shape[1] == 3:
            return _through(rows, rover, speed)
        else:
            raise ValueError(
                "path must be rows of time, vx, vy, omega (n, 4), poses (n, 3) or a pair of stamps "
                f"and twists, got shape {rows.shape}"
            )
    if twists.shape[1:] != (3,) or len(stamps) != len(twists) or len(stamps) < 2:
        raise ValueError(f"path must have n >= 2 stamps and twists (n, 3), got {len(stamps)}, {twists.shape}")
    if not (np.diff(stamps) > 0.0).all():
        row = int(np.argmin(np.diff(stamps) > 0.0)) + 1
        raise ValueError(f"path must go on in time, got {stamps[row]} after {stamps[row - 1]} in row {row}")
    return Course(stamps, rover.project(twists, keep="nearest"))


def _table(name: str, values: ArrayLike, axes: int) -> Floats:
    try:
        table = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        table = np.empty(())
    if table.ndim == 0:
        read = isinstance(values, str | PathLike)
        hint = "; `six-wheel simulate` reads files, numpy.loadtxt makes rows of one" if read else ""
        got = reprlib.repr(values)
        raise ArgumentTypeError(f"{name} must be rows of as many numbers each, got {got}{hint}")
    if table.ndim != axes or not len(table):
        raise ValueError(f"{name} must have {axes} axes and a row at least, got shape {table.shape}")
    if not np.isfinite(table).all():
        raise ValueError(f"{name} must be finite, got {table[~np.isfinite(table)][0]}")
    return table


def _through(poses: Floats, rover: Rover, speed: float) -> Course:
    """Arcs from pose to pose at a speed, a turn in place slow enough for it."""
    if not (np.isfinite(speed) and speed > 0.0):
        raise ValueError(f"speed must be finite and positive, got {speed}")
    if len(poses) < 2:
        raise ValueError(f"path must have two poses or more, got {len(poses)}")
    arcs = differentiate(poses, 1.0)
    ways = np.hypot(np.hypot(arcs[:, 0], arcs[:, 1]), LEVER * arcs[:, 2])
    moving = ways > 0.0
    if not moving.any():
        raise ValueError("path must move, got the same pose all along")
    arcs, times = arcs[moving], ways[moving] / speed
    ends = np.cumsum(times)
    twists = rover.project(arcs / times[:, None], keep="nearest")
    # Held over every arc: two rows, a moment apart from the arcs beside it.
    apart = 1e-6 * times
    stamps = np.stack((ends - times + apart, ends - apart), axis=-1).ravel()
    stamps[0] = 0.0
    return Course(stamps, np.repeat(twists, 2, axis=0), poses[0])
