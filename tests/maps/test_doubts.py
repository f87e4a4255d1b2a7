"""Every doubt about a map proposes what settles it, in the form of the place where it is uttered."""

import inspect
import math
import shlex
import typing
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.cli.app import ORDER
from six_wheel.cli.map_options import MapReading
from six_wheel.maps import TerrainFileError, doubts
from six_wheel.maps.files import Options
from six_wheel.robot_description.doubts import DoubtError, Proposal
from tests.cli_runs import Run
from tests.maps.forms.ground import grid
from tests.maps.forms.images import filled, tif
from tests.maps.forms.others import esri, written
from tests.maps.grid_map_bags import write_bag

pytest.importorskip("rasterio", reason="needs rasterio")
pytestmark = pytest.mark.filterwarnings("ignore")

PLAIN = filled(np.nan)
UNPLACED: dict[str, Any] = {"transform": None, "crs": None}
OTHERS = {"answer", "listed", "named"}  # functions of `doubts` that are none
DOUBTS = {
    name
    for name, one in inspect.getmembers(doubts, inspect.isfunction)
    if one.__module__ == doubts.__name__ and not name.startswith("_") and name not in OTHERS
}
FEET = "EPSG:32633+8228"  # heights in feet


class Uttered(NamedTuple):
    """A file that brings a doubt up, by a function that writes it, and options that do."""

    make: Callable[[Path], Any]
    options: Mapping[str, Any] = MappingProxyType({})
    name: str = "map.tif"


def numpy_file(folder: Path) -> None:
    np.save(folder / "map.npy", grid())


def bag(*layers: str) -> Callable[[Path], Any]:
    return lambda folder: write_bag(folder / "bag", np.arange(30.0).reshape(6, 5), layers=layers)


WHOLE = np.where(np.isnan(PLAIN), 0, PLAIN * 100).astype(np.int32)
BYTES = np.full(PLAIN.shape, 7, np.uint8)
UTTERED = {
    "flagged_heights": Uttered(tif(filled(-9999))),
    "another_mark": Uttered(tif(np.where(PLAIN > 13, -32768, filled(-9999))), {"nodata": -9999}),
    "all_marked": Uttered(tif(np.full_like(PLAIN, -9999))),
    "steep_heights": Uttered(tif(PLAIN * 1000)),
    "whole_heights": Uttered(
        tif(np.nan_to_num(np.round(PLAIN), nan=12).astype(np.int32), **UNPLACED), {"spacing": 0.4}
    ),
    "named_unit": Uttered(tif(PLAIN, "map_ft.tif"), name="map_ft.tif"),
    "cells_of_bits": Uttered(tif(BYTES)),
    "picture_bands": Uttered(tif(np.stack([BYTES] * 3))),
    "counts_without_unit": Uttered(
        tif(WHOLE.astype(np.uint16), "map.png", driver="PNG", **UNPLACED), name="map.png"
    ),
    "unknown_unit": Uttered(tif(PLAIN, unit="fathom")),
    "two_units": Uttered(tif(PLAIN, unit="m", crs=FEET)),
    "no_place": Uttered(tif(PLAIN, **UNPLACED)),
    "own_place": Uttered(tif(PLAIN), {"spacing": 1.0, "north_up": True}),
    "no_corners": Uttered(written(esri(xllcorner=None), "map.asc"), name="map.asc"),
    "several": Uttered(tif(np.stack((PLAIN, PLAIN)))),
    "band_by_name": Uttered(tif(PLAIN, names=("slope",))),
    "no_name_of_that": Uttered(tif(PLAIN), {"band": 5}),
    "several layers": Uttered(bag("mean height", "upper"), name="bag"),
    "no layer": Uttered(bag("elevation"), {"layer": "top"}, name="bag"),
    "no topic": Uttered(bag("elevation"), {"topic": "/top"}, name="bag"),
    "a layer of another name": Uttered(bag("slope"), name="bag"),
    "several arrays": Uttered(
        lambda folder: np.savez(folder / "map.npz", a=grid(), b=grid()), name="map.npz"
    ),
    "an array without a place": Uttered(numpy_file, name="map.npy"),
    "a mark in text": Uttered(written(esri(-32768), "map.asc"), name="map.asc"),
}


def python(proposal: Proposal) -> dict[str, Any]:
    """Arguments as Python reads what was proposed."""
    read: dict[str, Any] = eval(f"dict({proposal.argument})", {})
    return read


def typed(options: Mapping[str, Any]) -> list[str]:
    """Options of the command line."""
    return [
        word for name, value in options.items() for word in shlex.split(doubts.answer(name, value).option)
    ]


def proposals(error: DoubtError) -> list[Proposal]:
    return [part for part in error.parts if isinstance(part, Proposal) and "=" in part.argument]


def refusal(path: Path, options: Mapping[str, Any]) -> DoubtError | None:
    try:
        sw.Terrain.read(path, **options)
    except DoubtError as error:
        return error
    return None


