"""Immutable values with other arguments: everything else stays as it was."""

import copyreg
import dataclasses
import inspect
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cache, partial
from typing import Any, TypeVar

from six_wheel._core import Limits, Rover, Wheel, without_questions
from six_wheel.kinematics.keywords import did_you_mean, unknown_keyword

_T = TypeVar("_T")


def replace(self: _T, /, **changes: Any) -> _T:
    """The same with some of its values given anew; None is the default of one that has it.

    Raises
    ------
    TypeError
        If the call that makes it has no such argument.
    """
    # The call by which it pickles; that of its class for a named tuple or a dataclass.
    make, given = _call(self)
    parameters = _parameters(make)
    _check_names(self, changes, parameters)
    arguments = {
        name: argument
        for name, argument in (given | changes).items()
        if argument is not None or parameters[name].default is inspect.Parameter.empty
    }
    made: _T = make(**arguments)
    return made


def replace_in_rover(rover: Rover, wheel: str | None, changes: Mapping[str, Any]) -> Rover:
    """`Rover.replace`: arguments of the rover, and of every wheel or of the one that is named.

    Names, order and joints stay; wheels that change do not stand on the suspension they had.
    """
    of_wheel = [name for name in _parameters(Wheel) if name != "name"]
    of_rover = [] if wheel is not None else list(_parameters(Rover))
    _check_names(rover, changes, [*of_rover, *of_wheel])
    if wheel is not None and wheel not in rover.wheel_names:
        raise ValueError(f"wheel must be one of {', '.join(rover.wheel_names)}, got {wheel!r}")
    own = {name: value for name, value in changes.items() if name in of_rover}
    if isinstance(some := own.get("wheels"), Mapping):
        own["wheels"] = _with_some(rover, some)
    new = {name: value for name, value in changes.items() if name not in of_rover}
    if new:
        wheels = own.pop("wheels", rover.wheels)
        own["wheels"] = without_questions(lambda: [_changed(each, wheel, new) for each in wheels])
        if wheel is None and "steering_limit" in new and not any(each.steered for each in own["wheels"]):
            raise ValueError("steering_limit must be left out where no wheel steers")
    if "wheels" in own and tuple(own["wheels"]) != rover.wheels:
        own.setdefault("suspension", None)
    return replace(rover, **own)


def _with_some(rover: Rover, some: Mapping[str, Any]) -> list[Wheel]:
    """The wheels of a rover, some given anew by name: a `Wheel`, or changes of the one there is."""
    if unknown := [name for name in some if name not in rover.wheel_names]:
        known = list(rover.wheel_names)
        hint = did_you_mean(str(unknown[0]), known)
        raise ValueError(f"wheels must be some of {', '.join(known)}, got {unknown[0]!r}{hint}")

    def made(wheel: Wheel) -> Wheel:
        given = some.get(wheel.name, {})
        if isinstance(given, Mapping):
            return wheel.replace(**given)
        if not isinstance(given, Wheel):
            raise TypeError(f"wheels must hold Wheel or dict, got {given!r} for {wheel.name!r}")
        return given.replace(name=wheel.name)

    return without_questions(lambda: [made(wheel) for wheel in rover.wheels])


def _changed(each: Wheel, only: str | None, changes: dict[str, Any]) -> Wheel:
    """A wheel of a rover after changes to all of them, or to the one of that name."""
    if only is not None and each.name != only:
        return each
    if only is None and not changes.get("steered", each.steered):
        changes = {name: value for name, value in changes.items() if name != "steering_limit"}
    return each.replace(**changes)


def _call(value: Any) -> tuple[Callable[..., Any], dict[str, Any]]:
    """The call that makes a value, and the arguments that were given to it."""
    kind: Callable[..., Any] = type(value)
    if isinstance(value, tuple) or dataclasses.is_dataclass(value):
        return kind, {name: getattr(value, name) for name in _parameters(kind)}
    make: Any
    make, call = value.__reduce__()
    keywords: Mapping[str, Any] = {}
    if make is copyreg.__newobj_ex__:  # type: ignore[attr-defined]
        make, call, keywords = call
    elif isinstance(make, partial):
        make, keywords = make.func, make.keywords
    return make, dict(zip(_parameters(make), call, strict=False)) | dict(keywords)


@cache
def _parameters(make: Callable[..., Any]) -> Mapping[str, inspect.Parameter]:
    return inspect.signature(make).parameters


def _check_names(value: object, changes: Iterable[str], names: Collection[str]) -> None:
    for name in changes:
        if name not in names:
            raise TypeError(unknown_keyword(f"{type(value).__name__}.replace", name, names))


def limits_given(limits: Limits) -> dict[str, float]:
    """The limits that were given, by name; infinite ones among them."""
    return _call(limits)[1]
