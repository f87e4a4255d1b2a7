"""Opens a map: finds its form, and reads it by the reader of that form."""

import contextlib
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel._core import Terrain
from six_wheel.kinematics.errors import as_path, needed, one_line
from six_wheel.kinematics.keywords import checked
from six_wheel.maps import doubts
from six_wheel.maps.files import Grid, Options, TerrainFileError, cut, unit_in_name
from six_wheel.maps.plausibility import find_fill, find_unit, is_fill
from six_wheel.maps.readers import grids, matrices
from six_wheel.maps.readers.reference import UNKNOWN, Reference, read_projection, read_reference
from six_wheel.maps.readers.refusals import refuse_others
from six_wheel.maps.readers.sources import FIRST, Source, open_source
from six_wheel.robot_description.missing_files import near_file

if TYPE_CHECKING:
    from six_wheel.maps.readers.rasters import GridImage, Raster


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
    b"!",  # ZMap
)


@checked(Options, call="Terrain.read")
def read(path: str | PathLike[str], **options: Any) -> Terrain:
    """See `Terrain.read`."""
    return read_with(path, Options(**options))


def read_with(path: str | PathLike[str], options: Options) -> Terrain:
    """The same with its options together."""
    with _asked_in(path):
        return _read(*_find(path, options))


def _read(path: Path, options: Options, source: Source) -> Terrain:
    if _is_raster(source):
        with _raster(source, options) as raster:
            if options.window is not None:
                raster.glance()
            grid = raster.read(options.window)
            raster.check_plausibility(grid.heights)
            if np.isnan(grid.heights).all():
                raise TerrainFileError(f"{path} has no known height, all are marked as unknown")
        return _terrain(grid, path)
    return _read_grid(source, options)


def open_raster(path: Path, options: Options) -> "Raster | GridImage":
    """A map that is read by windows: an image stays open, any other form is in memory."""
    with _asked_in(path):
        path, options, source = _find(path, options)
        if _is_raster(source):
            raster = _raster(source, options)
            try:
                raster.check_sample()
            except BaseException:
                raster.close()
                raise
            return raster
        ground = _read_grid(source, options)
    from six_wheel.maps.readers.rasters import GridImage, rasterio

    rasterio()
    return GridImage(ground)


def describe(path: Path, options: Options) -> list[tuple[str, str]]:
    """Form, units, marks of unknown heights and coordinate system of a map, and the source of each."""
    path, options, source = _find(path, options)
    if _is_raster(source):
        with _raster(source, options) as raster:
            return raster.description
    form, unit, system = "GridMap of a bag", "1 m", "of the frame of its header, in m"
    if _is_array(source):
        said = "as asked" if options.unit else "taken for granted"
        form, unit, system = f"NumPy, {source.suffix}", f"{float(options.unit or 1.0):g} m, {said}", NO_SYSTEM
    elif not _is_bag(path):
        reference, form = _reference(source), f"text, {source.suffix}"
        unit = "1 m, taken for granted: the file has none"
        if options.unit is not None or reference.height is not None:
            said = "as asked" if options.unit is not None else "as its .prj says"
            unit = f"{float(options.unit or reference.height or 1.0):g} m, {said}"
        system = f"in units of {reference.plane:g} m by its .prj" if reference != UNKNOWN else NO_SYSTEM
    return [("form", form), ("unit", unit), ("coordinates", system)]


@contextlib.contextmanager
def _asked_in(path: str | PathLike[str]) -> Iterator[None]:
    """Within it, doubts about a map that a YAML file names propose keys of that file."""
    try:
        yield
    except TerrainFileError as error:
        if Path(path).suffix.lower() in YAML and any(not isinstance(part, str) for part in error.parts):
            raise TerrainFileError(f"{error.told('key')} (keys of {path})") from None
        raise


