"""The ground as images, drawn from containers, numbers, marks, units, systems and directions."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.unseen.case import COLUMNS, NODE, ROWS, STEP, Case, heights

FOOT, SURVEY_FOOT = 0.3048, 1200 / 3937
MOON = (
    'PROJCS["Moon south",GEOGCS["Moon",DATUM["D_Moon",SPHEROID["Moon_2000",1737400,0]],'
    'PRIMEM["Reference_Meridian",0],UNIT["degree",0.0174532925199433]],PROJECTION["Polar_Stereographic"],'
    'PARAMETER["latitude_of_origin",-90],PARAMETER["central_meridian",0],UNIT["metre",1]]'
)
# System, unit of its plane [m], node [m].
SYSTEMS = {
    "UTM": ("EPSG:25832", 1.0, NODE),
    "none": (None, 1.0, (200.2, -31.8)),
    "survey feet": ("EPSG:2272", SURVEY_FOOT, (820_000.0, 72_000.0)),
    "national": ("EPSG:21781", 1.0, (602_000.2, 199_000.2)),
    "Moon": (MOON, 1.0, (3_000.2, -12_000.2)),
    "site in km": ('LOCAL_CS["site",UNIT["kilometre",1000]]', 1000.0, (1200.2, 800.2)),
}
# Unit of heights [m], and the ways in which a file says it.
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": FOOT, "km": 1000.0, "ftUS": SURVEY_FOOT}
TRANSFORMS = ("north up", "south up", "mirrored", "quarter turn", "turned", "south east first")


def placement(kind: str, node: tuple[float, float], steps: tuple[float, float], metre: float) -> Any:
    """Cells as this kind of image lays them, from those of rows northwards; the transform; the yaw."""
    from affine import Affine

    (x, y), (dx, dy) = node, steps
    west, south = x - dx / 2, y - dy / 2
    east, north = west + dx * COLUMNS, south + dy * ROWS
    lay, yaw = (lambda cells: cells[::-1]), 0.0
    numbers = (dx, 0.0, west, 0.0, -dy, north)
    if kind == "south up":
        lay, numbers = (lambda cells: cells), (dx, 0.0, west, 0.0, dy, south)
    elif kind == "mirrored":
        lay, numbers = (lambda cells: cells[::-1, ::-1]), (-dx, 0.0, east, 0.0, -dy, north)
    elif kind == "south east first":
        lay, numbers = (lambda cells: cells[:, ::-1]), (-dx, 0.0, east, 0.0, dy, south)
    elif kind == "quarter turn":
        lay, numbers = (lambda cells: cells.T), (0.0, dx, west, dy, 0.0, south)
    elif kind == "turned":
        yaw = 0.7
        cos, sin = np.cos(yaw), np.sin(yaw)
        corner = (x - cos * dx / 2 - sin * dy * (ROWS - 0.5), y - sin * dx / 2 + cos * dy * (ROWS - 0.5))
        corner = (corner[0], corner[1])
        numbers = (cos * dx, sin * dy, corner[0], sin * dx, -cos * dy, corner[1])
    return lay, Affine(*(value / metre for value in numbers)), yaw


def image(
    path: str,
    *,
    driver: str = "GTiff",
    dtype: Any = np.float32,
    kind: str = "north up",
    system: str = "UTM",
    steps: tuple[float, float] = (STEP, STEP),
    unit: str = "m",
    said: str = "nothing",
    mark: float | None = np.nan,
    tag: Any = None,
    scale: tuple[float, float] | None = None,
    beside: int = 0,
    named: str = "",
    mask: bool = False,
    count: float | None = None,
    **more: Any,
) -> tuple[Any, dict[str, Any]]:
    """A function that writes an image and reads it, and what is true of it for its case.

    `beside` is the number of other bands before that of the heights, which is called `named`; `count` the
    height of one count of whole numbers where it is no unit.
    """
    crs, metre, node = SYSTEMS[system]
    lay, transform, yaw = placement(kind, node, steps, metre)
    factor = (count or 1.0) * UNITS[unit]
    cells = heights() / factor
    if scale is not None:
        cells = (heights() / UNITS[unit] - scale[1]) / scale[0]
        factor = scale[0] * UNITS[unit]
    unknown = np.isnan(cells)
    whole = np.issubdtype(np.dtype(dtype), np.integer)
    cells = np.where(unknown, 0.0 if mask else mark, np.round(cells) if whole else cells)
    band = np.ascontiguousarray(lay(cells)).astype(dtype)
    bands = [np.full_like(band, k + 1) for k in range(beside)] + [band]

    def make(folder: Path) -> Any:
        import rasterio
        import rasterio.shutil

        target = folder / path
        direct = driver in (
            "GTiff",
            "HFA",
            "ENVI",
            "EHdr",
            "ERS",
            "PCIDSK",
            "RST",
            "SAGA",
            "ILWIS",
            "MFF",
            "KRO",
        )
        first = target if direct else folder / "first.tif"
        profile: dict[str, Any] = {"driver": driver if direct else "GTiff", "transform": transform}
        profile |= {"crs": crs, "count": len(bands), "dtype": band.dtype, "nodata": tag}
        profile |= {"height": band.shape[0], "width": band.shape[1]} | (more if direct else {})
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with rasterio.open(first, "w", **profile) as dataset:
                dataset.write(np.stack(bands))
                _say(dataset, unit if said == "band" else None, scale, named, beside + 1)
                if said == "tag":
                    dataset.update_tags(beside + 1, units={"ft": "feet", "m": "metres"}.get(unit, unit))
                if mask:
                    dataset.write_mask(np.ascontiguousarray(lay(~unknown)).astype(np.uint8) * 255)
            if not direct:
                rasterio.shutil.copy(first, target, driver=driver, **more)
                if driver != "VRT":
                    first.unlink()
        return lambda **options: sw.Terrain.read(target, **options)

    close = 3e-3 + (0.51 * factor if whole else 1e-7 * 212.0 * (4 if unit == "km" else 1))
    return make, {"node": node, "steps": steps, "yaw": yaw, "close": close}


def _say(dataset: Any, unit: str | None, scale: Any, named: str, band: int) -> None:
    if unit is not None:
        dataset.set_band_unit(band, {"ftUS": "US survey foot"}.get(unit, unit))
    if scale is not None:
        dataset.scales = [scale[0]] * dataset.count
        dataset.offsets = [scale[1]] * dataset.count
    if named:
        dataset.set_band_description(band, named)


def containers() -> list[Case]:
    """One image in every format that GDAL writes."""
    cases = []
    for driver, suffix, dtype, tag in (
        ("COG", "tif", np.float32, -9999.0),
        ("HFA", "img", np.float32, -9999.0),
        ("ENVI", "dat", np.float64, -9999.0),
        ("EHdr", "flt", np.float32, -9999.0),
        ("ERS", "ers", np.float32, -9999.0),
        ("PCIDSK", "pix", np.float32, None),
        ("RST", "rst", np.float32, -9999.0),
        ("SAGA", "sdat", np.float32, -99999.0),
        ("AAIGrid", "asc", np.float32, -9999.0),
        ("GSBG", "grd", np.float32, None),
        ("GSAG", "grd", np.float32, 1.70141e38),
        ("GS7BG", "grd", np.float64, None),
        ("ISIS3", "cub", np.float32, None),
        ("VICAR", "vic", np.float32, None),
        ("netCDF", "nc", np.float32, -9999.0),
        ("ZMap", "dat", np.float32, -9999.0),
        ("BT", "bt", np.float32, None),
        ("R", "rda", np.float32, None),
        ("ILWIS", "mpr", np.float32, None),
        ("KRO", "kro", np.float32, None),
        ("Zarr", "zarr", np.float32, -9999.0),
        ("GPKG", "gpkg", np.float32, -9999.0),
        ("SIGDEM", "sigdem", np.float64, None),
        ("RRASTER", "grd", np.float32, -9999.0),
        ("XYZ", "xyz", np.float32, None),
        ("JP2OpenJPEG", "jp2", np.int16, None),
        ("VRT", "vrt", np.float32, -9999.0),
        ("PCRaster", "map", np.float32, None),
        ("GTX", "gtx", np.float32, -88.8888),
    ):
        whole = dtype == np.int16
        mark = tag if tag is not None else (-9999.0 if whole else np.nan)
        truth = {"unit": 0.01, "nodata": mark} if whole else {"nodata": mark}
        truth |= {"spacing": STEP, "origin": NODE} if driver == "VICAR" else {}  # it keeps no place
        lossless = {"REVERSIBLE": "YES", "QUALITY": "100"}
        near = {"system": "none"}  # GTX knows no other; ZMap has no room for the digits of others
        special = {"GTX": near, "ZMap": near, "JP2OpenJPEG": lossless}.get(driver, {})
        make, true = image(
            f"map.{suffix}",
            driver=driver,
            dtype=dtype,
            mark=mark,
            tag=tag,
            count=0.01 if whole else None,
            **special,
        )
        remedy = "gdalwarp" if driver == "GTX" else ""  # it is always in degrees
        cases.append(Case(f"{driver} .{suffix}", make, truth, remedy, **true))
    return cases


def drawn(count: int, seed: int) -> list[Case]:
    """GeoTIFFs of properties drawn at random."""
    rng = np.random.default_rng(seed)

    def pick(values: Any) -> Any:
        return values[int(rng.integers(len(values)))]

    cases: list[Case] = []
    while len(cases) < count:
        dtype = pick((np.float32, np.float32, np.float64, np.int16, np.int32, np.uint16))
        kind, system = pick(TRANSFORMS), pick(list(SYSTEMS))
        unit = pick(("m", "m", "m", "cm", "mm", "ft", "km", "ftUS"))
        said = "nothing" if unit == "m" and rng.random() < 0.6 else pick(("band", "tag"))
        if unit in ("mm", "cm") and rng.random() < 0.3:
            said = "nothing"
        truth: dict[str, Any] = {} if said != "nothing" else {"unit": unit}
        scale = count_height = None
        if np.issubdtype(dtype, np.integer):
            if rng.random() < 0.5 or unit in ("km", "ft", "ftUS"):
                scale, unit = (0.01, 200.0 if dtype != np.int32 else 0.0), "m"
                said = pick(("nothing", "band"))
                truth = {"unit": unit}
            elif unit not in ("mm", "cm"):
                unit, said, truth = "cm", pick(("nothing", "band")), {"unit": "cm"}
            dtype = np.int32 if unit == "mm" else dtype
        mark = pick((-9999.0, -32768.0, 32767.0)) if dtype in (np.int16, np.int32) else 65535.0
        if not np.issubdtype(dtype, np.integer):
            mark = pick((np.nan, -9999.0, -32767.0, 1e20, -99999.0, -3.4028234663852886e38, 0.0))
        way = pick(("tag", "tag", "nothing", "mask"))
        if np.isnan(mark):
            way = "nothing"
        if mark == 0.0 and way == "nothing" and unit in ("km",):
            way = "tag"
        if way == "nothing" and not np.isnan(mark):
            truth["nodata"] = mark
        steps = pick(((STEP, STEP), (STEP, 0.25), (0.5, 1.0)))
        beside = pick((0, 0, 0, 1, 2))
        named = pick(("", "elevation", "Height", "DTM", "z"))
        if beside and not named:
            truth["band"] = beside + 1
        more = pick(
            (
                {},
                {"compress": "zstd"},
                {"tiled": True, "blockxsize": 16, "blockysize": 16},
                {"AREA_OR_POINT": "Point"},
                {"compress": "lzw", "predictor": 2},
                {"interleave": "pixel"},
                {"BIGTIFF": "YES"},
                {"ENDIANNESS": "BIG"},
                {"SPARSE_OK": True},
            )
        )
        make, true = image(
            "map.tif",
            dtype=dtype,
            kind=kind,
            system=system,
            steps=steps,
            unit=unit,
            said=said,
            mark=mark,
            tag=mark if way == "tag" else None,
            scale=scale,
            beside=beside,
            named=named,
            mask=way == "mask",
            count=count_height,
            **more,
        )
        name = f"{np.dtype(dtype)} {kind}, {system}, {unit} by {said}, {mark:g} by {way}, {scale}, "
        name += f"+{beside} {named} {more}"
        cases.append(Case(name, make, truth, **true))
    return cases
