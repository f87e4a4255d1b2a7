"""Costmaps of occupancy grids and of maps as nav2 saves them."""

import math
from types import SimpleNamespace as Bag

import numpy as np
import pytest

import six_wheel as sw

GRID = np.array([[0, 0, 0, 0, 0], [0, 0, 100, 0, -1], [0, 0, 0, 0, 0]])


def message(grid=GRID, yaw=0.0, **changes):
    turn = Bag(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    origin = Bag(position=Bag(x=-1.0, y=2.0, z=0.0), orientation=turn)
    info = Bag(height=grid.shape[0], width=grid.shape[1], resolution=0.5, origin=origin)
    return Bag(header=Bag(frame_id="map"), info=info, data=grid.ravel().tolist(), **changes)


def tilted():
    msg = message()
    msg.info.origin.orientation.x = 0.1
    return msg


def test_cells_are_squares_whose_middle_has_the_cost():
    costs = sw.Costmap.from_occupancy_grid(message())
    assert (costs.spacing, costs.origin, costs.frame, costs.lethal) == (
        (0.5, 0.5),
        (-0.75, 2.25),
        "map",
        0.65,
    )
    assert costs.values.tolist() == [[0, 0, 0, 0, 0], [0, 0, 1, 0, 0.5], [0, 0, 0, 0, 0]]


def test_costs_around_an_obstacle_are_those_of_the_distance():
    costs = sw.Costmap.from_occupancy_grid(message(), inflation=1.0, unknown=0.0).values
    rows, columns = np.mgrid[:3, :5]
    distance = 0.5 * np.hypot(rows - 1, columns - 2)
    expected = np.where(distance == 0, 1.0, 0.65 * np.clip(1 - distance, 0, None))
    np.testing.assert_allclose(costs, expected, atol=1e-7)  # single precision
    assert (costs >= 0.65).sum() == 1


def test_a_turned_grid_is_the_grid_about_its_corner(tmp_path):
    """nav2 saves maps that are turned; they were refused."""
    straight, turned = (sw.Costmap.from_occupancy_grid(message(yaw=yaw)) for yaw in (0.0, 0.7))
    corner = np.array((-1.0, 2.0))
    cos, sin = math.cos(0.7), math.sin(0.7)
    middle = corner + np.array(((cos, -sin), (sin, cos))) @ (straight.origin - corner)
    np.testing.assert_allclose(turned.origin, middle, rtol=1e-15)
    assert turned == straight.replace(origin=turned.origin, yaw=turned.yaw)
    assert math.isclose(turned.yaw, 0.7, rel_tol=1e-15)
    pytest.importorskip("yaml")
    (tmp_path / "a.pgm").write_bytes(b"P5 2 2 255\n" + bytes([254, 0, 254, 254]))
    for yaw in (0.0, -1.2):
        text = f"image: a.pgm\nresolution: 0.1\norigin: [1.0, 2.0, {yaw}]\n"
        (tmp_path / f"{yaw}.yaml").write_text(text)
    straight, turned = (sw.Costmap.read(tmp_path / f"{yaw}.yaml") for yaw in (0.0, -1.2))
    assert turned.yaw == -1.2
    assert turned == straight.replace(origin=turned.origin, yaw=-1.2)
    half = 0.05 * np.array((math.cos(-1.2) - math.sin(-1.2), math.sin(-1.2) + math.cos(-1.2)))
    np.testing.assert_allclose(turned.origin, np.add((1.0, 2.0), half), rtol=1e-15)


@pytest.mark.parametrize("head", ["P5\n# a map\n3 2\n255\n", "P5 3 2 255\n"])
def test_a_map_of_nav2(tmp_path, head):
    pixels = bytes([254, 254, 0, 205, 254, 254])
    (tmp_path / "a.pgm").write_bytes(head.encode() + pixels)
    text = "image: a.pgm\nresolution: 0.1\norigin: [1.0, 2.0, 0.0]\n"
    text += "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    (tmp_path / "a.yaml").write_text(text)
    pytest.importorskip("yaml")
    costs = sw.Costmap.read(tmp_path / "a.yaml", unknown=0.25)
    assert costs.values.tolist() == [[0.25, 0, 0], [0, 0, 1]]  # the first row of an image is the far one
    np.testing.assert_allclose(costs.origin, (1.05, 2.05))
    (tmp_path / "b.pgm").write_text("P2 3 2 255 " + " ".join(map(str, pixels)))
    (tmp_path / "b.yaml").write_text(text.replace("a.pgm", "b.pgm"))
    assert sw.Costmap.read(tmp_path / "b.yaml", unknown=0.25) == costs


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (
            lambda: sw.Costmap.from_occupancy_grid(Bag(info=message().info, data=[0])),
            "must hold height x width, 3 x 5",
        ),
        (lambda: sw.Costmap.from_occupancy_grid(tilted()), "origin must turn about z alone"),
        (lambda: sw.Costmap.from_occupancy_grid(GRID), "msg must have info and data"),
        (
            lambda: sw.Costmap.from_occupancy_grid(message(), inflation=-1.0),
            "inflation must be finite and not negative",
        ),
        (lambda: sw.Costmap.from_occupancy_grid(message(), unknown=math.nan), "unknown must be finite"),
        (
            lambda: sw.Costmap.from_occupancy_grid(message(), lethal="high"),
            "lethal must be finite and not negative, got 'high'",
        ),
    ],
)
def test_grids_that_cannot_be_used(made, message):
    with pytest.raises(ValueError, match=message):
        made()


