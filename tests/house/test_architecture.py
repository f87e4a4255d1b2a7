"""The page of the architecture names places that are there."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PLACE = re.compile(r"`([\w/]+\.rs)`: ((?:`\w+`(?:, )?)+)")


def test_every_formula_is_where_the_page_says() -> None:
    page = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    places = PLACE.findall(page)
    assert len(places) > 30
    for path, names in places:
        code = (ROOT / "rust" / path).read_text(encoding="utf-8")
        for name in re.findall(r"\w+", names):
            assert re.search(rf"\b(?:fn|struct|trait)\s+{name}\b", code), (path, name)


def test_a_formula_is_named_once() -> None:
    page = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    rows = [row.split("|")[1].strip() for row in page.splitlines() if row.startswith("| ")][1:]
    assert len(rows) == len(set(rows))
