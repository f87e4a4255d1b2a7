"""A view in a real browser: pictures by structure, every control, two browsers, a reload, a page on disk."""

import io
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import six_wheel as sw
from tests.view.browsing import DESK, PATIENCE, TELEPHONE, Page

Open = Callable[..., Any]
TWIST = (0.15, 0.0, 0.05)
SCALES = (
    "Object.values(window.__viserTestpoints.uplots).map(each => each.chart.scales.x).map(x => [x.min, x.max])"
)
PREPARED = "document.documentElement.dataset.prepared"
SAND, TEAL = (0, 60), (160, 200)  # [degrees] of hue


@pytest.fixture
def page(browser: Any) -> Any:
    pages: list[Page] = []

    def open_page(url: str, size: tuple[int, int] = DESK) -> Page:
        pages.append(Page(browser, url, size))
        return pages[-1]

    yield open_page
    for each in pages:
        each.close()


def pixels(png: bytes) -> NDArray[np.float64]:
    from matplotlib.image import imread

    return np.asarray(imread(io.BytesIO(png), format="png"))[..., :3]


def share(picture: NDArray[np.float64], hues: tuple[int, int]) -> float:
    """Share of pixels that have a colour, of these hues."""
    from matplotlib.colors import rgb_to_hsv

    hue, saturation, value = np.moveaxis(rgb_to_hsv(picture), -1, 0)
    found = (360 * hue > hues[0]) & (360 * hue < hues[1]) & (saturation > 0.25) & (value > 0.2)
    return float(found.mean())


def until(true: Callable[[], bool], patience: float = PATIENCE / 1000.0) -> bool:
    """True if it becomes true within the patience [s]."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if true():
            return True
        time.sleep(0.05)
    return False


@pytest.mark.slow
@pytest.mark.parametrize("size", [DESK, TELEPHONE])
def test_a_rover_on_rocks_is_seen_and_nothing_comes_from_elsewhere(
    opened: Open, page: Any, size: tuple[int, int]
) -> None:
    shown = page(opened("perseverance", twist=TWIST).url, size)
    shown.ready("possible as commanded")
    picture = pixels(shown.shot())
    assert shown.page.evaluate(PREPARED) == "2"  # a newer viser may be written differently: see `prepared`
    free = picture[: size[1] * 2 // 5, : size[0] * 7 // 10]  # beside and above the panel
    assert share(picture, SAND) > 0.1
    assert free.std() > 0.05  # the rover, not the sky alone
    assert share(picture, TEAL) > 0.002
    assert shown.complaints == []
    assert shown.elsewhere == []


@pytest.mark.slow
def test_a_slider_of_the_page_changes_the_picture(opened: Open, page: Any) -> None:
    """`test_controls` moves the others, and looks at the data of the scene."""
    view = opened("perseverance", "flat", twist=TWIST)
    shown = page(view.url)
    shown.ready("possible as commanded")
    before = pixels(shown.shot())
    shown.type("vy [cm/s]", "3")
    shown.page.wait_for_selector("text=not without sliding")
    after = pixels(shown.shot())
    assert np.abs(after - before).max(axis=-1).mean() > 0.005
    assert shown.complaints == []


@pytest.mark.slow
def test_two_browsers_agree_and_a_reload_keeps_the_state(opened: Open, page: Any) -> None:
    view = opened("curiosity", "flat", twist=TWIST)
    first, second = page(view.url), page(view.url, TELEPHONE)
    first.ready("possible as commanded")
    first.type("vx [cm/s]", "7")
    assert until(lambda: view.twist[0] == pytest.approx(0.07))
    for each in (first, second):
        each.page.wait_for_selector("text=driven +0.0700")
    first.page.reload()
    first.page.wait_for_selector("text=driven +0.0700")
    second.close()
    first.type("vx [cm/s]", "6")  # one that closes does not matter to the other
    first.page.wait_for_selector("text=driven +0.0600")
    assert first.complaints == []


@pytest.mark.slow
def test_a_record_plays_in_the_page(opened: Open, page: Any) -> None:
    stamps = np.linspace(0.0, 30.0, 600)
    log = sw.simulate(sw.Rover.preset("husky"), (stamps, np.tile([0.3, 0.0, 0.1], (600, 1))))
    view = opened(log, rover="husky")
    shown = page(view.url)
    shown.ready("as recorded")
    before = pixels(shown.shot())
    shown.page.keyboard.press("Space")
    assert until(lambda: view.time > 2.0)
    shown.page.keyboard.press("Space")
    after = pixels(shown.shot())
    assert np.abs(after - before).max(axis=-1).mean() > 0.005
    # All of the record is plotted; it was the first second of it.
    assert shown.page.evaluate(SCALES) == [[0.0, 30.0]] * len(view._player._cursors)
    assert shown.complaints == []


@pytest.mark.slow
def test_a_page_on_disk_shows_the_scene(opened: Open, page: Any, tmp_path: Path) -> None:
    target = opened("perseverance", twist=TWIST).save(tmp_path / "page.html")
    shown = page(target.as_uri())
    shown.page.wait_for_timeout(4000)
    picture = pixels(shown.shot())
    assert share(picture, SAND) > 0.1
    assert shown.page.evaluate(PREPARED) == "2"
    assert shown.elsewhere == []
    assert shown.complaints == []
    assert target.stat().st_size < 8_000_000


@pytest.mark.slow
def test_ctrl_c_ends_it_with_a_browser_on_it(page: Any) -> None:
    command = [sys.executable, "-m", "six_wheel", "view", "husky", "--no-browser"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        found = re.match(r"(http://127\.0\.0\.1:\d+)", process.stdout.readline())
        assert found
        shown = page(found[1])
        shown.ready("possible as commanded")
        os.kill(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert (process.returncode, out, err) == (0, "", "")
