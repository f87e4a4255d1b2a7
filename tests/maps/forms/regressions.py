"""Forms that were once read wrongly, refused without help, or ended in a traceback."""

import gzip
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.forms.ground import CELL, COLUMNS, PLACE, ROWS, Form, grid, middles
from tests.maps.forms.images import affine, filled, tif
from tests.maps.forms.others import PROJECTED, esri, made, written

FOOT = 0.3048
MIDDLE = (PLACE[0] + CELL / 2, PLACE[1] + CELL / 2)
IN_FEET = {"xllcorner": PLACE[0] / FOOT, "yllcorner": PLACE[1] / FOOT, "cellsize": CELL / FOOT}
VERTICAL = ',VERTCS["v",VDATUM["d"],PARAMETER["Direction",{}],UNIT["{}",{}]]'
REFUSED: dict[str, Any] = {"knowable": False}


def zipped(**files: str) -> Any:
    def make(folder: Path) -> Any:
        path = folder / "map.zip"
        with zipfile.ZipFile(path, "w") as target:
            for name, text in files.items():
                target.writestr(name.replace("__", "."), text)
            target.writestr("__MACOSX/._a.asc", "x")
        return lambda **options: sw.Terrain.read(path, **options)

    return make


def images() -> list[Form]:
    plain, slopes = filled(np.nan), np.full((ROWS, COLUMNS), 0.1, np.float32)
    opacity = np.where(np.isnan(plain), 0, 255).astype(np.float32)
    degrees = affine(1 / 3600, 0, 11.3, 0, -1 / 3600, 47.9)
    flat = (np.nan_to_num(plain) * 1e-7).astype(np.float32)
    forms = [
        Form("images", "a band of opacity in floats", tif(np.stack((filled(0), opacity)), ALPHA="YES")),
        Form("images", "mark in the metadata", tif(filled(-77), tags={"missing_value": "-77"})),
        Form("images", "unit as [m]", tif(plain, unit="[m]")),
        Form("images", "unit in a tag", tif(filled(np.nan, factor=0.001), tags={"unit": "mm"})),
        Form("images", "named slope", tif(slopes, names=("slope",)), help="slope, no heights", **REFUSED),
        Form("images", "all unknown", tif(plain * np.nan), help="no known height", **REFUSED),
        Form("images", "degrees unsaid", tif(flat, crs=None, transform=degrees), help="degrees", **REFUSED),
        Form(
            "images",
            "no place, from the south",
            tif(plain[::-1], transform=None, crs=None),
            {"spacing": CELL, "north_up": False},
            place=None,
        ),
        Form(
            "images",
            "zeros far below",
            tif(filled(0) + np.where(filled(0) == 0, 0, 1200).astype(np.float32)),
            help="nodata=0",
            **REFUSED,
        ),
    ]
    for mark in (-2147483648.0, -9999000.0, 1e10, -1e38, 1e32):
        forms.append(Form("images", f"mark {mark:g}", tif(filled(mark)), {"nodata": mark}))
    two = filled(-9999)
    two[0, :4] = -32768
    forms.append(Form("images", "two marks", tif(two), help="nodata=-32768", **REFUSED))
    return forms


