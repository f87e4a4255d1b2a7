"""The ground as DataArrays of xarray, and as NetCDF, Zarr and HDF5 that they and h5py write."""

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.unseen.arrays import PLACE, made, with_mark
from tests.maps.unseen.case import COLUMNS, NODE, STEP, Case, heights
from tests.maps.unseen.texts import FOOT, UNPLACED, X, Y


def labelled() -> list[Case]:
    """DataArrays of xarray, and NetCDF, HDF5 and Zarr that it writes."""
    if not importlib.util.find_spec("xarray"):
        return []
    import xarray as xr

    z = xr.DataArray(heights(), {"y": Y, "x": X}, ("y", "x"), name="z")
    named = z.rename(y="northing", x="easting")
    lonlat = z.rename(y="lat", x="lon")
    whole = xr.DataArray(with_mark(-1, np.int32, 0.01), z.coords, z.dims, name="z")
    cases = [
        Case("xarray", made(z)),
        Case("xarray transposed", made(z.T)),
        Case("xarray north first", made(z[::-1])),
        Case("xarray both ways", made(z[::-1, ::-1])),
        Case("xarray easting", made(named)),
        Case("xarray with a time", made(z.expand_dims("time")), remedy="isel"),
        Case("xarray scalar time", made(z.assign_coords(time=0))),
        Case("xarray dataset", made(z.to_dataset()), remedy='dataset["z"]'),
        Case("xarray lon lat", made(lonlat), remedy="degrees"),
        Case("xarray in feet", made((z / FOOT).assign_attrs(units="ft"))),
        Case("xarray in feet, long_name", made((z / FOOT).assign_attrs(long_name="elevation [ft]"))),
        Case("xarray in parsec", made(z.assign_attrs(units="parsec")), remedy="unit"),
        Case("xarray depth", made((-z).assign_attrs(positive="down"))),
        Case("xarray coordinates in km", made(_in_km(z))),
        Case("xarray scaled", made(whole.assign_attrs(scale_factor=0.01, _FillValue=-1)), close=0.01),
        Case(
            "xarray uneven",
            made(z.assign_coords(x=NODE[0] + np.arange(COLUMNS) ** 1.2)),
            remedy="evenly|interpolate",
        ),
        Case("xarray without coordinates", made(z.drop_vars(["x", "y"]), **PLACE)),
        Case("xarray other names", made(z.rename(x="a", y="b")), remedy="rename"),
        Case("xarray with spacing that differs", made(z, spacing=1.0), remedy="leave it out"),
    ]

    def written(name: str, array: Any, **more: Any) -> Any:
        def make(folder: Path) -> Any:
            path = folder / name
            if name.endswith("zarr"):
                array.to_dataset().to_zarr(path, zarr_format=2)
            else:
                array.to_netcdf(path, **more)
            return lambda **options: sw.Terrain.read(path, **options)

        return make

    three = z.to_dataset().assign(slope=z * 0, aspect=z * 0 + 1)
    classic: dict[str, Any] = (
        {"engine": "scipy"} if not importlib.util.find_spec("netCDF4") else {"format": "NETCDF3_64BIT"}
    )
    for ends, more in (
        ((".nc", classic), (" 4.nc", {})) if importlib.util.find_spec("netCDF4") else ((".nc", classic),)
    ):
        cases += [
            Case(f"NetCDF{ends}", written(f"a{ends}", z, **more)),
            Case(f"NetCDF{ends} north first", written(f"a{ends}", z[::-1], **more)),
            Case(f"NetCDF{ends} x backwards", written(f"a{ends}", z[:, ::-1], **more)),
            Case(f"NetCDF{ends} easting", written(f"a{ends}", named, **more)),
            Case(f"NetCDF{ends} transposed", written(f"a{ends}", z.T, **more)),
            Case(f"NetCDF{ends} in feet", written(f"a{ends}", (z / FOOT).assign_attrs(units="feet"), **more)),
            Case(
                f"NetCDF{ends} depth",
                written(f"a{ends}", (-z).assign_attrs(positive="down", units="m"), **more),
            ),
            Case(f"NetCDF{ends} several", written(f"a{ends}", three, **more)),
            Case(
                f"NetCDF{ends} topo and more",
                written(f"a{ends}", three.rename(z="relief"), **more),
                {"band": "relief"},
            ),
            Case(f"NetCDF{ends} lon lat", written(f"a{ends}", lonlat, **more), remedy="degrees"),
            Case(f"NetCDF{ends} in km", written(f"a{ends}", _in_km(z), **more)),
            Case(f"NetCDF{ends} of a time", written(f"a{ends}", z.expand_dims(time=[0.0]), **more)),
            Case(
                f"NetCDF{ends} uneven",
                written(f"a{ends}", z.assign_coords(x=NODE[0] + STEP * np.arange(COLUMNS) ** 1.2), **more),
                remedy="evenly|interpolat",
            ),
            Case(
                f"NetCDF{ends} without coordinates",
                written(f"a{ends}", z.drop_vars(["x", "y"]), **more),
                UNPLACED | {"north_up": False},
            ),
            Case(
                f"NetCDF{ends} north first without coordinates",
                written(f"a{ends}", z[::-1].drop_vars(["x", "y"]), **more),
                UNPLACED | {"north_up": True},
            ),
            Case(
                f"NetCDF{ends} packed",
                written(
                    f"a{ends}",
                    z.assign_attrs(),
                    encoding={
                        "z": {"dtype": "i2", "scale_factor": 0.01, "add_offset": 200.0, "_FillValue": -1}
                    },
                    **more,
                ),
                close=0.01,
            ),
            Case(
                f"NetCDF{ends} mark without a name",
                written(f"a{ends}", z.fillna(-9999.0), **more),
                {"nodata": -9999.0},
            ),
        ]
    if importlib.util.find_spec("zarr"):
        cases.append(Case("Zarr of xarray", written("a.zarr", z)))
    if importlib.util.find_spec("rioxarray"):
        cases += _placed_by_rioxarray(z)
    return cases


def _in_km(z: Any) -> Any:
    z = z.assign_coords(x=X / 1000, y=Y / 1000)
    for name in "xy":
        z.coords[name].attrs["units"] = "km"
    return z


def _placed_by_rioxarray(z: Any) -> list[Case]:
    import rioxarray  # noqa: F401

    placed = z.rio.write_crs("EPSG:25832")
    degrees = z.assign_coords(x=9 + X * 1e-9, y=48 + Y * 1e-9).rio.write_crs("EPSG:4326")
    return [
        Case("rioxarray", made(placed)),
        Case("rioxarray in degrees", made(degrees), remedy="degrees"),
        Case("rioxarray nodata", made(placed.fillna(-9999.0).rio.write_nodata(-9999.0))),
    ]


def hdf5() -> list[Case]:
    """Plain HDF5."""
    if not importlib.util.find_spec("h5py"):
        return []
    import h5py

    def written(**arrays: Any) -> Any:
        def make(folder: Path) -> Any:
            path = folder / "a.h5"
            with h5py.File(path, "w") as target:
                for name, values in arrays.items():
                    target[name] = values
            return lambda **options: sw.Terrain.read(path, **options)

        return make

    return [
        Case("HDF5", written(z=heights()), UNPLACED | {"north_up": False}),
        Case(
            "HDF5 with x and y", written(z=heights(), x=X, y=Y), UNPLACED | {"north_up": False, "band": "z"}
        ),
        Case(
            "HDF5 of two", written(a=heights(), b=heights() * 0), UNPLACED | {"north_up": False, "band": "a"}
        ),
    ]


def every() -> list[Case]:
    return [*labelled(), *hdf5()]
