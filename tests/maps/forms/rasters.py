"""The ground as NetCDF and what else GDAL writes."""

from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.forms.ground import CELL, COLUMNS, PLACE, ROWS, Form, grid
from tests.maps.forms.images import MARS, filled, north_up, tif


def netcdf(
    dims: tuple[str, str] = ("y", "x"),
    standard: bool = True,
    unit: str = "m",
    positive: str = "",
    extra: bool = False,
) -> Any:
    """NetCDF of the classic form."""

    def make(folder: Path) -> Any:
        from scipy.io import netcdf_file

        path = folder / "map.nc"
        factor = {"m": 1.0, "cm": 0.01}[unit] * (-1.0 if positive == "down" else 1.0)
        with netcdf_file(path, "w") as target:
            for name, count, first in (("x", COLUMNS, PLACE[0]), ("y", ROWS, PLACE[1])):
                target.createDimension(name, count)
                axis = target.createVariable(name, "f8", (name,))
                axis[:] = CELL * (np.arange(count) + 0.5) + first
                if standard:
                    axis.standard_name, axis.units = f"projection_{name}_coordinate", "m"
            for name in ("z", "slope") if extra else ("z",):
                variable = target.createVariable(name, "f8", dims)
                heights = np.nan_to_num(grid() / factor, nan=-9999.0)
                variable[:] = heights if dims == ("y", "x") else heights.T
                variable._FillValue, variable.units = -9999.0, unit
                if positive:
                    variable.positive = positive
        return lambda **options: sw.Terrain.read(path, **options)

    return make


def rasters() -> list[Form]:
    """NetCDF and what else GDAL reads."""
    forms = [
        Form("rasters", "NetCDF", netcdf()),
        Form("rasters", "NetCDF without CF attributes", netcdf(standard=False)),
        Form("rasters", "NetCDF in cm", netcdf(unit="cm")),
        Form("rasters", "NetCDF positive down", netcdf(positive="down")),
        Form("rasters", "NetCDF of two variables", netcdf(extra=True), {"band": "z"}),
        Form("rasters", "NetCDF with x first", netcdf(dims=("x", "y")), help="ncpdq", knowable=False),
        # It was read as it lies: coordinates without attributes are not in the metadata.
        Form("rasters", "NetCDF with x first, no attributes", netcdf(dims=("x", "y"), standard=False)),
    ]
    for driver, suffix, mark in (
        ("GSAG", "grd", 1.70141e38),
        ("GSBG", "grd", 1.70141e38),
        ("GS7BG", "grd", 1.70141e38),
        ("ENVI", "bin", -9999.0),
        ("ISIS3", "cub", None),
        ("RRASTER", "grd", -9999.0),
        ("SAGA", "sdat", -9999.0),
        ("PCRaster", "map", None),
        ("AAIGrid", "asc", -9999.0),
        ("XYZ", "xyz", None),
        ("netCDF", "nc", -9999.0),
    ):
        if mark is not None:
            whole = {"crs": None} if driver.startswith("GS") else {}
            forms.append(Form("rasters", driver, copied(driver, suffix, mark, **whole)))
    mars = {"crs": MARS.format(40), "transform": north_up(100.0, 2.37e6)}
    forms.append(Form("rasters", "PDS4", copied("PDS4", "xml", -9999.0, **mars), place=(100.0, 2.37e6)))
    return forms


def copied(driver: str, suffix: str, mark: float, **more: Any) -> Any:
    """A GeoTIFF copied to another form by GDAL."""

    def make(folder: Path) -> Any:
        import rasterio.shutil

        tif(filled(mark), "first.tif", nodata=mark, **more)(folder)
        path = folder / f"map.{suffix}"
        rasterio.shutil.copy(folder / "first.tif", path, driver=driver)
        return lambda **options: sw.Terrain.read(path, **options)

    return make
