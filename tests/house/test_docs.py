"""Snippets of the pages under docs run and print what the pages print; links lead to files."""

import doctest
import json
import pkgutil
import re
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BUILT = {"_build", "api"}
PAGES = sorted(page for page in DOCS.rglob("*.md") if not BUILT & set(page.relative_to(DOCS).parts))
NAMES = [str(page.relative_to(DOCS)) for page in PAGES]
MODELS = (DOCS / "explanation" / "models.md").read_text(encoding="utf-8")
LARGEST_PICTURE = 60_000  # [B], of those drawn for a page
WIDEST = 84  # columns of a snippet that a page of 1280 px shows whole


class Checker(doctest.OutputChecker):
    """Equal but for spaces and the sign of zero, in which machines may differ."""

    def check_output(self, want: str, got: str, optionflags: int) -> bool:
        same = [re.sub(r"-(0\.0*[,)\]])", r"\1", "".join(text.split())) for text in (want, got)]
        return super().check_output(*same, optionflags)


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_snippets_give_what_the_page_says(page):
    lines, shown = [], False
    for line in page.read_text(encoding="utf-8").splitlines():
        fence = line.startswith("```")
        # All but the snippets becomes empty lines, so that a failure names the line of the page.
        lines.append(line if shown and not fence else "")
        shown = line == "```pycon" if fence else shown
    code = "\n".join(lines)
    test = doctest.DocTestParser().get_doctest(code, {}, page.name, str(page), 0)
    report: list[str] = []
    runner = doctest.DocTestRunner(Checker(), verbose=False, optionflags=doctest.ELLIPSIS)
    result = runner.run(test, out=report.append)
    assert result.failed == 0, "".join(report)


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_snippets_fit_the_page(page):
    lines = page.read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line.startswith((">>> ", "... ")) and len(line) > WIDEST] == []


def test_the_cheat_sheet_runs(monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.syspath_prepend(DOCS)
    import sheet

    exec(compile(sheet.CODE, "sheet.py", "exec"), {})
    told = {word for row in (*sheet.REASONS, *sheet.HEALTH) for word in re.findall(r"[A-Z_]{3,}", row[0])}
    assert told <= {one.name for one in (*sw.Reason, *sw.OdometryHealth)}


NOTEBOOKS = {"first": 2, "log": 2, "rocks": 6}  # and how many pictures each shows


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_is_that_of_its_page(name, monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    import notebook

    assert set(notebook.NOTEBOOKS) == set(NOTEBOOKS)
    page = (DOCS / "tutorials" / f"{notebook.NOTEBOOKS[name]}.md").read_text(encoding="utf-8")
    written = (DOCS / "tutorials" / f"{name}.ipynb").read_text(encoding="utf-8")
    assert written == notebook.notebook(page), "python docs/notebook.py writes it"
    assert all(cell.get("outputs", []) == [] for cell in json.loads(written)["cells"])


@pytest.mark.slow
@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_runs_and_shows_its_pictures(name, tmp_path):
    for needed in ("matplotlib", "scipy", "yaml"):
        pytest.importorskip(needed)
    why = "executes notebooks: pip install nbclient ipykernel"
    nbclient = pytest.importorskip("nbclient", reason=why)
    pytest.importorskip("ipykernel", reason=why)
    import nbformat

    read = nbformat.read(DOCS / "tutorials" / f"{name}.ipynb", as_version=4)
    place = {"metadata": {"path": str(tmp_path)}}
    done = nbclient.NotebookClient(read, timeout=300, resources=place).execute()
    outputs = [each for cell in done.cells if cell.cell_type == "code" for each in cell.outputs]
    assert [each.output_type for each in outputs if each.output_type == "error"] == []
    assert sum("image/png" in each.get("data", {}) for each in outputs) == NOTEBOOKS[name]


def test_wpilib_gives_the_same_modules():
    pytest.importorskip("wpimath")
    text = (DOCS / "coming_from" / "wpilib.md").read_text(encoding="utf-8")
    names: dict[str, object] = {}
    for code in re.findall(r"```python\n(.*?)```", text, re.S):
        exec(code, names)
    steering, speeds = sw.Rover.swerve(names["places"], 0.05).inverse((1.0, 0.5, 0.8))
    ours = np.stack((steering, 0.05 * speeds), axis=-1)
    np.testing.assert_allclose(ours, names["theirs"], rtol=0, atol=1e-12)


def anchors(page: Path) -> set[str]:
    """The anchors that GitHub and MyST give to the headings of a page."""
    heads = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w -]", "", head).lower().replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_what_a_page_links_to_is_there(page):
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if "://" in link:
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_what_a_page_names_is_there(page):
    """A page on logs named ``sw.table_columns``, which is in `six_wheel.log_odometry`."""
    text = page.read_text(encoding="utf-8")
    for name in set(re.findall(r"`(?:sw|six_wheel)\.(\w+(?:\.\w+)*)", text)) - {"NAME"}:
        try:
            pkgutil.resolve_name(f"six_wheel.{name}")
        except ModuleNotFoundError:  # what it needs is not installed
            continue
        except AttributeError as error:
            raise AssertionError(f"six_wheel.{name}: {error}") from None


def test_every_vehicle_has_a_section_with_a_small_picture():
    pictures = set(re.findall(r"\]\(\.\./pictures/(\w+)\.png\)", MODELS))
    assert {"six_wheel", "swerve", "differential", "tracked", "ackermann"} <= pictures
    assert {"bicycle", "tricycle", "mecanum", "omni", "rocker_bogie", "four_axle"} <= pictures
    for name in pictures:
        assert (DOCS / "pictures" / f"{name}.png").stat().st_size < LARGEST_PICTURE, name
    sections = re.split(r"^## ", MODELS, flags=re.M)[1:]
    for section in sections:
        if "![" in section:
            assert "**Published" in section, section.splitlines()[0]
            assert "**What is wrong" in section, section.splitlines()[0]
            assert ">>>" in section, section.splitlines()[0]


@pytest.mark.slow
def test_every_picture_can_be_drawn_again(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    pytest.importorskip("scipy")
    pytest.importorskip("rosbags")
    monkeypatch.syspath_prepend(DOCS)
    import draw

    monkeypatch.setattr(draw, "PICTURES", tmp_path)
    draw.main()
    drawn = {path.name for path in tmp_path.iterdir()}
    elsewhere = {"rerun.png"}  # by `rerun --headless`
    # by tests of the view, in Chromium
    elsewhere |= {path.name for path in (DOCS / "pictures").glob("view_*.jpg")}
    assert drawn == {path.name for path in (DOCS / "pictures").iterdir()} - elsewhere
    assert max(path.stat().st_size for path in tmp_path.glob("*.png")) < LARGEST_PICTURE


def test_every_picture_is_on_a_page():
    pages = "".join(page.read_text(encoding="utf-8") for page in (*PAGES, ROOT / "README.md"))
    for path in (DOCS / "pictures").iterdir():
        assert f"pictures/{path.name})" in pages, path.name
