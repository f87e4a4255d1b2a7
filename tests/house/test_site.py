"""The built site: every name has a page, every link leads somewhere, nothing comes from elsewhere."""

import importlib
import os
import re
import shutil
import subprocess
import zlib
from html.parser import HTMLParser
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from urllib.parse import unquote

import pytest

import six_wheel as sw

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BUILT = DOCS / "_build" / "html"  # written by `make docs`
NARROW, WIDE = 390, 1280  # [px] a telephone, a desk
LARGEST_SITE = 12_000_000  # [B] without the recorded drive
LARGEST_DRIVE = 4_000_000  # [B] viser's page is 1.7 MB of it


@pytest.fixture(scope="module")
def site() -> Path:
    """The site of `make docs`, no older than its pages."""
    index = BUILT / "index.html"
    if not index.exists():
        why = (
            "make docs has not built the site"
            if find_spec("sphinx")
            else "needs Sphinx: make docs installs it"
        )
        pytest.skip(why)
    pages = [*DOCS.glob("*.md"), *DOCS.glob("*/*.md"), DOCS / "conf.py"]
    built = max(path.stat().st_mtime for path in BUILT.rglob("*.html"))
    if max(page.stat().st_mtime for page in pages) > built:
        pytest.skip("docs/_build is older than the pages: make docs builds it anew")
    return BUILT


class Page(HTMLParser):
    """Anchors of a page, where its links lead, and what it loads."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = {key: value for key, value in attrs if value is not None}
        self.anchors |= {found[key] for key in ("id", "name") if key in found}
        if tag == "a" and "href" in found:
            self.links.append(found["href"])
        if tag in ("script", "img", "iframe") and "src" in found:
            self.loaded.append(found["src"])
        if tag == "link" and "href" in found and found.get("rel") != "canonical":
            self.loaded.append(found["href"])


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Page]:
    return {path.resolve(): Page(path) for path in site.rglob("*.html")}


def outside(link: str) -> bool:
    return re.match(r"[a-z]+:|//", link) is not None


def test_every_link_inside_leads_somewhere(pages: dict[Path, Page]) -> None:
    dead = []
    for path, page in pages.items():
        for link in {*page.links, *page.loaded}:
            if outside(link):
                continue
            place, _, anchor = link.partition("#")
            target = (path.parent / unquote(place.partition("?")[0])).resolve() if place else path
            ok = target.exists() and (
                not anchor or target not in pages or unquote(anchor) in pages[target].anchors
            )
            if not ok:
                dead.append(f"{path.name}: {link}")
    assert dead == []
    assert sum(len(page.links) for page in pages.values()) > 5_000  # and there were some


def test_nothing_is_loaded_from_elsewhere(pages: dict[Path, Page], site: Path) -> None:
    loaded = {link for page in pages.values() for link in page.loaded if not link.startswith("data:")}
    assert [link for link in loaded if outside(link)] == []
    styles = "".join(path.read_text(encoding="utf-8") for path in site.rglob("*.css"))
    assert re.findall(r"(?:@import|url\()\s*['\"]?(?:https?:)?//[^)]*", styles) == []


def inventory(site: Path) -> set[str]:
    """The Python names that have an anchor, from Sphinx's inventory."""
    packed = (site / "objects.inv").read_bytes().split(b"\n", 4)[4]
    lines = zlib.decompress(packed).decode().splitlines()
    return {line.split(" ", 1)[0] for line in lines if re.search(r" py:\w+ ", line)}


def listed() -> list[str]:
    block = (DOCS / "reference" / "index.md").read_text(encoding="utf-8").split("Modules\n")[1]
    return [line.strip() for line in block.splitlines() if line.startswith("   ") and ":" not in line]


def test_every_public_name_has_a_page(site: Path) -> None:
    names = inventory(site)
    hidden = {"__version__", "config", "profiles", "se2"}  # a text; modules, listed under their own names
    assert {f"six_wheel.{name}" for name in set(sw.__all__) - hidden} - names == set()
    places = {id(getattr(sw, name)) for name in sw.__all__}
    missing = []
    for module in listed():
        assert f"six_wheel.{module}" in names
        package = importlib.import_module(f"six_wheel.{module}")
        for name in package.__all__:
            member = getattr(package, name)
            if id(member) in places or isinstance(member, ModuleType):
                continue
            places.add(id(member))
            if f"six_wheel.{module}.{name}" not in names:
                missing.append(f"{module}.{name}")
    assert missing == []


