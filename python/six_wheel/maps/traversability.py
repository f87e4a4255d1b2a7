"""A whole map in tiles: spread, resumed, written in its own frame."""

import contextlib
import hashlib
import math
import os
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product, starmap
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import RockerBogie, Terrain, __version__
from six_wheel.kinematics.errors import as_path, one_line
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.objects.notebooks import Shown
from six_wheel.kinematics.objects.whole_files import check_target, replacing
from six_wheel.kinematics.statuses import FeasibilityLimits
from six_wheel.maps.files import Options
from six_wheel.maps.readers.rasters import GridImage, Raster, rasterio
from six_wheel.maps.reading import open_raster
from six_wheel.maps.tiles import REASONS, Tile, judge, reach
from six_wheel.parallel import Journal, spread
from six_wheel.parallel.journal import file_states

SIDE = 256  # cells of a tile along its side
PICTURE = 1000  # largest side of what a picture is made from
BANDS = {
    "safe": "share of headings at which the rover may stand",
    "tilt": "worst tilt [rad]",
    "clearance": "least clearance of the belly beyond what is asked for [m]",
    "reason": "most frequent reason why not: "
    + ", ".join(f"{k} {reason}" for k, reason in enumerate(REASONS)),
}


class Layers(NamedTuple):
    """Layers of the result for every cell, as rows of the image; NaN where nothing is known."""

    safe: NDArray[np.float32]
    tilt: NDArray[np.float32]  # [rad]
    clearance: NDArray[np.float32]  # [m]
    reason: NDArray[np.float32]


@dataclass(frozen=True)
class Traversed(Shown):
    """Result of `traverse` for a map."""

    output: Path
    cells: int
    headings: int
    safe: float
    """Share of the poses at which the rover may stand."""
    tiles: int
    resumed: int
    """Tiles that an earlier run had done."""
    picture: Layers
    """The layers, thinned out to a picture's size."""
    extent: tuple[float, float, float, float]
    """x_min, x_max, y_min, y_max of the image [m]."""


class Window(NamedTuple):
    """Cells of a tile, as rows and columns of the image."""

    rows: slice
    columns: slice


@checked()
def traverse(
    path: str | os.PathLike[str],
    rover: RockerBogie,
    output: str | os.PathLike[str],
    *,
    headings: int = 16,
    limits: FeasibilityLimits | None = None,
    map_error: float = 0.0,
    belly: tuple[float, float, float, float] | None = None,
    cluster: Any = None,
    workers: int | None = None,
    progress: Callable[[int, int], object] | None = None,
    band: int | str | None = None,
    nodata: float | Sequence[float] | None = None,
    unit: str | float | None = None,
    north_up: bool | None = None,
    spacing: float | tuple[float, float] | None = None,
    origin: tuple[float, float] | None = None,
    topic: str | None = None,
    layer: str | None = None,
) -> Traversed:
    """Feasibility of the settled pose of a rover at every cell of a map and at `headings` headings.

    The map is read, judged and written in tiles: memory does not grow with it. Finished tiles are kept in a
    folder beside the output until that is whole; the same call after a stop goes on there. Results do not
    depend on where tiles are judged, bit for bit.

    Parameters
    ----------
    path : path
        Whatever `Terrain.read` takes (extra ``[terrain]``). Images are read by windows, other forms whole.
    rover : RockerBogie
        Its origin over the middle of a cell.
    output : path
        GeoTIFF of four layers in the frame of the map: share of safe headings, worst tilt, clearance left,
        reason.
    headings : int, default 16
        Evenly spaced, from the x axis of the map's frame.
    limits : FeasibilityLimits, optional
        Limits of a stand; default ``FeasibilityLimits.curiosity()``.
    map_error : float, default 0.0
        Largest error of the heights [m].
    belly : (float, float, float, float), optional
        As for `RockerBogie.bounds` [m].
    cluster : str or distributed.Client, optional
        A Dask cluster instead of this machine (extra ``[cluster]``).
    workers : int, optional
        Processes of this machine, default one per core.
    progress : callable, optional
        Called with the number of finished tiles and of all.
    band, nodata, unit, north_up, spacing, origin, topic, layer : optional
        As for `Terrain.read`, for what the map leaves open.

    Returns
    -------
    Traversed
        Counts of cells and of safe ones, where the layers are, tiles that were kept from a call before.

    Raises
    ------
    TerrainFileError
        If the map cannot be read, or is in degrees.
    ValueError
        If the output is the map, not a file, or in no folder.
    ClusterError
        If the cluster does not answer.
    OSError
        If there is no room for the result. What was finished stays, the output does not appear.
    RuntimeError
        If a tile fails.
    """
    if isinstance(headings, bool) or not isinstance(headings, int) or headings < 1:
        raise ValueError(f"headings must be at least 1, got {headings}")
    path, output = as_path("path", path), as_path("output", output)
    check_target(output, [path])
    options = Options(None, topic, layer, band, nodata, unit, north_up, spacing, origin)
    task = _Task(rover, headings, limits or FeasibilityLimits.curiosity(), map_error, belly, options)
    with open_raster(path, options) as raster:
        rows, columns = (
            [slice(first, min(first + SIDE, size)) for first in range(0, size, SIDE)] for size in raster.shape
        )
        windows = list(starmap(Window, product(rows, columns)))
        # One tile here, before anything is written: what is wrong with the arguments is said at once.
        flat = Terrain(np.zeros((2, 2)), 1.0)
        rover.feasible(flat, [(0.0, 0.0, 0.0)], task.limits, map_error=map_error, belly=belly)
        journal = Journal(output.with_name(output.name + ".tiles"), task.described(path))
        resumed = len(journal.done)
        for outcome in spread(
            judge,
            windows,
            cluster=cluster,
            workers=workers,
            journal=journal,
            prepare=partial(_tile, raster, task),
            progress=None if progress is None else lambda done: progress(done, len(windows)),
        ):
            if outcome.failure is not None:
                part, across = windows[outcome.index]
                where = f"rows {part.start} to {part.stop - 1}, columns {across.start} to {across.stop - 1}"
                raise ValueError(f"the tile of {where} failed: {outcome.failure}")
        picture, safe = _write(output, raster, windows, journal)
        left, bottom, right, top = raster.placement.bounds
        cells = raster.shape[0] * raster.shape[1]
    journal.discard()
    return Traversed(
        output, cells, headings, safe / cells, len(windows), resumed, picture, (left, right, bottom, top)
    )


