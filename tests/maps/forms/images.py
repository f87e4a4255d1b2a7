"""The ground as GeoTIFF and other images."""

from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.forms.ground import CELL, COLUMNS, PLACE, ROWS, Form, grid

UTM = "EPSG:32633"
LATITUDE = 45.0


def affine(a: float, b: float, c: float, d: float, e: float, f: float) -> Any:
    from affine import Affine

    return Affine(a, b, c, d, e, f)


def north_up(x: float = PLACE[0], y: float = PLACE[1], cell: float = CELL) -> Any:
    return affine(cell, 0, x, 0, -cell, y + cell * ROWS)


def tif(
    bands: Any,
    name: str = "map.tif",
    unit: str | None = None,
    names: Any = (),
    scale: Any = None,
    tags: Any = None,
    colours: bool = False,
    **profile: Any,
) -> Any:
    """Writes bands whose first row is the northern one; reads them by `sw.Terrain.read`."""
    bands = np.asarray(bands)
    bands = bands[None] if bands.ndim == 2 else bands
    settings = {"driver": "GTiff", "crs": UTM, "transform": north_up()} | profile

    def make(folder: Path) -> Any:
        import rasterio

        path, (count, rows, columns) = folder / name, bands.shape
        given = {key: value for key, value in settings.items() if value is not None}
        shape = {"count": count, "height": rows, "width": columns, "dtype": bands.dtype}
        with rasterio.open(path, "w", **shape, **given) as target:
            target.write(bands)
            if unit is not None:
                target.units = [unit] * count
            for band, title in enumerate(names, 1):
                target.set_band_description(band, title)
            if scale is not None:
                target.scales, target.offsets = [scale[0]] * count, [scale[1]] * count
            if tags is not None:
                target.update_tags(1, **tags)
            if colours:
                target.write_colormap(1, {k: (k, k, k, 255) for k in range(256)})
        return lambda **options: sw.Terrain.read(path, **options)

    return make


def filled(fill: float, dtype: Any = np.float32, factor: float = 1.0) -> Any:
    """Heights north first, times a factor, the hole with a mark."""
    heights = grid() / factor
    whole = np.issubdtype(dtype, np.integer)
    return np.where(np.isnan(heights), fill, np.round(heights) if whole else heights)[::-1].astype(dtype)


def numbers() -> list[Form]:
    """Types and units of GeoTIFF."""
    forms = []
    for dtype in (np.float32, np.float64):
        forms.append(Form("numbers", f"{np.dtype(dtype)}", tif(filled(np.nan, dtype))))
    for name, factor in (
        ("m", 1),
        ("metre", 1),
        ("metres", 1),
        ("cm", 0.01),
        ("mm", 0.001),
        ("km", 1000),
        ("ft", 0.3048),
        ("foot", 0.3048),
        ("feet", 0.3048),
        ("US survey foot", 1200 / 3937),
        ("centimeters", 0.01),
        ("millimetres", 0.001),
        ("decimetre", 0.1),
        ("inch", 0.0254),
    ):
        forms.append(Form("numbers", f"band unit {name}", tif(filled(np.nan, np.float64, factor), unit=name)))
    forms.append(
        Form(
            "numbers",
            "band unit fathom",
            tif(filled(np.nan, np.float64, 1.8288), unit="fathom"),
            {"unit": 1.8288},
        )
    )
    for factor in (0.01, 0.001):
        for dtype in (np.int16, np.int32, np.uint16):
            close = 2e-3 + factor
            forms.append(
                Form(
                    "numbers",
                    f"whole {factor} {np.dtype(dtype)}",
                    tif(filled(0, dtype, factor)),
                    {"unit": factor, "nodata": 0},
                    close=close,
                    help="unit=",
                )
            )
            forms.append(
                Form(
                    "numbers",
                    f"whole scaled {factor} {np.dtype(dtype)}",
                    tif(filled(0, dtype, factor), scale=(factor, 0.0), nodata=0),
                    close=close,
                )
            )
    forms.append(
        Form(
            "numbers",
            "scale and offset",
            tif(filled(-1, np.int16, 0.01), scale=(0.01, 0.0), nodata=-1),
            close=0.02,
        )
    )
    forms.append(Form("numbers", "mm said nothing", tif(filled(np.nan, np.float32, 0.001)), {"unit": "mm"}))
    eight = np.clip(grid(None)[::-1] * 10, 0, 255).astype(np.uint8)
    picture = {"help": "picture", "knowable": False}
    forms.append(Form("numbers", "picture of one band", tif(eight), **picture))
    forms.append(Form("numbers", "palette", tif(eight, colours=True), **picture))
    for count in (3, 4):
        forms.append(Form("numbers", f"picture of {count} bands", tif(np.stack([eight] * count)), **picture))
    forms.append(
        Form("numbers", "complex", tif(filled(0, np.complex64)), help="real numbers", knowable=False)
    )
    return forms


