"""Options for what a map leaves open: the same in Python, on the command line and in a file of parameters."""

import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.maps import TerrainFileError, traverse
from tests.cli_runs import Run
from tests.maps.forms.ground import CELL, Form, grid, is_right
from tests.maps.forms.images import filled, north_up, tif
from tests.maps.forms.others import esri, written

rasterio = pytest.importorskip("rasterio", reason="needs rasterio")
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")

UNPLACED: dict[str, Any] = {"spacing": CELL, "unit": "mm", "nodata": -9999}
FORM = Form("", "", lambda folder: sw.Terrain.read, place=None)


def unplaced(folder: Path) -> Path:
    tif(np.where(filled(-9999) == -9999, -9999, filled(-9999) * 1000), transform=None, crs=None)(folder)
    return folder / "map.tif"


def test_python_and_files_of_parameters_agree(tmp_path: Path) -> None:
    path = unplaced(tmp_path)
    ground = sw.Terrain.read(path, **UNPLACED)
    assert is_right(ground, FORM)
    described = tmp_path / "map.yaml"
    described.write_text("map: map.tif\nspacing: 0.5\nunit: mm\nnodata: -9999\n")
    assert sw.Terrain.read(described) == ground
    moved = sw.Terrain.read(described, origin=(3.0, 4.0))
    assert moved.origin == (3.0, 4.0)
    described.write_text("map: map.tif\nspacings: 0.5\n")
    with pytest.raises(TerrainFileError, match="must hold map, the name of a file, and options among window"):
        sw.Terrain.read(described)


def test_every_question_is_asked_before_anything_is_computed(tmp_path: Path) -> None:
    path, suspension, output = unplaced(tmp_path), sw.RockerBogie.preset("perseverance"), tmp_path / "out.tif"
    options: dict[str, Any] = {}
    for name, value in (("spacing", CELL), ("nodata", -9999), ("unit", "mm")):
        with pytest.raises(TerrainFileError, match=rf"{name}=") as told:
            sw.Terrain.read(path, **options)
        with pytest.raises(TerrainFileError) as same:
            traverse(path, suspension, output, headings=1, workers=1, **options)
        assert str(same.value) == str(told.value)
        options[name] = value
    done = traverse(path, suspension, output, headings=1, workers=1, **options)
    assert done.cells == grid().size
    assert not (tmp_path / "out.tif.tiles").exists()


def test_the_command_line_asks_and_is_answered(run: Run, tmp_path: Path) -> None:
    path, picture = unplaced(tmp_path), tmp_path / "picture.png"
    code, _, refusal = run("show", str(path), "-o", str(picture))
    assert code != 0
    assert "--spacing 0.1" in refusal
    answers = ["--spacing", "0.5", "--unit", "mm", "--nodata", "-9999"]
    code, shown, words = run("show", str(path), "-o", str(picture), *answers)
    assert code == 0, words
    assert picture.stat().st_size > 0
    for words in ("24 x 30 of 0.5 x 0.5 m", "1.67% of the cells", "no known system"):
        assert words in shown
    commands = tmp_path / "commands.csv"
    commands.write_text("time,vx,vy,omega\n0,0.1,0,0\n1,0.1,0,0\n")
    start = ["--start", "7", "3", "0"]
    code, _, words = run("simulate", "perseverance", str(commands), "--ground", str(path), *start, *answers)
    assert code == 0, words


def test_no_shadow_falls_from_unknown_cells() -> None:
    """Cells beside a hole were drawn dark and bright, as if it were filled by the mean of the map."""
    from six_wheel.plotting.ground.map import map_figure

    left = map_figure(sw.Terrain(grid(), CELL)).subfigs[0].axes[0]
    relief, shade = (np.ma.filled(image.get_array(), np.nan) for image in left.images)
    hole = np.argwhere(np.isnan(relief))
    for row, column in hole:
        assert np.isnan(shade[row - 1 : row + 2, column]).all()
        assert np.isnan(shade[row, column - 1 : column + 2]).all()
    assert len(hole)
    assert not np.isnan(shade[0, 0])


def test_marks_that_are_heights_stay_heights(tmp_path: Path) -> None:
    path = tmp_path / "map.asc"
    # A pit of one depth far below all else is a mark whatever its number; the floor of a canyon is none.
    written(esri(-500.0), "map.asc")(tmp_path)
    with pytest.raises(TerrainFileError, match=r"12 heights are -500, .*: nodata=-500"):
        sw.Terrain.read(path)
    assert np.nanmin(sw.Terrain.read(path, nodata=math.nan).heights) == -500
    canyon = np.linspace(-300.0, 0.0, 720).reshape(24, 30)
    canyon[5:8, 20:24] = -500.0
    assert sw.Terrain(canyon, 10.0).heights.min() == -500
    heights = grid(-9999.0)
    with pytest.raises(
        ValueError, match=r"12 heights are -9999, the first at row 5, column 20: nodata=-9999"
    ):
        sw.Terrain(heights, CELL)
    kept = sw.Terrain(heights, CELL, nodata=math.nan)
    assert kept.heights.min() == -9999
    assert kept.replace(yaw=0.1).heights.min() == -9999


def test_stretched_projections_are_told_with_both_factors(tmp_path: Path) -> None:
    tif(filled(np.nan), crs="EPSG:3857", transform=north_up(1.5e6, 5_621_521.0))(tmp_path)
    with pytest.warns(match=r"distances 1\.4\d\d times as long along x and 1\.4\d\d along y .*EPSG:32633"):
        sw.Terrain.read(tmp_path / "map.tif")
    tif(filled(np.nan))(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sw.Terrain.read(tmp_path / "map.tif")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"unit": "parsec"},
            "unit must be m, cm, mm, dm, km, ft, us-ft, in or its length in metres, got 'parsec'",
        ),
        ({"unit": -1}, "unit must be m, cm"),
        ({"nodata": "a"}, "nodata must be a number, got 'a'"),
        ({"spacing": (1, -1)}, "spacing must be finite and positive, .*north_up=True"),
        ({"spacing": (1, 1, 1)}, "spacing must be two numbers"),
        ({"origin": 3}, "origin must be two numbers, got 3"),
        ({"band": 7}, "has no band 7, it has 1"),
        ({"spacing": 1.0}, "has a place of its own: leave spacing out"),
        # These were in words of Python and NumPy, or taken for a yes.
        ({"window": 5}, "window must be x_min, y_min, x_max, y_max, all finite, got 5"),
        ({"window": (None,) * 4}, "window must be x_min, y_min, x_max, y_max, all finite, got "),
        ({"north_up": "no"}, "north_up must be True or False, got 'no'"),
        ({"north_up": np.zeros(2)}, "north_up must be True or False, got array"),
        ({"spacing": [[1.0], [1.0, 2.0]]}, r"spacing must be a number, got \[1.0\]"),
    ],
)
def test_wrong_options_are_named(options: dict[str, Any], message: str, tmp_path: Path) -> None:
    tif(filled(np.nan))(tmp_path)
    with pytest.raises(ValueError, match=message):
        sw.Terrain.read(tmp_path / "map.tif", **options)