def test_files_that_are_no_maps(tmp_path):
    pytest.importorskip("yaml")
    turned = "image: a.pgm\nresolution: 1\norigin: [0, 0, 0.5]\n"
    for text, rule in (
        ("a: 1\n", "must have image, resolution, origin"),
        ("a: [", "must be YAML"),
        (turned.replace("0.5", "a"), r"m\.yaml: origin must be a finite number, got 'a'"),
        (turned.replace("[0, 0, 0.5]", "abc"), "origin must be three numbers, got 'abc'"),
        ("[" * 10_000, "must be YAML"),
    ):
        (tmp_path / "m.yaml").write_text(text)
        with pytest.raises(ValueError, match=rule):
            sw.Costmap.read(tmp_path / "m.yaml")
    (tmp_path / "m.yaml").write_text(turned)
    with pytest.raises(FileNotFoundError, match=r"a\.pgm must be a file, there is none"):
        sw.Costmap.read(tmp_path / "m.yaml")
    with pytest.raises(FileNotFoundError, match=r"none\.yaml must be a file, there is none"):
        sw.Costmap.read(tmp_path / "none.yaml")
    with pytest.raises(ValueError, match=r"must be a file, it is a folder"):
        sw.Costmap.read(tmp_path)
    (tmp_path / "m.yaml").write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match=r"m\.yaml: must be YAML"):
        sw.Costmap.read(tmp_path / "m.yaml")
    (tmp_path / "m.yaml").write_text("image: a.pgm\nresolution: 1\norigin: [0, 0, 0]\n")
    (tmp_path / "a.pgm").write_bytes(b"P5 1 1 255\n\0")
    for key in ("resolution", "occupied_thresh", "free_thresh"):
        (tmp_path / "n.yaml").write_text(f"image: a.pgm\nresolution: 1\norigin: [0, 0, 0]\n{key}: [x]\n")
        with pytest.raises(ValueError, match=rf"n\.yaml: {key} must be a finite number, got \['x'\]"):
            sw.Costmap.read(tmp_path / "n.yaml")
    for pixels in (b"P5 3 2 255\n\0\0", b"P5 3 2 0\n\0\0\0\0\0\0", b"P5 x"):
        (tmp_path / "a.pgm").write_bytes(pixels)
        with pytest.raises(ValueError, match="must be a PGM"):
            sw.Costmap.read(tmp_path / "m.yaml")
    with pytest.raises(FileNotFoundError):
        sw.Costmap.read(tmp_path / "none.yaml")