def test_every_member_of_a_class_has_an_anchor(site: Path) -> None:
    names, places, missing = inventory(site), set(), []
    owners = {f"six_wheel.{name}": getattr(sw, name) for name in sw.__all__}
    for module in listed():
        package = importlib.import_module(f"six_wheel.{module}")
        owners |= {f"six_wheel.{module}.{name}": getattr(package, name) for name in package.__all__}
    for owner, member in owners.items():
        if not isinstance(member, type) or member in places:
            continue
        places.add(member)
        annotated = vars(member).get("__annotations__", ())  # a narrower type is on the page of the base
        own = {*vars(member), *(name for name in annotated if not hasattr(member.__base__, name))}
        missing += [f"{owner}.{name}" for name in own if name[0] != "_" and f"{owner}.{name}" not in names]
    assert missing == []
    assert len(places) > 100


def test_every_public_package_is_listed() -> None:
    root = Path(sw.__file__).parent
    found = {
        ".".join(path.parent.relative_to(root).parts)
        for path in root.rglob("__init__.py")
        if re.search(r"^__all__", path.read_text(encoding="utf-8"), re.M)
    }
    inner = {name for name in found if name.split(".")[0] == "cli"}  # the command line is its own page
    assert found - inner - {""} - set(listed()) == set()


def test_every_command_has_a_section(pages: dict[Path, Page], site: Path) -> None:
    pytest.importorskip("typer")
    from six_wheel.cli.names import COMMANDS

    page = pages[(site / "reference" / "cli.html").resolve()]
    assert {f"six-wheel-{name}" for name in COMMANDS} <= page.anchors


def test_the_site_is_small(site: Path) -> None:
    sizes = {path: path.stat().st_size for path in site.rglob("*") if path.is_file()}
    assert sizes.pop(site / "howto" / "recorded_drive.html") < LARGEST_DRIVE
    assert sum(sizes.values()) < LARGEST_SITE


def chromium() -> str:
    for name in (os.environ.get("CHROMIUM", ""), "chromium", "chromium-browser", "google-chrome"):
        if name and (found := shutil.which(name)):
            return found
    pytest.skip("no chromium on this machine (CHROMIUM=PATH says where one is)")


def browsed(page: Path, folder: Path, width: int, *options: str) -> subprocess.CompletedProcess[str]:
    """Console messages and a picture of a page from headless Chromium, in a window of a width."""
    command = [
        chromium(),
        *("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--enable-logging=stderr"),
        *(f"--user-data-dir={folder}", f"--window-size={width},900", "--virtual-time-budget=4000"),
        *options,
        page.as_uri(),
    ]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


SHOWN = ("index", "start", "tutorials/wheels", "reference/cli", "reference/api/six_wheel.Rover", "search")


@pytest.mark.parametrize("name", SHOWN)
def test_a_browser_has_no_complaint(site: Path, name: str, tmp_path: Path) -> None:
    done = browsed(site / f"{name}.html", tmp_path, WIDE, "--dump-dom")
    assert re.findall(r".*CONSOLE.*", done.stderr) == []
    assert "</html>" in done.stdout


MEASURE = """<!doctype html><body style="margin:0">
<iframe id="f" src="{page}" width="{width}" height="900"></iframe>
<script>document.getElementById("f").onload = e => {{ const d = e.target.contentDocument.scrollingElement;
document.title = "wide " + d.scrollWidth; }};</script>"""


@pytest.mark.parametrize("name", SHOWN)
def test_a_page_fits_a_telephone(site: Path, name: str, tmp_path: Path) -> None:
    around = tmp_path / "around.html"
    page = (site / f"{name}.html").as_uri()
    around.write_text(MEASURE.format(page=page, width=NARROW), encoding="utf-8")
    done = browsed(around, tmp_path / "profile", WIDE, "--allow-file-access-from-files", "--dump-dom")
    found = re.search(r"<title>wide (\d+)</title>", done.stdout)
    assert found, done.stderr
    assert int(found[1]) <= NARROW


def test_search_finds_words_of_the_field(site: Path) -> None:
    words = (site / "searchindex.js").read_text(encoding="utf-8")
    for word in ("icr", "scrub", "swerv", "odometri", "calibr"):
        assert f'"{word}":' in words or f",{word}:" in words or f"{{{word}:" in words, word
