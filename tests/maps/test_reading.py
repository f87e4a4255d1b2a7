"""Maps from files keep their place, know what they do not know, and say what is wrong in one line."""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.maps import TerrainFileError

# Of rasterio, about a sign of the library it makes transforms with.
pytestmark = pytest.mark.filterwarnings("ignore:Use `@` matmul:PendingDeprecationWarning")
SHARED = Path(__file__).parents[3] / "shared" / "data" / "terrain"
CORNER = "xllcorner 0\nyllcorner 0\n"
HEIGHTS = np.arange(20, dtype=np.float32).reshape(4, 5) / 8  # exact in single precision


def write_tif(path: Path, heights: Any, transform: Any, crs: Any = "EPSG:32633", **more: Any) -> Path:
    rasterio = pytest.importorskip("rasterio", reason="needs rasterio")
    profile = {"driver": "GTiff", "count": 1, "dtype": heights.dtype, "crs": crs, "transform": transform}
    with rasterio.open(
        path, "w", height=heights.shape[0], width=heights.shape[1], **profile, **more
    ) as target:
        target.write(heights, 1)
    return path


def multiply(first: Any, *others: Any) -> Any:
    """Affine transforms, by a sign that its versions agree on."""
    matrix = np.reshape(first, (3, 3))
    for other in others:
        matrix = matrix @ np.reshape(other, (3, 3))
    return type(first)(*matrix[:2].ravel())


def at(transform: Any, column: float, row: float) -> Any:
    return (np.reshape(transform, (3, 3)) @ (column, row, 1))[:2]


def north_up(x: float = 500_000.0, y: float = 4_000_000.0, size: float = 0.5) -> Any:
    affine = pytest.importorskip("affine", reason="needs rasterio")
    return affine.Affine(size, 0, x, 0, -size, y)


def test_an_image_keeps_its_place(tmp_path: Path) -> None:
    ground = sw.Terrain.read(write_tif(tmp_path / "dtm.tif", HEIGHTS, north_up()))
    assert ground.spacing == (0.5, 0.5)
    assert ground.heights.dtype == np.float32
    # Pixel (0, 0) is the corner in the north-west; heights stand for the middle of their pixels.
    assert ground.height_at((500_000.25, 3_999_999.75)) == HEIGHTS[0, 0]
    assert ground.height_at((500_002.25, 3_999_998.25)) == HEIGHTS[3, 4]


def test_a_turned_image_keeps_its_place(tmp_path: Path) -> None:
    affine = pytest.importorskip("affine", reason="needs rasterio").Affine
    for place in (affine.rotation(30), multiply(affine.rotation(-100), affine.scale(1, -1))):
        transform = multiply(affine.translation(10, 20), place, affine.scale(0.5, 0.25))
        path = write_tif(tmp_path / "turned.tif", HEIGHTS, transform)
        ground = sw.Terrain.read(path)
        for row, column in ((0, 0), (3, 4), (2, 1)):
            place, middle = at(transform, column + 0.5, row + 0.5), at(transform, 2.5, 2.0)
            inwards = (place - middle) * (1 - 1e-9) + middle
            assert ground.height_at(inwards) == pytest.approx(HEIGHTS[row, column], abs=1e-6)


def test_what_an_image_does_not_know_is_nan(tmp_path: Path) -> None:
    heights = HEIGHTS.copy()
    heights[1, 2] = -9999
    ground = sw.Terrain.read(write_tif(tmp_path / "holes.tif", heights, north_up(), nodata=-9999))
    assert np.isnan(ground.heights).sum() == 1
    whole = (HEIGHTS * 8).astype(np.int16)
    ground = sw.Terrain.read(write_tif(tmp_path / "whole.tif", whole, north_up(), nodata=7))
    assert np.isnan(ground.heights).sum() == 1
    assert np.nanmax(ground.heights) == 19


def test_a_window_is_that_part(tmp_path: Path) -> None:
    random = np.random.default_rng(1).standard_normal((60, 70)).astype(np.float32)
    path = write_tif(tmp_path / "map.tif", random, north_up(0, 30))
    whole = sw.Terrain.read(path)
    part = sw.Terrain.read(path, window=(10.1, 8.3, 20.2, 12.9))
    assert part.shape[0] < 14
    points = np.random.default_rng(2).uniform((10.1, 8.3), (20.2, 12.9), (100, 2))
    np.testing.assert_allclose(part.height_at(points), whole.height_at(points), atol=1e-12)
    with pytest.raises(TerrainFileError, match=r"window must overlap the map, got .* the map has x 0 to 35"):
        sw.Terrain.read(path, window=(100, 100, 110, 110))
    with pytest.raises(ValueError, match="window must be x_min, y_min, x_max, y_max in order"):
        sw.Terrain.read(path, window=(2, 2, 1, 3))


