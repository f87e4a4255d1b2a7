"""A rover in the browser, in three dimensions, computed by this package while its sliders move.

>>> import six_wheel as sw
>>> view = sw.view("perseverance")  # doctest: +SKIP
>>> view.twist = (0.06, 0.0, 0.02)  # doctest: +SKIP
>>> view.close()  # doctest: +SKIP

`view` opens a page on this machine; `View` is what it returns. Needs the extra ``view`` (viser,
trimesh), which is loaded when a view is opened.
"""

import inspect
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.view.opening import view
    from six_wheel.view.viewing import View

__all__ = ["View", "view"]

__getattr__, __dir__ = attach(__name__, {"opening": ("view",), "viewing": ("View",)})


class _Viewing(ModuleType):
    """This package, which can be called: ``six_wheel.view(rover)`` is ``six_wheel.view.view(rover)``."""

    def __call__(self, *args: Any, **options: Any) -> "View":
        shown: View = self.view(*args, **options)  # with its arguments checked
        return shown

    @property
    def __signature__(self) -> inspect.Signature:
        return inspect.signature(self.view)


sys.modules[__name__].__class__ = _Viewing
