"""Forms of a second ground, of which no reader was written: right, or refused in one line that helps."""

from pathlib import Path

import pytest

pytest.importorskip("rasterio", reason="needs rasterio")

from tests.maps.unseen.__main__ import count, every

# Of rasterio, pandas and GDAL, about how they write these files.
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]


def test_no_form_is_wrong_in_silence_and_most_are_right(tmp_path: Path) -> None:
    cases = every(seed=1)
    found = count(cases, tmp_path)
    made = sum(map(len, found.values()))
    known = sum(case.knowable for case in cases)
    assert len({case.name for case in cases}) > 0.95 * len(cases)
    assert made == len(cases) > 300
    assert not found["silent"]
    assert not found["traceback"]
    assert len(found["unhelpful"]) <= 0.05 * made, found["unhelpful"]
    assert len(found["right"]) + len(found["as proposed"]) >= 0.8 * known
