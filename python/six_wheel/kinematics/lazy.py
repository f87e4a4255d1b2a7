"""Names that a package has at once and loads when they are first used."""

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module

Lookup = tuple[Callable[[str], object], Callable[[], list[str]]]


def attach(package: str, modules: Mapping[str, Sequence[str]]) -> Lookup:
    """`__getattr__` and `__dir__` of a package.

    Parameters
    ----------
    package : str
        Its full name.
    modules : mapping of str to sequence of str
        Its modules, those of its packages as ``package.module``, and of each the names that the package shows
        as its own.
    """
    inner = {module.partition(".")[0] for module in modules}
    places = {name: module for module, names in modules.items() for name in names}

    def get(name: str) -> object:
        if name in places:
            value = getattr(import_module(f"{package}.{places[name]}"), name)
        elif name in inner:
            value = import_module(f"{package}.{name}")
        else:
            from six_wheel.kinematics.keywords import did_you_mean

            hint = "" if name.startswith("_") else did_you_mean(name, names())
            raise AttributeError(f"module {package!r} has no attribute {name!r}{hint}")
        setattr(sys.modules[package], name, value)  # from now on without a detour
        return value

    def names() -> list[str]:
        inside = vars(sys.modules[package])
        own = (name for name in inside if name.startswith("__") and name.endswith("__"))
        return sorted({*own, *inside.get("__all__", ()), *inner, *places})

    return get, names