def _find(path: str | PathLike[str], options: Options) -> tuple[Path, Options, Source]:
    """The file of a map, behind the YAML file that names it. Fails for what is no map."""
    options = options.checked()
    path = as_path("path", path)
    if not path.exists():
        hint = ": download it first" if "://" in str(path) or ":/" in str(path)[:8] else near_file(path)
        raise FileNotFoundError(f"{path} must be a file, there is none{hint}")
    if path.is_file() and path.stat().st_size == 0:
        raise TerrainFileError(f"{path} is empty (0 bytes): fetch it again")
    source = open_source(path)
    if path.is_file():
        refuse_others(source, source.read(FIRST))
    if _is_bag(path):
        return path, options, source
    if options.topic is not None or options.layer is not None:
        raise TerrainFileError(f"{path}: topic and layer are for bags, this is none")
    if path.is_dir() and path.suffix.lower() != ".zarr":
        tiles = f"gdalbuildvrt all.vrt {path}/*.tif makes one map of its tiles"
        raise TerrainFileError(f"{path} is a folder: {tiles}")
    if source.suffix in YAML:
        return _find(*_described(source, options))
    return path, options, source


def _is_bag(path: Path) -> bool:
    return path.suffix.lower() in BAGS or (path / "metadata.yaml").exists()


def _is_array(source: Source) -> bool:
    return source.path.is_file() and (
        source.suffix == ".npz" or source.read(FIRST).startswith(matrices.NUMPY)
    )


def _is_raster(source: Source) -> bool:
    """True for what GDAL reads: all but bags and text."""
    if _is_bag(source.path) or source.suffix in YAML or _is_array(source):
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
    """Ground of a bag, an array or text."""
    path = source.path
    if _is_bag(path):
        from six_wheel.maps.readers import bags

        return _made(bags.read(path, options), UNKNOWN, path, options)
    if _is_array(source):
        return _made(matrices.read(source, options), UNKNOWN, path, options)
    reference = _reference(source)
    return _made(grids.read(path, source.text(), options, reference), reference, path, options)


def _reference(source: Source) -> Reference:
    """The reference system beside a text: a ``.prj`` file, or the metadata that GDAL writes."""
    text = source.beside(".prj")
    if text is not None and text.strip():
        reference = read_projection(text)
        if reference is None:
            told = "must be well-known text or lines of names and values"
            raise TerrainFileError(f"{source.path}: its .prj {told}: correct it, or remove it")
    else:
        reference = read_reference((source.beside(f"{source.suffix}.aux.xml") or "").replace("&quot;", '"'))
    return reference


def _described(source: Source, options: Options) -> tuple[Path, Options]:
    """Name of a map and options for it, of a YAML file; those given beside go before."""
    path = source.path
    with needed("six-wheel[cli]", "maps described by a YAML file need"):
        import yaml
    try:
        found = yaml.safe_load(source.text())
    except yaml.YAMLError as error:
        raise TerrainFileError(f"{path}: {one_line(error)}") from None
    except RecursionError:
        raise TerrainFileError(f"{path} must be YAML, its brackets are nested too deep") from None
    if isinstance(found, dict) and "image" in found:
        raise TerrainFileError(f"{path} is an occupancy map, no heights")
    allowed = set(Options._fields)
    if not isinstance(found, dict) or not isinstance(found.get("map"), str) or set(found) - allowed - {"map"}:
        listed = ", ".join(Options._fields)
        raise TerrainFileError(f"{path} must hold map, the name of a file, and options among {listed}")
    given = {name: value for name, value in options._asdict().items() if value is not None}
    inner = path.parent / found.pop("map")
    try:
        there = inner.exists()
    except OSError as error:
        raise TerrainFileError(f"{path}: its map must be a file: {error.strerror}") from None
    if not there:
        raise FileNotFoundError(f"{path}: its map {inner} must be a file, there is none{near_file(inner)}")
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
    for mark in options.marks:
        heights[is_fill(heights, mark)] = np.nan
    unit = float(options.unit or reference.height or 1.0)
    finding = None if options.every_number_counts else find_fill(heights, options.marks)
    if unit != 1.0:
        heights = heights * unit
    if finding is None and options.unit is None and reference.height is None and not grid.unit_stated:
        word = unit_in_name(path.stem)
        finding = doubts.named_unit(path.stem, word) if word else find_unit(heights, grid.spacing)
    if finding is None and np.isnan(heights).all():
        finding = ("no height is known, all are marked as unknown",)
    if finding is not None:
        raise TerrainFileError(f"{path}: ", *finding)
    return _terrain(cut(grid._replace(heights=heights), options.window, str(path)), path)


def _terrain(grid: Grid, path: Path) -> Terrain:
    try:
        return Terrain(*grid[:4], nodata=np.nan, unit="m")
    except ValueError as error:
        raise TerrainFileError(f"{path}: {error}") from None
