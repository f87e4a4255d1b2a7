"""Points x, y and z as text, and matrices."""

import json

import numpy as np

from tests.maps.unseen.case import NODE, Case, heights
from tests.maps.unseen.texts import FOOT, UNPLACED, X, Y, file, points, table


def every() -> list[Case]:
    """Points x, y and z, and matrices."""
    rng = np.random.default_rng(5)
    known, shuffled = points(), rng.permutation(points())
    numbered = np.c_[np.arange(len(known)), known]
    coloured = np.c_[known, rng.integers(0, 255, (len(known), 3))]
    feet = known * [1, 1, 1 / FOOT]
    local = known - [*NODE, 0]
    coarse = np.round(known, 2)
    matrix = heights()
    pivot = "\n".join(
        [",".join(["y", *(f"{x:.2f}" for x in X)])]
        + [
            ",".join([f"{y:.2f}", *("" if np.isnan(v) else f"{v:.4f}" for v in row)])
            for y, row in zip(Y, matrix, strict=True)
        ]
    )
    named = json.dumps({"x": X.tolist(), "y": Y.tolist(), "z": np.nan_to_num(matrix, nan=-9999).tolist()})
    return [
        Case("xyz", file("a.xyz", table(known, " "))),
        Case("xyz shuffled", file("a.xyz", table(shuffled, "\t"))),
        Case("xyz with nan", file("a.xyz", table(points(False), " "))),
        Case("xyz with -9999", file("a.xyz", table(points(False), " ", mark="-9999")), {"nodata": -9999.0}),
        Case("xyz of two digits", file("a.xyz", table(coarse, " ", digits=2)), close=0.01),
        Case("xyz local", file("a.xyz", table(local, " ")), node=(0.0, 0.0)),
        Case("csv east, north, elevation", file("a.csv", table(known, ",", "East,North,Elevation"))),
        Case("csv X,Y,Z quoted", file("a.csv", table(known, ",", '"X","Y","Z"'))),
        Case("csv with units", file("a.csv", table(feet, ",", "x (m),y (m),z (ft)", 5))),
        Case("csv with _ft", file("a.csv", table(feet, ",", "x_m,y_m,elev_ft", 5))),
        Case("csv with an index", file("a.csv", table(numbered, ",", ",x,y,z"))),
        Case("csv with an id", file("a.csv", table(numbered, ",", "id,easting,northing,height"))),
        Case("csv with semicolons", file("a.csv", table(known, ";", "x;y;z").replace(".", ","))),
        Case("csv with an empty height", file("a.csv", table(points(False), ",", "x,y,z", mark=""))),
        Case("csv, blanks behind commas", file("a.csv", table(known, ", ", "x, y, z"))),
        Case("csv in UTF-16", file("a.csv", table(known, ",", "x,y,z").encode("utf-16"))),
        Case(
            "csv CRLF and a blank end",
            file("a.csv", table(known, ",", "x,y,z").replace("\n", "\r\n") + "\r\n\r\n"),
        ),
        Case("csv with comments", file("a.csv", "# made by a scanner\n" + table(known, ",", "x,y,z"))),
        Case("csv x_coord", file("a.csv", table(known, ",", "x_coord,y_coord,elevation"))),
        Case("csv ALTITUDE", file("a.csv", table(known[:, [2, 1, 0]], ",", "ALTITUDE,NORTHING,EASTING"))),
        Case("csv of poses", file("a.csv", table(numbered, ",", "t,vx,vy,omega")), remedy="x, y and z"),
        Case("txt CloudCompare", file("a.txt", table(coloured, " ", "//X Y Z R G B"))),
        Case("pts", file("a.pts", table(coloured, " ", str(len(known))))),
        Case("GRASS r.out.xyz", file("a.txt", table(known, "|"))),
        Case("lon, lat", file("a.csv", table(known, ",", "lon,lat,alt")), remedy="degrees"),
        Case(
            "scattered",
            file("a.xyz", table(known + rng.uniform(-0.1, 0.1, known.shape), " ")),
            remedy="gdal_grid",
        ),
        Case("two columns", file("a.xyz", table(known[:, :2], " ")), remedy="columns|matrix|list|spacing"),
        Case("matrix", file("a.txt", table(matrix, " ")), UNPLACED | {"nodata": -9999.0}),
        Case("matrix north first", file("a.csv", table(matrix[::-1])), UNPLACED | {"north_up": True}),
        Case("matrix tabs", file("m.dat", table(matrix, "\t", mark="-9999")), UNPLACED | {"nodata": -9999.0}),
        Case("matrix .tsv", file("m.tsv", table(matrix, "\t")), UNPLACED),
        Case("matrix below a title", file("m.txt", "# heights\n" + table(matrix, " ")), UNPLACED),
        Case("matrix with coordinates", file("a.csv", pivot)),
        Case("json", file("a.json", named), remedy="json|JSON|sw.Terrain"),
        Case("geojson", file("a.geojson", '{"type": "FeatureCollection", "features": []}'), remedy="gdal_"),
    ]
