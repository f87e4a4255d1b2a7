"""Pages of the browser: the one that the server sends, and a view as a page that needs no server."""

from __future__ import annotations  # viser is loaded when there is a view

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from six_wheel.kinematics.objects.whole_files import replacing

if TYPE_CHECKING:
    import viser

FRAMES, RATE = 300, 12.0  # of a record in a page: at most so many, so many a second of watching

# Until a scene says which lights it has, viser's client shows two lamps with shadows and decodes a picture of
# a sky, which takes seconds where pictures are drawn by software; a recorded page goes back to them at the
# begin of every pass. It begins with neither here. Shaders are linked without waiting for each one.
REPLACED = {
    "enableDefaultLights:!0,enableDefaultLightsShadows:!0,environmentMap:null": (
        "enableDefaultLights:!1,enableDefaultLightsShadows:!1,environmentMap:{}"
    ),
    "checkShaderErrors:!0": "checkShaderErrors:!1",
}
# Arrow keys are commands of the served page, heard at the root of the document. The camera of viser's client
# listens behind it and hears nothing of them. A slider with the focus keeps them for itself.
ARROWS = (
    '<script>document.documentElement.addEventListener("keydown",event=>{'
    'if(!event.code.startsWith("Arrow"))return;'
    'if(event.target.getAttribute("role")==="slider")event.stopImmediatePropagation();'
    "event.stopPropagation()})</script>"
)
LONG = 1_000_000  # characters; the client is the only text of such a length that is decoded


def prepared(page: str) -> str:
    """A page of viser's client, which unpacks its program itself, with `REPLACED` done as it is unpacked.

    The attribute ``data-prepared`` of the document counts the replacements that were made.
    """
    replacements = "".join(
        f'if(text.includes("{old}")){{text=text.replace("{old}","{new}");count++}}'
        for old, new in REPLACED.items()
    )
    script = (
        "<script>{const own=TextDecoder.prototype.decode;TextDecoder.prototype.decode=function(...given){"
        f"let text=own.apply(this,given),count=0;if(text.length<{LONG})return text;"
        f"TextDecoder.prototype.decode=own;{replacements}"
        "document.documentElement.dataset.prepared=count;return text}}</script>"
    )
    return page.replace("<head>", f"<head>{script}", 1)


def client_page() -> bytes:
    """The page that a server sends. It is packed already: as it comes no time goes into packing it again."""
    import viser

    source = Path(viser.__file__).parent / "client" / "build" / "index.html"
    page = source.read_text(encoding="utf-8").replace("<head>", f"<head>{ARROWS}", 1)
    return prepared(page).encode()


def write_page(server: viser.ViserServer, target: Path, dark: bool, frames: Iterable[float]) -> None:
    """Write what a server shows. Each step of `frames` changes it, and gives how long it lasts [s]."""
    steps = iter(frames)
    first = next(steps, None)
    serializer = server.get_scene_serializer()
    if first is not None:
        serializer.insert_sleep(first)
    for pause in steps:
        serializer.insert_sleep(pause)
    page = prepared(serializer.as_html(dark_mode=dark))
    with replacing(target) as temporary:
        temporary.write_text(page, encoding="utf-8")
