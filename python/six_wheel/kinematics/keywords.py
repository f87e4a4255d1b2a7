"""Messages for names that are not there, with the nearest one and all there are, and for wrong types."""

import difflib
import inspect
import os
import re
import sys
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import wraps
from numbers import Real
from typing import Any, TypeVar, get_origin

from six_wheel.kinematics.errors import ArgumentTypeError, FileError, shown

_F = TypeVar("_F", bound=Callable[..., Any])
_C = TypeVar("_C", bound=type[Any])

# Keywords of other libraries, or of old, and those of here; the first that the call has counts.
NAMES = {
    "arm": ("suspension",),
    "center": ("centre",),
    "d1": ("track_width",),
    "d2": ("middle_to_rear",),
    "d3": ("front_to_middle",),
    "d4": ("middle_track_width",),
    "encoder": ("wheel_encoders",),
    "encoders": ("wheel_encoders",),
    "gear": ("gear_ratio",),
    "half_track": ("track_width",),
    "half_wheelbase": ("wheelbase",),
    "hinges": ("pivots",),
    "modulus": ("wraps_at",),
    "orientation": ("yaw",),
    "reading": ("readings",),
    "resolution": ("ticks_per_turn", "spacing"),
    "speeds": ("wheel_speeds",),
    "time_unit": ("stamp_unit",),
}
# Keywords that mean the same by another number.
_OF_ENCODERS = ("wheel_encoders", "give wheel_encoders=Encoder(ticks_per_turn=..., wraps_at=...)")
SENTENCES = {
    "bits": ("wraps_at", "bits=16 is wraps_at=65536"),
    "cell_size": ("spacing", "cell_size is spacing"),
    "d1": ("track_width", "d1 is half of track_width"),
    "d4": ("middle_track_width", "d4 is half of middle_track_width"),
    "half_track": ("track_width", "half_track is half of track_width"),
    "half_wheelbase": ("wheelbase", "half_wheelbase is half of wheelbase"),
    "frequency": ("period", "give period = 1 / frequency"),
    "rate": ("period", "give period = 1 / rate"),
    **dict.fromkeys(("modulus", "resolution", "ticks_per_turn", "wraps_at"), _OF_ENCODERS),
}


def same_thing(name: str, known: Collection[str]) -> str | None:
    """The known name of what others call `name`; None if there is none, or its number is another."""
    if SENTENCES.get(name, ("", ""))[0] in known:
        return None
    return next((new for new in NAMES.get(name, ()) if new in known), None)


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """`; did you mean ...?` with the nearest known name, or nothing where none is near."""
    names = list(known)
    meant = [new for new in NAMES.get(name, ()) if new in names] or difflib.get_close_matches(name, names, 1)
    return f"; did you mean {meant[0]}?" if meant else ""


def unknown_keyword(call: str, name: str, signature: str | Iterable[str]) -> str:
    """The message for a keyword that a call does not have, by its signature as text, or its names."""
    names = _names(signature) if isinstance(signature, str) else list(signature)
    needed, sentence = SENTENCES.get(name, ("", ""))
    hint = f": {sentence}." if needed in names else did_you_mean(name, names) or ";"
    hint = hint if hint.endswith((".", "?", ";")) else f"{hint}."
    return f"{call}() has no {name}{hint} {'It' if hint[-1] != ';' else 'it'} takes {', '.join(names)}"


def _names(signature: str) -> list[str]:
    """The names in a signature as `inspect.signature` shows it."""
    found = re.findall(r"[(,]\s*(\w+)\s*(?=[=,)])", re.sub(r"\([^()]*\)(?!$)", "0", signature))
    return [each for each in found if not each.isdigit()]


def too_many_values(call: str, excess: Collection[object], signature: str) -> str:
    """The message for values without names that a call has no place for, by its `inspect.signature`."""
    placed = _names(signature.partition("*")[0] + ")")
    return _too_many(call, placed, _names(signature)[len(placed) :], len(placed) + len(excess))


def _too_many(call: str, placed: Collection[str], by_name: Collection[str], got: int) -> str:
    count = f"{len(placed)} value{'s' * (len(placed) != 1)}" if placed else "no values"
    listed = f" ({', '.join(placed)})" if placed else ""
    rest = f": give {', '.join(by_name)} by name" if by_name else ""
    return f"{call}() takes {count} without names{listed}, got {got}{rest}"


def _absent(
    signature: inspect.Signature, arguments: tuple[Any, ...], keywords: Mapping[str, Any]
) -> list[str]:
    """The parameters without a default that a call has not given."""
    kinds = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    without = signature.parameters.values()
    required = [each.name for each in without if each.default is each.empty and each.kind not in kinds]
    placed = list(signature.parameters)[: len(arguments)]
    return [name for name in required if name not in placed and name not in keywords]


def _needs(call: str, absent: Collection[str]) -> str:
    """The message for arguments that are missing, in the words of the core."""
    return f"{call}() needs the argument{'s' * (len(absent) > 1)} {', '.join(absent)}"


def unknown_of(method: Callable[..., Any], given: Iterable[str]) -> str | None:
    """The message for the first keyword that a method of the core does not have; None if it has them all."""
    names = [name for name in inspect.signature(method).parameters if name != "self"]
    wrong = next((name for name in given if name not in names), None)
    return None if wrong is None else unknown_keyword(method.__qualname__, wrong, names)


