"""The ground as arrays of NumPy, in memory and in files, and as tables of pandas and polars."""

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from tests.maps.unseen.case import NODE, STEP, Case, heights
from tests.maps.unseen.texts import FOOT, UNPLACED, X, Y, points

PLACE: dict[str, Any] = {"spacing": STEP, "origin": NODE}


def made(values: Any, **given: Any) -> Any:
    return lambda folder: lambda **options: sw.Terrain(values, **(given | options))


def with_mark(mark: float, dtype: Any = np.float64, factor: float = 1.0) -> Any:
    values = np.where(np.isnan(heights()), mark, heights() / factor)
    return (np.round(values) if np.issubdtype(dtype, np.integer) else values).astype(dtype)


def plain() -> list[Case]:
    """Arrays of NumPy and lists."""
    z = heights()
    bare = {"remedy": "reshape|two rows"}
    cases = [
        Case("big-endian", made(z.astype(">f8"), **PLACE)),
        Case("half precision", made(z.astype(np.float16), **PLACE), close=0.07),
        Case("a view with strides", made(np.repeat(np.repeat(z, 2, 0), 2, 1)[::2, ::2], **PLACE)),
        Case("read only", made(_frozen(z), **PLACE)),
        Case("nested tuples", made(tuple(map(tuple, z)), **PLACE)),
        Case("objects", made(z.astype(object), **PLACE), remedy="astype"),
        Case("None for unknown", made([[None if np.isnan(v) else v for v in row] for row in z], **PLACE)),
        Case("texts", made(z.astype(str), **PLACE), remedy="numbers"),
        Case("masked", made(np.ma.masked_invalid(z), **PLACE)),
        Case(
            "masked integers",
            made(np.ma.masked_equal(with_mark(-1, np.int32, 0.01), -1), **PLACE),
            {"unit": "cm"},
            close=0.01,
        ),
        Case(
            "masked with its mark beside",
            made(np.ma.masked_equal(with_mark(-9999.0), 7.0), **PLACE),
            {"nodata": -9999.0},
        ),
        Case("north up", made(z[::-1], **PLACE, north_up=True)),
        Case(
            "north up, negative dy",
            made(z[::-1], origin=NODE, spacing=(STEP, -STEP)),
            {"north_up": True, "spacing": STEP},
        ),
        Case("no spacing", made(z, origin=NODE), {"spacing": STEP}),
        Case("spacing as an array", made(z, origin=np.array(NODE), spacing=np.array([STEP, STEP]))),
        Case("spacing as an int array of cm", made(z * 100, origin=NODE, spacing=STEP), {"unit": "cm"}),
        Case("unit mm", made(z * 1000, **PLACE), {"unit": "mm"}),
        Case("unit given", made(z / FOOT, **PLACE, unit="ft")),
        Case("bands first", made(z[None], **PLACE), remedy=r"src.read(1)"),
        Case("bands last", made(z[..., None], **PLACE), remedy="heights[:, :, 0]"),
        Case("flat", made(z.ravel(), **PLACE), remedy="reshape"),
        Case("points", made(points(), **PLACE), remedy="reshape|grid them"),
        Case("points turned", made(points().T.copy(), **PLACE), remedy="reshape|grid them"),
        Case("all points", made(points(False), **PLACE), remedy="reshape"),
        Case("a picture", made((z - 200).astype(np.uint8), **PLACE), remedy="picture"),
        Case("booleans", made(z > 0, **PLACE), remedy="numbers|real"),
        Case("complex", made(z * 1j, **PLACE), remedy="numbers|real"),
        Case("ragged", made([[1.0, 2.0], [3.0]], **PLACE), remedy="rows|rectang|shape"),
        Case("a path", made(Path("a.tif"), **PLACE), remedy="Terrain.read"),
        Case("a number", made(3.0, **PLACE), **bare),
        Case("nothing", made([], **PLACE), **bare),
        Case("None", made(None, **PLACE), remedy="array|numbers|two rows"),
        Case("a structured array", made(_structured(), **PLACE), remedy="numbers|real|field"),
        Case("all -9999", made(np.full(z.shape, -9999.0), **PLACE), remedy="no height is known"),
        Case("infinite for unknown", made(with_mark(np.inf), **PLACE), remedy="finite|nan where unknown"),
    ]
    for mark in (
        -9999.0,
        -32768.0,
        1e20,
        -3.4028234663852886e38,
        9.969209968386869e36,
        -99999.0,
        1e30,
        65535.0,
        0.0,
    ):
        for dtype in (np.float32, np.float64):
            cases.append(
                Case(f"{mark:g} {np.dtype(dtype)}", made(with_mark(mark, dtype), **PLACE), {"nodata": mark})
            )
    return cases


