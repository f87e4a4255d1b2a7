"""Opens a map: finds its form, and reads it by the reader of that form."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel._core import Terrain
from six_wheel.kinematics.errors import as_path
from six_wheel.kinematics.keywords import checked
from six_wheel.maps.files import Grid, Options, TerrainFileError, cut
from six_wheel.maps.plausibility import find_fill, find_unit, is_fill
from six_wheel.maps.readers import grids
from six_wheel.maps.readers.reference import UNKNOWN, Reference, read_projection, read_reference
from six_wheel.maps.readers.refusals import refuse_others
from six_wheel.maps.readers.sources import FIRST, Source, open_source

if TYPE_CHECKING:
    from six_wheel.maps.readers.rasters import GridImage, Raster

__all__ = ["TerrainFileError", "describe", "open_raster", "read", "read_with"]

BAGS = (".bag", ".db3", ".mcap")
TEXTS = (".asc", ".csv", ".grd", ".txt", ".xyz", ".dat", ".tsv", ".pts", ".agr")
YAML = (".yaml", ".yml")
NO_SYSTEM = "of no known system, taken for metres"
# First bytes of what GDAL reads, whatever its suffix.
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
    b"north:",
)


@checked(Options, call="Terrain.read")
def read(path: str | PathLike[str], **options: Any) -> Terrain:
    """See `Terrain.read`."""
    return read_with(path, Options(**options))


def read_with(path: str | PathLike[str], options: Options) -> Terrain:
    """The same with its options together."""
    path, options, source = _find(path, options)
    if _is_raster(source):
        with _raster(source, options) as raster:
            grid = raster.read(options.window)
            raster.check_plausibility(grid.heights)
            if np.isnan(grid.heights).all():
                raise TerrainFileError(f"{path} has no known height, all are marked as unknown")
        return _terrain(grid, path)
    return _read_grid(source, options)


def open_raster(path: Path, options: Options) -> "Raster | GridImage":
    """A map that is read by windows: an image stays open, any other form is in memory."""
    path, options, source = _find(path, options)
    if _is_raster(source):
        return _raster(source, options)
    from six_wheel.maps.readers.rasters import GridImage, rasterio

    rasterio()
    return GridImage(_read_grid(source, options))


def describe(path: Path, options: Options) -> list[tuple[str, str]]:
    """Form, units, marks of unknown heights and coordinate system of a map, and the source of each."""
    path, options, source = _find(path, options)
    if _is_raster(source):
        with _raster(source, options) as raster:
            return raster.description
    if _is_bag(path):
        return [
            ("form", "GridMap of a bag"),
            ("unit", "1 m"),
            ("coordinates", "of the frame of its header, in m"),
        ]
    reference = _reference(source)
    unit = "1 m, taken for granted: the file has none"
    if options.unit is not None or reference.height is not None:
        said = "as asked" if options.unit is not None else "as its .prj says"
        unit = f"{float(options.unit or reference.height or 1.0):g} m, {said}"
    system = f"in units of {reference.plane:g} m by its .prj" if reference != UNKNOWN else NO_SYSTEM
    return [("form", f"text, {source.suffix}"), ("unit", unit), ("coordinates", system)]


def _find(path: str | PathLike[str], options: Options) -> tuple[Path, Options, Source]:
    """The file of a map, behind the YAML file that names it. Fails for what is no map."""
    options = options.checked()
    if isinstance(path, str) and not path:
        raise ValueError("path must name a file, got an empty text")
    path = as_path("path", path)
    if not path.exists():
        hint = ": download it first" if "://" in str(path) or ":/" in str(path)[:8] else ""
        raise FileNotFoundError(f"{path} must be a file, there is none{hint}")
    source = open_source(path)
    if _is_bag(path):
        if path.is_file():
            refuse_others(source, source.read(FIRST))
        return path, options, source
    if options.topic is not None or options.layer is not None:
        raise TerrainFileError(f"{path}: topic and layer are for bags, this is none")
    if path.is_dir() and path.suffix.lower() != ".zarr":
        tiles = f"gdalbuildvrt all.vrt {path}/*.tif makes one map of its tiles"
        raise TerrainFileError(f"{path} is a folder: {tiles}")
    if path.is_file():
        if path.stat().st_size == 0:
            raise TerrainFileError(f"{path} is empty (0 bytes): fetch it again")
        refuse_others(source, source.read(FIRST))
    if source.suffix in YAML:
        return _find(*_described(source, options))
    return path, options, source


def _is_bag(path: Path) -> bool:
    return path.suffix.lower() in BAGS or (path / "metadata.yaml").exists()


def _is_raster(source: Source) -> bool:
    """True for what GDAL reads: all but bags and text."""
    if _is_bag(source.path) or source.suffix in YAML:
        return False
    if source.suffix not in TEXTS or source.path.is_dir():
        return True
    begin = source.read(FIRST)
    is_wide = begin.startswith((b"\xff\xfe", b"\xfe\xff"))  # text of 16 bits
    return begin.startswith(RASTERS) or (b"\0" in begin and not is_wide)


def _raster(source: Source, options: Options) -> "Raster":
    from six_wheel.maps.readers.rasters import Raster, rasterio

    rasterio()
    return Raster(_labelled(source), options)


def _read_grid(source: Source, options: Options) -> Terrain:
    """Ground of a bag or of text."""
    path = source.path
    if _is_bag(path):
        from six_wheel.maps.readers import bags

        return _made(bags.read(path, options), UNKNOWN, path, options)
    reference = _reference(source)
    return _made(grids.read(path, source.text(), options, reference), reference, path, options)


def _reference(source: Source) -> Reference:
    """The reference system beside a text: a ``.prj`` file, or the metadata that GDAL writes."""
    text = source.beside(".prj")
    if text is not None:
        reference = read_projection(text)
        if reference is None:
            told = "must be well-known text or lines of names and values"
            raise TerrainFileError(f"{source.path}: its .prj {told}: correct it, or remove it")
    else:
        reference = read_reference((source.beside(f"{source.suffix}.aux.xml") or "").replace("&quot;", '"'))
    if reference.degrees:
        name = source.path
        command = f"gdalwarp -t_srs EPSG:326NN {name.name} {name.stem}.tif, NN the UTM zone"
        raise TerrainFileError(
            f"{name} must be in metres, its coordinates are degrees: project it first: {command}"
        )
    return reference


def _described(source: Source, options: Options) -> tuple[Path, Options]:
    """Name of a map and options for it, of a YAML file; those given beside go before."""
    path = source.path
    try:
        import yaml
    except ImportError as missing:
        raise ImportError('reading YAML needs PyYAML: pip install "six-wheel[cli]"') from missing
    try:
        found = yaml.safe_load(source.text())
    except yaml.YAMLError as error:
        raise TerrainFileError(f"{path}: {' '.join(str(error).split())}") from None
    if isinstance(found, dict) and "image" in found:
        raise TerrainFileError(f"{path} is an occupancy map, no heights")
    allowed = set(Options._fields)
    if not isinstance(found, dict) or not isinstance(found.get("map"), str) or set(found) - allowed - {"map"}:
        listed = ", ".join(Options._fields)
        raise TerrainFileError(f"{path} must hold map, the name of a file, and options among {listed}")
    given = {name: value for name, value in options._asdict().items() if value is not None}
    inner = path.parent / found.pop("map")
    if inner.suffix.lower() in YAML:
        raise TerrainFileError(f"{path} must name a map, got {inner.name}")
    return inner, Options(**(found | given))


def _labelled(source: Source) -> Source:
    """The label beside an image of PDS, which says what its bytes are."""
    if source.suffix == ".img" and not source.packing:
        for suffix in (".lbl", ".LBL", ".xml", ".XML"):
            if (label := source.path.with_suffix(suffix)).exists():
                return source._replace(path=label, name=label)
    return source


def _made(grid: Grid, reference: Reference, path: Path, options: Options) -> Terrain:
    """Ground of a grid whose heights are as they are in its file."""
    heights = np.array(grid.heights)
    if options.nodata is not None:
        heights[is_fill(heights, options.nodata)] = np.nan
    unit = float(options.unit or reference.height or 1.0)
    finding = find_fill(heights, options.nodata)
    if unit != 1.0:
        heights = heights * unit
    if finding is None and options.unit is None and reference.height is None:
        finding = find_unit(heights, grid.spacing)
    if finding is None and np.isnan(heights).all():
        finding = "no height is known"
    if finding is not None:
        raise TerrainFileError(f"{path}: {finding}")
    return _terrain(cut(grid._replace(heights=heights), options.window, str(path)), path)


def _terrain(grid: Grid, path: Path) -> Terrain:
    try:
        return Terrain(*grid, nodata=np.nan, unit="m")
    except ValueError as error:
        raise TerrainFileError(f"{path}: {error}") from None