def texts() -> list[Form]:
    old = "Projection UTM\nZunits FEET\nUnits METERS\n"
    commas = esri().replace(".", ",")
    forms = [
        Form("text", "ESRI, commas between", written(esri(separator=", "), "a.asc")),
        Form("text", "ESRI, semicolons between", written(esri(separator=";").replace(".", ","), "a.asc")),
        Form("text", "ESRI, decimal commas in its head", written(commas, "a.asc")),
        Form("text", "ESRI in UTF-16", written(esri().encode("utf-16"), "a.asc")),
        Form("text", "ESRI with a comment in Latin-1", written(b"# H\xf6hen\n" + esri().encode(), "a.asc")),
        Form(
            "text",
            "ESRI without corners",
            written(esri(xllcorner=None, yllcorner=None), "a.asc"),
            {"origin": MIDDLE},
        ),
        Form("text", "ESRI with stars", written(esri(np.nan).replace("nan", "*"), "a.asc")),
        Form("text", "ESRI with 1.#QNAN", written(esri(np.nan).replace("nan", "1.#QNAN"), "a.asc")),
        Form(
            "text", ".PRJ in feet", written(esri(**IN_FEET), "a.asc", {"a.PRJ": PROJECTED.format("ft", FOOT)})
        ),
        Form(
            "text",
            "heights in feet by VERTCS",
            written(
                esri(factor=FOOT),
                "a.asc",
                {"a.prj": PROJECTED.format("m", 1.0) + VERTICAL.format(1.0, "ft", FOOT)},
            ),
        ),
        Form(
            "text",
            "depths by VERTCS",
            written(
                esri(factor=-1.0),
                "a.asc",
                {"a.prj": PROJECTED.format("m", 1.0) + VERTICAL.format(-1.0, "m", 1.0)},
            ),
        ),
        Form("text", "heights in feet by ARC/INFO", written(esri(factor=FOOT), "a.asc", {"a.prj": old})),
        Form(
            "text",
            ".prj of another kind",
            written(esri(), "a.asc", {"a.prj": "EPSG:32633"}),
            help="its .prj",
            **REFUSED,
        ),
        Form(
            "text",
            "degrees unsaid",
            written(esri(xllcorner=11, yllcorner=47, cellsize=1 / 3600), "a.asc"),
            help="look like degrees",
            **REFUSED,
        ),
        Form(
            "text",
            "ZIP with .prj in feet",
            zipped(a__asc=esri(**IN_FEET), a__prj=PROJECTED.format("ft", FOOT)),
        ),
        Form(
            "text",
            "cut off gzip",
            written(gzip.compress(esri().encode())[:300], "a.asc.gz"),
            help="unpack",
            **REFUSED,
        ),
        Form("text", "no gzip", written(esri(), "a.asc.gz"), help="unpack", **REFUSED),
        Form("text", "GRASS", written(grass(), "a.asc")),
        Form(
            "text",
            "a table of a drive",
            written("time,vx\n0,1\n1,1\n2,1\n3,1\n", "a.csv"),
            help="no map|columns",
            **REFUSED,
        ),
    ]
    return forms + points()


def grass() -> str:
    edges = {
        "north": PLACE[1] + CELL * ROWS,
        "south": PLACE[1],
        "east": PLACE[0] + CELL * COLUMNS,
        "west": PLACE[0],
    }
    head = [
        f"{name}: {value}" for name, value in (edges | {"rows": ROWS, "cols": COLUMNS, "null": "*"}).items()
    ]
    rows = [" ".join("*" if np.isnan(v) else f"{v:.4f}" for v in row) for row in grid()[::-1]]
    return "\n".join([*head, *rows])


