"""Maps in tiles: the same as all at once, wherever they run, however often they stop."""

import errno
import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.maps import traversability, traverse
from six_wheel.parallel import ClusterError

rasterio = pytest.importorskip("rasterio", reason="needs rasterio")
affine = pytest.importorskip("affine", reason="needs rasterio")
# Of rasterio, about a sign of the library it makes transforms with.
pytestmark = pytest.mark.filterwarnings("ignore:Use `@` matmul:PendingDeprecationWarning")

HEADINGS = 2


@pytest.fixture(autouse=True)
def small_tiles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(traversability, "SIDE", 16)


@pytest.fixture
def chart(tmp_path: Path) -> Path:
    """A map of 36 x 44 cells, north up, with a hole."""
    heights = sw.Terrain.yard((21.5, 17.5), 0.5, 0.05, seed=2).heights.astype(np.float32)
    heights[17, 20] = np.nan
    path = tmp_path / "map.tif"
    with rasterio.open(
        path,
        "w",
        driver="GTiff",
        height=36,
        width=44,
        count=1,
        dtype="float32",
        nodata=math.nan,
        crs="EPSG:32633",
        transform=affine.Affine(0.5, 0, 500_000, 0, -0.5, 4_000_000),
    ) as target:
        target.write(heights, 1)
    return path


def layers(path: Path) -> Any:
    with rasterio.open(path) as source:
        return source.read()


def run(chart: Path, name: str = "safe.tif", **options: Any) -> Any:
    options = {"workers": 1, "headings": HEADINGS, **options}
    output = chart.with_name(name)
    return traverse(chart, sw.RockerBogie.preset("perseverance"), output, **options)


def test_tiles_say_what_feasible_says(chart: Path) -> None:
    done = run(chart)
    assert done.cells == 36 * 44
    assert done.tiles == 9
    with rasterio.open(done.output) as written, rasterio.open(chart) as source:
        assert (written.crs, written.transform) == (source.crs, source.transform)
        assert written.descriptions == ("safe", "tilt", "clearance", "reason")
        found = written.read()
    # From a place nearby: the coordinates of the map have fewer digits left.
    ground = sw.Terrain(sw.Terrain.read(chart).heights, 0.5)
    x, y = 0.5 * np.arange(44), 0.5 * np.arange(36)[::-1, None]
    poses = np.empty((36, 44, HEADINGS, 3))
    poses[..., 0], poses[..., 1] = x[:, None], y[..., None]
    poses[..., 2] = 2 * math.pi / HEADINGS * np.arange(HEADINGS)
    whole = sw.RockerBogie.preset("perseverance").feasible(ground, poses)
    # A cell just at a limit may be decided otherwise from another tile's corner.
    assert np.mean(found[0] != whole.ok.mean(axis=-1)) < 1e-3
    assert 0.05 < found[0].mean() < 0.95
    tilt = np.fmax.reduce(whole.tilt, axis=-1)
    assert np.array_equal(np.isnan(found[1]), np.isnan(tilt))
    assert np.nanmax(np.abs(found[1] - tilt)) < 0.02
    assert done.safe == pytest.approx(found[0].mean(dtype=np.float64), abs=1e-6)
    assert sorted(path.name for path in chart.parent.iterdir()) == ["map.tif", "safe.tif"]


def test_processes_and_a_cluster_give_the_same_to_the_bit(
    chart: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(chart)
    expected = layers(chart.with_name("safe.tif")).tobytes()
    run(chart, "processes.tif", workers=2)
    assert layers(chart.with_name("processes.tif")).tobytes() == expected
    distributed = pytest.importorskip("distributed", reason="needs Dask")
    options = {"dashboard_address": None, "silence_logs": 50}
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, **options) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        run(chart, "cluster.tif", workers=None, cluster=client)
    assert layers(chart.with_name("cluster.tif")).tobytes() == expected