def _frozen(z: Any) -> Any:
    z = z.copy()
    z.flags.writeable = False
    return z


def _structured() -> Any:
    table = np.zeros(9, [("x", float), ("y", float), ("z", float)])
    return table


def files() -> list[Case]:
    """Arrays of NumPy in files."""

    def saved(name: str, *values: Any, **arrays: Any) -> Any:
        def make(folder: Path) -> Any:
            path = folder / name
            (np.save(path, *values) if values else np.savez(path, **arrays))
            return lambda **options: sw.Terrain.read(path, **options)

        return make

    z = heights()
    return [
        Case("npy", saved("a.npy", z), UNPLACED),
        Case("npy north first", saved("a.npy", z[::-1]), UNPLACED | {"north_up": True}),
        Case(
            "npy with a mark", saved("a.npy", with_mark(-9999.0, np.float32)), UNPLACED | {"nodata": -9999.0}
        ),
        Case(
            "npy in mm",
            saved("a.npy", with_mark(-1e6, np.int32, 0.001)),
            UNPLACED | {"unit": "mm", "nodata": -1e6},
        ),
        Case("npy of points", saved("a.npy", points())),
        Case("npy of bands", saved("a.npy", z[None]), remedy="src.read(1)"),
        Case("npy of objects", saved("a.npy", np.array([{}, 1], object)), remedy="no array of numbers"),
        Case("npy of texts", saved("a.npy", np.array(["a", "b"])), remedy="real numbers"),
        Case("npy of pixels", saved("a.npy", (z - 200).astype(np.uint8)), remedy="picture"),
        Case("npz", saved("a.npz", heights=z), UNPLACED),
        Case("npz of two", saved("a.npz", slope=z * 0, dem=z), UNPLACED),
        Case("npz of others", saved("a.npz", a=z * 0, b=z), UNPLACED | {"band": "b"}),
        Case("npz with x and y", saved("a.npz", x=X, y=Y, z=z)),
        Case("npz with y downwards", saved("a.npz", x=X, y=Y[::-1], z=z[::-1])),
        Case("npz with meshes", saved("a.npz", x=np.meshgrid(X, Y)[0], y=np.meshgrid(X, Y)[1], z=z)),
        Case("npz of points", saved("a.npz", x=points()[:, 0], y=points()[:, 1], z=points()[:, 2])),
        Case("npz of nothing", saved("a.npz", n=np.zeros(())), remedy="rows and columns"),
    ]


def tables() -> list[Case]:
    """DataFrames of pandas and polars."""
    cases = []
    if importlib.util.find_spec("pandas"):
        import pandas as pd

        frame = pd.DataFrame(heights(), index=pd.Index(Y, name="y"), columns=pd.Index(X, name="x"))
        rows = pd.DataFrame(points(), columns=["x", "y", "z"])
        cases += [
            Case("pandas pivot", made(frame)),
            Case("pandas pivot, north first", made(frame[::-1])),
            Case("pandas pivot turned", made(frame.T)),
            Case("pandas without names", made(pd.DataFrame(heights(), index=Y, columns=X))),
            Case("pandas columns as text", made(pd.DataFrame(heights(), index=Y, columns=X.astype(str)))),
            Case("pandas range", made(pd.DataFrame(heights()), **PLACE)),
            Case("pandas points", made(rows)),
            Case("pandas points shuffled", made(rows.sample(frac=1, random_state=1))),
            Case(
                "pandas easting",
                made(rows.rename(columns={"x": "Easting", "y": "Northing", "z": "Elevation"})),
            ),
            Case("pandas with more columns", made(rows.assign(intensity=1.0))),
            Case("pandas units", made((rows * [1, 1, 1 / FOOT]).rename(columns={"z": "z_ft"}))),
            Case("pandas long, stacked", made(frame.stack()), remedy="unstack"),
            Case("pandas single", made(frame.astype(np.float32)), close=0.05),
            Case("pandas nullable", made(pd.DataFrame(heights()).convert_dtypes(), **PLACE)),
            Case(
                "pandas of words",
                made(pd.DataFrame({"a": ["b"] * 4, "c": ["d"] * 4}), **PLACE),
                remedy="numbers",
            ),
        ]
    if importlib.util.find_spec("polars"):
        import polars as pl

        rows = pl.DataFrame(dict(zip(("x", "y", "z"), points().T, strict=True)))
        cases += [
            Case("polars points", made(rows)),
            Case("polars lazy", made(rows.lazy()), remedy="collect"),
            Case("polars matrix", made(pl.DataFrame(heights()), **PLACE)),
        ]
    return cases


def every() -> list[Case]:
    return [*plain(), *files(), *tables()]
