"""Files that hold no map of heights, by their first bytes and names, each with what to give instead."""

from six_wheel.maps.files import TerrainFileError
from six_wheel.maps.readers.sources import Source

MESHES = (".stl", ".obj", ".ply", ".dae", ".glb", ".gltf", ".fbx", ".sdf", ".off", ".3mf")
POINTS = (".las", ".laz", ".pcd", ".e57", ".copc", ".ptx")
SHAPES = (".shp", ".geojson", ".kml", ".dxf")
TABLES = (".mat", ".pkl", ".parquet", ".feather", ".xlsx")
PACKED = (".7z", ".rar", ".tar", ".tgz", ".bz2", ".xz", ".zst", ".zip", ".gz")
# Ends of names and first bytes, and what such a file is.
KINDS: tuple[tuple[tuple[str, ...], tuple[bytes, ...], str], ...] = (
    ((), (b"version https://git-lfs",), "is a pointer of Git LFS, not the file: git lfs pull"),
    (
        MESHES,
        (b"ply\n", b"ply\r", b"solid "),
        "is a mesh: make a raster of it first (CloudCompare, Rasterize; or sample z)",
    ),
    (POINTS, (b"LASF", b"# .PCD"), "holds points: make a raster of them first (pdal, writers.gdal)"),
    (
        (),
        (b"# Octomap",),
        "is an OctoMap of occupied cells: make a map of heights of it first (grid_map_octomap)",
    ),
    ((".pgm",), (b"P2", b"P5"), "is an occupancy map or a picture, no heights"),
    (SHAPES, (), "holds shapes: make a raster of them first (gdal_rasterize or gdal_grid)"),
    (TABLES, (), "is no map: read its array and give sw.Terrain(heights, spacing=0.1)"),
    (PACKED, (), "is packed: unpack it first"),
)


def refuse_others(source: Source, begin: bytes) -> None:
    """Fails for a file that is no map of heights, with its kind and the remedy."""
    head = begin.lstrip()[:64].lower()
    if head.startswith((b"<!doctype html", b"<html")) or (head.startswith(b"<?xml") and b"<error>" in head):
        raise TerrainFileError(f"{source.path} is a web page, not the file: download it again")
    for ends, begins, kind in KINDS:
        if source.suffix in ends or begin.startswith(begins):
            raise TerrainFileError(f"{source.path} {kind}")
