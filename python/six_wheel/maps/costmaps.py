"""Costs of occupancy: grids of ROS messages, and maps as nav2 saves them, with inflation."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
import re
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Costmap, compose
from six_wheel.kinematics.errors import FileError, as_path, needed, one_line, shown
from six_wheel.kinematics.objects.checked_values import is_number
from six_wheel.robot_description.missing_files import near_file

Floats = NDArray[np.float64]
UNKNOWN, LETHAL = 0.5, 0.65
"""Cost of what is not known; cost from which on a place is forbidden, which is nav2's ``occupied_thresh``."""
_WORD = re.compile(
    rb"(?:\s|#[^\n]*(?:\n|\Z))*+([^\s#]\S*)"
)  # of the header of a PGM, behind blanks and comments


def from_occupancy_grid(
    msg: Any, *, inflation: float = 0.0, unknown: float = UNKNOWN, lethal: float = LETHAL
) -> Costmap:
    """See `Costmap.from_occupancy_grid`."""
    info = getattr(msg, "info", None)
    if info is None or not hasattr(msg, "data"):
        raise ValueError(
            f"msg must have info and data, as nav_msgs/OccupancyGrid, got a {type(msg).__name__}"
        )
    rows, columns = int(info.height), int(info.width)
    data = np.asarray(msg.data)
    if data.size != rows * columns:
        raise ValueError(f"msg.data must hold height x width, {rows} x {columns}, cells, got {data.size}")
    place, turn = info.origin.position, info.origin.orientation
    if math.hypot(float(turn.x), float(turn.y)) > 1e-6:
        raise ValueError("msg.info.origin must turn about z alone, got an orientation that is tilted")
    yaw = math.remainder(2.0 * math.atan2(float(turn.z), float(turn.w)), 2.0 * math.pi)
    percent = data.astype(np.int64).reshape(rows, columns)
    occupancy = np.where((percent < 0) | (percent > 100), math.nan, percent / 100.0)
    frame = getattr(getattr(msg, "header", None), "frame_id", None) or None
    corner = (float(place.x), float(place.y), yaw)
    return _costmap(occupancy, float(info.resolution), corner, inflation, unknown, lethal, frame)


def read_costmap(
    path: str | PathLike[str],
    *,
    inflation: float = 0.0,
    unknown: float = UNKNOWN,
    lethal: float | None = None,
) -> Costmap:
    """See `Costmap.read`."""
    file = as_path("path", path)
    with needed("six-wheel[cli]", "maps of nav2 need"):
        import yaml
    try:
        keys = yaml.safe_load(_content(file).decode())
    except RecursionError:
        raise FileError(f"{file}: must be YAML, its brackets are nested too deep") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise FileError(f"{file}: must be YAML, got {str(error).splitlines()[0]}") from None
    missing = [
        key for key in ("image", "resolution", "origin") if not isinstance(keys, dict) or key not in keys
    ]
    if missing:
        raise FileError(f"{file}: must have {', '.join(missing)}, as nav2's map files")
    origin = keys["origin"] if isinstance(keys["origin"], list) else [keys["origin"]]
    if len(origin) != 3:
        raise FileError(f"{file}: origin must be three numbers, got {keys['origin']!r}")
    x, y, yaw = (_number(file, "origin", value) for value in origin)
    shade = _image(file.parent / str(keys["image"]))
    share = shade if keys.get("negate", 0) else 1.0 - shade
    occupied = _number(file, "occupied_thresh", keys.get("occupied_thresh", LETHAL))
    free = _number(file, "free_thresh", keys.get("free_thresh", 0.25))
    if keys.get("mode", "trinary") == "trinary":
        between = np.where(share < free, 0.0, math.nan)
        share = np.where(share > occupied, 1.0, between)
    forbidden = occupied if lethal is None else lethal
    return _costmap(
        share[::-1],
        _number(file, "resolution", keys["resolution"]),
        (x, y, yaw),
        inflation,
        unknown,
        forbidden,
        None,
    )


