"""A view as a page that needs no server."""

from __future__ import annotations  # viser is loaded when there is a view

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from six_wheel.logs.writing import replacing

if TYPE_CHECKING:
    import viser

__all__ = ["FRAMES", "RATE", "write_page"]

FRAMES, RATE = 300, 12.0  # of a record in a page: at most so many, so many a second of watching


def write_page(server: viser.ViserServer, target: Path, dark: bool, frames: Iterable[float]) -> None:
    """Write what a server shows. Each step of `frames` changes it, and gives how long it lasts [s]."""
    steps = iter(frames)
    first = next(steps, None)
    serializer = server.get_scene_serializer()
    if first is not None:
        serializer.insert_sleep(first)
    for pause in steps:
        serializer.insert_sleep(pause)
    page = serializer.as_html(dark_mode=dark)
    with replacing(target) as temporary:
        temporary.write_text(page, encoding="utf-8")
