"""The ground as text, arrays and what is no map."""

import gzip
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.forms.ground import CELL, COLUMNS, PLACE, ROWS, Form, grid, middles
from tests.maps.forms.images import filled, tif

HEADER = {
    "ncols": COLUMNS,
    "nrows": ROWS,
    "xllcorner": PLACE[0],
    "yllcorner": PLACE[1],
    "cellsize": CELL,
    "NODATA_value": -9999,
}
GEOGRAPHIC = (
    'GEOGCS["w",DATUM["w",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["G",0],UNIT["degree",0.0174]]'
)
PROJECTED = f'PROJCS["local",{GEOGRAPHIC},UNIT["{{}}",{{}}]]'


def written(content: str | bytes, name: str, beside: Any = None) -> Any:
    def make(folder: Path) -> Any:
        path = folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        for other, text in (beside or {}).items():
            (folder / other).write_text(text)
        return lambda **options: sw.Terrain.read(path, **options)

    return make


def esri(
    mark: float = -9999.0,
    separator: str = " ",
    digits: int = 4,
    comma: bool = False,
    factor: float = 1.0,
    **header: Any,
) -> str:
    head = {key: value for key, value in (HEADER | header).items() if value is not None}
    lines = [f"{key} {value}" for key, value in head.items()]
    lines += [
        separator.join(f"{value:.{digits}f}" for value in row) for row in filled(mark, np.float64, factor)
    ]
    text = "\n".join(lines) + "\n"
    return text.replace(".", ",") if comma else text


def texts() -> list[Form]:
    """ESRI ASCII, tables of points, lists."""
    forms = [
        Form("text", "ESRI", written(esri(), "a.asc")),
        Form(
            "text",
            "ESRI, upper case",
            written(esri().replace("ncols", "NCOLS").replace("cellsize", "CELLSIZE"), "a.asc"),
        ),
        Form("text", "ESRI as .txt", written(esri(), "a.txt")),
        Form("text", "ESRI as .grd", written(esri(), "a.grd")),
        Form("text", "ESRI with CRLF", written(esri().replace("\n", "\r\n"), "a.asc")),
        Form("text", "ESRI with a byte order mark", written("\ufeff" + esri(), "a.asc")),
        Form("text", "ESRI with tabs", written(esri(separator="\t"), "a.asc")),
        Form("text", "ESRI with decimal commas", written(esri(comma=True), "a.asc")),
        Form("text", "ESRI with comments", written("# made by hand\n" + esri(), "a.asc")),
        Form("text", "ESRI without its mark", written(esri(NODATA_value=None), "a.asc")),
        Form(
            "text",
            "ESRI with a rounded mark",
            written(esri(-3.402823e38, NODATA_value=-3.4028234663852886e38), "a.asc"),
        ),
        Form("text", "ESRI with another mark", written(esri(-32768.0), "a.asc"), {"nodata": -32768}),
        Form(
            "text",
            "ESRI by centres",
            written(
                esri(
                    xllcorner=None,
                    yllcorner=None,
                    xllcenter=PLACE[0] + CELL / 2,
                    yllcenter=PLACE[1] + CELL / 2,
                ).replace("nrows", "nrows"),
                "a.asc",
            ),
        ),
        Form("text", "ESRI with dx and dy", written(esri(cellsize=None, dx=CELL, dy=CELL), "a.asc")),
        Form("text", "ESRI in mm", written(esri(factor=0.001), "a.asc"), {"unit": "mm"}),
        Form(
            "text",
            "ESRI in metres by .prj",
            written(esri(), "a.asc", {"a.prj": PROJECTED.format("metre", 1.0)}),
        ),
        Form(
            "text",
            "ESRI in feet by .prj",
            written(
                esri(xllcorner=PLACE[0] / 0.3048, yllcorner=PLACE[1] / 0.3048, cellsize=CELL / 0.3048),
                "a.asc",
                {"a.prj": PROJECTED.format("foot", 0.3048)},
            ),
        ),
        Form(
            "text",
            "ESRI in degrees by .prj",
            written(esri(), "a.asc", {"a.prj": 'GEOGCS["w",UNIT["degree",0.01745]]'}),
            help="gdalwarp",
            knowable=False,
        ),
        Form(
            "text", "ESRI in degrees", written(esri(cellsize=1e-5), "a.asc"), help="degrees", knowable=False
        ),
        Form(
            "text",
            "ESRI cut off",
            written(esri()[:2000], "a.asc"),
            help=r"must hold 24 x 30 heights, got \d+",
            knowable=False,
        ),
        Form("text", "ESRI packed by gzip", written(gzip.compress(esri().encode()), "a.asc.gz")),
        Form(
            "text",
            "matrix",
            written("\n".join(" ".join(f"{v:.4f}" for v in row) for row in grid(None)), "a.txt"),
            {"spacing": CELL},
            place=None,
            hole=False,
        ),
        Form(
            "text",
            "matrix with commas",
            written("\n".join(",".join(f"{v:.4f}" for v in row) for row in grid(None)), "a.csv"),
            {"spacing": CELL},
            place=None,
            hole=False,
        ),
    ]
    x, y = middles()
    points = np.stack((x + PLACE[0], y + PLACE[1], grid()), -1).reshape(-1, 3)
    points = points[~np.isnan(points[:, 2])]
    orders = {
        "": slice(None),
        " north first": np.s_[::-1],
        " by columns": np.lexsort((points[:, 1], points[:, 0])),
        " in any order": np.random.default_rng(0).permutation(len(points)),
    }
    for separator, title in ((" ", "blanks"), (",", "commas"), (";", "semicolons"), ("\t", "tabs")):
        for order, rows in orders.items():
            text = "\n".join(separator.join(f"{value:.4f}" for value in row) for row in points[rows])
            forms.append(Form("text", f"points, {title}{order}", written(text, "a.xyz")))
    body = "\n".join(f"{a:.4f},{b:.4f},{c:.4f}" for a, b, c in points)
    forms.append(Form("text", "points with names", written("x,y,z\n" + body, "a.csv")))
    forms.append(
        Form(
            "text",
            "points with names in another order",
            written("z,x,y\n" + "\n".join(f"{c:.4f},{a:.4f},{b:.4f}" for a, b, c in points), "a.csv"),
        )
    )
    scattered = points + np.random.default_rng(1).uniform(-0.2, 0.2, points.shape)
    forms.append(
        Form(
            "text",
            "scattered points",
            written("\n".join(f"{a:.4f} {b:.4f} {c:.4f}" for a, b, c in scattered), "a.xyz"),
            help="gdal_grid",
            knowable=False,
        )
    )
    whole = [
        PLACE[0] + CELL / 2,
        PLACE[0] + CELL * (COLUMNS - 0.5),
        COLUMNS,
        PLACE[1] + CELL / 2,
        PLACE[1] + CELL * (ROWS - 0.5),
        ROWS,
    ]
    listed = ",".join(map(str, [*whole, *np.where(np.isnan(grid()), -9999, grid()).ravel()]))
    forms.append(Form("text", "list", written(listed, "a.txt"), {"nodata": -9999}))
    described = "map: inner.asc\nnodata: -32768\n"
    forms.append(
        Form("text", "YAML with options", written(described, "a.yaml", {"inner.asc": esri(-32768.0)}))
    )
    return forms