def test_a_map_in_degrees_is_refused(tmp_path: Path) -> None:
    path = write_tif(tmp_path / "degrees.tif", HEIGHTS, north_up(14, 50, 1e-5), crs="EPSG:4326")
    with pytest.raises(TerrainFileError, match=r"degrees\.tif must be in metres, its coord"):
        sw.Terrain.read(path)
    grid = tmp_path / "grid.asc"
    grid.write_text("ncols 2\nnrows 2\nxllcorner 14\nyllcorner 50\ncellsize 0.00001\n1 2\n3 4\n")
    with pytest.raises(
        TerrainFileError,
        match="coordinates look like degrees: .* gdalwarp -s_srs EPSG:4326 -t_srs EPSG:32633",
    ):
        sw.Terrain.read(grid)
    grid.write_text("ncols 2\nnrows 2\nxllcorner 14\nyllcorner 50\ncellsize 1\n1 2\n3 4\n")
    grid.with_suffix(".prj").write_text('GEOGCS["WGS 84"]')
    with pytest.raises(TerrainFileError, match="its coordinates are degrees"):
        sw.Terrain.read(grid)


def test_an_esri_grid_begins_in_the_north(tmp_path: Path) -> None:
    path = tmp_path / "grid.asc"
    path.write_text(
        "NCOLS 3\nNROWS 2\nXLLCORNER 10\nYLLCORNER 20\nCELLSIZE 2\nNODATA_value -9999\n1 2 3\n4 -9999 6\n"
    )
    ground = sw.Terrain.read(path)
    assert ground.origin == (11, 21)
    np.testing.assert_array_equal(ground.heights, [[4, np.nan, 6], [1, 2, 3]])
    centred = tmp_path / "centred.asc"
    centred.write_text(path.read_text().replace("CORNER", "CENTER"))
    assert sw.Terrain.read(centred).origin == (10, 20)
    assert sw.Terrain.read(path, window=(12, 20, 16, 24)).shape == (2, 3)


def test_a_list_of_heights_runs_along_x(tmp_path: Path) -> None:
    path = tmp_path / "surface.txt"
    path.write_text("0,2,3,10,11,2,1,2,3,4,5,6")
    ground = sw.Terrain.read(path)
    assert (ground.origin, ground.spacing) == ((0, 10), (1, 1))
    np.testing.assert_array_equal(ground.heights, [[1, 2, 3], [4, 5, 6]])


@pytest.mark.skipif(not SHARED.exists(), reason="needs the recorded grids")
def test_recorded_grids_are_read_whole() -> None:
    for path in sorted(SHARED.glob("*.txt")):
        ground = sw.Terrain.read(path)
        assert ground.spacing in ((0.05, 0.05), (0.1, 0.1))
        assert np.isfinite(ground.heights).all()


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.asc", "ncols 2\nnrows 2\n1 2 3 4", "must give ncols, nrows and cellsize"),
        ("a.asc", "ncols 2\nnrows 2\ncellsize 1\n1 2 3", "must hold 2 x 2 heights, got 3"),
        ("a.asc", "ncols two\n", r"a\.asc:1: ncols must be a number"),
        ("a.asc", "ncols 2\nnrows 2\ncellsize 1\n1 2 3 x", "it has 'x' where a height belongs"),
        ("a.asc", "ncols 2\nnrows 2\ncellsize 1\n1 2 3 4", r"has no xllcorner and yllcorner: origin="),
        ("a.asc", f"{CORNER}ncols 2\nnrows 1\ncellsize 1\n1 2", "at least two rows and two columns"),
        ("a.asc", f"{CORNER}ncols 2\nnrows 0\ncellsize 1\n1 2", "must have whole ncols and nrows"),
        ("a.asc", f"{CORNER}ncols nan\nnrows 2\ncellsize 1\n1 2", "must have whole ncols and nrows"),
        ("a.asc", f"{CORNER}ncols 2\nnrows 2\ncellsize -1\n1 2 3 4", "spacing must be finite and positive"),
        ("a.txt", "1,2,3", "must begin with x min, x max, x count"),
        ("a.txt", "0,1,2,0,1,2,1,2,3", "must hold 2 x 2 heights, got 3"),
        ("a.txt", "0,1,1.5,0,1,2,1,2,3", "must have at least two x and y"),
        ("a.txt", "hello world", "is no map as text: it has 'hello' where a height belongs"),
        ("a.txt", "\xff\xfe", "is empty"),
        ("a.tif", "no image", r"a\.tif must be a map"),
    ],
)
def test_broken_files_are_named(name: str, text: str, message: str, tmp_path: Path) -> None:
    if name.endswith(".tif"):
        pytest.importorskip("rasterio", reason="needs rasterio")
    path = tmp_path / name
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(TerrainFileError, match=message) as caught:
        sw.Terrain.read(path)
    assert "\n" not in str(caught.value)
    deep = tmp_path / "deep.yaml"
    deep.write_text("[" * 10_000)
    with pytest.raises(TerrainFileError, match="deep.yaml must be YAML, its brackets are nested too deep"):
        sw.Terrain.read(deep)
    with pytest.raises(FileNotFoundError, match="there is none"):
        sw.Terrain.read(tmp_path / "nothing.tif")


