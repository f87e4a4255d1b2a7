"""Maps as they come: every form of one known ground is read right, or refused in one line that helps."""

from collections import Counter
from pathlib import Path

import pytest

from tests.maps.forms import images, others, rasters, regressions
from tests.maps.forms.ground import CLASSES, Form, classify

pytest.importorskip("rasterio", reason="needs rasterio")

# Of rasterio and GDAL, about how they write these files.
pytestmark = pytest.mark.filterwarnings("ignore")


def test_a_form_that_failed_once_does_not_again(tmp_path: Path) -> None:
    for number, form in enumerate(regressions.every()):
        folder = tmp_path / str(number)
        folder.mkdir()
        kind, words = classify(form, folder)
        expected = ("right", "as proposed") if form.knowable else ("helpful",)
        assert kind in expected, f"{form.name}: {kind}: {words}"


def all_forms() -> list[Form]:
    return [*images.every(), *others.every(), *rasters.rasters(), *regressions.every()]


def test_no_form_is_wrong_in_silence(tmp_path: Path) -> None:
    forms, found = all_forms(), dict[str, list[str]]()
    for number, form in enumerate(forms):
        folder = tmp_path / str(number)
        folder.mkdir()
        kind, words = classify(form, folder)
        found.setdefault(kind, []).append(f"{form.group}: {form.name}: {words}")
    known = [form for form in forms if form.knowable]
    told = Counter({kind: len(names) for kind, names in found.items()})
    report = "\n".join(f"{kind}\n  " + "\n  ".join(found.get(kind, [])) for kind in CLASSES[3:])
    print({kind: told[kind] for kind in CLASSES}, len(forms), len(known))
    assert len(forms) >= 200
    assert told["silent"] == 0, report
    assert told["traceback"] == 0, report
    assert told["unhelpful"] <= 0.05 * len(forms), report
    assert told["right"] + told["as proposed"] >= 0.8 * len(known), report
