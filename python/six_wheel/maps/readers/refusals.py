"""Files that hold no map of heights, by their first bytes and names, each with what to give instead."""

from six_wheel.maps.files import TerrainFileError
from six_wheel.maps.readers.sources import Source

MESHES = (".stl", ".obj", ".ply", ".dae", ".glb", ".gltf", ".fbx", ".sdf", ".off", ".3mf")
POINTS = (".las", ".laz", ".pcd", ".e57", ".copc", ".ptx")
SHAPES = (".shp", ".geojson", ".kml", ".dxf")
TABLES = (".mat", ".pkl", ".parquet", ".feather", ".xlsx")
PACKED = (".7z", ".rar", ".tar", ".tgz", ".bz2", ".xz", ".zst", ".zip", ".gz")
PICTURE = "is an occupancy map or a picture, no heights"


def refuse_others(source: Source, begin: bytes) -> None:
    """Fails for a file that is no map of heights, with its kind and the remedy."""
    kind = _kind(source, begin)
    if kind is not None:
        raise TerrainFileError(f"{source.path} {kind}")


def _kind(source: Source, begin: bytes) -> str | None:
    suffix = source.suffix
    if begin.startswith(b"version https://git-lfs"):
        return "is a pointer of Git LFS, not the file: git lfs pull"
    head = begin.lstrip()[:64].lower()
    if head.startswith((b"<!doctype html", b"<html")) or (head.startswith(b"<?xml") and b"<error>" in head):
        return "is a web page, not the file: download it again"
    if suffix in MESHES or begin.startswith((b"ply\n", b"ply\r", b"solid ")):
        return "is a mesh: make a raster of it first (CloudCompare, Rasterize; or sample z)"
    if suffix in POINTS or begin.startswith((b"LASF", b"# .PCD")):
        return "holds points: make a raster of them first (pdal, writers.gdal)"
    if begin.startswith(b"# Octomap"):
        return "is an OctoMap of occupied cells: make a map of heights of it first (grid_map_octomap)"
    if suffix == ".pgm" or begin[:2] in (b"P2", b"P5"):
        return PICTURE
    if suffix in SHAPES:
        return "holds shapes: make a raster of them first (gdal_rasterize or gdal_grid)"
    if suffix in TABLES:
        return "is no map: read its array and give sw.Terrain(heights, spacing=0.1)"
    if suffix in PACKED:
        return "is packed: unpack it first"
    return None
