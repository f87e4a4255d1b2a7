"""Objects in a notebook: their text, and their picture where matplotlib is installed."""

import sys
from typing import Any

__all__ = ["mimebundle", "shown_in_notebooks"]


def mimebundle(self: Any, include: Any = None, exclude: Any = None) -> dict[str, str]:
    """Representations for a notebook: ``text/plain`` always, ``text/html`` with the picture of `plot`.

    Without matplotlib, and for an object that cannot be drawn, the text stands alone: no error leaves it.
    """
    bundle = {"text/plain": repr(self)}
    try:
        import base64
        import html

        # Pictures are made floors above this one, by the package that this object came with.
        image = sys.modules["six_wheel"].plot(self)._repr_png_()
        picture = f"data:image/png;base64,{base64.b64encode(image).decode()}"
        words = html.escape(str(self))
        bundle["text/html"] = f'<pre>{words}</pre><img alt="{type(self).__name__}" src="{picture}">'
    except Exception:
        pass  # a cell that shows a result is no place for the error of its picture
    return bundle


def shown_in_notebooks(*kinds: type) -> None:
    """Give classes of the core the representations of `mimebundle`."""
    for kind in kinds:
        kind._repr_mimebundle_ = mimebundle  # type: ignore[attr-defined]
