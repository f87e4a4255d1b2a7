"""Grid maps of bags keep their place; bags that hold no usable map are refused with what to give instead."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.maps import TerrainFileError
from six_wheel.maps.readers.bags import GRID_MAP
from tests.maps.grid_map_bags import write_bag

pytest.importorskip("rosbags.highlevel", reason="needs rosbags")
CELLS = np.arange(30.0).reshape(6, 5)


@pytest.mark.parametrize("label", ["column_index", "row_index"])
@pytest.mark.parametrize("yaw", [0.0, 0.6])
def test_a_grid_map_of_a_bag_keeps_its_place(label: str, yaw: float, tmp_path: Path) -> None:
    cells = np.arange(30.0).reshape(6, 5)
    cells[3, 2] = np.nan
    path = write_bag(tmp_path / "bag", cells, (3, 1), label, yaw)
    ground = sw.Terrain.read(path)
    assert ground.shape == (5, 6)
    # Cell (0, 0) is where x and y of the map's own axes are largest.
    for row, column in ((0, 0), (5, 4), (5, 0)):
        x, y = 1.25 - 0.5 * row, 1.0 - 0.5 * column
        point = (
            3 + (math.cos(yaw) * x - math.sin(yaw) * y) * (1 - 1e-9),
            -2 + (math.sin(yaw) * x + math.cos(yaw) * y) * (1 - 1e-9),
        )
        assert ground.height_at(point) == pytest.approx(cells[row, column], abs=1e-6)
    assert np.isnan(ground.heights).sum() == 1
    with pytest.raises(TerrainFileError, match='has no layer slope, it has elevation: layer="elevation"'):
        sw.Terrain.read(path, layer="slope")
    with pytest.raises(TerrainFileError, match="has no map on /other, it has /map"):
        sw.Terrain.read(path, topic="/other")
    with pytest.raises(TerrainFileError, match="has a place of its own: leave spacing out"):
        sw.Terrain.read(path, spacing=1.0)
    assert sw.Terrain.read(path, band="elevation") == ground


@pytest.mark.parametrize(
    ("made", "options", "message"),
    [
        ({"layers": ()}, {}, r"has a map without layers on /map: record one with heights"),
        ({"layers": ("upper", "lower")}, {}, r'has several layers, upper, lower: layer="upper"'),
        (
            {"layers": ("upper", "lower")},
            {"layer": "top"},
            r'has no layer top, it has upper, lower: layer="up',
        ),
        ({"layers": ("slope",)}, {}, r'has one layer, slope, no heights \(layer="slope" takes it\)'),
        ({"topics": ("/a", "/b")}, {}, r'has several topics of maps, /a, /b: topic="/a"'),
        ({"topics": ("/a", "/b")}, {"topic": "/c"}, r'has no map on /c, it has /a, /b: topic="/a"'),
        (
            {"roll": 0.01},
            {},
            r"must hold a level map, its pose is tilted by 0\.57 degrees: transform it first",
        ),
        ({"short": 1}, {}, r"layer elevation must have 5 x 6 cells, got 29"),
        ({"messages": 0}, {}, r"has no message on /map"),
        ({"kind": "std_msgs/msg/Header"}, {}, rf"must hold a {GRID_MAP}, it has std_msgs/msg/Header"),
        ({}, {"spacing": 1.0, "north_up": True}, r"has a place of its own: leave spacing, north_up out"),
        ({}, {"unit": "parsec"}, r"unit must be m, cm"),
    ],
)
def test_bags_without_a_usable_map_are_refused(
    made: dict[str, Any], options: dict[str, Any], message: str, tmp_path: Path
) -> None:
    path = write_bag(tmp_path / "bag", CELLS, **made)
    with pytest.raises(ValueError, match=message) as caught:
        sw.Terrain.read(path, **options)
    assert "\n" not in str(caught.value)


def test_one_of_several_layers_and_topics_is_read(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "bag", CELLS, layers=("upper", "elevation"), topics=("/a", "/b"), messages=2)
    assert sw.Terrain.read(path, topic="/b").shape == (5, 6)
    assert sw.Terrain.read(path, topic="/b", layer="upper") == sw.Terrain.read(path, topic="/a")
    heights = sw.Terrain.read(path, topic="/a", unit="cm", nodata=29).heights
    assert np.nanmax(heights) == pytest.approx(0.28)
    assert np.isnan(heights).sum() == 1


@pytest.mark.parametrize("keep", [0.0, 0.01, 0.3, 0.9])
def test_a_damaged_bag_is_refused_in_one_line(keep: float, tmp_path: Path) -> None:
    path = write_bag(tmp_path / "bag", CELLS)
    file = next(path.glob("*.db3"))
    data = file.read_bytes()
    file.write_bytes(data[: int(len(data) * keep)])
    with pytest.raises(TerrainFileError, match="must be a bag|must hold|has no message|is empty") as caught:
        sw.Terrain.read(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["a.bag", "a.mcap", "a.db3"])
def test_bytes_that_are_no_bag_are_refused_in_one_line(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    for data in (b"\xc1" * 300, b"SQLite format 3\0" + b"\0" * 300, b"#ROSBAG V2.0\n" + b"\xff" * 90):
        path.write_bytes(data)
        with pytest.raises(TerrainFileError, match="must be a bag|must hold") as caught:
            sw.Terrain.read(path)
        assert "\n" not in str(caught.value)
    path.write_bytes(b"")
    with pytest.raises(TerrainFileError, match="is empty"):
        sw.Terrain.read(path)
