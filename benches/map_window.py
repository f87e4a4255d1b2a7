"""Time of the processor and memory for a window of 100 m of a GeoTIFF of 1 GB, beside rasterio alone.

``python -m benches.map_window FOLDER`` writes both images there, 2 GB, and removes them.
"""

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

SIDE = 16384  # rows and columns of single precision: 1 GB
CELL = 0.5  # [m]
CORNER = (400_000.0, 5_400_000.0)  # in the north-west [m]
TILED = {"tiled": True, "blockxsize": 256, "blockysize": 256}
REPEATS = 20


def write(path: Path, side: int, **more: object) -> None:
    """A random walk down the rows."""
    import rasterio

    place = rasterio.Affine(CELL, 0, CORNER[0], 0, -CELL, CORNER[1])
    profile = {"driver": "GTiff", "count": 1, "dtype": "float32", "crs": "EPSG:32633", "transform": place}
    steps = np.random.default_rng(0).normal(0, 0.02, (256, side))
    rows = (300 + np.cumsum(steps, axis=0)).astype(np.float32)
    with rasterio.open(path, "w", height=side, width=side, **profile, **more) as target:
        for first in range(0, side, 256):
            target.write(rows, 1, window=((first, first + 256), (0, side)))


def memory() -> float:
    """The most that this process has had so far [MB] (Linux; `ru_maxrss` would be that of its parent too)."""
    status = Path("/proc/self/status").read_text()
    return float(status.partition("VmHWM:")[2].split()[0]) / 1024


def measure(path: Path, small: Path, alone: bool) -> str:
    """Time of the processor of the first reading and the least of several, and the memory that they took."""
    import rasterio

    import six_wheel as sw

    x, y = CORNER[0] + CELL * SIDE / 2, CORNER[1] - CELL * SIDE / 2

    def ours() -> object:
        return sw.Terrain.read(path, window=(x, y - 100, x + 100, y))

    def theirs() -> object:
        with rasterio.open(path) as dataset:
            return dataset.read(1, window=((SIDE // 2, SIDE // 2 + 200), (SIDE // 2, SIDE // 2 + 200)))

    read: Callable[[], object] = theirs if alone else ours
    sw.Terrain.read(small)  # loads what reading needs
    before, times = memory(), []
    for _ in range(REPEATS):
        begin = time.process_time()
        read()
        times.append(1e3 * (time.process_time() - begin))
    name = "rasterio alone" if alone else "Terrain.read"
    return f"{path.stem:8}{name:16}{times[0]:7.1f} ms first {min(times):6.1f} ms {memory() - before:6.1f} MB"


def main(folder: Path) -> None:
    small = folder / "small.tif"
    write(small, 256)
    for name, more in (("tiled", TILED), ("strips", {})):
        path = folder / f"{name}.tif"
        try:
            write(path, SIDE, **more)
            for alone in ("", "alone"):
                words = [sys.executable, "-m", "benches.map_window", str(path), str(small), alone]
                subprocess.run(words, check=True)
        finally:
            path.unlink(missing_ok=True)
    small.unlink()


if __name__ == "__main__":
    if len(sys.argv) == 2:
        main(Path(sys.argv[1]))
    else:
        print(measure(Path(sys.argv[1]), Path(sys.argv[2]), bool(sys.argv[3])))
