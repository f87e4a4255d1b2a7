"""Opens a map, whatever it is."""

from os import PathLike
from pathlib import Path

from six_wheel._core import Terrain
from six_wheel.kinematics.errors import as_path
from six_wheel.maps import grids
from six_wheel.maps.files import Grid, TerrainFileError, Window, check, cut

__all__ = ["TerrainFileError", "read"]

BAGS = (".bag", ".db3", ".mcap")
TEXTS = (".asc", ".csv", ".grd", ".txt")


def read(
    path: str | PathLike[str],
    *,
    window: Window | None = None,
    topic: str | None = None,
    layer: str | None = None,
) -> Terrain:
    """See `Terrain.read`."""
    check(window)
    path = as_path("path", path)
    if not path.exists():
        raise FileNotFoundError(f"{path} must be a file, there is none")
    if path.suffix.lower() in BAGS or (path.is_dir() and (path / "metadata.yaml").exists()):
        from six_wheel.maps import bags

        return _made(cut(bags.read(path, topic, layer), window, str(path)), path)
    if topic is not None or layer is not None:
        raise TerrainFileError(f"{path}: topic and layer are for bags, this is none")
    if path.suffix.lower() in TEXTS:
        return _made(cut(grids.read(path), window, str(path)), path)
    from six_wheel.maps import rasters

    with rasters.Raster(path) as raster:
        return _made(raster.read(window), path)


def _made(grid: Grid, path: Path) -> Terrain:
    try:
        return Terrain(grid.heights, grid.spacing, grid.origin, grid.yaw)
    except ValueError as error:
        raise TerrainFileError(f"{path}: {error}") from None
