"""Ground as a grid of heights: laws, an oracle in NumPy, exact cases, the boundary."""

import copy
import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import six_wheel as sw

ROUNDING = 1e-13  # heights and places of order ten, a few operations


def bumpy(rows=7, columns=9, seed=0, **place):
    heights = np.random.default_rng(seed).uniform(-1, 1, (rows, columns))
    return sw.Terrain(heights, place.pop("spacing", (0.5, 0.25)), **place)


def nodes(ground):
    """World coordinates of every node, by hand."""
    rows, columns = ground.shape
    u, v = np.meshgrid(ground.spacing[0] * np.arange(columns), ground.spacing[1] * np.arange(rows))
    cos, sin = math.cos(ground.yaw), math.sin(ground.yaw)
    return np.stack([ground.origin[0] + cos * u - sin * v, ground.origin[1] + sin * u + cos * v], -1)


# Laws


@given(st.floats(-4, 4), st.tuples(st.floats(-9, 9), st.floats(-9, 9)))
def test_nodes_have_their_heights_wherever_the_map_lies(yaw, origin):
    ground = bumpy(origin=origin, yaw=yaw)
    inner = nodes(ground)[1:-1, 1:-1]
    for method in ("bilinear", "bicubic"):
        np.testing.assert_allclose(
            ground.height_at(inner, method=method), ground.heights[1:-1, 1:-1], rtol=0, atol=100 * ROUNDING
        )


@pytest.mark.parametrize("method", ["bilinear", "bicubic"])
def test_gradients_are_the_differences_of_heights(method):
    ground = bumpy(yaw=0.4, origin=(1.0, 2.0))
    generator = np.random.default_rng(1)
    middle = nodes(ground).reshape(-1, 2).mean(0)
    xy = middle + generator.uniform(-0.5, 0.5, (200, 2))
    step = 1e-6
    differences = [
        (ground.height_at(xy + d, method=method) - ground.height_at(xy - d, method=method)) / (2 * step)
        for d in step * np.eye(2)
    ]
    error = np.abs(ground.gradient_at(xy, method=method) - np.stack(differences, -1)).max(-1)
    # A crease of the bilinear surface may lie within the step: here it does in none of the points.
    assert error.max() < 1e-8


def test_normals_are_square_to_the_gradient():
    ground = bumpy(yaw=-0.3)
    xy = nodes(ground)[3, 4] + np.random.default_rng(2).uniform(-0.3, 0.3, (50, 2))
    gradient, normal = ground.gradient_at(xy), ground.normal_at(xy)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=-1), 1, atol=1e-15)
    np.testing.assert_allclose(normal[:, :2] / normal[:, 2:], -gradient, rtol=1e-13)
    assert (normal[:, 2] > 0).all()


# An oracle


def test_bilinear_heights_are_numpys():
    ground = bumpy()
    u, v = np.random.default_rng(3).uniform(0, [8, 6], (300, 2)).T
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b = u - i, v - j
    h = ground.heights
    expected = (1 - b) * ((1 - a) * h[j, i] + a * h[j, i + 1]) + b * (
        (1 - a) * h[j + 1, i] + a * h[j + 1, i + 1]
    )
    np.testing.assert_allclose(
        ground.height_at(np.stack([u / 2, v / 4], -1)), expected, rtol=0, atol=ROUNDING
    )


# Exact cases


def test_unknown_and_outside_are_nan():
    heights = np.zeros((3, 4))
    heights[1, 1] = np.nan
    ground = sw.Terrain(heights, 1.0)
    assert ground.height_at((2.5, 0.5)) == 0.0
    assert math.isnan(ground.height_at((1.9, 0.9)))
    assert np.isnan(ground.gradient_at([(1.5, 0.5), (-0.1, 0.0), (3.1, 1.0), (math.nan, 0.0)])).all()
    assert ground.contains([(0, 0), (3, 2), (3.0001, 2), (0, -1e-9), (math.inf, 0)]).tolist() == [
        True,
        True,
    ] + 3 * [False]
    # Three nodes in a row are needed beside an unknown one before a cubic knows anything.
    assert math.isnan(ground.height_at((2.5, 0.5), method="bicubic"))


@pytest.mark.parametrize("yaw", [0.0, 0.4, -2.0])
@pytest.mark.parametrize("origin", [(0.0, 0.0), (-3.7, 12.1), (451236.1, 5411234.9)])
@pytest.mark.parametrize("spacing", [0.1, 0.05, 0.3, 1.0, 0.7, 1.0 / 3.0])
def test_the_last_nodes_are_on_the_map(spacing, origin, yaw):
    """In 40 of 522 maps the last node, at ``origin + column spacing``, was beside its map by rounding."""
    for columns in range(2, 60):
        rows = columns % 7 + 2
        heights = np.arange(float(rows * columns)).reshape(rows, columns)
        ground = sw.Terrain(heights, spacing, origin=origin, yaw=yaw, unit="m")
        places = nodes(ground)
        assert ground.contains(places).all()
        # Places are off by some of their last digits; the ground rises by up to `columns` per spacing.
        digits = 8.0 * np.spacing(np.abs(places).max()) * (columns + 1) / spacing
        np.testing.assert_allclose(ground.height_at(places), heights, rtol=0.0, atol=digits)
        beside = places[-1, -1] + (1e-6 * spacing + 1e-8) * np.array((math.cos(yaw), math.sin(yaw)))
        assert not ground.contains(beside)
        assert np.isnan(ground.height_at(beside))


