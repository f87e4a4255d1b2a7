"""ESRI ASCII grids and what programs make of them."""

import bz2
import gzip

from tests.maps.unseen.case import NODE, STEP, Case
from tests.maps.unseen.texts import FOOT, file, grid


def every() -> list[Case]:
    """ESRI ASCII grids and what their programs make of them."""
    corner = {"xllcorner": None, "yllcorner": None}
    feet = {"xllcorner": (NODE[0] - STEP / 2) / FOOT, "yllcorner": (NODE[1] - STEP / 2) / FOOT}
    feet |= {"cellsize": STEP / FOOT}
    prj = (
        'PROJCS["p",GEOGCS["g",DATUM["d",SPHEROID["s",6378137,298.25]],UNIT["degree",0.0174]],UNIT["{}",{}]]'
    )
    crs = 'COMPD_CS["c",{},VERT_CS["v",VERT_DATUM["d",2005],UNIT["{}",{}]]]'
    wide = grid().replace(" ", "   ").replace("\n", "  \n")
    sci = "\n".join(
        " ".join("-9999" if v == -9999 else f"{v:.6E}" for v in map(float, row.split())) if k > 5 else row
        for k, row in enumerate(grid().splitlines())
    )
    return [
        Case("ten numbers a line", file("a.asc", grid(line=10))),
        Case("one line", file("a.asc", grid(line=10_000))),
        Case("wide", file("a.asc", wide)),
        Case(
            "capitals and colons",
            file("A.ASC", grid().replace("ncols", "NCOLS:").replace("cellsize", "CellSize")),
        ),
        Case("exponents", file("a.asc", sci)),
        Case("CR alone", file("a.asc", grid().replace("\n", "\r"))),
        Case("mark nan said nan", file("a.asc", grid("nan", nodata_value="nan"))),
        Case("mark -9999.0 said -9999", file("a.asc", grid("-9999.000000"))),
        Case("mark 1e+30", file("a.asc", grid("1e+30", nodata_value="1e+30"))),
        Case("mark without its line", file("a.asc", grid("-32767", nodata_value=None)), {"nodata": -32767.0}),
        Case("mark -88", file("a.asc", grid("-88", nodata_value="-88"))),
        Case("center", file("a.asc", grid(xllcenter=NODE[0], yllcenter=NODE[1], **corner))),
        Case("no corners", file("a.asc", grid(**corner)), {"origin": NODE}),
        Case("gzip", file("a.asc.gz", gzip.compress(grid().encode()))),
        Case("bzip2", file("a.asc.bz2", bz2.compress(grid().encode())), remedy="unpack"),
        Case("feet by .prj", file("a.asc", grid(**feet), prj=prj.format("Foot", FOOT))),
        Case(
            "heights in feet by VERT_CS",
            file("a.asc", grid(factor=FOOT, digits=5), prj=crs.format(prj.format("metre", 1), "Foot", FOOT)),
        ),
        Case("heights in mm", file("a.asc", grid(factor=0.001)), {"unit": "mm"}),
        Case("heights in cm", file("a.asc", grid(factor=0.01)), {"unit": "cm"}),
        Case("named _cm", file("site_cm.asc", grid(factor=0.01)), {"unit": "cm"}),
        Case("named _ft", file("site_ft.asc", grid(factor=FOOT, digits=5)), {"unit": "ft"}),
        Case("named feet", file("dem-elevation-feet.asc", grid(factor=FOOT, digits=5)), {"unit": "ft"}),
        Case("degrees", file("a.asc", grid(xllcorner=9.1, yllcorner=48.2, cellsize=4e-6)), remedy="gdalwarp"),
        Case(
            "degrees by .prj",
            file("a.asc", grid(), prj='GEOGCS["g",UNIT["degree",0.0174]]'),
            remedy="gdalwarp",
        ),
        Case("short", file("a.asc", grid()[:-400]), remedy="heights, got"),
        Case("long", file("a.asc", grid() + "1 2 3\n"), remedy="heights, got"),
        Case("a word", file("a.asc", grid().replace("213", "abc", 1)), remedy="where a height belongs"),
        Case("no cellsize", file("a.asc", grid(cellsize=None)), remedy="must give ncols, nrows and cellsize"),
        Case("a header without a number", file("a.asc", grid(cellsize="")), remedy="must be a number"),
        Case("suffix .dem", file("a.dem", grid())),
        Case("suffix .txt", file("a.txt", grid())),
        Case("no suffix", file("elevation", grid())),
        Case("suffix .ascii", file("a.ascii", grid())),
    ]