@pytest.fixture
def heard(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the doubts that are uttered."""
    names: list[str] = []

    def listen(name: str) -> None:
        inner = getattr(doubts, name)

        def listening(*given: Any, **more: Any) -> Any:
            names.append(name)
            return inner(*given, **more)

        monkeypatch.setattr(doubts, name, listening)

    for name in DOUBTS:
        listen(name)
    return names


@pytest.fixture(params=UTTERED)
def uttered(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, Uttered]:
    case = UTTERED[request.param]
    case.make(tmp_path)
    return tmp_path / case.name, case


def test_every_doubt_has_a_file_that_brings_it_up(tmp_path: Path, heard: list[str]) -> None:
    for name, case in UTTERED.items():
        folder = tmp_path / name
        folder.mkdir()
        case.make(folder)
        assert refusal(folder / case.name, case.options) is not None
        assert heard[-1] == name or name not in DOUBTS
    with pytest.raises(ValueError, match=r"spacing must be given .*: spacing=0\.1"):
        sw.Terrain(grid())
    assert set(heard) == DOUBTS


def test_python_reads_what_is_proposed(uttered: tuple[Path, Uttered], heard: list[str]) -> None:
    path, case = uttered
    error = refusal(path, case.options)
    assert isinstance(error, TerrainFileError)
    assert "\n" not in str(error)
    doubt, found = heard[-1], proposals(error)
    if doubt == "own_place":
        assert refusal(path, {}) is None  # all that it says to leave out
        return
    # Where several options belong together the first one is the one that is needed.
    for proposal in found:
        assert proposal.argument in str(error)
        heard.clear()
        refusal(path, {**case.options, **python(found[0]), **python(proposal)})
        assert doubt not in heard, proposal
    assert found


def test_the_command_line_reads_what_is_proposed(
    uttered: tuple[Path, Uttered], heard: list[str], run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Drawing takes a second, and tells nothing about options.
    monkeypatch.setattr("six_wheel.plotting.saving.save", lambda figure, target: target)
    monkeypatch.setattr("six_wheel.plotting.ground.map.map_figure", lambda *given, **more: None)
    path, case = uttered
    error = refusal(path, case.options)
    assert error is not None
    doubt, found = heard[-1], proposals(error)
    command = ["show", str(path), "-o", "shown.png", *typed(case.options)]
    code, _, said = run(*command)
    assert code == 2
    assert said == f"six-wheel: {error.told('option')}\n"
    assert "=" not in said.replace(str(path), "")
    for proposal in found:
        assert proposal.option in said
        heard.clear()
        run(*command, *shlex.split(found[0].option), *shlex.split(proposal.option))
        assert doubt not in heard, proposal


def test_a_file_of_options_reads_what_is_proposed(
    uttered: tuple[Path, Uttered], heard: list[str], tmp_path: Path
) -> None:
    path, case = uttered
    file = tmp_path / "site.yaml"
    lines = [f"map: {path.name}", *(doubts.answer(*each).key for each in case.options.items())]
    file.write_text("\n".join(lines))
    with pytest.raises(TerrainFileError) as caught:
        sw.Terrain.read(file)
    doubt, inner = heard[-1], refusal(path, case.options)
    assert inner is not None
    assert str(caught.value) == f"{inner.told('key')} (keys of {file})"
    for proposal in proposals(inner):
        file.write_text("\n".join([*lines, proposals(inner)[0].key, proposal.key]))
        heard.clear()
        refusal(file, {})
        assert doubt not in heard, proposal


@pytest.mark.parametrize("value", [3, 0.25, -9999.0, 1e20, -3.4028234663852886e38, math.nan, True, False])
@pytest.mark.parametrize("name", ["nodata", "north_up"])
def test_numbers_are_proposed_as_they_are(name: str, value: Any) -> None:
    if isinstance(value, bool) is (name == "north_up"):
        assert python(doubts.answer(name, value)) == {name: pytest.approx(value, rel=1e-8, nan_ok=True)}


@pytest.mark.parametrize(
    "text", ["m", "us-ft", "mean height", "a'b", 'a "b"', "yes", "2", "höhe", "$HOME", "a: b"]
)
def test_names_are_quoted(text: str) -> None:
    import yaml

    proposed = doubts.answer("layer", text)
    assert python(proposed) == {"layer": text}
    assert shlex.split(proposed.option) == ["--layer", text]
    assert yaml.safe_load(proposed.key) == {"layer": text}


def test_the_view_says_whose_option_it_is(tmp_path: Path) -> None:
    from six_wheel.view.subject import find_ground

    tif(filled(-9999))(tmp_path)
    path = tmp_path / "map.tif"
    with pytest.raises(TerrainFileError) as caught:
        find_ground(path, 2.0)
    assert str(caught.value).endswith(f" if not, as ground=sw.Terrain.read({str(path)!r}, ...)")
    assert caught.value.told("option").endswith("--nodata nan if not")


def test_every_command_that_reads_a_map_has_every_option() -> None:
    commands = [each for each in ORDER if MapReading in typing.get_type_hints(each).values()]
    assert {each.__name__ for each in commands} == {"show", "view", "simulate", "traverse"}
    named = set(Options._fields) - {"window"}
    assert set(MapReading._fields) == named
    from six_wheel.maps import traverse

    assert named <= set(inspect.signature(traverse).parameters)