class _Task(NamedTuple):
    """The question that is asked at every cell."""

    rover: RockerBogie
    headings: int
    limits: FeasibilityLimits
    map_error: float
    belly: tuple[float, float, float, float] | None
    options: Options

    def described(self, path: Path) -> dict[str, Any]:
        """All that the answers for a map depend on."""
        return {
            "six_wheel": __version__,
            "map": file_states([path]),
            "rover": hashlib.sha256(repr(self.rover).encode()).hexdigest(),
            "headings": self.headings,
            "limits": [str(limit) for limit in self.limits],
            "map_error": self.map_error,
            "belly": self.belly,
            "options": [str(option) for option in self.options],
            "side": SIDE,
        }


def _tile(raster: Raster | GridImage, task: _Task, window: Window) -> Tile:
    """The heights that a tile's cells depend on, with its cells among them, rows turned to go along +y."""
    rows, columns = window
    margin = [math.ceil(reach(task.rover) / spacing) + 1 for spacing in raster.spacing]
    around = [
        slice(max(part.start - more, 0), min(part.stop + more, size))
        for part, more, size in zip((rows, columns), (margin[1], margin[0]), raster.shape, strict=True)
    ]
    heights = raster.heights(*around)
    first = rows.start - around[0].start
    inner = slice(first, first + rows.stop - rows.start)
    if raster.placement.flipped:
        heights = heights[::-1]
        inner = slice(heights.shape[0] - inner.stop, heights.shape[0] - inner.start)
    across = slice(columns.start - around[1].start, columns.stop - around[1].start)
    if min(heights.shape) < 2:
        raise ValueError(f"heights must have at least two rows and two columns, got shape {heights.shape}")
    return Tile(
        task.rover, np.ascontiguousarray(heights), raster.spacing, raster.placement.yaw, (inner, across),
        task.headings, task.limits, task.map_error, task.belly,
    )  # fmt: skip


def _write(
    output: Path, raster: Raster | GridImage, windows: list[Window], journal: Journal
) -> tuple[Layers, float]:
    """The layers, from the journal to a file beside the output, then to its place."""
    library = rasterio()
    rows, columns = raster.shape
    needed = rows * columns * 4 * len(BANDS)
    free = shutil.disk_usage(output.parent).free
    if needed > free:
        raise OSError(f"{output} needs {needed} bytes, the disk has {free}")
    step = max(1, math.ceil(max(rows, columns) / PICTURE))
    thin = [np.full((math.ceil(rows / step), math.ceil(columns / step)), np.nan, np.float32) for _ in BANDS]
    safe = 0.0
    profile = {
        "driver": "GTiff",
        "dtype": "float32",
        "count": len(BANDS),
        "height": rows,
        "width": columns,
        "crs": raster.crs,
        "transform": raster.placement.transform,
        "nodata": math.nan,
        "tiled": True,
        "blockxsize": SIDE,
        "blockysize": SIDE,
        "compress": "deflate",
        "bigtiff": "if_safer",
    }
    with _named(output), replacing(output) as beside:
        with library.open(beside, "w", **profile) as target:
            for band, (name, meaning) in enumerate(BANDS.items(), 1):
                target.set_band_description(band, name)
                target.update_tags(band, meaning=meaning)
            for index, (part, across) in enumerate(windows):
                layers = journal.read(index)
                place = ((part.start, part.stop), (across.start, across.stop))
                first = [-(-begin.start // step) for begin in (part, across)]
                for band, name in enumerate(BANDS, 1):
                    layer = layers[name].astype(np.float32)
                    layer = layer[::-1] if raster.placement.flipped else layer
                    target.write(layer, band, window=place)
                    few = layer[first[0] * step - part.start :: step, first[1] * step - across.start :: step]
                    thin[band - 1][first[0] : first[0] + few.shape[0], first[1] : first[1] + few.shape[1]] = (
                        few
                    )
                safe += float(layers["safe"].sum(dtype=np.float64))
        with library.open(beside) as written:  # a full disk is noticed here
            written.read(1, window=((rows - 1, rows), (0, columns)))
    return Layers(*thin), safe


@contextlib.contextmanager
def _named(output: Path) -> Iterator[None]:
    """Context in which an error of GDAL names the file as the user did."""
    try:
        yield
    except rasterio().errors.RasterioError as error:
        why = one_line(error)
        raise OSError(f"{output}: could not be written: {why}") from None