def test_a_missing_library_names_the_install_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "a.tif").write_bytes(b"II")
    (tmp_path / "a.mcap").write_bytes(b"MCAP")
    monkeypatch.setitem(sys.modules, "rasterio", None)
    with pytest.raises(ImportError, match=r'pip install "six-wheel\[terrain\]"'):
        sw.Terrain.read(tmp_path / "a.tif")
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(ImportError, match=r'pip install "six-wheel\[bags\]"'):
        sw.Terrain.read(tmp_path / "a.mcap")


def test_a_yard_is_its_seed() -> None:
    one, same = sw.Terrain.yard((10, 8), 0.1, 0.1, seed=4), sw.Terrain.yard((10, 8), 0.1, 0.1, seed=4)
    assert one == same
    assert one != sw.Terrain.yard((10, 8), 0.1, 0.1, seed=5)
    assert one.shape == (81, 101)
    # Values of the first time it was made: the same on every platform.
    assert [float(one.heights[k, k]) for k in (0, 40, 80)] == YARD


YARD = [0.12, 0.0658, 0.0213]


def test_a_yard_is_as_rough_as_it_says() -> None:
    sizes = [
        float(np.std(sw.Terrain.yard(40, 0.2, 0.0, seed=seed, roughness=0.2).heights)) for seed in range(20)
    ]
    assert 0.12 < float(np.sqrt(np.mean(np.square(sizes)))) < 0.25
    # Hurst 0.7: over twice the distance, heights differ by 2^0.7 as much.
    heights = np.stack([sw.Terrain.yard(40, 0.1, 0.0, seed=seed).heights for seed in range(10)])
    spread = [np.sqrt(np.mean((heights[..., lag:] - heights[..., :-lag]) ** 2)) for lag in (8, 16, 32, 64)]
    steps = np.log2(np.divide(spread[1:], spread[:-1]))
    np.testing.assert_allclose(steps.mean(), 0.7, atol=0.12)


@pytest.mark.parametrize("cover", [0.05, 0.1, 0.2])
def test_rocks_cover_what_they_should(cover: float) -> None:
    shares = [
        np.mean(sw.Terrain.yard(25, 0.025, cover, seed=seed, roughness=0.0).heights > 0) for seed in range(2)
    ]
    q = 1.79 + 0.152 / cover
    expected = cover * (math.exp(-q * 0.05) - math.exp(-q * 3.0))
    # Rocks overlap, and the smallest are hardly wider than two cells.
    assert 0.75 * expected < np.mean(shares) < 1.1 * expected


def test_a_grid_coarser_than_the_noise_has_none() -> None:
    """It was a division by zero."""
    assert not sw.Terrain.yard(300.0, 50.0, 0.0).heights.any()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": -1}, "size must be one or two lengths"),
        ({"spacing": 0.0}, "spacing must be positive and at most the size"),
        ({"cover": 0.7}, "cover must be from 0 to 0.5, got 0.7"),
        ({"seed": -1}, "seed must be a whole number from 0, got -1"),
        ({"roughness": math.nan}, "roughness must be finite and not negative"),
        ({"size": 1e6, "spacing": 1e3}, r"size must make at most 100,000,000 rocks, got 5.21e\+12"),
        ({"size": 1e6, "spacing": 0.01}, r"spacing must make at most 1,000,000,000 heights"),
    ],
)
def test_yards_that_make_no_sense_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sw.Terrain.yard(**options)


@pytest.mark.parametrize("cut", [b"}", b")", b"'shape'", b"<f8"])
def test_damaged_headers_of_arrays(tmp_path: Path, cut: bytes) -> None:
    """A brace that was lost ended in an error of Python's tokenizer."""
    path = tmp_path / "map.npy"
    np.save(path, np.zeros((4, 4)))
    path.write_bytes(path.read_bytes().replace(cut, b"(" * len(cut), 1))
    with pytest.raises(ValueError, match=r"map\.npy is no array of numbers, or damaged: "):
        sw.Terrain.read(path, spacing=0.1)