def _number(file: Path, key: str, value: object) -> float:
    """A value of a map file that has to be a finite number."""
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise FileError(f"{file}: {key} must be a finite number, got {value!r}")
    return number


def inflated(costs: Floats, lethal: float, spacing: float, inflation: float) -> Floats:
    """Costs with those around obstacles: they fall linearly from `lethal` to 0 over `inflation` [m].

    The distance to the nearest cell of at least `lethal` is exact up to that radius: the largest of the costs
    of all obstacles within it, one shift of the grid for every cell of the disc.
    """
    reach = math.floor(inflation / spacing)
    obstacles = costs >= lethal
    result = costs.copy()
    rows, columns = costs.shape
    for down in range(-min(reach, rows - 1), min(reach, rows - 1) + 1):
        for right in range(-min(reach, columns - 1), min(reach, columns - 1) + 1):
            distance = spacing * math.hypot(down, right)
            if not 0.0 < distance < inflation:
                continue
            target = result[max(down, 0) : rows + min(down, 0), max(right, 0) : columns + min(right, 0)]
            source = obstacles[
                max(-down, 0) : rows + min(-down, 0), max(-right, 0) : columns + min(-right, 0)
            ]
            np.maximum(target, lethal * (1.0 - distance / inflation), out=target, where=source)
    return result


def _costmap(
    occupancy: Floats,
    resolution: float,
    corner: tuple[float, float, float],  # x, y, yaw [m, m, rad]
    inflation: float,
    unknown: float,
    lethal: float,
    frame: str | None,
) -> Costmap:
    """The costmap of an occupancy, NaN where it is not known, and the pose of its first corner."""
    for name, value in (("inflation", inflation), ("unknown", unknown), ("lethal", lethal)):
        if not (is_number(value) and math.isfinite(value) and value >= 0.0):
            got = value if is_number(value) else shown(value)
            raise ValueError(f"{name} must be finite and not negative, got {got}")
    costs = np.where(np.isnan(occupancy), unknown, occupancy)
    costs = inflated(costs, lethal, resolution, inflation)
    # A cell of a grid of ROS is a square of which the origin is the corner; here it is a point in its middle.
    middle = compose(corner, (resolution / 2.0, resolution / 2.0, 0.0))
    return Costmap(costs, resolution, middle[:2], corner[2], lethal=lethal, frame=frame)


def _content(path: Path) -> bytes:
    """Bytes of a file. Fails where it is none."""
    if path.is_dir():
        raise FileError(f"{path} must be a file, it is a folder")
    if not path.exists():
        raise FileNotFoundError(f"{path} must be a file, there is none{near_file(path)}")
    return path.read_bytes()


def _image(path: Path) -> Floats:
    """Shades of an image from 0, black, to 1."""
    content = _content(path)
    if content[:2] in (b"P2", b"P5"):
        return _pgm(path, content)
    try:
        from PIL import Image
    except ModuleNotFoundError:
        raise FileError(f"{path}: must be a PGM (other images need Pillow: pip install pillow)") from None
    try:
        with Image.open(path) as image:
            return np.asarray(image.convert("L"), dtype=float) / 255.0
    except MemoryError:
        raise
    except Exception as error:  # each of its formats has errors of its own
        told = one_line(error)
        raise FileError(f"{path}: must be an image that Pillow reads, got: {told}") from None


def _pgm(path: Path, content: bytes) -> Floats:
    """A portable grey map, plain or raw. Source: netpbm, format pgm(5)."""
    header: list[bytes] = []
    at = 0
    while len(header) < 4 and (found := _WORD.match(content, at)):
        header.append(found[1])
        at = found.end()
    try:
        columns, rows, most = (int(number) for number in header[1:])
        if most < 1:
            raise ValueError
        if header[0] == b"P2":
            values = np.array(content[at:].split(), dtype=float)
        else:
            kind = np.dtype("u1" if most < 256 else ">u2")
            values = np.frombuffer(content, kind, rows * columns, at + 1).astype(float)
        return values.reshape(rows, columns) / most
    except ValueError:
        raise FileError(f"{path}: must be a PGM with as many shades as its header says") from None
