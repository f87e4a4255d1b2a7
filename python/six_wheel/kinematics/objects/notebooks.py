"""Objects in a notebook: their text, and their picture where matplotlib is installed."""

import sys
from typing import Any


class Shown:
    """Representations for a notebook: ``text/plain`` always, ``text/html`` with the picture of `plot`.

    Without matplotlib, and for an object that cannot be drawn, the text stands alone: no error leaves it.
    """

    __slots__ = ()

    def _repr_html_(self) -> str | None:
        try:
            import base64
            import html

            # Pictures are made floors above this one, by the package that this object came with.
            image = sys.modules["six_wheel"].plot(self)._repr_png_()
        except Exception:
            return None  # a cell that shows a result is no place for the error of its picture
        picture = f"data:image/png;base64,{base64.b64encode(image).decode()}"
        words = html.escape(str(self))
        return f'<pre>{words}</pre><img alt="{type(self).__name__}" src="{picture}">'

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        shown = self._repr_html_()
        return {"text/plain": repr(self)} | ({} if shown is None else {"text/html": shown})


def shown_in_notebooks(*kinds: type) -> None:
    """Give classes of the core the representations of `Shown`."""
    for kind in kinds:
        for name in ("_repr_html_", "_repr_mimebundle_"):
            setattr(kind, name, vars(Shown)[name])
