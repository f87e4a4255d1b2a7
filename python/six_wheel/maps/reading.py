"""Opens a map, whatever it is."""

import gzip
import zipfile
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel._core import Terrain
from six_wheel.kinematics.errors import as_path
from six_wheel.maps import grids
from six_wheel.maps.doubts import find_doubt, is_fill
from six_wheel.maps.files import Grid, Options, TerrainFileError, cut
from six_wheel.maps.reference import UNKNOWN, Reference

if TYPE_CHECKING:
    from six_wheel.maps.rasters import Raster

__all__ = ["TerrainFileError", "open_raster", "read", "read_with", "system_of"]

BAGS = (".bag", ".db3", ".mcap")
TEXTS = (".asc", ".csv", ".grd", ".txt", ".xyz", ".dat", ".tsv")
# First bytes of text with a suffix of its own, or of another.
RASTERS = (
    b"DSAA",
    b"DSBB",
    b"DSRB",
    b"CDF",
    b"\x89HDF",
    b"II*\0",
    b"MM\0*",
    b"II+\0",
    b"MM\0+",
    b"\x89PNG",
    b"\xff\xd8\xff",
    b"[",
)
MESHES = (".stl", ".obj", ".ply", ".dae", ".glb", ".gltf")
POINTS = (".las", ".laz", ".pcd", ".e57", ".copc")


def read(path: str | PathLike[str], **options: Any) -> Terrain:
    """See `Terrain.read`."""
    return read_with(path, Options(**options))


def read_with(path: str | PathLike[str], options: Options) -> Terrain:
    """The same with its options together."""
    options = options.checked()
    path = as_path("path", path)
    if not path.exists():
        raise FileNotFoundError(f"{path} must be a file, there is none")
    if path.suffix.lower() in BAGS or (path.is_dir() and (path / "metadata.yaml").exists()):
        from six_wheel.maps import bags

        return _made(bags.read(path, options.topic, options.layer), UNKNOWN, path, options)
    if options.topic is not None or options.layer is not None:
        raise TerrainFileError(f"{path}: topic and layer are for bags, this is none")
    if path.suffix.lower() in (".yaml", ".yml"):
        return _described(path, options)
    begin = _first_bytes(path)
    _refuse(path, begin)
    source = _packed(path) if path.suffix.lower() in (".zip", ".gz") else None
    inner = Path(source or path)
    if inner.suffix.lower() in TEXTS and not begin.startswith(RASTERS):
        _refuse_empty(path)
        return _made(*grids.read(path, _text(path, inner), options), path, options)
    with _raster(path, options, source) as raster:
        grid = raster.read(options.window)
        raster.doubt(grid.heights)
    return _terrain(grid, path)


def open_raster(path: Path, options: Options) -> "Raster":
    """A map as an image that stays open, to be read by windows. Refuses what `read` refuses."""
    _refuse(path, _first_bytes(path))
    return _raster(path, options, _packed(path) if path.suffix.lower() in (".zip", ".gz") else None)


def system_of(path: Path) -> str | None:
    """Name of the coordinate reference system of an image; None where there is none."""
    if path.is_dir() or path.suffix.lower() in (*BAGS, *TEXTS, ".yaml", ".yml", ".zip", ".gz"):
        return None
    from six_wheel.maps.rasters import rasterio

    with rasterio().open(_label(path)) as dataset:
        text = "" if dataset.crs is None else dataset.crs.to_wkt()
    return text.partition('"')[2].partition('"')[0] or None


def _raster(path: Path, options: Options, source: str | None) -> "Raster":
    from six_wheel.maps.rasters import Raster, rasterio

    rasterio()
    _refuse_empty(path)
    return Raster(_label(path), options, source)


def _described(path: Path, options: Options) -> Terrain:
    """A file of parameters: the name of a map and its options."""
    try:
        import yaml
    except ImportError as missing:
        raise ImportError('reading YAML needs PyYAML: pip install "six-wheel[cli]"') from missing
    try:
        found = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        raise TerrainFileError(f"{path}: {' '.join(str(error).split())}") from None
    if isinstance(found, dict) and "image" in found:
        raise TerrainFileError(f"{path} is an occupancy map, no heights")
    allowed = set(Options._fields)
    if not isinstance(found, dict) or not isinstance(found.get("map"), str) or set(found) - allowed - {"map"}:
        listed = ", ".join(Options._fields)
        raise TerrainFileError(f"{path} must hold map, the name of a file, and options among {listed}")
    given = {name: value for name, value in options._asdict().items() if value is not None}
    inner = path.parent / found.pop("map")
    if inner.suffix.lower() in (".yaml", ".yml"):
        raise TerrainFileError(f"{path} must name a map, got {inner.name}")
    return read_with(inner, Options(**(found | given)))


def _first_bytes(path: Path) -> bytes:
    if path.is_dir():
        raise TerrainFileError(
            f"{path} is a folder: gdalbuildvrt all.vrt {path}/*.tif makes one map of its tiles"
        )
    with path.open("rb") as file:
        return file.read(512)


