"""Forms that were read wrongly or refused without help when they were first seen, and their like."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.unseen.case import COLUMNS, NODE, ROWS, STEP, Case, heights
from tests.maps.unseen.images import SURVEY_FOOT, placement
from tests.maps.unseen.texts import FOOT, UNPLACED, X, Y, file, grid, points, table

NORTH = heights()[::-1]
TRANSFORM = placement("north up", NODE, (STEP, STEP), 1.0)[1]


def tif(
    cells: Any,
    name: str = "map.tif",
    unit: str = "",
    called: str = "",
    tags: dict[str, str] | None = None,
    beside: Callable[[Path], None] = lambda path: None,
    **profile: Any,
) -> Any:
    """Writes one band and what is beside it; reads it."""
    cells = np.asarray(cells)
    given = {"driver": "GTiff", "crs": "EPSG:25832", "transform": TRANSFORM, "count": 1} | profile

    def make(folder: Path) -> Any:
        import rasterio

        path = folder / name
        with rasterio.open(path, "w", height=ROWS, width=COLUMNS, dtype=cells.dtype, **given) as dataset:
            dataset.write(cells, 1)
            dataset.units = [unit]
            if called:
                dataset.set_band_description(1, called)
            dataset.update_tags(**(tags or {}))
        beside(path)
        return lambda **options: sw.Terrain.read(path, **options)

    return make


def units() -> list[Case]:
    """Units of heights in the words of files, in sidecars, tags and names."""
    words = {
        "METERS": 1.0, "m above geoid": 1.0, "metre (ellipsoid)": 1.0, "decimeters": 0.1,
        "ft (US)": SURVEY_FOOT,
        "U.S. survey foot": SURVEY_FOOT, "Foot_US": SURVEY_FOOT, "international feet": FOOT, "FT": FOOT,
        "centimetre": 0.01, "yards": 3 * FOOT, "mètres": 1.0, "m a.s.l.": 1.0,
    }  # fmt: skip

    def sidecar(path: Path) -> None:
        band = '<PAMRasterBand band="1"><UnitType>ft</UnitType></PAMRasterBand>'
        other = path.with_name(path.name + ".aux.xml")
        other.write_text(f"<PAMDataset>{band}</PAMDataset>")

    feet, depth = NORTH / FOOT, {"positive": "down"}
    return [
        *(Case(word, tif(NORTH / size, unit=word), {"unit": size}) for word, size in words.items()),
        Case("unit in a sidecar", tif(feet, beside=sidecar)),
        Case("Z_UNITS", tif(feet, tags={"Z_UNITS": "feet"})),
        Case("vertical_units", tif(NORTH / SURVEY_FOOT, tags={"vertical_units": "US survey feet"})),
        Case("positive down", tif(-NORTH, tags=depth)),
        Case("Elevation (US survey foot)", tif(NORTH / SURVEY_FOOT, called="Elevation (US survey foot)")),
        Case("elevation_ft", tif(feet, called="elevation_ft"), {"unit": "ft"}),
        Case("called cm", tif(NORTH * 100, "dem-cm.tif"), {"unit": "cm"}),
        Case("cells of 5 cm", tif(NORTH, "dem_5_cm.tif")),
        Case("tile of 32 km", tif(NORTH, "tile_32_km.tif")),
    ]


def marks() -> list[Case]:
    """Marks of unknown heights that are no common ones."""
    cases = []
    for mark in (-9999.9, -888888.0, -10000.0, -1.0, -500.0, 8888.0, 1e6, -1e10):
        cells = np.nan_to_num(NORTH, nan=mark)
        cases.append(Case(f"mark {mark:g}", tif(cells), {"nodata": mark}))
    both = np.where(np.isnan(NORTH) & (np.arange(COLUMNS) < 6), -32768, np.nan_to_num(NORTH, nan=-9999))
    cases.append(Case("two marks", tif(both), {"nodata": (-9999, -32768)}))
    return cases


def tables() -> list[Case]:
    """Tables and matrices of text as programs write them."""
    known, matrix = points(), heights()
    in_feet = table(known / [1, 1, FOOT], digits=5)
    exponents = "\n".join(" ".join(f"{v:.8E}".replace("E", "D") for v in row) for row in known)
    texts = "\n".join(f"P{k},{x:.4f},{y:.4f},{z:.4f}" for k, (x, y, z) in enumerate(known))
    columns, rows = ",".join(map(str, range(COLUMNS))), table(matrix, mark="").splitlines()
    crossed = [f"{y:.1f},{row}" for y, row in zip(Y, rows, strict=True)]
    decimals = table(matrix, ";", mark="").replace(".", ",")
    return [
        Case("units in a second line", file("a.csv", "x,y,z\nm,m,m\n" + table(known))),
        Case("feet in a second line", file("a.csv", "x,y,z\nm,m,ft\n" + in_feet)),
        Case("exponents of Fortran", file("a.xyz", exponents)),
        Case("sep=;", file("a.csv", "sep=;\n" + table(known, ";", "x;y;z"))),
        Case("names of points", file("a.csv", f"Point,X,Y,Z\n{texts}")),
        Case("pos.x", file("a.csv", table(known, ",", "pos.x,pos.y,pos.z"))),
        Case("Height (cm)", file("a.csv", table(known * [1, 1, 100], ",", "X,Y,Height (cm)"))),
        Case(
            "key of others", file("a.asc", grid().replace("nodata_value", "byteorder LSBFIRST\nnodata_value"))
        ),
        Case("matrix of decimal commas", file("a.csv", decimals), UNPLACED),
        Case("matrix below its columns", file("a.csv", "\n".join([columns, *rows])), UNPLACED),
        Case(
            "matrix with counted rows and columns",
            file("a.csv", "\n".join([f",{columns}", *(f"{k},{row}" for k, row in enumerate(rows))])),
            UNPLACED,
        ),
        Case("crossed", file("a.csv", "\n".join([",".join(["", *(f"{x:.1f}" for x in X)]), *crossed[::-1]]))),
    ]


def label(unit: str, size: float) -> Any:
    """An image of PDS 3 with its label beside it."""

    def make(folder: Path) -> Any:
        cells = np.where(np.isnan(NORTH), -3.4028226550889045e38, NORTH / size).astype("<f4")
        (folder / "A.IMG").write_bytes(cells.tobytes())
        (folder / "A.LBL").write_text(
            LABEL.format(bytes=4 * COLUMNS, rows=ROWS, columns=COLUMNS, unit=unit, step=STEP, last=ROWS - 1)
        )
        return lambda **options: sw.Terrain.read(folder / "A.IMG", **options)

    return make


LABEL = """PDS_VERSION_ID = PDS3\r
RECORD_TYPE = FIXED_LENGTH\r
RECORD_BYTES = {bytes}\r
FILE_RECORDS = {rows}\r
^IMAGE = "A.IMG"\r
OBJECT = IMAGE\r
 LINES = {rows}\r
 LINE_SAMPLES = {columns}\r
 SAMPLE_TYPE = PC_REAL\r
 SAMPLE_BITS = 32\r
 UNIT = "{unit}"\r
 MISSING_CONSTANT = 16#FF7FFFFB#\r