def made(heights: Any, **given: Any) -> Any:
    return lambda folder: lambda **options: sw.Terrain(heights, **(given | options))


def arrays() -> list[Form]:
    """Arrays, DataArrays (by their protocol) and DataFrames."""
    corner = (PLACE[0] + CELL / 2, PLACE[1] + CELL / 2)
    place: dict[str, Any] = {"spacing": CELL, "origin": corner}
    forms = [
        Form("arrays", "float64", made(grid(), **place)),
        Form("arrays", "float32", made(grid().astype(np.float32), **place)),
        Form("arrays", "Fortran order", made(np.asfortranarray(grid()), **place)),
        Form("arrays", "list", made(grid().tolist(), **place)),
        Form("arrays", "masked", made(np.ma.masked_invalid(grid()), **place)),
        Form(
            "arrays",
            "masked by a mark",
            made(np.ma.masked_equal(np.nan_to_num(grid(), nan=-9999.0), -9999.0), **place),
        ),
        Form("arrays", "north up", made(grid()[::-1], north_up=True, **place)),
        Form(
            "arrays",
            "negative dy",
            made(grid()[::-1], **(place | {"spacing": (CELL, -CELL)})),
            {"north_up": True},
        ),
        Form("arrays", "of three axes", made(grid()[None], **place), help=r"src\.read\(1\)", knowable=False),
        Form(
            "arrays",
            "8 bits",
            made(np.clip(grid(0) * 10, 0, 255).astype(np.uint8), **place),
            help="picture",
            knowable=False,
        ),
        Form(
            "arrays",
            "points",
            made(np.stack((*middles(), grid(None)), -1).reshape(-1, 3), **place),
            help=r"reshape\(24, 30\)",
            knowable=False,
        ),
        Form("arrays", "path", made("dtm.tif", **place), help=r"Terrain\.read", knowable=False),
        Form("arrays", "dict", made({"a": grid()}, **place), help="one of its values", knowable=False),
        Form("arrays", "one row", made(grid()[:1], **place), help="at least two rows", knowable=False),
        Form("arrays", "without spacing", made(grid()), {"spacing": CELL}, place=None),
    ]
    forms[7] = Form(
        "arrays",
        "negative dy",
        made(grid()[::-1], **(place | {"spacing": (CELL, -CELL)})),
        help="north_up=True",
        knowable=False,
    )
    for mark in (-9999.0, -32768.0, -3.4028234663852886e38, 1e20, -99999.0):
        for dtype in (np.float32, np.float64):
            forms.append(
                Form(
                    "arrays",
                    f"{mark:g} {np.dtype(dtype)}",
                    made(np.nan_to_num(grid(), nan=mark).astype(dtype), **place),
                    {"nodata": mark},
                )
            )
    for unit, factor in (("mm", 0.001), ("cm", 0.01)):
        forms.append(Form("arrays", f"said to be {unit}", made(grid() / factor, unit=unit, **place)))
    forms.append(Form("arrays", "mm", made(grid() / 0.001, **place), {"unit": "mm"}))
    forms.append(
        Form(
            "arrays",
            "whole mm",
            made(np.nan_to_num(grid(None) * 1000).astype(np.int32), **(place)),
            {"unit": "mm"},
            hole=False,
        )
    )
    return forms + frames()


