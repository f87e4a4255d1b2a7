"""Every vehicle is everywhere a user looks for it; what is missing is named."""

import re
from pathlib import Path

import pytest

import six_wheel as sw
from six_wheel import reference

ROOT = Path(__file__).parents[2]
VEHICLES = sorted(
    name
    for name, member in vars(sw.Rover).items()
    if isinstance(member, staticmethod) and name not in ("preset", "presets")
)


def text(*path: str) -> str:
    return ROOT.joinpath(*path).read_text(encoding="utf-8")


def test_there_are_vehicles():
    assert {"six_wheel", "swerve", "differential", "ackermann"} <= set(VEHICLES)


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_a_vehicle_is_in_the_reference(vehicle):
    assert hasattr(reference.Rover, vehicle)


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_a_vehicle_has_a_kind_and_an_example_of_it(vehicle):
    pytest.importorskip("pydantic")
    from six_wheel.robot_description.parameters.vehicle_types import KINDS

    assert vehicle in KINDS
    examples = [path.read_text(encoding="utf-8") for path in (ROOT / "examples").glob("*.yaml")]
    told = re.compile(r"\bd1:" if vehicle == "six_wheel" else rf"\bkind: {vehicle}\b")
    assert any(told.search(example) for example in examples), f"examples/{vehicle}.yaml"


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_a_vehicle_has_sections_and_a_picture(vehicle, monkeypatch):
    sections = re.split(r"^## ", text("docs", "explanation", "models.md"), flags=re.M)[1:]
    head = vehicle.capitalize().replace("_", "[ -]")
    section = next((one for one in sections if re.match(head, one)), "")
    assert section, f"a section of docs/explanation/models.md that begins with {head}"
    assert f"](../pictures/{vehicle}.png)" in section
    assert f"`Rover.{vehicle}(" in section
    assert f"`{vehicle}`" in text("docs", "reference", "parameter_keys.md")
    features = text("docs", "explanation", "features.md")
    assert f"`{vehicle}`" in features or f"`Rover.{vehicle}`" in features
    assert (ROOT / "docs" / "pictures" / f"{vehicle}.png").exists()
    pytest.importorskip("matplotlib")
    pytest.importorskip("scipy")
    monkeypatch.syspath_prepend(ROOT / "docs")
    import draw

    assert vehicle in draw.VEHICLES


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_a_vehicle_obeys_the_laws(vehicle):
    laws = "".join(
        path.read_text(encoding="utf-8") for path in (ROOT / "tests" / "core" / "laws").glob("*.py")
    )
    assert re.search(rf"Rover\.{vehicle}\b|\b{vehicle}\b", laws)