def test_single_precision_stays_single_precision():
    heights = np.random.default_rng(0).uniform(-1, 1, (4, 5)).astype(np.float32)
    ground = sw.Terrain(heights[:, ::-1], 0.1)
    assert ground.heights.dtype == np.float32
    np.testing.assert_array_equal(ground.heights, heights[:, ::-1])
    assert ground.height_at((0.1, 0.2)) == pytest.approx(heights[2, 3], abs=1e-7)
    assert sw.Terrain([[0, 1], [2, 3]], 1).heights.dtype == np.float64
    assert ground != sw.Terrain(heights, 0.1)


def test_the_callers_array_is_not_kept():
    heights = np.zeros((3, 3))
    ground = sw.Terrain(heights, 1.0)
    heights += 1
    ground.heights[:] = 2
    assert ground.height_at((1, 1)) == 0.0


# Values


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_terrains_are_values(dtype):
    heights = np.random.default_rng(0).uniform(-1, 1, (4, 5)).astype(dtype)
    heights[2, 2] = np.nan
    ground = sw.Terrain(heights, (0.1, 0.2), origin=(1.0, -2.0), yaw=0.3)
    for same in (pickle.loads(pickle.dumps(ground)), copy.deepcopy(ground)):
        assert same == ground
        assert hash(same) == hash(ground)
        assert same.heights.dtype == dtype
    assert ground != sw.Terrain(heights, (0.1, 0.2), origin=(1.0, -2.0))
    assert ground != "ground"
    assert repr(ground) == "Terrain(<4 x 5 heights>, spacing=(0.1, 0.2), origin=(1.0, -2.0), yaw=0.3)"
    with pytest.raises(AttributeError):
        ground.spacing = 2.0


# The boundary


@pytest.mark.parametrize(
    ("heights", "more", "message"),
    [
        ([[1.0, 2.0]], {}, r"heights must have at least two rows and two columns, got shape \(1, 2\)"),
        ([1.0, 2.0], {}, r"heights must have at least two rows and two columns, got shape \(2,\)"),
        (np.zeros((0, 3)), {}, r"heights must have at least two rows and two columns, got shape \(0, 3\)"),
        (np.zeros((2, 2, 2)), {}, r"heights must have at least two rows"),
        ([[1.0, 2.0], [3.0]], {}, r"heights must be numbers of one rectangular shape"),
        ([["a", "b"], ["c", "d"]], {}, r"heights must be real numbers"),
        ([[0, 0], [0, math.inf]], {}, r"heights\[1, 1\] must be finite, or nan where unknown, got inf"),
        (np.full((2, 2), -np.inf, np.float32), {}, r"heights\[0, 0\] must be finite"),
        (np.zeros((2, 2)), {"spacing": 0}, r"spacing must be finite and positive, got \(0\.0, 0\.0\)"),
        (np.zeros((2, 2)), {"spacing": -0.1}, r"spacing must be finite and positive, got \(-0\.1, -0\.1\)"),
        (np.zeros((2, 2)), {"spacing": (0.1, math.nan)}, r"spacing must be finite and positive"),
        (np.zeros((2, 2)), {"spacing": "a"}, r"spacing must be a number, got 'a'"),
        (np.zeros((2, 2)), {"spacing": 2.8e-4}, r"map in degrees has to be projected to metres first"),
        (np.zeros((2, 2)), {"origin": (0, math.inf)}, r"origin must be finite, got \(0\.0, inf\)"),
        (np.zeros((2, 2)), {"origin": 3}, r"origin must be two numbers, got 3"),
        (np.zeros((2, 2)), {"yaw": math.nan}, r"yaw must be finite, got nan"),
        # Beside unit= or nodata= these came through, or in words of NumPy; of complex ones half was lost.
        (
            [[1.0, 2.0], [3.0]],
            {"unit": "m"},
            r"heights must be numbers of one rectangular shape, got a ragged",
        ),
        (np.zeros((2, 2), complex), {"nodata": -1}, r"heights must be real numbers, got dtype complex128"),
        (np.zeros((2, 2), bool), {"unit": "cm"}, r"heights must be real numbers, got dtype bool"),
        (np.array([["a", "b"], ["c", "d"]]), {"nodata": -1}, r"heights must be real numbers, got dtype <U1"),
        (np.zeros((2, 2)), {"spacing": 1e300}, r"spacing must make a map whose coordinates have digits"),
    ],
)
def test_wrong_arguments_are_named(heights, more, message):
    with pytest.raises(ValueError, match=message):
        sw.Terrain(heights, **({"spacing": 1.0} | more))


def test_wrong_questions_are_named():
    ground = bumpy()
    with pytest.raises(ValueError, match=r"xy must have shape \(\.\.\., 2\), got shape \(3,\)"):
        ground.height_at((1, 2, 3))
    with pytest.raises(ValueError, match=r"method must be 'bilinear' or 'bicubic', got \"cubic\""):
        ground.height_at((1, 2), method="cubic")
    assert ground.height_at(np.zeros((0, 2))).shape == (0,)
    assert ground.normal_at(np.zeros((2, 0, 2))).shape == (2, 0, 3)
    assert isinstance(ground.height_at((0.5, 0.5)), float)