def points() -> list[Form]:
    x, y = middles()
    known = np.stack((x + PLACE[0], y + PLACE[1], grid()), -1).reshape(-1, 3)
    known = np.random.default_rng(3).permutation(known[~np.isnan(known[:, 2])])
    colours = np.c_[known, np.full((len(known), 3), 200.0)]

    def table(rows: Any, separator: str = ",", head: str = "") -> str:
        return head + "\n".join(separator.join(f"{value:.4f}" for value in row) for row in rows)

    doubled = np.concatenate((known, known[:9] + np.array([0, 0, 1])))
    swapped = known[:, [1, 0, 2]]
    forms = [
        Form(
            "points",
            "Northing, Easting",
            written(table(swapped, head="Northing,Easting,Elevation\n"), "a.csv"),
        ),
        Form("points", "names in a comment", written(table(known[:, [2, 0, 1]], " ", "# z x y\n"), "a.xyz")),
        Form(
            "points",
            "unit in its name",
            written(table(known * [1, 1, 100], head="x [m],y [m],z [cm]\n"), "a.csv"),
        ),
        Form("points", "decimal commas", written(table(known, "\t").replace(".", ","), "a.txt")),
        Form("points", "blanks and decimal commas", written(table(known, " ").replace(".", ","), "a.xyz")),
        Form("points", "colours", written(table(colours, " "), "a.xyz")),
        Form("points", "their number first", written(table(known, " ", f"{len(known)}\n"), "a.pts")),
        Form(
            "points",
            "names that say nothing",
            written(table(swapped, head="a,b,c\n"), "a.csv"),
            help="x, y and z",
            **REFUSED,
        ),
        Form(
            "points",
            "two heights at a place",
            written(table(doubled, " "), "a.xyz"),
            help="several heights at one place",
            **REFUSED,
        ),
        Form(
            "points",
            "longitudes",
            written(table(known, head="lon,lat,z\n"), "a.csv"),
            help="degrees",
            **REFUSED,
        ),
    ]
    try:
        import polars

        columns = dict(zip("xyz", known.T, strict=True))
        forms.append(Form("points", "a table of polars", made(polars.DataFrame(columns))))
    except ImportError:
        pass
    return forms


class Labelled:
    """The protocol of a DataArray of xarray."""

    def __init__(self, values: Any, dims: Any, attrs: Any = None, **coords: Any) -> None:
        self.values, self.dims, self.attrs = values, dims, attrs or {}
        self.coords = {
            name: Labelled(*value) if isinstance(value, tuple) else value for name, value in coords.items()
        }

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return np.asarray(self.values, dtype)


def labelled() -> list[Form]:
    x, y = (CELL * (np.arange(n) + 0.5) + first for n, first in zip((COLUMNS, ROWS), PLACE, strict=True))
    place: dict[str, Any] = {"spacing": CELL, "origin": MIDDLE}
    marked, whole = (
        np.nan_to_num(grid(), nan=-77.0),
        np.nan_to_num(grid() * 100, nan=-1.0).round().astype(np.int16),
    )
    axes = {"x": (x, ("x",)), "y": (y, ("y",))}
    named = {f"projection_{name}_coordinate": name for name in "xy"}
    stood = {
        short: (values, (short,), {"standard_name": standard})
        for short, values, standard in zip("ab", (x, y), named, strict=True)
    }
    system = Labelled(0, (), {"crs_wkt": 'GEOGCS["w",UNIT["degree",0.0174]]'})
    return [
        Form("labelled", "transposed without coordinates", made(Labelled(grid().T, ("x", "y")), **place)),
        Form("labelled", "transposed by standard names", made(Labelled(grid().T, ("a", "b"), **stood))),
        Form(
            "labelled",
            "names that say nothing",
            made(Labelled(grid(), ("p", "q"), p=(y, ("p",)), q=(x, ("q",)))),
            help=r"\.rename",
            **REFUSED,
        ),
        Form("labelled", "_FillValue", made(Labelled(marked, ("y", "x"), {"_FillValue": -77.0}, **axes))),
        Form(
            "labelled",
            "scale_factor",
            made(Labelled(whole, ("y", "x"), {"scale_factor": 0.01, "missing_value": -1}, **axes)),
            close=0.01,
        ),
        Form(
            "labelled",
            "a band as well",
            made(Labelled(grid()[None], ("band", "y", "x"), **axes)),
            help=r"\.isel\(band=0\)",
            **REFUSED,
        ),
        Form(
            "labelled",
            "degrees by its system",
            made(Labelled(grid(), ("y", "x"), spatial_ref=system, **axes)),
            help="degrees",
            **REFUSED,
        ),
        Form(
            "labelled",
            "marks of whole cm",
            made(np.where(whole < 0, -9999, whole), unit="cm", **place),
            {"nodata": -9999},
            close=0.01,
        ),
    ]


def every() -> list[Form]:
    return [*images(), *texts(), *labelled()]