def _refuse(path: Path, begin: bytes) -> None:
    """Fails for what is no map of heights, with what it is and what to give."""
    suffix, name = path.suffix.lower(), path.name
    if begin.startswith(b"version https://git-lfs"):
        raise TerrainFileError(f"{path} is a pointer of Git LFS, not the file: git lfs pull")
    if begin.lstrip()[:15].lower().startswith((b"<!doctype html", b"<html")):
        raise TerrainFileError(f"{path} is a web page, not the file: download it again")
    if begin.startswith(b"\x93NUMPY") or suffix == ".npy":
        raise TerrainFileError(
            f'{path} is an array without a place: sw.Terrain(np.load("{name}"), spacing=0.1)'
        )
    if suffix == ".npz":
        loaded = f'np.load("{name}")["heights"]'
        raise TerrainFileError(f"{path} holds arrays without a place: sw.Terrain({loaded}, spacing=0.1)")
    if suffix in MESHES or begin.startswith((b"ply\n", b"ply\r", b"solid ")):
        raise TerrainFileError(
            f"{path} is a mesh: make a raster of it first (CloudCompare, Rasterize; or sample z)"
        )
    if suffix in POINTS or begin.startswith((b"LASF", b"# .PCD")):
        raise TerrainFileError(f"{path} holds points: make a raster of them first (pdal, writers.gdal)")
    if suffix == ".pgm" or begin[:2] in (b"P2", b"P5"):
        raise TerrainFileError(f"{path} is an occupancy map or a picture, no heights")
    if suffix in (".shp", ".gpkg", ".geojson", ".kml", ".dxf"):
        raise TerrainFileError(
            f"{path} holds shapes: make a raster of them first (gdal_rasterize or gdal_grid)"
        )
    if suffix in (".mat", ".pkl", ".parquet", ".feather", ".xlsx"):
        raise TerrainFileError(f"{path} is no map: read its array and give sw.Terrain(heights, spacing=0.1)")
    if suffix in (".7z", ".rar", ".tar", ".tgz", ".bz2", ".xz"):
        raise TerrainFileError(f"{path} is packed: unpack it first")


def _refuse_empty(path: Path) -> None:
    if path.stat().st_size == 0:
        raise TerrainFileError(f"{path} is empty (0 bytes): fetch it again")


def _packed(path: Path) -> str:
    """Name under which GDAL sees the only map of a packed file."""
    if path.suffix.lower() == ".gz":
        return (
            f"/vsigzip/{path}"[: -len(path.suffix)] if Path(path.stem).suffix in TEXTS else f"/vsigzip/{path}"
        )
    try:
        with zipfile.ZipFile(path) as packed:
            names = [name for name in packed.namelist() if not name.endswith("/")]
    except zipfile.BadZipFile:
        raise TerrainFileError(f"{path} must be a ZIP file: download it again, or unpack it") from None
    beside = (".prj", ".xml", ".txt", ".pdf", ".tfw", ".md", ".html", ".aux")
    maps = [name for name in names if Path(name).suffix.lower() not in beside] or names
    if len(maps) != 1:
        listed = ", ".join(maps[:5])
        raise TerrainFileError(f"{path} holds {len(maps)} files: unpack it, and give one of {listed}")
    return f"/vsizip/{path}/{maps[0]}"


def _text(path: Path, inner: Path) -> str:
    """Text of a file, packed or not."""
    suffix = path.suffix.lower()
    try:
        if suffix == ".gz":
            with gzip.open(path) as packed:
                data = packed.read()
        elif suffix == ".zip":
            with zipfile.ZipFile(path) as folder:
                data = folder.read(str(inner).removeprefix(f"/vsizip/{path}/"))
        else:
            data = path.read_bytes()
        return data.decode("utf-8-sig")
    except (UnicodeDecodeError, OSError):
        raise TerrainFileError(f"{path} must be text") from None


def _label(path: Path) -> Path:
    """The label beside an image of PDS, which says what its bytes are."""
    if path.suffix.lower() == ".img":
        for suffix in (".lbl", ".LBL", ".xml", ".XML"):
            if (label := path.with_suffix(suffix)).exists():
                return label
    return path


def _made(grid: Grid, reference: Reference, path: Path, options: Options) -> Terrain:
    """Ground of a grid whose heights are as they are in its file."""
    heights = np.array(grid.heights)
    if options.nodata is not None:
        heights[is_fill(heights, options.nodata)] = np.nan
    unit = float(options.unit or reference.height or 1.0)
    known = {
        "nodata_known": options.nodata is not None,
        "unit_known": unit != 1.0 or options.unit is not None,
    }
    found = find_doubt(heights * np.asarray(unit, heights.dtype), grid.spacing, **known)
    if found is not None:
        raise TerrainFileError(f"{path}: {found.message}")
    if unit != 1.0:
        heights = heights * unit
    return _terrain(cut(grid._replace(heights=heights), options.window, str(path)), path)


def _terrain(grid: Grid, path: Path) -> Terrain:
    try:
        return Terrain(*grid, nodata=np.nan, unit="m")
    except ValueError as error:
        raise TerrainFileError(f"{path}: {error}") from None
