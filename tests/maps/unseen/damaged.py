"""Files that are no maps, and halves of maps."""

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.unseen.case import Case
from tests.maps.unseen.images import image
from tests.maps.unseen.texts import file, grid


def noise(count: int) -> bytes:
    return np.random.default_rng(2).bytes(count)


def every() -> list[Case]:
    """Files that are no maps, and halves of maps."""

    def cut(keep: float, name: str = "map.tif", **more: Any) -> Any:
        def make(folder: Path) -> Any:
            image(name, **more)[0](folder)
            path = folder / name
            data = path.read_bytes()
            path.write_bytes(data[: int(len(data) * keep)])
            return lambda **options: sw.Terrain.read(path, **options)

        return make

    def zipped(**files: bytes | str) -> bytes:
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w") as target:
            for name, content in files.items():
                target.writestr(name.replace("__", "."), content)
        return buffer.getvalue()

    def folder_of(*names: str) -> Any:
        def make(folder: Path) -> Any:
            (folder / "tiles").mkdir()
            for name in names:
                (folder / "tiles" / name).write_bytes(b"")
            return lambda **options: sw.Terrain.read(folder / "tiles", **options)

        return make

    def link(folder: Path) -> Any:
        (folder / "a.tif").symlink_to(folder / "gone.tif")
        return lambda **options: sw.Terrain.read(folder / "a.tif", **options)

    broken = "damaged|cut off|must be a map|fetch|download"
    return [
        *(
            Case(f"cut to {keep:.0%}, {more}", cut(keep, **more), remedy=broken)
            for keep in (0.02, 0.3, 0.7, 0.95)
            for more in ({}, {"compress": "deflate", "tiled": True, "blockxsize": 16, "blockysize": 16})
        ),
        *(
            Case(
                f"cut {driver}",
                cut(0.5, f"a.{suffix}", driver=driver, mark=-9999.0, tag=-9999.0),
                remedy=broken,
            )
            for driver, suffix in (("netCDF", "nc"), ("HFA", "img"), ("GPKG", "gpkg"), ("COG", "tif"))
        ),
        Case("nothing in .tif", file("a.tif", b""), remedy="empty"),
        Case("nothing in .asc", file("a.asc", b""), remedy="empty"),
        Case("blanks", file("a.asc", " \n\n"), remedy="empty"),
        *(
            Case(
                f"noise .{end}",
                file(f"a.{end}", noise(3000)),
                remedy="must be a|is no|packed|damaged|no array|no map|bag|text",
            )
            for end in (
                "tif",
                "nc",
                "asc",
                "xyz",
                "csv",
                "img",
                "npy",
                "npz",
                "zip",
                "gz",
                "yaml",
                "mcap",
                "bag",
                "h5",
                "grd",
                "dat",
            )
        ),
        Case("web page", file("a.tif", "<!DOCTYPE html><html><body>404</body></html>"), remedy="web page"),
        Case(
            "LFS",
            file("a.asc", "version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 1\n"),
            remedy="git lfs",
        ),
        Case("JSON error", file("a.tif", '{"error": "not found"}'), remedy="must be a map|JSON|download"),
        Case("zip", file("a.zip", lambda: zipped(a__asc=grid()))),
        Case(
            "zip with a readme",
            file("a.zip", lambda: zipped(data__asc=grid(), README__txt="hello", data__prj="")),
        ),
        Case("zip of two", file("a.zip", lambda: zipped(a__asc=grid(), b__asc=grid())), remedy="unpack"),
        Case("empty zip", file("a.zip", lambda: zipped()), remedy="must hold one"),
        Case("cut zip", file("a.zip", lambda: zipped(a__asc=grid())[:200]), remedy="download|unpack"),
        Case("folder of tiles", folder_of("a.tif", "b.tif"), remedy="gdalbuildvrt"),
        Case("empty folder", folder_of(), remedy="folder"),
        Case("dangling link", link, remedy="there is none|link"),
        Case("yaml of nothing", file("a.yaml", "map: gone.tif\n"), remedy="there is none"),
        Case("yaml of a list", file("a.yaml", "- 1\n- 2\n"), remedy="must hold map"),
        Case("yaml of a rover", file("a.yaml", "wheel_radius: 0.1\n"), remedy="must hold map"),
        Case("broken yaml", file("a.yaml", "map: [a\n"), remedy="a.yaml"),
        Case(
            "nav2 map",
            file("a.yaml", "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n"),
            remedy="occupancy",
        ),
        *(
            Case(
                f"mesh .{end}",
                file(f"a.{end}", b"ply\nformat ascii 1.0\n" if end == "ply" else b"data data data"),
                remedy="mesh",
            )
            for end in ("ply", "stl", "obj", "dae")
        ),
        *(
            Case(f"points .{end}", file(f"a.{end}", b"LASF" + noise(400)), remedy="pdal")
            for end in ("las", "laz", "pcd", "e57")
        ),
        *(
            Case(f"table .{end}", file(f"a.{end}", noise(400)), remedy="sw.Terrain|array|table")
            for end in ("mat", "pkl", "parquet", "xlsx", "feather")
        ),
        Case("octomap", file("a.bt", b"# Octomap OcTree binary file\n" + noise(100)), remedy="OctoMap"),
        Case("pdf", file("a.pdf", b"%PDF-1.4\n" + noise(200)), remedy="must be a map|no map|PDF|picture"),
        Case("python", file("a.py", "import os\n"), remedy="must be a map|no map"),
    ]