def nodata() -> list[Form]:
    """Marks of unknown heights."""
    forms = []
    marks = (
        -9999.0,
        -32768.0,
        -32767.0,
        -99999.0,
        -3.4028234663852886e38,
        1e20,
        1e30,
        3.4028234663852886e38,
        0.0,
        255.0,
        9999.0,
        -999.0,
        32767.0,
    )
    for mark in marks:
        forms.append(Form("nodata", f"{mark:g} tagged", tif(filled(mark), nodata=mark)))
        if abs(mark) > 256:
            forms.append(Form("nodata", f"{mark:g} without a tag", tif(filled(mark)), {"nodata": mark}))
            forms.append(
                Form(
                    "nodata", f"{mark:g} beside another tag", tif(filled(mark), nodata=-1e6), {"nodata": mark}
                )
            )
    forms.append(Form("nodata", "nan tagged", tif(filled(np.nan), nodata=np.nan)))
    forms.append(Form("nodata", "nan", tif(filled(np.nan))))
    forms.append(Form("nodata", "infinite", tif(filled(np.inf))))
    forms.append(Form("nodata", "-9999 with 1e-6 beside", tif(filled(-9999.004)), {"nodata": -9999.0}))
    return forms


def layouts() -> list[Form]:
    """Places and bands of GeoTIFF."""
    forms, plain = [], filled(np.nan)
    slopes = np.full_like(plain, 0.1)
    turned = affine(CELL, 0, PLACE[0], 0, CELL, PLACE[1])
    forms.append(Form("layout", "south up", tif(plain[::-1], transform=turned)))
    mirrored = affine(-CELL, 0, PLACE[0] + CELL * COLUMNS, 0, -CELL, PLACE[1] + CELL * ROWS)
    forms.append(Form("layout", "from the east", tif(plain[:, ::-1], transform=mirrored)))
    for angle in (0.3, -1.0, 2.0):
        cos, sin = np.cos(angle), np.sin(angle)
        a, d = CELL * cos, CELL * sin
        b, e = CELL * sin, -CELL * cos
        c, f = PLACE[0] - ROWS * b, PLACE[1] - ROWS * e
        forms.append(
            Form("layout", f"turned {angle}", tif(plain, transform=affine(a, b, c, d, e, f)), turn=angle)
        )
    forms.append(
        Form(
            "layout",
            "sheared",
            tif(plain, transform=affine(CELL, 0.1, PLACE[0], 0, -CELL, PLACE[1])),
            help="gdalwarp",
            knowable=False,
        )
    )
    for more in (
        {"tiled": True, "blockxsize": 16, "blockysize": 16},
        {"compress": "deflate"},
        {"compress": "lzw"},
        {"bigtiff": "YES"},
        {"AREA_OR_POINT": "Point"},
        {"interleave": "band"},
    ):
        forms.append(Form("layout", str(more), tif(plain, **more)))
    forms.append(
        Form("layout", "no place", tif(plain, transform=None, crs=None), {"spacing": CELL}, place=None)
    )
    forms.append(
        Form("layout", "no place but a system", tif(plain, transform=None), {"spacing": CELL}, place=None)
    )
    two = np.stack((slopes, plain))
    forms.append(Form("layout", "two bands", tif(two), {"band": 2}))
    for name in ("elevation", "height", "DEM", "dtm", "z"):
        forms.append(Form("layout", f"two bands, one {name}", tif(two, names=("slope", name))))
    forms.append(
        Form(
            "layout", "two bands with other names", tif(two, names=("slope", "surface")), {"band": "surface"}
        )
    )
    for name in ("map.vrt", "map.img", "map.bil", "map.ers"):
        driver = {"map.vrt": None, "map.img": "HFA", "map.bil": "EHdr", "map.ers": "ERS"}[name]
        if driver is not None:
            mark = -9999.0
            forms.append(Form("layout", driver, tif(filled(mark), name, driver=driver, nodata=mark)))
    return forms


FEET = 'LOCAL_CS["site",UNIT["foot",0.3048]]'
MARS = (
    'PROJCS["Mars",GEOGCS["Mars",DATUM["Mars",SPHEROID["Mars",3396190,0]],PRIMEM["Reference",0],'
    'UNIT["degree",0.0174532925199433]],PROJECTION["Equirectangular"],PARAMETER["standard_parallel_1",{}],'
    'PARAMETER["central_meridian",0],UNIT["metre",1]]'
)


