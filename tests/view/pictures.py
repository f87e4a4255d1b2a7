"""Pictures of the docs by the browser of the tests: ``python -m tests.view.pictures`` writes them."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright

import six_wheel as sw
from tests.view.browsing import DESK, TELEPHONE, Page, launch

PICTURES = Path(__file__).parents[2] / "docs" / "pictures"


def scenes() -> dict[str, tuple[Any, dict[str, Any], tuple[int, int]]]:
    """Arguments of every picture, and the size of its window."""
    corners = [(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25), (-0.3, -0.25)]
    swerve = sw.Rover.swerve(corners, 0.1)
    car = sw.Rover.ackermann(2.6, 1.5, 0.33, steering_limit=0.6)
    suspension = sw.RockerBogie.preset("perseverance")
    stamps = np.arange(0.0, 60.0, 1.0)
    twists = np.stack([np.full(60, 0.15), np.zeros(60), 0.06 * np.sin(stamps / 9.0)], axis=1)
    yard = sw.Terrain.yard(30.0, 0.1, 0.08, 4, roughness=0.2)
    run = sw.simulate(
        suspension, (stamps, twists), ground=yard, start=(8.0, 14.0, 0.0), rate=10.0, name="run"
    )
    return {
        "view_rocks": ("perseverance", {"twist": (0.15, 0.0, 0.05)}, DESK),
        "view_phone": ("perseverance", {"twist": (0.15, 0.0, 0.05)}, TELEPHONE),
        "view_swerve": (swerve, {"twist": (0.06, 0.05, 0.1)}, DESK),
        "view_ackermann": (car, {"twist": (0.2, 0.0, 0.04)}, DESK),
        "view_record": (run, {}, DESK),
    }


def draw(browser: Any, name: str, target: Path) -> None:
    """Draw one of the scenes."""
    x, options, size = scenes()[name]
    with sw.view(x, open=False, **options) as view:
        if view.time is not None:
            view.time = view.duration / 2.0
        page = Page(browser, view.url, size)
        page.ready("driven")
        page.shot(target)
        page.close()


def main(names: list[str]) -> None:
    with sync_playwright() as driver:
        browser = launch(driver)
        if browser is None:
            sys.exit("no chromium on this machine (CHROMIUM=PATH says where one is)")
        for name in names or scenes():
            draw(browser, name, PICTURES / f"{name}.jpg")
            print(PICTURES / f"{name}.jpg")
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1:])