END_OBJECT = IMAGE\r
OBJECT = IMAGE_MAP_PROJECTION\r
 MAP_PROJECTION_TYPE = "EQUIRECTANGULAR"\r
 A_AXIS_RADIUS = 3396.19 <KM>\r
 B_AXIS_RADIUS = 3396.19 <KM>\r
 C_AXIS_RADIUS = 3396.19 <KM>\r
 CENTER_LATITUDE = 0.0 <DEG>\r
 CENTER_LONGITUDE = 0.0 <DEG>\r
 MAP_SCALE = {step} <METERS/PIXEL>\r
 LINE_PROJECTION_OFFSET = {last}\r
 SAMPLE_PROJECTION_OFFSET = 0\r
END_OBJECT = IMAGE_MAP_PROJECTION\r
END\r
"""


def labels() -> list[Case]:
    """Units by the keyword UNIT of PDS 3."""
    sizes = {"METER": 1.0, "KILOMETER": 1000.0, "FEET": FOOT, "CENTIMETER": 0.01}
    true: dict[str, Any] = {"node": (0.0, 0.0), "close": 0.02}
    named = [Case(f"PDS 3 in {unit}", label(unit, size), **true) for unit, size in sizes.items()]
    return [*named, Case("PDS 3 in N/A", label("N/A", 1.0), **true)]


def arrays() -> list[Case]:
    """Arrays of NumPy in files, rows along x."""

    def make(folder: Path) -> Any:
        np.savez_compressed(folder / "a.npz", elevation=heights().T, x=X, y=Y)
        return lambda **options: sw.Terrain.read(folder / "a.npz", **options)

    return [Case("npz with rows along x", make)]


def every() -> list[Case]:
    return [*units(), *marks(), *tables(), *labels(), *arrays()]
