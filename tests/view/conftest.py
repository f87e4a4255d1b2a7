"""Views that end with the test, and a browser where there is one."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest

import six_wheel as sw


@pytest.fixture(autouse=True)
def extra() -> None:
    """The extra `view`; a skip at import of this file would end the whole run."""
    for name in ("viser", "trimesh"):
        pytest.importorskip(name, reason='needs pip install "six-wheel[view]"')


@pytest.fixture
def opened() -> Iterator[Callable[..., Any]]:
    """Open a view that is closed at the end."""
    views: list[Any] = []

    def open_view(x: Any, ground: Any = None, **options: Any) -> Any:
        views.append(sw.view(x, ground, open=False, **options))
        return views[-1]

    yield open_view
    for view in views:
        view.close()


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A headless Chromium that draws by software: CHROMIUM or on the PATH, or that of playwright itself."""
    playwright = pytest.importorskip("playwright.sync_api", reason="needs playwright: pip install playwright")
    from tests.view.browsing import launch

    with playwright.sync_playwright() as driver:
        started = launch(driver)
        if started is None:
            pytest.skip("no chromium on this machine (CHROMIUM=PATH says where one is)")
        yield started
        started.close()