def test_a_stop_in_the_middle_loses_nothing(chart: Path) -> None:
    run(chart)

    def stop(done: int, total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(chart, "again.tif", progress=stop)
    assert not chart.with_name("again.tif").exists()
    assert chart.with_name("again.tif.tiles").is_dir()
    with pytest.raises(ValueError, match="holds another run: headings was 2, now 3"):
        run(chart, "again.tif", headings=3)
    done = run(chart, "again.tif")
    assert done.resumed == 3
    assert layers(done.output).tobytes() == layers(chart.with_name("safe.tif")).tobytes()
    assert not chart.with_name("again.tif.tiles").exists()


def test_a_full_disk_is_one_line_and_nothing_half_written(
    chart: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(file: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(OSError, match="No space left"):
            run(chart)
    assert not chart.with_name("safe.tif").exists()
    usage = type("Usage", (), {"free": 10})
    with monkeypatch.context() as patch:
        patch.setattr(traversability.shutil, "disk_usage", lambda path: usage)
        with pytest.raises(OSError, match=r"safe\.tif needs 25344 bytes, the disk has 10"):
            run(chart)
    assert not chart.with_name("safe.tif").exists()
    assert run(chart).resumed == 9


def test_bad_arguments_write_nothing(chart: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("six_wheel.parallel.spreading.ANSWER", 0.5)
    before = sorted(chart.parent.iterdir())
    with pytest.raises(ValueError, match="headings must be at least 1, got 0"):
        run(chart, headings=0)
    with pytest.raises(ValueError, match="roll must be positive"):
        run(chart, limits=sw.FeasibilityLimits(roll=-1.0))
    with pytest.raises(ValueError, match="must be another file than"):
        run(chart, "map.tif")
    with pytest.raises(FileNotFoundError, match="must be a file, there is none"):
        run(chart.with_name("nothing.tif"))
    assert sorted(chart.parent.iterdir()) == before
    pytest.importorskip("distributed", reason="needs Dask")
    with pytest.raises(ClusterError, match="does not answer"):
        run(chart, workers=None, cluster="tcp://127.0.0.1:9")


def test_the_command(run: Any, refused: Any, tmp_path: Path, chart: Path) -> None:
    options = ("--headings", "2", "--workers", "1")
    code, out, err = run(
        "traverse", "perseverance", str(chart), *options, "-o", "safe.tif", "--plot", "safe.png"
    )
    assert (code, err) == (0, "")
    assert "1584 at 2 headings" in out
    assert Path("safe.png").stat().st_size > 10_000
    assert "a parameter file or a preset" in refused("traverse", "nobody", str(chart), "-o", "a.tif")
    wrong = refused("traverse", "perseverance", str(chart), *options, "-o", "a.tif", "--limit", "height=3")
    assert (
        wrong
        == "limit must be one of roll, pitch, tilt, rocker, bogie, clearance, wheel_drop, got 'height=3'"
    )
    assert "the folder of the output must exist" in refused(
        "traverse", "perseverance", str(chart), *options, "-o", "x/a.tif"
    )
    for limit in ("roll=15", "tilt=", "bogie=adeg", "rocker=3grad"):
        wrong = refused("traverse", "perseverance", str(chart), *options, "-o", "a.tif", "--limit", limit)
        name = limit.partition("=")[0]
        assert wrong == f"limit {name} must be an angle such as 15deg or 0.26rad, got {limit!r}"
    wrong = refused(
        "traverse", "perseverance", str(chart), *options, "-o", "a.tif", "--limit", "clearance=0.1m"
    )
    assert wrong == "limit clearance must be a number, got 'clearance=0.1m'"


def test_limits_are_in_either_unit() -> None:
    from six_wheel.cli.commands.traverse import _limits

    limits = _limits(["roll=15deg", "pitch=0.25rad", "clearance=0.3", "tilt= 2e1deg"])
    assert limits == sw.FeasibilityLimits.curiosity().replace(
        roll=math.radians(15), pitch=0.25, clearance=0.3, tilt=math.radians(20)
    )