def systems() -> list[Form]:
    """Coordinate reference systems."""
    forms, plain = [], filled(np.nan)
    for code in (32633, 32733, 3035, 2056, 25832, 5514):
        place = {2056: (2.6e6, 1.2e6), 3035: (4.3e6, 3.2e6), 5514: (-7.4e5, -1.04e6)}.get(code, PLACE)
        forms.append(
            Form(
                "system",
                f"EPSG:{code}",
                tif(plain, crs=f"EPSG:{code}", transform=north_up(*place)),
                place=place,
            )
        )
    for code in (4326, 4258, 4269):
        degrees = affine(1e-5, 0, 14.0, 0, -1e-5, 50.0)
        forms.append(
            Form(
                "system",
                f"EPSG:{code}",
                tif(plain, crs=f"EPSG:{code}", transform=degrees),
                help="gdalwarp -t_srs EPSG:32633",
                knowable=False,
            )
        )
    foot = 1200 / 3937
    state = (6e5, 2e5)
    for code, unit in ((2263, foot), (2229, foot)):
        there = north_up(state[0] / unit, state[1] / unit, CELL / unit)
        forms.append(
            Form(
                "system",
                f"EPSG:{code} in feet",
                tif(plain, crs=f"EPSG:{code}", transform=there, unit="m"),
                place=state,
            )
        )
    forms.append(
        Form(
            "system",
            "local in feet",
            tif(plain, crs=FEET, transform=north_up(PLACE[0] / 0.3048, PLACE[1] / 0.3048, CELL / 0.3048)),
        )
    )
    forms.append(Form("system", "local in metres", tif(plain, crs='LOCAL_CS["site",UNIT["metre",1]]')))
    forms.append(Form("system", "none", tif(plain, crs=None)))
    for vertical, factor in (("5703", 1.0), ("6360", foot), ("8228", 0.3048)):
        forms.append(
            Form(
                "system",
                f"vertical EPSG:{vertical}",
                tif(filled(np.nan, np.float64, factor), crs=f"EPSG:32633+{vertical}"),
            )
        )
    for y in (5_621_521.0, 8_000_000.0):
        there = (1_500_000.0, y)
        forms.append(
            Form(
                "system",
                f"Web Mercator {y:g}",
                tif(plain, crs="EPSG:3857", transform=north_up(*there)),
                place=there,
            )
        )
    for parallel in (0, 40):
        for there in ((0.0, 0.0), (100.0, 2.37e6), (100.0, 4_600_000.0)):
            forms.append(
                Form(
                    "system",
                    f"Mars {parallel} {there}",
                    tif(plain, crs=MARS.format(parallel), transform=north_up(*there)),
                    place=there,
                )
            )
    moon = MARS.format(0).replace("3396190", "1737400").replace("Mars", "Moon")
    forms.append(Form("system", "Moon", tif(plain, crs=moon, transform=north_up(0, 0)), place=(0.0, 0.0)))
    moon_degrees = moon[moon.index("GEOGCS") : moon.index(",PROJECTION")]
    forms.append(
        Form(
            "system",
            "Moon in degrees",
            tif(plain, crs=moon_degrees, transform=affine(1e-5, 0, 14, 0, -1e-5, 50)),
            help=r"\+proj=eqc .*\+R=1737400",
            knowable=False,
        )
    )
    return forms


def pictures() -> list[Form]:
    """Pictures of 16 and 8 bits."""
    forms = []
    counts = np.round(grid(None)[::-1] * 100).astype(np.uint16)
    answer = {"spacing": CELL, "unit": 0.01}
    for name, driver in (("map.png", "PNG"),):
        forms.append(
            Form(
                "pictures",
                f"{driver} of 16 bits",
                tif(counts, name, driver=driver, transform=None, crs=None),
                answer,
                place=None,
                hole=False,
                close=0.02,
                help="spacing=|unit=",
            )
        )
        forms.append(
            Form(
                "pictures",
                f"{driver} of 16 bits with a world file",
                tif(counts, name, driver=driver, crs=None, worldfile="YES"),
                {"unit": 0.01},
                hole=False,
                close=0.02,
            )
        )
    eight = (counts // 20).astype(np.uint8)
    for name, driver in (("map.jpg", "JPEG"), ("map.png", "PNG"), ("map.bmp", "BMP")):
        forms.append(
            Form(
                "pictures",
                f"{driver} of 8 bits",
                tif(eight, name, driver=driver, transform=None, crs=None),
                help="picture|spacing=",
                knowable=False,
            )
        )
        forms.append(
            Form(
                "pictures",
                f"{driver} of 8 bits, three bands",
                tif(np.stack([eight] * 3), name, driver=driver, transform=None, crs=None),
                help="picture",
                knowable=False,
            )
        )
    return forms


def every() -> list[Form]:
    return [*numbers(), *nodata(), *layouts(), *systems(), *pictures()]