def checked(*others: Callable[..., Any], call: str = "") -> Callable[[_F], _F]:
    """Decorator of a public function: a keyword that it does not have is refused with the nearest one, and an
    argument of another type than its annotation states is named where the call fails.

    Keywords of `others`, which its ``**options`` go to, are its own. `call` is its public name, by default
    that of the function.
    """

    def decorate(function: _F) -> _F:
        name = call or function.__name__
        together: tuple[Callable[..., Any], ...] = (function, *others)
        signatures = {each: inspect.signature(each) for each in together}
        named = {
            parameter.name
            for signature in signatures.values()
            for parameter in signature.parameters.values()
            if parameter.kind in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY)
        }
        shown = [each for signature in signatures.values() for each in signature.parameters if each in named]
        shown = [each for each in shown if each not in ("self", "cls", "_cls")]

        # A call with any keyword refuses those it does not have itself.
        parameters = signatures[function].parameters.values()
        takes_any = not others and any(each.kind is each.VAR_KEYWORD for each in parameters)
        kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
        placed = [each.name for each in parameters if each.kind in kinds]
        takes_all = any(each.kind is each.VAR_POSITIONAL for each in parameters)
        places = sys.maxsize if takes_all else len(placed)

        @wraps(function)
        def call_checked(*arguments: Any, **keywords: Any) -> Any:
            if not (takes_any or keywords.keys() <= named):
                wrong = next(each for each in keywords if each not in named)
                raise TypeError(unknown_keyword(name, wrong, dict.fromkeys(shown)))
            if len(arguments) > places:
                public = [each for each in placed if each in shown]
                given = len(arguments) - places + len(public)
                raise TypeError(
                    _too_many(name, public, [each for each in shown if each not in placed], given)
                )
            try:
                return function(*arguments, **keywords)
            except (AttributeError, TypeError, ValueError) as error:
                if absent := _absent(signatures[function], arguments, keywords):
                    raise TypeError(_needs(name, absent)) from None
                if (message := _mistyped(signatures, arguments, keywords, error)) is None:
                    raise
                raise ArgumentTypeError(message) from error

        return call_checked  # type: ignore[return-value]

    return decorate


def checked_class(kind: _C) -> _C:
    """Decorator of a public class: its constructor and its own public methods are `checked`."""
    for name, member in list(vars(kind).items()):
        inner = member.__func__ if isinstance(member, classmethod | staticmethod) else member
        makes = name in ("__init__", "__new__")
        if not inspect.isfunction(inner) or not (makes or not name.startswith("_")):
            continue
        call = kind.__name__ if makes else f"{kind.__name__}.{name}"
        wrapped = checked(call=call)(inner)
        made = wrapped if inner is member else type(member)(wrapped)
        setattr(kind, name, made)
    return kind


def _is_array(value: object) -> bool:
    import numpy as np

    if hasattr(value, "__array__") and not isinstance(value, np.ndarray):
        return True  # an array of another library: what it raises is its caller's
    try:
        np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        return False
    return True


# Words for an annotation, and the test of it.
KINDS: Mapping[str, tuple[str, Callable[[Any], bool]]] = {
    "ArrayLike": ("real numbers", _is_array),
    "Callable": ("callable", callable),
    "Floats": ("real numbers", _is_array),
    "None": ("None", lambda value: value is None),
    "Path": ("a path", lambda value: isinstance(value, str | os.PathLike)),
    "PathLike": ("a path", lambda value: isinstance(value, str | os.PathLike)),
    "bool": ("True or False", lambda value: not getattr(value, "shape", ()) and value in (True, False)),
    "float": ("a number", lambda value: isinstance(value, Real)),
    "int": ("a whole number", lambda value: hasattr(value, "__index__")),
    "str": ("a str", lambda value: isinstance(value, str)),
}


def _mistyped(
    signatures: Mapping[Callable[..., Any], inspect.Signature],
    arguments: tuple[Any, ...],
    keywords: Mapping[str, Any],
    error: Exception,
) -> str | None:
    """The message for the first argument of a failed call that is not what its annotation states.

    None if every argument is, if the annotations do not tell, or if the error names an argument itself. The
    signatures are those of the function, then of those that its ``**options`` go to.
    """
    named = {name for signature in signatures.values() for name in signature.parameters}
    argument = getattr(error, "argument", None)  # of an error of the core
    if isinstance(error, FileError if argument else FileError | ArgumentTypeError) or argument in named:
        return None
    given = dict(keywords)
    for function, signature in signatures.items():
        given |= dict(zip(signature.parameters, arguments, strict=False))
        arguments = ()
        for name, parameter in signature.parameters.items():
            if name not in given or (stated := _stated(function, parameter)) is None:
                continue
            if not any(fits(given[name]) for _, fits in stated.values()):
                words = dict.fromkeys(text for text, _ in stated.values() if text != "None")
                got = shown(given[name])
                hint = f": give sw.load({got})" if "Rover" in stated and isinstance(given[name], str) else ""
                return f"{name} must be {' or '.join(words)}, got {got}{hint}"
    return None


def _stated(
    function: Callable[..., Any], parameter: inspect.Parameter
) -> dict[str, tuple[str, Callable[[Any], bool]]] | None:
    """Kinds of values that an annotation names, with their tests; None where one of its words is no kind."""
    text = parameter.annotation
    if text is parameter.empty or parameter.kind in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL):
        return None
    text = text if isinstance(text, str) else inspect.formatannotation(text)
    while (inner := re.sub(r"\[[^\[\]]*\]", "", text)) != text:
        text = inner
    stated = {}
    for word in text.replace(" ", "").strip("\"'").split("|"):
        name = word.rpartition(".")[2]
        kind = getattr(function, "__globals__", {}).get(name)
        name = "Callable" if get_origin(kind) is Callable else name
        if name in KINDS:
            stated[name] = KINDS[name]
        elif inspect.isclass(kind) and kind.__module__.startswith("six_wheel"):
            stated[name] = f"a {name}", lambda value, kind=kind: isinstance(value, kind)  # type: ignore[misc]
        else:
            return None
    return stated
