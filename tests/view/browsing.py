"""A page of a view in a headless browser."""

import os
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

SOFTWARE = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
NAMES = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 180_000  # [ms] of a machine that draws by software while it does other things
# A click of playwright's own waits for two pictures, seconds where software draws and has other work.
CLICK = "element => element.click()"
PAUSE = 120  # [ms]; viser's page sends one change in 50 ms at most, of several controls the last one
DESK, TELEPHONE = (1280, 800), (390, 800)  # [px]
# two pictures on
DRAWN = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
SMALL = (760, 480)  # [px], which software draws fast


def find_chromium() -> str | None:
    """Chromium of CHROMIUM or on the PATH."""
    for name in (os.environ.get("CHROMIUM", ""), *NAMES):
        if name and (found := shutil.which(name)):
            return found
    return None


def launch(driver: Any) -> Any | None:
    """A browser that draws by software; None if there is none, not even playwright's own."""
    path = find_chromium()
    if path is None and not Path(driver.chromium.executable_path).exists():
        return None
    return driver.chromium.launch(executable_path=path, args=list(SOFTWARE))


class Page:
    """A page, with what it complained of and what it asked other hosts for."""

    def __init__(self, browser: Any, url: str, size: tuple[int, int] = DESK) -> None:
        self.complaints: list[str] = []
        self.elsewhere: list[str] = []
        self.frames = [0, 0]  # web socket frames received, and their bytes
        self.page = browser.new_page(viewport={"width": size[0], "height": size[1]})
        self.page.set_default_timeout(PATIENCE)
        self.page.on("console", lambda each: self._said(each.type, each.text))
        self.page.on("pageerror", lambda error: self._said("error", str(error)))
        self.page.on("request", lambda request: self._asked(request.url, url))
        self.page.on("websocket", self._listen)
        self.page.goto(url)
        self.page.wait_for_selector("canvas", state="attached")

    def ready(self, text: str) -> None:
        """Wait until the panel has a text, and the picture is drawn."""
        self.page.wait_for_selector(f"text={text}")
        self.page.wait_for_timeout(2500)

    def shot(self, path: Path | None = None) -> bytes:
        """A picture, without viser's note that there is no graphics processor."""
        for button in self.page.locator(".mantine-Notification-closeButton").all():
            button.click()
        self.page.wait_for_timeout(500)
        options = {} if path is None or path.suffix == ".png" else {"type": "jpeg", "quality": 86}
        return bytes(self.page.screenshot(path=path, **options))

    def type(self, row: str, value: str) -> None:
        """Write a number into the field of a slider, whose name stands in its row."""
        field = self._input(row)
        self.page.wait_for_timeout(PAUSE)
        field.fill(value)
        field.press("Enter")

    def value(self, row: str) -> str:
        """The number in the field of a slider."""
        return str(self._input(row).input_value())

    def tick(self, row: str) -> None:
        """Click on the box of a row."""
        self.page.wait_for_timeout(PAUSE)
        self._input(row).evaluate(CLICK)

    def choose(self, row: str, option: str) -> None:
        """Choose an option of the list of a row."""
        self._input(row).evaluate(CLICK)
        wanted = re.compile(f"^{re.escape(option)}$")
        self.page.locator("[role=option]").filter(has_text=wanted).last.evaluate(CLICK)

    def press(self, name: str) -> None:
        """Click on a button."""
        self.page.wait_for_timeout(PAUSE)
        self.page.get_by_role("button", name=name, exact=True).evaluate(CLICK)

    def unfold(self, folder: str) -> None:
        """Open a folder that is closed."""
        self.page.get_by_text(folder, exact=True).first.evaluate(CLICK)
        self.page.wait_for_timeout(400)

    def _input(self, row: str) -> Any:
        return (
            self.page.get_by_text(row, exact=True)
            .first.locator("xpath=ancestor::*[.//input][1]")
            .locator("input:not([type=hidden])")
            .last
        )

    def close(self) -> None:
        """Close the page."""
        self.page.close()

    def _said(self, kind: str, text: str) -> None:
        if kind == "error":
            self.complaints.append(text)

    def _asked(self, asked: str, own: str) -> None:
        if not asked.startswith((own, own.replace("http", "ws"), "data:", "blob:")):
            self.elsewhere.append(asked)

    def _listen(self, socket: Any) -> None:
        def received(data: Any) -> None:
            self.frames[0] += 1
            self.frames[1] += len(data)

        socket.on("framereceived", received)


def pull(shown: Page, camera: Any, handle: NDArray[np.float64], size: float) -> None:
    """Pull the arrow of a handle along x with the mouse."""
    grip, target = (project(camera, handle + np.array([share * size, 0.0, 0.0])) for share in (0.45, 0.75))
    mouse = shown.page.mouse
    mouse.move(*grip)
    shown.page.evaluate(DRAWN)
    mouse.down()
    for share in np.linspace(0.0, 1.0, 8):
        mouse.move(*(grip + share * (target - grip)))
        shown.page.evaluate(DRAWN)
    mouse.up()
    shown.page.wait_for_timeout(500)


def project(camera: Any, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Place of a point in the window [px], whose picture may be drawn with fewer pixels."""
    from viser.transforms import SO3

    width, height = SMALL
    x, y, depth = SO3(np.asarray(camera.wxyz)).inverse() @ (point - np.asarray(camera.position))
    scale = height / 2.0 / np.tan(camera.fov / 2.0)
    return np.array([width / 2.0 + scale * x / depth, height / 2.0 + scale * y / depth])