def frames() -> list[Form]:
    """Tables with coordinates."""
    pandas, forms = __import__("pandas"), []
    x, y = (
        CELL * (np.arange(count) + 0.5) + first for count, first in zip((COLUMNS, ROWS), PLACE, strict=True)
    )
    forms.append(Form("frames", "DataFrame", made(pandas.DataFrame(grid(), y, x))))
    forms.append(Form("frames", "DataFrame, north first", made(pandas.DataFrame(grid()[::-1], y[::-1], x))))
    named = pandas.DataFrame(grid().T, x, y).rename_axis(index="x", columns="y")
    forms.append(Form("frames", "DataFrame, x down", made(named)))
    forms.append(
        Form(
            "frames",
            "DataFrame without coordinates",
            made(pandas.DataFrame(grid()), spacing=CELL, origin=(PLACE[0] + CELL / 2, PLACE[1] + CELL / 2)),
        )
    )
    forms.append(
        Form(
            "frames",
            "DataFrame with wrong spacing",
            made(pandas.DataFrame(grid(), y, x), spacing=1.0),
            help="leave it out",
            knowable=False,
        )
    )
    uneven = np.array(x)
    uneven[5] += 0.2
    forms.append(
        Form(
            "frames",
            "DataFrame, uneven",
            made(pandas.DataFrame(grid(), y, uneven)),
            help="evenly spaced",
            knowable=False,
        )
    )
    try:
        import xarray
    except ImportError:
        return forms
    for title, heights, coords, dims in (
        ("", grid(), {"y": y, "x": x}, ("y", "x")),
        (", north first", grid()[::-1], {"y": y[::-1], "x": x}, ("y", "x")),
        (", x first", grid().T, {"y": y, "x": x}, ("x", "y")),
        (", easting", grid(), {"northing": y, "easting": x}, ("northing", "easting")),
    ):
        forms.append(Form("frames", f"DataArray{title}", made(xarray.DataArray(heights, coords, dims))))
    return forms


def refused() -> list[Form]:
    """Files that hold no map, and packed ones."""
    files: list[tuple[str, bytes, str]] = [
        ("a.npy", b"\x93NUMPY\x01\0", "damaged"),
        ("a.npz", b"PK\x03\x04", "damaged"),
        ("a.stl", b"solid a\n", "mesh"),
        ("a.obj", b"v 0 0 0\n", "mesh"),
        ("a.ply", b"ply\nformat ascii 1.0\n", "mesh"),
        ("a.las", b"LASF", "pdal"),
        ("a.laz", b"LASF", "pdal"),
        ("a.pcd", b"# .PCD v0.7\n", "pdal"),
        ("a.pgm", b"P5\n2 2\n255\n0000", "occupancy"),
        ("a.tif", b"version https://git-lfs.github.com/spec/v1\n", "git lfs pull"),
        ("b.tif", b"<!DOCTYPE html><html>", "web page"),
        ("c.tif", b"", "0 bytes"),
        ("a.yaml", b"image: a.pgm\nresolution: 0.05\n", "occupancy"),
        ("a.mat", b"MATLAB 5.0", "sw.Terrain"),
        ("a.shp", b"\0\0'\n", "gdal_rasterize"),
        ("a.7z", b"7z", "unpack"),
        ("a.zip", b"PK no", "unpack"),
    ]
    forms = [
        Form("refused", f"{name} {begin[:8]!r}", written(begin, name), help=words, knowable=False)
        for name, begin, words in files
    ]
    folder = lambda where: lambda **options: sw.Terrain.read(where, **options)  # noqa: E731
    forms.append(Form("refused", "folder", folder, help="gdalbuildvrt", knowable=False))

    def packed(suffix: str) -> Any:
        def make(where: Path) -> Any:
            tif(filled(np.nan), "inner.tif")(where)
            path = where / f"map.{suffix}"
            if suffix == "zip":
                with zipfile.ZipFile(path, "w") as target:
                    target.write(where / "inner.tif", "deep/inner.tif")
                    target.writestr("deep/inner.prj", "none")
            else:
                path = where / "map.tif.gz"
                path.write_bytes(gzip.compress((where / "inner.tif").read_bytes()))
            return lambda **options: sw.Terrain.read(path, **options)

        return make

    forms += [Form("refused", f"GeoTIFF in {suffix}", packed(suffix)) for suffix in ("zip", "gz")]
    return forms


def every() -> list[Form]:
    return [*texts(), *arrays(), *refused()]
