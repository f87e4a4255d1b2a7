"""Names that a package has at once and loads when they are first used."""

import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from importlib import import_module
from types import FunctionType, ModuleType

Lookup = tuple[Callable[[str], object], Callable[[], list[str]]]


class Package(ModuleType):
    """A package that says what to call where it is called itself."""

    def __call__(self, *args: object, **options: object) -> object:
        functions = [name for name in vars(self).get("__all__", ()) if name[0].islower()]
        hint = f"; call one of its functions: {', '.join(functions[:4])}" if functions else ""
        raise TypeError(f"{self.__name__} is a module, not a function{hint}")


def _checked(package: str, value: object) -> object:
    """A public function with `checked` arguments, pickled as that of its package; others as they are."""
    if not isinstance(value, FunctionType) or hasattr(value, "__wrapped__"):
        return value
    from six_wheel.kinematics.keywords import checked

    function = checked()(value)
    function.__module__ = package
    return function


def attach(
    package: str,
    modules: Mapping[str, Sequence[str]],
    beside: Collection[str] = (),
    hint: Callable[[str], str] | None = None,
) -> Lookup:
    """`__getattr__` and `__dir__` of the package of this full name.

    `modules` are its modules, those of its packages as ``package.module``, and of each the names that the
    package shows as its own. It has the names `beside`, too, which `dir` leaves out. `hint` gives the words
    about a name that is not there; without words the nearest name is said.
    """
    sys.modules[package].__class__ = Package
    inner = {module.partition(".")[0] for module in modules}
    places = {name: module for module, names in modules.items() for name in names}

    def get(name: str) -> object:
        if name in places:
            value = _checked(package, getattr(import_module(f"{package}.{places[name]}"), name))
        elif name in inner:
            value = import_module(f"{package}.{name}")
        else:
            from six_wheel.kinematics.keywords import did_you_mean

            words = hint(name) if hint is not None else ""
            if not words and not name.startswith("_"):
                words = did_you_mean(name, names())
            raise AttributeError(f"module {package!r} has no attribute {name!r}{words}")
        setattr(sys.modules[package], name, value)  # from now on without a detour
        return value

    def names() -> set[str]:
        inside = vars(sys.modules[package])
        own = (name for name in inside if name.startswith("__") and name.endswith("__"))
        return {*own, *inside.get("__all__", ()), *inner, *places}

    return get, lambda: sorted(names() - set(beside))
